!> One row of a trade, solved in a process of its own.
module row_task
   use, intrinsic :: iso_c_binding, only: c_int
   use command_line, only: command_type
   use deck_preparation, only: prepare_deck, read_deck_type
   use errors, only: error_type, set_error, status_interrupted, status_no_convergence
   use increments, only: simulation_type
   use interruption, only: caught_signal
   use kinds, only: dp
   use model, only: model_type
   use processes, only: report_type, set_reason, task_type
   use records, only: increment_record_type
   use sorting, only: number_index_type
   use steps, only: solves_heat
   use trade_instants, only: instant_at
   use trade_quantities, only: row_values_type
   use variations, only: variation_type
   implicit none
   private
   public :: row_task_type

   !> What a row needs. It solves, and recovers the fields that are due, but writes no results.
   type, extends(task_type) :: row_task_type
      character(:), allocatable :: path          !! the deck as given
      type(command_type) :: command              !! options of the command line
      type(variation_type) :: variation          !! what is other than in the deck
      real(dp), allocatable :: instants(:)       !! total times of comparison [time]
      integer, allocatable :: nodes(:)           !! numbers of nodes whose temperature is compared
      character(:), allocatable :: values_path   !! file for the values
   contains
      procedure :: execute
   end type row_task_type

contains

   !> Solves the row and leaves its values in a file.
   subroutine execute(self, report)
      class(row_task_type), intent(inout) :: self
      type(report_type), intent(inout) :: report    !! how it ended
      type(read_deck_type) :: deck
      type(model_type) :: model
      type(simulation_type) :: simulation
      type(row_values_type) :: values
      type(error_type), allocatable :: error

      call prepare_deck(self%path, self%command, deck, model, simulation, error, self%variation)
      if (.not. allocated(error)) then
         call solve(self, model, simulation, values, error)
         call values%save(self%values_path)
         if (allocated(error)) error%status = max(error%status, status_no_convergence)
      end if
      if (.not. allocated(error)) return
      report%status = int(error%status, c_int)
      call set_reason(report, error%message)
   end subroutine execute

   subroutine solve(self, model, simulation, values, error)
      type(row_task_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(inout) :: simulation
      type(row_values_type), intent(inout) :: values
      type(error_type), allocatable, intent(out) :: error
      type(increment_record_type) :: record
      integer, allocatable :: nodes(:)
      integer :: instant

      call simulation%reduce(model, error)
      if (allocated(error)) return
      nodes = node_indexes(model, self%nodes)
      associate (interfaces => simulation%bodies%interfaces)
         call values%prepare(size(interfaces), size(nodes), size(self%instants))
         do while (.not. simulation%finished(model))
            if (caught_signal() /= '') then
               call set_error(error, status_interrupted, 'ended by '//caught_signal())
               return
            end if
            call simulation%advance(model, record, error)
            if (allocated(record%iterations)) values%passes = values%passes + &
               size(record%iterations)
            if (allocated(error)) return
            values%increments = values%increments + 1
            if (solves_heat(model%steps(record%step)%analysis)) values%imbalance = &
               max(values%imbalance, record%heat_imbalance_pointwise)
            instant = instant_at(self%instants, record%time)
            if (instant > 0) call values%sample(record, interfaces, nodes, instant)
         end do
      end associate
   end subroutine solve

   !> Indexes of nodes by their numbers; none where no step solves heat.
   pure function node_indexes(model, numbers) result(indexes)
      type(model_type), intent(in) :: model
      integer, intent(in) :: numbers(:)
      integer, allocatable :: indexes(:)
      type(number_index_type) :: index
      integer :: i

      if (.not. any(solves_heat(model%steps%analysis))) then
         allocate (indexes(0))
         return
      end if
      call index%build(model%mesh%node_number)
      allocate (indexes(size(numbers)))
      do i = 1, size(numbers)
         indexes(i) = index%find(numbers(i))
      end do
   end function node_indexes

end module row_task
