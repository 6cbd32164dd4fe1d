!> Tables of the listing: *CONTACT PRINT, *NODE PRINT, *EL PRINT, the iteration history, the *VERIFY
!> verdicts, zone diagrams.
module listing_tables
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values, geometry_values, has_quantity
   use increment_quantities, only: pass_value
   use kinds, only: dp
   use listing_text, only: column, in_columns, page_type, table_heads, table_row, to_right, &
      zone_numeral
   use model, only: model_type, uncertainty_full, verify_type
   use no_estimates, only: mark_of, of_points
   use quantity_types, only: of_contact_points, of_passes, quantity_type
   use records, only: contact_record_type, increment_record_type
   use reported_quantities, only: quantities
   use requested_tables, only: requested_table_type, table_column_type
   use solution_report, only: iteration_record_type
   use text, only: or_blank, string_type, to_text
   use verification, only: node_words, outcome_type, uncertainty_words
   implicit none
   private
   public :: print_contact_table, print_iterations, print_requested, print_verdicts, &
      uncertainties_of, zone_diagram_type

   character(*), parameter :: uncertainties_of = 'UNCERTAINTIES (95 %) OF '

   character(*), parameter :: node_head = '    node           x           y'
   character(*), parameter :: point_head = ' element point           x           y'

   integer, parameter :: panel_columns = 28 !! contact points that are side by side on 132 columns

   !> The line-printer zone diagram of an interface: one row an increment, one column a contact
   !> point, I (open), II (slip), III (stick).
   type :: zone_diagram_type
      private
      integer :: rows = 0                         !! increments so far
      integer, allocatable :: increment(:)        !! (rows) their numbers
      real(dp), allocatable :: load(:)            !! (rows) their load
      integer, allocatable :: contact_state(:, :) !! (contact points, rows) contact states
   contains
      procedure :: add => add_increment
      procedure :: print => print_diagram
   end type zone_diagram_type

contains

   !> Prints the contact points of an interface in fixed columns (*CONTACT PRINT), or the
   !> uncertainties of their numbers; without heat the last four are left out.
   subroutine print_contact_table(page, points, contact, node_number, title)
      type(page_type), intent(inout) :: page              !! of the listing
      type(contact_points_type), intent(in) :: points     !! contact points of the interface
      type(contact_record_type), intent(in) :: contact    !! their state
      integer, intent(in) :: node_number(:)               !! (nodes) numbers in the deck
      character(*), intent(in) :: title                   !! before the name of the interface
      type(quantity_type), allocatable :: columns(:)
      real(dp), allocatable :: values(:, :)
      type(string_type), allocatable :: rows(:)
      integer :: i

      columns = pack(quantities, quantities%kind == of_contact_points .and. &
         quantities%width > 0 .and. has_quantity(contact, quantities%needs))
      allocate (values(size(points%slave), size(columns)), rows(0:size(points%slave)))
      do i = 1, size(columns)
         if (columns(i)%is_geometry) then
            values(:, i) = geometry_values(columns(i)%name, points, node_number)
         else
            values(:, i) = contact_values(columns(i)%name, contact)
         end if
      end do
      rows(0)%value = ' no.'//table_heads(columns)
      do i = 1, size(points%slave)
         rows(i)%value = to_right(to_text(i), 4)//table_row(columns, values(i, :))
      end do
      call page%table('   '//title//points%name, rows)
   end subroutine print_contact_table

   !> Prints the passes of an increment.
   subroutine print_iterations(page, iterations)
      type(page_type), intent(inout) :: page                    !! of the listing
      type(iteration_record_type), intent(in) :: iterations(:)  !! passes, in their order
      type(quantity_type), allocatable :: columns(:)
      type(string_type) :: rows(0:size(iterations))
      integer :: i, k

      columns = pack(quantities, quantities%kind == of_passes)
      rows(0)%value = table_heads(columns)
      do k = 1, size(iterations)
         rows(k)%value = table_row(columns, [(pass_value(columns(i)%name, iterations(k)), &
            i=1, size(columns))])
      end do
      call page%table('   ITERATION HISTORY', rows)
   end subroutine print_iterations

   !> Prints what came of the *VERIFY cards.
   subroutine print_verdicts(page, checks, outcomes)
      type(page_type), intent(inout) :: page         !! of the listing
      type(verify_type), intent(in) :: checks(:)
      type(outcome_type), intent(in) :: outcomes(:)  !! what came of each
      integer :: i

      call page%line('')
      call page%line('VERIFICATION')
      call page%line('  card  kind       quantity                 where                  time'// &
         '       expected          found deviation   allowed  verdict')
      do i = 1, size(checks)
         call print_verdict(page, checks(i), outcomes(i))
      end do
      call page%line('')
      call page%line('   '//to_text(count(outcomes%passed .and. checks%expects))//' passed, '// &
         to_text(count(outcomes%judged .and. .not. outcomes%passed))//' failed, '// &
         to_text(count(.not. outcomes%judged))//' not judged')
   end subroutine print_verdicts

   subroutine print_verdict(page, check, outcome)
      type(page_type), intent(inout) :: page
      type(verify_type), intent(in) :: check
      type(outcome_type), intent(in) :: outcome
      character(10) :: kind
      character(max(24, len(check%title()))) :: quantity
      character(16) :: where
      character(:), allocatable :: allowed, deviation, expected, found, time, verdict

      kind = or_blank(check%kind)
      quantity = check%title()
      where = or_blank(check%where)
      time = 'LAST'
      if (.not. check%at_last) time = to_text(check%when)
      found = to_right('-', 15)
      if (outcome%reason == '') found = column(outcome%found, 15, 7)
      expected = to_right('-', 15)
      deviation = to_right('-', 10)
      allowed = deviation
      if (check%expects) then
         expected = column(check%value, 15, 7)
         if (outcome%reason == '') deviation = column(outcome%deviation, 10, 2)
         allowed = column(check%tolerance, 10, 2)
      end if
      verdict = '-'
      if (check%expects .and. outcome%judged) verdict = merge('PASS', 'FAIL', outcome%passed)
      call page%line(to_right(to_text(check%line), 6)//'  '//kind//' '//quantity//' '//where// &
         to_right(time, 11)//expected//found//deviation//allowed// &
         merge(' REL', ' ABS', check%relative)//to_right(verdict, 5))
      if (or_blank(check%source) /= '') call page%line('        source: '//check%source)
      if (outcome%reason /= '') call page%line('        '//trim(merge('failed:  ', 'no value:', &
         check%expects))//' '//outcome%reason)
      if (uncertainty_words(outcome)//node_words(outcome) /= '') call page%line( &
         '        found:  '//to_text(outcome%found)//uncertainty_words(outcome)// &
         node_words(outcome))
   end subroutine print_verdict

   !> Prints tables of *NODE PRINT and *EL PRINT.
   subroutine print_requested(page, tables, model)
      type(page_type), intent(inout) :: page                 !! of the listing
      type(requested_table_type), intent(in) :: tables(:)    !! those that are due
      type(model_type), intent(in) :: model
      integer :: i

      do i = 1, size(tables)
         if (tables(i)%is_of_nodes) then
            call print_nodes(page, tables(i), model%mesh%node_number)
         else
            call print_points(page, tables(i), model)
         end if
      end do
   end subroutine print_requested

   !> Table of the nodes of a set and sums over them, or of the uncertainties of both.
   subroutine print_nodes(page, table, node_number)
      type(page_type), intent(inout) :: page
      type(requested_table_type), intent(in) :: table
      integer, intent(in) :: node_number(:)               ! (nodes) numbers in the deck
      type(string_type) :: rows(0:size(table%member)), totals(0:1)
      character(:), allocatable :: title
      integer :: i

      title = '   '
      if (table%has_uncertainties) title = title//uncertainties_of
      do i = 1, size(table%absent)
         if (table%has_uncertainties) then
            call page%line('')
            call page%line(title//'NODES OF '//table%set//': '//trim(table%absent(i))// &
               mark_of(of_points))
         else
            call print_absence(page, '   NODES OF '//table%set, table%absent(i))
         end if
      end do
      rows(0)%value = node_head
      do i = 1, size(table%member)
         rows(i)%value = to_right(to_text(node_number(table%member(i))), 8)// &
            in_columns(table%position(:, i), 12, 4)
      end do
      call add(rows, table%columns)
      if (len(rows(0)%value) > len(node_head)) call page%table(title//'NODES OF '//table%set, rows)
      totals(0)%value = ''
      totals(1)%value = ''
      call add(totals, table%totals)
      if (totals(0)%value /= '') call page%table(title//'TOTALS OF '//table%set, totals)
   end subroutine print_nodes

   !> Adds columns with values to the rows of a table, the first of which is its head.
   pure subroutine add(rows, columns)
      type(string_type), intent(inout) :: rows(0:)
      type(table_column_type), intent(in) :: columns(:)
      integer :: i, k

      do i = 1, size(columns)
         if (.not. allocated(columns(i)%values)) cycle
         rows(0)%value = rows(0)%value//to_right(trim(columns(i)%head), 14)
         do k = 1, size(columns(i)%values)
            rows(k)%value = rows(k)%value//in_columns(columns(i)%values(k:k), 14, 6)
         end do
      end do
   end subroutine add

   !> Table of the integration points of the elements of a set.
   subroutine print_points(page, table, model)
      type(page_type), intent(inout) :: page
      type(requested_table_type), intent(in) :: table
      type(model_type), intent(in) :: model
      character(:), allocatable :: title
      type(string_type) :: rows(0:size(table%member))
      integer :: i

      title = '   INTEGRATION POINTS OF '//table%set
      do i = 1, size(table%absent)
         call print_absence(page, title, table%absent(i))
      end do
      if (model%uncertainty == uncertainty_full) title = title//mark_of(of_points)
      rows(0)%value = point_head
      do i = 1, size(table%member)
         rows(i)%value = to_right(to_text(model%mesh%element_number(table%member(i))), 8)// &
            to_right(to_text(table%point(i)), 6)//in_columns(table%position(:, i), 12, 4)
      end do
      call add(rows, table%columns)
      if (rows(0)%value == point_head .and. size(table%columns) > 0) return
      do i = 1, size(table%member)
         if (table%axes(i) > 0) rows(i)%value = rows(i)%value//' '// &
            model%orientations(table%axes(i))%name
      end do
      call page%table(title, rows)
   end subroutine print_points

   subroutine print_absence(page, title, key)
      type(page_type), intent(inout) :: page
      character(*), intent(in) :: title
      character(*), intent(in) :: key          ! of what is not there

      call page%line('')
      call page%line(title//': there is no '//trim(key)//' at this increment')
   end subroutine print_absence

   !> Adds an increment to a zone diagram.
   subroutine add_increment(self, record, contact_state)
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
   end subroutine add_increment

   !> Prints a zone diagram, in several panels where the contact points do not fit side by side.
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

end module listing_tables
