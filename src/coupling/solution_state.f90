!> The state of a run, which changes from increment to increment, and its named arrays: what a run
!> needs to go on from it, and nothing that can be made from the deck. A restart keeps their table.
module solution_state
   use contact_system, only: contact_state_type
   use edge_heat, only: edge_heat_type
   use heat_equation, only: heat_sources_type
   use kinds, only: dp
   use state_tables, only: integers, logicals, reals, state_table_type
   implicit none
   private
   public :: solution_state_type, exchange_state

   !> State at the end of an increment.
   type :: solution_state_type
      type(contact_state_type) :: contact           !! contact state of all contact points
      real(dp), allocatable :: omega(:)             !! (m) conductance
      type(edge_heat_type) :: edge                  !! contact points at the edge of contact
      logical, allocatable :: resting(:)          !! (m) contact points that rest, where a law jumps
      logical, allocatable :: idle(:)               !! (m) closed contact points that carry no force
      real(dp), allocatable :: flux_conductance(:) !! (m) conductance by which heat crossed last
      real(dp), allocatable :: omega_before(:)      !! (m) conductance an increment earlier
      real(dp), allocatable :: jump(:)              !! (m) T_xi - T_eta [temperature]
      real(dp), allocatable :: friction_heat(:)     !! (n) heat of friction, or none [power]
      real(dp), allocatable :: temperature(:)       !! (nodes) [temperature]
      real(dp), allocatable :: displacement(:)      !! (2 nodes) [length]
      !> (2 nodes) at which contact points of faces that slide were placed, or none [length]
      real(dp), allocatable :: faces_at(:)
      real(dp), allocatable :: wear(:)              !! (m) depth of both faces, or none [length]
      real(dp), allocatable :: worn_volume(:)       !! (m) that both have lost [length^3]
      real(dp), allocatable :: smallest_gap(:)      !! (m) smallest gap so far [length]
      !> (2, nodes) of the last increment that solved mechanics; unallocated before it [force]
      real(dp), allocatable :: reaction(:, :)
      real(dp), allocatable :: stress_temperature(:)  !! (nodes) of that increment [temperature]
      type(heat_sources_type) :: sources            !! Q of (3.3) and F of films
      real(dp), allocatable :: stored(:)            !! (nodes) rate of stored heat, or none [power]
      !> Rate of heat that strains take up; inelastic ones give it, below 0 [power]
      real(dp) :: dilatation = 0.0_dp
      !> Lowest and highest temperature of the transient step so far [temperature]
      real(dp), allocatable :: extremes(:)
      real(dp), allocatable :: force_load(:)        !! (2 nodes) applied forces [force]
      !> (2 nodes) what the stiffness has beyond the bodies, initial stresses included; unallocated
      !> for none [force]
      real(dp), allocatable :: forces_beyond(:)
      !> (2) when the last point became solid, and the length of the increment in which it did;
      !> unallocated while one is not [time]
      real(dp), allocatable :: solid_time(:)
      real(dp), allocatable :: history(:)           !! what all integration points remember, or none
      real(dp), allocatable :: work(:)   !! (2) of friction and of loads beside these [energy]
      ! The next four where materials vary.
      real(dp), allocatable :: operators_at(:)      !! (nodes) temperatures of the operators
      real(dp), allocatable :: tangent(:)           !! of their stress, or none of elasticity
      !> (4 nodes) corrections of the operators by corrections_type, now and an increment earlier
      real(dp), allocatable :: corrections(:), corrections_before(:)
      real(dp), allocatable :: displacement_before(:)   !! (2 nodes) where materials have laws
      real(dp), allocatable :: temperature_before(:)    !! (nodes) where materials melt
      real(dp) :: increment_size = 0.0_dp           !! size of the increment [time]
      logical :: has_mechanics = .false.            !! whether mechanics was ever solved
      !> Whether the last increment solved heat by a scheme that keeps an imbalance for ever.
      logical :: keeps_imbalance = .false.
      !> Whether heat was out of balance at the end of the last increment that solved heat.
      logical :: is_out_of_balance = .false.
   end type solution_state_type

contains

   !> All entries of the table, in either direction. A state that receives them is of the same model
   !> before its first increment, with the sources at the instant of the table.
   subroutine exchange_state(self, state)
      type(state_table_type), intent(inout) :: self
      type(solution_state_type), intent(inout) :: state
      logical, allocatable :: flags(:)
      real(dp), allocatable :: reaction(:), scalars(:)

      associate (contact => state%contact)
         call integers(self, 'contact_state', contact%contact_state)
         call integers(self, 'direction', contact%direction)
         call reals(self, 'gap', contact%gap)
         call reals(self, 'tangential', contact%tangential)
         call reals(self, 'slip_origin', contact%slip_origin)
         call reals(self, 'force', contact%force)
         call reals(self, 'shear_force', contact%shear_force)
      end associate
      call reals(self, 'conductance', state%omega)
      call reals(self, 'conductance_before', state%omega_before)
      call reals(self, 'carrying', state%flux_conductance)
      call logicals(self, 'resting', state%resting)
      call logicals(self, 'idle', state%idle)
      call integers(self, 'edge_point', state%edge%point)
      call reals(self, 'edge_conductance', state%edge%conductance)
      call reals(self, 'edge_own', state%edge%own)
      call integers(self, 'edge_start', state%edge%jump%start)
      call integers(self, 'edge_node', state%edge%jump%value)
      call reals(self, 'edge_share', state%edge%jump%coefficient)
      if (allocated(state%edge%point)) state%edge%jump%count = size(state%edge%point)
      call reals(self, 'jump', state%jump)
      call reals(self, 'friction_heat', state%friction_heat)
      call reals(self, 'temperature', state%temperature)
      call reals(self, 'stored', state%stored)
      call reals(self, 'operators_at', state%operators_at)
      call reals(self, 'tangent', state%tangent)
      call reals(self, 'history', state%history)
      call reals(self, 'solid_time', state%solid_time)
      call reals(self, 'work', state%work)
      call reals(self, 'corrections', state%corrections)
      call reals(self, 'corrections_before', state%corrections_before)
      call reals(self, 'displacement_before', state%displacement_before)
      call reals(self, 'temperature_before', state%temperature_before)
      call reals(self, 'extremes', state%extremes)
      call reals(self, 'displacement', state%displacement)
      call reals(self, 'faces_at', state%faces_at)
      call reals(self, 'wear', state%wear)
      call reals(self, 'worn_volume', state%worn_volume)
      call reals(self, 'stress_temperature', state%stress_temperature)
      call reals(self, 'smallest_gap', state%smallest_gap)
      if (allocated(state%reaction)) reaction = [state%reaction]
      call reals(self, 'reaction', reaction)
      if (self%restores) then
         if (allocated(state%reaction)) deallocate (state%reaction)
         if (allocated(reaction)) state%reaction = reshape(reaction, [2, size(reaction)/2])
      end if
      scalars = [state%increment_size, state%dilatation]
      call reals(self, 'scalars', scalars)
      state%increment_size = scalars(1)
      state%dilatation = scalars(2)
      flags = [state%has_mechanics, state%keeps_imbalance, state%is_out_of_balance]
      call logicals(self, 'flags', flags)
      state%has_mechanics = flags(1)
      state%keeps_imbalance = flags(2)
      state%is_out_of_balance = flags(3)
   end subroutine exchange_state

end module solution_state
