!> Numerical uncertainties (95 %) of the numbers of a run, found beside it: by a finer mesh on which
!> the last increment of each step is solved again, or the whole deck with increments half as long.
!> One rule makes them of what changes there. Where fields err most, recovery finds.
module error_estimator
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use body_maxima, only: body_maxima_type
   use checked_values, only: is_estimable, values_asked_for, worst_of
   use companion_states, only: find_other_states
   use contact_extents, only: peaks_at_axis, peaks_at_corner, spacing_at
   use contact_points, only: contact_points_type
   use contact_quantities, only: estimated, estimated_values
   use divided_mesh, only: divided_mesh_type
   use due_output, only: is_followed, is_judged
   use errors, only: error_type, status_interrupted
   use field_quantities, only: maxima
   use field_recovery, only: squared_errors
   use increment_quantities, only: history_estimated, history_value
   use kinds, only: dp
   use local_refinement, only: elements_about, largest_part
   use mesh, only: mesh_type
   use model, only: model_type, uncertainty_full, verify_type
   use no_estimates, only: at_corner, first_reason, interrupted, no_finer_value, no_reason, &
      not_on_finer_mesh, not_unique, of_axis, of_path, of_step, reason_count, reason_of_run, &
      slides_far
   use quantity_histories, only: quantity_histories_type
   use quantity_types, only: find_quantity, of_history, of_nodes, quantity_type
   use records, only: increment_record_type, uncertainty_type
   use reported_quantities, only: verifiable
   use simulation, only: simulation_type
   use solution_state, only: solution_state_type
   use state_tables, only: state_table_type, words
   use table_uncertainties, only: find_table_uncertainties
   use text, only: append, read_integer, to_text, to_upper
   use uncertainty_rule, only: uncertainty_parts
   implicit none
   private
   public :: error_estimator_type

   !> Part of the squared recovered error of stress and of flux, in every body, that the elements
   !> have which are divided.
   real(dp), parameter :: divided_part = 0.95_dp
   real(dp), parameter :: rounding = 1.0e-20_dp   !! part of the largest squared error

   !> Relative difference of quantities that the fixed point leaves
   real(dp), parameter :: same = 1.0e-5_dp
   real(dp), parameter :: nothing(2) = 0.0_dp   !! scatter and spacing of what has neither

   !> Data of the estimates.
   type :: error_estimator_type
      private
      type(divided_mesh_type) :: divided           !! the model with divided elements
      type(solution_state_type) :: before          !! state before the present increment
      type(quantity_histories_type) :: histories   !! quantities at the increments before
      !> Contact points of the interfaces of the run, and of those of the divided mesh
      type(contact_points_type), allocatable :: interfaces(:), finer(:)
      real(dp) :: iteration = 0.0_dp               !! what its fixed point has left, relative
      logical :: is_on = .false.                   !! whether there is anything to estimate
      logical :: is_full = .false.                 !! whether the divided mesh follows the run
      character(:), allocatable :: lost            !! why there is no finer run; else unallocated
      logical :: is_told = .false.                 !! whether an increment of this run has that
      logical, public :: is_interrupted = .false.  !! whether that is a signal
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
      type(body_maxima_type) :: found
      integer :: i

      associate (values => reshape([(estimated_values(record%contacts(i)), &
         i=1, size(record%contacts))], [size(estimated), size(record%contacts)]))
         if (self%is_on) call self%histories%follow(record%step, record%time, values)
         if (.not. (self%is_full .or. record%last_of_step)) return
         record%uncertainties = no_uncertainty(values, reason_of_run(model))
      end associate
      call found%find(model, simulation, record)
      call begin_bodies(model, found, record)
      if (.not. self%is_on) return
      call solve_finer(self, model, simulation, record, found)
      self%iteration = left_by_iteration(record)
      call judge_interfaces(self, model, simulation, record)
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

      if (self%is_full) then
         if (.not. allocated(self%lost)) call self%divided%follow(simulation, record, error)
      else
         near = elements_about(model%mesh, nodes_looked_at(model, record, found))
         if (allocated(self%lost)) deallocate (self%lost)
         call self%divided%solve_end(simulation, model, near .or. err_most(model%mesh, record), &
            near, self%before, error)
      end if
      if (allocated(error)) then
         self%lost = error%message
         self%is_interrupted = error%status == status_interrupted
      end if
      if (allocated(self%lost) .and. (allocated(error) .or. .not. self%is_told)) call append( &
         record%notes, 'numerical uncertainties cannot be estimated: '//self%lost)
      self%is_told = allocated(self%lost)
      call simulation%bodies%views(self%interfaces)
      if (.not. allocated(self%lost)) call self%divided%run%bodies%views(self%finer)
   end subroutine solve_finer

   !> Nodes at which the last increment alone tells maxima and checks.
   function nodes_looked_at(model, record, found) result(nodes)
      type(model_type), intent(in) :: model
      type(increment_record_type), intent(in) :: record
      type(body_maxima_type), intent(in) :: found
      integer, allocatable :: nodes(:)
      integer :: i, number
      logical :: is_number

      nodes = [found%node]
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
      real(dp), dimension(size(chosen)) :: of_flux, of_stress
      integer :: b

      of_flux = squared_errors(mesh, record%heat_flux_error)
      of_stress = squared_errors(mesh, record%stress_error)
      ! A body without heat or stress has errors that are rounding of those elsewhere.
      where (of_flux <= rounding*maxval(of_flux)) of_flux = 0.0_dp
      where (of_stress <= rounding*maxval(of_stress)) of_stress = 0.0_dp
      chosen = .false.
      do b = 1, mesh%body_count
         associate (is_own => mesh%element_body == b)
            chosen = chosen .or. largest_part(merge(of_flux, 0.0_dp, is_own), divided_part) .or. &
               largest_part(merge(of_stress, 0.0_dp, is_own), divided_part)
         end associate
      end do
   end function err_most

   !> Uncertainties of the quantities of interfaces.
   subroutine judge_interfaces(self, model, simulation, record)
      type(error_estimator_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(increment_record_type), intent(inout) :: record   ! with their values
      real(dp), dimension(size(estimated), size(record%contacts)) :: other, values
      real(dp), dimension(size(estimated)) :: change, scatter
      logical :: holds(reason_count), is_at_corner
      integer :: i, q, start(size(record%contacts) + 1)

      start = simulation%bodies%points%interface_start
      values = record%uncertainties%value
      other = values
      if (record%last_of_step .and. .not. model%steps(record%step)%is_transient) call &
         find_other_states(simulation, model, record%step, self%before, other)
      do i = 1, size(record%contacts)
         is_at_corner = peaks_at_corner(self%interfaces(i), record%contacts(i))
         change = ieee_value(1.0_dp, ieee_quiet_nan)
         if (.not. allocated(self%lost)) then
            change = estimated_values(self%divided%record%contacts(i)) - values(:, i)
            is_at_corner = is_at_corner .or. peaks_at_corner(self%finer(i), &
               self%divided%record%contacts(i))
         end if
         call self%histories%take_change(i, change, scatter)
         do q = 1, size(estimated)
            holds = .false.
            holds(slides_far) = record%contacts(i)%slide%point > 0
            if (.not. ieee_is_nan(other(q, i) - values(q, i))) holds(not_unique) = &
               abs(other(q, i) - values(q, i)) > same*abs(values(q, i))
            holds(at_corner) = estimated(q)%name == 'peak_pressure' .and. is_at_corner
            holds(of_axis) = estimated(q)%name == 'peak_pressure' .and. &
               peaks_at_axis(self%interfaces(i), record%contacts(i))
            holds(of_path) = estimated(q)%follows_path .and. .not. self%is_full .and. any( &
               simulation%bodies%laws%friction(start(i):start(i + 1) - 1)%coefficient > 0.0_dp)
            record%uncertainties(q, i) = judged(self, estimated(q), values(q, i), change(q), &
               holds, [scatter(q), spacing_at(estimated(q), self%interfaces(i), values(q, i))])
            if (holds(not_unique)) call append(record%notes, trim(estimated(q)%name)//' of '// &
               model%contacts(i)%name//' is '//to_text(values(q, i))//' or '//to_text( &
               other(q, i))//': the conductance jumps as the gap closes, two contact states '// &
               'satisfy all conditions, and increments decide which is found')
         end do
      end do
   end subroutine judge_interfaces

   !> The maxima of bodies, without uncertainties.
   subroutine begin_bodies(model, found, record)
      type(model_type), intent(in) :: model
      type(body_maxima_type), intent(in) :: found
      type(increment_record_type), intent(inout) :: record
      integer :: b

      allocate (record%body_uncertainties(model%mesh%body_count))
      do b = 1, model%mesh%body_count
         associate (own => record%body_uncertainties(b))
            own%node = found%node(:, b)
            own%corners = pack(found%corners, model%mesh%node_body(found%corners) == b)
            own%maxima = no_uncertainty(found%value(:, b), reason_of_run(model))
         end associate
      end do
   end subroutine begin_bodies

   !> Uncertainties of the maxima of bodies.
   subroutine judge_bodies(self, model, simulation, found, record)
      type(error_estimator_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(body_maxima_type), intent(in) :: found
      type(increment_record_type), intent(inout) :: record
      logical :: holds(reason_count)
      real(dp) :: change(size(maxima), model%mesh%body_count)
      integer :: b, q

      change = ieee_value(1.0_dp, ieee_quiet_nan)
      if (.not. allocated(self%lost)) change = found%changes(self%divided, model%mesh, &
         simulation, record%fields)
      holds = .false.
      holds(slides_far) = any(record%contacts%slide%point > 0)
      do b = 1, model%mesh%body_count
         do q = 1, size(maxima)
            holds(of_path) = .not. (self%is_full .or. allocated(self%lost)) .and. &
               ieee_is_nan(change(q, b))
            record%body_uncertainties(b)%maxima(q) = judged(self, maxima(q), found%value(q, b), &
               change(q, b), holds, nothing)
         end do
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
      integer :: i

      allocate (record%check_uncertainties(size(model%verifications)), source=no_uncertainty( &
         ieee_value(1.0_dp, ieee_quiet_nan), no_reason))
      do i = 1, size(model%verifications)
         associate (check => model%verifications(i))
            if (is_estimable(check) .and. (is_judged(check, record, model) .or. &
               is_followed(check, record, model))) call judge(check, record%check_uncertainties(i))
         end associate
      end do

   contains

      !> Gives a check the uncertainty of a quantity of an interface, of the largest pressure of the
      !> only one, or of a maximum of a body, where it is about one of these; else compares what
      !> both meshes have.
      subroutine judge(check, own)
         type(verify_type), intent(in) :: check
         type(uncertainty_type), intent(inout) :: own
         type(quantity_type) :: quantity
         character(:), allocatable :: reason, where
         real(dp), allocatable :: fine(:), values(:)
         logical :: holds(reason_count), is_node
         integer :: k, number, q

         where = to_upper(check%where)
         q = find_quantity(estimated, check%quantity)
         if (to_upper(check%quantity) == 'PRESSURE' .and. where == 'MAX' .and. &
            size(self%interfaces) == 1) q = find_quantity(estimated, 'peak_pressure')
         do k = 1, merge(size(self%interfaces), 0, q > 0)
            if (to_upper(self%interfaces(k)%name) /= where .and. size(self%interfaces) > 1) cycle
            own = record%uncertainties(q, k)
            return
         end do
         call values_asked_for(check, record, model, self%interfaces, &
            simulation%recovery%points%node, values, reason)
         if (reason /= '') return
         q = findloc(maxima%head == to_upper(check%quantity), .true., dim=1)
         k = 0
         if (q > 0 .and. where == 'MAX') k = maxloc(found%value(q, :), dim=1, &
            mask=found%node(q, :) > 0)
         if (k > 0) then
            own = record%body_uncertainties(k)%maxima(q)
            if (maxval(values) > own%value) own = no_uncertainty(maxval(values), at_corner)
            return
         end if
         quantity = verifiable(find_quantity(verifiable, check%quantity))
         call read_integer(check%where, number, is_node)
         holds = .false.
         if (is_node .and. any(quantity%unit == ['stress', '-     '])) holds(at_corner) = &
            any(found%is_singular .and. model%mesh%node_number == number)
         holds(of_step) = .not. (self%is_full .or. quantity%kind == of_nodes .and. is_node)
         if (.not. (allocated(self%lost) .or. any(holds))) call values_asked_for(check, &
            self%divided%record, self%divided%model, self%finer, &
            self%divided%run%recovery%points%node, fine, reason)
         if (reason /= '' .or. .not. allocated(fine)) fine = [ieee_value(1.0_dp, ieee_quiet_nan)]
         own = judged(self, quantity, worst_of(check, values), worst_of(check, fine) - &
            worst_of(check, values), holds, merge(of_instant(record), nothing, quantity%kind == &
            of_history))
      end subroutine judge

   end subroutine judge_checks

   !> Uncertainties of the quantities of an increment.
   subroutine judge_history(self, record)
      type(error_estimator_type), intent(in) :: self
      type(increment_record_type), intent(inout) :: record
      real(dp), dimension(size(history_estimated)) :: finer, values
      integer :: q

      values = [(history_value(history_estimated(q)%name, record), q=1, size(values))]
      finer = ieee_value(1.0_dp, ieee_quiet_nan)
      if (.not. allocated(self%lost)) finer = [(history_value(history_estimated(q)%name, &
         self%divided%record), q=1, size(finer))]
      record%history_uncertainties = [(judged(self, history_estimated(q), values(q), &
         finer(q) - values(q), spread(.false., 1, reason_count), of_instant(record)), q=1, &
         size(values))]
   end subroutine judge_history

   !> Scatter and increment beside an instant, which is known to a part of the latter.
   pure function of_instant(record) result(beside)
      type(increment_record_type), intent(in) :: record
      real(dp) :: beside(2)

      beside = nothing
      ! Results of earlier versions do not have it.
      if (allocated(record%solid_time)) beside(2) = sum(record%solid_time(2:))
   end function of_instant

   !> A value without an uncertainty, and why.
   elemental function no_uncertainty(value, reason) result(own)
      real(dp), intent(in) :: value
      integer, intent(in) :: reason              ! of a value that is there
      type(uncertainty_type) :: own

      associate (none => ieee_value(1.0_dp, ieee_quiet_nan))
         own = uncertainty_type(value, none, none, none, none, merge(no_reason, reason, &
            ieee_is_nan(value)))
      end associate
   end function no_uncertainty

   !> The uncertainty of a value, or the reason why it has none; one that is not there has none.
   pure function judged(self, quantity, value, change, holds, beside) result(own)
      type(error_estimator_type), intent(in) :: self
      type(quantity_type), intent(in) :: quantity
      real(dp), intent(in) :: value
      real(dp), intent(in) :: change                  ! on the finer mesh, or NaN
      logical, intent(in) :: holds(reason_count)      ! what is known of the value
      real(dp), intent(in) :: beside(2)               ! scatter; spacing or increment
      type(uncertainty_type) :: own
      logical :: all_holds(reason_count)
      real(dp) :: parts(3)

      all_holds = holds
      all_holds(merge(interrupted, not_on_finer_mesh, self%is_interrupted)) = allocated(self%lost)
      all_holds(no_finer_value) = ieee_is_nan(change) .and. .not. allocated(self%lost)
      own = no_uncertainty(value, first_reason(all_holds))
      if (ieee_is_nan(value)) return
      parts = uncertainty_parts(quantity, change, beside(1), beside(2), self%iteration*value)
      if (any(own%no_estimate == [of_axis, of_path]) .and. .not. ieee_is_nan(sum(parts))) then
         own%at_end = sum(parts)
      end if
      if (own%no_estimate == no_reason) own = uncertainty_type(value, sum(parts), parts(1), &
         parts(2), parts(3), no_reason)
   end function judged

   !> What the fixed point has left, relative: its residual, through the gain that is nearest to 1.
   !> omega - U(omega) = r moves the solution by (1 - U')^-1 r.
   pure real(dp) function left_by_iteration(record) result(relative)
      type(increment_record_type), intent(in) :: record

      relative = 0.0_dp
      if (.not. allocated(record%iterations)) return
      if (size(record%iterations) == 0 .or. ieee_is_nan(record%coupling_gain)) return
      associate (gains => [0.0_dp, record%coupling_gain, record%coupling_gain_max])
         relative = history_value('residual', record)/max(tiny(1.0_dp), &
            minval(abs(1.0_dp - gains), mask=.not. ieee_is_nan(gains)))
      end associate
   end function left_by_iteration

   !> All that the estimates take of earlier increments, in either direction.
   !> Errors: as simulation_type's reduce.
   subroutine exchange(self, interfaces, table, error)
      class(error_estimator_type), intent(inout) :: self  !! started
      integer, intent(in) :: interfaces                   !! number of them
      type(state_table_type), intent(inout) :: table
      type(error_type), allocatable, intent(out) :: error

      if (.not. self%is_on) return
      call self%histories%exchange([size(estimated), interfaces], table)
      if (.not. self%is_full) return
      call words(table, 'no_finer_run', self%lost)
      if (.not. allocated(self%lost)) call self%divided%exchange(table, error)
   end subroutine exchange

   !> Frees the factors of the finer mesh.
   subroutine release(self)
      class(error_estimator_type), intent(inout) :: self

      call self%divided%release()
   end subroutine release

end module error_estimator
