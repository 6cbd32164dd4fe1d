!> *RIGID BODY -> what follows a reference node; its lines: those of *SURFACE, TYPE=SEGMENTS, and of
!> R2D2 and RAX2 elements, what all of them are checked for, and where decks may name them.
module deck_builder_rigid
   use card_values, only: choice, is_on, check_extra, read_field, read_row
   use cards, only: data_card_type
   use deck_context, only: deck_type
   use deck_source, only: place_type
   use drawn_lines, only: drawn_line_type, sharpest_corner
   use equations, only: coupling_type
   use kinds, only: dp
   use mesh, only: surface_type
   use text, only: read_integer, to_text, to_upper
   implicit none
   private
   public :: build_drawing, build_line_surface, lines_of, build_rigid_body, need_faces, &
      check_rigid_masters

   real(dp), parameter :: pi = acos(-1.0_dp)
   real(dp), parameter :: same_radius = 1.0e-3_dp   !! part of the radius; decks give few digits
   real(dp), parameter :: same_point = 1.0e-9_dp    !! part of the length of a drawing
   real(dp), parameter :: half_turn = 1.0e-6_dp     !! from 180 degrees [rad]
   real(dp), parameter :: sharp_turn = 0.5_dp       !! cosine of 60 degrees

contains

   !> Reads the cards START, LINE and CIRCL: the end of a piece and, of an arc, its centre.
   subroutine build_drawing(deck, surface)
      type(deck_type), intent(inout) :: deck
      type(surface_type), intent(inout) :: surface         !! receives the drawing
      type(drawn_line_type) :: line
      real(dp) :: given(5), last(2), x(2, 2)
      integer :: errors, j
      character(:), allocatable :: word
      logical :: valid

      errors = deck%error_count()
      allocate (line%start(2, 0), line%finish(2, 0), line%centre(2, 0), line%is_arc(0))
      do j = 1, size(deck%card%data)
         associate (data => deck%card%data(j))
            word = to_upper(data%text(1))
            if ((word == 'START') .neqv. (j == 1)) then
               call deck%error(data%place(1), 'a drawing begins with one card START, x, y; the '// &
                  'cards behind it are LINE, x, y and CIRCL, x, y, x and y of the centre')
               exit
            end if
            given = 0.0_dp
            valid = .false.
            select case (word)
            case ('START', 'LINE')
               call read_row(data, '@'//word//'/x/y', deck, given(:3), valid)
            case ('CIRCL')
               call read_row(data, '@CIRCL/x of its end/y of its end/x of its centre/'// &
                  'y of its centre', deck, given, valid)
            case default
               call deck%error(data%place(1), ''''//data%text(1)//''' is no piece of a '// &
                  'drawing; known are START, LINE and CIRCL')
            end select
            if (.not. valid) exit
            x = reshape(given(2:), shape(x))
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
      if (deck%error_count() == errors .and. size(line%is_arc) == 0) call deck%error( &
         deck%card%place, 'the drawing has no piece: give LINE or CIRCL behind START')
      if (deck%error_count() > errors) return
      associate (n => size(line%is_arc))
         line%closed = n > 1 .and. norm2(line%finish(:, n) - line%start(:, 1)) <= &
            same_point*maxval(norm2(line%finish - line%start, dim=1))
      end associate
      call check_smooth([(deck%card%data(j)%place(1), j=2, size(deck%card%data))], surface%name, &
         line, deck)
      call turn_round(line)
      surface%drawing = line
   end subroutine build_drawing

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

   !> Decks have the body on the right of a line, faces on their left.
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

   !> The lines of a set, or the one of a number; none where there is no such set or line.
   pure function lines_of(name, deck) result(lines)
      character(*), intent(in) :: name
      type(deck_type), intent(in) :: deck
      integer, allocatable :: lines(:)
      integer :: number, set
      logical :: is_number

      allocate (lines(0))
      call read_integer(name, number, is_number)
      if (is_number) then
         set = findloc(deck%line_number, number, dim=1)
         if (set > 0) lines = [set]
      else
         set = deck%index_of('element set', name)
         if (set > 0) lines = deck%line_sets(set)%members
      end if
   end function lines_of

   !> Builds the surface of the sides of rigid line elements: SPOS is on the left from the first to
   !> the second node, SNEG on the right.
   subroutine build_line_surface(deck, surface)
      type(deck_type), intent(inout) :: deck
      type(surface_type), intent(inout) :: surface         !! receives the line
      integer, allocatable :: ends(:, :), lines(:), more(:)
      character(:), allocatable :: side
      integer :: i, j
      logical :: valid

      allocate (lines(0), ends(2, 0))
      do j = 1, size(deck%card%data)
         valid = .true.
         call read_field(deck%card%data(j), 2, 'side SPOS or SNEG', deck, side, valid)
         call check_extra(deck%card%data(j), 2, 'element or set, side', deck)
         if (.not. valid) return
         side = to_upper(side)
         more = lines_of(deck%card%data(j)%text(1), deck)
         if ((side /= 'SPOS' .and. side /= 'SNEG') .or. size(more) == 0) then
            call deck%error(deck%card%data(j)%place(merge(1, 2, size(more) == 0)), 'a surface '// &
               'of rigid elements has sides SPOS or SNEG of such elements only')
            return
         end if
         if (any(deck%line_nodes(:2, more) == 0)) return
         lines = [lines, more]
         do i = 1, size(more)
            ends = reshape([ends, merge(deck%line_nodes(:2, more(i)), &
               deck%line_nodes([2, 1], more(i)), side == 'SPOS')], [2, size(ends, 2) + 1])
         end do
      end do
      call join_lines(lines, ends, deck, surface)
   end subroutine build_line_surface

   subroutine join_lines(lines, ends, deck, surface)
      integer, intent(in) :: lines(:), ends(:, :)          ! (n), (2, n) nodes
      type(deck_type), intent(inout) :: deck
      type(surface_type), intent(inout) :: surface
      type(drawn_line_type) :: line
      integer :: i, order(size(lines))

      order(1) = 1
      do i = 1, size(lines)
         if (all(ends(2, :) /= ends(1, i))) order(1) = i
      end do
      do i = 2, size(lines)
         order(i) = findloc(ends(1, :), ends(2, order(i - 1)), dim=1)
         if (order(i) > 0) then
            if (all(order(:i - 1) /= order(i))) cycle
         end if
         call deck%error(deck%card%place, 'the rigid elements of surface '//surface%name// &
            ' are not one line, each from the node where another one ends; number their nodes '// &
            'that way, or name the pieces as surfaces of their own')
         return
      end do
      line%line = lines(order)
      line%start = deck%mesh%coordinates(:, ends(1, order))
      line%finish = deck%mesh%coordinates(:, ends(2, order))
      allocate (line%is_arc(size(lines)), source=.false.)
      line%centre = 0.0_dp*line%start
      line%closed = ends(1, order(1)) == ends(2, order(size(order)))
      call check_smooth([(deck%card%place, i=1, size(lines))], surface%name, line, deck)
      call turn_round(line)
      surface%drawing = line
   end subroutine join_lines

   !> Reads what follows the reference node, which is known: nodes, elements, surfaces of lines.
   subroutine build_rigid_body(deck, coupling)
      type(deck_type), intent(inout) :: deck
      type(coupling_type), intent(inout) :: coupling       !! receives the rest
      character(*), parameter :: names(3) = [character(8) :: 'NSET', 'TIE NSET', 'PIN NSET']
      character(:), allocatable :: position
      integer, allocatable :: lines(:)
      integer :: i, set, surface
      logical :: isothermal

      coupling%is_rigid = .true.
      coupling%follows = .true.
      allocate (coupling%node_sets(0), lines(0))
      do i = 1, size(names)
         set = 0
         call deck%take_named(trim(names(i)), 'node set', set)
         if (set > 0) coupling%node_sets = [coupling%node_sets, set]
      end do
      call deck%take_named('ELSET', 'element set', coupling%element_set)
      if (coupling%element_set > 0) then
         lines = lines_of(deck%mesh%element_sets(coupling%element_set)%name, deck)
         coupling%nodes = pack(deck%line_nodes(:, lines), deck%line_nodes(:, lines) > 0)
      end if
      surface = 0
      call deck%take_named('ANALYTICAL SURFACE', 'surface', surface)
      if (surface > 0) then
         if (.not. allocated(deck%mesh%surfaces(surface)%drawing)) then
            call deck%error(deck%card%place_of('ANALYTICAL SURFACE'), 'surface '// &
               deck%mesh%surfaces(surface)%name//' is no drawing; name one of *SURFACE, '// &
               'TYPE=SEGMENTS, or the elements by ELSET=')
            return
         end if
      end if
      position = choice(deck%card, 'POSITION', 'INPUT', deck, '')
      isothermal = is_on(deck%card, 'ISOTHERMAL', deck)
      ! Lines conduct no heat: they have one temperature.
      coupling%is_warm = isothermal .or. (size(lines) > 0 .and. size(coupling%node_sets) == 0)
      do i = 1, size(deck%mesh%surfaces)
         associate (given => deck%mesh%surfaces(i))
            if (.not. allocated(given%drawing)) cycle
            if (i /= surface) then
               if (.not. allocated(given%drawing%line)) cycle
               if (all(given%drawing%line(1) /= lines)) cycle
            end if
            given%drawing%reference = coupling%reference
            given%drawing%rotation = coupling%rotation
         end associate
      end do
      if (.not. (deck%card%has('ELSET') .or. deck%card%has('ANALYTICAL SURFACE') .or. any([( &
         deck%card%has(trim(names(i))), i=1, size(names))]))) call deck%error(deck%card%place, &
         '*RIGID BODY names nothing that is rigid; give ELSET=, NSET= or ANALYTICAL SURFACE=')
   end subroutine build_rigid_body

   !> Refuses a rigid surface where faces of elements are needed.
   subroutine need_faces(place, deck, surface)
      type(place_type), intent(in) :: place                !! where it is named
      type(deck_type), intent(inout) :: deck
      integer, intent(inout) :: surface                    !! 0 for none, and after an error

      if (surface == 0) return
      if (.not. allocated(deck%mesh%surfaces(surface)%drawing)) return
      call deck%error(place, 'surface '//deck%mesh%surfaces(surface)%name//' is rigid: it has '// &
         'no faces; name its reference node, or make it the master of a *CONTACT PAIR')
      surface = 0
   end subroutine need_faces

   !> Rigid surfaces in contact have a reference node.
   subroutine check_rigid_masters(deck)
      type(deck_type), intent(inout) :: deck
      integer :: i

      do i = 1, size(deck%model%contacts)
         if (deck%model%contacts(i)%master == 0) cycle
         associate (surface => deck%mesh%surfaces(deck%model%contacts(i)%master))
            if (.not. allocated(surface%drawing)) cycle
            if (surface%drawing%reference > 0) cycle
            call deck%missing(place_type(image=deck%model%contacts(i)%card), 'rigid surface '// &
               surface%name//' belongs to no *RIGID BODY, whose reference node it follows; '// &
               'give *RIGID BODY, REF NODE=node, '//trim(merge('ELSET=its elements         ', &
               'ANALYTICAL SURFACE=its name', allocated(surface%drawing%line))), 'equation')
         end associate
      end do
   end subroutine check_rigid_masters

end module deck_builder_rigid
