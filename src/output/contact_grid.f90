!> The file `NAME.contact.vtkhdf`: the contact points of all interfaces as lines along the slaves,
!> with their quantities at every increment, so that they are drawn and exported by themselves.
module contact_grid
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values
   use growing_datasets, only: flush_sets, growing_dataset_type, quantity_dataset
   use hdf5_writer, only: as_integer, hdf5_writer_type
   use kinds, only: dp
   use model, only: unit_labels_type
   use quantity_types, only: of_contact_points, quantity_type
   use records, only: increment_record_type
   use reported_quantities, only: datasets, geometry
   use result_tables, only: storage_of, write_geometry
   use vtk_grids, only: cell_group, grid_steps_type, point_group, write_grid
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
      type(growing_dataset_type), allocatable, public :: sets(:)   !! one for each of them
      type(unit_labels_type) :: labels                     !! units of the deck
      integer :: points = 0                                !! contact points of all interfaces
   contains
      procedure :: start
      procedure :: append
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
         self%sets(i) = quantity_dataset(point_group, self%quantities(i), labels, &
            storage_of(self%quantities(i)), 0, self%points, expected)
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

   !> Writes the data that do not change: lines, numbers of nodes, arc lengths, weights.
   subroutine write_head(self, file, interfaces, node_number)
      class(contact_grid_type), intent(in) :: self
      type(hdf5_writer_type), intent(inout) :: file       !! the open file
      type(contact_points_type), intent(in) :: interfaces(:)
      integer, intent(in) :: node_number(:)               !! (nodes) numbers in the deck
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
         [(vtk_line, k=1, size(interface_of))], self%labels)
      call file%create_group(point_group)
      call write_geometry(file, point_group, interfaces, node_number, self%labels)
      call file%create_group(cell_group)
      call file%write(cell_group//interface_set, interface_of, as_integer, &
         'number of the *CONTACT PAIR, from 1')
      call self%steps%create_groups(file)
   end subroutine write_head

   !> Writes the waiting rows.
   subroutine flush_grid(self, file, is_new)
      class(contact_grid_type), intent(inout) :: self
      type(hdf5_writer_type), intent(inout) :: file       !! the open file, with its head
      logical, intent(in) :: is_new                       !! whether these are its first rows
      character(len(geometry%name) + 1) :: names(size(geometry) + size(self%quantities))

      call flush_sets(self%sets, file)
      call self%steps%flush(file)
      if (.not. is_new) return
      names(:size(geometry)) = ' '//geometry%name
      names(size(geometry) + 1:) = self%quantities%name
      call self%steps%write_links(file, names, [' '//interface_set])
   end subroutine flush_grid

end module contact_grid
