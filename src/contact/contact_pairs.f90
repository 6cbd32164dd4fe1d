!> Contact node pairs: geometry, normals and tributary lengths, taken once from the undeformed mesh.
module contact_pairs
   use contact_definitions, only: contact_definition_type
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp
   use mesh, only: mesh_type
   use quadrature, only: gauss_point_3, gauss_weight_3
   use shape_functions, only: side_shape, side_slope
   use surface_chains, only: chain_faces
   use text, only: to_text
   implicit none
   private
   public :: contact_pairs_type, make_pairs, never_approached

   real(dp), parameter :: unmoved = 1.0e-9_dp    !! relative change of a gap that is rounding

   !> The pairs of one interface, ordered along the slave from the end with the smaller x (then y).
   type :: contact_pairs_type
      character(:), allocatable :: name        !! name of the *CONTACT PAIR
      integer, allocatable :: slave_node(:)    !! (m) node indexes
      integer, allocatable :: master_node(:)   !! (m) node indexes
      real(dp), allocatable :: position(:, :)  !! (2, m) undeformed slave [length]
      real(dp), allocatable :: arc_length(:)   !! (m) s from the first pair [length]
      real(dp), allocatable :: weight(:)       !! (m) tributary length times thickness [length^2]
      real(dp), allocatable :: normal(:, :)    !! (2, m) common unit normal, outward from the slave
      real(dp), allocatable :: tangent(:, :)   !! (2, m) unit tangent towards growing s
      real(dp), allocatable :: initial_gap(:)  !! (m) h [length]
   end type contact_pairs_type

contains

   !> The pairs of one *CONTACT PAIR: the k-th nodes along its two surfaces.
   !> Errors: surfaces that do not form one open line, unequal numbers of nodes, nodes that are not
   !> opposite.
   subroutine make_pairs(mesh, definition, thickness, pairs, error)
      type(mesh_type), intent(in) :: mesh                     !! the mesh
      type(contact_definition_type), intent(in) :: definition !! the *CONTACT PAIR
      real(dp), intent(in) :: thickness                       !! thickness of the slave [length]
      type(contact_pairs_type), intent(out) :: pairs          !! the pairs
      type(error_type), allocatable, intent(out) :: error     !! see above
      integer, allocatable :: slave(:), master(:)
      logical :: turned

      pairs%name = definition%name
      call chain_faces(mesh, mesh%surfaces(definition%slave), slave, error)
      if (allocated(error)) return
      call chain_faces(mesh, mesh%surfaces(definition%master), master, error)
      if (allocated(error)) return
      if (size(slave) /= size(master)) then
         call set_error(error, status_deck, 'contact pair '//pairs%name//': '// &
            to_text(size(slave))//' slave nodes but '//to_text(size(master))//' master nodes')
         return
      end if
      call start_at_smaller_x(mesh, slave, turned)
      associate (x => mesh%coordinates)
         if (norm2(x(:, master(1)) - x(:, slave(1))) > &
            norm2(x(:, master(size(master))) - x(:, slave(1)))) master = master(size(master):1:-1)
         pairs%slave_node = slave
         pairs%master_node = master
         pairs%position = x(:, slave)
         pairs%arc_length = arc_lengths(x(:, slave))
         pairs%weight = thickness*tributary_lengths(0.5_dp*(x(:, slave) + x(:, master)))
         pairs%tangent = face_tangents(x(:, slave)) + face_tangents(x(:, master))
         call set_directions(turned, pairs)
         pairs%initial_gap = sum((x(:, master) - x(:, slave))*pairs%normal, dim=1)
      end associate
      if (any(pairs%weight <= 0.0_dp)) then
         call set_error(error, status_deck, 'contact pair '//pairs%name// &
            ': no length of the face belongs to slave node '// &
            to_text(mesh%node_number(slave(minloc(pairs%weight, dim=1))))// &
            '; its midside nodes are too far from the middle')
         return
      end if
      call check_opposite(mesh, pairs, error)
   end subroutine make_pairs

   !> Whether a pair neither closed nor came nearer than it was.
   elemental function never_approached(initial_gap, smallest_gap) result(never)
      real(dp), intent(in) :: initial_gap    !! h [length]
      real(dp), intent(in) :: smallest_gap   !! smallest gap of all increments [length]
      logical :: never                       !! to be reported

      never = smallest_gap > 0.0_dp .and. smallest_gap >= initial_gap*(1.0_dp - unmoved)
   end function never_approached

   !> Turns a line of nodes so that it starts at the end with the smaller x, then y.
   subroutine start_at_smaller_x(mesh, nodes, turned)
      type(mesh_type), intent(in) :: mesh
      integer, intent(inout) :: nodes(:)
      logical, intent(out) :: turned
      real(dp) :: first(2), last(2)

      first = mesh%coordinates(:, nodes(1))
      last = mesh%coordinates(:, nodes(size(nodes)))
      turned = last(1) < first(1) .or. (last(1) <= first(1) .and. last(2) < first(2))
      if (turned) nodes = nodes(size(nodes):1:-1)
   end subroutine start_at_smaller_x

   !> Unit tangents and normals from the summed tangents of both faces. An unturned line has the
   !> slave on its left.
   subroutine set_directions(turned, pairs)
      logical, intent(in) :: turned
      type(contact_pairs_type), intent(inout) :: pairs
      real(dp) :: side
      integer :: k

      side = merge(-1.0_dp, 1.0_dp, turned)
      allocate (pairs%normal, mold=pairs%tangent)
      do k = 1, size(pairs%slave_node)
         pairs%tangent(:, k) = pairs%tangent(:, k)/norm2(pairs%tangent(:, k))
         pairs%normal(:, k) = side*[pairs%tangent(2, k), -pairs%tangent(1, k)]
      end do
   end subroutine set_directions

   !> Arc length of each node along a line of three-node sides, from the first.
   pure function arc_lengths(x) result(s)
      real(dp), intent(in) :: x(:, :)
      real(dp) :: s(size(x, 2))
      real(dp) :: mid, half(2)
      integer :: first, g, part

      s(1) = 0.0_dp
      do first = 1, size(x, 2) - 2, 2
         half = 0.0_dp
         do part = 1, 2
            mid = part - 1.5_dp
            do g = 1, 3
               half(part) = half(part) + 0.5_dp*gauss_weight_3(g)* &
                  norm2(matmul(x(:, first:first + 2), side_slope(3, mid + 0.5_dp*gauss_point_3(g))))
            end do
         end do
         s(first + 1) = s(first) + half(1)
         s(first + 2) = s(first + 1) + half(2)
      end do
   end function arc_lengths

   !> Integral of each node's shape function along a line of three-node sides. A constant pressure
   !> so has constant nodal force over weight, which is what makes the lumped recovery pass the
   !> patch test.
   pure function tributary_lengths(x) result(weight)
      real(dp), intent(in) :: x(:, :)
      real(dp) :: weight(size(x, 2))
      integer :: first, g

      weight = 0.0_dp
      do first = 1, size(x, 2) - 2, 2
         do g = 1, 3
            weight(first:first + 2) = weight(first:first + 2) + gauss_weight_3(g)* &
               side_shape(3, gauss_point_3(g))* &
               norm2(matmul(x(:, first:first + 2), side_slope(3, gauss_point_3(g))))
         end do
      end do
   end function tributary_lengths

   !> Unit tangents at the nodes of a line of three-node sides; at a shared corner the direction
   !> midway.
   pure function face_tangents(x) result(tangent)
      real(dp), intent(in) :: x(:, :)
      real(dp) :: tangent(2, size(x, 2))
      real(dp) :: along(2)
      integer :: first, node

      tangent = 0.0_dp
      do first = 1, size(x, 2) - 2, 2
         do node = 0, 2
            along = matmul(x(:, first:first + 2), side_slope(3, node - 1.0_dp))
            tangent(:, first + node) = tangent(:, first + node) + along/norm2(along)
         end do
      end do
      do node = 1, size(x, 2)
         tangent(:, node) = tangent(:, node)/norm2(tangent(:, node))
      end do
   end function face_tangents

   !> Refuses a pair whose tangential offset exceeds both half the local element edge and half its
   !> gap.
   subroutine check_opposite(mesh, pairs, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_pairs_type), intent(in) :: pairs
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: offset, edge
      integer :: first, k, m

      m = size(pairs%slave_node)
      do k = 1, m
         first = min(2*((k - 1)/2) + 1, m - 2)
         edge = pairs%arc_length(first + 2) - pairs%arc_length(first)
         offset = abs(dot_product(pairs%tangent(:, k), &
            mesh%coordinates(:, pairs%master_node(k)) - pairs%position(:, k)))
         if (offset > 0.5_dp*max(edge, abs(pairs%initial_gap(k)))) then
            call set_error(error, status_deck, 'contact pair '//pairs%name//': slave node '// &
               to_text(mesh%node_number(pairs%slave_node(k)))//' and master node '// &
               to_text(mesh%node_number(pairs%master_node(k)))// &
               ' are not opposite each other; mesh both surfaces with nodes that face')
            return
         end if
      end do
   end subroutine check_opposite

end module contact_pairs
