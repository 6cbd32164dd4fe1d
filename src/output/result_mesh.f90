!> The part of group `/VTKHDF` that does not vary: the mesh and its numbers, in one part, stored
!> once. Layout: VTKHDF 2.0, UnstructuredGrid.
module result_mesh
   use element_kinds, only: element_node_count, kind_count
   use errors, only: error_type
   use hdf5, only: hid_t
   use hdf5_attributes, only: write_attribute, write_fixed_text
   use hdf5_helpers, only: as_byte, as_integer, as_long, create_group, write_array
   use kinds, only: dp
   use model, only: model_type
   implicit none
   private
   public :: write_result_mesh
   public :: grid_group, point_group, cell_group, steps_group, cell_data_names

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

      call create_group(file, grid_group, error)
      if (allocated(error)) return
      call write_fixed_text(file, grid_group, 'Type', 'UnstructuredGrid', error)
      if (allocated(error)) return
      call write_attribute(file, grid_group, 'Version', [2, 0], error)
      if (allocated(error)) return
      call write_counts(file, size(point_node), model%mesh%element_kind, error)
      if (allocated(error)) return
      call write_cells(file, model%mesh%element_kind, element_points, error)
      if (allocated(error)) return
      call write_point_data(file, model, point_node, error)
      if (allocated(error)) return
      call write_cell_data(file, model, error)
   end subroutine write_result_mesh

   subroutine write_counts(file, points, kinds, error)
      integer(hid_t), intent(in) :: file
      integer, intent(in) :: points
      integer, intent(in) :: kinds(:)
      type(error_type), allocatable, intent(out) :: error

      call write_array(file, grid_group//'/NumberOfPoints', [points], as_long, error)
      if (allocated(error)) return
      call write_array(file, grid_group//'/NumberOfCells', [size(kinds)], as_long, error)
      if (allocated(error)) return
      call write_array(file, grid_group//'/NumberOfConnectivityIds', &
         [sum(element_node_count(kinds))], as_long, error)
   end subroutine write_counts

   subroutine write_cells(file, kinds, element_points, error)
      integer(hid_t), intent(in) :: file
      integer, intent(in) :: kinds(:)
      integer, intent(in) :: element_points(:, :)
      type(error_type), allocatable, intent(out) :: error
      integer :: e, offsets(0:size(kinds)), points(sum(element_node_count(kinds)))

      offsets(0) = 0
      do e = 1, size(kinds)
         offsets(e) = offsets(e - 1) + element_node_count(kinds(e))
         points(offsets(e - 1) + 1:offsets(e)) = element_points(:element_node_count(kinds(e)), e)
      end do
      ! VTK counts from 0.
      call write_array(file, grid_group//'/Connectivity', points - 1, as_long, error)
      if (allocated(error)) return
      call write_array(file, grid_group//'/Offsets', offsets, as_long, error)
      if (allocated(error)) return
      call write_array(file, grid_group//'/Types', vtk_types(kinds), as_byte, error)
   end subroutine write_cells

   subroutine write_point_data(file, model, point_node, error)
      integer(hid_t), intent(in) :: file
      type(model_type), intent(in) :: model
      integer, intent(in) :: point_node(:)
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: points(:, :)

      allocate(points(3, size(point_node)), source=0.0_dp)
      points(:2, :) = model%mesh%coordinates(:, point_node)
      call write_array(file, grid_group//'/Points', points, error)
      if (allocated(error)) return
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
