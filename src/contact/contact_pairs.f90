!> Contact points that are pairs of opposite nodes, as in the published method.
module contact_pairs
   use chain_geometry, only: arc_lengths, at_tips, chain_tangents, edge_lengths, &
      tributary_lengths, swept_areas
   use contact_definitions, only: contact_definition_type, pairing_nodes
   use contact_points, only: contact_points_type, no_radius
   use errors, only: error_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use interface_checks, only: check_sides, check_weights
   use sum_lists, only: differences, single_values
   use surface_chains, only: surface_chain_type
   implicit none
   private
   public :: set_node_pairs

   real(dp), parameter :: weightless = 0.01_dp   !! part of its neighbour's weight below which the
   !! corner on the axis has none

contains

   !> The contact points of two lines with equally many nodes: the k-th nodes along both. A node
   !> that both lines end in, the tip of a crack, is none.
   !> Errors: nodes that are not opposite, bodies on the wrong side, sides without tributary length.
   subroutine set_node_pairs(mesh, definition, slave, master, thickness, points, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition !! the *CONTACT PAIR
      type(surface_chain_type), intent(in) :: slave, master   !! both from the slave's first node on
      real(dp), intent(in) :: thickness !! thickness of the slave, not used if axisymmetric [length]
      type(contact_points_type), intent(inout) :: points      !! its name and its axis are set
      type(error_type), allocatable, intent(out) :: error
      integer :: first, k, last

      points%pairing = pairing_nodes
      points%slave_node = slave%nodes
      points%master_node = master%nodes
      call set_weights(mesh, slave, master, thickness, points%about_axis, points%weight)
      first = 1
      last = size(slave%nodes)
      if (slave%nodes(1) == master%nodes(1)) first = 2
      if (slave%nodes(last) == master%nodes(last)) last = last - 1
      call set_geometry(mesh, slave, master, points)
      call check_sides(mesh, definition, slave, master, [first, last], error)
      if (allocated(error)) return
      points%side_nodes = slave%side_nodes
      points%edge = edge_lengths(mesh%coordinates(:, slave%nodes), slave%side_nodes, slave%closed)
      call cut_ends(first, last, points)
      call check_weights(mesh, definition%title(), points%slave_node, points%weight, error)
      if (allocated(error)) return
      points%difference = differences(points%slave_node, points%master_node)
      points%slave_mean = single_values(points%slave_node)
      points%master_mean = single_values(points%master_node)
      points%face_node = [points%slave_node, points%master_node]
      points%at_face_nodes = single_values([(k, k=1, size(points%slave_node)), &
         (k, k=1, size(points%master_node))])
   end subroutine set_node_pairs

   !> Weights on the line midway between the faces. On three-node sides the integral vanishes for a
   !> corner on the axis but for the curvature of the side, and at the tip of quarter points but for
   !> the radius; what these leave goes to the neighbours.
   subroutine set_weights(mesh, slave, master, thickness, about_axis, weight)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(in) :: slave, master
      real(dp), intent(in) :: thickness
      logical, intent(in) :: about_axis
      real(dp), allocatable, intent(out) :: weight(:)
      real(dp) :: middle(2, size(slave%nodes))
      logical :: without(size(slave%nodes))
      integer :: k, n
      integer, allocatable :: beside(:)

      n = size(slave%nodes)
      middle = 0.5_dp*(mesh%coordinates(:, slave%nodes) + mesh%coordinates(:, master%nodes))
      without = at_tips(middle, slave%side_nodes, slave%closed)
      if (about_axis) then
         weight = swept_areas(middle, slave%side_nodes, slave%closed)
         if (slave%side_nodes == 3 .and. .not. slave%closed) then
            without(1) = without(1) .or. is_bare(1, 2)
            without(n) = without(n) .or. is_bare(n, n - 1)
         end if
      else
         weight = thickness*tributary_lengths(middle, slave%side_nodes, slave%closed)
      end if
      do k = 1, n
         if (.not. without(k)) cycle
         beside = modulo([k - 1, k + 1] - 1, n) + 1
         if (.not. slave%closed) beside = pack(beside, abs(beside - k) == 1)
         weight(beside) = weight(beside) + weight(k)/size(beside)
         weight(k) = 0.0_dp
      end do
   contains
      pure logical function is_bare(corner, neighbour)
         integer, intent(in) :: corner, neighbour

         is_bare = maxval(abs(mesh%coordinates(1, [slave%nodes(corner), master%nodes(corner)]))) &
            <= no_radius*maxval(abs(middle(1, :))) .and. &
            abs(weight(corner)) < weightless*abs(weight(neighbour))
      end function is_bare
   end subroutine set_weights

   !> Positions, arc length, common tangents and normals, and gaps. An unturned line has its body on
   !> the left.
   subroutine set_geometry(mesh, slave, master, points)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(in) :: slave, master
      type(contact_points_type), intent(inout) :: points
      real(dp) :: side
      integer :: k

      associate (x => mesh%coordinates, n => slave%side_nodes, closed => slave%closed)
         points%position = x(:, slave%nodes)
         points%arc_length = arc_lengths(points%position, n, closed)
         points%tangent = chain_tangents(points%position, n, closed) + &
            chain_tangents(x(:, master%nodes), n, closed)
         side = merge(-1.0_dp, 1.0_dp, slave%turned)
         allocate (points%normal, mold=points%tangent)
         do k = 1, size(slave%nodes)
            points%tangent(:, k) = points%tangent(:, k)/max(norm2(points%tangent(:, k)), &
               tiny(1.0_dp))
            points%normal(:, k) = side*[points%tangent(2, k), -points%tangent(1, k)]
         end do
         points%initial_gap = sum((x(:, master%nodes) - points%position)*points%normal, dim=1)
      end associate
   end subroutine set_geometry

   !> Keeps the contact points first..last; s begins there.
   pure subroutine cut_ends(first, last, points)
      integer, intent(in) :: first, last
      type(contact_points_type), intent(inout) :: points

      points%slave_node = points%slave_node(first:last)
      points%master_node = points%master_node(first:last)
      points%position = points%position(:, first:last)
      points%arc_length = points%arc_length(first:last) - points%arc_length(first)
      points%weight = points%weight(first:last)
      points%normal = points%normal(:, first:last)
      points%tangent = points%tangent(:, first:last)
      points%initial_gap = points%initial_gap(first:last)
      points%edge = points%edge(first:last)
   end subroutine cut_ends

end module contact_pairs
