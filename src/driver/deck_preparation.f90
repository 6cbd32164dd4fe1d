!> One deck from its cards to a run that can start, or to what is wrong with it.
module deck_preparation
   use, intrinsic :: iso_fortran_env, only: error_unit
   use cards, only: cards_type
   use command_line, only: command_type
   use deck_builder, only: build_model
   use deck_reader, only: read_deck
   use deck_report, only: deck_report_type
   use errors, only: error_type, status_deck
   use increments, only: simulation_type
   use messages, only: print_error
   use model, only: model_type
   use pair_reports, only: pair_all
   use support_checks, only: check_over_constrained, check_supports
   use variations, only: variation_type
   use verify_places, only: check_arc_lengths
   implicit none
   private
   public :: prepare_deck

contains

   !> Reads a deck and prepares its run. Warnings and errors go to stderr.
   subroutine prepare_deck(path, command, cards, model, simulation, status, variation)
      character(*), intent(in) :: path                    !! the deck as given
      type(command_type), intent(in) :: command           !! options of the command line
      type(cards_type), intent(out) :: cards              !! its cards
      type(model_type), intent(out) :: model              !! its model
      type(simulation_type), intent(inout) :: simulation  !! a fresh run
      integer, intent(out) :: status                      !! exit status so far
      type(variation_type), intent(in), optional :: variation   !! what is other than in the deck
      type(deck_report_type) :: report
      type(error_type), allocatable :: error

      status = 0
      call read_deck(path, command%width, command%settings, cards, report)
      call build_model(cards, model, report, error, variation)
      if (.not. (report%has_errors() .or. allocated(error))) then
         call pair_all(model, simulation%operators%interfaces, report)
      end if
      if (.not. (report%has_errors() .or. allocated(error))) then
         call simulation%start(model, error)
         if (allocated(error)) then
            call check_over_constrained(model, simulation, report)
            if (report%has_errors()) deallocate (error)
         else
            call check_arc_lengths(model, simulation%operators%interfaces, report)
            call check_supports(cards%last, model, simulation, report)
         end if
      end if
      model%warnings = report%warnings()
      call report%print(error_unit)
      if (report%has_errors()) status = status_deck
      if (.not. allocated(error)) return
      status = error%status
      call print_error(path, error%message)
   end subroutine prepare_deck

end module deck_preparation
