!> Tables of the listing: *CONTACT PRINT, the iteration history, the *VERIFY verdicts.
module listing_tables
   use contact_pairs, only: contact_pairs_type
   use listing_text, only: column
   use model, only: verify_type
   use records, only: contact_record_type
   use run_summaries, only: or_blank
   use solution_report, only: iteration_record_type
   use text, only: to_text
   use verification, only: outcome_type
   use zone_diagram, only: zone_numeral
   implicit none
   private
   public :: print_contact_table, print_iterations, print_verdicts

contains

   !> Prints the pairs of an interface in fixed columns (*CONTACT PRINT); without heat the last four
   !> are left out.
   subroutine print_contact_table(unit, pairs, contact, node_number)
      integer, intent(in) :: unit                         !! unit of the listing
      type(contact_pairs_type), intent(in) :: pairs       !! pairs of the interface
      type(contact_record_type), intent(in) :: contact    !! their state
      integer, intent(in) :: node_number(:)               !! (nodes) numbers in the deck
      logical :: has_heat
      integer :: k

      has_heat = allocated(contact%conductance)
      write (unit, '(/, 2a)') '   CONTACT PAIRS OF ', pairs%name
      write (unit, '(a4, 2a8, 2a11, a5, 2a10, 2a11)', advance='no') 'pair', 'slave', 'master', &
         'x', 'y', 'zone', 'gap', 'p', 'tau', 'slip'
      if (has_heat) write (unit, '(2a11, a10, a11)', advance='no') 'T1', 'T2', 'omega', 'q'
      write (unit, '()')
      do k = 1, size(pairs%slave_node)
         write (unit, '(i4, 2i8, 2a, a5, 4a)', advance='no') k, &
            node_number(pairs%slave_node(k)), node_number(pairs%master_node(k)), &
            column(pairs%position(1, k), 11, 3), column(pairs%position(2, k), 11, 3), &
            adjustr('  '//zone_numeral(contact%status(k))), column(contact%gap(k), 10, 3), &
            column(contact%pressure(k), 10, 3), column(contact%shear(k), 11, 3), &
            column(contact%slip(k), 11, 3)
         if (has_heat) write (unit, '(4a)', advance='no') &
            column(contact%slave_temperature(k), 11, 3), &
            column(contact%master_temperature(k), 11, 3), column(contact%conductance(k), 10, 3), &
            column(contact%heat_flux(k), 11, 3)
         write (unit, '()')
      end do
   end subroutine print_contact_table

   !> Prints the passes of an increment.
   subroutine print_iterations(unit, iterations)
      integer, intent(in) :: unit                               !! unit of the listing
      type(iteration_record_type), intent(in) :: iterations(:)  !! passes, in their order
      integer :: i

      write (unit, '(/, a)') '   ITERATION HISTORY'
      write (unit, '(a12, a11, a12, 2a11, a8, a15, a11)') 'increment', 'iteration', 'residual', &
         'g min', 'g max', 'g kept', 'pairs changed', 'cut-backs'
      do i = 1, size(iterations)
         associate (pass => iterations(i))
            write (unit, '(i12, i11, a, 2f11.6, i8, i15, i11)') pass%increment, &
               pass%iteration, column(pass%residual, 12, 3), pass%g_min, pass%g_max, pass%g_kept, &
               pass%pairs_changed, pass%cut_backs
         end associate
      end do
   end subroutine print_iterations

   !> Prints what came of the *VERIFY cards.
   subroutine print_verdicts(unit, checks, outcomes)
      integer, intent(in) :: unit                    !! unit of the listing
      type(verify_type), intent(in) :: checks(:)     !! the checks
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
   end subroutine print_verdict

end module listing_tables
