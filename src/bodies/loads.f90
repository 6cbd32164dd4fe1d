!> All loads and supports of a model at the present instant.
module loads
   use element_kinds, only: axisymmetric, element_node_count
   use kinds, only: dp
   use load_histories, only: load_history_type, step_clock_type
   use connections, only: connections_type
   use model, only: model_type
   use sparse_matrix, only: sparse_matrix_type
   use state_tables, only: state_table_type
   use steps, only: analysis_static, boundary_type, dof_temperature, load_film_sink, &
      load_temperature, load_type, step_type
   use unit_loads, only: entries_of, find_locations, integrated, same_location, unit_loads_type
   implicit none
   private
   public :: loads_type

   !> Histories of the loads; displacements by degree of freedom, temperatures by node, all other
   !> ones by the locations on which the deck puts loads.
   type :: loads_type
      type(load_history_type) :: displacement  !! (2 nodes) prescribed displacements [length]
      type(load_history_type) :: temperature   !! (nodes) prescribed temperatures [temperature]
      type(load_history_type) :: applied       !! (locations) loads, each in the unit of its kind
      !> (interfaces) overlaps that are allowed, or factors of the initial ones [length or -]
      type(load_history_type) :: interference
      logical, allocatable :: shrinks(:)       !! (interfaces) which of the two
      type(load_type), allocatable :: locations(:)   !! (locations) what they act on
      type(unit_loads_type) :: unit            !! nodal forces and heat of unit loads
      integer :: card_count = 0                !! number of the last data card of a load
   contains
      procedure :: prepare
      procedure :: begin_step
      procedure :: move_to
      procedure :: nodal_forces
      procedure :: present_gaps
      procedure :: heat_load
      procedure :: film_matrix
      procedure :: card_heat
      procedure :: set_temperatures
      procedure :: axis_value
      procedure :: exchange
   end type loads_type

contains

   !> Starts with nothing given: displacements and loads from zero, temperatures from the initial
   !> ones.
   pure subroutine prepare(self, model)
      class(loads_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(dp), allocatable :: zero(:)
      integer :: e, node, q, s

      allocate (zero(2*size(model%mesh%node_number)), source=0.0_dp)
      call self%displacement%prepare(zero, model%amplitudes)
      ! Nodes on the axis of an axisymmetric body stay there.
      associate (mesh => model%mesh, permanent => self%displacement%permanent)
         do e = 1, size(mesh%element_number)
            if (mesh%element_plane(e) /= axisymmetric) cycle
            do q = 1, element_node_count(mesh%element_kind(e))
               node = mesh%element_nodes(q, e)
               if (mesh%coordinates(1, node) <= 0.0_dp) permanent(2*node - 1) = .true.
            end do
         end do
         self%displacement%active = permanent
      end associate
      call self%interference%prepare(spread(0.0_dp, 1, size(model%contacts)), model%amplitudes)
      allocate (self%shrinks(size(model%contacts)), source=.false.)
      call self%temperature%prepare(model%initial_temperature, model%amplitudes)
      self%locations = find_locations(model%steps)
      call self%applied%prepare(values_at(self%locations, model%initial_temperature), &
         model%amplitudes)
      ! As in CalculiX the sink of a film acts whole at once, while its coefficient ramps.
      self%applied%at_once = self%locations%kind == load_film_sink
      do s = 1, size(model%steps)
         if (.not. allocated(model%steps(s)%loads)) cycle
         self%card_count = max(self%card_count, maxval([0, model%steps(s)%loads%card]))
      end do
      self%unit = integrated(model, self%locations)
   end subroutine prepare

   !> Values of loads that are not given: the nodes' temperatures for *TEMPERATURE, else zero.
   pure function values_at(locations, temperature) result(values)
      type(load_type), intent(in) :: locations(:)
      real(dp), intent(in) :: temperature(:)
      real(dp) :: values(size(locations))
      integer :: i

      values = 0.0_dp
      do i = 1, size(values)
         if (locations(i)%kind == load_temperature) values(i) = temperature(locations(i)%item)
      end do
   end function values_at

   !> Takes over what the cards of a step give and end. What is prescribed for the first time, or
   !> again after it was free, ramps from where the node is.
   pure subroutine begin_step(self, step, displacement, temperature)
      class(loads_type), intent(inout) :: self
      type(step_type), intent(in) :: step
      real(dp), intent(in) :: displacement(:)     !! (2 nodes) at the end of the last step [length]
      real(dp), intent(in) :: temperature(:)      !! (nodes) likewise [temperature]
      integer :: i

      call self%displacement%begin_step(displacement)
      call self%temperature%begin_step(temperature)
      call self%applied%begin_step(values_at(self%locations, temperature))
      if (step%ends_boundaries) then
         call self%displacement%remove([(i, i=1, size(displacement))])
         call self%temperature%remove([(i, i=1, size(temperature))])
      end if
      do i = 1, size(step%boundaries)
         associate (card => step%boundaries(i))
            if (card%dof == dof_temperature) then
               call prescribe(self%temperature, card%node, card)
            else
               call prescribe(self%displacement, 2*(card%node - 1) + card%dof, card)
            end if
         end associate
      end do
      call apply_step(self, step)
      call begin_interferences(self, step)
   end subroutine begin_step

   !> Gives a prescribed value, or keeps the one at the start of the step.
   pure subroutine prescribe(history, i, boundary)
      type(load_history_type), intent(inout) :: history
      integer, intent(in) :: i                    !! its number there
      type(boundary_type), intent(in) :: boundary

      call history%give(i, merge(history%start(i), boundary%value, boundary%keeps), &
         boundary%amplitude, boundary%card)
   end subroutine prescribe

   !> Gives the interferences of a step. Without an amplitude they act whole at once, and go down to
   !> zero over the step.
   pure subroutine begin_interferences(self, step)
      class(loads_type), intent(inout) :: self
      type(step_type), intent(in) :: step
      integer :: i

      call self%interference%begin_step(0.0_dp*self%interference%value)
      if (step%changes%ends_interferences) call self%interference%remove([(i, i=1, &
         size(self%shrinks))])
      if (.not. allocated(step%changes%interferences)) return
      do i = 1, size(step%changes%interferences)
         associate (given => step%changes%interferences(i))
            self%shrinks(given%contact) = given%shrinks
            call self%interference%give(given%contact, given%value, given%amplitude, 0)
            if (given%amplitude > 0) cycle
            self%interference%start(given%contact) = given%value
            self%interference%target(given%contact) = 0.0_dp
         end associate
      end do
   end subroutine begin_interferences

   !> Gives the loads of a step; on their locations, and of the kinds that OP=NEW ends, nothing
   !> stays.
   pure subroutine apply_step(self, step)
      class(loads_type), intent(inout) :: self
      type(step_type), intent(in) :: step
      logical :: given(size(self%locations)), ends
      integer :: entries(size(step%loads)), i

      given = .false.
      entries = entries_of(self%locations, step%loads)
      given(entries) = .true.
      ends = .false.
      do i = 1, size(given)
         ! The entries of a location that a step gives are its first ones.
         ends = i > 1 .and. (ends .or. given(max(1, i - 1))) .and. &
            same_location(self%locations(i), self%locations(max(1, i - 1)))
         if (given(i)) cycle
         associate (kind => self%locations(i)%kind)
            if (kind == load_temperature .and. step%analysis /= analysis_static) then
               call self%applied%remove([i])
            else if (self%applied%active(i) .and. (ends .or. step%ends_loads(kind)) .and. &
               kind /= load_film_sink) then
               call self%applied%fade(i)
            end if
         end associate
      end do
      do i = 1, size(step%loads)
         associate (load => step%loads(i))
            call self%applied%give(entries(i), load%value, load%amplitude, load%card)
         end associate
      end do
   end subroutine apply_step

   !> Moves everything to an instant.
   pure subroutine move_to(self, clock, model)
      class(loads_type), intent(inout) :: self
      type(step_clock_type), intent(in) :: clock  !! the instant
      type(model_type), intent(in) :: model
      type(step_clock_type) :: ramped

      call self%displacement%move_to(clock, model%amplitudes)
      call self%temperature%move_to(clock, model%amplitudes)
      call self%applied%move_to(clock, model%amplitudes)
      ramped = clock
      ramped%ramped = .true.
      call self%interference%move_to(ramped, model%amplitudes)
   end subroutine move_to

   !> The histories, in either direction.
   subroutine exchange(self, table)
      class(loads_type), intent(inout) :: self     !! in the step of the table
      type(state_table_type), intent(inout) :: table

      call self%displacement%exchange(table, 'prescribed_displacement')
      call self%temperature%exchange(table, 'prescribed_temperature')
      call self%applied%exchange(table, 'load')
      call self%interference%exchange(table, 'interference')
   end subroutine exchange

   !> Present values of the loads; of those that do not act zero.
   pure function present_values(self) result(values)
      class(loads_type), intent(in) :: self
      real(dp) :: values(size(self%locations))

      values = merge(self%applied%value, 0.0_dp, self%applied%active)
   end function present_values

   !> Applied nodal forces: concentrated ones and those of pressures, tractions and body forces.
   pure function nodal_forces(self) result(forces)
      class(loads_type), intent(in) :: self
      real(dp) :: forces(size(self%displacement%value))  !! (2 nodes) [force]

      forces = self%unit%forces%multiply(present_values(self))
   end function nodal_forces

   !> Initial gaps of the contact points, counted from the overlaps that are allowed at present.
   pure function present_gaps(self, points) result(gap)
      class(loads_type), intent(in) :: self
      type(connections_type), intent(in) :: points  !! all contact points
      real(dp) :: gap(size(points%initial_gap))            !! (m) h [length]

      gap = points%initial_gap
      associate (i => points%interface)
         where (self%interference%active(i)) gap = gap + self%interference%value(i)* &
            merge(max(-gap, 0.0_dp), 1.0_dp, self%shrinks(i))
      end associate
   end function present_gaps

   !> Nodal heat of sources and fluxes, and of films with the bodies at temperature zero: Q of
   !> (3.3).
   pure function heat_load(self) result(heat)
      class(loads_type), intent(in) :: self
      real(dp) :: heat(size(self%temperature%value))    !! (nodes) into the bodies [power]

      heat = self%unit%heat%multiply(self%unit%with_films(present_values(self)))
   end function heat_load

   !> Contribution of films to the conduction matrix, both triangles; without values where no heat
   !> crosses a film.
   pure function film_matrix(self) result(matrix)
      class(loads_type), intent(in) :: self
      type(sparse_matrix_type) :: matrix      !! (nodes, nodes) [power/temperature]

      matrix = self%unit%film_matrix(present_values(self), size(self%temperature%value))
   end function film_matrix

   !> Net heat that each data card of a load brings into the bodies; zero for cards of mechanics.
   pure function card_heat(self, temperature) result(rates)
      class(loads_type), intent(in) :: self
      real(dp), intent(in) :: temperature(:)    !! (nodes) [temperature]
      real(dp) :: rates(self%card_count)        !! (cards) by their running numbers [power]
      real(dp) :: of_location(size(self%locations))
      integer :: i

      of_location = self%unit%location_heat(present_values(self), temperature)
      rates = 0.0_dp
      do i = 1, size(of_location)
         if (.not. self%applied%active(i)) cycle
         associate (rate => rates(self%applied%card(i)))
            rate = rate + of_location(i)
         end associate
      end do
   end function card_heat

   !> Temperatures that *TEMPERATURE gives in a step without heat; other nodes keep theirs.
   pure subroutine set_temperatures(self, temperature)
      class(loads_type), intent(in) :: self
      real(dp), intent(inout) :: temperature(:)        !! (nodes) [temperature]
      integer :: i

      do i = 1, size(self%locations)
         if (self%locations(i)%kind /= load_temperature .or. .not. self%applied%active(i)) cycle
         temperature(self%locations(i)%item) = self%applied%value(i)
      end do
   end subroutine set_temperatures

   !> Value on the load axis: the prescribed value of LOAD=, or the time.
   pure function axis_value(self, model, time) result(value)
      class(loads_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: time                !! total time [time]
      real(dp) :: value                           !! value on the load axis

      if (model%load_node == 0) then
         value = time
      else if (model%load_dof == dof_temperature) then
         value = self%temperature%value(model%load_node)
      else
         value = self%displacement%value(2*(model%load_node - 1) + model%load_dof)
      end if
   end function axis_value

end module loads
