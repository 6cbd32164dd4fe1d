!> Checks of steps that store heat: capacities, a start, and what DILATATION needs.
module storage_checks
   use card_places, only: place_type
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use materials, only: follows_temperature, heat_capacity, of_elasticity, of_expansion
   use model, only: model_type
   use steps, only: solves_heat
   use text, only: to_text
   implicit none
   private
   public :: check_storage

contains

   !> Reports what the steps that store heat lack, each thing once, at the first of them.
   subroutine check_storage(context, model, report)
      type(deck_context_type), intent(in) :: context
      type(model_type), intent(in) :: model                !! with its initial temperatures
      type(deck_report_type), intent(inout) :: report      !! receives errors
      logical :: is_used(size(model%materials))
      integer :: first, m

      first = findloc(model%steps%is_transient, .true., dim=1)
      if (first == 0) return
      is_used = [(any(model%sections%material == m), m=1, size(is_used))]
      do m = 1, size(is_used)
         associate (material => model%materials(m))
            if (.not. is_used(m) .or. .not. material%has_specific_heat) cycle
            if (material%has_density) cycle
            call report%missing(context%analysis_place(first), 'material '//material%name// &
               ' has *SPECIFIC HEAT, but no *DENSITY: its heat capacity is the product of both', &
               '*DENSITY')
            return
         end associate
      end do
      if (.not. any(is_used .and. heat_capacity(model%materials) > 0.0_dp)) call report%missing( &
         context%analysis_place(first), 'without STEADY STATE the bodies store heat, but no '// &
         'material of theirs has *SPECIFIC HEAT and *DENSITY; give them, or STEADY STATE', &
         '*SPECIFIC HEAT')
      if (context%temperatures%count == 0 .and. .not. any(solves_heat( &
         model%steps(:first - 1)%analysis))) call report%error(context%analysis_place(first), &
         'a step that stores heat needs temperatures to start from; give *INITIAL CONDITIONS, '// &
         'TYPE=TEMPERATURE, or a steady step before')
      call check_dilatation(context, model, report)
   end subroutine check_storage

   !> DILATATION needs temperatures from absolute zero.
   subroutine check_dilatation(context, model, report)
      type(deck_context_type), intent(in) :: context
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      type(place_type) :: place
      integer :: n

      n = findloc(model%steps%dilates, .true., dim=1)
      if (n == 0) return
      place = context%analysis_place(n)
      if (.not. model%constants%has_absolute_zero) then
         call report%error(place, 'DILATATION needs absolute temperatures; give *PHYSICAL '// &
            'CONSTANTS, ABSOLUTE ZERO=')
         return
      end if
      if (any(follows_temperature(model%materials(model%sections%material), of_elasticity) .or. &
         follows_temperature(model%materials(model%sections%material), of_expansion))) then
         call report%error(place, 'DILATATION needs *ELASTIC and *EXPANSION of one row: with '// &
            'tables over temperature the heat of strains is another one')
         return
      end if
      n = minloc(model%initial_temperature, dim=1, mask=model%mesh%node_body > 0)
      if (model%initial_temperature(n) > model%constants%absolute_zero) return
      call report%error(place, 'DILATATION needs temperatures above absolute zero, '// &
         to_text(model%constants%absolute_zero)//', but node '// &
         to_text(model%mesh%node_number(n))//' starts at '// &
         to_text(model%initial_temperature(n)))
   end subroutine check_dilatation

end module storage_checks
