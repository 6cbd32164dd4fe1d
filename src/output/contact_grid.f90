!> The file `NAME.contact.vtkhdf`: the contact points of all interfaces as lines along the slaves,
!> with their quantities at every increment, so that they are drawn and exported by themselves.
module contact_grid
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values, geometry_values
   use errors, only: error_type
   use grid_steps, only: grid_steps_type
   use growing_datasets, only: bytes_in, flush_sets, growing_dataset, growing_dataset_type
   use hdf5, only: hid_t
   use hdf5_attributes, only: describe
   use hdf5_helpers, only: as_integer, as_real, create_group, write_array
   use kinds, only: dp, long
   use model, only: unit_labels_type
   use quantity_types, only: of_contact_points, quantity_type
   use records, only: increment_record_type
   use reported_quantities, only: datasets, quantities
   use result_mesh, only: cell_group, point_group, write_grid
   use unit_labels, only: unit_in_words
   implicit none
   private
   public :: contact_grid_type

   integer, parameter :: vtk_line = 3
   character(*), parameter :: interface_set = 'interface'

   !> Writer of the grid.
   type :: contact_grid_type
      private
      type(grid_steps_type) :: steps
      type(quantity_type), allocatable :: quantities(:)    !! those of contact points that grow
      type(growing_dataset_type), allocatable :: sets(:)   !! one for each of them
      type(unit_labels_type) :: labels                     !! units of the deck
      integer :: points = 0                                !! contact points of all interfaces
   contains
      procedure :: start
      procedure :: append
      procedure :: waiting_bytes
      procedure :: write_head
      procedure :: flush => flush_grid
   end type contact_grid_type

contains

   !> Prepares the datasets.
   subroutine start(self, interfaces, has, expected, labels)
      class(contact_grid_type), intent(inout) :: self
      type(contact_points_type), intent(in) :: interfaces(:)
      logical, intent(in) :: has(0:)                      !! what the deck solves, by needs_*
      integer, intent(in) :: expected                     !! increments that are expected
      type(unit_labels_type), intent(in) :: labels        !! units of the deck
      integer :: i

      self%labels = labels
      self%quantities = datasets(of_contact_points, has)
      self%points = 0
      do i = 1, size(interfaces)
         self%points = self%points + size(interfaces(i)%slave_node)
      end do
      allocate (self%sets(size(self%quantities)))
      do i = 1, size(self%sets)
         associate (quantity => self%quantities(i))
            self%sets(i) = growing_dataset(point_group//trim(quantity%name), merge(as_integer, &
               as_real, quantity%is_integer), 0, self%points, expected)
            call self%sets(i)%describe_as(trim(quantity%description), &
               unit_in_words(quantity%unit, labels), '')
         end associate
      end do
      call self%steps%start(trim(self%quantities(1)%name), '', expected)
   end subroutine start

   !> Adds an increment.
   subroutine append(self, record, interfaces)
      class(contact_grid_type), intent(inout) :: self
      type(increment_record_type), intent(in) :: record
      type(contact_points_type), intent(in) :: interfaces(:)
      integer :: i, k

      do k = 1, size(self%sets)
         do i = 1, size(interfaces)
            call self%sets(k)%append(contact_values(self%quantities(k)%name, interfaces(i), &
               record%contacts(i)))
         end do
      end do
      call self%steps%append(record%time, self%points, 0)
   end subroutine append

   !> Bytes that wait in memory.
   pure function waiting_bytes(self) result(bytes)
      class(contact_grid_type), intent(in) :: self
      integer(long) :: bytes

      bytes = bytes_in(self%sets)
   end function waiting_bytes

   !> Writes what does not change: lines, numbers of nodes, arc lengths, weights.
   !> Error: status_internal, when HDF5 refuses.
   subroutine write_head(self, file, interfaces, node_number, error)
      class(contact_grid_type), intent(in) :: self
      integer(hid_t), intent(in) :: file                  !! the open file
      type(contact_points_type), intent(in) :: interfaces(:)
      integer, intent(in) :: node_number(:)               !! (nodes) numbers in the deck
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: points(3, self%points)
      integer, allocatable :: ends(:), interface_of(:)
      integer :: first, i, k, m

      points = 0.0_dp
      first = 0
      allocate (ends(0), interface_of(0))
      do i = 1, size(interfaces)
         m = size(interfaces(i)%slave_node)
         points(:2, first + 1:first + m) = interfaces(i)%position
         ends = [ends, [(first + k, first + k + 1, k=1, m - 1)]]
         interface_of = [interface_of, [(i, k=1, m - 1)]]
         first = first + m
      end do
      call write_grid(file, points, ends, [(2*k, k=0, size(interface_of))], &
         [(vtk_line, k=1, size(interface_of))], self%labels, error)
      if (allocated(error)) return
      call write_geometry(self, file, interfaces, node_number, error)
      if (allocated(error)) return
      call create_group(file, cell_group, error)
      if (allocated(error)) return
      call write_array(file, cell_group//interface_set, interface_of, as_integer, error)
      if (allocated(error)) return
      call describe(file, cell_group//interface_set, 'number of the *CONTACT PAIR, from 1', '-', &
         error)
      if (allocated(error)) return
      call self%steps%create_groups(file, error)
   end subroutine write_head

   subroutine write_geometry(self, file, interfaces, node_number, error)
      class(contact_grid_type), intent(in) :: self
      integer(hid_t), intent(in) :: file
      type(contact_points_type), intent(in) :: interfaces(:)
      integer, intent(in) :: node_number(:)
      type(error_type), allocatable, intent(out) :: error
      type(quantity_type), allocatable :: given(:)
      real(dp), allocatable :: values(:)
      integer :: i, k

      call create_group(file, point_group, error)
      if (allocated(error)) return
      given = pack(quantities, quantities%is_geometry)
      do k = 1, size(given)
         allocate (values(0))
         do i = 1, size(interfaces)
            values = [values, geometry_values(given(k)%name, interfaces(i), node_number)]
         end do
         if (given(k)%is_integer) then
            call write_array(file, point_group//trim(given(k)%name), nint(values), as_integer, &
               error)
         else
            call write_array(file, point_group//trim(given(k)%name), values, error)
         end if
         if (allocated(error)) return
         call describe(file, point_group//trim(given(k)%name), given(k)%description, &
            unit_in_words(given(k)%unit, self%labels), error)
         if (allocated(error)) return
         deallocate (values)
      end do
   end subroutine write_geometry

   !> Writes the waiting rows.
   !> Error: status_internal, when HDF5 refuses.
   subroutine flush_grid(self, file, is_new, error)
      class(contact_grid_type), intent(inout) :: self
      integer(hid_t), intent(in) :: file                  !! the open file, with its head
      logical, intent(in) :: is_new                       !! whether these are its first rows
      type(error_type), allocatable, intent(out) :: error
      type(quantity_type), allocatable :: given(:)
      character(len(given%name) + 1), allocatable :: names(:)
      integer :: i

      call flush_sets(self%sets, file, error)
      if (allocated(error)) return
      call flush_sets(self%steps%sets, file, error)
      if (allocated(error)) return
      call self%steps%write_count(file, error)
      if (allocated(error) .or. .not. is_new) return
      given = pack(quantities, quantities%is_geometry)
      allocate (names(size(given) + size(self%quantities)))
      do i = 1, size(given)
         names(i) = ' '//given(i)%name
      end do
      names(size(given) + 1:) = self%quantities%name
      call self%steps%write_links(file, names, [' '//interface_set], error)
   end subroutine flush_grid

end module contact_grid
