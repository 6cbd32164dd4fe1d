!> Rows are run in processes of their own, as often as their times ask for.
module trade_measurement
   use clock, only: wall_seconds
   use errors, only: error_type, set_error, status_internal, status_interrupted
   use interruption, only: caught_signal
   use kinds, only: dp
   use open_files, only: close_descriptor, open_in_memory
   use processes, only: child_type, pause_briefly, reason_of, report_type
   use progress, only: progress_type
   use row_task, only: row_task_type
   use text, only: to_text
   use trade_plan, only: coarser_row
   use trade_study, only: trade_row_type
   use variations, only: variation_type
   implicit none
   private
   public :: measure_rows, expected_seconds

   !> Runs of a row by the CPU seconds of its first: short times scatter most.
   real(dp), parameter :: moments(3) = [0.1_dp, 1.0_dp, 5.0_dp]   !! [s]
   integer, parameter :: runs_within(4) = [7, 5, 3, 1]            !! up to each, and beyond
   real(dp), parameter :: patience = 5.0_dp        !! a row may take so many times the limit
   real(dp), parameter :: least_patience = 20.0_dp !! and this [s]

   !> From one mesh to the next factors take 16 times the operations at most; small rows, which
   !> mostly start up, take less.
   real(dp), parameter :: least_growth = 4.0_dp, usual_growth = 8.0_dp, most_growth = 16.0_dp

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

   !> CPU seconds that a row would take: those on the mesh before, times their growth there; 0 on
   !> the deck's mesh, huge where the mesh before has no such row.
   pure real(dp) function expected_seconds(row, rows) result(seconds)
      type(trade_row_type), intent(in) :: row
      type(trade_row_type), intent(in) :: rows(:)   !! that were measured
      real(dp) :: growth
      integer :: before, i

      seconds = 0.0_dp
      if (row%variation%levels == 0 .and. row%variation%contact_levels == 0) return
      before = coarser_row(rows, row%variation)
      seconds = huge(seconds)
      if (before == 0) return
      seconds = rows(before)%cpu_seconds
      i = coarser_row(rows, rows(before)%variation)
      growth = usual_growth
      if (i > 0) growth = seconds/max(rows(i)%cpu_seconds, 1.0e-3_dp)
      seconds = seconds*min(max(growth, least_growth), most_growth)
   end function expected_seconds

   !> Runs some rows. A row that fails keeps its reason.
   !> Errors: status_interrupted after a signal, then only the rows that were measured remain;
   !> status_internal where no process can be started.
   subroutine measure_rows(task, jobs, limit, progress, rows, error)
      type(row_task_type), intent(in) :: task                 !! all but the variation
      integer, intent(in) :: jobs                             !! rows that run at a time
      real(dp), intent(in) :: limit                           !! CPU seconds of a row [s]
      type(progress_type), intent(inout) :: progress
      type(trade_row_type), allocatable, intent(inout) :: rows(:)
      type(error_type), allocatable, intent(out) :: error
      type(slot_type) :: slots(jobs)
      integer :: next, s
      logical :: has_ended

      next = 1
      do while (next <= size(rows) .or. any(slots%runs_left > 0))
         do s = 1, jobs
            if (slots(s)%runs_left > 0) then
               call collect(slots(s), max(patience*limit, least_patience), rows(slots(s)%row), &
                  has_ended)
               if (.not. has_ended) cycle
            end if
            if (slots(s)%runs_left == 0) then
               if (next > size(rows)) cycle
               slots(s)%row = next
               next = next + 1
            end if
            call progress%say(words_of(rows(slots(s)%row)))
            call begin(task, rows(slots(s)%row)%variation, slots(s), error)
            if (allocated(error)) exit
         end do
         if (.not. allocated(error) .and. caught_signal() /= '') call set_error(error, &
            status_interrupted, 'ended by '//caught_signal())
         if (allocated(error)) exit
         call pause_briefly()
      end do
      do s = 1, jobs
         if (slots(s)%child%is_running) call slots(s)%child%kill()
      end do
      if (allocated(error)) rows = rows(pack([(s, s=1, size(rows))], &
         [(allocated(rows(s)%cpu) .and. rows(s)%status /= status_interrupted, s=1, size(rows))]))
   end subroutine measure_rows

   !> Begins a run.
   subroutine begin(task, variation, slot, error)
      type(row_task_type), intent(in) :: task
      type(variation_type), intent(in) :: variation
      type(slot_type), intent(inout) :: slot
      type(error_type), allocatable, intent(out) :: error

      slot%task = task
      slot%task%variation = variation
      call open_in_memory(slot%file, slot%task%found, error)
      if (.not. allocated(error)) call slot%child%start(slot%task, error)
      if (allocated(error)) return
      slot%runs_left = max(slot%runs_left, 1)
      slot%since = wall_seconds()
   end subroutine begin

   !> Takes what a run left, once it has ended; after the first one of a row, repetitions are due.
   subroutine collect(slot, longest, row, has_ended)
      type(slot_type), intent(inout) :: slot
      real(dp), intent(in) :: longest              !! wall time of a run [s]
      type(trade_row_type), intent(inout) :: row
      logical, intent(out) :: has_ended
      logical :: is_late
      integer :: i

      is_late = wall_seconds() - slot%since >= longest
      has_ended = is_late
      if (is_late) then
         call slot%child%kill()
      else
         has_ended = slot%child%has_ended()
      end if
      if (.not. has_ended) return
      slot%runs_left = slot%runs_left - 1
      associate (ended => slot%child%end)
         row%peak_bytes = max(row%peak_bytes, ended%peak_bytes)
         if (.not. allocated(row%cpu)) then
            row%cpu = [ended%cpu_seconds]
            row%status = status_internal
            row%reason = 'took longer than '//to_text(longest)//' s'
            if (.not. is_late) call take_outcome(slot, row)
            if (row%status == 0) slot%runs_left = &
               runs_within(count(ended%cpu_seconds > moments) + 1) - 1
         else if (ended%signal == 0 .and. ended%status == 0) then
            row%cpu = [row%cpu, ended%cpu_seconds]
         end if
      end associate
      ! The median: the smallest that half of the others do not exceed.
      row%cpu_seconds = minval(row%cpu, mask=[(2*count(row%cpu <= row%cpu(i)) >= size(row%cpu), &
         i=1, size(row%cpu))])
      if (.not. is_late) call slot%child%drop_files()
      call close_descriptor(slot%file)
   end subroutine collect

   subroutine take_outcome(slot, row)
      type(slot_type), intent(in) :: slot
      type(trade_row_type), intent(inout) :: row
      type(report_type) :: report
      type(error_type), allocatable :: error

      report = slot%child%report()
      row%reason = slot%child%sudden_end()
      if (slot%child%end%signal /= 0 .or. report%is_whole == 0) return
      row%status = int(report%status)
      row%reason = reason_of(report)
      call slot%task%load(row, error)
      if (row%status /= 0 .or. .not. allocated(error)) return
      row%status = error%status
      row%reason = error%message
   end subroutine take_outcome

   pure function words_of(row) result(words)
      type(trade_row_type), intent(in) :: row
      character(:), allocatable :: words

      words = 'row with level '//to_text(row%variation%levels)
      if (row%varied /= '') words = 'row with '//row%varied
      if (allocated(row%cpu)) words = words//', run '//to_text(size(row%cpu) + 1)
   end function words_of

end module trade_measurement
