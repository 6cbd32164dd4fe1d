!> The bound of each number from its parts, or the reason why it has none.
module summed_bounds
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use contact_points, only: contact_points_type
   use contact_quantities, only: estimated
   use doubled_increments, only: doubled_increments_type
   use interface_quantities, only: peaks_at_corner, turns_at_peak
   use kinds, only: dp
   use no_estimates, only: at_corner, first_reason, no_doubled_edge, no_finer_edge, no_reason, &
      not_doubled, not_on_finer_mesh, out_of_equilibrium, reason_count, single_increment, &
      slides_far, turns_round
   use quantity_types, only: find_quantity
   use records, only: body_errors_type, contact_record_type, interface_errors_type
   implicit none
   private
   public :: sum_up_body, sum_up_interface

contains

   !> The bounds of an interface.
   subroutine sum_up_interface(doubled, has_fine, is_mixed, points, contact, errors)
      type(doubled_increments_type), intent(in) :: doubled
      logical, intent(in) :: has_fine            !! whether the mesh with halved elements was solved
      logical, intent(in) :: is_mixed            !! whether its bodies differ in stiffness
      type(contact_points_type), intent(in) :: points
      type(contact_record_type), intent(in) :: contact
      class(interface_errors_type), intent(inout) :: errors   !! value and parts in
      logical :: holds(reason_count), of_peak(reason_count)

      holds = .false.
      holds(slides_far) = contact%slide%point > 0
      of_peak = holds
      of_peak(at_corner) = peaks_at_corner(points, contact)
      of_peak(turns_round) = is_mixed .and. turns_at_peak(points, contact)
      call sum_up(doubled, has_fine, holds, errors, find_quantity(estimated, 'peak_pressure'), &
         of_peak)
   end subroutine sum_up_interface

   !> The bounds of the maxima of a body.
   subroutine sum_up_body(doubled, has_fine, is_steady, slides, errors)
      type(doubled_increments_type), intent(in) :: doubled
      logical, intent(in) :: has_fine            !! whether the mesh with halved elements was solved
      logical, intent(in) :: is_steady           !! whether nothing depends on the past
      logical, intent(in) :: slides              !! whether an interface slides beyond its points
      type(body_errors_type), intent(inout) :: errors         !! value and parts in
      logical :: holds(reason_count)

      holds = .false.
      holds(slides_far) = slides
      holds(out_of_equilibrium) = .not. is_steady
      call sum_up(doubled, has_fine, holds, errors, 0, holds)
   end subroutine sum_up_body

   !> Adds up the parts of each bound. A quantity with a reason that holds has NaN and that reason.
   subroutine sum_up(doubled, has_fine, holds, errors, peak, of_peak)
      type(doubled_increments_type), intent(in) :: doubled
      logical, intent(in) :: has_fine
      logical, intent(in) :: holds(reason_count)              ! of all quantities
      class(interface_errors_type), intent(inout) :: errors
      integer, intent(in) :: peak                             ! a quantity, or 0
      logical, intent(in) :: of_peak(reason_count)            ! what holds of it
      logical :: of_this(reason_count)
      integer :: q

      if (.not. allocated(errors%no_estimate)) allocate (errors%no_estimate(size(errors%value)))
      do q = 1, size(errors%value)
         of_this = merge(of_peak, holds, q == peak)
         if (any(of_this)) errors%mesh(q) = ieee_value(1.0_dp, ieee_quiet_nan)
         associate (no_increment => ieee_is_nan(errors%increment(q)))
            of_this(single_increment) = no_increment .and. .not. doubled%has_doubled
            of_this(not_doubled) = no_increment .and. doubled%is_lost
            of_this(no_doubled_edge) = no_increment
         end associate
         of_this(not_on_finer_mesh) = .not. has_fine
         of_this(no_finer_edge) = .true.
         errors%no_estimate(q) = merge(first_reason(of_this), no_reason, ieee_is_nan( &
            errors%mesh(q) + errors%increment(q)) .and. .not. ieee_is_nan(errors%value(q)))
      end do
      errors%bound = errors%mesh + errors%increment + errors%iteration
   end subroutine sum_up

end module summed_bounds
