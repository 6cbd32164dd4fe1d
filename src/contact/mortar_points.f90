!> Contact points of faces whose nodes need not match: one at each corner of the slave face that the
!> master lies opposite to. Gap, relative displacement and jump of temperature of a point are the
!> means of slave less master with its hat function (mortar_segments).
module mortar_points
   use chain_geometry, only: arc_lengths, chord_depth, edge_lengths, side_positions
   use contact_definitions, only: pairing_surfaces
   use contact_points, only: contact_points_type, small_offset
   use hidden_segments, only: hide_segments
   use mortar_segments, only: edge_segments_of, hats_of, integrate_segments, mortar_integrals_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use mortar_sides, only: beside_line, face_line_type, hats, line_of, opposite_at, &
      opposite_coordinate, slave_side_type, sides_of
   use sparse_matrix, only: sparse_matrix_type
   use sum_lists, only: add_terms, sum_list_type
   use surface_chains, only: surface_chain_type
   implicit none
   private
   public :: other_chains_type, set_mortar_points

   !> Part of its sides that the master must cover to make a corner a contact point of its own, over
   !> the part of its neighbour's. With less, a sliver of the face would have a multiplier: it goes
   !> to the neighbour, which keeps what the hats sum to. Of a neighbour beside a sliver half is
   !> covered, so the sliver is a tenth of a side: so much finer sides are known to be stable.
   real(dp), parameter :: least_cover = 0.2_dp

   !> Sine of an angle between normals that is rounding of coordinates.
   real(dp), parameter :: no_turn = 1.0e-12_dp
   !> Step along a side's coordinate to either side of a node: at a node itself two sides meet.
   real(dp), parameter :: aside = 1.0e-6_dp
   real(dp), parameter :: on_normal = 1.0e-9_dp   !! part of a side's length that is rounding

   !> Lines of the surfaces of an interface beside the two whose contact points are made.
   type :: other_chains_type
      type(surface_chain_type), allocatable :: slaves(:), masters(:)
   end type other_chains_type

contains

   !> The contact points of two lines of nodes; none where no face of the master is opposite, or
   !> another line hides it.
   subroutine set_mortar_points(mesh, slave, master, others, thickness, points)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(in) :: slave   !! from the end with the smaller x on
      type(surface_chain_type), intent(in) :: master
      type(other_chains_type), intent(in) :: others   !! lines beside these two
      real(dp), intent(in) :: thickness               !! not used about an axis [length]
      type(contact_points_type), intent(inout) :: points !! its name, axis and sliding are set
      type(mortar_integrals_type) :: integrals
      type(face_line_type) :: slave_line, master_line
      type(slave_side_type), allocatable :: side(:)
      integer, allocatable :: corner(:), owner(:), kept(:), point_of(:)
      integer :: c

      slave_line = line_of(mesh, slave)
      master_line = line_of(mesh, master)
      master_line%leads = points%follows_sliding
      side = sides_of(slave_line, master_line)
      do c = 1, size(others%masters)
         call hide_segments(side, master_line, line_of(mesh, others%masters(c)), .true.)
      end do
      do c = 1, size(others%slaves)
         call hide_segments(side, master_line, line_of(mesh, others%slaves(c)), .false.)
      end do
      call integrate_segments(slave_line, master_line, side, thickness, points%about_axis, &
         integrals)
      corner = slave%nodes(1::slave%side_nodes - 1)
      owner = owners(integrals, slave%closed, [(any(master%nodes == corner(c)), c=1, size(corner))])
      kept = pack([(c, c=1, size(corner))], owner == [(c, c=1, size(corner))])
      point_of = [(findloc(kept, owner(c), dim=1), c=1, size(owner))]
      points%pairing = pairing_surfaces
      points%side_nodes = 2
      points%node_spacings = slave%side_nodes - 1
      points%finest_gap = max(depth_of(slave), depth_of(master))
      points%is_open_corner = owner == 0
      points%slave = corner(kept)
      points%position = integrals%position(:, kept)
      associate (x => mesh%coordinates(:, slave%nodes), n => slave%side_nodes)
         associate (s => arc_lengths(x, n, slave%closed), edge => edge_lengths(x, n, slave%closed))
            points%arc_length = s((n - 1)*(kept - 1) + 1) + integrals%beyond(kept)
            points%edge = edge((n - 1)*(kept - 1) + 1)
         end associate
      end associate
      points%normal = integrals%normal(:, kept)
      points%tangent = slave_line%outward*reshape([-points%normal(2, :), points%normal(1, :)], &
         shape(points%normal), order=[2, 1])
      call set_means(slave, master, integrals, owner, kept, points)
      call set_face_nodes(side, master_line, [slave%nodes, master%nodes], point_of, &
         owner == [(c, c=1, size(owner))], points)
      points%mortar%segments = edge_segments_of(side, master_line, [slave%nodes, master%nodes], &
         merge(0.0_dp, thickness, points%about_axis), point_of)
      points%mortar%hats = hats_of(points%mortar%segments, size(kept))
      points%initial_gap = [(mean_gap(mesh%coordinates, points, c), c=1, size(kept))]
      if (size(kept) > 0) call set_ends(mesh%coordinates, slave, master, points)
      allocate (points%master, mold=points%slave)
      do c = 1, size(kept)
         points%master(c) = master%nodes(minloc(norm2(mesh%coordinates(:, master%nodes) - &
            spread(points%position(:, c), 2, size(master%nodes)), dim=1), dim=1))
      end do
   contains
      real(dp) function depth_of(chain)
         type(surface_chain_type), intent(in) :: chain

         depth_of = chord_depth(mesh%coordinates(:, chain%nodes), chain%side_nodes, chain%closed)
      end function depth_of
   end subroutine set_mortar_points

   !> Mean distance of the master along the normal. From the contact point on, because the rounding
   !> of coefficients is that of what they are multiplied by.
   pure real(dp) function mean_gap(x, points, k)
      real(dp), intent(in) :: x(:, :)                  ! (2, nodes) [length]
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: k
      integer, allocatable :: nodes(:)
      real(dp), allocatable :: across(:), along(:), from(:, :)

      call points%means_of(k, nodes, along, across)
      from = x(:, nodes) - spread(points%position(:, k), 2, size(nodes))
      mean_gap = -dot_product(points%normal(:, k), matmul(from, along) + &
         [dot_product(across, from(2, :)), -dot_product(across, from(1, :))])
   end function mean_gap

   !> Whether the faces end at different places, as a punch on a wider body.
   subroutine set_ends(coordinates, slave, master, points)
      real(dp), intent(in) :: coordinates(:, :)         ! (2, nodes)
      type(surface_chain_type), intent(in) :: slave, master
      type(contact_points_type), intent(inout) :: points
      real(dp), dimension(2, 2) :: tangent, ends

      associate (last => [1, size(points%slave)], s => slave%nodes, m => master%nodes)
         tangent = points%tangent(:, last)
         ends = coordinates(:, m([1, size(m)]))
         if (.not. slave%closed) points%at_corner = master%closed .or. abs(sum(tangent* &
            (coordinates(:, s([1, size(s)])) - ends), dim=1)) > small_offset*points%edge(last)
      end associate
   end subroutine set_ends

   !> The corner whose contact point takes a corner's integrals, its own or the neighbour with the
   !> larger part covered; 0 where nothing is covered. A corner that both faces end in, the tip of a
   !> crack, is no contact point.
   pure function owners(integrals, closed, is_tip) result(owner)
      type(mortar_integrals_type), intent(in) :: integrals
      logical, intent(in) :: closed
      logical, intent(in) :: is_tip(:)                 ! (corners)
      integer :: owner(size(is_tip))
      real(dp) :: cover(size(is_tip))
      integer :: beside(2), c, n

      n = size(is_tip)
      cover = 0.0_dp
      where (integrals%weight > 0.0_dp) cover = integrals%weight/integrals%whole
      where (is_tip) cover = 0.5_dp*least_cover*cover
      owner = [(c, c=1, n)]
      where (cover <= 0.0_dp) owner = 0
      do c = 1, n
         if (owner(c) /= c) cycle
         beside = modulo([c - 2, c], n) + 1
         if (.not. closed) beside = min(max([c - 1, c + 1], 1), n)
         if (cover(beside(1)) >= cover(beside(2))) beside = beside([2, 1])
         if (cover(c) >= least_cover*cover(beside(2))) cycle
         if (owner(beside(2)) == beside(2) .and. beside(2) /= c) owner(c) = beside(2)
      end do
   end function owners

   !> Weights, and what each contact point takes of the nodes: the integrals of the corners it owns.
   pure subroutine set_means(slave, master, integrals, owner, kept, points)
      type(surface_chain_type), intent(in) :: slave, master
      type(mortar_integrals_type), intent(in) :: integrals
      integer, intent(in) :: owner(:), kept(:)
      type(contact_points_type), intent(inout) :: points
      integer :: k

      points%weight = [(sum(integrals%weight, mask=owner == kept(k)), k=1, size(kept))]
      associate (one => reshape([(1.0_dp, k=1, size(kept))], [1, size(kept)]))
         points%difference = means([integrals%slave], [integrals%master], one, [1, -1], 0.0_dp)
         points%slave_mean = means([integrals%slave], [integrals%master], one, [1, 0], 0.0_dp)
         points%master_mean = means([integrals%slave], [integrals%master], one, [0, 1], 0.0_dp)
      end associate
      associate (n => points%normal, of_slave => integrals%slave_normal, &
         of_master => integrals%master_normal)
         points%across = means(of_slave, of_master, reshape([-n(2, :), n(1, :)], shape(n), &
            order=[2, 1]), [1, -1], no_turn)
         if (points%across%start(size(kept) + 1) > 1) then
            points%along = means(of_slave, of_master, n, [1, -1], 0.0_dp)
         else
            points%across = sum_list_type()
         end if
      end associate

   contains
      !> Means over slave and master, each with a sign or left out, in one sum; of several integrals
      !> the sum with a factor for each contact point.
      pure function means(of_slave, of_master, factor, signs, least) result(sums)
         type(sparse_matrix_type), intent(in) :: of_slave(:), of_master(:)
         real(dp), intent(in) :: factor(:, :)          ! (several, contact points)
         integer, intent(in) :: signs(2)               ! of slave and master: 1, 0 or -1
         real(dp), intent(in) :: least                 ! coefficient that is not rounding
         type(sum_list_type) :: sums
         real(dp), allocatable :: share(:)
         integer, allocatable :: nodes(:)
         integer :: c, i, k

         call sums%reserve(size(kept), size(kept)*2*(slave%side_nodes + master%side_nodes))
         do k = 1, size(kept)
            ! The corner's own node comes first.
            nodes = points%slave(k:k)
            share = [0.0_dp]
            do c = 1, size(owner)
               if (owner(c) /= kept(k)) cycle
               do i = 1, size(of_slave)
                  if (signs(1) /= 0) call add_row(of_slave(i), c, slave%nodes, &
                     signs(1)*factor(i, k), nodes, share)
                  if (signs(2) /= 0) call add_row(of_master(i), c, master%nodes, &
                     signs(2)*factor(i, k), nodes, share)
               end do
            end do
            share = share/points%weight(k)
            where (abs(share) <= least) share = 0.0_dp
            call sums%add(nodes, share)
         end do
      end function means
   end subroutine set_means

   !> The nodes of both faces that carry contact quantities.
   pure subroutine set_face_nodes(side, master, nodes, point_of, own_point, points)
      type(slave_side_type), intent(in) :: side(:)           ! of the slave
      type(face_line_type), intent(in) :: master
      integer, intent(in) :: nodes(:)                  ! of the slave, then of the master
      integer, intent(in) :: point_of(:)               ! (corners) contact point of each; 0 for none
      logical, intent(in) :: own_point(:)              ! (corners) whether it is the corner itself
      type(contact_points_type), intent(inout) :: points
      type(sum_list_type) :: on_face(2)
      integer :: carrying(size(nodes)), i, k, n

      call interpolate_on_faces(side, master, point_of, own_point, on_face(1), on_face(2))
      call points%at_face_nodes%reserve(size(nodes), 2*size(nodes))
      n = 0
      do i = 1, 2
         do k = 1, on_face(i)%count
            associate (terms => on_face(i)%values_of(k))
               if (size(terms) == 0) cycle
               call points%at_face_nodes%add(terms, on_face(i)%coefficients_of(k))
               carrying(points%at_face_nodes%count) = nodes(n + k)
            end associate
         end do
         n = n + on_face(i)%count
      end do
      points%face_node = carrying(:points%at_face_nodes%count)
   end subroutine set_face_nodes

   !> Adds a multiple of a row of a matrix to a sum of nodal values.
   pure subroutine add_row(matrix, row, node, factor, nodes, share)
      type(sparse_matrix_type), intent(in) :: matrix
      integer, intent(in) :: row, node(:)
      real(dp), intent(in) :: factor
      integer, allocatable, intent(inout) :: nodes(:)
      real(dp), allocatable, intent(inout) :: share(:)

      associate (first => matrix%row_start(row), last => matrix%row_start(row + 1) - 1)
         call add_terms(node(matrix%column(first:last)), factor*matrix%value(first:last), nodes, &
            share)
      end associate
   end subroutine add_row

   !> Sums over the contact points that give each node of both faces its contact quantities: linear
   !> along each side of the slave, as the multipliers are; at a node of the master those of the
   !> slave's point whose normal meets it. Without terms where the node is outside the covered part.
   pure subroutine interpolate_on_faces(side, master, point_of, own_point, on_slave, on_master)
      type(slave_side_type), intent(in) :: side(:)  ! of the slave
      type(face_line_type), intent(in) :: master
      integer, intent(in) :: point_of(:)      ! (corners) contact point of each; 0 for none
      logical, intent(in) :: own_point(:)     ! (corners) whether the point is the corner itself
      type(sum_list_type), intent(out) :: on_slave    ! (nodes of the slave, contact points)
      type(sum_list_type), intent(out) :: on_master   ! (nodes of the master, contact points)
      real(dp) :: xi
      logical :: is_own
      integer :: k, nodes, per_side, s

      per_side = size(side(1)%nodes) - 1
      nodes = maxval(side(size(side))%nodes)
      call on_slave%reserve(nodes, 2*nodes)
      do k = 1, nodes
         s = min((k - 1)/per_side + 1, size(side))
         xi = 2.0_dp*(k - 1 - (s - 1)*per_side)/per_side - 1.0_dp
         is_own = modulo(k - 1, per_side) == 0
         if (is_own) is_own = own_point((k - 1)/per_side + 1)
         if (.not. is_own) s = merge(s, 0, is_covered(k))
         call add_node(side, s, xi, point_of, on_slave)
      end do
      call on_master%reserve(size(master%x, 2), 2*size(master%x, 2))
      do k = 1, size(master%x, 2)
         call find_opposite(side, master, k, s, xi)
         call add_node(side, s, xi, point_of, on_master)
      end do

   contains
      !> Whether the master lies opposite a node of the slave or beside it.
      pure logical function is_covered(node)
         integer, intent(in) :: node
         integer :: i

         is_covered = .false.
         do i = 1, size(side)
            if (all(side(i)%nodes /= node)) cycle
            associate (at => 2.0_dp*(findloc(side(i)%nodes, node, dim=1) - 1)/per_side - 1.0_dp)
               is_covered = is_covered .or. opposite_at(side(i), max(at - aside, -1.0_dp)) > 0 &
                  .or. opposite_at(side(i), min(at + aside, 1.0_dp)) > 0
            end associate
         end do
      end function is_covered
   end subroutine interpolate_on_faces

   !> Adds the sum of a point of the slave: the values of the corners of its side, by their hats.
   pure subroutine add_node(side, s, xi, point_of, sums)
      type(slave_side_type), intent(in) :: side(:)
      integer, intent(in) :: s                ! side, 0 for none
      real(dp), intent(in) :: xi
      integer, intent(in) :: point_of(:)
      type(sum_list_type), intent(inout) :: sums
      integer :: points(2)
      real(dp) :: hat(2)

      points = 0
      if (s > 0) points = point_of(side(s)%corners)
      hat = 0.5_dp*[1.0_dp - xi, 1.0_dp + xi]
      if (s > 0) then
         if (side(s)%covered(1) < side(s)%covered(2)) hat = hats(side(s), xi)
      end if
      if (s == 0 .or. any(points == 0 .and. abs(hat) > 0.0_dp)) then
         call sums%add([integer ::], [real(dp) ::])
      else if (points(1) == points(2)) then
         call sums%add(points(:1), [1.0_dp])
      else
         call sums%add(points, hat)
      end if
   end subroutine add_node

   !> The point of the slave opposite a node of the master: the nearest one whose normal meets it
   !> and sees it; side 0 where there is none.
   pure subroutine find_opposite(side, master, node, s, xi)
      type(slave_side_type), intent(in) :: side(:)
      type(face_line_type), intent(in) :: master
      integer, intent(in) :: node             ! position along the master's line
      integer, intent(out) :: s
      real(dp), intent(out) :: xi
      real(dp) :: apart, at, ends(2), nearest
      integer :: i

      s = 0
      xi = 0.0_dp
      nearest = huge(nearest)
      do i = 1, size(side)
         associate (x => master%x(:, node), n => size(side(i)%nodes))
            ends = [beside_line(side(i)%normal(:, 1), side(i)%x(:, 1), master%x(:, node:node)), &
               beside_line(side(i)%normal(:, n), side(i)%x(:, n), master%x(:, node:node))]
            where (abs(ends) <= on_normal*norm2(side(i)%x(:, n) - side(i)%x(:, 1))) ends = 0.0_dp
            if (abs(ends(1)) <= 0.0_dp) then
               at = -1.0_dp
            else if (abs(ends(2)) <= 0.0_dp) then
               at = 1.0_dp
            else if (ends(1)*ends(2) < 0.0_dp) then
               at = opposite_coordinate(side(i), master%x(:, node:node), ends)
            else
               cycle
            end if
            apart = norm2(x - side(i)%x(:, merge(1, n, at < 0.0_dp)))
         end associate
         if (apart >= nearest) cycle
         if (.not. (sees(max(at - aside, -1.0_dp)) .or. sees(min(at + aside, 1.0_dp)))) cycle
         nearest = apart
         s = i
         xi = at
      end do

   contains
      !> Whether a side of the master that has the node lies opposite.
      pure logical function sees(from)
         real(dp), intent(in) :: from
         integer :: opposite

         opposite = opposite_at(side(i), from)
         sees = .false.
         if (opposite > 0) sees = any(side_positions(opposite, master%side_nodes, &
            size(master%x, 2)) == node)
      end function sees
   end subroutine find_opposite

end module mortar_points
