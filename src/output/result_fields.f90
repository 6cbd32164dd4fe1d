!> The part of group `/VTKHDF` that grows: `Steps`, point and cell data of every increment that is
!> due.
!> The geometry is static, so its offsets are zero at every step.
module result_fields
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values
   use element_kinds, only: axisymmetric
   use field_quantities, only: element_values, point_values
   use growing_datasets, only: flush_sets, growing_dataset_type, quantity_dataset
   use hdf5_writer, only: as_real, hdf5_writer_type
   use kinds, only: dp
   use model, only: model_type
   use quantity_types, only: of_elements, of_contact_points, of_points, quantity_type
   use records, only: increment_record_type
   use reported_quantities, only: datasets
   use vtk_grids, only: cell_data_names, cell_group, grid_steps_type, point_group
   implicit none
   private
   public :: field_results_type

   character(*), parameter :: mark = 'contact_'   !! before names of quantities of contact points

   !> Fields of the result file. `sets` holds one for each of `point_data`, then one for each of
   !> `cell_data`.
   type :: field_results_type
      private
      integer, allocatable, public :: point_node(:)              !! (points) node index
      integer, allocatable :: face_point(:)                      !! points on contact faces
      integer, allocatable :: face_interface(:)                  !! their interface
      integer, allocatable :: face_row(:)                        !! their row of its at_face_nodes
      !> (2, points) unit vectors away from the origin in plane models; else unallocated
      real(dp), allocatable :: radial(:, :)
      type(grid_steps_type), public :: steps                     !! times
      type(quantity_type), allocatable :: point_data(:)          !! point data that varies
      type(quantity_type), allocatable :: cell_data(:)           !! cell data that varies
      integer :: cells = 0                                       !! number of cells
      type(growing_dataset_type), allocatable, public :: sets(:) !! what grows
   contains
      procedure :: start
      procedure :: append
      procedure :: flush => flush_fields
   end type field_results_type

contains

   !> Prepares the datasets.
   subroutine start(self, model, interfaces, point_node, has, expected)
      class(field_results_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      integer, intent(in) :: point_node(:)               !! (points) node index of each point
      logical, intent(in) :: has(0:)                     !! what the deck solves, by needs_*
      integer, intent(in) :: expected                    !! increments that are expected
      integer :: i, width

      self%point_node = point_node
      self%cells = size(model%mesh%element_kind)
      if (all(model%mesh%element_plane /= axisymmetric)) self%radial = &
         directions(model%mesh%coordinates(:, point_node))
      call find_faces(self, interfaces)
      self%point_data = datasets(of_points, has)
      if (size(interfaces) > 0) self%point_data = [self%point_data, &
         on_faces(datasets(of_contact_points, has))]
      self%cell_data = datasets(of_elements, has)
      allocate(self%sets(size(self%point_data) + size(self%cell_data)))
      call self%steps%start(trim(self%point_data(1)%name), trim(self%cell_data(1)%name), expected)
      do i = 1, size(self%point_data)
         width = merge(self%point_data(i)%values, 0, self%point_data(i)%values > 1)
         self%sets(i) = quantity_dataset(point_group, self%point_data(i), model%units, as_real, &
            width, size(point_node), expected)
      end do
      do i = 1, size(self%cell_data)
         self%sets(size(self%point_data) + i) = quantity_dataset(cell_group, self%cell_data(i), &
            model%units, as_real, 0, self%cells, expected)
      end do
   end subroutine start

   !> Unit vectors from the origin to points; along x at the origin itself.
   pure function directions(coordinates) result(radial)
      real(dp), intent(in) :: coordinates(:, :)
      real(dp) :: radial(2, size(coordinates, 2)), radius
      integer :: i

      do i = 1, size(radial, 2)
         radius = hypot(coordinates(1, i), coordinates(2, i))
         radial(:, i) = [1.0_dp, 0.0_dp]
         if (radius > 0.0_dp) radial(:, i) = coordinates(:, i)/radius
      end do
   end function directions

   !> Adds the fields of an increment.
   subroutine append(self, record, interfaces)
      class(field_results_type), intent(inout) :: self
      type(increment_record_type), intent(in) :: record
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      integer :: i

      call self%steps%append(record%time, size(self%point_node), self%cells)
      do i = 1, size(self%point_data)
         call self%sets(i)%append(field_values(self, self%point_data(i), record, &
            interfaces))
      end do
      do i = 1, size(self%cell_data)
         call self%sets(size(self%point_data) + i)%append(or_nan(element_values( &
            self%cell_data(i)%name, record), self%cells))
      end do
   end subroutine append

   !> Writes the waiting rows; the first time then gives the offsets of Steps all their names.
   subroutine flush_fields(self, file, is_new)
      class(field_results_type), intent(inout) :: self
      type(hdf5_writer_type), intent(inout) :: file       !! the open file, with its head
      logical, intent(in) :: is_new                       !! whether these are its first rows
      character(len(self%point_data%name) + 1) :: points(1 + size(self%point_data))
      character(len(self%cell_data%name) + 1) :: cells(size(cell_data_names) + &
         size(self%cell_data))

      call flush_sets(self%sets, file)
      call self%steps%flush(file)
      if (.not. is_new) return
      points(1) = ' node_id'
      points(2:) = self%point_data%name
      cells(:size(cell_data_names)) = ' '//cell_data_names
      cells(size(cell_data_names) + 1:) = self%cell_data%name
      call self%steps%write_links(file, points, cells)
   end subroutine flush_fields

   !> The quantities of contact points that are fields too, by their names as such.
   pure function on_faces(of_interface) result(fields)
      type(quantity_type), intent(in) :: of_interface(:)
      type(quantity_type), allocatable :: fields(:)
      integer :: i

      fields = pack(of_interface, of_interface%is_on_faces)
      do i = 1, size(fields)
         fields(i)%name = mark//trim(fields(i)%name)
         fields(i)%description = trim(fields(i)%description)//'; on both faces, else NaN'
      end do
   end function on_faces

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
      self%face_point = pack([(k, k=1, size(self%point_node))], interface_of(self%point_node) > 0)
      self%face_interface = interface_of(self%point_node(self%face_point))
      self%face_row = row_of(self%point_node(self%face_point))
   end subroutine find_faces

   function field_values(self, quantity, record, interfaces) result(values)
      class(field_results_type), intent(in) :: self
      type(quantity_type), intent(in) :: quantity
      type(increment_record_type), intent(in) :: record
      type(contact_points_type), intent(in) :: interfaces(:)
      real(dp), allocatable :: values(:)

      if (quantity%kind == of_contact_points) then
         values = face_values(self, quantity%name(len(mark) + 1:), quantity%is_integer, record, &
            interfaces)
      else
         values = or_nan(point_values(quantity%name, record%fields, self%point_node, &
            self%radial), quantity%values*size(self%point_node))
      end if
   end function field_values

   !> As many values as are due, NaN where there are none.
   pure function or_nan(values, due) result(filled)
      real(dp), intent(in) :: values(:)
      integer, intent(in) :: due
      real(dp), allocatable :: filled(:)

      filled = values
      if (size(values) == 0) filled = spread(ieee_value(1.0_dp, ieee_quiet_nan), 1, due)
   end function or_nan

   function face_values(self, name, is_state, record, interfaces) result(values)
      class(field_results_type), intent(in) :: self
      character(*), intent(in) :: name
      logical, intent(in) :: is_state        ! not interpolated: that of the nearest contact point
      type(increment_record_type), intent(in) :: record
      type(contact_points_type), intent(in) :: interfaces(:)
      real(dp), allocatable :: values(:), face(:)
      integer :: i, k

      values = or_nan([real(dp) ::], size(self%point_node))
      do i = 1, size(interfaces)
         associate (at_nodes => interfaces(i)%at_face_nodes, &
            of_points => contact_values(name, interfaces(i), record%contacts(i)))
            if (is_state) then
               face = [(nearest_value(at_nodes%coefficients_of(k), &
                  of_points(at_nodes%values_of(k))), k=1, at_nodes%count)]
            else
               face = spread(0.0_dp, 1, at_nodes%count)
               call at_nodes%add_totals(of_points, face)
            end if
         end associate
         do k = 1, size(self%face_point)
            if (self%face_interface(k) == i) values(self%face_point(k)) = face(self%face_row(k))
         end do
      end do
   end function face_values

   !> The value with the largest share; midway between two the larger one.
   pure real(dp) function nearest_value(share, values)
      real(dp), intent(in) :: share(:), values(:)

      nearest_value = maxval(values, mask=share >= maxval(share))
   end function nearest_value

end module result_fields
