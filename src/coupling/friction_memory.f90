!> Where the slip of each contact point counts from, at the end of an increment.
module friction_memory
   use contact_states, only: contact_open
   use contact_system, only: contact_system_type
   use contact_workspace, only: contact_workspace_type
   use kinds, only: dp
   use held_points, only: tangential_positions
   use reduced_bodies, only: reduced_bodies_type
   use solution_state, only: solution_state_type
   implicit none
   private
   public :: remember_slip

contains

   !> Slip counts from the instant of closing. Tangential positions that the contact system does not
   !> carry, of contact points that are frictionless or held, are taken from the recovered
   !> displacements, and such a contact point closes where it is at that instant on the straight
   !> line between its ends.
   pure subroutine remember_slip(bodies, solved, previous, next)
      type(reduced_bodies_type), intent(in) :: bodies
      type(contact_workspace_type), intent(in) :: solved      !! factors of the solution
      type(solution_state_type), intent(in) :: previous       !! state at the start
      type(solution_state_type), intent(inout) :: next        !! state at the end, with its fields
      real(dp), dimension(size(next%contact%gap)) :: before, now
      integer :: k

      before = tangential_positions(bodies%points, bodies%held_direction, previous%displacement)
      now = tangential_positions(bodies%points, bodies%held_direction, next%displacement)
      associate (contact => next%contact)
         do k = 1, size(now)
            if (bodies%equilibrium%contact%tangent(k) == 0) then
               contact%tangential(k) = now(k)
               contact%reference(k) = before(k) + &
                  closing_fraction(bodies%equilibrium%contact, solved, k, previous%contact%gap(k), &
                  contact%force(k))*(now(k) - before(k))
            end if
            if (contact%contact_state(k) == contact_open .or. next%idle(k)) then
               contact%slip_origin(k) = contact%tangential(k)
            else if (previous%contact%contact_state(k) == contact_open) then
               contact%slip_origin(k) = contact%reference(k)
            end if
         end do
      end associate
   end subroutine remember_slip

   !> Instant at which a contact point without a tangential unknown closed, as a fraction of the
   !> increment: relieved of its force alone it would overlap by force/stiffness. One that carries
   !> no force, as at rest, closes at the end.
   pure function closing_fraction(system, solved, k, gap, force) result(fraction)
      type(contact_system_type), intent(in) :: system
      type(contact_workspace_type), intent(in) :: solved
      integer, intent(in) :: k
      real(dp), intent(in) :: gap, force
      real(dp) :: fraction
      real(dp) :: stiffness(1, 1)

      fraction = merge(1.0_dp, 0.0_dp, gap > 0.0_dp)
      if (gap <= 0.0_dp .or. force <= 0.0_dp) return
      ! Zero where the contact point alone holds a body, but for rounding: it then closes at once.
      stiffness = max(solved%stiffness(system, [system%normal(k)]), 0.0_dp)
      fraction = gap*stiffness(1, 1)/(gap*stiffness(1, 1) + force)
   end function closing_fraction

end module friction_memory
