!> Text that is printed with Fortran's own statements into memory, and taken from there: whether it
!> then finds room in a file is seen in one place, and so are its control characters.
module printed_text
   use errors, only: error_type, set_error, status_internal
   use file_calls, only: read_file
   use open_files, only: close_descriptor, open_in_memory
   use utf8, only: printable
   implicit none
   private
   public :: printed_text_type

   !> Text that waits to be taken.
   type :: printed_text_type
      integer :: unit = 0                               !! Fortran unit to print on
      integer, private :: descriptor = -1               !! of the file in memory
      character(:), allocatable, private :: path        !! by which Fortran opens it
   contains
      procedure :: open => open_text
      procedure :: take
      procedure :: close => close_text
   end type printed_text_type

contains

   !> Error: status_internal, when the system opens no file in memory.
   subroutine open_text(self, error)
      class(printed_text_type), intent(inout) :: self     !! the text, empty
      type(error_type), allocatable, intent(out) :: error
      character(200) :: reason
      integer :: status

      call open_in_memory(self%descriptor, self%path, error)
      if (allocated(error)) return
      open (newunit=self%unit, file=self%path, status='old', action='readwrite', iostat=status, &
         iomsg=reason)
      if (status /= 0) call set_error(error, status_internal, trim(reason))
   end subroutine open_text

   !> Takes all lines that were printed since the last time.
   subroutine take(self, lines)
      class(printed_text_type), intent(inout) :: self
      character(:), allocatable, intent(out) :: lines   !! with their ends, and printable
      character(:), allocatable :: contents, reason
      integer :: first, length, n

      flush (self%unit)
      call read_file(self%path, huge(1), contents, reason)
      rewind (self%unit)
      endfile (self%unit)
      rewind (self%unit)
      allocate (character(0) :: lines)
      if (all_printable(contents)) then
         call move_alloc(contents, lines)
         return
      end if
      first = 1
      do while (first <= len(contents))
         length = index(contents(first:), new_line('a')) - 1
         if (length < 0) exit
         n = len(lines)
         lines = lines//printable(contents(first:first + length - 1))//new_line('a')
         first = first + length + 1
      end do
   end subroutine take

   !> Whether a text has plain letters and ends of line only, as most have.
   pure logical function all_printable(contents)
      character(*), intent(in) :: contents
      integer :: i

      all_printable = .false.
      do i = 1, len(contents)
         if (iachar(contents(i:i)) >= 32 .and. iachar(contents(i:i)) < 127) cycle
         if (contents(i:i) /= new_line('a')) return
      end do
      all_printable = .true.
   end function all_printable

   !> Ends the text; what was not taken is lost.
   subroutine close_text(self)
      class(printed_text_type), intent(inout) :: self

      if (self%descriptor < 0) return
      close (self%unit)
      call close_descriptor(self%descriptor)
      self%descriptor = -1
   end subroutine close_text

end module printed_text
