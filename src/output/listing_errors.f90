!> Estimates of errors in the listing.
module listing_errors
   use listing_text, only: column
   use records, only: increment_record_type
   implicit none
   private
   public :: print_estimates

contains

   !> Prints how large the discretisation error of each body is estimated, in the energy norm,
   !> relative to stress and heat flux, at the end of a step.
   subroutine print_estimates(unit, record)
      integer, intent(in) :: unit                         !! unit of the listing
      type(increment_record_type), intent(in) :: record   !! the increment
      integer :: b, bodies

      if (.not. record%last_of_step) return
      bodies = 0
      if (allocated(record%stress_error%body)) bodies = size(record%stress_error%body)
      if (allocated(record%heat_flux_error%body)) bodies = size(record%heat_flux_error%body)
      do b = 1, bodies
         write (unit, '(3x, a, i0)', advance='no') 'estimated error of the mesh, body ', b
         if (allocated(record%stress_error%body)) write (unit, '(2a)', advance='no') &
            '   stress', column(record%stress_error%body(b), 9, 2)
         if (allocated(record%heat_flux_error%body)) write (unit, '(2a)', advance='no') &
            '   heat flux', column(record%heat_flux_error%body(b), 9, 2)
         write (unit, '(a)') '  (energy norm, relative)'
      end do
   end subroutine print_estimates

end module listing_errors
