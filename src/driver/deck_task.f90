!> A deck of a batch, solved in a process of its own; what is known of it stands in memory that the
!> batch sees, whatever becomes of that process.
module deck_task
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use command_line, only: command_type
   use deck_outcomes, only: deck_outcome_type
   use deck_run, only: run_deck
   use kinds, only: dp
   use processes, only: task_type
   use records, only: increment_record_type
   implicit none
   private
   public :: deck_task_type, account_type

   !> What a deck's process says of itself, all of it 0 at first.
   type, bind(c) :: account_type
      integer(c_int) :: is_whole = 0_c_int        !! 1 once the deck has ended by itself
      integer(c_int) :: increments = 0_c_int      !! as in deck_outcome_type
      integer(c_int) :: iterations = 0_c_int      !! alike
      integer(c_int) :: verify_passed = 0_c_int   !! alike
      integer(c_int) :: verify_failed = 0_c_int   !! alike
      real(c_double) :: seconds = 0.0_dp          !! alike [s]
   end type account_type

   !> The deck.
   type, extends(task_type) :: deck_task_type
      character(:), allocatable :: path                !! as given
      type(command_type) :: command                    !! options of the command line
      type(account_type), pointer :: account => null() !! in memory that is shared
   contains
      procedure :: execute
   end type deck_task_type

   !> An outcome that is told while the deck runs.
   type, extends(deck_outcome_type) :: told_outcome_type
      type(account_type), pointer :: account => null() !! in memory that is shared
   contains
      procedure :: note => note_and_tell
   end type told_outcome_type

contains

   !> Solves the deck.
   subroutine execute(self, status)
      class(deck_task_type), intent(inout) :: self   !! the deck
      integer, intent(out) :: status                 !! exit status
      type(told_outcome_type) :: outcome

      outcome%account => self%account
      call run_deck(self%path, self%command, outcome)
      status = outcome%status
      associate (account => self%account)
         account%verify_passed = int(outcome%verify_passed, c_int)
         account%verify_failed = int(outcome%verify_failed, c_int)
         account%seconds = outcome%seconds
         account%is_whole = 1_c_int
      end associate
   end subroutine execute

   !> Counts the passes of an increment, and tells them.
   subroutine note_and_tell(self, record, accepted)
      class(told_outcome_type), intent(inout) :: self     !! the run
      type(increment_record_type), intent(in) :: record   !! the increment
      integer, intent(in) :: accepted                     !! increments accepted so far

      call self%deck_outcome_type%note(record, accepted)
      self%account%increments = int(self%increments, c_int)
      self%account%iterations = int(self%iterations, c_int)
   end subroutine note_and_tell

end module deck_task
