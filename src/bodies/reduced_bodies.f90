!> The bodies and their contact points, numbered for a set of supports, with equilibrium reduced to
!> the contact unknowns. Their heat is reduced for given films, by each run for itself
!> (heat_reduction).
module reduced_bodies
   use field_constraints, only: constrain_displacements, constrain_temperatures
   use connections, only: connections_type, contact_laws_type, join_points, laws_of_step, &
      match_surfaces, match_tie
   use conductance_laws, only: is_constant
   use contact_points, only: contact_points_type, on_axis
   use dilatation, only: dilatation_type
   use element_kinds, only: element_node_count
   use equilibrium_reduction, only: equilibrium_reduction_type
   use errors, only: error_type
   use field_problem, only: field_problem_type
   use kinds, only: dp
   use loads, only: loads_type
   use materials, only: follows_temperature, heat_capacity, heat_capacity_at, melts, varies
   use model, only: has_sparse_tail, model_type
   use held_points, only: held_directions
   use point_materials, only: point_materials_type
   use quadrature, only: integration_rules
   use rigid_motions, only: joint_type, joints_of, unsupported_motions
   use linear_constraints, only: linear_constraints_type
   use mesh, only: mesh_type, nodes_per_element
   use sparse_matrix, only: linear_combination, sparse_matrix_type, triplet_list_type
   use steps, only: load_temperature, solves_heat, solves_mechanics
   use sum_lists, only: sum_list_type
   use stiffness_matrix, only: assemble_stiffness, assemble_thermal_load, bar_stiffness, &
      bar_thermal_load
   use thermal_matrix, only: assemble_capacity, assemble_conduction
   implicit none
   private
   public :: reduced_bodies_type

   real(dp), parameter :: far = 1.0e3_dp        !! ratio of stiffnesses that are far apart

   !> The reduced bodies.
   type :: reduced_bodies_type
      !> Interfaces in the order of the deck: what each has beside its part of `points` (see view)
      type(contact_points_type), allocatable :: interfaces(:)
      type(contact_points_type), allocatable :: ties(:)       !! theirs, given to prepare
      type(connections_type) :: points                 !! all their contact points
      type(contact_laws_type) :: laws                         !! theirs in the step
      !> (2, m) along which the supports hold contact points, as from held_directions
      real(dp), allocatable :: held_direction(:, :)
      type(field_problem_type) :: thermal                     !! heat, (3.3)
      type(field_problem_type) :: mechanical                  !! equilibrium, (2.4)
      !> C of (1.2); without values where no step needs it [energy/temperature]
      type(sparse_matrix_type) :: capacity
      !> (entries) of C without melting, and the diagonal that this adds (nodes); unallocated where
      !> nothing melts
      real(dp), allocatable :: sensible(:), melting(:)
      type(dilatation_type) :: dilatation                     !! heat that strains take up
      type(sparse_matrix_type) :: thermal_load                !! nodal forces per nodal temperature
      ! What springs and trusses have of the matrices of equilibrium; without values for none.
      type(sparse_matrix_type) :: bar_stiffness, bar_load
      type(equilibrium_reduction_type) :: equilibrium         !! the partial solution of (2.4)
      real(dp) :: largest_expansion = 0.0_dp !! of all bodies [1/temperature]
      !> (nodes) that the operators were formed with, where materials vary [temperature]
      real(dp), allocatable :: operators_at(:)
      !> (16*materials of the points) of stress by strain, likewise; unallocated for elasticity
      real(dp), allocatable :: tangent(:)
      type(sum_list_type) :: rigid !! (motions, 2 nodes) that the supports leave free
      !> nodes of no body that contact points took when these motions were found; unallocated where
      !> supports have changed since
      integer, allocatable, private :: references(:)
      integer, allocatable :: jump_index(:) !! (m) index of the jump on the tail, 0 where held
      logical :: is_coupled = .false.   !! whether heat depends on the mechanics of the step
      !> (2 nodes) where contact points lie on displaced faces; unallocated where none does [length]
      real(dp), allocatable :: faces_at(:)
      real(dp), allocatable :: worn(:)   !! (m) wear that is part of the gaps, or none [length]
      real(dp), allocatable, private :: unworn_gap(:)  !! (m) initial gaps without it [length]
      !> All of them as they were matched last, where some follow sliding
      type(contact_points_type), allocatable, private :: matched(:), matched_ties(:)
      ! Key of the numbering: supports, contact points with friction, prescribed temperatures.
      logical, allocatable, private :: prescribed(:)               !! (2 nodes)
      logical, allocatable, private :: has_friction(:)       !! (m)
      logical, allocatable, private :: held_temperature(:)   !! (nodes)
   contains
      procedure :: prepare
      procedure :: view
      procedure :: views
      procedure :: enter_step
      procedure :: follow_faces
      procedure :: displaced_by
      procedure :: least_spacing
      procedure :: wear_to
      procedure :: movement
      procedure, private :: couples
      procedure :: number
      procedure :: assemble_steps
      procedure :: form_operators
      procedure :: move_operators
      procedure :: has_operators_of
      procedure :: evened
      procedure :: largest_displacement
      procedure :: set_melting
      procedure :: reduce
   end type reduced_bodies_type

contains

   !> Matches the surfaces, unless the caller has already put their points in place; with the laws
   !> of the first step.
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
      if (any(self%interfaces%follows_sliding)) then
         allocate (self%faces_at(2*size(model%mesh%node_number)), source=0.0_dp)
         self%matched = self%interfaces
         self%matched_ties = self%ties
      end if
      call join_points(self%interfaces, self%ties, model, self%points)
      deallocate (self%ties)
      self%laws = laws_of_step(model, self%points, 1)
      if (allocated(self%laws%wear)) then
         allocate (self%worn(size(self%points%slave)), source=0.0_dp)
         self%unworn_gap = self%points%initial_gap
      end if
      if (has_sparse_tail(model, real(size(self%points%slave), dp)) .or. &
         allocated(self%faces_at)) then
         self%mechanical%division%graph = joined_nodes(model)
         if (allocated(self%faces_at) .and. .not. has_sparse_tail(model, &
            real(size(self%points%slave), dp))) then
            allocate (self%mechanical%division%is_on_face(size(model%mesh%node_number)), &
               source=.false.)
            do i = 1, size(self%interfaces)
               if (self%interfaces(i)%follows_sliding) self%mechanical%division%is_on_face( &
                  self%interfaces(i)%face_node) = .true.
            end do
         end if
         self%thermal%division = self%mechanical%division
      end if
      self%largest_expansion = maxval([(maxval(abs(model%materials(model%sections(i)%material) &
         %expansion)), i=1, size(model%sections))])
   end subroutine prepare

   !> Which nodes elements, springs and trusses join.
   pure function joined_nodes(model) result(graph)
      type(model_type), intent(in) :: model
      type(sparse_matrix_type) :: graph         ! (nodes, nodes)
      type(triplet_list_type) :: list
      integer :: bars, e, i
      real(dp) :: ones(nodes_per_element, nodes_per_element)

      ones = 1.0_dp
      bars = 0
      if (allocated(model%bars)) bars = size(model%bars)
      associate (mesh => model%mesh)
         call list%reserve(nodes_per_element**2*(size(mesh%element_kind) + bars))
         do e = 1, size(mesh%element_kind)
            associate (n => element_node_count(mesh%element_kind(e)))
               call list%add_block(mesh%element_nodes(:n, e), mesh%element_nodes(:n, e), &
                  ones(:n, :n))
            end associate
         end do
         do i = 1, bars
            associate (nodes => (model%bars(i)%elongation%places() - 1)/2 + 1)
               call list%add_block(nodes, nodes, ones(:size(nodes), :size(nodes)))
            end associate
         end do
         graph = list%compress(size(mesh%node_number), size(mesh%node_number))
      end associate
   end function joined_nodes

   !> The contact points of one interface. A body that ends at a line of symmetry goes on beyond it,
   !> as a rigid master does.
   pure subroutine view(self, i, points)
      class(reduced_bodies_type), intent(in) :: self !! prepared
      integer, intent(in) :: i                       !! index of the interface
      type(contact_points_type), intent(out) :: points
      integer :: first

      points = self%interfaces(i)
      first = self%points%interface_start(i)
      points%contact_row_type = self%points%part(first, self%points%interface_start(i + 1) - 1)
      if (.not. points%is_rigid .or. .not. allocated(self%held_direction)) return
      associate (ends => points%ends())
         points%at_corner = points%at_corner .and. .not. (on_axis(points, ends) .or. &
            norm2(self%held_direction(:, first - 1 + ends), dim=1) > 0.0_dp)
      end associate
   end subroutine view

   !> Those of all interfaces.
   pure subroutine views(self, interfaces)
      class(reduced_bodies_type), intent(in) :: self !! prepared
      type(contact_points_type), allocatable, intent(out) :: interfaces(:)
      integer :: i

      allocate (interfaces(size(self%interfaces)))
      do i = 1, size(interfaces)
         call self%view(i, interfaces(i))
      end do
   end subroutine views

   !> Enters a step: laws of its contact points, unknowns of its fields. A field is numbered again
   !> only where it is solved and its supports or frictions differ from those that were numbered
   !> last; only then are its factors formed again.
   subroutine enter_step(self, model, step, loads)
      class(reduced_bodies_type), intent(inout) :: self !! prepared
      type(model_type), intent(in) :: model
      integer, intent(in) :: step                            !! its index
      type(loads_type), intent(in) :: loads                  !! supports of the step
      logical :: heat, mechanics

      self%laws = laws_of_step(model, self%points, step)
      associate (prescribed => loads%displacement%active, &
         held_temperature => loads%temperature%active, &
         has_friction => self%laws%friction%coefficient > 0.0_dp)
         mechanics = solves_mechanics(model%steps(step)%analysis)
         heat = solves_heat(model%steps(step)%analysis)
         self%is_coupled = self%couples(model, step)
         if (mechanics .and. allocated(self%prescribed)) mechanics = &
            any(self%prescribed .neqv. prescribed) .or. any(self%has_friction .neqv. has_friction)
         if (heat .and. allocated(self%held_temperature)) then
            heat = any(self%held_temperature .neqv. held_temperature)
         end if
         if (mechanics) then
            if (allocated(self%references)) deallocate (self%references)
            self%prescribed = prescribed
            self%has_friction = has_friction
         end if
         if (heat) self%held_temperature = held_temperature
         call self%number(model, prescribed, held_temperature, mechanics, heat)
      end associate
   end subroutine enter_step

   !> Places the contact points of faces that slide where displacements take these, and numbers the
   !> unknowns anew.
   !> Errors: as match_surfaces.
   subroutine follow_faces(self, model, step, displacement, error)
      class(reduced_bodies_type), intent(inout) :: self !! in a step, with faces that slide
      type(model_type), intent(in) :: model
      integer, intent(in) :: step                            !! its index
      real(dp), intent(in) :: displacement(:)                !! (2 nodes) [length]
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(self%matched)
         if (.not. model%contacts(i)%follows_sliding) cycle
         call match_surfaces(model, i, self%matched(i), error, displacement)
         if (allocated(error)) return
      end do
      self%faces_at = displacement
      self%interfaces = self%matched
      call join_points(self%interfaces, self%matched_ties, model, self%points)
      self%laws = laws_of_step(model, self%points, step)
      if (allocated(self%worn)) then
         self%unworn_gap = self%points%initial_gap
         call self%wear_to((self%worn))
      end if
      self%is_coupled = self%couples(model, step)
      if (allocated(self%prescribed)) self%has_friction = self%laws%friction%coefficient > 0.0_dp
      call self%number(model, self%prescribed, self%held_temperature, allocated(self%prescribed), &
         allocated(self%held_temperature))
   end subroutine follow_faces

   !> Makes wear part of the gaps, in the place of what was.
   pure subroutine wear_to(self, depth)
      class(reduced_bodies_type), intent(inout) :: self !! in a step with laws of wear
      real(dp), intent(in) :: depth(:)                       !! (m) of both faces [length]

      self%worn = depth
      self%points%initial_gap = self%unworn_gap + self%laws%worn_part*depth
   end subroutine wear_to

   !> Whether heat depends on the mechanics of a step, at the contact points as they are placed.
   pure logical function couples(self, model, step)
      class(reduced_bodies_type), intent(in) :: self !! with the laws of the step
      type(model_type), intent(in) :: model
      integer, intent(in) :: step                            !! its index

      associate (analysis => model%steps(step)%analysis)
         couples = solves_heat(analysis) .and. solves_mechanics(analysis) .and. &
            (allocated(self%points%heated) .or. .not. all(is_constant(self%laws%conductance)))
      end associate
   end function couples

   !> How far contact points that follow sliding have moved against their masters from where they
   !> were placed, the farthest one, as a part of their spacing.
   pure real(dp) function displaced_by(self, displacement)
      class(reduced_bodies_type), intent(in) :: self !! with faces that slide
      real(dp), intent(in) :: displacement(:)                !! (2 nodes) [length]
      real(dp) :: moved(size(self%points%slave))
      integer :: i

      displaced_by = 0.0_dp
      moved = self%movement(displacement - self%faces_at)
      do i = 1, size(self%interfaces)
         if (.not. self%interfaces(i)%follows_sliding) cycle
         associate (first => self%points%interface_start(i), edge => self%interfaces(i)%edge)
            displaced_by = max(displaced_by, maxval(moved(first:first + size(edge) - 1)/edge))
         end associate
      end do
   end function displaced_by

   !> Least spacing of contact points that follow sliding.
   pure real(dp) function least_spacing(self) result(least)
      class(reduced_bodies_type), intent(in) :: self !! with faces that slide [length]
      integer :: i

      least = huge(least)
      do i = 1, size(self%interfaces)
         if (self%interfaces(i)%follows_sliding) least = min(least, minval(self%interfaces(i)%edge))
      end do
   end function least_spacing

   !> How far contact points that follow sliding move against their masters; against the first node
   !> of the master, or its reference node, where nothing is opposite.
   pure function movement(self, displacement) result(moved)
      class(reduced_bodies_type), intent(in) :: self !! prepared
      real(dp), intent(in) :: displacement(:)                !! (2 nodes) [length]
      real(dp) :: moved(size(self%points%slave))             !! (m) [length]
      real(dp) :: relative(2, size(moved))
      integer :: k

      relative = self%points%relative(displacement)
      do k = 1, size(moved)
         associate (master => self%points%master(k))
            if (self%points%is_beyond(k)) relative(:, k) = relative(:, k) - &
               displacement(2*master - 1:2*master)
         end associate
      end do
      moved = norm2(relative, dim=1)
   end function movement

   !> Numbers the unknowns of the fields that are asked for, for a set of supports.
   subroutine number(self, model, prescribed, held_temperature, mechanics, heat)
      class(reduced_bodies_type), intent(inout) :: self !! prepared
      type(model_type), intent(in) :: model
      logical, intent(in) :: prescribed(:) !! (2 nodes) prescribed displacements
      logical, intent(in) :: held_temperature(:)             !! (nodes) prescribed temperatures
      logical, intent(in) :: mechanics                       !! whether displacements are numbered
      logical, intent(in) :: heat                            !! whether temperatures are numbered

      associate (points => self%points, used => model%mesh%node_body > 0)
         if (mechanics) then
            self%held_direction = held_directions(points, prescribed)
            call find_motions(self, model, prescribed)
            call constrain_displacements(used, prescribed, points, &
               self%laws%friction%coefficient > 0.0_dp, slave_is_stiffer(model, points, .true.), &
               self%mechanical%map, self%mechanical%division)
            self%mechanical%numbering = self%mechanical%numbering + 1
         end if
         if (.not. heat) return
         call constrain_temperatures(used, held_temperature, points, &
            slave_is_stiffer(model, points, .false.), self%thermal%map, self%thermal%division)
         self%thermal%numbering = self%thermal%numbering + 1
         ! Heat of friction would ask for sharp solutions of other loads.
         self%thermal%changes = any(model%steps%is_transient) .and. size(points%weight) == 0 .and. &
            self%thermal%map%tail == 0 .and. .not. allocated(self%thermal%division%piece) .and. &
            any(melts(model%materials(model%sections%material)))
         if (self%thermal%changes) self%thermal%leading = self%thermal%map%leading_nodes()
         self%jump_index = self%thermal%map%tail_index(self%thermal%map%introduced)
      end associate
   end subroutine number

   !> Finds the motions that the supports leave free, where contact points change any.
   subroutine find_motions(self, model, prescribed)
      type(reduced_bodies_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      logical, intent(in) :: prescribed(:)                   ! (2 nodes)
      integer, allocatable :: references(:)
      ! gfortran never frees the components of a function's result within an array constructor.
      type(joint_type), allocatable :: of_bars(:), of_equations(:), of_ties(:)

      references = self%points%references(model%mesh%node_body == 0)
      if (allocated(self%references)) then
         if (size(references) == size(self%references)) then
            if (all(references == self%references)) return
         end if
      end if
      of_ties = joints_of(self%points%ties)
      of_equations = joints_of(self%points%equations)
      of_bars = joints_of(self%points%elongations)
      call unsupported_motions(model%mesh, prescribed, [of_ties, of_equations, of_bars], &
         references, self%rigid)
      call move_alloc(references, self%references)
   end subroutine find_motions

   !> Whether the slave's body is far stiffer, or conducts far better, than the master's. A soft
   !> body is to be written by the stiff one: the other way round its stiffness would be left over
   !> where those of the stiff one cancel, and their rounding with it.
   pure function slave_is_stiffer(model, points, mechanics) result(stiffer)
      type(model_type), intent(in) :: model
      type(connections_type), intent(in) :: points
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
      ! A rigid master has no stiffness at its reference node: its slave follows.
      stiffer = stiffness(points%slave) > far*stiffness(points%master) .and. &
         stiffness(points%master) > 0.0_dp
   end function slave_is_stiffer

   !> Reduces equilibrium to the unknowns that were numbered last, where that is not done.
   !> Errors: unconstrained bodies, a failure of the solver.
   subroutine reduce(self, model, node_rank, error)
      class(reduced_bodies_type), intent(inout) :: self !! numbered
      type(model_type), intent(in) :: model
      !> (nodes) ranks in nested dissection, where they are known
      integer, allocatable, intent(in) :: node_rank(:)
      type(error_type), allocatable, intent(out) :: error

      if (self%equilibrium%is_of(self%mechanical, sparse_matrix_type())) return
      call self%equilibrium%reduce(model, self%mechanical, self%points, self%rigid, node_rank, &
         error)
   end subroutine reduce

   !> Assembles the matrices that the steps of the model solve with, where that is not done.
   subroutine assemble_steps(self, model)
      class(reduced_bodies_type), intent(inout) :: self !! prepared
      type(model_type), intent(in) :: model
      logical :: changes         ! whether temperatures ever differ from the initial ones
      integer :: i

      if (allocated(self%mechanical%matrix%value)) return
      if (allocated(self%thermal%matrix%value)) return
      associate (mechanics => any(solves_mechanics(model%steps%analysis)), &
         heat => any(solves_heat(model%steps%analysis)))
         changes = heat
         do i = 1, size(model%steps)
            if (.not. allocated(model%steps(i)%loads)) cycle
            changes = changes .or. any(model%steps(i)%loads%kind == load_temperature)
         end do
         call self%form_operators(model, model%initial_temperature, mechanics, heat, &
            with_strain=mechanics .and. changes)
      end associate
      if (any(model%steps%dilates)) call self%dilatation%prepare(model)
   end subroutine assemble_steps

   !> Forms the operators with the properties at given temperatures. Their reductions do not serve
   !> any more.
   subroutine form_operators(self, model, temperature, with_mechanics, with_heat, with_strain)
      class(reduced_bodies_type), intent(inout) :: self !! prepared
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: temperature(:)                 !! (nodes)
      logical, intent(in) :: with_mechanics                  !! whether any step solves mechanics
      logical, intent(in) :: with_heat                       !! whether any step solves heat
      logical, intent(in) :: with_strain !! whether temperatures strain the bodies in any step
      type(point_materials_type) :: points

      associate (mesh => model%mesh, sections => model%sections, materials => model%materials)
         points%has_inverses = .false.
         call points%place(mesh, sections, materials, model%orientations, integration_rules())
         if (any(varies(materials(sections%material)))) then
            call points%set_temperature(mesh, temperature, model%initial_temperature)
            self%operators_at = temperature
         end if
         if (allocated(self%tangent)) call points%take_tangents(mesh, self%tangent)
         if (with_mechanics) call self%mechanical%set_matrix(assemble_stiffness(mesh, sections, &
            points), self%points%along_z)
         if (with_strain) self%thermal_load = assemble_thermal_load(mesh, sections, points)
         if (with_mechanics .and. allocated(model%bars)) call add_bars(self, model, with_strain)
         if (with_heat) call self%thermal%set_matrix(assemble_conduction(mesh, sections, points))
         if (any(model%steps%is_transient .or. model%steps%stability_frequency > 0)) then
            self%capacity = assemble_capacity(mesh, sections, capacities(model, temperature))
            if (any(melts(materials))) self%sensible = self%capacity%value
            if (allocated(self%melting)) call add_melting(self)
         end if
      end associate
   end subroutine form_operators

   !> Adds the springs and trusses to the matrices of the bodies.
   subroutine add_bars(self, model, with_strain)
      type(reduced_bodies_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      logical, intent(in) :: with_strain

      if (size(model%bars) == 0) return
      associate (nodes => size(model%mesh%node_number))
         self%bar_stiffness = bar_stiffness(model%bars, nodes)
         call self%mechanical%set_matrix(linear_combination(1.0_dp, self%mechanical%matrix, &
            1.0_dp, self%bar_stiffness), self%points%along_z)
         if (.not. with_strain) return
         self%bar_load = bar_thermal_load(model%bars, nodes)
         self%thermal_load = linear_combination(1.0_dp, self%thermal_load, 1.0_dp, self%bar_load)
      end associate
   end subroutine add_bars

   !> Forms the operators that there are at other temperatures and tangents.
   subroutine move_operators(self, model, temperature, tangent)
      class(reduced_bodies_type), intent(inout) :: self !! assembled
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: temperature(:)                 !! (nodes)
      real(dp), allocatable, intent(in) :: tangent(:)        !! of stress at points, or none

      if (allocated(self%tangent)) deallocate (self%tangent)
      if (allocated(tangent)) self%tangent = tangent
      call self%form_operators(model, temperature, allocated(self%mechanical%matrix%value), &
         allocated(self%thermal%matrix%value), allocated(self%thermal_load%value))
   end subroutine move_operators

   !> Gives C the slopes of latent heat.
   pure subroutine set_melting(self, slopes)
      class(reduced_bodies_type), intent(inout) :: self !! assembled
      real(dp), intent(in) :: slopes(:)                      !! (nodes) [energy/temperature]

      if (allocated(self%melting)) then
         if (all(abs(self%melting - slopes) <= 0.0_dp)) return
      end if
      self%melting = slopes
      call add_melting(self)
   end subroutine set_melting

   pure subroutine add_melting(self)
      type(reduced_bodies_type), intent(inout) :: self
      integer :: i, k

      associate (c => self%capacity)
         c%value(:) = self%sensible
         do i = 1, size(self%melting)
            if (self%melting(i) <= 0.0_dp) cycle
            k = c%row_start(i) - 1 + findloc(c%column(c%row_start(i):c%row_start(i + 1) - 1), i, &
               dim=1)
            c%value(k) = c%value(k) + self%melting(i)
         end do
      end associate
   end subroutine add_melting

   !> Whether the operators are those of temperatures and tangents.
   pure logical function has_operators_of(self, temperature, tangent) result(has)
      class(reduced_bodies_type), intent(in) :: self !! assembled
      real(dp), intent(in) :: temperature(:)                 !! (nodes)
      real(dp), allocatable, intent(in) :: tangent(:)        !! of stress at points, or none

      has = allocated(tangent) .eqv. allocated(self%tangent)
      if (has) has = all(abs(self%operators_at - temperature) <= 0.0_dp)
      if (has .and. allocated(tangent)) has = all(abs(self%tangent - tangent) <= 0.0_dp)
   end function has_operators_of

   !> Nodal forces, those along z, which act on whole bodies, divided by how much stiffer bodies are
   !> against them.
   pure function evened(self, forces) result(even)
      class(reduced_bodies_type), intent(in) :: self !! assembled
      real(dp), intent(in) :: forces(:)                      !! (2 nodes)
      real(dp) :: even(size(forces))                         !! (2 nodes)

      even = forces
      if (allocated(self%mechanical%lever)) even(self%points%along_z) = &
         forces(self%points%along_z)/self%mechanical%lever
   end function evened

   !> The largest displacement in the plane.
   pure real(dp) function largest_displacement(self, displacement) result(largest)
      class(reduced_bodies_type), intent(in) :: self
      real(dp), intent(in) :: displacement(:)                !! (2 nodes) [length]
      real(dp), allocatable :: in_plane(:)

      if (.not. allocated(self%points%along_z)) then
         largest = maxval(abs(displacement))
         return
      end if
      in_plane = displacement
      in_plane(self%points%along_z) = 0.0_dp
      largest = maxval(abs(in_plane))
   end function largest_displacement

   !> rho c of the elements at the means of temperatures of their nodes.
   pure function capacities(model, temperature) result(capacity)
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: temperature(:)
      real(dp) :: capacity(size(model%mesh%element_kind))
      integer :: e

      do e = 1, size(capacity)
         associate (material => model%materials(model%sections(model%mesh%element_section(e))% &
            material), nodes => model%mesh%element_nodes(:element_node_count( &
            model%mesh%element_kind(e)), e))
            capacity(e) = heat_capacity(material)
            if (follows_temperature(material)) capacity(e) = heat_capacity_at(material, &
               sum(temperature(nodes))/size(nodes))
         end associate
      end do
   end function capacities

end module reduced_bodies
