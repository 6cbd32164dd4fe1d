!> A file that HDF5 writes: groups, whole datasets, attributes. Shapes are Fortran's; C and h5py
!> show the dimensions in reverse order.
!>
!> The writer keeps its first error, and writes nothing after it: its user checks once, at the end.
module hdf5_writer
   use, intrinsic :: iso_c_binding, only: c_char, c_loc, c_null_char, c_ptr
   use errors, only: error_type, set_error, status_internal
   use hdf5, only: hid_t, hsize_t, size_t, h5open_f, h5close_f, h5dont_atexit_f, h5eset_auto_f, &
      h5fcreate_f, h5fopen_f, h5fclose_f, h5f_acc_trunc_f, h5f_acc_rdwr_f, h5pcreate_f, &
      h5pclose_f, h5pset_libver_bounds_f, h5pset_buffer_f, h5p_file_access_f, &
      h5p_dataset_create_f, h5p_dataset_xfer_f, h5f_libver_v18_f, h5f_libver_latest_f, &
      h5gcreate_f, h5gclose_f, h5lcreate_hard_f, h5ldelete_f, h5lexists_f, h5gn_members_f, &
      h5gget_obj_info_idx_f, h5screate_simple_f, h5screate_f, h5sclose_f, h5s_scalar_f, &
      h5dcreate_f, h5dwrite_f, h5dclose_f, h5oopen_f, h5oclose_f, h5aopen_f, h5acreate_f, &
      h5aexists_f, h5awrite_f, h5aclose_f, h5tcopy_f, h5tclose_f, h5tset_cset_f, h5tset_size_f, &
      h5t_cset_utf8_f, h5t_string, h5t_native_character, h5t_native_double, h5t_native_integer, &
      h5kind_to_type, h5_integer_kind, h5t_std_i32le, h5t_std_i64le, h5t_std_u8le, h5t_ieee_f64le
   use kinds, only: dp, long
   use model, only: unit_labels_type
   use text, only: or_blank, string_type
   use unit_labels, only: unit_in_words
   implicit none
   private
   public :: hdf5_file_type, hdf5_writer_type, start_hdf5, end_hdf5, make_text_type
   public :: stored_type, as_real, as_integer, as_long, as_byte

   integer, parameter :: as_real = 1      !! stored as 64-bit real
   integer, parameter :: as_integer = 2   !! stored as 32-bit integer
   integer, parameter :: as_long = 3      !! stored as 64-bit integer
   integer, parameter :: as_byte = 4      !! stored as unsigned byte
   !> Bytes of the buffer in which HDF5 converts types; its own default, 1 MB, is cleared each time.
   integer(hsize_t), parameter :: conversion_bytes = 16384_hsize_t
   integer, parameter :: longest_name = 1024   !! of a member of a group

   !> A file, written or read.
   type :: hdf5_file_type
      integer(hid_t) :: id = -1                          !! HDF5's handle while the file is open
      type(error_type), allocatable :: error             !! the first one since it was opened
      integer :: error_status = status_internal          !! of its errors
      character(:), allocatable :: before                !! their words; unallocated for none
   contains
      procedure :: note
      procedure :: has
   end type hdf5_file_type

   !> A file that is being written.
   type, extends(hdf5_file_type) :: hdf5_writer_type
      integer(hid_t) :: creation = -1                    !! properties of datasets, likewise
      integer(hid_t) :: transfer = -1                    !! properties of writing them, likewise
      integer(hid_t), private :: text = -1               !! type of text, likewise
      type(unit_labels_type) :: labels                   !! units of the deck
   contains
      procedure :: create => create_file
      procedure :: open => open_file
      procedure :: close => close_file
      procedure :: create_group
      procedure :: link => link_dataset
      procedure :: remove
      procedure :: keep_members
      procedure :: write => write_strings
      generic :: set => set_attribute, set_integers
      procedure :: set_fixed_text
      procedure :: describe
      procedure, private :: set_attribute, set_integers
   end type hdf5_writer_type

   !> A value in memory, and its types.
   type :: stored_value_type
      integer(hid_t) :: memory_type = -1
      integer(hid_t) :: file_type = -1
      type(c_ptr) :: address
      integer :: extent = 0                    !! numbers in it; 0 for a scalar
   end type stored_value_type

contains

   !> Starts HDF5 and silences its own messages: ours go through `error`.
   !> Error: status_internal, when the library does not start.
   subroutine start_hdf5(error)
      type(error_type), allocatable, intent(out) :: error
      integer :: ignored, status(2)

      ! HDF5 1.10 crashes at exit when a file could not be closed for want of space.
      call h5dont_atexit_f(ignored)
      call h5open_f(status(1))
      call h5eset_auto_f(0, status(2))
      if (any(status < 0)) call set_error(error, status_internal, 'cannot start HDF5')
   end subroutine start_hdf5

   !> Ends HDF5 and frees its memory.
   subroutine end_hdf5()
      integer :: status

      call h5close_f(status)
   end subroutine end_hdf5

   !> Creates a file, over one that is there. Format 1.8 keeps it readable everywhere.
   !> Error kept: status_internal, when it cannot be written.
   subroutine create_file(self, path)
      class(hdf5_writer_type), intent(inout) :: self
      character(*), intent(in) :: path
      integer(hid_t) :: access
      integer :: status(4)

      call h5pcreate_f(h5p_file_access_f, access, status(1))
      call h5pset_libver_bounds_f(access, h5f_libver_v18_f, h5f_libver_latest_f, status(2))
      call h5fcreate_f(path, h5f_acc_trunc_f, self%id, status(3), access_prp=access)
      call h5pclose_f(access, status(4))
      call self%note(status, 'cannot write "'//path//'"')
      call make_properties(self)
   end subroutine create_file

   !> Opens a file to extend it.
   !> Error kept: status_internal, when it is not there or is no HDF5 file.
   subroutine open_file(self, path)
      class(hdf5_writer_type), intent(inout) :: self
      character(*), intent(in) :: path
      integer :: status

      call h5fopen_f(path, h5f_acc_rdwr_f, self%id, status)
      call self%note([status], 'cannot open "'//path//'"')
      call make_properties(self)
   end subroutine open_file

   !> Makes what all datasets of the file share, because making it for each takes longer than
   !> writing a small one.
   subroutine make_properties(self)
      class(hdf5_writer_type), intent(inout) :: self
      integer :: status(4)

      if (self%id < 0) return
      call h5pcreate_f(h5p_dataset_create_f, self%creation, status(1))
      call h5pcreate_f(h5p_dataset_xfer_f, self%transfer, status(2))
      call h5pset_buffer_f(self%transfer, conversion_bytes, status(3))
      call make_text_type(self%text, status(4))
      call self%note(status, 'cannot set properties of HDF5')
   end subroutine make_properties

   !> Closes the file, which is then complete unless there was an error.
   !> Error: the first one since it was opened; status_internal, when the rest cannot be written.
   subroutine close_file(self, error)
      class(hdf5_writer_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      integer :: status(4)

      if (self%id >= 0) then
         call h5pclose_f(self%creation, status(1))
         call h5pclose_f(self%transfer, status(2))
         call h5tclose_f(self%text, status(3))
         call h5fclose_f(self%id, status(4))
         call self%note(status, 'cannot finish the result file')
      end if
      self%id = -1
      call move_alloc(self%error, error)
   end subroutine close_file

   !> Keeps an error where a call of HDF5 failed.
   subroutine note(self, status, message)
      class(hdf5_file_type), intent(inout) :: self
      integer, intent(in) :: status(:)                    !! returned by the calls
      character(*), intent(in) :: message                 !! what failed, in plain words

      if (allocated(self%error)) return
      if (any(status < 0)) call set_error(self%error, self%error_status, &
         or_blank(self%before)//message)
   end subroutine note

   !> Creates a group; its parent exists.
   subroutine create_group(self, path)
      class(hdf5_writer_type), intent(inout) :: self
      character(*), intent(in) :: path
      integer(hid_t) :: group
      integer :: status(2)

      if (allocated(self%error)) return
      call h5gcreate_f(self%id, path, group, status(1))
      call h5gclose_f(group, status(2))
      call self%note(status, 'cannot create group '//path)
   end subroutine create_group

   !> Whether there is a group or dataset; its group exists.
   logical function has(self, path)
      class(hdf5_file_type), intent(inout) :: self
      character(*), intent(in) :: path
      integer :: status

      has = .false.
      if (allocated(self%error)) return
      call h5lexists_f(self%id, path, has, status)
      call self%note([status], 'the group of '//path//' is damaged')
   end function has

   !> Removes a dataset.
   subroutine remove(self, path)
      class(hdf5_writer_type), intent(inout) :: self
      character(*), intent(in) :: path
      integer :: status

      if (allocated(self%error)) return
      call h5ldelete_f(self%id, path, status)
      call self%note([status], 'cannot remove '//path)
   end subroutine remove

   !> Removes the members of a group that are not among some.
   subroutine keep_members(self, path, kept)
      class(hdf5_writer_type), intent(inout) :: self
      character(*), intent(in) :: path                    !! of the group, which exists
      type(string_type), intent(in) :: kept(:)            !! names of members
      character(longest_name) :: name
      integer :: count, i, k, kind, status

      if (allocated(self%error)) return
      call h5gn_members_f(self%id, path, count, status)
      call self%note([status], 'cannot read group '//path)
      if (allocated(self%error)) return
      do i = count - 1, 0, -1
         call h5gget_obj_info_idx_f(self%id, path, i, name, kind, status)
         call self%note([status], 'cannot read group '//path)
         if (any([(kept(k)%value == trim(name), k=1, size(kept))])) cycle
         call self%remove(path//'/'//trim(name))
      end do
   end subroutine keep_members

   !> Gives a dataset a second name, unless it has it.
   subroutine link_dataset(self, path, second_path)
      class(hdf5_writer_type), intent(inout) :: self
      character(*), intent(in) :: path, second_path
      integer :: status

      if (self%has(second_path) .or. allocated(self%error)) return
      call h5lcreate_hard_f(self%id, path, self%id, second_path, status)
      call self%note([status], 'cannot link '//second_path)
   end subroutine link_dataset

   !> The type that numbers have in the file.
   function stored_type(storage) result(type)
      integer, intent(in) :: storage   !! as_real, as_integer, as_long or as_byte
      integer(hid_t) :: type           !! HDF5's type, not to be closed
      integer(hid_t) :: types(4)

      types([as_real, as_integer, as_long, as_byte]) = [h5t_ieee_f64le, h5t_std_i32le, &
         h5t_std_i64le, h5t_std_u8le]
      type = types(storage)
   end function stored_type

   !> The type of text of any length, which h5py shows as str; to be closed by the caller.
   subroutine make_text_type(type, status)
      integer(hid_t), intent(out) :: type
      integer, intent(out) :: status        !! negative for failure

      call h5tcopy_f(h5t_string, type, status)
      if (status >= 0) call h5tset_cset_f(type, h5t_cset_utf8_f, status)
   end subroutine make_text_type

   !> Writes a dataset of strings of any length.
   subroutine write_strings(self, path, strings, description)
      class(hdf5_writer_type), intent(inout) :: self
      character(*), intent(in) :: path
      type(string_type), intent(in) :: strings(:)
      character(*), intent(in) :: description
      character(kind=c_char), allocatable, target :: characters(:)
      type(c_ptr), allocatable, target :: starts(:)
      integer(hid_t) :: dataset, space
      integer :: i, k, position, status(5)

      if (allocated(self%error)) return
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
      call h5screate_simple_f(1, shape(starts, kind=hsize_t), space, status(1))
      call h5dcreate_f(self%id, path, self%text, space, dataset, status(2))
      call h5dwrite_f(dataset, self%text, c_loc(starts), status(3), xfer_prp=self%transfer)
      call self%note(status(:3), 'cannot write dataset '//path)
      call self%describe(dataset, path, description, '-', '')
      call h5dclose_f(dataset, status(4))
      call h5sclose_f(space, status(5))
      call self%note(status, 'cannot write dataset '//path)
   end subroutine write_strings

   !> Says what an open dataset is: `description`, `unit`, and `components` where there are such.
   subroutine describe(self, dataset, path, description, unit, components)
      class(hdf5_writer_type), intent(inout) :: self
      integer(hid_t), intent(in) :: dataset
      character(*), intent(in) :: path                    !! its path
      character(*), intent(in) :: description
      character(*), intent(in) :: unit                    !! as of quantity_type; '-': pure number
      character(*), intent(in) :: components              !! their names; empty: none

      call set_text(self, path, 'description', trim(description), dataset)
      call set_text(self, path, 'unit', unit_in_words(trim(unit), self%labels), dataset)
      if (components /= '') call set_text(self, path, 'components', trim(components), dataset)
   end subroutine describe

   !> Writes an attribute of a group or dataset, over one of the same name: an integer of either
   !> kind, a real, or text, which h5py shows as str.
   subroutine set_attribute(self, path, name, value)
      class(hdf5_writer_type), intent(inout) :: self
      character(*), intent(in) :: path                    !! of the group or dataset
      character(*), intent(in) :: name
      class(*), target, intent(in) :: value

      select type (value)
      type is (integer)
         call set_value(self, path, name, stored_value_type(h5t_native_integer, &
            stored_type(as_integer), c_loc(value)))
      type is (integer(long))
         call set_value(self, path, name, stored_value_type(h5kind_to_type(long, h5_integer_kind), &
            stored_type(as_long), c_loc(value)))
      type is (real(dp))
         call set_value(self, path, name, stored_value_type(h5t_native_double, &
            stored_type(as_real), c_loc(value)))
      type is (character(*))
         call set_text(self, path, name, value)
      end select
   end subroutine set_attribute

   subroutine set_integers(self, path, name, values)
      class(hdf5_writer_type), intent(inout) :: self
      character(*), intent(in) :: path, name
      integer, contiguous, target, intent(in) :: values(:)

      call set_value(self, path, name, stored_value_type(h5t_native_integer, &
         stored_type(as_integer), c_loc(values), size(values)))
   end subroutine set_integers

   !> Writes an attribute of text of fixed length, the form that VTK asks for.
   subroutine set_fixed_text(self, path, name, value)
      class(hdf5_writer_type), intent(inout) :: self
      character(*), intent(in) :: path, name, value
      character(len(value), kind=c_char), target :: copy
      integer(hid_t) :: type
      integer :: status(3)

      if (allocated(self%error)) return
      copy = value
      call h5tcopy_f(h5t_native_character, type, status(1))
      call h5tset_size_f(type, len(value, kind=size_t), status(2))
      call set_value(self, path, name, stored_value_type(type, type, c_loc(copy)))
      call h5tclose_f(type, status(3))
      call self%note(status, 'cannot write attribute '//path//'@'//name)
   end subroutine set_fixed_text

   subroutine set_text(self, path, name, value, opened)
      class(hdf5_writer_type), intent(inout) :: self
      character(*), intent(in) :: path, name, value
      integer(hid_t), intent(in), optional :: opened   ! the object at the path
      character(len(value) + 1, kind=c_char), target :: copy
      type(c_ptr), target :: start

      copy = value//c_null_char
      start = c_loc(copy)
      call set_value(self, path, name, stored_value_type(self%text, self%text, c_loc(start)), &
         opened)
   end subroutine set_text

   subroutine set_value(self, path, name, value, opened)
      class(hdf5_writer_type), intent(inout) :: self
      character(*), intent(in) :: path, name
      type(stored_value_type), intent(in) :: value
      integer(hid_t), intent(in), optional :: opened   ! the object at the path
      integer(hid_t) :: attribute, object, space
      integer :: status(8)
      logical :: exists

      if (allocated(self%error)) return
      status = 0
      exists = .false.
      ! HDF5 1.10 cannot write to an attribute that was opened by the path of its object.
      if (present(opened)) object = opened
      if (.not. present(opened)) call h5oopen_f(self%id, path, object, status(1))
      call h5aexists_f(object, name, exists, status(2))
      if (exists) then
         call h5aopen_f(object, name, attribute, status(3))
      else
         if (value%extent > 0) then
            call h5screate_simple_f(1, [int(value%extent, hsize_t)], space, status(3))
         else
            call h5screate_f(h5s_scalar_f, space, status(3))
         end if
         call h5acreate_f(object, name, value%file_type, space, attribute, status(4))
         call h5sclose_f(space, status(5))
      end if
      call h5awrite_f(attribute, value%memory_type, value%address, status(6))
      call h5aclose_f(attribute, status(7))
      if (.not. present(opened)) call h5oclose_f(object, status(8))
      call self%note(status, 'cannot write attribute '//path//'@'//name)
   end subroutine set_value

end module hdf5_writer
