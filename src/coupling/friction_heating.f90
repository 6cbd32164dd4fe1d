!> Heat of friction in an increment, at the n contact points that may have it.
!>
!> A closed contact point makes eta lambda_t s' of heat, s' being the rate of its slip: what slips
!> in the increment over its duration, so that heat is eta times the work of the shear at the end.
!> In the second of two stages, of the duration gamma dt, a position d goes on from d* = d_0 +
!> (1/gamma - 1)(d_1 - d_0), as temperatures do (heat_storage): from the slips s_1 and s_2 of both
!> stages the rate is (s_2 - (1/gamma - 2) s_1)/(gamma dt). It makes up for what the first stage
!> counted too much, and is negative where slip ends; over the increment heat is the work of both
!> shears.
!>
!> Faces that slide out of the plane with the speed v make eta v times the friction that their
!> pressure has. Eq. (3.4) divided by a1 has the load p_1 q_i + p_2 q_i+1 of heats q: with the parts
!> of other loads for a given speed, a rate at each instant; all of it at the end for slip, a mean
!> over the increment; all of it at the start where (3.4) is explicit, for mechanics come later.
module friction_heating
   use closing_instant, only: contact_change_type
   use contact_system, only: contact_open, contact_state_type
   use controls, only: stage_part
   use friction_laws, only: friction_bound
   use heat_equation, only: heat_equation_type
   use kinds, only: dp
   use reduced_bodies, only: reduced_bodies_type
   use steps, only: solves_heat, solves_mechanics
   implicit none
   private
   public :: friction_heating_type, begin_friction, friction_at_start, nodal_friction_heat, slips, &
      slips_before

   !> Heats of the increment.
   type :: friction_heating_type
      real(dp), allocatable :: old(:)           !! (n) q_i [power]
      real(dp), allocatable :: heat(:)          !! (n) q_i+1 [power]
      real(dp), allocatable :: parts(:, :)      !! (2, n) p_1, p_2
      real(dp) :: duration = 1.0_dp             !! in which contact points slip [time]
      !> (m) slip that was counted before; unallocated for none [length]
      real(dp), allocatable :: slip_before(:)
   contains
      procedure :: load
      procedure :: entering
      procedure :: entering_part
      procedure :: found
      procedure :: of_positions
      procedure :: changes
   end type friction_heating_type

contains

   !> The heats of an increment before it is solved.
   pure subroutine begin_friction(bodies, equation, analysis, contact, before, friction)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_equation_type), intent(in) :: equation
      integer, intent(in) :: analysis                      !! one of the analysis_* of steps
      type(contact_state_type), intent(in) :: contact      !! at the start, under laws of the step
      real(dp), allocatable, intent(in) :: before(:)       !! (n) heats that the state has, or none
      type(friction_heating_type), intent(inout) :: friction
      integer :: j

      friction%old = friction_at_start(bodies, contact, before)
      friction%heat = friction%old
      allocate (friction%parts(2, size(friction%old)), source=0.0_dp)
      if (.not. solves_heat(analysis)) then
         friction%heat = 0.0_dp
         return
      end if
      associate (c => equation%scheme%c/equation%scheme%a(1), speed => bodies%laws%heat%speed)
         if (.not. solves_mechanics(analysis)) then
            ! Nothing slips, and pressures stay.
            where (speed < 0.0_dp) friction%heat = 0.0_dp
            friction%old = friction%heat
            friction%parts(1, :) = sum(c)
         else if (equation%is_explicit()) then
            friction%parts(1, :) = sum(c)
         else
            do j = 1, size(speed)
               friction%parts(:, j) = merge(c, [0.0_dp, sum(c)], speed(j) >= 0.0_dp)
            end do
         end if
      end associate
   end subroutine begin_friction

   !> Heats where an increment begins: of slip those that the state has.
   pure function friction_at_start(bodies, contact, before) result(heat)
      type(reduced_bodies_type), intent(in) :: bodies
      type(contact_state_type), intent(in) :: contact
      real(dp), allocatable, intent(in) :: before(:)       !! (n), or none [power]
      real(dp), allocatable :: heat(:)                     !! (n) [power]

      allocate (heat(size(bodies%points%heated)), source=0.0_dp)
      if (allocated(before)) heat = before
      where (bodies%laws%heat%speed >= 0.0_dp) heat = sliding_heat(bodies, contact)
   end function friction_at_start

   !> Heats of given speeds.
   pure function sliding_heat(bodies, contact) result(heat)
      type(reduced_bodies_type), intent(in) :: bodies
      type(contact_state_type), intent(in) :: contact
      real(dp) :: heat(size(bodies%points%heated))         !! (n) [power]

      associate (heated => bodies%points%heated, law => bodies%laws%heat, &
         friction => bodies%laws%heating_friction)
         heat = law%efficiency*max(law%speed, 0.0_dp)*friction_bound(friction%coefficient, &
            friction%largest_shear, merge(0.0_dp, contact%force(heated), &
            contact%contact_state(heated) == contact_open))
      end associate
   end function sliding_heat

   !> Load of the contact points in (3.4) divided by a1.
   pure function load(self)
      class(friction_heating_type), intent(in) :: self
      real(dp) :: load(size(self%old))                     !! (n) [power]

      load = self%parts(1, :)*self%old + self%parts(2, :)*self%heat
   end function load

   !> Part of heats at the end, or of their changes, in the load.
   pure function entering_part(self, friction_heat)
      class(friction_heating_type), intent(in) :: self
      real(dp), intent(in) :: friction_heat(:, :)                   !! (n, columns) [power]
      real(dp) :: entering_part(size(friction_heat, 1), size(friction_heat, 2))

      entering_part = spread(self%parts(2, :), 2, size(friction_heat, 2))*friction_heat
   end function entering_part

   !> Heats that enter the faces at the end of the increment.
   pure function entering(self)
      class(friction_heating_type), intent(in) :: self
      real(dp) :: entering(size(self%old))                 !! (n) [power]

      entering = merge(self%heat, self%old, self%parts(2, :) > 0.0_dp)
   end function entering

   !> Heats that a contact state makes at the end of the increment.
   pure function found(self, bodies, contact) result(heat)
      class(friction_heating_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(contact_state_type), intent(in) :: contact
      real(dp) :: heat(size(self%old))                     !! (n) [power]
      real(dp) :: slip_rate(size(contact%gap))

      slip_rate = rates_of_slip(self, bodies, contact)
      heat = sliding_heat(bodies, contact)
      associate (heated => bodies%points%heated, law => bodies%laws%heat)
         where (law%speed < 0.0_dp) heat = -law%efficiency*contact%shear_force(heated)* &
            slip_rate(heated)
      end associate
   end function found

   !> Heat that positions of the faces would make in place of slips, which are their differences: it
   !> is known to the rounding of this.
   pure real(dp) function of_positions(self, bodies, contact, displacement) result(heat)
      class(friction_heating_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(contact_state_type), intent(in) :: contact
      real(dp), intent(in) :: displacement                 !! the largest one [length]

      associate (heated => bodies%points%heated, law => bodies%laws%heat)
         heat = maxval(abs(law%efficiency*contact%shear_force(heated)), &
            mask=law%speed < 0.0_dp .and. contact%contact_state(heated) /= contact_open)
         heat = max(heat, 0.0_dp)*max(displacement, maxval(abs(contact%tangential(heated))))/ &
            self%duration
      end associate
   end function of_positions

   !> Slips of the contact points over the duration; 0 where they are open.
   pure function rates_of_slip(friction, bodies, contact) result(rate)
      type(friction_heating_type), intent(in) :: friction
      type(reduced_bodies_type), intent(in) :: bodies
      type(contact_state_type), intent(in) :: contact
      real(dp) :: rate(size(contact%gap))                  !! (m) [length/time]

      rate = slips(bodies, contact)
      if (allocated(friction%slip_before)) rate = rate - friction%slip_before
      rate = merge(0.0_dp, rate/friction%duration, contact%contact_state == contact_open)
   end function rates_of_slip

   !> Slips of the contact points in the increment, 0 where they are open.
   pure function slips(bodies, contact) result(slip)
      type(reduced_bodies_type), intent(in) :: bodies
      type(contact_state_type), intent(in) :: contact
      real(dp) :: slip(size(contact%gap))                  !! (m) [length]

      slip = merge(0.0_dp, contact%tangential - contact%reference + &
         bodies%equilibrium%contact%compliance*contact%shear_force, &
         contact%contact_state == contact_open)
   end function slips

   !> What the second of two stages counts as slip before it.
   pure function slips_before(bodies, contact) result(slip)
      type(reduced_bodies_type), intent(in) :: bodies
      type(contact_state_type), intent(in) :: contact      !! at the end of the first stage
      real(dp) :: slip(size(contact%gap))                  !! (m) [length]

      slip = (1.0_dp/stage_part - 2.0_dp)*slips(bodies, contact)
   end function slips_before

   !> Changes of the heats with those of the contact.
   pure function changes(self, bodies, contact, change, growth) result(heat)
      class(friction_heating_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(contact_state_type), intent(in) :: contact      !! of which the changes are
      type(contact_change_type), intent(in) :: change
      !> rate at which the changes grow; absent: they come about in the duration [1/time]
      real(dp), intent(in), optional :: growth
      real(dp) :: heat(size(self%old), size(change%force, 2))   !! (n, columns)
      real(dp) :: rate(size(contact%gap)), by_slip
      integer :: j

      rate = rates_of_slip(self, bodies, contact)
      by_slip = 1.0_dp/self%duration
      if (present(growth)) by_slip = growth
      heat = 0.0_dp
      do j = 1, size(heat, 1)
         associate (k => bodies%points%heated(j), law => bodies%laws%heat(j), &
            friction => bodies%laws%heating_friction(j))
            if (contact%contact_state(k) == contact_open) cycle
            if (law%speed < 0.0_dp) then
               heat(j, :) = -law%efficiency*(change%shear(k, :)*rate(k) + &
                  contact%shear_force(k)*change%slip(k, :)*by_slip)
            else if (friction%coefficient*contact%force(k) < friction%largest_shear) then
               heat(j, :) = law%efficiency*law%speed*friction%coefficient*change%force(k, :)
            end if
         end associate
      end do
   end function changes

   !> Heat of the contact points as it enters nodes.
   pure function nodal_friction_heat(bodies, heat) result(nodal)
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: heat(:)                      !! (n) [power]
      real(dp) :: nodal(bodies%thermal%matrix%row_count)   !! (nodes) [power]

      nodal = 0.0_dp
      call bodies%points%heat_shares%add_shares(heat, nodal)
   end function nodal_friction_heat

end module friction_heating
