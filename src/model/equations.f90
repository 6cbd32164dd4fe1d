!> Linear equations between degrees of freedom, as a deck gives them, and kinematic couplings: faces
!> that follow a reference node as a rigid body does.
module equations
   use element_kinds, only: side_nodes
   use kinds, only: dp
   use mesh, only: mesh_type
   use steps, only: dof_temperature
   implicit none
   private
   public :: equation_type, equation_nodes, coupling_type, coupling_equations, constrained_nodes, &
      fill_equation, surface_nodes

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

   !> One *COUPLING with *KINEMATIC.
   type :: coupling_type
      character(:), allocatable :: title       !! card and line, for messages
      integer :: card = 0                      !! card image
      integer :: reference = 0                 !! index of the reference node
      integer :: rotation = 0 !! index of the node whose first degree of freedom is its rotation
      integer :: surface = 0                   !! index of the surface
      logical :: follows(2) = .false.          !! displacements along x and y
      logical :: is_warm = .false.             !! temperatures
   end type coupling_type

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

   !> The equations of the nodes of the surface, in linear theory: u = u_r + theta x (x - x_r).
   pure function coupling_equations(coupling, mesh) result(equations)
      type(coupling_type), intent(in) :: coupling
      type(mesh_type), intent(in) :: mesh
      type(equation_type), allocatable :: equations(:)
      integer, allocatable :: nodes(:)
      integer :: c, k, n
      real(dp) :: arm(2)

      nodes = surface_nodes(mesh, coupling%surface)
      nodes = pack(nodes, nodes /= coupling%reference)
      allocate (equations(size(nodes)*(count(coupling%follows) + merge(1, 0, coupling%is_warm))))
      equations%card = coupling%card
      n = 0
      do k = 1, size(nodes)
         arm = mesh%coordinates(:, nodes(k)) - mesh%coordinates(:, coupling%reference)
         do c = 1, 2
            if (.not. coupling%follows(c)) cycle
            n = n + 1
            call fill_equation([nodes(k), coupling%reference, coupling%rotation], [c, c, 1], &
               [1.0_dp, -1.0_dp, merge(arm(2), -arm(1), c == 1)], equations(n))
         end do
         if (.not. coupling%is_warm) cycle
         n = n + 1
         call fill_equation([nodes(k), coupling%reference], [dof_temperature, dof_temperature], &
            [1.0_dp, -1.0_dp], equations(n))
      end do
      do k = 1, n
         equations(k)%title = coupling%title
      end do
   end function coupling_equations

   !> Nodes that equations relate, and those that couplings bring.
   pure function constrained_nodes(equations, couplings, nodes) result(related)
      type(equation_type), intent(in) :: equations(:)
      type(coupling_type), intent(in) :: couplings(:)
      integer, intent(in) :: nodes                 !! number of nodes
      logical :: related(nodes)
      integer :: i

      related = equation_nodes(equations, nodes)
      do i = 1, size(couplings)
         related(pack([couplings(i)%reference, couplings(i)%rotation], &
            [couplings(i)%reference, couplings(i)%rotation] > 0)) = .true.
      end do
   end function constrained_nodes

   !> Fills an equation, without the terms whose coefficient is zero.
   pure subroutine fill_equation(nodes, dofs, coefficients, equation)
      integer, intent(in) :: nodes(:), dofs(:)         !! (n) of its terms
      real(dp), intent(in) :: coefficients(:)          !! (n)
      type(equation_type), intent(inout) :: equation

      associate (there => abs(coefficients) > 0.0_dp)
         equation%node = pack(nodes, there)
         equation%dof = pack(dofs, there)
         equation%coefficient = pack(coefficients, there)
      end associate
   end subroutine fill_equation

   !> Nodes of a surface, each once.
   pure function surface_nodes(mesh, surface) result(nodes)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: surface
      integer, allocatable :: nodes(:)
      logical :: found(size(mesh%node_number))
      integer :: f, i

      found = .false.
      associate (faces => mesh%surfaces(surface)%faces)
         do f = 1, size(faces, 2)
            found(mesh%element_nodes(side_nodes(mesh%element_kind(faces(1, f)), faces(2, f)), &
               faces(1, f))) = .true.
         end do
      end associate
      nodes = pack([(i, i=1, size(found))], found)
   end function surface_nodes

end module equations
