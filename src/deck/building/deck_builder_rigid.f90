!> *SURFACE, TYPE=SEGMENTS, and surfaces of R2D2 and RAX2 elements -> lines of rigid bodies;
!> *RIGID BODY -> what follows a reference node.
module deck_builder_rigid
   use card_parameters, only: choose, has_parameter, is_on, parameter_place
   use card_values, only: check_extra, need_field
   use cards, only: cards_type, data_card_type, field_place, field_text, has_field, &
      keyword_card_type
   use deck_context, only: deck_context_type, take_named
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use drawn_lines, only: drawn_line_type, sharpest_corner
   use element_types, only: rigid_line
   use equations, only: coupling_type
   use kinds, only: dp
   use mesh, only: mesh_type, surface_type
   use model, only: model_type
   use named_items, only: find_named
   use text, only: read_integer, to_text, to_upper
   implicit none
   private
   public :: build_drawing, build_line_surface, is_rigid_side, build_rigid_body, need_faces, &
      check_rigid_masters

   real(dp), parameter :: pi = acos(-1.0_dp)
   real(dp), parameter :: same_radius = 1.0e-3_dp   !! part of the radius; decks give few digits
   real(dp), parameter :: same_point = 1.0e-9_dp    !! part of the length of a drawing
   real(dp), parameter :: half_turn = 1.0e-6_dp     !! from 180 degrees [rad]
   real(dp), parameter :: sharp_turn = 0.5_dp       !! cosine of 60 degrees

contains

   !> Reads the cards START, LINE and CIRCL of a surface.
   subroutine build_drawing(cards, card, report, surface)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(surface_type), intent(inout) :: surface         !! receives the drawing
      type(drawn_line_type) :: line
      real(dp) :: last(2), x(2, 2)
      integer :: errors, j
      character(:), allocatable :: word
      logical :: valid

      errors = report%error_count()
      allocate (line%start(2, 0), line%finish(2, 0), line%centre(2, 0), line%is_arc(0))
      do j = card%first_data, card%last_data
         associate (data => cards%data(j))
            word = to_upper(field_text(data, 1))
            if ((word == 'START') .neqv. (j == card%first_data)) then
               call report%error(field_place(data, 1), 'a drawing begins with one card START, '// &
                  'x, y; the cards behind it are LINE, x, y and CIRCL, x, y, x and y of the centre')
               exit
            end if
            call read_points(data, word, report, x, valid)
            if (.not. valid) exit
            if (word /= 'START') then
               line%start = reshape([line%start, last], [2, size(line%is_arc) + 1])
               line%finish = reshape([line%finish, x(:, 1)], shape(line%start))
               line%centre = reshape([line%centre, x(:, 2)], shape(line%start))
               line%is_arc = [line%is_arc, word == 'CIRCL']
               call check_piece(data, line, report)
            end if
            last = x(:, 1)
         end associate
      end do
      if (report%error_count() == errors .and. size(line%is_arc) == 0) call report%error( &
         card%place, 'the drawing has no piece: give LINE or CIRCL behind START')
      if (report%error_count() > errors) return
      associate (n => size(line%is_arc))
         line%closed = n > 1 .and. norm2(line%finish(:, n) - line%start(:, 1)) <= &
            same_point*maxval(norm2(line%finish - line%start, dim=1))
      end associate
      call check_smooth([(field_place(cards%data(j), 1), j=card%first_data + 1, card%last_data)], &
         surface%name, line, report)
      call turn_round(line)
      surface%drawing = line
   end subroutine build_drawing

   !> The end of a piece and, of an arc, its centre.
   subroutine read_points(data, word, report, x, valid)
      type(data_card_type), intent(in) :: data
      character(*), intent(in) :: word
      type(deck_report_type), intent(inout) :: report
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
         call report%error(field_place(data, 1), ''''//field_text(data, 1)// &
            ''' is no piece of a drawing; known are START, LINE and CIRCL')
         valid = .false.
         return
      end select
      do i = 1, 2*points
         call need_field(data, i + 1, axes(2 - modulo(i, 2):2 - modulo(i, 2))//trim(merge( &
            ' of the centre', '              ', i > 2)), report, x(2 - modulo(i, 2), (i + 1)/2), &
            valid)
      end do
      call check_extra(data, 2*points + 1, word//', '//trim(merge( &
         'x and y of its end, x and y of its centre', &
         'x, y                                     ', points == 2)), report)
   end subroutine read_points

   !> A piece has a length, and an arc one radius and less than half a turn.
   subroutine check_piece(data, line, report)
      type(data_card_type), intent(in) :: data
      type(drawn_line_type), intent(in) :: line            ! this piece is its last one
      type(deck_report_type), intent(inout) :: report
      real(dp) :: radius(2)
      integer :: n

      n = size(line%is_arc)
      if (norm2(line%finish(:, n) - line%start(:, n)) <= 0.0_dp) then
         call report%error(field_place(data, 2), 'this piece ends where it begins')
         return
      end if
      if (.not. line%is_arc(n)) return
      radius = [norm2(line%start(:, n) - line%centre(:, n)), &
         norm2(line%finish(:, n) - line%centre(:, n))]
      if (abs(radius(2) - radius(1)) > same_radius*maxval(radius)) then
         call report%error(field_place(data, 4), 'the ends of the arc are '//to_text(radius(1))// &
            ' and '//to_text(radius(2))//' from its centre; let both be one radius')
      else if (abs(line%sweep(n)) > pi - half_turn) then
         call report%error(field_place(data, 1), 'the arc turns by 180 degrees or more, so '// &
            'that its side of the centre is not known; make two arcs of it')
      end if
   end subroutine check_piece

   !> Refuses a line that turns by more than 60 degrees between two pieces.
   subroutine check_smooth(places, name, line, report)
      type(place_type), intent(in) :: places(:)            ! (pieces) where each piece is
      character(*), intent(in) :: name
      type(drawn_line_type), intent(in) :: line
      type(deck_report_type), intent(inout) :: report
      real(dp) :: cosine
      integer :: piece

      call sharpest_corner(line, piece, cosine)
      if (cosine >= sharp_turn) return
      call report%error(places(piece), 'rigid surface '//name//' turns by '// &
         to_text(nint(180.0_dp*acos(max(cosine, -1.0_dp))/pi))//' degrees at the end of this '// &
         'piece, more than 60: round the corner by arcs of less than 180 degrees, or end the '// &
         'surface there')
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

   !> Whether a data card of a *SURFACE names sides of rigid line elements.
   pure logical function is_rigid_side(data, context)
      type(data_card_type), intent(in) :: data
      type(deck_context_type), intent(in) :: context
      integer, allocatable :: lines(:)

      lines = lines_of(field_text(data, 1), context)
      is_rigid_side = size(lines) > 0
      if (is_rigid_side) is_rigid_side = all(context%line_kind(lines) == rigid_line)
   end function is_rigid_side

   !> The lines of a set, or the one of a number; none where there is no such set or line.
   pure function lines_of(name, context) result(lines)
      character(*), intent(in) :: name
      type(deck_context_type), intent(in) :: context
      integer, allocatable :: lines(:)
      integer :: number, set
      logical :: is_number

      allocate (lines(0))
      call read_integer(name, number, is_number)
      if (is_number) then
         set = findloc(context%line_number, number, dim=1)
         if (set > 0) lines = [set]
      else
         set = find_named(context%line_sets, to_upper(name))
         if (set > 0) lines = context%line_sets(set)%members
      end if
   end function lines_of

   !> Builds the surface of the sides of rigid line elements: SPOS is on the left from the first to
   !> the second node, SNEG on the right.
   subroutine build_line_surface(cards, card, context, mesh, report, surface)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(in) :: context
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(surface_type), intent(inout) :: surface         !! receives the line
      integer, allocatable :: ends(:, :), lines(:), more(:)
      character(:), allocatable :: side
      integer :: i, j
      logical :: valid

      allocate (lines(0), ends(2, 0))
      do j = card%first_data, card%last_data
         valid = .true.
         call need_field(cards%data(j), 2, 'side SPOS or SNEG', report, side, valid)
         call check_extra(cards%data(j), 2, 'element or set, side', report)
         if (.not. valid) return
         side = to_upper(side)
         more = lines_of(field_text(cards%data(j), 1), context)
         if ((side /= 'SPOS' .and. side /= 'SNEG') .or. size(more) == 0) then
            call report%error(field_place(cards%data(j), merge(1, 2, size(more) == 0)), &
               'a surface of rigid elements has sides SPOS or SNEG of such elements only')
            return
         end if
         if (any(context%line_nodes(:2, more) == 0)) return
         lines = [lines, more]
         do i = 1, size(more)
            ends = reshape([ends, merge(context%line_nodes(:2, more(i)), &
               context%line_nodes([2, 1], more(i)), side == 'SPOS')], [2, size(ends, 2) + 1])
         end do
      end do
      call join_lines(card, lines, ends, mesh, report, surface)
   end subroutine build_line_surface

   !> Puts lines one behind the other.
   subroutine join_lines(card, lines, ends, mesh, report, surface)
      type(keyword_card_type), intent(in) :: card
      integer, intent(in) :: lines(:), ends(:, :)          ! (n), (2, n) nodes
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report
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
         call report%error(card%place, 'the rigid elements of surface '//surface%name// &
            ' are not one line, each from the node where another one ends; number their nodes '// &
            'that way, or name the pieces as surfaces of their own')
         return
      end do
      line%line = lines(order)
      line%start = mesh%coordinates(:, ends(1, order))
      line%finish = mesh%coordinates(:, ends(2, order))
      allocate (line%is_arc(size(lines)), source=.false.)
      line%centre = 0.0_dp*line%start
      line%closed = ends(1, order(1)) == ends(2, order(size(order)))
      call check_smooth(spread_place(card%place, size(lines)), surface%name, line, report)
      call turn_round(line)
      surface%drawing = line
   end subroutine join_lines

   pure function spread_place(place, n) result(places)
      type(place_type), intent(in) :: place
      integer, intent(in) :: n
      type(place_type) :: places(n)

      places = place
   end function spread_place

   !> Reads what follows the reference node, which is known: sets of nodes and elements, and the
   !> surfaces that are lines.
   subroutine build_rigid_body(card, context, model, report, coupling)
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(in) :: context
      type(model_type), intent(inout) :: model             !! receives whom its surfaces follow
      type(deck_report_type), intent(inout) :: report      !! receives errors
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
         call take_named(card, trim(names(i)), 'node set', model%mesh%node_sets, report, set)
         if (set > 0) coupling%node_sets = [coupling%node_sets, set]
      end do
      call take_named(card, 'ELSET', 'element set', model%mesh%element_sets, report, &
         coupling%element_set)
      if (coupling%element_set > 0) then
         lines = lines_of(model%mesh%element_sets(coupling%element_set)%name, context)
         coupling%nodes = pack(context%line_nodes(:, lines), context%line_nodes(:, lines) > 0)
      end if
      surface = 0
      call take_named(card, 'ANALYTICAL SURFACE', 'surface', model%mesh%surfaces, report, surface)
      if (surface > 0) then
         if (.not. allocated(model%mesh%surfaces(surface)%drawing)) then
            call report%error(parameter_place(card, 'ANALYTICAL SURFACE'), 'surface '// &
               model%mesh%surfaces(surface)%name//' is no drawing; name one of *SURFACE, '// &
               'TYPE=SEGMENTS, or the elements by ELSET=')
            return
         end if
      end if
      call choose(card, 'POSITION', 'INPUT', report, position)
      isothermal = is_on(card, 'ISOTHERMAL', report)
      ! Lines conduct no heat: they have one temperature.
      coupling%is_warm = isothermal .or. (size(lines) > 0 .and. size(coupling%node_sets) == 0)
      do i = 1, size(model%mesh%surfaces)
         associate (given => model%mesh%surfaces(i))
            if (.not. allocated(given%drawing)) cycle
            if (i /= surface .and. .not. allocated(given%drawing%line)) cycle
            if (i /= surface) then
               if (.not. any(given%drawing%line(1) == lines)) cycle
            end if
            given%drawing%reference = coupling%reference
            given%drawing%rotation = coupling%rotation
         end associate
      end do
      if (surface > 0 .or. coupling%element_set > 0 .or. size(coupling%node_sets) > 0) return
      if (has_parameter(card, 'NSET') .or. has_parameter(card, 'ELSET') .or. &
         has_parameter(card, 'TIE NSET') .or. has_parameter(card, 'PIN NSET') .or. &
         has_parameter(card, 'ANALYTICAL SURFACE')) return
      call report%error(card%place, '*RIGID BODY names nothing that is rigid; give ELSET=, '// &
         'NSET= or ANALYTICAL SURFACE=')
   end subroutine build_rigid_body

   !> Refuses a rigid surface where faces of elements are needed.
   subroutine need_faces(mesh, place, advice, report, surface)
      type(mesh_type), intent(in) :: mesh
      type(place_type), intent(in) :: place                !! where it is named
      character(*), intent(in) :: advice                   !! what to name in its place
      type(deck_report_type), intent(inout) :: report      !! receives the error
      integer, intent(inout) :: surface                    !! 0 for none, and after an error

      if (surface == 0) return
      if (.not. allocated(mesh%surfaces(surface)%drawing)) return
      call report%error(place, 'surface '//mesh%surfaces(surface)%name//' is rigid: it has no '// &
         'faces; '//advice)
      surface = 0
   end subroutine need_faces

   !> Rigid surfaces in contact have a reference node.
   subroutine check_rigid_masters(model, report)
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer :: i

      do i = 1, size(model%contacts)
         if (model%contacts(i)%master == 0) cycle
         associate (surface => model%mesh%surfaces(model%contacts(i)%master))
            if (.not. allocated(surface%drawing)) cycle
            if (surface%drawing%reference > 0) cycle
            call report%missing(place_type(image=model%contacts(i)%card), 'rigid surface '// &
               surface%name//' belongs to no *RIGID BODY, whose reference node it follows; '// &
               'give *RIGID BODY, REF NODE=node, '//trim(merge('ELSET=its elements         ', &
               'ANALYTICAL SURFACE=its name', allocated(surface%drawing%line))), 'equation')
         end associate
      end do
   end subroutine check_rigid_masters

end module deck_builder_rigid
