!> Rows of a trade-off study are solved in processes of their own, without output, as often as their
!> times ask for.
module trade_measurement
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_int
   use adaptive_rounds, only: adaptive_rounds_type, increment_taker_type
   use clock, only: wall_seconds
   use command_line, only: command_type
   use contact_quantities, only: contact_values
   use deck_preparation, only: prepare_deck, read_deck_type
   use errors, only: error_type, set_error, status_internal, status_interrupted, &
      status_no_convergence
   use increments, only: simulation_type
   use interface_quantities, only: closed_length
   use interruption, only: caught_signal
   use kinds, only: dp
   use model, only: model_type
   use processes, only: child_type, pause_briefly, reason_of, report_type, set_reason, task_type
   use progress, only: progress_type
   use records, only: increment_record_type
   use reported_quantities, only: traded
   use sorting, only: number_index_type
   use text, only: to_text
   use trade_plan, only: instant_at
   use trade_study, only: absent, figure_count, trade_row_type
   use variations, only: variation_type
   implicit none
   private
   public :: row_run_type, measure_rows

   !> Runs of a row by the CPU seconds of its first: short times scatter most.
   real(dp), parameter :: moments(3) = [0.1_dp, 1.0_dp, 5.0_dp]   !! [s]
   integer, parameter :: runs_within(4) = [7, 5, 3, 1]            !! up to each, and beyond
   real(dp), parameter :: patience = 5.0_dp        !! a row may take so many times the limit
   real(dp), parameter :: least_patience = 20.0_dp !! and this [s]

   !> What is compared of a row, taken as its increments come.
   type, extends(increment_taker_type) :: row_values_type
      real(dp), allocatable :: instants(:)   !! total times of comparison [time]
      integer, allocatable :: nodes(:)       !! indexes of nodes whose temperature is compared
      real(dp), pointer :: values(:, :)      !! (items, instants)
      integer :: increments = 0              !! accepted ones
      integer :: passes = 0                  !! of the fixed point in all of them
   contains
      procedure :: take
   end type row_values_type

   !> All that a row needs.
   type, extends(task_type) :: row_task_type
      character(:), allocatable :: path           !! the deck as given
      type(command_type) :: command               !! options of the command line
      type(read_deck_type), pointer :: deck => null()   !! read
      real(dp), allocatable :: instants(:)        !! total times of comparison [time]
      integer, allocatable :: nodes(:)            !! numbers of nodes whose temperature is compared
      real(dp), pointer :: values(:, :)           !! (items, instants) shared with the process
      type(variation_type) :: variation           !! the row
   contains
      procedure :: execute
   end type row_task_type

   !> A row in a process of its own.
   type :: row_run_type
      type(row_task_type) :: task     !! all but the variation is given
      integer, private :: row = 0               !! its index
      integer, private :: runs_left = 0         !! of it, the present one included; 0: none runs
      type(child_type), private :: child
      real(dp), private :: since = 0.0_dp       !! when it began [s]
   end type row_run_type

contains

   !> Runs some rows. A row that fails keeps its reason.
   !> Errors: status_interrupted after a signal, then only the rows that were measured remain;
   !> status_internal where no process can be started.
   subroutine measure_rows(runs, progress, rows, error)
      type(row_run_type), intent(inout) :: runs(:)            !! as many as run at a time
      type(progress_type), intent(inout) :: progress
      type(trade_row_type), allocatable, intent(inout) :: rows(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: next, i
      logical :: has_ended

      next = 1
      do while (next <= size(rows) .or. any(runs%runs_left > 0))
         do i = 1, size(runs)
            associate (run => runs(i))
               if (run%runs_left > 0) then
                  call collect(run, rows(run%row), has_ended)
                  if (.not. has_ended) cycle
               end if
               if (run%runs_left == 0) then
                  if (next > size(rows)) cycle
                  run%row = next
                  run%runs_left = 1
                  run%task%variation = rows(next)%variation
                  next = next + 1
               end if
               call progress%say('level '//to_text(run%task%variation%levels)//', row '// &
                  to_text(run%row)//' of '//to_text(size(rows)))
               run%task%values = absent
               run%since = wall_seconds()
               call run%child%start(run%task, error)
            end associate
            if (allocated(error)) exit
         end do
         if (.not. allocated(error) .and. caught_signal() /= '') call set_error(error, &
            status_interrupted, 'ended by '//caught_signal())
         if (allocated(error)) exit
         call pause_briefly()
      end do
      do i = 1, size(runs)
         if (runs(i)%child%is_running) call runs(i)%child%kill()
      end do
      if (allocated(error)) rows = rows(pack([(i, i=1, size(rows))], &
         [(allocated(rows(i)%cpu), i=1, size(rows))]))
   end subroutine measure_rows

   !> Takes what a run left, once it has ended; after the first one of a row, repetitions are due.
   subroutine collect(self, row, has_ended)
      type(row_run_type), intent(inout) :: self
      type(trade_row_type), intent(inout) :: row
      logical, intent(out) :: has_ended
      type(report_type) :: report
      real(dp) :: longest
      integer :: i

      longest = max(patience*self%task%command%limit, least_patience)
      has_ended = self%child%has_ended()
      if (has_ended) then
         report = self%child%report()
         call self%child%drop_files()
      else if (wall_seconds() - self%since >= longest) then
         call self%child%kill()
         has_ended = .true.
         report%status = int(status_internal, c_int)
         call set_reason(report, 'took longer than '//to_text(longest)//' s')
      else
         return
      end if
      self%runs_left = self%runs_left - 1
      associate (ended => self%child%end)
         row%peak_bytes = max(row%peak_bytes, ended%peak_bytes)
         if (.not. allocated(row%cpu)) then
            row%cpu = [ended%cpu_seconds]
            row%status = int(report%status)
            row%reason = reason_of(report)
            row%increments = int(report%increments)
            row%passes = int(report%iterations)
            row%values = self%task%values
            if (row%status == 0) self%runs_left = &
               runs_within(count(ended%cpu_seconds > moments) + 1) - 1
         else if (report%status == 0) then
            row%cpu = [row%cpu, ended%cpu_seconds]
         end if
      end associate
      ! The median: the smallest that at least half of them do not exceed.
      row%cpu_seconds = minval(row%cpu, mask=[(2*count(row%cpu <= row%cpu(i)) >= size(row%cpu), &
         i=1, size(row%cpu))])
   end subroutine collect

   !> Solves the row, a round without estimates and without a request.
   subroutine execute(self, report)
      class(row_task_type), intent(inout) :: self
      type(report_type), intent(inout) :: report    !! how it ended
      type(model_type) :: model
      type(simulation_type) :: simulation
      type(adaptive_rounds_type) :: rounds
      type(row_values_type) :: found
      type(increment_record_type) :: record
      type(number_index_type) :: index
      type(error_type), allocatable :: error
      integer :: i

      call prepare_deck(self%path, self%command, self%deck, model, simulation, error, &
         self%variation)
      if (.not. allocated(error)) then
         model%estimates_errors = .false.
         if (allocated(model%accuracy%targets)) deallocate (model%accuracy%targets)
         call index%build(model%mesh%node_number)
         found%nodes = [(index%find(self%nodes(i)), i=1, size(self%nodes))]
         found%instants = self%instants
         found%values => self%values
         call simulation%reduce(model, error)
         call rounds%solve_increments(model, simulation, found, record, error)
         if (allocated(error)) error%status = max(error%status, status_no_convergence)
      end if
      report%increments = int(found%increments, c_int)
      report%iterations = int(found%passes, c_int)
      if (.not. allocated(error)) return
      report%status = int(error%status, c_int)
      call set_reason(report, error%message)
   end subroutine execute

   !> Takes the values at the instants of comparison; their order is that of item_quantities.
   subroutine take(self, simulation, record, error)
      class(row_values_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(increment_record_type), intent(inout) :: record
      type(error_type), allocatable, intent(inout) :: error
      real(dp), allocatable :: values(:)
      integer :: i, instant, q

      if (allocated(record%iterations)) self%passes = self%passes + size(record%iterations)
      if (allocated(error)) return
      self%increments = self%increments + 1
      instant = instant_at(self%instants, record%time)
      if (instant == 0) return
      associate (interfaces => simulation%bodies%interfaces)
         allocate (values(0))
         do i = 1, size(interfaces)
            values = [values, (contact_values(traded(q)%name, interfaces(i), &
               record%contacts(i)), q=1, figure_count), &
               closed_length(record%contacts(i), interfaces(i)%arc_length)]
         end do
         if (size(interfaces) == 0) values = [(merge(record%heat_in, absent, &
            traded(q)%name == 'heat_rate'), q=1, figure_count), 0.0_dp]
      end associate
      values = [values, record%fields%temperature(self%nodes)]
      where (.not. ieee_is_finite(values)) values = absent
      self%values(:, instant) = values
   end subroutine take

end module trade_measurement
