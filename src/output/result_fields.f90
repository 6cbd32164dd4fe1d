!> The part of group `/VTKHDF` that grows: `Steps`, point and cell data of every increment that is
!> due.
!> The geometry is static, so its offsets are zero at every step.
module result_fields
   use contact_pairs, only: contact_pairs_type
   use errors, only: error_type
   use growing_datasets, only: growing_dataset, growing_dataset_type
   use hdf5, only: hid_t
   use hdf5_attributes, only: write_attribute
   use hdf5_helpers, only: as_long, as_real, create_group, link_dataset
   use kinds, only: dp
   use record_values, only: contact_values, name_length, not_a_number, point_values
   use records, only: increment_record_type
   use result_mesh, only: cell_data_names, cell_group, point_group, steps_group
   implicit none
   private
   public :: field_results_type

   !> Growing datasets of Steps; those of the same content are links to these.
   integer, parameter :: at_values = 1, at_zero = 2, at_zero_column = 3, at_one = 4, at_offset = 5
   integer, parameter :: at_cell_offset = 6
   integer, parameter :: step_sets = 6

   !> Fields of the result file. `sets` holds those of Steps, then one for each of `names`, then one
   !> for each of `cell_names`.
   type :: field_results_type
      private
      integer, allocatable, public :: point_node(:)              !! (points) node index
      integer, allocatable :: face_point(:)                      !! points on contact faces
      integer, allocatable :: face_interface(:)                  !! their interface
      integer, allocatable :: face_pair(:)                       !! their pair in it
      integer :: increments = 0                                  !! increments appended
      character(name_length), allocatable :: names(:)            !! point data that varies
      character(name_length), allocatable :: cell_names(:)       !! cell data that varies
      integer :: cells = 0                                       !! number of cells
      type(growing_dataset_type), allocatable, public :: sets(:) !! what grows
   contains
      procedure :: start
      procedure :: append
      procedure :: create_groups
      procedure :: write_links
      procedure :: write_count
   end type field_results_type

contains

   !> Prepares the datasets.
   subroutine start(self, pairs, point_node, cells, has_temperature, has_heat, has_mechanics, &
      expected)
      class(field_results_type), intent(inout) :: self   !! the fields
      type(contact_pairs_type), intent(in) :: pairs(:)   !! pairs of every interface
      integer, intent(in) :: point_node(:)               !! (points) node index of each point
      integer, intent(in) :: cells                       !! number of elements
      logical, intent(in) :: has_temperature             !! whether temperatures matter
      logical, intent(in) :: has_heat                    !! whether a step solves heat
      logical, intent(in) :: has_mechanics               !! whether a step solves mechanics
      integer, intent(in) :: expected                    !! increments that are expected
      integer :: i

      self%point_node = point_node
      call find_faces(self, pairs)
      self%names = field_names(has_temperature, has_heat, has_mechanics, size(pairs) > 0)
      self%cells = cells
      self%cell_names = pack([character(name_length) :: 'stress_error', 'heat_flux_error'], &
         [has_mechanics, has_heat])
      allocate(self%sets(step_sets + size(self%names) + size(self%cell_names)))
      self%sets(at_values) = growing_dataset(steps_group//'Values', as_real, 0, 1, expected)
      self%sets(at_zero) = growing_dataset(steps_group//'PartOffsets', as_long, 0, 1, expected)
      self%sets(at_zero_column) = growing_dataset(steps_group//'CellOffsets', as_long, 1, 1, &
         expected)
      self%sets(at_one) = growing_dataset(steps_group//'NumberOfParts', as_long, 0, 1, expected)
      self%sets(at_offset) = growing_dataset(steps_group//'PointDataOffsets/'// &
         trim(self%names(1)), as_long, 0, 1, expected)
      self%sets(at_cell_offset) = growing_dataset(steps_group//'CellDataOffsets/'// &
         trim(self%cell_names(1)), as_long, 0, 1, expected)
      do i = 1, size(self%names)
         self%sets(step_sets + i) = growing_dataset(point_group//trim(self%names(i)), as_real, &
            components(self%names(i)), size(point_node), expected)
      end do
      do i = 1, size(self%cell_names)
         self%sets(step_sets + size(self%names) + i) = growing_dataset(cell_group// &
            trim(self%cell_names(i)), as_real, 0, cells, expected)
      end do
   end subroutine start

   !> Adds the fields of an increment.
   subroutine append(self, record, pairs)
      class(field_results_type), intent(inout) :: self   !! the fields
      type(increment_record_type), intent(in) :: record  !! the increment
      type(contact_pairs_type), intent(in) :: pairs(:)   !! pairs of every interface
      integer :: i

      call self%sets(at_values)%append([record%time])
      call self%sets(at_zero)%append([0.0_dp])
      call self%sets(at_zero_column)%append([0.0_dp])
      call self%sets(at_one)%append([1.0_dp])
      call self%sets(at_offset)%append([real(self%increments, dp)*size(self%point_node)])
      call self%sets(at_cell_offset)%append([real(self%increments, dp)*self%cells])
      do i = 1, size(self%names)
         call self%sets(step_sets + i)%append(field_values(self, self%names(i), record, pairs))
      end do
      do i = 1, size(self%cell_names)
         call self%sets(step_sets + size(self%names) + i)%append(cell_values(self, &
            self%cell_names(i), record))
      end do
      self%increments = self%increments + 1
   end subroutine append

   !> Creates the groups that the datasets go into.
   !> Error: status_internal, when HDF5 refuses.
   subroutine create_groups(self, file, error)
      class(field_results_type), intent(in) :: self       !! the fields
      integer(hid_t), intent(in) :: file                  !! the open file
      type(error_type), allocatable, intent(out) :: error !! what went wrong

      call create_group(file, steps_group, error)
      if (allocated(error)) return
      if (size(self%names) > 0) call create_group(file, steps_group//'PointDataOffsets', error)
      if (allocated(error)) return
      call create_group(file, steps_group//'CellDataOffsets', error)
   end subroutine create_groups

   !> Gives the offsets of Steps all their names, once their datasets are in the file.
   !> Error: status_internal, when HDF5 refuses.
   subroutine write_links(self, file, error)
      class(field_results_type), intent(in) :: self       !! the fields
      integer(hid_t), intent(in) :: file                  !! the open file
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      character(*), parameter :: zeros = steps_group//'PartOffsets'
      character(*), parameter :: points = steps_group//'PointDataOffsets/'
      character(*), parameter :: cells = steps_group//'CellDataOffsets/'
      integer :: i

      call link_dataset(file, zeros, steps_group//'PointOffsets', error)
      if (allocated(error)) return
      call link_dataset(file, steps_group//'CellOffsets', steps_group//'ConnectivityIdOffsets', &
         error)
      if (allocated(error)) return
      call link_dataset(file, zeros, points//'node_id', error)
      if (allocated(error)) return
      do i = 2, size(self%names)
         call link_dataset(file, points//trim(self%names(1)), points//trim(self%names(i)), error)
         if (allocated(error)) return
      end do
      do i = 2, size(self%cell_names)
         call link_dataset(file, cells//trim(self%cell_names(1)), cells//trim(self%cell_names(i)), &
            error)
         if (allocated(error)) return
      end do
      do i = 1, size(cell_data_names)
         call link_dataset(file, zeros, cells//trim(cell_data_names(i)), error)
         if (allocated(error)) return
      end do
   end subroutine write_links

   !> Writes the number of increments that the file holds.
   !> Error: status_internal, when HDF5 refuses.
   subroutine write_count(self, file, error)
      class(field_results_type), intent(in) :: self       !! the fields
      integer(hid_t), intent(in) :: file                  !! the open file
      type(error_type), allocatable, intent(out) :: error !! what went wrong

      call write_attribute(file, steps_group, 'NSteps', self%increments, error)
   end subroutine write_count

   pure function field_names(has_temperature, has_heat, has_mechanics, has_contact) result(names)
      logical, intent(in) :: has_temperature
      logical, intent(in) :: has_heat
      logical, intent(in) :: has_mechanics
      logical, intent(in) :: has_contact
      character(name_length), allocatable :: names(:)

      allocate(names(0))
      if (has_mechanics) names = [character(name_length) :: 'displacement', 'stress', 'von_mises']
      if (has_temperature) names = [character(name_length) :: names, 'temperature']
      if (has_heat) names = [character(name_length) :: names, 'heat_flux']
      if (has_contact) names = [character(name_length) :: names, 'contact_pressure', &
         'contact_shear', 'contact_gap', 'contact_status']
      if (has_contact .and. has_heat) names = [character(name_length) :: names, &
         'contact_conductance', 'contact_heat_flux']
   end function field_names

   pure function components(name) result(count)
      character(*), intent(in) :: name
      integer :: count

      select case (name)
      case ('displacement', 'heat_flux')
         count = 3
      case ('stress')
         count = 4
      case default
         count = 0
      end select
   end function components

   subroutine find_faces(self, pairs)
      class(field_results_type), intent(inout) :: self
      type(contact_pairs_type), intent(in) :: pairs(:)
      integer, allocatable :: interface_of(:), pair_of(:)
      integer :: i, k

      allocate(interface_of(maxval([1, self%point_node])), source=0)
      allocate(pair_of(size(interface_of)), source=0)
      do i = 1, size(pairs)
         do k = 1, size(pairs(i)%slave_node)
            interface_of([pairs(i)%slave_node(k), pairs(i)%master_node(k)]) = i
            pair_of([pairs(i)%slave_node(k), pairs(i)%master_node(k)]) = k
         end do
      end do
      self%face_point = pack([(k, k=1, size(self%point_node))], interface_of(self%point_node) > 0)
      self%face_interface = interface_of(self%point_node(self%face_point))
      self%face_pair = pair_of(self%point_node(self%face_point))
   end subroutine find_faces

   function field_values(self, name, record, pairs) result(values)
      class(field_results_type), intent(in) :: self
      character(*), intent(in) :: name
      type(increment_record_type), intent(in) :: record
      type(contact_pairs_type), intent(in) :: pairs(:)
      real(dp), allocatable :: values(:)

      allocate(values(0))
      associate (fields => record%fields)
         select case (name)
         case ('displacement')
            if (allocated(fields%displacement)) then
               values = as_vectors(fields%displacement(:, self%point_node))
            end if
         case ('heat_flux')
            if (allocated(fields%heat_flux)) values = as_vectors(fields%heat_flux)
         case ('stress')
            if (allocated(fields%stress)) values = reshape(fields%stress, [size(fields%stress)])
         case ('von_mises')
            values = point_values('MISES', fields, self%point_node)
         case ('temperature')
            values = point_values('NT', fields, self%point_node)
         case default
            values = face_values(self, name(len('contact_') + 1:), record, pairs)
         end select
      end associate
      if (size(values) == 0) then
         deallocate(values)
         allocate(values(max(1, components(name))*size(self%point_node)), source=not_a_number())
      end if
   end function field_values

   function cell_values(self, name, record) result(values)
      class(field_results_type), intent(in) :: self
      character(*), intent(in) :: name
      type(increment_record_type), intent(in) :: record
      real(dp), allocatable :: values(:)

      if (name == 'stress_error') then
         if (allocated(record%stress_error%element)) values = record%stress_error%element
      else
         if (allocated(record%heat_flux_error%element)) values = record%heat_flux_error%element
      end if
      if (.not. allocated(values)) allocate(values(self%cells), source=not_a_number())
   end function cell_values

   pure function as_vectors(plane) result(values)
      real(dp), intent(in) :: plane(:, :)
      real(dp) :: values(3*size(plane, 2))

      values(1::3) = plane(1, :)
      values(2::3) = plane(2, :)
      values(3::3) = 0.0_dp
   end function as_vectors

   function face_values(self, name, record, pairs) result(values)
      class(field_results_type), intent(in) :: self
      character(*), intent(in) :: name
      type(increment_record_type), intent(in) :: record
      type(contact_pairs_type), intent(in) :: pairs(:)
      real(dp), allocatable :: values(:), face(:)
      integer :: i, k

      allocate(values(size(self%point_node)), source=not_a_number())
      do i = 1, size(pairs)
         face = contact_values(name, pairs(i), record%contacts(i))
         do k = 1, size(self%face_point)
            if (self%face_interface(k) == i) values(self%face_point(k)) = face(self%face_pair(k))
         end do
      end do
   end function face_values

end module result_fields
