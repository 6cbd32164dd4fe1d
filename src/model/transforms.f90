!> Axes of their own, along which cards name displacements and forces of some nodes.
!>
!> Such a node has a partner, a node of no element, whose degrees of freedom are the components of
!> its displacement along these axes. Equations relate both; what a card prescribes or loads is
!> prescribed and loaded there.
module transforms
   use equations, only: equation_type
   use kinds, only: dp
   use mesh, only: mesh_type, set_type
   implicit none
   private
   public :: transform_type, partner_type, axes_at, axis_in_plane, along_axes, on_nodes

   !> One *TRANSFORM.
   type :: transform_type
      character(:), allocatable :: title       !! card and line, for messages
      integer :: card = 0                      !! card image
      integer :: set = 0                       !! index of the node set
      logical :: cylindrical = .false.         !! TYPE=C: along the radius and round the axis
      real(dp) :: point(2) = 0.0_dp            !! on the axis, or on the first axis in the plane
      real(dp) :: sense = 1.0_dp               !! -1 where the second one is clockwise of the first
      integer :: out_of_plane = 3              !! local axis along z
   end type transform_type

   !> A node with axes of its own, and its partner.
   type :: partner_type
      integer :: node = 0                      !! node index
      integer :: partner = 0                   !! index of its partner
      real(dp) :: axes(2, 2) = 0.0_dp          !! unit vectors of the axes, a column each
   end type partner_type

contains

   !> The axes in the plane at a place, a unit vector each; zero on the axis of a cylindrical
   !> transform.
   pure function axes_at(transform, x) result(axes)
      type(transform_type), intent(in) :: transform
      real(dp), intent(in) :: x(2)             !! [length]
      real(dp) :: axes(2, 2), first(2)

      axes = 0.0_dp
      first = transform%point
      if (transform%cylindrical) first = x - transform%point
      if (norm2(first) <= 0.0_dp) return
      first = first/norm2(first)
      axes(:, 1) = first
      axes(:, 2) = transform%sense*[-first(2), first(1)]
   end function axes_at

   !> Which of the two axes in the plane a degree of freedom of some nodes is along, 3 where it is
   !> along z, and 0 where the nodes differ; other degrees of freedom themselves.
   pure integer function axis_in_plane(transforms, node_sets, nodes, dof) result(axis)
      type(transform_type), intent(in) :: transforms(:)
      type(set_type), intent(in) :: node_sets(:)
      integer, intent(in) :: nodes(:), dof
      integer :: i, k, out_of_plane(size(nodes))

      axis = dof
      if (dof > 3 .or. all(transforms%out_of_plane == 3)) return
      out_of_plane = 3
      do i = 1, size(transforms)
         if (transforms(i)%set == 0) cycle
         do k = 1, size(nodes)
            if (all(node_sets(transforms(i)%set)%members /= nodes(k))) cycle
            out_of_plane(k) = transforms(i)%out_of_plane
         end do
      end do
      if (minval(out_of_plane) /= maxval(out_of_plane)) then
         axis = 0
      else if (dof == maxval(out_of_plane)) then
         axis = 3
      else if (dof > maxval(out_of_plane)) then
         axis = dof - 1
      end if
   end function axis_in_plane

   !> An equation whose terms at nodes with axes of their own are along these, as one along x and y.
   pure function along_axes(equation, mesh, transforms, of_node) result(plain)
      type(equation_type), intent(in) :: equation
      type(mesh_type), intent(in) :: mesh
      type(transform_type), intent(in) :: transforms(:)
      integer, intent(in) :: of_node(:)        !! (nodes) the transform of each, or 0
      type(equation_type) :: plain
      real(dp) :: axes(2, 2)
      integer :: c, i

      plain = equation
      if (equation%is_thermal()) return
      plain%node = [integer ::]
      plain%dof = [integer ::]
      plain%coefficient = [real(dp) ::]
      do i = 1, size(equation%node)
         associate (node => equation%node(i), dof => equation%dof(i))
            axes = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])
            if (of_node(node) > 0) axes = axes_at(transforms(of_node(node)), &
               mesh%coordinates(:, node))
            do c = 1, 2
               if (abs(axes(c, dof)) > 0.0_dp) call plain%add_term(node, c, &
                  equation%coefficient(i)*axes(c, dof))
            end do
         end associate
      end do
   end function along_axes

   !> Forces along x and y of nodes, with those of their partners, which have none then.
   pure function on_nodes(partners, forces) result(whole)
      type(partner_type), intent(in) :: partners(:)
      real(dp), intent(in) :: forces(:, :)     !! (2, nodes) [force]
      real(dp) :: whole(2, size(forces, 2))    !! (2, nodes) [force]
      integer :: i

      whole = forces
      do i = 1, size(partners)
         associate (node => partners(i)%node, partner => partners(i)%partner)
            whole(:, node) = whole(:, node) + matmul(partners(i)%axes, forces(:, partner))
            whole(:, partner) = 0.0_dp
         end associate
      end do
   end function on_nodes

end module transforms
