!> Where a run is in its steps, and how long its increments are: fixed, cut back where one fails
!> and grown again behind it.
module increment_control
   use due_output, only: met_within
   use kinds, only: dp
   use load_histories, only: step_clock_type
   use model, only: model_type
   use records, only: increment_record_type
   use state_tables, only: integers, reals, state_table_type
   use steps, only: adapts_increments, increment_growth, planned_increments, smallest_part, &
      step_type
   use text, only: counted, percent, to_text
   implicit none
   private
   public :: increment_control_type, next_end

   real(dp), parameter :: remainder = 1.0e-6_dp   !! part of an increment too small for one
   real(dp), parameter :: rounding = 1.0e-13_dp   !! of a time: what sums of times lose
   real(dp), parameter :: cut = 0.25_dp           !! part of a failed increment that is tried next
   real(dp), parameter :: growth = 2.0_dp         !! of increments after one that did not fail
   real(dp), parameter :: hardly_longer = 1.001_dp !! factor that makes no longer increment
   real(dp), parameter :: alike = 1.0e-9_dp        !! relative difference of sizes that is none
   real(dp), parameter :: allowance = 1.2_dp       !! of what a step allows its increments
   real(dp), parameter :: aim = 0.7_dp             !! part of it that they are made for
   real(dp), parameter :: slip_aim = 0.95_dp       !! part of the spacing that the next one may slip
   real(dp), parameter :: same = 0.1_dp            !! relative difference of errors that are alike
   integer, parameter :: many = 100                !! increments that a step has without INC=

   !> Position in the steps, and size of the next increment.
   type :: increment_control_type
      integer :: step = 0                     !! present step
      integer :: increments = 0               !! increments so far, over all steps
      integer :: increments_of_step = 0       !! increments of the present step so far
      integer :: cut_backs = 0                !! cut-backs of the next increment so far
      logical :: branch_ended = .false.       !! whether the branch of the step was followed
      real(dp) :: step_start = 0.0_dp         !! total time at the start of the step [time]
      real(dp) :: step_time = 0.0_dp          !! time since then [time]
      real(dp) :: largest = 0.0_dp            !! largest size of the next increment [time]
      real(dp) :: useful = 0.0_dp             !! size below which none is shortened [time]
      integer :: warned_of = 0                !! last step whose smallest increment erred
      real(dp) :: spacing = 0.0_dp            !! of instants of the step that differ [time]
      !> Of a longer attempt at this increment that erred too much: its size [time], error, and
      !> largest change of a temperature; 0 without one
      real(dp), private :: longer(3) = 0.0_dp
      !> Instants on which increments of the step land, from its start [time]
      real(dp), allocatable :: landings(:)
   contains
      procedure :: enter_step
      procedure :: step_is_over
      procedure :: next_instant
      procedure :: instant_at
      procedure :: exchange
      procedure :: size_to
      procedure :: goes_too_far
      procedure, private :: useful_size
      procedure :: shorten
      procedure :: planned
      procedure :: accept
      procedure :: can_cut_back
      procedure :: cut_back
      procedure :: why_not_again
      procedure :: explain_many
      procedure :: warn_of_smallest
   end type increment_control_type

contains

   !> Enters the next step.
   pure subroutine enter_step(self, model)
      class(increment_control_type), intent(inout) :: self   !! position in the steps
      type(model_type), intent(in) :: model

      if (self%step > 0) self%step_start = self%step_start + model%steps(self%step)%period
      self%step = self%step + 1
      self%step_time = 0.0_dp
      self%increments_of_step = 0
      self%branch_ended = .false.
      self%cut_backs = 0
      self%useful = 0.0_dp
      self%largest = model%steps(self%step)%first_increment
      self%spacing = rounding*(self%step_start + model%steps(self%step)%period)
      self%landings = landing_times(model, model%steps(self%step), self%step_start)
   end subroutine enter_step

   !> Corners of amplitudes, and instants of output that neither they nor the ends of the step meet:
   !> times of *VERIFY cards and of *TIME POINTS. With DIRECT increments land on none of them.
   pure function landing_times(model, step, step_start) result(times)
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      real(dp), intent(in) :: step_start
      real(dp), allocatable :: times(:), output(:)
      integer :: i

      times = [0.0_dp, step%period]
      if (step%direct) return
      times = [times, (model%amplitudes(i)%times - merge(step_start, 0.0_dp, &
         model%amplitudes(i)%total_time), i=1, size(model%amplitudes))]
      output = pack(model%verifications%when, .not. model%verifications%at_last) - step_start
      call add_output(times, output, met_within(output + step_start, step%first_increment), step)
      output = [step%field_points%in_step(step_start), &
         step%contact_print_points%in_step(step_start)]
      if (allocated(step%node_prints)) output = [output, &
         (step%node_prints(i)%points%in_step(step_start), i=1, size(step%node_prints))]
      if (allocated(step%element_prints)) output = [output, &
         (step%element_prints(i)%points%in_step(step_start), i=1, size(step%element_prints))]
      call add_output(times, output, met_within(output + step_start, &
         min(step%first_increment, step%smallest_increment)), step)
   end function landing_times

   !> Adds the instants of output that are within the step and that none of the others meets.
   pure subroutine add_output(times, output, tolerance, step)
      real(dp), allocatable, intent(inout) :: times(:)   ! from the start of the step [time]
      real(dp), intent(in) :: output(:), tolerance(:)    ! [time]
      type(step_type), intent(in) :: step
      integer :: k

      do k = 1, size(output)
         if (output(k) < 0.0_dp .or. output(k) > step%period) cycle
         if (all(abs(times - output(k)) > tolerance(k))) times = [times, output(k)]
      end do
   end subroutine add_output

   !> Whether the present step is solved to its end.
   pure logical function step_is_over(self, model)
      class(increment_control_type), intent(in) :: self   !! position in the steps
      type(model_type), intent(in) :: model

      step_is_over = self%step_time >= model%steps(self%step)%period
      if (model%steps(self%step)%continuation%is_on) step_is_over = self%branch_ended
   end function step_is_over

   !> The end of the next increment.
   pure function next_instant(self, model) result(clock)
      class(increment_control_type), intent(in) :: self   !! position in the steps
      type(model_type), intent(in) :: model
      type(step_clock_type) :: clock                      !! the instant

      associate (step => model%steps(self%step))
         clock = self%instant_at(model, next_end(self%step_time, self%largest, &
            merge(step%period, step%first_increment, step%grows .or. adapts_increments(step)), &
            step%period, self%landings, self%spacing))
      end associate
   end function next_instant

   !> The instant at a time of the present step.
   pure function instant_at(self, model, step_time) result(clock)
      class(increment_control_type), intent(in) :: self   !! position in the steps
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: step_time                   !! from the start of the step [time]
      type(step_clock_type) :: clock

      clock = step_clock_type(step_time, model%steps(self%step)%period, &
         self%step_start + step_time, model%steps(self%step)%ramped)
   end function instant_at

   !> Size of an increment that ends at an instant: what differs from the size that is set by the
   !> rounding of times alone is that size, so that its factors serve again.
   pure real(dp) function size_to(self, clock)
      class(increment_control_type), intent(in) :: self   !! position in the steps
      type(step_clock_type), intent(in) :: clock          !! its end

      size_to = clock%step_time - self%step_time
      if (abs(size_to - self%largest) <= alike*self%largest) size_to = self%largest
   end function size_to

   !> The position within the present step, in either direction.
   subroutine exchange(self, table)
      class(increment_control_type), intent(inout) :: self   !! in the step of the table
      type(state_table_type), intent(inout) :: table
      integer, allocatable :: counts(:)
      real(dp), allocatable :: times(:)

      counts = [self%increments, self%increments_of_step]
      times = [self%step_time, self%largest, self%useful]
      call integers(table, 'increments', counts)
      call reals(table, 'times', times)
      self%increments = counts(1)
      self%increments_of_step = counts(2)
      self%step_time = times(1)
      self%largest = times(2)
      self%useful = times(3)
   end subroutine exchange

   !> Whether an increment of a transient errs or changes temperatures by more than the step allows,
   !> and may be shorter. Beside temperatures that jump as a step begins none is shorter than heat
   !> takes to cross an element, until one errs by no more than the step allows.
   !>
   !> Nor where an increment errs by the same part of the range of temperatures as a longer attempt,
   !> however short: bodies leave one temperature, and heat that grows from nothing changes it by a
   !> power of time, which makes the range, too. What it errs is none beside later ranges, since
   !> changes fall at least as fast as the size.
   pure logical function goes_too_far(self, model, increment_size, record)
      class(increment_control_type), intent(in) :: self   !! position in the steps
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: increment_size              !! of it [time]
      type(increment_record_type), intent(in) :: record   !! of it

      goes_too_far = .false.
      if (.not. adapts_increments(model%steps(self%step))) return
      associate (size_before => self%longer(1), error => self%longer(2), change => self%longer(3))
         if (record%makes_range .and. size_before > 0.0_dp .and. abs(record%local_error - error) &
            <= same*error .and. record%largest_change*size_before <= (1.0_dp + same)*change* &
            increment_size) return
      end associate
      goes_too_far = excess(model%steps(self%step), record) > allowance .and. &
         self%can_cut_back(model, increment_size) .and. &
         0.5_dp*increment_size > hardly_longer*self%useful_size(model%steps(self%step), record)
   end function goes_too_far

   !> Size below which an increment is not shortened for what it errs.
   pure real(dp) function useful_size(self, step, record)
      class(increment_control_type), intent(in) :: self   !! position in the steps
      type(step_type), intent(in) :: step
      type(increment_record_type), intent(in) :: record   !! of the increment

      useful_size = max(self%useful, record%useful_increment)
      if ((record%largest_change/step%largest_change)**2 > allowance) useful_size = 0.0_dp
   end function useful_size

   !> What an increment takes of what its step allows: 1 is all of it.
   pure real(dp) function excess(step, record)
      type(step_type), intent(in) :: step
      type(increment_record_type), intent(in) :: record

      excess = max(record%local_error/step%local_error, strain_excess(step, record), &
         (record%largest_change/step%largest_change)**2)
   end function excess

   !> The same of its inelastic strains.
   pure real(dp) function strain_excess(step, record)
      type(step_type), intent(in) :: step
      type(increment_record_type), intent(in) :: record

      strain_excess = max(record%strain_error/step%local_error, record%creep_difference/ &
         step%creep_tolerance)
   end function strain_excess

   !> Makes the next attempt shorter than one that went too far, and says why. Sizes are halves of
   !> halves of the first one, so that few are different.
   function shorten(self, model, increment_size, record) result(words)
      class(increment_control_type), intent(inout) :: self   !! position in the steps
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: increment_size                 !! of the attempt [time]
      type(increment_record_type), intent(in) :: record      !! of it
      character(:), allocatable :: words                     !! part of a sentence

      associate (step => model%steps(self%step))
         words = words_of_excess(step, record)
         call halve(self, step, increment_size*sqrt(aim/excess(step, record)), &
            self%useful_size(step, record))
      end associate
      self%longer = [increment_size, record%local_error, record%largest_change]
      self%cut_backs = self%cut_backs + 1
   end function shorten

   !> What an increment errs or changes by, more than its step allows.
   function words_of_excess(step, record) result(words)
      type(step_type), intent(in) :: step
      type(increment_record_type), intent(in) :: record
      character(:), allocatable :: words                     ! part of a sentence

      words = 'its temperatures err by '//percent(record%local_error)//' of their range'
      if (record%strain_error > allowance*step%local_error) then
         words = 'its inelastic strains err by '//percent(record%strain_error)// &
            ' of the elastic ones'
      else if (record%creep_difference/step%creep_tolerance > allowance) then
         words = 'its creep strains differ by '//to_text(record%creep_difference)// &
            ', more than CETOL='//to_text(step%creep_tolerance)
      else if (record%local_error <= allowance*step%local_error) then
         words = 'a temperature changes by '//to_text(record%largest_change)// &
            ', more than DELTMX='//to_text(step%largest_change)
      end if
   end function words_of_excess

   !> Warns of the first increment of a step that is kept as the smallest, whatever its strains err:
   !> they stay, where temperatures forget.
   subroutine warn_of_smallest(self, model, increment_size, record)
      class(increment_control_type), intent(inout) :: self   !! before it accepts the increment
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: increment_size                 !! of it [time]
      type(increment_record_type), intent(inout) :: record   !! of it

      associate (step => model%steps(self%step))
         if (self%warned_of == self%step .or. .not. adapts_increments(step)) return
         if (strain_excess(step, record) <= allowance .or. self%can_cut_back(model, &
            increment_size)) return
         self%warned_of = self%step
         call record%warn('the increment is the smallest of its step and is kept, though '// &
            words_of_excess(step, record)//'; give a smallest increment, the third value of '// &
            'the step''s times, below '//to_text(step%smallest_increment))
      end associate
   end subroutine warn_of_smallest

   !> Halves the size until it is at most the one wanted, but makes it no smaller than the smallest,
   !> nor than what is useful.
   pure subroutine halve(self, step, wanted, useful)
      type(increment_control_type), intent(inout) :: self
      type(step_type), intent(in) :: step
      real(dp), intent(in) :: wanted, useful                 !! [time]

      do while (self%largest > max(wanted, step%smallest_increment) .and. &
         0.5_dp*self%largest >= useful)
         self%largest = 0.5_dp*self%largest
      end do
      self%largest = max(self%largest, step%smallest_increment)
   end subroutine halve

   !> How many increments the whole run takes where no further one is cut back or ends before its
   !> time on an instant of the deck.
   pure integer function planned(self, model)
      class(increment_control_type), intent(in) :: self   !! position in the steps
      type(model_type), intent(in) :: model
      real(dp), parameter :: rounding = 1.0e-6_dp
      real(dp) :: left(size(model%steps))

      left = planned_increments(model%steps)
      left(:self%step - 1) = 0.0_dp
      if (self%step > 0) then
         associate (step => model%steps(self%step), of_step => left(self%step))
            if (step%grows) of_step = merge(0.0_dp, max(of_step - self%increments_of_step, &
               1.0_dp), self%step_time >= step%period)
            if (.not. step%grows) of_step = (step%period - self%step_time)/step%first_increment
         end associate
      end if
      planned = self%increments + sum(ceiling(min(left - rounding, 1.0e6_dp)))
   end function planned

   !> Goes on behind an increment that converged.
   pure subroutine accept(self, model, clock, record)
      class(increment_control_type), intent(inout) :: self   !! position in the steps
      type(model_type), intent(in) :: model
      type(step_clock_type), intent(in) :: clock             !! its end
      type(increment_record_type), optional, intent(in) :: record   !! of it, where it was solved
      real(dp) :: increment_size, size_before

      increment_size = clock%step_time - self%step_time
      size_before = self%largest
      self%step_time = clock%step_time
      self%increments = self%increments + 1
      self%increments_of_step = self%increments_of_step + 1
      associate (step => model%steps(self%step))
         if (adapts_increments(step)) then
            self%longer = 0.0_dp
            if (.not. present(record)) return
            self%useful = max(self%useful, record%useful_increment)
            if (excess(step, record) <= allowance) self%useful = 0.0_dp
            if (2.0_dp*self%largest <= step%largest_increment .and. excess(step, record)* &
               (2.0_dp*self%largest/increment_size)**2 <= aim) self%largest = 2.0_dp*self%largest
         else if (self%cut_backs == 0 .and. step%grows) then
            self%largest = min(increment_growth*self%largest, step%largest_increment)
         else if (self%cut_backs == 0) then
            self%largest = min(growth*self%largest, step%first_increment)
         end if
      end associate
      self%cut_backs = 0
      ! The next one slips as fast as this one. Sizes that are halves of each other stay so.
      if (.not. (present(record) .and. size_before < self%largest)) return
      if (record%slip_part*self%largest <= increment_size) return
      self%largest = max(size_before, merge(0.0_dp, slip_aim*increment_size/record%slip_part, &
         adapts_increments(model%steps(self%step))))
   end subroutine accept

   !> Whether an increment that failed may be tried again with a smaller size, if it is not the
   !> smallest already.
   pure logical function can_cut_back(self, model, failed)
      class(increment_control_type), intent(in) :: self   !! position in the steps
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: failed                      !! size that failed [time]

      associate (step => model%steps(self%step))
         can_cut_back = .not. step%direct .and. failed > hardly_longer*step%smallest_increment
      end associate
   end function can_cut_back

   !> Makes the next attempt shorter than one that failed.
   pure subroutine cut_back(self, model, failed)
      class(increment_control_type), intent(inout) :: self   !! position in the steps
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: failed                         !! size that failed [time]

      self%cut_backs = self%cut_backs + 1
      associate (step => model%steps(self%step))
         if (adapts_increments(step)) then
            call halve(self, step, cut*failed, 0.0_dp)
         else
            self%largest = max(cut*failed, step%smallest_increment)
         end if
      end associate
   end subroutine cut_back

   !> Says where the run ends, and why the increment is not tried again.
   pure function why_not_again(self, model, failed) result(words)
      class(increment_control_type), intent(in) :: self   !! position in the steps
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: failed                      !! size that failed [time]
      character(:), allocatable :: words                  !! part of a sentence

      words = 'step '//to_text(self%step)//', increment size '//to_text(failed)
      if (model%steps(self%step)%direct) then
         words = words//', which DIRECT does not allow to be cut back: leave DIRECT out'
      else
         words = words//', the smallest that the step allows'
         if (self%cut_backs > 0) words = words//', after '//counted(self%cut_backs, 'cut-back')
         if (model%steps(self%step)%smallest_increment > smallest_part*model%steps(self%step)% &
            period) words = words//'; give a shorter smallest increment, the third value of '// &
            'the step''s times'
      end if
   end function why_not_again

   !> Says which error keeps the increments of a step short where these are more than INC= allows by
   !> default.
   pure subroutine explain_many(self, model, clock, record)
      class(increment_control_type), intent(in) :: self      !! before it accepts the increment
      type(model_type), intent(in) :: model
      type(step_clock_type), intent(in) :: clock             !! its end
      type(increment_record_type), intent(inout) :: record   !! of it
      character(:), allocatable :: words

      associate (step => model%steps(self%step), taken => excess(model%steps(self%step), record))
         if (self%increments_of_step < many .or. .not. adapts_increments(step)) return
         if (taken*(2.0_dp*self%largest/self%size_to(clock))**2 <= aim) return
         words = 'LOCAL ERROR='//to_text(step%local_error)
         if (taken <= record%creep_difference/step%creep_tolerance) words = 'CETOL='// &
            to_text(step%creep_tolerance)
         if (taken <= (record%largest_change/step%largest_change)**2) words = 'DELTMX='// &
            to_text(step%largest_change)
         record%many_increments = to_text(self%increments_of_step + 1)//' increments in step '// &
            to_text(self%step)//', kept short by '//words
      end associate
   end subroutine explain_many

   !> The end of the next increment: the next multiple of the first increment, reckoned and not
   !> added up, or an earlier instant on which the step must land; short of these where increments
   !> were cut back. A remainder too small for an increment goes to the one before it, unless that
   !> would go over an instant on which the step must land.
   pure function next_end(step_time, size_allowed, first, period, landings, spacing) result(ending)
      real(dp), intent(in) :: step_time      !! end of the last increment [time]
      real(dp), intent(in) :: size_allowed   !! largest size of the next one [time]
      real(dp), intent(in) :: first          !! first increment [time]
      real(dp), intent(in) :: period         !! length of the step [time]
      real(dp), intent(in) :: landings(:)    !! (n) instants on which it must land [time]
      real(dp), intent(in) :: spacing        !! least distance of two instants that differ [time]
      real(dp) :: ending                     !! all from the start of the step [time]
      real(dp) :: target
      integer :: i

      associate (tolerance => max(remainder*size_allowed, spacing))
         target = (floor((step_time + tolerance)/first) + 1)*first
         if (target > period - tolerance) target = period
         do i = 1, size(landings)
            if (landings(i) > step_time + spacing .and. landings(i) < target) target = landings(i)
         end do
         ending = step_time + size_allowed
         if (target <= ending + tolerance) ending = target
      end associate
   end function next_end

end module increment_control
