!> A deck beside itself on a mesh some or all of whose elements are divided into four.
!>
!> Either the last increment of each step is solved there, from the displacements and temperatures
!> that the run had before it (ERRORS=LAST), or the whole deck is followed with all elements divided
!> and two increments for each of the run (ERRORS=FULL). Contact points, operators and reduction of
!> the divided mesh are its own; nothing that the run reads is written.
module divided_mesh
   use companion_states, only: implicit_state
   use connections, only: connections_type
   use contact_system, only: contact_open
   use controls, only: default_solver, method_anderson, start_type
   use equations, only: equation_nodes
   use errors, only: error_type
   use field_recovery, only: error_record_type
   use heat_equation, only: heat_across
   use increment_records, only: contacts_of_state
   use increments, only: advance
   use kinds, only: dp
   use load_histories, only: end_of_step
   use local_refinement, only: choose_neighbours, elements_about, elements_at_surfaces, &
      largest_part
   use mesh_division, only: divide, division_type
   use model, only: model_type, uncertainty_no
   use records, only: field_record_type, increment_record_type
   use reduced_bodies, only: reduced_bodies_type
   use refinement, only: divide_model, parents_of
   use restarts, only: bring_to, exchange_run
   use solution_state, only: solution_state_type
   use state_tables, only: state_table_type
   use steps, only: boundary_type, dof_temperature, solves_mechanics, step_type
   use simulation, only: make_initial_state, simulation_type
   implicit none
   private
   public :: divided_mesh_type

   !> Part of the heat that crosses all contact points which the elements divided for it carry
   real(dp), parameter :: of_heat = 0.99_dp

   !> The divided model and its run.
   type :: divided_mesh_type
      type(model_type) :: model                         !! the divided one
      type(division_type) :: division
      !> Its increment to the end of the run's, with its interfaces, displacements, temperatures and
      !> stress where that is due; of an end of a step no more than these
      type(increment_record_type) :: record
      !> Freed by release. Held by value, its copying, which nothing calls, would be most of the
      !> code of this module and of those that hold a divided mesh
      type(simulation_type), pointer :: run => null()
   contains
      procedure :: solve_end
      procedure :: begin
      procedure :: follow
      procedure :: exchange
      procedure :: release
   end type divided_mesh_type

contains

   !> Solves the end of the run's step in the equilibrium of heat, with the elements divided that
   !> are closed or conduct most of the heat, and some more. Anderson's method solves the increment
   !> without the loads of all jumps; where it fails, that of the deck does with them.
   !> Errors: as reduced_bodies' prepare and reduce, or the increment has no solution.
   subroutine solve_end(self, simulation, model, also, near, previous, error)
      class(divided_mesh_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation     !! the run at the end
      type(model_type), intent(in) :: model
      logical, intent(in) :: also(:)                      !! (elements) that are divided besides
      logical, intent(in) :: near(:)                      !! (elements) whose stress counts
      type(solution_state_type), intent(in) :: previous   !! state before the last increment
      type(error_type), allocatable, intent(out) :: error
      type(solution_state_type) :: before, guess, next
      type(step_type) :: step

      call divide_at_contact(self, simulation, model, also, error)
      if (allocated(error)) return
      associate (run => self%run, number => simulation%control%step)
         call enter_step(self, number)
         if (self%model%solver == model%solver) call order_as_run(self, simulation%bodies)
         call run%reduce(self%model, error)
         if (allocated(error)) return
         call run%loads%move_to(end_of_step(self%model%steps, number), self%model)
         before = prolonged(self, simulation%bodies%points, previous)
         guess = before
         guess%increment_size = simulation%state%increment_size
         guess%sources%load = run%loads%heat_load()
         guess%sources%film = run%loads%film_matrix()
         guess%force_load = run%loads%nodal_forces()
         do
            step = self%model%steps(number)
            step%start = start_type()
            if (run%heat_reductions(1)%forms_on_demand) step%fixed_point%method = method_anderson
            next = guess
            call implicit_state(run, self%model, step, before, next, error)
            if (.not. (allocated(error) .and. run%heat_reductions(1)%forms_on_demand .and. &
               run%bodies%is_coupled)) exit
            run%heat_reductions(1)%forms_on_demand = .false.
            call run%reduce(self%model, error)
            if (allocated(error)) exit
         end do
         if (allocated(error)) return
         call contacts_of_state(run%bodies, next, self%record%contacts)
         self%record%fields = field_record_type(temperature=next%temperature)
         call run%recovery%prepare(self%model, near(parents_of(self%division)))
         if (next%has_mechanics) self%record%fields%displacement = reshape(next%displacement, &
            [2, size(next%temperature)])
         call recover_stress(self, next)
      end associate
   end subroutine solve_end

   !> Begins to follow a run from its start, with all elements divided and increments that are not
   !> made for their own errors.
   !> Errors: as simulation_type's start.
   subroutine begin(self, model, error)
      class(divided_mesh_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      integer :: s

      call divide_elements(self, model, spread(.true., 1, size(model%mesh%element_kind)))
      self%model%uncertainty = uncertainty_no
      self%model%verifications = self%model%verifications(:0)
      do s = 1, size(self%model%steps)
         associate (step => self%model%steps(s))
            step%first_increment = 0.5_dp*step%first_increment
            step%smallest_increment = 0.5_dp*step%smallest_increment
            step%max_increments = huge(1)
            step%local_error = huge(1.0_dp)
            step%largest_change = huge(1.0_dp)
            step%field_frequency = 0
            step%restart_frequency = 0
            step%stability_frequency = 0
            if (allocated(step%field_points%times)) deallocate (step%field_points%times)
            if (allocated(step%element_prints)) deallocate (step%element_prints)
         end associate
      end do
      call self%run%start(self%model, error)
   end subroutine begin

   !> Follows the run to the end of its increment.
   !> Error: as advance of increments.
   subroutine follow(self, simulation, record, error)
      class(divided_mesh_type), intent(inout) :: self        !! begun
      type(simulation_type), intent(in) :: simulation        !! the run at that end
      type(increment_record_type), intent(in) :: record      !! of the increment
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: half

      associate (run => self%run, goal => simulation%control)
         if (run%control%step < goal%step) call run%enter_step(self%model)
         half = 0.5_dp*(goal%step_time - run%control%step_time)
         do while (run%control%step_time < goal%step_time - goal%spacing)
            run%control%landings = [run%control%landings, goal%step_time]
            run%control%largest = half
            call advance(run, self%model, self%record, error)
            if (allocated(error)) return
         end do
         if (allocated(record%fields%stress) .and. .not. allocated(self%record%fields%stress)) then
            call recover_stress(self, run%state)
         end if
      end associate
   end subroutine follow

   !> Where the run that follows stands, in either direction.
   !> Errors: as simulation_type's reduce.
   subroutine exchange(self, table, error)
      class(divided_mesh_type), intent(inout) :: self        !! begun
      type(state_table_type), intent(inout) :: table
      type(error_type), allocatable, intent(out) :: error

      table%prefix = 'finer_'
      if (table%restores) then
         call bring_to(self%model, self%run, table, error)
      else
         call exchange_run(self%run, table)
      end if
      table%prefix = ''
   end subroutine exchange

   !> Frees the run with its factors.
   subroutine release(self)
      class(divided_mesh_type), intent(inout) :: self

      if (.not. associated(self%run)) return
      call self%run%release()
      deallocate (self%run)
   end subroutine release

   !> Stress of a state, and its inelastic strains, where mechanics is solved.
   subroutine recover_stress(self, state)
      type(divided_mesh_type), intent(inout) :: self
      type(solution_state_type), intent(in) :: state
      type(error_record_type) :: estimate

      if (allocated(state%stress_temperature)) call self%run%recovery%recover_stress(self%model, &
         reshape(state%displacement, [2, size(state%temperature)]), state%stress_temperature - &
         self%model%initial_temperature, state%history, self%record%fields%stress, estimate)
      if (allocated(state%history)) call self%run%recovery%recover_strains(self%model, &
         state%history, self%record%fields%inelastic_strain)
   end subroutine recover_stress

   !> Divides the elements at the contact, at ties and some more, and prepares what solving ends of
   !> steps takes of a run, unless that is done.
   !> Errors: as reduced_bodies' prepare.
   subroutine divide_at_contact(self, simulation, model, also, error)
      type(divided_mesh_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(model_type), intent(in) :: model
      logical, intent(in) :: also(:)                      ! (elements)
      type(error_type), allocatable, intent(out) :: error
      logical :: chosen(size(model%mesh%element_number))
      integer, allocatable :: counted(:)
      integer :: k

      chosen = elements_at_surfaces(model%mesh, [model%contacts%slave, model%contacts%master])
      ! Contact points that are closed, or with much heat; all of the faces where there is none.
      associate (points => simulation%bodies%points, state => simulation%state)
         counted = pack([(k, k=1, size(points%slave))], state%contact%contact_state /= &
            contact_open .or. largest_part(abs(heat_across(points%weight, &
            state%flux_conductance, state%jump)), of_heat))
         if (size(counted) > 0) chosen = chosen .and. elements_about(model%mesh, &
            [(points%nodes_of(counted(k)), k=1, size(counted))])
      end associate
      chosen = chosen .or. also .or. elements_at_surfaces(model%mesh, &
         [model%ties%faces%slave, model%ties%faces%master])
      call choose_neighbours(model, chosen)
      if (associated(self%run)) then
         if (all((self%division%rank > 0) .eqv. chosen)) return
      end if
      call self%release()
      call divide_elements(self, model, chosen)
      call self%run%bodies%prepare(self%model, error)
      if (allocated(error)) then
         call self%release()
         return
      end if
      self%run%heat_reductions(1)%forms_on_demand = .not. allocated(self%run%bodies%points%heated)
      call self%run%loads%prepare(self%model)
      self%run%state = make_initial_state(self%model, self%run%bodies)
   end subroutine divide_at_contact

   !> Makes the model with some elements divided, for a fresh run.
   subroutine divide_elements(self, model, chosen)
      type(divided_mesh_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      logical, intent(in) :: chosen(:)                    ! (elements) as choose_neighbours asks

      self%model = model
      self%division = divide(model%mesh, chosen)
      call divide_model(self%model, self%division)
      call hold_new_nodes(self%division, self%model)
      call keep_to_equations(self%division, self%model)
      if (model%has_solver_by_size) self%model%solver = default_solver( &
         real(self%division%nodes_after, dp), any(solves_mechanics(model%steps%analysis)))
      allocate (self%run)
   end subroutine divide_elements

   !> Prescribes what all nodes of a side or element have prescribed at the new nodes on it, too:
   !> the deck may name nodes one by one.
   subroutine hold_new_nodes(division, model)
      type(division_type), intent(in) :: division
      type(model_type), intent(inout) :: model            ! the divided one
      integer, parameter :: dofs(3) = [1, 2, dof_temperature]
      type(boundary_type), allocatable :: given(:)
      type(boundary_type) :: support
      integer, allocatable :: around(:)                   ! those of the nodes that a new one is of
      integer :: at(size(model%mesh%node_number)), d, first, i, last, node, s

      do s = 1, size(model%steps)
         given = model%steps(s)%boundaries
         do d = 1, size(dofs)
            at = 0
            do i = 1, size(given)
               if (given(i)%dof == dofs(d)) at(given(i)%node) = i
            end do
            do node = division%nodes + 1, division%nodes_after
               first = division%weights%row_start(node)
               last = division%weights%row_start(node + 1) - 1
               around = at(division%weights%column(first:last))
               if (at(node) > 0 .or. any(around == 0)) cycle
               support = given(around(1))
               if (any(given(around)%amplitude /= support%amplitude)) cycle
               support%node = node
               support%value = dot_product(division%weights%value(first:last), given(around)%value)
               model%steps(s)%boundaries = [model%steps(s)%boundaries, support]
            end do
         end do
      end do
   end subroutine hold_new_nodes

   !> Sides whose nodes the deck's equations name, but for such as supports hold, stay as they are,
   !> for these do not name the new nodes, which hang there and follow from the others. Couplings
   !> and axes include them.
   pure subroutine keep_to_equations(division, model)
      type(division_type), intent(in) :: division
      type(model_type), intent(inout) :: model            ! the divided one
      logical :: is_held(0:division%nodes), is_named(0:division%nodes)
      integer :: between(2), ends(3), s

      if (model%deck_equations == 0) return
      is_named(0) = .false.
      is_named(1:) = equation_nodes(model%equations(:model%deck_equations), division%nodes)
      is_held = .false.
      is_held(0) = .true.
      do s = 1, size(model%steps)
         associate (held => model%steps(s)%boundaries%node)
            is_held(pack(held, held <= division%nodes)) = .true.
         end associate
      end do
      do s = 1, division%sides%count
         ends = division%sides%ends(:, s)
         between = division%between(:, s)
         if (between(1) <= division%nodes .or. .not. all(is_named(ends) .or. is_held(ends))) cycle
         ! Beside a named end, a side that supports hold is another one.
         if (.not. (is_named(ends(2)) .or. ends(2) == 0 .and. any(is_named(ends)))) cycle
         if (any(model%mesh%hanging_sides([2, 4], :) == between(1))) cycle
         model%mesh%hanging_sides = reshape([model%mesh%hanging_sides, merge([ends, between], &
            [ends(1), between(1), ends(3), 0, 0], ends(2) > 0)], &
            [5, size(model%mesh%hanging_sides, 2) + 1])
      end do
   end subroutine keep_to_equations

   !> Orders unknowns as the run does. A new node comes with the first one of its side, or of its
   !> element if it lies inside: what it joins, that one joins already, so separators stay.
   subroutine order_as_run(self, bodies)
      type(divided_mesh_type), intent(inout) :: self
      type(reduced_bodies_type), intent(in) :: bodies      !! of the run
      integer :: node_rank(size(self%model%mesh%node_number))
      integer, allocatable :: nodes(:)
      integer :: i

      if (.not. allocated(bodies%equilibrium%rank)) return
      nodes = bodies%mechanical%map%leading_nodes()
      if (size(nodes) /= size(bodies%equilibrium%rank)) return
      node_rank = huge(1)
      node_rank(nodes) = bodies%equilibrium%rank
      associate (weights => self%division%weights)
         do i = self%division%nodes + 1, self%division%nodes_after
            node_rank(i) = minval(node_rank(weights%column(weights%row_start(i): &
               weights%row_start(i + 1) - 1)))
         end do
      end associate
      where (node_rank == huge(1)) node_rank = maxval([1, bodies%equilibrium%rank])
      call self%run%heat_reductions(1)%set_node_rank(self%run%bodies, node_rank)
   end subroutine order_as_run

   !> Enters a step as the run did. The run's state at the start of steps shows in loads that ramp
   !> from there only, and not at the end of a step.
   subroutine enter_step(self, step)
      type(divided_mesh_type), intent(inout) :: self
      integer, intent(in) :: step

      associate (run => self%run)
         do while (run%control%step < step)
            if (run%control%step > 0) call run%loads%move_to(end_of_step(self%model%steps, &
               run%control%step), self%model)
            ! The end of the step before, as far as loads tell.
            run%state%displacement = run%loads%displacement%value
            run%state%temperature = run%loads%temperature%value
            call run%enter_step(self%model)
         end do
      end associate
   end subroutine enter_step

   !> The state of the run on the divided mesh: fields, and contact states of the nearest contact
   !> points; friction counts from the relative displacements of the fields.
   function prolonged(self, points, state) result(divided)
      type(divided_mesh_type), intent(in) :: self
      type(connections_type), intent(in) :: points  !! of the run
      type(solution_state_type), intent(in) :: state
      type(solution_state_type) :: divided
      integer :: first, i, k, last, nearest(size(self%run%bodies%points%slave))

      divided = make_initial_state(self%model, self%run%bodies)
      ! Partners of new nodes with axes of their own come last; nothing is taken of what they have.
      associate (n => self%division%nodes_after)
         divided%temperature(:n) = self%division%prolong(state%temperature, 1)
         divided%displacement(:2*n) = self%division%prolong(state%displacement, 2)
      end associate
      if (.not. state%has_mechanics) return
      divided%has_mechanics = .true.
      divided%increment_size = state%increment_size
      associate (fine => self%run%bodies%points, contact => divided%contact, &
         x => self%model%mesh%coordinates)
         ! The nearest contact point of the run.
         do i = 1, size(fine%interface_start) - 1
            first = points%interface_start(i)
            last = points%interface_start(i + 1) - 1
            do k = fine%interface_start(i), fine%interface_start(i + 1) - 1
               nearest(k) = first - 1 + minloc(norm2(x(:, points%slave(first:last)) - &
                  spread(x(:, fine%slave(k)), 2, last - first + 1), dim=1), dim=1)
            end do
         end do
         contact%contact_state = state%contact%contact_state(nearest)
         contact%direction = state%contact%direction(nearest)
         associate (relative => fine%relative(divided%displacement))
            contact%tangential = sum(fine%tangent*relative, dim=1)
            contact%approach = sum(fine%normal*relative, dim=1)
         end associate
         contact%reference = contact%tangential
         contact%slip_origin = contact%tangential
         contact%gap = merge(0.0_dp, max(0.0_dp, self%run%loads%present_gaps(fine) - &
            self%run%bodies%laws%reach - contact%approach), contact%contact_state /= contact_open)
         divided%omega = state%omega(nearest)
         divided%omega_before = divided%omega
         divided%jump = fine%jumps(divided%temperature)
      end associate
   end function prolonged

end module divided_mesh
