!> *NGEN and *ELGEN -> the *NODE and *ELEMENT cards that they stand for.
module generated_cards
   use card_parameters, only: has_parameter, parameter_text
   use card_values, only: check_extra, need_field, take_field
   use cards, only: add_data, add_keyword, cards_type, data_card_type, field_place, field_text, &
      field_type, keyword_card_type, parameter_type, replace_cards
   use deck_report, only: deck_report_type
   use keywords, only: find_keyword
   use kinds, only: dp
   use text, only: read_integer, read_real, string_type, to_text
   implicit none
   private
   public :: generate_cards, exact_text

   integer, parameter :: most_generated = 10000000   !! nodes or elements of one data card
   character(*), parameter :: too_many = 'a card generates at most 10000000 nodes or elements'

   !> Nodes, or elements, of the cards so far.
   type :: given_type
      integer :: count = 0
      integer, allocatable :: number(:)      !! (capacity) their numbers
      integer, allocatable :: keyword(:)     !! (capacity) keyword card
      integer, allocatable :: card(:)        !! (capacity) data card
   end type given_type

contains

   !> Replaces each *NGEN by *NODE and each *ELGEN by *ELEMENT, with the data that they generate.
   !> Generated cards have the place of the data card that generates them.
   subroutine generate_cards(cards, report)
      type(cards_type), intent(inout) :: cards
      type(deck_report_type), intent(inout) :: report   !! receives errors
      type(cards_type) :: all
      type(given_type) :: nodes, elements
      integer :: k, j

      do k = 1, size(cards%keywords)
         if (generates(cards%keywords(k))) exit
      end do
      if (k > size(cards%keywords)) return
      do k = 1, size(cards%keywords)
         associate (card => cards%keywords(k))
            if (.not. generates(card)) then
               call add_keyword(all, card)
               do j = card%first_data, card%last_data
                  call add_data(all, cards%data(j)%fields, cards%data(j)%end)
                  if (card%name == 'NODE') call keep_last(all, nodes)
                  if (card%name == 'ELEMENT') call keep_last(all, elements)
               end do
            else if (card%name == 'NGEN') then
               do j = card%first_data, card%last_data
                  call generate_nodes(card, cards%data(j), nodes, report, all)
               end do
            else
               do j = card%first_data, card%last_data
                  call generate_elements(card, cards%data(j), elements, report, all)
               end do
            end if
         end associate
      end do
      call replace_cards(cards, all)
   end subroutine generate_cards

   !> Whether a card generates something; without data it is reported elsewhere.
   pure logical function generates(card)
      type(keyword_card_type), intent(in) :: card

      generates = (card%name == 'NGEN' .or. card%name == 'ELGEN') .and. &
         card%last_data >= card%first_data
   end function generates

   !> First and last node, increment: the nodes between the two, at equal distances on a line.
   subroutine generate_nodes(card, data, nodes, report, all)
      type(keyword_card_type), intent(in) :: card
      type(data_card_type), intent(in) :: data
      type(given_type), intent(inout) :: nodes
      type(deck_report_type), intent(inout) :: report
      type(cards_type), intent(inout) :: all
      type(string_type) :: words(3)
      real(dp) :: place(2), x(2, 2)
      integer :: ends(2), at, step, i, j, n
      logical :: valid, is_number

      valid = .true.
      step = 1
      call need_field(data, 1, 'first node', report, ends(1), valid)
      call need_field(data, 2, 'last node', report, ends(2), valid)
      call take_field(data, 3, 'increment', report, step, valid)
      call check_extra(data, 3, 'first node, last node, increment', report)
      do i = 1, 2
         if (.not. valid) exit
         at = position_of(ends(i), nodes)
         valid = at > 0
         if (valid) then
            ! A coordinate that is no number is 0 here and reported elsewhere.
            do j = 1, 2
               call read_real(field_text(all%data(nodes%card(at)), j + 1), x(j, i), is_number)
            end do
         else
            call report%error(field_place(data, i), 'no *NODE before this card has node '// &
               to_text(ends(i)))
         end if
      end do
      if (valid) call check_range(data, ends, step, report, valid)
      if (.not. valid) then
         call report%lose('node')
         return
      end if
      call add_set(card, 'NSET', data, ends, all)
      n = (ends(2) - ends(1))/step
      if (n > 1) call add_generated(card, 'NODE', '', all)
      do i = 1, n - 1
         place = x(:, 1) + (x(:, 2) - x(:, 1))*i/n
         words(1)%value = to_text(ends(1) + i*step)
         words(2)%value = exact_text(place(1))
         words(3)%value = exact_text(place(2))
         call add_fields(data, words, all)
         call keep_last(all, nodes)
      end do
   end subroutine generate_nodes

   !> The increment leads from the first number to the last.
   subroutine check_range(data, ends, step, report, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: ends(2), step
      type(deck_report_type), intent(inout) :: report
      logical, intent(inout) :: valid

      valid = step > 0 .and. ends(2) > ends(1)
      if (valid) valid = mod(ends(2) - ends(1), step) == 0
      if (.not. valid) then
         call report%error(field_place(data, 3), 'increments of '//to_text(step)// &
            ' do not lead from '//to_text(ends(1))//' to '//to_text(ends(2)))
      else if ((ends(2) - ends(1))/step > most_generated) then
         call report%error(field_place(data, 2), too_many)
         valid = .false.
      end if
   end subroutine check_range

   !> Master element; then for the elements of a row, and for the rows, their number and the
   !> increments of their nodes and of their own numbers.
   subroutine generate_elements(card, data, elements, report, all)
      type(keyword_card_type), intent(in) :: card
      type(data_card_type), intent(in) :: data
      type(given_type), intent(in) :: elements
      type(deck_report_type), intent(inout) :: report
      type(cards_type), intent(inout) :: all
      integer, allocatable :: corners(:)
      integer :: master, at, counts(2), steps(2, 2), i, j
      logical :: valid

      valid = .true.
      call need_field(data, 1, 'master element', report, master, valid)
      call read_rows(data, counts, steps, report, valid)
      at = 0
      if (valid) at = position_of(master, elements)
      if (valid .and. at == 0) call report%error(field_place(data, 1), &
         'no *ELEMENT before this card has element '//to_text(master))
      if (at == 0) then
         call report%lose('element')
         return
      end if
      corners = corners_of(all%data(elements%card(at)))
      call add_set(card, 'ELSET', data, [master], all)
      if (product(counts) > 1) call add_generated(card, 'ELEMENT', &
         parameter_text(all%keywords(elements%keyword(at)), 'TYPE'), all)
      do j = 0, counts(2) - 1
         do i = 0, counts(1) - 1
            if (i + j > 0) call add_numbers(data, [master + i*steps(2, 1) + j*steps(2, 2), &
               corners + i*steps(1, 1) + j*steps(1, 2)], all)
         end do
      end do
   end subroutine generate_elements

   subroutine read_rows(data, counts, steps, report, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(out) :: counts(2)      ! elements of a row, and rows
      integer, intent(out) :: steps(2, 2)    ! increments of nodes and elements, of both
      type(deck_report_type), intent(inout) :: report
      logical, intent(inout) :: valid
      character(*), parameter :: nouns(2) = [character(8) :: 'elements', 'rows']
      integer :: i

      counts = 1
      steps = 1
      do i = 1, 2
         call take_field(data, 3*i - 1, 'number of '//trim(nouns(i)), report, counts(i), valid)
         call take_field(data, 3*i, 'increment of nodes', report, steps(1, i), valid)
         call take_field(data, 3*i + 1, 'increment of elements', report, steps(2, i), valid)
         if (.not. valid .or. counts(i) > 0) cycle
         call report%error(field_place(data, 3*i - 1), 'the number of '//trim(nouns(i))// &
            ' must be positive')
         valid = .false.
      end do
      call check_extra(data, 7, 'master element, elements of a row, increments of nodes and '// &
         'elements, rows, increments of nodes and elements', report)
      if (.not. valid .or. real(counts(1), dp)*counts(2) <= most_generated) return
      call report%error(field_place(data, 2), too_many)
      valid = .false.
   end subroutine read_rows

   !> Puts what the generating card names itself into its set.
   subroutine add_set(card, keyword, data, numbers, all)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: keyword     ! NSET or ELSET, which is also the parameter
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: numbers(:)
      type(cards_type), intent(inout) :: all

      if (.not. has_parameter(card, keyword)) return
      call add_generated(card, keyword, '', all)
      call add_numbers(data, numbers, all)
   end subroutine add_set

   !> Adds a keyword card in the place of the generating one, and with its set.
   subroutine add_generated(card, keyword, element_type, all)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: keyword
      character(*), intent(in) :: element_type    ! TYPE=, or empty
      type(cards_type), intent(inout) :: all
      type(keyword_card_type) :: generated
      type(parameter_type) :: type_parameter

      generated%name = keyword
      generated%meant = ''
      generated%known = find_keyword(keyword)
      generated%place = card%place
      generated%parameters = card%parameters
      if (len(element_type) > 0) then
         type_parameter = parameter_type('TYPE', element_type, card%place, card%place)
         generated%parameters = [generated%parameters, type_parameter]
      end if
      call add_keyword(all, generated)
   end subroutine add_generated

   subroutine add_numbers(data, numbers, all)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: numbers(:)
      type(cards_type), intent(inout) :: all
      type(string_type) :: words(size(numbers))
      integer :: i

      do i = 1, size(numbers)
         words(i)%value = to_text(numbers(i))
      end do
      call add_fields(data, words, all)
   end subroutine add_numbers

   subroutine add_fields(data, words, all)
      type(data_card_type), intent(in) :: data
      type(string_type), intent(in) :: words(:)
      type(cards_type), intent(inout) :: all
      type(field_type), allocatable :: fields(:)
      integer :: i

      allocate(fields(size(words)))
      do i = 1, size(words)
         fields(i)%text = words(i)%value
         fields(i)%place = field_place(data, 1)
      end do
      call add_data(all, fields, data%end)
   end subroutine add_fields

   !> Remembers the node or element of the last data card; fields that are no numbers are reported
   !> elsewhere.
   subroutine keep_last(all, given)
      type(cards_type), intent(in) :: all
      type(given_type), intent(inout) :: given
      integer :: number
      logical :: valid

      call read_integer(field_text(all%data(all%data_count), 1), number, valid)
      if (.not. valid) return
      if (.not. allocated(given%number)) allocate(given%number(0), given%keyword(0), given%card(0))
      if (given%count == size(given%number)) then
         given%number = [given%number, spread(0, 1, given%count + 64)]
         given%keyword = [given%keyword, spread(0, 1, given%count + 64)]
         given%card = [given%card, spread(0, 1, given%count + 64)]
      end if
      given%count = given%count + 1
      given%number(given%count) = number
      given%keyword(given%count) = all%keyword_count
      given%card(given%count) = all%data_count
   end subroutine keep_last

   !> Position of a number in a list, the last one where there are several; 0 where it is not.
   pure integer function position_of(number, given)
      integer, intent(in) :: number
      type(given_type), intent(in) :: given

      position_of = 0
      if (given%count > 0) position_of = findloc(given%number(:given%count), number, dim=1, &
         back=.true.)
   end function position_of

   !> Nodes of an element, up to the first field that is no number.
   pure function corners_of(data) result(corners)
      type(data_card_type), intent(in) :: data
      integer, allocatable :: corners(:)
      integer :: i, number
      logical :: valid

      allocate(corners(0))
      do i = 2, size(data%fields)
         call read_integer(data%fields(i)%text, number, valid)
         if (.not. valid) exit
         corners = [corners, number]
      end do
   end function corners_of

   !> A number with all of its digits.
   function exact_text(value) result(string)
      real(dp), intent(in) :: value
      character(:), allocatable :: string
      character(32) :: buffer

      write (buffer, '(es24.16e3)') value
      string = trim(adjustl(buffer))
   end function exact_text

end module generated_cards
