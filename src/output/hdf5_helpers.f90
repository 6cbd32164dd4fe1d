!> Thin wrappers over HDF5's Fortran API: one call for a file, a group, a whole dataset, an
!> attribute. Shapes are Fortran's; C and h5py show the dimensions in reverse order.
module hdf5_helpers
   use, intrinsic :: iso_c_binding, only: c_char, c_loc, c_null_char, c_ptr
   use errors, only: error_type, set_error, status_internal
   use hdf5, only: hid_t, hsize_t, h5open_f, h5close_f, h5dont_atexit_f, h5eset_auto_f, &
      h5fcreate_f, h5fopen_f, h5fclose_f, h5f_acc_trunc_f, h5f_acc_rdwr_f, &
      h5pcreate_f, h5pclose_f, h5pset_libver_bounds_f, h5p_file_access_f, &
      h5pset_buffer_f, h5p_dataset_xfer_f, &
      h5f_libver_v18_f, h5f_libver_latest_f, h5gcreate_f, h5gclose_f, h5lcreate_hard_f, &
      h5screate_simple_f, h5sclose_f, h5dcreate_f, h5dwrite_f, h5dclose_f, &
      h5tcopy_f, h5tclose_f, h5tset_cset_f, h5t_cset_utf8_f, h5t_string, &
      h5t_native_double, h5t_native_integer, &
      h5t_std_i32le, h5t_std_i64le, h5t_std_u8le, h5t_ieee_f64le
   use kinds, only: dp
   use text, only: string_type
   implicit none
   private
   public :: open_hdf5, close_hdf5, create_file, open_file, close_file
   public :: create_group, link_dataset, write_array, write_values, write_strings
   public :: utf8_string_type, check_status, stored_type, as_real, as_integer, as_long, as_byte

   integer, parameter :: as_real = 1      !! stored as 64-bit real
   integer, parameter :: as_integer = 2   !! stored as 32-bit integer
   integer, parameter :: as_long = 3      !! stored as 64-bit integer
   integer, parameter :: as_byte = 4      !! stored as unsigned byte

   !> Bytes of the buffer in which HDF5 converts types; its own default, 1 MB, is cleared each time.
   integer(hsize_t), parameter :: conversion_bytes = 16384_hsize_t

   !> Writes a whole array as a dataset.
   interface write_array
      module procedure write_integers
      module procedure write_reals
      module procedure write_real_table
   end interface write_array

contains

   !> Raises an error where a call of HDF5 failed.
   !> Error: status_internal, when a status is negative.
   subroutine check_status(status, message, error)
      integer, intent(in) :: status(:)                    !! what the calls returned
      character(*), intent(in) :: message                 !! what failed, in plain words
      type(error_type), allocatable, intent(out) :: error !! what went wrong

      if (any(status < 0)) call set_error(error, status_internal, message)
   end subroutine check_status

   !> Starts HDF5 and silences its own messages: ours go through `error`.
   !> Error: status_internal, when the library does not start.
   subroutine open_hdf5(error)
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      integer :: ignored, status(2)

      ! HDF5 1.10 crashes at exit when a file could not be closed for want of space.
      call h5dont_atexit_f(ignored)
      call h5open_f(status(1))
      call h5eset_auto_f(0, status(2))
      call check_status(status, 'cannot start HDF5', error)
   end subroutine open_hdf5

   !> Ends HDF5 and frees what it holds.
   subroutine close_hdf5()
      integer :: status

      call h5close_f(status)
   end subroutine close_hdf5

   !> Creates a file, over one that is there. Format 1.8 keeps it readable everywhere.
   !> Error: status_internal, when it cannot be written.
   subroutine create_file(path, file, error)
      character(*), intent(in) :: path                    !! path of the file
      integer(hid_t), intent(out) :: file                 !! the open file
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      integer(hid_t) :: access
      integer :: status(4)

      call h5pcreate_f(h5p_file_access_f, access, status(1))
      call h5pset_libver_bounds_f(access, h5f_libver_v18_f, h5f_libver_latest_f, status(2))
      call h5fcreate_f(path, h5f_acc_trunc_f, file, status(3), access_prp=access)
      call h5pclose_f(access, status(4))
      call check_status(status, 'cannot write "'//path//'"', error)
   end subroutine create_file

   !> Opens a file to write on in it.
   !> Error: status_internal, when it is not there or is no HDF5 file.
   subroutine open_file(path, file, error)
      character(*), intent(in) :: path                    !! path of the file
      integer(hid_t), intent(out) :: file                 !! the open file
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      integer :: status

      call h5fopen_f(path, h5f_acc_rdwr_f, file, status)
      call check_status([status], 'cannot open "'//path//'"', error)
   end subroutine open_file

   !> Closes a file; all is then in it.
   !> Error: status_internal, when the rest cannot be written.
   subroutine close_file(file, error)
      integer(hid_t), intent(in) :: file                  !! the open file
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      integer :: status

      call h5fclose_f(file, status)
      call check_status([status], 'cannot finish the result file', error)
   end subroutine close_file

   !> Creates a group; its parent is already.
   !> Error: status_internal, when it cannot be created.
   subroutine create_group(file, path, error)
      integer(hid_t), intent(in) :: file                  !! the open file
      character(*), intent(in) :: path                    !! path of the group
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      integer(hid_t) :: group
      integer :: status(2)

      call h5gcreate_f(file, path, group, status(1))
      call h5gclose_f(group, status(2))
      call check_status(status, 'cannot create group '//path, error)
   end subroutine create_group

   !> Gives a dataset a second name.
   !> Error: status_internal, when there is no such dataset.
   subroutine link_dataset(file, path, second_path, error)
      integer(hid_t), intent(in) :: file                  !! the open file
      character(*), intent(in) :: path                    !! path of the dataset
      character(*), intent(in) :: second_path             !! another path for it
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      integer :: status

      call h5lcreate_hard_f(file, path, file, second_path, status)
      call check_status([status], 'cannot link '//second_path, error)
   end subroutine link_dataset

   !> The type that numbers have in the file.
   function stored_type(storage) result(type)
      integer, intent(in) :: storage   !! as_real, as_integer, as_long or as_byte
      integer(hid_t) :: type           !! HDF5's type, not to be closed

      select case (storage)
      case (as_integer)
         type = h5t_std_i32le
      case (as_long)
         type = h5t_std_i64le
      case (as_byte)
         type = h5t_std_u8le
      case default
         type = h5t_ieee_f64le
      end select
   end function stored_type

   !> The type of text of any length, which h5py shows as str.
   subroutine utf8_string_type(type, status)
      integer(hid_t), intent(out) :: type   !! HDF5's type, to be closed by the caller
      integer, intent(out) :: status        !! negative for failure

      call h5tcopy_f(h5t_string, type, status)
      if (status >= 0) call h5tset_cset_f(type, h5t_cset_utf8_f, status)
   end subroutine utf8_string_type

   !> Writes text of any length as a dataset of strings.
   !> Error: status_internal, when the dataset cannot be written.
   subroutine write_strings(file, path, strings, error)
      integer(hid_t), intent(in) :: file                  !! the open file
      character(*), intent(in) :: path                    !! path of the dataset
      type(string_type), intent(in) :: strings(:)         !! the text
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      character(kind=c_char), allocatable, target :: characters(:)
      type(c_ptr), allocatable, target :: starts(:)
      integer(hid_t) :: type
      integer :: i, k, position, status

      position = 0
      do i = 1, size(strings)
         position = position + len(strings(i)%value) + 1
      end do
      allocate(characters(position), starts(size(strings)))
      position = 0
      do i = 1, size(strings)
         starts(i) = c_loc(characters(position + 1))
         do k = 1, len(strings(i)%value)
            characters(position + k) = strings(i)%value(k:k)
         end do
         position = position + len(strings(i)%value) + 1
         characters(position) = c_null_char
      end do
      call utf8_string_type(type, status)
      call write_whole(file, path, shape(starts, kind=hsize_t), type, type, c_loc(starts), error)
      call h5tclose_f(type, status)
   end subroutine write_strings

   !> Error: status_internal, when the dataset cannot be written.
   subroutine write_integers(file, path, values, storage, error)
      integer(hid_t), intent(in) :: file                  !! the open file
      character(*), intent(in) :: path                    !! path of the dataset
      integer, intent(in) :: values(:)                    !! what is written
      integer, intent(in) :: storage                      !! as_integer, as_long or as_byte
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      integer, allocatable, target :: copy(:)

      allocate(copy, source=values)
      call write_whole(file, path, shape(values, kind=hsize_t), h5t_native_integer, &
         stored_type(storage), c_loc(copy), error)
   end subroutine write_integers

   !> Error: status_internal, when the dataset cannot be written.
   subroutine write_reals(file, path, values, error)
      integer(hid_t), intent(in) :: file                  !! the open file
      character(*), intent(in) :: path                    !! path of the dataset
      real(dp), intent(in) :: values(:)                   !! what is written
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      real(dp), allocatable, target :: copy(:)

      allocate(copy, source=values)
      call write_whole(file, path, shape(values, kind=hsize_t), h5t_native_double, &
         stored_type(as_real), c_loc(copy), error)
   end subroutine write_reals

   !> Error: status_internal, when the dataset cannot be written.
   subroutine write_real_table(file, path, values, error)
      integer(hid_t), intent(in) :: file                  !! the open file
      character(*), intent(in) :: path                    !! path of the dataset
      real(dp), intent(in) :: values(:, :)                !! what is written
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      real(dp), allocatable, target :: copy(:, :)

      allocate(copy, source=values)
      call write_whole(file, path, shape(values, kind=hsize_t), h5t_native_double, &
         stored_type(as_real), c_loc(copy), error)
   end subroutine write_real_table

   subroutine write_whole(file, path, dimensions, memory_type, file_type, address, error)
      integer(hid_t), intent(in) :: file
      character(*), intent(in) :: path
      integer(hsize_t), intent(in) :: dimensions(:)
      integer(hid_t), intent(in) :: memory_type
      integer(hid_t), intent(in) :: file_type
      type(c_ptr), intent(in) :: address
      type(error_type), allocatable, intent(out) :: error
      integer(hid_t) :: space, dataset
      integer :: status(5)

      call h5screate_simple_f(size(dimensions), dimensions, space, status(1))
      call h5dcreate_f(file, path, file_type, space, dataset, status(2))
      call write_values(dataset, memory_type, address, status(3))
      call h5dclose_f(dataset, status(4))
      call h5sclose_f(space, status(5))
      call check_status(status, 'cannot write dataset '//path, error)
   end subroutine write_whole

   !> Writes values into an open dataset: all of it, or what the selections name.
   subroutine write_values(dataset, memory_type, address, status, memory, space)
      integer(hid_t), intent(in) :: dataset            !! the dataset
      integer(hid_t), intent(in) :: memory_type        !! type of the values
      type(c_ptr), intent(in) :: address               !! the values
      integer, intent(out) :: status                   !! negative for failure
      integer(hid_t), intent(in), optional :: memory   !! selection in memory
      integer(hid_t), intent(in), optional :: space    !! selection in the dataset
      integer(hid_t) :: transfer
      integer :: results(4)

      call h5pcreate_f(h5p_dataset_xfer_f, transfer, results(1))
      call h5pset_buffer_f(transfer, conversion_bytes, results(2))
      call h5dwrite_f(dataset, memory_type, address, results(3), memory, space, transfer)
      call h5pclose_f(transfer, results(4))
      status = minval(results)
   end subroutine write_values

end module hdf5_helpers
