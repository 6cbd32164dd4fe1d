!> The line-printer zone diagram: one row an increment, one column a pair, I (gap), II (slip), III
!> (stick).
module zone_diagram
   use contact_pairs, only: contact_pairs_type
   use contact_states, only: status_open, status_stick
   use kinds, only: dp
   use records, only: increment_record_type
   use text, only: to_text
   implicit none
   private
   public :: zone_diagram_type, zone_numeral, zone_counts

   integer, parameter :: panel_columns = 28   !! pairs that stand side by side on 132 columns

   !> Zones of one interface at every increment.
   type :: zone_diagram_type
      private
      integer :: rows = 0                         !! increments so far
      integer, allocatable :: increment(:)        !! (rows) their numbers
      real(dp), allocatable :: load(:)            !! (rows) their load
      integer, allocatable :: status(:, :)        !! (pairs, rows) status of the pairs
   contains
      procedure :: add
      procedure :: print => print_diagram
   end type zone_diagram_type

contains

   !> The Roman numeral of a zone, set to the right.
   pure function zone_numeral(status) result(numeral)
      integer, intent(in) :: status   !! status_open, status_slip or status_stick
      character(3) :: numeral         !! I, II or III

      if (status == status_open) then
         numeral = '  I'
      else if (status == status_stick) then
         numeral = 'III'
      else
         numeral = ' II'
      end if
   end function zone_numeral

   !> Numbers of pairs in the zones.
   pure function zone_counts(status) result(counts)
      integer, intent(in) :: status(:)   !! (pairs) status of the pairs
      integer :: counts(3)               !! pairs in zones I, II and III

      counts(1) = count(status == status_open)
      counts(3) = count(status == status_stick)
      counts(2) = size(status) - counts(1) - counts(3)
   end function zone_counts

   !> Adds an increment.
   subroutine add(self, record, status)
      class(zone_diagram_type), intent(inout) :: self
      type(increment_record_type), intent(in) :: record
      integer, intent(in) :: status(:)                   !! (pairs) status of the pairs

      if (self%rows == 0) call resize(self, size(status), 64)
      if (self%rows == size(self%load)) call resize(self, size(status), 2*self%rows)
      self%rows = self%rows + 1
      self%increment(self%rows) = record%increment
      self%load(self%rows) = record%load
      self%status(:, self%rows) = status
   end subroutine add

   subroutine resize(self, pairs, rows)
      class(zone_diagram_type), intent(inout) :: self
      integer, intent(in) :: pairs
      integer, intent(in) :: rows
      integer, allocatable :: increment(:), status(:, :)
      real(dp), allocatable :: load(:)

      allocate(increment(rows), load(rows), status(pairs, rows))
      if (self%rows > 0) then
         increment(:self%rows) = self%increment(:self%rows)
         load(:self%rows) = self%load(:self%rows)
         status(:, :self%rows) = self%status(:, :self%rows)
      end if
      call move_alloc(increment, self%increment)
      call move_alloc(load, self%load)
      call move_alloc(status, self%status)
   end subroutine resize

   !> Prints the diagram, in several panels where the pairs do not fit side by side.
   subroutine print_diagram(self, unit, pairs)
      class(zone_diagram_type), intent(in) :: self
      integer, intent(in) :: unit                      !! unit of the listing
      type(contact_pairs_type), intent(in) :: pairs    !! pairs of the interface
      integer :: m, panels, width, first, last, row, k
      character(13) :: load

      m = size(pairs%slave_node)
      write (unit, '(/, 3a, i0, 2a, /, a)') 'ZONE DIAGRAM OF ', pairs%name, ': ', m, &
         ' pairs in columns, from s = 0 to s = ', to_text(pairs%arc_length(m)), &
         'I gap, II slip, III stick'
      panels = (m + panel_columns - 1)/panel_columns
      width = (m + panels - 1)/panels
      do first = 1, m, width
         last = min(m, first + width - 1)
         write (unit, '(/, a5, a13, 28i4)') 'incr', 'load', (k, k=first, last)
         do row = 1, self%rows
            load = to_text(self%load(row))
            write (unit, '(i5, a, 28a4)') self%increment(row), adjustr(load), &
               (zone_numeral(self%status(k, row)), k=first, last)
         end do
      end do
   end subroutine print_diagram

end module zone_diagram
