!> How the contact state follows its load while all contact points keep their conditions: the
!> derivative of the partial solution of (2.4). The instants of closing follow too: with f =
!> f(lambda) the row of a contact point that closes and sticks, r = (1 - f) (d_t - d_t,i) + f
!> c.lambda, has
!>
!>    dr = (1 - f) dd_t + (f c + (c.lambda - d_t + d_t,i) df/dlambda).dlambda.
module contact_tangent
   use contact_states, only: contact_state_type, contact_open, contact_stick
   use contact_system, only: contact_system_type
   use contact_workspace, only: contact_workspace_type
   use kinds, only: dp
   implicit none
   private
   public :: contact_response

contains

   !> Changes of gaps and normal forces with the condensed load, one column a change of load.
   pure subroutine contact_response(system, work, state, load, gap, force, sound)
      type(contact_system_type), intent(in) :: system !! the reduced system
      type(contact_workspace_type), intent(in) :: work !! as its last solution left it
      type(contact_state_type), intent(in) :: state   !! that solution
      real(dp), intent(in) :: load(:, :)              !! (tail, n) changes of c [force]
      real(dp), intent(out) :: gap(:, :)              !! (m, n) changes of the gaps [length]
      real(dp), intent(out) :: force(:, :) !! (m, n) changes of the compressive forces [force]
      logical, intent(out) :: sound                   !! whether the derivative exists
      real(dp) :: motion(size(load, 1), size(load, 2))
      integer, allocatable :: closed(:)
      integer :: k

      motion = load
      sound = .true.
      if (any(closes(system, work, state))) then
         call move_with_instants(system, work, state, motion, sound)
      else
         call work%solve_free(motion)
      end if
      closed = pack([(k, k=1, size(state%contact_state))], state%contact_state /= contact_open)
      gap = 0.0_dp
      do k = 1, size(state%contact_state)
         if (state%contact_state(k) == contact_open) gap(k, :) = -motion(system%normal(k), :)
      end do
      force = 0.0_dp
      associate (rows => system%normal(closed), free => work%rows%free)
         force(closed, :) = load(rows, :) - matmul(system%schur(rows, free), motion(free, :))
      end associate
   end subroutine contact_response

   !> Contact points whose position of sticking depends on their forces.
   pure function closes(system, work, state)
      type(contact_system_type), intent(in) :: system
      type(contact_workspace_type), intent(in) :: work
      type(contact_state_type), intent(in) :: state
      logical :: closes(size(state%contact_state)) !! (m)

      closes = work%closing%acts .and. state%contact_state == contact_stick .and. system%tangent > 0
   end function closes

   !> Motion under changes of load, the instants of closing following.
   pure subroutine move_with_instants(system, work, state, motion, sound)
      type(contact_system_type), intent(in) :: system
      type(contact_workspace_type), intent(in) :: work
      type(contact_state_type), intent(in) :: state
      real(dp), intent(inout) :: motion(:, :)   !! loads in; displacements in the free rows out
      logical, intent(out) :: sound
      type(contact_workspace_type) :: tangent
      logical :: moves(size(state%contact_state)), singular
      real(dp) :: arm
      integer :: k

      tangent = work
      moves = closes(system, work, state)
      do k = 1, size(moves)
         if (.not. moves(k)) cycle
         associate (law => work%closing(k), row => system%tangent(k))
            arm = (dot_product(law%compliance, [-state%force(k), state%shear_force(k)]) - &
               (state%tangential(k) - law%start))/(law%compliance(2) + system%compliance(k))
            tangent%rows%share(row) = tangent%rows%share(row) + arm*law%rate(1)
            tangent%rows%own(row) = tangent%rows%own(row) + arm*law%rate(2)
         end associate
      end do
      call tangent%factor_rows(system, singular)
      sound = .not. singular
      if (sound) call tangent%solve_free(motion)
   end subroutine move_with_instants

end module contact_tangent
