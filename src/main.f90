!> thercon: thermomechanical contact of elastic bodies. Command line and exit status.
program thercon
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use command_line, only: command_check, command_help, command_keywords, command_trade, &
      command_type, command_version, read_command, usage
   use batch, only: run_batch
   use deck_files, only: results_of
   use deck_outcomes, only: deck_outcome_type
   use deck_reader, only: keyword_lines
   use deck_run, only: run_deck
   use deck_trade, only: trade_deck
   use errors, only: error_type, status_deck
   use file_calls, only: check_printed, survive_file_limits
   use interruption, only: catch_signals
   use memory_calls, only: allow_stack
   use messages, only: print_error, print_line
   use run_description, only: check_deck
   use text, only: string_type
   use version_report, only: print_versions
   implicit none
   type(command_type) :: command
   type(deck_outcome_type) :: outcome
   type(error_type), allocatable :: error
   type(string_type), allocatable :: lines(:)
   integer :: deck_status, i, status

   interface
      !> Ends the process without the line that STOP writes.
      subroutine c_exit(status) bind(c, name='exit')
         import :: c_int
         integer(c_int), value :: status
      end subroutine c_exit
   end interface

   status = 0
   call survive_file_limits()
   call allow_stack(error)
   if (.not. allocated(error)) call read_command(command, error)
   if (allocated(error)) then
      call print_error('thercon', error%message)
      call c_exit(int(error%status, c_int))
   end if
   select case (command%action)
   case (command_help)
      do i = 1, size(usage)
         call print_line(output_unit, trim(usage(i)))
      end do
   case (command_keywords)
      lines = keyword_lines()
      status = status_deck
      do i = 2, size(lines)
         if (index(lines(i)%value, command%keyword) /= 1) cycle
         if (status == status_deck) call print_line(output_unit, lines(1)%value)
         status = 0
         call print_line(output_unit, lines(i)%value)
      end do
      if (status == status_deck) call print_error('thercon', 'no keyword begins with '// &
         command%keyword//'; thercon --keywords prints all')
   case (command_version)
      call print_versions()
   case (command_check)
      do i = 1, size(command%decks)
         call check_deck(command%decks(i)%value, command, deck_status)
         status = max(status, deck_status)
      end do
   case (command_trade)
      call catch_signals(outlives_pipes=.false.)
      call trade_deck(command%decks(1)%value, command, status)
   case default
      if (command%is_batch) then
         call run_batch(command, status)
      else
         associate (path => command%decks(1)%value)
            call catch_signals(outlives_pipes=.false.)
            call run_deck(path, command, outcome)
            status = outcome%report%status
            if (command%json) call outcome%print_document(results_of(path, command))
            if (.not. command%quiet .and. status /= status_deck) call outcome%print(results_of( &
               path, command))
            call outcome%print_failed_checks()
         end associate
      end if
   end select
   call check_printed(error)
   if (allocated(error)) then
      call print_error('thercon', error%message)
      status = max(status, error%status)
   end if
   flush (error_unit)
   call c_exit(int(status, c_int))

end program thercon
