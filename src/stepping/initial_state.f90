!> The state before the first increment: nothing moved, contact points at their initial gaps.
!> Contact points without a gap conduct as closed ones that carry no pressure.
module initial_state
   use contact_operator, only: kept_contact, law_conductance
   use contact_states, only: contact_open
   use kinds, only: dp
   use model, only: model_type
   use reduced_bodies, only: reduced_bodies_type
   use solution_state, only: solution_state_type
   implicit none
   private
   public :: make_initial_state

contains

   !> State before the first increment.
   pure function make_initial_state(model, bodies) result(state)
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies     !! the bodies, matched
      type(solution_state_type) :: state                          !! see above

      associate (m => size(bodies%points%slave), n => size(model%mesh%node_number), &
         contact => state%contact)
         allocate (contact%contact_state(m), source=contact_open)
         allocate (contact%direction(m), source=0)
         allocate (contact%reference(m), contact%tangential(m), contact%slip_origin(m), &
            contact%force(m), contact%shear_force(m), source=0.0_dp)
         contact%gap = bodies%points%initial_gap
         state%smallest_gap = contact%gap
         allocate (state%resting(m), state%idle(m), source=.false.)
         state%jump = bodies%points%jumps(model%initial_temperature)
         state%omega = law_conductance(bodies, model%initial_temperature, state%jump, &
            kept_contact(contact, has_mechanics=.false.))
         state%omega_before = state%omega
         state%carrying = state%omega
         allocate (state%displacement(2*n), state%sources%load(n), source=0.0_dp)
         state%temperature = model%initial_temperature
      end associate
   end function make_initial_state

end module initial_state
