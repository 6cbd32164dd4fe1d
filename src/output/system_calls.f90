!> The few calls of the operating system that Fortran 2008 lacks.
module system_calls
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   use, intrinsic :: iso_fortran_env, only: file_storage_size
   use errors, only: error_type, set_error, status_internal
   use kinds, only: long
   implicit none
   private
   public :: rename_file, copy_file, remove_file, make_folder, is_terminal

   integer, parameter :: block_size = 1048576                       !! bytes that are copied at once
   integer, parameter :: octets = file_storage_size/8               !! bytes in a file storage unit

   interface
      !> POSIX rename(2): atomic where both names are in one folder.
      function posix_rename(from, to) bind(c, name='rename') result(status)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: from(*)
         character(kind=c_char), intent(in) :: to(*)
         integer(c_int) :: status
      end function posix_rename

      !> POSIX unlink(2).
      function posix_unlink(path) bind(c, name='unlink') result(status)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int) :: status
      end function posix_unlink

      !> POSIX mkdir(2).
      function posix_mkdir(path, mode) bind(c, name='mkdir') result(status)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: mode
         integer(c_int) :: status
      end function posix_mkdir

      !> POSIX isatty(3).
      function posix_isatty(descriptor) bind(c, name='isatty') result(answer)
         import :: c_int
         integer(c_int), value :: descriptor
         integer(c_int) :: answer
      end function posix_isatty
   end interface

contains

   !> Gives a file another name; a file that had that name is replaced in one instant.
   !> Error: status_internal, when the system refuses.
   subroutine rename_file(from, to, error)
      character(*), intent(in) :: from                     !! present path
      character(*), intent(in) :: to                       !! new path, in the same file system
      type(error_type), allocatable, intent(out) :: error  !! what went wrong

      if (posix_rename(from//c_null_char, to//c_null_char) /= 0) then
         call set_error(error, status_internal, 'cannot rename "'//from//'" to "'//to//'"')
      end if
   end subroutine rename_file

   !> Makes a folder and those above it; one that is there already is left as it is. Whether it can
   !> be written to shows when a file is opened in it.
   subroutine make_folder(path)
      character(*), intent(in) :: path   !! the folder
      integer :: i
      integer(c_int) :: status
      integer(c_int), parameter :: all_may = int(o'777', c_int)

      do i = 2, len(path)
         if (path(i:i) == '/') status = posix_mkdir(path(:i - 1)//c_null_char, all_may)
      end do
      status = posix_mkdir(path//c_null_char, all_may)
   end subroutine make_folder

   !> Copies a file byte by byte; a file that stands at the target is overwritten.
   !> Error: status_internal, when either file cannot be read or written.
   subroutine copy_file(from, to, error)
      character(*), intent(in) :: from                     !! path that is read
      character(*), intent(in) :: to                       !! path that is written
      type(error_type), allocatable, intent(out) :: error  !! what went wrong
      character(block_size), allocatable :: block
      integer :: source, target, status
      integer(long) :: left, portion

      open (newunit=source, file=from, access='stream', action='read', status='old', iostat=status)
      if (status /= 0) then
         call set_error(error, status_internal, 'cannot read "'//from//'"')
         return
      end if
      open (newunit=target, file=to, access='stream', action='write', status='replace', &
         iostat=status)
      if (status == 0) then
         allocate(block)
         inquire (unit=source, size=left)
         left = left*octets
         do while (left > 0 .and. status == 0)
            portion = min(left, int(block_size, long))
            read (source, iostat=status) block(:portion)
            if (status == 0) write (target, iostat=status) block(:portion)
            left = left - portion
         end do
         if (status == 0) then
            close (target, iostat=status)
         else
            close (target)
         end if
      end if
      close (source)
      if (status /= 0) call set_error(error, status_internal, 'cannot write "'//to//'"')
   end subroutine copy_file

   !> Removes a file; that it is not there is no error.
   subroutine remove_file(path)
      character(*), intent(in) :: path   !! the file
      integer(c_int) :: ignored

      ignored = posix_unlink(path//c_null_char)
   end subroutine remove_file

   !> Whether a person looks at what is written there.
   function is_terminal(descriptor) result(answer)
      integer, intent(in) :: descriptor   !! 1 standard output, 2 standard error
      logical :: answer                   !! true for a terminal

      answer = posix_isatty(int(descriptor, c_int)) == 1
   end function is_terminal

end module system_calls
