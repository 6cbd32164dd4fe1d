!> Files that stay open, by their descriptors: written at their end, locked, in memory. The calls
!> themselves are in file_calls.c.
module open_files
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long, c_null_char
   use errors, only: error_type, set_error, status_internal
   use file_calls, only: cannot_write, reason_of
   use text, only: to_text
   implicit none
   private
   public :: open_new_file, write_file, lock_file, unlock_file, open_in_memory, append_to_file
   public :: overwrite_in_file, empty_file, close_descriptor

   integer(c_int), parameter :: locked_by_another = -1_c_int   !! as in file_calls.c
   integer(c_int), parameter :: not_lockable = -2_c_int        !! alike

   abstract interface
      integer(c_int) function open_call(path, descriptor) bind(c)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), intent(out) :: descriptor
      end function open_call

      integer(c_int) function descriptor_call(descriptor) bind(c)
         import :: c_int
         integer(c_int), value :: descriptor
      end function descriptor_call
   end interface

   procedure(open_call), bind(c, name='file_open_new') :: c_open_new
   procedure(open_call), bind(c, name='file_lock') :: c_lock
   procedure(descriptor_call), bind(c, name='file_empty') :: c_empty
   procedure(descriptor_call), bind(c, name='file_close') :: c_close

   interface
      subroutine c_unlock(path, descriptor) bind(c, name='file_unlock')
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: descriptor
      end subroutine c_unlock

      integer(c_int) function c_in_memory(descriptor) bind(c, name='file_in_memory')
         import :: c_int
         integer(c_int), intent(out) :: descriptor
      end function c_in_memory

      integer(c_int) function c_append(descriptor, text, count) bind(c, name='file_append')
         import :: c_char, c_int, c_long
         integer(c_int), value :: descriptor
         character(kind=c_char), intent(in) :: text(*)
         integer(c_long), value :: count
      end function c_append

      integer(c_int) function c_overwrite(descriptor, position, text, count) &
         bind(c, name='file_overwrite')
         import :: c_char, c_int, c_long
         integer(c_int), value :: descriptor
         integer(c_long), value :: position
         character(kind=c_char), intent(in) :: text(*)
         integer(c_long), value :: count
      end function c_overwrite
   end interface

contains

   !> Makes a file anew, to write at its end.
   !> Error: status_internal, when the system refuses.
   subroutine open_new_file(path, descriptor, error)
      character(*), intent(in) :: path                     !! the file
      integer, intent(out) :: descriptor                   !! the open file, -1 after an error
      type(error_type), allocatable, intent(out) :: error  !! with the system's reason
      integer(c_int) :: number, opened

      number = c_open_new(path//c_null_char, opened)
      descriptor = int(opened)
      if (number /= 0) call set_error(error, status_internal, cannot_write(path, reason_of(number)))
   end subroutine open_new_file

   !> Makes a file of a text.
   !> Error: status_internal, when the system refuses.
   subroutine write_file(path, string, error)
      character(*), intent(in) :: path                     !! the file
      character(*), intent(in) :: string                   !! the text, with its ends of line
      type(error_type), allocatable, intent(out) :: error  !! with the system's reason
      integer :: descriptor

      call open_new_file(path, descriptor, error)
      if (allocated(error)) return
      call append_to_file(descriptor, path, string, error)
      call close_descriptor(descriptor)
   end subroutine write_file

   !> Opens a file to write at its end, and locks it: the system frees the lock with the descriptor,
   !> at the latest when the process ends, however it ends.
   !> Errors, status_internal: the file cannot be written; another run has the lock.
   subroutine lock_file(path, descriptor, has_lock, error)
      character(*), intent(in) :: path                     !! the file; made if it is missing
      integer, intent(out) :: descriptor                   !! the open file, -1 after an error
      logical, intent(out) :: has_lock                     !! false where there are no locks
      type(error_type), allocatable, intent(out) :: error
      integer(c_int) :: number, opened

      number = c_lock(path//c_null_char, opened)
      descriptor = int(opened)
      has_lock = number == 0
      select case (number)
      case (0, not_lockable)
         return
      case (locked_by_another)
         call set_error(error, status_internal, cannot_write(path, &
            'another run writes here; wait for its end or name another folder with --out'))
      case default
         call set_error(error, status_internal, cannot_write(path, reason_of(number)))
      end select
   end subroutine lock_file

   !> Closes a locked file; one in which nothing was written is removed.
   subroutine unlock_file(path, descriptor)
      character(*), intent(in) :: path      !! the file
      integer, intent(in) :: descriptor     !! as from lock_file

      call c_unlock(path//c_null_char, int(descriptor, c_int))
   end subroutine unlock_file

   !> Opens a file in memory, whose end comes with that of its descriptor.
   !> Error: status_internal, when the system opens none.
   subroutine open_in_memory(descriptor, path, error)
      integer, intent(out) :: descriptor                   !! of the file
      character(:), allocatable, intent(out) :: path       !! by which it can be opened
      type(error_type), allocatable, intent(out) :: error  !! with the system's reason
      integer(c_int) :: number, opened

      number = c_in_memory(opened)
      descriptor = int(opened)
      path = '/proc/self/fd/'//to_text(descriptor)
      if (number /= 0) call set_error(error, status_internal, &
         'cannot open a file in memory: '//reason_of(number))
   end subroutine open_in_memory

   !> Writes text at the end of an open file.
   !> Error: status_internal, when the system refuses.
   subroutine append_to_file(descriptor, path, string, error)
      integer, intent(in) :: descriptor                    !! the open file
      character(*), intent(in) :: path                     !! its path, for the message
      character(*), intent(in) :: string                   !! what is written
      type(error_type), allocatable, intent(out) :: error  !! with the system's reason
      integer(c_int) :: number

      number = c_append(int(descriptor, c_int), string, len(string, kind=c_long))
      if (number /= 0) call set_error(error, status_internal, cannot_write(path, reason_of(number)))
   end subroutine append_to_file

   !> Writes text over what is at a position of an open file.
   !> Error: status_internal, when the system refuses.
   subroutine overwrite_in_file(descriptor, path, position, string, error)
      integer, intent(in) :: descriptor                    !! the open file
      character(*), intent(in) :: path                     !! its path, for the message
      integer, intent(in) :: position                      !! bytes before the text
      character(*), intent(in) :: string                   !! what is written
      type(error_type), allocatable, intent(out) :: error  !! with the system's reason
      integer(c_int) :: number

      number = c_overwrite(int(descriptor, c_int), int(position, c_long), string, &
         len(string, kind=c_long))
      if (number /= 0) call set_error(error, status_internal, cannot_write(path, reason_of(number)))
   end subroutine overwrite_in_file

   !> Empties an open file.
   !> Error: status_internal, when the system refuses.
   subroutine empty_file(descriptor, path, error)
      integer, intent(in) :: descriptor                    !! the open file
      character(*), intent(in) :: path                     !! its path, for the message
      type(error_type), allocatable, intent(out) :: error  !! with the system's reason
      integer(c_int) :: number

      number = c_empty(int(descriptor, c_int))
      if (number /= 0) call set_error(error, status_internal, cannot_write(path, reason_of(number)))
   end subroutine empty_file

   !> Closes what was opened here.
   subroutine close_descriptor(descriptor)
      integer, intent(in) :: descriptor   !! the open file
      integer(c_int) :: ignored

      ignored = c_close(int(descriptor, c_int))
   end subroutine close_descriptor

end module open_files
