!> The part of group `/VTKHDF` that does not vary: the mesh and its numbers, in one part, stored
!> once. Layout: VTKHDF 2.0, UnstructuredGrid.
module result_mesh
   use element_kinds, only: element_node_count, kind_count
   use errors, only: error_type
   use hdf5, only: hid_t
   use hdf5_attributes, only: describe, write_attribute, write_fixed_text
   use hdf5_helpers, only: as_byte, as_integer, as_long, create_group, write_array
   use kinds, only: dp
   use model, only: model_type, unit_labels_type
   use unit_labels, only: unit_in_words
   implicit none
   private
   public :: write_result_mesh, write_grid
   public :: point_group, cell_group, steps_group, cell_data_names

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

   !> What the datasets of any grid are, and those of the mesh.
   character(56), parameter :: grid_descriptions(2, 6) = reshape([character(56) :: &
      'NumberOfPoints', 'points', 'NumberOfCells', 'cells', &
      'NumberOfConnectivityIds', 'entries of Connectivity', &
      'Connectivity', 'points of every cell, from 0', &
      'Offsets', 'first entry of every cell in Connectivity', &
      'Types', 'VTK cell types: 3 line, 5, 22 triangle, 9, 23 four-sided'], [2, 6])
   character(56), parameter :: mesh_descriptions(2, 4) = reshape([character(56) :: &
      'PointData/node_id', 'number of the node in the deck', &
      'CellData/element_id', 'number of the element in the deck', &
      'CellData/body', 'number of the body, from 1', &
      'CellData/material', 'number of the *MATERIAL in the deck, from 1'], [2, 4])

contains

   !> Creates the groups of `/VTKHDF` and writes the mesh with `node_id`, `element_id`, `body` and
   !> `material`.
   !> Error: status_internal, when HDF5 refuses.
   subroutine write_result_mesh(file, model, point_node, element_points, error)
      integer(hid_t), intent(in) :: file                  !! the open file
      type(model_type), intent(in) :: model
      integer, intent(in) :: point_node(:)                !! (points) node index of each point
      integer, intent(in) :: element_points(:, :)         !! (8, elements) points, like the nodes
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      real(dp), allocatable :: points(:, :)
      integer, allocatable :: cell_points(:), offsets(:)

      allocate (points(3, size(point_node)), source=0.0_dp)
      points(:2, :) = model%mesh%coordinates(:, point_node)
      call find_cells(model%mesh%element_kind, element_points, cell_points, offsets)
      call write_grid(file, points, cell_points, offsets, vtk_types(model%mesh%element_kind), &
         model%units, error)
      if (allocated(error)) return
      call write_point_data(file, model, point_node, error)
      if (allocated(error)) return
      call write_cell_data(file, model, error)
      if (allocated(error)) return
      call describe_all(file, mesh_descriptions, error)
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
   !> Error: status_internal, when HDF5 refuses.
   subroutine write_grid(file, points, cell_points, offsets, types, labels, error)
      integer(hid_t), intent(in) :: file                  !! the open file
      real(dp), intent(in) :: points(:, :)                !! (3, points) [length]
      integer, intent(in) :: cell_points(:)               !! points of each cell, from 1
      integer, intent(in) :: offsets(:)                   !! (cells + 1) from 0
      integer, intent(in) :: types(:)                     !! (cells) VTK's
      type(unit_labels_type), intent(in) :: labels        !! units of the deck
      type(error_type), allocatable, intent(out) :: error !! what went wrong

      call create_group(file, grid_group, error)
      if (allocated(error)) return
      call write_fixed_text(file, grid_group, 'Type', 'UnstructuredGrid', error)
      if (allocated(error)) return
      call write_attribute(file, grid_group, 'Version', [2, 0], error)
      if (allocated(error)) return
      call write_array(file, grid_group//'/NumberOfPoints', [size(points, 2)], as_long, error)
      if (allocated(error)) return
      call write_array(file, grid_group//'/NumberOfCells', [size(types)], as_long, error)
      if (allocated(error)) return
      call write_array(file, grid_group//'/NumberOfConnectivityIds', [size(cell_points)], as_long, &
         error)
      if (allocated(error)) return
      ! VTK counts from 0.
      call write_array(file, grid_group//'/Connectivity', cell_points - 1, as_long, error)
      if (allocated(error)) return
      call write_array(file, grid_group//'/Offsets', offsets, as_long, error)
      if (allocated(error)) return
      call write_array(file, grid_group//'/Types', types, as_byte, error)
      if (allocated(error)) return
      call write_array(file, grid_group//'/Points', points, error)
      if (allocated(error)) return
      call describe_all(file, grid_descriptions, error)
      if (allocated(error)) return
      call describe(file, grid_group//'/Points', 'coordinates before deformation', &
         unit_in_words('length', labels), error)
   end subroutine write_grid

   !> Says what some datasets of the grid are.
   subroutine describe_all(file, descriptions, error)
      integer(hid_t), intent(in) :: file
      character(*), intent(in) :: descriptions(:, :)      ! (2, datasets) name, what it is
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(descriptions, 2)
         call describe(file, grid_group//'/'//trim(descriptions(1, i)), descriptions(2, i), '-', &
            error)
         if (allocated(error)) return
      end do
   end subroutine describe_all

   subroutine write_point_data(file, model, point_node, error)
      integer(hid_t), intent(in) :: file
      type(model_type), intent(in) :: model
      integer, intent(in) :: point_node(:)
      type(error_type), allocatable, intent(out) :: error

      call create_group(file, point_group, error)
      if (allocated(error)) return
      call write_array(file, point_group//'node_id', model%mesh%node_number(point_node), &
         as_integer, error)
   end subroutine write_point_data

   subroutine write_cell_data(file, model, error)
      integer(hid_t), intent(in) :: file
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      call create_group(file, cell_group, error)
      if (allocated(error)) return
      call write_array(file, cell_group//'element_id', model%mesh%element_number, as_integer, error)
      if (allocated(error)) return
      call write_array(file, cell_group//'body', model%mesh%element_body, as_integer, error)
      if (allocated(error)) return
      call write_array(file, cell_group//'material', &
         model%sections(model%mesh%element_section)%material, as_integer, error)
   end subroutine write_cell_data

end module result_mesh
