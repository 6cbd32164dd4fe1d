!> Contact points of faces whose nodes need not match: one at each corner of the slave face that the
!> master lies opposite to. Gap, relative displacement and jump of temperature of a point are the
!> means of slave less master with its hat function (mortar_segments).
module mortar_points
   use chain_geometry, only: arc_lengths, edge_lengths
   use contact_definitions, only: pairing_surfaces
   use contact_points, only: contact_points_type, small_offset
   use edge_segments, only: edge_segments_of, hats_of
   use face_interpolation, only: interpolate_on_faces
   use kinds, only: dp
   use mesh, only: mesh_type
   use mortar_segments, only: integrate_segments, mortar_integrals_type
   use mortar_sides, only: face_line_type, side_type, sides_of
   use sparse_matrix, only: sparse_matrix_type
   use sum_lists, only: sum_list_type
   use surface_chains, only: surface_chain_type
   implicit none
   private
   public :: set_mortar_points

   !> Part of its sides that the master must cover to make a corner a contact point of its own, over
   !> the part of its neighbour's. With less, a sliver of the face would have a multiplier: it goes
   !> to the neighbour, which keeps what the hats sum to. Of a neighbour beside a sliver half is
   !> covered, so the sliver is a tenth of a side: so much finer sides are known to be stable.
   real(dp), parameter :: least_cover = 0.2_dp

   !> Sine of an angle between normals that is rounding of coordinates.
   real(dp), parameter :: no_turn = 1.0e-12_dp

contains

   !> The contact points of two lines of nodes; none where no face of the master is opposite.
   subroutine set_mortar_points(mesh, slave, master, thickness, points)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(in) :: slave   !! from the end with the smaller x on
      type(surface_chain_type), intent(in) :: master
      real(dp), intent(in) :: thickness               !! not used about an axis [length]
      type(contact_points_type), intent(inout) :: points !! its name and its axis are set
      type(mortar_integrals_type) :: integrals
      type(face_line_type) :: slave_line, master_line
      type(side_type), allocatable :: side(:)
      integer, allocatable :: corner(:), owner(:), kept(:), point_of(:)
      integer :: c

      slave_line = line_of(slave)
      master_line = line_of(master)
      side = sides_of(slave_line, master_line)
      call integrate_segments(slave_line, master_line, side, thickness, points%about_axis, &
         integrals)
      corner = slave%nodes(1::slave%side_nodes - 1)
      owner = owners(integrals, slave%closed, [(any(master%nodes == corner(c)), c=1, size(corner))])
      kept = pack([(c, c=1, size(corner))], owner == [(c, c=1, size(corner))])
      point_of = [(findloc(kept, owner(c), dim=1), c=1, size(owner))]
      points%pairing = pairing_surfaces
      points%side_nodes = 2
      points%node_spacings = slave%side_nodes - 1
      points%corners = size(corner)
      points%open_corners = count(owner == 0)
      points%slave_node = corner(kept)
      points%position = integrals%position(:, kept)
      associate (x => mesh%coordinates(:, slave%nodes), n => slave%side_nodes)
         associate (s => arc_lengths(x, n, slave%closed), edge => edge_lengths(x, n, slave%closed))
            points%arc_length = s((n - 1)*(kept - 1) + 1) + integrals%beyond(kept)
            points%edge = edge((n - 1)*(kept - 1) + 1)
         end associate
      end associate
      if (size(kept) > 0) points%arc_length = points%arc_length - points%arc_length(1)
      points%normal = integrals%normal(:, kept)
      points%tangent = slave_line%outward*reshape([-points%normal(2, :), points%normal(1, :)], &
         shape(points%normal), order=[2, 1])
      call set_means(slave, master, integrals, owner, kept, points)
      call set_face_nodes(side, master_line, [slave%nodes, master%nodes], point_of, &
         owner == [(c, c=1, size(owner))], points)
      points%segments = edge_segments_of(side, master_line, [slave%nodes, master%nodes], &
         merge(0.0_dp, thickness, points%about_axis), point_of)
      points%hats = hats_of(points%segments, size(kept))
      points%initial_gap = initial_gaps(points, mesh%coordinates)
      if (size(kept) > 0) call set_ends(mesh%coordinates, slave, master, points)
      allocate (points%master_node, mold=points%slave_node)
      do c = 1, size(kept)
         points%master_node(c) = master%nodes(minloc(norm2(mesh%coordinates(:, master%nodes) - &
            spread(points%position(:, c), 2, size(master%nodes)), dim=1), dim=1))
      end do

   contains
      function line_of(chain) result(line)
         type(surface_chain_type), intent(in) :: chain
         type(face_line_type) :: line

         line = face_line_type(mesh%coordinates(:, chain%nodes), chain%side_nodes, chain%closed, &
            merge(-1.0_dp, 1.0_dp, chain%turned))
      end function line_of
   end subroutine set_mortar_points

   !> How far the master goes on beyond the contact points, and where one face alone ends.
   subroutine set_ends(coordinates, slave, master, points)
      real(dp), intent(in) :: coordinates(:, :)         ! (2, nodes)
      type(surface_chain_type), intent(in) :: slave, master
      type(contact_points_type), intent(inout) :: points

      associate (s => slave%nodes, m => master%nodes)
         if (.not. master%closed) points%to_end = ends_beyond(coordinates(:, m([1, size(m)])), &
            points)
         if (.not. slave%closed) points%at_corner = master%closed .or. ends_apart(coordinates(:, &
            s([1, size(s)])) - coordinates(:, m([1, size(m)])), points)
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
         integer, allocatable :: nodes(:)
         real(dp), allocatable :: share(:)
         integer :: c, i, k

         call sums%reserve(size(kept), size(kept)*2*(slave%side_nodes + master%side_nodes))
         do k = 1, size(kept)
            ! The corner's own node comes first.
            nodes = points%slave_node(k:k)
            share = [0.0_dp]
            do c = 1, size(owner)
               if (owner(c) /= kept(k)) cycle
               do i = 1, size(of_slave)
                  call add_row(of_slave(i), c, slave%nodes, signs(1)*factor(i, k), nodes, share)
                  call add_row(of_master(i), c, master%nodes, signs(2)*factor(i, k), nodes, share)
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
      type(side_type), intent(in) :: side(:)           ! of the slave
      type(face_line_type), intent(in) :: master
      integer, intent(in) :: nodes(:)                  ! of the slave, then of the master
      integer, intent(in) :: point_of(:)               ! (corners) contact point of each; 0 for none
      logical, intent(in) :: own_point(:)              ! (corners) whether it is the corner itself
      type(contact_points_type), intent(inout) :: points
      type(sum_list_type) :: on_face(2)
      integer :: i, k, n

      call interpolate_on_faces(side, master, point_of, own_point, on_face(1), on_face(2))
      allocate (points%face_node(0))
      call points%at_face_nodes%reserve(size(nodes), 2*size(nodes))
      n = 0
      do i = 1, 2
         do k = 1, on_face(i)%count
            associate (terms => on_face(i)%values_of(k))
               if (size(terms) == 0) cycle
               points%face_node = [points%face_node, nodes(n + k)]
               call points%at_face_nodes%add(terms, on_face(i)%coefficients_of(k))
            end associate
         end do
         n = n + on_face(i)%count
      end do
   end subroutine set_face_nodes

   !> How far the first and the last contact point lie from the ends of the master, along the slave;
   !> 0 where they lie beyond it.
   pure function ends_beyond(ends, points) result(distance)
      real(dp), intent(in) :: ends(2, 2)               ! [length]
      type(contact_points_type), intent(in) :: points
      real(dp) :: distance(2)
      integer :: m

      m = size(points%slave_node)
      distance = max(0.0_dp, [dot_product(points%tangent(:, 1), points%position(:, 1) - &
         ends(:, 1)), dot_product(points%tangent(:, m), ends(:, 2) - points%position(:, m))])
   end function ends_beyond

   !> Whether the faces end at different places, as a punch on a wider body.
   pure function ends_apart(apart, points) result(are_apart)
      real(dp), intent(in) :: apart(2, 2)              ! slave's ends less master's [length]
      type(contact_points_type), intent(in) :: points
      logical :: are_apart(2)

      associate (last => [1, size(points%slave_node)])
         are_apart = abs(sum(points%tangent(:, last)*apart, dim=1)) > small_offset* &
            points%edge(last)
      end associate
   end function ends_apart

   !> Mean distance of master and slave along the normals.
   pure function initial_gaps(points, x) result(gap)
      type(contact_points_type), intent(in) :: points
      real(dp), intent(in) :: x(:, :)                  ! (2, nodes) [length]
      real(dp) :: gap(size(points%weight))
      real(dp), dimension(size(points%weight)) :: across_x, across_y, mean_x, mean_y

      mean_x = 0.0_dp
      mean_y = 0.0_dp
      across_x = 0.0_dp
      across_y = 0.0_dp
      if (points%across%count > 0) then
         call points%along%add_totals(x(1, :), mean_x)
         call points%along%add_totals(x(2, :), mean_y)
         call points%across%add_totals(x(1, :), across_x)
         call points%across%add_totals(x(2, :), across_y)
      else
         call points%difference%add_totals(x(1, :), mean_x)
         call points%difference%add_totals(x(2, :), mean_y)
      end if
      gap = -points%normal(1, :)*(mean_x + across_y) - points%normal(2, :)*(mean_y - across_x)
   end function initial_gaps

   !> Adds a multiple of a row of a matrix to a sum of nodal values.
   pure subroutine add_row(matrix, row, node, factor, nodes, share)
      type(sparse_matrix_type), intent(in) :: matrix
      integer, intent(in) :: row, node(:)
      real(dp), intent(in) :: factor
      integer, allocatable, intent(inout) :: nodes(:)
      real(dp), allocatable, intent(inout) :: share(:)
      integer :: i, k

      do k = matrix%row_start(row), matrix%row_start(row + 1) - 1
         i = findloc(nodes, node(matrix%column(k)), dim=1)
         if (i == 0) then
            nodes = [nodes, node(matrix%column(k))]
            share = [share, 0.0_dp]
            i = size(nodes)
         end if
         share(i) = share(i) + factor*matrix%value(k)
      end do
   end subroutine add_row

end module mortar_points
