!> Bounds of the errors of a run, found beside it: one for each quantity of an interface at the end
!> of a step, which everything else prints and judges by. It is the sum of three parts: mesh,
!> increments, fixed point. Which elements err most, recovery finds: in stress and heat flux.
module error_estimator
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use body_bounds, only: body_bounds_type
   use contact_definitions, only: pairing_surfaces
   use contact_points, only: contact_points_type
   use contact_quantities, only: estimated
   use contact_system, only: contact_open
   use divided_mesh, only: divided_mesh_type
   use doubled_increments, only: doubled_increments_type
   use element_kinds, only: element_corner_count
   use errors, only: error_type
   use increment_quantities, only: history_value
   use interface_quantities, only: quantities_of, quantities_of_state, regime_of
   use kinds, only: dp
   use local_refinement, only: elements_at_surfaces
   use mesh, only: mesh_type
   use mesh_bounds, only: bounds_of_mesh, locked_in
   use model, only: model_type
   use no_estimates, only: no_reason, reason_of_run
   use other_states, only: find_other_states
   use quantity_histories, only: quantity_histories_type
   use quantity_types, only: find_quantity
   use records, only: increment_record_type
   use field_recovery, only: error_record_type
   use heat_equation, only: heat_equation_type
   use simulation, only: simulation_type
   use solution_state, only: solution_state_type
   use state_tables, only: integers, reals, state_table_type
   use steps, only: solves_heat
   use summed_bounds, only: sum_up_body, sum_up_interface
   use temperature_laws, only: relative_jump
   use text, only: append, to_text
   implicit none
   private
   public :: error_estimator_type, squared_errors

   !> Error of the increments in the change that doubling them makes: that of errors that fall with
   !> their length; of a peak pressure between mortar points with its square root, as what closes at
   !> once does where round faces meet, and with it the friction that is locked in there.
   real(dp), parameter :: of_doubled_increments = 1.0_dp, of_doubled_in_peak = 1 + sqrt(2.0_dp)

   !> Part of the change from the round before that is left: one that divides elements leaves less.
   real(dp), parameter :: left_by_round = 0.5_dp

   !> Relative error of a body below which its fields are smooth but for rounding.
   real(dp), parameter :: rounding = 1.0e-8_dp

   !> Data of the bounds.
   type :: error_estimator_type
      private
      type(divided_mesh_type) :: divided           !! the model with divided elements
      type(body_bounds_type), allocatable :: bodies   !! their maxima
      type(doubled_increments_type) :: doubled     !! the run with doubled increments
      type(solution_state_type) :: before          !! state before the present increment
      type(quantity_histories_type) :: histories   !! quantities at the increments before
      logical, allocatable :: has_triangles(:)     !! (interfaces) with some at its faces
      logical, allocatable :: is_mixed(:)          !! (interfaces) of different stiffness
      real(dp), allocatable :: most_locked(:)      !! (interfaces) largest of locked_in so far
      integer, allocatable :: regime(:)            !! (interfaces) regime_of their contact
      !> Squared relative errors that are left in elements that are not divided, of both fields and
      !> of heat alone
      real(dp) :: energies(2) = 0.0_dp
      integer :: step = 0                          !! step of the present increment
      logical :: is_on = .false.                   !! whether there is anything to estimate
   contains
      procedure :: start
      procedure :: begin_increment
      procedure :: end_increment
      procedure :: exchange
      procedure :: release
   end type error_estimator_type

contains

   !> Starts beside a run.
   subroutine start(self, model, simulation)
      class(error_estimator_type), intent(inout) :: self  !! fresh
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation     !! the run, started
      integer :: i

      self%is_on = model%estimates_errors
      if (.not. self%is_on) return
      allocate (self%most_locked(size(model%contacts)), source=0.0_dp)
      allocate (self%regime(size(model%contacts)), source=contact_open)
      self%has_triangles = [(any(elements_at_surfaces(model%mesh, [model%contacts(i)%slave, &
         model%contacts(i)%master]) .and. element_corner_count(model%mesh%element_kind) == 3), &
         i=1, size(model%contacts))]
      self%is_mixed = [(differ_in_stiffness(model, [model%contacts(i)%slave, &
         model%contacts(i)%master]), i=1, size(model%contacts))]
      call self%doubled%start(model, simulation%bodies, simulation%state)
   end subroutine start

   !> Keeps what an increment starts from.
   subroutine begin_increment(self, simulation)
      class(error_estimator_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation      !! the run, about to advance

      if (self%is_on) self%before = simulation%state
   end subroutine begin_increment

   !> Follows an accepted increment; at the end of a step its record receives the bounds, or why
   !> there are none.
   subroutine end_increment(self, model, simulation, record, histories)
      class(error_estimator_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation        !! the run at its end
      type(increment_record_type), intent(inout) :: record
      !> (steps) at their ends in the round before, empty in the first; receives the present ones
      type(quantity_histories_type), intent(inout) :: histories(:)
      real(dp) :: values(size(estimated), size(record%contacts))
      type(contact_points_type) :: points
      character(:), allocatable :: no_mesh
      logical :: slides
      integer :: i

      if (.not. self%is_on) then
         if (record%last_of_step) call go_without(model, record)
         return
      end if
      if (record%step /= self%step) then
         self%step = record%step
         call self%histories%begin_step(size(estimated), size(record%contacts), &
            simulation%loads%corners(model%amplitudes, simulation%control%step_start))
      end if
      call self%doubled%follow(model, simulation, record)
      do i = 1, size(record%contacts)
         call simulation%bodies%view(i, points)
         associate (contact => record%contacts(i))
            values(:, i) = quantities_of(contact)
            self%most_locked(i) = max(self%most_locked(i), locked_in(points, contact, &
               self%has_triangles(i)))
            if (regime_of(contact) /= self%regime(i)) call self%histories%begin_anew(i)
            self%regime(i) = regime_of(contact)
         end associate
      end do
      call self%histories%follow(record%time, values)
      if (.not. record%last_of_step) return
      allocate (record%errors(size(record%contacts)))
      do i = 1, size(record%errors)
         associate (errors => record%errors(i))
            errors%value = values(:, i)
            allocate (errors%mesh(size(estimated)), source=ieee_value(1.0_dp, ieee_quiet_nan))
            allocate (errors%increment(size(estimated)), source=0.0_dp)
            allocate (errors%iteration(size(estimated)), source=0.0_dp)
         end associate
      end do
      call bound_mesh(self, model, simulation, record, histories(record%step), no_mesh)
      if (no_mesh /= '') call append(record%notes, 'the errors of the mesh cannot be '// &
         'estimated: '//no_mesh)
      histories(record%step) = self%histories
      call bound_increments(self, simulation, record)
      call bound_iteration(record)
      do i = 1, size(record%errors)
         call simulation%bodies%view(i, points)
         call sum_up_interface(self%doubled, no_mesh == '', self%is_mixed(i), points, &
            record%contacts(i), record%errors(i))
      end do
      slides = any(record%contacts%slide%point > 0)
      do i = 1, size(record%body_errors)
         call sum_up_body(self%doubled, no_mesh == '', is_steady(model, record), slides, &
            record%body_errors(i))
      end do
      if (no_mesh == '' .and. is_steady(model, record) .and. .not. slides) call &
         self%bodies%bound_checks(model, simulation, self%divided, self%energies, record)
   end subroutine end_increment

   !> The quantities at the end of a step in a run that bounds nothing, and why.
   subroutine go_without(model, record)
      type(model_type), intent(in) :: model
      type(increment_record_type), intent(inout) :: record
      integer :: i

      allocate (record%errors(size(record%contacts)), record%body_errors(0))
      do i = 1, size(record%errors)
         associate (errors => record%errors(i))
            errors%value = quantities_of(record%contacts(i))
            errors%bound = spread(ieee_value(1.0_dp, ieee_quiet_nan), 1, size(estimated))
            errors%mesh = errors%bound
            errors%increment = errors%bound
            errors%iteration = errors%bound
            errors%no_estimate = merge(no_reason, reason_of_run(model), ieee_is_nan(errors%value))
         end associate
      end do
   end subroutine go_without

   !> All that the bounds take of earlier increments, in either direction.
   subroutine exchange(self, table)
      class(error_estimator_type), intent(inout) :: self  !! started
      type(state_table_type), intent(inout) :: table
      integer, allocatable :: step(:)

      if (.not. self%is_on) return
      ! One that has followed no increment yet receives the table.
      if (self%step == 0) call self%histories%begin_step(size(estimated), size(self%most_locked), &
         [real(dp) ::])
      step = [self%step]
      call integers(table, 'estimated_step', step)
      self%step = step(1)
      call reals(table, 'most_locked', self%most_locked)
      call integers(table, 'contact_regime', self%regime)
      call self%histories%exchange(table)
      call self%doubled%exchange(table)
   end subroutine exchange

   !> Frees the factors of the finer mesh.
   subroutine release(self)
      class(error_estimator_type), intent(inout) :: self

      call self%divided%release()
      call self%doubled%release()
   end subroutine release

   !> Whether the elements at some surfaces differ in stiffness, or one has none and is rigid.
   pure logical function differ_in_stiffness(model, surfaces) result(differ)
      type(model_type), intent(in) :: model
      integer, intent(in) :: surfaces(:)       ! indexes into the mesh's surfaces
      logical :: at_face(size(model%mesh%element_kind))
      integer :: e, i, first

      differ = any([(size(model%mesh%surfaces(surfaces(i))%faces, 2), i=1, size(surfaces))] == 0)
      if (differ) return
      at_face = elements_at_surfaces(model%mesh, surfaces)
      first = findloc(at_face, .true., dim=1)
      do e = first + 1, size(at_face)
         if (at_face(e)) differ = differ .or. any(abs(moduli(e) - moduli(first)) > &
            rounding*abs(moduli(first)))
      end do

   contains

      pure function moduli(element)
         integer, intent(in) :: element
         real(dp) :: moduli(4, 4)

         moduli = model%materials(model%sections( &
            model%mesh%element_section(element))%material)%elasticity
      end function moduli

   end function differ_in_stiffness

   !> Whether the fields at the end of a step depend on nothing before it.
   pure logical function is_steady(model, record)
      type(model_type), intent(in) :: model
      type(increment_record_type), intent(in) :: record
      type(heat_equation_type) :: equation

      associate (step => model%steps(record%step))
         equation = heat_equation_type(step%scheme)
         is_steady = equation%is_steady() .or. .not. solves_heat(step%analysis)
      end associate
   end function is_steady

   !> Bounds of the errors of the mesh.
   subroutine bound_mesh(self, model, simulation, record, before, why_not)
      type(error_estimator_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(increment_record_type), intent(inout) :: record
      type(quantity_histories_type), intent(in) :: before    ! histories in the round before
      character(:), allocatable, intent(out) :: why_not      ! why there are none; else ''
      type(error_type), allocatable :: error
      real(dp), dimension(size(estimated), size(record%errors)) :: change, spread
      real(dp) :: of_heat(size(model%mesh%element_kind))
      logical :: also(size(model%mesh%element_kind))
      type(contact_points_type) :: points
      integer :: i

      why_not = ''
      if (.not. allocated(self%bodies)) allocate (self%bodies)
      call self%bodies%find(model, simulation, record, also)
      call self%divided%find_change(simulation, model, also, self%before, change, error)
      if (allocated(error)) then
         why_not = error%message
         return
      end if
      call find_other_states(simulation, model, record%step, self%before, spread)
      of_heat = 0.0_dp
      call add_errors(model%mesh, record%heat_flux_error, of_heat)
      self%energies = [sum(squared_errors(model%mesh, record), mask=.not. &
         self%divided%is_divided), sum(of_heat, mask=.not. self%divided%is_divided)]
      if (is_steady(model, record)) call self%bodies%bound(model, simulation, self%divided, &
         self%energies, record)
      do i = 1, size(record%errors)
         associate (bounds => record%errors(i)%mesh)
            call simulation%bodies%view(i, points)
            bounds = bounds_of_mesh(points, record%contacts(i), &
               change(:, i), self%histories%scatter(i, before), self%most_locked(i), &
               self%energies(1), jump_of(i))
            ! Halved elements show how far another state moves an edge, but not which it is.
            where (estimated%resolution > 0.0_dp .and. .not. ieee_is_nan(bounds + spread(:, i)))
               bounds = max(bounds, spread(:, i))
            else where
               bounds = bounds + spread(:, i)
            end where
            where (.not. ieee_is_nan(bounds)) bounds = max(bounds, &
               left_by_round*abs(self%histories%change_since(i, before)))
         end associate
         if (spread(find_quantity(estimated, 'edge_contact'), i) > 0.0_dp) call append( &
            record%notes, 'on this mesh another contact state of '//model%contacts(i)%name// &
            ' satisfies all conditions, with the edge of contact '//to_text(spread( &
            find_quantity(estimated, 'edge_contact'), i))//' from this one: the conductance '// &
            'jumps there, and increments decide which is found; the bounds have both')
      end do

   contains

      !> Jump of the conductance of an interface where heat crosses it and moves the faces.
      real(dp) function jump_of(interface) result(jump)
         integer, intent(in) :: interface

         associate (bodies => simulation%bodies, &
            start => simulation%bodies%points%interface_start)
            jump = 0.0_dp
            if (.not. bodies%is_coupled) return
            if (abs(record%contacts(interface)%heat_rate) > 0.0_dp) jump = maxval(relative_jump( &
               bodies%laws%conductance(start(interface):start(interface + 1) - 1)))
         end associate
      end function jump_of

   end subroutine bound_mesh

   !> Bounds of the errors of the increments, from those of twice the size. Maxima of bodies err by
   !> as large a part of themselves as force, heat rate and peak pressure of an interface.
   subroutine bound_increments(self, simulation, record)
      type(error_estimator_type), intent(in) :: self
      type(simulation_type), intent(in) :: simulation
      type(increment_record_type), intent(inout) :: record
      real(dp) :: doubled(size(estimated), size(record%errors)), part
      integer :: i, peak, q

      if (.not. self%doubled%is_led) return
      doubled = ieee_value(1.0_dp, ieee_quiet_nan)
      if (self%doubled%has_doubled .and. .not. self%doubled%is_lost) then
         call quantities_of_state(simulation%bodies, self%doubled%state, doubled)
      end if
      peak = find_quantity(estimated, 'peak_pressure')
      part = 0.0_dp
      do i = 1, size(record%errors)
         associate (bodies => simulation%bodies, errors => record%errors(i), &
            start => simulation%bodies%points%interface_start)
            errors%increment = of_doubled_increments*abs(errors%value - doubled(:, i))
            if (bodies%interfaces(i)%pairing == pairing_surfaces .and. &
               any(bodies%laws%friction(start(i):start(i + 1) - 1)%coefficient > 0.0_dp)) then
               errors%increment(peak) = of_doubled_in_peak*abs(errors%value(peak) - &
                  doubled(peak, i))
            end if
            do q = 1, size(estimated)
               if (estimated(q)%is_of_friction .or. estimated(q)%resolution > 0.0_dp) cycle
               if (ieee_is_nan(errors%value(q))) cycle
               if (abs(errors%value(q)) <= 0.0_dp) cycle
               if (ieee_is_nan(part + errors%increment(q))) then
                  part = part + errors%increment(q)
               else
                  part = max(part, merge(1.0_dp, errors%increment(q)/ &
                     max(abs(errors%value(q)), errors%increment(q), tiny(part)), &
                     errors%increment(q) >= abs(errors%value(q))))
               end if
            end do
         end associate
      end do
      do i = 1, size(record%body_errors)
         record%body_errors(i)%increment = part*abs(record%body_errors(i)%value)
      end do
   end subroutine bound_increments

   !> Bounds of the errors of the fixed point: its residual, through the gain that is nearest to 1.
   subroutine bound_iteration(record)
      type(increment_record_type), intent(inout) :: record
      real(dp) :: distance, relative
      integer :: i

      if (.not. allocated(record%iterations)) return
      if (size(record%iterations) == 0) return
      if (ieee_is_nan(record%coupling_gain)) return
      distance = min(1.0_dp, abs(1.0_dp - record%coupling_gain))
      if (.not. ieee_is_nan(record%coupling_gain_max)) distance = min(distance, &
         abs(1.0_dp - record%coupling_gain_max))
      relative = history_value('residual', record)/max(tiny(1.0_dp), distance)
      do i = 1, size(record%errors)
         record%errors(i)%iteration = relative*abs(record%errors(i)%value)
      end do
      do i = 1, size(record%body_errors)
         record%body_errors(i)%iteration = relative*abs(record%body_errors(i)%value)
      end do
   end subroutine bound_iteration

   !> Squared error of each element: stress and heat flux of each body count by their relative
   !> errors.
   pure function squared_errors(mesh, record) result(error)
      type(mesh_type), intent(in) :: mesh
      type(increment_record_type), intent(in) :: record  !! with the fields of its end
      real(dp) :: error(size(mesh%element_kind))

      error = 0.0_dp
      call add_errors(mesh, record%stress_error, error)
      call add_errors(mesh, record%heat_flux_error, error)
   end function squared_errors

   !> Adds the part that each element has in the squared relative error of its body.
   pure subroutine add_errors(mesh, estimate, error)
      type(mesh_type), intent(in) :: mesh
      type(error_record_type), intent(in) :: estimate
      real(dp), intent(inout) :: error(:)
      real(dp) :: square(size(error)), sums(mesh%body_count)
      integer :: e

      if (.not. allocated(estimate%element)) return
      sums = 0.0_dp
      do e = 1, size(error)
         square(e) = estimate%element(e)**2*area_of(mesh, e)
         sums(mesh%element_body(e)) = sums(mesh%element_body(e)) + square(e)
      end do
      do e = 1, size(error)
         associate (b => mesh%element_body(e))
            if (sums(b) <= 0.0_dp) cycle
            if (estimate%body(b) > rounding) error(e) = error(e) + estimate%body(b)**2*square(e)/ &
               sums(b)
         end associate
      end do
   end subroutine add_errors

   !> Area of an element between its corners.
   pure real(dp) function area_of(mesh, e) result(area)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e
      integer :: corners, i

      area = 0.0_dp
      corners = element_corner_count(mesh%element_kind(e))
      do i = 1, corners
         associate (a => mesh%coordinates(:, mesh%element_nodes(i, e)), &
            b => mesh%coordinates(:, mesh%element_nodes(mod(i, corners) + 1, e)))
            area = area + 0.5_dp*(a(1)*b(2) - a(2)*b(1))
         end associate
      end do
      area = abs(area)
   end function area_of

end module error_estimator
