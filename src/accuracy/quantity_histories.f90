!> How quantities vary over the last increments of a step, and how much they scatter there.
module quantity_histories
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use kinds, only: dp
   use state_tables, only: reals, state_table_type
   implicit none
   private
   public :: quantity_histories_type, scatter_of

   integer, parameter :: needed = 9, kept = 17 !! values that tell a scatter, at least and at most

   !> The quantities of all interfaces at the last increments of a step.
   type :: quantity_histories_type
      private
      real(dp) :: time(kept) = 0.0_dp              !! ends of the increments, the newest last
      !> (kept, quantities, interfaces) likewise; NaN before the step
      real(dp), allocatable :: values(:, :, :)
      !> (3, quantities, interfaces) their last changes on a finer mesh that is followed, else 0
      real(dp), allocatable :: changes(:, :, :)
   contains
      procedure :: begin_step
      procedure :: follow
      procedure :: scatter
      procedure :: take_change
      procedure :: exchange
   end type quantity_histories_type

contains

   !> Forgets the values of the step before.
   pure subroutine begin_step(self, quantities, interfaces)
      class(quantity_histories_type), intent(inout) :: self
      integer, intent(in) :: quantities, interfaces   !! numbers of them

      if (.not. allocated(self%values)) allocate (self%values(kept, quantities, interfaces), &
         self%changes(3, quantities, interfaces))
      self%values = ieee_value(1.0_dp, ieee_quiet_nan)
      self%changes = 0.0_dp
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
      real(dp), allocatable :: changes(:), time(:), values(:)

      time = self%time
      values = [self%values]
      changes = [self%changes]
      call reals(table, 'history_time', time)
      call reals(table, 'history_values', values)
      call reals(table, 'history_changes', changes)
      self%time = time
      self%values = reshape(values, shape(self%values))
      self%changes = reshape(changes, shape(self%changes))
   end subroutine exchange

   !> Takes the changes of the quantities of an interface on a finer mesh at the end of an
   !> increment, and gives those of the last three that are largest, since at one increment one may
   !> vanish by chance.
   pure subroutine take_change(self, interface, change, largest)
      class(quantity_histories_type), intent(inout) :: self
      integer, intent(in) :: interface
      real(dp), intent(in) :: change(:)           !! (quantities) NaN: none
      real(dp), intent(out) :: largest(:)         !! (quantities) likewise

      associate (own => self%changes(:, :, interface))
         own(:2, :) = own(2:, :)
         own(3, :) = merge(0.0_dp, abs(change), ieee_is_nan(change))
         largest = merge(change, maxval(own, dim=1), ieee_is_nan(change))
      end associate
   end subroutine take_change

   !> How much the quantities of an interface scatter; NaN where they have too few values.
   pure function scatter(self, interface)
      class(quantity_histories_type), intent(in) :: self
      integer, intent(in) :: interface
      real(dp) :: scatter(size(self%values, 2))
      integer :: q

      do q = 1, size(scatter)
         scatter(q) = scatter_of(self%time, self%values(:, q, interface))
      end do
   end function scatter

   !> How much values scatter about a smooth history; NaN for too few. The deviation is that which
   !> fourth divided differences tell, in which a history that is cubic in time vanishes, whatever
   !> the increments: their median, which a corner of the history does not move.
   pure real(dp) function scatter_of(time, values)
      real(dp), intent(in) :: time(:)     !! (17) the newest last [time]
      real(dp), intent(in) :: values(:)   !! (17) likewise; NaN where there is none
      real(dp) :: difference(size(values) - 4), t(5), weight(5)
      integer :: first, i, j, k, n

      scatter_of = ieee_value(1.0_dp, ieee_quiet_nan)
      first = findloc(ieee_is_nan(values), .true., dim=1, back=.true.) + 1
      if (size(values) - first + 1 < needed) return
      n = size(difference)
      do k = first, n
         t = time(k:k + 4)
         ! Weights of the values in their divided difference, but for a factor.
         do i = 1, 5
            weight(i) = product([(t(5) - t(1), j=1, i - 1), (t(5) - t(1), j=i + 1, 5)]/ &
               [(t(i) - t(j), j=1, i - 1), (t(i) - t(j), j=i + 1, 5)])
         end do
         ! Of independent values the difference has norm2(weight) times their standard deviation.
         difference(k) = abs(dot_product(weight, values(k:k + 4) - values(k + 4)))/norm2(weight)
      end do
      scatter_of = minval(difference(first:), mask=[(2*count(difference(first:) <= difference(k)) &
         >= n - first + 1, k=first, n)])
   end function scatter_of

end module quantity_histories
