!> The history of loads and prescribed values over the steps.
module load_histories
   use amplitudes, only: amplitude_type, amplitude_value
   use kinds, only: dp
   use state_tables, only: reals, state_table_type
   use steps, only: step_type
   implicit none
   private
   public :: end_of_step, load_history_type, step_clock_type

   !> Where in the steps an instant lies.
   type :: step_clock_type
      real(dp) :: step_time = 0.0_dp    !! time since the start of the step [time]
      real(dp) :: period = 1.0_dp       !! length of the step [time]
      real(dp) :: total_time = 0.0_dp   !! time since the start of the first step [time]
      logical :: ramped = .true.        !! loads without an amplitude ramp over the step
   end type step_clock_type

   !> A set of numbered loads, each with its present value. Loads stay from step to step until given
   !> anew or ended.
   type :: load_history_type
      logical, allocatable :: active(:)      !! (n) whether the load is given
      logical, allocatable :: permanent(:)   !! (n) active whatever the cards say
      logical, allocatable :: at_once(:)     !! (n) whether it never ramps
      real(dp), allocatable :: rest(:)       !! (n) value to which a load fades
      real(dp), allocatable :: start(:)      !! (n) value at the start of the step
      real(dp), allocatable :: target(:)     !! (n) value at its end, or factor of the amplitude
      real(dp), allocatable :: value(:)      !! (n) present value
      integer, allocatable :: amplitude(:)   !! (n) index of the amplitude, or 0
      integer, allocatable :: card(:)        !! (n) card that gave the load last
      logical, allocatable :: on_total_time(:)   !! (amplitudes) abscissa is total time
   contains
      procedure :: prepare
      procedure :: begin_step
      procedure :: give
      procedure :: fade
      procedure :: remove
      procedure :: move_to
      procedure :: exchange
   end type load_history_type

contains

   !> The end of a step.
   pure function end_of_step(steps, step) result(clock)
      type(step_type), intent(in) :: steps(:)
      integer, intent(in) :: step                !! its number
      type(step_clock_type) :: clock

      clock = step_clock_type(steps(step)%period, steps(step)%period, sum(steps(:step)%period), &
         steps(step)%ramped)
   end function end_of_step

   !> Starts with no load given.
   pure subroutine prepare(self, initial, amplitudes)
      class(load_history_type), intent(inout) :: self
      real(dp), intent(in) :: initial(:)             !! (n) values before anything is given
      type(amplitude_type), intent(in) :: amplitudes(:)  !! load curves

      allocate (self%active(size(initial)), self%at_once(size(initial)), &
         self%permanent(size(initial)), source=.false.)
      allocate (self%amplitude(size(initial)), self%card(size(initial)), source=0)
      self%rest = initial
      self%start = initial
      self%target = initial
      self%value = initial
      self%on_total_time = amplitudes%total_time
   end subroutine prepare

   !> Starts a step: loads stay at their last value unless given anew, but for those that an
   !> amplitude on total time moves on; as in CalculiX one on step time ends with its step. A load
   !> that is not given has the present value, from which it ramps once it is.
   pure subroutine begin_step(self, present_value)
      class(load_history_type), intent(inout) :: self
      real(dp), intent(in) :: present_value(:)       !! (n) values of loads that are not given
      integer :: i

      where (.not. self%active) self%value = present_value
      do i = 1, size(self%amplitude)
         if (self%amplitude(i) == 0) cycle
         if (.not. self%on_total_time(self%amplitude(i))) self%amplitude(i) = 0
      end do
      self%start = self%value
      where (self%amplitude == 0) self%target = self%value
   end subroutine begin_step

   !> Gives a load for this step.
   pure subroutine give(self, i, value, amplitude, card)
      class(load_history_type), intent(inout) :: self
      integer, intent(in) :: i                       !! number of the load
      real(dp), intent(in) :: value !! value at the end of the step, or factor of the amplitude
      integer, intent(in) :: amplitude               !! index of the amplitude, or 0
      integer, intent(in) :: card                    !! card that gives it

      self%active(i) = .true.
      self%target(i) = value
      self%amplitude(i) = amplitude
      self%card(i) = card
   end subroutine give

   !> Ends a load as OP=NEW does in CalculiX: it goes to its rest over the step where it would ramp,
   !> at once where it follows an amplitude on total time or nothing ramps.
   pure subroutine fade(self, i)
      class(load_history_type), intent(inout) :: self
      integer, intent(in) :: i                       !! number of the load

      if (self%amplitude(i) > 0) self%start(i) = self%rest(i)
      self%amplitude(i) = 0
      self%target(i) = self%rest(i)
   end subroutine fade

   !> Ends loads at once: what they prescribed is free.
   pure subroutine remove(self, i)
      class(load_history_type), intent(inout) :: self
      integer, intent(in) :: i(:)                    !! numbers of the loads

      self%active(i) = self%permanent(i)
      self%amplitude(i) = 0
      self%card(i) = 0
      self%target(i) = self%value(i)
   end subroutine remove

   !> Moves all loads to an instant of the step.
   pure subroutine move_to(self, clock, amplitudes)
      class(load_history_type), intent(inout) :: self
      type(step_clock_type), intent(in) :: clock         !! the instant
      type(amplitude_type), intent(in) :: amplitudes(:)  !! load curves
      real(dp) :: factor(size(amplitudes)), share
      integer :: i

      do i = 1, size(amplitudes)
         factor(i) = amplitude_value(amplitudes(i), &
            merge(clock%total_time, clock%step_time, amplitudes(i)%total_time))
      end do
      share = 1.0_dp
      if (clock%ramped) share = clock%step_time/clock%period
      do i = 1, size(self%value)
         if (.not. self%active(i)) cycle
         if (self%amplitude(i) > 0) then
            self%value(i) = self%target(i)*factor(self%amplitude(i))
         else if (self%at_once(i)) then
            self%value(i) = self%target(i)
         else
            self%value(i) = self%start(i) + (self%target(i) - self%start(i))*share
         end if
      end do
   end subroutine move_to

   !> What loads ramp from and to in the present step, in either direction; all else follows from
   !> the cards of the steps, and the present values from the instant.
   subroutine exchange(self, table, name)
      class(load_history_type), intent(inout) :: self     !! in the step of the table
      type(state_table_type), intent(inout) :: table
      character(*), intent(in) :: name                    !! of these loads
      real(dp), allocatable :: start(:), target(:)

      start = pack(self%start, self%active)
      target = pack(self%target, self%active)
      call reals(table, name//'_start', start)
      call reals(table, name//'_target', target)
      if (.not. table%restores) return
      self%start = unpack(start, self%active, self%start)
      self%target = unpack(target, self%active, self%target)
   end subroutine exchange

end module load_histories
