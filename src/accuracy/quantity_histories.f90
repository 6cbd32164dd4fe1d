!> How quantities vary over the last increments of a step, and how much they scatter there.
module quantity_histories
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use kinds, only: dp
   use state_tables, only: integers, reals, state_table_type
   implicit none
   private
   public :: quantity_histories_type, scatter_of

   integer, parameter :: needed = 9, kept = 17 !! values that tell a scatter, at least and at most

   !> The quantities of all interfaces at the last increments of a step.
   type :: quantity_histories_type
      private
      integer :: step = 0                          !! the step
      real(dp) :: time(kept) = 0.0_dp              !! ends of the increments, the newest last
      !> (kept, quantities, interfaces) likewise; NaN before the step
      real(dp), allocatable :: values(:, :, :)
      !> (3, quantities, interfaces) their last changes on a finer mesh, 0 before the step
      real(dp), allocatable :: changes(:, :, :)
   contains
      procedure :: follow
      procedure :: take_change
      procedure :: exchange
   end type quantity_histories_type

contains

   !> Takes the values at the end of an increment.
   pure subroutine follow(self, step, time, values)
      class(quantity_histories_type), intent(inout) :: self
      integer, intent(in) :: step                 !! its step; those of another one are forgotten
      real(dp), intent(in) :: time                !! that end [time]
      real(dp), intent(in) :: values(:, :)        !! (quantities, interfaces)

      if (.not. allocated(self%values)) allocate (self%values(kept, size(values, 1), &
         size(values, 2)), self%changes(3, size(values, 1), size(values, 2)))
      if (step /= self%step) self%values = ieee_value(1.0_dp, ieee_quiet_nan)
      if (step /= self%step) self%changes = 0.0_dp
      self%step = step
      self%time = [self%time(2:), time]
      self%values(:kept - 1, :, :) = self%values(2:, :, :)
      self%values(kept, :, :) = values
   end subroutine follow

   !> The values of the present step, in either direction.
   subroutine exchange(self, sizes, table)
      class(quantity_histories_type), intent(inout) :: self
      integer, intent(in) :: sizes(2)             !! numbers of quantities and interfaces
      type(state_table_type), intent(inout) :: table
      integer, allocatable :: step(:)
      real(dp), allocatable :: changes(:), time(:), values(:)

      ! Those that have followed no increment yet receive the table.
      if (self%step == 0) call self%follow(1, 0.0_dp, spread(spread(0.0_dp, 1, sizes(1)), 2, &
         sizes(2)))
      step = [self%step]
      time = self%time
      values = [self%values]
      changes = [self%changes]
      call integers(table, 'estimated_step', step)
      call reals(table, 'history_time', time)
      call reals(table, 'history_values', values)
      call reals(table, 'history_changes', changes)
      self%step = step(1)
      self%time = time
      self%values = reshape(values, shape(self%values))
      self%changes = reshape(changes, shape(self%changes))
   end subroutine exchange

   !> Takes the changes of the quantities of an interface on a finer mesh at the end of an
   !> increment, and gives how they scatter. Where they have too few values for that, 0; then the
   !> largest of the last three changes counts, since at one increment one may vanish by chance.
   pure subroutine take_change(self, interface, change, scatter)
      class(quantity_histories_type), intent(inout) :: self
      integer, intent(in) :: interface
      real(dp), intent(inout) :: change(:)        !! (quantities) NaN: none
      real(dp), intent(out) :: scatter(:)         !! (quantities)
      integer :: q

      do q = 1, size(change)
         associate (own => self%changes(:, q, interface))
            own = [own(2:), merge(0.0_dp, abs(change(q)), ieee_is_nan(change(q)))]
            scatter(q) = scatter_of(self%time, self%values(:, q, interface))
            if (.not. ieee_is_nan(scatter(q))) cycle
            scatter(q) = 0.0_dp
            if (.not. ieee_is_nan(change(q))) change(q) = maxval(own)
         end associate
      end do
   end subroutine take_change

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
