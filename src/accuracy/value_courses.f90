!> How quantities vary over the last increments of a step.
module value_courses
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use kinds, only: dp
   implicit none
   private
   public :: value_courses_type, scatter_of

   integer, parameter :: needed = 9                !! values that tell a scatter
   integer, parameter :: kept = 2*needed - 1       !! as many of every second increment
   !> Standard deviation of the fourth difference of independent values, over theirs.
   real(dp), parameter :: of_difference = sqrt(70.0_dp)

   !> The quantities of all interfaces at the last increments of a step.
   type :: value_courses_type
      private
      !> (kept, quantities, interfaces) the newest last; NaN before the step
      real(dp), allocatable :: values(:, :, :)
   contains
      procedure :: follow
      procedure :: scatter
   end type value_courses_type

contains

   !> Takes the values at the end of an increment.
   pure subroutine follow(self, begins_step, values)
      class(value_courses_type), intent(inout) :: self
      logical, intent(in) :: begins_step          !! whether it is the first of a step
      real(dp), intent(in) :: values(:, :)        !! (quantities, interfaces)

      if (.not. allocated(self%values)) allocate (self%values(kept, size(values, 1), &
         size(values, 2)))
      if (begins_step) self%values = ieee_value(1.0_dp, ieee_quiet_nan)
      self%values(:kept - 1, :, :) = self%values(2:, :, :)
      self%values(kept, :, :) = values
   end subroutine follow

   !> How much the quantities of an interface scatter; NaN where they have too few values.
   pure function scatter(self, interface)
      class(value_courses_type), intent(in) :: self
      integer, intent(in) :: interface
      real(dp) :: scatter(size(self%values, 2))
      integer :: q

      do q = 1, size(scatter)
         scatter(q) = scatter_of(self%values(:, q, interface))
      end do
   end function scatter

   !> How much the last values scatter about a smooth course. Increments so short that an edge of
   !> contact passes a node only in several of them tell it over every second one.
   pure real(dp) function scatter_of(values)
      real(dp), intent(in) :: values(:)   !! (17) the newest last; NaN where there is none
      real(dp) :: longer

      scatter_of = deviation(values(needed:))
      longer = deviation(values(::2))
      if (.not. ieee_is_nan(longer)) scatter_of = max(scatter_of, longer)
   end function scatter_of

   !> The standard deviation that fourth differences tell, in which a cubic course vanishes.
   pure real(dp) function deviation(values)
      real(dp), intent(in) :: values(:)
      real(dp) :: difference(size(values) - 4)
      integer :: k

      do k = 1, size(difference)
         difference(k) = values(k) - 4*values(k + 1) + 6*values(k + 2) - 4*values(k + 3) + &
            values(k + 4)
      end do
      deviation = sqrt(sum(difference**2)/size(difference))/of_difference
   end function deviation

end module value_courses
