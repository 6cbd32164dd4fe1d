!> The heat of the bodies reduced to the jumps of the contact points, for given films. Nobody
!> changes a reduction that others read: a run and each companion of it own one each, and reduce
!> keeps what still serves.
module heat_reduction
   use controls, only: solver_mumps
   use dense, only: product_of
   use errors, only: error_type
   use field_constraints, only: in_cycle, stiffness_alone
   use field_problem, only: field_reduction_type
   use jump_loads, only: loads_by_elimination
   use kinds, only: dp
   use model, only: model_type
   use reduced_bodies, only: reduced_bodies_type
   use sparse_matrix, only: sparse_matrix_type
   use unconstrained_bodies, only: undetermined_beside
   implicit none
   private
   public :: heat_reduction_type, loads_of_temperatures, temperatures_in_loads

   integer, parameter :: columns_at_once = 32   !! jumps whose responses are formed together

   !> Heat, (3.3), reduced.
   type, extends(field_reduction_type) :: heat_reduction_type
      !> (mechanical tail, thermal tail) condensed mechanical load per jump; formed where heat
      !> depends on the mechanics of the step
      real(dp), allocatable :: jump_load(:, :)
      !> (m, thermal tail) mean temperature of the faces per jump; formed where laws vary with it
      real(dp), allocatable :: jump_mean(:, :)
      !> Of unit heat at each of the n contact points that friction may heat: (thermal tail, n)
      !> condensed heat; (mechanical tail, n) condensed mechanical load of the temperatures that it
      !> makes without jumps; (m, n) mean temperature of the faces, formed where laws vary with it.
      !> Formed where heat depends on the mechanics of the step; not for a sparse tail, which the
      !> heat enters as it is, and without which it makes nothing
      real(dp), allocatable :: friction_heat(:, :), friction_load(:, :), friction_mean(:, :)
      !> (nodes) ranks in nested dissection of both fields as numbered; known where one elimination
      !> of both was made
      integer, allocatable :: node_rank(:)
      !> Whether loads of jumps are formed as they are asked for, instead of jump_load for all of
      !> them: less work for a single increment.
      logical :: forms_on_demand = .false.
      !> Forces on what pieces keep per temperature of what they keep, where these go to solvers,
      !> these degrees of freedom and nodes, and which of both fields it was made of
      real(dp), allocatable, private :: kept_load(:, :)
      integer, allocatable, private :: kept_dofs(:), kept_nodes(:)
      integer, private :: kept_load_of(2) = 0
      integer, private :: ranked_displacements = 0   !! numbering of those in node_rank
      !> numbering and values of equilibrium in jump_load, 0 without it
      integer, private :: equilibrium(2) = 0
      integer, private :: friction_equilibrium(2) = 0   !! the same of friction_load
      logical, private :: is_balanced = .false.   !! whether jump_load is
   contains
      procedure :: serves
      procedure :: renumber_both
      procedure :: share_order
      procedure :: reduce
      procedure :: eliminate
      procedure :: set_node_rank
      procedure :: is_on_demand
      procedure :: is_divided
      procedure :: loads_of_tail
      procedure :: has_tail_forces
      procedure :: add_kept_forces
      procedure :: means_of_tail
      procedure :: friction_on_tail
      procedure :: conductors
   end type heat_reduction_type

contains

   !> Whether this is the heat of bodies with given films, for their present supports and step.
   pure logical function serves(self, bodies, film)
      class(heat_reduction_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies  !! numbered
      type(sparse_matrix_type), intent(in) :: film     !! (nodes, nodes) [power/temperature]

      serves = self%is_of(bodies%thermal, film) .and. (.not. bodies%is_coupled .or. &
         (self%is_on_demand(bodies) .and. has_kept_load(self, bodies)) .or. &
         (has_loads(self, bodies) .and. self%is_balanced .and. has_friction_loads(self, bodies)))
   end function serves

   !> Whether loads of jumps are formed as they are asked for: where the caller says so, and where
   !> bodies are divided, unless heat of friction asks for the loads of all jumps of a full tail.
   pure logical function is_on_demand(self, bodies)
      class(heat_reduction_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies

      is_on_demand = self%forms_on_demand .or. self%is_divided(bodies)
   end function is_on_demand

   !> Whether they are so formed of divided bodies.
   pure logical function is_divided(self, bodies)
      class(heat_reduction_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies

      is_divided = self%schur%is_sparse() .or. bodies%mechanical%division%is_tail() .or. &
         (allocated(bodies%thermal%division%piece) .and. .not. allocated(bodies%points%heated))
   end function is_divided

   !> Whether forces per temperature of what pieces keep are those of the pieces, if there are any.
   pure logical function has_kept_load(self, bodies)
      class(heat_reduction_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies

      has_kept_load = .not. allocated(bodies%thermal%division%piece) .or. &
         bodies%thermal%division%is_tail() .or. &
         all(self%kept_load_of == [self%kept_made, bodies%equilibrium%kept_made])
   end function has_kept_load

   !> Whether the loads of the jumps are those of the bodies' supports.
   pure logical function has_loads(self, bodies)
      class(heat_reduction_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies

      has_loads = allocated(self%jump_load) .and. all(self%equilibrium == &
         [bodies%mechanical%numbering, bodies%mechanical%values])
   end function has_loads

   !> Whether the loads of the heat of friction are those of the bodies' supports, if there are any.
   pure logical function has_friction_loads(self, bodies)
      class(heat_reduction_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies

      has_friction_loads = .not. allocated(bodies%points%heated) .or. &
         all(self%friction_equilibrium == [bodies%mechanical%numbering, bodies%mechanical%values])
   end function has_friction_loads

   !> Reduces heat for given films, as far as it does not serve for films, supports and step.
   !> Errors: bodies whose temperature nothing determines, a failure of the solver.
   subroutine reduce(self, model, bodies, film, error)
      class(heat_reduction_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies  !! equilibrium reduced, where it is solved
      type(sparse_matrix_type), intent(in) :: film     !! (nodes, nodes) [power/temperature]
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: of_loads
      logical :: warm(size(model%mesh%node_body))
      character(:), allocatable :: words
      integer :: k

      if (self%serves(bodies, film)) return
      call self%eliminate(model, bodies, film, of_loads)
      if (.not. self%is_of(bodies%thermal, film)) then
         call self%factor(bodies%thermal, film, model%solver, self%node_rank, error)
         if (allocated(error)) then
            ! Factors say better than an elimination what makes both fail: no prescribed temperature
            ! and no film is on these bodies or on a body that contact points join to them.
            warm = bodies%thermal%map%is_given([(k, k=1, size(warm))])
            if (allocated(film%value)) warm(pack(film%column, film%value > 0.0_dp)) = .true.
            words = undetermined_beside(model, bodies%points, warm)
            if (len(words) > 0) error%message = words//': no *BOUNDARY on dof 11 and no *FILM '// &
               'with a coefficient above 0 at this time fixes it'
            return
         end if
         self%friction_equilibrium = 0
         if (allocated(self%jump_mean)) deallocate (self%jump_mean)
         if (bodies%points%vary_with_temperature() .and. .not. self%schur%is_sparse()) then
            call form_jump_mean(self, bodies)
         end if
      end if
      if (allocated(of_loads)) call move_alloc(of_loads, error)
      if (allocated(error) .or. .not. bodies%is_coupled) return
      if (.not. has_kept_load(self, bodies)) call form_kept_load(self, bodies)
      if (self%is_on_demand(bodies)) return
      if (.not. has_friction_loads(self, bodies)) call form_friction(self, bodies)
      if (.not. has_loads(self, bodies)) call form_jump_load(self, bodies)
      self%equilibrium = [bodies%mechanical%numbering, bodies%mechanical%values]
      if (self%is_balanced) return
      do k = 1, size(self%jump_load, 2)
         self%jump_load(:, k) = bodies%equilibrium%contact%motions%balanced(self%jump_load(:, k))
      end do
      self%is_balanced = .true.
   end subroutine reduce

   !> Forms the loads of the jumps by one elimination of both fields, where the solver is better at
   !> that, and frees what does not serve. Called before equilibrium is factored, it leaves the
   !> memory of both fields' factors to the elimination, and its ranks to them.
   !> Errors: as loads_by_elimination.
   subroutine eliminate(self, model, bodies, film, error)
      class(heat_reduction_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies  !! numbered
      type(sparse_matrix_type), intent(in) :: film     !! (nodes, nodes) [power/temperature]
      type(error_type), allocatable, intent(out) :: error

      call self%renumber_both(bodies)
      if (.not. self%is_for(bodies%thermal, film)) self%equilibrium = 0
      if (has_loads(self, bodies) .or. .not. bodies%is_coupled) return
      if (self%is_on_demand(bodies)) return
      if (allocated(self%jump_load)) deallocate (self%jump_load)
      self%is_balanced = .false.
      if (model%solver /= solver_mumps .or. allocated(bodies%mechanical%division%piece)) return
      associate (heat => bodies%thermal%map, motion => bodies%mechanical%map)
         if (heat%equations + motion%equations == heat%tail + motion%tail) return
      end associate
      if (.not. self%is_of(bodies%thermal, film)) then
         call self%release()
         self%values = bodies%thermal%values
         self%added = film
      end if
      self%ranked_displacements = bodies%mechanical%numbering
      call loads_by_elimination(bodies%thermal, film, bodies%mechanical, bodies%thermal_load, &
         self%node_rank, self%jump_load, error)
      if (.not. allocated(error)) self%equilibrium = [bodies%mechanical%numbering, &
         bodies%mechanical%values]
   end subroutine eliminate

   !> Forgets what is of other numberings of the bodies.
   subroutine renumber_both(self, bodies)
      class(heat_reduction_type), intent(inout) :: self
      type(reduced_bodies_type), intent(in) :: bodies

      if (allocated(self%node_rank) .and. (self%numbering /= bodies%thermal%numbering .or. &
         self%ranked_displacements /= bodies%mechanical%numbering)) deallocate (self%node_rank)
      if (self%numbering /= bodies%thermal%numbering) self%equilibrium = 0
      call self%renumber(bodies%thermal)
   end subroutine renumber_both

   !> Orders unknowns as another reduction of the same bodies does.
   subroutine share_order(self, other, bodies)
      class(heat_reduction_type), intent(inout) :: self
      type(heat_reduction_type), intent(in) :: other
      type(reduced_bodies_type), intent(in) :: bodies

      call self%renumber_both(bodies)
      if (other%numbering /= self%numbering) return
      if (.not. allocated(self%rank) .and. allocated(other%rank)) self%rank = other%rank
      if (allocated(self%node_rank) .or. .not. allocated(other%node_rank)) return
      self%node_rank = other%node_rank
      self%ranked_displacements = other%ranked_displacements
   end subroutine share_order

   !> Gives the order of the unknowns of both fields.
   subroutine set_node_rank(self, bodies, node_rank)
      class(heat_reduction_type), intent(inout) :: self
      type(reduced_bodies_type), intent(in) :: bodies  !! numbered
      integer, intent(in) :: node_rank(:)              !! (nodes) ranks, several may be the same

      call self%renumber_both(bodies)
      self%node_rank = node_rank
      self%ranked_displacements = bodies%mechanical%numbering
   end subroutine set_node_rank

   !> Condensed mechanical loads of the thermal tail: from those of its unit values, or by a
   !> solution of each field.
   function loads_of_tail(self, bodies, on_tail) result(load)
      class(heat_reduction_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: on_tail(:, :)               !! (thermal tail, n) [temperature]
      real(dp) :: load(bodies%mechanical%map%tail, size(on_tail, 2))   !! (mechanical tail, n)

      if (self%has_tail_forces(bodies)) then
         load = loads_by(self, bodies, self%extended_to_kept(bodies%thermal, on_tail))
      else if (self%is_on_demand(bodies)) then
         load = loads_of_temperatures(bodies, self%extended(bodies%thermal, on_tail))
      else
         load = product_of(self%jump_load, on_tail)
      end if
   end function loads_of_tail

   !> Whether forces on what pieces keep are known of the temperatures that they keep, and loads are
   !> formed as they are asked for.
   pure logical function has_tail_forces(self, bodies)
      class(heat_reduction_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies

      has_tail_forces = self%is_on_demand(bodies) .and. allocated(self%kept_load)
   end function has_tail_forces

   !> Adds these forces.
   pure subroutine add_kept_forces(self, temperature, forces)
      class(heat_reduction_type), intent(in) :: self
      real(dp), intent(in) :: temperature(:)   !! (nodes) those that pieces keep, others not used
      real(dp), intent(inout) :: forces(:)     !! (2 nodes) [force]

      associate (made => product_of(self%kept_load, reshape(temperature(self%kept_nodes), &
         [size(self%kept_nodes), 1])))
         forces(self%kept_dofs) = forces(self%kept_dofs) + made(:, 1)
      end associate
   end subroutine add_kept_forces

   !> Mean temperatures of the faces that the thermal tail makes.
   function means_of_tail(self, bodies, on_tail) result(mean)
      class(heat_reduction_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: on_tail(:, :)               !! (thermal tail, n) [temperature]
      real(dp) :: mean(size(bodies%points%slave), size(on_tail, 2))   !! (m, n)
      integer :: k

      if (.not. self%schur%is_sparse()) then
         mean = product_of(self%jump_mean, on_tail)
         return
      end if
      do k = 1, size(on_tail, 2)
         mean(:, k) = bodies%points%means(bodies%thermal%map%expand(on_tail(:, k)))
      end do
   end function means_of_tail

   !> Condensed heat of the contact points that friction heats.
   function friction_on_tail(self, bodies, heat) result(on_tail)
      class(heat_reduction_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: heat(:)                     !! (n) [power]
      real(dp) :: on_tail(bodies%thermal%map%tail)        !! (thermal tail) [power]
      real(dp) :: nodal(bodies%thermal%matrix%row_count)

      if (self%schur%is_sparse()) then
         nodal = 0.0_dp
         call bodies%points%heat_shares%add_shares(heat, nodal)
         on_tail = bodies%thermal%map%restrict(nodal)
      else
         on_tail = matmul(self%friction_heat, heat)
      end if
   end function friction_on_tail

   !> Forces on the degrees of freedom that pieces of the bodies keep, of a unit temperature of each
   !> node that they keep: the same for all places of faces that slide, as the matrices that they
   !> leave are.
   subroutine form_kept_load(self, bodies)
      class(heat_reduction_type), intent(inout) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp) :: forces(bodies%thermal_load%row_count), unit(bodies%thermal_load%column_count)
      integer :: k

      associate (heat => bodies%thermal, piece => bodies%mechanical%division%piece)
         self%kept_dofs = pack([(k, k=1, size(forces))], piece == 0)
         self%kept_nodes = pack([(k, k=1, size(unit))], heat%division%piece == 0 .and. &
            (heat%map%moves([(k, k=1, size(unit))]) .or. &
            heat%map%is_given([(k, k=1, size(unit))])))
         if (allocated(self%kept_load)) deallocate (self%kept_load)
         allocate (self%kept_load(size(self%kept_dofs), size(self%kept_nodes)))
         do k = 1, size(self%kept_nodes)
            unit = 0.0_dp
            unit(self%kept_nodes(k)) = 1.0_dp
            call self%pieces%fill(unit)
            forces = bodies%thermal_load%multiply(unit)
            call bodies%equilibrium%pieces%condense(forces)
            self%kept_load(:, k) = forces(self%kept_dofs)
         end do
         self%kept_load_of = [self%kept_made, bodies%equilibrium%kept_made]
      end associate
   end subroutine form_kept_load

   !> The loads of the jumps, balanced, from the responses to each.
   subroutine form_jump_load(self, bodies)
      class(heat_reduction_type), intent(inout) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      integer :: first, last

      associate (tail => bodies%thermal%map%tail)
         allocate (self%jump_load(bodies%mechanical%map%tail, tail))
         do first = 1, tail, columns_at_once
            last = min(first + columns_at_once - 1, tail)
            self%jump_load(:, first:last) = loads_by(self, bodies, &
               self%unit_responses(bodies%thermal, first, last))
         end do
      end associate
      self%is_balanced = .true.
   end subroutine form_jump_load

   !> Condensed mechanical loads, balanced, of temperatures of the nodes that pieces keep, or of all
   !> where there are none.
   function loads_by(self, bodies, temperature) result(load)
      class(heat_reduction_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: temperature(:, :)
      real(dp) :: load(bodies%mechanical%map%tail, size(temperature, 2))
      real(dp), allocatable :: forces(:, :)
      integer :: k

      if (.not. allocated(self%kept_load)) then
         load = loads_of_temperatures(bodies, temperature)
         return
      end if
      allocate (forces(bodies%thermal_load%row_count, size(load, 2)), source=0.0_dp)
      do k = 1, size(load, 2)
         call self%add_kept_forces(temperature(:, k), forces(:, k))
      end do
      call bodies%equilibrium%condense_kept(bodies%mechanical, forces, load)
      do k = 1, size(load, 2)
         load(:, k) = bodies%equilibrium%contact%motions%balanced(load(:, k))
      end do
   end function loads_by

   !> Condensed mechanical loads of temperatures, balanced.
   function loads_of_temperatures(bodies, temperature) result(load)
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: temperature(:, :)           !! (nodes, n) [temperature]
      real(dp) :: load(bodies%mechanical%map%tail, size(temperature, 2))   !! (mechanical tail, n)
      real(dp), allocatable :: forces(:, :)
      integer :: k

      allocate (forces(bodies%thermal_load%row_count, size(load, 2)))
      call bodies%thermal_load%multiply_columns(temperature, forces)
      call bodies%equilibrium%condense_forces(bodies%mechanical, forces, load)
      do k = 1, size(load, 2)
         load(:, k) = bodies%equilibrium%contact%motions%balanced(load(:, k))
      end do
   end function loads_of_temperatures

   !> The transposed of loads_of_temperatures: how sums of the condensed loads follow temperatures.
   function temperatures_in_loads(bodies, factors) result(by_temperature)
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: factors(:, :)               !! (mechanical tail, n) of the loads
      real(dp) :: by_temperature(bodies%thermal_load%column_count, size(factors, 2))   !! (nodes, n)
      real(dp) :: balanced(size(factors, 1), size(factors, 2))
      real(dp), allocatable :: motions(:, :)
      integer :: k

      do k = 1, size(factors, 2)
         balanced(:, k) = bodies%equilibrium%contact%motions%balanced(factors(:, k))
      end do
      motions = bodies%equilibrium%extended(bodies%mechanical, balanced)
      do k = 1, size(factors, 2)
         by_temperature(:, k) = bodies%thermal_load%multiply_transposed(motions(:, k))
      end do
   end function temperatures_in_loads

   !> Mean temperature of the faces at all contact points, of a unit jump at each.
   subroutine form_jump_mean(self, bodies)
      class(heat_reduction_type), intent(inout) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), allocatable :: temperature(:, :)
      integer :: first, k, last, tail

      tail = bodies%thermal%map%tail
      allocate (self%jump_mean(size(bodies%points%slave), tail))
      do first = 1, tail, columns_at_once
         last = min(first + columns_at_once - 1, tail)
         temperature = self%unit_responses(bodies%thermal, first, last)
         do k = first, last
            self%jump_mean(:, k) = bodies%points%means(temperature(:, k - first + 1))
         end do
      end do
      ! Forces of links, which are unknowns of the tail too, act on jumps only.
      do k = 1, tail
         if (.not. any(bodies%jump_index == k)) self%jump_mean(:, k) = 0.0_dp
      end do
   end subroutine form_jump_mean

   !> What unit heat at each contact point that friction may heat makes.
   subroutine form_friction(self, bodies)
      class(heat_reduction_type), intent(inout) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), allocatable :: heat(:, :), temperature(:, :)
      real(dp) :: unit(size(bodies%points%heated))
      integer :: first, k, last, n, nodes

      nodes = bodies%thermal%matrix%row_count
      n = size(bodies%points%heated)
      if (allocated(self%friction_heat)) deallocate (self%friction_heat, self%friction_load, &
         self%friction_mean)
      allocate (self%friction_heat(bodies%thermal%map%tail, n), self%friction_load( &
         bodies%mechanical%map%tail, n), self%friction_mean(size(bodies%points%slave), n))
      do first = 1, n, columns_at_once
         last = min(first + columns_at_once - 1, n)
         allocate (heat(nodes, last - first + 1), temperature(nodes, last - first + 1))
         heat = 0.0_dp
         do k = first, last
            unit = 0.0_dp
            unit(k) = 1.0_dp
            call bodies%points%heat_shares%add_shares(unit, heat(:, k - first + 1))
         end do
         call self%condense_kept(bodies%thermal, heat, self%friction_heat(:, first:last), &
            temperature)
         self%friction_load(:, first:last) = loads_by(self, bodies, temperature)
         do k = first, last
            self%friction_mean(:, k) = bodies%points%means(temperature(:, k - first + 1))
         end do
         deallocate (heat, temperature)
      end do
      self%friction_equilibrium = [bodies%mechanical%numbering, bodies%mechanical%values]
   end subroutine form_friction

   !> Conductance of the bodies about each contact point alone; 0 where both temperatures are
   !> prescribed. A contact point that closes a cycle, whose jump only the others hold, has that of
   !> the bodies at its nodes.
   pure function conductors(self, bodies) result(conductance)
      class(heat_reduction_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp) :: conductance(size(bodies%points%slave))     !! (m) [power/temperature]
      logical :: cyclic(size(conductance))
      integer :: k

      conductance = 0.0_dp
      cyclic = in_cycle(bodies%thermal%map, size(cyclic))
      associate (index => bodies%jump_index, own => self%schur%diagonal())
         do k = 1, size(conductance)
            if (index(k) == 0) cycle
            conductance(k) = own(index(k))
            if (.not. cyclic(k)) cycle
            conductance(k) = stiffness_alone(conductance(k), bodies%thermal%matrix, &
               bodies%points%nodes_of(k), 1)
         end do
      end associate
   end function conductors

end module heat_reduction
