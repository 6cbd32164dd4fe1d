!> Group `/restart` of the result file: the state of the run at the increments at which *RESTART
!> asks for it, one behind the other.
module restart_results
   use hdf5_writer, only: as_real, hdf5_writer_type
   use kinds, only: dp
   use records, only: increment_record_type
   use growing_datasets, only: flush_sets, growing_dataset, growing_dataset_type
   use state_tables, only: state_table_type
   use text, only: string_type
   implicit none
   private
   public :: restart_results_type, restart_group, names_set, place_set, value_set
   public :: at_increment, at_step, at_increment_in_step, at_time, at_count, place_columns

   character(*), parameter :: restart_group = '/restart'
   character(*), parameter :: names_set = restart_group//'/names'
   character(*), parameter :: place_set = restart_group//'/places'
   character(*), parameter :: value_set = restart_group//'/values'
   !> Columns of the places.
   integer, parameter :: at_increment = 1, at_step = 2, at_increment_in_step = 3, at_time = 4, &
      at_count = 5, place_columns = 5
   integer, parameter :: most_in_chunk = 131072   !! values

   !> The restarts that a run writes.
   type :: restart_results_type
      type(growing_dataset_type), allocatable :: sets(:)    !! places, values
      type(string_type), allocatable, private :: names(:)   !! of the arrays
      integer, private :: step = 0                          !! of the last one
      integer, private :: values_before = 0                 !! values of those before it
   contains
      procedure :: append
      procedure :: go_on
      procedure :: flush => flush_restarts
   end type restart_results_type

contains

   !> Adds a restart, in the place of the last one where only one of each step is kept.
   subroutine append(self, record, table, overlays)
      class(restart_results_type), intent(inout) :: self
      type(increment_record_type), intent(in) :: record
      type(state_table_type), intent(in) :: table         !! state of the run, whole
      logical, intent(in) :: overlays                     !! whether only one of each step is kept
      integer :: count

      if (.not. allocated(self%sets)) call start(self, table)
      associate (places => self%sets(1), values => self%sets(2))
         if (overlays .and. self%step == record%step) then
            call places%cut(places%rows() - 1)
            call values%cut(self%values_before)
         end if
         self%step = record%step
         self%values_before = values%rows()
         count = table%arrays + table%count
         call places%append([real(record%increment, dp), real(record%step, dp), &
            real(record%increment_in_step, dp), record%time, real(count, dp)])
         call values%append(real(table%sizes(:table%arrays), dp))
         call values%append(table%values(:table%count))
      end associate
   end subroutine append

   !> Prepares the datasets.
   subroutine start(self, table)
      type(restart_results_type), intent(inout) :: self
      type(state_table_type), intent(in) :: table
      integer :: i

      allocate (self%names(table%arrays), self%sets(2))
      self%sets(1) = growing_dataset(place_set, as_real, place_columns, 1, 1000, &
         'where each state is, and how many values it has', 'time')
      self%sets(1)%components = 'increment step increment_in_step time values'
      self%sets(2) = growing_dataset(value_set, as_real, 0, min(most_in_chunk, &
         table%arrays + table%count), 10, &
         'the states one behind the other: sizes of all arrays (-1: not there), then their values')
      do i = 1, size(self%names)
         self%names(i)%value = trim(table%names(i))
      end do
   end subroutine start

   !> Goes on behind the first restarts of an earlier file.
   subroutine go_on(self, file, table, counts)
      class(restart_results_type), intent(inout) :: self  !! empty
      type(hdf5_writer_type), intent(inout) :: file       !! the open file
      type(state_table_type), intent(in) :: table         !! the last of those that are kept
      integer, intent(in) :: counts(2)                    !! restarts that are kept, their values
      integer :: i

      call start(self, table)
      do i = 1, size(self%sets)
         call self%sets(i)%go_on(file, counts(i))
      end do
   end subroutine go_on

   !> Writes the restarts that wait.
   subroutine flush_restarts(self, file)
      class(restart_results_type), intent(inout) :: self
      type(hdf5_writer_type), intent(inout) :: file       !! the open file

      if (.not. allocated(self%sets)) return
      if (.not. file%has(restart_group)) then
         call file%create_group(restart_group)
         call file%write(names_set, self%names, 'names of the arrays of the state')
      end if
      call flush_sets(self%sets, file)
   end subroutine flush_restarts

end module restart_results
