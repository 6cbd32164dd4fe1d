!> The line-printer zone diagram: one row an increment, one column a contact point, I (open), II
!> (slip), III (stick).
module zone_diagram
   use contact_points, only: contact_points_type
   use contact_system, only: contact_open, contact_stick
   use kinds, only: dp
   use records, only: increment_record_type
   use text, only: to_text
   implicit none
   private
   public :: zone_diagram_type, zone_numeral, zone_counts

   integer, parameter :: panel_columns = 28 !! contact points that are side by side on 132 columns

   !> Zones of one interface at every increment.
   type :: zone_diagram_type
      private
      integer :: rows = 0                         !! increments so far
      integer, allocatable :: increment(:)        !! (rows) their numbers
      real(dp), allocatable :: load(:)            !! (rows) their load
      integer, allocatable :: contact_state(:, :) !! (contact points, rows) contact states
   contains
      procedure :: add
      procedure :: print => print_diagram
   end type zone_diagram_type

contains

   !> The Roman numeral of a zone, set to the right.
   pure function zone_numeral(contact_state) result(numeral)
      integer, intent(in) :: contact_state !! contact_open, contact_slip or contact_stick
      character(3) :: numeral         !! I, II or III

      if (contact_state == contact_open) then
         numeral = '  I'
      else if (contact_state == contact_stick) then
         numeral = 'III'
      else
         numeral = ' II'
      end if
   end function zone_numeral

   !> Numbers of contact points in the zones.
   pure function zone_counts(contact_state) result(counts)
      integer, intent(in) :: contact_state(:) !! (contact points) contact states
      integer :: counts(3)               !! contact points in zones I, II and III

      counts(1) = count(contact_state == contact_open)
      counts(3) = count(contact_state == contact_stick)
      counts(2) = size(contact_state) - counts(1) - counts(3)
   end function zone_counts

   !> Adds an increment.
   subroutine add(self, record, contact_state)
      class(zone_diagram_type), intent(inout) :: self
      type(increment_record_type), intent(in) :: record
      integer, intent(in) :: contact_state(:)            !! (contact points) contact states
      integer :: n

      if (.not. allocated(self%load)) allocate (self%increment(0), self%load(0), &
         self%contact_state(size(contact_state), 0))
      if (self%rows == size(self%load)) then
         n = max(64, 2*self%rows)
         self%increment = reshape(self%increment, [n], pad=[0])
         self%load = reshape(self%load, [n], pad=[0.0_dp])
         self%contact_state = reshape(self%contact_state, [size(contact_state), n], pad=[0])
      end if
      self%rows = self%rows + 1
      self%increment(self%rows) = record%increment
      self%load(self%rows) = record%load
      self%contact_state(:, self%rows) = contact_state
   end subroutine add

   !> Prints the diagram, in several panels where the contact points do not fit side by side.
   subroutine print_diagram(self, unit, points)
      class(zone_diagram_type), intent(in) :: self
      integer, intent(in) :: unit                      !! unit of the listing
      type(contact_points_type), intent(in) :: points  !! contact points of the interface
      integer :: m, panels, width, first, last, row, k
      character(13) :: load

      m = size(points%slave)
      write (unit, '(/, 3a, i0, 2a, /, a)') 'ZONE DIAGRAM OF ', points%name, ': ', m, &
         ' contact points in columns, from s = 0 to s = ', to_text(points%arc_length(m)), &
         'I open, II slip, III stick'
      panels = (m + panel_columns - 1)/panel_columns
      width = (m + panels - 1)/panels
      do first = 1, m, width
         last = min(m, first + width - 1)
         write (unit, '(/, a5, a13, 28i4)') 'incr', 'load', (k, k=first, last)
         do row = 1, self%rows
            load = to_text(self%load(row))
            write (unit, '(i5, a, 28a4)') self%increment(row), adjustr(load), &
               (zone_numeral(self%contact_state(k, row)), k=first, last)
         end do
      end do
   end subroutine print_diagram

end module zone_diagram
