!> Small motions of the temperatures about a state. With A the conduction of bodies, films and
!> contact at the conductances of the state, they follow
!>
!>    C dT/dt = -A T + F y,   y = N(T, dT/dt),
!>
!> y being the changes of the conductances, and of the heats that friction makes, at the contact
!> points whose changes carry heat; F has the nodal heats of unit changes, and N says how the
!> contact answers temperatures: with its strains, its gaps and pressures, and the laws. Open,
!> slipping and stuck contact points keep their states, points at rest their conductance.
module small_motions
   use closing_instant, only: contact_change_type, contact_response
   use conductance_graph, only: conductance_graph_type
   use contact_heat, only: changes_by_faces, temperature_jumps
   use contact_operator, only: make_graph, opening_changes, openings
   use contact_system, only: closing_law_type
   use contact_workspace, only: contact_workspace_type
   use controls, only: implicit_scheme
   use dense, only: tail_factors_type
   use errors, only: error_type
   use heat_equation, only: heat_across, heat_equation_type
   use heat_reduction, only: heat_reduction_type, loads_of_temperatures
   use increment_data, only: increment_data_type, increment_workspace_type
   use kinds, only: dp
   use model, only: model_type
   use reduced_bodies, only: reduced_bodies_type
   use solution_state, only: solution_state_type
   use sparse_matrix, only: linear_combination, sparse_matrix_type
   implicit none
   private
   public :: small_motion_type, shifted_conduction_type

   !> How the contact answers temperatures.
   type :: small_motion_type
      integer, allocatable :: active(:)        !! (a) contact points whose conductance counts
      integer :: heated = 0                    !! heats of friction behind these
      logical :: takes_rates = .false.         !! whether y depends on dT/dt: by slip that goes on
      real(dp), allocatable, private :: heat_rate(:)    !! (a) heat against the jump per conductance
      real(dp), allocatable, private :: coordinate(:)   !! (m) of the laws
      real(dp), allocatable, private :: slope(:)        !! (m) of omega by the opening
      type(contact_workspace_type), private :: tangent  !! factors of the contact states
      type(increment_workspace_type), private :: solved !! graphs, faces, heat of friction
   contains
      procedure :: begin
      procedure :: answers
      procedure :: heats
      procedure :: heat_loads
      procedure :: displacement
   end type small_motion_type

   !> A + sigma C, factored.
   type :: shifted_conduction_type
      type(heat_reduction_type) :: heat
      type(tail_factors_type) :: tail
   contains
      procedure :: factor
      procedure :: solve
      procedure :: responses
   end type shifted_conduction_type

contains

   !> Begins with the state that an increment found.
   !> Error: its contact system is singular.
   subroutine begin(self, bodies, state, heat, solved, error)
      class(small_motion_type), intent(out) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(solution_state_type), intent(in) :: state
      type(heat_reduction_type), intent(in) :: heat            !! of the increment
      type(increment_workspace_type), intent(in) :: solved     !! workspace that it left
      type(error_type), allocatable, intent(out) :: error
      type(conductance_graph_type), allocatable :: graph(:)
      real(dp) :: heat_rate(size(state%jump))
      integer :: k

      self%active = [integer ::]
      self%heat_rate = [real(dp) ::]
      self%tangent = solved%contact
      self%tangent%closing = closing_law_type()
      call self%tangent%factor_set(bodies%equilibrium%contact, state%contact, error)
      if (allocated(error) .or. .not. bodies%is_coupled) return
      self%solved%pass%graph = solved%pass%graph
      if (allocated(solved%faces)) self%solved%faces = solved%faces
      self%solved%friction = solved%friction
      graph = make_graph(bodies, heat, 1.0_dp)
      graph%law = solved%pass%graph%law
      self%coordinate = graph%coordinate_of_opening(openings(bodies, graph, state%contact))
      self%slope = graph%derivative(self%coordinate)
      call move_alloc(graph, self%solved%pass%graph)
      heat_rate = -heat_across(bodies%points%weight, 1.0_dp, state%jump)
      if (allocated(state%edge%point)) heat_rate(state%edge%point) = &
         heat_rate(state%edge%point)*state%edge%own
      where (bodies%jump_index == 0 .or. state%resting .or. (.not. abs(self%slope) > 0.0_dp .and. &
         .not. bodies%points%vary_with_temperature())) heat_rate = 0.0_dp
      self%active = pack([(k, k=1, size(heat_rate))], abs(heat_rate) > 0.0_dp)
      self%heat_rate = heat_rate(self%active)
      if (.not. allocated(solved%friction%made)) return
      self%heated = size(solved%friction%made)
      self%takes_rates = any(bodies%laws%heat%speed < 0.0_dp)
   end subroutine begin

   !> N: changes y with temperatures that grow at a rate.
   function answers(self, bodies, state, temperature, growth) result(changes)
      class(small_motion_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(solution_state_type), intent(in) :: state
      real(dp), intent(in) :: temperature(:, :)                !! (nodes, n) [temperature]
      real(dp), intent(in) :: growth                           !! [1/time]
      real(dp) :: changes(size(self%active) + self%heated, size(temperature, 2))
      real(dp), allocatable :: change(:, :), jump(:, :), mean(:, :)
      type(contact_change_type) :: of_contact
      integer :: k

      if (size(changes, 1) == 0) return
      allocate (change(size(self%slope), size(changes, 2)))
      call opening_changes(bodies, self%solved%pass%graph, self%tangent, state%contact, &
         loads_of_temperatures(bodies, temperature), change, of_contact)
      change = spread(self%slope, 2, size(change, 2))*change
      if (bodies%points%vary_with_temperature()) then
         allocate (jump, mean, mold=change)
         do k = 1, size(change, 2)
            jump(:, k) = bodies%points%jumps(temperature(:, k))
            mean(:, k) = bodies%points%means(temperature(:, k))
         end do
         change = change + changes_by_faces(bodies, self%solved, self%coordinate, mean, jump)
      end if
      associate (a => size(self%active))
         changes(:a, :) = change(self%active, :)
         if (self%heated > 0) changes(a + 1:, :) = self%solved%friction%changes(bodies, &
            state%contact, of_contact, growth)
      end associate
   end function answers

   !> F^T T: the heats of unit changes at the temperatures of a field.
   pure function heats(self, bodies, temperature) result(sums)
      class(small_motion_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: temperature(:, :)                !! (nodes, n)
      real(dp) :: sums(size(self%active) + self%heated, size(temperature, 2))
      real(dp) :: jump(size(bodies%points%slave))
      integer :: k

      sums = 0.0_dp
      associate (a => size(self%active))
         do k = 1, size(sums, 2)
            jump = bodies%points%jumps(temperature(:, k))
            sums(:a, k) = self%heat_rate*jump(self%active)
            if (self%heated > 0) call bodies%points%heat_shares%add_totals(temperature(:, k), &
               sums(a + 1:, k))
         end do
      end associate
   end function heats

   !> F: loads of the tail, and nodal heats of friction.
   pure subroutine heat_loads(self, bodies, on_tail, nodal)
      class(small_motion_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), allocatable, intent(out) :: on_tail(:, :)      !! (thermal tail, a)
      real(dp), allocatable, intent(out) :: nodal(:, :)        !! (nodes, heated)
      real(dp) :: unit(self%heated)
      integer :: k

      allocate (on_tail(bodies%thermal%map%tail, size(self%active)), &
         nodal(bodies%thermal%matrix%row_count, self%heated), source=0.0_dp)
      do k = 1, size(self%active)
         on_tail(bodies%jump_index(self%active(k)), k) = self%heat_rate(k)
      end do
      do k = 1, self%heated
         unit = 0.0_dp
         unit(k) = 1.0_dp
         call bodies%points%heat_shares%add_shares(unit, nodal(:, k))
      end do
   end subroutine heat_loads

   !> Displacements that temperatures make.
   function displacement(self, bodies, state, temperature) result(values)
      class(small_motion_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(solution_state_type), intent(in) :: state
      real(dp), intent(in) :: temperature(:)                   !! (nodes) [temperature]
      real(dp) :: values(2*size(temperature))                  !! (2 nodes) [length]
      type(contact_change_type) :: change
      real(dp) :: no_support(size(values))

      no_support = 0.0_dp
      call contact_response(bodies%equilibrium%contact, self%tangent, state%contact, &
         loads_of_temperatures(bodies, reshape(temperature, [size(temperature), 1])), change, &
         with_slip=.true.)
      values = bodies%equilibrium%recover(bodies%mechanical, bodies%equilibrium%load_of( &
         bodies%mechanical, bodies%thermal_load%multiply(temperature), no_support), &
         change%motion(:, 1))
   end function displacement

   !> Factors A + sigma C.
   !> Errors: as heat_reduction's reduce.
   subroutine factor(self, model, bodies, state, heat, sigma, error)
      class(shifted_conduction_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      type(solution_state_type), intent(in) :: state
      type(heat_reduction_type), intent(in) :: heat            !! of the run, for its order
      real(dp), intent(in) :: sigma                            !! > 0 [1/time]
      type(error_type), allocatable, intent(out) :: error
      type(sparse_matrix_type) :: film
      type(increment_data_type) :: data
      type(increment_workspace_type) :: workspace
      real(dp) :: jump(size(state%jump)), none(size(state%temperature))

      film = bodies%capacity
      film%value = sigma*film%value
      if (allocated(state%sources%film%value)) film = linear_combination(1.0_dp, &
         state%sources%film, sigma, bodies%capacity)
      self%heat%forms_on_demand = .true.
      call self%heat%share_order(heat, bodies)
      call self%heat%reduce(model, bodies, film, error)
      if (allocated(error)) return
      none = 0.0_dp
      data%equation = heat_equation_type(implicit_scheme, state%sources, state%sources, &
         state%temperature, bodies%points%weight, state%omega, state%jump)
      data%held_jump = 0.0_dp*state%jump
      workspace%heat = self%heat%load_of(bodies%thermal, none, none)
      allocate (workspace%heat%condensed(bodies%thermal%map%tail), source=0.0_dp)
      workspace%edge = state%edge
      call temperature_jumps(bodies, self%heat, data, state%omega, workspace, jump)
      self%tail = workspace%tail
   end subroutine factor

   !> Temperatures under nodal heats.
   function solve(self, bodies, nodal) result(temperature)
      class(shifted_conduction_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: nodal(:, :)                      !! (nodes, n) [power]
      real(dp) :: temperature(size(nodal, 1), size(nodal, 2))  !! [temperature]
      real(dp) :: on_tail(bodies%thermal%map%tail, size(nodal, 2))

      call self%heat%condense_forces(bodies%thermal, nodal, on_tail, temperature)
      call self%tail%solve_columns(on_tail)
      temperature = temperature + self%heat%extended(bodies%thermal, on_tail)
   end function solve

   !> (A + sigma C)^-1 F.
   function responses(self, bodies, motion) result(temperature)
      class(shifted_conduction_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(small_motion_type), intent(in) :: motion
      real(dp), allocatable :: temperature(:, :)               !! (nodes, changes)
      real(dp), allocatable :: nodal(:, :), on_tail(:, :)

      call motion%heat_loads(bodies, on_tail, nodal)
      call self%tail%solve_columns(on_tail)
      associate (a => size(motion%active), nodes => size(nodal, 1))
         allocate (temperature(nodes, a + motion%heated))
         temperature(:, :a) = self%heat%extended(bodies%thermal, on_tail)
         temperature(:, a + 1:) = self%solve(bodies, nodal)
      end associate
   end function responses

end module small_motions
