!> Wear of the faces in an increment. With the slip of its end it is a compliance of the contact
!> points, as of soft faces: a pressure p takes the gap c p farther. So the pressure belongs to the
!> worn faces, and however fast they wear, increments are stable.
module face_wear
   use contact_operator, only: law_pressure
   use contact_system, only: contact_open
   use kinds, only: dp
   use overlap_laws, only: overlap_law_type
   use reduced_bodies, only: reduced_bodies_type
   use solution_state, only: solution_state_type
   implicit none
   private
   public :: wear_by_pressure, wear_faces, worn_overlaps, body_compliance

   !> Compliance beside that of the bodies below which rounding of gaps would be forces.
   real(dp), parameter :: rigid = 1.0e-10_dp

contains

   !> Depth that the faces lose for each pressure, by the slip since the start.
   pure function wear_by_pressure(bodies, before, next, duration) result(depth)
      type(reduced_bodies_type), intent(in) :: bodies       !! of a step with laws of wear
      type(solution_state_type), intent(in) :: before, next !! at the start, at the end
      real(dp), intent(in) :: duration                      !! of sliding out of the plane [time]
      real(dp) :: depth(size(next%omega))                   !! (m) [length/stress]
      real(dp), dimension(size(depth)) :: of_master, slip, temperature
      integer :: i

      associate (contact => next%contact, start => before%contact)
         slip = contact%tangential - contact%slip_origin
         where (start%contact_state /= contact_open) slip = slip - (start%tangential - &
            start%slip_origin)
         if (allocated(bodies%laws%speed)) slip = hypot(slip, bodies%laws%speed*duration)
         temperature = 0.0_dp
         of_master = 0.0_dp
         do i = 1, size(bodies%interfaces)
            associate (first => bodies%points%interface_start(i), &
               last => bodies%points%interface_start(i + 1) - 1)
               call bodies%interfaces(i)%slave_mean%add_totals(next%temperature, &
                  temperature(first:last))
               call bodies%interfaces(i)%master_mean%add_totals(next%temperature, &
                  of_master(first:last))
            end associate
         end do
         depth = bodies%laws%wear%rate_at(0.5_dp*(temperature + of_master))*abs(slip)* &
            bodies%laws%wear_count
         where (contact%contact_state == contact_open) depth = 0.0_dp
      end associate
   end function wear_by_pressure

   !> How far the bodies give way at each contact point to a pressure there alone.
   pure function body_compliance(bodies) result(compliance)
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp) :: compliance(size(bodies%points%weight))    !! (m) [length/stress]

      compliance = 0.0_dp
      where (bodies%equilibrium%contact%alone > 0.0_dp) compliance = bodies%points%weight/ &
         bodies%equilibrium%contact%alone
   end function body_compliance

   !> Laws of overlap of contact points that wear, beside those of soft faces.
   pure function worn_overlaps(bodies, by_pressure) result(overlap)
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: by_pressure(:)                !! (m) as above
      type(overlap_law_type), allocatable :: overlap(:)     !! (m)
      real(dp) :: compliance(size(by_pressure))
      integer :: k

      compliance = body_compliance(bodies)
      allocate (overlap(size(by_pressure)))
      if (allocated(bodies%laws%overlap)) overlap = bodies%laws%overlap
      do k = 1, size(overlap)
         associate (opens => bodies%laws%worn_part(k)*by_pressure(k))
            if (opens <= rigid*compliance(k)) cycle
            overlap(k)%overlap = [0.0_dp, opens]
            overlap(k)%pressure = [0.0_dp, 1.0_dp]
         end associate
      end do
   end function worn_overlaps

   !> Wears the faces at the end of an increment, which then touch without overlap; points of
   !> weight 0, which carry no force, by the limit of the profile.
   pure subroutine wear_faces(bodies, before, by_pressure, next)
      type(reduced_bodies_type), intent(in) :: bodies
      type(solution_state_type), intent(in) :: before       !! at the start
      real(dp), intent(in) :: by_pressure(:)                !! (m) with which it was solved
      type(solution_state_type), intent(inout) :: next      !! at the end

      next%worn_volume = before%worn_volume
      associate (contact => next%contact, closed => next%contact%contact_state /= contact_open)
         next%wear = before%wear + by_pressure*law_pressure(bodies, contact)
         ! Areas of faces that slide follow their strains.
         where (closed) next%worn_volume = next%worn_volume + by_pressure*contact%force
         where (bodies%laws%worn_part*by_pressure > 0.0_dp .and. closed) contact%gap = 0.0_dp
      end associate
   end subroutine wear_faces

end module face_wear
