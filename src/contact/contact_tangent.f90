!> How the contact state follows its load while all contact points keep their conditions: the
!> derivative of the partial solution of (2.4). The instants of closing follow too: the row of a
!> contact point that closes and sticks, r = (1 - f) (d_t - d_t,i) + a.lambda, has
!>
!>    dr = (1 - f) dd_t + (a + b).dlambda,
!>
!> with b the derivative of r by lambda through f(lambda) and a(lambda).
module contact_tangent
   use contact_states, only: contact_state_type, contact_open, contact_stick
   use contact_system, only: contact_system_type
   use contact_workspace, only: contact_workspace_type
   use dense, only: product_of
   use kinds, only: dp
   implicit none
   private
   public :: contact_response, make_tangent

contains

   !> Changes of gaps and normal forces with the condensed load, one column a change of load.
   pure subroutine contact_response(system, tangent, state, load, gap, force)
      type(contact_system_type), intent(in) :: system !! the reduced system
      type(contact_workspace_type), intent(in) :: tangent !! of the state, as make_tangent left it
      type(contact_state_type), intent(in) :: state   !! a solution
      real(dp), intent(in) :: load(:, :)              !! (tail, n) changes of c [force]
      real(dp), intent(out) :: gap(:, :)              !! (m, n) changes of the gaps [length]
      real(dp), intent(out) :: force(:, :) !! (m, n) changes of the compressive forces [force]
      real(dp), dimension(size(load, 1), size(load, 2)) :: taken_up, motion
      integer :: k

      taken_up = load
      call tangent%solve_free(taken_up)
      motion = 0.0_dp
      motion(tangent%rows%free, :) = taken_up(tangent%rows%free, :)
      taken_up = load - product_of(system%schur, motion)
      gap = 0.0_dp
      force = 0.0_dp
      do k = 1, size(state%contact_state)
         associate (row => system%normal(k))
            if (state%contact_state(k) == contact_open) then
               gap(k, :) = -motion(row, :)
            else
               force(k, :) = taken_up(row, :)
            end if
         end associate
      end do
   end subroutine contact_response

   !> Contact points whose position of sticking depends on their forces.
   pure function closes(system, work, state)
      type(contact_system_type), intent(in) :: system
      type(contact_workspace_type), intent(in) :: work
      type(contact_state_type), intent(in) :: state
      logical :: closes(size(state%contact_state)) !! (m)

      closes = work%closing%acts .and. state%contact_state == contact_stick .and. system%tangent > 0
   end function closes

   !> The factors of a solution, the instants of closing following its load.
   pure subroutine make_tangent(system, work, state, tangent, sound)
      type(contact_system_type), intent(in) :: system !! the reduced system
      type(contact_workspace_type), intent(in) :: work !! as its last solution left it
      type(contact_state_type), intent(in) :: state   !! that solution
      type(contact_workspace_type), intent(out) :: tangent
      logical, intent(out) :: sound                   !! whether the derivative exists
      logical :: moves(size(state%contact_state)), singular
      integer :: c, k

      tangent = work
      sound = .true.
      moves = closes(system, work, state)
      if (.not. any(moves)) return
      do k = 1, size(moves)
         if (.not. moves(k)) cycle
         c = findloc(tangent%rows%closing, system%tangent(k), dim=1)
         tangent%rows%arm(c, :) = tangent%rows%arm(c, :) + system%alone(k)*system%on_tail( &
            work%closing(k)%rate)
      end do
      call tangent%factor_rows(system, singular)
      sound = .not. singular
   end subroutine make_tangent

end module contact_tangent
