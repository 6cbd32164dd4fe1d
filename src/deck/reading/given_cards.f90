!> Nodes and elements of the cards so far, and the cards that are added to them where a card stands
!> for others; motions of nodes by a translation and a rotation, which stay in the plane.
module given_cards
   use card_values, only: read_row
   use cards, only: add_data, add_keyword, cards_type, data_card_type, field_type, &
      keyword_card_type, parameter_type
   use deck_report, only: deck_report_type
   use keywords, only: find_keyword
   use kinds, only: dp
   use name_index, only: name_index_type
   use number_lists, only: number_list_type
   use sorting, only: unique_sorted
   use text, only: append, read_integer, read_real, string_type, to_text, to_upper
   implicit none
   private
   public :: growing_cards_type, add_set, add_generated, add_numbers, node_place, keep_last, &
      members_of, card_of, is_given, corners_of, exact_text, motion_type, read_motion, rotation, &
      axis_layout

   !> Cards that take the place of others, so far.
   type, extends(cards_type) :: growing_cards_type
      !> nodes and elements of these cards: number, keyword card and data card of each
      type(number_list_type) :: nodes, elements
      type(deck_report_type), pointer :: report => null()         !! what is wrong with the deck
   end type growing_cards_type

   !> Two points of an axis, as read_row.
   character(*), parameter :: axis_layout = 'x of point 1?/y of point 1?/z of point 1?/'// &
      'x of point 2?/y of point 2?/z of point 2? =1'

   real(dp), parameter :: degree = acos(-1.0_dp)/180
   real(dp), parameter :: negligible = 1.0e-9_dp   !! part of a direction or distance

   !> What becomes of a place x: turn x + shift.
   type :: motion_type
      real(dp) :: turn(2, 2) = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])
      real(dp) :: shift(2) = 0.0_dp   !! [length]
   contains
      procedure :: moved
   end type motion_type

contains

   !> Puts what the generating card names itself into its set.
   subroutine add_set(card, keyword, data, numbers, all)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: keyword           !! NSET or ELSET, which is also the parameter
      type(data_card_type), intent(in) :: data      !! whose place the cards have
      integer, intent(in) :: numbers(:)             !! of nodes or elements
      type(growing_cards_type), intent(inout) :: all        !! receives the cards

      if (.not. card%has(keyword)) return
      call add_generated(card, keyword, '', all)
      call add_numbers(data, numbers, all)
   end subroutine add_set

   !> Adds a keyword card in the place of the generating one, and with its set.
   subroutine add_generated(card, keyword, element_type, all)
      type(keyword_card_type), intent(in) :: card   !! the generating one
      character(*), intent(in) :: keyword           !! NODE, ELEMENT, NSET or ELSET
      character(*), intent(in) :: element_type      !! TYPE=, or empty
      type(growing_cards_type), intent(inout) :: all        !! receives the card
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

   !> Adds a data card of numbers and, of a node, its place.
   subroutine add_numbers(data, numbers, all, x)
      type(data_card_type), intent(in) :: data      !! whose place it has
      integer, intent(in) :: numbers(:)             !! its fields
      type(growing_cards_type), intent(inout) :: all        !! receives the card
      real(dp), intent(in), optional :: x(2)        !! the fields behind them [length]
      type(field_type), allocatable :: fields(:)
      integer :: i, n

      n = size(numbers)
      allocate (fields(n + merge(2, 0, present(x))))
      do i = 1, size(fields)
         if (i <= n) fields(i)%text = to_text(numbers(i))
         if (i > n) fields(i)%text = exact_text(x(i - n))
         fields(i)%place = data%place(1)
      end do
      call add_data(all, fields, data%end)
      call keep_last(all)
   end subroutine add_numbers

   !> Place of a node that is given; a coordinate that is no number is 0 and reported elsewhere.
   function node_place(all, number) result(x)
      type(growing_cards_type), intent(in) :: all
      integer, intent(in) :: number
      real(dp) :: x(2)                              !! [length]
      integer :: card(2), i
      logical :: is_number

      x = 0.0_dp
      card = card_of(number, all%nodes)
      do i = 1, 2
         call read_real(all%keywords(card(1))%data(card(2))%text(i + 1), x(i), is_number)
      end do
   end function node_place

   !> Remembers the node or element of the last data card; what is no number is reported elsewhere.
   subroutine keep_last(all)
      type(growing_cards_type), intent(inout) :: all
      integer :: number
      logical :: valid

      associate (last => all%keywords(all%keyword_count))
         if (.not. any(last%name == ['NODE   ', 'ELEMENT'])) return
         call read_integer(last%data(last%data_count)%text(1), number, valid)
         if (.not. valid) return
         if (last%name == 'NODE') call all%nodes%add([number, all%keyword_count, last%data_count])
         if (last%name == 'ELEMENT') call all%elements%add([number, all%keyword_count, &
            last%data_count])
      end associate
   end subroutine keep_last

   !> Numbers of a set of the cards so far, each once and ascending; others are reported elsewhere.
   function members_of(all, keyword, name) result(numbers)
      type(growing_cards_type), intent(in) :: all
      character(*), intent(in) :: keyword           !! NSET or ELSET
      character(*), intent(in) :: name              !! of the set, in any case
      integer, allocatable :: numbers(:)
      type(string_type), allocatable :: names(:)    ! of it and the sets in it, each once
      type(name_index_type) :: known                ! the same names
      type(number_list_type) :: found
      integer :: i, j, k, n, number, range(3)
      logical :: is_set, valid

      call add_name(name, known, names)
      n = 0
      do while (n < size(names))
         n = n + 1
         do k = 1, all%keyword_count
            associate (card => all%keywords(k))
               if (to_upper(card%text(keyword)) /= names(n)%value) cycle
               is_set = card%name == keyword
               if (.not. (is_set .or. any(card%name == ['NODE   ', 'ELEMENT']))) cycle
               do j = 1, card%data_count
                  range(3) = 1
                  do i = 1, merge(size(card%data(j)%fields), 1, is_set)
                     call read_integer(card%data(j)%text(i), number, valid)
                     if (card%has('GENERATE')) then
                        if (i <= 3) range(i) = number
                     else if (valid) then
                        call found%add([number])
                     else if (is_set) then
                        call add_name(card%data(j)%text(i), known, names)
                     end if
                  end do
                  if (card%has('GENERATE') .and. range(3) > 0) call found%add([(i, i=range(1), &
                     range(2), range(3))])
               end do
            end associate
         end do
      end do
      numbers = unique_sorted(found%numbers())
   end function members_of

   subroutine add_name(name, known, names)
      character(*), intent(in) :: name
      type(name_index_type), intent(inout) :: known
      type(string_type), allocatable, intent(inout) :: names(:)

      if (known%find(name) > 0) return
      call known%add(name)
      call append(names, to_upper(name))
   end subroutine add_name

   !> Keyword card and data card of a node or element, of several the last ones; 0 for none.
   pure function card_of(number, given) result(card)
      integer, intent(in) :: number                 !! of a node or element
      type(number_list_type), intent(in) :: given   !! as of growing_cards_type
      integer :: card(2), at

      associate (list => given%numbers())
         at = findloc(list(1::3), number, dim=1, back=.true.)
         card = 0
         if (at > 0) card = list(3*at - 1:3*at)
      end associate
   end function card_of

   !> Whether a node or element is given.
   pure logical function is_given(number, given)
      integer, intent(in) :: number                 !! of a node or element
      type(number_list_type), intent(in) :: given   !! as of growing_cards_type

      is_given = any(card_of(number, given) > 0)
   end function is_given

   !> Nodes of an element, up to the first field that is no number.
   pure function corners_of(data) result(corners)
      type(data_card_type), intent(in) :: data      !! of *ELEMENT
      integer, allocatable :: corners(:)            !! numbers of its nodes
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
      character(:), allocatable :: string           !! such as 1.0000000000000000E+000
      character(32) :: buffer

      write (buffer, '(es24.16e3)') value
      string = trim(adjustl(buffer))
   end function exact_text

   !> A place behind the motion.
   pure function moved(self, x)
      class(motion_type), intent(in) :: self
      real(dp), intent(in) :: x(2)                       !! [length]
      real(dp) :: moved(2)                               !! [length]

      moved = matmul(self%turn, x) + self%shift
   end function moved

   !> Reads a translation and, on a second card, axis and angle of the rotation that follows it.
   subroutine read_motion(rows, times, report, motion)
      type(data_card_type), intent(in) :: rows(:)
      integer, intent(in) :: times                       !! the angle counts as often
      class(deck_report_type), intent(inout) :: report   !! receives errors
      type(motion_type), intent(out) :: motion           !! receives what is sound of it
      real(dp) :: x(7)
      logical :: valid

      if (size(rows) == 0) return
      call read_row(rows(1), 'translation along x?/translation along y?/translation along z?', &
         report, x(:3), valid)
      motion%shift = x(:2)
      if (abs(x(3)) > negligible*maxval(abs(x(:3)))) call report%error(rows(1)%place(3), &
         'models stay in the plane: the translation along z must be 0')
      if (size(rows) == 1) return
      call read_row(rows(2), axis_layout//'/angle in degrees?', report, x, valid)
      if (.not. valid) return
      associate (axis => x(4:6) - x(:3))
         if (norm2(axis(:2)) > negligible*norm2(axis) .or. norm2(axis) <= 0.0_dp) call &
            report%error(rows(2)%place(1), 'models stay in the plane: the axis of the rotation '// &
            'is along z, such as 0., 0., 0., 0., 0., 1., 90.')
         motion%turn = rotation(sign(times*degree, axis(3))*x(7))
      end associate
      motion%shift = x(:2) + matmul(motion%turn, motion%shift - x(:2))
   end subroutine read_motion

   !> Turns a place about the origin.
   pure function rotation(angle)
      real(dp), intent(in) :: angle                      !! anticlockwise [rad]
      real(dp) :: rotation(2, 2)

      rotation = reshape([cos(angle), sin(angle), -sin(angle), cos(angle)], [2, 2])
   end function rotation

end module given_cards
