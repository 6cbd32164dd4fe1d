!> A run: its reduced bodies, loads and state, and where it is in its steps.
module simulation
   use branch_trials, only: branch_type
   use clock, only: wall_seconds
   use contact_operator, only: law_conductance
   use contact_system, only: contact_open
   use controls, only: stage_part
   use discretisation_errors, only: recovery_type
   use errors, only: error_type, status_internal
   use field_problem, only: solved_loads_type
   use heat_equation, only: heat_equation_type
   use heat_reduction, only: heat_reduction_type
   use increment_control, only: increment_control_type
   use increment_data, only: increment_workspace_type
   use kinds, only: dp
   use load_histories, only: step_clock_type
   use loads, only: loads_type
   use point_histories, only: history_count
   use model, only: model_type
   use operator_corrections, only: corrections_type
   use reduced_bodies, only: reduced_bodies_type
   use run_sizes, only: measure_factors, measure_steps, run_seconds_type, run_size_type
   use solution_state, only: solution_state_type
   use sparse_matrix, only: sparse_matrix_type
   use steps, only: solves_heat, solves_mechanics
   use stiffness_matrix, only: assemble_initial_force
   implicit none
   private
   public :: simulation_type, point_fields_type, make_initial_state

   integer, parameter :: kept_reductions = 3     !! of heat, by films and increment sizes

   !> What the integration points of all elements have in a state, for the energies of bodies.
   type :: point_fields_type
      real(dp) :: energies(3) = 0.0_dp         !! stored, dissipated by plasticity and by creep
      real(dp), allocatable :: volume(:)       !! (points) that each stands for [length^3]
      real(dp), allocatable :: stress(:, :)    !! (4, points) [stress]
      real(dp), allocatable :: elastic(:, :)   !! (4, points) strain by the stress
      real(dp), allocatable :: free(:, :)      !! (4, points) strain by the temperature
   end type point_fields_type

   !> A run: the reduced bodies, the loads and the state, moved on by advance of increments.
   type :: simulation_type
      type(reduced_bodies_type) :: bodies   !! the bodies reduced to their contact unknowns
      !> Their heat likewise, for films and increment sizes; where no heat is stored the first alone
      type(heat_reduction_type) :: heat_reductions(kept_reductions)
      integer :: in_use = 1                 !! which of them the increment has
      type(recovery_type) :: recovery               !! stress and flux with their errors
      type(corrections_type) :: corrections         !! what bodies are beyond their operators
      type(loads_type) :: loads                     !! loads and supports
      type(solution_state_type) :: state            !! state at the end of the last increment
      !> What its solution left, where its stability is analysed
      type(increment_workspace_type), allocatable :: solved
      type(solved_loads_type), allocatable :: known(:)  !! loads of earlier increments, solved
      type(increment_control_type) :: control       !! position in the steps, size of increments
      type(branch_type) :: branch                   !! of *CONTINUATION of the step
      type(run_seconds_type) :: seconds             !! where the time went
      type(run_size_type) :: sizes                  !! sizes over all steps
      type(solution_state_type), allocatable :: cycle_before   !! at the end of the last cycle
      !> Of the state, where energies were measured; unallocated arrays where they were not
      type(point_fields_type) :: point_fields
      character(:), allocatable :: undecided        !! what was last warned of
      !> (m) contact points without a master when last looked at, and (2 interfaces) whether it was
      !> told that some left theirs, reached one; unallocated where no face slides
      logical, allocatable :: is_beyond(:), sliding_told(:)
      real(dp) :: pivot_told = 1.0_dp               !! smallest pivot that was warned of
      character(:), allocatable :: runaway          !! last thermal runaway of an attempt, in words
      real(dp) :: runaway_time = 0.0_dp             !! where this attempt would have ended [time]
   contains
      procedure :: start
      procedure :: enter_step
      procedure :: assemble
      procedure :: reduce
      procedure :: reduce_heat
      procedure :: take_back
      procedure :: place_faces
      procedure :: finished
      procedure :: release
   end type simulation_type

contains

   !> Prepares a run, sees whether its steps can all be numbered, and enters the first.
   !> Errors: as reduced_bodies' prepare and measure_steps.
   subroutine start(self, model, error)
      class(simulation_type), intent(inout) :: self       !! a fresh run
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: since

      since = wall_seconds()
      self%undecided = ''
      call self%bodies%prepare(model, error)
      if (allocated(error)) return
      call self%recovery%prepare(model, spread(.true., 1, size(model%mesh%element_kind)))
      call self%loads%prepare(model)
      self%state = make_initial_state(model, self%bodies)
      if (allocated(self%bodies%points%is_beyond)) then
         self%is_beyond = self%bodies%points%is_beyond
         allocate (self%sliding_told(2*size(model%contacts)), source=.false.)
      end if
      call self%corrections%prepare(model, self%state%forces_beyond)
      if (any(model%materials%law%annealing > 0)) call self%corrections%points%start_history( &
         model%mesh, model%initial_temperature, self%state%history)
      self%seconds%assemble = (wall_seconds() - since)
      call measure_steps(model, self%bodies%points, self%loads, self%state, self%sizes, error)
      if (.not. allocated(error)) call enter_step(self, model)
   end subroutine start

   !> Enters the next step.
   subroutine enter_step(self, model)
      class(simulation_type), intent(inout) :: self       !! the run, started
      type(model_type), intent(in) :: model
      type(branch_type) :: branch                         ! a new one

      call self%control%enter_step(model)
      branch%step = self%control%step
      branch%start = self%control%instant_at(model, 0.0_dp)
      branch%asked = model%steps(branch%step)%continuation
      self%branch = branch
      call self%loads%begin_step(model%steps(self%control%step), self%state%displacement, &
         self%state%temperature)
      call self%bodies%enter_step(model, self%control%step, self%loads)
   end subroutine enter_step

   !> Assembles the bodies, where that is not done.
   subroutine assemble(self, model)
      class(simulation_type), intent(inout) :: self       !! the run, started
      type(model_type), intent(in) :: model
      real(dp) :: since

      since = wall_seconds()
      call self%bodies%assemble_steps(model)
      self%seconds%assemble = self%seconds%assemble + (wall_seconds() - since)
   end subroutine assemble

   !> Assembles and reduces the bodies for the present step, where that is not done.
   !> Errors: as reduced_bodies' and heat_reduction's reduce.
   subroutine reduce(self, model, error)
      class(simulation_type), intent(inout) :: self       !! the run, started
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      type(heat_equation_type) :: equation
      type(sparse_matrix_type) :: film
      type(step_clock_type) :: clock
      real(dp) :: since

      call self%assemble(model)
      since = wall_seconds()
      associate (analysis => model%steps(self%control%step)%analysis, bodies => self%bodies, &
         heat => self%heat_reductions(self%in_use))
         film = heat%added
         if (solves_heat(analysis) .and. (heat%numbering /= bodies%thermal%numbering .or. &
            .not. (allocated(heat%solver) .or. heat%schur%is_sparse()))) then
            clock = self%control%next_instant(model)
            call self%loads%move_to(clock, model)
            equation = heat_equation_type(model%steps(self%control%step)%scheme, self%state%sources)
            equation%new%film = self%loads%film_matrix()
            associate (step => model%steps(self%control%step))
               if (step%is_transient) equation%duration = equation%scheme%a(1)* &
                  self%control%size_to(clock)*merge(stage_part, 1.0_dp, step%scheme%stages == 2)
            end associate
            film = equation%left_film(bodies%capacity)
         end if
         call heat%renumber_both(bodies)
         ! Both fields are eliminated while neither has factors, for their memory. Where a matrix is
         ! singular the factors fail, too, and say better why.
         if (solves_mechanics(analysis)) call bodies%equilibrium%renumber(bodies%mechanical)
         if (solves_heat(analysis)) call heat%eliminate(model, bodies, film, error)
         if (allocated(error)) then
            if (error%status == status_internal) return
            deallocate (error)
         end if
         if (solves_mechanics(analysis)) call bodies%reduce(model, heat%node_rank, error)
         if (solves_heat(analysis) .and. .not. allocated(error)) call heat%reduce(model, bodies, &
            film, error)
      end associate
      self%seconds%reduce = self%seconds%reduce + (wall_seconds() - since)
      call measure_factors(self%bodies, self%heat_reductions, self%sizes)
   end subroutine reduce

   !> Moves loads and operators from an attempt that is not accepted back to those of the last
   !> increment.
   !> Errors: as reduce.
   subroutine take_back(self, model, error)
      class(simulation_type), intent(inout) :: self       !! the run
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: at(:)                      ! (nodes) [temperature]

      if (allocated(self%state%wear)) call self%bodies%wear_to(self%state%wear)
      if (allocated(self%state%faces_at)) then
         call self%place_faces(model, self%state%faces_at, error)
         if (allocated(error)) return
      end if
      call self%loads%move_to(self%control%instant_at(model, self%control%step_time), model)
      if (.not. allocated(self%bodies%operators_at)) return
      at = model%initial_temperature
      if (allocated(self%state%operators_at)) at = self%state%operators_at
      if (self%bodies%has_operators_of(at, self%state%tangent)) return
      call self%bodies%move_operators(model, at, self%state%tangent)
      call self%reduce(model, error)
   end subroutine take_back

   !> Places the contact points of faces that slide, and reduces the bodies to them, where they do
   !> not lie there.
   !> Errors: as follow_faces and reduce.
   subroutine place_faces(self, model, displacement, error)
      class(simulation_type), intent(inout) :: self       !! the run, started
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: displacement(:)             !! (2 nodes) [length]
      type(error_type), allocatable, intent(out) :: error

      if (all(abs(displacement - self%bodies%faces_at) <= 0.0_dp)) return
      call self%bodies%follow_faces(model, self%control%step, displacement, error)
      if (.not. allocated(error)) call self%reduce(model, error)
   end subroutine place_faces

   !> Whether all steps are solved.
   pure function finished(self, model) result(done)
      class(simulation_type), intent(in) :: self   !! the run
      type(model_type), intent(in) :: model
      logical :: done                              !! nothing is left

      done = self%control%step == size(model%steps) .and. self%control%step_is_over(model)
   end function finished

   !> Reduces heat, unless a reduction of a former increment serves; a new one takes the place of
   !> the oldest.
   !> Errors: as heat_reduction's reduce.
   subroutine reduce_heat(self, model, film, error)
      class(simulation_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(sparse_matrix_type), intent(in) :: film          !! and C/(a1 dt), beside K
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      if (.not. self%heat_reductions(self%in_use)%serves(self%bodies, film)) then
         if (model%steps(self%control%step)%is_transient) then
            do i = 1, size(self%heat_reductions)
               if (self%heat_reductions(i)%serves(self%bodies, film)) exit
            end do
            if (i > size(self%heat_reductions)) then
               i = 1 + modulo(self%in_use, size(self%heat_reductions))
               call self%heat_reductions(i)%share_order(self%heat_reductions(self%in_use), &
                  self%bodies)
            end if
            self%in_use = i
         end if
         call self%heat_reductions(self%in_use)%reduce(model, self%bodies, film, error)
      end if
      if (.not. allocated(error)) call measure_factors(self%bodies, self%heat_reductions, &
         self%sizes)
   end subroutine reduce_heat

   !> Frees the factors.
   subroutine release(self)
      class(simulation_type), intent(inout) :: self   !! the run
      integer :: i

      call self%bodies%equilibrium%release()
      do i = 1, size(self%heat_reductions)
         call self%heat_reductions(i)%release()
      end do
   end subroutine release

   !> State before the first increment.
   pure function make_initial_state(model, bodies) result(state)
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies     !! the bodies, matched
      type(solution_state_type) :: state                          !! see above
      integer :: numbers

      associate (m => size(bodies%points%slave), n => size(model%mesh%node_number), &
         contact => state%contact)
         allocate (contact%contact_state(m), source=contact_open)
         allocate (contact%direction(m), source=0)
         allocate (contact%reference(m), contact%tangential(m), contact%slip_origin(m), &
            contact%force(m), contact%shear_force(m), source=0.0_dp)
         contact%gap = bodies%points%initial_gap - bodies%laws%reach
         state%smallest_gap = contact%gap
         allocate (state%resting(m), state%idle(m), source=.false.)
         state%jump = bodies%points%jumps(model%initial_temperature)
         state%omega = law_conductance(bodies, model%initial_temperature, state%jump, contact)
         state%omega_before = state%omega
         state%flux_conductance = state%omega
         allocate (state%displacement(2*n), state%sources%load(n), source=0.0_dp)
         state%temperature = model%initial_temperature
         if (allocated(model%mesh%initial_stress)) state%forces_beyond = assemble_initial_force( &
            model%mesh, model%sections)
         if (allocated(bodies%faces_at)) state%faces_at = bodies%faces_at
         if (allocated(bodies%worn)) state%wear = bodies%worn
         if (allocated(bodies%worn)) state%worn_volume = bodies%worn
         numbers = history_count(model%mesh, model%sections, model%materials)
         if (numbers > 0) allocate (state%history(numbers), source=0.0_dp)
      end associate
   end function make_initial_state

end module simulation
