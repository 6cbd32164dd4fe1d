!> The line of a rigid body as the master of an interface. Its points move with the reference node,
!>
!>    u = u_r + theta (-(y - y_r), x - x_r),   T = T_r,
!>
!> so that contact points are made on nodes that lie on the line as closely as one likes, and then
!> take the values of the reference node and of the node of its rotation in their place.
module rigid_masters
   use chain_geometry, only: chain_tangents
   use contact_definitions, only: contact_definition_type
   use contact_points, only: contact_points_type, no_radius
   use drawn_lines, only: drawn_line_type
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp
   use mesh, only: mesh_type
   use mortar_segments, only: edge_segment_type, hats_of
   use sum_lists, only: sum_list_type
   use surface_chains, only: surface_chain_type
   use text, only: to_text
   implicit none
   private
   public :: add_points, check_facing, follow_reference, opposite_line, sampled_line

contains

   !> A line with midside nodes along the drawing, as master of mortar points.
   pure subroutine sampled_line(drawing, slave, mesh, master)
      type(drawn_line_type), intent(in) :: drawing
      type(surface_chain_type), intent(in) :: slave
      type(mesh_type), intent(inout) :: mesh           !! receives the nodes behind its own
      type(surface_chain_type), intent(out) :: master  !! with its body on the left
      real(dp), allocatable :: x(:, :)

      x = drawing%samples(mesh%coordinates(:, slave%nodes))
      master%side_nodes = 3
      master%closed = drawing%closed
      call add_points(x, mesh, master%nodes)
   end subroutine sampled_line

   !> The points of the drawing that the normals of the slave's nodes meet, as master of node pairs,
   !> with the drawing's tangents, 0 where they meet none. The line goes on there at the distance of
   !> the nearest node with one, so that the weights of pairs do not depend on what it does beside.
   pure subroutine opposite_line(drawing, slave, reach, about_axis, mesh, master)
      type(drawn_line_type), intent(in) :: drawing
      type(surface_chain_type), intent(in) :: slave    !! from its first contact point on
      real(dp), intent(in) :: reach(:)                 !! (n) by how much normals may miss its ends
      logical, intent(in) :: about_axis                !! whether x is a radius
      type(mesh_type), intent(inout) :: mesh           !! receives the nodes behind its own
      type(surface_chain_type), intent(out) :: master  !! runs as the slave does
      real(dp) :: ahead(size(slave%nodes)), beyond, side, t
      real(dp), dimension(2, size(slave%nodes)) :: normal, x
      integer :: k, piece
      logical :: is_met(size(slave%nodes))

      side = merge(-1.0_dp, 1.0_dp, slave%turned)
      normal = chain_tangents(mesh%coordinates(:, slave%nodes), slave%side_nodes, slave%closed)
      normal = side*reshape([normal(2, :), -normal(1, :)], shape(normal), order=[2, 1])
      master%side_nodes = slave%side_nodes
      master%closed = slave%closed
      master%turned = .not. slave%turned
      allocate (master%tangent(2, size(slave%nodes)), source=0.0_dp)
      associate (from => mesh%coordinates(:, slave%nodes))
         do k = 1, size(slave%nodes)
            ! Where a face reaches the axis, its mirror image leans the other way.
            if (about_axis .and. abs(from(1, k)) <= no_radius*maxval(abs(from(1, :)))) then
               normal(:, k) = [0.0_dp, sign(1.0_dp, normal(2, k))]
            end if
            call drawing%find_met(from(:, k), normal(:, k), reach(k), piece, t, ahead(k))
            is_met(k) = piece > 0
            if (is_met(k)) then
               ! The drawing has its body on the left, and so have the faces of the slave: both run
               ! against each other.
               x(:, k) = drawing%point(piece, t)
               master%tangent(:, k) = -side*drawing%mean_tangent(piece, t)
            else
               call drawing%find_nearest(from(:, k), piece, t, x(:, k), beyond)
            end if
         end do
         do k = 1, size(slave%nodes)
            if (is_met(k) .or. .not. any(is_met)) cycle
            x(:, k) = from(:, k) + normal(:, k)*ahead(minloc(norm2(from - spread(from(:, k), 2, &
               size(is_met)), dim=1), dim=1, mask=is_met))
         end do
      end associate
      call add_points(x, mesh, master%nodes)
   end subroutine opposite_line

   !> Adds nodes to a mesh.
   pure subroutine add_points(x, mesh, nodes)
      real(dp), intent(in) :: x(:, :)                  !! (2, n) [length]
      type(mesh_type), intent(inout) :: mesh
      integer, allocatable, intent(out) :: nodes(:)    !! (n) their indexes
      integer :: i, n

      n = size(mesh%node_number)
      mesh%coordinates = reshape([mesh%coordinates, x], [2, n + size(x, 2)])
      mesh%node_number = [mesh%node_number, spread(0, 1, size(x, 2))]
      nodes = [(i, i=n + 1, n + size(x, 2))]
   end subroutine add_points

   !> Refuses a drawing that shows its back to the slave where the two are nearest.
   subroutine check_facing(mesh, definition, drawing, slave, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition
      type(drawn_line_type), intent(in) :: drawing
      type(surface_chain_type), intent(in) :: slave
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: along(2), beyond, foot(2), nearest, t
      integer :: at, k, n, piece

      nearest = huge(nearest)
      at = 1
      n = size(slave%nodes)
      do k = 1, n
         associate (x => mesh%coordinates(:, slave%nodes(k)))
            call drawing%find_nearest(x, piece, t, foot, beyond)
            if (beyond > 0.0_dp .or. norm2(foot - x) >= nearest) cycle
            nearest = norm2(foot - x)
         end associate
         at = k
      end do
      call drawing%find_nearest(mesh%coordinates(:, slave%nodes(at)), piece, t, foot, beyond)
      along = mesh%coordinates(:, slave%nodes(min(at + 1, n))) - &
         mesh%coordinates(:, slave%nodes(max(at - 1, 1)))
      if (slave%turned) along = -along
      if (dot_product(along, drawing%tangent(piece, t)) < 0.0_dp) return
      associate (surface => mesh%surfaces(definition%master))
         call set_error(error, status_deck, definition%title()//': surface '//surface%name// &
            ' shows its back to slave node '//to_text(mesh%node_number(slave%nodes(at)))// &
            ': the outward normal of a rigid surface is on the left of its direction; '// &
            trim(merge('name its other side        ', 'draw it the other way round', &
            allocated(drawing%line))), surface%card)
      end associate
   end subroutine check_facing

   !> Gives contact points made on nodes behind those of a mesh the reference node in their place.
   pure subroutine follow_reference(drawing, last, coordinates, points)
      type(drawn_line_type), intent(in) :: drawing
      integer, intent(in) :: last                      !! node of the mesh
      real(dp), intent(in) :: coordinates(:, :)        !! (2, n) with these nodes [length]
      type(contact_points_type), intent(inout) :: points
      type(sum_list_type) :: along, across
      integer, allocatable :: nodes(:)
      real(dp), allocatable :: straight(:), turned(:)
      real(dp) :: arm(2), turn(2)
      integer :: i, k

      call along%reserve(size(points%slave), 8*size(points%slave))
      call across%reserve(size(points%slave), 8*size(points%slave))
      do k = 1, size(points%slave)
         call points%means_of(k, nodes, straight, turned)
         turn = 0.0_dp
         do i = 1, size(nodes)
            if (nodes(i) <= last) cycle
            arm = coordinates(:, nodes(i)) - coordinates(:, drawing%reference)
            turn = turn + [turned(i)*arm(1) - straight(i)*arm(2), &
               -straight(i)*arm(1) - turned(i)*arm(2)]
         end do
         call along%add([pack(nodes, nodes <= last), drawing%reference, drawing%rotation], &
            [pack(straight, nodes <= last), sum(straight, mask=nodes > last), turn(1)])
         call across%add([pack(nodes, nodes <= last), drawing%reference, drawing%rotation], &
            [pack(turned, nodes <= last), sum(turned, mask=nodes > last), turn(2)])
      end do
      points%along = along
      points%across = across
      points%difference = at_reference(points%difference)
      points%master_mean = at_reference(points%master_mean)
      points%master = drawing%reference
      points%is_rigid = .true.
      associate (kept => points%face_node <= last)
         points%at_face_nodes = points%at_face_nodes%chosen(pack([(k, k=1, size(kept))], kept))
         points%face_node = pack(points%face_node, kept)
      end associate
      if (.not. allocated(points%mortar%segments)) return
      do k = 1, size(points%mortar%segments)
         call join_drawn(drawing%reference, last, points%mortar%segments(k))
      end do
      points%mortar%hats = hats_of(points%mortar%segments, size(points%slave))
   contains
      !> Sums in which the reference node has the values of all nodes of the drawing.
      pure function at_reference(sums) result(kept)
         type(sum_list_type), intent(in) :: sums
         type(sum_list_type) :: kept
         integer :: s

         call kept%reserve(sums%count, size(sums%value))
         do s = 1, sums%count
            associate (nodes => sums%values_of(s), share => sums%coefficients_of(s))
               call kept%add([pack(nodes, nodes <= last), drawing%reference], &
                  [pack(share, nodes <= last), sum(share, mask=nodes > last)])
            end associate
         end do
      end function at_reference
   end subroutine follow_reference

   !> Puts the reference node in the place of all nodes of the drawing in a segment.
   pure subroutine join_drawn(reference, last, segment)
      integer, intent(in) :: reference, last
      type(edge_segment_type), intent(inout) :: segment
      real(dp), allocatable :: difference(:, :)
      integer :: i
      integer, allocatable :: own(:)

      own = pack([(i, i=1, size(segment%nodes))], segment%nodes <= last)
      allocate (difference(size(own) + 1, size(segment%difference, 2)))
      difference(:size(own), :) = segment%difference(own, :)
      difference(size(own) + 1, :) = sum(segment%difference, dim=1) - &
         sum(difference(:size(own), :), dim=1)
      segment%nodes = [segment%nodes(own), reference]
      call move_alloc(difference, segment%difference)
   end subroutine join_drawn

end module rigid_masters
