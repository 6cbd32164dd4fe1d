!> Linear equations between degrees of freedom, as a deck gives them.
module equations
   use kinds, only: dp
   use steps, only: dof_temperature
   implicit none
   private
   public :: equation_type, equation_nodes

   !> A sum of coefficient*degree of freedom that is zero, of displacements or of temperatures.
   type :: equation_type
      character(:), allocatable :: title           !! card and line, for messages
      integer :: card = 0                          !! card image
      integer, allocatable :: node(:)              !! (n) node indexes
      integer, allocatable :: dof(:)               !! (n) 1 and 2, or dof_temperature
      real(dp), allocatable :: coefficient(:)      !! (n) none is zero
   contains
      procedure :: is_thermal
      procedure :: places
      procedure :: replace
      procedure :: add_term
   end type equation_type

contains

   !> Whether it is one of temperatures.
   pure logical function is_thermal(self)
      class(equation_type), intent(in) :: self

      is_thermal = self%dof(1) == dof_temperature
   end function is_thermal

   !> Positions of its terms among the degrees of freedom of a field.
   pure function places(self)
      class(equation_type), intent(in) :: self
      integer :: places(size(self%node))           !! (n)

      places = self%node
      if (.not. self%is_thermal()) places = 2*(self%node - 1) + self%dof
   end function places

   !> Writes the values of nodes that are dropped as the mean of two other ones, and numbers the
   !> nodes anew.
   pure subroutine replace(self, parents, new_index)
      class(equation_type), intent(inout) :: self
      integer, intent(in) :: parents(:, :)         !! (2, nodes) the other ones
      integer, intent(in) :: new_index(:)          !! (nodes) 0 where dropped
      type(equation_type) :: other
      integer :: i, k

      allocate (other%node(0), other%dof(0), other%coefficient(0))
      do i = 1, size(self%node)
         associate (node => self%node(i), dof => self%dof(i), coefficient => self%coefficient(i))
            if (new_index(node) > 0) then
               call other%add_term(new_index(node), dof, coefficient)
            else
               do k = 1, 2
                  call other%add_term(new_index(parents(k, node)), dof, 0.5_dp*coefficient)
               end do
            end if
         end associate
      end do
      self%node = other%node
      self%dof = other%dof
      self%coefficient = other%coefficient
   end subroutine replace

   !> Adds a term; each degree of freedom is there once.
   pure subroutine add_term(self, node, dof, coefficient)
      class(equation_type), intent(inout) :: self
      integer, intent(in) :: node, dof
      real(dp), intent(in) :: coefficient
      integer :: at

      at = findloc(self%node == node .and. self%dof == dof, .true., dim=1)
      if (at > 0) then
         self%coefficient(at) = self%coefficient(at) + coefficient
      else
         self%node = [self%node, node]
         self%dof = [self%dof, dof]
         self%coefficient = [self%coefficient, coefficient]
      end if
   end subroutine add_term

   !> Nodes that equations name.
   pure function equation_nodes(equations, nodes) result(named)
      type(equation_type), intent(in) :: equations(:)
      integer, intent(in) :: nodes                 !! number of nodes
      logical :: named(nodes)
      integer :: i

      named = .false.
      do i = 1, size(equations)
         named(equations(i)%node) = .true.
      end do
   end function equation_nodes

end module equations
