!> Tables of the listing: *CONTACT PRINT, the iteration history, the *VERIFY verdicts.
module listing_tables
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values, geometry_values
   use increment_quantities, only: pass_value
   use kinds, only: dp
   use listing_text, only: column, table_cell, table_head
   use model, only: verify_type
   use quantity_types, only: needs_heat, of_contact_points, of_passes, quantity_type
   use records, only: contact_record_type
   use reported_quantities, only: quantities
   use run_summaries, only: or_blank
   use solution_report, only: iteration_record_type
   use text, only: to_text
   use verification, only: bound_words, outcome_type
   implicit none
   private
   public :: print_contact_table, print_iterations, print_verdicts

contains

   !> Prints the contact points of an interface in fixed columns (*CONTACT PRINT); without heat the
   !> last four are left out.
   subroutine print_contact_table(unit, points, contact, node_number)
      integer, intent(in) :: unit                         !! unit of the listing
      type(contact_points_type), intent(in) :: points     !! contact points of the interface
      type(contact_record_type), intent(in) :: contact    !! their state
      integer, intent(in) :: node_number(:)               !! (nodes) numbers in the deck
      type(quantity_type), allocatable :: columns(:)
      real(dp), allocatable :: values(:, :)
      integer :: i, k, n

      columns = pack(quantities, quantities%kind == of_contact_points .and. &
         quantities%width > 0 .and. (quantities%needs /= needs_heat .or. &
         allocated(contact%conductance)))
      n = size(columns)
      allocate (values(size(points%slave_node), n))
      do i = 1, n
         if (columns(i)%is_geometry) then
            values(:, i) = geometry_values(columns(i)%name, points, node_number)
         else
            values(:, i) = contact_values(columns(i)%name, points, contact)
         end if
      end do
      write (unit, '(/, 2a)') '   CONTACT POINTS OF ', points%name
      write (unit, '(*(a))') ' no.', (table_head(columns(i)), i=1, n)
      do k = 1, size(values, 1)
         write (unit, '(i4, *(a))') k, (table_cell(columns(i), values(k, i)), i=1, n)
      end do
   end subroutine print_contact_table

   !> Prints the passes of an increment.
   subroutine print_iterations(unit, iterations)
      integer, intent(in) :: unit                               !! unit of the listing
      type(iteration_record_type), intent(in) :: iterations(:)  !! passes, in their order
      type(quantity_type), allocatable :: columns(:)
      integer :: i, k

      columns = pack(quantities, quantities%kind == of_passes)
      write (unit, '(/, a)') '   ITERATION HISTORY'
      write (unit, '(*(a))') (table_head(columns(i)), i=1, size(columns))
      do k = 1, size(iterations)
         write (unit, '(*(a))') (table_cell(columns(i), pass_value(columns(i)%name, &
            iterations(k))), i=1, size(columns))
      end do
   end subroutine print_iterations

   !> Prints what came of the *VERIFY cards.
   subroutine print_verdicts(unit, checks, outcomes)
      integer, intent(in) :: unit                    !! unit of the listing
      type(verify_type), intent(in) :: checks(:)
      type(outcome_type), intent(in) :: outcomes(:)  !! what came of each
      integer :: i

      write (unit, '(/, a)') 'VERIFICATION'
      write (unit, '(a6, 2x, a10, 1x, a24, 1x, a16, a11, 2a15, 2a10, a9)') 'card', &
         'kind      ', 'quantity                ', 'where           ', 'time', 'expected', &
         'found', 'deviation', 'allowed', 'verdict'
      do i = 1, size(checks)
         call print_verdict(unit, checks(i), outcomes(i))
      end do
      write (unit, '(/, 3x, i0, a, i0, a)') count(outcomes%passed), ' passed, ', &
         count(.not. outcomes%passed), ' failed'
   end subroutine print_verdicts

   subroutine print_verdict(unit, check, outcome)
      integer, intent(in) :: unit
      type(verify_type), intent(in) :: check
      type(outcome_type), intent(in) :: outcome
      character(10) :: kind
      character(24) :: quantity
      character(16) :: where
      character(11) :: time
      character(15) :: found
      character(10) :: deviation

      kind = or_blank(check%kind)
      quantity = check%quantity
      where = or_blank(check%where)
      time = 'LAST'
      if (.not. check%at_last) time = to_text(check%when)
      found = '-'
      deviation = '-'
      if (outcome%reason == '') then
         found = column(outcome%found, 15, 7)
         deviation = column(outcome%deviation, 10, 2)
      end if
      write (unit, '(i6, 2x, a, 1x, a, 1x, 6a, a4, a5)') check%line, kind, quantity, where, &
         adjustr(time), column(check%value, 15, 7), adjustr(found), adjustr(deviation), &
         column(check%tolerance, 10, 2), merge(' REL', ' ABS', check%relative), &
         merge(' PASS', ' FAIL', outcome%passed)
      if (or_blank(check%source) /= '') write (unit, '(8x, 2a)') 'source: ', check%source
      if (outcome%reason /= '') write (unit, '(8x, 2a)') 'failed: ', outcome%reason
      if (allocated(outcome%bound)) write (unit, '(8x, 3a)') 'found:  ', to_text(outcome%found), &
         bound_words(outcome)
   end subroutine print_verdict

end module listing_tables
