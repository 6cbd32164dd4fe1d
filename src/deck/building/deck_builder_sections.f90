!> *ORIENTATION and *SOLID SECTION -> material, its axes and thickness of elements.
module deck_builder_sections
   use card_parameters, only: choose, parameter_place
   use card_values, only: check_extra, need_field, take_field
   use cards, only: cards_type, data_card_type, field_place, has_field, keyword_card_type
   use deck_context, only: deck_context_type, name_last, need_element_set, need_named, take_named
   use deck_report, only: deck_report_type
   use deck_structure, only: cards_of, has_stand_in
   use element_kinds, only: axisymmetric
   use kinds, only: dp
   use mesh, only: mesh_type, set_type
   use model, only: model_type
   use named_items, only: find_named
   use orientations, only: orientation_type
   use text, only: to_text
   implicit none
   private
   public :: build_orientations, build_sections

   real(dp), parameter :: degree = acos(-1.0_dp)/180

contains

   !> Builds all orientations.
   subroutine build_orientations(cards, model, report)
      type(cards_type), intent(in) :: cards
      type(model_type), intent(inout) :: model             !! receives the orientations
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer, allocatable :: places(:)
      integer :: n
      logical :: repeated

      places = cards_of(cards, 'ORIENTATION')
      allocate(model%orientations(size(places)))
      do n = 1, size(places)
         associate (card => cards%keywords(places(n)))
            call name_last(cards, places(n), 'orientation', model%orientations(:n), report, &
               repeated)
            if (card%last_data >= card%first_data) call build_axes(cards, card, &
               model%orientations(n), report)
         end associate
      end do
   end subroutine build_orientations

   !> Two points. a lies on axis 1, b in the plane of axes 1 and 2 on the side of axis 2; or both
   !> lie on the axis of a cylinder, along which axis 3 points from a to b.
   subroutine build_axes(cards, card, orientation, report)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(orientation_type), intent(inout) :: orientation
      type(deck_report_type), intent(inout) :: report
      character(:), allocatable :: system
      real(dp) :: a(3), b(3), turn
      logical :: valid

      system = 'RECTANGULAR'
      call choose(card, 'SYSTEM', 'RECTANGULAR/CYLINDRICAL', report, system)
      valid = .true.
      associate (data => cards%data(card%first_data))
         call read_point(data, 1, 'a', report, a, valid)
         call read_point(data, 4, 'b', report, b, valid)
         call check_extra(data, 6, 'a(1), a(2), a(3), b(1), b(2), b(3)', report)
         if (.not. valid) return
         orientation%cylindrical = system == 'CYLINDRICAL'
         turn = a(1)*b(2) - a(2)*b(1)
         if (orientation%cylindrical) then
            if (norm2(b(1:2) - a(1:2)) > 0.0_dp .or. .not. abs(b(3) - a(3)) > 0.0_dp) call &
               report%error(field_place(data, 4), &
               'the axis through a and b must be parallel to z')
            orientation%centre = a(1:2)
            orientation%hand = sign(1.0_dp, b(3) - a(3))
         else if (abs(a(3)) > 0.0_dp .or. abs(b(3)) > 0.0_dp) then
            call report%error(field_place(data, merge(3, 6, abs(a(3)) > 0.0_dp)), &
               'axes 1 and 2 lie in the plane: the z components of a and b must be 0')
         else if (.not. abs(turn) > epsilon(turn)*norm2(a)*norm2(b)) then
            call report%error(field_place(data, 1), 'a and b must not lie on one line')
         else
            orientation%direction = a(1:2)/norm2(a(1:2))
            orientation%hand = sign(1.0_dp, turn)
         end if
      end associate
      if (card%last_data > card%first_data) then
         call turn_axes(cards%data(card%first_data + 1), orientation, report)
      end if
   end subroutine build_axes

   subroutine read_point(data, first, name, report, point, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: first
      character(*), intent(in) :: name
      type(deck_report_type), intent(inout) :: report
      real(dp), intent(out) :: point(3)
      logical, intent(inout) :: valid
      integer :: i

      point = 0.0_dp
      do i = 1, 3
         call need_field(data, first + i - 1, 'component of '//name, report, point(i), valid)
         if (.not. has_field(data, first + i - 1)) exit
      end do
   end subroutine read_point

   !> The second card: a turn round axis 3, from axis 1 towards axis 2.
   subroutine turn_axes(data, orientation, report)
      type(data_card_type), intent(in) :: data
      type(orientation_type), intent(inout) :: orientation
      type(deck_report_type), intent(inout) :: report
      real(dp) :: angle
      integer :: axis
      logical :: valid

      valid = .true.
      axis = 3
      angle = 0.0_dp
      call need_field(data, 1, 'axis', report, axis, valid)
      call take_field(data, 2, 'angle in degrees', report, angle, valid)
      call check_extra(data, 2, 'axis, angle', report)
      if (.not. valid) return
      if (axis /= 3) then
         call report%error(field_place(data, 1), &
            'a turn about axis 1 or 2 leaves the plane: only axis 3')
         return
      end if
      angle = angle*degree
      associate (first => orientation%direction, &
         second => orientation%hand*[-orientation%direction(2), orientation%direction(1)])
         orientation%direction = cos(angle)*first + sin(angle)*second
      end associate
   end subroutine turn_axes

   !> Builds all sections, and gives the elements theirs.
   subroutine build_sections(cards, context, model, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context    !! receives notes, whether all is sound
      type(model_type), intent(inout) :: model             !! receives the sections
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer, allocatable :: places(:)
      integer :: n
      logical :: valid

      places = cards_of(cards, 'SOLID SECTION')
      allocate(model%sections(size(places)))
      context%sections_sound = .not. (has_stand_in(cards, 'SOLID SECTION') .or. &
         report%has_lost('element set'))
      valid = .true.
      do n = 1, size(places)
         associate (card => cards%keywords(places(n)), section => model%sections(n))
            call need_named(card, 'MATERIAL', 'material', model%materials, report, &
               section%material)
            call take_named(card, 'ORIENTATION', 'orientation', model%orientations, report, &
               section%orientation)
            if (card%last_data >= card%first_data) then
               associate (data => cards%data(card%first_data))
                  call take_field(data, 1, 'thickness', report, section%thickness, valid)
                  call check_extra(data, 1, 'thickness', report)
                  if (section%thickness <= 0.0_dp) call report%error(field_place(data, 1), &
                     'the thickness must be positive')
               end associate
            end if
            call give_section(card, n, context%line_sets, model%mesh, report, &
               context%sections_sound)
            if (card%last_data < card%first_data .and. any(model%mesh%element_section == n .and. &
               model%mesh%element_plane /= axisymmetric)) call context%note( &
               '*SOLID SECTION without a thickness: '//to_text(section%thickness))
         end associate
      end do
   end subroutine build_sections

   !> Gives the elements of its set a section; sound becomes false where that set is not known.
   subroutine give_section(card, section, line_sets, mesh, report, sound)
      type(keyword_card_type), intent(in) :: card
      integer, intent(in) :: section
      type(set_type), intent(in) :: line_sets(:)
      type(mesh_type), intent(inout) :: mesh
      type(deck_report_type), intent(inout) :: report
      logical, intent(inout) :: sound
      integer :: set

      call need_element_set(card, mesh%element_sets, report, set)
      sound = sound .and. set > 0
      if (set == 0) return
      if (find_named(line_sets, mesh%element_sets(set)%name) > 0) call report%warning( &
         parameter_place(card, 'ELSET'), 'element set '//mesh%element_sets(set)%name// &
         ' also has lines, which are ignored: bars are not modelled')
      associate (members => mesh%element_sets(set)%members)
         if (any(mesh%element_section(members) > 0)) call report%warning(card%place, &
            'this section replaces an earlier one; elements concerned: '// &
            to_text(count(mesh%element_section(members) > 0)))
         mesh%element_section(members) = section
      end associate
   end subroutine give_section

end module deck_builder_sections
