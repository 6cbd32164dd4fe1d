!> thercon: thermomechanical contact of elastic bodies. Command line and exit status.
program thercon
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use command_line, only: command_check, command_help, command_trade, command_type, &
      command_version, read_command, usage
   use deck_check, only: check_deck
   use deck_run, only: base_name, run_deck
   use deck_trade, only: trade_deck
   use errors, only: error_type, status_deck, status_interrupted
   use interruption, only: catch_signals, caught_signal
   use progress, only: deck_outcome_type, print_batch_summary
   use version_report, only: print_versions
   implicit none
   type(command_type) :: command
   type(error_type), allocatable :: error
   integer :: status

   interface
      !> Ends the process without the line that STOP writes.
      subroutine c_exit(status) bind(c, name='exit')
         import :: c_int
         integer(c_int), value :: status
      end subroutine c_exit
   end interface

   status = 0
   call read_command(command, error)
   if (allocated(error)) then
      write (error_unit, '(2a)') 'thercon: error: ', error%message
      call c_exit(int(status_deck, c_int))
   end if
   select case (command%action)
   case (command_help)
      write (output_unit, '(a)') usage
   case (command_version)
      call print_versions(output_unit)
   case (command_check)
      call check_all(status)
   case (command_trade)
      call catch_signals()
      call trade_deck(command%decks(1)%value, command, status)
   case default
      call run_all(status)
   end select
   flush (output_unit)
   flush (error_unit)
   call c_exit(int(status, c_int))

contains

   !> Checks the decks one after the other.
   subroutine check_all(worst)
      integer, intent(out) :: worst
      integer :: deck, deck_status

      worst = 0
      do deck = 1, size(command%decks)
         call check_deck(command%decks(deck)%value, command, deck_status)
         worst = max(worst, deck_status)
      end do
   end subroutine check_all

   !> Solves the decks one after the other; one that fails does not stop the others.
   subroutine run_all(worst)
      integer, intent(out) :: worst
      type(deck_outcome_type) :: outcomes(size(command%decks))
      integer :: deck, other

      worst = 0
      do deck = 2, size(command%decks)
         do other = 1, deck - 1
            if (base_name(command%decks(deck)%value) /= base_name(command%decks(other)%value)) then
               cycle
            end if
            write (error_unit, '(6a)') 'thercon: error: ', command%decks(other)%value, ' and ', &
               command%decks(deck)%value, ' would have the same results'
            worst = status_deck
         end do
      end do
      if (worst > 0) return
      call catch_signals()
      do deck = 1, size(command%decks)
         if (caught_signal() == '') then
            call run_deck(command%decks(deck)%value, command, outcomes(deck))
         else
            call leave_out(command%decks(deck)%value, outcomes(deck))
         end if
         worst = max(worst, outcomes(deck)%status)
         if (.not. command%quiet .and. outcomes(deck)%status /= status_deck .and. &
            .not. outcomes(deck)%left_out) then
            call outcomes(deck)%print(command%folder//'/'//base_name(outcomes(deck)%path))
         end if
      end do
      if (size(outcomes) > 1 .and. .not. command%quiet) call print_batch_summary(outcomes)
   end subroutine run_all

   !> Leaves out a deck that stands behind the one at which a signal came.
   subroutine leave_out(path, outcome)
      character(*), intent(in) :: path
      type(deck_outcome_type), intent(inout) :: outcome

      outcome%path = path
      outcome%status = status_interrupted
      outcome%left_out = .true.
      write (error_unit, '(4a)') path, ': error: not started because of ', caught_signal()
   end subroutine leave_out

end program thercon
