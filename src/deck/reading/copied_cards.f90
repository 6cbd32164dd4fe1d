!> *NFILL, *NCOPY and *ELCOPY of Abaqus -> the *NODE and *ELEMENT cards that they stand for: nodes
!> between two sets, and copies of sets.
module copied_cards
   use card_parameters, only: choice, need_parameter, take_parameter
   use card_values, only: read_row
   use cards, only: data_card_type, keyword_card_type
   use deck_report, only: deck_report_type
   use given_cards, only: add_generated, add_node_card, add_numbers, add_set, corners_of, &
      given_type, growing_cards_type, keep_last, members_of, node_place, position_of, rotation
   use kinds, only: dp
   use text, only: read_integer, to_text, to_upper
   implicit none
   private
   public :: fill_nodes, copy_nodes, copy_elements

   integer, parameter :: most_intervals = 10000   !! of *NFILL

   character(*), parameter :: axis_layout = 'x of point 1?/y of point 1?/z of point 1?/'// &
      'x of point 2?/y of point 2?/z of point 2? =1'

   real(dp), parameter :: same_place = 1.0e-6_dp   !! distance, by the largest coordinate
   real(dp), parameter :: degree = acos(-1.0_dp)/180.0_dp

contains

   !> *NFILL: nodes between those of two sets, in the order of their numbers, at equal distances or,
   !> with BIAS=, at distances of which each is the one behind it times the bias.
   subroutine fill_nodes(card, all)
      type(keyword_card_type), intent(in) :: card
      type(growing_cards_type), intent(inout) :: all            !! receives the cards
      real(dp) :: bias
      integer :: j

      bias = 1.0_dp
      call take_parameter(card, 'BIAS', all%report, bias, '>0')
      do j = 1, size(card%data)
         call fill_line(card, card%data(j), bias, all)
      end do
   end subroutine fill_nodes

   !> Two sets or nodes, number of intervals, increment.
   subroutine fill_line(card, data, bias, all)
      type(keyword_card_type), intent(in) :: card
      type(data_card_type), intent(in) :: data
      real(dp), intent(in) :: bias
      type(growing_cards_type), intent(inout) :: all
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
         x(:, 1) = node_place(all, position_of(from(i), all%nodes))
         x(:, 2) = node_place(all, position_of(to(i), all%nodes))
         do k = 1, intervals - 1
            call add_node_card(data, from(i) + k*step, x(:, 1) + (x(:, 2) - x(:, &
               1))*(parts(k)/parts(intervals)), all)
         end do
      end do
   end subroutine fill_line

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
      numbers = pack(numbers, [(position_of(numbers(k), all%nodes) > 0, k=1, size(numbers))])
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
      real(dp) :: center(2), shift(2), turn(2, 2)
      real(dp), allocatable :: x(:, :)
      integer :: at, change, i
      logical :: valid
      logical, allocatable :: is_there(:)

      valid = .true.
      change = 0
      if (size(card%data) > 2) call all%report%error(card%data(3)%place(1), 'extra data card; '// &
         '*NCOPY has at most 2')
      call take_old_set(card, 'NSET', all%nodes, all, numbers, valid)
      call need_shift(card, 'CHANGE NUMBER', all%report, change, valid)
      call read_motion(card, card%data, all%report, center, shift, turn, valid)
      if (.not. valid) then
         call all%report%lose('node')
         return
      end if
      allocate (x(2, size(numbers)), is_there(size(numbers)))
      do i = 1, size(numbers)
         x(:, i) = matmul(turn, node_place(all, position_of(numbers(i), all%nodes)) + shift - &
            center) + center
      end do
      do i = 1, size(numbers)
         at = position_of(numbers(i) + change, all%nodes)
         is_there(i) = at > 0
         if (at > 0) is_there(i) = norm2(node_place(all, at) - x(:, i)) <= same_place*maxval(abs(x))
      end do
      associate (data => card%data(1))
         call add_copies_card(card, 'NODE', 'NSET', '', all)
         do i = 1, size(numbers)
            if (.not. is_there(i)) call add_node_card(data, numbers(i) + change, x(:, i), all)
         end do
         if (.not. (any(is_there) .and. card%has('NEW SET'))) return
         call add_copies_card(card, 'NSET', 'NSET', '', all)
         call add_numbers(data, pack(numbers + change, is_there), all)
      end associate
   end subroutine copy_nodes

   !> What a copy does to a place: x -> turn (x + shift - center) + center.
   subroutine read_motion(card, rows, report, center, shift, turn, valid)
      type(keyword_card_type), intent(in) :: card
      type(data_card_type), intent(in) :: rows(:)
      type(deck_report_type), intent(inout) :: report
      real(dp), intent(out) :: center(2), shift(2), turn(2, 2)
      logical, intent(inout) :: valid
      character(:), allocatable :: kind
      real(dp) :: angle, moved(3), points(7)
      integer :: times
      logical :: sound

      kind = choice(card, 'REFLECT', 'LINE', report, '')
      valid = valid .and. (kind == 'LINE' .or. .not. card%has('REFLECT'))
      if (.not. valid) return
      shift = 0.0_dp
      angle = 0.0_dp
      points = [0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp]
      if (kind == 'LINE') then
         call read_row(rows(1), axis_layout, report, points, valid)
         associate (along => points(4:5) - points(1:2))
            if (valid .and. norm2(along) <= 0.0_dp) then
               call report%error(rows(1)%place(1), 'the two points of the line coincide')
               valid = .false.
            end if
            angle = 2.0_dp*atan2(along(2), along(1))
         end associate
         turn = reshape([cos(angle), sin(angle), sin(angle), -cos(angle)], [2, 2])
      else
         if (card%lacks('SHIFT')) then
            call report%error(card%place, '*NCOPY needs SHIFT or REFLECT=LINE')
            valid = .false.
         end if
         call read_row(rows(1), 'shift along x?/shift along y?/shift along z?', report, moved, &
            sound)
         shift = moved(:2)
         valid = valid .and. sound
         if (size(rows) > 1) then
            call read_row(rows(2), axis_layout//'/angle?', report, points, sound)
            valid = valid .and. sound
            if (valid .and. norm2(points(4:5) - points(1:2)) > 0.0_dp) call report%error( &
               rows(2)%place(4), 'the axis of the turn must be parallel to z')
            times = 1
            call take_parameter(card, 'MULTIPLE', report, times, '>=1')
            angle = sign(1.0_dp, points(6) - points(3))*points(7)*times*degree
         end if
         turn = rotation(angle)
      end if
      center = points(:2)
   end subroutine read_motion

   !> *ELCOPY: copies of the elements of a set; with REFLECT their nodes go round the other way.
   subroutine copy_elements(card, all)
      type(keyword_card_type), intent(in) :: card
      type(growing_cards_type), intent(inout) :: all            !! receives the cards
      character(:), allocatable :: kind, last_kind
      integer, allocatable :: corners(:), numbers(:)
      type(data_card_type) :: data
      integer :: at, i, node_shift, shift
      logical :: valid

      valid = .true.
      shift = 0
      node_shift = 0
      if (size(card%data) > 0) call all%report%error(card%place, '*ELCOPY has no data')
      call take_old_set(card, 'ELSET', all%elements, all, numbers, valid)
      call need_shift(card, 'ELEMENT SHIFT', all%report, shift, valid)
      call need_shift(card, 'SHIFT NODES', all%report, node_shift, valid)
      if (.not. valid) then
         call all%report%lose('element')
         return
      end if
      last_kind = ''
      do i = 1, size(numbers)
         at = position_of(numbers(i), all%elements)
         kind = all%keywords(all%elements%keyword(at))%text('TYPE')
         if (kind /= last_kind) call add_copies_card(card, 'ELEMENT', 'ELSET', kind, all)
         last_kind = kind
         data = all%keywords(all%elements%keyword(at))%data(all%elements%card(at))
         corners = corners_of(data)
         if (card%has('REFLECT')) corners = reflected(corners)
         data%fields = data%fields(:1)
         data%fields(1)%place = card%place
         call add_numbers(data, [numbers(i) + shift, corners + node_shift], all)
         call keep_last(all)
      end do
   end subroutine copy_elements

   !> The nodes of an element the other way round: 1 4 3 2, and its midside nodes 8 7 6 5.
   pure function reflected(nodes) result(back)
      integer, intent(in) :: nodes(:)
      integer :: back(size(nodes))
      integer :: corners

      corners = size(nodes)
      if (any(corners == [6, 8])) corners = corners/2
      back(:corners) = [nodes(1), nodes(corners:2:-1)]
      back(corners + 1:) = nodes(size(nodes):corners + 1:-1)
   end function reflected

   !> The nodes or elements of OLD SET=.
   subroutine take_old_set(card, keyword, given, all, numbers, valid)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: keyword               ! NSET or ELSET
      type(given_type), intent(in) :: given
      type(growing_cards_type), intent(in) :: all
      integer, allocatable, intent(out) :: numbers(:)
      logical, intent(inout) :: valid
      character(:), allocatable :: name
      integer :: i

      allocate (numbers(0))
      call need_parameter(card, 'OLD SET', all%report, name)
      valid = valid .and. len(name) > 0
      if (.not. valid) return
      numbers = members_of(all, keyword, name)
      numbers = pack(numbers, [(position_of(numbers(i), given) > 0, i=1, size(numbers))])
      if (size(numbers) > 0) return
      call all%report%error(card%place_of('OLD SET'), 'no card before this one gives set '//name// &
         ' a node or element')
      valid = .false.
   end subroutine take_old_set

   !> What the numbers of the copies have above those of the set.
   subroutine need_shift(card, name, report, shift, valid)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                  ! of the parameter
      type(deck_report_type), intent(inout) :: report
      integer, intent(inout) :: shift
      logical, intent(inout) :: valid
      integer :: errors

      errors = report%error_count()
      call take_parameter(card, name, report, shift)
      valid = valid .and. report%error_count() == errors
      if (card%lacks(name)) call report%error(card%place, '*'//card%name//' needs '//name//'=')
      valid = valid .and. card%has(name)
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

end module copied_cards
