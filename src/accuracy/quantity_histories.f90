!> How quantities vary over the last increments of a step.
module quantity_histories
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use kinds, only: dp
   use state_tables, only: reals, state_table_type
   implicit none
   private
   public :: quantity_histories_type, scatter_of

   integer, parameter :: needed = 9                !! values that tell a scatter
   integer, parameter :: kept = 2*needed - 1       !! as many of every second increment
   real(dp), parameter :: same_time = 1.0e-6_dp    !! of an increment

   !> The quantities of all interfaces at the last increments of a step.
   type :: quantity_histories_type
      private
      real(dp) :: time(kept) = 0.0_dp              !! ends of the increments, the newest last
      real(dp), allocatable :: corners(:)          !! instants at which the loads turn [time]
      !> (kept, quantities, interfaces) likewise; NaN before the step
      real(dp), allocatable :: values(:, :, :)
   contains
      procedure :: begin_step
      procedure :: follow
      procedure :: scatter
      procedure :: exchange
   end type quantity_histories_type

contains

   !> Forgets the values of the step before.
   pure subroutine begin_step(self, quantities, interfaces, corners)
      class(quantity_histories_type), intent(inout) :: self
      integer, intent(in) :: quantities, interfaces   !! numbers of them
      real(dp), intent(in) :: corners(:)              !! instants at which the loads turn [time]

      if (.not. allocated(self%values)) allocate (self%values(kept, quantities, interfaces))
      self%values = ieee_value(1.0_dp, ieee_quiet_nan)
      self%corners = corners
   end subroutine begin_step

   !> Takes the values at the end of an increment.
   pure subroutine follow(self, time, values)
      class(quantity_histories_type), intent(inout) :: self
      real(dp), intent(in) :: time                !! that end [time]
      real(dp), intent(in) :: values(:, :)        !! (quantities, interfaces)

      self%time = [self%time(2:), time]
      self%values(:kept - 1, :, :) = self%values(2:, :, :)
      self%values(kept, :, :) = values
   end subroutine follow

   !> The values of the present step, in either direction.
   subroutine exchange(self, table)
      class(quantity_histories_type), intent(inout) :: self   !! with values where it receives them
      type(state_table_type), intent(inout) :: table
      real(dp), allocatable :: time(:), values(:)

      time = self%time
      values = [self%values]
      call reals(table, 'history_time', time)
      call reals(table, 'history_corners', self%corners)
      call reals(table, 'history_values', values)
      self%time = time
      self%values = reshape(values, shape(self%values))
   end subroutine exchange

   !> How much the quantities of an interface scatter; 0 where they have too few values.
   pure function scatter(self, interface)
      class(quantity_histories_type), intent(in) :: self
      integer, intent(in) :: interface
      real(dp) :: scatter(size(self%values, 2))
      integer :: q

      do q = 1, size(scatter)
         scatter(q) = scatter_of(self%time, self%values(:, q, interface), self%corners)
         if (ieee_is_nan(scatter(q))) scatter(q) = 0.0_dp
      end do
   end function scatter

   !> How much the last values scatter about a smooth history. Increments so short that an edge of
   !> contact passes a node only in several of them tell it over every second one.
   pure real(dp) function scatter_of(time, values, corners)
      real(dp), intent(in) :: time(:)     !! (17) the newest last [time]
      real(dp), intent(in) :: values(:)   !! (17) likewise; NaN where there is none
      real(dp), intent(in) :: corners(:)  !! instants at which the history may turn [time]
      real(dp) :: longer

      scatter_of = deviation(time(needed:), values(needed:), corners)
      longer = deviation(time(::2), values(::2), corners)
      if (.not. ieee_is_nan(longer)) scatter_of = max(scatter_of, longer)
   end function scatter_of

   !> The standard deviation that fourth divided differences tell, in which a history that is cubic
   !> in time vanishes, whatever the increments; NaN where a value is missing. Those across a corner
   !> count only where corners are so close that there are no others.
   pure real(dp) function deviation(time, values, corners)
      real(dp), intent(in) :: time(:), values(:), corners(:)
      real(dp) :: difference(size(values) - 4), t(5), weight(5)
      logical :: counts(size(values) - 4)
      integer :: i, j, k

      deviation = ieee_value(1.0_dp, ieee_quiet_nan)
      if (any(ieee_is_nan(values))) return
      do k = 1, size(difference)
         t = time(k:k + 4)
         counts(k) = .not. any(corners > t(1) + same_time*(t(2) - t(1)) .and. &
            corners < t(5) - same_time*(t(5) - t(4)))
         ! Weights of the values in their divided difference, but for a factor.
         do i = 1, 5
            weight(i) = product([(t(5) - t(1), j=1, i - 1), (t(5) - t(1), j=i + 1, 5)]/ &
               [(t(i) - t(j), j=1, i - 1), (t(i) - t(j), j=i + 1, 5)])
         end do
         ! Of independent values the difference has norm2(weight) times their standard deviation.
         difference(k) = dot_product(weight, values(k:k + 4) - values(k + 4))/norm2(weight)
      end do
      if (.not. any(counts)) counts = .true.
      deviation = sqrt(sum(difference**2, mask=counts)/count(counts))
   end function deviation

end module quantity_histories
