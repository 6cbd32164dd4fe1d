!> Judges the *VERIFY cards of a deck on the increments as they come. Values reach another one
!> between the increments by which they pass it, as if they changed linearly with the time.
module verification
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use checked_values, only: is_estimable, is_of_motions, values_asked_for, worst_node, worst_of
   use contact_points, only: contact_points_type
   use due_output, only: is_followed, is_judged
   use kinds, only: dp
   use materials, only: melts
   use model, only: model_type, unit_labels_type, verify_type
   use no_estimates, only: mark_of, no_finer_value, no_reason, of_points, reason_inside_step
   use quantity_types, only: find_quantity, quantity_type
   use records, only: increment_record_type
   use reported_quantities, only: verifiable
   use state_tables, only: reals, state_table_type, words
   use text, only: append, few_digits, or_blank, percent, share_words, string_type, to_text
   use unit_labels, only: unit_label
   implicit none
   private
   public :: verifier_type, outcome_type, failure_words, node_words, uncertainty_words

   !> Outcome of one check.
   type :: outcome_type
      logical :: judged = .false.               !! whether its time was reached
      logical :: passed = .false.               !! the verdict; no value expected: nothing to fail
      real(dp) :: time = 0.0_dp                 !! total time at which it was judged [time]
      real(dp) :: found = 0.0_dp                !! value found, the worst of a set
      real(dp) :: deviation = 0.0_dp            !! magnitude of its deviation, relative for REL
      integer :: node = 0                       !! where in a set the value is; 0 for none
      real(dp), allocatable :: uncertainty      !! of the value; unallocated for none
      integer :: no_estimate = no_reason        !! why it has none
      character(:), allocatable :: reason       !! why there is no value; else empty
   end type outcome_type

   !> Quantities whose values the model has before the first increment.
   character(*), parameter :: initially_known(3) = ['NT', 'U1', 'U2']

   !> The values of one card so far.
   type :: reached_level_type
      real(dp), allocatable :: level             !! unallocated for other cards
      !> (6, values) the time at which each reached it first and its uncertainty; its last value
      !> with its time, slope and increment; NaN where there is none, unallocated before the first
      real(dp), allocatable, private :: course(:, :)
   contains
      procedure :: follow
      procedure :: times
   end type reached_level_type

   !> All checks of a deck, in its order.
   type :: verifier_type
      type(outcome_type), allocatable :: outcomes(:)   !! one for each of model%verifications
      !> Likewise: when values were reached
      type(reached_level_type), allocatable, private :: levels(:)
   contains
      procedure :: start
      procedure :: judge
      procedure :: exchange
      procedure :: counts
      procedure :: add_asked
   end type verifier_type

contains

   !> Prepares the outcomes: a check that is never reached fails.
   subroutine start(self, model)
      class(verifier_type), intent(inout) :: self   !! the checks
      type(model_type), intent(in) :: model
      integer :: i

      allocate(self%outcomes(size(model%verifications)), self%levels(size(model%verifications)))
      do i = 1, size(self%outcomes)
         self%outcomes(i)%reason = 'the run ended before this time'
         if (allocated(model%verifications(i)%level)) self%levels(i)%level = &
            model%verifications(i)%level
      end do
   end subroutine start

   !> Judges the checks that name the time of an increment.
   subroutine judge(self, record, model, interfaces, point_node)
      class(verifier_type), intent(inout) :: self         !! the checks
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      integer, intent(in) :: point_node(:)                !! (points) node index of each point
      real(dp), allocatable :: values(:)
      character(:), allocatable :: reason
      real(dp) :: uncertainty
      integer :: i, no_estimate

      do i = 1, size(self%outcomes)
         no_estimate = reason_inside_step(model)
         uncertainty = ieee_value(1.0_dp, ieee_quiet_nan)
         if (allocated(record%check_uncertainties)) then
            no_estimate = record%check_uncertainties(i)%no_estimate
            uncertainty = record%check_uncertainties(i)%total
         end if
         if (is_followed(model%verifications(i), record, model)) call self%levels(i)%follow( &
            model%verifications(i), record, model, interfaces, point_node, uncertainty)
         if (.not. is_judged(model%verifications(i), record, model)) cycle
         if (allocated(model%verifications(i)%level)) then
            call self%levels(i)%times(values, uncertainty, reason)
            if (.not. ieee_is_nan(uncertainty)) no_estimate = no_reason
            if (ieee_is_nan(uncertainty) .and. no_estimate == no_reason) no_estimate = of_points
         else
            call values_asked_for(model%verifications(i), record, model, interfaces, point_node, &
               values, reason)
         end if
         self%outcomes(i) = outcome_of(model%verifications(i), values, reason)
         self%outcomes(i)%time = record%time
         if (len(self%outcomes(i)%reason) > 0) cycle
         if (.not. (self%outcomes(i)%passed .and. model%verifications(i)%expects)) self%outcomes( &
            i)%node = worst_node(model%verifications(i), model%mesh, point_node, values)
         if (.not. is_estimable(model%verifications(i))) cycle
         if (is_of_motions(model%verifications(i))) then
            no_estimate = no_finer_value
            uncertainty = ieee_value(1.0_dp, ieee_quiet_nan)
         end if
         self%outcomes(i)%no_estimate = no_estimate
         if (.not. ieee_is_nan(uncertainty)) self%outcomes(i)%uncertainty = uncertainty
      end do
   end subroutine judge

   !> The outcomes so far, in either direction; none where the table is of another deck's checks.
   subroutine exchange(self, table)
      class(verifier_type), intent(inout) :: self   !! started
      type(state_table_type), intent(inout) :: table
      character(:), allocatable :: reasons
      real(dp), allocatable :: values(:)
      real(dp) :: rows(8, size(self%outcomes))
      integer :: first, i

      call exchange_levels(self%levels, table)
      reasons = ''
      do i = 1, size(self%outcomes)
         associate (outcome => self%outcomes(i))
            rows(:, i) = [outcome%time, outcome%found, outcome%deviation, merge(1.0_dp, 0.0_dp, &
               [outcome%judged, outcome%passed, allocated(outcome%uncertainty)]), &
               real([outcome%no_estimate, outcome%node], dp)]
            if (allocated(outcome%uncertainty)) rows(7, i) = outcome%uncertainty
            if (outcome%judged) reasons = reasons//outcome%reason//new_line('a')
         end associate
      end do
      values = [rows]
      call reals(table, 'checks', values)
      call words(table, 'check_reasons', reasons)
      if (size(values) /= size(rows) .or. .not. table%restores) return
      rows = reshape(values, shape(rows))
      first = 1
      do i = 1, size(self%outcomes)
         associate (outcome => self%outcomes(i))
            outcome%judged = rows(4, i) > 0.0_dp
            if (.not. outcome%judged) cycle
            outcome%time = rows(1, i)
            outcome%found = rows(2, i)
            outcome%deviation = rows(3, i)
            outcome%passed = rows(5, i) > 0.0_dp
            if (rows(6, i) > 0.0_dp) outcome%uncertainty = rows(7, i)
            if (rows(6, i) <= 0.0_dp) outcome%no_estimate = nint(rows(7, i))
            outcome%node = nint(rows(8, i))
            outcome%reason = reasons(first:first - 2 + index(reasons(first:), new_line('a')))
            first = first + len(outcome%reason) + 1
         end associate
      end do
   end subroutine exchange

   !> Numbers of the checks that passed, that failed, and that could not be judged, because the run
   !> ended before their times. What only asks for a value does not pass.
   pure function counts(self, model)
      class(verifier_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer :: counts(3)

      associate (outcomes => self%outcomes)
         counts = [count(outcomes%passed .and. model%verifications%expects), &
            count(outcomes%judged .and. .not. outcomes%passed), count(.not. outcomes%judged)]
      end associate
   end function counts

   !> Adds a line for each value that is asked for and none expected, such as
   !> `NT reaches 70 TOP: 0.2 +- 0.01 (5 %) s`.
   subroutine add_asked(self, model, lines)
      class(verifier_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(string_type), allocatable, intent(inout) :: lines(:)
      character(:), allocatable :: words
      integer :: i

      do i = 1, size(self%outcomes)
         associate (check => model%verifications(i), outcome => self%outcomes(i))
            if (check%expects .or. .not. outcome%judged) cycle
            words = trim(check%title()//' '//check%where)
            if (.not. check%at_last) words = words//' at time '//to_text(check%when)
            if (outcome%reason == '') then
               words = words//node_words(outcome)//': '//to_text(outcome%found)// &
                  uncertainty_words(outcome)
               if (allocated(outcome%uncertainty)) words = trim(words//' '//share_words( &
                  outcome%uncertainty, outcome%found))
               call append(lines, words//unit_words(check, model%units))
            else
               call append(lines, words//': '//outcome%reason)
            end if
         end associate
      end do
   end subroutine add_asked

   !> The unit of the value of a check, with a blank before it; empty for none.
   pure function unit_words(check, labels) result(words)
      type(verify_type), intent(in) :: check
      type(unit_labels_type), intent(in) :: labels
      character(:), allocatable :: words
      type(quantity_type) :: quantity

      quantity = verifiable(find_quantity(verifiable, check%quantity))
      if (allocated(check%level)) quantity%unit = 'time'
      words = ''
      if (quantity%unit == 'time') then
         words = or_blank(labels%time)
      else if (quantity%unit /= '-' .and. quantity%unit /= 'load') then
         words = unit_label(quantity%unit, labels)
      end if
      if (words /= '') words = ' '//words
   end function unit_words

   !> The message on a check that failed, such as `deck.inp:36: check failed: NT MID, node 11 at
   !> time 1: 3.6, expected 3.7 (off by 2.7027 %, allowed 1 %)`.
   pure function failure_words(check, outcome) result(words)
      type(verify_type), intent(in) :: check
      type(outcome_type), intent(in) :: outcome
      character(:), allocatable :: words

      words = check%address//': check failed: '//trim(check%title()//' '//check%where)// &
         node_words(outcome)//' at time '//to_text(outcome%time)//': '
      if (len(outcome%reason) > 0) then
         words = words//'expected '//to_text(check%value)//', but '//outcome%reason
      else if (check%relative .and. abs(check%value) > 0.0_dp) then
         words = words//to_text(outcome%found)//uncertainty_words(outcome)//', expected '// &
            to_text(check%value)//' (off by '//percent(outcome%deviation, digits=6)// &
            ', allowed '//percent(check%tolerance, digits=6)//')'
      else
         words = words//to_text(outcome%found)//uncertainty_words(outcome)//', expected '// &
            to_text(check%value)//' (off by '//to_text(outcome%deviation)//', allowed '// &
            to_text(merge(0.0_dp, check%tolerance, check%relative))//')'
      end if
   end function failure_words

   !> Where in a set the value is that fails, or that is told of it; empty for no set.
   pure function node_words(outcome) result(words)
      type(outcome_type), intent(in) :: outcome
      character(:), allocatable :: words            !! such as ', node 11'

      words = ''
      if (outcome%node > 0) words = ', node '//to_text(outcome%node)
   end function node_words

   !> How far the value may be from the exact one, or why that is not known.
   pure function uncertainty_words(outcome) result(words)
      type(outcome_type), intent(in) :: outcome
      character(:), allocatable :: words            !! with a blank before them

      words = ''
      if (outcome%no_estimate /= no_reason) words = mark_of(outcome%no_estimate)
      if (allocated(outcome%uncertainty)) words = ' +- '//few_digits(outcome%uncertainty)
   end function uncertainty_words

   pure function outcome_of(check, values, reason) result(outcome)
      type(verify_type), intent(in) :: check
      real(dp), intent(in) :: values(:)
      character(*), intent(in) :: reason
      type(outcome_type) :: outcome

      outcome%judged = .true.
      outcome%passed = .not. check%expects
      outcome%reason = reason
      if (reason /= '') return
      outcome%found = worst_of(check, values)
      if (ieee_is_nan(outcome%found)) then
         outcome%reason = 'there is no value (NaN)'
         return
      end if
      if (.not. check%expects) return
      outcome%deviation = abs(outcome%found - check%value)
      outcome%passed = outcome%deviation <= check%tolerance
      if (.not. check%relative) return
      outcome%passed = outcome%deviation <= check%tolerance*abs(check%value)
      if (abs(check%value) > 0.0_dp) outcome%deviation = outcome%deviation/abs(check%value)
   end function outcome_of

   !> Takes the values of an increment; NaN is passed over.
   subroutine follow(self, check, record, model, interfaces, point_node, uncertainty)
      class(reached_level_type), intent(inout) :: self
      type(verify_type), intent(in) :: check
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      integer, intent(in) :: point_node(:)                   !! (points) node index of each point
      real(dp), intent(in) :: uncertainty                    !! of a single value, or NaN
      type(increment_record_type) :: start
      real(dp), allocatable :: kinks(:), values(:)
      character(:), allocatable :: reason
      integer :: m

      ! Where temperatures melt their course bends, by whatever it is there.
      allocate (kinks(0))
      if (check%quantity == 'NT') then
         do m = 1, size(model%materials)
            if (melts(model%materials(m))) kinks = [kinks, model%materials(m)%melting%solidus, &
               model%materials(m)%melting%liquidus]
         end do
      end if
      if (record%increment == 1 .and. any(initially_known == check%quantity)) then
         start%fields%temperature = model%initial_temperature
         allocate (start%fields%displacement(2, size(model%initial_temperature)), source=0.0_dp)
         call values_asked_for(check, start, model, interfaces, point_node, values, reason)
         if (reason == '') call take(self, values, 0.0_dp, 0.0_dp, kinks)
      end if
      call values_asked_for(check, record, model, interfaces, point_node, values, reason)
      if (reason == '') call take(self, values, record%time, uncertainty, kinks)
   end subroutine follow

   pure subroutine take(self, values, time, uncertainty, kinks)
      type(reached_level_type), intent(inout) :: self
      real(dp), intent(in) :: values(:), time, uncertainty
      real(dp), intent(in) :: kinks(:)   ! values at which a course may bend within an increment
      real(dp), parameter :: rounding = 1.0e-12_dp   ! part of the change in an increment
      real(dp) :: bend, slope
      logical :: lands
      integer :: i

      if (.not. allocated(self%course)) allocate (self%course(6, size(values)), &
         source=ieee_value(1.0_dp, ieee_quiet_nan))
      do i = 1, size(self%course, 2)
         if (ieee_is_nan(values(i))) cycle
         associate (reached => self%course(1, i), doubt => self%course(2, i), &
            before => self%course(3, i), then => self%course(4, i), &
            earlier_slope => self%course(5, i), increment => self%course(6, i))
            if (ieee_is_nan(before)) then
               if (abs(values(i) - self%level) <= 0.0_dp) reached = time
               earlier_slope = 0.0_dp
               increment = 0.0_dp
            else
               slope = (values(i) - before)/(time - then)
               ! As the gap of a point that closes at the end of the increment.
               lands = abs(values(i) - self%level) <= rounding*abs(values(i) - before)
               if (ieee_is_nan(reached) .and. ((before < self%level .neqv. &
                  values(i) < self%level) .or. lands)) then
                  reached = time
                  if (.not. lands) reached = then + (self%level - before)/(values(i) - before)* &
                     (time - then)
                  ! Between its increments the course is a parabola rather than a line.
                  bend = abs(slope - earlier_slope)/(time - then + increment)*(reached - then)* &
                     (time - reached)
                  ! A value that is cut off there, as a solid fraction, may have come to it before.
                  if (lands .or. any((before < kinks) .neqv. (values(i) < kinks))) bend = &
                     abs(slope)*(time - then)
                  doubt = (uncertainty + bend)/abs(slope)
               end if
               earlier_slope = slope
               increment = time - then
            end if
            before = values(i)
            then = time
         end associate
      end do
   end subroutine take

   !> When the values reached it.
   pure subroutine times(self, values, uncertainty, reason)
      class(reached_level_type), intent(in) :: self
      real(dp), allocatable, intent(out) :: values(:)        !! (values) [time]
      real(dp), intent(out) :: uncertainty                   !! of a single one, or NaN [time]
      character(:), allocatable, intent(out) :: reason       !! why there are none; else empty

      allocate (values(0))
      if (allocated(self%course)) values = self%course(1, :)
      uncertainty = ieee_value(1.0_dp, ieee_quiet_nan)
      if (size(values) == 1) uncertainty = self%course(2, 1)
      reason = ''
      associate (never => count(ieee_is_nan(values)))
         if (size(values) == 0 .or. never > 0) reason = 'never reached'
         if (never > 0 .and. never < size(values)) reason = reason//' by '//to_text(never)// &
            ' of the '//to_text(size(values))//' values; MIN or MAX asks for a single one'
      end associate
   end subroutine times

   !> The courses so far, in either direction; nothing where no card asks for one.
   subroutine exchange_levels(levels, table)
      type(reached_level_type), intent(inout) :: levels(:)
      type(state_table_type), intent(inout) :: table
      real(dp), allocatable :: values(:)
      integer :: first, i, n

      if (.not. any([(allocated(levels(i)%level), i=1, size(levels))])) return
      allocate (values(0))
      do i = 1, size(levels)
         if (.not. allocated(levels(i)%course)) cycle
         values = [values, real(i, dp), levels(i)%level, real(size(levels(i)%course, 2), dp), &
            levels(i)%course]
      end do
      call reals(table, 'reached', values)
      if (.not. table%restores) return
      first = 1
      do while (first < size(values))
         i = nint(values(first))
         n = nint(values(first + 2))
         if (i <= size(levels)) then
            if (allocated(levels(i)%level)) then
               ! The table may be that of another deck's checks.
               if (abs(levels(i)%level - values(first + 1)) <= 0.0_dp) levels(i)%course = &
                  reshape(values(first + 3:first + 2 + 6*n), [6, n])
            end if
         end if
         first = first + 3 + 6*n
      end do
   end subroutine exchange_levels

end module verification
