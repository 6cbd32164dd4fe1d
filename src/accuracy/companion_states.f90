!> States beside that of a run at the end of a step: in the equilibrium of heat, and without what
!> only the run itself tells. Other contact states may satisfy all conditions, too: where the
!> conductance jumps as a gap closes, a contact point beside an edge may be closed, warm and
!> pressed, or open and cold: both are solutions on the mesh of the run, and its increments decide
!> which one it finds. The exact solution has one edge; so what these states differ by is an error
!> of the mesh.
module companion_states
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use contact_quantities, only: estimated_values
   use contact_system, only: contact_open
   use controls, only: implicit_scheme, start_closed, start_open, start_type
   use errors, only: error_type
   use heat_reduction, only: heat_reduction_type
   use increment_data, only: trial_type
   use increment_solution, only: begin_increment, recover_fields, solve_points
   use increment_records, only: contacts_of_state
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
   public :: find_other_states, implicit_state

   real(dp), parameter :: tolerance = 1.0e-6_dp   !! of the fixed point; errors are far larger

contains

   !> Solves the end of an increment, with all of its fields, without the gain and the last digits.
   !> Error: it has no solution.
   subroutine implicit_state(simulation, model, asked, before, state, error)
      type(simulation_type), intent(in) :: simulation
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: asked                   !! the step of the run, another start
      type(solution_state_type), intent(in) :: before        !! at the start of the increment
      type(solution_state_type), intent(inout) :: state      !! guess in, solution out
      type(error_type), allocatable, intent(out) :: error
      type(heat_reduction_type) :: own                       ! where the run has other films
      type(step_type) :: step

      step = asked
      step%fixed_point%finds_gain = .false.
      step%fixed_point%tolerance = max(tolerance, asked%fixed_point%tolerance)
      step%scheme = implicit_scheme
      associate (bodies => simulation%bodies)
         if (simulation%heat_reductions(1)%serves(bodies, state%sources%film) .or. &
            .not. solves_heat(step%analysis)) then
            call solve_end(simulation%heat_reductions(1))
         else
            own%forms_on_demand = simulation%heat_reductions(1)%forms_on_demand
            call own%share_order(simulation%heat_reductions(1), bodies)
            call own%reduce(model, bodies, state%sources%film, error)
            if (.not. allocated(error)) call solve_end(own)
            call own%release()
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
      type(solution_state_type) :: state
      type(step_type) :: from
      real(dp) :: own(size(farthest, 1), size(farthest, 2)), other(size(farthest, 1))
      type(contact_record_type), allocatable :: contacts(:)
      integer :: i, k

      own = farthest
      associate (bodies => simulation%bodies)
         if (.not. bodies%is_coupled .or. .not. any(law_jumps(bodies%laws%conductance))) return
         do i = 1, size(kinds)
            from = model%steps(step)
            from%start = start_type(kind=kinds(i))
            state = simulation%state
            call implicit_state(simulation, model, from, before, state, error)
            if (allocated(error)) cycle
            if (.not. is_beside(bodies, state%contact%contact_state, &
               simulation%state%contact%contact_state)) cycle
            call contacts_of_state(bodies, state, contacts)
            do k = 1, size(contacts)
               other = estimated_values(contacts(k))
               where (.not. ieee_is_nan(other - own(:, k))) farthest(:, k) = merge(other, &
                  farthest(:, k), abs(other - own(:, k)) > abs(farthest(:, k) - own(:, k)))
            end do
         end do
      end associate
   end subroutine find_other_states

   !> Whether two contact states differ, and by no more than one contact point at each edge.
   pure logical function is_beside(bodies, one, other)
      type(reduced_bodies_type), intent(in) :: bodies
      integer, intent(in) :: one(:), other(:)       ! (m) open, slip or stick
      logical, dimension(size(one)) :: differs, is_open
      integer, allocatable :: beside(:)
      integer :: first, i, k

      is_open = one == contact_open
      differs = is_open .neqv. other == contact_open
      is_beside = any(differs)
      do i = 1, size(bodies%interfaces)
         first = bodies%points%interface_start(i)
         do k = first, bodies%points%interface_start(i + 1) - 1
            if (.not. differs(k)) cycle
            beside = first - 1 + bodies%interfaces(i)%beside(k - first + 1)
            is_beside = is_beside .and. any(is_open(beside) .neqv. is_open(k)) .and. &
               .not. any(differs(beside))
         end do
      end do
   end function is_beside

end module companion_states
