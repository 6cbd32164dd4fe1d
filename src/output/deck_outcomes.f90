!> How the run of a deck ended, and the short summary of it.
module deck_outcomes
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use errors, only: error_type, status_deck, status_internal, status_interrupted, &
      status_no_convergence, status_ok, status_verify
   use json, only: json_type
   use kinds, only: dp
   use messages, only: message_type, print_line
   use processes, only: file_report, reason_of, report_type, set_reason
   use records, only: increment_record_type
   use result_rows, only: result_row_type
   use text, only: append, counted, string_type, to_text, with_decimals
   use version, only: program_version
   implicit none
   private
   public :: deck_outcome_type, end_of_run, counts_of_checks, print_document

   !> Files that a run has written by how far it came: none, listing, passes that failed, all
   !> without and with contact.
   character(*), parameter :: extensions(0:4) = [character(42) :: '', '.lst', '.lst, .cvg', &
      '.vtkhdf, .lst, .sta, .cvg', '.vtkhdf, .contact.vtkhdf, .lst, .sta, .cvg']

   !> How a deck ended.
   type :: deck_outcome_type
      character(:), allocatable :: path     !! deck as the command line names it
      !> What a deck's process reports. Its reason: why the deck is not solved, or how well where
      !> that is less than TOL; one sentence, or nothing. Its files: run_output's written
      type(report_type) :: report
      real(dp) :: known_to = 0.0_dp         !! conductance, relative, where rounding exceeds TOL
      logical :: keeps_round = .false.      !! whether files and increments are those of the last
      !! whole round of a requested accuracy, beside which another is solved
      ! The rest is what a batch knows of the deck's process.
      logical :: is_running = .false.       !! whether it was started and has not ended
      logical :: has_run = .false.          !! whether it was started and has ended
      real(dp) :: cpu_seconds = 0.0_dp      !! its own and the system's [s]
      real(dp) :: peak_bytes = 0.0_dp       !! largest resident memory [byte]
      character(:), allocatable :: ending   !! its outcome in words where the status says too little
      ! Of a deck that is solved in this process.
      type(string_type), allocatable :: summary(:)         !! what it comes to, lines
      type(string_type), allocatable :: failed_checks(:)   !! one line each
      ! For --json and --table.
      type(message_type), allocatable :: messages(:)
      type(json_type) :: results                           !! at the last increment
      type(result_row_type) :: row                         !! the same for a table of runs
   contains
      procedure :: note
      procedure :: note_files
      procedure :: fail
      procedure :: words
      procedure :: is_earlier
      procedure :: print => print_outcome
      procedure :: print_failed_checks
      procedure :: print_document => print_json
   end type deck_outcome_type

contains

   !> Counts the passes of an increment, and what is written of it.
   subroutine note(self, record, accepted, files)
      class(deck_outcome_type), intent(inout) :: self     !! the run
      type(increment_record_type), intent(in) :: record
      integer, intent(in) :: accepted                     !! increments accepted so far
      integer, intent(in) :: files                        !! what run_output has written

      if (.not. self%keeps_round) self%report%increments = accepted
      if (allocated(record%iterations)) self%report%iterations = self%report%iterations + &
         size(record%iterations)
      call self%note_files(files)
   end subroutine note

   !> Notes what is written; the process of a deck of a batch reports this and all else.
   subroutine note_files(self, files)
      class(deck_outcome_type), intent(inout) :: self     !! the run
      integer, intent(in) :: files                        !! what run_output has written

      if (.not. self%keeps_round) self%report%files = files
      call file_report(self%report)
   end subroutine note_files

   !> Takes what went wrong; the first reason counts.
   pure subroutine fail(self, error)
      class(deck_outcome_type), intent(inout) :: self     !! the run
      type(error_type), intent(in) :: error               !! what went wrong

      if (self%report%status /= status_ok) return
      self%report%status = error%status
      self%report%lacks_memory = merge(1_c_int, 0_c_int, error%lacks_memory)
      call set_reason(self%report, error%message)
   end subroutine fail

   !> The outcome in words, of at most 20 characters.
   pure function words(self) result(string)
      class(deck_outcome_type), intent(in) :: self   !! the run
      character(:), allocatable :: string            !! such as 'not converged'

      if (allocated(self%ending)) then
         string = self%ending
         return
      end if
      select case (self%report%status)
      case (status_ok)
         string = 'solved'
         if (self%report%increments == 0) string = 'skipped'
      case (status_deck)
         string = 'deck error'
      case (status_no_convergence)
         string = 'not converged'
      case (status_internal)
         string = 'internal/I-O error'
         if (self%report%lacks_memory == 1) string = 'out of memory'
      case (status_verify)
         string = end_of_run(self%report%verify_failed, self%report%verify_failed == 0)
      case (status_interrupted)
         string = 'interrupted'
      case default
         string = 'status '//to_text(self%report%status)
      end select
   end function words

   !> Whether all that is known is of a result that was finished before: nothing was written, but it
   !> has increments.
   pure logical function is_earlier(self)
      class(deck_outcome_type), intent(in) :: self   !! the run

      is_earlier = self%report%increments > 0 .and. self%report%files == 0
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

      associate (report => self%report)
         if (self%words() == 'skipped') return
         if (self%is_earlier() .and. report%status == status_ok) return
         ! Where nothing was done the reason, which is printed already, says all.
         if (report%status == status_internal .and. report%increments + report%files == 0) return
         doubts = ''
         if (report%status == status_ok .and. reason_of(report) /= '') doubts = '; '// &
            reason_of(report)
         call print_line(output_unit, self%path//': '//self%words()//', '//counted( &
            report%increments, 'increment')//' in '//with_decimals(report%seconds, 2)//' s'//doubts)
         ! Where its results are, and how many checks passed.
         allocate (lines(0))
         if (allocated(self%summary)) lines = self%summary
         if (report%files > 0 .and. (self%keeps_round .or. report%status /= status_deck .and. &
            report%status /= status_internal)) call append(lines, 'results: '//results// &
            trim(extensions(report%files)))
         if (report%verify_passed + report%verify_failed > 0) call append(lines, &
            counts_of_checks(report%verify_passed, report%verify_failed))
      end associate
      do i = 1, size(lines)
         call print_line(output_unit, '  '//lines(i)%value)
      end do
   end subroutine print_outcome

   !> Prints how the run ended, and its results, as one document in JSON.
   subroutine print_json(self, results)
      class(deck_outcome_type), intent(in) :: self    !! the run
      character(*), intent(in) :: results             !! path of its results without extension
      type(json_type) :: members
      character(:), allocatable :: list
      integer :: comma

      associate (report => self%report)
         call members%put(self%words(), 'outcome')
         call members%put(reason_of(report), 'reason')
         call members%put(int(report%increments), 'increments')
         call members%put(int(report%iterations), 'iterations')
         call members%put(report%seconds, 'seconds')
         call members%put(int(report%verify_passed), 'checks_passed')
         call members%put(int(report%verify_failed), 'checks_failed')
         call members%open('[', 'files')
         list = trim(extensions(report%files))
         do while (len(list) > 0)
            comma = index(list//',', ',')
            call members%put(results//list(:comma - 1))
            list = list(comma + 2:)
         end do
         call members%close(']')
         call members%put_members(self%results)
         call print_document('run', self%path, int(report%status), self%messages, members)
      end associate
   end subroutine print_json

   !> Prints the document that `--json` prints of a deck on stdout.
   subroutine print_document(command, deck, status, messages, members)
      character(*), intent(in) :: command                 !! run or check
      character(*), intent(in) :: deck                    !! as given
      integer, intent(in) :: status                       !! exit status
      type(message_type), allocatable, intent(in) :: messages(:)   !! unallocated for none
      type(json_type), intent(in) :: members              !! what else it has
      type(json_type) :: document
      integer :: i

      call document%open('{')
      call document%put('thercon', 'program')
      call document%put(program_version, 'version')
      call document%put(command, 'command')
      call document%put(deck, 'deck')
      call document%put(status, 'status')
      call document%open('[', 'messages')
      if (allocated(messages)) then
         do i = 1, size(messages)
            associate (message => messages(i))
               call document%open('{')
               call document%put(message%severity, 'severity')
               call document%put(message%file, 'file')
               if (message%line > 0) then
                  call document%put(message%line, 'line')
                  call document%put(message%column, 'column')
               end if
               call document%put(message%words, 'message')
               call document%close('}')
            end associate
         end do
      end if
      call document%close(']')
      call document%put_members(members)
      call document%close('}')
      call print_line(output_unit, document%text)
   end subroutine print_document

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
