!> *NODE and *ELEMENT -> nodes and elements of the mesh, and lines. Mesh generators write these for
!> the curves of a drawing: they are no elements of the mesh, but their sets name nodes, and the
!> faces under them.
module deck_builder_mesh
   use card_values, only: need_parameter, check_extra, check_unneeded, may_be_decimals, read_field
   use cards, only: data_card_type, keyword_card_type
   use deck_context, only: deck_type, plane_by_element
   use deck_reader, only: keyword_of
   use deck_source, only: place_type
   use deck_structure, only: cards_of, data_count
   use element_kinds, only: element_node_count, generalized_strain, &
      plane_strain, plane_stress, quad8
   use element_types, only: drawn_line, line_kind, line_node_count, take_element_type
   use kinds, only: dp
   use mesh, only: add_node, extent_of, nodes_per_element
   use sorting, only: repeated, sort_order
   use text, only: to_text, to_upper
   implicit none
   private
   public :: build_nodes, build_elements, is_line_card

   character(*), parameter :: gmsh_comment = '******* E L E M E N T S'   !! before the first element

   integer, parameter :: nodes_per_line = 3

   !> Nodes of an element as messages name them.
   character(6), parameter :: node_words(nodes_per_element) = &
      ['node 1', 'node 2', 'node 3', 'node 4', 'node 5', 'node 6', 'node 7', 'node 8']

   real(dp), parameter :: height_rounding = 1.0e-9_dp   !! of z, by the extent of the model

contains

   !> Builds the nodes, in the order of the deck.
   subroutine build_nodes(deck)
      type(deck_type), intent(inout) :: deck
      real(dp), allocatable :: heights(:)
      real(dp) :: place(2)
      integer, allocatable :: places(:)
      integer :: j, k, n
      logical :: told

      places = cards_of(deck%cards, 'NODE')
      n = data_count(deck%cards, places)
      allocate(deck%mesh%node_number(n), deck%mesh%coordinates(2, n), heights(n))
      allocate(deck%node_place(n), deck%node_valid(n))
      n = 0
      told = .false.
      do k = 1, size(places)
         associate (rows => deck%cards%keywords(places(k))%data)
            do j = 1, size(rows)
               n = n + 1
               deck%node_place(n) = rows(j)%place(1)
               call build_node(rows(j), deck, deck%mesh%node_number(n), deck%mesh%coordinates(:, &
                  n), heights(n), deck%node_valid(n))
               ! Decimal commas tear the coordinates, and the last of their parts means nothing.
               if (told .or. .not. may_be_decimals(rows(j), 5)) cycle
               call check_unneeded(rows(j), 5, 'a direction', deck)
               told = .true.
            end do
         end associate
      end do
      call move_alloc(heights, deck%node_height)
      call drop_repeated(deck)
      if (n == 0) call deck%lose('node')
      deck%node_index%noun = 'node'
      call deck%node_index%build(deck%mesh%node_number)
      ! Nodes that no card can name: for the turn about y of the REF NODE of a section, then for the
      ! rotation of each coupling and rigid body.
      if (n == 0) return
      place = deck%mesh%coordinates(:, 1)
      places = [cards_of(deck%cards, 'COUPLING'), cards_of(deck%cards, 'RIGID BODY')]
      places = [cards_of(deck%cards, 'SOLID SECTION'), places(sort_order(places))]
      do k = 1, size(places)
         call deck%open_card(places(k))
         if (deck%card%name == 'SOLID SECTION' .and. .not. deck%card%has('REF NODE')) cycle
         call add_node(deck%mesh, place)
         deck%node_place = [deck%node_place, deck%card%place]
         deck%node_valid = [deck%node_valid, .true.]
      end do
   end subroutine build_nodes

   !> Of a node that is given more than once the last place counts, as in Abaqus and CalculiX.
   subroutine drop_repeated(deck)
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: kept(:), places(:)
      logical :: keeps(size(deck%mesh%node_number))
      integer :: i, first

      places = repeated(deck%mesh%node_number)
      places = pack(places, deck%mesh%node_number(places) > 0)
      if (size(places) == 0) return
      keeps = .true.
      keeps(places) = .false.
      do i = 1, size(places)
         first = findloc(deck%mesh%node_number, deck%mesh%node_number(places(i)), dim=1)
         if (norm2(deck%mesh%coordinates(:, places(i)) - deck%mesh%coordinates(:, first)) > &
            0.0_dp) call deck%warning(deck%node_place(places(i)), 'node '// &
            to_text(deck%mesh%node_number(first))//' is defined twice, first on '// &
            deck%source%words_of(deck%node_place(first))//': the last place is used')
         deck%mesh%coordinates(:, first) = deck%mesh%coordinates(:, places(i))
         deck%node_height(first) = deck%node_height(places(i))
         deck%node_place(first) = deck%node_place(places(i))
         deck%node_valid(first) = deck%node_valid(places(i))
      end do
      kept = pack([(i, i=1, size(keeps))], keeps)
      deck%mesh%node_number = deck%mesh%node_number(kept)
      deck%mesh%coordinates = deck%mesh%coordinates(:, kept)
      deck%node_place = deck%node_place(kept)
      deck%node_valid = deck%node_valid(kept)
      deck%node_height = deck%node_height(kept)
   end subroutine drop_repeated

   !> Number, x, y and z. A coordinate that is left out is 0, as in CalculiX; what is behind z
   !> is the direction of a normal in Abaqus.
   subroutine build_node(data, deck, number, coordinates, z, valid)
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(inout) :: deck
      integer, intent(out) :: number
      real(dp), intent(out) :: coordinates(2), z
      logical, intent(out) :: valid                 ! whether the coordinates are known
      character(*), parameter :: names = 'xy'
      integer :: i

      valid = .true.
      coordinates = 0.0_dp
      z = 0.0_dp
      call read_number(data, 'node', deck, number)
      do i = 1, 2
         call read_field(data, i + 1, names(i:i)//'?', deck, coordinates(i), valid)
         if (data%has(i + 1) .or. data%is_undefined(i + 1) .or. number == 0) cycle
         call deck%warning(data%place(i + 1), 'node '//to_text(number)//' has no '//names(i:i)// &
            ': 0 is used')
      end do
      call read_field(data, 4, 'z?', deck, z, valid)
      if (data%has(4)) call deck%note('*NODE: third coordinates are ignored')
      call check_extra(data, 7, 'number, x, y', deck)
      if (size(data%fields) > 4) call deck%note('*NODE: numbers after the third coordinate are '// &
         'ignored')
   end subroutine build_node

   !> The nodes of elements lie in the plane z = 0, but for rounding. Others may be those of a
   !> drawing or of a rigid body.
   subroutine check_heights(deck)
      type(deck_type), intent(inout) :: deck
      logical :: has_element(0:size(deck%mesh%node_number))
      real(dp) :: rounding
      integer :: e, i

      if (size(deck%mesh%node_number) == 0) return
      rounding = height_rounding*extent_of(deck%mesh%coordinates)
      has_element = .false.
      do e = 1, size(deck%mesh%element_number)
         if (deck%element_valid(e)) has_element(deck%mesh%element_nodes(:, e)) = .true.
      end do
      do i = 1, size(deck%node_height)
         if (has_element(i) .and. abs(deck%node_height(i)) > rounding) call deck%error( &
            deck%node_place(i), 'node '//to_text(deck%mesh%node_number(i))//' of an element is '// &
            'out of the plane; models are two-dimensional: z must be 0', 'z')
      end do
   end subroutine check_heights

   !> The number of a node or element, from 1; 0 after an error.
   subroutine read_number(data, noun, deck, number)
      type(data_card_type), intent(in) :: data
      character(*), intent(in) :: noun
      type(deck_type), intent(inout) :: deck
      integer, intent(out) :: number
      logical :: valid

      number = 0
      valid = .true.
      call read_field(data, 1, noun//' number', deck, number, valid)
      if (valid .and. number < 1) then
         call deck%error(data%place(1), 'numbers begin with 1')
         number = 0
      end if
      if (number == 0) call deck%lose(noun)
   end subroutine read_number

   !> Whether a keyword card begins elements that are lines.
   pure logical function is_line_card(card)
      type(keyword_card_type), intent(in) :: card   !! any card

      is_line_card = .false.
      if (card%name == 'ELEMENT') is_line_card = line_node_count(to_upper(card%text('TYPE'))) > 0
   end function is_line_card

   !> Builds the elements and the lines, in the order of the deck.
   subroutine build_elements(deck)
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: numbers(:), places(:), second(:)
      type(place_type), allocatable :: places_of(:)
      logical, allocatable :: of_lines(:)
      integer :: e, k, line, n

      places = cards_of(deck%cards, 'ELEMENT')
      of_lines = [(is_line_card(deck%cards%keywords(places(k))), k=1, size(places))]
      n = data_count(deck%cards, pack(places, of_lines))
      allocate (deck%line_number(n), deck%line_nodes(nodes_per_line, n), source=0)
      allocate (deck%line_kind(n), source=drawn_line)
      allocate (deck%line_place(n))
      n = data_count(deck%cards, pack(places, .not. of_lines))
      allocate (deck%mesh%element_number(n), deck%mesh%element_section(n), source=0)
      allocate (deck%mesh%element_nodes(nodes_per_element, n), source=0)
      allocate (deck%mesh%element_kind(n), source=quad8)
      allocate (deck%mesh%element_plane(n), source=plane_strain)
      allocate (deck%element_place(n))
      allocate (deck%element_valid(n), source=.false.)
      e = 0
      line = 0
      do k = 1, size(places)
         call deck%open_card(places(k))
         if (of_lines(k)) call add_lines(deck, line)
         if (.not. of_lines(k)) call add_elements(deck, e)
      end do
      k = findloc(of_lines, .true., dim=1)
      if (n == 0 .and. k > 0) call deck%missing(deck%cards%keywords(places(k))%place_of('TYPE'), &
         'the deck has lines, but no elements')
      call check_heights(deck)
      if (n == 0) call deck%lose('element')
      deck%element_index%noun = 'element'
      call deck%element_index%build(deck%mesh%element_number)
      ! Elements and lines have different numbers.
      numbers = [deck%mesh%element_number, deck%line_number]
      places_of = [deck%element_place, deck%line_place]
      second = repeated(numbers)
      second = pack(second, numbers(second) > 0)
      do k = 1, size(second)
         call deck%error(places_of(second(k)), 'element '//to_text(numbers(second(k)))//' is '// &
            'defined twice, first on '//deck%source%words_of(places_of(findloc(numbers, &
            numbers(second(k)), dim=1))))
      end do
      ! One of the two may stand for one that is missing.
      if (size(second) > 0) call deck%lose('element')
      deck%member_index%noun = 'element'
      call deck%member_index%build(numbers)
   end subroutine build_elements

   subroutine add_lines(deck, n)
      type(deck_type), intent(inout) :: deck
      integer, intent(inout) :: n        ! lines so far
      character(:), allocatable :: name
      integer :: j
      logical :: valid

      name = to_upper(deck%card%text('TYPE'))
      if (line_kind(name) == drawn_line) call deck%note('*ELEMENT, TYPE='//name//': lines are '// &
         'ignored, except for sets and surfaces that are made of them')
      do j = 1, size(deck%card%data)
         n = n + 1
         deck%line_kind(n) = line_kind(name)
         deck%line_place(n) = deck%card%data(j)%place(1)
         call read_number(deck%card%data(j), 'element', deck, deck%line_number(n))
         call read_nodes(deck%card%data(j), deck, deck%line_nodes(:line_node_count(name), n), valid)
      end do
   end subroutine add_lines

   !> Adds the elements of a card; those of a type that cannot be used keep their numbers only.
   subroutine add_elements(deck, n)
      type(deck_type), intent(inout) :: deck
      integer, intent(inout) :: n        ! elements so far
      character(:), allocatable :: message, name, note
      integer :: j, kind, plane

      call need_parameter(deck%card, 'TYPE', deck, name)
      call take_element_type(name, kind, plane, message, note)
      if (len(name) > 0 .and. len(message) > 0) call deck%error(deck%card%place_of('TYPE'), message)
      if (len(note) > 0) call deck%note(note)
      if (plane == plane_stress .and. deck%plane == plane_by_element) call warn_of_gmsh( &
         deck%card%place_of('TYPE'), deck)
      if (deck%plane /= plane_by_element .and. plane /= generalized_strain) plane = deck%plane
      do j = 1, size(deck%card%data)
         n = n + 1
         deck%element_place(n) = deck%card%data(j)%place(1)
         call read_number(deck%card%data(j), 'element', deck, deck%mesh%element_number(n))
         if (len(message) > 0) cycle
         deck%mesh%element_kind(n) = kind
         deck%mesh%element_plane(n) = plane
         call read_nodes(deck%card%data(j), deck, &
            deck%mesh%element_nodes(:element_node_count(kind), n), deck%element_valid(n))
      end do
   end subroutine add_elements

   !> Warns of plane stress that gmsh wrote, which calls all elements so; once.
   subroutine warn_of_gmsh(place, deck)
      type(place_type), intent(in) :: place              ! where the type of an element is
      type(deck_type), intent(inout) :: deck
      integer :: i

      do i = place%image - 1, 1, -1
         if (index(deck%source%images(i)%value, gmsh_comment) == 1) exit
         if (keyword_of(deck%source%images(i)%value) == 'NODE') return
      end do
      if (i > 0) call deck%warning(place, 'gmsh calls all elements CPS, plane stress; say what '// &
         'is meant by *OPTIONS, PLANE=STRAIN, STRESS or AXISYMMETRIC', 'gmsh')
   end subroutine warn_of_gmsh

   !> Indexes of the nodes of an element or a line; one that does not exist is an error, and 0.
   subroutine read_nodes(data, deck, nodes, valid)
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(inout) :: deck
      integer, intent(inout) :: nodes(:)               ! 0 before
      logical, intent(out) :: valid                    ! whether the places of all are known
      integer :: fields, number, q
      logical :: is_number

      fields = size(data%fields) - 1
      valid = fields == size(nodes)
      if (.not. (valid .or. data%is_undefined(fields + 1))) call deck%error( &
         data%place(min(fields, size(nodes)) + 2), 'the element has '//to_text(fields)// &
         ' nodes, but its TYPE= has '//to_text(size(nodes)))
      do q = 1, min(size(nodes), fields)
         is_number = .true.
         call read_field(data, q + 1, node_words(q), deck, number, is_number)
         if (is_number) then
            nodes(q) = deck%node_index%find(number)
            if (nodes(q) == 0) call deck%missing(data%place(q + 1), 'there is no node '// &
               to_text(number), 'node', to_text(number))
         end if
         valid = valid .and. nodes(q) > 0
         if (nodes(q) > 0) valid = valid .and. deck%node_valid(nodes(q))
      end do
      if (.not. valid) return
      do q = 2, size(nodes)
         if (all(nodes(:q - 1) /= nodes(q))) cycle
         call deck%error(data%place(q + 1), 'a node appears twice in this element')
         valid = .false.
      end do
   end subroutine read_nodes

end module deck_builder_mesh
