!> Rows are run in processes of their own, as often as their times ask for.
module trade_measurement
   use clock, only: wall_seconds
   use command_line, only: command_type
   use errors, only: error_type, set_error, status_internal, status_interrupted
   use interruption, only: caught_signal
   use file_calls, only: remove_file
   use kinds, only: dp
   use processes, only: child_type, pause_briefly, reason_of, report_type
   use progress, only: progress_type
   use row_task, only: row_task_type
   use text, only: string_type, to_text
   use trade_rows, only: trade_row_type, trade_type
   implicit none
   private
   public :: measurement_type, working_paths, median

   !> Runs of a row by the CPU seconds of its first: times of a moment scatter most.
   real(dp), parameter :: moments(3) = [0.1_dp, 1.0_dp, 5.0_dp]   !! [s]
   integer, parameter :: runs_within(4) = [7, 5, 3, 1]             !! up to each, and beyond
   real(dp), parameter :: patience = 5.0_dp       !! a row may take so many times the limit
   real(dp), parameter :: least_patience = 20.0_dp !! and this [s]

   !> A run of a row that is under way.
   type :: slot_type
      integer :: row = 0            !! the row, 0 where the slot is free
      type(child_type) :: child     !! its process
      real(dp) :: since = 0.0_dp    !! when it began [s]
      logical :: is_late = .false.  !! whether it was ended for taking too long
   end type slot_type

   !> What all runs have in common.
   type :: measurement_type
      type(row_task_type) :: task              !! deck, options, instants and nodes
      type(progress_type) :: progress          !! progress line
      character(:), allocatable :: scratch     !! path that temporary files begin with
      real(dp) :: limit = 0.0_dp               !! CPU seconds that a row should take at most [s]
      integer :: jobs = 1                      !! rows that run at a time
   contains
      procedure :: run
   end type measurement_type

contains

   !> Runs the last rows of a trade. A row that fails keeps its reason.
   !> Errors: status_interrupted after a signal, then the trade has only the rows that were
   !> measured; status_internal where no process can be started.
   subroutine run(self, trade, first, last, error)
      class(measurement_type), intent(inout) :: self      !! what the runs have in common
      type(trade_type), intent(inout) :: trade
      integer, intent(in) :: first                        !! first row to be run
      integer, intent(in) :: last                         !! last row that there is
      type(error_type), allocatable, intent(out) :: error
      type(slot_type) :: slots(self%jobs)
      integer :: queue((last - first + 1)*maxval(runs_within))
      type(string_type), allocatable :: paths(:)
      integer :: queued, next, s, i

      paths = working_paths(self%scratch, self%jobs)
      queued = last - first + 1
      queue(:queued) = [(i, i=first, last)]
      next = 1
      do while (next <= queued .or. any(slots%row > 0))
         do s = 1, size(slots)
            if (slots(s)%row > 0 .or. next > queued) cycle
            call begin(self, trade, queue(next), paths(s)%value, slots(s), error)
            if (allocated(error)) exit
            next = next + 1
         end do
         if (.not. allocated(error)) call wait_for_one(self, trade, paths, slots, queue, &
            queued)
         if (caught_signal() /= '') call set_error_once(error)
         if (allocated(error)) exit
      end do
      do s = 1, size(slots)
         if (slots(s)%row > 0) call slots(s)%child%kill()
         call remove_file(paths(s)%value)
      end do
      call self%progress%clear()
      if (allocated(error)) call keep_measured(trade, first)
      do i = first, trade%count
         trade%rows(i)%cpu_seconds = median(trade%rows(i)%cpu)
      end do
   end subroutine run

   !> Takes the rows out again that were not run to their end.
   pure subroutine keep_measured(trade, first)
      type(trade_type), intent(inout) :: trade
      integer, intent(in) :: first
      integer :: i, kept

      kept = first - 1
      do i = first, trade%count
         if (.not. allocated(trade%rows(i)%cpu)) cycle
         if (trade%rows(i)%status == status_interrupted) cycle
         kept = kept + 1
         if (kept < i) trade%rows(kept) = trade%rows(i)
      end do
      trade%count = kept
   end subroutine keep_measured

   subroutine set_error_once(error)
      type(error_type), allocatable, intent(inout) :: error

      if (.not. allocated(error)) call set_error(error, status_interrupted, 'ended by '// &
         caught_signal())
   end subroutine set_error_once

   !> Begins a run of a row.
   subroutine begin(self, trade, row, path, slot, error)
      class(measurement_type), intent(inout) :: self
      type(trade_type), intent(in) :: trade
      integer, intent(in) :: row
      character(*), intent(in) :: path   ! of its values
      type(slot_type), intent(out) :: slot
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: line

      self%task%variation = trade%rows(row)%variation
      self%task%values_path = path
      line = 'row '//to_text(row)//' of level '//to_text(trade%rows(row)%level)
      if (allocated(trade%rows(row)%cpu)) line = line//', run '// &
         to_text(size(trade%rows(row)%cpu) + 1)
      call self%progress%say(line)
      call slot%child%start(self%task, error)
      if (allocated(error)) return
      slot%row = row
      slot%since = wall_seconds()
   end subroutine begin

   !> Waits until a run has ended, or a signal has come.
   subroutine wait_for_one(self, trade, paths, slots, queue, queued)
      class(measurement_type), intent(in) :: self
      type(trade_type), intent(inout) :: trade
      type(string_type), intent(in) :: paths(:)   ! of the values, one a slot
      type(slot_type), intent(inout) :: slots(:)
      integer, intent(inout) :: queue(:), queued
      logical :: has_ended
      integer :: s

      has_ended = .false.
      do while (caught_signal() == '')
         do s = 1, size(slots)
            if (slots(s)%row == 0) cycle
            slots(s)%is_late = wall_seconds() - slots(s)%since >= max(patience*self%limit, &
               least_patience)
            if (slots(s)%is_late) call slots(s)%child%kill()
            has_ended = slots(s)%is_late
            if (.not. has_ended) has_ended = slots(s)%child%has_ended()
            if (.not. has_ended) cycle
            call take(self, trade%rows(slots(s)%row), slots(s), paths(s)%value, queue, queued)
            slots(s)%row = 0
            return
         end do
         call pause_briefly()
      end do
   end subroutine wait_for_one

   !> Takes what a run left; after the first one its repetitions are queued.
   subroutine take(self, row, slot, path, queue, queued)
      class(measurement_type), intent(in) :: self
      type(trade_row_type), intent(inout) :: row
      type(slot_type), intent(inout) :: slot
      character(*), intent(in) :: path   ! of its values
      integer, intent(inout) :: queue(:), queued
      integer :: again

      associate (ended => slot%child%end)
         row%peak_bytes = max(row%peak_bytes, ended%peak_bytes)
         if (allocated(row%cpu)) then
            if (ended%signal == 0 .and. ended%status == 0) row%cpu = [row%cpu, &
               ended%cpu_seconds]
            if (.not. slot%is_late) call slot%child%drop_files()
            return
         end if
         row%cpu = [ended%cpu_seconds]
         call take_outcome(self, row, slot, path)
         if (row%status /= 0) return
         again = runs_within(count(ended%cpu_seconds > moments) + 1) - 1
      end associate
      queue(queued + 1:queued + again) = slot%row
      queued = queued + again
   end subroutine take

   subroutine take_outcome(self, row, slot, path)
      class(measurement_type), intent(in) :: self
      type(trade_row_type), intent(inout) :: row
      type(slot_type), intent(inout) :: slot
      character(*), intent(in) :: path   ! of its values
      type(report_type) :: report
      type(error_type), allocatable :: error

      row%status = status_internal
      if (slot%is_late) then
         row%reason = 'took longer than '//to_text(max(patience*self%limit, least_patience))//' s'
         return
      end if
      report = slot%child%report()
      call slot%child%drop_files()
      row%reason = slot%child%sudden_end()
      if (slot%child%end%signal /= 0 .or. report%is_whole == 0) return
      row%status = int(report%status)
      row%reason = reason_of(report)
      call row%values%load(path, error)
      if (row%status == 0 .and. allocated(error)) then
         row%status = error%status
         row%reason = error%message
      end if
   end subroutine take_outcome

   !> Paths of the temporary files.
   pure function working_paths(scratch, jobs) result(paths)
      character(*), intent(in) :: scratch          !! path that they begin with
      integer, intent(in) :: jobs                  !! rows that run at a time
      type(string_type), allocatable :: paths(:)   !! (jobs)
      integer :: i

      allocate (paths(jobs))
      do i = 1, jobs
         paths(i)%value = scratch//'.'//to_text(i)//'.values.tmp'
      end do
   end function working_paths

   !> The median of some numbers.
   pure real(dp) function median(numbers)
      real(dp), intent(in) :: numbers(:)   !! at least one
      real(dp) :: sorted(size(numbers)), number
      integer :: i, k, n

      n = size(numbers)
      sorted = numbers
      do i = 2, n
         number = sorted(i)
         do k = i - 1, 1, -1
            if (sorted(k) <= number) exit
            sorted(k + 1) = sorted(k)
         end do
         sorted(k + 1) = number
      end do
      median = 0.5_dp*(sorted((n + 1)/2) + sorted(n/2 + 1))
   end function median

end module trade_measurement
