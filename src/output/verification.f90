!> Judges the *VERIFY cards of a deck on the increments as they come.
module verification
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use contact_points, only: contact_points_type
   use due_output, only: is_judged
   use kinds, only: dp
   use model, only: model_type, verify_type
   use records, only: increment_record_type
   use text, only: percent, to_text
   use verify_values, only: values_asked_for
   implicit none
   private
   public :: verifier_type, outcome_type, failure_words

   !> What came of one check.
   type :: outcome_type
      logical :: judged = .false.               !! whether its time was reached
      logical :: passed = .false.               !! the verdict
      real(dp) :: time = 0.0_dp                 !! total time at which it was judged [time]
      real(dp) :: found = 0.0_dp                !! value found, the worst of a set
      real(dp) :: deviation = 0.0_dp            !! magnitude of its deviation, relative for REL
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
      end do
   end subroutine judge

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
         words = words//to_text(outcome%found)//', expected '//to_text(check%value)// &
            ' (off by '//percent(outcome%deviation, digits=6)//', allowed '// &
            percent(check%tolerance, digits=6)//')'
      else
         words = words//to_text(outcome%found)//', expected '//to_text(check%value)// &
            ' (off by '//to_text(outcome%deviation)//', allowed '// &
            to_text(merge(0.0_dp, check%tolerance, check%relative))//')'
      end if
   end function failure_words

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
