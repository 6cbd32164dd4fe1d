!> Other contact states that satisfy all conditions at the end of a step. Where the conductance
!> jumps as a gap closes, a contact point beside an edge may be closed, warm and pressed, or open
!> and cold: both are solutions on the mesh of the run, and its increments decide which one it
!> finds. The exact solution has one edge; so what these states differ by is an error of the mesh.
module other_states
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use contact_quantities, only: estimated
   use contact_system, only: contact_open
   use controls, only: start_closed, start_open, start_type
   use companion_states, only: implicit_state, implicit_step
   use errors, only: error_type
   use heat_reduction, only: heat_reduction_type
   use interface_quantities, only: quantities_of_state
   use kinds, only: dp
   use model, only: model_type
   use reduced_bodies, only: reduced_bodies_type
   use simulation, only: simulation_type
   use solution_state, only: solution_state_type
   use steps, only: step_type
   use temperature_laws, only: law_jumps
   implicit none
   private
   public :: find_other_states

contains

   !> The quantities of another state, of those from OPEN and from CLOSED that differ from that of
   !> the run at contact points beside edges alone: those farthest from its own. What differs more
   !> is another branch, no error of this one.
   subroutine find_other_states(simulation, model, step, before, farthest)
      type(simulation_type), intent(in) :: simulation        !! the run at the end of an increment
      type(model_type), intent(in) :: model
      integer, intent(in) :: step                            !! index of its step
      type(solution_state_type), intent(in) :: before        !! state at the start of the increment
      !> (quantities, interfaces) those of the run in, and out where there is no other
      real(dp), intent(inout) :: farthest(:, :)
      integer, parameter :: kinds(2) = [start_open, start_closed]
      type(error_type), allocatable :: error
      type(heat_reduction_type) :: heat
      type(solution_state_type) :: state
      type(step_type) :: from
      real(dp), dimension(size(estimated), size(farthest, 2)) :: own, other
      integer :: i

      own = farthest
      associate (bodies => simulation%bodies)
         if (.not. bodies%is_coupled .or. .not. any(law_jumps(bodies%laws%conductance))) return
         do i = 1, size(kinds)
            from = implicit_step(model%steps(step))
            from%start = start_type(kind=kinds(i))
            state = simulation%state
            call implicit_state(simulation, heat, model, from, before, state, error)
            if (allocated(error)) cycle
            if (.not. is_beside(state%contact%contact_state, &
               simulation%state%contact%contact_state, piece_starts(bodies))) cycle
            call quantities_of_state(bodies, state, other)
            where (.not. ieee_is_nan(other - own))
               farthest = merge(other, farthest, abs(other - own) > abs(farthest - own))
            end where
         end do
      end associate
      call heat%release()
   end subroutine find_other_states

   !> The first contact point of each piece of all interfaces, and the one behind the last.
   pure function piece_starts(bodies) result(starts)
      type(reduced_bodies_type), intent(in) :: bodies
      integer, allocatable :: starts(:)
      integer :: i

      starts = [integer ::]
      associate (start => bodies%points%interface_start)
         do i = 1, size(bodies%interfaces)
            associate (ends => bodies%interfaces(i)%ends())
               starts = [starts, start(i) - 1 + ends(1::2)]
            end associate
         end do
         starts = [starts, start(size(start))]
      end associate
   end function piece_starts

   !> Whether two contact states differ, and by no more than one contact point at each edge.
   pure logical function is_beside(one, other, start)
      integer, intent(in) :: one(:), other(:)       !! (m) open, slip or stick
      integer, intent(in) :: start(:)               !! (pieces + 1) first contact points
      integer :: i, k

      is_beside = any([(differs(k), k=1, size(one))])
      do i = 1, size(start) - 1
         do k = start(i), start(i + 1) - 1
            if (.not. differs(k)) cycle
            associate (beside => [max(k - 1, start(i)), min(k + 1, start(i + 1) - 1)])
               is_beside = is_beside .and. &
                  any((one(beside) == contact_open) .neqv. (one(k) == contact_open)) .and. &
                  .not. (k > start(i) .and. differs(max(k - 1, 1)))
            end associate
         end do
      end do

   contains

      pure logical function differs(k)
         integer, intent(in) :: k

         differs = (one(k) == contact_open) .neqv. (other(k) == contact_open)
      end function differs

   end function is_beside

end module other_states
