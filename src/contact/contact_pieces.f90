!> The contact points of an interface from those of its pieces, each between one line of the slave
!> and one of the master.
module contact_pieces
   use chain_geometry, only: arc_lengths
   use contact_definitions, only: contact_definition_type
   use contact_points, only: contact_points_type, join_rows
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp
   use mesh, only: mesh_type
   use mortar_segments, only: hats_of
   use surface_chains, only: surface_chain_type
   use text, only: to_text
   implicit none
   private
   public :: join_pieces, line_starts

   !> Part of the length of the face by which the ends of pieces beside each other are rounding.
   real(dp), parameter :: rounding = 1.0e-9_dp

contains

   !> Puts the pieces that have contact points one behind the other, along the lines of the slave.
   !> Error: pieces that lie between the contact points of another one.
   subroutine join_pieces(mesh, definition, slaves, line, pieces, points, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition
      type(surface_chain_type), intent(in) :: slaves(:)       !! lines of the slave
      integer, intent(in) :: line(:)                          !! (pieces) that of each, ascending
      type(contact_points_type), intent(inout) :: pieces(:)   !! s along their lines
      type(contact_points_type), intent(out) :: points
      type(error_type), allocatable, intent(out) :: error
      type(contact_points_type), allocatable :: sorted(:)
      integer, allocatable :: order(:)
      real(dp) :: start(size(slaves))
      integer :: k

      start = line_starts(mesh, slaves)
      do k = 1, size(line)
         if (line(k) > 1) pieces(k)%arc_length = pieces(k)%arc_length + start(line(k))
      end do
      call sort_pieces(line, pieces, order)
      sorted = pieces(order)
      call check_order(mesh, definition, sorted, error)
      if (allocated(error)) return
      points = sorted(1)
      if (size(order) > 1) call add_pieces(sorted, points)
      points%arc_length = points%arc_length - points%arc_length(1)
      if (allocated(points%is_open_corner)) points%is_open_corner = open_corners(line, pieces)
   end subroutine join_pieces

   !> Where s begins on each line: it goes on from one to the next, straight on between them.
   function line_starts(mesh, lines) result(start)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(in) :: lines(:)
      real(dp) :: start(size(lines))                          !! [length]
      integer :: i

      start(:1) = 0.0_dp
      do i = 2, size(lines)
         associate (before => mesh%coordinates(:, lines(i - 1)%nodes), &
            first => mesh%coordinates(:, lines(i)%nodes(1)))
            associate (s => arc_lengths(before, lines(i - 1)%side_nodes, lines(i - 1)%closed))
               start(i) = start(i - 1) + s(size(s)) + norm2(first - before(:, size(s)))
            end associate
         end associate
      end do
   end function line_starts

   !> The pieces with contact points, along each line of the slave.
   pure subroutine sort_pieces(line, pieces, order)
      integer, intent(in) :: line(:)
      type(contact_points_type), intent(in) :: pieces(:)
      integer, allocatable, intent(out) :: order(:)
      integer :: i, k

      order = pack([(k, k=1, size(pieces))], [(size(pieces(k)%slave) > 0, k=1, size(pieces))])
      do i = 2, size(order)
         do k = i, 2, -1
            associate (here => order(k), before => order(k - 1))
               if (line(here) /= line(before)) exit
               if (pieces(here)%arc_length(1) >= pieces(before)%arc_length(1)) exit
            end associate
            order([k - 1, k]) = order([k, k - 1])
         end do
      end do
   end subroutine sort_pieces

   !> Refuses pieces that begin before the one before ends.
   subroutine check_order(mesh, definition, pieces, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition
      type(contact_points_type), intent(in) :: pieces(:)      ! in their order
      type(error_type), allocatable, intent(out) :: error
      integer :: k

      do k = 2, size(pieces)
         associate (before => pieces(k - 1), here => pieces(k), m => size(pieces(k - 1)%slave))
            if (here%arc_length(1) >= before%arc_length(m)*(1.0_dp - rounding)) cycle
            call set_error(error, status_deck, definition%title()//': at slave node '// &
               to_text(mesh%node_number(here%slave(1)))//' a line of surface '// &
               mesh%surfaces(definition%master)%name//' lies between parts of another one; '// &
               'make surfaces of these lines, each on a data card')
            return
         end associate
      end do
   end subroutine check_order

   !> Puts pieces in one row.
   pure subroutine add_pieces(pieces, points)
      type(contact_points_type), intent(in) :: pieces(:)
      type(contact_points_type), intent(inout) :: points      ! the first of them
      integer :: behind, i, k   ! behind: contact points before a piece

      call join_rows(pieces%contact_row_type, points)
      associate (n => size(pieces))
         points%cuts = [(size(pieces(i)%slave), i=1, n - 1)]
         do i = 2, n - 1
            points%cuts(i) = points%cuts(i) + points%cuts(i - 1)
         end do
         points%face_node = [(pieces(i)%face_node, i=1, n)]
         points%position = reshape([(pieces(i)%position, i=1, n)], [2, size(points%slave)])
         points%arc_length = [(pieces(i)%arc_length, i=1, n)]
         points%edge = [(pieces(i)%edge, i=1, n)]
         points%to_end = [(pieces(i)%to_end, i=1, n)]
         points%at_corner = [(pieces(i)%at_corner, i=1, n)]
         points%finest_gap = maxval(pieces%finest_gap)
         do i = 2, n
            behind = points%cuts(i - 1)
            call points%slave_mean%add_sums(pieces(i)%slave_mean)
            call points%master_mean%add_sums(pieces(i)%master_mean)
            associate (own => pieces(i)%at_face_nodes)
               do k = 1, own%count
                  call points%at_face_nodes%add(own%values_of(k) + behind, own%coefficients_of(k))
               end do
            end associate
            ! Where pieces touch, rounding must not let s fall.
            points%arc_length(behind + 1:) = max(points%arc_length(behind + 1:), &
               points%arc_length(behind))
         end do
      end associate
      if (allocated(points%mortar%segments)) call add_segments(pieces, points)
   end subroutine add_pieces

   !> The segments of all pieces.
   pure subroutine add_segments(pieces, points)
      type(contact_points_type), intent(in) :: pieces(:)
      type(contact_points_type), intent(inout) :: points
      integer :: i, k

      do i = 2, size(pieces)
         associate (own => pieces(i)%mortar%segments)
            k = size(points%mortar%segments)
            points%mortar%segments = [points%mortar%segments, own]
            do k = k + 1, size(points%mortar%segments)
               associate (ends => points%mortar%segments(k)%points)
                  where (ends > 0) ends = ends + points%cuts(i - 1)
               end associate
            end do
         end associate
      end do
      points%mortar%hats = hats_of(points%mortar%segments, size(points%slave))
   end subroutine add_segments

   !> Corners of the slave that are opposite no master.
   pure function open_corners(line, pieces) result(is_open)
      integer, intent(in) :: line(:)
      type(contact_points_type), intent(in) :: pieces(:)
      logical, allocatable :: is_open(:), own(:)
      integer :: k

      allocate (is_open(0))
      own = pieces(1)%is_open_corner
      do k = 2, size(line)
         if (line(k) == line(k - 1)) then
            own = own .and. pieces(k)%is_open_corner
         else
            is_open = [is_open, own]
            own = pieces(k)%is_open_corner
         end if
      end do
      is_open = [is_open, own]
   end function open_corners

end module contact_pieces
