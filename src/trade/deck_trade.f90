!> `thercon trade`: speed against accuracy of one deck, measured. Each row is solved in a process of
!> its own, without output, as often as its time asks for.
module deck_trade
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: error_unit
   use accuracy_targets, only: whole_request
   use accuracy_rounds, only: needs_full
   use adaptive_rounds, only: adaptive_rounds_type, increment_taker_type
   use clock, only: wall_seconds
   use command_line, only: command_type
   use contact_extents, only: closed_length
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values
   use deck_files, only: input_files_type, results_of
   use deck_preparation, only: prepare_deck, read_deck_type
   use element_kinds, only: side_node_count
   use errors, only: error_type, set_error, status_internal, status_interrupted, &
      status_no_convergence, status_verify
   use file_calls, only: make_folder, try_file
   use interruption, only: caught_signal
   use kinds, only: dp
   use messages, only: print_error, print_line
   use model, only: model_type, uncertainty_full, uncertainty_last, uncertainty_no
   use order_reduction, only: side_corners
   use processes, only: child_type, pause_briefly, reason_of, report_type, &
      set_reason, share_numbers, task_type
   use progress, only: progress_type
   use records, only: increment_record_type
   use reported_quantities, only: traded
   use simulation, only: simulation_type
   use sorting, only: number_index_type
   use steps, only: solves_heat
   use text, only: counted, few_digits, string_type, to_text
   use trade_reference, only: state_errors
   use trade_study, only: absent, common_instants, factors, figure_count, instant_at, &
      item_quantities, judge_rows, mesh_rows, most_levels, single_rows, trade_row_type, trade_type
   use trade_table, only: imbalanced_rows, print_trade, write_trade
   use variations, only: variation_type
   implicit none
   private
   public :: trade_deck

   integer, parameter :: most_nodes = 2000     !! whose temperatures are compared
   real(dp), parameter :: usual_limit = 30.0_dp  !! --limit, unless given [s]
   real(dp), parameter :: growth = 4.0_dp      !! of elements from one mesh to the next
   real(dp), parameter :: unknown = 1.0e300_dp !! seconds of a row whose coarser one is left out

   !> Runs of a row by the CPU seconds of its first: short times scatter most.
   real(dp), parameter :: moments(3) = [0.1_dp, 1.0_dp, 5.0_dp]   !! [s]
   integer, parameter :: runs_within(4) = [7, 5, 3, 1]            !! up to each, and beyond
   real(dp), parameter :: patience = 5.0_dp        !! a run may take so many times the limit
   real(dp), parameter :: least_patience = 20.0_dp !! and this [s]

   !> Values of a row, in memory that its process shares, taken as its increments come.
   type, extends(increment_taker_type) :: row_values_type
      real(dp), allocatable :: instants(:)   !! total times of comparison [time]
      integer, allocatable :: nodes(:)       !! indexes of nodes whose temperature is compared
      real(dp), pointer :: values(:, :)      !! (items, instants)
      !> (7, 2) CPU seconds of the runs that have ended [s]; accepted increments, passes of the
      !> fixed point in all of them, largest pointwise imbalance of heat
      real(dp), pointer :: figures(:, :)
   contains
      procedure :: take
   end type row_values_type

   !> A row in a process of its own.
   type, extends(task_type) :: row_task_type
      character(:), allocatable :: path           !! the deck as given
      type(command_type) :: command               !! options of the command line
      type(read_deck_type), pointer :: deck => null()   !! read
      integer, allocatable :: nodes(:)            !! numbers of nodes whose temperature is compared
      type(row_values_type) :: found              !! values of the row
      type(variation_type) :: variation           !! the row
      real(dp) :: accuracy = 0.0_dp               !! that it requests; 0: none
   contains
      procedure :: execute
   end type row_task_type

   !> One of the processes that run beside each other.
   type :: row_run_type
      type(row_task_type) :: task     !! all but the variation is given
      integer :: row = 0              !! its index, 0 where none runs
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
      type(simulation_type), allocatable :: simulation
      type(input_files_type) :: inputs
      type(row_run_type) :: runs(command%jobs)
      type(trade_type) :: trade
      type(error_type), allocatable :: error
      character(:), allocatable :: table
      type(string_type) :: tables(1)
      integer :: i

      status = 0
      allocate (simulation)
      call prepare_deck(path, command, deck, model, simulation, error, &
         variation_type(order=2, levels=0))
      if (allocated(error)) status = error%status
      if (allocated(error)) return
      call simulation%release()
      table = results_of(path, command)//'.trade.csv'
      call inputs%add(path, deck%cards%files)
      tables(1)%value = table   ! gfortran leaks components of an array constructor
      call inputs%check(tables, error)
      if (.not. allocated(error)) call make_folder(command%folder, error)
      if (.not. allocated(error)) call try_file(table, error)
      do i = 1, size(runs)
         runs(i)%task%path = path
         runs(i)%task%command = command
         if (command%limit <= 0.0_dp) runs(i)%task%command%limit = usual_limit
         runs(i)%task%deck => deck
      end do
      if (.not. allocated(error)) call measure(model, &
         simulation%bodies%interfaces%pairing, runs, trade, error)
      if (allocated(error)) status = error%status
      if (status == status_interrupted .and. allocated(trade%rows)) then
         if (size(trade%rows) > 0) then
            trade%ended_early = error%message//': the table contains only the '// &
               counted(size(trade%rows), 'row')//' measured before'
            deallocate (error)
         end if
      end if
      if (.not. allocated(error)) then
         call state_errors(model%initial_temperature, trade)
         call judge_rows(trade)
         call write_trade(table, trade, error)
         if (allocated(error)) status = error%status
      end if
      if (allocated(error)) call print_error(path, error%message)
      if (allocated(error)) return
      if (.not. command%quiet) call print_trade(path, table, trade)
      if (imbalanced_rows(trade) /= '') call print_line(error_unit, path//': warning: at the '// &
         'end of an increment heat is out of balance by more than 1 % of the largest rate '// &
         '(heat_imbalance_pointwise), left by the thermal scheme: '//imbalanced_rows(trade))
      if (allocated(trade%ended_early)) call print_error(path, trade%ended_early)
      if (allocated(trade%ended_early)) return
      i = findloc(trade%rows%is_default, .true., dim=1)
      status = trade%rows(i)%status
      if (status /= 0) call print_error(path, 'the deck as written fails: '//trade%rows(i)%reason)
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
      integer :: contact_level, corners(2, size(model%mesh%node_number)), highest, i, level, most

      allocate (trade%rows(0), trade%left_out(0))
      ! Temperatures are those of the corners of the deck's own elements, which all rows have.
      corners = side_corners(model%mesh)
      nodes = pack(model%mesh%node_number, corners(1, :) == 0 .and. &
         any(solves_heat(model%steps%analysis)))
      nodes = nodes(::1 + (size(nodes) - 1)/most_nodes)
      trade%instants = common_instants(model, factors(1))
      trade%items = item_quantities(size(model%contacts), size(nodes))
      do i = 1, size(runs)
         associate (task => runs(i)%task)
            task%nodes = nodes
            task%found%instants = trade%instants
            call share_numbers(task%found%figures, runs_within(1), 2, error)
            if (.not. allocated(error)) call share_numbers(task%found%values, size(trade%items), &
               size(trade%instants), error)
         end associate
         if (allocated(error)) return
      end do
      call progress%start(runs(1)%task%command%quiet)
      most = model%written_levels + most_levels
      highest = merge(2, 1, any(side_node_count(model%mesh%element_kind) == 3))
      do contact_level = 0, merge(most, 0, size(model%contacts) > 0)
         do level = 0, most - contact_level
            call mesh_rows(model, highest, level, contact_level, rows)
            call leave_out_expensive(runs(1)%task%command%limit, trade, rows)
            call measure_rows(runs, progress, rows, error)
            trade%rows = [trade%rows, rows]
            if (allocated(error)) return
         end do
      end do
      call single_rows(model, highest, pairings, rows)
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
      real(dp) :: expected(size(rows))
      integer :: coarser, i, local

      ! From the one on the next coarser mesh with the same elements and increments; of the coarsest
      ! mesh 0.
      do i = 1, size(rows)
         associate (mesh => rows(i)%variation, measured => trade%rows%variation)
            local = merge(1, 0, mesh%contact_levels > 0)
            coarser = findloc(measured%order == mesh%order .and. measured%contact_levels == &
               mesh%contact_levels - local .and. measured%levels == mesh%levels - (1 - local) &
               .and. abs(measured%increments - mesh%increments) <= 0.0_dp, .true., dim=1)
            expected(i) = merge(0.0_dp, unknown, mesh%levels + mesh%contact_levels == 0)
         end associate
         if (coarser > 0) expected(i) = growth*trade%rows(coarser)%cpu_seconds
      end do
      where (rows%is_default) expected = 0.0_dp
      do i = 1, size(rows)
         if (expected(i) <= limit .or. expected(i) >= unknown) cycle
         rows(i)%reason = 'at least '//few_digits(expected(i))//' s'
         trade%left_out = [trade%left_out, rows(i)]
      end do
      rows = rows(pack([(i, i=1, size(rows))], expected <= limit))
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

      next = 1
      do while (next <= size(rows) .or. any(runs%row > 0))
         do i = 1, size(runs)
            associate (run => runs(i))
               if (run%row > 0) call collect(run, rows(run%row))
               if (run%row > 0 .or. next > size(rows)) cycle
               run%row = next
               run%task%variation = rows(next)%variation
               run%task%accuracy = rows(next)%accuracy
               next = next + 1
               call progress%say('level '//to_text(run%task%variation%levels)//', row '// &
                  to_text(run%row)//' of '//to_text(size(rows)))
               run%task%found%values = absent
               run%task%found%figures = 0.0_dp
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

   !> Takes what a row left, once its process has ended or its time is over.
   subroutine collect(self, row)
      type(row_run_type), intent(inout) :: self
      type(trade_row_type), intent(inout) :: row
      type(report_type) :: report
      real(dp) :: longest
      integer :: i

      associate (figures => self%task%found%figures)
         longest = max(patience*self%task%command%limit, least_patience)
         if (self%child%has_ended()) then
            report = self%child%report()
            call self%child%drop_files()
         else if (wall_seconds() - self%since >= longest*(1 + count(figures(:, 1) > 0.0_dp))) then
            call self%child%kill()
            report%status = int(status_internal, c_int)
            call set_reason(report, 'took longer than '//to_text(longest)//' s')
         else
            return
         end if
         self%row = 0
         row%peak_bytes = self%child%end%peak_bytes
         row%status = int(report%status)
         row%reason = reason_of(report)
         row%increments = nint(figures(1, 2))
         row%passes = nint(figures(2, 2))
         row%imbalance = figures(3, 2)
         row%values = self%task%found%values
         row%cpu = pack(figures(:, 1), figures(:, 1) > 0.0_dp)
      end associate
      if (size(row%cpu) == 0) row%cpu = [self%child%end%cpu_seconds]
      ! The median: the smallest that at least half of them do not exceed.
      row%cpu_seconds = minval(row%cpu, mask=[(2*count(row%cpu <= row%cpu(i)) >= size(row%cpu), &
         i=1, size(row%cpu))])
   end subroutine collect

   !> Solves the row as often as its time asks for: in a round, or in those of a requested accuracy.
   subroutine execute(self, report)
      class(row_task_type), intent(inout) :: self
      type(report_type), intent(inout) :: report    !! how it ended
      type(adaptive_rounds_type) :: fresh, rounds
      type(error_type), allocatable :: error
      real(dp) :: ended, began
      integer :: run

      do run = 1, runs_within(1)
         if (run > runs_within(count(self%found%figures(1, 1) > moments) + 1)) exit
         call cpu_time(began)
         rounds = fresh
         rounds%variation = self%variation
         do
            call rounds%begin_round()
            call solve_round(self, rounds, error)
            if (allocated(error) .or. .not. rounds%accuracy%goes_on) exit
         end do
         if (.not. allocated(error) .and. rounds%accuracy%is_on) then
            if (.not. rounds%accuracy%is_reached()) call set_error(error, status_verify, &
               'accuracy not reached: '//rounds%accuracy%reason)
         end if
         if (allocated(error)) exit
         call cpu_time(ended)
         self%found%figures(run, 1) = max(ended - began, tiny(ended))
      end do
      if (.not. allocated(error)) return
      report%status = int(error%status, c_int)
      call set_reason(report, error%message)
   end subroutine execute

   !> A round, without estimates where no accuracy is requested.
   !> Errors: as prepare_deck and solve_increments.
   subroutine solve_round(self, rounds, error)
      class(row_task_type), intent(inout) :: self
      type(adaptive_rounds_type), intent(inout) :: rounds
      type(error_type), allocatable, intent(out) :: error
      type(model_type) :: model
      type(simulation_type), allocatable :: simulation
      type(increment_record_type) :: record
      type(number_index_type) :: index
      integer :: i

      allocate (simulation)
      call prepare_deck(self%path, self%command, self%deck, model, simulation, error, &
         rounds%variation)
      if (allocated(error)) return
      model%uncertainty = merge(uncertainty_last, uncertainty_no, self%accuracy > 0.0_dp)
      model%steps%restart_frequency = 0
      if (allocated(model%accuracy%targets)) deallocate (model%accuracy%targets)
      if (self%accuracy > 0.0_dp) then
         model%accuracy%targets = whole_request(self%accuracy)
         if (needs_full(model)) model%uncertainty = uncertainty_full
      end if
      call index%build(model%mesh%node_number)
      self%found%nodes = [(index%find(self%nodes(i)), i=1, size(self%nodes))]
      self%found%figures(:, 2) = 0.0_dp
      call simulation%reduce(model, error)
      call rounds%solve_increments(model, simulation, self%found, record, error)
      if (allocated(error)) error%status = max(error%status, status_no_convergence)
      call simulation%release()
   end subroutine solve_round

   !> Takes the values at the instants of comparison; their order is that of item_quantities.
   subroutine take(self, simulation, record, error)
      class(row_values_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(increment_record_type), intent(inout) :: record
      type(error_type), allocatable, intent(inout) :: error
      type(contact_points_type), allocatable :: interfaces(:)
      real(dp), allocatable :: values(:)
      integer :: i, instant, q

      if (allocated(record%iterations)) self%figures(2, 2) = self%figures(2, 2) + &
         size(record%iterations)
      if (allocated(error)) return
      self%figures(1, 2) = self%figures(1, 2) + 1
      if (ieee_is_finite(record%heat_imbalance_pointwise)) self%figures(3, 2) = &
         max(self%figures(3, 2), record%heat_imbalance_pointwise)
      instant = instant_at(self%instants, record%time)
      if (instant == 0) return
      call simulation%bodies%views(interfaces)
      allocate (values(0))
      do i = 1, size(interfaces)
         values = [values, (contact_values(traded(q)%name, record%contacts(i)), q=1, &
            figure_count), closed_length(interfaces(i), record%contacts(i))]
      end do
      if (size(interfaces) == 0) values = [(merge(record%heat_in, absent, &
         traded(q)%name == 'heat_rate'), q=1, figure_count), 0.0_dp]
      values = [values, record%fields%temperature(self%nodes)]
      where (.not. ieee_is_finite(values)) values = absent
      self%values(:, instant) = values
   end subroutine take

end module deck_trade
