!> What changes from increment to increment.
module solution_state
   use contact_states, only: contact_state_type
   use cut_hats, only: cut_hats_type
   use kinds, only: dp
   use thermal_matrix, only: heat_sources_type
   implicit none
   private
   public :: solution_state_type

   !> State at the end of an increment.
   type :: solution_state_type
      type(contact_state_type) :: contact           !! contact state of all contact points
      real(dp), allocatable :: omega(:)             !! (m) conductance
      type(cut_hats_type) :: cut                    !! contact points at the edge of contact
      logical, allocatable :: resting(:)          !! (m) contact points that rest, where a law jumps
      logical, allocatable :: idle(:)               !! (m) closed contact points that carry no force
      real(dp), allocatable :: carrying(:)          !! (m) conductance by which heat crossed last
      real(dp), allocatable :: omega_before(:)      !! (m) conductance an increment earlier
      real(dp), allocatable :: jump(:)              !! (m) T_xi - T_eta [temperature]
      real(dp), allocatable :: temperature(:)       !! (nodes) [temperature]
      real(dp), allocatable :: displacement(:)      !! (2 nodes) [length]
      real(dp), allocatable :: smallest_gap(:)      !! (m) smallest gap so far [length]
      !> (2, nodes) of the last increment that solved mechanics; unallocated before it [force]
      real(dp), allocatable :: reaction(:, :)
      real(dp), allocatable :: stress_temperature(:)  !! (nodes) of that increment [temperature]
      type(heat_sources_type) :: sources            !! Q of (3.3) and F of films
      real(dp), allocatable :: force_load(:)        !! (2 nodes) applied forces [force]
      real(dp) :: increment_size = 0.0_dp           !! size of the increment [time]
      logical :: has_mechanics = .false.            !! whether mechanics was ever solved
      !> Whether the last increment solved heat by a scheme that keeps an imbalance for ever.
      logical :: keeps_imbalance = .false.
      !> Whether heat was out of balance at the end of the last increment that solved heat.
      logical :: is_out_of_balance = .false.
   end type solution_state_type

end module solution_state
