!> *PRE-TENSION SECTION -> a body cut in two, and the section that joins its faces again.
module deck_builder_sections
   use card_values, only: read_row
   use cards, only: keyword_card_type
   use deck_builder_equations, only: find_reference
   use deck_builder_rigid, only: need_faces
   use deck_context, only: deck_type
   use deck_structure, only: cards_of
   use equations, only: coupling_type
   use kinds, only: dp
   use mesh, only: surface_type
   use section_cuts, only: cut_mesh, section_normal, unit_vector
   use text, only: to_text
   implicit none
   private
   public :: build_pre_tensions

contains

   !> Builds all sections, behind the couplings: their nodes are behind all others.
   subroutine build_pre_tensions(deck)
      type(deck_type), intent(inout) :: deck
      type(coupling_type) :: section
      integer, allocatable :: places(:)
      integer :: k

      places = cards_of(deck%cards, 'PRE-TENSION SECTION')
      do k = 1, size(places)
         call build_section(deck%cards%keywords(places(k)), deck, section)
         if (section%opposite > 0) then
            deck%model%couplings = [deck%model%couplings, section]
         else
            call deck%lose('equation')
         end if
      end do
   end subroutine build_pre_tensions

   !> Builds one section; without an opposite face after an error.
   subroutine build_section(card, deck, section)
      type(keyword_card_type), intent(in) :: card
      type(deck_type), intent(inout) :: deck
      type(coupling_type), intent(out) :: section
      character(:), allocatable :: fault
      real(dp) :: given(3)
      logical :: sound, valid

      section%card = card%place%image
      section%title = '*PRE-TENSION SECTION, '//deck%source%words_of(card%place)
      call find_reference('NODE', card, deck, section%reference)
      call deck%need_named(card, 'SURFACE', 'surface', section%surface)
      call need_faces(card%place_of('SURFACE'), 'a section lies between elements of a body', deck, &
         section%surface)
      valid = section%reference > 0 .and. section%surface > 0 .and. all(deck%element_valid)
      if (valid) valid = size(deck%mesh%surfaces(section%surface)%faces) > 0
      if (valid) section%normal = section_normal(section%surface, deck%mesh)
      if (size(card%data) > 0) then
         call read_row(card%data(1), 'x of the normal/y of the normal/z of the normal?', deck, &
            given, sound)
         valid = valid .and. sound
         section%normal = unit_vector(given(:2))
         if (sound .and. (norm2(section%normal) <= 0.0_dp .or. abs(given(3)) > 0.0_dp)) then
            call deck%error(card%data(1)%place(1), 'the normal of a section is a direction in '// &
               'the plane, such as 0., 1., 0.')
            valid = .false.
         end if
      end if
      if (.not. valid) return
      fault = ''
      if (norm2(section%normal) <= 0.0_dp) fault = 'is closed: it has no normal'
      if (any(deck%mesh%element_nodes == section%reference)) fault = 'has node '// &
         to_text(deck%mesh%node_number(section%reference))//', which elements have, too: the '// &
         'reference node is a node of its own'
      if (any(deck%model%couplings%reference == section%reference)) fault = 'has node '// &
         to_text(deck%mesh%node_number(section%reference))//', which is the reference node of '// &
         'another card'
      if (len(fault) == 0) call cut(card, deck, section, fault)
      if (len(fault) > 0) call deck%error(card%place, 'this section '//fault)
   end subroutine build_section

   !> Cuts the mesh, and adds the other face.
   subroutine cut(card, deck, section, fault)
      type(keyword_card_type), intent(in) :: card
      type(deck_type), intent(inout) :: deck
      type(coupling_type), intent(inout) :: section
      character(:), allocatable, intent(out) :: fault
      type(surface_type) :: other
      integer :: first, last

      call cut_mesh(section%surface, deck%mesh, other%faces, first, fault)
      if (len(fault) > 0) return
      last = size(deck%mesh%node_number)
      ! No deck can name it.
      other%name = section%title
      other%card = section%card
      deck%mesh%surfaces = [deck%mesh%surfaces, other]
      section%opposite = size(deck%mesh%surfaces)
      deck%face_places = [deck%face_places, deck%face_places(section%surface)]
      deck%node_place = [deck%node_place, spread(card%place, 1, last - first + 1)]
      deck%node_valid = [deck%node_valid, spread(.true., 1, last - first + 1)]
      deck%dropped = [deck%dropped, spread(.false., 1, last - first + 1)]
      call deck%note(section%title//': the elements of its surface have the nodes '// &
         to_text(deck%mesh%node_number(first))//' to '//to_text(deck%mesh%node_number(last))// &
         ' there, which the deck does not have')
   end subroutine cut

end module deck_builder_sections
