!> Groups `/history/nodes/<set>` and `/history/elements/<set>` of the result file: what *NODE PRINT
!> and *EL PRINT print, a row for each increment at which a table of the set is due.
module history_results
   use growing_datasets, only: bytes_in, flush_sets, growing_dataset, growing_dataset_type, &
      write_integers
   use hdf5_writer, only: as_integer, as_real, hdf5_writer_type
   use kinds, only: dp, long
   use model, only: model_type
   use records, only: increment_record_type
   use requested_tables, only: requested_table_type, table_column_type, tables_of_step
   use text, only: append_text => append, string_type
   implicit none
   private
   public :: history_results_type

   character(*), parameter :: above(2) = [character(17) :: '/history/nodes', '/history/elements']
   integer, parameter :: first_quantity = 3   !! dataset behind increment and time

   !> The group of a set.
   type :: set_history_type
      character(:), allocatable :: group                     !! its path
      character(:), allocatable :: above                     !! path of the group above
      type(requested_table_type) :: table                    !! the first of the set
      integer, allocatable :: number(:)                      !! of its nodes or elements in the deck
      character(:), allocatable :: name_of_numbers           !! node or element
      type(string_type), allocatable :: names(:)             !! of the datasets, as they are below
      type(growing_dataset_type), allocatable :: sets(:)     !! increment, time, the quantities
   end type set_history_type

   !> All of them, in the order in which steps ask for them first.
   type :: history_results_type
      private
      type(set_history_type), allocatable :: histories(:)
   contains
      procedure :: start
      procedure :: append
      procedure :: rows
      procedure :: go_on
      procedure :: bytes
      procedure :: flush => flush_histories
   end type history_results_type

contains

   !> Prepares the datasets that the tables of all steps need.
   subroutine start(self, model, expected)
      class(history_results_type), intent(out) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: expected                     !! rows that are expected
      type(requested_table_type), allocatable :: tables(:)
      integer :: i, s

      allocate (self%histories(0))
      do s = 1, size(model%steps)
         call tables_of_step(s, model, tables)
         do i = 1, size(tables)
            ! A set may have no node of an element.
            if (size(tables(i)%member) == 0) cycle
            call take_table(self, tables(i), model, expected)
         end do
      end do
   end subroutine start

   !> Adds the datasets of a table that are not there yet.
   subroutine take_table(self, table, model, expected)
      type(history_results_type), intent(inout) :: self
      type(requested_table_type), intent(in) :: table
      type(model_type), intent(in) :: model
      integer, intent(in) :: expected
      type(set_history_type) :: history
      integer :: i, place

      place = place_of(self, table)
      if (place == 0) then
         place = size(self%histories) + 1
         call start_history(self, table, model, expected, history)
         self%histories = [self%histories, history]
      end if
      do i = 1, size(table%columns)
         call add_dataset(self%histories(place), table%columns(i), size(table%member), expected, &
            ', a column for each row of '//self%histories(place)%name_of_numbers)
      end do
      do i = 1, size(table%totals)
         call add_dataset(self%histories(place), table%totals(i), 0, expected, &
            ', the sum over all nodes of the set')
      end do
   end subroutine take_table

   !> Index of the history of a table; 0 for none.
   pure integer function place_of(self, table) result(place)
      type(history_results_type), intent(in) :: self
      type(requested_table_type), intent(in) :: table

      do place = size(self%histories), 1, -1
         associate (its => self%histories(place)%table)
            if (its%is_of_nodes .neqv. table%is_of_nodes) cycle
            if (its%set /= table%set .or. size(its%member) /= size(table%member)) cycle
            if (all(its%member == table%member)) return
         end associate
      end do
   end function place_of

   !> Starts the history of a set, without quantities.
   subroutine start_history(self, table, model, expected, history)
      type(history_results_type), intent(in) :: self       ! the others
      type(requested_table_type), intent(in) :: table
      type(model_type), intent(in) :: model
      integer, intent(in) :: expected
      type(set_history_type), intent(inout) :: history
      integer :: i

      history%table = table
      history%above = trim(above(merge(1, 2, table%is_of_nodes)))
      ! HDF5 takes neither a slash nor a point alone for a name.
      history%group = table%set
      if (history%group == '.') history%group = '|'
      do i = 1, len(history%group)
         if (history%group(i:i) == '/') history%group(i:i) = '|'
      end do
      history%group = history%above//'/'//history%group
      ! Two sets may have one name: that of all nodes, and one of the deck.
      do i = 1, size(self%histories)
         if (self%histories(i)%group == history%group) history%group = history%group//' (2)'
      end do
      if (table%is_of_nodes) then
         history%name_of_numbers = 'node'
         history%number = model%mesh%node_number(table%member)
      else
         history%name_of_numbers = 'element'
         history%number = model%mesh%element_number(table%member)
      end if
      allocate (history%names(2), history%sets(2))
      history%names(1)%value = 'increment'
      history%names(2)%value = 'time'
      history%sets(1) = growing_dataset(history%group//'/increment', as_integer, 0, 1, expected, &
         'increment of the row, from 1')
      history%sets(2) = growing_dataset(history%group//'/time', as_real, 0, 1, expected, &
         'total time at the end of the increment', 'time')
   end subroutine start_history

   subroutine add_dataset(history, column, width, expected, suffix)
      type(set_history_type), intent(inout) :: history
      type(table_column_type), intent(in) :: column
      integer, intent(in) :: width, expected
      character(*), intent(in) :: suffix               ! of its description
      type(growing_dataset_type) :: dataset
      character(len(column%name)) :: words
      integer :: i

      if (any([(history%names(i)%value == column%name, i=1, size(history%names))])) return
      words = column%name
      do i = 1, len(words)
         if (words(i:i) == '_') words(i:i) = ' '
      end do
      call append_text(history%names, column%name)
      dataset = growing_dataset(history%group//'/'//column%name, as_real, width, 1, &
         expected, words//suffix, trim(column%unit))
      history%sets = [history%sets, dataset]
   end subroutine add_dataset

   !> Adds the tables of an increment: a row for each set of which one is due, NaN for what none of
   !> them has.
   subroutine append(self, record, tables)
      class(history_results_type), intent(inout) :: self
      type(increment_record_type), intent(in) :: record
      type(requested_table_type), intent(in) :: tables(:)    !! those that are due
      integer, allocatable :: places(:)
      integer :: h, i, k

      places = [(place_of(self, tables(i)), i=1, size(tables))]
      where (tables%has_uncertainties) places = 0
      do h = 1, size(self%histories)
         if (all(places /= h)) cycle
         associate (history => self%histories(h))
            call history%sets(1)%append([real(record%increment, dp)])
            call history%sets(2)%append([record%time])
            do k = first_quantity, size(history%sets)
               call history%sets(k)%append(values_of(history%names(k)%value, tables, places == h))
            end do
         end associate
      end do
   end subroutine append

   !> The values of a quantity in one of some tables; none where none has it.
   pure function values_of(name, tables, counts) result(values)
      character(*), intent(in) :: name
      type(requested_table_type), intent(in) :: tables(:)
      logical, intent(in) :: counts(:)                       ! whether a table is of the set
      real(dp), allocatable :: values(:)
      type(table_column_type), allocatable :: columns(:)
      integer :: i, k

      allocate (values(0))
      do i = 1, size(tables)
         if (.not. counts(i)) cycle
         columns = [tables(i)%columns, tables(i)%totals]
         do k = 1, size(columns)
            if (allocated(columns(k)%values) .and. columns(k)%name == name) values = &
               columns(k)%values
         end do
      end do
   end function values_of

   !> Rows of each set so far.
   pure function rows(self)
      class(history_results_type), intent(in) :: self
      integer, allocatable :: rows(:)
      integer :: i

      rows = [(self%histories(i)%sets(1)%rows(), i=1, size(self%histories))]
   end function rows

   !> Goes on behind the first rows of an earlier file, and removes what only steps that are dropped
   !> asked for.
   subroutine go_on(self, file, rows)
      class(history_results_type), intent(inout) :: self     !! started
      type(hdf5_writer_type), intent(inout) :: file          !! the open file
      integer, intent(in) :: rows(:)                         !! of its sets, in the same order
      type(string_type), allocatable :: groups(:), kept(:)
      integer :: first, h, i, k

      allocate (groups(0))
      do h = 1, size(self%histories)
         call start_group(self%histories(h), file)
         associate (history => self%histories(h))
            call append_text(groups, history%group(index(history%group, '/', back=.true.) + 1:))
            kept = history%names
            call append_text(kept, history%name_of_numbers)
            call append_text(kept, 'point')
            call file%keep_members(history%group, kept)
            ! Steps that are new may be the first to ask for it.
            first = 0
            if (h <= size(rows)) first = rows(h)
            do k = 1, size(history%sets)
               call history%sets(k)%go_on(file, first)
            end do
         end associate
      end do
      do i = 1, size(above)
         if (file%has(trim(above(i)))) call file%keep_members(trim(above(i)), groups)
      end do
   end subroutine go_on

   !> Bytes that wait in memory.
   pure integer(long) function bytes(self)
      class(history_results_type), intent(in) :: self
      integer :: i

      bytes = 0_long
      do i = 1, size(self%histories)
         bytes = bytes + bytes_in(self%histories(i)%sets)
      end do
   end function bytes

   !> Writes the rows that wait.
   subroutine flush_histories(self, file)
      class(history_results_type), intent(inout) :: self
      type(hdf5_writer_type), intent(inout) :: file       !! the open file
      integer :: i

      do i = 1, size(self%histories)
         associate (history => self%histories(i))
            call start_group(history, file)
            call flush_sets(history%sets, file)
         end associate
      end do
   end subroutine flush_histories

   !> Creates the group of a set, where it is not there yet.
   subroutine start_group(history, file)
      type(set_history_type), intent(in) :: history
      type(hdf5_writer_type), intent(inout) :: file

      if (.not. file%has(history%above)) call file%create_group(history%above)
      if (file%has(history%group)) return
      call file%create_group(history%group)
      call write_integers(file, history%group//'/'//history%name_of_numbers, history%number, &
         as_integer, 'number of the '//history%name_of_numbers//' in the deck')
      if (allocated(history%table%point)) call write_integers(file, history%group//'/point', &
         history%table%point, as_integer, 'number of the integration point in its element')
   end subroutine start_group

end module history_results
