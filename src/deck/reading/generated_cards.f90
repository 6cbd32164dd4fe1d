!> *NGEN, *NFILL, *NCOPY, *ELGEN and *ELCOPY -> the *NODE and *ELEMENT cards that they stand for.
module generated_cards
   use card_parameters, only: choice, take_parameter
   use card_values, only: read_row
   use cards, only: add_data, add_keyword, cards_type, data_card_type, keyword_card_type, &
      replace_cards
   use copied_cards, only: copy_elements, copy_nodes, fill_nodes
   use deck_report, only: deck_report_type
   use given_cards, only: add_generated, add_numbers, add_set, corners_of, &
      card_of, growing_cards_type, is_given, keep_last, node_place
   use kinds, only: dp
   use plane_motions, only: rotation
   use text, only: to_text
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

   !> First and last node, increment: the nodes between the two, at equal distances on a line or,
   !> with LINE=C, on a circle.
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

   !> A node of the cards so far, and its place.
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

end module generated_cards
