!> Which elements have the largest part of the error that recovery finds in stress and heat flux.
module error_marking
   use element_kinds, only: element_corner_count
   use kinds, only: dp
   use mesh, only: mesh_type
   use recovered_error, only: error_record_type
   use records, only: increment_record_type
   implicit none
   private
   public :: largest_part, squared_errors

   integer, parameter :: halvings = 50   !! of the interval that holds the least value
   !> Relative error of a body below which its fields are smooth but for rounding.
   real(dp), parameter :: rounding = 1.0e-8_dp

contains

   !> Squared error of each element: stress and heat flux of each body count by their relative
   !> errors.
   pure function squared_errors(mesh, record) result(error)
      type(mesh_type), intent(in) :: mesh
      type(increment_record_type), intent(in) :: record  !! with the fields of its end
      real(dp) :: error(size(mesh%element_kind))

      error = 0.0_dp
      call add_errors(mesh, record%stress_error, error)
      call add_errors(mesh, record%heat_flux_error, error)
   end function squared_errors

   !> Adds the part that each element has in the squared relative error of its body.
   pure subroutine add_errors(mesh, estimate, error)
      type(mesh_type), intent(in) :: mesh
      type(error_record_type), intent(in) :: estimate
      real(dp), intent(inout) :: error(:)
      real(dp) :: square(size(error)), sums(mesh%body_count)
      integer :: e

      if (.not. allocated(estimate%element)) return
      sums = 0.0_dp
      do e = 1, size(error)
         square(e) = estimate%element(e)**2*area_of(mesh, e)
         sums(mesh%element_body(e)) = sums(mesh%element_body(e)) + square(e)
      end do
      do e = 1, size(error)
         associate (b => mesh%element_body(e))
            if (sums(b) <= 0.0_dp) cycle
            if (estimate%body(b) > rounding) error(e) = error(e) + estimate%body(b)**2*square(e)/ &
               sums(b)
         end associate
      end do
   end subroutine add_errors

   !> Area of an element between its corners.
   pure real(dp) function area_of(mesh, e) result(area)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e
      integer :: corners, i

      area = 0.0_dp
      corners = element_corner_count(mesh%element_kind(e))
      do i = 1, corners
         associate (a => mesh%coordinates(:, mesh%element_nodes(i, e)), &
            b => mesh%coordinates(:, mesh%element_nodes(mod(i, corners) + 1, e)))
            area = area + 0.5_dp*(a(1)*b(2) - a(2)*b(1))
         end associate
      end do
      area = abs(area)
   end function area_of

   !> The largest values, as many as have a part of the sum of all.
   pure function largest_part(values, part) result(chosen)
      real(dp), intent(in) :: values(:)     !! not negative
      real(dp), intent(in) :: part          !! of their sum
      logical :: chosen(size(values))
      real(dp) :: high, least, middle
      integer :: k

      least = 0.0_dp
      high = maxval(values)
      do k = 1, halvings
         middle = 0.5_dp*(least + high)
         if (sum(values, mask=values >= middle) >= part*sum(values)) then
            least = middle
         else
            high = middle
         end if
      end do
      chosen = values >= least .and. values > 0.0_dp
   end function largest_part

end module error_marking
