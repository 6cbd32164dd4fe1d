!> *NGEN, *NFILL, *NCOPY, *ELGEN and *ELCOPY -> the *NODE and *ELEMENT cards that they stand for.
module generated_cards
   use card_values, only: choice, need_parameter, take_parameter, read_row
   use cards, only: add_data, add_keyword, cards_type, data_card_type, keyword_card_type, &
      replace_cards
   use deck_report, only: deck_report_type
   use given_cards, only: add_generated, add_numbers, add_set, card_of, corners_of, &
      growing_cards_type, is_given, keep_last, members_of, node_place, axis_layout, motion_type, &
      read_motion, rotation
   use kinds, only: dp
   use number_lists, only: number_list_type
   use text, only: read_integer, to_text, to_upper
   implicit none
   private
   public :: generate_cards

   integer, parameter :: most_generated = 10000000   !! nodes or elements of one data card
   character(*), parameter :: too_many = 'a card generates at most 10000000 nodes or elements'

   !> A node that a card names, or a place that it gives.
   type :: given_point_type
      integer :: number = 0            !! of the node
      real(dp) :: x(2) = 0.0_dp        !! its place [length]
      logical :: valid = .false.       !! whether it is known
   end type given_point_type

   !> The circle of *NGEN, LINE=C, about its center.
   type, extends(given_point_type) :: given_circle_type
      real(dp) :: angle = 0.0_dp       !! from the first node to the last [rad]
   end type given_circle_type

   integer, parameter :: most_intervals = 10000   !! of *NFILL

   real(dp), parameter :: same_place = 1.0e-6_dp   !! distance, by the largest coordinate

contains

   !> Replaces each card that generates nodes or elements by *NODE or *ELEMENT, with the data that
   !> it generates. Generated cards have the place of the card that generates them.
   subroutine generate_cards(cards, report)
      type(cards_type), intent(inout) :: cards
      type(deck_report_type), intent(inout), target :: report   !! receives errors
      type(growing_cards_type) :: all
      real(dp) :: bias
      integer :: k, j

      do k = 1, size(cards%keywords)
         if (generates(cards%keywords(k))) exit
      end do
      if (k > size(cards%keywords)) return
      all%report => report
      do k = 1, size(cards%keywords)
         associate (card => cards%keywords(k))
            if (.not. generates(card)) then
               call add_keyword(all, card)
               do j = 1, size(card%data)
                  call add_data(all, card%data(j)%fields, card%data(j)%end)
                  call keep_last(all)
               end do
               cycle
            end if
            select case (card%name)
            case ('NCOPY')
               call copy_nodes(card, all)
            case ('ELCOPY')
               call copy_elements(card, all)
            case default
               bias = 1.0_dp
               call take_parameter(card, 'BIAS', report, bias, '>0')
               do j = 1, size(card%data)
                  if (card%name == 'NFILL') call fill_nodes(card, card%data(j), bias, all)
                  if (card%name == 'NGEN') call generate_nodes(card, card%data(j), all)
                  if (card%name == 'ELGEN') call generate_elements(card, card%data(j), all)
               end do
            end select
         end associate
      end do
      call replace_cards(cards, all)
   end subroutine generate_cards

   !> Whether a card generates something; without data it is reported elsewhere.
   pure logical function generates(card)
      type(keyword_card_type), intent(in) :: card

      generates = card%name == 'ELCOPY' .or. size(card%data) > 0 .and. &
         any(card%name == [character(5) :: 'NGEN', 'ELGEN', 'NFILL', 'NCOPY'])
   end function generates

   !> First and last node, increment: nodes at equal distances on a line or, with LINE=C, a circle.
   subroutine generate_nodes(card, data, all)
      type(keyword_card_type), intent(in) :: card
      type(data_card_type), intent(in) :: data
      type(growing_cards_type), intent(inout) :: all
      type(given_point_type) :: ends(2)
      type(given_circle_type) :: circle
      real(dp) :: from(2), given(10)
      integer :: step, i, n
      logical :: valid

      if (card%has('LINE')) then
         call read_row(data, '#first node/#last node/#increment? =1/#center?/x of the '// &
            'center?/y of the center?/z of the center?/x of the normal?/y of the normal?/z of '// &
            'the normal?', all%report, given, valid)
      else
         call read_row(data, '#first node/#last node/#increment? =1', all%report, given, valid)
      end if
      step = nint(given(3))
      do i = 1, 2
         if (valid) call find_given_node(data, i, nint(given(i)), all, ends(i))
      end do
      valid = valid .and. ends(1)%valid .and. ends(2)%valid
      if (valid .and. card%has('LINE')) then
         call make_circle(card, data, given, ends, all, circle)
         valid = circle%valid
      end if
      if (valid) then
         n = ends(2)%number - ends(1)%number
         valid = step > 0 .and. n > 0 .and. mod(n, max(step, 1)) == 0
         if (.not. valid) then
            call all%report%error(data%place(3), 'increments of '//to_text(step)//' do not '// &
               'lead from '//to_text(ends(1)%number)//' to '//to_text(ends(2)%number))
         else if (n/step > most_generated) then
            call all%report%error(data%place(2), too_many)
            valid = .false.
         end if
      end if
      if (.not. valid) then
         call all%report%lose('node')
         return
      end if
      call add_set(card, 'NSET', data, ends%number, all)
      n = (ends(2)%number - ends(1)%number)/step
      if (n > 1) call add_generated(card, 'NODE', '', all)
      do i = 1, n - 1
         if (card%has('LINE')) then
            from = matmul(rotation(circle%angle*i/n), ends(1)%x - circle%x)
            from = circle%x + from*(1 + (norm2(ends(2)%x - circle%x)/norm2(from) - 1)*i/n)
         else
            from = ends(1)%x + (ends(2)%x - ends(1)%x)*i/n
         end if
         call add_numbers(data, [ends(1)%number + i*step], all, from)
      end do
   end subroutine generate_nodes

   subroutine find_given_node(data, i, number, all, node)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i                ! position of the field
      integer, intent(in) :: number
      type(growing_cards_type), intent(in) :: all
      type(given_point_type), intent(out) :: node

      node%number = number
      node%valid = is_given(number, all%nodes)
      if (node%valid) then
         node%x = node_place(all, number)
      else
         call all%report%error(data%place(i), 'no *NODE before this card has node '// &
            to_text(number))
      end if
   end subroutine find_given_node

   !> Center of the circle of *NGEN, LINE=C, a node or a place, and the angle from the first node to
   !> the last: the smaller one, or the one anticlockwise about the normal that the card gives.
   subroutine make_circle(card, data, given, ends, all, circle)
      type(keyword_card_type), intent(in) :: card
      type(data_card_type), intent(in) :: data
      real(dp), intent(in) :: given(10)       ! (fields)
      type(given_point_type), intent(in) :: ends(2)
      type(growing_cards_type), intent(in) :: all
      type(given_circle_type), intent(out) :: circle
      real(dp), parameter :: whole = 2*acos(-1.0_dp)
      real(dp) :: radii(2, 2)

      circle%valid = choice(card, 'LINE', 'C', all%report, '') == 'C'
      circle%x = given(5:6)
      if (circle%valid .and. data%has(4)) call find_given_node(data, 4, nint(given(4)), all, &
         circle%given_point_type)
      if (.not. circle%valid) return
      radii(:, 1) = ends(1)%x - circle%x
      radii(:, 2) = ends(2)%x - circle%x
      associate (angle => circle%angle)
         angle = atan2(radii(1, 1)*radii(2, 2) - radii(2, 1)*radii(1, 2), &
            dot_product(radii(:, 1), radii(:, 2)))
         if (given(10) > 0.0_dp) angle = modulo(angle, whole)
         if (given(10) < 0.0_dp) angle = -modulo(-angle, whole)
      end associate
      if (minval(norm2(radii, dim=1)) > 0.0_dp) return
      call all%report%error(data%place(4), 'the center of the circle is one of its nodes')
      circle%valid = .false.
   end subroutine make_circle

   !> Master element; then for the elements of a row, and for the rows, their number and the
   !> increments of their nodes and of their own numbers.
   subroutine generate_elements(card, data, all)
      type(keyword_card_type), intent(in) :: card
      type(data_card_type), intent(in) :: data
      type(growing_cards_type), intent(inout) :: all
      integer, allocatable :: corners(:)
      real(dp) :: given(7)
      integer :: master, card_at(2), i, j
      integer :: counts(2)      ! elements of a row, and rows
      integer :: steps(2, 2)    ! increments of nodes and elements, of both
      logical :: valid

      call read_row(data, '#master element/#number of elements? >0 =1/#increment of nodes? '// &
         '=1/#increment of elements? =1/#number of rows? >0 =1/#increment of nodes? '// &
         '=1/#increment of elements? =1', all%report, given, valid)
      master = nint(given(1))
      counts = nint(given([2, 5]))
      steps = nint(reshape(given([3, 4, 6, 7]), [2, 2]))
      if (valid .and. product(given([2, 5])) > most_generated) then
         call all%report%error(data%place(2), too_many)
         valid = .false.
      end if
      card_at = 0
      if (valid) card_at = card_of(master, all%elements)
      if (valid .and. card_at(1) == 0) call all%report%error(data%place(1), 'no *ELEMENT '// &
         'before this card has element '//to_text(master))
      if (card_at(1) == 0) then
         call all%report%lose('element')
         return
      end if
      corners = corners_of(all%keywords(card_at(1))%data(card_at(2)))
      call add_set(card, 'ELSET', data, [master], all)
      if (product(counts) > 1) call add_generated(card, 'ELEMENT', &
         all%keywords(card_at(1))%text('TYPE'), all)
      do j = 0, counts(2) - 1
         do i = 0, counts(1) - 1
            if (i + j == 0) cycle
            call add_numbers(data, [master + i*steps(2, 1) + j*steps(2, 2), &
               corners + i*steps(1, 1) + j*steps(1, 2)], all)
         end do
      end do
   end subroutine generate_elements

   !> *NFILL: nodes between those of two sets, in the order of their numbers, at equal distances or,
   !> with BIAS=, at distances of which each is the one behind it times the bias. A data card has
   !> two sets or nodes, number of intervals, increment.
   subroutine fill_nodes(card, data, bias, all)
      type(keyword_card_type), intent(in) :: card
      type(data_card_type), intent(in) :: data
      real(dp), intent(in) :: bias
      type(growing_cards_type), intent(inout) :: all            !! receives the cards
      integer, allocatable :: from(:), to(:)
      real(dp) :: given(4), x(2, 2)
      real(dp), allocatable :: parts(:)
      integer :: i, intervals, k, step
      logical :: valid

      call read_row(data, '@set or node/@set or node/#number of intervals >0/#increment? >0 =1', &
         all%report, given, valid)
      intervals = nint(given(3))
      step = nint(given(4))
      call end_of_fill(data, 1, all, from, valid)
      call end_of_fill(data, 2, all, to, valid)
      if (valid .and. intervals > most_intervals) then
         call all%report%error(data%place(3), 'the number of intervals is from 1 to '// &
            to_text(most_intervals))
         valid = .false.
      else if (valid .and. size(from) /= size(to)) then
         call all%report%error(data%place(2), 'the two ends have '//to_text(size(from))//' and '// &
            to_text(size(to))//' nodes; give sets of as many nodes')
         valid = .false.
      end if
      if (.not. valid) then
         call all%report%lose('node')
         return
      end if
      call add_set(card, 'NSET', data, [from, to], all)
      if (intervals > 1) call add_generated(card, 'NODE', '', all)
      allocate (parts(0:intervals), source=0.0_dp)
      do k = 1, intervals
         parts(k) = parts(k - 1) + bias**(1 - k)
      end do
      do i = 1, size(from)
         x(:, 1) = node_place(all, from(i))
         x(:, 2) = node_place(all, to(i))
         do k = 1, intervals - 1
            call add_numbers(data, [from(i) + k*step], all, x(:, 1) + (x(:, 2) - x(:, 1))*(parts( &
               k)/ parts(intervals)))
         end do
      end do
   end subroutine fill_nodes

   !> A node set, or one node, of the cards so far.
   subroutine end_of_fill(data, i, all, numbers, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i                          ! position of the field
      type(growing_cards_type), intent(in) :: all
      integer, allocatable, intent(out) :: numbers(:)
      logical, intent(inout) :: valid
      integer :: k, number
      logical :: is_number

      call read_integer(data%text(i), number, is_number)
      numbers = [number]
      if (.not. is_number) numbers = members_of(all, 'NSET', data%text(i))
      numbers = pack(numbers, [(is_given(numbers(k), all%nodes), k=1, size(numbers))])
      if (size(numbers) > 0) return
      call all%report%error(data%place(i), 'no *NODE before this card has node or set '// &
         to_upper(data%text(i)))
      valid = .false.
   end subroutine end_of_fill

   !> *NCOPY: copies of the nodes of a set, shifted and then turned about an axis along z, MULTIPLE=
   !> times, or reflected at a line. A copy that is there already, as on a seam, is that node.
   subroutine copy_nodes(card, all)
      type(keyword_card_type), intent(in) :: card
      type(growing_cards_type), intent(inout) :: all            !! receives the cards
      integer, allocatable :: numbers(:)
      type(motion_type) :: motion
      real(dp), allocatable :: x(:, :)
      real(dp) :: points(6)
      integer :: change, errors, i, times
      logical, allocatable :: is_there(:)
      logical :: valid

      errors = all%report%error_count()
      call take_old_set(card, 'NSET', all%nodes, all, numbers)
      call need_shift(card, 'CHANGE NUMBER', all, change)
      if (.not. card%has('REFLECT')) then
         if (card%lacks('SHIFT')) call all%report%error(card%place, '*NCOPY needs SHIFT or '// &
            'REFLECT=LINE')
         times = 1
         call take_parameter(card, 'MULTIPLE', all%report, times, '>=1')
         call read_motion(card%data, times, all%report, motion)
      else if (choice(card, 'REFLECT', 'LINE', all%report, '') == 'LINE') then
         call read_row(card%data(1), axis_layout, all%report, points, valid)
         associate (along => points(4:5) - points(1:2))
            if (valid .and. norm2(along) <= 0.0_dp) call all%report%error( &
               card%data(1)%place(1), 'the two points of the line coincide')
            motion%turn = rotation(2*atan2(along(2), along(1)))
         end associate
         motion%turn(:, 2) = -motion%turn(:, 2)
         motion%shift = points(1:2) - matmul(motion%turn, points(1:2))
      end if
      if (card%flawed .or. all%report%error_count() > errors) then
         call all%report%lose('node')
         return
      end if
      allocate (x(2, size(numbers)), is_there(size(numbers)))
      do i = 1, size(numbers)
         x(:, i) = motion%moved(node_place(all, numbers(i)))
      end do
      do i = 1, size(numbers)
         is_there(i) = is_given(numbers(i) + change, all%nodes)
         if (is_there(i)) is_there(i) = norm2(node_place(all, numbers(i) + change) - x(:, i)) <= &
            same_place*maxval(abs(x))
      end do
      call add_copies_card(card, 'NODE', 'NSET', '', all)
      do i = 1, size(numbers)
         if (.not. is_there(i)) call add_numbers(card%data(1), [numbers(i) + change], all, x(:, i))
      end do
      if (.not. (any(is_there) .and. card%has('NEW SET'))) return
      call add_copies_card(card, 'NSET', 'NSET', '', all)
      call add_numbers(card%data(1), pack(numbers + change, is_there), all)
   end subroutine copy_nodes

   !> *ELCOPY: copies of the elements of a set; with REFLECT their nodes go round the other way.
   subroutine copy_elements(card, all)
      type(keyword_card_type), intent(in) :: card
      type(growing_cards_type), intent(inout) :: all            !! receives the cards
      character(:), allocatable :: kind, last_kind
      integer, allocatable :: corners(:), numbers(:)
      type(data_card_type) :: data
      integer :: at(2), errors, i, n, node_shift, shift

      errors = all%report%error_count()
      call take_old_set(card, 'ELSET', all%elements, all, numbers)
      call need_shift(card, 'ELEMENT SHIFT', all, shift)
      call need_shift(card, 'SHIFT NODES', all, node_shift)
      if (card%flawed .or. all%report%error_count() > errors) then
         call all%report%lose('element')
         return
      end if
      last_kind = ''
      do i = 1, size(numbers)
         at = card_of(numbers(i), all%elements)
         kind = all%keywords(at(1))%text('TYPE')
         if (kind /= last_kind) call add_copies_card(card, 'ELEMENT', 'ELSET', kind, all)
         last_kind = kind
         data = all%keywords(at(1))%data(at(2))
         corners = corners_of(data)
         if (card%has('REFLECT')) then   ! 1 4 3 2, and midside nodes 8 7 6 5
            n = size(corners)
            if (any(n == [6, 8])) n = n/2
            corners = [corners(1), corners(n:2:-1), corners(size(corners):n + 1:-1)]
         end if
         data%fields = data%fields(:1)
         data%fields(1)%place = card%place
         call add_numbers(data, [numbers(i) + shift, corners + node_shift], all)
      end do
   end subroutine copy_elements

   !> The nodes or elements of OLD SET=.
   subroutine take_old_set(card, keyword, given, all, numbers)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: keyword               ! NSET or ELSET
      type(number_list_type), intent(in) :: given
      type(growing_cards_type), intent(in) :: all
      integer, allocatable, intent(out) :: numbers(:)
      character(:), allocatable :: name
      integer :: i

      call need_parameter(card, 'OLD SET', all%report, name)
      if (len(name) == 0) return
      numbers = members_of(all, keyword, name)
      numbers = pack(numbers, [(is_given(numbers(i), given), i=1, size(numbers))])
      if (size(numbers) > 0) return
      call all%report%error(card%place_of('OLD SET'), 'no card before this one gives set '//name// &
         ' a node or element')
   end subroutine take_old_set

   subroutine need_shift(card, name, all, shift)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                  ! of the parameter
      type(growing_cards_type), intent(in) :: all
      integer, intent(out) :: shift
      character(:), allocatable :: text

      shift = 0
      call need_parameter(card, name, all%report, text)
      call take_parameter(card, name, all%report, shift)
   end subroutine need_shift

   !> Adds the keyword card of copies, which are in the set NEW SET=.
   subroutine add_copies_card(card, keyword, set, element_type, all)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: keyword, set
      character(*), intent(in) :: element_type          ! TYPE=, or empty
      type(growing_cards_type), intent(inout) :: all
      type(keyword_card_type) :: named
      integer :: i

      named = card
      named%parameters = pack(card%parameters, [(card%parameters(i)%name == 'NEW SET', &
         i=1, size(card%parameters))])
      if (size(named%parameters) > 0) named%parameters(1)%name = set
      call add_generated(named, keyword, element_type, all)
   end subroutine add_copies_card

end module generated_cards
