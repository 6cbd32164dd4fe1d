!> Group `/VTKHDF` of a grid that does not move: points and cells in one part, stored once, and the
!> times of its rows, group `Steps`. Layout: VTKHDF 2.0, UnstructuredGrid. Datasets with the same
!> contents are one with several names.
module vtk_grids
   use element_kinds, only: element_node_count, kind_count
   use growing_datasets, only: flush_sets, growing_dataset, growing_dataset_type
   use hdf5_writer, only: as_byte, as_integer, as_long, as_real, hdf5_writer_type
   use kinds, only: dp
   use model, only: model_type, unit_labels_type
   use unit_labels, only: unit_in_words
   implicit none
   private
   public :: grid_steps_type, write_result_mesh, write_grid
   public :: point_group, cell_group, cell_data_names

   character(*), parameter :: grid_group = '/VTKHDF'                    !! the grid
   character(*), parameter :: point_group = '/VTKHDF/PointData/'        !! data of points
   character(*), parameter :: cell_group = '/VTKHDF/CellData/'          !! data of cells
   character(*), parameter :: steps_group = '/VTKHDF/Steps/'            !! data of time

   !> Cell data that does not vary.
   character(10), parameter :: cell_data_names(3) = [character(10) :: &
      'element_id', 'body', 'material']

   !> VTK's cell types of quad8, quad8_reduced, quad4, triangle6 and triangle3. Its corners and
   !> midside nodes are in our order.
   integer, parameter :: vtk_types(kind_count) = [23, 23, 9, 22, 5]

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
      procedure :: flush => flush_steps
      procedure :: write_links
   end type grid_steps_type

contains

   !> Creates the groups of `/VTKHDF` and writes the mesh with `node_id`, `element_id`, `body` and
   !> `material`.
   subroutine write_result_mesh(file, model, point_node, element_points)
      type(hdf5_writer_type), intent(inout) :: file       !! the open file
      type(model_type), intent(in) :: model
      integer, intent(in) :: point_node(:)                !! (points) node index of each point
      integer, intent(in) :: element_points(:, :)         !! (8, elements) points, like the nodes
      real(dp), allocatable :: points(:, :)
      integer, allocatable :: cell_points(:), offsets(:)

      allocate (points(3, size(point_node)), source=0.0_dp)
      points(:2, :) = model%mesh%coordinates(:, point_node)
      call find_cells(model%mesh%element_kind, element_points, cell_points, offsets)
      call write_grid(file, points, cell_points, offsets, vtk_types(model%mesh%element_kind), &
         model%units)
      call file%create_group(point_group)
      call file%write(point_group//'node_id', model%mesh%node_number(point_node), as_integer, &
         'number of the node in the deck')
      call file%create_group(cell_group)
      call file%write(cell_group//'element_id', model%mesh%element_number, as_integer, &
         'number of the element in the deck')
      call file%write(cell_group//'body', model%mesh%element_body, as_integer, &
         'number of the body, from 1')
      call file%write(cell_group//'material', model%sections(model%mesh%element_section)%material, &
         as_integer, 'number of the *MATERIAL in the deck, from 1')
   end subroutine write_result_mesh

   !> Points of the cells one behind the other, and where those of each begin.
   pure subroutine find_cells(kinds, element_points, cell_points, offsets)
      integer, intent(in) :: kinds(:), element_points(:, :)
      integer, allocatable, intent(out) :: cell_points(:), offsets(:)
      integer :: e

      allocate (cell_points(sum(element_node_count(kinds))), offsets(0:size(kinds)))
      offsets(0) = 0
      do e = 1, size(kinds)
         offsets(e) = offsets(e - 1) + element_node_count(kinds(e))
         cell_points(offsets(e - 1) + 1:offsets(e)) = element_points(: &
            element_node_count(kinds(e)), e)
      end do
   end subroutine find_cells

   !> Creates the group of a grid in one part and writes its points and cells.
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
   end subroutine write_grid

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

   !> Creates the groups of the datasets.
   subroutine create_groups(file)
      type(hdf5_writer_type), intent(inout) :: file       !! the open file

      call file%create_group(steps_group)
      call file%create_group(point_offsets)
      call file%create_group(cell_offsets)
   end subroutine create_groups

   !> Writes the waiting rows, and the number of all.
   subroutine flush_steps(self, file)
      class(grid_steps_type), intent(inout) :: self
      type(hdf5_writer_type), intent(inout) :: file       !! the open file, with the groups

      call flush_sets(self%sets, file)
      call file%set(steps_group, 'NSteps', self%increments)
   end subroutine flush_steps

   !> Gives the offsets all their names, once their datasets are in the file.
   subroutine write_links(self, file, point_sets, cell_sets)
      class(grid_steps_type), intent(in) :: self
      type(hdf5_writer_type), intent(inout) :: file       !! the open file
      !> Names of all point data and of all cell data that grow; of those that do not with a blank
      !> before them
      character(*), intent(in) :: point_sets(:), cell_sets(:)

      call file%link(zeros, steps_group//'PointOffsets')
      call file%link(steps_group//'CellOffsets', steps_group//'ConnectivityIdOffsets')
      call link_all(file, point_offsets, self%point_set, point_sets)
      call link_all(file, cell_offsets, self%cell_set, cell_sets)
   end subroutine write_links

   subroutine link_all(file, group, written, names)
      type(hdf5_writer_type), intent(inout) :: file
      character(*), intent(in) :: group, written, names(:)
      integer :: i

      do i = 1, size(names)
         if (names(i) == written) cycle
         if (names(i)(:1) == ' ') then
            call file%link(zeros, group//trim(adjustl(names(i))))
         else
            call file%link(group//written, group//trim(names(i)))
         end if
      end do
   end subroutine link_all

end module vtk_grids
