!> The fixed-point iteration omega = U(omega) of an increment, section 4, from one start or another.
!>
!> Contact points may rest: gamma = p = 0 with a conductance between the values of a law that jumps
!> there. Without them some increments have no solution, (1.8) asking for a law without a jump.
module increment_iteration
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use contact_heat, only: at_own_temperatures, derivative_by_temperature, find_edge_loads, &
      jump_derivatives, jump_derivatives_type
   use contact_operator, only: contact_operator_pass, load_derivative, opening_derivative, &
      openings, residual_floor
   use contact_system, only: closing_law_type, contact_open, contact_slip, contact_state_type
   use controls, only: fixed_point_type, method_anderson, method_newton, method_picard, &
      method_zaitsev
   use edge_heat, only: edge_heat_at, edge_heat_type, find_edge_integrals
   use errors, only: error_type, set_error, status_no_convergence
   use fixed_point, only: accelerator_type, anderson_type, pass_type, picard_type, point_residual, &
      zaitsev_type
   use heat_reduction, only: heat_reduction_type
   use increment_data, only: contact_scales_type, increment_data_type, increment_workspace_type, &
      trial_type
   use interruption, only: check_overdue
   use kinds, only: dp
   use newton, only: newton_type
   use newton_products, only: find_newton_step
   use reduced_bodies, only: reduced_bodies_type
   use solution_report, only: iteration_record_type, solution_report_type
   use solution_state, only: solution_state_type
   use text, only: append, counted, to_text
   implicit none
   private
   public :: iterate, make_accelerator, pass_on_branch

   integer, parameter :: most_turns = 4  !! openings and closings of a contact point whose law jumps
   integer, parameter :: on_path = 10     !! passes with a path, over those of the method itself
   real(dp), parameter :: no_strain = 1.0_dp  !! thermal strain that is none of the small ones
   integer, parameter :: most_away = 5    !! passes with larger ones after which a method is lost
   !> Part of a residual that the next pass leaves, above which steps follow how edges move.
   real(dp), parameter :: slow = 0.05_dp
   integer, parameter :: fewest_steps = 20   !! passes of Newton's method before another is tried

   !> Part of the pressure that the overlap of a whole displacement would make, below which none
   !> counts as the largest of an increment.
   real(dp), parameter :: least_pressure = 1.0e-6_dp

   !> Part of the largest length that a gap counts by: what is left of one is closed in the end, and
   !> takes force.
   real(dp), parameter :: least_gap = 1.0e-5_dp

contains

   !> Conductances, jumps and contact state of an increment. If heat is integrated to an edge of
   !> contact and its position does not converge, as when it jumps back and forth over a contact
   !> point, heat crosses whole sides. Where another method fails, Newton's solves the increment if
   !> laws jump, since the others know no contact points at rest; elsewhere it only tells what the
   !> failure means.
   !> Errors: no convergence of the fixed point or of the contact zones, unconstrained bodies;
   !> status_interrupted where a signal left no more time.
   subroutine iterate(bodies, heat, trial, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(trial_type), intent(inout) :: trial   !! loaded, omega*^0 and guess in; last pass out
      type(error_type), allocatable, intent(out) :: error
      type(contact_state_type) :: guess
      type(fixed_point_type) :: first
      real(dp) :: omega_start(size(trial%next%omega))
      integer :: before
      logical :: is_near

      associate (controls => trial%data%fixed_point, workspace => trial%workspace, &
         next => trial%next)
         allocate (workspace%record%iterations(0))
         next%edge = edge_heat_type()
         guess = next%contact
         omega_start = next%omega
         ! A derivative of divided bodies costs a solution for each contact point: it is formed only
         ! where it is needed.
         first = controls
         if (heat%is_divided(bodies) .and. controls%method == method_newton) first = &
            with_method(controls, method_anderson)
         ! On faces placed anew the solution before is near, and whole steps lead on from it.
         is_near = allocated(trial%data%closing_start) .and. &
            any(first%method == [method_anderson, method_zaitsev])
         if (is_near) first%g = 1.0_dp
         do while (workspace%resolves_edge .or. first%method /= controls%method .or. is_near)
            call use_method(bodies, heat, first, trial, error)
            if (.not. allocated(error)) return
            if (error%status /= status_no_convergence) return
            call start_again()
            if (.not. workspace%resolves_edge) exit
            call append(workspace%record%notes, 'the position of the edge of contact in its '// &
               'element side does not converge; in this increment heat crosses the undivided side')
            workspace%resolves_edge = .false.
            workspace%edge = edge_heat_type()
         end do
         before = size(workspace%record%iterations)
         call use_method(bodies, heat, controls, trial, error)
         if (allocated(error) .and. size(workspace%record%iterations) == before) then
            ! Not even contact zones were found from the start: those of the last increment may be.
            next%contact = guess
            next%omega = trial%data%equation%omega_old
            call use_method(bodies, heat, controls, trial, error)
         end if
         if (.not. allocated(error)) return
         if (error%status /= status_no_convergence) return
         ! Newton's method needs the loads of all jumps.
         if (heat%is_on_demand(bodies) .and. .not. heat%is_divided(bodies)) return
         if (controls%method /= method_newton) then
            if (any(workspace%pass%graph%width > 0.0_dp)) then
               call append(workspace%record%notes, &
                  'the method of the deck finds no state for a contact point whose conductance '// &
                  'jumps; NEWTON solves this increment')
               call start_again()
               call use_method(bodies, heat, with_method(controls, method_newton), trial, error)
               if (.not. allocated(error)) return
            else if (.not. (runs_away(bodies, next%jump) .or. workspace%contact%driven)) then
               call start_again()
               call explain_failure(bodies, heat, trial, error)
               return
            end if
         end if
         call name_runaway(bodies, next%jump, workspace%record, error)
      end associate
   contains
      !> Contact and conductances as at the start; passes read nothing else of the state.
      subroutine start_again()
         trial%next%contact = guess
         trial%next%omega = omega_start
      end subroutine start_again
   end subroutine iterate

   !> The controls with another method.
   pure function with_method(controls, method)
      type(fixed_point_type), intent(in) :: controls
      integer, intent(in) :: method            ! one of the method_* constants
      type(fixed_point_type) :: with_method

      with_method = controls
      with_method%method = method
   end function with_method

   !> Says of an increment in which another method failed what Newton's finds in it: a solution, or
   !> that the heat runs away.
   subroutine explain_failure(bodies, heat, trial, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(trial_type), intent(inout) :: trial     !! at its start again; keeps the record it has
      type(error_type), intent(inout) :: error
      type(solution_report_type) :: record
      type(error_type), allocatable :: other_error

      record = trial%workspace%record
      call use_method(bodies, heat, with_method(trial%data%fixed_point, &
         method_newton), trial, other_error)
      trial%workspace%record = record
      trial%workspace%contact%driven = .false.
      if (allocated(other_error)) then
         call name_runaway(bodies, trial%next%jump, trial%workspace%record, error)
      else
         error%message = error%message//'; *FIXED POINT, METHOD=NEWTON solves it'
      end if
   end subroutine explain_failure

   !> Whether the temperature jumps of a pass strain a body beyond all small strains, if they are
   !> numbers at all.
   pure logical function runs_away(bodies, jump)
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: jump(:)

      runs_away = .false.
      if (bodies%largest_expansion <= 0.0_dp) return
      runs_away = .not. all(ieee_is_finite(jump))
      if (.not. runs_away) runs_away = any(abs(jump)*bodies%largest_expansion > no_strain)
   end function runs_away

   !> Names the interface with the largest jump, in place of an error, where the heat runs away.
   subroutine name_runaway(bodies, jump, record, error)
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: jump(:)
      type(solution_report_type), intent(inout) :: record
      type(error_type), intent(inout) :: error
      integer :: k

      if (.not. runs_away(bodies, jump)) return
      k = findloc(ieee_is_finite(jump), .false., dim=1)
      if (k == 0) k = maxloc(abs(jump), dim=1)
      record%runaway = 'thermal runaway in contact pair '// &
         bodies%interfaces(bodies%points%interface(k))%name//': the heat that crosses its gap '// &
         'widens it, and the wider gap needs hotter bodies, without limit (thermal strains '// &
         'above 1); a steady state needs less heat, a smaller gap or better conduction'
      error%message = record%runaway
   end subroutine name_runaway

   !> The iteration by one method.
   subroutine use_method(bodies, heat, controls, trial, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(fixed_point_type), intent(in) :: controls
      type(trial_type), intent(inout) :: trial
      type(error_type), allocatable, intent(out) :: error
      class(accelerator_type), allocatable :: accelerator
      type(iteration_record_type), allocatable :: passes(:)
      type(contact_state_type) :: good
      integer :: turns(size(trial%next%omega)), away, i
      logical :: follows_edges
      real(dp) :: wanted

      turns = 0
      away = 0
      follows_edges = .false.
      wanted = controls%tolerance
      allocate (passes(0))
      call begin_passes(bodies, trial%data, trial%next%omega, trial%workspace)
      call make_accelerator(controls, size(turns), accelerator)
      associate (data => trial%data, workspace => trial%workspace, next => trial%next, &
         pass => trial%workspace%pass, record => trial%workspace%record)
         do i = 1, huge(i) - 1
            if ((i - 1)/merge(on_path, 1, accelerator%follows_path) >= controls%max_iterations) exit
            ! Where the edge goes over a contact point U jumps, and there is no path.
            if (workspace%resolves_edge .and. accelerator%follows_path) exit
            call check_overdue(error)
            if (allocated(error)) exit
            good = next%contact
            pass%iteration = i
            if (workspace%resolves_edge) then
               if (allocated(pass%coordinate)) call find_edge_integrals(bodies, &
                  pass%graph%modulus, pass%graph%opening(pass%coordinate), workspace%edge_integrals)
               workspace%edge = edge_heat_at(workspace%edge_integrals, bodies%points%weight, &
                  pass%omega)
            end if
            call contact_operator_pass(bodies, heat, data, workspace, next%jump, next%contact, &
               error)
            passes = [passes, iteration_record_type(increment=record%increment, &
               iteration=size(record%iterations) + i, residual=real(huge(1.0), dp), &
               g_min=minval(accelerator%g), g_max=maxval(accelerator%g), g_kept=accelerator%kept, &
               pairs_changed=count(next%contact%contact_state /= good%contact_state))]
            pass%found = .not. allocated(error)
            if (.not. pass%found) then
               if (accelerator%retreats) call accelerator%next(pass)
               if (.not. accelerator%retreats) exit
               deallocate (error)
               next%contact = good
               cycle
            end if
            call measure_pass(bodies, data, workspace, next, passes(i)%residual)
            wanted = max(controls%tolerance, record%residual_floor)
            ! Newton's next pass has the edges of its coordinates.
            if (workspace%resolves_edge .and. (controls%method /= method_newton .or. &
               passes(i)%residual <= wanted)) call measure_edges(bodies, workspace, &
               passes(i)%residual)
            if (passes(i)%residual <= wanted) exit
            away = merge(away + 1, 0, runs_away(bodies, next%jump))
            pass%is_lost = away >= most_away
            if (pass%is_lost) then
               if (accelerator%follows_path .or. controls%method /= method_newton) exit
               away = 0   ! from here on by a path
            end if
            where ((next%contact%contact_state == contact_open) .neqv. &
               (good%contact_state == contact_open)) turns = turns + 1
            if (controls%method /= method_newton .and. any(turns > most_turns .and. &
               pass%graph%width > 0.0_dp)) exit
            if (i > 2) follows_edges = follows_edges .or. passes(i)%residual > slow* &
               passes(i - 1)%residual
            call take_step(bodies, heat, trial, follows_edges, accelerator)
         end do
         call close_passes(record, passes, i, wanted, error)
      end associate
      if (.not. allocated(error)) call settle(trial%next%resting, trial%next%contact)
   end subroutine use_method

   !> Starts passes from omega*^0 without anything that passes of another method left.
   pure subroutine begin_passes(bodies, data, omega, workspace)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_data_type), intent(in) :: data
      real(dp), intent(in) :: omega(:)                           ! (m) omega*^0
      type(increment_workspace_type), intent(inout) :: workspace

      workspace%contact%closing = closing_law_type()
      if (allocated(data%closing_start)) workspace%contact%closing = data%closing_start
      if (allocated(workspace%pass%coordinate)) deallocate (workspace%pass%coordinate)
      workspace%pass%omega = omega
      workspace%pass%image = omega
      if (workspace%resolves_edge) call find_edge_integrals(bodies, workspace%pass%graph%modulus, &
         openings(bodies, workspace%pass%graph, data%previous), workspace%edge_integrals)
   end subroutine begin_passes

   !> Findings of a pass: solution so far, openings, points at rest, residual and its floor.
   subroutine measure_pass(bodies, data, workspace, next, residual)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_data_type), intent(in) :: data
      type(increment_workspace_type), intent(inout) :: workspace
      type(solution_state_type), intent(inout) :: next
      real(dp), intent(out) :: residual

      workspace%pass%opening = openings(bodies, workspace%pass%graph, next%contact)
      call find_residual(data%scales, bodies%points%weight, workspace%pass, residual, next%resting)
      next%omega = merge(workspace%pass%omega, workspace%pass%image, bodies%points%weight > 0.0_dp)
      next%edge = workspace%edge
      workspace%record%residual_floor = residual_floor(bodies, data, workspace%pass, next%contact)
   end subroutine measure_pass

   !> The residual with how far edges of contact are from those that a pass found.
   subroutine measure_edges(bodies, workspace, residual)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_workspace_type), intent(inout) :: workspace
      real(dp), intent(inout) :: residual

      type(edge_heat_type) :: found
      logical :: is_same

      call find_edge_integrals(bodies, workspace%pass%graph%modulus, workspace%pass%opening, &
         workspace%edge_integrals)
      found = edge_heat_at(workspace%edge_integrals, bodies%points%weight, workspace%pass%image)
      associate (given => workspace%edge)
         is_same = size(found%point) == size(given%point)
         if (is_same) is_same = all(found%point == given%point)
         if (is_same) then
            residual = maxval([residual, point_residual(given%conductance, found%conductance)])
         else
            residual = max(residual, 1.0_dp)
         end if
      end associate
   end subroutine measure_edges

   !> Keeps the passes, and says so where the last one is not good enough.
   subroutine close_passes(record, passes, last, wanted, error)
      type(solution_report_type), intent(inout) :: record
      type(iteration_record_type), intent(in) :: passes(:)
      integer, intent(in) :: last   !! the loop's, beyond the last pass where that was not enough
      real(dp), intent(in) :: wanted
      type(error_type), allocatable, intent(inout) :: error
      integer :: n

      n = min(last, size(passes))
      if (allocated(error)) n = last - 1
      record%iterations = [record%iterations, passes(:n)]
      if (allocated(error) .or. n == 0) return
      if (passes(n)%residual <= wanted) return
      call set_error(error, status_no_convergence, 'the conductance does not converge in '// &
         counted(n, 'iteration')//'; last residual '//to_text(passes(n)%residual)//', required '// &
         to_text(wanted))
   end subroutine close_passes

   !> The next omega*, from the derivative of the pass where the accelerator asks for it.
   subroutine take_step(bodies, heat, trial, follows_edges, accelerator)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(trial_type), intent(inout) :: trial
      logical, intent(in) :: follows_edges   ! whether the derivative has the edges of contact
      class(accelerator_type), intent(inout) :: accelerator

      associate (pass => trial%workspace%pass)
         if (allocated(pass%derivative)) deallocate (pass%derivative)
         if (allocated(pass%step)) deallocate (pass%step)
         if (allocated(pass%path_step)) deallocate (pass%path_step)
         if (accelerator%asks_derivative(pass)) then
            if (heat%schur%is_sparse()) then
               select type (accelerator)
               type is (newton_type)
                  call accelerator%prepare_step(pass)
               end select
               call find_newton_step(bodies, heat, trial, follows_edges)
            else
               call find_derivative(bodies, heat, trial, follows_edges)
            end if
         end if
         call accelerator%next(pass)
         trial%next%omega = pass%omega
      end associate
   end subroutine take_step

   !> Derivative of the openings that the last pass found by the conductances.
   subroutine find_derivative(bodies, heat, trial, follows_edges)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(trial_type), intent(inout) :: trial
      logical, intent(in) :: follows_edges   ! whether it has the edges of contact
      type(jump_derivatives_type) :: by_omega
      real(dp), allocatable :: load(:, :)

      associate (workspace => trial%workspace, next => trial%next, pass => trial%workspace%pass)
         call jump_derivatives(bodies, trial%data, workspace, next%jump, by_omega)
         if (follows_edges .and. allocated(workspace%edge%point)) then
            call find_edge_loads(bodies, trial%data, workspace, next%jump, by_omega%at_edge, load)
            call workspace%tail%solve_columns(load)
            by_omega%of_tail = reshape([by_omega%of_tail, load], [size(load, 1), &
               size(by_omega%of_tail, 2) + size(load, 2)])
         end if
         call opening_derivative(bodies, heat, workspace, by_omega, next%contact, &
            pass%derivative, pass%body)
         if (bodies%points%vary_with_temperature() .and. allocated(pass%derivative)) then
            call at_own_temperatures(derivative_by_temperature(bodies, heat, workspace, &
               pass%coordinates(), by_omega), pass%derivative)
         end if
      end associate
   end subroutine find_derivative

   !> One pass at coordinates of a branch, workspace%pass%coordinate, with its derivatives; they are
   !> unallocated where they do not exist.
   !> Errors: as contact_operator_pass.
   subroutine pass_on_branch(bodies, heat, trial, residual, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(trial_type), intent(inout) :: trial   !! loaded, graphs, coordinates, contact guess in
      real(dp), intent(out) :: residual          !! over the one wanted
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: coordinate(:)

      associate (data => trial%data, workspace => trial%workspace, next => trial%next)
         coordinate = workspace%pass%coordinate
         call begin_passes(bodies, data, workspace%pass%graph%omega(coordinate), workspace)
         workspace%pass%coordinate = coordinate
         call contact_operator_pass(bodies, heat, data, workspace, next%jump, next%contact, error)
         if (allocated(error)) return
         call measure_pass(bodies, data, workspace, next, residual)
         residual = residual/max(data%fixed_point%tolerance, workspace%record%residual_floor)
         call find_derivative(bodies, heat, trial, .false.)
         if (allocated(workspace%pass%derivative)) call load_derivative(bodies, heat, data, &
            next%contact, workspace)
      end associate
   end subroutine pass_on_branch

   !> The accelerator that the deck asks for.
   subroutine make_accelerator(controls, points, accelerator)
      type(fixed_point_type), intent(in) :: controls
      integer, intent(in) :: points                                !! m, number of contact points
      class(accelerator_type), allocatable, intent(out) :: accelerator    !! fresh memory

      select case (controls%method)
      case (method_picard)
         allocate (picard_type :: accelerator)
         allocate (accelerator%g(points), source=1.0_dp)
      case (method_zaitsev)
         allocate (accelerator, source=zaitsev_type(constant_iterations=controls%constant))
         allocate (accelerator%g(points), source=controls%g)
      case (method_anderson)
         allocate (anderson_type :: accelerator)
         allocate (accelerator%g(points), source=controls%g)
      case default
         allocate (accelerator, source=newton_type(retreats=.true., &
            most_steps=max(controls%max_iterations, fewest_steps)))
         allocate (accelerator%g(points), source=1.0_dp)
      end select
   end subroutine make_accelerator

   !> Largest residual of a pass over the contact points that carry heat, which those of weight 0 do
   !> not, and the contact points that rest in it: a conductance between the two
   !> values of its law needs no more of a contact point than that neither gap nor pressure is left.
   pure subroutine find_residual(scales, weight, pass, residual, resting)
      type(contact_scales_type), intent(in) :: scales       !! largest values of the increment
      real(dp), intent(in) :: weight(:)                     !! (m) tributary areas [length^2]
      type(pass_type), intent(in) :: pass
      real(dp), intent(out) :: residual                     !! relative
      logical, intent(out) :: resting(:)                    !! (m) contact points that rest
      real(dp), dimension(size(weight)) :: by_law, by_rest, pressure
      real(dp) :: largest

      by_law = 0.0_dp
      where (weight > 0.0_dp) by_law = point_residual(pass%omega, pass%image)
      resting = pass%graph%may_rest(pass%omega)
      if (any(resting)) then
         associate (modulus => pass%graph%modulus)
            pressure = modulus*max(-pass%opening, 0.0_dp)
            largest = max(maxval(pressure), scales%force/max(maxval(weight), tiny(1.0_dp)))
            by_rest = max(pass%opening, 0.0_dp)/max(least_gap*scales%length, largest/modulus) + &
               pressure/max(largest, least_pressure*modulus*scales%length)
         end associate
         resting = resting .and. by_rest < by_law
         where (resting) by_law = by_rest
      end if
      residual = maxval(by_law)
   end subroutine find_residual

   !> Leaves nothing of gap, pressure and shear at contact points that rest; they count as closed.
   pure subroutine settle(resting, state)
      logical, intent(in) :: resting(:)                  !! (m) contact points that rest
      type(contact_state_type), intent(inout) :: state

      where (resting .and. state%contact_state == contact_open) state%reference = state%tangential
      where (resting)
         state%contact_state = contact_slip
         state%direction = 0
         state%gap = 0.0_dp
         state%force = 0.0_dp
         state%shear_force = 0.0_dp
      end where
   end subroutine settle

end module increment_iteration
