!> Small motions of the temperatures about a state. With A the conduction of bodies, films and
!> contact at the conductances of the state, they follow
!>
!>    C dT/dt = -A T + F y,   y = N(T, dT/dt),
!>
!> y being the changes of the conductances, and of the heats that friction makes, at the contact
!> points whose changes carry heat; F has the nodal heats of unit changes, and N says how the
!> contact answers temperatures: with its strains, its gaps and pressures, and the laws. Open,
!> slipping and stuck contact points keep their states, points at rest their conductance. At edges
!> inside a side of mortar points heat follows the openings themselves, which move the edges.
!>
!> N is formed as rows over the nodes; on a sparse tail each answer is a solution of the contact
!> system, and so is each product with its transposed.
module linear_perturbations
   use closing_instant, only: contact_change_type, contact_response
   use contact_heat, only: changes_by_faces
   use contact_operator, only: make_graph, opening_changes, openings
   use contact_system, only: closing_law_type, contact_open, contact_state_type
   use contact_workspace, only: contact_workspace_type
   use dense, only: transposed_product
   use edge_heat, only: find_heat_by_opening
   use errors, only: error_type
   use heat_equation, only: heat_across
   use heat_reduction, only: heat_reduction_type, loads_of_temperatures, temperatures_in_loads
   use increment_data, only: increment_workspace_type
   use kinds, only: dp
   use reduced_bodies, only: reduced_bodies_type
   use solution_state, only: solution_state_type
   implicit none
   private
   public :: linear_perturbation_type

   !> How the contact answers temperatures. Changes are those of the conductances of some contact
   !> points, of the heats of friction, and of the openings of contact points at edges inside a
   !> side, one behind the other.
   type :: linear_perturbation_type
      integer :: changes = 0                       !! n
      integer, allocatable :: active(:)            !! (a) contact points whose conductance counts
      integer :: heated = 0                        !! heats of friction
      integer, allocatable :: at_edge(:)           !! contact points whose openings count
      type(contact_workspace_type) :: tangent      !! factors of the contact states
      type(contact_state_type) :: contact          !! these states
      type(increment_workspace_type) :: laws       !! graphs, faces, heat of friction
      real(dp), allocatable :: coordinate(:)       !! (m) of the laws [length]
      real(dp), allocatable :: slope(:)            !! (m) of omega by the opening
      logical :: takes_rates = .false.         !! whether y depends on dT/dt: by slip that goes on
      real(dp), allocatable :: reads(:, :)     !! (nodes, n) N^T at constant temperatures
      !> (nodes, n) what it has more at unit rate, where that is anything
      real(dp), allocatable :: reads_rate(:, :)
      real(dp), allocatable, private :: heat_rate(:)    !! (a) heat against the jump per conductance
      !> (nodes, at edges) heat per opening
      real(dp), allocatable, private :: edge_heat(:, :)
   contains
      procedure :: begin
      procedure :: answers
      procedure :: answers_to_rates
      procedure :: sums_of_answers
      procedure :: heats
      procedure :: heat_loads
      procedure :: nodal_heat
      procedure :: displacement
   end type linear_perturbation_type

contains

   !> Begins with the state that an increment found.
   !> Error: its contact system is singular.
   subroutine begin(self, bodies, state, heat, solved, error)
      class(linear_perturbation_type), intent(out) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(solution_state_type), intent(in) :: state
      type(heat_reduction_type), intent(in) :: heat            !! of the increment
      type(increment_workspace_type), intent(in) :: solved     !! workspace that it left
      type(error_type), allocatable, intent(out) :: error
      real(dp), dimension(size(state%jump)) :: coordinate, heat_rate, opening, slope
      integer :: k

      self%active = [integer ::]
      self%at_edge = [integer ::]
      self%heat_rate = [real(dp) ::]
      allocate (self%reads(size(state%temperature), 0))
      self%tangent = solved%contact
      self%tangent%closing = closing_law_type()
      call self%tangent%factor_set(bodies%equilibrium%contact, state%contact, error)
      if (allocated(error) .or. .not. bodies%is_coupled) return
      self%laws%pass%graph = make_graph(bodies, heat, 1.0_dp)
      self%laws%pass%graph%law = solved%pass%graph%law
      if (allocated(solved%faces)) self%laws%faces = solved%faces
      self%laws%friction = solved%friction
      opening = openings(bodies, self%laws%pass%graph, state%contact)
      coordinate = self%laws%pass%graph%coordinate_of_opening(opening)
      slope = self%laws%pass%graph%derivative(coordinate)
      heat_rate = -heat_across(bodies%points%weight, 1.0_dp, state%jump)
      if (allocated(state%edge%point)) then
         ! There are none where laws follow temperatures.
         call find_heat_by_opening(bodies, self%laws%pass%graph, opening, state%resting, &
            state%temperature, self%at_edge, self%edge_heat)
         heat_rate(state%edge%point) = 0.0_dp
      end if
      where (bodies%jump_index == 0 .or. state%resting .or. (.not. abs(slope) > 0.0_dp .and. &
         .not. bodies%points%vary_with_temperature())) heat_rate = 0.0_dp
      self%active = pack([(k, k=1, size(heat_rate))], abs(heat_rate) > 0.0_dp)
      self%heat_rate = heat_rate(self%active)
      if (allocated(solved%friction%heat)) then
         self%heated = size(solved%friction%heat)
         self%takes_rates = any(bodies%laws%heat%speed < 0.0_dp)
      end if
      self%changes = size(self%active) + self%heated + size(self%at_edge)
      self%contact = state%contact
      self%coordinate = coordinate
      self%slope = slope
      if (heat%schur%is_sparse()) return
      call read_temperatures(self, bodies)
   end subroutine begin

   !> How the changes y follow temperatures: by the strains of the bodies, what loads of the
   !> mechanical tail change, of which temperatures make those that temperatures_in_loads has, and
   !> by the laws of the faces.
   subroutine read_temperatures(self, bodies)
      type(linear_perturbation_type), intent(inout) :: self           ! receives it
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), dimension(bodies%mechanical%map%tail, bodies%mechanical%map%tail) :: unit
      real(dp) :: opening(size(self%slope), size(unit, 2)), of_point(size(self%slope))
      real(dp), dimension(size(unit, 1), self%changes) :: by_load, by_rate
      type(contact_change_type) :: of_contact
      integer :: k

      unit = 0.0_dp
      do k = 1, size(unit, 1)
         unit(k, k) = 1.0_dp
      end do
      call opening_changes(bodies, self%laws%pass%graph, self%tangent, self%contact, unit, &
         opening, of_contact)
      by_load = transpose(changes_with(self, bodies, opening, of_contact, 0.0_dp))
      self%reads = temperatures_in_loads(bodies, by_load)
      if (self%takes_rates) then
         by_rate = transpose(changes_with(self, bodies, opening, of_contact, 1.0_dp)) - by_load
         self%reads_rate = temperatures_in_loads(bodies, by_rate)
      end if
      do k = 1, merge(size(self%active), 0, bodies%points%vary_with_temperature())
         of_point = 0.0_dp
         of_point(self%active(k)) = 1.0_dp
         call add_faces(self, bodies, of_point, self%reads(:, k))
      end do
   end subroutine read_temperatures

   !> Adds how conductances follow the temperatures of the faces by their laws.
   pure subroutine add_faces(self, bodies, by_conductance, sums)
      type(linear_perturbation_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: by_conductance(:)                ! (m) factors of conductances
      real(dp), intent(inout) :: sums(:)                       ! (nodes)
      real(dp), dimension(size(by_conductance), 2) :: change, mean

      mean = spread([1.0_dp, 0.0_dp], 1, size(by_conductance))
      change = changes_by_faces(bodies, self%laws, self%coordinate, mean, 1.0_dp - mean)
      call bodies%points%mean%add_shares(change(:, 1)*by_conductance, sums)
      call bodies%points%difference%add_shares(change(:, 2)*by_conductance, sums)
   end subroutine add_faces

   !> N: changes y with temperatures that grow at a rate.
   function answers(self, bodies, temperature, growth) result(changes)
      class(linear_perturbation_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: temperature(:, :)                !! (nodes, columns) [temperature]
      real(dp), intent(in) :: growth                           !! [1/time]
      real(dp) :: changes(self%changes, size(temperature, 2))

      if (bodies%thermal%division%is_tail() .and. self%changes > 0) then
         changes = found_answers(self, bodies, temperature, growth)
         return
      end if
      changes = transposed_product(self%reads, temperature)
      if (self%takes_rates) changes = changes + &
         growth*transposed_product(self%reads_rate, temperature)
   end function answers

   !> N': what changes y have more with temperatures that grow at unit rate.
   function answers_to_rates(self, bodies, temperature) result(changes)
      class(linear_perturbation_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: temperature(:, :)                !! (nodes, columns) [temperature]
      real(dp) :: changes(self%changes, size(temperature, 2))

      if (bodies%thermal%division%is_tail() .and. self%changes > 0) then
         changes = found_answers(self, bodies, temperature, 1.0_dp) - &
            found_answers(self, bodies, temperature, 0.0_dp)
      else
         changes = transposed_product(self%reads_rate, temperature)
      end if
   end function answers_to_rates

   !> N on a sparse tail, by a solution of the contact system.
   function found_answers(self, bodies, temperature, growth) result(changes)
      type(linear_perturbation_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: temperature(:, :)                ! (nodes, columns) [temperature]
      real(dp), intent(in) :: growth                           ! of theirs [1/time]
      real(dp) :: changes(self%changes, size(temperature, 2))
      real(dp), dimension(size(self%slope), size(temperature, 2)) :: by_faces, jump, mean, opening
      type(contact_change_type) :: of_contact
      integer :: k

      call opening_changes(bodies, self%laws%pass%graph, self%tangent, self%contact, &
         loads_of_temperatures(bodies, temperature), opening, of_contact)
      changes = changes_with(self, bodies, opening, of_contact, growth)
      if (.not. bodies%points%vary_with_temperature()) return
      do k = 1, size(temperature, 2)
         mean(:, k) = bodies%points%means(temperature(:, k))
         jump(:, k) = bodies%points%jumps(temperature(:, k))
      end do
      by_faces = changes_by_faces(bodies, self%laws, self%coordinate, mean, jump)
      changes(:size(self%active), :) = changes(:size(self%active), :) + by_faces(self%active, :)
   end function found_answers

   !> Changes y with openings of the contact points, forces and slip.
   function changes_with(self, bodies, opening, of_contact, growth) result(changes)
      type(linear_perturbation_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: opening(:, :)                    ! (m, columns) changes [length]
      type(contact_change_type), intent(in) :: of_contact
      real(dp), intent(in) :: growth                           ! of these [1/time]
      real(dp) :: changes(self%changes, size(opening, 2))

      associate (a => size(self%active))
         changes(:a, :) = spread(self%slope(self%active), 2, size(opening, 2))* &
            opening(self%active, :)
         if (self%heated > 0) changes(a + 1:a + self%heated, :) = self%laws%friction%changes( &
            bodies, self%contact, of_contact, growth)
         changes(a + self%heated + 1:, :) = opening(self%at_edge, :)
      end associate
   end function changes_with

   !> N^T y: sums of changes y, as they follow the temperatures of the nodes.
   function sums_of_answers(self, bodies, changes, growth) result(sums)
      class(linear_perturbation_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: changes(:)                       !! (n) y
      real(dp), intent(in) :: growth                           !! [1/time]
      real(dp) :: sums(bodies%thermal%matrix%row_count)        !! (nodes)
      real(dp) :: by_motion(bodies%mechanical%map%tail, 1), by_force(bodies%mechanical%map%tail, 1)
      real(dp), dimension(size(self%slope)) :: by_conductance, by_opening
      real(dp) :: by_load(bodies%mechanical%map%tail, 1)

      associate (a => size(self%active), system => bodies%equilibrium%contact)
         by_conductance = 0.0_dp
         by_conductance(self%active) = changes(:a)
         by_opening = self%slope*by_conductance
         by_opening(self%at_edge) = by_opening(self%at_edge) + changes(a + self%heated + 1:)
         by_motion = 0.0_dp
         by_force = 0.0_dp
         call add_openings(self, bodies, by_opening, by_motion(:, 1), by_force(:, 1))
         if (self%heated > 0) call add_heats(self, bodies, changes(a + 1:a + self%heated), growth, &
            by_motion(:, 1), by_force(:, 1))
         ! Forces are the load less S times the motion that it makes.
         by_load = by_motion - system%schur%times(by_force)
         call self%tangent%solve_transposed(by_load(:, 1))
         by_load = by_load + by_force
      end associate
      associate (of_loads => temperatures_in_loads(bodies, by_load))
         sums = of_loads(:, 1)
      end associate
      if (bodies%points%vary_with_temperature()) call add_faces(self, bodies, by_conductance, sums)
   end function sums_of_answers

   !> F^T T: the heats of unit changes at the temperatures of a field.
   pure function heats(self, bodies, temperature) result(sums)
      class(linear_perturbation_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: temperature(:, :)                !! (nodes, n)
      real(dp) :: sums(self%changes, size(temperature, 2))
      real(dp) :: jump(size(bodies%points%slave))
      integer :: k

      sums = 0.0_dp
      associate (a => size(self%active))
         do k = 1, size(sums, 2)
            jump = bodies%points%jumps(temperature(:, k))
            sums(:a, k) = self%heat_rate*jump(self%active)
            if (self%heated > 0) call bodies%points%heat_shares%add_totals(temperature(:, k), &
               sums(a + 1:a + self%heated, k))
         end do
         if (size(self%at_edge) > 0) sums(a + self%heated + 1:, :) = &
            transposed_product(self%edge_heat, temperature)
      end associate
   end function heats

   !> F: loads of the tail, and nodal heats of friction and at edges.
   pure subroutine heat_loads(self, bodies, on_tail, nodal)
      class(linear_perturbation_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), allocatable, intent(out) :: on_tail(:, :)      !! (thermal tail, a)
      real(dp), allocatable, intent(out) :: nodal(:, :)        !! (nodes, n - a)
      real(dp) :: unit(self%heated)
      integer :: k

      allocate (on_tail(bodies%thermal%map%tail, size(self%active)), &
         nodal(bodies%thermal%matrix%row_count, self%heated + size(self%at_edge)), source=0.0_dp)
      do k = 1, size(self%active)
         on_tail(bodies%jump_index(self%active(k)), k) = self%heat_rate(k)
      end do
      do k = 1, self%heated
         unit = 0.0_dp
         unit(k) = 1.0_dp
         call bodies%points%heat_shares%add_shares(unit, nodal(:, k))
      end do
      if (size(self%at_edge) > 0) nodal(:, self%heated + 1:) = self%edge_heat
   end subroutine heat_loads

   !> F y, as heat that enters nodes.
   pure function nodal_heat(self, bodies, changes) result(nodal)
      class(linear_perturbation_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: changes(:)                       !! (n) y
      real(dp) :: nodal(bodies%thermal%matrix%row_count)       !! (nodes) [power]
      real(dp) :: crossing(size(bodies%points%slave))

      associate (a => size(self%active))
         crossing = 0.0_dp
         crossing(self%active) = self%heat_rate*changes(:a)
         nodal = 0.0_dp
         call bodies%points%difference%add_shares(crossing, nodal)
         if (self%heated > 0) call bodies%points%heat_shares%add_shares( &
            changes(a + 1:a + self%heated), nodal)
         if (size(self%at_edge) > 0) nodal = nodal + matmul(self%edge_heat, &
            changes(a + self%heated + 1:))
      end associate
   end function nodal_heat

   !> Displacements that temperatures make.
   function displacement(self, bodies, state, temperature) result(values)
      class(linear_perturbation_type), intent(in) :: self
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

   !> Adds what openings have of motions and forces of the tail.
   pure subroutine add_openings(self, bodies, by_opening, by_motion, by_force)
      type(linear_perturbation_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: by_opening(:)                    ! (m) factors of openings
      real(dp), intent(inout) :: by_motion(:), by_force(:)     ! (tail) likewise
      integer :: k

      do k = 1, size(by_opening)
         associate (row => bodies%equilibrium%contact%normal(k), weight => bodies%points%weight(k))
            if (weight <= 0.0_dp) cycle
            if (self%contact%contact_state(k) == contact_open) then
               by_motion(row) = by_motion(row) - by_opening(k)
            else
               by_force(row) = by_force(row) - by_opening(k)/(weight* &
                  self%laws%pass%graph(k)%modulus)
            end if
         end associate
      end do
   end subroutine add_openings

   !> Adds what heats of friction have of motions and forces of the tail.
   pure subroutine add_heats(self, bodies, by_heat, growth, by_motion, by_force)
      type(linear_perturbation_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: by_heat(:)                       ! (heats) factors of them
      real(dp), intent(in) :: growth
      real(dp), intent(inout) :: by_motion(:), by_force(:)     ! (tail) likewise
      real(dp) :: unit(size(self%slope), 3, 3)     ! of force, shear and slip, a column each
      real(dp) :: per(size(by_heat), 3)
      integer :: k

      unit = 0.0_dp
      do k = 1, 3
         unit(:, k, k) = 1.0_dp
      end do
      per = self%laws%friction%changes(bodies, self%contact, contact_change_type( &
         force=unit(:, :, 1), shear=unit(:, :, 2), slip=unit(:, :, 3)), growth)
      associate (system => bodies%equilibrium%contact)
         do k = 1, size(by_heat)
            associate (j => bodies%points%heated(k))
               by_force(system%normal(j)) = by_force(system%normal(j)) + by_heat(k)*per(k, 1)
               if (system%tangent(j) == 0) cycle
               by_force(system%tangent(j)) = by_force(system%tangent(j)) - by_heat(k)* &
                  (per(k, 2) + per(k, 3)*system%compliance(j))
               by_motion(system%tangent(j)) = by_motion(system%tangent(j)) + by_heat(k)*per(k, 3)
            end associate
         end do
      end associate
   end subroutine add_heats

end module linear_perturbations
