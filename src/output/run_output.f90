!> All that a run writes, in one object: result file, `.sta`, `.cvg`, listing, verdicts, progress
!> line.
!>
!> A later round of a requested accuracy is a draft: it takes the place of the round before once it
!> is whole. Until then nothing of it is in the files.
module run_output
   use, intrinsic :: iso_fortran_env, only: error_unit
   use accuracy_lines, only: told_of_rounds
   use accuracy_rounds, only: accuracy_rounds_type
   use contact_points, only: contact_points_type
   use errors, only: error_type
   use json, only: json_type
   use kinds, only: dp
   use messages, only: print_line
   use listing, only: listing_type
   use model, only: model_type
   use progress, only: progress_type
   use records, only: increment_record_type
   use requested_tables, only: due_tables, requested_table_type
   use result_rows, only: result_row_type
   use results, only: results_type
   use run_judgement, only: run_judgement_type
   use run_documents, only: put_checks, put_summary
   use run_summaries, only: put_run, run_summary_type
   use clock, only: wall_seconds
   use state_tables, only: state_table_type
   use text, only: append, counted, or_blank, string_type, to_text
   use verification, only: failure_words, verifier_type
   implicit none
   private
   public :: run_output_type

   !> The output of one run.
   type :: run_output_type
      private
      !> The caller keeps it up to date; of a later round it holds the checks of the first
      type(run_summary_type), public :: run
      type(results_type), public :: results                    !! result file, `.sta`, `.cvg`
      type(listing_type), public :: listing                    !! `.lst`
      type(verifier_type), public :: verifier                          !! *VERIFY cards
      type(progress_type), public :: progress                  !! progress line
      type(run_judgement_type), public :: judgement                    !! what the whole run shows
      integer, public :: kept_round = 0                        !! round in the files; 0 for none
      integer, allocatable :: point_node(:)                    !! (points) node index of each point
      logical :: is_finished = .false.                         !! whether it came to its end
   contains
      procedure :: reserve
      procedure :: start
      procedure :: accept
      procedure :: fail
      procedure :: finish
      procedure :: break_off
      procedure :: written
      procedure :: failed_checks
      procedure :: summary_lines
      procedure :: report
   end type run_output_type

contains

   !> Tries whether all files of a run can be written, before anything is solved, and locks them
   !> against other runs of the same name. They are left as they are; close the listing in any case.
   !> Error: status_internal, when one cannot be written, or another run writes them.
   subroutine reserve(self, path, lock, error)
      class(run_output_type), intent(inout) :: self
      character(*), intent(in) :: path                    !! path of the results without extension
      integer, intent(inout) :: lock                      !! as listing_type's reserve
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      logical :: has_lock

      call self%listing%reserve(path//'.lst', lock, has_lock, error)
      if (allocated(error)) return
      if (.not. has_lock) call print_warnings(self, [string_type('the file system of "'//path// &
         '.lst" has no locks: a second run of this name at the same time would not be noticed')])
      call self%results%reserve(path, self%kept_round > 0, has_lock .and. self%kept_round == 0, &
         error)
   end subroutine reserve

   !> Begins the output of a run, whose files are reserved: writes the head of the listing and
   !> touches no other file yet. `run` is filled in before, but for its times and verdicts.
   !> Error: status_internal, when the listing cannot be written or HDF5 does not start.
   subroutine start(self, model, interfaces, point_node, element_points, cards, error)
      class(run_output_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      integer, intent(in) :: point_node(:)                !! (points) node index of each point
      integer, intent(in) :: element_points(:, :)         !! (8, elements) points of each element
      type(string_type), intent(in) :: cards(:)           !! card images as read
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      real(dp) :: since

      since = wall_seconds()
      self%point_node = point_node
      call self%verifier%start(model)
      call self%listing%open(self%kept_round > 0, model, interfaces, self%run, error)
      if (allocated(error)) return
      call self%results%open(model, interfaces, point_node, element_points, cards, error)
      self%run%seconds_write = self%run%seconds_write + (wall_seconds() - since)
   end subroutine start

   !> Takes an accepted increment.
   !> Error: status_internal, when a file cannot be written.
   subroutine accept(self, record, model, interfaces, error)
      class(run_output_type), intent(inout) :: self
      type(increment_record_type), intent(inout) :: record   !! whose restart is taken from it
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      type(requested_table_type), allocatable :: tables(:)
      type(state_table_type), allocatable :: restart
      real(dp) :: since

      since = wall_seconds()
      call due_tables(record, model, tables)
      call self%listing%add(record, model, interfaces, tables, error)
      call self%verifier%judge(record, model, interfaces, self%point_node)
      call self%judgement%take(record, model, interfaces)
      call self%progress%take(record)
      if (allocated(record%restart)) then
         call move_alloc(record%restart, restart)
         call self%verifier%exchange(restart)
         call self%judgement%exchange(restart)
      end if
      if (.not. allocated(error)) then
         call self%results%histories%append(record, tables)
         call self%results%append(record, model, interfaces, self%run, error, restart)
      end if
      if (allocated(error)) call self%progress%clear()
      self%run%seconds_write = self%run%seconds_write + (wall_seconds() - since)
   end subroutine accept

   !> Prints warnings of the run on stderr.
   subroutine print_warnings(self, warnings)
      class(run_output_type), intent(inout) :: self
      type(string_type), intent(in) :: warnings(:)
      integer :: i

      call self%progress%clear()
      do i = 1, size(warnings)
         call print_line(error_unit, or_blank(self%run%deck_path)//': warning: '//warnings(i)%value)
      end do
   end subroutine print_warnings

   !> Takes why the run ended early, and the increment at which it did not converge. A draft is then
   !> dropped.
   subroutine fail(self, reason, record)
      class(run_output_type), intent(inout) :: self
      character(*), intent(in) :: reason                     !! what went wrong, one sentence
      type(increment_record_type), intent(in) :: record      !! attempts and passes; empty for none

      if (self%kept_round > 0) then
         call self%progress%clear()
         call self%results%give_up()
         call self%listing%break_off(reason, record, kept(self, self%results%published))
         return
      end if
      call self%results%take_passes(record)
      self%judgement%ended_early = .true.
      call self%listing%end_early(reason, record, kept(self, self%results%accepted))
   end subroutine fail

   !> Ends the output: publishes what is left, then closes the listing. `run` then holds the
   !> verdicts.
   !> Error: status_internal, when a file cannot be written.
   subroutine finish(self, model, interfaces, cards, accuracy, error)
      class(run_output_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(string_type), intent(in) :: cards(:)           !! card images as read
      type(accuracy_rounds_type), intent(in) :: accuracy  !! rounds of a requested accuracy
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      real(dp) :: since
      integer :: counts(3)

      since = wall_seconds()
      if (any(model%verifications%expects)) then
         counts = self%verifier%counts(model)
         self%run%verify_passed = counts(1)
         self%run%verify_failed = counts(2)
      end if
      self%run%accuracy = told_of_rounds(accuracy, self%run%verify_passed + &
         self%run%verify_failed > 0, interfaces, model)
      self%run%is_finished = .not. self%judgement%ended_early .and. &
         self%run%accuracy%later_round == 0
      call self%results%finish(model, interfaces, self%run, accuracy, error)
      if (allocated(error)) then
         call self%break_off(error%message)
         return
      end if
      self%kept_round = 0
      self%is_finished = .true.
      self%run%seconds_write = self%run%seconds_write + (wall_seconds() - since)
      self%run%warnings = self%judgement%warnings(model, interfaces)
      call self%listing%finish(model, interfaces, cards, self%verifier, self%run, error)
      if (self%run%accuracy%later_round == 0) call print_warnings(self, self%run%warnings)
   end subroutine finish

   !> Ends the listing with the reason why the other files could not be written.
   subroutine break_off(self, reason)
      class(run_output_type), intent(inout) :: self
      character(*), intent(in) :: reason                  !! what went wrong, one sentence

      if (self%kept_round > 0) then
         call self%fail(reason, increment_record_type())
         return
      end if
      call self%progress%clear()
      if (self%listing%is_begun()) call self%listing%break_off(reason, increment_record_type(), '')
   end subroutine break_off

   !> Summary of the run at its last accepted increment.
   function summary_lines(self, model, interfaces) result(lines)
      class(run_output_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(string_type), allocatable :: lines(:)
      integer :: i

      allocate (lines(0))
      call self%listing%summary%add_lines(model, interfaces, lines)
      call self%verifier%add_asked(model, lines)
      associate (targets => self%run%accuracy%targets, rounds => self%run%accuracy%rounds, &
         advice => self%run%accuracy%advice)
         do i = 1, size(targets)
            ! The verdict is the first one.
            call append(lines, repeat(' ', merge(0, 3, i == 1))//targets(i)%value)
         end do
         lines = [lines, rounds]
         do i = 1, size(advice)
            call append(lines, '   '//advice(i)%value)
         end do
      end associate
   end function summary_lines

   !> The run at its last accepted increment as members of a document in JSON, and as a row of a
   !> table of runs.
   subroutine report(self, model, interfaces, members, row)
      class(run_output_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(json_type), intent(out) :: members
      type(result_row_type), intent(out) :: row
      integer :: i

      call put_run(members, self%run, model)
      call put_summary(members, row, self%listing%summary, model, interfaces)
      call put_checks(members, row, model, self%verifier)
      associate (accuracy => self%run%accuracy)
         if (.not. allocated(accuracy%targets)) return
         if (size(accuracy%targets) == 0) return
         call members%open('{', 'accuracy')
         call members%put(or_blank(accuracy%missed) == '', 'reached')
         call members%open('[', 'lines')
         do i = 1, size(accuracy%targets)
            call members%put(accuracy%targets(i)%value)
         end do
         do i = 1, size(accuracy%advice)
            call members%put(accuracy%advice(i)%value)
         end do
         call members%close(']')
         call members%close('}')
      end associate
   end subroutine report

   !> One line for each *VERIFY card that failed, and one for all that could not be judged.
   function failed_checks(self, model) result(lines)
      class(run_output_type), intent(in) :: self        !! the output, finished
      type(model_type), intent(in) :: model
      type(string_type), allocatable :: lines(:)        !! what was expected and what was found
      integer :: i, counts(3)

      allocate(lines(0))
      do i = 1, size(model%verifications)
         associate (check => model%verifications(i), outcome => self%verifier%outcomes(i))
            if (outcome%passed .or. .not. outcome%judged) cycle
            call append(lines, failure_words(check, outcome))
         end associate
      end do
      counts = self%verifier%counts(model)
      if (counts(3) > 0) call append(lines, self%run%deck_path//': note: '// &
         counted(counts(3), '*VERIFY check')//' could not be judged: the run ended before '// &
         trim(merge('its time   ', 'their times', counts(3) == 1)))
   end function failed_checks

   !> How many kinds of files of this run are in place: 0 none, 1 the listing, 2 with it the passes
   !> that failed, which the end of a run leaves, 3 all.
   pure integer function written(self)
      class(run_output_type), intent(in) :: self

      written = merge(1, 0, self%listing%is_begun())
      if (self%is_finished) written = 2
      if (self%results%published > 0) written = merge(4, 3, self%results%has_contact)
   end function written

   !> Contents of the files if the run ends here.
   pure function kept(self, increments) result(words)
      class(run_output_type), intent(in) :: self
      integer, intent(in) :: increments            ! in the result file
      character(:), allocatable :: words           ! one sentence

      words = 'No increment was accepted: this run has no result file and no .sta. If there '// &
         'are any, they are of an earlier run.'
      if (increments > 0) words = 'The results hold the increments up to number '// &
         to_text(increments)//'.'
      if (self%kept_round > 0 .and. increments == 0) words = 'The results are those of round '// &
         to_text(self%kept_round)//', the last whole one.'
   end function kept

end module run_output
