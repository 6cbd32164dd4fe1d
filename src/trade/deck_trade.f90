!> `thercon trade`: speed against accuracy of one deck, measured. Rows are solved in processes of
!> their own, without output, as often as their times ask for.
module deck_trade
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: output_unit
   use adaptive_rounds, only: adaptive_rounds_type, increment_taker_type
   use clock, only: wall_seconds
   use command_line, only: command_type
   use contact_quantities, only: contact_values
   use deck_files, only: input_files_type, results_of
   use deck_preparation, only: prepare_deck, read_deck_type
   use errors, only: error_type, set_error, status_internal, status_interrupted, &
      status_no_convergence
   use file_calls, only: make_folder, try_file
   use increments, only: simulation_type
   use interface_quantities, only: closed_length
   use interruption, only: caught_signal
   use kinds, only: dp
   use messages, only: print_error, print_line
   use model, only: model_type
   use order_reduction, only: side_corners
   use processes, only: child_type, pause_briefly, reason_of, report_type, &
      set_reason, share_numbers, task_type
   use progress, only: progress_type
   use records, only: increment_record_type
   use reported_quantities, only: traded
   use sorting, only: number_index_type
   use steps, only: solves_heat
   use text, only: counted, few_digits, string_type, to_text
   use trade_reference, only: state_errors
   use trade_study, only: absent, common_instants, figure_count, instant_at, item_quantities, &
      judge_rows, mesh_rows, most_levels, single_rows, trade_row_type, trade_type
   use trade_table, only: print_trade, write_trade
   use variations, only: variation_type
   implicit none
   private
   public :: trade_deck

   integer, parameter :: most_nodes = 2000     !! whose temperatures are compared
   real(dp), parameter :: growth = 4.0_dp      !! of elements from one mesh to the next

   !> Runs of a row by the CPU seconds of its first: short times scatter most.
   real(dp), parameter :: moments(3) = [0.1_dp, 1.0_dp, 5.0_dp]   !! [s]
   integer, parameter :: runs_within(4) = [7, 5, 3, 1]            !! up to each, and beyond
   real(dp), parameter :: patience = 5.0_dp        !! a row may take so many times the limit
   real(dp), parameter :: least_patience = 20.0_dp !! and this [s]

   !> What is compared of a row, taken as its increments come.
   type, extends(increment_taker_type) :: row_values_type
      real(dp), allocatable :: instants(:)   !! total times of comparison [time]
      !> Nodes whose temperature is compared: numbers of the deck, in the process of a row indexes
      integer, allocatable :: nodes(:)
      real(dp), pointer :: values(:, :)      !! (items, instants) shared with that process
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
      type(row_values_type) :: found              !! values of the row
      type(variation_type) :: variation           !! the row
   contains
      procedure :: execute
   end type row_task_type

   !> A row in a process of its own.
   type :: row_run_type
      type(row_task_type) :: task     !! all but the variation is given
      integer :: row = 0              !! its index
      integer :: runs_left = 0        !! of it, the present one included; 0: none runs
      type(child_type) :: child
      real(dp) :: since = 0.0_dp      !! when it began [s]
   end type row_run_type

contains

   !> Measures a deck, prints and writes the table; errors are printed on stderr. A deck that fails
   !> as written has a table too, and so has a study that a signal ends.
   subroutine trade_deck(path, command, status)
      character(*), intent(in) :: path             !! the deck as given
      type(command_type), intent(in) :: command    !! options of the command line
      integer, intent(out) :: status               !! exit status
      type(read_deck_type), target :: deck
      type(model_type) :: model
      type(simulation_type) :: simulation
      type(input_files_type) :: inputs
      type(row_run_type) :: runs(command%jobs)
      type(trade_type) :: trade
      type(error_type), allocatable :: error
      character(:), allocatable :: table
      integer :: i

      status = 0
      call prepare_deck(path, command, deck, model, simulation, error, &
         variation_type(order=2, levels=0))
      if (allocated(error)) status = error%status
      if (allocated(error)) return
      call simulation%release()
      table = results_of(path, command)//'.trade.csv'
      call inputs%add(path, deck%cards%files)
      call inputs%check([string_type(table)], error)
      if (.not. allocated(error)) call make_folder(command%folder, error)
      if (.not. allocated(error)) call try_file(table, error)
      do i = 1, size(runs)
         runs(i)%task%path = path
         runs(i)%task%command = command
         runs(i)%task%deck => deck
      end do
      if (.not. allocated(error)) call measure(model, &
         simulation%bodies%interfaces%pairing, runs, trade, error)
      if (allocated(error)) status = error%status
      if (status == status_interrupted .and. size(trade%rows) > 0) then
         trade%ended_early = error%message//': the table contains only the '// &
            counted(size(trade%rows), 'row')//' measured before'
         deallocate (error)
      end if
      if (.not. allocated(error)) then
         call state_errors(model%initial_temperature, trade)
         call judge_rows(trade)
         call write_trade(table, trade, error)
         if (allocated(error)) status = error%status
      end if
      if (allocated(error)) call print_error(path, error%message)
      if (allocated(error)) return
      if (.not. command%quiet) then
         call print_trade(path, trade)
         call print_line(output_unit, 'table: '//table)
      end if
      if (allocated(trade%ended_early)) then
         call print_error(path, trade%ended_early)
         return
      end if
      i = findloc(trade%rows%is_default, .true., dim=1)
      status = trade%rows(i)%status
      if (status /= 0) call print_error(path, 'the deck as written fails: '// &
         trade%rows(i)%reason)
   end subroutine trade_deck

   !> Runs the grid level by level, then meshes with ever more levels at the contact faces, both as
   !> far as that is affordable, then the single variations.
   !> Errors: as measure_rows and share_numbers.
   subroutine measure(model, pairings, runs, trade, error)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pairings(:)                  !! (interfaces) as the deck has them
      type(row_run_type), intent(inout) :: runs(:)        !! with the deck
      type(trade_type), intent(inout) :: trade
      type(error_type), allocatable, intent(out) :: error
      type(progress_type) :: progress
      type(trade_row_type), allocatable :: rows(:)
      integer, allocatable :: nodes(:)
      integer :: i, level, contact_level, corners(2, size(model%mesh%node_number))

      allocate (trade%rows(0), trade%left_out(0))
      ! Temperatures are those of the corners of the deck's own elements, which all rows have.
      corners = side_corners(model%mesh)
      nodes = pack(model%mesh%node_number, corners(1, :) == 0 .and. &
         any(solves_heat(model%steps%analysis)))
      nodes = nodes(::1 + (size(nodes) - 1)/most_nodes)
      trade%instants = common_instants(model)
      trade%items = item_quantities(size(model%contacts), size(nodes))
      do i = 1, size(runs)
         runs(i)%task%found%nodes = nodes
         runs(i)%task%found%instants = trade%instants
         call share_numbers(runs(i)%task%found%values, size(trade%items), size(trade%instants), &
            error)
         if (allocated(error)) return
      end do
      associate (limit => runs(1)%task%command%limit, quiet => runs(1)%task%command%quiet, &
         most => model%written_levels + most_levels)
         call progress%start(quiet)
         do contact_level = 0, merge(most, 0, size(model%contacts) > 0)
            do level = 0, most - contact_level
               call mesh_rows(model, level, contact_level, rows)
               call leave_out_expensive(limit, trade, rows)
               call measure_rows(runs, progress, rows, error)
               trade%rows = [trade%rows, rows]
               if (allocated(error)) return
            end do
         end do
      end associate
      call single_rows(model, pairings, rows)
      call measure_rows(runs, progress, rows, error)
      trade%rows = [trade%rows, rows]
      call progress%clear()
   end subroutine measure

   !> Leaves out the rows that would cost too much, but never the deck as written; rows on meshes
   !> even finer than those are not named.
   pure subroutine leave_out_expensive(limit, trade, rows)
      real(dp), intent(in) :: limit                       !! CPU seconds that a row may take [s]
      type(trade_type), intent(inout) :: trade            !! receives them
      type(trade_row_type), allocatable, intent(inout) :: rows(:)
      logical :: is_kept(size(rows))
      integer :: coarser, i, less

      do i = 1, size(rows)
         associate (mesh => rows(i)%variation)
            is_kept(i) = rows(i)%is_default .or. mesh%levels + mesh%contact_levels == 0
            if (is_kept(i)) cycle
            ! The row on the next coarser mesh, with the same elements and increments.
            less = merge(1, 0, mesh%contact_levels > 0)
            coarser = findloc(trade%rows%variation%order == mesh%order .and. &
               trade%rows%variation%contact_levels == mesh%contact_levels - less .and. &
               trade%rows%variation%levels == mesh%levels - (1 - less) .and. &
               abs(trade%rows%variation%increments - mesh%increments) <= 0.0_dp, .true., dim=1)
         end associate
         if (coarser == 0) cycle
         is_kept(i) = growth*trade%rows(coarser)%cpu_seconds <= limit
         if (is_kept(i)) cycle
         rows(i)%reason = 'at least '//few_digits(growth*trade%rows(coarser)%cpu_seconds)//' s'
         trade%left_out = [trade%left_out, rows(i)]
      end do
      rows = rows(pack([(i, i=1, size(rows))], is_kept))
   end subroutine leave_out_expensive

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
               run%task%found%values = absent
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
            row%values = self%task%found%values
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
         self%found%nodes = [(index%find(self%found%nodes(i)), i=1, size(self%found%nodes))]
         call simulation%reduce(model, error)
         call rounds%solve_increments(model, simulation, self%found, record, error)
         if (allocated(error)) error%status = max(error%status, status_no_convergence)
      end if
      report%increments = int(self%found%increments, c_int)
      report%iterations = int(self%found%passes, c_int)
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

end module deck_trade
