!> States beside that of a run at the end of a step: in the equilibrium of heat, and without what
!> only the run itself tells. Other contact states may satisfy all conditions, too: where the
!> conductance jumps as a gap closes, a contact point beside an edge may be closed, warm and
!> pressed, or open and cold: both are solutions on the mesh of the run, and its increments decide
!> which one it finds. The exact solution has one edge; so what these states differ by is an error
!> of the mesh.
module companion_states
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use contact_system, only: contact_open
   use controls, only: implicit_scheme, start_closed, start_open, start_type
   use errors, only: error_type
   use heat_reduction, only: heat_reduction_type
   use increment_data, only: trial_type
   use increment_solution, only: begin_increment, recover_fields, solve_points
   use interface_quantities, only: contacts_of_state, quantities_of
   use kinds, only: dp
   use model, only: model_type
   use records, only: contact_record_type
   use reduced_bodies, only: reduced_bodies_type
   use simulation, only: simulation_type
   use solution_state, only: solution_state_type
   use steps, only: solves_heat, step_type
   use temperature_laws, only: law_jumps
   implicit none
   private
   public :: find_other_states, implicit_state, implicit_step

   real(dp), parameter :: tolerance = 1.0e-6_dp   !! of the fixed point; errors are far larger

contains

   !> A step without other starts, the gain and the last digits.
   pure function implicit_step(step) result(companion)
      type(step_type), intent(in) :: step   !! the step of the run
      type(step_type) :: companion          !! the same, cheaper

      companion = step
      companion%start = start_type()
      companion%fixed_point%finds_gain = .false.
      companion%fixed_point%tolerance = max(tolerance, step%fixed_point%tolerance)
      companion%scheme = implicit_scheme
   end function implicit_step

   !> Solves the end of an increment, with all of its fields.
   !> Error: it has no solution.
   subroutine implicit_state(simulation, own, model, step, before, state, error)
      type(simulation_type), intent(in) :: simulation
      type(heat_reduction_type), intent(inout) :: own        !! where the run has other films
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step                    !! from implicit_step
      type(solution_state_type), intent(in) :: before        !! at the start of the increment
      type(solution_state_type), intent(inout) :: state      !! guess in, solution out
      type(error_type), allocatable, intent(out) :: error

      associate (bodies => simulation%bodies)
         if (simulation%heat_reductions(1)%serves(bodies, state%sources%film) .or. &
            .not. solves_heat(step%analysis)) then
            call solve_end(simulation%heat_reductions(1))
         else
            call own%share_order(simulation%heat_reductions(1), bodies)
            call own%reduce(model, bodies, state%sources%film, error)
            if (.not. allocated(error)) call solve_end(own)
         end if
      end associate
   contains
      subroutine solve_end(heat)
         type(heat_reduction_type), intent(in) :: heat
         type(trial_type) :: trial

         trial%next = state
         call begin_increment(simulation%bodies, step, before, trial)
         call solve_points(simulation%bodies, heat, simulation%loads, trial, error)
         if (.not. allocated(error)) call recover_fields(simulation%bodies, heat, &
            simulation%loads, before, trial)
         state = trial%next
      end subroutine solve_end
   end subroutine implicit_state

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
      real(dp) :: own(size(farthest, 1), size(farthest, 2)), other(size(farthest, 1))
      type(contact_record_type), allocatable :: contacts(:)
      integer :: i, k

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
            call contacts_of_state(bodies, state, contacts)
            do k = 1, size(contacts)
               other = quantities_of(contacts(k))
               where (.not. ieee_is_nan(other - own(:, k))) farthest(:, k) = merge(other, &
                  farthest(:, k), abs(other - own(:, k)) > abs(farthest(:, k) - own(:, k)))
            end do
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

end module companion_states
