!> Files that stay open, by their descriptors: written, emptied, locked. The calls themselves are in
!> file_calls.c.
module open_files
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long, c_null_char
   use errors, only: error_type, set_error, status_internal
   use file_calls, only: cannot_write, check_written, create_working_file, remove_file, rename_file
   implicit none
   private
   public :: open_new_file, replace_file, write_file, lock_file, unlock_file, write_to_file, &
      empty_file, close_descriptor

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
   procedure(descriptor_call), bind(c, name='close') :: c_close

   interface
      subroutine c_unlock(path, descriptor) bind(c, name='file_unlock')
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: descriptor
      end subroutine c_unlock

      integer(c_int) function c_write(descriptor, position, text, count) bind(c, name='file_write')
         import :: c_char, c_int, c_long
         integer(c_int), value :: descriptor
         integer(c_long), value :: position
         character(kind=c_char), intent(in) :: text(*)
         integer(c_long), value :: count
      end function c_write
   end interface

contains

   !> Makes a file anew.
   !> Error: status_internal, when the system refuses.
   subroutine open_new_file(path, descriptor, error)
      character(*), intent(in) :: path                     !! the file
      integer, intent(out) :: descriptor                   !! the open file, -1 after an error
      type(error_type), allocatable, intent(out) :: error  !! with the system's reason
      integer(c_int) :: opened

      call check_written(c_open_new(path//c_null_char, opened), path, error)
      descriptor = int(opened)
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
      call write_to_file(descriptor, path, string, error)
      call close_descriptor(descriptor)
   end subroutine write_file

   !> Makes a file of a text; one that is there is replaced in one instant.
   !> Error: status_internal, when the system refuses.
   subroutine replace_file(path, string, error)
      character(*), intent(in) :: path, string             !! as write_file
      type(error_type), allocatable, intent(out) :: error  !! with the system's reason
      character(:), allocatable :: working_path

      call create_working_file(path, working_path, error)
      if (allocated(error)) return
      call write_file(working_path, string, error)
      if (.not. allocated(error)) call rename_file(working_path, path, error)
      if (allocated(error)) call remove_file(working_path)
   end subroutine replace_file

   !> Opens a file and locks it: the system frees the lock with the descriptor,
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
         call check_written(number, path, error)
      end select
   end subroutine lock_file

   !> Closes a locked file; one in which nothing was written is removed.
   subroutine unlock_file(path, descriptor)
      character(*), intent(in) :: path      !! the file
      integer, intent(in) :: descriptor     !! as from lock_file

      call c_unlock(path//c_null_char, int(descriptor, c_int))
   end subroutine unlock_file

   !> Writes text at the end of an open file, or over what is at a position.
   !> Error: status_internal, when the system refuses.
   subroutine write_to_file(descriptor, path, string, error, position)
      integer, intent(in) :: descriptor                    !! the open file
      character(*), intent(in) :: path                     !! its path, for the message
      character(*), intent(in) :: string                   !! what is written
      type(error_type), allocatable, intent(out) :: error  !! with the system's reason
      integer, intent(in), optional :: position            !! bytes before the text
      integer(c_long) :: before

      before = -1
      if (present(position)) before = position
      call check_written(c_write(int(descriptor, c_int), before, string, &
         len(string, kind=c_long)), path, error)
   end subroutine write_to_file

   !> Empties an open file.
   !> Error: status_internal, when the system refuses.
   subroutine empty_file(descriptor, path, error)
      integer, intent(in) :: descriptor                    !! the open file
      character(*), intent(in) :: path                     !! its path, for the message
      type(error_type), allocatable, intent(out) :: error  !! with the system's reason

      call check_written(c_empty(int(descriptor, c_int)), path, error)
   end subroutine empty_file

   !> Closes what was opened here.
   subroutine close_descriptor(descriptor)
      integer, intent(in) :: descriptor   !! the open file
      integer(c_int) :: ignored

      ignored = c_close(int(descriptor, c_int))
   end subroutine close_descriptor

end module open_files
