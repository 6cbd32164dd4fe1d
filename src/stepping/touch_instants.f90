!> The instant within an increment of a transient at which an interface first touches, or parts as
!> a whole. The heat that crosses it changes its course there, so the increment is repeated to end
!> just behind: a scheme of second order keeps its order.
!>
!> The distance of an interface is its smallest gap while all its contact points are open, and less
!> than 0 with a force: the overlap that it stands for. Regula falsi (Illinois) finds the end of the
!> increment at which it has passed 0 by a small part of what it was at its start.
module touch_instants
   use contact_system, only: contact_open
   use kinds, only: dp
   use reduced_bodies, only: reduced_bodies_type
   use solution_state, only: solution_state_type
   implicit none
   private
   public :: touch_search_type

   !> Part of the distance at the start, and of the first attempt, that is none.
   real(dp), parameter :: small = 1.0e-3_dp
   integer, parameter :: most_tries = 20      !! attempts at one instant
   real(dp), parameter :: rounding = 1.0e3_dp !! of gaps, in the least length of the contact points
   !> Part of the first attempt, and part of the distance that is left within it, of a touch that
   !> comes on the way.
   real(dp), parameter :: short = 0.1_dp, nearer = 0.5_dp

   !> A search within one increment.
   type :: touch_search_type
      integer :: interface = 0                       !! which touches or parts; 0 while none does
      real(dp) :: ending = 0.0_dp                    !! end of the next attempt [time]
      integer, private :: tries = 0, last = 0        !! attempts; which end the last one moved
      real(dp), private :: times(2) = 0.0_dp         !! before and behind the instant [time]
      real(dp), private :: distances(2) = 0.0_dp     !! at these [length]
      real(dp), private :: first(2) = 0.0_dp         !! first attempt: [time], distance [length]
   contains
      procedure :: ends_behind
   end type touch_search_type

contains

   !> Whether an increment may end with an attempt; else the end of the next one is set.
   logical function ends_behind(self, bodies, before, next, times)
      class(touch_search_type), intent(inout) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(solution_state_type), intent(in) :: before, next   !! states at both ends of the attempt
      real(dp), intent(in) :: times(2)                        !! these ends [time]
      real(dp) :: at_start, at_end
      integer :: i
      logical :: passes

      ends_behind = .true.
      do i = 1, size(bodies%interfaces)
         if (self%interface > 0 .and. self%interface /= i) cycle
         at_start = distance(bodies, before, i)
         at_end = distance(bodies, next, i)
         passes = (at_start > 0.0_dp .neqv. at_end > 0.0_dp) .and. abs(at_start) > rounding* &
            bodies%equilibrium%contact%least_length
         if (self%interface == 0) then
            if (.not. passes) cycle
            self%interface = i
            self%times = times
            self%distances = [at_start, at_end]
         end if
         exit
      end do
      if (self%interface == 0) return
      self%tries = self%tries + 1
      ends_behind = passes .and. abs(at_end) <= small*abs(at_start) .or. self%tries > most_tries
      if (ends_behind) return
      if (self%tries == 1) self%first = [times(2) - times(1), abs(at_end)]
      ! Loads that act at once close it where the increment begins.
      associate (part => (times(2) - times(1))/self%first(1))
         ends_behind = passes .and. (part <= small .or. part <= short .and. abs(at_end) > nearer* &
            self%first(2))
      end associate
      if (ends_behind) return
      if (self%tries > 1) then
         ! It takes the place of the end of its kind; the other one counts half if it stays a second
         ! time.
         i = merge(2, 1, passes)
         self%times(i) = times(2)
         self%distances(i) = at_end
         if (self%last == i) self%distances(3 - i) = 0.5_dp*self%distances(3 - i)
         self%last = i
      end if
      associate (t => self%times, d => self%distances, goal => -0.3_dp*small*at_start)
         self%ending = t(1) + (t(2) - t(1))*min(max((d(1) - goal)/(d(1) - d(2)), 0.01_dp), 0.99_dp)
      end associate
   end function ends_behind

   !> Distance of an interface; that of a removed one is its gap.
   pure real(dp) function distance(bodies, state, i)
      type(reduced_bodies_type), intent(in) :: bodies
      type(solution_state_type), intent(in) :: state
      integer, intent(in) :: i                                ! the interface

      associate (first => bodies%points%interface_start(i), &
         last => bodies%points%interface_start(i + 1) - 1, contact => state%contact)
         if (all(contact%contact_state(first:last) == contact_open)) then
            distance = minval(contact%gap(first:last))
         else
            distance = -maxval(contact%force(first:last)/ &
               bodies%equilibrium%contact%alone(first:last))
         end if
      end associate
   end function distance

end module touch_instants
