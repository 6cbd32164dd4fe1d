!> How the run of a deck ended, and the short summary of it.
module deck_outcomes
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use errors, only: error_type, status_deck, status_internal, status_interrupted, &
      status_no_convergence, status_ok, status_verify
   use kinds, only: dp
   use messages, only: print_line
   use processes, only: file_report, reason_of, report_type, set_reason
   use records, only: increment_record_type
   use text, only: append, counted, string_type, to_text, with_decimals
   implicit none
   private
   public :: deck_outcome_type, end_of_run, counts_of_checks

   !> Files that a run has written by how far it came: none, listing, passes that failed, all
   !> without and with contact.
   character(*), parameter :: extensions(0:4) = [character(42) :: '', '.lst', '.lst, .cvg', &
      '.vtkhdf, .lst, .sta, .cvg', '.vtkhdf, .contact.vtkhdf, .lst, .sta, .cvg']

   !> How a deck ended.
   type :: deck_outcome_type
      character(:), allocatable :: path     !! deck as the command line names it
      integer :: status = status_ok         !! one of the status_* constants
      logical :: lacks_memory = .false.     !! whether it failed for want of memory
      integer :: increments = 0             !! increments that were accepted
      integer :: iterations = 0             !! passes of these and of the one that failed
      integer :: verify_passed = 0          !! *VERIFY checks that passed
      integer :: verify_failed = 0          !! *VERIFY checks that failed
      real(dp) :: known_to = 0.0_dp         !! conductance, relative, where rounding exceeds TOL
      integer :: files = 0                  !! how many files it has written: run_output's written
      logical :: keeps_round = .false.      !! whether files and increments are those of the last
      !! whole round of a requested accuracy, beside which another is solved
      real(dp) :: seconds = 0.0_dp          !! time it took [s]
      ! The rest is what a batch knows of the deck's process.
      logical :: is_running = .false.       !! whether it was started and has not ended
      logical :: has_run = .false.          !! whether it was started and has ended
      real(dp) :: cpu_seconds = 0.0_dp      !! its own and the system's [s]
      real(dp) :: peak_bytes = 0.0_dp       !! largest resident memory [byte]
      character(:), allocatable :: ending   !! its outcome in words where the status says too little
      !> Why it is not solved, or how well where that is less than TOL; one sentence, or nothing
      character(:), allocatable :: reason
      ! Of a deck that is solved in this process.
      type(string_type), allocatable :: summary(:)         !! what it comes to, lines
      type(string_type), allocatable :: failed_checks(:)   !! one line each
   contains
      procedure :: note
      procedure :: doubt
      procedure :: note_files
      procedure :: as_report
      procedure :: take
      procedure :: fail
      procedure :: words
      procedure :: is_earlier
      procedure :: print => print_outcome
      procedure :: print_failed_checks
   end type deck_outcome_type

contains

   !> Counts the passes of an increment, and what is written of it.
   subroutine note(self, record, accepted, files)
      class(deck_outcome_type), intent(inout) :: self     !! the run
      type(increment_record_type), intent(in) :: record
      integer, intent(in) :: accepted                     !! increments accepted so far
      integer, intent(in) :: files                        !! what run_output has written

      if (.not. self%keeps_round) self%increments = accepted
      if (allocated(record%iterations)) self%iterations = self%iterations + size(record%iterations)
      call self%note_files(files)
   end subroutine note

   !> Notes that rounding leaves the conductance of an increment less sure than TOL; the worst
   !> counts.
   pure subroutine doubt(self, floor)
      class(deck_outcome_type), intent(inout) :: self     !! the run
      real(dp), intent(in) :: floor                       !! what it is known to, relative

      if (floor <= self%known_to .or. self%status /= status_ok) return
      self%known_to = floor
      self%reason = 'the contact conductance is accurate to '//to_text(floor)//' only'
   end subroutine doubt

   !> Notes what is written; the process of a deck of a batch reports this and all else.
   subroutine note_files(self, files)
      class(deck_outcome_type), intent(inout) :: self     !! the run
      integer, intent(in) :: files                        !! what run_output has written

      if (.not. self%keeps_round) self%files = files
      call file_report(self%as_report())
   end subroutine note_files

   !> The outcome as a deck's process reports it.
   function as_report(self) result(report)
      class(deck_outcome_type), intent(in) :: self        !! the run
      type(report_type) :: report

      report%status = int(self%status, c_int)
      report%lacks_memory = merge(1_c_int, 0_c_int, self%lacks_memory)
      report%increments = int(self%increments, c_int)
      report%iterations = int(self%iterations, c_int)
      report%verify_passed = int(self%verify_passed, c_int)
      report%verify_failed = int(self%verify_failed, c_int)
      report%files = int(self%files, c_int)
      report%seconds = self%seconds
      if (allocated(self%reason)) call set_reason(report, self%reason)
   end function as_report

   !> Takes what a deck's process has reported so far.
   subroutine take(self, report)
      class(deck_outcome_type), intent(inout) :: self     !! the run
      type(report_type), intent(in) :: report

      self%status = int(report%status)
      self%lacks_memory = report%lacks_memory == 1
      self%increments = int(report%increments)
      self%iterations = int(report%iterations)
      self%verify_passed = int(report%verify_passed)
      self%verify_failed = int(report%verify_failed)
      self%files = int(report%files)
      self%reason = reason_of(report)
   end subroutine take

   !> Takes what went wrong; the first reason counts.
   pure subroutine fail(self, error)
      class(deck_outcome_type), intent(inout) :: self     !! the run
      type(error_type), intent(in) :: error               !! what went wrong

      if (self%status /= status_ok) return
      self%status = error%status
      self%reason = error%message
      self%lacks_memory = error%lacks_memory
   end subroutine fail

   !> The outcome in words, of at most 20 characters.
   pure function words(self) result(string)
      class(deck_outcome_type), intent(in) :: self   !! the run
      character(:), allocatable :: string            !! such as 'not converged'

      if (allocated(self%ending)) then
         string = self%ending
         return
      end if
      select case (self%status)
      case (status_ok)
         string = 'solved'
         if (self%increments == 0) string = 'skipped'
      case (status_deck)
         string = 'deck error'
      case (status_no_convergence)
         string = 'not converged'
      case (status_internal)
         string = 'internal/I-O error'
         if (self%lacks_memory) string = 'out of memory'
      case (status_verify)
         string = end_of_run(self%verify_failed, self%verify_failed == 0)
      case (status_interrupted)
         string = 'interrupted'
      case default
         string = 'status '//to_text(self%status)
      end select
   end function words

   !> Whether all that is known is of a result that was finished before: nothing was written, but it
   !> has increments.
   pure logical function is_earlier(self)
      class(deck_outcome_type), intent(in) :: self   !! the run

      is_earlier = self%increments > 0 .and. self%files == 0
   end function is_earlier

   !> How a run ended that was not cut short.
   pure function end_of_run(failed_checks, misses_target) result(words)
      integer, intent(in) :: failed_checks           !! *VERIFY checks
      logical, intent(in) :: misses_target           !! whether a requested accuracy is not reached
      character(:), allocatable :: words             !! such as 'solved'

      words = 'solved'
      if (misses_target) words = 'accuracy not reached'
      if (failed_checks > 0 .and. misses_target) words = 'check failed, '//words
      if (failed_checks > 0 .and. .not. misses_target) words = 'check failed'
   end function end_of_run

   !> How many *VERIFY checks passed.
   pure function counts_of_checks(passed, failed) result(words)
      integer, intent(in) :: passed, failed          !! checks
      character(:), allocatable :: words

      words = counted(passed, 'check')//' passed, '//to_text(failed)//' failed'
   end function counts_of_checks

   !> The short summary of one run.
   subroutine print_outcome(self, results)
      class(deck_outcome_type), intent(in) :: self    !! the run
      character(*), intent(in) :: results             !! path of its results without extension
      character(:), allocatable :: doubts
      type(string_type), allocatable :: lines(:)
      integer :: i

      doubts = ''
      if (self%words() == 'skipped' .or. self%is_earlier() .and. self%status == status_ok) return
      ! Where nothing was done the reason, which is printed already, says all.
      if (self%status == status_internal .and. self%increments == 0 .and. self%files == 0) return
      if (self%status == status_ok .and. allocated(self%reason)) then
         if (len(self%reason) > 0) doubts = '; '//self%reason
      end if
      call print_line(output_unit, self%path//': '//self%words()//', '// &
         counted(self%increments, 'increment')//' in '//with_decimals(self%seconds, 2)//' s'// &
         doubts)
      ! Where its results are, and how many checks passed.
      allocate (lines(0))
      if (allocated(self%summary)) lines = self%summary
      if (self%files > 0 .and. (self%keeps_round .or. self%status /= status_deck .and. &
         self%status /= status_internal)) call append(lines, 'results: '//results// &
         trim(extensions(self%files)))
      if (self%verify_passed + self%verify_failed > 0) call append(lines, &
         counts_of_checks(self%verify_passed, self%verify_failed))
      do i = 1, size(lines)
         call print_line(output_unit, '  '//lines(i)%value)
      end do
   end subroutine print_outcome

   !> Prints the checks that failed on stderr, one line each.
   subroutine print_failed_checks(self)
      class(deck_outcome_type), intent(in) :: self    !! the run
      integer :: i

      if (.not. allocated(self%failed_checks)) return
      do i = 1, size(self%failed_checks)
         call print_line(error_unit, self%failed_checks(i)%value)
      end do
   end subroutine print_failed_checks

end module deck_outcomes
