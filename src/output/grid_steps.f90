!> Group `/VTKHDF/Steps` of a grid that does not move: the times of its rows, and where the data of
!> each begin. What is the same has one dataset and several names.
module grid_steps
   use errors, only: error_type
   use growing_datasets, only: growing_dataset, growing_dataset_type
   use hdf5, only: hid_t
   use hdf5_attributes, only: write_attribute
   use hdf5_helpers, only: as_long, as_real, create_group, link_dataset
   use kinds, only: dp
   use result_mesh, only: steps_group
   implicit none
   private
   public :: grid_steps_type

   integer, parameter :: at_values = 1, at_zero = 2, at_zero_column = 3, at_one = 4, at_offset = 5
   integer, parameter :: at_cell_offset = 6
   character(*), parameter :: zeros = steps_group//'PartOffsets'
   character(*), parameter :: point_offsets = steps_group//'PointDataOffsets/'
   character(*), parameter :: cell_offsets = steps_group//'CellDataOffsets/'

   !> Times of one grid.
   type :: grid_steps_type
      private
      type(growing_dataset_type), allocatable, public :: sets(:)   !! what grows
      character(:), allocatable :: point_set   !! whose offsets are written; others are links
      character(:), allocatable :: cell_set    !! the same of cell data; empty: none
      integer :: increments = 0                !! rows so far
   contains
      procedure :: start
      procedure :: append
      procedure, nopass :: create_groups
      procedure :: write_links
      procedure :: write_count
   end type grid_steps_type

contains

   !> Prepares the datasets.
   pure subroutine start(self, point_set, cell_set, expected)
      class(grid_steps_type), intent(inout) :: self
      character(*), intent(in) :: point_set          !! one of the point data that grow
      character(*), intent(in) :: cell_set           !! one of the cell data that grow; empty: none
      integer, intent(in) :: expected                !! rows that are expected

      self%point_set = point_set
      self%cell_set = cell_set
      allocate (self%sets(merge(at_offset, at_cell_offset, cell_set == '')))
      self%sets(at_values) = growing_dataset(steps_group//'Values', as_real, 0, 1, expected)
      call self%sets(at_values)%describe_as('total time', 'time', '')
      self%sets(at_zero) = growing_dataset(zeros, as_long, 0, 1, expected)
      self%sets(at_zero_column) = growing_dataset(steps_group//'CellOffsets', as_long, 1, 1, &
         expected)
      self%sets(at_one) = growing_dataset(steps_group//'NumberOfParts', as_long, 0, 1, expected)
      call self%sets(at_zero)%describe_as('offset 0: the mesh does not change', '-', '')
      call self%sets(at_zero_column)%describe_as('offset 0: the mesh does not change', '-', '')
      call self%sets(at_one)%describe_as('parts of the grid', '-', '')
      self%sets(at_offset) = growing_dataset(point_offsets//point_set, as_long, 0, 1, expected)
      call self%sets(at_offset)%describe_as('first row of the point data of the time', '-', '')
      if (cell_set == '') return
      self%sets(at_cell_offset) = growing_dataset(cell_offsets//cell_set, as_long, 0, 1, expected)
      call self%sets(at_cell_offset)%describe_as('first row of the cell data of the time', '-', '')
   end subroutine start

   !> Adds a row.
   pure subroutine append(self, time, points, cells)
      class(grid_steps_type), intent(inout) :: self
      real(dp), intent(in) :: time                   !! total time [time]
      integer, intent(in) :: points, cells           !! of the grid

      call self%sets(at_values)%append([time])
      call self%sets(at_zero)%append([0.0_dp])
      call self%sets(at_zero_column)%append([0.0_dp])
      call self%sets(at_one)%append([1.0_dp])
      call self%sets(at_offset)%append([real(self%increments, dp)*points])
      if (self%cell_set /= '') call self%sets(at_cell_offset)%append( &
         [real(self%increments, dp)*cells])
      self%increments = self%increments + 1
   end subroutine append

   !> Creates the groups that the datasets go into.
   !> Error: status_internal, when HDF5 refuses.
   subroutine create_groups(file, error)
      integer(hid_t), intent(in) :: file                  !! the open file
      type(error_type), allocatable, intent(out) :: error !! what went wrong

      call create_group(file, steps_group, error)
      if (allocated(error)) return
      call create_group(file, point_offsets, error)
      if (allocated(error)) return
      call create_group(file, cell_offsets, error)
   end subroutine create_groups

   !> Gives the offsets all their names, once their datasets are in the file.
   !> Error: status_internal, when HDF5 refuses.
   subroutine write_links(self, file, point_sets, cell_sets, error)
      class(grid_steps_type), intent(in) :: self
      integer(hid_t), intent(in) :: file                  !! the open file
      !> Names of all point data and of all cell data that grow; of those that do not with a blank
      !> before them
      character(*), intent(in) :: point_sets(:), cell_sets(:)
      type(error_type), allocatable, intent(out) :: error !! what went wrong

      call link_dataset(file, zeros, steps_group//'PointOffsets', error)
      if (allocated(error)) return
      call link_dataset(file, steps_group//'CellOffsets', steps_group//'ConnectivityIdOffsets', &
         error)
      if (allocated(error)) return
      call link_all(file, point_offsets, self%point_set, point_sets, error)
      if (allocated(error)) return
      call link_all(file, cell_offsets, self%cell_set, cell_sets, error)
   end subroutine write_links

   subroutine link_all(file, group, written, names, error)
      integer(hid_t), intent(in) :: file
      character(*), intent(in) :: group, written, names(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(names)
         if (names(i) == written) cycle
         if (names(i)(:1) == ' ') then
            call link_dataset(file, zeros, group//trim(adjustl(names(i))), error)
         else
            call link_dataset(file, group//written, group//trim(names(i)), error)
         end if
         if (allocated(error)) return
      end do
   end subroutine link_all

   !> Writes the number of rows that the file holds.
   !> Error: status_internal, when HDF5 refuses.
   subroutine write_count(self, file, error)
      class(grid_steps_type), intent(in) :: self
      integer(hid_t), intent(in) :: file                  !! the open file
      type(error_type), allocatable, intent(out) :: error !! what went wrong

      call write_attribute(file, steps_group, 'NSteps', self%increments, error)
   end subroutine write_count

end module grid_steps
