!> A deck of a batch, solved in a process of its own.
module deck_task
   use command_line, only: command_type
   use deck_outcomes, only: deck_outcome_type
   use deck_run, only: run_deck
   use processes, only: report_type, task_type
   implicit none
   private
   public :: deck_task_type

   !> The deck.
   type, extends(task_type) :: deck_task_type
      character(:), allocatable :: path   !! as given
      type(command_type) :: command       !! options of the command line
   contains
      procedure :: execute
   end type deck_task_type

contains

   !> Solves the deck.
   subroutine execute(self, report)
      class(deck_task_type), intent(inout) :: self
      type(report_type), intent(inout) :: report   !! how the deck ended
      type(deck_outcome_type) :: outcome

      call run_deck(self%path, self%command, outcome)
      call outcome%print_failed_checks()
      report = outcome%as_report()
   end subroutine execute

end module deck_task
