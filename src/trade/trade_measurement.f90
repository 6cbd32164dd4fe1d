!> Rows of a trade-off study are solved in processes of their own, without output, as often as their
!> times ask for.
module trade_measurement
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_int
   use clock, only: wall_seconds
   use command_line, only: command_type
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values
   use deck_preparation, only: prepare_deck, read_deck_type
   use errors, only: error_type, set_error, status_internal, status_interrupted, &
      status_no_convergence
   use increments, only: simulation_type
   use interface_quantities, only: closed_length
   use interruption, only: caught_signal
   use kinds, only: dp
   use model, only: model_type
   use open_files, only: close_descriptor, open_in_memory
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
   public :: row_task_type, measure_rows

   !> Runs of a row by the CPU seconds of its first: short times scatter most.
   real(dp), parameter :: moments(3) = [0.1_dp, 1.0_dp, 5.0_dp]   !! [s]
   integer, parameter :: runs_within(4) = [7, 5, 3, 1]            !! up to each, and beyond
   real(dp), parameter :: patience = 5.0_dp        !! a row may take so many times the limit
   real(dp), parameter :: least_patience = 20.0_dp !! and this [s]

   !> Everything that a row needs.
   type, extends(task_type) :: row_task_type
      character(:), allocatable :: path      !! the deck as given
      type(command_type) :: command          !! options of the command line
      integer, allocatable :: items(:)       !! as from item_quantities
      real(dp), allocatable :: instants(:)   !! total times of comparison [time]
      integer, allocatable :: nodes(:)       !! numbers of nodes whose temperature is compared
      type(variation_type) :: variation      !! the row
      character(:), allocatable :: found     !! path of a file for what it finds
   contains
      procedure :: execute
   end type row_task_type

   !> Room for a row that is run.
   type :: slot_type
      integer :: row = 0            !! the row
      integer :: runs_left = 0      !! of this row, the present one included; 0: the slot is free
      type(row_task_type) :: task
      type(child_type) :: child     !! its process
      integer :: file = -1          !! descriptor of the file for what it finds
      real(dp) :: since = 0.0_dp    !! when it began [s]
   end type slot_type

contains

   !> Runs some rows. A row that fails keeps its reason.
   !> Errors: status_interrupted after a signal, then only the rows that were measured remain;
   !> status_internal where no process can be started.
   subroutine measure_rows(task, progress, rows, error)
      type(row_task_type), intent(in) :: task                 !! all but the variation
      type(progress_type), intent(inout) :: progress
      type(trade_row_type), allocatable, intent(inout) :: rows(:)
      type(error_type), allocatable, intent(out) :: error
      type(slot_type) :: slots(task%command%jobs)
      integer :: next, s
      logical :: has_ended

      next = 1
      do while (next <= size(rows) .or. any(slots%runs_left > 0))
         do s = 1, size(slots)
            if (slots(s)%runs_left > 0) then
               call collect(slots(s), rows(slots(s)%row), has_ended)
               if (.not. has_ended) cycle
            end if
            if (slots(s)%runs_left == 0) then
               if (next > size(rows)) cycle
               slots(s)%row = next
               slots(s)%runs_left = 1
               next = next + 1
            end if
            call progress%say('level '//to_text(rows(slots(s)%row)%variation%levels)//', row '// &
               to_text(slots(s)%row)//' of '//to_text(size(rows)))
            slots(s)%task = task
            slots(s)%task%variation = rows(slots(s)%row)%variation
            call open_in_memory(slots(s)%file, slots(s)%task%found, error)
            if (.not. allocated(error)) call slots(s)%child%start(slots(s)%task, error)
            if (allocated(error)) exit
            slots(s)%since = wall_seconds()
         end do
         if (.not. allocated(error) .and. caught_signal() /= '') call set_error(error, &
            status_interrupted, 'ended by '//caught_signal())
         if (allocated(error)) exit
         call pause_briefly()
      end do
      do s = 1, size(slots)
         if (slots(s)%child%is_running) call slots(s)%child%kill()
      end do
      if (allocated(error)) rows = rows(pack([(s, s=1, size(rows))], &
         [(allocated(rows(s)%cpu), s=1, size(rows))]))
   end subroutine measure_rows

   !> Takes what a run left, once it has ended; after the first one of a row, repetitions are due.
   subroutine collect(slot, row, has_ended)
      type(slot_type), intent(inout) :: slot
      type(trade_row_type), intent(inout) :: row
      logical, intent(out) :: has_ended
      type(report_type) :: report
      integer :: i

      associate (longest => max(patience*slot%task%command%limit, least_patience), &
         ended => slot%child%end)
         has_ended = slot%child%has_ended()
         if (.not. has_ended .and. wall_seconds() - slot%since < longest) return
         slot%runs_left = slot%runs_left - 1
         report%status = int(status_internal, c_int)
         if (has_ended) then
            report = slot%child%report()
            if (ended%signal /= 0 .or. report%is_whole == 0) then
               report%status = int(status_internal, c_int)
               call set_reason(report, slot%child%sudden_end())
            end if
            call slot%child%drop_files()
         else
            call slot%child%kill()
            call set_reason(report, 'took longer than '//to_text(longest)//' s')
         end if
         has_ended = .true.
         row%peak_bytes = max(row%peak_bytes, ended%peak_bytes)
         if (.not. allocated(row%cpu)) then
            row%cpu = [ended%cpu_seconds]
            row%status = int(report%status)
            row%reason = reason_of(report)
            call load(slot%task, row)
            if (row%status == 0) slot%runs_left = &
               runs_within(count(ended%cpu_seconds > moments) + 1) - 1
         else if (report%status == 0) then
            row%cpu = [row%cpu, ended%cpu_seconds]
         end if
      end associate
      ! The median: the smallest that at least half of them do not exceed.
      row%cpu_seconds = minval(row%cpu, mask=[(2*count(row%cpu <= row%cpu(i)) >= size(row%cpu), &
         i=1, size(row%cpu))])
      call close_descriptor(slot%file)
   end subroutine collect

   !> Reads what a row found; a solved one that left no values fails.
   subroutine load(task, row)
      type(row_task_type), intent(in) :: task
      type(trade_row_type), intent(inout) :: row
      integer :: unit, io

      allocate (row%values(size(task%items), size(task%instants)))
      open (newunit=unit, file=task%found, access='stream', status='old', iostat=io)
      if (io == 0) then
         read (unit, iostat=io) row%increments, row%passes, row%values
         close (unit)
      end if
      if (io /= 0 .and. row%status == 0) then
         row%status = status_internal
         row%reason = 'no values of the row'
      end if
   end subroutine load

   !> Solves the row and leaves what it found in the file.
   subroutine execute(self, report)
      class(row_task_type), intent(inout) :: self
      type(report_type), intent(inout) :: report    !! how it ended
      type(read_deck_type) :: deck
      type(model_type) :: model
      type(simulation_type) :: simulation
      type(trade_row_type) :: row
      type(error_type), allocatable :: error
      integer :: unit, io

      call prepare_deck(self%path, self%command, deck, model, simulation, error, self%variation)
      if (.not. allocated(error)) then
         call solve(self, model, simulation, row, error)
         open (newunit=unit, file=self%found, access='stream', status='old', iostat=io)
         if (io == 0) then
            write (unit, iostat=io) row%increments, row%passes, row%values
            close (unit)
         end if
         if (io /= 0 .and. .not. allocated(error)) call set_error(error, status_internal, &
            'no room for the values of the row')
         if (allocated(error)) error%status = max(error%status, status_no_convergence)
      end if
      if (.not. allocated(error)) return
      report%status = int(error%status, c_int)
      call set_reason(report, error%message)
   end subroutine execute

   subroutine solve(self, model, simulation, row, error)
      type(row_task_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(inout) :: simulation
      type(trade_row_type), intent(inout) :: row
      type(error_type), allocatable, intent(out) :: error
      type(increment_record_type) :: record
      type(number_index_type) :: index
      integer :: nodes(size(self%nodes)), instant, i

      allocate (row%values(size(self%items), size(self%instants)), source=absent)
      call index%build(model%mesh%node_number)
      nodes = [(index%find(self%nodes(i)), i=1, size(nodes))]
      call simulation%reduce(model, error)
      do while (.not. (allocated(error) .or. simulation%finished(model)))
         call simulation%advance(model, record, error)
         if (allocated(record%iterations)) row%passes = row%passes + size(record%iterations)
         if (allocated(error)) return
         row%increments = row%increments + 1
         instant = instant_at(self%instants, record%time)
         if (instant > 0) row%values(:, instant) = compared_values(record, &
            simulation%bodies%interfaces, nodes)
      end do
   end subroutine solve

   !> Values of the items at an instant.
   pure function compared_values(record, interfaces, nodes) result(values)
      type(increment_record_type), intent(in) :: record     !! the increment that ends there
      type(contact_points_type), intent(in) :: interfaces(:)
      integer, intent(in) :: nodes(:)
      real(dp), allocatable :: values(:)
      integer :: i, q

      allocate (values(0))
      do i = 1, size(interfaces)
         values = [values, (contact_values(traded(q)%name, interfaces(i), record%contacts(i)), &
            q=1, figure_count), closed_length(record%contacts(i), interfaces(i)%arc_length)]
      end do
      if (size(interfaces) == 0) values = [(merge(record%heat_in, absent, &
         traded(q)%name == 'heat_rate'), q=1, figure_count), 0.0_dp]
      values = [values, record%fields%temperature(nodes)]
      where (.not. ieee_is_finite(values)) values = absent
   end function compared_values

end module trade_measurement
