!> The block of an accepted increment in the listing.
module listing_increments
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use contact_states, only: status_open, status_stick
   use kinds, only: dp
   use listing_text, only: column, print_wrapped
   use records, only: attempt_record_type, contact_record_type, increment_record_type
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
      type(increment_record_type), intent(in) :: record   !! the increment
      integer :: passes

      write (unit, '(/, a, i0, a, i0, 4a)') 'INCREMENT ', record%increment, '   STEP ', &
         record%step, '   TIME ', to_text(record%time), '   LOAD ', to_text(record%load)
      if (allocated(record%failed)) call print_attempts(unit, record%failed)
      if (.not. allocated(record%iterations)) return
      passes = size(record%iterations)
      if (passes == 0) return
      write (unit, '(3x, 2(a, i0), 5a)') 'passes ', passes, '   cut-backs ', record%cut_backs, &
         '   residual', column(record%iterations(passes)%residual, 9, 2), '  (floor', &
         column(record%residual_floor, 9, 2), ')'
      if (.not. ieee_is_nan(record%coupling_gain)) write (unit, '(3x, 4a)') &
         'quasi-static coupling gain ', text_or_none(record%coupling_gain), &
         '   largest real one ', text_or_none(record%coupling_gain_max)
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
   subroutine print_interface(unit, name, contact)
      integer, intent(in) :: unit                         !! unit of the listing
      character(*), intent(in) :: name                    !! name of the interface
      type(contact_record_type), intent(in) :: contact    !! its state
      integer :: zones(3)

      zones = zone_counts(contact%status)
      write (unit, '(3x, a, 3(a, i0), 4a)') name, '   I ', zones(1), '   II ', zones(2), &
         '   III ', zones(3), '   edge of contact s = ', text_or_none(contact%edge_contact), &
         '   of stick s = ', text_or_none(contact%edge_stick)
      write (unit, '(6x, 4a)', advance='no') 'normal force', &
         column(contact%normal_force, 14, 6), '   shear force', column(contact%shear_force, 14, 6)
      if (allocated(contact%heat_flux)) then
         write (unit, '(2a)', advance='no') '   heat rate', column(contact%heat_rate, 14, 6)
      end if
      write (unit, '()')
      call print_surplus(unit, 'contact', edge_count(contact%status /= status_open))
      call print_surplus(unit, 'stick', edge_count(contact%status == status_stick))
   end subroutine print_interface

   !> Ends of zones between two pairs.
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

   function text_or_none(value) result(string)
      real(dp), intent(in) :: value
      character(:), allocatable :: string

      string = 'none'
      if (.not. ieee_is_nan(value)) string = to_text(value)
   end function text_or_none

   !> Prints what balances, and the work of the re-factorisation.
   subroutine print_balances(unit, record, analysis)
      integer, intent(in) :: unit                         !! unit of the listing
      type(increment_record_type), intent(in) :: record   !! the increment
      integer, intent(in) :: analysis                     !! one of the analysis_* constants

      if (solves_heat(analysis)) then
         write (unit, '(3x, 8a)') 'heat in', column(record%heat_in, 14, 6), '   out', &
            column(record%heat_out, 14, 6), '   heat imbalance', &
            column(record%heat_imbalance, 9, 2), '   at this instant', &
            column(record%heat_imbalance_pointwise, 9, 2)
      end if
      if (solves_mechanics(analysis)) then
         write (unit, '(3x, 4a)') 'force imbalance', column(record%force_imbalance, 9, 2), &
            '   contact conditions violated by', column(record%contact_violation, 9, 2)
      end if
      associate (work => record%work)
         if (work%columns_full > 0) write (unit, '(3x, 2(a, i0, a, i0, a, f5.1), a)') &
            'factored again ', work%columns_again, ' of ', work%columns_full, ' columns (', &
            100.0_dp*work%columns_again/work%columns_full, ' %), ', work%flops_again, ' of ', &
            work%flops_full, ' flops (', 100.0_dp*work%flops_again/max(1.0_dp, &
            real(work%flops_full, dp)), ' %)'
      end associate
   end subroutine print_balances

end module listing_increments
