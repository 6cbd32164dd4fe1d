!> *SURFACE -> sets of element faces.
module deck_builder_surfaces
   use card_parameters, only: choose, parameter_place
   use card_values, only: check_extra, need_field
   use cards, only: cards_type, data_card_type, field_place, field_text, has_field, &
      keyword_card_type
   use deck_context, only: deck_context_type, name_last, place_list_type, read_target
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use deck_structure, only: cards_of
   use element_kinds, only: element_corner_count
   use line_faces, only: find_line_faces
   use mesh, only: mesh_type, surface_type
   use named_items, only: find_named
   use sorting, only: sort_order
   use text, only: to_text, to_upper
   implicit none
   private
   public :: build_surfaces

contains

   !> Builds all surfaces.
   subroutine build_surfaces(cards, context, mesh, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context    !! receives their places
      type(mesh_type), intent(inout) :: mesh               !! receives the surfaces
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer, allocatable :: places(:)
      integer :: n
      logical :: repeated

      places = cards_of(cards, 'SURFACE')
      allocate(mesh%surfaces(size(places)), context%face_places(size(places)))
      do n = 1, size(places)
         call name_last(cards, places(n), 'surface', mesh%surfaces(:n), report, repeated)
         if (repeated) call report%lose('surface')
         call build_surface(cards, cards%keywords(places(n)), context, mesh, report, &
            mesh%surfaces(n), context%face_places(n))
      end do
   end subroutine build_surfaces

   !> Builds one surface; a face that is named twice counts once, in the order of elements.
   subroutine build_surface(cards, card, context, mesh, report, surface, places)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(in) :: context
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report
      type(surface_type), intent(inout) :: surface
      type(place_list_type), intent(inout) :: places   ! receives where each face is named
      character(:), allocatable :: kind
      type(place_type), allocatable :: named(:)
      integer, allocatable :: elements(:), keys(:), order(:)
      integer :: element, set, face, j, errors
      logical :: valid

      kind = 'ELEMENT'
      surface%card = card%place%image
      errors = report%error_count()
      call choose(card, 'TYPE', 'ELEMENT/NODE', report, kind)
      if (kind == 'NODE') call report%error(parameter_place(card, 'TYPE'), 'TYPE=NODE is '// &
         'refused on *SURFACE: contact needs the areas and normals of faces; name elements and '// &
         'faces S1 to S4')
      if (report%error_count() > errors) then
         ! The data of another type have other fields.
         allocate(surface%faces(2, 0))
         return
      end if
      allocate(keys(0), named(0))
      do j = card%first_data, card%last_data
         ! An element set that has lines, without a face.
         if (.not. has_field(cards%data(j), 2) .and. find_named(context%line_sets, &
            field_text(cards%data(j), 1)) > 0) then
            call add_line_faces(cards%data(j), context, mesh, report, keys)
            named = [named, spread(field_place(cards%data(j), 1), 1, size(keys) - size(named))]
            cycle
         end if
         valid = .true.
         call read_target(cards%data(j), 1, 'element', context%element_index, mesh%element_sets, &
            report, element, set, valid)
         ! An unknown set may be one of lines, which has no face.
         if (valid .or. has_field(cards%data(j), 2)) call read_face(cards%data(j), report, face, &
            valid)
         call check_extra(cards%data(j), 2, 'element or set, face', report)
         if (.not. valid) cycle
         elements = [element]
         if (set > 0) elements = mesh%element_sets(set)%members
         call check_face(cards%data(j), mesh, elements, face, report, valid)
         if (.not. valid) cycle
         keys = [keys, 4*elements + face - 1]
         named = [named, spread(field_place(cards%data(j), 1), 1, size(keys) - size(named))]
      end do
      call sort_faces(keys, order)
      places%items = named(order)
      surface%faces = reshape([keys(order)/4, mod(keys(order), 4) + 1], [2, size(order)], &
         order=[2, 1])
   end subroutine build_surface

   !> The order of faces by their keys, of equal ones the first alone.
   subroutine sort_faces(keys, order)
      integer, intent(in) :: keys(:)
      integer, allocatable, intent(out) :: order(:)
      integer :: i

      order = sort_order(keys)
      order = pack(order, [(i == 1 .or. keys(order(i)) /= keys(order(max(i - 1, 1))), &
         i=1, size(order))])
   end subroutine sort_faces

   !> Adds the faces under the lines of a set; the first line under which there is none, or one
   !> inside a body, is an error.
   subroutine add_line_faces(data, context, mesh, report, keys)
      type(data_card_type), intent(in) :: data
      type(deck_context_type), intent(in) :: context
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report
      integer, allocatable, intent(inout) :: keys(:)
      integer, allocatable :: members(:), faces(:, :), uses(:)
      character(:), allocatable :: fault
      integer :: i, bad

      call check_extra(data, 1, 'element set of lines', report)
      members = context%line_sets(find_named(context%line_sets, field_text(data, 1)))%members
      allocate(faces(2, size(members)), uses(size(members)))
      call find_line_faces(mesh, context%element_valid, context%line_nodes(:, members), faces, uses)
      keys = [keys, pack(4*faces(1, :) + faces(2, :) - 1, uses == 1)]
      if (all(uses == 1) .or. .not. all(context%element_valid)) return
      bad = findloc(uses == 1, .false., dim=1)
      fault = 'belongs to no side of an element'
      if (uses(bad) > 1) fault = 'lies inside a body, between two elements'
      if (count(uses /= 1) > 1) fault = fault//'; lines of the set that are no faces: '// &
         to_text(count(uses /= 1))
      associate (nodes => context%line_nodes(:, members(bad)))
         if (any(nodes(:2) == 0)) return
         i = findloc(nodes > 0, .true., dim=1, back=.true.)
         call report%error(field_place(data, 1), 'line '// &
            to_text(context%line_number(members(bad)))//' from node '// &
            to_text(mesh%node_number(nodes(1)))//' to '//to_text(mesh%node_number(nodes(i)))// &
            ' '//fault)
      end associate
   end subroutine add_line_faces

   !> Every element of a data card has the face.
   subroutine check_face(data, mesh, elements, face, report, valid)
      type(data_card_type), intent(in) :: data
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: elements(:), face
      type(deck_report_type), intent(inout) :: report
      logical, intent(inout) :: valid
      integer :: i

      do i = 1, size(elements)
         if (face <= element_corner_count(mesh%element_kind(elements(i)))) cycle
         call report%error(field_place(data, 2), 'element '// &
            to_text(mesh%element_number(elements(i)))//' is a triangle and has no face S'// &
            to_text(face))
         valid = .false.
         return
      end do
   end subroutine check_face

   !> Reads the second field of a card as S and the number of a face.
   subroutine read_face(data, report, face, valid)
      type(data_card_type), intent(in) :: data
      type(deck_report_type), intent(inout) :: report
      integer, intent(out) :: face                       !! 1..4, 0 after an error
      logical, intent(inout) :: valid
      character(:), allocatable :: label

      face = 0
      call need_field(data, 2, 'face S1 to S4', report, label, valid)
      if (len(label) == 0) return
      label = to_upper(label)
      if (len(label) == 2) then
         if (label(1:1) == 'S') face = index('1234', label(2:2))
      end if
      if (face > 0) return
      call report%error(field_place(data, 2), ''''//field_text(data, 2)// &
         ''' is no face; faces are S1 to S4')
      valid = .false.
   end subroutine read_face

end module deck_builder_surfaces
