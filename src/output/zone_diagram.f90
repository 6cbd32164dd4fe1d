!> The line-printer zone diagram: one row an increment, one column a contact point, I (open), II
!> (slip), III (stick).
module zone_diagram
   use contact_points, only: contact_points_type
   use kinds, only: dp
   use listing_text, only: page_type, to_right, zone_numeral
   use records, only: increment_record_type
   use text, only: to_text
   implicit none
   private
   public :: zone_diagram_type

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
   pure subroutine print_diagram(self, page, points)
      class(zone_diagram_type), intent(in) :: self
      type(page_type), intent(inout) :: page           !! of the listing
      type(contact_points_type), intent(in) :: points  !! contact points of the interface
      character(:), allocatable :: line
      integer :: m, panels, width, first, last, row, k

      m = size(points%slave)
      call page%line('')
      call page%line('ZONE DIAGRAM OF '//points%name//': '//to_text(m)//' contact points in '// &
         'columns, from s = 0 to s = '//to_text(points%arc_length(m)))
      call page%line('I open, II slip, III stick')
      panels = (m + panel_columns - 1)/panel_columns
      width = (m + panels - 1)/panels
      do first = 1, m, width
         last = min(m, first + width - 1)
         line = ' incr         load'
         do k = first, last
            line = line//to_right(to_text(k), 4)
         end do
         call page%line('')
         call page%line(line)
         do row = 1, self%rows
            line = to_right(to_text(self%increment(row)), 5)//to_right(to_text(self%load(row)), 13)
            do k = first, last
               line = line//' '//zone_numeral(self%contact_state(k, row))
            end do
            call page%line(line)
         end do
      end do
   end subroutine print_diagram

end module zone_diagram
