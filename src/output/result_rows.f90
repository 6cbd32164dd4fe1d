!> The results of a run as one row of a table of runs: quantities by the names of *VERIFY, such as
!> `heat_rate JOINT`. docs/batch.md describes the columns.
module result_rows
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use deck_source, only: read_lines
   use errors, only: error_type
   use kinds, only: dp
   use name_index, only: name_index_type
   use open_files, only: replace_file
   use text, only: all_digits, append, quoted, string_type
   implicit none
   private
   public :: result_row_type

   character(*), parameter :: heading = 'quantity,value'   !! first line of a file

   !> Quantities in the order in which they come, and their values at the last increment.
   type :: result_row_type
      type(string_type), allocatable :: names(:)    !! unallocated: there is no row
      type(string_type), allocatable :: values(:)   !! all digits; empty for one that does not exist
      type(name_index_type), private :: known
   contains
      procedure :: put
      procedure :: put_uncertainty
      procedure :: has
      procedure :: value_of
      procedure :: write => write_row
      procedure :: read => read_row
   end type result_row_type

contains

   !> Adds a quantity.
   subroutine put(self, name, value)
      class(result_row_type), intent(inout) :: self
      character(*), intent(in) :: name               !! quantity, and where if it is somewhere
      real(dp), intent(in) :: value                  !! NaN: it does not exist
      character(:), allocatable :: digits

      digits = ''
      if (ieee_is_finite(value)) digits = all_digits(value)
      call add(self, name, digits)
   end subroutine put

   !> Adds the numerical uncertainty of the quantity that was put last.
   subroutine put_uncertainty(self, value)
      class(result_row_type), intent(inout) :: self
      real(dp), intent(in) :: value                  !! in the unit of the quantity
      character(:), allocatable :: name

      name = self%names(size(self%names))%value
      call self%put(name//' uncertainty', value)
   end subroutine put_uncertainty

   subroutine add(self, name, value)
      type(result_row_type), intent(inout) :: self
      character(*), intent(in) :: name, value        ! a number, or nothing

      if (.not. allocated(self%names)) allocate (self%names(0), self%values(0))
      call self%known%add(name)
      call append(self%names, name)
      call append(self%values, value)
   end subroutine add

   !> Whether a quantity is there.
   logical function has(self, name)
      class(result_row_type), intent(in) :: self
      character(*), intent(in) :: name               !! as in put

      has = self%known%find(name) > 0
   end function has

   !> The value of a quantity as in a CSV file; empty where there is none.
   pure function value_of(self, name) result(value)
      class(result_row_type), intent(in) :: self
      character(*), intent(in) :: name               !! as in put
      character(:), allocatable :: value
      integer :: i

      value = ''
      i = self%known%find(name)
      if (i > 0) value = self%values(i)%value
   end function value_of

   !> Writes the row to a file of one line for each quantity, as replace_file does.
   !> Error: status_internal, when the file cannot be written.
   subroutine write_row(self, path, error)
      class(result_row_type), intent(in) :: self
      character(*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: text
      integer :: i

      text = heading//new_line('a')
      do i = 1, size(self%names)
         text = text//quoted(self%names(i)%value)//','//self%values(i)%value//new_line('a')
      end do
      call replace_file(path, text, error)
   end subroutine write_row

   !> Reads a row; there is none where the file is not there or is none of these.
   subroutine read_row(self, path)
      class(result_row_type), intent(out) :: self
      character(*), intent(in) :: path
      type(string_type), allocatable :: lines(:)
      character(:), allocatable :: fault
      integer :: comma, i

      call read_lines(path, lines, fault)
      if (len(fault) > 0 .or. size(lines) == 0) return
      if (lines(1)%value /= heading) return
      do i = 2, size(lines)
         comma = index(lines(i)%value, ',', back=.true.)
         if (comma < 3) cycle
         ! Without the quotes of the name.
         call add(self, lines(i)%value(2:comma - 2), lines(i)%value(comma + 1:))
      end do
   end subroutine read_row

end module result_rows
