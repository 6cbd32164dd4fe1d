!> What `thercon check` prints of a deck that it understood.
module deck_check
   use, intrinsic :: iso_fortran_env, only: output_unit
   use command_line, only: command_type
   use deck_preparation, only: prepare_deck, read_deck_type
   use errors, only: error_type
   use increments, only: simulation_type
   use interface_warnings, only: gap_range
   use kinds, only: dp
   use messages, only: print_line
   use model, only: model_type
   use model_words, only: closed_law_words, friction_words, material_words, open_law_words, &
      open_words, pairing_words, points_words, section_words
   use run_description, only: describe_run
   use run_summaries, only: run_summary_type
   use text, only: counted, string_type, to_text
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
      type(string_type), allocatable :: sections(:)
      real(dp) :: gaps(2)
      integer :: i

      call print_line(output_unit, run%deck_path//': no errors, '// &
         counted(size(model%warnings), 'warning'))
      call line('modelled', run%modelled)
      call line('bodies', to_text(model%mesh%body_count))
      call line('nodes', to_text(size(model%mesh%node_number)))
      call line('elements', to_text(size(model%mesh%element_number)))
      call line('steps', to_text(size(model%steps)))
      call line('unknown temperatures', to_text(run%equations_thermal))
      call line('unknown displacements', to_text(run%equations_mechanical))
      call line('contact unknowns', to_text(run%contact_unknowns))
      call line('memory of a run', to_text(nint(model%memory_needed/1.0e6_dp))//' MB (estimate)')
      sections = section_words(model)
      do i = 1, size(sections)
         call line('section '//to_text(i), sections(i)%value)
      end do
      do i = 1, size(model%materials)
         call line('material '//model%materials(i)%name, material_words(model%materials(i)))
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
            gaps = gap_range(model%mesh, points)
            call line('contact pair '//points%name, to_text(size(points%slave_node))// &
               ' '//points_words(points)//', initial gaps '//to_text(gaps(1))//' to '// &
               to_text(gaps(2)))
            call line('pairing of '//points%name, pairing_words(model%contacts(i)%pairing, points))
            if (len(open_words(points)) > 0) call line('note on '//points%name, open_words(points))
         end associate
      end do
      if (run%has_biot) call line('contact Biot number', to_text(run%contact_biot(1))//' to '// &
         to_text(run%contact_biot(2))//' at the initial gaps')
   end subroutine print_deck

   subroutine line(name, value)
      character(*), intent(in) :: name, value

      call print_line(output_unit, '   '//name//' '//repeat('.', &
         max(26 - character_count(name), 2))//' '//value)
   end subroutine line

end module deck_check
