!> What rows of a trade are compared by: figures of every interface and temperatures, at instants
!> that all rows meet.
module trade_quantities
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values
   use errors, only: error_type, set_error, status_internal
   use interface_quantities, only: closed_length
   use kinds, only: dp
   use records, only: increment_record_type
   use reported_quantities, only: traded
   implicit none
   private
   public :: row_values_type, is_there
   public :: quantity_count, figure_count, temperature, figure, absent

   integer, parameter :: quantity_count = size(traded)   !! quantities that rows are judged by
   integer, parameter :: temperature = quantity_count    !! the last: of the nodes, the worst
   integer, parameter :: figure_count = quantity_count - 1   !! the others: a number an interface

   real(dp), parameter :: absent = -1.0e300_dp   !! in place of what there is none of

   !> What a row found.
   type :: row_values_type
      integer :: increments = 0                        !! increments that were accepted
      integer :: passes = 0                            !! passes of the fixed point in all of them
      real(dp) :: imbalance = 0.0_dp !! largest of heat at the end of an increment, relative
      !> (figure_count, interfaces or 1 without, instants); absent where there is none
      real(dp), allocatable :: figures(:, :, :)
      real(dp), allocatable :: length(:, :)     !! (contact points, instants) closed length [length]
      real(dp), allocatable :: temperatures(:, :)      !! (nodes, instants), 0 nodes without heat
   contains
      procedure :: prepare
      procedure :: sample
      procedure :: save => save_values
      procedure :: load => load_values
   end type row_values_type

contains

   !> Whether there is a value.
   elemental logical function is_there(value)
      real(dp), intent(in) :: value   !! a value, or absent

      is_there = value > 0.5_dp*absent
   end function is_there

   !> Makes room; nothing is there yet.
   pure subroutine prepare(self, interfaces, nodes, instants)
      class(row_values_type), intent(inout) :: self
      integer, intent(in) :: interfaces               !! number of interfaces
      integer, intent(in) :: nodes                    !! nodes whose temperature is compared
      integer, intent(in) :: instants                 !! instants at which rows are compared

      allocate (self%figures(figure_count, max(interfaces, 1), instants), source=absent)
      allocate (self%length(max(interfaces, 1), instants), source=0.0_dp)
      allocate (self%temperatures(nodes, instants), source=absent)
   end subroutine prepare

   !> Takes what there is at an instant.
   subroutine sample(self, record, interfaces, nodes, instant)
      class(row_values_type), intent(inout) :: self
      type(increment_record_type), intent(in) :: record     !! the increment that ends there
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      integer, intent(in) :: nodes(:)                       !! (nodes) indexes
      integer, intent(in) :: instant                        !! which instant
      integer :: i, q

      self%temperatures(:, instant) = record%fields%temperature(nodes)
      ! Without contact the heat that enters stands for that through the contact.
      if (size(interfaces) == 0) self%figures(figure('heat_rate'), 1, instant) = &
         finite(record%heat_in)
      do i = 1, size(interfaces)
         do q = 1, figure_count
            self%figures(q:q, i, instant) = finite(contact_values(traded(q)%name, interfaces(i), &
               record%contacts(i)))
         end do
         self%length(i, instant) = closed_length(record%contacts(i), interfaces(i)%arc_length)
      end do
   end subroutine sample

   !> Index of a figure by the name of its quantity.
   pure integer function figure(name)
      character(*), intent(in) :: name   !! one of traded

      do figure = figure_count, 1, -1
         if (traded(figure)%name == name) return
      end do
   end function figure

   !> A number, or absent in place of none.
   elemental real(dp) function finite(number)
      real(dp), intent(in) :: number

      finite = absent
      if (ieee_is_finite(number)) finite = number
   end function finite

   !> Writes the values into a file, which a parent process reads.
   subroutine save_values(self, path)
      class(row_values_type), intent(in) :: self
      character(*), intent(in) :: path             !! the file
      integer :: unit, io

      open (newunit=unit, file=path, access='stream', form='unformatted', status='replace', &
         action='write', iostat=io)
      if (io /= 0) return
      write (unit, iostat=io) self%increments, self%passes, self%imbalance, allocated(self%figures)
      if (io == 0 .and. allocated(self%figures)) write (unit, iostat=io) shape(self%figures), &
         size(self%temperatures, 1), self%figures, self%length, self%temperatures
      if (io == 0) then
         close (unit)
      else
         close (unit, status='delete')
      end if
   end subroutine save_values

   !> Reads what save_values wrote, and removes the file.
   !> Error: status_internal, when there is no whole file.
   subroutine load_values(self, path, error)
      class(row_values_type), intent(inout) :: self
      character(*), intent(in) :: path                       !! the file
      type(error_type), allocatable, intent(out) :: error
      integer :: unit, io, n(4)
      logical :: has_figures

      open (newunit=unit, file=path, access='stream', form='unformatted', status='old', iostat=io)
      if (io == 0) then
         read (unit, iostat=io) self%increments, self%passes, self%imbalance, has_figures
         if (io == 0 .and. has_figures) then
            read (unit, iostat=io) n
            if (io == 0) call self%prepare(n(2), n(4), n(3))
            if (io == 0) read (unit, iostat=io) self%figures, self%length, self%temperatures
         end if
         close (unit, status='delete')
      end if
      if (io /= 0) call set_error(error, status_internal, 'a row left no values')
   end subroutine load_values

end module trade_quantities
