!> The active set of the contact system: which pairs are open, slip and stick.
!>
!> Solve, correct every pair that violates its condition, solve again. A set that comes back is left
!> by correcting only the last offending pair (Murty's least-index rule), which cannot cycle on the
!> P-matrix of a frictionless problem.
!>
!> Where contact alone holds a body, a set may leave it loose. A first guess that does is given up
!> for all pairs closed. A correction that does is taken back, and fewer pairs, the worst ones, are
!> corrected. If even a single pair cannot be taken, the body moves on until another pair stops it:
!> an open one that closes, or a slipping one whose slip would turn. If none does, it is loose.
module active_set
   use closing_path, only: follow_closing_path
   use contact_system, only: condition_code, contact_state_type, contact_system_type
   use errors, only: error_type
   use friction, only: next_status
   use kinds, only: dp
   use records, only: status_open, status_slip, status_stick
   implicit none
   private
   public :: solve_contact

   integer, parameter :: most_sets = 200           !! active sets tried before giving up
   real(dp), parameter :: least_motion = 1.0e-8_dp !! part of a motion that is more than rounding

contains

   !> Contact state under a condensed load, the references of friction being given.
   !> Errors: no active set satisfies all conditions; the bodies are not held, and then loose is set
   !> and the status is the one to which all corrections together led.
   subroutine solve_contact(system, load, state, error)
      type(contact_system_type), intent(inout) :: system  !! the reduced system
      real(dp), intent(in) :: load(:)                     !! (tail) c [force]
      type(contact_state_type), intent(inout) :: state    !! guess of the status in, solution out
      type(error_type), allocatable, intent(out) :: error !! see above
      integer :: visited(size(state%status), most_sets)
      real(dp) :: excess(size(state%status))
      integer, allocatable :: loosest(:)
      integer :: next(2, size(state%status)), k, set
      logical :: one_at_a_time

      one_at_a_time = .false.
      call system%solve_set(load, state, error)
      if (allocated(error)) then
         state%status = merge(status_stick, status_slip, system%tangent > 0)
         state%direction = 0
         call system%solve_set(load, state, error)
      end if
      do set = 1, most_sets
         if (allocated(error)) exit
         visited(:, set) = condition_code(state)
         do k = 1, set - 1
            one_at_a_time = one_at_a_time .or. all(visited(:, k) == visited(:, set))
         end do
         call judge(system, load, state, next, excess)
         if (all(excess <= 0.0_dp)) return
         call correct(system, load, next, excess, one_at_a_time, loosest, state, error)
      end do
      if (allocated(loosest)) state%status = loosest
      if (.not. allocated(error)) call follow_closing_path(system, load, state, error)
   end subroutine solve_contact

   !> Corrects the offending pairs, all of them or one at a time, and solves; as few as it takes to
   !> leave the bodies held.
   !> Error: every correction leaves a body loose.
   subroutine correct(system, load, next, excess, one_at_a_time, loosest, state, error)
      type(contact_system_type), intent(inout) :: system
      real(dp), intent(in) :: load(:)
      integer, intent(in) :: next(:, :)
      real(dp), intent(in) :: excess(:)
      logical, intent(inout) :: one_at_a_time
      integer, allocatable, intent(inout) :: loosest(:) !! status that all corrections would give
      type(contact_state_type), intent(inout) :: state
      type(error_type), allocatable, intent(out) :: error
      type(contact_state_type) :: sound
      logical :: chosen(size(excess))
      integer :: k, n

      sound = state
      if (.not. one_at_a_time) then
         n = count(excess > 0.0_dp)
         do while (n > 1)
            chosen = excess > 0.0_dp
            do k = n + 1, count(excess > 0.0_dp)
               chosen(minloc(excess, dim=1, mask=chosen)) = .false.
            end do
            call solve_corrected(system, load, sound, next, chosen, state, error)
            if (.not. allocated(error)) then
               if (allocated(loosest) .and. n == count(excess > 0.0_dp)) then
                  deallocate (loosest)
               end if
               return
            end if
            if (.not. allocated(loosest)) loosest = state%status
            n = n/2
         end do
      end if
      one_at_a_time = one_at_a_time .or. allocated(error)
      do k = size(excess), 1, -1
         if (excess(k) <= 0.0_dp) cycle
         chosen = [(n == k, n=1, size(excess))]
         call solve_corrected(system, load, sound, next, chosen, state, error)
         if (allocated(error)) call stop_motion(system, load, k, state, error)
         if (.not. allocated(error)) return
      end do
      if (.not. allocated(loosest)) loosest = merge(next(1, :), sound%status, excess > 0.0_dp)
   end subroutine correct

   !> Solution with some pairs corrected.
   subroutine solve_corrected(system, load, sound, next, corrected, state, error)
      type(contact_system_type), intent(inout) :: system
      real(dp), intent(in) :: load(:)
      type(contact_state_type), intent(in) :: sound
      integer, intent(in) :: next(:, :)
      logical, intent(in) :: corrected(:)
      type(contact_state_type), intent(inout) :: state
      type(error_type), allocatable, intent(out) :: error

      state = sound
      where (corrected)
         state%status = next(1, :)
         state%direction = next(2, :)
      end where
      call system%solve_set(load, state, error)
   end subroutine solve_corrected

   !> Lets a body that is loose since a pair was taken from it move on until other pairs hold it.
   !> Error: none does.
   subroutine stop_motion(system, load, taken, state, error)
      type(contact_system_type), intent(inout) :: system
      real(dp), intent(in) :: load(:)
      integer, intent(in) :: taken
      type(contact_state_type), intent(inout) :: state   !! the loose set, values of the one before
      type(error_type), allocatable, intent(inout) :: error
      integer :: k, n

      do n = 1, size(state%status)
         k = stopping_pair(system, state, taken)
         if (k == 0) return
         state%status(k) = merge(status_stick, status_slip, system%tangent(k) > 0)
         state%direction(k) = 0
         call system%solve_set(load, state, error)
         if (.not. allocated(error)) return
      end do
   end subroutine stop_motion

   !> The pair that first stops the motion on which a body sets out when a pair is taken from it; 0
   !> where none does. The motion is the null vector of the set that was factored last.
   pure function stopping_pair(system, state, taken) result(first)
      type(contact_system_type), intent(in) :: system
      type(contact_state_type), intent(in) :: state   !! the loose set, values of the one before it
      integer, intent(in) :: taken                    !! the pair
      integer :: first
      real(dp) :: motion(size(system%schur, 1)), sense, way, nearest, distance
      integer :: k

      first = 0
      motion = 0.0_dp
      motion(system%free) = system%lu%null_vector()
      if (state%status(taken) == status_open) then
         sense = -motion(system%normal(taken))
      else if (system%tangent(taken) == 0) then
         return
      else
         sense = -state%direction(taken)*motion(system%tangent(taken))
      end if
      if (abs(sense) <= least_motion*maxval(abs(motion))) return
      motion = sign(1.0_dp, sense)*motion/maxval(abs(motion))
      nearest = huge(1.0_dp)
      do k = 1, size(state%status)
         if (k == taken .or. state%status(k) == status_stick) cycle
         if (state%status(k) == status_open) then
            way = motion(system%normal(k))
            distance = max(state%gap(k), 0.0_dp)
         else
            if (system%tangent(k) == 0) cycle
            way = state%direction(k)*motion(system%tangent(k))
            distance = abs(system%slip(state, k))
         end if
         if (way <= least_motion .or. distance >= nearest*way) cycle
         nearest = distance/way
         first = k
      end do
   end function stopping_pair

   !> What status each pair should have, and by how much it violates the present one.
   subroutine judge(system, load, state, next, excess)
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: load(:)
      type(contact_state_type), intent(in) :: state
      integer, intent(out) :: next(:, :)
      real(dp), intent(out) :: excess(:)
      real(dp) :: gap_tolerance, force_tolerance
      integer :: k

      gap_tolerance = 1.0e-13_dp*max(maxval(abs(state%gap)), maxval(abs(system%initial_gap)), &
         maxval(abs(state%tangential))) + tiny(1.0_dp)
      force_tolerance = max(1.0e-12_dp*maxval(abs(state%force)), &
         1.0e-13_dp*largest_term(system, load, state)) + tiny(1.0_dp)
      next(1, :) = state%status
      next(2, :) = state%direction
      do k = 1, size(state%status)
         call next_status(next(1, k), next(2, k), state%gap(k), state%force(k), &
            state%shear_force(k), system%slip(state, k), system%friction(k), &
            system%tangent(k) > 0, gap_tolerance, force_tolerance, excess(k))
      end do
   end subroutine judge

   !> Largest sum of the terms of which a contact force is made, S d - c, without their signs: what
   !> its rounding goes by where the terms cancel, as in a body that contact moves as a whole.
   pure function largest_term(system, load, state) result(force)
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: load(:)
      type(contact_state_type), intent(in) :: state
      real(dp) :: force
      real(dp) :: terms(size(load))
      integer :: k

      terms = abs(load)
      do k = 1, size(state%status)
         terms = terms + abs(system%initial_gap(k) - state%gap(k))* &
            abs(system%schur(:, system%normal(k)))
         if (system%tangent(k) == 0) cycle
         terms = terms + abs(state%tangential(k))*abs(system%schur(:, system%tangent(k)))
      end do
      force = maxval(terms)
   end function largest_term

end module active_set
