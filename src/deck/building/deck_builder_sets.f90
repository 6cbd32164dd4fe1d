!> *NSET and *ELSET, NSET= on *NODE and ELSET= on *ELEMENT -> named sets; *SURFACE -> sets of faces.
module deck_builder_sets
   use card_values, only: choice, chosen, need_parameter, surface_kinds, check_extra, read_field, &
      read_row
   use cards, only: data_card_type, keyword_card_type
   use deck_builder_mesh, only: is_line_card
   use deck_builder_rigid, only: build_drawing, build_line_surface, lines_of, need_faces
   use deck_context, only: deck_type, item_index_type, place_list_type
   use deck_structure, only: cards_of
   use element_kinds, only: element_corner_count, side_nodes
   use element_sides, only: element_sides_type, find_sides
   use element_types, only: rigid_line
   use kinds, only: dp
   use load_requests, only: target_type
   use mesh, only: set_type, surface_type
   use name_index, only: is_pattern
   use number_lists, only: number_list_type
   use sorting, only: sort_order, unique_sorted
   use text, only: read_integer, to_text, to_upper
   implicit none
   private
   public :: build_sets, build_surfaces, build_node_surfaces, check_face

   !> Sets of nodes or of elements while they grow.
   type :: draft_type
      type(item_index_type) :: numbers   !! of nodes or of elements
      integer :: sets = 0                       !! number of sets
      type(set_type), allocatable :: items(:)   !! (capacity) their names
      type(number_list_type), allocatable :: members(:)   !! (capacity) some more than once
   end type draft_type

contains

   !> Builds all sets of nodes, or of elements and lines; a name on several cards is one set.
   subroutine build_sets(noun, deck)
      character(*), intent(in) :: noun                           !! node or element
      type(deck_type), intent(inout) :: deck
      type(set_type), allocatable :: sets(:)
      type(draft_type) :: draft
      character(:), allocatable :: parameter, definer
      integer :: count, first(2), i, j, k, kind, n

      parameter = trim(merge('NSET ', 'ELSET', noun == 'node'))
      definer = to_upper(noun)
      allocate(draft%items(size(deck%cards%keywords)), draft%members(size(deck%cards%keywords)))
      draft%numbers = deck%node_index
      if (noun == 'element') draft%numbers = deck%member_index
      first = [0, size(deck%mesh%element_number)]
      do k = 1, size(deck%cards%keywords)
         call deck%open_card(k)
         if (deck%card%name == definer) then
            kind = merge(2, 1, is_line_card(deck%card))
            count = size(deck%card%data)
            if (deck%card%has(parameter)) then
               call open_set(parameter, deck, draft, i)
               if (noun == 'node') then
                  call draft%members(i)%add(nodes_of(deck%card, draft%numbers))
               else
                  call draft%members(i)%add(first(kind) + [(j, j=1, count)])
               end if
            end if
            first(kind) = first(kind) + count
         else if (deck%card%name == parameter) then
            call build_set(deck, draft)
         end if
      end do
      allocate(sets(draft%sets))
      do i = 1, draft%sets
         call move_alloc(draft%items(i)%name, sets(i)%name)
         sets(i)%members = unique_sorted(draft%members(i)%numbers())
      end do
      if (noun == 'node') then
         call move_alloc(sets, deck%mesh%node_sets)
      else
         ! The elements stay, the lines, whose indexes are behind theirs, are kept beside them.
         n = size(deck%mesh%element_number)
         allocate (deck%line_sets(size(sets)))
         do i = 1, size(sets)
            deck%line_sets(i)%members = pack(sets(i)%members, sets(i)%members > n) - n
            if (size(deck%line_sets(i)%members) == 0) cycle
            sets(i)%members = pack(sets(i)%members, sets(i)%members <= n)
            sets(i)%of_lines = size(sets(i)%members) == 0
         end do
         call move_alloc(sets, deck%mesh%element_sets)
      end if
   end subroutine build_sets

   !> The nodes that a *NODE card gives, of which some may be given again elsewhere.
   function nodes_of(card, numbers) result(nodes)
      type(keyword_card_type), intent(in) :: card
      type(item_index_type), intent(in) :: numbers
      integer, allocatable :: nodes(:)
      integer :: j, number
      logical :: is_number

      allocate (nodes(size(card%data)), source=0)
      do j = 1, size(nodes)
         call read_integer(card%data(j)%text(1), number, is_number)
         if (is_number) nodes(j) = numbers%find(number)
      end do
      nodes = pack(nodes, nodes > 0)
   end function nodes_of

   !> Finds the set that a card names, or begins it.
   subroutine open_set(parameter, deck, draft, set)
      character(*), intent(in) :: parameter
      type(deck_type), intent(inout) :: deck
      type(draft_type), intent(inout) :: draft
      integer, intent(out) :: set
      character(:), allocatable :: name
      integer :: number
      logical :: is_number

      name = to_upper(deck%card%text(parameter))
      set = deck%index_of(draft%numbers%noun//' set', name)
      if (set > 0) return
      call read_integer(name, number, is_number)
      if (is_number) call deck%error(deck%card%place_of(parameter), 'the name of a set must '// &
         'not be a number')
      call deck%add_name(draft%numbers%noun//' set', name)
      draft%sets = draft%sets + 1
      set = draft%sets
      draft%items(set)%name = name
   end subroutine open_set

   subroutine build_set(deck, draft)
      type(deck_type), intent(inout) :: deck
      type(draft_type), intent(inout) :: draft
      character(:), allocatable :: name
      integer, allocatable :: nodes(:), others(:)
      type(target_type) :: other
      integer :: set, j, i, k, known
      logical :: valid

      call need_parameter(deck%card, deck%card%name, deck, name)
      if (len(name) == 0) return
      known = draft%sets
      call open_set(deck%card%name, deck, draft, set)
      if (draft%numbers%noun == 'node') then
         call find_nodes(deck, nodes)
         call draft%members(set)%add(nodes)
      end if
      do j = 1, size(deck%card%data)
         if (deck%card%has('GENERATE')) then
            call generate(deck%card%data(j), deck, draft, set)
            cycle
         end if
         do i = 1, size(deck%card%data(j)%fields)
            if (is_pattern(deck%card%data(j)%text(i))) then
               call deck%find_matches(deck%card%data(j), i, draft%numbers%noun//' set', others, &
                  known)
               do k = 1, size(others)
                  if (others(k) /= set) call draft%members(set)%add(unique_sorted( &
                     draft%members(others(k))%numbers()))
               end do
               cycle
            end if
            valid = .true.
            call deck%need_target(draft%numbers%noun, deck%card%data(j), i, other, valid, known)
            if (other%item > 0) call draft%members(set)%add([other%item])
            ! Each member once, lest sets that hold a set twice double.
            if (other%set > 0) call draft%members(set)%add(unique_sorted( &
               draft%members(other%set)%numbers()))
         end do
      end do
   end subroutine build_set

   !> The nodes of the element set or the surface that an *NSET card names; some repeatedly.
   subroutine find_nodes(deck, nodes)
      type(deck_type), intent(inout) :: deck
      integer, allocatable, intent(out) :: nodes(:)
      type(number_list_type) :: found
      integer :: i, set, surface

      set = 0
      surface = 0
      call deck%take_named('ELSET', 'element set', set)
      if (set > 0) then
         call found%add([deck%mesh%element_nodes(:, deck%mesh%element_sets(set)%members)])
         call found%add([deck%line_nodes(:, deck%line_sets(set)%members)])
      end if
      call deck%take_named('SURFACE', 'surface', surface)
      call need_faces(deck%card%place_of('SURFACE'), deck, surface)
      if (surface > 0) then
         associate (faces => deck%mesh%surfaces(surface)%faces)
            do i = 1, size(faces, 2)
               call found%add(deck%mesh%element_nodes(side_nodes(deck%mesh%element_kind(faces(1, &
                  i)), faces(2, i)), faces(1, i)))
            end do
         end associate
      end if
      nodes = found%numbers()
      nodes = pack(nodes, nodes > 0)
   end subroutine find_nodes

   !> Numbers from first to last; those between that do not exist are ignored with a warning.
   subroutine generate(data, deck, draft, set)
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(inout) :: deck
      type(draft_type), intent(inout) :: draft
      integer, intent(in) :: set
      character(:), allocatable :: range
      real(dp) :: given(3)
      integer :: first, last, step, number, count, found, first_missing, k
      logical :: valid

      call read_row(data, '#first number/#last number/#increment? =1', deck, given, valid)
      first = nint(given(1))
      last = nint(given(2))
      step = nint(given(3))
      if (.not. valid .or. draft%numbers%is_empty()) return
      if (step < 1 .or. last < first) then
         call deck%error(data%place(1), 'the numbers must ascend from first to last')
         return
      end if
      count = (last - first)/step + 1
      found = 0
      first_missing = 0   ! as the offset of its number, in steps
      do k = 0, (min(last, draft%numbers%largest()) - first)/step
         number = draft%numbers%find(first + k*step)
         if (number == 0) cycle
         call draft%members(set)%add([number])
         if (first_missing == k) first_missing = k + 1
         found = found + 1
      end do
      range = 'from '//to_text(first)//' to '//to_text(last)
      associate (noun => draft%numbers%noun)
         if (found == 0 .and. draft%members(set)%count == 0) then
            call deck%missing(data%place(1), 'there is no '//noun//' '//range, noun)
         else if (found < count .and. .not. deck%has_lost(noun)) then
            if (step > 1) range = range//' in steps of '//to_text(step)
            call deck%warning(data%place(1), 'missing '//noun//'s are left out: '// &
               to_text(count - found)//' of '//to_text(count)//' '//range//', the first is '// &
               to_text(first + first_missing*step))
         end if
      end associate
   end subroutine generate

   !> Builds all surfaces.
   subroutine build_surfaces(deck)
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: places(:)
      integer :: n

      places = cards_of(deck%cards, 'SURFACE')
      allocate(deck%mesh%surfaces(size(places)), deck%face_places(size(places)))
      do n = 1, size(places)
         call deck%open_card(places(n))
         call deck%take_name('surface', deck%mesh%surfaces(n)%name)
         call build_surface(deck, deck%mesh%surfaces(n), deck%face_places(n))
      end do
   end subroutine build_surfaces

   !> Builds one surface; a face that is named twice counts once, in the order of elements.
   subroutine build_surface(deck, surface, places)
      type(deck_type), intent(inout) :: deck
      type(surface_type), intent(inout) :: surface
      type(place_list_type), intent(inout) :: places   ! receives where each face is named
      character(:), allocatable :: kind
      type(number_list_type) :: found, named   ! faces, and the data cards that name them
      integer, allocatable :: cards_of_faces(:), elements(:), keys(:), order(:), sets(:)
      type(target_type) :: target
      integer :: face, i, j, errors
      logical :: valid

      surface%card = deck%card%place%image
      errors = deck%error_count()
      kind = choice(deck%card, 'TYPE', surface_kinds, deck, 'ELEMENT')
      allocate(surface%faces(2, 0))
      ! The data of another type have other fields; node sets are made of surfaces, too.
      if (deck%error_count() > errors .or. kind == 'NODE') return
      if (kind == 'SEGMENTS') then
         call build_drawing(deck, surface)
      else if (size(deck%card%data) > 0) then
         associate (lines => lines_of(deck%card%data(1)%text(1), deck))
            if (size(lines) > 0 .and. all(deck%line_kind(lines) == rigid_line)) kind = 'RIGID'
         end associate
         if (kind == 'RIGID') call build_line_surface(deck, surface)
      end if
      if (kind /= 'ELEMENT') then
         if (.not. allocated(surface%drawing)) call deck%lose('surface')
         return
      end if
      do j = 1, size(deck%card%data)
         ! A line, or an element set that has some, without a face.
         if (.not. deck%card%data(j)%has(2) .and. size(lines_of(deck%card%data(j)%text(1), &
            deck)) > 0) then
            call add_line_faces(deck%card%data(j), deck, found)
            call named%add(spread(j, 1, found%count - named%count))
            cycle
         end if
         valid = .true.
         if (is_pattern(deck%card%data(j)%text(1))) then
            call deck%find_matches(deck%card%data(j), 1, 'element set', sets)
            elements = [(deck%mesh%element_sets(sets(i))%members, i=1, size(sets))]
            valid = size(sets) > 0
         else
            call deck%need_target('element', deck%card%data(j), 1, target, valid)
            if (valid) elements = target%members(deck%mesh%element_sets)
         end if
         if (.not. deck%card%data(j)%has(2)) then
            if (valid) call add_free_faces(deck%card%data(j), elements, deck, found)
            call named%add(spread(j, 1, found%count - named%count))
            cycle
         end if
         call read_face(deck%card%data(j), deck, face, valid)
         call check_extra(deck%card%data(j), 2, 'element or set, face', deck)
         if (.not. valid) cycle
         call check_face(deck%card%data(j), elements, face, deck, valid)
         if (.not. valid) cycle
         call found%add(4*elements + face - 1)
         call named%add(spread(j, 1, size(elements)))
      end do
      keys = found%numbers()
      order = sort_order(keys)
      order = pack(order, [(i == 1 .or. keys(order(i)) /= keys(order(max(i - 1, 1))), &
         i=1, size(order))])
      cards_of_faces = named%numbers()
      places%items = [(deck%card%data(cards_of_faces(order(i)))%place(1), i=1, size(order))]
      surface%faces = reshape([keys(order)/4, mod(keys(order), 4) + 1], [2, size(order)], &
         order=[2, 1])
   end subroutine build_surface

   !> Adds the sides of elements that no other element of the mesh has.
   subroutine add_free_faces(data, elements, deck, found)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: elements(:)
      type(deck_type), intent(inout) :: deck
      type(number_list_type), intent(inout) :: found
      type(element_sides_type) :: sides
      integer :: before, i, k

      call check_extra(data, 2, 'element or set, face', deck)
      if (.not. all(deck%element_valid) .or. size(elements) == 0) return
      before = found%count
      sides = find_sides(deck%mesh)
      do i = 1, size(elements)
         do k = 1, element_corner_count(deck%mesh%element_kind(elements(i)))
            associate (owners => sides%elements(:, sides%of_element(k, elements(i))))
               if (count(owners > 0) == 1) call found%add([4*elements(i) + k - 1])
            end associate
         end do
      end do
      if (found%count == before) call deck%error(data%place(1), &
         'no side here is free: each belongs to another element, too')
   end subroutine add_free_faces

   !> Adds the faces under lines; the first line with none, or one inside a body, is an error.
   subroutine add_line_faces(data, deck, found)
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(inout) :: deck
      type(number_list_type), intent(inout) :: found
      type(element_sides_type) :: sides
      integer, allocatable :: members(:), uses(:)
      character(:), allocatable :: fault
      integer :: i, bad, ends(3), side

      call check_extra(data, 1, 'element set of lines', deck)
      if (.not. all(deck%element_valid)) return
      members = lines_of(data%text(1), deck)
      allocate (uses(size(members)), source=0)
      sides = find_sides(deck%mesh)
      do i = 1, size(members)
         ends = deck%line_nodes(:, members(i))
         if (any(ends(:2) == 0)) cycle
         ! The midside node of a line is its second or its third.
         side = sides%index_of(ends([1, 3, 2]))
         if (side == 0 .and. ends(3) > 0) side = sides%index_of(ends)
         if (side == 0) cycle
         uses(i) = count(sides%elements(:, side) > 0)
         if (uses(i) == 1) call found%add([4*sides%elements(1, side) + findloc(sides%of_element(:, &
            sides%elements(1, side)), side, dim=1) - 1])
      end do
      if (all(uses == 1)) return
      bad = findloc(uses == 1, .false., dim=1)
      fault = 'belongs to no side of an element'
      if (uses(bad) > 1) fault = 'lies inside a body, between two elements'
      if (count(uses /= 1) > 1) fault = fault//'; lines of the set that are no faces: '// &
         to_text(count(uses /= 1))
      associate (nodes => deck%line_nodes(:, members(bad)))
         if (any(nodes(:2) == 0)) return
         i = findloc(nodes > 0, .true., dim=1, back=.true.)
         if (all(deck%mesh%element_nodes /= nodes(1) .and. deck%mesh%element_nodes /= &
            nodes(2))) fault = fault//', nor do its nodes: its curve is the side of no surface '// &
            'in the drawing, such as a second one at the place of one that is; take that one'
         call deck%error(data%place(1), 'line '//to_text(deck%line_number(members(bad)))//' '// &
            'from node '//to_text(deck%mesh%node_number(nodes(1)))//' to '// &
            to_text(deck%mesh%node_number(nodes(i)))//' '//fault)
      end associate
   end subroutine add_line_faces

   !> Every element of a data card has the face.
   subroutine check_face(data, elements, face, deck, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: elements(:)                 !! indexes of the elements
      integer, intent(in) :: face                        !! 1..4
      type(deck_type), intent(inout) :: deck
      logical, intent(inout) :: valid                    !! becomes false after an error
      integer :: i

      associate (sides => element_corner_count(deck%mesh%element_kind(elements)))
         i = findloc(face > sides .and. deck%element_valid(elements), .true., dim=1)
         if (i == 0) return
         call deck%error(data%place(2), 'element '//to_text(deck%mesh%element_number(elements( &
            i)))//' has '//to_text(sides(i))//' sides')
      end associate
      valid = .false.
   end subroutine check_face

   subroutine read_face(data, deck, face, valid)
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(inout) :: deck
      integer, intent(out) :: face                       !! 1..4, 0 after an error
      logical, intent(inout) :: valid
      character(:), allocatable :: label

      face = 0
      call read_field(data, 2, 'face S1 to S4', deck, label, valid)
      if (len(label) == 0) return
      face = findloc(['S1', 'S2', 'S3', 'S4'] == to_upper(label), .true., dim=1)
      if (face > 0) return
      call deck%error(data%place(2), ''''//data%text(2)//''' is no face; faces are S1 to S4')
      valid = .false.
   end subroutine read_face

   !> Finds the faces of all surfaces of nodes, once these are known.
   subroutine build_node_surfaces(deck)
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: places(:)
      type(target_type) :: target
      logical, allocatable :: named(:)
      real(dp) :: area(2)
      integer :: errors, j, n
      logical :: valid

      places = cards_of(deck%cards, 'SURFACE')
      do n = 1, size(places)
         call deck%open_card(places(n))
         if (chosen(deck%card, 'TYPE', surface_kinds) /= 'NODE') cycle
         errors = deck%error_count()
         named = spread(.false., 1, size(deck%mesh%node_number))
         do j = 1, size(deck%card%data)
            call read_row(deck%card%data(j), '@node or set/area?', deck, area, valid)
            if (deck%card%data(j)%has(2)) call deck%note('*SURFACE, TYPE=NODE: areas are '// &
               'ignored: those of the faces are taken')
            call deck%need_target('node', deck%card%data(j), 1, target, valid)
            if (valid) named(target%members(deck%mesh%node_sets)) = .true.
         end do
         if (deck%error_count() == errors .and. all(deck%element_valid)) call find_faces(named, &
            deck, n)
         if (size(deck%mesh%surfaces(n)%faces, 2) == 0) call deck%lose('surface')
      end do
   end subroutine build_node_surfaces

   !> The outer sides of elements all of whose nodes are named. A node on none of them is an error.
   subroutine find_faces(named, deck, surface)
      logical, intent(in) :: named(:)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: surface
      type(element_sides_type) :: sides
      type(number_list_type) :: found
      logical :: taken(0:size(named))
      integer :: e, f

      sides = find_sides(deck%mesh)
      taken = .false.
      do e = 1, size(deck%mesh%element_number)
         do f = 1, element_corner_count(deck%mesh%element_kind(e))
            associate (side => sides%of_element(f, e))
               associate (nodes => pack(sides%ends(:, side), sides%ends(:, side) > 0))
                  if (sides%elements(2, side) > 0 .or. .not. all(named(nodes))) cycle
                  taken(nodes) = .true.
               end associate
            end associate
            call found%add([e, f])
         end do
      end do
      deck%mesh%surfaces(surface)%faces = reshape(found%numbers(), [2, found%count/2])
      deck%face_places(surface)%items = spread(deck%card%place, 1, size( &
         deck%mesh%surfaces(surface)%faces, 2))
      e = findloc(named .and. .not. taken(1:), .true., dim=1)
      if (e > 0) call deck%error(deck%card%data(1)%place(1), 'node '//to_text( &
         deck%mesh%node_number(e))//' of surface '//deck%mesh%surfaces(surface)%name//' is on '// &
         'no side of an element, at the edge of its body, whose nodes are all in the surface: '// &
         'add the nodes that are missing, or name elements and faces S1 to S4')
   end subroutine find_faces

end module deck_builder_sets
