!> Calls of the file system beyond Fortran's own statements, with the system's reason where it
!> refuses, and which file a path leads to: links and other spellings of a path lead to the same
!> one. Open files have descriptors, see open_files.
!>
!> HDF5 files are sealed by a digest of all bytes, behind the end of what HDF5 reads. It tells a
!> damaged file before HDF5 reads it, which crashes on some of these. The calls themselves are in
!> file_calls.c and file_seals.c.
module file_calls
   use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_int, c_long, c_null_char, c_ptr
   use errors, only: error_type, set_error, status_deck, status_internal
   use kinds, only: long
   use text, only: to_text
   implicit none
   private
   public :: rename_file, copy_file, remove_file, make_folder, is_terminal, is_stream, read_file, &
      sync_file, try_file, try_growth, create_working_file, remove_working_files, &
      survive_file_limits, cannot_write, check_written, print_text, check_printed, &
      identity_of, check_in_place, seal_file, check_seal, c_free

   integer(c_int), parameter :: too_long = -3_c_int   !! as in file_calls.c
   integer, parameter :: reason_length = 200
   integer, parameter :: number_length = 24   !! of what a working file's name adds, at most

   abstract interface
      integer(c_int) function path_call(path) bind(c)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
      end function path_call
   end interface

   procedure(path_call), bind(c, name='unlink') :: c_remove
   procedure(path_call), bind(c, name='file_remove_working') :: c_remove_working
   procedure(path_call), bind(c, name='file_sync') :: c_sync
   procedure(path_call), bind(c, name='file_make_folder') :: c_make_folder
   procedure(path_call), bind(c, name='file_check_folder') :: c_check_folder
   procedure(path_call), bind(c, name='file_is_stream') :: c_is_stream
   procedure(path_call), bind(c, name='file_try') :: c_try
   procedure(path_call), bind(c, name='file_seal') :: c_seal
   procedure(path_call), bind(c, name='file_is_damaged') :: c_is_damaged

   interface
      subroutine c_reason(number, text, length) bind(c, name='file_reason')
         import :: c_char, c_int
         integer(c_int), value :: number, length
         character(kind=c_char), intent(out) :: text(length)
      end subroutine c_reason

      integer(c_int) function c_rename(from, to) bind(c, name='file_rename')
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: from(*), to(*)
      end function c_rename

      integer(c_int) function c_is_terminal(descriptor) bind(c, name='isatty')
         import :: c_int
         integer(c_int), value :: descriptor
      end function c_is_terminal

      subroutine c_print(text, count) bind(c, name='file_print')
         import :: c_char, c_long
         character(kind=c_char), intent(in) :: text(*)
         integer(c_long), value :: count
      end subroutine c_print

      integer(c_int) function c_print_error() bind(c, name='file_print_error')
         import :: c_int
      end function c_print_error

      integer(c_int) function c_try_growth(path, count) bind(c, name='file_try_growth')
         import :: c_char, c_int, c_long
         character(kind=c_char), intent(in) :: path(*)
         integer(c_long), value :: count
      end function c_try_growth

      integer(c_int) function c_create_working(stem, path, length) &
         bind(c, name='file_create_working')
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: stem(*)
         integer(c_int), value :: length
         character(kind=c_char), intent(out) :: path(length)
      end function c_create_working

      integer(c_int) function c_copy(from, to, is_source) bind(c, name='file_copy')
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: from(*), to(*)
         integer(c_int), intent(out) :: is_source
      end function c_copy

      integer(c_int) function c_read(path, most, contents, count) bind(c, name='file_read')
         import :: c_char, c_int, c_long, c_ptr
         character(kind=c_char), intent(in) :: path(*)
         integer(c_long), value :: most
         type(c_ptr), intent(out) :: contents
         integer(c_long), intent(out) :: count
      end function c_read

      !> Frees what C has allocated.
      subroutine c_free(contents) bind(c, name='free')
         import :: c_ptr
         type(c_ptr), value :: contents
      end subroutine c_free

      !> From now on a file that would grow past the limit of the process is an error like others.
      subroutine survive_file_limits() bind(c, name='file_survive_limits')
      end subroutine survive_file_limits

      subroutine c_identity(path, identity) bind(c, name='file_identity')
         import :: c_char, c_long
         character(kind=c_char), intent(in) :: path(*)
         integer(c_long), intent(out) :: identity(2)
      end subroutine c_identity
   end interface

contains

   !> The message on a file that cannot be written.
   pure function cannot_write(path, reason) result(message)
      character(*), intent(in) :: path          !! the file
      character(*), intent(in) :: reason        !! the system's words, such as from iomsg=
      character(:), allocatable :: message      !! without an end of line

      message = 'cannot write "'//path//'": '//trim(reason)
   end function cannot_write

   !> Error: status_internal, where the system refused to write.
   subroutine check_written(number, path, error)
      integer(c_int), intent(in) :: number                 !! as from a function of file_calls.c
      character(*), intent(in) :: path                     !! the file
      type(error_type), allocatable, intent(out) :: error  !! with the system's reason

      if (number /= 0) call set_error(error, status_internal, cannot_write(path, &
         system_reason(number)))
   end subroutine check_written

   !> Gives a file another name; a file that had that name is replaced in one instant.
   !> Error: status_internal, when the system refuses.
   subroutine rename_file(from, to, error)
      character(*), intent(in) :: from                     !! present path
      character(*), intent(in) :: to                       !! new path, in the same file system
      type(error_type), allocatable, intent(out) :: error  !! what went wrong

      call check_written(c_rename(from//c_null_char, to//c_null_char), to, error)
   end subroutine rename_file

   !> Waits until the contents of a file are on its disk, so that a loss of power after it was given
   !> its name leaves it whole.
   subroutine sync_file(path)
      character(*), intent(in) :: path
      integer(c_int) :: ignored

      ignored = c_sync(path//c_null_char)
   end subroutine sync_file

   !> Makes a folder and those above it; one that is there already is left as it is.
   !> Error: status_internal, when it cannot be made or no file can be made in it.
   subroutine make_folder(path, error)
      character(*), intent(in) :: path                     !! the folder
      type(error_type), allocatable, intent(out) :: error  !! with the first reason
      integer :: i
      integer(c_int) :: made, number

      made = 0
      do i = 2, len(path)
         if (path(i:i) == '/' .and. made == 0) made = c_make_folder(path(:i - 1)//c_null_char)
      end do
      if (made == 0) made = c_make_folder(path//c_null_char)
      number = c_check_folder(path//'/'//c_null_char)
      if (number == 0) return
      if (made /= 0) number = made
      call set_error(error, status_internal, 'cannot write to the folder "'//path//'": '// &
         system_reason(number)//'; name another one with --out')
   end subroutine make_folder

   !> Copies a file; a file that is at the target is overwritten.
   !> Error: status_internal, when either file cannot be read or written.
   subroutine copy_file(from, to, error)
      character(*), intent(in) :: from                     !! path that is read
      character(*), intent(in) :: to                       !! path that is written
      type(error_type), allocatable, intent(out) :: error  !! what went wrong
      integer(c_int) :: number, is_source

      number = c_copy(from//c_null_char, to//c_null_char, is_source)
      if (number == 0) return
      call check_written(number, to, error)
      if (is_source /= 0) error%message = 'cannot read "'//from//'": '//system_reason(number)
   end subroutine copy_file

   !> Removes a file; that it is not there is no error.
   subroutine remove_file(path)
      character(*), intent(in) :: path   !! the file
      integer(c_int) :: ignored

      ignored = c_remove(path//c_null_char)
   end subroutine remove_file

   !> Whether a person looks at what is written there.
   function is_terminal(descriptor) result(answer)
      integer, intent(in) :: descriptor   !! 1 standard output, 2 standard error
      logical :: answer                   !! true for a terminal

      answer = c_is_terminal(int(descriptor, c_int)) == 1
   end function is_terminal

   !> Prints text on standard output. Fortran's own statements do not tell where it finds no room.
   subroutine print_text(string)
      character(*), intent(in) :: string   !! the text, with its ends of line

      call c_print(string, len(string, kind=c_long))
   end subroutine print_text

   !> Error: status_internal, when something that was printed on standard output found no room.
   subroutine check_printed(error)
      type(error_type), allocatable, intent(out) :: error  !! with the system's reason
      integer(c_int) :: number

      number = c_print_error()
      if (number /= 0) call set_error(error, status_internal, &
         'cannot write to standard output: '//system_reason(number))
   end subroutine check_printed

   !> Whether a file can be read once only, as a pipe.
   function is_stream(path) result(answer)
      character(*), intent(in) :: path    !! the file
      logical :: answer                   !! false where it is missing

      answer = c_is_stream(path//c_null_char) /= 0
   end function is_stream

   !> Tries whether a file can be written, and leaves it as it was.
   !> Error: status_internal, when it cannot.
   subroutine try_file(path, error)
      character(*), intent(in) :: path                     !! the file, which may be missing
      type(error_type), allocatable, intent(out) :: error  !! with the system's reason

      call check_written(c_try(path//c_null_char), path, error)
   end subroutine try_file

   !> Tries whether a file has room for more bytes, which are zero and stay in it.
   subroutine try_growth(path, bytes, reason)
      character(*), intent(in) :: path                        !! the file
      integer, intent(in) :: bytes                            !! their number
      character(:), allocatable, intent(out) :: reason        !! why it has none; else empty
      integer(c_int) :: number

      reason = ''
      number = c_try_growth(path//c_null_char, int(bytes, c_long))
      if (number /= 0) reason = system_reason(number)
   end subroutine try_growth

   !> Makes a new, empty file beside another one, `<path>.<number>.tmp`. No other run has it.
   !> Error: status_internal, when it cannot be made.
   subroutine create_working_file(path, working_path, error)
      character(*), intent(in) :: path                         !! the file that it is to become
      character(:), allocatable, intent(out) :: working_path   !! its own path
      type(error_type), allocatable, intent(out) :: error      !! with the system's reason
      character(len(path) + number_length, kind=c_char) :: buffer

      buffer = ''
      call check_written(c_create_working(path//c_null_char, buffer, len(buffer, kind=c_int)), &
         path, error)
      working_path = without_end(buffer)
   end subroutine create_working_file

   !> Removes what killed runs have left beside a file. Call it with the lock of its run only.
   subroutine remove_working_files(path)
      character(*), intent(in) :: path   !! as create_working_file had it
      integer(c_int) :: ignored

      ignored = c_remove_working(path//c_null_char)
   end subroutine remove_working_files

   !> Reads a file, which may be a pipe, to its end.
   subroutine read_file(path, most, contents, reason)
      character(*), intent(in) :: path                         !! the file
      integer, intent(in) :: most                              !! bytes that it may have
      character(:), allocatable, intent(out) :: contents       !! all its bytes
      character(:), allocatable, intent(out) :: reason         !! why it is not read; else empty
      character(kind=c_char), pointer :: bytes(:)
      type(c_ptr) :: address
      integer(c_long) :: count
      integer(c_int) :: number
      integer(long) :: i

      contents = ''
      reason = ''
      number = c_read(path//c_null_char, int(most, c_long), address, count)
      if (number == too_long) then
         reason = 'it has more than '//to_text(most/1000000)//' MB'
      else if (number /= 0) then
         reason = system_reason(number)
      end if
      if (number /= 0) return
      call c_f_pointer(address, bytes, [count])
      deallocate (contents)
      allocate (character(count) :: contents)
      do i = 1, count
         contents(i:i) = bytes(i)
      end do
      call c_free(address)
   end subroutine read_file

   !> The system's words on an error number.
   function system_reason(number) result(reason)
      integer(c_int), intent(in) :: number      !! as from errno of C
      character(:), allocatable :: reason
      character(reason_length, kind=c_char) :: buffer

      buffer = ''
      call c_reason(number, buffer, int(reason_length, c_int))
      reason = without_end(buffer)
   end function system_reason

   !> A string of C as one of Fortran.
   pure function without_end(buffer) result(string)
      character(*, kind=c_char), intent(in) :: buffer   !! with a null character at its end
      character(:), allocatable :: string               !! what is before it

      string = buffer(:index(buffer//c_null_char, c_null_char) - 1)
   end function without_end

   !> What tells the file at a path from others: all paths to it have the same identity. Pipes and
   !> devices, whose contents nothing replaces, count as none.
   function identity_of(path) result(identity)
      character(*), intent(in) :: path           !! the file, which may be missing
      character(:), allocatable :: identity      !! empty where there is no regular file
      integer(c_long) :: device_and_inode(2)

      identity = ''
      call c_identity(path//c_null_char, device_and_inode)
      if (device_and_inode(2) /= 0) identity = to_text(int(device_and_inode(1), long))//':'// &
         to_text(int(device_and_inode(2), long))
   end function identity_of

   !> Error: status_internal, when an open file is no longer the one at its path.
   subroutine check_in_place(path, descriptor, error)
      character(*), intent(in) :: path                     !! where it was opened
      integer, intent(in) :: descriptor                    !! of the open file
      type(error_type), allocatable, intent(out) :: error

      if (identity_of(path) /= identity_of('/proc/self/fd/'//to_text(descriptor))) call set_error( &
         error, status_internal, cannot_write(path, 'it was removed or replaced during the run'))
   end subroutine check_in_place

   !> Seals a file that is complete and closed.
   !> Error: status_internal, when it cannot be written.
   subroutine seal_file(path, error)
      character(*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error  !! with the system's reason

      call check_written(c_seal(path//c_null_char), path, error)
   end subroutine seal_file

   !> Error: status_deck, when the bytes of a file are not those that were sealed. One without a
   !> seal, as earlier versions wrote it, passes if its length is right.
   subroutine check_seal(path, error)
      character(*), intent(in) :: path                     !! that it is missing is no error
      type(error_type), allocatable, intent(out) :: error

      if (c_is_damaged(path//c_null_char) /= 0) call set_error(error, status_deck, &
         'the result "'//path//'" is damaged: its bytes are not those that were written; solve '// &
         'its deck anew')
   end subroutine check_seal

end module file_calls
