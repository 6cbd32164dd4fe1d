!> Whether every body is held, and no contact pair is held too much, in every step.
module support_checks
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use increments, only: simulation_type
   use loads, only: loads_type
   use loose_bodies, only: bodies_held_by_nothing, bodies_without_temperature
   use model, only: model_type
   use pair_rows, only: over_constrained
   use steps, only: solves_heat, solves_mechanics
   use text, only: string_type, to_text
   implicit none
   private
   public :: check_over_constrained, check_supports

contains

   !> Reports the first pair of each interface whose relative motion is prescribed along the normal,
   !> because that of both nodes is, for the first step that has one.
   subroutine check_over_constrained(model, simulation, report)
      type(model_type), intent(in) :: model               !! the model
      type(simulation_type), intent(in) :: simulation     !! the run, whose start failed at this
      type(deck_report_type), intent(inout) :: report     !! receives errors
      type(loads_type) :: loads
      logical, allocatable :: too_much(:)
      integer :: first, i, k, step

      loads = simulation%loads
      do step = 1, size(model%steps)
         call loads%begin_step(model%steps(step), simulation%state%displacement, &
            simulation%state%temperature)
         if (.not. solves_mechanics(model%steps(step)%analysis)) cycle
         too_much = over_constrained(simulation%operators%pairs, loads%displacement%active)
         do i = 1, size(model%contacts)
            associate (start => simulation%operators%pairs%interface_start)
               first = start(i)
               k = findloc(too_much(first:start(i + 1) - 1), .true., dim=1)
            end associate
            if (k == 0) cycle
            associate (pairs => simulation%operators%interfaces(i), &
               number => model%mesh%node_number)
               call report%error(place_type(image=model%contacts(i)%card), 'step '// &
                  to_text(step)//': contact pair '//pairs%name//': *BOUNDARY prescribes the '// &
                  'motion of slave node '//to_text(number(pairs%slave_node(k)))// &
                  ' and master node '//to_text(number(pairs%master_node(k)))//' towards each '// &
                  'other, so that their contact force is undetermined; free one of the two '// &
                  'nodes along the normal of the faces')
            end associate
         end do
         if (report%has_errors()) return
      end do
   end subroutine check_over_constrained

   !> Reports the bodies that nothing holds and those whose temperature nothing determines, for the
   !> first step that leaves one so.
   subroutine check_supports(last, model, simulation, report)
      type(place_type), intent(in) :: last                !! where the deck ends
      type(model_type), intent(in) :: model               !! the model
      type(simulation_type), intent(in) :: simulation     !! the run, started
      type(deck_report_type), intent(inout) :: report     !! receives errors
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

end module support_checks
