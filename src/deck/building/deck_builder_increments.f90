!> Data card of an analysis -> first increment, period, smallest and largest increment of a step.
module deck_builder_increments
   use card_values, only: check_extra, take_field
   use cards, only: data_card_type, field_place, has_field
   use decimal_commas, only: decimal_comma, report_decimal_comma
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use steps, only: least_increment, step_type
   use text, only: to_text
   implicit none
   private
   public :: build_increments

   real(dp), parameter :: smallest_part = 1.0e-5_dp   !! of a period: smallest increment

contains

   !> First increment, period, smallest and largest increment.
   subroutine build_increments(data, context, report, step)
      type(data_card_type), intent(in) :: data             !! data card of the analysis
      type(deck_context_type), intent(inout) :: context    !! receives notes
      type(deck_report_type), intent(inout) :: report      !! receives errors and warnings
      type(step_type), intent(inout) :: step               !! receives the times
      integer :: comma
      logical :: valid

      valid = .true.
      call take_field(data, 1, 'first increment', report, step%first_increment, valid)
      call take_field(data, 2, 'period', report, step%period, valid)
      step%smallest_increment = min(smallest_part*step%period, step%first_increment)
      step%largest_increment = step%first_increment
      call take_field(data, 3, 'smallest increment', report, step%smallest_increment, valid)
      call take_field(data, 4, 'largest increment', report, step%largest_increment, valid)
      call note_increments(data, step, context)
      comma = decimal_comma(data)
      if (comma > 0 .and. (size(data%fields) > 4 .or. .not. times_fit(data, step))) then
         call report_decimal_comma(data, comma, report)
         valid = .false.
      else
         call check_extra(data, 4, 'first increment, period, smallest, largest increment', report)
         if (valid) call check_times(data, step, report, valid)
      end if
      if (.not. valid) then
         step%first_increment = 1.0_dp
         step%period = 1.0_dp
      else if (step%largest_increment < step%first_increment) then
         step%first_increment = step%largest_increment
         step%smallest_increment = min(step%smallest_increment, step%first_increment)
         call report%warning(field_place(data, 4), 'the first increment is longer than the '// &
            'largest, and is shortened to it')
      else if (step%smallest_increment < least_increment*step%period) then
         step%smallest_increment = least_increment*step%period
         call context%note('smallest increment raised to '//to_text(step%smallest_increment)// &
            ': a smaller part of the period is lost in rounding')
      end if
   end subroutine build_increments

   !> Whether the times of a step are positive, and the first increment lies between the smallest
   !> and the period.
   pure logical function times_fit(data, step)
      type(data_card_type), intent(in) :: data
      type(step_type), intent(in) :: step

      times_fit = .not. any(not_positive(data, step)) .and. &
         step%first_increment <= step%period .and. step%smallest_increment <= step%first_increment
   end function times_fit

   !> Which of the times that the card gives are not positive.
   pure function not_positive(data, step)
      type(data_card_type), intent(in) :: data
      type(step_type), intent(in) :: step
      logical :: not_positive(4)
      integer :: i

      not_positive = [step%first_increment, step%period, step%smallest_increment, &
         step%largest_increment] <= 0.0_dp .and. [(has_field(data, i), i=1, 4)]
   end function not_positive

   subroutine check_times(data, step, report, valid)
      type(data_card_type), intent(in) :: data
      type(step_type), intent(in) :: step
      type(deck_report_type), intent(inout) :: report
      logical, intent(inout) :: valid
      logical :: wrong(4)
      integer :: i

      valid = times_fit(data, step)
      wrong = not_positive(data, step)
      do i = 1, 4
         if (wrong(i)) call report%error(field_place(data, i), &
            'increments and periods must be positive')
      end do
      if (valid .or. any(wrong)) return
      if (step%first_increment > step%period) then
         call report%error(field_place(data, 1), 'the first increment is longer than the '// &
            'period; give a shorter one')
      else
         call report%error(field_place(data, 3), 'the smallest increment is longer than the '// &
            'first; give a shorter one')
      end if
   end subroutine check_times

   !> Notes the defaults of the card, and what of it does not act.
   subroutine note_increments(data, step, context)
      type(data_card_type), intent(in) :: data
      type(step_type), intent(in) :: step
      type(deck_context_type), intent(inout) :: context

      if (.not. has_field(data, 1)) call context%note('first increment not given: 1')
      if (.not. has_field(data, 2)) call context%note('period not given: 1')
      if (step%direct) then
         if (has_field(data, 3) .or. has_field(data, 4)) call context%note( &
            'smallest and largest increment ignored: with DIRECT increments are fixed')
         return
      end if
      if (.not. has_field(data, 3)) call context%note('smallest increment not given: '// &
         to_text(step%smallest_increment))
   end subroutine note_increments

end module deck_builder_increments
