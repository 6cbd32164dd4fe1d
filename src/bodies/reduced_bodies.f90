!> The bodies reduced once to their contact unknowns: everything that the fixed-point iteration
!> needs, on the contact points alone.
module reduced_bodies
   use contact_constraints, only: constrain_displacements, constrain_temperatures, &
      in_cycle, stiffness_alone
   use contact_points, only: contact_points_type
   use contact_reduction, only: contact_system_of
   use contact_system, only: contact_system_type
   use constraint_joints, only: joints_of
   use controls, only: solver_mumps
   use element_kinds, only: element_node_count
   use errors, only: error_type, set_error, status_deck
   use field_problem, only: field_problem_type
   use jump_loads, only: loads_by_elimination, loads_by_solves
   use kinds, only: dp
   use unconstrained_motions, only: balanced_load
   use mesh, only: extent_of
   use model, only: model_type
   use all_contact_points, only: all_contact_points_type, joined_points, match_surfaces, match_tie
   use held_points, only: find_held_directions
   use rigid_motions, only: joint_type, unsupported_motions
   use sparse_matrix, only: sparse_matrix_type
   use stiffness_matrix, only: assemble_initial_force, assemble_stiffness, assemble_thermal_load
   use text, only: to_text
   use thermal_matrix, only: assemble_conduction
   use unconstrained_bodies, only: undetermined_beside
   use weak_bodies, only: weakness_of_bodies
   implicit none
   private
   public :: reduced_bodies_type

   real(dp), parameter :: rounding = 1.0e-15_dp  !! of coordinates, in the extent of the model
   real(dp), parameter :: far = 1.0e3_dp        !! ratio of stiffnesses that are far apart
   integer, parameter :: columns_at_once = 32   !! jumps whose responses are formed together

   !> The reduced bodies.
   type :: reduced_bodies_type
      type(contact_points_type), allocatable :: interfaces(:) !! interfaces in the order of the deck
      type(contact_points_type), allocatable :: ties(:)       !! points of the ties likewise
      type(all_contact_points_type) :: points                 !! all their contact points
      type(field_problem_type) :: thermal                     !! heat, (3.3)
      type(field_problem_type) :: mechanical                  !! equilibrium, (2.4)
      type(sparse_matrix_type) :: thermal_load                !! nodal forces per nodal temperature
      real(dp), allocatable :: initial_force(:)               !! (2 nodes) of stresses, or none
      type(contact_system_type) :: contact                    !! the partial solution of (2.4)
      real(dp), allocatable :: initial_temperature(:)         !! (nodes) [temperature]
      real(dp) :: largest_expansion = 0.0_dp !! of all bodies [1/temperature]
      real(dp), allocatable :: rigid(:, :)  !! (2 nodes, motions) that the supports leave free
      integer, allocatable :: jump_index(:) !! (m) index of the jump on the tail, 0 where held
      !> (mechanical tail, thermal tail) condensed mechanical load per jump; formed where coupled.
      real(dp), allocatable :: jump_load(:, :)
      !> (m, thermal tail) mean temperature of the faces per jump; formed where laws vary with it
      real(dp), allocatable :: jump_mean(:, :)
      !> (nodes) ranks in nested dissection; known where one elimination of both fields was made
      integer, allocatable :: node_rank(:)
      logical :: is_coupled = .false.   !! whether heat depends on the mechanics of the step
   contains
      procedure :: prepare
      procedure :: number
      procedure :: assemble
      procedure :: reduce
      procedure :: set_film
      procedure :: conductors
      procedure :: release
   end type reduced_bodies_type

contains

   !> Matches the surfaces, unless the caller has already put their points in place.
   !> Errors: as make_contact_points and make_tie_points.
   subroutine prepare(self, model, error)
      class(reduced_bodies_type), intent(inout) :: self !! empty
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      if (.not. allocated(self%interfaces)) then
         allocate (self%interfaces(size(model%contacts)))
         do i = 1, size(model%contacts)
            call match_surfaces(model, i, self%interfaces(i), error)
            if (allocated(error)) return
         end do
      end if
      if (.not. allocated(self%ties)) then
         allocate (self%ties(size(model%ties)))
         do i = 1, size(model%ties)
            call match_tie(model, i, self%ties(i), error)
            if (allocated(error)) return
         end do
      end if
      self%points = joined_points(self%interfaces, self%ties, model)
      self%initial_temperature = model%initial_temperature
      self%largest_expansion = maxval([(maxval(abs(model%materials(model%sections(i)%material) &
         %expansion)), i=1, size(model%sections))])
   end subroutine prepare

   !> Numbers the unknowns of the fields that are asked for, for a set of supports.
   !> Error: an over-constrained contact point.
   subroutine number(self, model, held, held_temperature, mechanics, heat, error)
      class(reduced_bodies_type), intent(inout) :: self !! prepared
      type(model_type), intent(in) :: model
      logical, intent(in) :: held(:)                         !! (2 nodes) prescribed displacements
      logical, intent(in) :: held_temperature(:)             !! (nodes) prescribed temperatures
      logical, intent(in) :: mechanics                       !! whether displacements are numbered
      logical, intent(in) :: heat                            !! whether temperatures are numbered
      type(error_type), allocatable, intent(out) :: error
      ! gfortran never frees the components of a function's result within an array constructor.
      type(joint_type), allocatable :: of_equations(:), of_ties(:)

      if (allocated(self%node_rank) .and. (mechanics .or. heat)) deallocate (self%node_rank)
      if (mechanics) then
         call find_held_directions(self%points, held)
         of_ties = joints_of(self%points%ties)
         of_equations = joints_of(self%points%equations)
         call unsupported_motions(model%mesh, held, [of_ties, of_equations], self%rigid)
      end if
      associate (points => self%points, used => model%mesh%node_body > 0)
         if (mechanics) call constrain_displacements(used, held, points, &
            slave_is_stiffer(model, points, .true.), self%mechanical%map, error)
         if (allocated(error) .or. .not. heat) return
         call constrain_temperatures(used, held_temperature, points, &
            slave_is_stiffer(model, points, .false.), self%thermal%map)
      end associate
   end subroutine number

   !> Whether the slave's body is far stiffer, or conducts far better, than the master's. A soft
   !> body is to be written by the stiff one: the other way round its stiffness would be left over
   !> where those of the stiff one cancel, and their rounding with it.
   pure function slave_is_stiffer(model, points, mechanics) result(stiffer)
      type(model_type), intent(in) :: model
      type(all_contact_points_type), intent(in) :: points
      logical, intent(in) :: mechanics
      logical :: stiffer(size(points%slave))
      real(dp) :: stiffness(size(model%mesh%node_number)), own
      integer :: e, i

      stiffness = 0.0_dp
      do e = 1, size(model%mesh%element_number)
         associate (section => model%sections(model%mesh%element_section(e)), &
            nodes => model%mesh%element_nodes(:element_node_count(model%mesh%element_kind(e)), e))
            associate (material => model%materials(section%material))
               own = maxval([(material%elasticity(i, i), i=1, 4)])
               if (.not. mechanics) own = maxval(material%conductivity)
            end associate
            stiffness(nodes) = max(stiffness(nodes), own*section%thickness)
         end associate
      end do
      stiffer = stiffness(points%slave) > far*stiffness(points%master)
   end function slave_is_stiffer

   !> Reduces the fields that are asked for to the unknowns that were numbered last.
   !> Errors: unconstrained bodies, a failure of the solver.
   subroutine reduce(self, model, mechanics, heat, coupled, error)
      class(reduced_bodies_type), intent(inout) :: self !! numbered
      type(model_type), intent(in) :: model
      logical, intent(in) :: mechanics                       !! whether mechanics is reduced anew
      logical, intent(in) :: heat                            !! whether heat is reduced anew
      logical, intent(in) :: coupled            !! whether heat depends on the mechanics of the step
      type(error_type), allocatable, intent(out) :: error

      self%is_coupled = coupled
      call reduce_fields(self, model, mechanics, heat, error)
   end subroutine reduce

   !> Reduces the fields that are asked for, and what couples them.
   !> Errors: as reduce.
   subroutine reduce_fields(self, model, mechanics, heat, error)
      class(reduced_bodies_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      logical, intent(in) :: mechanics, heat
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: of_jumps
      character(:), allocatable :: words
      logical :: by_elimination, forms

      if (allocated(self%jump_load) .and. (mechanics .or. heat)) deallocate (self%jump_load)
      forms = self%is_coupled .and. .not. allocated(self%jump_load)
      by_elimination = forms .and. model%solver == solver_mumps
      if (by_elimination) then
         ! Before the factors of the fields, for their memory. These say what makes it fail.
         if (mechanics) call self%mechanical%release()
         if (heat) call self%thermal%release()
         call self%mechanical%map%stiffen_links(self%mechanical%matrix)
         call self%thermal%map%stiffen_links(self%thermal%matrix)
         call loads_by_elimination(self%thermal, self%mechanical, self%thermal_load, &
            self%node_rank, self%jump_load, of_jumps)
      end if
      if (mechanics) then
         call self%mechanical%reduce(model%solver, self%node_rank, error)
         if (allocated(error)) then
            words = weakness_of_bodies(model)
            if (error%status == status_deck .and. len(words) > 0) error%message = &
               error%message//'; '//words
            return
         end if
         self%contact = contact_system_of(self%mechanical, self%points, self%rigid)
         self%contact%least_length = rounding*extent_of(model%mesh%coordinates)
      end if
      if (heat) call reduce_heat(self, model, error)
      if (allocated(error) .or. .not. forms) return
      if (.not. by_elimination) call loads_by_solves(self%thermal, self%mechanical, &
         self%thermal_load, self%jump_load)
      if (allocated(of_jumps)) call move_alloc(of_jumps, error)
      if (allocated(self%jump_load)) call balance_jump_load(self)
   end subroutine reduce_fields

   !> Reduces the heat problem to the jumps.
   !> Errors: bodies whose temperature nothing determines, a failure of the solver.
   subroutine reduce_heat(self, model, error)
      class(reduced_bodies_type), intent(inout) :: self !! numbered
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      call self%thermal%reduce(model%solver, self%node_rank, error)
      if (allocated(error)) then
         call name_cold_bodies(self, model, error)
         return
      end if
      associate (map => self%thermal%map)
         self%jump_index = map%tail_index(map%introduced)
      end associate
      if (allocated(self%jump_mean)) deallocate (self%jump_mean)
      if (self%points%vary_with_temperature()) call form_jump_mean(self)
   end subroutine reduce_heat

   !> Names the bodies that leave the heat problem singular: no prescribed temperature and no film
   !> is on them or on a body that contact points join to them.
   subroutine name_cold_bodies(self, model, error)
      type(reduced_bodies_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(error_type), intent(inout) :: error
      logical :: warm(size(model%mesh%node_body))
      character(:), allocatable :: words
      integer :: i

      warm = self%thermal%map%is_given([(i, i=1, size(warm))])
      if (allocated(self%thermal%added%value)) then
         warm(pack(self%thermal%added%column, self%thermal%added%value > 0.0_dp)) = .true.
      end if
      words = undetermined_beside(model, self%points, warm)
      if (len(words) > 0) error%message = words//': no *BOUNDARY on dof 11 and no *FILM with a '// &
         'coefficient above 0 at this time fixes it'
   end subroutine name_cold_bodies

   !> Takes the films of an increment; where they differ from those of the factors, the heat problem
   !> is reduced again.
   !> Errors: as reduce_heat.
   subroutine set_film(self, film, model, error)
      class(reduced_bodies_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: film !! (nodes, nodes) [power/temperature]
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      if (same_values(film, self%thermal%added)) return
      self%thermal%added = film
      call reduce_fields(self, model, .false., .true., error)
   end subroutine set_film

   !> Whether two matrices have the same entries.
   pure logical function same_values(a, b)
      type(sparse_matrix_type), intent(in) :: a, b

      same_values = allocated(a%value) .eqv. allocated(b%value)
      if (.not. (same_values .and. allocated(a%value))) return
      same_values = size(a%value) == size(b%value)
      if (same_values) same_values = all(a%column == b%column) .and. &
         all(abs(a%value - b%value) <= 0.0_dp)
   end function same_values

   !> Assembles the matrices of the bodies alone, once.
   subroutine assemble(self, model, with_mechanics, with_heat, with_strain)
      class(reduced_bodies_type), intent(inout) :: self !! prepared
      type(model_type), intent(in) :: model
      logical, intent(in) :: with_mechanics                  !! whether any step solves mechanics
      logical, intent(in) :: with_heat                       !! whether any step solves heat
      logical, intent(in) :: with_strain !! whether temperatures strain the bodies in any step

      if (with_mechanics) self%mechanical%matrix = assemble_stiffness(model%mesh, &
         model%sections, model%materials, model%orientations)
      if (with_mechanics .and. allocated(model%mesh%initial_stress)) self%initial_force = &
         assemble_initial_force(model%mesh, model%sections)
      if (with_strain) self%thermal_load = assemble_thermal_load(model%mesh, model%sections, &
         model%materials, model%orientations)
      if (with_heat) self%thermal%matrix = assemble_conduction(model%mesh, model%sections, &
         model%materials, model%orientations)
   end subroutine assemble

   !> Balances the condensed loads of the jumps, which have no resultant.
   subroutine balance_jump_load(self)
      class(reduced_bodies_type), intent(inout) :: self
      real(dp) :: none(size(self%rigid, 2))
      integer :: k

      none = 0.0_dp
      do k = 1, size(self%jump_load, 2)
         self%jump_load(:, k) = balanced_load(self%jump_load(:, k), self%contact%rigid, &
            self%contact%motion, none)
      end do
   end subroutine balance_jump_load

   !> Mean temperature of the faces at all contact points, of a unit jump at each.
   subroutine form_jump_mean(self)
      class(reduced_bodies_type), intent(inout) :: self
      real(dp), allocatable :: temperature(:, :)
      integer :: first, k, last, tail

      tail = self%thermal%map%tail
      allocate (self%jump_mean(size(self%points%slave), tail))
      do first = 1, tail, columns_at_once
         last = min(first + columns_at_once - 1, tail)
         temperature = self%thermal%unit_responses(first, last)
         do k = first, last
            self%jump_mean(:, k) = self%points%means(temperature(:, k - first + 1))
         end do
      end do
      ! Forces of links, which are unknowns of the tail too, act on jumps only.
      do k = 1, tail
         if (.not. any(self%jump_index == k)) self%jump_mean(:, k) = 0.0_dp
      end do
   end subroutine form_jump_mean

   !> Conductance of the bodies about each contact point alone; 0 where both temperatures are
   !> prescribed. A contact point that closes a cycle, whose jump only the others hold, has that of
   !> the bodies at its nodes.
   pure function conductors(self) result(conductance)
      class(reduced_bodies_type), intent(in) :: self
      real(dp) :: conductance(size(self%points%slave))     !! (m) [power/temperature]
      logical :: cyclic(size(conductance))
      integer :: k

      conductance = 0.0_dp
      cyclic = in_cycle(self%thermal%map, size(cyclic))
      do k = 1, size(conductance)
         if (self%jump_index(k) == 0) cycle
         conductance(k) = self%thermal%solver%schur(self%jump_index(k), self%jump_index(k))
         if (.not. cyclic(k)) cycle
         conductance(k) = stiffness_alone(conductance(k), self%thermal%matrix, &
            self%points%nodes_of(k), 1)
      end do
   end function conductors

   !> Frees the factors.
   subroutine release(self)
      class(reduced_bodies_type), intent(inout) :: self

      call self%thermal%release()
      call self%mechanical%release()
   end subroutine release

end module reduced_bodies
