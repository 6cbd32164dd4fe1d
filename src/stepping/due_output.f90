!> Output due at an increment: fields of the result file, tables of the listing, verdicts.
!> Stress, heat flux and their errors are recovered for these alone.
module due_output
   use checked_values, only: is_recovered
   use kinds, only: dp
   use model, only: model_type, verify_type
   use records, only: increment_record_type
   use print_requests, only: time_points_type
   implicit none
   private
   public :: ends_run, fields_are_due, is_followed, is_judged, is_nth, met_within, &
      needs_recovery, table_is_due

   real(dp), parameter :: landing = 1.0e-6_dp   !! of an increment: how near a time is met

contains

   !> Whether the result file takes the fields of an increment: every n-th of a step and its last,
   !> of n = 0 the last alone.
   pure logical function fields_are_due(record, model)
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model

      associate (step => model%steps(record%step))
         fields_are_due = record%last_of_step .or. table_is_due(step%field_frequency, &
            step%field_points, record, model)
      end associate
   end function fields_are_due

   !> Whether a table of the listing is due: at every n-th increment of a step, at instants of
   !> *TIME POINTS, and at its last increment.
   pure logical function table_is_due(frequency, points, record, model)
      integer, intent(in) :: frequency                    !! n; 0 never
      type(time_points_type), intent(in) :: points
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model

      table_is_due = is_nth(frequency, record)
      if (table_is_due .or. .not. allocated(points%times)) return
      associate (start => sum(model%steps(:record%step - 1)%period), &
         step => model%steps(record%step))
         table_is_due = any(abs(points%in_step(start) + start - record%time) <= &
            met_within(record%time, min(step%first_increment, step%smallest_increment)))
      end associate
   end function table_is_due

   !> Whether an increment is an n-th one of its step, or the last; none is of n = 0.
   pure logical function is_nth(n, record)
      integer, intent(in) :: n                            !! such as restart_frequency of the step
      type(increment_record_type), intent(in) :: record

      is_nth = n > 0
      if (is_nth) is_nth = record%last_of_step .or. modulo(record%increment_in_step, n) == 0
   end function is_nth

   !> How near the end of an increment meets an instant.
   elemental real(dp) function met_within(time, increment)
      real(dp), intent(in) :: time        !! either of them, total time [time]
      real(dp), intent(in) :: increment   !! least one that counts [time]

      met_within = 1.0e-12_dp*abs(time) + landing*increment
   end function met_within

   !> Whether an increment is the last of all steps, but for those that a *CYCLE leaves out.
   pure logical function ends_run(record, model)
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model

      ends_run = record%last_of_step .and. record%step + record%left_out == size(model%steps)
   end function ends_run

   !> Whether a check is judged on an increment.
   pure logical function is_judged(check, record, model)
      type(verify_type), intent(in) :: check
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model

      if (check%at_last) then
         is_judged = ends_run(record, model)
      else
         is_judged = abs(record%time - check%when) <= met_within(check%when, &
            model%steps(record%step)%first_increment)
      end if
   end function is_judged

   !> Whether a check of when a value is reached looks at an increment.
   pure logical function is_followed(check, record, model)
      type(verify_type), intent(in) :: check
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model

      is_followed = allocated(check%level)
      if (is_followed .and. .not. check%at_last) is_followed = record%time <= check%when + &
         met_within(check%when, model%steps(record%step)%first_increment)
   end function is_followed

   !> Whether anything asks for stress, heat flux or their errors. The last increment of a step
   !> always does: the listing tells its errors.
   pure logical function needs_recovery(record, model)
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model
      integer :: i

      needs_recovery = fields_are_due(record, model)
      do i = 1, size(model%verifications)
         if (needs_recovery) return
         associate (check => model%verifications(i))
            needs_recovery = is_judged(check, record, model)
            if (is_followed(check, record, model)) needs_recovery = is_recovered(check)
         end associate
      end do
   end function needs_recovery

end module due_output
