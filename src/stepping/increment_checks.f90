!> Checks that a solved increment must pass before it is accepted.
module increment_checks
   use contact_system, only: contact_open
   use contact_workspace, only: contact_workspace_type
   use errors, only: check_finite, error_type, set_error, status_no_convergence
   use kinds, only: dp
   use model, only: model_type
   use records, only: increment_record_type
   use simulation, only: simulation_type
   use solution_state, only: solution_state_type
   use steps, only: solves_heat, solves_mechanics
   use text, only: to_text
   use unconstrained_bodies, only: unconstrained_now, undetermined_now
   implicit none
   private
   public :: check_balance, check_heat, check_record, check_values, check_violation
   public :: warn_of_choices

   real(dp), parameter :: sound_violation = 1.0e-6_dp !! largest violation of a sound state
   real(dp), parameter :: sound_imbalance = 1.0e-6_dp !! of heat and forces in discrete equations

contains

   !> The values of an increment are numbers, its rates and forces balance, and contact keeps its
   !> conditions.
   !> Error: status_no_convergence, they do not.
   subroutine check_record(record, analysis, error)
      type(increment_record_type), intent(in) :: record
      integer, intent(in) :: analysis      !! one of the analysis_* constants of steps
      type(error_type), allocatable, intent(out) :: error

      call check_values(record, error)
      if (allocated(error)) return
      if (solves_heat(analysis)) call check_balance(record%heat_imbalance, 'heat rates', error)
      if (allocated(error) .or. .not. solves_mechanics(analysis)) return
      call check_balance(record%force_imbalance, 'forces', error)
      if (.not. allocated(error)) call check_violation(record, error)
   end subroutine check_record

   !> The recovered displacements keep the contact conditions.
   !> Error: they do not.
   subroutine check_violation(record, error)
      type(increment_record_type), intent(in) :: record
      type(error_type), allocatable, intent(out) :: error

      if (record%contact_violation <= sound_violation) return
      call set_error(error, status_no_convergence, &
         'the recovered displacements violate the contact conditions by '// &
         to_text(record%contact_violation)//' of the largest displacement or force')
   end subroutine check_violation

   !> The heat rates, or the forces, of the discrete equations balance.
   !> Error: they do not.
   subroutine check_balance(imbalance, what, error)
      real(dp), intent(in) :: imbalance    !! relative to the largest rate or force
      character(*), intent(in) :: what     !! 'heat rates' or 'forces'
      type(error_type), allocatable, intent(out) :: error

      if (imbalance <= sound_imbalance) return
      call set_error(error, status_no_convergence, 'the '//what//' are out of balance by '// &
         to_text(imbalance)//' of the largest: their rounding outweighs them; look for '// &
         'properties, sizes or values that are many orders of magnitude apart')
   end subroutine check_balance

   !> The fields and the contact state of an increment are numbers.
   !> Error: status_no_convergence, something overflowed.
   subroutine check_values(record, error)
      type(increment_record_type), intent(in) :: record
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      associate (fields => record%fields)
         if (allocated(fields%temperature)) then
            call check_finite(fields%temperature, 'temperatures', status_no_convergence, error)
            if (allocated(error)) return
         end if
         if (allocated(fields%heat_flux)) then
            call check_finite([fields%heat_flux], 'heat fluxes', status_no_convergence, error)
            if (allocated(error)) return
         end if
         if (allocated(fields%reaction_heat)) then
            call check_finite([record%heat_imbalance], 'heat fluxes', status_no_convergence, error)
            if (allocated(error)) return
         end if
         if (allocated(fields%stress)) then
            call check_finite([fields%stress], 'displacements and stresses', &
               status_no_convergence, error)
            if (allocated(error)) return
         end if
         if (allocated(fields%displacement)) then
            call check_finite([fields%displacement, fields%reaction], &
               'displacements and stresses', status_no_convergence, error)
            if (allocated(error)) return
         end if
      end associate
      do i = 1, size(record%contacts)
         associate (contact => record%contacts(i))
            call check_finite([contact%gap, contact%pressure, contact%shear, contact%slip], &
               'gaps and pressures', status_no_convergence, error)
            if (allocated(error)) return
         end associate
      end do
   end subroutine check_values

   !> Names the bodies whose temperature the conductances of an increment leave undetermined, in
   !> place of whatever error followed from it.
   !> Error: there are such bodies.
   subroutine check_heat(run, model, carries, error)
      type(simulation_type), intent(in) :: run                    !! with loads of the increment
      type(model_type), intent(in) :: model
      logical, intent(in) :: carries(:)                           !! (m) whether heat can cross
      type(error_type), allocatable, intent(inout) :: error
      character(:), allocatable :: words

      words = undetermined_now(model, run%bodies%points, run%loads%temperature%active, &
         run%control%step, carries)
      if (len(words) == 0) return
      if (allocated(error)) deallocate (error)
      call set_error(error, status_no_convergence, words)
   end subroutine check_heat

   !> Warns of what the loads leave open, once for as long as it stays: motions that nothing drives
   !> and nothing holds, contact states of which friction allows several.
   subroutine warn_of_choices(run, model, contact, next, undecided, record)
      type(simulation_type), intent(in) :: run                  !! with supports of the increment
      type(model_type), intent(in) :: model
      type(contact_workspace_type), intent(in) :: contact       !! of the solution
      type(solution_state_type), intent(in) :: next             !! state at its end
      character(:), allocatable, intent(inout) :: undecided     !! what was last warned of
      type(increment_record_type), intent(inout) :: record      !! receives the warning
      character(:), allocatable :: free, words

      words = ''
      if (contact%several) words = &
         'with so much friction other contact states satisfy all conditions, too'
      if (size(contact%unconstrained, 2) > 0 .or. any(next%idle)) then
         free = unconstrained_now(model, run%bodies%points, &
            run%bodies%laws%friction%coefficient > 0.0_dp, run%loads%displacement%active, &
            merge(contact_open, next%contact%contact_state, next%idle .or. next%resting))
         if (len(free) > 0) words = &
            free(3:)//'; no load drives it: the smallest movement is used'
      end if
      if (words /= undecided .and. len(words) > 0) call record%warn(words)
      undecided = words
   end subroutine warn_of_choices

end module increment_checks
