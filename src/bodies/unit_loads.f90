!> Locations on which the steps of a model put loads, and what loads of unit strength do to the
!> nodes there, integrated once. A location is a kind of load on a component of a node or element;
!> one that a step loads several times has as many entries, one behind the other.
module unit_loads
   use element_integrals, only: body_moments, side_mass, side_pressure, side_weights
   use element_kinds, only: axisymmetric, element_node_count, side_nodes
   use kinds, only: dp
   use model, only: model_type
   use sorting, only: sort_order
   use sparse_matrix, only: sparse_matrix_type, triplet_list_type
   use steps, only: load_body_force, load_body_heat, load_centrifugal, load_face_heat, &
      load_film_coefficient, load_force, load_gravity, load_nodal_heat, load_pressure, &
      load_traction, load_type, step_type
   implicit none
   private
   public :: find_locations, entries_of, same_location, integrated, unit_loads_type

   integer, parameter :: most_side_nodes = 3   !! nodes of a quadratic side

   !> A side with a film.
   type :: film_side_type
      integer :: coefficient = 0               !! location of its coefficient
      integer :: sink = 0                      !! location of its sink temperature
      integer, allocatable :: nodes(:)         !! (n) nodes
      real(dp), allocatable :: mass(:, :)      !! (n, n) integral of psi^p psi^q [length^2]
   end type film_side_type

   !> Sums over the locations on which the deck puts loads.
   type :: unit_loads_type
      !> (2 nodes, locations) nodal forces [force per unit of the load]
      type(sparse_matrix_type) :: forces
      !> (nodes, locations) nodal heat, for films of unit coefficient and sink [power]
      type(sparse_matrix_type) :: heat
      real(dp), allocatable, private :: total_heat(:)         !! (locations) sums of its columns
      type(film_side_type), allocatable, private :: films(:)  !! sides with a film
   contains
      procedure :: with_films
      procedure :: film_matrix
      procedure :: location_heat
   end type unit_loads_type

contains

   !> Locations of all steps, ordered by kind, item and component.
   pure function find_locations(steps) result(locations)
      type(step_type), intent(in) :: steps(:)
      type(load_type), allocatable :: locations(:)   !! each with the entries of its fullest step
      type(load_type), allocatable :: loads(:), all(:)
      integer, allocatable :: ranks(:), order(:)
      logical, allocatable :: first(:)
      integer :: s, i, n

      allocate (all(0), ranks(0))
      do s = 1, size(steps)
         if (.not. allocated(steps(s)%loads)) cycle
         loads = steps(s)%loads(location_order(steps(s)%loads))
         all = [all, loads]
         n = size(ranks)
         ranks = [ranks, spread(1, 1, size(loads))]
         do i = 2, size(loads)
            ! Rank of the load among those at its location.
            if (same_location(loads(i), loads(i - 1))) ranks(n + i) = ranks(n + i - 1) + 1
         end do
      end do
      order = sort_order(ranks)
      order = order(location_order(all(order)))
      all = all(order)
      ranks = ranks(order)
      allocate (first(size(all)), source=.true.)
      do i = 2, size(all)
         first(i) = ranks(i) /= ranks(i - 1) .or. .not. same_location(all(i), all(i - 1))
      end do
      locations = pack(all, first)
   end function find_locations

   !> The order of loads by kind, item and component; loads on one location keep theirs.
   pure function location_order(loads) result(order)
      type(load_type), intent(in) :: loads(:)
      integer :: order(size(loads))

      order = sort_order(loads%component)
      order = order(sort_order(loads(order)%item))
      order = order(sort_order(loads(order)%kind))
   end function location_order

   !> Whether two loads or entries are of one location.
   pure logical function same_location(one, other)
      type(load_type), intent(in) :: one, other

      same_location = one%kind == other%kind .and. one%item == other%item .and. &
         one%component == other%component
   end function same_location

   !> Entry that each load of a step takes.
   pure function entries_of(locations, loads) result(entries)
      type(load_type), intent(in) :: locations(:)    !! locations that hold all of the loads
      type(load_type), intent(in) :: loads(:)        !! (m) loads of one step
      integer :: entries(size(loads))                !! (m) each entry once
      integer :: order(size(loads)), i, location

      order = location_order(loads)
      location = 0
      do i = 1, size(loads)
         location = location + 1
         do while (.not. same_location(locations(location), loads(order(i))))
            location = location + 1
         end do
         entries(order(i)) = location
      end do
   end function entries_of

   !> Integrates a unit load on each location. Cards give coefficients and sinks of films for the
   !> same sides, in one order.
   pure function integrated(model, locations) result(unit)
      type(model_type), intent(in) :: model
      type(load_type), intent(in) :: locations(:)          !! what the loads act on
      type(unit_loads_type) :: unit
      real(dp), allocatable :: x(:, :)
      real(dp) :: thickness
      integer :: first, i, n
      logical :: is_axisymmetric

      n = count(locations%kind == load_film_coefficient)
      first = findloc(locations%kind, load_film_coefficient, dim=1)
      allocate (unit%films(n))
      do i = 1, n
         associate (film => unit%films(i), location => locations(first + i - 1))
            film%coefficient = first + i - 1
            film%sink = film%coefficient + n
            call find_domain(model, location%item, location%component, film%nodes, x, thickness, &
               is_axisymmetric)
            film%mass = side_mass(x, thickness, is_axisymmetric)
         end associate
      end do
      call integrate_columns(unit, model, locations)
   end function integrated

   !> Nodal forces and heat, a column for each location.
   pure subroutine integrate_columns(unit, model, locations)
      type(unit_loads_type), intent(inout) :: unit
      type(model_type), intent(in) :: model
      type(load_type), intent(in) :: locations(:)
      type(triplet_list_type) :: forces, heat
      integer, allocatable :: nodes(:)
      real(dp), allocatable :: unit_force(:, :), rate(:)
      integer :: i

      associate (n => size(locations), most_nodes => size(model%mesh%element_nodes, 1))
         call forces%reserve(2*most_nodes*n)
         call heat%reserve(most_nodes*n)
         do i = 1, n
            call integrate(model, locations(i), nodes, unit_force, rate)
            if (allocated(unit_force)) then
               call forces%add_block(2*nodes - 1, [i], transpose(unit_force(1:1, :)))
               call forces%add_block(2*nodes, [i], transpose(unit_force(2:2, :)))
            else if (allocated(rate)) then
               call heat%add_block(nodes, [i], reshape(rate, [size(rate), 1]))
            end if
         end do
         do i = 1, size(unit%films)
            associate (film => unit%films(i))
               call heat%add_block(film%nodes, [film%coefficient], &
                  reshape(sum(film%mass, dim=2), [size(film%nodes), 1]))
            end associate
         end do
         unit%forces = forces%compress(2*size(model%mesh%node_number), n)
         unit%heat = heat%compress(size(model%mesh%node_number), n)
         allocate (unit%total_heat(n), source=0.0_dp)
      end associate
      do i = 1, size(unit%heat%value)
         associate (total => unit%total_heat(unit%heat%column(i)))
            total = total + unit%heat%value(i)
         end associate
      end do
   end subroutine integrate_columns

   !> Nodal forces or heat rates of a unit load, the others unallocated; those of films follow from
   !> their sides.
   pure subroutine integrate(model, location, nodes, forces, heat)
      type(model_type), intent(in) :: model
      type(load_type), intent(in) :: location
      integer, allocatable, intent(out) :: nodes(:)      !! (n)
      real(dp), allocatable, intent(out) :: forces(:, :) !! (2, n) [force per unit of the load]
      real(dp), allocatable, intent(out) :: heat(:)      !! (n) [power per unit of the load]
      real(dp), allocatable :: moments(:, :), x(:, :), weights(:)
      real(dp) :: thickness
      logical :: is_axisymmetric

      associate (kind => location%kind, item => location%item, component => location%component)
         select case (kind)
         case (load_force, load_nodal_heat)
            nodes = [item]
            weights = [1.0_dp]
         case (load_pressure)
            call find_domain(model, item, component, nodes, x, thickness, is_axisymmetric)
            forces = side_pressure(x, thickness, is_axisymmetric)
         case (load_face_heat, load_traction)
            call find_domain(model, item, merge(component, (component + 1)/2, &
               kind == load_face_heat), nodes, x, thickness, is_axisymmetric)
            weights = side_weights(x, thickness, is_axisymmetric)
         case (load_body_force, load_gravity, load_body_heat, load_centrifugal)
            call find_domain(model, item, 0, nodes, x, thickness, is_axisymmetric)
            moments = body_moments(model%mesh%element_kind(item), x, thickness, is_axisymmetric)
            weights = moments(1, :)
            if (kind == load_centrifugal) forces = turning_forces(moments, component)
         case default
            return
         end select
         select case (kind)
         case (load_nodal_heat, load_face_heat, load_body_heat)
            heat = weights
         case (load_force, load_traction, load_body_force, load_gravity)
            allocate (forces(2, size(nodes)), source=0.0_dp)
            forces(2 - mod(component, 2), :) = weights
         case default
            continue
         end select
         if (kind == load_gravity .or. kind == load_centrifugal) forces = model%materials( &
            model%sections(model%mesh%element_section(item))%material)%density*forces
      end associate
   end subroutine integrate

   !> Nodal forces of one component of load_centrifugal, by the density.
   pure function turning_forces(moments, component) result(forces)
      real(dp), intent(in) :: moments(:, :)                !! (3, n) as from body_moments
      integer, intent(in) :: component
      real(dp) :: forces(2, size(moments, 2))

      forces = 0.0_dp
      select case (component)
      case (1, 2)
         forces(component, :) = moments(component + 1, :)
      case (3, 4)
         forces(component - 2, :) = moments(1, :)
      case default
         forces(1, :) = moments(2, :)
      end select
   end function turning_forces

   !> Data of an integral over a side of an element, or over all of it.
   pure subroutine find_domain(model, element, side, nodes, x, thickness, is_axisymmetric)
      type(model_type), intent(in) :: model
      integer, intent(in) :: element, side                 !! side 0 for the whole element
      integer, allocatable, intent(out) :: nodes(:)        !! (n)
      real(dp), allocatable, intent(out) :: x(:, :)        !! (2, n) coordinates [length]
      real(dp), intent(out) :: thickness                   !! [length]
      logical, intent(out) :: is_axisymmetric                        !! whether x is a radius

      associate (mesh => model%mesh)
         if (side > 0) then
            nodes = mesh%element_nodes(side_nodes(mesh%element_kind(element), side), element)
         else
            nodes = mesh%element_nodes(:element_node_count(mesh%element_kind(element)), element)
         end if
         x = mesh%coordinates(:, nodes)
         thickness = model%sections(mesh%element_section(element))%thickness
         is_axisymmetric = mesh%element_plane(element) == axisymmetric
      end associate
   end subroutine find_domain

   !> Values by which the columns of heat count: a film by its coefficient times its sink.
   pure function with_films(self, value) result(strength)
      class(unit_loads_type), intent(in) :: self
      real(dp), intent(in) :: value(:)                     !! (locations) present values
      real(dp) :: strength(size(value))

      strength = value
      associate (films => self%films)
         strength(films%coefficient) = value(films%coefficient)*value(films%sink)
      end associate
   end function with_films

   !> Contribution of films to the conduction matrix, both triangles; without values where no heat
   !> crosses a film.
   pure function film_matrix(self, value, nodes) result(matrix)
      class(unit_loads_type), intent(in) :: self
      real(dp), intent(in) :: value(:)        !! (locations) present values
      integer, intent(in) :: nodes            !! number of nodes of the model
      type(sparse_matrix_type) :: matrix      !! (nodes, nodes) [power/temperature]
      type(triplet_list_type) :: list
      integer :: i

      call list%reserve(most_side_nodes**2*size(self%films))
      do i = 1, size(self%films)
         associate (film => self%films(i), coefficient => value(self%films(i)%coefficient))
            if (abs(coefficient) <= 0.0_dp) cycle
            call list%add_block(film%nodes, film%nodes, coefficient*film%mass)
         end associate
      end do
      if (list%length > 0) matrix = list%compress(nodes, nodes)
   end function film_matrix

   !> Net heat that the load on each location brings into the bodies.
   pure function location_heat(self, value, temperature) result(heat)
      class(unit_loads_type), intent(in) :: self
      real(dp), intent(in) :: value(:)          !! (locations) present values
      real(dp), intent(in) :: temperature(:)    !! (nodes) [temperature]
      real(dp) :: heat(size(value))             !! (locations) [power]
      integer :: i

      heat = self%total_heat*self%with_films(value)
      do i = 1, size(self%films)
         associate (film => self%films(i))
            heat(film%coefficient) = heat(film%coefficient) - value(film%coefficient)* &
               sum(matmul(film%mass, temperature(film%nodes)))
         end associate
      end do
   end function location_heat

end module unit_loads
