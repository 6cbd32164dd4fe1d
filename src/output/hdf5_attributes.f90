!> Attributes of HDF5 objects: written new, or over one of the same name.
module hdf5_attributes
   use, intrinsic :: iso_c_binding, only: c_char, c_loc, c_null_char, c_ptr
   use errors, only: error_type
   use hdf5, only: hid_t, hsize_t, size_t, h5oopen_f, h5oclose_f, h5aopen_f, &
      h5acreate_f, h5aexists_f, h5awrite_f, h5aclose_f, h5screate_simple_f, &
      h5screate_f, h5sclose_f, h5s_scalar_f, h5tcopy_f, h5tclose_f, h5tset_size_f, &
      h5t_native_character, h5t_native_double, h5t_native_integer, h5kind_to_type, h5_integer_kind
   use hdf5_helpers, only: as_integer, as_long, as_real, check_status, stored_type, utf8_string_type
   use kinds, only: dp, long
   implicit none
   private
   public :: write_attribute, write_fixed_text, describe, describe_open

   !> Writes an attribute.
   interface write_attribute
      module procedure write_integer_attribute
      module procedure write_integers_attribute
      module procedure write_long_attribute
      module procedure write_real_attribute
      module procedure write_text_attribute
   end interface write_attribute

   !> A value in memory, and its types.
   type :: stored_value_type
      integer(hid_t) :: memory_type = -1
      integer(hid_t) :: file_type = -1
      type(c_ptr) :: address
      integer :: extent = 0                    !! numbers in it; 0 for a scalar
   end type stored_value_type

contains

   !> Writes what a dataset is: `description`, `unit`, and `components` where there are such.
   !> Error: status_internal, when an attribute cannot be written.
   subroutine describe(file, path, description, unit, error, components)
      integer(hid_t), intent(in) :: file                  !! the open file
      character(*), intent(in) :: path                    !! path of the dataset
      character(*), intent(in) :: description             !! what it is
      character(*), intent(in) :: unit                    !! its unit; '-' for a pure number
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      character(*), intent(in), optional :: components    !! their names; empty or absent: none
      integer(hid_t) :: object
      integer :: status(3)

      call h5oopen_f(file, path, object, status(1))
      call describe_open(object, description, unit, status(2), components)
      call h5oclose_f(object, status(3))
      call check_status(status, 'cannot describe '//path, error)
   end subroutine describe

   !> The same for a dataset that is open.
   subroutine describe_open(dataset, description, unit, worst, components)
      integer(hid_t), intent(in) :: dataset               !! the open dataset
      character(*), intent(in) :: description             !! what it is
      character(*), intent(in) :: unit                    !! its unit; '-' for a pure number
      integer, intent(out) :: worst                       !! negative after an error
      character(*), intent(in), optional :: components    !! their names; empty or absent: none
      integer(hid_t) :: type
      integer :: status(5)

      status = 0
      call utf8_string_type(type, status(1))
      call write_text(dataset, 'description', trim(description), type, status(2))
      call write_text(dataset, 'unit', trim(unit), type, status(3))
      if (present(components)) then
         if (len_trim(components) > 0) call write_text(dataset, 'components', trim(components), &
            type, status(4))
      end if
      call h5tclose_f(type, status(5))
      worst = minval(status)
   end subroutine describe_open

   !> Writes text to an open object.
   subroutine write_text(object, name, value, type, status)
      integer(hid_t), intent(in) :: object, type
      character(*), intent(in) :: name, value
      integer, intent(out) :: status
      character(len(value) + 1, kind=c_char), target :: copy
      type(c_ptr), target :: start

      copy = value//c_null_char
      start = c_loc(copy)
      call write_to(object, name, stored_value_type(type, type, c_loc(start)), status)
   end subroutine write_text

   !> Error: status_internal, when the attribute cannot be written.
   subroutine write_integer_attribute(file, path, name, value, error)
      integer(hid_t), intent(in) :: file                  !! the open file
      character(*), intent(in) :: path                    !! path of the object
      character(*), intent(in) :: name                    !! name of the attribute
      integer, intent(in) :: value                        !! its value
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      integer, target :: copy

      copy = value
      call write_any(file, path, name, stored_value_type(h5t_native_integer, &
         stored_type(as_integer), c_loc(copy)), error)
   end subroutine write_integer_attribute

   !> Error: status_internal, when the attribute cannot be written.
   subroutine write_integers_attribute(file, path, name, values, error)
      integer(hid_t), intent(in) :: file                  !! the open file
      character(*), intent(in) :: path                    !! path of the object
      character(*), intent(in) :: name                    !! name of the attribute
      integer, contiguous, target, intent(in) :: values(:) !! its values
      type(error_type), allocatable, intent(out) :: error !! what went wrong

      call write_any(file, path, name, stored_value_type(h5t_native_integer, &
         stored_type(as_integer), c_loc(values), size(values)), error)
   end subroutine write_integers_attribute

   !> Error: status_internal, when the attribute cannot be written.
   subroutine write_long_attribute(file, path, name, value, error)
      integer(hid_t), intent(in) :: file                  !! the open file
      character(*), intent(in) :: path                    !! path of the object
      character(*), intent(in) :: name                    !! name of the attribute
      integer(long), intent(in) :: value                  !! its value
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      integer(long), target :: copy

      copy = value
      call write_any(file, path, name, stored_value_type(h5kind_to_type(long, h5_integer_kind), &
         stored_type(as_long), c_loc(copy)), error)
   end subroutine write_long_attribute

   !> Error: status_internal, when the attribute cannot be written.
   subroutine write_real_attribute(file, path, name, value, error)
      integer(hid_t), intent(in) :: file                  !! the open file
      character(*), intent(in) :: path                    !! path of the object
      character(*), intent(in) :: name                    !! name of the attribute
      real(dp), intent(in) :: value                       !! its value
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      real(dp), target :: copy

      copy = value
      call write_any(file, path, name, stored_value_type(h5t_native_double, &
         stored_type(as_real), c_loc(copy)), error)
   end subroutine write_real_attribute

   !> Error: status_internal, when the attribute cannot be written.
   subroutine write_text_attribute(file, path, name, value, error)
      integer(hid_t), intent(in) :: file                  !! the open file
      character(*), intent(in) :: path                    !! path of the object
      character(*), intent(in) :: name                    !! name of the attribute
      character(*), intent(in) :: value                   !! its value, shown by h5py as str
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      integer(hid_t) :: object, type
      integer :: status(5)

      status = 0
      call h5oopen_f(file, path, object, status(1))
      call utf8_string_type(type, status(2))
      call write_text(object, name, value, type, status(3))
      call h5tclose_f(type, status(4))
      call h5oclose_f(object, status(5))
      call check_status(status, 'cannot write attribute '//path//'@'//name, error)
   end subroutine write_text_attribute

   !> Writes text of fixed length, the form that VTK asks for.
   !> Error: status_internal, when the attribute cannot be written.
   subroutine write_fixed_text(file, path, name, value, error)
      integer(hid_t), intent(in) :: file                  !! the open file
      character(*), intent(in) :: path                    !! path of the object
      character(*), intent(in) :: name                    !! name of the attribute
      character(*), intent(in) :: value                   !! its value
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      character(len(value), kind=c_char), target :: copy
      integer(hid_t) :: type
      integer :: status(3)

      copy = value
      call h5tcopy_f(h5t_native_character, type, status(1))
      call h5tset_size_f(type, len(value, kind=size_t), status(2))
      call write_any(file, path, name, stored_value_type(type, type, c_loc(copy)), error)
      call h5tclose_f(type, status(3))
      if (.not. allocated(error)) call check_status(status, 'cannot write text', error)
   end subroutine write_fixed_text

   subroutine write_any(file, path, name, value, error)
      integer(hid_t), intent(in) :: file
      character(*), intent(in) :: path
      character(*), intent(in) :: name
      type(stored_value_type), intent(in) :: value
      type(error_type), allocatable, intent(out) :: error
      integer(hid_t) :: object
      integer :: status(3)

      ! HDF5 1.10 cannot write to an attribute that was opened by the path of its object.
      call h5oopen_f(file, path, object, status(1))
      call write_to(object, name, value, status(2))
      call h5oclose_f(object, status(3))
      call check_status(status, 'cannot write attribute '//path//'@'//name, error)
   end subroutine write_any

   !> Writes an attribute of an open object.
   subroutine write_to(object, name, value, worst)
      integer(hid_t), intent(in) :: object
      character(*), intent(in) :: name
      type(stored_value_type), intent(in) :: value
      integer, intent(out) :: worst
      integer(hid_t) :: attribute, space
      integer :: status(6)
      logical :: exists

      status = 0
      call h5aexists_f(object, name, exists, status(1))
      if (exists) then
         call h5aopen_f(object, name, attribute, status(2))
      else
         if (value%extent > 0) then
            call h5screate_simple_f(1, [int(value%extent, hsize_t)], space, status(2))
         else
            call h5screate_f(h5s_scalar_f, space, status(2))
         end if
         call h5acreate_f(object, name, value%file_type, space, attribute, status(3))
         call h5sclose_f(space, status(4))
      end if
      call h5awrite_f(attribute, value%memory_type, value%address, status(5))
      call h5aclose_f(attribute, status(6))
      worst = minval(status)
   end subroutine write_to

end module hdf5_attributes
