!> The active set of the contact system: which contact points are open, slip and stick.
!>
!> Solve, correct every contact point that violates its condition, solve again. A set that comes
!> back is left by correcting only the last offending contact point (Murty's least-index rule),
!> which cannot cycle on the P-matrix of a frictionless problem. Where that does not help, the
!> interfaces whose sets come back follow a path, the others held as they are.
!>
!> Where contact alone holds a body, a set may leave it unconstrained. The body is then held softly
!> where it was, and let go in steps, from the position that each step leads to (proximal point
!> method), until the set that is found also holds without that. What drives off through all steps
!> is unconstrained.
!>
!> A closed contact point whose force is rounding, although a body rests on it alone, is idle: it
!> supports nothing, opened it leaves the body free, and no load drives the body. A force below
!> rounding does not decide by itself, because a light load may leave no more than that beside the
!> thermal forces. The load is judged instead: its resultants along the rigid motions are exact.
module active_set
   use contact_system, only: contact_open, contact_slip, contact_state_type, contact_system_type, &
      next_contact_state, response_type, rounding_type, state_code
   use contact_workspace, only: contact_workspace_type
   use errors, only: error_type, set_error, status_no_convergence
   use kinds, only: dp
   use lemke_path, only: follow_lemke_path
   implicit none
   private
   public :: solve_contact

   integer, parameter :: most_sets = 200           !! active sets tried before giving up
   integer, parameter :: most_tangents = 100       !! of soft faces before giving up
   integer, parameter :: soft_steps = 12           !! steps in which a softly held body is let go
   !> of the contact points' stiffness, in the first of them
   real(dp), parameter :: first_hold = 1.0e-3_dp
   real(dp), parameter :: least_hold = 1.0e-10_dp  !! the same in the last ones
   real(dp), parameter :: nothing = 1.0e-12_dp     !! part of the largest stiffness that is rounding
   real(dp), parameter :: barely = 10.0_dp  !! lengths of rounding by which a contact point overlaps
   real(dp), parameter :: no_motion = 1.0e-6_dp   !! part of a motion that counts as none
   character(*), parameter :: unsettled = 'the contact zones do not settle'

contains

   !> Contact state under a condensed load, the references of friction being given, and its idle
   !> contact points. Motions that nothing drives or holds are least from the positions of the
   !> guess, whatever sets are tried. Gaps of soft faces count from where they begin to press, and
   !> are negative where they do.
   !> Errors: no active set satisfies all conditions; pressures of soft faces do not settle; the
   !> bodies are not held, and then driven is set, and the state is the one in which they are driven
   !> away.
   subroutine solve_contact(system, load, work, state, error)
      type(contact_system_type), intent(in) :: system     !! the reduced system
      real(dp), intent(in) :: load(:)                     !! (tail) c [force]
      type(contact_workspace_type), intent(inout) :: work !! laws in, factors of the solution out
      type(contact_state_type), intent(inout) :: state    !! guess in, solution out
      type(error_type), allocatable, intent(out) :: error
      real(dp), dimension(size(state%gap)) :: initial_gap, start
      integer :: i
      logical :: settled

      if (.not. any(work%soft%is_soft)) then
         call solve_tangents(system, load, work, state, error)
         return
      end if
      initial_gap = work%initial_gap
      start = state%gap
      call work%soft%press(state%force)
      settled = .false.
      do i = 1, most_tangents
         work%initial_gap = initial_gap + work%soft%onset
         state%gap = start + work%soft%onset + work%soft%reach
         call solve_tangents(system, load, work, state, error)
         if (allocated(error)) exit
         call work%soft%follow(state%approach - initial_gap, state%force, settled)
         if (settled) exit
      end do
      work%initial_gap = initial_gap
      if (allocated(error)) return
      if (.not. settled) call set_error(error, status_no_convergence, &
         'the pressures of soft faces do not settle')
      where (work%soft%is_soft) state%gap = initial_gap - work%soft%reach - state%approach
   end subroutine solve_contact

   !> The same with the tangents of soft faces, from the onset of which their gaps count.
   !> Errors: as solve_contact.
   subroutine solve_tangents(system, load, work, state, error)
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: load(:)
      type(contact_workspace_type), intent(inout) :: work
      type(contact_state_type), intent(inout) :: state
      type(error_type), allocatable, intent(out) :: error

      call find_state(system, load, work, state, error)
      if (allocated(error)) return
      work%idle = state%contact_state /= contact_open .and. &
         state%force <= force_rounding(system, work, state)
      if (any(work%idle)) call keep_unloaded(system, load, work, state, work%idle)
      ! No force is left of idle contact points, and none of any closed one is negative.
      where (state%force <= 0.0_dp .or. work%idle)
         state%force = 0.0_dp
         state%shear_force = 0.0_dp
      end where
   end subroutine solve_tangents

   !> A state that satisfies all contact conditions.
   !> Errors: as solve_contact.
   subroutine find_state(system, load, work, state, error)
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: load(:)
      type(contact_workspace_type), intent(inout) :: work
      type(contact_state_type), intent(inout) :: state
      type(error_type), allocatable, intent(out) :: error
      type(contact_state_type) :: forward, guess
      type(error_type), allocatable :: failure
      logical :: restless(size(state%gap))

      guess = state
      work%anchor = positions(system, work, state)
      work%several = .false.
      call search(system, load, work, state, restless, error)
      if (.not. allocated(error)) then
         work%several = work%turns_back(system)
         if (.not. work%several) return
         ! The path of states turns back here; one at which it goes on is better, where it is found.
         forward = state
         call follow_lemke_path(system, load, work, spread(.true., 1, size(restless)), forward, &
            failure)
         if (.not. allocated(failure)) call work%solve_set(system, load, forward, failure)
         if (.not. allocated(failure)) state = forward
         return
      end if
      if (work%driven) then
         state = guess
         ! Bodies in a row that touch are pushed onto each other one by one, but close at once.
         where (guess%contact_state == contact_open .and. .not. work%removed .and. guess%gap <= &
            barely*system%least_length)
            state%contact_state = contact_slip
            state%direction = 0
         end where
         call search(system, load, work, state, restless, failure)
         if (.not. allocated(failure)) then
            if (allocated(error)) deallocate (error)
            return
         end if
      end if
      if (system%motions%basis%count > 0) then
         state = guess
         call hold_softly(system, load, work, state, error)
      else
         call follow_paths(system, load, work, restless, state, error)
      end if
   end subroutine find_state

   !> A state by paths of the interfaces whose sets come back, the others being held as they are,
   !> each followed by a search that judges all; at last by a path of them all.
   !> Errors: as follow_lemke_path.
   subroutine follow_paths(system, load, work, restless, state, error)
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: load(:)
      type(contact_workspace_type), intent(inout) :: work
      logical, intent(inout) :: restless(:)      !! contact points of the sets that come back
      type(contact_state_type), intent(inout) :: state
      type(error_type), allocatable, intent(out) :: error
      logical :: follows(size(restless))
      integer :: i, followed

      follows = .false.
      do
         followed = count(follows)
         do i = 1, size(system%interface_start) - 1
            associate (first => system%interface_start(i), &
               last => system%interface_start(i + 1) - 1)
               if (any(restless(first:last))) follows(first:last) = .true.
            end associate
         end do
         if (count(follows) == followed) follows = .true.
         call follow_lemke_path(system, load, work, follows, state, error)
         if (all(follows)) exit
         if (.not. allocated(error)) call search(system, load, work, state, restless, error)
         if (.not. allocated(error)) return
      end do
      if (.not. allocated(error)) call work%solve_set(system, load, state, error)
   end subroutine follow_paths

   !> Corrects the active set until nothing violates its condition.
   !> Errors: as solve_set; the sets do not settle, and then restless contact points are those that
   !> differ in the sets that come back.
   subroutine search(system, load, work, state, restless, error)
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: load(:)
      type(contact_workspace_type), intent(inout) :: work
      type(contact_state_type), intent(inout) :: state
      logical, intent(out) :: restless(:)        ! (m)
      type(error_type), allocatable, intent(out) :: error
      integer :: visited(size(state%contact_state), most_sets)
      integer :: next(2, size(state%contact_state)), k, set, since
      real(dp) :: excess(size(state%contact_state))
      logical :: corrected(size(state%contact_state)), one_at_a_time

      restless = .false.
      one_at_a_time = .false.
      since = 1
      do set = 1, most_sets
         call work%solve_set(system, load, state, error)
         if (allocated(error)) return
         call judge(system, work, state, next, excess)
         corrected = excess > 0.0_dp
         if (.not. any(corrected)) return
         visited(:, set) = state_code(state)
         do k = since, set - 1
            if (all(visited(:, k) == visited(:, set))) exit
         end do
         if (k < set) then
            if (one_at_a_time) then   ! it would come back for ever
               since = k
               exit
            end if
            one_at_a_time = .true.
            since = set
         end if
         if (one_at_a_time) corrected(:findloc(corrected, .true., dim=1, back=.true.) - 1) = .false.
         where (corrected)
            state%contact_state = next(1, :)
            state%direction = next(2, :)
         end where
      end do
      do k = since, min(set, most_sets)
         restless = restless .or. visited(:, k) /= visited(:, since)
      end do
      call set_error(error, status_no_convergence, unsettled)
   end subroutine search

   !> Contact state where the supports alone do not hold the bodies.
   !> Errors: as solve_contact.
   subroutine hold_softly(system, load, work, state, error)
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: load(:)
      type(contact_workspace_type), intent(inout) :: work
      type(contact_state_type), intent(inout) :: state
      type(error_type), allocatable, intent(out) :: error
      type(contact_workspace_type) :: soft
      real(dp) :: hold, softest
      real(dp), dimension(system%motions%basis%count) :: position, way
      logical :: restless(size(state%gap))
      integer :: step

      position = system%motions%along(positions(system, work, state))
      ! Contact points that close a cycle, and those that move a rigid body, have no stiffness.
      associate (own => [system%own, system%alone])
         softest = minval(own, mask=own > nothing*maxval(own))
      end associate
      do step = 1, soft_steps
         hold = max(first_hold*0.1_dp**(step - 1), least_hold)*softest
         soft = work%another()
         soft%hold = hold
         associate (soft_load => load + hold*system%motions%combined(position))
            call search(system, soft_load, soft, state, restless, error)
            if (allocated(error)) call follow_paths(system, soft_load, soft, restless, state, error)
         end associate
         if (allocated(error)) return
         way = system%motions%along(positions(system, work, state)) - position
         position = position + way
         if (holds_exactly(system, load, work, state)) return
         ! A light load comes no farther than load/hold: the body goes on across the open gaps.
         associate (far => norm2(state%gap) + barely*system%least_length*sqrt(real(size(load), dp)))
            if (work%driven .and. norm2(way) > 0.0_dp) position = position + &
               max(far/norm2(way) - 1.0_dp, 0.0_dp)*way
         end associate
      end do
      ! The last trial says why: driven is set, or some contact point is wrong without the hold.
      call work%solve_set(system, load, state, error)
      if (.not. allocated(error)) call set_error(error, status_no_convergence, unsettled)
   end subroutine hold_softly

   !> Whether a set that was found with the hold satisfies all conditions without it; then the state
   !> is the exact one.
   logical function holds_exactly(system, load, work, state)
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: load(:)
      type(contact_workspace_type), intent(inout) :: work
      type(contact_state_type), intent(inout) :: state
      type(contact_state_type) :: exact
      type(error_type), allocatable :: error
      integer :: next(2, size(state%contact_state))
      real(dp) :: excess(size(state%contact_state))

      exact = state
      call work%solve_set(system, load, exact, error)
      holds_exactly = .not. allocated(error)
      if (.not. holds_exactly) return
      call judge(system, work, exact, next, excess)
      holds_exactly = all(excess <= 0.0_dp)
      if (holds_exactly) state = exact
   end function holds_exactly

   !> Relative displacements of a state.
   pure function positions(system, work, state) result(d)
      type(contact_system_type), intent(in) :: system
      type(contact_workspace_type), intent(in) :: work
      type(contact_state_type), intent(in) :: state
      real(dp) :: d(system%schur%order)
      integer :: k

      d = 0.0_dp
      if (allocated(state%link)) then
         if (size(state%link) == size(system%link)) d(system%link) = state%link
      end if
      do k = 1, size(state%contact_state)
         d(system%normal(k)) = work%initial_gap(k) - state%gap(k)
         if (system%tangent(k) > 0) d(system%tangent(k)) = state%tangential(k)
      end do
   end function positions

   !> The state that each contact point should have, and by how much it violates the present one.
   subroutine judge(system, work, state, next, excess)
      type(contact_system_type), intent(in) :: system
      type(contact_workspace_type), intent(in) :: work
      type(contact_state_type), intent(in) :: state
      integer, intent(out) :: next(:, :)
      real(dp), intent(out) :: excess(:)
      type(response_type) :: response
      type(rounding_type) :: rounding
      integer :: k

      rounding%gap = work%gap_rounding(system, state)
      rounding%force = force_rounding(system, work, state)
      next(1, :) = state%contact_state
      next(2, :) = state%direction
      excess = 0.0_dp
      do k = 1, size(state%contact_state)
         if (work%removed(k)) cycle
         response = response_type(state%gap(k), state%force(k), state%shear_force(k), &
            work%slip(system, state, k))
         call next_contact_state(next(1, k), next(2, k), response, &
            work%friction(k), system%tangent(k) > 0, rounding, excess(k))
      end do
   end subroutine judge

   !> Contact force that is rounding.
   pure real(dp) function force_rounding(system, work, state)
      type(contact_system_type), intent(in) :: system
      type(contact_workspace_type), intent(in) :: work   ! of the state
      type(contact_state_type), intent(in) :: state

      ! Rounding is left of what the load is made of, too, and of coordinates.
      force_rounding = max(1.0e-12_dp*maxval(abs(state%force)), 1.0e-13_dp*work%largest_term, &
         1.0e-12_dp*work%load_scale + system%least_force()) + tiny(1.0_dp)
   end function force_rounding

   !> Of the contact points given, keeps those that hinder a motion which no load drives once they
   !> are open.
   subroutine keep_unloaded(system, load, work, state, idle)
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: load(:)
      type(contact_workspace_type), intent(in) :: work
      type(contact_state_type), intent(in) :: state
      logical, intent(inout) :: idle(:)
      type(contact_workspace_type) :: opened
      type(contact_state_type) :: trial
      type(error_type), allocatable :: error
      real(dp) :: motion(size(load))
      integer :: k

      opened = work%another()
      do while (any(idle))
         trial = state
         where (idle)
            trial%contact_state = contact_open
            trial%direction = 0
         end where
         call opened%solve_set(system, load, trial, error)
         if (opened%driven) then
            motion = 0.0_dp
            call opened%unconstrained%add_shares(opened%drive, motion)
            idle = idle .and. .not. moved(system, motion)
         else if (allocated(error) .or. opened%unconstrained%count == work%unconstrained%count) then
            idle = .false.
         else
            motion = 0.0_dp
            associate (motions => opened%unconstrained)
               do k = 1, motions%start(motions%count + 1) - 1
                  associate (of_row => motion(motions%value(k)))
                     of_row = hypot(of_row, motions%coefficient(k))
                  end associate
               end do
            end associate
            idle = idle .and. moved(system, motion)
            exit
         end if
      end do
   end subroutine keep_unloaded

   !> Contact points that a motion moves.
   pure function moved(system, motion)
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: motion(:)             ! (tail)
      logical :: moved(size(system%normal))         ! (m)
      logical :: moves(0:system%schur%order)

      moves(0) = .false.
      moves(1:) = abs(motion) > no_motion*maxval(abs(motion))
      moved = moves(system%normal) .or. moves(system%tangent)
   end function moved

end module active_set
