!> `thercon trade`: speed against accuracy of one deck, measured.
module deck_trade
   use, intrinsic :: iso_fortran_env, only: output_unit
   use command_line, only: command_type
   use deck_files, only: input_files_type, results_of
   use deck_preparation, only: prepare_deck, read_deck_type
   use errors, only: error_type, status_interrupted
   use file_calls, only: make_folder, try_file
   use increments, only: simulation_type
   use kinds, only: dp
   use messages, only: print_error, print_line
   use model, only: model_type
   use order_reduction, only: side_corners
   use processes, only: share_numbers
   use progress, only: progress_type
   use steps, only: solves_heat
   use text, only: counted, few_digits, string_type
   use trade_measurement, only: measure_rows, row_run_type
   use trade_plan, only: common_instants, mesh_rows, most_levels, single_rows
   use trade_reference, only: state_errors
   use trade_study, only: item_quantities, judge_rows, trade_row_type, trade_type
   use trade_table, only: print_trade, write_trade
   use variations, only: variation_type
   implicit none
   private
   public :: trade_deck

   integer, parameter :: most_nodes = 2000     !! whose temperatures are compared
   real(dp), parameter :: growth = 4.0_dp      !! of elements from one mesh to the next

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
      integer, allocatable :: pairings(:)
      integer :: i

      call prepare_deck(path, command, deck, model, simulation, error, &
         variation_type(order=2, levels=0))
      if (allocated(error)) then
         status = error%status
         return
      end if
      pairings = simulation%bodies%interfaces%pairing
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
      if (.not. allocated(error)) call measure(model, pairings, runs, trade, error)
      if (allocated(error)) then
         status = error%status
         if (status == status_interrupted .and. size(trade%rows) > 0) then
            trade%ended_early = error%message//': the table contains only the '// &
               counted(size(trade%rows), 'row')//' measured before'
            deallocate (error)
         end if
      end if
      if (.not. allocated(error)) then
         call state_errors(model%initial_temperature, trade)
         call judge_rows(trade)
         call write_trade(table, trade, error)
      end if
      if (allocated(error)) then
         status = error%status
         call print_error(path, error%message)
         return
      end if
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
         runs(i)%task%nodes = nodes
         runs(i)%task%instants = trade%instants
         call share_numbers(runs(i)%task%values, size(trade%items), size(trade%instants), error)
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

end module deck_trade
