!> What the end of a deck's process means for the deck.
module batch_ends
   use deck_outcomes, only: deck_outcome_type
   use deck_task, only: account_type
   use errors, only: status_internal, status_interrupted
   use process_ends, only: describe_end, is_crash, process_end_type, signal_name
   use text, only: to_text
   implicit none
   private
   public :: take_end

   character(*), parameter :: mark = ': error: '   !! before what went wrong, in a message
   character(*), parameter :: ran_out = 'memory ran out'
   !> What the run-time library and the solvers' libraries say where there is no memory left.
   character(*), parameter :: signs_of_memory(4) = [character(24) :: 'Error allocating', &
      'Cannot allocate memory', 'Memory allocation', 'emory allocation failed']

contains

   !> Sets how a deck ended. Why a process ended before the deck did is added to what it printed.
   subroutine take_end(ended, account, printed, is_killed, outcome)
      type(process_end_type), intent(in) :: ended               !! end of the process
      type(account_type), intent(in) :: account                 !! what it said of itself
      character(:), allocatable, intent(inout) :: printed       !! messages, without last line end
      logical, intent(in) :: is_killed                          !! whether the batch ended it
      type(deck_outcome_type), intent(inout) :: outcome         !! how the deck ended

      outcome%has_run = .true.
      outcome%increments = int(account%increments)
      outcome%iterations = int(account%iterations)
      outcome%cpu_seconds = ended%cpu_seconds
      outcome%peak_bytes = ended%peak_bytes
      if (allocated(outcome%ending)) deallocate (outcome%ending)
      if (account%is_whole == 1 .and. ended%signal == 0) then
         outcome%status = ended%status
         outcome%verify_passed = int(account%verify_passed)
         outcome%verify_failed = int(account%verify_failed)
         outcome%seconds = account%seconds
         outcome%reason = ''
         if (outcome%status /= 0) outcome%reason = first_error(printed)
         if (index(outcome%reason, ran_out) == 1) outcome%ending = 'out of memory'
         return
      end if
      call explain(ended, printed, is_killed, outcome)
      if (len(printed) > 0) printed = printed//new_line('a')
      printed = printed//outcome%path//mark//outcome%reason
   end subroutine take_end

   !> The words for a process that did not come to the end of its deck.
   subroutine explain(ended, printed, is_killed, outcome)
      type(process_end_type), intent(in) :: ended
      character(*), intent(in) :: printed
      logical, intent(in) :: is_killed
      type(deck_outcome_type), intent(inout) :: outcome

      outcome%status = status_internal
      outcome%reason = describe_end(ended)
      if (is_killed) then
         outcome%status = status_interrupted
         outcome%ending = 'interrupted'
         outcome%reason = 'killed because a second signal came'
      else if (says_out_of_memory(printed)) then
         outcome%ending = 'out of memory'
         if (ended%signal == 0) outcome%reason = ran_out
         if (ended%signal /= 0) outcome%reason = ran_out//'; '//outcome%reason
      else if (ended%signal == 0) then
         outcome%reason = 'its process ended with status '//to_text(ended%status)// &
            ' before the deck did'
      else if (is_crash(ended%signal)) then
         outcome%ending = 'crash: '//signal_name(ended%signal)
      else
         outcome%ending = 'killed: '//signal_name(ended%signal)
      end if
   end subroutine explain

   pure logical function says_out_of_memory(printed)
      character(*), intent(in) :: printed
      integer :: i

      says_out_of_memory = .false.
      do i = 1, size(signs_of_memory)
         if (index(printed, trim(signs_of_memory(i))) > 0) says_out_of_memory = .true.
      end do
   end function says_out_of_memory

   !> What stands behind the mark in the first line that has it.
   pure function first_error(printed) result(words)
      character(*), intent(in) :: printed
      character(:), allocatable :: words
      integer :: first, length

      words = ''
      first = index(printed, mark)
      if (first == 0) return
      first = first + len(mark)
      length = index(printed(first:)//new_line('a'), new_line('a')) - 1
      words = printed(first:first + length - 1)
   end function first_error

end module batch_ends
