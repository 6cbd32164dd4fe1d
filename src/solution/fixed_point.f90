!> Accelerators of the fixed point omega = U(omega), section 4 of the paper. The loop and its
!> tolerances are the caller's; an accelerator only chooses the next omega*.
module fixed_point
   use controls, only: fixed_point_type, method_picard
   use kinds, only: dp
   implicit none
   private
   public :: accelerator_type, make_accelerator, fixed_point_residual, predicted_conductance

   !> What turns omega* and its image U(omega*) into the next omega*.
   type, abstract :: accelerator_type
      real(dp), allocatable :: g(:)   !! (m) g of the last pass
      integer :: kept = 0 !! pairs whose g was kept in the last pass, eq. (4.2) giving none
   contains
      procedure(next_interface), deferred :: next
   end type accelerator_type

   abstract interface
      !> The next omega*.
      subroutine next_interface(self, iteration, omega, image)
         import :: accelerator_type, dp
         class(accelerator_type), intent(inout) :: self  !! memory of the iteration
         integer, intent(in) :: iteration                !! pass, from 1
         real(dp), intent(inout) :: omega(:)             !! (m) omega* in, next omega* out
         real(dp), intent(in) :: image(:)                !! (m) U(omega*)
      end subroutine next_interface
   end interface

   !> Eq. (4.1): omega* = U(omega*).
   type, extends(accelerator_type) :: picard_type
   contains
      procedure :: next => next_picard
   end type picard_type

   !> Eq. (4.2): each pair mixed by its own secant.
   type, extends(accelerator_type) :: zaitsev_type
      private
      real(dp) :: constant_g = 0.5_dp            !! g of the first iterations
      integer :: constant_iterations = 3         !! their number
      real(dp), allocatable :: last_omega(:)     !! (m) omega*^(i-2)
      real(dp), allocatable :: last_image(:)     !! (m) omega^(i-1)
   contains
      procedure :: next => next_zaitsev
   end type zaitsev_type

contains

   !> The accelerator that the deck asks for.
   subroutine make_accelerator(controls, pairs, accelerator)
      type(fixed_point_type), intent(in) :: controls                      !! *FIXED POINT
      integer, intent(in) :: pairs                                        !! number of pairs
      class(accelerator_type), allocatable, intent(out) :: accelerator    !! fresh memory

      if (controls%method == method_picard) then
         allocate (picard_type :: accelerator)
         allocate (accelerator%g(pairs), source=1.0_dp)
      else
         allocate (accelerator, source=zaitsev_type(constant_g=controls%g, &
            constant_iterations=controls%constant))
         allocate (accelerator%g(pairs), source=controls%g)
      end if
   end subroutine make_accelerator

   !> omega* becomes its image.
   subroutine next_picard(self, iteration, omega, image)
      class(picard_type), intent(inout) :: self
      integer, intent(in) :: iteration
      real(dp), intent(inout) :: omega(:)
      real(dp), intent(in) :: image(:)

      if (iteration > 0) omega = image
      self%kept = 0
   end subroutine next_picard

   !> g_i = 1/(1 - tan a_i) clipped to (0, 1]. Where tan a_i >= 1 or is 0/0 the paper is silent: the
   !> pair's last g stays.
   subroutine next_zaitsev(self, iteration, omega, image)
      class(zaitsev_type), intent(inout) :: self
      integer, intent(in) :: iteration
      real(dp), intent(inout) :: omega(:)
      real(dp), intent(in) :: image(:)
      real(dp) :: star_change, tangent
      integer :: k

      self%kept = 0
      if (iteration > max(self%constant_iterations, 1)) then
         do k = 1, size(omega)
            star_change = omega(k) - self%last_omega(k)
            tangent = 1.0_dp
            if (abs(star_change) > 2*epsilon(1.0_dp)*abs(omega(k))) then
               tangent = (image(k) - self%last_image(k))/star_change
            end if
            if (tangent < 1.0_dp) then
               self%g(k) = min(1.0_dp/(1.0_dp - tangent), 1.0_dp)
            else
               self%kept = self%kept + 1
            end if
         end do
      end if
      self%last_omega = omega
      self%last_image = image
      omega = omega*(1.0_dp - self%g) + image*self%g
   end subroutine next_zaitsev

   !> max |U(omega) - omega|/omega over the pairs that carry heat.
   pure function fixed_point_residual(omega, image) result(residual)
      real(dp), intent(in) :: omega(:)   !! (m) omega*
      real(dp), intent(in) :: image(:)   !! (m) U(omega*)
      real(dp) :: residual               !! relative residual
      integer :: k

      residual = 0.0_dp
      do k = 1, size(omega)
         if (omega(k) > 0.0_dp) then
            residual = max(residual, abs(image(k) - omega(k))/omega(k))
         else if (image(k) > 0.0_dp) then
            residual = max(residual, 1.0_dp)
         end if
      end do
   end function fixed_point_residual

   !> omega*^0 of an increment, below (4.2): linear extrapolation; where that is not positive
   !> omega_i is kept.
   elemental function predicted_conductance(omega, omega_before, step_ratio) result(predicted)
      real(dp), intent(in) :: omega          !! omega_i
      real(dp), intent(in) :: omega_before   !! omega_(i-1)
      real(dp), intent(in) :: step_ratio     !! dt_i/dt_(i-1)
      real(dp) :: predicted                  !! omega*^0 of the next increment

      predicted = omega + (omega - omega_before)*step_ratio
      if (predicted <= 0.0_dp) predicted = omega
   end function predicted_conductance

end module fixed_point
