!> Both grids of a run. Group `/VTKHDF` of the result file: the mesh, with point and cell data of
!> every increment that is due. The file `NAME.contact.vtkhdf`: the contact points of all interfaces
!> as lines along the slaves, with their quantities at every increment, so that they are drawn and
!> exported by themselves.
!>
!> A grid does not move: points and cells are in one part, stored once, with the point and cell data
!> of every increment and the times of these, group `Steps`. Layout: VTKHDF 2.0, UnstructuredGrid.
!> Datasets with the same contents are one with several names.
module result_fields
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values
   use element_kinds, only: axisymmetric, element_node_count, kind_count
   use field_quantities, only: point_values
   use hdf5_writer, only: as_byte, as_integer, as_long, as_real, hdf5_writer_type
   use increment_quantities, only: part_values
   use kinds, only: dp
   use model, only: model_type
   use quantity_types, only: of_contact_points, of_elements, of_points, quantity_type
   use records, only: increment_record_type
   use reported_quantities, only: datasets
   use growing_datasets, only: flush_sets, growing_dataset, growing_dataset_type, &
      quantity_dataset, write_integers, write_once
   use result_tables, only: write_geometry
   use sorting, only: invert_lists
   implicit none
   private
   public :: field_results_type, contact_grid_type, node_sets, cell_sets, interface_sets, &
      vtk_grid_type, write_grid, point_group, cell_group

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

   !> Growing parts of a grid.
   type :: vtk_grid_type
      type(quantity_type), allocatable :: point_data(:), cell_data(:)
      !> Datasets, one for each of `point_data`, then one for each of `cell_data`
      type(growing_dataset_type), allocatable :: sets(:)
      integer :: points = 0                                        !! number of points
      integer :: cells = 0                                         !! number of cells
      integer :: increments = 0                                    !! rows so far
      type(growing_dataset_type), allocatable, private :: steps(:) !! datasets of Steps
   contains
      procedure :: start_grid
      procedure :: append_time
      procedure :: go_on
      procedure :: flush_grid
   end type vtk_grid_type

   character(*), parameter :: mark = 'contact_'   !! before names of quantities of contact points

   !> Point and cell data that do not vary.
   character(*), parameter :: node_sets(1) = ['node_id']
   character(*), parameter :: cell_sets(3) = [character(10) :: 'element_id', 'body', 'material']

   character(*), parameter :: interface_sets(1) = ['interface']   !! cell data of contact points

   !> VTK's cell types of quad8, quad8_reduced, quad4, triangle6, triangle3 and quad4_enhanced. Its
   !> corners and midside nodes are in our order.
   integer, parameter :: vtk_types(kind_count) = [23, 23, 9, 22, 5, 9]
   integer, parameter :: vtk_line = 3

   !> Fields of the result file.
   type, extends(vtk_grid_type) :: field_results_type
      private
      integer, allocatable :: point_node(:)                      !! (points) node index
      integer, allocatable :: face_point(:)  !! points on contact faces, by their interfaces
      integer, allocatable :: face_start(:)  !! (interfaces + 1) the first of each
      integer, allocatable :: face_row(:)                        !! their row of its at_face_nodes
      !> (2, points) unit vectors away from the origin in plane models; else unallocated
      real(dp), allocatable :: radial(:, :)
      !> (points) whether an element uses its node: no other node has a temperature
      logical, allocatable :: is_used(:)
   contains
      procedure :: start
      procedure :: append
      procedure :: write_head
   end type field_results_type

   !> The grid of the contact points, without cell data that grow.
   type, extends(vtk_grid_type) :: contact_grid_type
   contains
      procedure :: append => append_contact
      procedure, nopass :: write_head => write_contact_head
   end type contact_grid_type

contains

   !> Prepares the datasets.
   subroutine start(self, model, interfaces, point_node, has, expected)
      class(field_results_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      integer, intent(in) :: point_node(:)               !! (points) node index of each point
      logical, intent(in) :: has(0:)                     !! what the deck solves, by needs_*
      integer, intent(in) :: expected                    !! increments that are expected
      type(quantity_type), allocatable :: fields(:), of_faces(:)
      integer :: i

      self%point_node = point_node
      self%is_used = model%mesh%node_body(point_node) > 0
      if (all(model%mesh%element_plane /= axisymmetric)) then
         ! At the origin itself along x.
         self%radial = model%mesh%coordinates(:, point_node)
         do i = 1, size(point_node)
            associate (radius => hypot(self%radial(1, i), self%radial(2, i)))
               self%radial(:, i) = merge(self%radial(:, i)/max(radius, tiny(radius)), &
                  [1.0_dp, 0.0_dp], radius > 0.0_dp)
            end associate
         end do
      end if
      call find_faces(self, interfaces)
      fields = datasets(of_points, has)
      if (size(interfaces) > 0) then
         ! Some quantities of contact points are fields too, by names of their own; NaN is real.
         of_faces = datasets(of_contact_points, has)
         of_faces = pack(of_faces, of_faces%is_on_faces)
         of_faces%is_integer = .false.
         do i = 1, size(of_faces)
            of_faces(i)%name = mark//trim(of_faces(i)%name)
            of_faces(i)%description = trim(of_faces(i)%description)//'; on both faces, else NaN'
         end do
         fields = [fields, of_faces]
      end if
      call self%start_grid(fields, datasets(of_elements, has), size(point_node), &
         size(model%mesh%element_kind), expected)
   end subroutine start

   subroutine find_faces(self, interfaces)
      class(field_results_type), intent(inout) :: self
      type(contact_points_type), intent(in) :: interfaces(:)
      integer, allocatable :: interface_of(:), row_of(:)
      integer :: i, k

      allocate(interface_of(maxval([1, self%point_node])), source=0)
      allocate(row_of(size(interface_of)), source=0)
      do i = 1, size(interfaces)
         associate (nodes => interfaces(i)%face_node)
            interface_of(nodes) = i
            row_of(nodes) = [(k, k=1, size(nodes))]
         end associate
      end do
      call invert_lists(reshape(interface_of(self%point_node), [1, size(self%point_node)]), &
         merge(1, 0, interface_of(self%point_node) > 0), size(interfaces), self%face_start, &
         self%face_point)
      self%face_row = row_of(self%point_node(self%face_point))
   end subroutine find_faces

   !> Adds the fields of an increment.
   subroutine append(self, record, interfaces)
      class(field_results_type), intent(inout) :: self
      type(increment_record_type), intent(in) :: record
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      real(dp), allocatable :: values(:)
      integer :: i

      do i = 1, size(self%point_data)
         associate (quantity => self%point_data(i))
            if (quantity%kind == of_contact_points) then
               call self%sets(i)%append(face_values(self, quantity%name(len(mark) + 1:), record, &
                  interfaces))
            else
               values = point_values(quantity%name, record%fields, self%point_node, self%radial)
               if (quantity%unit == 'temperature' .and. size(values) > 0) values = merge(values, &
                  ieee_value(1.0_dp, ieee_quiet_nan), self%is_used)
               call self%sets(i)%append(values)
            end if
         end associate
      end do
      do i = 1, size(self%cell_data)
         call self%sets(size(self%point_data) + i)%append(part_values(self%cell_data(i), record))
      end do
      call self%append_time(record%time)
   end subroutine append

   function face_values(self, name, record, interfaces) result(values)
      class(field_results_type), intent(in) :: self
      character(*), intent(in) :: name
      type(increment_record_type), intent(in) :: record
      type(contact_points_type), intent(in) :: interfaces(:)
      real(dp), allocatable :: values(:), face(:)
      integer :: i, k

      values = spread(ieee_value(1.0_dp, ieee_quiet_nan), 1, self%points)
      do i = 1, size(interfaces)
         associate (at_nodes => interfaces(i)%at_face_nodes, &
            of_points => contact_values(name, record%contacts(i)))
            if (name == 'status') then
               ! Not interpolated: that of the nearest contact point, of two as near the larger one.
               face = [(maxval(of_points(at_nodes%values_of(k)), mask=at_nodes%coefficients_of(k) &
                  >= maxval(at_nodes%coefficients_of(k))), k=1, at_nodes%count)]
            else
               face = spread(0.0_dp, 1, at_nodes%count)
               call at_nodes%add_totals(of_points, face)
            end if
         end associate
         ! Nodes of faces that slide have no contact quantities where nothing is opposite.
         associate (start => interfaces(i)%at_face_nodes%start)
            do k = self%face_start(i), self%face_start(i + 1) - 1
               if (start(self%face_row(k) + 1) > start(self%face_row(k))) values(self%face_point( &
                  k)) = face(self%face_row(k))
            end do
         end associate
      end do
   end function face_values

   !> Creates the groups of `/VTKHDF` and writes the mesh and the data that do not vary.
   subroutine write_head(self, file, model, element_points)
      class(field_results_type), intent(in) :: self       !! the fields, started
      type(hdf5_writer_type), intent(inout) :: file       !! the open file
      type(model_type), intent(in) :: model
      integer, intent(in) :: element_points(:, :)         !! (8, elements) points, like the nodes
      real(dp) :: points(3, self%points)
      integer, allocatable :: cell_points(:)
      integer :: e, offsets(0:self%cells)

      associate (mesh => model%mesh)
         points = 0.0_dp
         points(:2, :) = mesh%coordinates(:, self%point_node)
         allocate (cell_points(sum(element_node_count(mesh%element_kind))))
         offsets(0) = 0
         do e = 1, self%cells
            offsets(e) = offsets(e - 1) + element_node_count(mesh%element_kind(e))
            cell_points(offsets(e - 1) + 1:offsets(e)) = &
               element_points(:offsets(e) - offsets(e - 1), e)
         end do
         call write_grid(file, points, cell_points, offsets, vtk_types(mesh%element_kind))
         call write_integers(file, point_group//node_sets(1), mesh%node_number(self%point_node), &
            as_integer, 'number of the node in the deck')
         call write_integers(file, cell_group//trim(cell_sets(1)), mesh%element_number, &
            as_integer, 'number of the element in the deck')
         call write_integers(file, cell_group//trim(cell_sets(2)), mesh%element_body, as_integer, &
            'number of the body, from 1')
         call write_integers(file, cell_group//trim(cell_sets(3)), &
            model%sections(mesh%element_section)%material, as_integer, &
            'number of the *MATERIAL in the deck, from 1')
      end associate
   end subroutine write_head

   !> Adds the contact points of an increment.
   subroutine append_contact(self, record)
      class(contact_grid_type), intent(inout) :: self
      type(increment_record_type), intent(in) :: record
      integer :: i, k

      do k = 1, size(self%sets)
         do i = 1, size(record%contacts)
            call self%sets(k)%append(contact_values(self%point_data(k)%name, record%contacts(i)))
         end do
      end do
      call self%append_time(record%time)
   end subroutine append_contact

   !> Writes the lines and what does not vary: numbers of nodes, arc lengths, weights.
   subroutine write_contact_head(file, interfaces, node_number)
      type(hdf5_writer_type), intent(inout) :: file       !! the open file
      type(contact_points_type), intent(in) :: interfaces(:)
      integer, intent(in) :: node_number(:)               !! (nodes) numbers in the deck
      real(dp), allocatable :: points(:, :)
      integer, allocatable :: ends(:, :), interface_of(:)
      integer :: cells, first, i, k, m

      allocate (points(3, sum([(size(interfaces(i)%slave), i=1, size(interfaces))])), source=0.0_dp)
      allocate (ends(2, size(points, 2)), interface_of(size(points, 2)))
      cells = 0
      first = 0
      do i = 1, size(interfaces)
         m = size(interfaces(i)%slave)
         points(:2, first + 1:first + m) = interfaces(i)%position
         do k = 1, m - 1
            if (.not. interfaces(i)%on_one_piece(k, k + 1)) cycle
            cells = cells + 1
            ends(:, cells) = first + [k, k + 1]
            interface_of(cells) = i
         end do
         first = first + m
      end do
      call write_grid(file, points, [ends(:, :cells)], [(2*k, k=0, cells)], &
         [(vtk_line, k=1, cells)])
      call write_geometry(file, point_group, interfaces, node_number)
      call write_integers(file, cell_group//interface_sets(1), interface_of(:cells), as_integer, &
         'number of the *CONTACT PAIR, from 1')
   end subroutine write_contact_head

   !> Creates the groups of a grid in one part and writes its points and cells.
   subroutine write_grid(file, points, cell_points, offsets, types)
      type(hdf5_writer_type), intent(inout) :: file       !! the open file
      real(dp), intent(in) :: points(:, :)                !! (3, points) [length]
      integer, intent(in) :: cell_points(:)               !! points of each cell, from 1
      integer, intent(in) :: offsets(:)                   !! (cells + 1) from 0
      integer, intent(in) :: types(:)                     !! (cells) VTK's

      call file%create_group(grid_group)
      call file%set_fixed_text(grid_group, 'Type', 'UnstructuredGrid')
      call file%set(grid_group, 'Version', [2, 0])
      call write_integers(file, grid_group//'/NumberOfPoints', [size(points, 2)], as_long, 'points')
      call write_integers(file, grid_group//'/NumberOfCells', [size(types)], as_long, 'cells')
      call write_integers(file, grid_group//'/NumberOfConnectivityIds', [size(cell_points)], &
         as_long, 'entries of Connectivity')
      ! VTK counts from 0.
      call write_integers(file, grid_group//'/Connectivity', cell_points - 1, as_long, &
         'points of every cell, from 0')
      call write_integers(file, grid_group//'/Offsets', offsets, as_long, &
         'first entry of every cell in Connectivity')
      call write_integers(file, grid_group//'/Types', types, as_byte, &
         'VTK cell types: 3 line, 5, 22 triangle, 9, 23 four-sided')
      call write_once(file, growing_dataset(grid_group//'/Points', as_real, 3, 1, 1, &
         'coordinates before deformation', 'length'), [points])
      call file%create_group(point_group)
      call file%create_group(cell_group)
      call file%create_group(steps_group)
      call file%create_group(point_offsets)
      call file%create_group(cell_offsets)
   end subroutine write_grid

   !> Prepares the datasets.
   pure subroutine start_grid(self, point_data, cell_data, points, cells, expected)
      class(vtk_grid_type), intent(inout) :: self
      type(quantity_type), intent(in) :: point_data(:)    !! those that grow, at least one
      type(quantity_type), intent(in) :: cell_data(:)     !! those that grow
      integer, intent(in) :: points, cells                !! of the grid
      integer, intent(in) :: expected                     !! increments that are expected
      character(:), allocatable :: path
      integer :: i, n

      self%point_data = point_data
      self%cell_data = cell_data
      self%points = points
      self%cells = cells
      n = size(point_data)
      allocate(self%sets(n + size(cell_data)), self%steps(merge(6, 5, size(cell_data) > 0)))
      do i = 1, n
         self%sets(i) = quantity_dataset(point_group, point_data(i), points, expected)
      end do
      do i = 1, size(cell_data)
         self%sets(n + i) = quantity_dataset(cell_group, cell_data(i), cells, expected)
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

   !> Goes on behind the first increments of an earlier file.
   subroutine go_on(self, file, increments)
      class(vtk_grid_type), intent(inout) :: self         !! started
      type(hdf5_writer_type), intent(inout) :: file       !! the open file
      integer, intent(in) :: increments                   !! of it that are kept
      integer :: i

      self%increments = increments
      do i = 1, size(self%sets)
         call self%sets(i)%go_on(file, increments*merge(self%points, self%cells, &
            i <= size(self%point_data)))
      end do
      do i = 1, size(self%steps)
         call self%steps(i)%go_on(file, increments)
      end do
   end subroutine go_on

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

end module result_fields
