!> Bounds of the errors that the mesh makes in the largest von Mises stress and temperature of each
!> body, and in stress and temperature at the nodes that *VERIFY names.
!>
!> The elements round these nodes are divided into four (divided_mesh). The error is a multiple of
!> what stress there changes: the von Mises stress of the difference, which does not vanish by
!> chance where components change in different ways, as far as von Mises stresses near change too.
!> A maximum between nodes shows at the new nodes
!> of its elements. Elements that stay err as the square of the error of their energy norm.
!>
!> docs/accuracy.md says on which decks the constants were chosen and which judge them.
module body_bounds
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use body_maxima, only: divided_places, divided_point, elements_about, largest_change, &
      of_stress, of_temperature, places_of, places_type, values_type, vertex_near
   use divided_mesh, only: divided_mesh_type
   use due_output, only: is_judged
   use element_kinds, only: element_node_count
   use field_quantities, only: maxima, point_values
   use field_recovery, only: point_map_type
   use kinds, only: dp
   use model, only: model_type
   use records, only: field_record_type, increment_record_type
   use simulation, only: simulation_type
   use singular_corners, only: find_singular_corners
   use steps, only: solves_heat, solves_mechanics
   use text, only: read_integer, to_upper
   implicit none
   private
   public :: body_bounds_type

   integer, parameter :: layers = 2    !! of elements round a node that are divided
   !> Error in the change: errors that fall with h are just twice as large, and need some room.
   real(dp), parameter :: of_change = 2.1_dp
   !> Largest change that counts by its direction, in the largest one of the value at nodes near.
   real(dp), parameter :: of_changes_near = 2.0_dp
   !> Error of stress over the largest, and of temperature over the range, in the squared relative
   !> error of the energy norm that elements have that are not divided.
   real(dp), parameter :: of_energy = 0.25_dp, of_energy_in_heat = 1.5_dp

   !> Maxima of the bodies at the end of a step.
   type :: body_bounds_type
      private
      type(places_type) :: found
      type(point_map_type) :: points             !! of the run
      logical, allocatable :: counts(:, :)       !! (maxima, elements) those looked at
      logical, allocatable :: is_singular(:)     !! (nodes)
      !> (checks) node that *VERIFY names and that is judged, or 0
      integer, allocatable :: checked(:)
   contains
      procedure :: find
      procedure :: bound
      procedure :: bound_checks
   end type body_bounds_type

contains

   !> Finds the maxima, which the record receives, and which elements must be divided to bound their
   !> errors.
   subroutine find(self, model, simulation, record, chosen)
      class(body_bounds_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation        !! the run at the end of the step
      type(increment_record_type), intent(inout) :: record   !! with its fields
      logical, intent(out) :: chosen(:)                      !! (elements)
      logical :: is_larger(size(model%mesh%node_number))
      integer :: b

      self%points = simulation%recovery%points
      allocate (self%is_singular(size(model%mesh%node_number)), source=.false.)
      allocate (self%counts(size(maxima), size(chosen)), source=.false.)
      associate (analysis => model%steps(record%step)%analysis)
         self%counts(of_temperature, :) = solves_heat(analysis)
         if (solves_mechanics(analysis)) then
            call find_singular_corners(model, simulation, record, self%is_singular)
            self%counts(of_stress, :) = .not. elements_about(model%mesh, &
               pack([(b, b=1, size(self%is_singular))], self%is_singular), 1)
         end if
      end associate
      self%found = places_of(model%mesh, self%points, record%fields, self%counts)
      allocate (record%body_errors(model%mesh%body_count))
      is_larger = round_which_larger(self, model, record)
      do b = 1, size(record%body_errors)
         call begin_body(self, model, b, is_larger, record)
      end do
      call find_checked(self, model, record)
      associate (places => [self%found%point])
         chosen = elements_about(model%mesh, [self%points%node(pack(places, places > 0)), &
            pack(self%checked, self%checked > 0)], layers)
      end associate
   end subroutine find

   !> What a body's maxima are and where; bounds of the mesh are not known yet.
   subroutine begin_body(self, model, b, is_larger, record)
      type(body_bounds_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: b
      logical, intent(in) :: is_larger(:)                    ! (nodes) of round_which_larger
      type(increment_record_type), intent(inout) :: record
      real(dp) :: unknown(size(maxima))
      integer :: node

      unknown = ieee_value(1.0_dp, ieee_quiet_nan)
      associate (errors => record%body_errors(b), point => self%found%point(:, b))
         errors%value = merge(self%found%value(:, b), unknown, point > 0)
         errors%mesh = unknown
         errors%increment = 0*abs(errors%value)
         errors%iteration = errors%increment
         errors%node = merge(self%points%node(max(point, 1)), 0, point > 0)
         errors%corners = pack([(node, node=1, size(is_larger))], is_larger .and. &
            model%mesh%node_body == b)
      end associate
   end subroutine begin_body

   !> Singular corners in one of whose elements stress is at least the body's largest elsewhere.
   pure function round_which_larger(self, model, record) result(is_larger)
      type(body_bounds_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(increment_record_type), intent(in) :: record
      logical :: is_larger(size(self%is_singular))
      integer :: e, n

      is_larger = .false.
      if (.not. any(self%is_singular)) return
      associate (mesh => model%mesh, stress => point_values('von_mises', record%fields, &
         self%points%node))
         do e = 1, size(mesh%element_kind)
            n = element_node_count(mesh%element_kind(e))
            if (maxval(stress(self%points%element_points(:n, e))) < self%found%value(of_stress, &
               mesh%element_body(e))) cycle
            is_larger(mesh%element_nodes(:n, e)) = .true.
         end do
      end associate
      is_larger = is_larger .and. self%is_singular
   end function round_which_larger

   !> The nodes at which stress or temperature is checked by its number.
   pure subroutine find_checked(self, model, record)
      type(body_bounds_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(increment_record_type), intent(in) :: record
      integer :: i, number
      logical :: is_number

      allocate (self%checked(size(model%verifications)), source=0)
      do i = 1, size(self%checked)
         associate (check => model%verifications(i))
            if (.not. is_judged(check, record, model)) cycle
            if (all(to_upper(check%quantity) /= [character(5) :: 'NT', 'S11', 'S22', 'S33', 'S12', &
               'MISES'])) cycle
            if (.not. any(self%counts(merge(of_temperature, of_stress, to_upper(check%quantity) == &
               'NT'), :))) cycle
            call read_integer(check%where, number, is_number)
            if (is_number) self%checked(i) = findloc(model%mesh%node_number, number, dim=1)
         end associate
      end do
   end subroutine find_checked

   !> Bounds the errors of the mesh.
   subroutine bound(self, model, simulation, divided, energies, record)
      class(body_bounds_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(divided_mesh_type), intent(in) :: divided         !! solved
      !> Squared relative error of the energy norms left in elements that were not divided: of all
      !> and of heat alone
      real(dp), intent(in) :: energies(2)
      type(increment_record_type), intent(inout) :: record
      type(places_type) :: fine
      type(point_map_type) :: points
      logical :: near(size(self%counts, 1), size(self%counts, 2))
      real(dp), allocatable :: values(:)
      real(dp) :: change, left
      integer :: b, q

      do q = 1, size(maxima)
         associate (found => self%found%point(q, :))
            near(q, :) = self%counts(q, :) .and. elements_about(model%mesh, &
               self%points%node(pack(found, found > 0)), 1)
         end associate
      end do
      fine = divided_places(divided, near)
      points = divided%points()
      do q = 1, size(maxima)
         values = point_values(trim(maxima(q)%name), divided%fields, points%node)
         do b = 1, size(record%body_errors)
            if (self%found%point(q, b) == 0) cycle
            associate (errors => record%body_errors(b))
               left = left_at(simulation, record, errors%value(q), q, errors%node(q), energies)
               change = max(fine%value(q, b) - errors%value(q), vertex_near(divided, model%mesh, &
                  values, errors%node(q)) - errors%value(q), change_at(self, model, divided, &
                  record, self%found%point(q, b), trim(maxima(q)%name)))
               errors%mesh(q) = of_change*change + left
            end associate
         end do
      end do
   end subroutine bound

   !> What the elements that are not divided leave of the error at a node: of a temperature that is
   !> given, nothing.
   pure real(dp) function left_at(simulation, record, largest, q, node, energies) result(left)
      type(simulation_type), intent(in) :: simulation
      type(increment_record_type), intent(in) :: record
      real(dp), intent(in) :: largest            ! of q in the body
      integer, intent(in) :: q, node             ! of_stress or of_temperature, where
      real(dp), intent(in) :: energies(2)        ! as for `bound`

      left = 0.0_dp
      if (q == of_stress) then
         left = of_energy*energies(1)*largest
      else if (.not. simulation%loads%temperature%active(node)) then
         associate (t => record%fields%temperature)
            left = of_energy_in_heat*energies(2)*(maxval(t) - minval(t))
         end associate
      end if
   end function left_at

   !> How much a quantity changes at a point. That may vanish by chance; so of stress at least the
   !> von Mises stress of the change, but no more than some times what the quantity changes at the
   !> nodes round the point: where components change across the stress, none of these changes much.
   pure real(dp) function change_at(self, model, divided, record, point, name) result(change)
      type(body_bounds_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(divided_mesh_type), intent(in) :: divided
      type(increment_record_type), intent(in) :: record
      integer, intent(in) :: point
      character(*), intent(in) :: name
      type(field_record_type) :: difference
      type(point_map_type) :: points
      type(values_type) :: values
      integer :: after

      points = divided%points()
      after = divided_point(divided, model%mesh, self%points, point)
      values%before = point_values(name, record%fields, self%points%node)
      values%after = point_values(name, divided%fields, points%node)
      change = abs(values%after(after) - values%before(point))
      if (any(name == [character(11) :: 'NT', 'temperature'])) return
      difference%stress = divided%fields%stress(:, [after]) - record%fields%stress(:, [point])
      change = max(change, min(maxval(point_values('von_mises', difference, [1])), &
         of_changes_near*largest_change(divided, model%mesh, self%points, values, &
         self%points%node(point))))
   end function change_at

   !> Bounds the errors of what checks of nodes judge, NaN for others. Increments and iteration make
   !> as much as of the maxima of the body.
   subroutine bound_checks(self, model, simulation, divided, energies, record)
      class(body_bounds_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(divided_mesh_type), intent(in) :: divided         !! solved
      real(dp), intent(in) :: energies(2)                    !! as for `bound`
      type(increment_record_type), intent(inout) :: record   !! with all parts of its bounds
      character(:), allocatable :: name
      integer :: i, q

      allocate (record%check_bounds(size(self%checked)), source=ieee_value(1.0_dp, ieee_quiet_nan))
      do i = 1, size(self%checked)
         associate (node => self%checked(i))
            if (node == 0) cycle
            name = to_upper(model%verifications(i)%quantity)
            q = merge(of_temperature, of_stress, name == 'NT')
            if (q == of_stress .and. self%is_singular(node)) cycle
            associate (errors => record%body_errors(model%mesh%node_body(node)))
               record%check_bounds(i) = left_at(simulation, record, errors%value(q), q, node, &
                  energies) + errors%increment(q) + errors%iteration(q) + &
                  of_change*change_at(self, model, divided, record, node, name)
            end associate
         end associate
      end do
   end subroutine bound_checks

end module body_bounds
