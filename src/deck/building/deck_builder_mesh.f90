!> *NODE and *ELEMENT -> nodes and elements of the mesh.
module deck_builder_mesh
   use card_parameters, only: need_parameter, parameter_place
   use card_values, only: check_extra, check_unneeded, may_be_decimals, need_field, take_field
   use cards, only: cards_type, data_card_type, field_place, has_field, is_undefined
   use deck_builder_lines, only: element_cards, is_line_card, read_node
   use deck_context, only: deck_context_type, plane_by_element
   use deck_reader, only: keyword_of
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use deck_structure, only: data_cards_of
   use element_kinds, only: element_corner_count, element_node_count, plane_strain, plane_stress, &
      quad8
   use element_types, only: take_element_type
   use kinds, only: dp
   use mesh, only: add_node, extent_of, mesh_type, nodes_per_element
   use sorting, only: repeated
   use text, only: to_text
   implicit none
   private
   public :: build_nodes, build_elements

   character(*), parameter :: gmsh_comment = '******* E L E M E N T S'   !! before the first element

   real(dp), parameter :: height_rounding = 1.0e-9_dp   !! of z, by the extent of the model

contains

   !> Builds the nodes, in the order of the deck.
   subroutine build_nodes(cards, context, mesh, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context    !! receives the numbers
      type(mesh_type), intent(inout) :: mesh               !! receives the nodes
      type(deck_report_type), intent(inout) :: report      !! receives errors
      real(dp), allocatable :: heights(:)
      integer, allocatable :: card(:)
      integer :: j, n

      card = data_cards_of(cards, 'NODE')
      n = size(card)
      allocate(mesh%node_number(n), mesh%coordinates(2, n), heights(n))
      allocate(context%node_place(n), context%node_valid(n))
      do j = 1, n
         context%node_place(j) = field_place(cards%data(card(j)), 1)
         call build_node(cards%data(card(j)), context, report, mesh%node_number(j), &
            mesh%coordinates(:, j), heights(j), context%node_valid(j))
      end do
      call move_alloc(heights, context%node_height)
      call warn_of_decimals(cards, card, report)
      call drop_repeated(mesh, context, report)
      if (n == 0) call report%lose('node')
      context%node_index%noun = 'node'
      call context%node_index%build(mesh%node_number)
      call add_rotations(cards, context, mesh)
   end subroutine build_nodes

   !> Of a node that is given more than once the last place counts, as in Abaqus and CalculiX.
   subroutine drop_repeated(mesh, context, report)
      type(mesh_type), intent(inout) :: mesh
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      integer, allocatable :: kept(:), places(:)
      logical :: keeps(size(mesh%node_number))
      integer :: i, first

      places = repeated(mesh%node_number)
      places = pack(places, mesh%node_number(places) > 0)
      if (size(places) == 0) return
      keeps = .true.
      keeps(places) = .false.
      do i = 1, size(places)
         first = findloc(mesh%node_number, mesh%node_number(places(i)), dim=1)
         if (norm2(mesh%coordinates(:, places(i)) - mesh%coordinates(:, first)) > 0.0_dp) call &
            report%warning(context%node_place(places(i)), 'node '// &
            to_text(mesh%node_number(first))//' is defined twice, first on '// &
            report%source%words_of(context%node_place(first))//': the last place is used')
         mesh%coordinates(:, first) = mesh%coordinates(:, places(i))
         context%node_height(first) = context%node_height(places(i))
         context%node_place(first) = context%node_place(places(i))
         context%node_valid(first) = context%node_valid(places(i))
      end do
      kept = pack([(i, i=1, size(keeps))], keeps)
      mesh%node_number = mesh%node_number(kept)
      mesh%coordinates = mesh%coordinates(:, kept)
      context%node_place = context%node_place(kept)
      context%node_valid = context%node_valid(kept)
      context%node_height = context%node_height(kept)
   end subroutine drop_repeated

   !> Adds a node for the rotation of each coupling and rigid body, which no card can name.
   subroutine add_rotations(cards, context, mesh)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context
      type(mesh_type), intent(inout) :: mesh
      real(dp) :: place(2)
      integer :: k

      if (size(mesh%node_number) == 0) return
      do k = 1, size(cards%keywords)
         if (all(cards%keywords(k)%name /= [character(10) :: 'COUPLING', 'RIGID BODY'])) cycle
         place = mesh%coordinates(:, 1)
         call add_node(mesh, place)
         context%node_place = [context%node_place, cards%keywords(k)%place]
         context%node_valid = [context%node_valid, .true.]
      end do
   end subroutine add_rotations

   !> Number, x, y and z. A coordinate that is left out is 0, as in CalculiX; what is behind z
   !> is the direction of a normal in Abaqus.
   subroutine build_node(data, context, report, number, coordinates, z, valid)
      type(data_card_type), intent(in) :: data
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      integer, intent(out) :: number
      real(dp), intent(out) :: coordinates(2)
      real(dp), intent(out) :: z
      logical, intent(out) :: valid                 ! whether the coordinates are known
      character(*), parameter :: names = 'xy'
      integer :: i

      valid = .true.
      coordinates = 0.0_dp
      z = 0.0_dp
      call read_number(data, 'node', report, number)
      do i = 1, 2
         call take_field(data, i + 1, names(i:i), report, coordinates(i), valid)
         if (has_field(data, i + 1) .or. is_undefined(data, i + 1) .or. number == 0) cycle
         call report%warning(field_place(data, i + 1), 'node '//to_text(number)// &
            ' has no '//names(i:i)//': 0 is used')
      end do
      call take_field(data, 4, 'z', report, z, valid)
      if (has_field(data, 4)) then
         call context%note('*NODE: third coordinates are ignored')
      end if
      call check_extra(data, 7, 'number, x, y', report)
      if (size(data%fields) > 4) call context%note('*NODE: numbers after the third '// &
         'coordinate are ignored')
   end subroutine build_node

   !> The nodes of elements lie in the plane z = 0, but for rounding. Others may be those of a
   !> drawing or of a rigid body.
   subroutine check_heights(cards, context, mesh, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(in) :: context       ! whether the elements are sound
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report
      integer, allocatable :: card(:)
      logical :: has_element(0:size(mesh%node_number))
      type(place_type) :: place
      real(dp) :: rounding
      integer :: e, i, j

      if (size(mesh%node_number) == 0) return
      rounding = height_rounding*extent_of(mesh%coordinates)
      has_element = .false.
      do e = 1, size(mesh%element_number)
         if (context%element_valid(e)) has_element(mesh%element_nodes(:, e)) = .true.
      end do
      card = data_cards_of(cards, 'NODE')
      do i = 1, size(context%node_height)
         if (.not. has_element(i) .or. abs(context%node_height(i)) <= rounding) cycle
         do j = i, size(card) - 1   ! nodes that are given twice move the others up
            place = field_place(cards%data(card(j)), 1)
            if (place%image == context%node_place(i)%image) exit
         end do
         call report%error(field_place(cards%data(card(j)), 4), &
            'models are two-dimensional: z must be 0', 'z')
      end do
   end subroutine check_heights

   !> Warns of the first node whose coordinates may be torn by decimal commas, so that the last of
   !> their parts means nothing.
   subroutine warn_of_decimals(cards, card, report)
      type(cards_type), intent(in) :: cards
      integer, intent(in) :: card(:)
      type(deck_report_type), intent(inout) :: report
      integer :: i

      do i = 1, size(card)
         if (.not. may_be_decimals(cards%data(card(i)), 5)) cycle
         call check_unneeded(cards%data(card(i)), 5, 'a direction', report)
         return
      end do
   end subroutine warn_of_decimals

   !> The number of a node or element, from 1; 0 after an error.
   subroutine read_number(data, noun, report, number)
      type(data_card_type), intent(in) :: data
      character(*), intent(in) :: noun
      type(deck_report_type), intent(inout) :: report
      integer, intent(out) :: number
      logical :: valid

      number = 0
      valid = .true.
      call need_field(data, 1, noun//' number', report, number, valid)
      if (valid .and. number < 1) then
         call report%error(field_place(data, 1), 'numbers begin with 1')
         number = 0
      end if
      if (number == 0) call report%lose(noun)
   end subroutine read_number

   !> Reports elements that are given twice: one of the two may stand for one that is missing.
   subroutine check_repeated(cards, card, numbers, report, places)
      type(cards_type), intent(in) :: cards
      integer, intent(in) :: card(:), numbers(:)
      type(deck_report_type), intent(inout) :: report
      integer, allocatable, intent(out) :: places(:)   ! indexes into numbers
      integer :: i, first

      places = repeated(numbers)
      places = pack(places, numbers(places) > 0)
      do i = 1, size(places)
         first = findloc(numbers, numbers(places(i)), dim=1)
         call report%twice(field_place(cards%data(card(places(i))), 1), &
            'element '//to_text(numbers(places(i))), field_place(cards%data(card(first)), 1))
      end do
      if (size(places) > 0) call report%lose('element')
   end subroutine check_repeated

   !> Builds the elements, in the order of the deck; one of a type that cannot be used keeps its
   !> number only.
   subroutine build_elements(cards, context, mesh, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context    !! receives the numbers
      type(mesh_type), intent(inout) :: mesh               !! receives the elements
      type(deck_report_type), intent(inout) :: report      !! receives errors
      character(:), allocatable :: name, message, note
      integer, allocatable :: card(:), places(:)
      integer :: k, j, kind, n, plane

      card = element_cards(cards, of_lines=.false.)
      n = size(card)
      allocate(mesh%element_number(n), mesh%element_section(n))
      allocate(mesh%element_nodes(nodes_per_element, n), source=0)
      allocate(mesh%element_kind(n), source=quad8)
      allocate(mesh%element_plane(n), source=plane_strain)
      allocate(context%element_place(n))
      allocate(context%element_valid(n), source=.false.)
      mesh%element_section = 0
      n = 0
      do k = 1, size(cards%keywords)
         if (cards%keywords(k)%name /= 'ELEMENT' .or. is_line_card(cards%keywords(k))) cycle
         call need_parameter(cards%keywords(k), 'TYPE', report, name)
         message = ''
         if (len(name) > 0) then
            call take_element_type(name, kind, plane, message, note)
            if (len(note) > 0) call context%note(note)
         end if
         if (plane == plane_stress .and. context%plane == plane_by_element) call warn_of_gmsh( &
            parameter_place(cards%keywords(k), 'TYPE'), report)
         if (context%plane /= plane_by_element) plane = context%plane
         if (len(message) > 0) call report%error(parameter_place(cards%keywords(k), 'TYPE'), &
            message)
         do j = cards%keywords(k)%first_data, cards%keywords(k)%last_data
            n = n + 1
            context%element_place(n) = field_place(cards%data(j), 1)
            call read_number(cards%data(j), 'element', report, mesh%element_number(n))
            if (len(name) == 0 .or. len(message) > 0) cycle
            mesh%element_kind(n) = kind
            mesh%element_plane(n) = plane
            call read_element_nodes(cards%data(j), context, report, &
               mesh%element_nodes(:element_node_count(kind), n), context%element_valid(n))
            call check_layout(cards%data(j), kind, cards%keywords(k)%place, report)
         end do
      end do
      call check_heights(cards, context, mesh, report)
      if (n == 0) call report%lose('element')
      context%element_index%noun = 'element'
      call context%element_index%build(mesh%element_number)
      ! Elements and lines have different numbers.
      call check_repeated(cards, [card, element_cards(cards, of_lines=.true.)], &
         [mesh%element_number, context%line_number], report, places)
      context%member_index%noun = 'element'
      call context%member_index%build([mesh%element_number, context%line_number])
   end subroutine build_elements

   !> Warns of plane stress that gmsh wrote, which calls all elements so; once.
   subroutine warn_of_gmsh(place, report)
      type(place_type), intent(in) :: place              ! where the type of an element is
      type(deck_report_type), intent(inout) :: report
      integer :: i

      do i = place%image - 1, 1, -1
         associate (line => report%source%images(i)%value)
            if (index(line, gmsh_comment) == 1) exit
            if (keyword_of(line) == 'NODE') return
         end associate
      end do
      if (i > 0) call report%warning(place, 'gmsh calls all elements CPS, plane stress; say '// &
         'what is meant by *OPTIONS, PLANE=STRAIN, STRESS or AXISYMMETRIC', 'gmsh')
   end subroutine warn_of_gmsh

   subroutine read_element_nodes(data, context, report, nodes, valid)
      type(data_card_type), intent(in) :: data
      type(deck_context_type), intent(in) :: context
      type(deck_report_type), intent(inout) :: report
      integer, intent(inout) :: nodes(:)
      logical, intent(out) :: valid
      integer :: q
      logical :: is_number

      valid = .true.
      do q = 1, min(size(nodes), size(data%fields) - 1)
         is_number = .true.
         call read_node(data, q, context, report, nodes(q), is_number)
         valid = valid .and. nodes(q) > 0
         if (nodes(q) > 0) valid = valid .and. context%node_valid(nodes(q))
      end do
      if (size(data%fields) /= size(nodes) + 1) valid = .false.
      if (.not. valid) return
      do q = 2, size(nodes)
         if (all(nodes(:q - 1) /= nodes(q))) cycle
         call report%error(field_place(data, q + 1), 'a node appears twice in this element')
         valid = .false.
      end do
   end subroutine read_element_nodes

   !> Reports the first of the elements of a keyword card that have too many fields or too few: its
   !> TYPE= may be wrong.
   subroutine check_layout(data, kind, keyword, report)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: kind
      type(place_type), intent(in) :: keyword          ! where the *ELEMENT card is
      type(deck_report_type), intent(inout) :: report
      character(:), allocatable :: layout

      associate (fields => size(data%fields), due => element_node_count(kind) + 1, &
         corners => element_corner_count(kind))
         if (fields > due) then
            layout = 'element, '//to_text(corners)//' corners'
            if (due > corners + 1) layout = layout//', '//to_text(corners)//' midside nodes'
            call report%error(field_place(data, due + 1), 'extra field; the card is '//layout, &
               'extra fields of '//to_text(keyword%image))
         else if (fields < due .and. .not. is_undefined(data, fields)) then
            call report%error(field_place(data, fields + 1), 'missing field: node '// &
               to_text(fields), 'missing fields of '//to_text(keyword%image))
         end if
      end associate
   end subroutine check_layout

end module deck_builder_mesh
