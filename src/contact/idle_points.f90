!> Closed contact points whose force is rounding although a body rests on them alone. Such a contact
!> point supports nothing: opened, it leaves the body free, and no load drives the body.
!>
!> A force below rounding does not decide by itself, because a light load may leave no more than
!> that beside the thermal forces. The load is judged instead: its resultants along the rigid
!> motions are exact (unconstrained_motions).
module idle_points
   use contact_states, only: contact_state_type, contact_open
   use contact_system, only: contact_system_type
   use contact_workspace, only: contact_workspace_type
   use errors, only: error_type
   use kinds, only: dp
   implicit none
   private
   public :: find_idle_points

   real(dp), parameter :: nothing = 1.0e-6_dp   !! part of a motion that counts as none

contains

   !> Sets work%idle for a state that satisfies all conditions. No force is left of idle contact
   !> points, and none of any closed contact point is negative.
   subroutine find_idle_points(system, load, rounding, work, state)
      type(contact_system_type), intent(in) :: system     !! the reduced system
      real(dp), intent(in) :: load(:)                     !! (tail) c [force]
      real(dp), intent(in) :: rounding                    !! of the contact forces [force]
      type(contact_workspace_type), intent(inout) :: work !! as it was solved last
      type(contact_state_type), intent(inout) :: state    !! solution

      work%idle = state%contact_state /= contact_open .and. state%force <= rounding
      if (any(work%idle)) call keep_unloaded(system, load, work, state, work%idle)
      where (state%force <= 0.0_dp .or. work%idle)
         state%force = 0.0_dp
         state%shear_force = 0.0_dp
      end where
   end subroutine find_idle_points

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

      opened = work%another()
      do while (any(idle))
         trial = state
         where (idle)
            trial%contact_state = contact_open
            trial%direction = 0
         end where
         call opened%solve_set(system, load, trial, error)
         if (opened%driven) then
            idle = idle .and. .not. moved(system, opened%rows%free, &
               abs(matmul(opened%unconstrained, opened%drive)))
         else if (allocated(error) .or. size(opened%unconstrained, 2) == &
            size(work%unconstrained, 2)) then
            idle = .false.
         else
            idle = idle .and. moved(system, opened%rows%free, norm2(opened%unconstrained, dim=2))
            exit
         end if
      end do
   end subroutine keep_unloaded

   !> Contact points that a motion of the free rows moves.
   pure function moved(system, free, motion)
      type(contact_system_type), intent(in) :: system
      integer, intent(in) :: free(:)                !! rows that are sought
      real(dp), intent(in) :: motion(:)             !! (free) lengths of the motion
      logical :: moved(size(system%normal))         !! (m)
      logical :: moves(0:size(system%schur, 1))

      moves = .false.
      moves(free) = motion > nothing*maxval(motion)
      moved = moves(system%normal) .or. moves(system%tangent)
   end function moved

end module idle_points
