!> One row of a trade-off study, solved in a process of its own, without output.
module row_task
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_int
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
   use processes, only: report_type, set_reason, task_type
   use records, only: increment_record_type
   use reported_quantities, only: traded
   use sorting, only: number_index_type
   use trade_plan, only: instant_at
   use trade_study, only: absent, figure_count, trade_row_type
   use variations, only: variation_type
   implicit none
   private
   public :: row_task_type

   !> Everything that a row needs, and what it finds.
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
      procedure :: load
   end type row_task_type

contains

   !> Solves the row and leaves what it found in the file; the parent notices one that is not whole.
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
         allocate (row%values(size(self%items), size(self%instants)), source=absent)
         call solve(self, model, simulation, row, error)
         open (newunit=unit, file=self%found, access='stream', status='old', iostat=io)
         if (io == 0) write (unit, iostat=io) row%increments, row%passes, row%values
         if (io == 0) close (unit, iostat=io)
         if (allocated(error)) error%status = max(error%status, status_no_convergence)
      end if
      if (.not. allocated(error)) return
      report%status = int(error%status, c_int)
      call set_reason(report, error%message)
   end subroutine execute

   !> Reads what a row found.
   !> Error: status_internal, when there is no whole file.
   subroutine load(self, row, error)
      class(row_task_type), intent(in) :: self
      type(trade_row_type), intent(inout) :: row
      type(error_type), allocatable, intent(out) :: error
      integer :: unit, io

      allocate (row%values(size(self%items), size(self%instants)))
      open (newunit=unit, file=self%found, access='stream', status='old', iostat=io)
      if (io == 0) read (unit, iostat=io) row%increments, row%passes, row%values
      if (io /= 0) call set_error(error, status_internal, 'a row left no values')
      close (unit, iostat=io)
   end subroutine load

   subroutine solve(self, model, simulation, row, error)
      type(row_task_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(inout) :: simulation
      type(trade_row_type), intent(inout) :: row
      type(error_type), allocatable, intent(out) :: error
      type(increment_record_type) :: record
      type(number_index_type) :: index
      integer :: nodes(size(self%nodes)), instant, i

      call simulation%reduce(model, error)
      if (allocated(error)) return
      call index%build(model%mesh%node_number)
      nodes = [(index%find(self%nodes(i)), i=1, size(nodes))]
      do while (.not. simulation%finished(model))
         if (caught_signal() /= '') then
            call set_error(error, status_interrupted, 'ended by '//caught_signal())
            return
         end if
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

end module row_task
