!> Pairs of opposite nodes of two lines, as in the published method: positions, normals, gaps, arc
!> length, tributary weights.
module node_pairs
   use chain_geometry, only: arc_lengths, at_tips, chain_tangents, edge_lengths, tributary_areas
   use contact_definitions, only: contact_definition_type, pairing_nodes
   use contact_points, only: contact_points_type, no_radius
   use element_kinds, only: element_corner_count
   use errors, only: error_type, set_error, status_deck
   use interface_checks, only: check_sides
   use kinds, only: dp
   use mesh, only: mesh_type
   use sum_lists, only: differences, single_values
   use surface_chains, only: surface_chain_type
   use text, only: to_text
   implicit none
   private
   public :: goes_on, keep_points, set_node_pairs

   real(dp), parameter :: weightless = 0.01_dp   !! part of its neighbour's weight below which the
   !! corner on the axis has none
   !> Angle of a body from which on its outline goes on at a node: it turns away by 45 degrees.
   real(dp), parameter :: going_on = 0.75_dp*acos(-1.0_dp)

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
      integer, allocatable :: kept(:)
      logical :: on_drawing

      points%pairing = pairing_nodes
      on_drawing = allocated(master%tangent)
      points%slave = slave%nodes
      points%master = master%nodes
      call set_weights(mesh, slave, master, thickness, points%about_axis, points%weight)
      first = 1
      last = size(slave%nodes)
      if (slave%nodes(1) == master%nodes(1)) first = 2
      if (slave%nodes(last) == master%nodes(last)) last = last - 1
      call set_geometry(mesh, slave, master, points)
      if (.not. on_drawing) then
         call check_sides(mesh, definition, slave, master, [first, last], error)
         if (allocated(error)) return
      end if
      if (.not. (slave%closed .or. master%closed)) then
         ! One face may end at a corner of its body where the other goes on, as a punch on a wider
         ! body: judged by the outlines beyond the lines.
         associate (s => slave%nodes([1, size(slave%nodes)]), &
            m => master%nodes([1, size(slave%nodes)]))
            points%at_corner = [(goes_on(mesh, s(k)) .neqv. goes_on(mesh, m(k)), k=1, 2)]
         end associate
      end if
      points%side_nodes = slave%side_nodes
      points%edge = edge_lengths(mesh%coordinates(:, slave%nodes), slave%side_nodes, slave%closed)
      kept = [(k, k=first, last)]
      if (on_drawing) kept = pack(kept, norm2(master%tangent(:, kept), dim=1) > 0.0_dp)
      call keep_points(kept, points)
      ! 0 is the weight of a corner on the axis or at the tip of quarter points.
      if (.not. all(points%weight >= 0.0_dp)) then
         call set_error(error, status_deck, definition%title()//': no length of the face '// &
            'belongs to slave node '//to_text(mesh%node_number(points%slave(minloc( &
            points%weight, dim=1))))//'; its midside nodes are too far from the middle')
         return
      end if
      points%difference = differences(points%slave, points%master)
      points%slave_mean = single_values(points%slave)
      points%master_mean = single_values(points%master)
      points%face_node = [points%slave, points%master]
      points%at_face_nodes = single_values([(k, k=1, size(points%slave)), &
         (k, k=1, size(points%master))])
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
      weight = tributary_areas(middle, slave%side_nodes, slave%closed, merge(0.0_dp, thickness, &
         about_axis))
      if (about_axis .and. slave%side_nodes == 3 .and. .not. slave%closed) then
         without(1) = without(1) .or. is_bare(1, 2)
         without(n) = without(n) .or. is_bare(n, n - 1)
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
         points%tangent = chain_tangents(points%position, n, closed)
         if (allocated(master%tangent)) then
            if (points%follows_sliding) points%tangent = 0.0_dp
            points%tangent = points%tangent + master%tangent
         else
            points%tangent = points%tangent + chain_tangents(x(:, master%nodes), n, closed)
         end if
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

   !> Whether the outline of the elements at a corner goes on there.
   pure logical function goes_on(mesh, node)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: node                             !! the corner

      goes_on = body_angle(mesh, node) > going_on
   end function goes_on

   !> Angle that the elements at a corner fill; none at a point of a face that is no node of the
   !> mesh.
   pure real(dp) function body_angle(mesh, node)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: node
      integer :: e, k

      body_angle = 0.0_dp
      if (node > size(mesh%node_body)) return
      do e = 1, size(mesh%element_number)
         if (mesh%element_body(e) /= mesh%node_body(node)) cycle
         associate (n => element_corner_count(mesh%element_kind(e)))
            k = findloc(mesh%element_nodes(:n, e), node, dim=1)
            if (k == 0) cycle
            associate (x => mesh%coordinates(:, mesh%element_nodes(:n, e)))
               associate (leaving => x(:, mod(k, n) + 1) - x(:, k), &
                  entering => x(:, mod(k + n - 2, n) + 1) - x(:, k))
                  body_angle = body_angle + atan2(leaving(1)*entering(2) - &
                     leaving(2)*entering(1), dot_product(leaving, entering))
               end associate
            end associate
         end associate
      end do
   end function body_angle

   !> Keeps some of the contact points.
   pure subroutine keep_points(kept, points)
      integer, intent(in) :: kept(:)
      type(contact_points_type), intent(inout) :: points

      points%slave = points%slave(kept)
      points%master = points%master(kept)
      points%position = points%position(:, kept)
      points%arc_length = points%arc_length(kept)
      points%weight = points%weight(kept)
      points%normal = points%normal(:, kept)
      points%tangent = points%tangent(:, kept)
      points%initial_gap = points%initial_gap(kept)
      points%edge = points%edge(kept)
      if (points%difference%count > 0) points%difference = points%difference%chosen(kept)
   end subroutine keep_points

end module node_pairs
