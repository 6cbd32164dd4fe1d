!> Seals of HDF5 files: a digest of all bytes, behind the end of what HDF5 reads. It tells a damaged
!> file before HDF5 reads it, which crashes on some of these.
module file_seals
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   use errors, only: error_type, set_error, status_deck, status_internal
   use file_calls, only: cannot_write, reason_of
   implicit none
   private
   public :: seal_file, check_seal

   interface
      integer(c_int) function c_seal(path) bind(c, name='file_seal')
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
      end function c_seal

      integer(c_int) function c_is_damaged(path) bind(c, name='file_is_damaged')
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
      end function c_is_damaged
   end interface

contains

   !> Seals a file that is complete and closed.
   !> Error: status_internal, when it cannot be written.
   subroutine seal_file(path, error)
      character(*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error  !! with the system's reason
      integer(c_int) :: number

      number = c_seal(path//c_null_char)
      if (number /= 0) call set_error(error, status_internal, cannot_write(path, reason_of(number)))
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

end module file_seals
