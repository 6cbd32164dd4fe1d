!> `thercon trade`: speed against accuracy of one deck, measured.
module deck_trade
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use all_contact_points, only: match_surfaces
   use command_line, only: command_type
   use contact_definitions, only: pairing_by_faces, pairing_nodes, pairing_surfaces
   use contact_points, only: contact_points_type
   use deck_preparation, only: prepare_deck, read_deck_type
   use deck_run, only: base_name
   use element_kinds, only: element_corner_count
   use errors, only: error_type, status_deck, status_interrupted
   use file_calls, only: is_stream, make_folder, print_text, try_file
   use increments, only: simulation_type
   use input_files, only: input_files_type
   use kinds, only: dp
   use messages, only: print_error, print_line
   use model, only: model_type
   use printed_text, only: printed_text_type
   use recommendation, only: judge_rows
   use sorting, only: unique_sorted
   use text, only: counted, string_type
   use trade_errors, only: state_errors
   use trade_file, only: write_trade
   use trade_instants, only: common_instants
   use trade_limits, only: check_affordable, note_left_out
   use trade_measurement, only: measurement_type, working_paths
   use trade_plan, only: add_contact_level, add_level, add_singles, longest_factor, make_room, &
      most_levels
   use trade_reference, only: find_reference, reference_type
   use trade_rows, only: trade_type
   use trade_table, only: print_imbalances, print_trade
   use variations, only: variation_type
   implicit none
   private
   public :: trade_deck

   integer, parameter :: most_nodes = 2000   !! whose temperatures are compared

contains

   !> Measures a deck and prints and writes the table. What goes wrong is printed on stderr. A deck
   !> that does not run as it is written has a table all the same; so has a trade that a signal
   !> ends.
   subroutine trade_deck(path, command, status)
      character(*), intent(in) :: path             !! the deck as given
      type(command_type), intent(in) :: command    !! options of the command line
      integer, intent(out) :: status               !! exit status
      type(read_deck_type) :: deck
      type(model_type) :: model
      type(simulation_type) :: simulation
      type(trade_type) :: trade
      type(reference_type) :: reference
      type(input_files_type) :: inputs
      type(error_type), allocatable :: error, ended_early
      character(:), allocatable :: results
      integer :: i

      status = status_deck
      if (is_stream(path)) then
         call print_error(path, 'trade reads the deck more than once: give a file, not a pipe')
         return
      end if
      call prepare_deck(path, command, deck, model, simulation, error, &
         variation_type(order=2, levels=0))
      call simulation%release()
      if (allocated(error)) then
         status = error%status
         return
      end if
      results = command%folder//'/'//base_name(path)//'.trade'
      trade%instants = common_instants(model, longest_factor)
      call inputs%add(path, deck%cards%files)
      call inputs%check([string_type(results//'.csv'), working_paths(results, command%jobs)], error)
      if (.not. allocated(error)) call make_folder(command%folder, error)
      if (.not. allocated(error)) call try_file(results//'.csv', error)
      if (.not. allocated(error)) call measure(path, command, results, model, trade, error)
      call forgive_signal(trade, error, ended_early)
      if (.not. allocated(error)) then
         call find_reference(trade, reference)
         call state_errors(reference, model%initial_temperature, trade)
         call judge_rows(trade)
         call write_trade(results//'.csv', trade, error)
      end if
      if (allocated(error)) then
         status = error%status
         call print_error(path, error%message)
         return
      end if
      if (.not. command%quiet) then
         call print_table(path, results, trade)
      end if
      call print_imbalances(error_unit, path, trade)
      if (allocated(ended_early)) then
         status = ended_early%status
         call print_error(path, ended_early%message)
         return
      end if
      i = findloc(trade%rows(:trade%count)%is_default, .true., dim=1)
      status = trade%rows(i)%status
      if (status /= 0) call print_error(path, 'the deck as written fails: '// &
         trade%rows(i)%reason)
   end subroutine trade_deck

   !> A signal after some rows is no error yet: their table can be made.
   pure subroutine forgive_signal(trade, error, ended_early)
      type(trade_type), intent(inout) :: trade
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable, intent(out) :: ended_early

      if (.not. allocated(error)) return
      if (error%status /= status_interrupted .or. trade%count == 0) return
      call move_alloc(error, ended_early)
      ended_early%message = ended_early%message//': the table contains only the '// &
         counted(trade%count, 'row')//' measured before'
      trade%ended_early = ended_early%message
   end subroutine forgive_signal

   !> Prints the table on stdout, where it may find no room.
   subroutine print_table(path, results, trade)
      character(*), intent(in) :: path, results
      type(trade_type), intent(in) :: trade
      type(printed_text_type) :: text
      type(error_type), allocatable :: error
      character(:), allocatable :: lines

      call text%open(error)
      if (allocated(error)) then
         call print_error(path, error%message)
         return
      end if
      call print_trade(text%unit, path, trade)
      call text%take(lines)
      call text%close()
      call print_text(lines)
      call print_line(output_unit, 'table: '//results//'.csv')
   end subroutine print_table

   !> Runs the grid level by level, as long as that is affordable, then meshes with ever more levels
   !> at the contact faces, then the single variations.
   subroutine measure(path, command, results, model, trade, error)
      character(*), intent(in) :: path, results
      type(command_type), intent(in) :: command
      type(model_type), intent(in) :: model
      type(trade_type), intent(inout) :: trade
      type(error_type), allocatable, intent(out) :: error
      type(measurement_type) :: measurement
      integer :: level, first

      measurement%task%path = path
      measurement%task%command = command
      measurement%task%instants = trade%instants
      measurement%task%nodes = compared_nodes(model)
      measurement%scratch = results
      measurement%jobs = command%jobs
      measurement%limit = command%limit
      call measurement%progress%start(command%quiet)
      call make_room(model, trade)
      do level = 0, model%written_levels + most_levels
         first = trade%count + 1
         call add_level(model, level, trade)
         call keep_affordable(trade, first, command)
         call measurement%run(trade, first, trade%count, error)
         if (allocated(error)) return
         if (trade%count < first .and. level >= model%written_levels) exit
      end do
      do level = 1, model%written_levels + most_levels
         first = trade%count + 1
         call add_contact_level(model, level, trade)
         call keep_affordable(trade, first, command)
         if (trade%count < first) exit
         call measurement%run(trade, first, trade%count, error)
         if (allocated(error)) return
      end do
      first = trade%count + 1
      call add_singles(model, other_pairing(model), trade)
      call measurement%run(trade, first, trade%count, error)
   end subroutine measure

   !> The pairing that the deck does not have although all its faces match; 0 where one does not.
   integer function other_pairing(model)
      type(model_type), intent(in) :: model
      type(model_type) :: by_faces
      type(contact_points_type) :: points
      type(error_type), allocatable :: error
      integer :: i

      other_pairing = 0
      if (size(model%contacts) == 0) return
      by_faces = model
      by_faces%contacts%pairing = pairing_by_faces
      do i = 1, size(model%contacts)
         call match_surfaces(by_faces, i, points, error)
         if (allocated(error)) return
         if (points%pairing /= pairing_nodes) return
      end do
      other_pairing = merge(pairing_nodes, pairing_surfaces, &
         any(model%contacts%pairing == pairing_surfaces))
   end function other_pairing

   !> Takes the rows out again that would cost too much, but never the deck as it is written.
   subroutine keep_affordable(trade, first, command)
      type(trade_type), intent(inout) :: trade
      integer, intent(in) :: first
      type(command_type), intent(in) :: command
      character(:), allocatable :: reason
      integer :: i, kept

      kept = first - 1
      do i = first, trade%count
         reason = ''
         if (.not. trade%rows(i)%is_default) call check_affordable(trade, i, command%limit, &
            command%jobs, reason)
         if (len(reason) > 0) then
            call note_left_out(trade%rows(i), reason, trade%left_out)
         else
            kept = kept + 1
            if (kept < i) trade%rows(kept) = trade%rows(i)
         end if
      end do
      trade%count = kept
   end subroutine keep_affordable

   !> Numbers of the nodes whose temperatures are compared: corners of the deck's own elements,
   !> which all rows have; some of them where they are many.
   pure function compared_nodes(model) result(numbers)
      type(model_type), intent(in) :: model
      integer, allocatable :: numbers(:)
      logical :: is_corner(size(model%mesh%node_number))
      integer :: e

      is_corner = .false.
      associate (mesh => model%mesh)
         do e = 1, size(mesh%element_kind)
            is_corner(mesh%element_nodes(:element_corner_count(mesh%element_kind(e)), e)) = .true.
         end do
         numbers = unique_sorted(pack(mesh%node_number, is_corner))
      end associate
      numbers = numbers(::1 + (size(numbers) - 1)/most_nodes)
   end function compared_nodes

end module deck_trade
