!> What loads of unit strength do to the nodes, integrated once, and what their present values make
!> of it.
module unit_loads
   use kinds, only: dp
   use load_integrals, only: film_side, unit_forces, unit_heat
   use load_locations, only: load_locations_type
   use model, only: model_type
   use sparse_matrix, only: sparse_matrix_type, triplet_list_type
   use steps, only: load_film_coefficient
   implicit none
   private
   public :: integrated, unit_loads_type

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

   !> Integrates a unit load on each location.
   pure function integrated(model, locations) result(unit)
      type(model_type), intent(in) :: model
      type(load_locations_type), intent(in) :: locations   !! what the loads act on
      type(unit_loads_type) :: unit

      unit%films = film_sides(model, locations)
      call integrate_columns(unit, model, locations)
   end function integrated

   !> The sides with films; cards give coefficients and sinks for the same sides, in one order.
   pure function film_sides(model, locations) result(films)
      type(model_type), intent(in) :: model
      type(load_locations_type), intent(in) :: locations
      type(film_side_type), allocatable :: films(:)
      integer :: first, i, n

      n = count(locations%kind == load_film_coefficient)
      first = findloc(locations%kind, load_film_coefficient, dim=1)
      allocate (films(n))
      do i = 1, n
         associate (film => films(i), location => first + i - 1)
            film%coefficient = location
            film%sink = location + n
            call film_side(model, locations%item(location), locations%component(location), &
               film%nodes, film%mass)
         end associate
      end do
   end function film_sides

   !> Nodal forces and heat, a column for each location.
   pure subroutine integrate_columns(unit, model, locations)
      type(unit_loads_type), intent(inout) :: unit
      type(model_type), intent(in) :: model
      type(load_locations_type), intent(in) :: locations
      type(triplet_list_type) :: forces, heat
      integer, allocatable :: nodes(:)
      real(dp), allocatable :: unit_force(:, :), rate(:)
      integer :: i

      associate (n => size(locations%kind), most_nodes => size(model%mesh%element_nodes, 1))
         call forces%reserve(2*most_nodes*n)
         call heat%reserve(most_nodes*n)
         do i = 1, n
            call unit_forces(model, locations%kind(i), locations%item(i), locations%component(i), &
               nodes, unit_force)
            call forces%add_block(2*nodes - 1, [i], transpose(unit_force(1:1, :)))
            call forces%add_block(2*nodes, [i], transpose(unit_force(2:2, :)))
            call unit_heat(model, locations%kind(i), locations%item(i), locations%component(i), &
               nodes, rate)
            call heat%add_block(nodes, [i], reshape(rate, [size(rate), 1]))
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

   !> What the films add to the conduction matrix, with both triangles; without values where no heat
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
