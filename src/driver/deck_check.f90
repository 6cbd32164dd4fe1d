!> `thercon check`: a deck as it was understood.
module deck_check
   use, intrinsic :: iso_fortran_env, only: output_unit
   use command_line, only: command_type
   use deck_preparation, only: prepare_deck, read_deck_type
   use errors, only: error_type
   use increments, only: simulation_type
   use interface_warnings, only: gap_range
   use messages, only: print_line
   use model, only: model_type
   use model_words, only: closed_law_words, friction_words, from_to, open_law_words, open_words, &
      pairing_words, points_words
   use run_description, only: describe_run
   use run_summaries, only: in_check, run_entries, run_entry_type, run_summary_type
   use text, only: counted, to_text
   use utf8, only: character_count
   implicit none
   private
   public :: check_deck

contains

   !> Reads one deck and prints what was understood, unless it is asked to be quiet; nothing is
   !> solved.
   subroutine check_deck(path, command, status)
      character(*), intent(in) :: path            !! the deck as given
      type(command_type), intent(in) :: command   !! options of the command line
      integer, intent(out) :: status              !! exit status
      type(read_deck_type) :: deck
      type(model_type) :: model
      type(simulation_type) :: simulation
      type(run_summary_type) :: run
      type(error_type), allocatable :: error

      status = 0
      call prepare_deck(path, command, deck, model, simulation, error)
      if (allocated(error)) then
         status = error%status
      else if (allocated(model%steps) .and. .not. command%quiet) then
         call describe_run(path, model, simulation, run)
         call print_deck(model, simulation, run)
      end if
      call simulation%release()
   end subroutine check_deck

   subroutine print_deck(model, simulation, run)
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(run_summary_type), intent(in) :: run
      type(run_entry_type), allocatable :: entries(:)
      integer :: i

      call print_line(output_unit, run%deck_path//': no errors, '// &
         counted(size(model%warnings), 'warning'))
      entries = run_entries(run, model)
      do i = 1, size(entries)
         if (entries(i)%is_told(in_check)) call line(entries(i)%label, entries(i)%words)
      end do
      do i = 1, size(model%interactions)
         associate (interaction => model%interactions(i))
            call line('interaction '//interaction%name, 'friction '// &
               friction_words(interaction%friction)//'; conductance, open: '// &
               open_law_words(interaction%law)//'; closed: '//closed_law_words(interaction%law))
         end associate
      end do
      do i = 1, size(simulation%bodies%interfaces)
         associate (points => simulation%bodies%interfaces(i))
            call line('contact pair '//points%name, to_text(size(points%slave))// &
               ' '//points_words(points)//', initial gaps '// &
               from_to(gap_range(model%mesh, points)))
            call line('pairing of '//points%name, pairing_words(model%contacts(i)%pairing, points))
            if (len(open_words(points)) > 0) call line('note on '//points%name, open_words(points))
         end associate
      end do
      if (run%has_biot) call line('contact Biot number', from_to(run%contact_biot)// &
         ' at the initial gaps')
   end subroutine print_deck

   subroutine line(name, value)
      character(*), intent(in) :: name, value

      call print_line(output_unit, '   '//name//' '//repeat('.', &
         max(26 - character_count(name), 2))//' '//value)
   end subroutine line

end module deck_check
