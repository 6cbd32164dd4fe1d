!> Numerical uncertainties (95 %) of the numbers of a run, found beside it: by a finer mesh on which
!> the last increment of each step is solved again, or the whole deck with increments half as long.
!> One rule makes them of what changes there. Where fields err most, recovery finds.
module error_estimator
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use body_maxima, only: body_maxima_type
   use checked_values, only: is_estimable, values_asked_for, worst_of
   use companion_states, only: find_other_states
   use contact_points, only: contact_points_type
   use contact_quantities, only: estimated
   use divided_mesh, only: divided_mesh_type
   use due_output, only: is_followed, is_judged
   use element_kinds, only: element_corner_count
   use errors, only: error_type
   use field_quantities, only: maxima
   use field_recovery, only: error_record_type
   use increment_quantities, only: history_estimated, history_value
   use interface_quantities, only: peaks_at_axis, peaks_at_corner, quantities_of, spacing_at
   use kinds, only: dp
   use local_refinement, only: elements_about, largest_part
   use mesh, only: mesh_type
   use model, only: model_type, uncertainty_full, verify_type
   use no_estimates, only: at_corner, first_reason, no_finer_value, no_reason, not_on_finer_mesh, &
      not_unique, of_axis, of_path, of_step, reason_count, reason_of_run, slides_far
   use quantity_histories, only: quantity_histories_type
   use quantity_types, only: find_quantity, of_nodes, quantity_type
   use records, only: increment_record_type, uncertainty_type
   use reported_quantities, only: verifiable
   use simulation, only: simulation_type
   use solution_state, only: solution_state_type
   use state_tables, only: integers, state_table_type
   use table_uncertainties, only: find_table_uncertainties
   use text, only: append, read_integer, to_text, to_upper
   use uncertainty_rule, only: uncertainty_parts
   implicit none
   private
   public :: error_estimator_type, squared_errors

   !> Part of the squared recovered error of stress and of flux, in every body, that the elements
   !> have which are divided.
   real(dp), parameter :: divided_part = 0.95_dp

   !> Relative difference of quantities that the fixed point leaves
   real(dp), parameter :: same = 1.0e-5_dp
   !> Relative error of a body below which its fields are smooth but for rounding.
   real(dp), parameter :: rounding = 1.0e-8_dp

   !> Data of the estimates.
   type :: error_estimator_type
      private
      type(divided_mesh_type) :: divided           !! the model with divided elements
      type(solution_state_type) :: before          !! state before the present increment
      type(quantity_histories_type) :: histories   !! quantities at the increments before
      integer :: step = 0                          !! step of the present increment
      real(dp) :: iteration = 0.0_dp               !! what its fixed point has left, relative
      logical :: is_on = .false.                   !! whether there is anything to estimate
      logical :: is_full = .false.                 !! whether the divided mesh follows the run
      character(:), allocatable :: lost            !! why there is no finer run; else unallocated
   contains
      procedure :: start
      procedure :: begin_increment
      procedure :: end_increment
      procedure :: exchange
      procedure :: release
   end type error_estimator_type

contains

   !> Starts beside a run.
   subroutine start(self, model)
      class(error_estimator_type), intent(inout) :: self  !! fresh
      type(model_type), intent(in) :: model
      type(error_type), allocatable :: error

      self%is_on = reason_of_run(model) == no_reason
      self%is_full = self%is_on .and. model%uncertainty == uncertainty_full
      if (self%is_full) call self%divided%begin(model, error)
      if (allocated(error)) self%lost = error%message
   end subroutine start

   !> Keeps what an increment starts from.
   subroutine begin_increment(self, simulation)
      class(error_estimator_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation      !! the run, about to advance

      if (self%is_on) self%before = simulation%state
   end subroutine begin_increment

   !> Follows an accepted increment; at the end of a step, and always where the divided mesh follows
   !> the run, its record receives the uncertainties, or why there are none.
   subroutine end_increment(self, model, simulation, record)
      class(error_estimator_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation        !! the run at its end
      type(increment_record_type), intent(inout) :: record
      real(dp) :: values(size(estimated), size(record%contacts))
      type(body_maxima_type) :: found
      integer :: i

      do i = 1, size(record%contacts)
         values(:, i) = quantities_of(record%contacts(i))
      end do
      if (.not. self%is_on) then
         if (.not. record%last_of_step) return
         allocate (record%uncertainties(size(record%contacts)), record%body_uncertainties(0))
         do i = 1, size(record%contacts)
            call clear(record%uncertainties(i), values(:, i))
            where (.not. ieee_is_nan(values(:, i))) record%uncertainties(i)%no_estimate = &
               reason_of_run(model)
         end do
         return
      end if
      if (record%step /= self%step) then
         self%step = record%step
         call self%histories%begin_step(size(estimated), size(record%contacts))
      end if
      call self%histories%follow(record%time, values)
      if (.not. (self%is_full .or. record%last_of_step)) return
      call found%find(model, simulation, record)
      call solve_finer(self, model, simulation, record, found)
      self%iteration = left_by_iteration(record)
      call judge_interfaces(self, model, simulation, values, record)
      call judge_bodies(self, model, simulation, found, record)
      call judge_checks(self, model, simulation, found, record)
      if (self%is_full) call judge_history(self, record)
      if (self%is_full .and. .not. allocated(self%lost)) call find_table_uncertainties( &
         self%divided, simulation, model, self%iteration, record)
   end subroutine end_increment

   !> Solves the finer mesh at the end of the increment.
   subroutine solve_finer(self, model, simulation, record, found)
      type(error_estimator_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(increment_record_type), intent(inout) :: record
      type(body_maxima_type), intent(in) :: found
      logical :: near(size(model%mesh%element_kind))
      type(error_type), allocatable :: error
      logical :: was_lost

      was_lost = allocated(self%lost)
      if (self%is_full) then
         if (.not. was_lost) call self%divided%follow(simulation, record, error)
      else
         near = elements_about(model%mesh, nodes_looked_at(model, record, found))
         call self%divided%solve_end(simulation, model, near .or. err_most(model%mesh, record), &
            near, self%before, error)
         if (.not. allocated(error) .and. was_lost) deallocate (self%lost)
      end if
      if (allocated(error)) self%lost = error%message
      if (allocated(self%lost) .and. (allocated(error) .or. record%increment == 1)) call append( &
         record%notes, 'numerical uncertainties cannot be estimated: '//self%lost)
   end subroutine solve_finer

   !> Nodes at which the last increment alone tells maxima and checks.
   function nodes_looked_at(model, record, found) result(nodes)
      type(model_type), intent(in) :: model
      type(increment_record_type), intent(in) :: record
      type(body_maxima_type), intent(in) :: found
      integer, allocatable :: nodes(:)
      integer :: i, number
      logical :: is_number

      nodes = pack(found%node, found%node > 0)
      do i = 1, size(model%verifications)
         associate (check => model%verifications(i))
            if (verifiable(find_quantity(verifiable, check%quantity))%kind /= of_nodes .or. &
               .not. is_judged(check, record, model)) cycle
            call read_integer(check%where, number, is_number)
            if (is_number) nodes = [nodes, findloc(model%mesh%node_number, number, dim=1)]
         end associate
      end do
      nodes = pack(nodes, nodes > 0)
   end function nodes_looked_at

   !> The elements that hold most of the squared recovered errors of each body.
   function err_most(mesh, record) result(chosen)
      type(mesh_type), intent(in) :: mesh
      type(increment_record_type), intent(in) :: record
      logical :: chosen(size(mesh%element_kind))
      real(dp) :: error(size(chosen), 2)
      integer :: b, k

      error(:, 1) = errors_of(mesh, record%stress_error)
      error(:, 2) = errors_of(mesh, record%heat_flux_error)
      chosen = .false.
      do k = 1, 2
         do b = 1, mesh%body_count
            chosen = chosen .or. largest_part(merge(error(:, k), 0.0_dp, mesh%element_body == b), &
               divided_part)
         end do
      end do
   end function err_most

   !> Uncertainties of the quantities of interfaces.
   subroutine judge_interfaces(self, model, simulation, values, record)
      type(error_estimator_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      real(dp), intent(in) :: values(:, :)                   ! (quantities, interfaces)
      type(increment_record_type), intent(inout) :: record
      real(dp) :: other(size(values, 1), size(values, 2)), fine(size(values, 1)), &
         change(size(values, 1)), largest(size(values, 1)), scatter(size(values, 1))
      type(contact_points_type) :: points
      type(contact_points_type), allocatable :: finer(:)
      logical :: holds(reason_count), is_at_corner
      integer :: i, q, start(size(values, 2) + 1)

      allocate (record%uncertainties(size(record%contacts)))
      start = simulation%bodies%points%interface_start
      other = values
      if (record%last_of_step .and. .not. model%steps(record%step)%is_transient) call &
         find_other_states(simulation, model, record%step, self%before, other)
      fine = ieee_value(1.0_dp, ieee_quiet_nan)
      if (.not. allocated(self%lost)) call self%divided%run%bodies%views(finer)
      do i = 1, size(record%contacts)
         call clear(record%uncertainties(i), values(:, i))
         call simulation%bodies%view(i, points)
         scatter = self%histories%scatter(i)
         is_at_corner = peaks_at_corner(points, record%contacts(i))
         if (.not. allocated(self%lost)) then
            fine = quantities_of(self%divided%record%contacts(i))
            is_at_corner = is_at_corner .or. peaks_at_corner(finer(i), &
               self%divided%record%contacts(i))
         end if
         change = fine - values(:, i)
         if (self%is_full) call self%histories%take_change(i, change, largest)
         ! In steps of few increments changes alone tell how they scatter.
         if (self%is_full) change = merge(largest, change, ieee_is_nan(scatter))
         where (ieee_is_nan(scatter)) scatter = 0.0_dp
         do q = 1, size(values, 1)
            holds = .false.
            holds(slides_far) = record%contacts(i)%slide%point > 0
            if (.not. ieee_is_nan(other(q, i) - values(q, i))) holds(not_unique) = &
               abs(other(q, i) - values(q, i)) > same*abs(values(q, i))
            holds(at_corner) = estimated(q)%name == 'peak_pressure' .and. is_at_corner
            holds(of_axis) = estimated(q)%name == 'peak_pressure' .and. &
               peaks_at_axis(points, record%contacts(i))
            holds(of_path) = estimated(q)%follows_path .and. .not. self%is_full .and. any( &
               simulation%bodies%laws%friction(start(i):start(i + 1) - 1)%coefficient > 0.0_dp)
            call settle(self, record%uncertainties(i), q, estimated(q), change(q), holds, &
               [scatter(q), spacing_at(estimated(q), points, values(q, i))])
            if (holds(not_unique)) call append(record%notes, trim(estimated(q)%name)//' of '// &
               model%contacts(i)%name//' is '//to_text(values(q, i))//' or '//to_text( &
               other(q, i))//': the conductance jumps as the gap closes, two contact states '// &
               'satisfy all conditions, and increments decide which is found')
         end do
      end do
   end subroutine judge_interfaces

   !> Uncertainties of the maxima of bodies.
   subroutine judge_bodies(self, model, simulation, found, record)
      type(error_estimator_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(body_maxima_type), intent(in) :: found
      type(increment_record_type), intent(inout) :: record
      logical :: is_larger(size(found%is_singular)), holds(reason_count)
      real(dp) :: change(size(maxima), model%mesh%body_count), value(size(maxima))
      integer :: b, k, q

      allocate (record%body_uncertainties(model%mesh%body_count))
      change = ieee_value(1.0_dp, ieee_quiet_nan)
      if (.not. allocated(self%lost)) change = found%changes(self%divided, model%mesh, &
         simulation%recovery%points, record%fields)
      is_larger = found%larger_corners(model%mesh, simulation%recovery%points, record%fields)
      holds = .false.
      holds(slides_far) = any(record%contacts%slide%point > 0)
      do b = 1, model%mesh%body_count
         associate (own => record%body_uncertainties(b))
            value = merge(found%value(:, b), ieee_value(1.0_dp, ieee_quiet_nan), &
               found%node(:, b) > 0)
            call clear(own, value)
            own%node = found%node(:, b)
            own%corners = pack([(k, k=1, size(is_larger))], is_larger .and. &
               model%mesh%node_body == b)
            do q = 1, size(maxima)
               if (own%node(q) == 0) cycle
               holds(of_path) = .not. self%is_full .and. ieee_is_nan(change(q, b))
               if (maxima(q)%name == 'temperature' .and. simulation%loads%temperature%active( &
                  own%node(q))) change(q, b) = 0.0_dp
               call settle(self, own, q, maxima(q), change(q, b), holds)
            end do
         end associate
      end do
   end subroutine judge_bodies

   !> Uncertainties of what checks judge. The last increment alone tells quantities of interfaces,
   !> maxima, and values at single nodes.
   subroutine judge_checks(self, model, simulation, found, record)
      type(error_estimator_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(body_maxima_type), intent(in) :: found
      type(increment_record_type), intent(inout) :: record
      !> What checks call the maxima.
      character(*), parameter :: names(*) = [character(5) :: 'MISES', 'NT', 'PEEQ', 'CEEQ']
      type(contact_points_type), allocatable :: interfaces(:), fine_interfaces(:)
      type(uncertainty_type) :: checks
      integer :: i

      call clear(checks, spread(ieee_value(1.0_dp, ieee_quiet_nan), 1, size(model%verifications)))
      if (size(model%verifications) > 0) then
         call simulation%bodies%views(interfaces)
         if (.not. allocated(self%lost)) call self%divided%run%bodies%views(fine_interfaces)
      end if
      do i = 1, size(model%verifications)
         associate (check => model%verifications(i))
            if (.not. (is_estimable(check) .and. (is_judged(check, record, model) .or. &
               is_followed(check, record, model)))) cycle
            if (.not. is_copied(check)) call compare(check)
         end associate
      end do
      record%check_uncertainties = checks

   contains

      !> Whether a check has the uncertainty of a quantity of an interface, of the largest pressure
      !> of the only one, or of a maximum of a body, which it takes.
      logical function is_copied(check)
         type(verify_type), intent(in) :: check
         character(:), allocatable :: quantity, reason, where
         real(dp), allocatable :: values(:)
         integer :: k, q

         quantity = to_upper(check%quantity)
         where = to_upper(check%where)
         is_copied = .true.
         q = find_quantity(estimated, quantity)
         if (quantity == 'PRESSURE' .and. where == 'MAX' .and. size(interfaces) == 1) q = &
            find_quantity(estimated, 'peak_pressure')
         do k = 1, merge(size(interfaces), 0, q > 0)
            if (to_upper(interfaces(k)%name) /= where .and. size(interfaces) > 1) cycle
            call copy(record%uncertainties(k), q)
            return
         end do
         q = findloc(names == quantity, .true., dim=1)
         is_copied = q > 0 .and. where == 'MAX'
         if (.not. is_copied) return
         k = maxloc(found%value(q, :), dim=1)
         is_copied = found%node(q, k) > 0
         if (.not. is_copied) return
         call values_asked_for(check, record, model, interfaces, &
            simulation%recovery%points%node, values, reason)
         if (maxval(values) > found%value(q, k)) then
            checks%value(i) = maxval(values)
            checks%no_estimate(i) = at_corner
         else
            call copy(record%body_uncertainties(k), q)
         end if
      end function is_copied

      subroutine copy(own, q)
         class(uncertainty_type), intent(in) :: own
         integer, intent(in) :: q

         checks%value(i) = own%value(q)
         checks%total(i) = own%total(q)
         checks%change(i) = own%change(q)
         checks%scatter(i) = own%scatter(q)
         checks%iteration(i) = own%iteration(q)
         checks%no_estimate(i) = own%no_estimate(q)
      end subroutine copy

      !> Compares what both meshes have.
      subroutine compare(check)
         type(verify_type), intent(in) :: check
         type(quantity_type) :: quantity
         character(:), allocatable :: reason
         real(dp), allocatable :: values(:), fine(:)
         logical :: holds(reason_count), is_node
         integer :: number

         quantity = verifiable(find_quantity(verifiable, check%quantity))
         call read_integer(check%where, number, is_node)
         holds = .false.
         if (is_node .and. any(quantity%unit == ['stress', '-     '])) holds(at_corner) = &
            any(found%is_singular .and. model%mesh%node_number == number)
         holds(of_step) = .not. (self%is_full .or. quantity%kind == of_nodes .and. is_node)
         call values_asked_for(check, record, model, interfaces, simulation%recovery%points%node, &
            values, reason)
         if (reason /= '') return
         checks%value(i) = worst_of(check, values)
         if (.not. (allocated(self%lost) .or. any(holds))) call values_asked_for(check, &
            self%divided%record, self%divided%model, fine_interfaces, &
            self%divided%run%recovery%points%node, fine, reason)
         if (reason /= '' .or. .not. allocated(fine)) fine = [ieee_value(1.0_dp, ieee_quiet_nan)]
         call settle(self, checks, i, quantity, worst_of(check, fine) - checks%value(i), holds)
      end subroutine compare

   end subroutine judge_checks

   !> Uncertainties of the quantities of an increment.
   subroutine judge_history(self, record)
      type(error_estimator_type), intent(in) :: self
      type(increment_record_type), intent(inout) :: record
      type(uncertainty_type) :: own
      logical :: holds(reason_count)
      real(dp) :: change
      integer :: q

      holds = .false.
      call clear(own, [(history_value(history_estimated(q)%name, record), &
         q=1, size(history_estimated))])
      do q = 1, size(own%value)
         change = ieee_value(1.0_dp, ieee_quiet_nan)
         if (.not. allocated(self%lost)) change = history_value(history_estimated(q)%name, &
            self%divided%record) - own%value(q)
         call settle(self, own, q, history_estimated(q), change, holds)
      end do
      record%history_uncertainties = own
   end subroutine judge_history

   !> Begins with values alone.
   pure subroutine clear(own, values)
      class(uncertainty_type), intent(inout) :: own
      real(dp), intent(in) :: values(:)

      own%value = values
      own%total = spread(ieee_value(1.0_dp, ieee_quiet_nan), 1, size(values))
      own%change = own%total
      own%scatter = own%total
      own%iteration = own%total
      allocate (own%no_estimate(size(values)), source=no_reason)
      allocate (own%at_end(size(values)), source=0.0_dp)
   end subroutine clear

   !> Gives a value its uncertainty, or the reason why it has none; one that is not there has none.
   pure subroutine settle(self, own, q, quantity, change, holds, beside)
      type(error_estimator_type), intent(in) :: self
      class(uncertainty_type), intent(inout) :: own   ! with the value
      integer, intent(in) :: q
      type(quantity_type), intent(in) :: quantity
      real(dp), intent(in) :: change                  ! on the finer mesh, or NaN
      logical, intent(in) :: holds(reason_count)      ! what is known of the value
      real(dp), intent(in), optional :: beside(2)     ! scatter and spacing; absent: 0
      logical :: all_holds(reason_count)
      real(dp) :: parts(3), others(2)

      if (ieee_is_nan(own%value(q))) return
      all_holds = holds
      all_holds(not_on_finer_mesh) = allocated(self%lost)
      all_holds(no_finer_value) = ieee_is_nan(change)
      own%no_estimate(q) = first_reason(all_holds)
      others = 0.0_dp
      if (present(beside)) others = beside
      parts = uncertainty_parts(quantity, change, others(1), others(2), &
         self%iteration*own%value(q))
      if (any(own%no_estimate(q) == [of_axis, of_path]) .and. .not. ieee_is_nan(sum(parts))) then
         own%at_end(q) = sum(parts)
      end if
      if (own%no_estimate(q) /= no_reason) return
      own%change(q) = parts(1)
      own%scatter(q) = parts(2)
      own%iteration(q) = parts(3)
      own%total(q) = sum(parts)
   end subroutine settle

   !> What the fixed point has left, relative: its residual, through the gain that is nearest to 1.
   !> omega - U(omega) = r moves the solution by (1 - U')^-1 r.
   pure real(dp) function left_by_iteration(record) result(relative)
      type(increment_record_type), intent(in) :: record
      real(dp) :: distance

      relative = 0.0_dp
      if (.not. allocated(record%iterations)) return
      if (size(record%iterations) == 0 .or. ieee_is_nan(record%coupling_gain)) return
      distance = min(1.0_dp, abs(1.0_dp - record%coupling_gain))
      if (.not. ieee_is_nan(record%coupling_gain_max)) distance = min(distance, &
         abs(1.0_dp - record%coupling_gain_max))
      relative = history_value('residual', record)/max(tiny(1.0_dp), distance)
   end function left_by_iteration

   !> All that the estimates take of earlier increments, in either direction.
   !> Errors: as simulation_type's reduce.
   subroutine exchange(self, interfaces, table, error)
      class(error_estimator_type), intent(inout) :: self  !! started
      integer, intent(in) :: interfaces                   !! number of them
      type(state_table_type), intent(inout) :: table
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: step(:)

      if (.not. self%is_on) return
      ! One that has followed no increment yet receives the table.
      if (self%step == 0) call self%histories%begin_step(size(estimated), interfaces)
      step = [self%step]
      call integers(table, 'estimated_step', step)
      self%step = step(1)
      call self%histories%exchange(table)
      if (self%is_full .and. .not. allocated(self%lost)) call self%divided%exchange(table, error)
   end subroutine exchange

   !> Frees the factors of the finer mesh.
   subroutine release(self)
      class(error_estimator_type), intent(inout) :: self

      call self%divided%release()
   end subroutine release

   !> Squared error of each element: stress and heat flux of each body count by their relative
   !> errors.
   pure function squared_errors(mesh, record) result(error)
      type(mesh_type), intent(in) :: mesh
      type(increment_record_type), intent(in) :: record  !! with the fields of its end
      real(dp) :: error(size(mesh%element_kind))

      error = errors_of(mesh, record%stress_error) + errors_of(mesh, record%heat_flux_error)
   end function squared_errors

   !> The part that each element has in the squared relative error of its body.
   pure function errors_of(mesh, estimate) result(error)
      type(mesh_type), intent(in) :: mesh
      type(error_record_type), intent(in) :: estimate
      real(dp) :: error(size(mesh%element_kind))
      real(dp) :: sums(mesh%body_count)
      integer :: e

      error = 0.0_dp
      if (.not. allocated(estimate%element)) return
      sums = 0.0_dp
      do e = 1, size(error)
         error(e) = estimate%element(e)**2*area_of(mesh, e)
         sums(mesh%element_body(e)) = sums(mesh%element_body(e)) + error(e)
      end do
      do e = 1, size(error)
         associate (b => mesh%element_body(e))
            if (sums(b) > 0.0_dp .and. estimate%body(b) > rounding) then
               error(e) = estimate%body(b)**2*error(e)/sums(b)
            else
               error(e) = 0.0_dp
            end if
         end associate
      end do
   end function errors_of

   !> Area of an element between its corners.
   pure real(dp) function area_of(mesh, e) result(area)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e

      associate (x => mesh%coordinates(:, mesh%element_nodes(:element_corner_count( &
         mesh%element_kind(e)), e)))
         area = 0.5_dp*abs(sum(x(1, :)*cshift(x(2, :), 1) - cshift(x(1, :), 1)*x(2, :)))
      end associate
   end function area_of

end module error_estimator
