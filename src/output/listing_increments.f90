!> The block of an accepted increment in the listing.
module listing_increments
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values
   use contact_states, only: contact_open, contact_stick
   use increment_quantities, only: history_value
   use kinds, only: dp
   use listing_text, only: column, print_wrapped
   use quantity_types, only: needs_coupling, needs_heat, needs_mechanics, needs_nothing, &
      of_history, of_interface, quantity_type
   use records, only: attempt_record_type, contact_record_type, increment_record_type
   use reported_quantities, only: quantities
   use steps, only: solves_heat, solves_mechanics
   use text, only: to_text
   use zone_diagram, only: zone_counts
   use zone_edges, only: edges_kept
   implicit none
   private
   public :: print_increment, print_attempts, print_interface, print_balances

contains

   !> Prints which increment it is and how it converged.
   subroutine print_increment(unit, record)
      integer, intent(in) :: unit                         !! unit of the listing
      type(increment_record_type), intent(in) :: record
      integer :: passes

      write (unit, '(/, a, i0, a, i0, 4a)') 'INCREMENT ', record%increment, '   STEP ', &
         record%step, '   TIME ', to_text(record%time), '   LOAD ', to_text(record%load)
      if (allocated(record%failed)) call print_attempts(unit, record%failed)
      if (.not. allocated(record%iterations)) return
      passes = size(record%iterations)
      if (passes == 0) return
      write (unit, '(3x, 2(a, i0), 5a)') 'iterations ', passes, '   cut-backs ', record%cut_backs, &
         '   residual', column(history_value('residual', record), 9, 2), '  (floor', &
         column(history_value('residual_floor', record), 9, 2), ')'
      if (.not. ieee_is_nan(record%coupling_gain)) write (unit, '(a)') &
         history_line(needs_coupling, record)
   end subroutine print_increment

   !> Prints the attempts at an increment that failed.
   subroutine print_attempts(unit, attempts)
      integer, intent(in) :: unit                            !! unit of the listing
      type(attempt_record_type), intent(in) :: attempts(:)   !! these, in their order
      integer :: i

      do i = 1, size(attempts)
         call print_wrapped(unit, '   ', 'attempt '//to_text(i)//' of size '// &
            to_text(attempts(i)%increment_size)//', to time '//to_text(attempts(i)%time)// &
            ', failed: '//attempts(i)%reason)
      end do
   end subroutine print_attempts

   !> Prints zones, edges and sums of an interface.
   subroutine print_interface(unit, points, contact)
      integer, intent(in) :: unit                         !! unit of the listing
      type(contact_points_type), intent(in) :: points     !! the interface
      type(contact_record_type), intent(in) :: contact    !! its state
      type(quantity_type) :: quantity
      character(:), allocatable :: edges, sums
      real(dp) :: value(1)
      integer :: i, zones(3)

      edges = ''
      sums = ''
      do i = 1, size(quantities)
         if (quantities(i)%kind /= of_interface .or. quantities(i)%label == '') cycle
         quantity = quantities(i)
         if (quantity%needs == needs_heat .and. .not. allocated(contact%heat_flux)) cycle
         value = contact_values(quantity%name, points, contact)
         if (quantity%resolution > 0.0_dp) then
            edges = edges//told(quantity, value(1))
         else
            sums = sums//told(quantity, value(1))
         end if
      end do
      zones = zone_counts(contact%contact_state)
      write (unit, '(3x, a, 3(a, i0), a)') points%name, '   I ', zones(1), '   II ', zones(2), &
         '   III ', zones(3), edges
      write (unit, '(3x, a)') sums
      call print_surplus(unit, 'contact', edge_count(contact%contact_state /= contact_open))
      call print_surplus(unit, 'stick', edge_count(contact%contact_state == contact_stick))
   end subroutine print_interface

   !> The quantities of an increment that need the same, with their labels.
   pure function history_line(needs, record) result(line)
      integer, intent(in) :: needs
      type(increment_record_type), intent(in) :: record
      character(:), allocatable :: line
      type(quantity_type) :: quantity
      integer :: i

      line = ''
      do i = 1, size(quantities)
         if (quantities(i)%kind /= of_history .or. quantities(i)%needs /= needs) cycle
         quantity = quantities(i)
         if (quantity%label /= '') line = line//told(quantity, history_value(quantity%name, record))
      end do
   end function history_line

   !> A quantity with its label before it: edges and gains as one writes numbers, the others in
   !> columns.
   pure function told(quantity, value) result(words)
      type(quantity_type), intent(in) :: quantity
      real(dp), intent(in) :: value
      character(:), allocatable :: words

      words = '   '//trim(quantity%label)
      if (quantity%resolution > 0.0_dp .or. quantity%needs == needs_coupling) then
         if (ieee_is_nan(value)) then
            words = words//' none'
         else
            words = words//' '//to_text(value)
         end if
      else if (quantity%unit == '-') then
         words = words//column(value, 9, 2)
      else
         words = words//column(value, 14, 6)
      end if
   end function told

   !> Ends of zones between two contact points.
   pure integer function edge_count(in_zone)
      logical, intent(in) :: in_zone(:)

      edge_count = count(in_zone(2:) .neqv. in_zone(:size(in_zone) - 1))
   end function edge_count

   subroutine print_surplus(unit, zone, edges)
      integer, intent(in) :: unit
      character(*), intent(in) :: zone
      integer, intent(in) :: edges

      if (edges > edges_kept) write (unit, '(6x, 3a, i0, 3a, i0)') 'warning: the zones of ', &
         zone, ' have ', edges, ' edges; edges_', zone, ' of the result file holds the first ', &
         edges_kept
   end subroutine print_surplus

   !> Prints what balances, and the work of the re-factorisation.
   subroutine print_balances(unit, record, analysis)
      integer, intent(in) :: unit                         !! unit of the listing
      type(increment_record_type), intent(in) :: record
      integer, intent(in) :: analysis                     !! one of the analysis_* constants

      if (history_line(needs_nothing, record) /= '') write (unit, '(a)') &
         history_line(needs_nothing, record)
      if (solves_heat(analysis)) write (unit, '(a)') history_line(needs_heat, record)
      if (solves_mechanics(analysis)) write (unit, '(a)') history_line(needs_mechanics, record)
      associate (work => record%work)
         if (work%columns_full > 0) write (unit, '(3x, 2(a, i0, a, i0, a, f5.1), a)') &
            'refactored ', work%columns_again, ' of ', work%columns_full, ' columns (', &
            100.0_dp*work%columns_again/work%columns_full, ' %), ', work%flops_again, ' of ', &
            work%flops_full, ' flops (', 100.0_dp*work%flops_again/max(1.0_dp, &
            real(work%flops_full, dp)), ' %)'
      end associate
   end subroutine print_balances

end module listing_increments
