!> The accelerators of the fixed point by the names of *FIXED POINT.
module accelerators
   use controls, only: fixed_point_type, method_anderson, method_picard, &
      method_zaitsev
   use fixed_point, only: accelerator_type, anderson_type, picard_type, zaitsev_type
   use kinds, only: dp
   use newton, only: newton_type
   implicit none
   private
   public :: make_accelerator

   integer, parameter :: fewest_steps = 20   !! passes of Newton's method before another is tried

contains

   !> The accelerator that the deck asks for.
   subroutine make_accelerator(controls, points, accelerator)
      type(fixed_point_type), intent(in) :: controls
      integer, intent(in) :: points                                !! m, number of contact points
      class(accelerator_type), allocatable, intent(out) :: accelerator    !! fresh memory

      select case (controls%method)
      case (method_picard)
         allocate (picard_type :: accelerator)
         allocate (accelerator%g(points), source=1.0_dp)
      case (method_zaitsev)
         allocate (accelerator, source=zaitsev_type(constant_iterations=controls%constant))
         allocate (accelerator%g(points), source=controls%g)
      case (method_anderson)
         allocate (anderson_type :: accelerator)
         allocate (accelerator%g(points), source=controls%g)
      case default
         allocate (accelerator, source=newton_type(retreats=.true., &
            most_steps=max(controls%max_iterations, fewest_steps)))
         allocate (accelerator%g(points), source=1.0_dp)
      end select
   end subroutine make_accelerator

end module accelerators
