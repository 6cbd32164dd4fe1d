!> Group `/restart` of the result file: the state of the run at the increments at which *RESTART
!> asks for it, one behind the other.
module restart_results
   use hdf5_writer, only: as_integer, as_real, hdf5_writer_type
   use kinds, only: dp
   use model, only: unit_labels_type
   use records, only: increment_record_type
   use result_tables, only: flush_sets, growing_dataset, growing_dataset_type
   use state_tables, only: state_table_type
   use text, only: string_type
   use unit_labels, only: unit_in_words
   implicit none
   private
   public :: restart_results_type, restart_group, names_set, place_sets, size_set, value_set

   character(*), parameter :: restart_group = '/restart'
   !> Datasets with a number for each restart: where it is, in the order of their rows.
   character(*), parameter :: place_sets(4) = [character(26) :: restart_group//'/increment', &
      restart_group//'/step', restart_group//'/increment_in_step', restart_group//'/time']
   character(*), parameter :: place_descriptions(4) = [character(34) :: &
      'running number of the increment', 'step', 'number of the increment in its step', &
      'total time']
   character(*), parameter :: names_set = restart_group//'/names'
   character(*), parameter :: size_set = restart_group//'/sizes'
   character(*), parameter :: value_set = restart_group//'/values'
   integer, parameter :: most_in_chunk = 131072   !! values

   !> The restarts that a run writes.
   type :: restart_results_type
      !> One for each of place_sets, then sizes and values
      type(growing_dataset_type), allocatable :: sets(:)
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
   subroutine append(self, record, table, overlays, labels)
      class(restart_results_type), intent(inout) :: self
      type(increment_record_type), intent(in) :: record
      type(state_table_type), intent(in) :: table         !! state of the run, whole
      logical, intent(in) :: overlays                     !! whether only one of each step is kept
      type(unit_labels_type), intent(in) :: labels        !! units of the deck
      integer :: i
      real(dp) :: places(size(place_sets))

      if (.not. allocated(self%sets)) call start(self, table, labels)
      associate (sets => self%sets, n => size(place_sets))
         if (overlays .and. self%step == record%step) then
            do i = 1, n + 1
               call sets(i)%cut(sets(i)%rows() - 1)
            end do
            call sets(n + 2)%cut(self%values_before)
         end if
         self%step = record%step
         self%values_before = sets(n + 2)%rows()
         places = [real(record%increment, dp), real(record%step, dp), &
            real(record%increment_in_step, dp), record%time]
         do i = 1, n
            call sets(i)%append(places(i:i))
         end do
         call sets(n + 1)%append(real(table%sizes, dp))
         call sets(n + 2)%append(table%values)
      end associate
   end subroutine append

   !> Prepares the datasets.
   subroutine start(self, table, labels)
      type(restart_results_type), intent(inout) :: self
      type(state_table_type), intent(in) :: table
      type(unit_labels_type), intent(in) :: labels
      integer :: i, n

      n = size(place_sets)
      allocate (self%sets(n + 2), self%names(size(table%names)))
      do i = 1, n
         self%sets(i) = growing_dataset(trim(place_sets(i)), merge(as_real, as_integer, i == n), 0, &
            1, 1000, place_descriptions(i))
      end do
      self%sets(n) = growing_dataset(trim(place_sets(n)), as_real, 0, 1, 1000, &
         place_descriptions(n), unit_in_words('time', labels))
      self%sets(n + 1) = growing_dataset(size_set, as_integer, size(table%names), 1, 10, &
         'values of each array of the state; -1: it is not there')
      self%sets(n + 2) = growing_dataset(value_set, as_real, 0, min(most_in_chunk, &
         max(1, size(table%values))), 10, 'all arrays of all restarts, one behind the other')
      do i = 1, size(self%names)
         self%names(i)%value = trim(table%names(i))
      end do
   end subroutine start

   !> Goes on behind the first restarts of an earlier file.
   subroutine go_on(self, file, table, counts, labels)
      class(restart_results_type), intent(inout) :: self  !! empty
      type(hdf5_writer_type), intent(inout) :: file       !! the open file
      type(state_table_type), intent(in) :: table         !! the last of those that are kept
      integer, intent(in) :: counts(2)                    !! restarts that are kept, their values
      type(unit_labels_type), intent(in) :: labels        !! units of the deck
      integer :: i

      call start(self, table, labels)
      do i = 1, size(self%sets)
         call self%sets(i)%go_on(file, counts(merge(2, 1, i == size(self%sets))))
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
