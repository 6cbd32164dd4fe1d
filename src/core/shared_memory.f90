!> What a child leaves to its parent without a file in any folder: memory that both see, and files
!> without a name. Nothing of them is left once both have ended, however that came.
module shared_memory
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_int, c_intptr_t, c_loc, c_long, &
      c_null_char, c_null_ptr, c_ptr, c_size_t
   use errors, only: error_type, set_error, status_internal
   implicit none
   private
   public :: message_file_type, share_memory

   integer(c_int), parameter :: may_read_and_write = 3_c_int        !! PROT_READ, PROT_WRITE
   integer(c_int), parameter :: shared_and_anonymous = 33_c_int     !! MAP_SHARED, MAP_ANONYMOUS
   integer(c_intptr_t), parameter :: map_failed = -1_c_intptr_t     !! MAP_FAILED as an address
   integer, parameter :: block_length = 65536                       !! characters read at once

   !> A file without a name, for what a child prints.
   type :: message_file_type
      integer :: descriptor = -1   !! of the open file, -1 for none
   contains
      procedure :: open => open_messages
      procedure :: take
   end type message_file_type

   interface
      !> mmap(2) of POSIX, with Linux's memory that belongs to no file.
      function posix_map(address, length, protection, flags, descriptor, offset) &
         bind(c, name='mmap') result(mapped)
         import :: c_int, c_long, c_ptr, c_size_t
         type(c_ptr), value :: address
         integer(c_size_t), value :: length
         integer(c_int), value :: protection
         integer(c_int), value :: flags
         integer(c_int), value :: descriptor
         integer(c_long), value :: offset
         type(c_ptr) :: mapped
      end function posix_map

      !> memfd_create(2) of Linux.
      function linux_memory_file(name, flags) bind(c, name='memfd_create') result(descriptor)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: name(*)
         integer(c_int), value :: flags
         integer(c_int) :: descriptor
      end function linux_memory_file

      !> POSIX pread(2).
      function posix_read(descriptor, buffer, length, offset) bind(c, name='pread') result(count)
         import :: c_int, c_long, c_ptr, c_size_t
         integer(c_int), value :: descriptor
         type(c_ptr), value :: buffer
         integer(c_size_t), value :: length
         integer(c_long), value :: offset
         integer(c_long) :: count
      end function posix_read

      !> POSIX close(2).
      function posix_close(descriptor) bind(c, name='close') result(status)
         import :: c_int
         integer(c_int), value :: descriptor
         integer(c_int) :: status
      end function posix_close
   end interface

contains

   !> Memory, filled with zeros, that this process and all its children see.
   !> Error: status_internal, when there is none.
   subroutine share_memory(bytes, address, error)
      integer(c_size_t), intent(in) :: bytes               !! how much [byte]
      type(c_ptr), intent(out) :: address                  !! where it begins
      type(error_type), allocatable, intent(out) :: error  !! see above

      address = posix_map(c_null_ptr, bytes, may_read_and_write, shared_and_anonymous, &
         -1_c_int, 0_c_long)
      if (c_associated(address) .and. transfer(address, map_failed) /= map_failed) return
      address = c_null_ptr
      call set_error(error, status_internal, 'there is no memory to share with other processes')
   end subroutine share_memory

   !> Opens the file, empty.
   !> Error: status_internal, when the system has no room for one more.
   subroutine open_messages(self, error)
      class(message_file_type), intent(inout) :: self      !! the file
      type(error_type), allocatable, intent(out) :: error  !! see above

      self%descriptor = int(linux_memory_file('messages'//c_null_char, 0_c_int))
      if (self%descriptor < 0) call set_error(error, status_internal, &
         'the system opens no further file')
   end subroutine open_messages

   !> Takes all that was written, without a line end behind it, and closes the file.
   subroutine take(self, contents)
      class(message_file_type), intent(inout) :: self      !! the file
      character(:), allocatable, intent(out) :: contents   !! lines with their ends between them
      character(kind=c_char), target :: block(block_length)
      integer(c_long) :: count
      integer(c_int) :: ignored

      contents = ''
      do
         count = posix_read(int(self%descriptor, c_int), c_loc(block), &
            int(block_length, c_size_t), int(len(contents), c_long))
         if (count <= 0_c_long) exit
         contents = contents//transfer(block(:count), repeat(' ', int(count)))
      end do
      ignored = posix_close(int(self%descriptor, c_int))
      self%descriptor = -1
      do while (len(contents) > 0)
         if (contents(len(contents):) /= new_line('a')) exit
         contents = contents(:len(contents) - 1)
      end do
   end subroutine take

end module shared_memory
