!> The summary at the head of the listing.
module listing_summary
   use listing_text, only: page_width
   use run_summaries, only: run_summary_type
   use summary, only: summary_type
   use text, only: counted, string_type, to_text
   use verification, only: verifier_type
   implicit none
   private
   public :: ending, checks, warnings_below, summary_block

   integer, parameter :: run_lines = 3   !! ending, checks, warnings

contains

   !> How the run ended.
   pure function ending(has_failed, increments, failed_checks, missed, later_round) result(line)
      logical, intent(in) :: has_failed          !! whether it ended early
      integer, intent(in) :: increments          !! accepted ones
      integer, intent(in) :: failed_checks
      logical, intent(in) :: missed              !! whether a target of accuracy is not met
      integer, intent(in) :: later_round         !! round that was begun after this one; 0 for none
      character(:), allocatable :: line

      line = 'solved'
      if (missed) line = 'accuracy not reached'
      if (failed_checks > 0 .and. .not. missed) line = 'check failed'
      if (failed_checks > 0 .and. missed) line = 'check failed, '//line
      line = line//', '//counted(increments, 'increment')
      ! Read only while that round is solved, or where it did not come to its end.
      if (later_round > 0) line = line//'; round '//to_text(later_round)// &
         ' is being solved, or see ENDED EARLY at the end'
      if (has_failed) line = 'ended early after '//counted(increments, 'increment')// &
         ', see ENDED EARLY below'
   end function ending

   !> How many checks passed.
   pure function checks(verifier, run) result(line)
      type(verifier_type), intent(in) :: verifier  !! of this round
      type(run_summary_type), intent(in) :: run
      character(:), allocatable :: line

      line = 'no *VERIFY checks'
      if (size(verifier%outcomes) > 0 .or. run%verify_passed + run%verify_failed > 0) then
         line = counted(run%verify_passed, 'check')//' passed, '//to_text(run%verify_failed)// &
            ' failed'
         if (size(verifier%outcomes) == 0) line = line//' in round 1'
      end if
      if (verifier%unjudged_count() > 0) line = line//', '// &
         to_text(verifier%unjudged_count())//' not judged'
   end function checks

   !> How many warnings there are.
   pure function warnings_below(warnings) result(line)
      integer, intent(in) :: warnings            !! number of them
      character(:), allocatable :: line

      line = 'no warnings'
      if (warnings > 0) line = counted(warnings, 'warning')//', see WARNINGS below'
   end function warnings_below

   !> The summary as it is in the file: always as many lines of the same length, so that it can be
   !> written over.
   pure function summary_block(lines, interfaces) result(block)
      type(string_type), intent(in) :: lines(:)
      integer, intent(in) :: interfaces               !! number of them
      character(:), allocatable :: block
      type(summary_type) :: summary
      character(page_width) :: line
      integer :: i

      block = ''
      do i = 1, run_lines + summary%most_lines(interfaces)
         line = ''
         if (i <= size(lines)) line = '   '//lines(i)%value
         block = block//line//new_line('a')
      end do
   end function summary_block

end module listing_summary
