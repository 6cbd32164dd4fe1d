!> What a person at a terminal sees: a progress line, the summary of a run, the table of a batch.
module progress
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use clock, only: wall_seconds
   use errors, only: status_deck, status_internal, status_interrupted, status_no_convergence, &
      status_ok, status_verify
   use kinds, only: dp
   use records, only: increment_record_type
   use system_calls, only: is_terminal
   use text, only: to_text
   use zone_diagram, only: zone_counts
   implicit none
   private
   public :: progress_type, deck_outcome_type, print_batch_summary

   real(dp), parameter :: pause_seconds = 0.1_dp   !! between two updates of the line [s]
   integer, parameter :: line_length = 100         !! longest progress line

   !> The progress line.
   type :: progress_type
      private
      logical :: is_shown = .false.         !! whether there is a terminal that wants it
      real(dp) :: last_update = 0.0_dp      !! when the line was last drawn [s]
      integer :: length = 0                 !! characters that stand on the line
   contains
      procedure :: start
      procedure :: show
      procedure :: say
      procedure :: clear
   end type progress_type

   !> How a deck of a batch ended.
   type :: deck_outcome_type
      character(:), allocatable :: path     !! deck as the command line names it
      integer :: status = status_ok         !! one of the status_* constants
      logical :: left_out = .false.         !! whether a signal kept it from being started
      integer :: increments = 0             !! increments that were accepted
      integer :: verify_passed = 0          !! *VERIFY checks that passed
      integer :: verify_failed = 0          !! *VERIFY checks that failed
      real(dp) :: seconds = 0.0_dp          !! time it took [s]
   contains
      procedure :: print => print_outcome
   end type deck_outcome_type

contains

   !> Prepares the line: it is shown on a terminal only.
   subroutine start(self, quiet)
      class(progress_type), intent(inout) :: self   !! the line
      logical, intent(in) :: quiet                  !! --quiet

      self%is_shown = .not. quiet
      if (self%is_shown) self%is_shown = is_terminal(2)
   end subroutine start

   !> Shows where the run stands; several calls a moment draw the line once.
   subroutine show(self, record)
      class(progress_type), intent(inout) :: self         !! the line
      type(increment_record_type), intent(in) :: record   !! the last accepted increment
      character(:), allocatable :: line
      integer :: zones(3), i

      if (.not. self%is_shown) return
      if (wall_seconds() - self%last_update < pause_seconds) return
      self%last_update = wall_seconds()
      zones = 0
      do i = 1, size(record%contacts)
         zones = zones + zone_counts(record%contacts(i)%status)
      end do
      line = 'increment '//to_text(record%increment)
      if (allocated(record%iterations)) then
         line = line//'  iterations '//to_text(size(record%iterations))
      end if
      if (record%cut_backs > 0) line = line//'  cut-backs '//to_text(record%cut_backs)
      line = line//'  load '//to_text(record%load)
      if (sum(zones) > 0) line = line//'  I '//to_text(zones(1))//' II '//to_text(zones(2))// &
         ' III '//to_text(zones(3))
      call self%say(line)
   end subroutine show

   !> Shows a line of words in place of the last one.
   subroutine say(self, words)
      class(progress_type), intent(inout) :: self   !! the line
      character(*), intent(in) :: words             !! what it says
      integer :: length

      if (.not. self%is_shown) return
      length = min(len(words), line_length)
      write (error_unit, '(3a)', advance='no') achar(13), words(:length), &
         repeat(' ', max(0, self%length - length))
      flush (error_unit)
      self%length = length
   end subroutine say

   !> Wipes the line away.
   subroutine clear(self)
      class(progress_type), intent(inout) :: self   !! the line

      if (self%length > 0) then
         write (error_unit, '(3a)', advance='no') achar(13), repeat(' ', self%length), achar(13)
      end if
      self%length = 0
   end subroutine clear

   !> The short summary of one run.
   subroutine print_outcome(self, results)
      class(deck_outcome_type), intent(in) :: self    !! the run
      character(*), intent(in) :: results             !! path of its results without extension

      write (output_unit, '(5a, f5.2, a)') self%path, ': ', status_text(self%status), ', ', &
         to_text(self%increments)//' increments in ', self%seconds, ' s'
      if (self%verify_passed + self%verify_failed > 0) write (output_unit, '(2x, 4a)') &
         to_text(self%verify_passed), ' checks passed, ', to_text(self%verify_failed), ' failed'
      if (self%status == status_deck .or. self%status == status_internal) return
      write (output_unit, '(2x, 3a)') 'results: ', results, &
         trim(merge('.vtkhdf, .lst, .sta, .cvg', '.lst, .cvg               ', self%increments > 0))
   end subroutine print_outcome

   !> The table at the end of a batch.
   subroutine print_batch_summary(outcomes)
      type(deck_outcome_type), intent(in) :: outcomes(:)   !! one a deck, in their order
      integer :: width, i

      width = len('deck')
      do i = 1, size(outcomes)
         width = max(width, len(outcomes(i)%path))
      end do
      write (output_unit, '(/, 2a, 2x, a18, a12, a8, a8, a10)') 'deck', repeat(' ', width - 4), &
         'outcome', 'increments', 'passed', 'failed', 'seconds'
      do i = 1, size(outcomes)
         associate (deck => outcomes(i))
            write (output_unit, '(2a, 2x, a18, i12, 2i8, f10.2)') deck%path, &
               repeat(' ', width - len(deck%path)), status_text(deck%status), deck%increments, &
               deck%verify_passed, deck%verify_failed, deck%seconds
         end associate
      end do
   end subroutine print_batch_summary

   pure function status_text(status) result(string)
      integer, intent(in) :: status
      character(:), allocatable :: string

      select case (status)
      case (status_ok)
         string = 'solved'
      case (status_deck)
         string = 'deck error'
      case (status_no_convergence)
         string = 'not converged'
      case (status_internal)
         string = 'internal/I-O error'
      case (status_verify)
         string = 'check failed'
      case (status_interrupted)
         string = 'interrupted'
      case default
         string = 'status '//to_text(status)
      end select
   end function status_text

end module progress
