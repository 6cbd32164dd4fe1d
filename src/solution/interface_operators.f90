!> The bodies reduced once to their contact unknowns: everything that the fixed-point iteration
!> needs, on the pairs alone.
module interface_operators
   use bodies, only: bodies_on_axis
   use body_names, only: cold_bodies
   use conductance_laws, only: conductance_law_type
   use contact_pairs, only: contact_pairs_type, make_pairs
   use contact_system, only: contact_system_type
   use dense, only: column_space
   use equation_numbering, only: make_map
   use element_kinds, only: element_node_count
   use errors, only: error_type
   use field_problem, only: field_problem_type
   use kinds, only: dp
   use model, only: model_type
   use rigid_motions, only: unsupported_motions
   use ring_links, only: node_stiffness, ring_give
   use sparse_matrix, only: sparse_matrix_type
   use stiffness_matrix, only: assemble_stiffness, assemble_thermal_load
   use thermal_matrix, only: assemble_conduction
   implicit none
   private
   public :: interface_operators_type, pair_row_type, pair_surfaces, over_constrained

   real(dp), parameter :: nearly_aligned = 0.99_dp !! cosine of a normal that counts as along an
   !! axis
   real(dp), parameter :: far = 1.0e3_dp        !! ratio of stiffnesses that are far apart
   integer, parameter :: columns_at_once = 32   !! jumps whose responses are formed together

   !> The pairs of all interfaces in one row.
   type :: pair_row_type
      integer, allocatable :: interface_start(:)              !! (interfaces + 1) first pair of each
      integer, allocatable :: slave(:), master(:)             !! (m) node indexes
      real(dp), allocatable :: weight(:)                      !! (m) tributary areas [length^2]
      real(dp), allocatable :: initial_gap(:)                 !! (m) h [length]
      real(dp), allocatable :: friction(:)                    !! (m) mu [-]
      real(dp), allocatable :: normal(:, :), tangent(:, :)    !! (2, m) unit vectors
      type(conductance_law_type), allocatable :: law(:)       !! (m) conductance laws
   end type pair_row_type

   !> The reduced bodies.
   type :: interface_operators_type
      type(contact_pairs_type), allocatable :: interfaces(:)  !! interfaces in the order of the deck
      type(pair_row_type) :: pairs                            !! all their pairs
      type(field_problem_type) :: thermal                     !! heat, (3.3)
      type(field_problem_type) :: mechanical                  !! equilibrium, (2.4)
      type(sparse_matrix_type) :: thermal_load                !! nodal forces per nodal temperature
      type(contact_system_type) :: contact                    !! the partial solution of (2.4)
      real(dp), allocatable :: rigid(:, :)  !! (2 nodes, motions) that the supports leave free
      integer, allocatable :: jump_place(:) !! (m) place of the jump on the tail, 0 where held
      !> (mechanical tail, thermal tail) condensed mechanical load per jump; formed where coupled.
      real(dp), allocatable :: jump_load(:, :)
      logical :: is_coupled = .false.   !! whether heat and mechanics are solved together
   contains
      procedure :: prepare
      procedure :: number
      procedure :: assemble
      procedure :: reduce
      procedure :: reduce_heat
      procedure :: set_film
      procedure :: release
   end type interface_operators_type

contains

   !> Pairs the surfaces, unless the caller has already put the pairs in place.
   !> Error: as make_pairs.
   subroutine prepare(self, model, error)
      class(interface_operators_type), intent(inout) :: self !! empty
      type(model_type), intent(in) :: model                  !! the model
      type(error_type), allocatable, intent(out) :: error    !! see above
      integer :: i

      if (.not. allocated(self%interfaces)) then
         allocate (self%interfaces(size(model%contacts)))
         do i = 1, size(model%contacts)
            call pair_surfaces(model, i, self%interfaces(i), error)
            if (allocated(error)) return
         end do
      end if
      self%pairs = row_of(self%interfaces, model)
   end subroutine prepare

   !> Pairs the surfaces of one *CONTACT PAIR, with the thickness of the slave's first element.
   !> Error: as make_pairs.
   subroutine pair_surfaces(model, i, pairs, error)
      type(model_type), intent(in) :: model               !! the model
      integer, intent(in) :: i                            !! index into model%contacts
      type(contact_pairs_type), intent(out) :: pairs      !! the pairs
      type(error_type), allocatable, intent(out) :: error !! see above
      real(dp) :: thickness

      thickness = 1.0_dp
      associate (faces => model%mesh%surfaces(model%contacts(i)%slave)%faces)
         if (size(faces, 2) > 0) then
            thickness = model%sections(model%mesh%element_section(faces(1, 1)))%thickness
         end if
      end associate
      call make_pairs(model%mesh, model%contacts(i), thickness, pairs, error)
   end subroutine pair_surfaces

   !> Puts the pairs of all interfaces in one row.
   pure function row_of(interfaces, model) result(row)
      type(contact_pairs_type), intent(in) :: interfaces(:)
      type(model_type), intent(in) :: model
      type(pair_row_type) :: row
      integer :: i, first, last, m

      allocate (row%interface_start(size(interfaces) + 1))
      row%interface_start(1) = 1
      do i = 1, size(interfaces)
         row%interface_start(i + 1) = row%interface_start(i) + size(interfaces(i)%slave_node)
      end do
      m = row%interface_start(size(interfaces) + 1) - 1
      allocate (row%slave(m), row%master(m), row%weight(m), row%initial_gap(m), row%friction(m), &
         row%normal(2, m), row%tangent(2, m), row%law(m))
      do i = 1, size(interfaces)
         first = row%interface_start(i)
         last = row%interface_start(i + 1) - 1
         row%slave(first:last) = interfaces(i)%slave_node
         row%master(first:last) = interfaces(i)%master_node
         row%weight(first:last) = interfaces(i)%weight
         row%initial_gap(first:last) = interfaces(i)%initial_gap
         row%normal(:, first:last) = interfaces(i)%normal
         row%tangent(:, first:last) = interfaces(i)%tangent
         row%friction(first:last) = model%interactions(model%contacts(i)%interaction)%friction
         row%law(first:last) = model%interactions(model%contacts(i)%interaction)%law
      end do
   end function row_of

   !> Numbers the unknowns of the fields that are asked for, for a set of supports.
   !> Error: an over-constrained pair.
   subroutine number(self, model, held, held_temperature, mechanics, heat, error)
      class(interface_operators_type), intent(inout) :: self !! prepared
      type(model_type), intent(in) :: model                  !! the model
      logical, intent(in) :: held(:)                         !! (2 nodes) prescribed displacements
      logical, intent(in) :: held_temperature(:)             !! (nodes) prescribed temperatures
      logical, intent(in) :: mechanics                       !! whether displacements are numbered
      logical, intent(in) :: heat                            !! whether temperatures are numbered
      type(error_type), allocatable, intent(out) :: error    !! see above
      real(dp) :: frame(2, 2, size(self%pairs%slave)), scalar(1, 1, size(self%pairs%slave))
      logical :: on_tail(2, size(self%pairs%slave))

      if (mechanics) then
         call align_frames(self%pairs, held)
         call unsupported_motions(model%mesh%coordinates, model%mesh%node_body, &
            bodies_on_axis(model%mesh), held, self%rigid)
      end if
      associate (pairs => self%pairs, used => model%mesh%node_body > 0)
         frame(:, 1, :) = pairs%normal
         frame(:, 2, :) = pairs%tangent
         on_tail(1, :) = .true.
         on_tail(2, :) = pairs%friction > 0.0_dp
         if (mechanics) call make_map(used, held, pairs%slave, pairs%master, frame, on_tail, &
            self%mechanical%map, error, slave_is_stiffer(model, pairs, .true.))
         if (allocated(error) .or. .not. heat) return
         scalar = 1.0_dp
         call make_map(used, held_temperature, pairs%slave, pairs%master, scalar, on_tail(:1, :), &
            self%thermal%map, error, slave_is_stiffer(model, pairs, .false.))
      end associate
   end subroutine number

   !> Whether the slave's body is far stiffer, or conducts far better, than the master's. A soft
   !> body is to be written by the stiff one: the other way round its stiffness would be left over
   !> where those of the stiff one cancel, and their rounding with it.
   pure function slave_is_stiffer(model, pairs, mechanics) result(stiffer)
      type(model_type), intent(in) :: model
      type(pair_row_type), intent(in) :: pairs
      logical, intent(in) :: mechanics
      logical :: stiffer(size(pairs%slave))
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
      stiffer = stiffness(pairs%slave) > far*stiffness(pairs%master)
   end function slave_is_stiffer

   !> Reduces the fields that are asked for to the unknowns that were numbered last.
   !> Errors: bodies that nothing holds, a failure of the solver.
   subroutine reduce(self, model, mechanics, heat, coupled, error)
      class(interface_operators_type), intent(inout) :: self !! numbered
      type(model_type), intent(in) :: model                  !! the model
      logical, intent(in) :: mechanics                       !! whether mechanics is reduced anew
      logical, intent(in) :: heat                            !! whether heat is reduced anew
      logical, intent(in) :: coupled                         !! whether both are solved together
      type(error_type), allocatable, intent(out) :: error    !! see above

      self%is_coupled = coupled
      if (mechanics) then
         if (allocated(self%jump_load)) deallocate (self%jump_load)
         call self%mechanical%reduce(model%solver, error)
         if (allocated(error)) return
         call set_contact(self)
      end if
      if (heat) then
         call self%reduce_heat(model, error)
      else if (coupled .and. .not. allocated(self%jump_load)) then
         call form_jump_load(self)
      end if
   end subroutine reduce

   !> Reduces the heat problem to the jumps.
   !> Errors: bodies whose temperature nothing determines, a failure of the solver.
   subroutine reduce_heat(self, model, error)
      class(interface_operators_type), intent(inout) :: self !! numbered
      type(model_type), intent(in) :: model                  !! the model
      type(error_type), allocatable, intent(out) :: error    !! see above

      call self%thermal%reduce(model%solver, error)
      if (allocated(error)) then
         call name_cold_bodies(self, model, error)
         return
      end if
      associate (map => self%thermal%map)
         self%jump_place = map%tail_index(map%relative(1, :))
      end associate
      if (allocated(self%jump_load)) deallocate (self%jump_load)
      if (self%is_coupled) call form_jump_load(self)
   end subroutine reduce_heat

   !> Names the bodies that leave the heat problem singular: no prescribed temperature and no film
   !> stands on them or on a body that pairs join to them.
   subroutine name_cold_bodies(self, model, error)
      type(interface_operators_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(error_type), intent(inout) :: error
      logical :: warm(size(model%mesh%node_body))
      character(:), allocatable :: words

      warm = self%thermal%map%base(:size(warm)) > 0
      if (allocated(self%thermal%added%value)) then
         warm(pack(self%thermal%added%column, self%thermal%added%value > 0.0_dp)) = .true.
      end if
      words = cold_bodies(model, warm, self%pairs%slave, self%pairs%master)
      if (len(words) > 0) error%message = words//': no *BOUNDARY on dof 11 and no *FILM with a '// &
         'coefficient above 0 at this time fixes it'
   end subroutine name_cold_bodies

   !> Takes the films of an increment; where they differ from those of the factors, the heat problem
   !> is reduced again.
   !> Errors: as reduce_heat.
   subroutine set_film(self, film, model, error)
      class(interface_operators_type), intent(inout) :: self !! reduced
      type(sparse_matrix_type), intent(in) :: film !! (nodes, nodes) [power/temperature]
      type(model_type), intent(in) :: model                  !! the model
      type(error_type), allocatable, intent(out) :: error    !! see above

      if (same_values(film, self%thermal%added)) return
      self%thermal%added = film
      call self%reduce_heat(model, error)
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
      class(interface_operators_type), intent(inout) :: self !! prepared
      type(model_type), intent(in) :: model                  !! the model
      logical, intent(in) :: with_mechanics                  !! whether any step solves mechanics
      logical, intent(in) :: with_heat                       !! whether any step solves heat
      logical, intent(in) :: with_strain !! whether temperatures strain the bodies in any step

      if (with_mechanics) self%mechanical%matrix = assemble_stiffness(model%mesh, &
         model%sections, model%materials, model%orientations)
      if (with_strain) self%thermal_load = assemble_thermal_load(model%mesh, model%sections, &
         model%materials, model%orientations)
      if (with_heat) self%thermal%matrix = assemble_conduction(model%mesh, model%sections, &
         model%materials, model%orientations)
   end subroutine assemble

   !> A pair that is held along one axis on both nodes, as on an axis of symmetry, moves along the
   !> other one. Its normal, which a curved side gives only nearly so, is then taken along the axes.
   pure subroutine align_frames(pairs, held)
      type(pair_row_type), intent(inout) :: pairs
      logical, intent(in) :: held(:)
      logical :: both(2)
      integer :: along, k

      do k = 1, size(pairs%slave)
         both = held(2*pairs%slave(k) - 1:2*pairs%slave(k)) .and. &
            held(2*pairs%master(k) - 1:2*pairs%master(k))
         if (both(1) .eqv. both(2)) cycle
         along = merge(2, 1, both(1))
         if (abs(pairs%normal(along, k)) < nearly_aligned) cycle
         pairs%normal(3 - along, k) = 0.0_dp
         pairs%normal(along, k) = sign(1.0_dp, pairs%normal(along, k))
         pairs%tangent(along, k) = 0.0_dp
         pairs%tangent(3 - along, k) = sign(1.0_dp, pairs%tangent(3 - along, k))
      end do
   end subroutine align_frames

   !> Pairs whose normal motion is prescribed on both nodes, or their motion along a direction that
   !> is neither their normal nor their tangent, once frames are aligned.
   pure function over_constrained(pairs, held) result(too_much)
      type(pair_row_type), intent(in) :: pairs     !! the pairs
      logical, intent(in) :: held(:)               !! (2 nodes) prescribed displacements
      logical :: too_much(size(pairs%slave))       !! (m)
      logical :: both(2)
      integer :: k

      do k = 1, size(pairs%slave)
         both = held(2*pairs%slave(k) - 1:2*pairs%slave(k)) .and. &
            held(2*pairs%master(k) - 1:2*pairs%master(k))
         too_much(k) = any(both) .and. (all(both) .or. &
            abs(pairs%normal(merge(2, 1, both(1)), k)) < nearly_aligned)
      end do
   end function over_constrained

   !> The contact system from the mechanical Schur complement.
   subroutine set_contact(self)
      class(interface_operators_type), intent(inout) :: self
      type(contact_system_type) :: contact

      allocate (contact%normal(size(self%pairs%slave)), contact%tangent(size(self%pairs%slave)))
      associate (map => self%mechanical%map)
         contact%normal(:) = map%tail_index(map%relative(1, :))
         contact%tangent(:) = map%tail_index(map%relative(2, :))
      end associate
      contact%schur = self%mechanical%solver%schur_complement()
      call set_motions(self, contact)
      allocate (contact%closing(size(self%pairs%slave)))
      contact%initial_gap = self%pairs%initial_gap
      contact%friction = self%pairs%friction
      call set_rings(self, contact)
      self%contact = contact
   end subroutine set_contact

   !> The rigid motions that the supports leave free, on the tail. In exact arithmetic they need no
   !> force; what S makes of them is rounding, and is taken from it.
   subroutine set_motions(self, contact)
      class(interface_operators_type), intent(in) :: self
      type(contact_system_type), intent(inout) :: contact
      real(dp), allocatable :: forces(:, :), on_tail(:, :), relative(:, :)
      integer :: k, m, s

      allocate (on_tail(size(contact%schur, 1), size(self%rigid, 2)), source=0.0_dp)
      do k = 1, size(self%pairs%slave)
         s = 2*self%pairs%slave(k)
         m = 2*self%pairs%master(k)
         relative = self%rigid(s - 1:s, :) - self%rigid(m - 1:m, :)
         on_tail(contact%normal(k), :) = matmul(self%pairs%normal(:, k), relative)
         if (contact%tangent(k) > 0) then
            on_tail(contact%tangent(k), :) = matmul(self%pairs%tangent(:, k), relative)
         end if
      end do
      contact%motion = column_space(on_tail)
      if (size(contact%motion, 2) == 0) return
      associate (z => contact%motion)
         forces = matmul(contact%schur, z)
         contact%schur = contact%schur - matmul(forces, transpose(z)) - &
            matmul(z, transpose(forces)) + &
            matmul(z, matmul(matmul(transpose(z), forces), transpose(z)))
      end associate
   end subroutine set_motions

   !> The links of the rings, and how much their stuck pairs give.
   subroutine set_rings(self, contact)
      class(interface_operators_type), intent(in) :: self
      type(contact_system_type), intent(inout) :: contact
      integer :: k

      associate (map => self%mechanical%map, pairs => self%pairs)
         contact%link = map%tail_index(map%links%force)
         allocate (contact%give(size(pairs%slave)), source=0.0_dp)
         do k = 1, size(pairs%slave)
            if (map%in_ring(k)) contact%give(k) = ring_give/node_stiffness( &
               self%mechanical%matrix, [pairs%slave(k), pairs%master(k)], 2)
         end do
      end associate
   end subroutine set_rings

   !> Condensed mechanical load of a unit jump at each pair.
   subroutine form_jump_load(self)
      class(interface_operators_type), intent(inout) :: self
      real(dp), allocatable :: temperature(:, :)
      integer :: first, last, tail

      tail = self%thermal%map%tail
      allocate (self%jump_load(self%mechanical%map%tail, tail))
      do first = 1, tail, columns_at_once
         last = min(first + columns_at_once - 1, tail)
         allocate (temperature(self%thermal%matrix%row_count, last - first + 1))
         call self%thermal%unit_responses(first, temperature)
         call condense_thermal_load(self, temperature, self%jump_load(:, first:last))
         deallocate (temperature)
      end do
   end subroutine form_jump_load

   !> Condensed mechanical loads of fields of temperature.
   subroutine condense_thermal_load(self, temperature, condensed)
      class(interface_operators_type), intent(inout) :: self !! the reduced bodies
      real(dp), intent(in) :: temperature(:, :) !! (nodes, columns) over the natural state
      real(dp), intent(out) :: condensed(:, :)               !! (mechanical tail, columns)
      real(dp) :: forces(self%thermal_load%row_count, size(temperature, 2))
      integer :: k

      do k = 1, size(temperature, 2)
         forces(:, k) = self%thermal_load%multiply(temperature(:, k))
      end do
      call self%mechanical%condense_forces(forces, condensed)
   end subroutine condense_thermal_load

   !> Frees the factors.
   subroutine release(self)
      class(interface_operators_type), intent(inout) :: self !! the reduced bodies

      call self%thermal%release()
      call self%mechanical%release()
   end subroutine release

end module interface_operators
