!> *SURFACE, TYPE=SEGMENTS -> the lines and arcs of a rigid body; what all of its lines are checked
!> for.
module deck_builder_drawings
   use card_values, only: check_extra, need_field
   use cards, only: data_card_type, keyword_card_type
   use deck_context, only: deck_type
   use deck_source, only: place_type
   use drawn_lines, only: drawn_line_type, sharpest_corner
   use kinds, only: dp
   use mesh, only: surface_type
   use text, only: to_text, to_upper
   implicit none
   private
   public :: build_drawing, check_smooth, turn_round

   real(dp), parameter :: pi = acos(-1.0_dp)
   real(dp), parameter :: same_radius = 1.0e-3_dp   !! part of the radius; decks give few digits
   real(dp), parameter :: same_point = 1.0e-9_dp    !! part of the length of a drawing
   real(dp), parameter :: half_turn = 1.0e-6_dp     !! from 180 degrees [rad]
   real(dp), parameter :: sharp_turn = 0.5_dp       !! cosine of 60 degrees

contains

   !> Reads the cards START, LINE and CIRCL of a surface.
   subroutine build_drawing(card, deck, surface)
      type(keyword_card_type), intent(in) :: card
      type(deck_type), intent(inout) :: deck   !! receives errors
      type(surface_type), intent(inout) :: surface         !! receives the drawing
      type(drawn_line_type) :: line
      real(dp) :: last(2), x(2, 2)
      integer :: errors, j
      character(:), allocatable :: word
      logical :: valid

      errors = deck%error_count()
      allocate (line%start(2, 0), line%finish(2, 0), line%centre(2, 0), line%is_arc(0))
      do j = 1, size(card%data)
         associate (data => card%data(j))
            word = to_upper(data%text(1))
            if ((word == 'START') .neqv. (j == 1)) then
               call deck%error(data%place(1), 'a drawing begins with one card START, x, y; the '// &
                  'cards behind it are LINE, x, y and CIRCL, x, y, x and y of the centre')
               exit
            end if
            call read_points(data, word, deck, x, valid)
            if (.not. valid) exit
            if (word /= 'START') then
               line%start = reshape([line%start, last], [2, size(line%is_arc) + 1])
               line%finish = reshape([line%finish, x(:, 1)], shape(line%start))
               line%centre = reshape([line%centre, x(:, 2)], shape(line%start))
               line%is_arc = [line%is_arc, word == 'CIRCL']
               call check_piece(data, line, deck)
            end if
            last = x(:, 1)
         end associate
      end do
      if (deck%error_count() == errors .and. size(line%is_arc) == 0) call deck%error(card%place, &
         'the drawing has no piece: give LINE or CIRCL behind START')
      if (deck%error_count() > errors) return
      associate (n => size(line%is_arc))
         line%closed = n > 1 .and. norm2(line%finish(:, n) - line%start(:, 1)) <= &
            same_point*maxval(norm2(line%finish - line%start, dim=1))
      end associate
      call check_smooth([(card%data(j)%place(1), j=2, size(card%data))], surface%name, line, deck)
      call turn_round(line)
      surface%drawing = line
   end subroutine build_drawing

   !> The end of a piece and, of an arc, its centre.
   subroutine read_points(data, word, deck, x, valid)
      type(data_card_type), intent(in) :: data
      character(*), intent(in) :: word
      type(deck_type), intent(inout) :: deck
      real(dp), intent(out) :: x(2, 2)
      logical, intent(out) :: valid
      character(*), parameter :: axes = 'xy'
      integer :: i, points

      valid = .true.
      x = 0.0_dp
      select case (word)
      case ('START', 'LINE')
         points = 1
      case ('CIRCL')
         points = 2
      case default
         call deck%error(data%place(1), ''''//data%text(1)//''' is no piece of a drawing; '// &
            'known are START, LINE and CIRCL')
         valid = .false.
         return
      end select
      do i = 1, 2*points
         call need_field(data, i + 1, axes(2 - modulo(i, 2):2 - modulo(i, 2))//trim(merge(' of '// &
            'the centre', '              ', i > 2)), deck, x(2 - modulo(i, 2), (i + 1)/2), valid)
      end do
      call check_extra(data, 2*points + 1, word//', '//trim(merge('x and y of its end, x and y '// &
         'of its centre', 'x, y                                     ', points == 2)), deck)
   end subroutine read_points

   !> A piece has a length, and an arc one radius and less than half a turn.
   subroutine check_piece(data, line, deck)
      type(data_card_type), intent(in) :: data
      type(drawn_line_type), intent(in) :: line            ! this piece is its last one
      type(deck_type), intent(inout) :: deck
      real(dp) :: radius(2)
      integer :: n

      n = size(line%is_arc)
      if (norm2(line%finish(:, n) - line%start(:, n)) <= 0.0_dp) then
         call deck%error(data%place(2), 'this piece ends where it begins')
         return
      end if
      if (.not. line%is_arc(n)) return
      radius = [norm2(line%start(:, n) - line%centre(:, n)), &
         norm2(line%finish(:, n) - line%centre(:, n))]
      if (abs(radius(2) - radius(1)) > same_radius*maxval(radius)) then
         call deck%error(data%place(4), 'the ends of the arc are '//to_text(radius(1))//' and '// &
            to_text(radius(2))//' from its centre; let both be one radius')
      else if (abs(line%sweep(n)) > pi - half_turn) then
         call deck%error(data%place(1), 'the arc turns by 180 degrees or more, so that its '// &
            'side of the centre is not known; make two arcs of it')
      end if
   end subroutine check_piece

   !> Refuses a line that turns by more than 60 degrees between two pieces.
   subroutine check_smooth(places, name, line, deck)
      type(place_type), intent(in) :: places(:)            ! (pieces) where each piece is
      character(*), intent(in) :: name
      type(drawn_line_type), intent(in) :: line
      type(deck_type), intent(inout) :: deck
      real(dp) :: cosine
      integer :: piece

      call sharpest_corner(line, piece, cosine)
      if (cosine >= sharp_turn) return
      call deck%error(places(piece), 'rigid surface '//name//' turns by '//to_text(nint( &
         180.0_dp*acos(max(cosine, -1.0_dp))/pi))//' degrees at the end of this piece, more '// &
         'than 60: round the corner by arcs of less than 180 degrees, or end the surface there')
   end subroutine check_smooth

   !> Turns a line from one with the body on its right, as decks have it, to one with the body on
   !> its left, as faces have it.
   pure subroutine turn_round(line)
      type(drawn_line_type), intent(inout) :: line
      real(dp), allocatable :: start(:, :)
      integer :: i, n
      integer, allocatable :: order(:)

      n = size(line%is_arc)
      order = [(i, i=n, 1, -1)]
      start = line%start
      line%start = line%finish(:, order)
      line%finish = start(:, order)
      line%centre = line%centre(:, order)
      line%is_arc = line%is_arc(order)
      if (allocated(line%line)) line%line = line%line(order)
   end subroutine turn_round

end module deck_builder_drawings
