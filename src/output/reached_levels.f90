!> When the values of a *VERIFY card reach another value: between the increments by which they pass
!> it, as if they changed linearly with the time in between.
module reached_levels
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use checked_values, only: values_asked_for
   use contact_points, only: contact_points_type
   use kinds, only: dp
   use model, only: model_type, verify_type
   use records, only: increment_record_type
   use state_tables, only: reals, state_table_type
   implicit none
   private
   public :: reached_level_type, exchange_levels

   !> Quantities whose values the model has before the first increment.
   character(*), parameter :: initially_known(3) = ['NT', 'U1', 'U2']

   !> The values of one card so far.
   type :: reached_level_type
      real(dp), allocatable :: level             !! unallocated for other cards
      !> (6, values) the time at which each reached it first and its uncertainty; its last value
      !> with its time, slope and increment; NaN where there is none, unallocated before the first
      real(dp), allocatable, private :: course(:, :)
   contains
      procedure :: follow
      procedure :: times
   end type reached_level_type

contains

   !> Takes the values of an increment; NaN is passed over.
   subroutine follow(self, check, record, model, interfaces, point_node, uncertainty)
      class(reached_level_type), intent(inout) :: self
      type(verify_type), intent(in) :: check
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      integer, intent(in) :: point_node(:)                   !! (points) node index of each point
      real(dp), intent(in) :: uncertainty                    !! of a single value, or NaN
      type(increment_record_type) :: start
      real(dp), allocatable :: values(:)
      character(:), allocatable :: reason

      if (record%increment == 1 .and. any(initially_known == check%quantity)) then
         start%fields%temperature = model%initial_temperature
         allocate (start%fields%displacement(2, size(model%initial_temperature)), source=0.0_dp)
         call values_asked_for(check, start, model, interfaces, point_node, values, reason)
         if (reason == '') call take(self, values, 0.0_dp, 0.0_dp)
      end if
      call values_asked_for(check, record, model, interfaces, point_node, values, reason)
      if (reason == '') call take(self, values, record%time, uncertainty)
   end subroutine follow

   pure subroutine take(self, values, time, uncertainty)
      type(reached_level_type), intent(inout) :: self
      real(dp), intent(in) :: values(:), time, uncertainty
      real(dp) :: bend, slope
      integer :: i

      if (.not. allocated(self%course)) allocate (self%course(6, size(values)), &
         source=ieee_value(1.0_dp, ieee_quiet_nan))
      do i = 1, size(self%course, 2)
         if (ieee_is_nan(values(i))) cycle
         associate (reached => self%course(1, i), doubt => self%course(2, i), &
            before => self%course(3, i), then => self%course(4, i), &
            earlier_slope => self%course(5, i), increment => self%course(6, i))
            if (ieee_is_nan(before)) then
               if (abs(values(i) - self%level) <= 0.0_dp) reached = time
               earlier_slope = 0.0_dp
               increment = 0.0_dp
            else
               slope = (values(i) - before)/(time - then)
               if (ieee_is_nan(reached) .and. ((before < self%level .neqv. &
                  values(i) < self%level) .or. abs(values(i) - self%level) <= 0.0_dp)) then
                  reached = time
                  if (abs(values(i) - self%level) > 0.0_dp) reached = then + &
                     (self%level - before)/(values(i) - before)*(time - then)
                  ! Between its increments the course is a parabola rather than a line.
                  bend = abs(slope - earlier_slope)/(time - then + increment)*(reached - then)* &
                     (time - reached)
                  doubt = (uncertainty + bend)/abs(slope)
               end if
               earlier_slope = slope
               increment = time - then
            end if
            before = values(i)
            then = time
         end associate
      end do
   end subroutine take

   !> When the values reached it.
   pure subroutine times(self, values, uncertainty, reason)
      class(reached_level_type), intent(in) :: self
      real(dp), allocatable, intent(out) :: values(:)        !! (values) [time]
      real(dp), intent(out) :: uncertainty                   !! of a single one, or NaN [time]
      character(:), allocatable, intent(out) :: reason       !! why there are none; else empty

      allocate (values(0))
      if (allocated(self%course)) values = self%course(1, :)
      uncertainty = ieee_value(1.0_dp, ieee_quiet_nan)
      if (size(values) == 1) uncertainty = self%course(2, 1)
      reason = ''
      if (size(values) == 0 .or. any(ieee_is_nan(values))) reason = 'never reached'
   end subroutine times

   !> The courses so far, in either direction; nothing where no card asks for one.
   subroutine exchange_levels(levels, table)
      type(reached_level_type), intent(inout) :: levels(:)
      type(state_table_type), intent(inout) :: table
      real(dp), allocatable :: values(:)
      integer :: first, i, n

      if (.not. any([(allocated(levels(i)%level), i=1, size(levels))])) return
      allocate (values(0))
      do i = 1, size(levels)
         if (.not. allocated(levels(i)%course)) cycle
         values = [values, real(i, dp), levels(i)%level, real(size(levels(i)%course, 2), dp), &
            levels(i)%course]
      end do
      call reals(table, 'reached', values)
      if (.not. table%is_restoring()) return
      first = 1
      do while (first < size(values))
         i = nint(values(first))
         n = nint(values(first + 2))
         if (i <= size(levels)) then
            if (allocated(levels(i)%level)) then
               ! The table may be that of another deck's checks.
               if (abs(levels(i)%level - values(first + 1)) <= 0.0_dp) levels(i)%course = &
                  reshape(values(first + 3:first + 2 + 6*n), [6, n])
            end if
         end if
         first = first + 3 + 6*n
      end do
   end subroutine exchange_levels

end module reached_levels
