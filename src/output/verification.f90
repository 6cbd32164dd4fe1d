!> Judges the *VERIFY cards of a deck on the increments as they come.
module verification
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use contact_points, only: contact_points_type
   use contact_quantities, only: estimated
   use due_output, only: is_judged
   use kinds, only: dp
   use model, only: model_type, verify_type
   use quantity_types, only: find_quantity
   use records, only: increment_record_type
   use text, only: few_digits, percent, to_text, to_upper
   use verify_values, only: values_asked_for
   implicit none
   private
   public :: verifier_type, outcome_type, failure_words, bound_words

   !> What came of one check.
   type :: outcome_type
      logical :: judged = .false.               !! whether its time was reached
      logical :: passed = .false.               !! the verdict
      real(dp) :: time = 0.0_dp                 !! total time at which it was judged [time]
      real(dp) :: found = 0.0_dp                !! value found, the worst of a set
      real(dp) :: deviation = 0.0_dp            !! magnitude of its deviation, relative for REL
      !> Bound of the error of the value, NaN where it is uncertain; unallocated where it has none
      real(dp), allocatable :: bound
      character(:), allocatable :: reason       !! why there is no value; else empty
   end type outcome_type

   !> All checks of a deck, in its order.
   type :: verifier_type
      type(outcome_type), allocatable :: outcomes(:)   !! one for each of model%verifications
   contains
      procedure :: start
      procedure :: judge
      procedure :: passed_count
      procedure :: failed_count
      procedure :: unjudged_count
   end type verifier_type

contains

   !> Prepares the outcomes: a check that is never reached fails.
   subroutine start(self, model)
      class(verifier_type), intent(inout) :: self   !! the checks
      type(model_type), intent(in) :: model
      integer :: i

      allocate(self%outcomes(size(model%verifications)))
      do i = 1, size(self%outcomes)
         self%outcomes(i)%reason = 'the run ended before this time'
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
      integer :: i

      do i = 1, size(self%outcomes)
         if (.not. is_judged(model%verifications(i), record, model)) cycle
         call values_asked_for(model%verifications(i), record, model%mesh, interfaces, point_node, &
            values, reason)
         self%outcomes(i) = outcome_of(model%verifications(i), values, reason)
         self%outcomes(i)%time = record%time
         if (allocated(record%errors) .and. len(self%outcomes(i)%reason) == 0) call take_bound( &
            model%verifications(i), record, interfaces, self%outcomes(i))
      end do
   end subroutine judge

   !> Takes the bound of what a check is about: of a quantity of an interface, or of the largest
   !> pressure of the only one.
   subroutine take_bound(check, record, interfaces, outcome)
      type(verify_type), intent(in) :: check
      type(increment_record_type), intent(in) :: record
      type(contact_points_type), intent(in) :: interfaces(:)
      type(outcome_type), intent(inout) :: outcome
      integer :: i, q

      q = find_quantity(estimated, check%quantity)
      if (to_upper(check%quantity) == 'PRESSURE' .and. to_upper(check%where) == 'MAX' .and. &
         size(interfaces) == 1) q = find_quantity(estimated, 'peak_pressure')
      if (q == 0) return
      do i = 1, size(interfaces)
         if (to_upper(interfaces(i)%name) == to_upper(check%where) .or. size(interfaces) == 1) then
            outcome%bound = record%errors(i)%bound(q)
         end if
      end do
   end subroutine take_bound

   !> Number of checks that passed.
   pure function passed_count(self) result(number)
      class(verifier_type), intent(in) :: self   !! the checks
      integer :: number                          !! those that passed

      number = count(self%outcomes%passed)
   end function passed_count

   !> Number of checks that failed.
   pure function failed_count(self) result(number)
      class(verifier_type), intent(in) :: self   !! the checks
      integer :: number                          !! those that failed

      number = count(self%outcomes%judged .and. .not. self%outcomes%passed)
   end function failed_count

   !> Number of checks that could not be judged, because the run ended before their times.
   pure function unjudged_count(self) result(number)
      class(verifier_type), intent(in) :: self   !! the checks
      integer :: number                          !! those that were never reached

      number = count(.not. self%outcomes%judged)
   end function unjudged_count

   !> What is said of a check that failed, such as `deck.inp:36: check failed: heat_rate JOINT at
   !> time 1: 3.6, expected 3.7 (off by 2.7027 %, allowed 1 %)`.
   pure function failure_words(check, outcome) result(words)
      type(verify_type), intent(in) :: check
      type(outcome_type), intent(in) :: outcome
      character(:), allocatable :: words

      words = check%address//': check failed: '//trim(check%quantity//' '//check%where)// &
         ' at time '//to_text(outcome%time)//': '
      if (len(outcome%reason) > 0) then
         words = words//'expected '//to_text(check%value)//', but '//outcome%reason
      else if (check%relative .and. abs(check%value) > 0.0_dp) then
         words = words//to_text(outcome%found)//bound_words(outcome)//', expected '// &
            to_text(check%value)//' (off by '//percent(outcome%deviation, digits=6)// &
            ', allowed '//percent(check%tolerance, digits=6)//')'
      else
         words = words//to_text(outcome%found)//bound_words(outcome)//', expected '// &
            to_text(check%value)//' (off by '//to_text(outcome%deviation)//', allowed '// &
            to_text(merge(0.0_dp, check%tolerance, check%relative))//')'
      end if
   end function failure_words

   !> How far the value may be from the exact one; nothing where that is not bounded.
   pure function bound_words(outcome) result(words)
      type(outcome_type), intent(in) :: outcome
      character(:), allocatable :: words            !! with a blank before them

      words = ''
      if (.not. allocated(outcome%bound)) return
      words = ' (uncertain)'
      if (.not. ieee_is_nan(outcome%bound)) words = ' +- '//few_digits(outcome%bound)
   end function bound_words

   pure function outcome_of(check, values, reason) result(outcome)
      type(verify_type), intent(in) :: check
      real(dp), allocatable, intent(in) :: values(:)
      character(*), intent(in) :: reason
      type(outcome_type) :: outcome

      outcome%judged = .true.
      outcome%reason = reason
      if (.not. allocated(values)) return
      if (any(ieee_is_nan(values))) then
         outcome%reason = 'there is no value (NaN)'
         return
      end if
      outcome%found = values(maxloc(abs(values - check%value), dim=1))
      outcome%deviation = abs(outcome%found - check%value)
      outcome%passed = outcome%deviation <= check%tolerance
      if (.not. check%relative) return
      outcome%passed = outcome%deviation <= check%tolerance*abs(check%value)
      if (abs(check%value) > 0.0_dp) outcome%deviation = outcome%deviation/abs(check%value)
   end function outcome_of

end module verification
