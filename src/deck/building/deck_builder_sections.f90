!> *SOLID SECTION -> material and thickness of elements.
module deck_builder_sections
   use card_parameters, only: has_parameter, need_parameter, parameter_place, parameter_text
   use card_values, only: check_extra, take_field
   use cards, only: cards_type, field_place, keyword_card_type
   use deck_builder_materials, only: find_material
   use deck_builder_orientations, only: find_orientation
   use deck_context, only: deck_context_type, find_set, report_lines, report_unknown, &
      set_names
   use deck_report, only: deck_report_type
   use deck_structure, only: card_count, has_stand_in
   use element_kinds, only: axisymmetric
   use kinds, only: dp
   use materials, only: section_type
   use mesh, only: mesh_type, set_type
   use model, only: model_type
   use text, only: string_type, to_text, to_upper
   implicit none
   private
   public :: build_sections, named_element_set

contains

   !> Takes all sections, and gives the elements theirs.
   subroutine build_sections(cards, context, model, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context    !! receives notes, whether all is sound
      type(model_type), intent(inout) :: model             !! receives the sections
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer :: k, n

      allocate(model%sections(card_count(cards, 'SOLID SECTION')))
      context%sections_sound = .not. (has_stand_in(cards, 'SOLID SECTION') .or. &
         report%has_lost('element set'))
      n = 0
      do k = 1, size(cards%keywords)
         if (cards%keywords(k)%name /= 'SOLID SECTION') cycle
         n = n + 1
         call build_section(cards, cards%keywords(k), model, report, model%sections(n))
         call give_section(cards%keywords(k), n, context%line_sets, model%mesh, report, &
            context%sections_sound)
         if (cards%keywords(k)%last_data >= cards%keywords(k)%first_data) cycle
         if (any(model%mesh%element_section == n .and. &
            model%mesh%element_plane /= axisymmetric)) then
            call context%note('*SOLID SECTION without a thickness: '// &
               to_text(model%sections(n)%thickness))
         end if
      end do
   end subroutine build_sections

   subroutine build_section(cards, card, model, report, section)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      type(section_type), intent(out) :: section
      character(:), allocatable :: name
      type(string_type), allocatable :: names(:)
      integer :: i
      logical :: valid

      call need_parameter(card, 'MATERIAL', report, name)
      section%material = find_material(model%materials, name)
      if (section%material == 0 .and. len(name) > 0) then
         allocate(names(size(model%materials)))
         do i = 1, size(names)
            names(i)%value = model%materials(i)%name
         end do
         call report_unknown('material', name, names, parameter_place(card, 'MATERIAL'), report)
      end if
      call take_orientation(card, model, report, section)
      if (card%last_data < card%first_data) return
      valid = .true.
      associate (data => cards%data(card%first_data))
         call take_field(data, 1, 'thickness', report, section%thickness, valid)
         call check_extra(data, 1, 'thickness', report)
         if (section%thickness <= 0.0_dp) then
            call report%error(field_place(data, 1), 'the thickness must be positive')
         end if
      end associate
   end subroutine build_section

   subroutine take_orientation(card, model, report, section)
      type(keyword_card_type), intent(in) :: card
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      type(section_type), intent(inout) :: section
      character(:), allocatable :: name
      type(string_type), allocatable :: names(:)
      integer :: i

      if (.not. has_parameter(card, 'ORIENTATION')) return
      name = to_upper(parameter_text(card, 'ORIENTATION'))
      section%orientation = find_orientation(model%orientations, name)
      if (section%orientation > 0) return
      allocate(names(size(model%orientations)))
      do i = 1, size(names)
         names(i)%value = model%orientations(i)%name
      end do
      call report_unknown('orientation', name, names, parameter_place(card, 'ORIENTATION'), &
         report)
   end subroutine take_orientation

   !> Gives the elements of its set a section; sound becomes false where that set is not known.
   subroutine give_section(card, section, line_sets, mesh, report, sound)
      type(keyword_card_type), intent(in) :: card
      integer, intent(in) :: section
      type(set_type), intent(in) :: line_sets(:)
      type(mesh_type), intent(inout) :: mesh
      type(deck_report_type), intent(inout) :: report
      logical, intent(inout) :: sound
      character(:), allocatable :: name
      integer :: set

      call named_element_set(card, mesh, report, set)
      sound = sound .and. set > 0
      if (set == 0) return
      name = mesh%element_sets(set)%name
      if (find_set(line_sets, name) > 0) call report%warning( &
         parameter_place(card, 'ELSET'), 'element set '//name// &
         ' also has lines, which are ignored: bars are not modelled')
      associate (members => mesh%element_sets(set)%members)
         if (any(mesh%element_section(members) > 0)) call report%warning(card%place, &
            'this section replaces an earlier one; elements concerned: '// &
            to_text(count(mesh%element_section(members) > 0)))
         mesh%element_section(members) = section
      end associate
   end subroutine give_section

   !> Index of the set of elements that ELSET= of a card names; 0 after an error.
   subroutine named_element_set(card, mesh, report, set)
      type(keyword_card_type), intent(in) :: card
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer, intent(out) :: set
      character(:), allocatable :: name
      logical :: valid

      set = 0
      valid = .true.
      call need_parameter(card, 'ELSET', report, name)
      if (len(name) == 0) return
      set = find_set(mesh%element_sets, name)
      if (set == 0) then
         call report_unknown('element set', name, set_names(mesh%element_sets), &
            parameter_place(card, 'ELSET'), report)
      else if (mesh%element_sets(set)%of_lines) then
         call report_lines(name, parameter_place(card, 'ELSET'), report, valid)
         set = 0
      end if
   end subroutine named_element_set

end module deck_builder_sections
