!> The file `NAME.contact.vtkhdf`: the contact points of all interfaces as lines along the slaves,
!> with their quantities at every increment, so that they are drawn and exported by themselves.
module contact_grid
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values
   use hdf5_writer, only: as_integer, hdf5_writer_type
   use kinds, only: dp
   use model, only: unit_labels_type
   use records, only: increment_record_type
   use reported_quantities, only: geometry
   use result_tables, only: write_geometry
   use vtk_grids, only: cell_group, point_group, vtk_grid_type, write_grid
   implicit none
   private
   public :: contact_grid_type

   integer, parameter :: vtk_line = 3
   character(*), parameter :: interface_set = 'interface'

   !> Writer of the grid, without cell data that grow.
   type, extends(vtk_grid_type) :: contact_grid_type
   contains
      procedure :: append
      procedure, nopass :: write_head
      procedure :: flush => flush_contact_grid
   end type contact_grid_type

contains

   !> Adds an increment.
   subroutine append(self, record, interfaces)
      class(contact_grid_type), intent(inout) :: self
      type(increment_record_type), intent(in) :: record
      type(contact_points_type), intent(in) :: interfaces(:)
      integer :: i, k

      do k = 1, size(self%sets)
         do i = 1, size(interfaces)
            call self%sets(k)%append(contact_values(self%point_data(k)%name, interfaces(i), &
               record%contacts(i)))
         end do
      end do
      call self%append_time(record%time)
   end subroutine append

   !> Writes the data that do not change: lines, numbers of nodes, arc lengths, weights.
   subroutine write_head(file, interfaces, node_number, labels)
      type(hdf5_writer_type), intent(inout) :: file       !! the open file
      type(contact_points_type), intent(in) :: interfaces(:)
      integer, intent(in) :: node_number(:)               !! (nodes) numbers in the deck
      type(unit_labels_type), intent(in) :: labels        !! units of the deck
      real(dp), allocatable :: points(:, :)
      integer, allocatable :: ends(:), interface_of(:)
      integer :: first, i, k, m

      allocate (points(3, sum([(size(interfaces(i)%slave), i=1, size(interfaces))])), &
         source=0.0_dp)
      first = 0
      allocate (ends(0), interface_of(0))
      do i = 1, size(interfaces)
         m = size(interfaces(i)%slave)
         points(:2, first + 1:first + m) = interfaces(i)%position
         ends = [ends, [(first + k, first + k + 1, k=1, m - 1)]]
         interface_of = [interface_of, [(i, k=1, m - 1)]]
         first = first + m
      end do
      call write_grid(file, points, ends, [(2*k, k=0, size(interface_of))], &
         [(vtk_line, k=1, size(interface_of))], labels)
      call write_geometry(file, point_group, interfaces, node_number, labels)
      call file%write(cell_group//interface_set, interface_of, as_integer, &
         'number of the *CONTACT PAIR, from 1')
   end subroutine write_head

   !> Writes the waiting rows.
   subroutine flush_contact_grid(self, file, is_new)
      class(contact_grid_type), intent(inout) :: self
      type(hdf5_writer_type), intent(inout) :: file       !! the open file, with its head
      logical, intent(in) :: is_new                       !! whether these are its first rows

      call self%flush_grid(file, is_new, geometry%name, [interface_set])
   end subroutine flush_contact_grid

end module contact_grid
