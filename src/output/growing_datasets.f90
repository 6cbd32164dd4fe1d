!> Datasets of numbers. They grow row by row: rows gather in memory as reals and go to the file, in
!> the type that it stores, as one block.
module growing_datasets
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_c_binding, only: c_loc
   use hdf5, only: h5dclose_f, h5dcreate_f, h5dget_space_f, h5dopen_f, h5dset_extent_f, &
      h5dwrite_f, h5pset_chunk_f, h5s_select_set_f, h5s_unlimited_f, h5sclose_f, &
      h5screate_simple_f, h5sselect_hyperslab_f, h5t_native_double, hid_t, hsize_t
   use hdf5_writer, only: as_integer, as_real, hdf5_writer_type, stored_type
   use kinds, only: dp, long
   use quantity_types, only: of_bodies, of_contact_points, of_motions, quantity_type
   implicit none
   private
   public :: growing_dataset_type, growing_dataset, quantity_dataset, bytes_in, flush_sets, &
      write_integers, write_once

   integer, parameter :: chunk_bytes = 32768   !! bytes of a chunk, unless one append is larger

   !> One dataset and the rows of it that are not in the file yet.
   type :: growing_dataset_type
      private
      character(:), allocatable :: path                            !! path in the file
      character(:), allocatable :: description, unit   !! attributes of the dataset
      character(:), allocatable, public :: components  !! likewise
      integer :: storage = 0                    !! as_real, as_integer or as_long
      integer :: width = 0                      !! values in a row; 0: rows are single numbers
      integer :: at_once = 0                    !! values of one append
      integer(hsize_t) :: chunk_rows = 1        !! rows in a chunk
      logical :: in_file = .false.              !! whether the file has the dataset
      integer(hsize_t) :: rows_in_file = 0      !! rows that the file holds, or is to keep
      logical :: is_cut = .false.               !! whether it holds more of them still
      integer :: used = 0                       !! values in the buffer
      real(dp), allocatable :: buffer(:)        !! the rows that are not in the file yet
   contains
      procedure :: append
      procedure :: rows
      procedure :: cut
      procedure :: go_on
      procedure :: flush => flush_rows
   end type growing_dataset_type

contains

   !> A dataset without rows; the file gets it at the first flush.
   pure function growing_dataset(path, storage, width, rows_at_once, times, description, unit) &
      result(dataset)
      character(*), intent(in) :: path     !! path in the file
      integer, intent(in) :: storage       !! as_real, as_integer or as_long
      integer, intent(in) :: width         !! values in a row; 0: shape (rows), else (rows, width)
      integer, intent(in) :: rows_at_once  !! rows of one append
      integer, intent(in) :: times         !! appends that are expected
      character(*), intent(in), optional :: description   !! what it is
      character(*), intent(in), optional :: unit          !! '-' for a pure number, as without it
      type(growing_dataset_type) :: dataset
      integer(long) :: appends

      dataset%path = path
      dataset%description = ''
      dataset%unit = '-'
      dataset%components = ''
      if (present(description)) dataset%description = description
      if (present(unit)) dataset%unit = unit
      dataset%storage = storage
      dataset%width = width
      dataset%at_once = max(width, 1)*rows_at_once
      appends = max(1_long, min(chunk_bytes/(8_long*dataset%at_once), int(times, long)))
      dataset%chunk_rows = appends*rows_at_once
      allocate(dataset%buffer(dataset%at_once))
   end function growing_dataset

   !> A dataset of a quantity, described by its entry; one column for each place where the quantity
   !> is of bodies or contact points and places are given.
   pure function quantity_dataset(group, quantity, rows_at_once, times, places) result(dataset)
      character(*), intent(in) :: group             !! path of its group, with a slash at the end
      type(quantity_type), intent(in) :: quantity
      integer, intent(in) :: rows_at_once, times    !! as for growing_dataset
      integer, intent(in), optional :: places       !! bodies or contact points
      type(growing_dataset_type) :: dataset
      integer :: width

      width = merge(quantity%values, 0, quantity%values > 1 .or. quantity%kind == of_motions)
      if (present(places)) then
         if (any(quantity%kind == [of_bodies, of_contact_points])) width = places
      end if
      dataset = growing_dataset(group//trim(quantity%name), merge(as_integer, as_real, &
         quantity%is_integer), width, rows_at_once, times, quantity%description, quantity%unit)
      dataset%components = quantity%components
   end function quantity_dataset

   !> Adds rows; NaN, of integers 0, for those of one append where there are no values.
   pure subroutine append(self, values)
      class(growing_dataset_type), intent(inout) :: self
      real(dp), intent(in) :: values(:)                   !! rows, one after the other
      real(dp), allocatable :: larger(:)
      integer :: last

      last = self%used + size(values)
      if (size(values) == 0) last = self%used + self%at_once
      if (last > size(self%buffer)) then
         allocate(larger(2*last))
         larger(:self%used) = self%buffer(:self%used)
         call move_alloc(larger, self%buffer)
      end if
      if (size(values) == 0) then
         self%buffer(self%used + 1:last) = merge(ieee_value(1.0_dp, ieee_quiet_nan), 0.0_dp, &
            self%storage == as_real)
      else
         self%buffer(self%used + 1:last) = values
      end if
      self%used = last
   end subroutine append

   !> Rows so far.
   pure integer function rows(self)
      class(growing_dataset_type), intent(in) :: self

      rows = int(self%rows_in_file) + self%used/max(self%width, 1)
   end function rows

   !> Drops the rows behind the first ones.
   pure subroutine cut(self, rows)
      class(growing_dataset_type), intent(inout) :: self
      integer, intent(in) :: rows                            !! that are left

      self%used = max(rows - int(self%rows_in_file), 0)*max(self%width, 1)
      self%is_cut = self%is_cut .or. rows < self%rows_in_file
      self%rows_in_file = min(self%rows_in_file, int(rows, hsize_t))
   end subroutine cut

   !> Goes on behind the first rows of an earlier file; where it has none of this dataset they are
   !> NaN.
   subroutine go_on(self, file, rows)
      class(growing_dataset_type), intent(inout) :: self     !! without rows
      type(hdf5_writer_type), intent(inout) :: file          !! the open file
      integer, intent(in) :: rows                            !! of it that are kept
      integer :: i

      self%in_file = file%has(self%path)
      if (self%in_file) then
         self%rows_in_file = rows
         self%is_cut = .true.
      else
         do i = 1, rows*max(self%width, 1)/self%at_once
            call self%append([real(dp) ::])
         end do
      end if
   end subroutine go_on

   !> Writes a dataset that does not grow.
   subroutine write_once(file, dataset, values)
      type(hdf5_writer_type), intent(inout) :: file        !! the open file
      type(growing_dataset_type), intent(in) :: dataset    !! without rows
      real(dp), intent(in) :: values(:)                    !! rows, one after the other
      type(growing_dataset_type) :: whole

      whole = dataset
      whole%chunk_rows = max(1, size(values)/max(whole%width, 1))
      if (size(values) > 0) call whole%append(values)
      call whole%flush(file)
   end subroutine write_once

   !> The same of integers, numbers without a unit.
   subroutine write_integers(file, path, values, storage, description)
      type(hdf5_writer_type), intent(inout) :: file        !! the open file
      character(*), intent(in) :: path
      integer, intent(in) :: values(:)
      integer, intent(in) :: storage                       !! as_integer, as_long or as_byte
      character(*), intent(in) :: description

      call write_once(file, growing_dataset(path, storage, 0, 1, 1, description), real(values, dp))
   end subroutine write_integers

   !> Bytes that wait in memory.
   pure function bytes_in(datasets) result(bytes)
      type(growing_dataset_type), intent(in) :: datasets(:)
      integer(long) :: bytes                                 !! bytes of their rows in memory

      bytes = 8_long*sum(int(datasets%used, long))
   end function bytes_in

   !> Writes the waiting rows of all datasets.
   subroutine flush_sets(datasets, file)
      type(growing_dataset_type), intent(inout) :: datasets(:)
      type(hdf5_writer_type), intent(inout) :: file            !! the open file
      integer :: i

      do i = 1, size(datasets)
         call datasets(i)%flush(file)
      end do
   end subroutine flush_sets

   !> Writes the waiting rows behind those in the file; creates the dataset the first time.
   subroutine flush_rows(self, file)
      class(growing_dataset_type), target, intent(inout) :: self
      type(hdf5_writer_type), intent(inout) :: file              !! the open file
      integer(hsize_t) :: chunk(2), largest(2), offset(2), extent(2), whole(2)
      integer(hid_t) :: dataset, memory, space
      integer :: rank, status(9)

      if (allocated(file%error)) return
      if (self%used == 0 .and. self%in_file .and. .not. self%is_cut) return
      status = 0
      rank = merge(1, 2, self%width == 0)
      extent = int([max(self%width, 1), self%used/max(self%width, 1)], hsize_t)
      offset = [0_hsize_t, self%rows_in_file]
      whole = [extent(1), offset(2) + extent(2)]
      if (.not. self%in_file) then
         chunk = [whole(1), self%chunk_rows]
         largest = [whole(1), h5s_unlimited_f]
         call h5pset_chunk_f(file%creation, rank, chunk(3 - rank:), status(1))
         call h5screate_simple_f(rank, whole(3 - rank:), space, status(2), largest(3 - rank:))
         call h5dcreate_f(file%id, self%path, stored_type(self%storage), space, dataset, &
            status(3), file%creation)
         call h5sclose_f(space, status(4))
         status(1) = minval(status(:4))
      else
         call h5dopen_f(file%id, self%path, dataset, status(1))
         call h5dset_extent_f(dataset, whole(3 - rank:), status(2))
      end if
      if (extent(2) > 0) then
         call h5dget_space_f(dataset, space, status(3))
         call h5sselect_hyperslab_f(space, h5s_select_set_f, offset(3 - rank:), &
            extent(3 - rank:), status(4))
         call h5screate_simple_f(rank, extent(3 - rank:), memory, status(5))
         call h5dwrite_f(dataset, h5t_native_double, c_loc(self%buffer), status(6), memory, space, &
            file%transfer)
         call h5sclose_f(memory, status(7))
         call h5sclose_f(space, status(8))
      end if
      call file%note(status, 'cannot write dataset '//self%path)
      if (.not. self%in_file) call file%describe(dataset, self%path, self%description, self%unit, &
         self%components)
      if (status(1) >= 0) call h5dclose_f(dataset, status(9))
      call file%note(status, 'cannot write dataset '//self%path)
      self%in_file = .true.
      self%is_cut = .false.
      self%rows_in_file = whole(2)
      self%used = 0
   end subroutine flush_rows

end module growing_datasets
