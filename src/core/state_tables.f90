!> The table of a state: arrays by their names, one behind the other. What has a state names its
!> arrays once, in a procedure that goes both ways: it fills the table or takes them from there.
!> Whole numbers, logical values and text are kept as reals, which hold them exactly.
module state_tables
   use kinds, only: dp
   implicit none
   private
   public :: state_table_type, reals, integers, logicals, words

   integer, parameter :: name_length = 48
   integer, parameter :: absent = -1            !! size of an array that the state does not have
   integer, parameter :: first_arrays = 128, first_values = 4096   !! room at first

   !> The table. The same state has the same names in the same order, whatever its arrays hold.
   type :: state_table_type
      integer :: arrays = 0, count = 0                  !! how many there are, and their values
      character(name_length), allocatable :: names(:)   !! (arrays, or more)
      integer, allocatable :: sizes(:)                  !! likewise; negative: not there
      real(dp), allocatable :: values(:)                !! (count, or more) of all arrays
      character(16) :: prefix = ''                      !! of the names that follow
      logical :: restores = .false.                     !! whether arrays go back into a state
   contains
      procedure :: begin
   end type state_table_type

contains

   !> Begins to keep a state in an empty table.
   subroutine begin(self)
      class(state_table_type), intent(out) :: self

      allocate (self%names(first_arrays), self%sizes(first_arrays), self%values(first_values))
   end subroutine begin

   !> Adds an array to the table, or takes it from there: as the state had it, allocated or not. One
   !> that the table does not name stays.
   subroutine reals(table, name, values)
      type(state_table_type), intent(inout) :: table
      character(*), intent(in) :: name
      real(dp), allocatable, intent(inout) :: values(:)
      integer :: first, i

      if (.not. table%restores) then
         call append(table, trim(table%prefix)//name, values)
         return
      end if
      i = findloc(table%names(:table%arrays), trim(table%prefix)//name, dim=1)
      if (i == 0) return
      if (table%sizes(i) == absent) then
         if (allocated(values)) deallocate (values)
         return
      end if
      first = sum(max(table%sizes(:i - 1), 0))
      values = table%values(first + 1:first + table%sizes(i))
   end subroutine reals

   subroutine append(table, name, values)
      type(state_table_type), intent(inout) :: table
      character(*), intent(in) :: name
      real(dp), allocatable, intent(in) :: values(:)
      real(dp), allocatable :: longer(:)
      integer :: last

      if (table%arrays == size(table%names)) then
         table%names = [table%names, table%names]
         table%sizes = [table%sizes, table%sizes]
      end if
      table%arrays = table%arrays + 1
      table%names(table%arrays) = name
      table%sizes(table%arrays) = absent
      if (.not. allocated(values)) return
      table%sizes(table%arrays) = size(values)
      last = table%count + size(values)
      if (last > size(table%values)) then
         allocate (longer(2*last))
         longer(:table%count) = table%values(:table%count)
         call move_alloc(longer, table%values)
      end if
      table%values(table%count + 1:last) = values
      table%count = last
   end subroutine append

   !> The same of whole numbers.
   subroutine integers(table, name, values)
      type(state_table_type), intent(inout) :: table
      character(*), intent(in) :: name
      integer, allocatable, intent(inout) :: values(:)
      real(dp), allocatable :: as_reals(:)

      if (allocated(values)) as_reals = real(values, dp)
      call reals(table, name, as_reals)
      if (.not. table%restores) return
      if (allocated(values)) deallocate (values)
      if (allocated(as_reals)) values = nint(as_reals)
   end subroutine integers

   !> The same of logical values.
   subroutine logicals(table, name, values)
      type(state_table_type), intent(inout) :: table
      character(*), intent(in) :: name
      logical, allocatable, intent(inout) :: values(:)
      integer, allocatable :: as_integers(:)

      if (allocated(values)) as_integers = merge(1, 0, values)
      call integers(table, name, as_integers)
      if (.not. table%restores) return
      if (allocated(values)) deallocate (values)
      if (allocated(as_integers)) values = as_integers == 1
   end subroutine logicals

   !> The same of text.
   subroutine words(table, name, text)
      type(state_table_type), intent(inout) :: table
      character(*), intent(in) :: name
      character(:), allocatable, intent(inout) :: text
      integer, allocatable :: codes(:)
      integer :: i

      if (allocated(text)) codes = [(iachar(text(i:i)), i=1, len(text))]
      call integers(table, name, codes)
      if (.not. table%restores) return
      if (allocated(text)) deallocate (text)
      if (allocated(codes)) text = transfer(achar(codes), repeat(' ', size(codes)))
   end subroutine words

end module state_tables
