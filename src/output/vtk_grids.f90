!> Group `/VTKHDF` of a grid that does not move: points and cells in one part, stored once, with the
!> point and cell data of every increment and the times of these, group `Steps`. Layout: VTKHDF 2.0,
!> UnstructuredGrid. Datasets with the same contents are one with several names.
module vtk_grids
   use growing_datasets, only: flush_sets, growing_dataset, growing_dataset_type, quantity_dataset
   use hdf5_writer, only: as_byte, as_long, as_real, hdf5_writer_type
   use kinds, only: dp
   use model, only: unit_labels_type
   use quantity_types, only: quantity_type
   use unit_labels, only: unit_in_words
   implicit none
   private
   public :: vtk_grid_type, write_grid, point_group, cell_group

   character(*), parameter :: grid_group = '/VTKHDF'                    !! the grid
   character(*), parameter :: point_group = '/VTKHDF/PointData/'        !! data of points
   character(*), parameter :: cell_group = '/VTKHDF/CellData/'          !! data of cells
   character(*), parameter :: steps_group = '/VTKHDF/Steps/'            !! data of time
   character(*), parameter :: zeros = steps_group//'PartOffsets'
   character(*), parameter :: point_offsets = steps_group//'PointDataOffsets/'
   character(*), parameter :: cell_offsets = steps_group//'CellDataOffsets/'

   !> Datasets of Steps, their rows as in `append_time`; to the last two belongs the name of the
   !> first point or cell data that grow.
   character(*), parameter :: step_sets(6) = [character(len(point_offsets)) :: &
      steps_group//'Values', zeros, steps_group//'CellOffsets', steps_group//'NumberOfParts', &
      point_offsets, cell_offsets]
   character(*), parameter :: step_descriptions(6) = [character(41) :: 'total time', &
      'offset 0: the mesh does not change', 'offset 0: the mesh does not change', &
      'parts of the grid', 'first row of the point data of the time', &
      'first row of the cell data of the time']
   integer, parameter :: step_widths(6) = [0, 0, 1, 0, 0, 0]

   !> What grows in a grid.
   type :: vtk_grid_type
      type(quantity_type), allocatable :: point_data(:)
      type(quantity_type), allocatable :: cell_data(:)
      !> Datasets, one for each of `point_data`, then one for each of `cell_data`
      type(growing_dataset_type), allocatable :: sets(:)
      integer :: points = 0                                        !! number of points
      integer :: cells = 0                                         !! number of cells
      integer, private :: increments = 0                           !! rows so far
      type(growing_dataset_type), allocatable, private :: steps(:) !! datasets of Steps
   contains
      procedure :: start_grid
      procedure :: append_time
      procedure :: flush_grid
   end type vtk_grid_type

contains

   !> Creates the groups of a grid in one part and writes its points and cells.
   subroutine write_grid(file, points, cell_points, offsets, types, labels)
      type(hdf5_writer_type), intent(inout) :: file       !! the open file
      real(dp), intent(in) :: points(:, :)                !! (3, points) [length]
      integer, intent(in) :: cell_points(:)               !! points of each cell, from 1
      integer, intent(in) :: offsets(:)                   !! (cells + 1) from 0
      integer, intent(in) :: types(:)                     !! (cells) VTK's
      type(unit_labels_type), intent(in) :: labels        !! units of the deck

      call file%create_group(grid_group)
      call file%set_fixed_text(grid_group, 'Type', 'UnstructuredGrid')
      call file%set(grid_group, 'Version', [2, 0])
      call file%write(grid_group//'/NumberOfPoints', [size(points, 2)], as_long, 'points')
      call file%write(grid_group//'/NumberOfCells', [size(types)], as_long, 'cells')
      call file%write(grid_group//'/NumberOfConnectivityIds', [size(cell_points)], as_long, &
         'entries of Connectivity')
      ! VTK counts from 0.
      call file%write(grid_group//'/Connectivity', cell_points - 1, as_long, &
         'points of every cell, from 0')
      call file%write(grid_group//'/Offsets', offsets, as_long, &
         'first entry of every cell in Connectivity')
      call file%write(grid_group//'/Types', types, as_byte, &
         'VTK cell types: 3 line, 5, 22 triangle, 9, 23 four-sided')
      call file%write(grid_group//'/Points', points, 'coordinates before deformation', &
         unit_in_words('length', labels))
      call file%create_group(point_group)
      call file%create_group(cell_group)
      call file%create_group(steps_group)
      call file%create_group(point_offsets)
      call file%create_group(cell_offsets)
   end subroutine write_grid

   !> Prepares the datasets.
   pure subroutine start_grid(self, point_data, cell_data, points, cells, expected, labels)
      class(vtk_grid_type), intent(inout) :: self
      type(quantity_type), intent(in) :: point_data(:)    !! those that grow, at least one
      type(quantity_type), intent(in) :: cell_data(:)     !! those that grow
      integer, intent(in) :: points, cells                !! of the grid
      integer, intent(in) :: expected                     !! increments that are expected
      type(unit_labels_type), intent(in) :: labels        !! units of the deck
      character(:), allocatable :: path
      integer :: i, n

      self%point_data = point_data
      self%cell_data = cell_data
      self%points = points
      self%cells = cells
      n = size(point_data)
      allocate(self%sets(n + size(cell_data)), self%steps(merge(6, 5, size(cell_data) > 0)))
      do i = 1, n
         self%sets(i) = quantity_dataset(point_group, point_data(i), labels, points, expected)
      end do
      do i = 1, size(cell_data)
         self%sets(n + i) = quantity_dataset(cell_group, cell_data(i), labels, cells, expected)
      end do
      do i = 1, size(self%steps)
         path = trim(step_sets(i))
         if (path == point_offsets) path = path//trim(point_data(1)%name)
         if (path == cell_offsets) path = path//trim(cell_data(1)%name)
         self%steps(i) = growing_dataset(path, merge(as_real, as_long, i == 1), step_widths(i), 1, &
            expected, step_descriptions(i), trim(merge('time', '-   ', i == 1)))
      end do
   end subroutine start_grid

   !> Adds the rows of an increment to Steps.
   pure subroutine append_time(self, time)
      class(vtk_grid_type), intent(inout) :: self
      real(dp), intent(in) :: time                        !! total time [time]
      real(dp) :: row(size(step_sets))
      integer :: i

      row = [time, 0.0_dp, 0.0_dp, 1.0_dp, real(self%increments, dp)*self%points, &
         real(self%increments, dp)*self%cells]
      do i = 1, size(self%steps)
         call self%steps(i)%append([row(i)])
      end do
      self%increments = self%increments + 1
   end subroutine append_time

   !> Writes the waiting rows and the number of all; the first time then gives the offsets of Steps
   !> all their names.
   subroutine flush_grid(self, file, is_new, fixed_points, fixed_cells)
      class(vtk_grid_type), intent(inout) :: self
      type(hdf5_writer_type), intent(inout) :: file       !! the open file, with its head
      logical, intent(in) :: is_new                       !! whether these are its first rows
      character(*), intent(in) :: fixed_points(:)         !! point data that do not grow
      character(*), intent(in) :: fixed_cells(:)          !! cell data that do not grow

      call flush_sets(self%sets, file)
      call flush_sets(self%steps, file)
      call file%set(steps_group, 'NSteps', self%increments)
      if (.not. is_new) return
      call file%link(zeros, steps_group//'PointOffsets')
      call file%link(steps_group//'CellOffsets', steps_group//'ConnectivityIdOffsets')
      call link_offsets(file, point_offsets, fixed_points, self%point_data%name)
      call link_offsets(file, cell_offsets, fixed_cells, self%cell_data%name)
   end subroutine flush_grid

   subroutine link_offsets(file, group, fixed, growing)
      type(hdf5_writer_type), intent(inout) :: file
      character(*), intent(in) :: group, fixed(:), growing(:)
      integer :: i

      do i = 1, size(fixed)
         call file%link(zeros, group//trim(fixed(i)))
      end do
      do i = 2, size(growing)
         call file%link(group//trim(growing(1)), group//trim(growing(i)))
      end do
   end subroutine link_offsets

end module vtk_grids
