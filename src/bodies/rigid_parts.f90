!> The bodies as rigid parts.
!>
!> Elements that share sides are one part; parts of a body hinge on nodes that they have in common.
!> A part moves by two shifts and a turn about the middle of its nodes; turns count by the
!> displacement that they give at its farthest node. A plane part of one element of eight nodes with
!> reduced integration deforms, too, without any strain at its four integration points: its
!> hourglass mode.
module rigid_parts
   use dense, only: null_space
   use element_kinds, only: axisymmetric, element_node_count, quad8_reduced
   use kinds, only: dp
   use mesh, only: mesh_type
   use quadrature, only: integration_rule
   use shape_functions, only: element_gradients
   implicit none
   private
   public :: rigid_parts_type, find_rigid_parts

   !> Unknowns are two shifts and a turn of each part, the amplitudes of hourglass modes, and the
   !> degrees of freedom of no body.
   type :: rigid_parts_type
      integer, allocatable :: body(:)           !! (parts) body of each
      integer, allocatable :: first(:)          !! (parts) first element, 0 for all of the body
      integer, allocatable :: part(:)           !! (nodes) a part that has it, or 0
      integer, allocatable :: hinge(:, :)       !! (2, hinges) node, another part that has it
      real(dp), allocatable :: middle(:, :)     !! (2, parts) mean of the nodes [length]
      real(dp), allocatable :: extent(:)        !! (parts) distance of the farthest node [length]
      integer, allocatable :: soft(:)           !! (modes) part that has an hourglass mode
      integer, allocatable :: corner(:, :)      !! (8, modes) nodes of its element
      real(dp), allocatable :: mode(:, :, :)    !! (2, 8, modes) their displacements
      integer, allocatable :: lone(:) !! degrees of freedom, of no body, that joints take
   contains
      procedure :: unknowns
      procedure :: at_point
   end type rigid_parts_type

contains

   !> The parts of the bodies of a mesh, their hinges and hourglass modes.
   pure subroutine find_rigid_parts(mesh, bodies)
      type(mesh_type), intent(in) :: mesh                  !! its bodies known
      type(rigid_parts_type), intent(inout) :: bodies      !! receives all but `lone`

      call divide(mesh, bodies)
      call place(mesh, bodies)
      call find_modes(mesh, bodies)
   end subroutine find_rigid_parts

   !> Number of unknowns.
   pure integer function unknowns(self)
      class(rigid_parts_type), intent(in) :: self

      unknowns = 3*size(self%body) + size(self%soft) + size(self%lone)
   end function unknowns

   !> Displacement along a direction by unit shifts and the unit turn of a part.
   pure function at_point(self, part, position, direction) result(displacement)
      class(rigid_parts_type), intent(in) :: self
      integer, intent(in) :: part
      real(dp), intent(in) :: position(2)         !! [length]
      real(dp), intent(in) :: direction(2)        !! unit vector
      real(dp) :: displacement(3)
      real(dp) :: arm(2)

      arm = (position - self%middle(:, part))/self%extent(part)
      displacement = [direction, direction(2)*arm(1) - direction(1)*arm(2)]
   end function at_point

   !> The parts of the bodies and their hinges: nodes that several parts have.
   pure subroutine divide(mesh, bodies)
      type(mesh_type), intent(in) :: mesh
      type(rigid_parts_type), intent(inout) :: bodies
      integer :: e, p, q

      bodies%part = mesh%node_body
      allocate (bodies%hinge(2, 0))
      if (.not. allocated(mesh%element_part)) then
         bodies%body = [(p, p=1, mesh%body_count)]
         bodies%first = 0*bodies%body
         return
      end if
      bodies%first = [(findloc(mesh%element_part, p, dim=1), p=1, maxval(mesh%element_part))]
      bodies%body = mesh%element_body(bodies%first)
      bodies%part = 0
      do e = 1, size(mesh%element_part)
         do q = 1, element_node_count(mesh%element_kind(e))
            associate (own => bodies%part(mesh%element_nodes(q, e)), part => mesh%element_part(e))
               if (own == 0) own = part
               if (own == part) cycle
               if (any(bodies%hinge(1, :) == mesh%element_nodes(q, e) .and. &
                  bodies%hinge(2, :) == part)) cycle
               bodies%hinge = reshape([bodies%hinge, mesh%element_nodes(q, e), part], &
                  [2, size(bodies%hinge, 2) + 1])
            end associate
         end do
      end do
   end subroutine divide

   !> The middles and extents of the parts, of which one may have no node that is not a hinge.
   pure subroutine place(mesh, bodies)
      type(mesh_type), intent(in) :: mesh
      type(rigid_parts_type), intent(inout) :: bodies
      integer, allocatable :: nodes(:), parts(:)
      integer :: counts(size(bodies%body)), i

      nodes = [pack([(i, i=1, size(bodies%part))], bodies%part > 0), bodies%hinge(1, :)]
      parts = [pack(bodies%part, bodies%part > 0), bodies%hinge(2, :)]
      allocate (bodies%middle(2, size(bodies%body)), bodies%extent(size(bodies%body)), &
         source=0.0_dp)
      counts = 0
      do i = 1, size(nodes)
         counts(parts(i)) = counts(parts(i)) + 1
         bodies%middle(:, parts(i)) = bodies%middle(:, parts(i)) + mesh%coordinates(:, nodes(i))
      end do
      bodies%middle = bodies%middle/spread(real(counts, dp), 1, 2)
      do i = 1, size(nodes)
         associate (extent => bodies%extent(parts(i)))
            extent = max(extent, norm2(mesh%coordinates(:, nodes(i)) - &
               bodies%middle(:, parts(i))))
         end associate
      end do
   end subroutine place

   !> The hourglass modes of plane parts that are one element with four points for eight nodes.
   pure subroutine find_modes(mesh, bodies)
      type(mesh_type), intent(in) :: mesh
      type(rigid_parts_type), intent(inout) :: bodies
      integer :: elements(size(bodies%body)), e, p
      integer, allocatable :: part(:)

      allocate (bodies%soft(0), bodies%corner(8, 0), bodies%mode(2, 8, 0))
      if (.not. allocated(mesh%element_kind)) return
      part = mesh%element_body
      if (allocated(mesh%element_part)) part = mesh%element_part
      elements = 0
      do e = 1, size(part)
         elements(part(e)) = elements(part(e)) + 1
      end do
      do e = 1, size(part)
         p = part(e)
         if (elements(p) > 1 .or. mesh%element_kind(e) /= quad8_reduced .or. &
            mesh%element_plane(e) == axisymmetric) cycle
         bodies%soft = [bodies%soft, p]
         bodies%corner = reshape([bodies%corner, mesh%element_nodes(:, e)], [8, size(bodies%soft)])
         bodies%mode = reshape([bodies%mode, hourglass(mesh%coordinates(:, &
            mesh%element_nodes(:, e)))], [2, 8, size(bodies%soft)])
      end do
   end subroutine find_modes

   !> Displacements, across the rigid motions, that no integration point of such an element strains
   !> by; the largest one is 1.
   pure function hourglass(coordinates) result(mode)
      real(dp), intent(in) :: coordinates(:, :)   ! (2, 8) [length]
      real(dp) :: mode(2, 8)
      real(dp) :: gradients(2, 8), jacobian, points(2, 4), rows(15, 16), weights(4)
      real(dp), allocatable :: basis(:, :)
      integer :: i

      call integration_rule(quad8_reduced, points, weights)
      rows = 0.0_dp
      associate (extent => maxval(coordinates) - minval(coordinates))
         do i = 1, 4
            call element_gradients(quad8_reduced, coordinates, points(:, i), gradients, jacobian)
            rows(3*i - 2, 1::2) = gradients(1, :)*extent
            rows(3*i - 1, 2::2) = gradients(2, :)*extent
            rows(3*i, 1::2) = gradients(2, :)*extent
            rows(3*i, 2::2) = gradients(1, :)*extent
         end do
         rows(13, 1::2) = 1.0_dp
         rows(14, 2::2) = 1.0_dp
         rows(15, 1::2) = -(coordinates(2, :) - sum(coordinates(2, :))/8)/extent
         rows(15, 2::2) = (coordinates(1, :) - sum(coordinates(1, :))/8)/extent
      end associate
      basis = null_space(rows)
      mode = reshape(basis(:, 1)/maxval(abs(basis(:, 1))), [2, 8])
   end function hourglass

end module rigid_parts
