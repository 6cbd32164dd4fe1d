!> One deck from its cards to a run that can start, or to what is wrong with it.
module deck_preparation
   use, intrinsic :: iso_fortran_env, only: error_unit
   use cards, only: cards_type
   use command_line, only: command_type
   use contact_pairs, only: contact_pairs_type
   use deck_builder, only: build_model
   use deck_reader, only: read_deck
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use errors, only: error_type, status_deck
   use increments, only: simulation_type
   use interface_operators, only: pair_surfaces
   use kinds, only: dp
   use loads, only: loads_type
   use loose_bodies, only: bodies_held_by_nothing, bodies_without_temperature
   use model, only: model_type
   use pair_rings, only: first_repeated
   use steps, only: solves_heat, solves_mechanics
   use text, only: string_type, to_text
   use verify_places, only: check_arc_lengths
   implicit none
   private
   public :: prepare_deck

contains

   !> Reads a deck and prepares its run. Warnings and errors go to stderr.
   subroutine prepare_deck(path, command, cards, model, simulation, status)
      character(*), intent(in) :: path                    !! the deck as given
      type(command_type), intent(in) :: command           !! options of the command line
      type(cards_type), intent(out) :: cards              !! its cards
      type(model_type), intent(out) :: model              !! its model
      type(simulation_type), intent(inout) :: simulation  !! a fresh run
      integer, intent(out) :: status                      !! exit status so far
      type(deck_report_type) :: report
      type(error_type), allocatable :: error

      status = 0
      call read_deck(path, command%width, command%settings, cards, report)
      call build_model(cards, model, report)
      if (.not. report%has_errors()) then
         call pair_all(model, simulation%operators%interfaces, report)
      end if
      if (.not. report%has_errors()) then
         call simulation%start(model, error)
         if (.not. allocated(error)) then
            call check_arc_lengths(model, simulation%operators%interfaces, report)
            call check_supports(cards%last, model, simulation, report)
         end if
      end if
      call report%print(error_unit)
      if (report%has_errors()) status = status_deck
      if (.not. allocated(error)) return
      status = error%status
      write (error_unit, '(3a)') path, ': error: ', error%message
   end subroutine prepare_deck

   !> Pairs the surfaces of every *CONTACT PAIR and reports those that cannot be paired.
   subroutine pair_all(model, interfaces, report)
      type(model_type), intent(in) :: model
      type(contact_pairs_type), allocatable, intent(out) :: interfaces(:)
      type(deck_report_type), intent(inout) :: report
      type(error_type), allocatable :: error
      integer, allocatable :: slave(:), master(:)
      real(dp), allocatable :: normal(:, :)
      integer :: i, known, pair

      allocate (slave(0), master(0), normal(2, 0), interfaces(size(model%contacts)))
      do i = 1, size(model%contacts)
         call pair_surfaces(model, i, interfaces(i), error)
         if (allocated(error)) then
            call report%error(place_type(image=model%contacts(i)%card), error%message)
            cycle
         end if
         known = size(slave)
         slave = [slave, interfaces(i)%slave_node]
         master = [master, interfaces(i)%master_node]
         normal = reshape([normal, interfaces(i)%normal], [2, size(slave)])
         pair = first_repeated(slave, master, normal)
         if (pair == 0) cycle
         associate (number => model%mesh%node_number)
            call report%error(place_type(image=model%contacts(i)%card), 'contact pair '// &
               interfaces(i)%name//': nodes '//to_text(number(slave(pair)))//' and '// &
               to_text(number(master(pair)))//' are paired along the same normal by an '// &
               'earlier *CONTACT PAIR already; leave one of the two out')
         end associate
         slave = slave(:known)
         master = master(:known)
         normal = normal(:, :known)
      end do
   end subroutine pair_all

   !> Reports the bodies that nothing holds and those whose temperature nothing determines, for the
   !> first step that leaves one so.
   subroutine check_supports(last, model, simulation, report)
      type(place_type), intent(in) :: last
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(deck_report_type), intent(inout) :: report
      type(loads_type) :: loads
      type(string_type), allocatable :: messages(:)
      integer :: i, step

      loads = simulation%loads
      do step = 1, size(model%steps)
         if (step > 1) call loads%begin_step(model%steps(step), simulation%state%displacement, &
            simulation%state%temperature)
         associate (analysis => model%steps(step)%analysis, pairs => simulation%operators%pairs)
            if (solves_mechanics(analysis)) then
               call bodies_held_by_nothing(model, pairs, loads%displacement%active, messages)
               call report_all()
            end if
            if (solves_heat(analysis)) then
               call bodies_without_temperature(model, pairs, loads%temperature%active, step, &
                  messages)
               call report_all()
            end if
         end associate
         if (report%has_errors()) return
      end do
   contains
      subroutine report_all()
         do i = 1, size(messages)
            call report%error(last, 'step '//to_text(step)//': '//messages(i)%value)
         end do
      end subroutine report_all
   end subroutine check_supports

end module deck_preparation
