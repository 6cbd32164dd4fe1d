!> The part of HDF5's Fortran interface that `src` uses, written from the HDF5 1.10 reference
!> manual, for a compiler that cannot read the module files of the installed HDF5. It is read, never
!> linked; that the installed HDF5 agrees with the calls is seen by the build itself.
module hdf5
   use, intrinsic :: iso_c_binding, only: c_int, c_int64_t, c_ptr, c_size_t
   implicit none
   public

   integer, parameter :: hid_t = c_int64_t
   integer, parameter :: hsize_t = c_int64_t
   integer, parameter :: size_t = c_size_t
   integer(c_int), parameter :: h5_integer_kind = 0

   integer :: h5f_acc_rdonly_f, h5f_acc_rdwr_f, h5f_acc_trunc_f
   integer :: h5f_libver_latest_f, h5f_libver_v18_f
   integer :: h5s_scalar_f, h5s_select_set_f, h5t_cset_utf8_f
   integer(hsize_t) :: h5s_unlimited_f
   integer(hid_t) :: h5p_dataset_create_f, h5p_dataset_xfer_f, h5p_file_access_f
   integer(hid_t) :: h5t_ieee_f64le, h5t_std_i32le, h5t_std_i64le, h5t_std_u8le, h5t_string
   integer(hid_t) :: h5t_native_character, h5t_native_double, h5t_native_integer

   interface
      subroutine h5open_f(error)
         integer, intent(out) :: error
      end subroutine h5open_f

      subroutine h5close_f(error)
         integer, intent(out) :: error
      end subroutine h5close_f

      subroutine h5dont_atexit_f(error)
         integer, intent(out) :: error
      end subroutine h5dont_atexit_f

      subroutine h5get_libversion_f(majnum, minnum, relnum, error)
         integer, intent(out) :: majnum, minnum, relnum, error
      end subroutine h5get_libversion_f

      function h5kind_to_type(ikind, flag) result(h5_type)
         import :: c_int, hid_t
         integer, intent(in) :: ikind
         integer(c_int), intent(in) :: flag
         integer(hid_t) :: h5_type
      end function h5kind_to_type

      subroutine h5eset_auto_f(printflag, hdferr, estack_id, func, client_data)
         import :: c_ptr, hid_t
         integer, intent(in) :: printflag
         integer, intent(out) :: hdferr
         integer(hid_t), intent(in), optional :: estack_id
         type(c_ptr), intent(in), optional :: func, client_data
      end subroutine h5eset_auto_f

      subroutine h5fcreate_f(name, access_flags, file_id, hdferr, creation_prp, access_prp)
         import :: hid_t
         character(*), intent(in) :: name
         integer, intent(in) :: access_flags
         integer(hid_t), intent(out) :: file_id
         integer, intent(out) :: hdferr
         integer(hid_t), intent(in), optional :: creation_prp, access_prp
      end subroutine h5fcreate_f

      subroutine h5fopen_f(name, access_flags, file_id, hdferr, access_prp)
         import :: hid_t
         character(*), intent(in) :: name
         integer, intent(in) :: access_flags
         integer(hid_t), intent(out) :: file_id
         integer, intent(out) :: hdferr
         integer(hid_t), intent(in), optional :: access_prp
      end subroutine h5fopen_f

      subroutine h5fclose_f(file_id, hdferr)
         import :: hid_t
         integer(hid_t), intent(in) :: file_id
         integer, intent(out) :: hdferr
      end subroutine h5fclose_f

      subroutine h5pcreate_f(class, prp_id, hdferr)
         import :: hid_t
         integer(hid_t), intent(in) :: class
         integer(hid_t), intent(out) :: prp_id
         integer, intent(out) :: hdferr
      end subroutine h5pcreate_f

      subroutine h5pclose_f(prp_id, hdferr)
         import :: hid_t
         integer(hid_t), intent(in) :: prp_id
         integer, intent(out) :: hdferr
      end subroutine h5pclose_f

      subroutine h5pset_libver_bounds_f(fapl_id, low, high, hdferr)
         import :: hid_t
         integer(hid_t), intent(in) :: fapl_id
         integer, intent(in) :: low, high
         integer, intent(out) :: hdferr
      end subroutine h5pset_libver_bounds_f

      subroutine h5pset_buffer_f(plist_id, size, hdferr)
         import :: hid_t, hsize_t
         integer(hid_t), intent(in) :: plist_id
         integer(hsize_t), intent(in) :: size
         integer, intent(out) :: hdferr
      end subroutine h5pset_buffer_f

      subroutine h5pset_chunk_f(prp_id, ndims, dims, hdferr)
         import :: hid_t, hsize_t
         integer(hid_t), intent(in) :: prp_id
         integer, intent(in) :: ndims
         integer(hsize_t), intent(in) :: dims(ndims)
         integer, intent(out) :: hdferr
      end subroutine h5pset_chunk_f

      subroutine h5gcreate_f(loc_id, name, grp_id, hdferr, size_hint, lcpl_id, gcpl_id, gapl_id)
         import :: hid_t, size_t
         integer(hid_t), intent(in) :: loc_id
         character(*), intent(in) :: name
         integer(hid_t), intent(out) :: grp_id
         integer, intent(out) :: hdferr
         integer(size_t), intent(in), optional :: size_hint
         integer(hid_t), intent(in), optional :: lcpl_id, gcpl_id, gapl_id
      end subroutine h5gcreate_f

      subroutine h5gclose_f(grp_id, hdferr)
         import :: hid_t
         integer(hid_t), intent(in) :: grp_id
         integer, intent(out) :: hdferr
      end subroutine h5gclose_f

      subroutine h5lcreate_hard_f(obj_loc_id, obj_name, link_loc_id, link_name, hdferr, lcpl_id, &
         lapl_id)
         import :: hid_t
         integer(hid_t), intent(in) :: obj_loc_id, link_loc_id
         character(*), intent(in) :: obj_name, link_name
         integer, intent(out) :: hdferr
         integer(hid_t), intent(in), optional :: lcpl_id, lapl_id
      end subroutine h5lcreate_hard_f

      subroutine h5oopen_f(loc_id, name, obj_id, hdferr, lapl_id)
         import :: hid_t
         integer(hid_t), intent(in) :: loc_id
         character(*), intent(in) :: name
         integer(hid_t), intent(out) :: obj_id
         integer, intent(out) :: hdferr
         integer(hid_t), intent(in), optional :: lapl_id
      end subroutine h5oopen_f

      subroutine h5oclose_f(object_id, hdferr)
         import :: hid_t
         integer(hid_t), intent(in) :: object_id
         integer, intent(out) :: hdferr
      end subroutine h5oclose_f

      subroutine h5aopen_f(obj_id, attr_name, attr_id, hdferr, aapl_id)
         import :: hid_t
         integer(hid_t), intent(in) :: obj_id
         character(*), intent(in) :: attr_name
         integer(hid_t), intent(out) :: attr_id
         integer, intent(out) :: hdferr
         integer(hid_t), intent(in), optional :: aapl_id
      end subroutine h5aopen_f

      subroutine h5acreate_f(loc_id, name, type_id, space_id, attr_id, hdferr, acpl_id, aapl_id)
         import :: hid_t
         integer(hid_t), intent(in) :: loc_id, type_id, space_id
         character(*), intent(in) :: name
         integer(hid_t), intent(out) :: attr_id
         integer, intent(out) :: hdferr
         integer(hid_t), intent(in), optional :: acpl_id, aapl_id
      end subroutine h5acreate_f

      subroutine h5aexists_f(obj_id, attr_name, attr_exists, hdferr)
         import :: hid_t
         integer(hid_t), intent(in) :: obj_id
         character(*), intent(in) :: attr_name
         logical, intent(out) :: attr_exists
         integer, intent(out) :: hdferr
      end subroutine h5aexists_f

      subroutine h5awrite_f(attr_id, mem_type_id, buf, hdferr)
         import :: c_ptr, hid_t
         integer(hid_t), intent(in) :: attr_id, mem_type_id
         type(c_ptr), intent(in), target :: buf
         integer, intent(out) :: hdferr
      end subroutine h5awrite_f

      subroutine h5aclose_f(attr_id, hdferr)
         import :: hid_t
         integer(hid_t), intent(in) :: attr_id
         integer, intent(out) :: hdferr
      end subroutine h5aclose_f

      subroutine h5screate_f(classtype, space_id, hdferr)
         import :: hid_t
         integer, intent(in) :: classtype
         integer(hid_t), intent(out) :: space_id
         integer, intent(out) :: hdferr
      end subroutine h5screate_f

      subroutine h5screate_simple_f(rank, dims, space_id, hdferr, maxdims)
         import :: hid_t, hsize_t
         integer, intent(in) :: rank
         integer(hsize_t), intent(in) :: dims(*)
         integer(hid_t), intent(out) :: space_id
         integer, intent(out) :: hdferr
         integer(hsize_t), intent(in), optional :: maxdims(*)
      end subroutine h5screate_simple_f

      subroutine h5sclose_f(space_id, hdferr)
         import :: hid_t
         integer(hid_t), intent(in) :: space_id
         integer, intent(out) :: hdferr
      end subroutine h5sclose_f

      subroutine h5sselect_hyperslab_f(space_id, operator, start, count, hdferr, stride, block)
         import :: hid_t, hsize_t
         integer(hid_t), intent(in) :: space_id
         integer, intent(in) :: operator
         integer(hsize_t), intent(in) :: start(*), count(*)
         integer, intent(out) :: hdferr
         integer(hsize_t), intent(in), optional :: stride(:), block(:)
      end subroutine h5sselect_hyperslab_f

      subroutine h5dcreate_f(loc_id, name, type_id, space_id, dset_id, hdferr, dcpl_id, lcpl_id, &
         dapl_id)
         import :: hid_t
         integer(hid_t), intent(in) :: loc_id, type_id, space_id
         character(*), intent(in) :: name
         integer(hid_t), intent(out) :: dset_id
         integer, intent(out) :: hdferr
         integer(hid_t), intent(in), optional :: dcpl_id, lcpl_id, dapl_id
      end subroutine h5dcreate_f

      subroutine h5dopen_f(loc_id, name, dset_id, hdferr, dapl_id)
         import :: hid_t
         integer(hid_t), intent(in) :: loc_id
         character(*), intent(in) :: name
         integer(hid_t), intent(out) :: dset_id
         integer, intent(out) :: hdferr
         integer(hid_t), intent(in), optional :: dapl_id
      end subroutine h5dopen_f

      subroutine h5dclose_f(dset_id, hdferr)
         import :: hid_t
         integer(hid_t), intent(in) :: dset_id
         integer, intent(out) :: hdferr
      end subroutine h5dclose_f

      subroutine h5dset_extent_f(dataset_id, size, hdferr)
         import :: hid_t, hsize_t
         integer(hid_t), intent(in) :: dataset_id
         integer(hsize_t), intent(in) :: size(*)
         integer, intent(out) :: hdferr
      end subroutine h5dset_extent_f

      subroutine h5dget_space_f(dataset_id, dataspace_id, hdferr)
         import :: hid_t
         integer(hid_t), intent(in) :: dataset_id
         integer(hid_t), intent(out) :: dataspace_id
         integer, intent(out) :: hdferr
      end subroutine h5dget_space_f

      subroutine h5dwrite_f(dset_id, mem_type_id, buf, hdferr, mem_space_id, file_space_id, &
         xfer_prp)
         import :: c_ptr, hid_t
         integer(hid_t), intent(in) :: dset_id, mem_type_id
         type(c_ptr), intent(in), target :: buf
         integer, intent(out) :: hdferr
         integer(hid_t), intent(in), optional :: mem_space_id, file_space_id, xfer_prp
      end subroutine h5dwrite_f

      subroutine h5tcopy_f(type_id, new_type_id, hdferr)
         import :: hid_t
         integer(hid_t), intent(in) :: type_id
         integer(hid_t), intent(out) :: new_type_id
         integer, intent(out) :: hdferr
      end subroutine h5tcopy_f

      subroutine h5tclose_f(type_id, hdferr)
         import :: hid_t
         integer(hid_t), intent(in) :: type_id
         integer, intent(out) :: hdferr
      end subroutine h5tclose_f

      subroutine h5tset_cset_f(type_id, cset, hdferr)
         import :: hid_t
         integer(hid_t), intent(in) :: type_id
         integer, intent(in) :: cset
         integer, intent(out) :: hdferr
      end subroutine h5tset_cset_f

      subroutine h5tset_size_f(type_id, size, hdferr)
         import :: hid_t, size_t
         integer(hid_t), intent(in) :: type_id
         integer(size_t), intent(in) :: size
         integer, intent(out) :: hdferr
      end subroutine h5tset_size_f

      subroutine h5lexists_f(loc_id, name, link_exists, hdferr, lapl_id)
         import :: hid_t
         integer(hid_t), intent(in) :: loc_id
         character(*), intent(in) :: name
         logical, intent(out) :: link_exists
         integer, intent(out) :: hdferr
         integer(hid_t), intent(in), optional :: lapl_id
      end subroutine h5lexists_f

      subroutine h5gn_members_f(loc_id, name, nmembers, hdferr)
         import :: hid_t
         integer(hid_t), intent(in) :: loc_id
         character(*), intent(in) :: name
         integer, intent(out) :: nmembers, hdferr
      end subroutine h5gn_members_f

      subroutine h5gget_obj_info_idx_f(loc_id, name, idx, obj_name, obj_type, hdferr)
         import :: hid_t
         integer(hid_t), intent(in) :: loc_id
         character(*), intent(in) :: name
         integer, intent(in) :: idx
         character(1024), intent(out) :: obj_name
         integer, intent(out) :: obj_type, hdferr
      end subroutine h5gget_obj_info_idx_f

      subroutine h5ldelete_f(loc_id, name, hdferr, lapl_id)
         import :: hid_t
         integer(hid_t), intent(in) :: loc_id
         character(*), intent(in) :: name
         integer, intent(out) :: hdferr
         integer(hid_t), intent(in), optional :: lapl_id
      end subroutine h5ldelete_f

      subroutine h5sget_simple_extent_dims_f(space_id, dims, maxdims, hdferr)
         import :: hid_t, hsize_t
         integer(hid_t), intent(in) :: space_id
         integer(hsize_t), intent(out) :: dims(*), maxdims(*)
         integer, intent(out) :: hdferr
      end subroutine h5sget_simple_extent_dims_f

      subroutine h5dread_f(dset_id, mem_type_id, buf, hdferr, mem_space_id, file_space_id, xfer_prp)
         import :: c_ptr, hid_t
         integer(hid_t), intent(in) :: dset_id, mem_type_id
         type(c_ptr), intent(inout) :: buf
         integer, intent(out) :: hdferr
         integer(hid_t), intent(in), optional :: mem_space_id, file_space_id, xfer_prp
      end subroutine h5dread_f

      subroutine h5aread_f(attr_id, memtype_id, buf, hdferr)
         import :: c_ptr, hid_t
         integer(hid_t), intent(in) :: attr_id, memtype_id
         type(c_ptr), intent(inout) :: buf
         integer, intent(out) :: hdferr
      end subroutine h5aread_f
   end interface
end module hdf5
