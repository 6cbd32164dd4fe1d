!> A file of HDF5 that is read: whole datasets, parts of them, and attributes, by the names that
!> they were written with.
!>
!> The reader keeps its first error, and reads nothing after it: its user checks once, at the end.
module hdf5_reader
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_loc, c_ptr, c_size_t
   use errors, only: error_type, status_deck
   use file_calls, only: c_free, check_seal
   use hdf5, only: h5aclose_f, h5aexists_f, h5aopen_f, h5aread_f, h5dclose_f, h5dget_space_f, &
      h5dopen_f, h5dread_f, h5f_acc_rdonly_f, h5fclose_f, h5fopen_f, h5oclose_f, &
      h5oopen_f, h5s_select_set_f, h5sclose_f, h5screate_simple_f, h5sget_simple_extent_dims_f, &
      h5sselect_hyperslab_f, h5t_native_double, h5tclose_f, hid_t, hsize_t
   use hdf5_writer, only: hdf5_file_type, make_text_type
   use kinds, only: dp
   use text, only: string_type
   implicit none
   private
   public :: hdf5_reader_type

   !> An open file.
   type, extends(hdf5_file_type) :: hdf5_reader_type
   contains
      procedure :: open => open_file
      procedure :: close => close_file
      procedure :: reals
      procedure :: strings
      procedure :: number
      procedure :: text
   end type hdf5_reader_type

   interface
      !> Characters of a string of C.
      integer(c_size_t) function c_length(string) bind(c, name='strlen')
         import :: c_ptr, c_size_t
         type(c_ptr), value :: string
      end function c_length
   end interface

contains

   !> Opens a file; HDF5 is started.
   subroutine open_file(self, path)
      class(hdf5_reader_type), intent(inout) :: self
      character(*), intent(in) :: path
      integer :: status

      self%error_status = status_deck
      self%before = 'the result "'//path//'" cannot be read: '
      call check_seal(path, self%error)
      if (allocated(self%error)) return
      call h5fopen_f(path, h5f_acc_rdonly_f, self%id, status)
      if (status < 0) self%id = -1
      call self%note([status], 'it is no result file of thercon')
   end subroutine open_file

   !> Closes it.
   !> Error: status_deck, the first one since it was opened.
   subroutine close_file(self, error)
      class(hdf5_reader_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      integer :: ignored

      if (self%id >= 0) call h5fclose_f(self%id, ignored)
      self%id = -1
      call move_alloc(self%error, error)
   end subroutine close_file

   !> Numbers of a dataset, rows one behind the other: all of them, or some rows of one without
   !> columns.
   subroutine reals(self, path, values, first, count)
      class(hdf5_reader_type), intent(inout) :: self
      character(*), intent(in) :: path
      real(dp), allocatable, target, intent(out) :: values(:)
      integer, intent(in), optional :: first, count     !! the first row, from 1; their number
      type(c_ptr) :: buffer
      integer(hid_t) :: dataset, memory, space
      integer(hsize_t) :: extents(2), largest(2), offset(1)
      integer :: rank, status(6)

      allocate (values(0))
      if (allocated(self%error)) return
      status = 0
      call h5dopen_f(self%id, path, dataset, status(1))
      call self%note(status, 'it has no '//path)
      if (allocated(self%error)) return
      call h5dget_space_f(dataset, space, status(1))
      extents = 1
      call h5sget_simple_extent_dims_f(space, extents, largest, rank)
      offset = 0
      if (present(first)) then
         offset = first - 1
         status(6) = merge(0, -1, offset(1) + count <= extents(1))
         extents(1) = count
         call h5sselect_hyperslab_f(space, h5s_select_set_f, offset, extents(:1), status(2))
      end if
      deallocate (values)
      allocate (values(product(extents(:max(rank, 1)))))
      call h5screate_simple_f(1, [size(values, kind=hsize_t)], memory, status(3))
      buffer = c_loc(values)
      if (size(values) > 0 .and. all(status >= 0)) call h5dread_f(dataset, h5t_native_double, &
         buffer, status(4), memory, space)
      call h5sclose_f(memory, status(5))
      call h5sclose_f(space, status(5))
      call h5dclose_f(dataset, status(5))
      call self%note(status, path//' is damaged')
   end subroutine reals

   !> Strings of a dataset.
   subroutine strings(self, path, list)
      class(hdf5_reader_type), intent(inout) :: self
      character(*), intent(in) :: path
      type(string_type), allocatable, intent(out) :: list(:)
      type(c_ptr), allocatable, target :: starts(:)
      type(c_ptr) :: buffer
      integer(hid_t) :: dataset, space, type
      integer(hsize_t) :: extents(1), largest(1)
      integer :: i, rank, status(5)

      allocate (list(0))
      if (allocated(self%error)) return
      status = 0
      call h5dopen_f(self%id, path, dataset, status(1))
      call self%note(status, 'it has no '//path)
      if (allocated(self%error)) return
      call h5dget_space_f(dataset, space, status(1))
      call h5sget_simple_extent_dims_f(space, extents, largest, rank)
      deallocate (list)
      allocate (list(extents(1)), starts(extents(1)))
      call make_text_type(type, status(2))
      buffer = c_loc(starts)
      if (size(list) > 0) call h5dread_f(dataset, type, buffer, status(3))
      do i = 1, size(list)
         if (status(3) >= 0) list(i)%value = taken(starts(i))
      end do
      call h5tclose_f(type, status(4))
      call h5sclose_f(space, status(4))
      call h5dclose_f(dataset, status(4))
      call self%note(status, path//' is damaged')
   end subroutine strings

   !> A number that is an attribute; 0 where it is not there.
   real(dp) function number(self, path, name)
      class(hdf5_reader_type), intent(inout) :: self
      character(*), intent(in) :: path, name           !! of the group, and of the attribute
      real(dp), target :: value

      value = 0.0_dp
      call read_attribute(self, path, name, h5t_native_double, c_loc(value))
      number = value
   end function number

   !> Text that is an attribute; empty where it is not there.
   function text(self, path, name) result(string)
      class(hdf5_reader_type), intent(inout) :: self
      character(*), intent(in) :: path, name           !! of the group, and of the attribute
      character(:), allocatable :: string
      type(c_ptr), target :: start
      integer(hid_t) :: type
      integer :: status

      string = ''
      start = transfer(0_c_size_t, start)
      call make_text_type(type, status)
      call read_attribute(self, path, name, type, c_loc(start))
      if (c_associated(start)) string = taken(start)
      call h5tclose_f(type, status)
   end function text

   !> Reads an attribute to an address; nothing where it is not there.
   subroutine read_attribute(self, path, name, type, address)
      class(hdf5_reader_type), intent(inout) :: self
      character(*), intent(in) :: path, name
      integer(hid_t), intent(in) :: type
      type(c_ptr), intent(in) :: address
      type(c_ptr) :: buffer
      integer(hid_t) :: attribute, object
      integer :: status(4)
      logical :: exists

      if (.not. self%has(path)) return
      status = 0
      call h5oopen_f(self%id, path, object, status(1))
      call h5aexists_f(object, name, exists, status(2))
      if (exists) then
         call h5aopen_f(object, name, attribute, status(3))
         buffer = address
         call h5aread_f(attribute, type, buffer, status(4))
         call h5aclose_f(attribute, status(3))
      end if
      call h5oclose_f(object, status(1))
      call self%note(status, path//'@'//name//' is damaged')
   end subroutine read_attribute

   !> A string that HDF5 has allocated, which is freed.
   function taken(start) result(string)
      type(c_ptr), intent(in) :: start
      character(:), allocatable :: string
      character(kind=c_char), pointer :: characters(:)

      call c_f_pointer(start, characters, [c_length(start)])
      string = transfer(characters, repeat(' ', size(characters)))
      call c_free(start)
   end function taken

end module hdf5_reader
