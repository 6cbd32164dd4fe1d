!> The errors of a run, estimated beside it: of the mesh, of the increments, of the fixed point.
module error_estimator
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use contact_definitions, only: pairing_surfaces
   use contact_quantities, only: estimated
   use doubled_increments, only: doubled_increments_type
   use errors, only: error_type
   use increment_quantities, only: history_value
   use increments, only: simulation_type
   use interface_quantities, only: edge_resolution, quantities_of_state
   use kinds, only: dp
   use load_histories, only: step_clock_type
   use model, only: model_type
   use records, only: increment_record_type, interface_errors_type
   use refined_model, only: refined_model_type
   use refinement_error, only: find_change_by_refinement
   use solution_state, only: solution_state_type
   use text, only: append
   implicit none
   private
   public :: error_estimator_type, of_halved_elements

   !> Error of a mesh in the change that halving its elements makes: errors that fall with h are
   !> twice the change, those that fall with h^4 are 1.07 of it.
   real(dp), parameter :: of_halved_elements = 1.25_dp
   !> The same for bands of edges, which shall hold errors that fall with h, and not by a hair.
   real(dp), parameter :: of_halved_bands = 2.5_dp
   !> Error of the increments in the change that doubling them makes: those that fall with their
   !> length are the change, those that fall with its square a third of it.
   real(dp), parameter :: of_doubled_increments = 0.6_dp

   !> What the estimates are made with.
   type :: error_estimator_type
      private
      type(refined_model_type) :: refined          !! the model with divided elements
      type(doubled_increments_type) :: doubled     !! the run with doubled increments
      type(solution_state_type) :: before          !! state before the present increment
      integer :: step = 0                          !! step of the present increment
      logical :: is_on = .false.                   !! whether there is anything to estimate
      character(:), allocatable :: why_not         !! why the mesh cannot be refined; else ''
   contains
      procedure :: start
      procedure :: begin_increment
      procedure :: end_increment
   end type error_estimator_type

contains

   !> Starts beside a run.
   subroutine start(self, model, simulation)
      class(error_estimator_type), intent(inout) :: self  !! fresh
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation     !! the run, started
      type(error_type), allocatable :: error

      self%is_on = model%estimates_errors .and. size(model%contacts) > 0
      if (.not. self%is_on) return
      self%why_not = ''
      call self%refined%prepare(model, simulation%bodies%points, error)
      if (allocated(error)) self%why_not = error%message
      if (any(simulation%bodies%interfaces%pairing == pairing_surfaces)) self%why_not = &
         'it relaxes node pairs, and there are faces whose nodes do not match'
      if (size(model%ties) > 0) self%why_not = 'it relaxes nodes that are free, and there are ties'
      if (size(model%equations) > 0) self%why_not = &
         'it relaxes nodes that are free, and there are equations'
      call self%doubled%start(model, simulation%bodies, simulation%state)
   end subroutine start

   !> Keeps what an increment starts from.
   subroutine begin_increment(self, simulation)
      class(error_estimator_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation      !! the run, about to advance

      if (self%is_on) self%before = simulation%state
   end subroutine begin_increment

   !> Follows an accepted increment; at the end of a step its record receives the errors.
   subroutine end_increment(self, model, simulation, record)
      class(error_estimator_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(inout) :: simulation     !! the run; its state stays
      type(increment_record_type), intent(inout) :: record
      real(dp), allocatable :: values(:, :)

      if (.not. self%is_on) return
      if (record%step /= self%step .and. self%why_not == '') then
         associate (refined => self%refined, before => self%before)
            call refined%loads%begin_step(refined%model%steps(record%step), &
               refined%prolong(before%displacement, 2), refined%prolong(before%temperature, 1))
         end associate
      end if
      self%step = record%step
      call self%doubled%follow(model, simulation%bodies, simulation%loads, simulation%state, &
         record)
      if (.not. record%last_of_step) return
      allocate (record%errors(size(record%contacts)))
      allocate (values(size(estimated), size(record%contacts)))
      call quantities_of_state(simulation%bodies, simulation%state, &
         model%steps(self%step)%scheme, values)
      call store(values, record%errors)
      if (self%why_not == '') call estimate_mesh(self, model, simulation, values, record)
      call estimate_increments(self, model, simulation, values, record)
      call estimate_iteration(values, record)
      if (self%why_not /= '') call append(record%notes, 'the errors of the mesh cannot be '// &
         'estimated on one with elements of half the size: '//self%why_not)
   end subroutine end_increment

   subroutine store(values, errors)
      real(dp), intent(in) :: values(:, :)
      type(interface_errors_type), intent(inout) :: errors(:)
      integer :: i

      do i = 1, size(errors)
         errors(i)%value = values(:, i)
         allocate (errors(i)%mesh(size(estimated)), source=ieee_value(1.0_dp, ieee_quiet_nan))
         allocate (errors(i)%increment(size(estimated)), source=0.0_dp)
         allocate (errors(i)%iteration(size(estimated)), source=0.0_dp)
      end do
   end subroutine store

   !> Errors of the mesh, from the change that a refined one makes.
   subroutine estimate_mesh(self, model, simulation, values, record)
      type(error_estimator_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(inout) :: simulation
      real(dp), intent(in) :: values(:, :)
      type(increment_record_type), intent(inout) :: record
      type(error_type), allocatable :: error
      type(step_clock_type) :: clock
      real(dp) :: change(size(values, 1), size(values, 2))
      integer :: i

      clock%total_time = record%time
      clock%period = model%steps(self%step)%period
      clock%step_time = clock%period
      clock%ramped = model%steps(self%step)%ramped
      call find_change_by_refinement(self%refined, simulation, model, clock, self%before, change, &
         error)
      if (allocated(error)) then
         call append(record%notes, 'the errors of the mesh cannot be estimated: '//error%message)
         return
      end if
      do i = 1, size(record%errors)
         associate (mesh => record%errors(i)%mesh)
            mesh = of_halved_elements*change(:, i)
            where (estimated%is_path_dependent) mesh = ieee_value(1.0_dp, ieee_quiet_nan)
            where (estimated%resolution > 0.0_dp) mesh = of_halved_bands*abs(change(:, i)) + &
               edge_resolution(simulation%bodies%interfaces(i), values(:, i))
         end associate
      end do
   end subroutine estimate_mesh

   !> Errors of the increments, from those of twice the size.
   subroutine estimate_increments(self, model, simulation, values, record)
      type(error_estimator_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      real(dp), intent(in) :: values(:, :)
      type(increment_record_type), intent(inout) :: record
      real(dp) :: doubled(size(values, 1), size(values, 2))
      integer :: i

      if (.not. self%doubled%is_led) return
      doubled = ieee_value(1.0_dp, ieee_quiet_nan)
      if (self%doubled%has_doubled .and. .not. self%doubled%is_lost) then
         call quantities_of_state(simulation%bodies, self%doubled%state, &
            model%steps(self%step)%scheme, doubled)
      end if
      do i = 1, size(record%errors)
         record%errors(i)%increment = of_doubled_increments*(values(:, i) - doubled(:, i))
      end do
   end subroutine estimate_increments

   !> Bound of the errors of the fixed point: its residual, through the gain that is nearest to 1.
   subroutine estimate_iteration(values, record)
      real(dp), intent(in) :: values(:, :)
      type(increment_record_type), intent(inout) :: record
      real(dp) :: relative
      integer :: i

      if (.not. allocated(record%iterations)) return
      if (size(record%iterations) == 0) return
      if (ieee_is_nan(record%coupling_gain)) return
      relative = history_value('residual', record)/max(tiny(1.0_dp), &
         min(1.0_dp, abs(1.0_dp - record%coupling_gain), abs(1.0_dp - record%coupling_gain_max)))
      do i = 1, size(record%errors)
         record%errors(i)%iteration = relative*abs(values(:, i))
      end do
   end subroutine estimate_iteration

end module error_estimator
