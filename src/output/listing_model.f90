!> The listing's summary of the model: what will be modelled and why, sizes, interfaces.
module listing_model
   use contact_points, only: contact_points_type
   use hanging_nodes, only: hanging_count
   use interface_warnings, only: gap_range
   use kinds, only: dp
   use listing_text, only: print_title, print_wrapped
   use model, only: model_type
   use model_words, only: closed_law_words, friction_words, material_words, &
      open_law_words, open_words, pairing_words, points_words, section_words
   use steps, only: analysis_heat, analysis_static, solves_heat
   use run_summaries, only: or_blank, run_summary_type
   use text, only: string_type, to_text
   implicit none
   private
   public :: print_model

contains

   !> Prints the summary.
   subroutine print_model(unit, model, interfaces, run)
      integer, intent(in) :: unit                         !! unit of the listing
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(run_summary_type), intent(in) :: run
      type(string_type), allocatable :: sections(:)
      integer :: i

      call print_title(unit, 'PHYSICS')
      call print_wrapped(unit, '   ', or_blank(run%modelled))
      if (or_blank(run%reasons) /= '') call print_wrapped(unit, '   ', run%reasons)
      call print_title(unit, 'MODEL')
      call print_count(unit, 'bodies', model%mesh%body_count)
      call print_count(unit, 'nodes', size(model%mesh%node_number))
      call print_count(unit, 'elements', size(model%mesh%element_number))
      call print_count(unit, 'uniform refinements', model%refinement_levels)
      if (hanging_count(model%mesh) > 0) call print_count(unit, 'sides with hanging nodes', &
         hanging_count(model%mesh))
      if (model%element_order == 1) call print_entry(unit, 'order of the elements', &
         '1 (*OPTIONS, ORDER=1)')
      call print_count(unit, 'steps', size(model%steps))
      call print_steps(unit, model)
      call print_count(unit, 'unknown temperatures', run%equations_thermal)
      call print_count(unit, 'unknown displacements', run%equations_mechanical)
      call print_count(unit, 'contact unknowns', run%contact_unknowns)
      call print_entry(unit, 'solver', or_blank(run%solver))
      call print_entry(unit, 'bytes of factors', to_text(real(run%factor_bytes, dp)))
      call print_entry(unit, 'smallest pivot', to_text(run%smallest_pivot)// &
         ' of its diagonal entry')
      call print_entry(unit, 'load axis', or_blank(model%load_label))
      if (run%has_biot) call print_entry(unit, 'contact Biot number', from_to(run%contact_biot))
      sections = section_words(model)
      do i = 1, size(sections)
         call print_entry(unit, 'section '//to_text(i), sections(i)%value)
      end do
      do i = 1, size(model%materials)
         call print_entry(unit, 'material '//model%materials(i)%name, &
            material_words(model%materials(i)))
      end do
      call print_interfaces(unit, model, interfaces)
   end subroutine print_model

   subroutine print_interfaces(unit, model, interfaces)
      integer, intent(in) :: unit
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:)
      logical :: has_heat
      integer :: i

      has_heat = any(solves_heat(model%steps%analysis))
      do i = 1, size(interfaces)
         write (unit, '(/, 3x, 2a)') 'INTERFACE ', interfaces(i)%name
         call print_entry(unit, 'pairing', pairing_words(model%contacts(i)%pairing, interfaces(i)))
         call print_count(unit, points_words(interfaces(i)), size(interfaces(i)%slave_node))
         if (len(open_words(interfaces(i))) > 0) call print_entry(unit, 'note', &
            open_words(interfaces(i)))
         call print_entry(unit, 'length', to_text(maxval(interfaces(i)%arc_length)))
         call print_entry(unit, 'initial gaps', &
            from_to(gap_range(model%mesh, interfaces(i))))
         associate (interaction => model%interactions(model%contacts(i)%interaction))
            call print_entry(unit, 'coefficient of friction', friction_words(interaction%friction))
            if (.not. has_heat) cycle
            call print_entry(unit, 'conductance, open', open_law_words(interaction%law))
            call print_entry(unit, 'conductance, closed', closed_law_words(interaction%law))
         end associate
      end do
   end subroutine print_interfaces

   !> Analysis and scheme of (3.4) of every step; equal steps in one line.
   subroutine print_steps(unit, model)
      integer, intent(in) :: unit
      type(model_type), intent(in) :: model
      character(:), allocatable :: line, before
      integer :: first, i

      before = ''
      first = 1
      do i = 1, size(model%steps)
         associate (step => model%steps(i))
            select case (step%analysis)
            case (analysis_static)
               line = 'mechanics'
            case (analysis_heat)
               line = 'heat, scheme '//trim(step%scheme%name)
            case default
               line = 'heat and mechanics, scheme '//trim(step%scheme%name)
            end select
         end associate
         if (i > 1 .and. line /= before) then
            call print_entry(unit, step_range(first, i - 1), before)
            first = i
         end if
         before = line
      end do
      call print_entry(unit, step_range(first, size(model%steps)), before)
   end subroutine print_steps

   pure function step_range(first, last) result(words)
      integer, intent(in) :: first, last
      character(:), allocatable :: words

      words = 'step '//to_text(first)
      if (last > first) words = 'steps '//to_text(first)//' to '//to_text(last)
   end function step_range

   subroutine print_count(unit, name, number)
      integer, intent(in) :: unit
      character(*), intent(in) :: name
      integer, intent(in) :: number

      call print_entry(unit, name, to_text(number))
   end subroutine print_count

   subroutine print_entry(unit, name, value)
      integer, intent(in) :: unit
      character(*), intent(in) :: name
      character(*), intent(in) :: value

      call print_wrapped(unit, '   '//name//' '//repeat('.', max(26 - len(name), 2))//' ', value)
   end subroutine print_entry

   pure function from_to(ends) result(string)
      real(dp), intent(in) :: ends(2)
      character(:), allocatable :: string

      string = to_text(ends(1))//' to '//to_text(ends(2))
   end function from_to

end module listing_model
