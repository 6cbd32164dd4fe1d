!> `thercon trade`: speed against accuracy of one deck, measured.
module deck_trade
   use, intrinsic :: iso_fortran_env, only: output_unit
   use command_line, only: command_type
   use contact_definitions, only: pairing_nodes, pairing_surfaces
   use deck_files, only: base_name, input_files_type
   use deck_preparation, only: prepare_deck, read_deck_type
   use errors, only: error_type, status_deck, status_interrupted
   use file_calls, only: is_stream, make_folder, try_file
   use increments, only: simulation_type
   use kinds, only: dp
   use messages, only: print_error, print_line
   use model, only: model_type
   use order_reduction, only: side_corners
   use progress, only: progress_type
   use recommendation, only: judge_rows
   use steps, only: solves_heat
   use text, only: counted, few_digits, string_type
   use trade_measurement, only: measure_rows, row_task_type
   use trade_plan, only: coarser_row, common_instants, mesh_rows, most_levels, &
      single_rows
   use trade_reference, only: state_errors
   use trade_study, only: item_quantities, trade_row_type, trade_type
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
      type(read_deck_type) :: deck
      type(model_type) :: model
      type(simulation_type) :: simulation
      type(trade_type) :: trade
      type(error_type), allocatable :: error
      character(:), allocatable :: table
      integer :: i, other_pairing

      status = status_deck
      if (is_stream(path)) then
         call print_error(path, 'trade reads the deck more than once: give a file, not a pipe')
         return
      end if
      call prepare_deck(path, command, deck, model, simulation, error, &
         variation_type(order=2, levels=0))
      if (allocated(error)) then
         status = error%status
         return
      end if
      other_pairing = pairing_to_try(simulation, model)
      call simulation%release()
      table = command%folder//'/'//base_name(path)//'.trade.csv'
      call prepare_table(table, path, command, deck, error)
      if (.not. allocated(error)) call measure(path, command, other_pairing, model, trade, error)
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

   !> Sees whether the table can be written.
   !> Errors: a file of the deck is in its place, the folder or the file cannot be written.
   subroutine prepare_table(table, path, command, deck, error)
      character(*), intent(in) :: table, path
      type(command_type), intent(in) :: command
      type(read_deck_type), intent(in) :: deck
      type(error_type), allocatable, intent(out) :: error
      type(input_files_type) :: inputs

      call inputs%add(path, deck%cards%files)
      call inputs%check([string_type(table)], error)
      if (.not. allocated(error)) call make_folder(command%folder, error)
      if (.not. allocated(error)) call try_file(table, error)
   end subroutine prepare_table

   !> The pairing that the deck does not have, 0 where there is none.
   pure integer function pairing_to_try(simulation, model) result(other)
      type(simulation_type), intent(in) :: simulation
      type(model_type), intent(in) :: model

      other = 0
      if (all(simulation%bodies%interfaces%pairing == pairing_nodes)) other = pairing_surfaces
      if (any(model%contacts%pairing == pairing_surfaces)) other = pairing_nodes
      if (size(model%contacts) == 0) other = 0
   end function pairing_to_try

   !> Runs the grid level by level, then meshes with ever more levels at the contact faces, both as
   !> far as that is affordable, then the single variations.
   subroutine measure(path, command, other_pairing, model, trade, error)
      character(*), intent(in) :: path
      type(command_type), intent(in) :: command
      integer, intent(in) :: other_pairing                !! pairing of single_rows
      type(model_type), intent(in) :: model
      type(trade_type), intent(inout) :: trade
      type(error_type), allocatable, intent(out) :: error
      type(row_task_type) :: task
      type(progress_type) :: progress
      type(trade_row_type), allocatable :: rows(:)
      integer :: level, contact_level, corners(2, size(model%mesh%node_number))

      task%path = path
      task%command = command
      ! Temperatures are those of the corners of the deck's own elements, which all rows have.
      corners = side_corners(model%mesh)
      task%nodes = pack(model%mesh%node_number, corners(1, :) == 0 .and. &
         any(solves_heat(model%steps%analysis)))
      task%nodes = task%nodes(::1 + (size(task%nodes) - 1)/most_nodes)
      trade%instants = common_instants(model)
      trade%items = item_quantities(size(model%contacts), size(task%nodes))
      task%instants = trade%instants
      task%items = trade%items
      allocate (trade%rows(0), trade%left_out(0))
      call progress%start(command%quiet)
      associate (most => model%written_levels + most_levels)
         do contact_level = 0, merge(most, 0, size(model%contacts) > 0)
            do level = 0, most - contact_level
               call mesh_rows(model, level, contact_level, rows)
               call leave_out_expensive(command%limit, trade, rows)
               call run_rows()
               if (allocated(error)) return
            end do
         end do
      end associate
      call single_rows(model, other_pairing, rows)
      call run_rows()
      call progress%clear()
   contains
      subroutine run_rows()
         call measure_rows(task, progress, rows, error)
         trade%rows = [trade%rows, rows]
      end subroutine run_rows
   end subroutine measure

   !> Leaves out the rows that would cost too much, but never the deck as written; rows on meshes
   !> even finer than those are not named.
   pure subroutine leave_out_expensive(limit, trade, rows)
      real(dp), intent(in) :: limit                       !! CPU seconds that a row may take [s]
      type(trade_type), intent(inout) :: trade            !! receives them
      type(trade_row_type), allocatable, intent(inout) :: rows(:)
      logical :: is_kept(size(rows))
      real(dp) :: seconds
      integer :: i, before

      do i = 1, size(rows)
         before = coarser_row(trade%rows, rows(i)%variation)
         is_kept(i) = rows(i)%is_default .or. rows(i)%variation%levels + &
            rows(i)%variation%contact_levels == 0
         if (is_kept(i) .or. before == 0) cycle
         seconds = growth*trade%rows(before)%cpu_seconds
         is_kept(i) = seconds <= limit
         if (is_kept(i)) cycle
         trade%left_out = [trade%left_out, rows(i)]
         trade%left_out(size(trade%left_out))%reason = 'at least '//few_digits(seconds)//' s'
      end do
      rows = rows(pack([(i, i=1, size(rows))], is_kept))
   end subroutine leave_out_expensive

end module deck_trade
