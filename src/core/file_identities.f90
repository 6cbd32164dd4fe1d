!> Which file a path leads to, whatever its name: links and other spellings of a path lead to the
!> same one. The calls themselves are in file_calls.c.
module file_identities
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long, c_null_char
   use errors, only: error_type, set_error, status_internal
   use file_calls, only: cannot_write, without_end
   implicit none
   private
   public :: file_identity_type, identity_of, real_path_of, is_working_file, check_in_place

   integer, parameter :: longest_path = 4096           !! PATH_MAX of Linux
   character(*), parameter :: working_end = '.tmp'     !! of working files, as in file_calls.c

   !> Identity of a file, which all paths to it share.
   type :: file_identity_type
      integer(c_long), private :: device = 0   !! both 0 where there is no regular file
      integer(c_long), private :: inode = 0
   contains
      procedure :: is_there
      procedure :: is_same
   end type file_identity_type

   interface
      subroutine c_identity(path, identity) bind(c, name='file_identity')
         import :: c_char, c_long
         character(kind=c_char), intent(in) :: path(*)
         integer(c_long), intent(out) :: identity(2)
      end subroutine c_identity

      subroutine c_real_path(path, real_path, length) bind(c, name='file_real_path')
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: length
         character(kind=c_char), intent(out) :: real_path(length)
      end subroutine c_real_path

      integer(c_int) function c_is_at(path, descriptor) bind(c, name='file_is_at')
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: descriptor
      end function c_is_at
   end interface

contains

   !> The file at a path. Pipes and devices, whose contents nothing replaces, count as none.
   type(file_identity_type) function identity_of(path)
      character(*), intent(in) :: path    !! the file, which may be missing
      integer(c_long) :: identity(2)

      call c_identity(path//c_null_char, identity)
      identity_of = file_identity_type(identity(1), identity(2))
   end function identity_of

   !> Whether there is a regular file.
   elemental logical function is_there(self)
      class(file_identity_type), intent(in) :: self

      is_there = self%inode /= 0
   end function is_there

   !> Whether two paths lead to one file.
   elemental logical function is_same(self, other)
      class(file_identity_type), intent(in) :: self
      type(file_identity_type), intent(in) :: other   !! the file of another path

      is_same = self%is_there() .and. self%device == other%device .and. self%inode == other%inode
   end function is_same

   !> A path without links.
   function real_path_of(path) result(real_path)
      character(*), intent(in) :: path          !! to a file or folder
      character(:), allocatable :: real_path    !! empty where nothing is there
      character(longest_path, kind=c_char) :: buffer

      buffer = ''
      call c_real_path(path//c_null_char, buffer, int(longest_path, c_int))
      real_path = without_end(buffer)
   end function real_path_of

   !> Whether a file is one that remove_working_files would remove beside another one.
   logical function is_working_file(real_path, beside)
      character(*), intent(in) :: real_path     !! the file, without links
      character(*), intent(in) :: beside        !! the other one with its folder; may be missing
      character(:), allocatable :: stem
      integer :: slash, last

      last = len(real_path) - len(working_end)
      is_working_file = last > 0
      if (is_working_file) is_working_file = real_path(last + 1:) == working_end
      if (.not. is_working_file) return
      slash = index(beside, '/', back=.true.)
      stem = real_path_of(beside(:slash)//'.')//'/'//beside(slash + 1:)//'.'
      is_working_file = last > len(stem) .and. index(real_path, stem) == 1
      if (is_working_file) is_working_file = &
         verify(real_path(len(stem) + 1:last), '0123456789') == 0
   end function is_working_file

   !> Error: status_internal, when an open file is no longer the one at its path.
   subroutine check_in_place(path, descriptor, error)
      character(*), intent(in) :: path                     !! where it was opened
      integer, intent(in) :: descriptor                    !! of the open file
      type(error_type), allocatable, intent(out) :: error

      if (c_is_at(path//c_null_char, int(descriptor, c_int)) == 0) call set_error(error, &
         status_internal, cannot_write(path, 'it was removed or replaced during the run'))
   end subroutine check_in_place

end module file_identities
