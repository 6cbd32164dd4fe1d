!> Kinematic couplings: faces that follow a reference node as a rigid body does.
module couplings
   use element_kinds, only: side_nodes
   use equations, only: equation_nodes, equation_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use steps, only: dof_temperature
   implicit none
   private
   public :: coupling_type, coupling_equations, constrained_nodes

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

   !> The equations of the nodes of the surface, in linear theory: u = u_r + theta x (x - x_r).
   pure function coupling_equations(coupling, mesh) result(equations)
      type(coupling_type), intent(in) :: coupling
      type(mesh_type), intent(in) :: mesh
      type(equation_type), allocatable :: equations(:)
      integer, allocatable :: nodes(:)
      integer :: c, k, n
      real(dp) :: arm(2)

      nodes = nodes_of(mesh, coupling%surface)
      nodes = pack(nodes, nodes /= coupling%reference)
      allocate (equations(size(nodes)*(count(coupling%follows) + merge(1, 0, coupling%is_warm))))
      equations%card = coupling%card
      n = 0
      do k = 1, size(nodes)
         arm = mesh%coordinates(:, nodes(k)) - mesh%coordinates(:, coupling%reference)
         do c = 1, 2
            if (.not. coupling%follows(c)) cycle
            n = n + 1
            call fill([nodes(k), coupling%reference, coupling%rotation], [c, c, 1], &
               [1.0_dp, -1.0_dp, merge(arm(2), -arm(1), c == 1)], equations(n))
         end do
         if (.not. coupling%is_warm) cycle
         n = n + 1
         call fill([nodes(k), coupling%reference], [dof_temperature, dof_temperature], &
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
   pure subroutine fill(nodes, dofs, coefficients, equation)
      integer, intent(in) :: nodes(:), dofs(:)
      real(dp), intent(in) :: coefficients(:)
      type(equation_type), intent(inout) :: equation

      associate (there => abs(coefficients) > 0.0_dp)
         equation%node = pack(nodes, there)
         equation%dof = pack(dofs, there)
         equation%coefficient = pack(coefficients, there)
      end associate
   end subroutine fill

   !> Nodes of a surface, each once.
   pure function nodes_of(mesh, surface) result(nodes)
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
   end function nodes_of

end module couplings
