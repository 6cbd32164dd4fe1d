!> *ELEMENT of lines, which mesh generators write for the curves of a drawing: they are no elements
!> of the mesh, but their sets name nodes, and the faces under them.
module deck_builder_lines
   use card_values, only: check_extra, read_field
   use cards, only: cards_type, data_card_type, keyword_card_type
   use deck_context, only: deck_type
   use deck_structure, only: cards_of, data_count
   use element_types, only: drawn_line, line_kind, line_node_count
   use mesh, only: set_type
   use text, only: to_text, to_upper
   implicit none
   private
   public :: build_lines, split_line_sets, is_line_card, element_cards, read_node

   integer, parameter :: nodes_per_line = 3

contains

   !> Whether a keyword card begins elements that are lines.
   pure logical function is_line_card(card)
      type(keyword_card_type), intent(in) :: card   !! any card

      is_line_card = .false.
      if (card%name /= 'ELEMENT') return
      is_line_card = line_node_count(to_upper(card%text('TYPE'))) > 0
   end function is_line_card

   !> The *ELEMENT cards of lines, or of all other elements.
   pure function element_cards(cards, of_lines) result(places)
      type(cards_type), intent(in) :: cards
      logical, intent(in) :: of_lines         !! whether those of lines are wanted
      integer, allocatable :: places(:)       !! indexes into the keyword cards
      integer :: k

      places = cards_of(cards, 'ELEMENT')
      places = pack(places, [(is_line_card(cards%keywords(places(k))) .eqv. of_lines, k=1, &
         size(places))])
   end function element_cards

   !> Builds the lines, in the order of the deck; the nodes are known.
   subroutine build_lines(deck)
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: name
      integer, allocatable :: places(:)
      integer :: k, j, n

      places = element_cards(deck%cards, of_lines=.true.)
      n = data_count(deck%cards, places)
      allocate(deck%line_number(n), deck%line_nodes(nodes_per_line, n), source=0)
      allocate(deck%line_kind(n), source=drawn_line)
      allocate(deck%line_place(n))
      n = 0
      do k = 1, size(places)
         associate (card => deck%cards%keywords(places(k)))
            name = to_upper(card%text('TYPE'))
            if (line_kind(name) == drawn_line) call deck%note('*ELEMENT, TYPE='//name// &
               ': lines are ignored, except for sets and surfaces that are made of them')
            do j = 1, size(card%data)
               n = n + 1
               deck%line_kind(n) = line_kind(name)
               deck%line_place(n) = card%data(j)%place(1)
               call read_line(card%data(j), deck, deck%line_number(n), &
                  deck%line_nodes(:line_node_count(name), n))
            end do
         end associate
      end do
      if (size(places) > 0 .and. data_count(deck%cards, &
         element_cards(deck%cards, of_lines=.false.)) == 0) call deck%missing(deck%cards%keywords( &
         places(1))%place_of('TYPE'), 'the deck has lines, but no elements')
   end subroutine build_lines

   !> Number and nodes of one line; nodes that do not exist are errors, and 0.
   subroutine read_line(data, deck, number, nodes)
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(inout) :: deck
      integer, intent(inout) :: number, nodes(:)
      integer :: q
      logical :: valid

      valid = .true.
      call read_field(data, 1, 'element number', deck, number, valid)
      do q = 1, size(nodes)
         if (valid) call read_node(data, q, deck, nodes(q), valid)
      end do
      if (valid) call check_extra(data, size(nodes) + 1, 'line, '//to_text(size(nodes))//' nodes', &
         deck)
   end subroutine read_line

   !> Index of node q of an element or a line; one that does not exist is an error, and 0.
   subroutine read_node(data, q, deck, node, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: q                             !! node 1, 2, ... of the element
      type(deck_type), intent(inout) :: deck
      integer, intent(inout) :: node                       !! stays as it is without a number
      logical, intent(inout) :: valid                      !! false where it has no number
      integer :: number

      call read_field(data, q + 1, 'node '//to_text(q), deck, number, valid)
      if (.not. valid) return
      node = deck%node_index%find(number)
      if (node == 0) call deck%missing(data%place(q + 1), 'there is no node '//to_text(number), &
         'node', to_text(number))
   end subroutine read_node

   !> Parts sets of elements and lines: the elements stay, the lines are kept beside them.
   subroutine split_line_sets(elements, sets, line_sets)
      integer, intent(in) :: elements                             !! number of elements
      type(set_type), intent(inout) :: sets(:)  !! members are elements and, behind them, lines
      type(set_type), allocatable, intent(out) :: line_sets(:)    !! indexes of lines; may be empty
      integer :: i

      allocate (line_sets(size(sets)))
      do i = 1, size(sets)
         line_sets(i)%members = pack(sets(i)%members, sets(i)%members > elements) - elements
         if (size(line_sets(i)%members) == 0) cycle
         sets(i)%members = pack(sets(i)%members, sets(i)%members <= elements)
         sets(i)%of_lines = size(sets(i)%members) == 0
      end do
   end subroutine split_line_sets

end module deck_builder_lines
