!> What the deck says of contact: surface interactions and interfaces.
module contact_definitions
   use conductance_laws, only: conductance_law_type
   use kinds, only: dp
   implicit none
   private
   public :: interaction_type, contact_definition_type
   public :: pairing_by_faces, pairing_nodes, pairing_surfaces

   integer, parameter :: pairing_by_faces = 0    !! nodes where the faces match, else surfaces
   integer, parameter :: pairing_nodes = 1       !! pairs of opposite nodes
   integer, parameter :: pairing_surfaces = 2    !! mortar points

   !> One *SURFACE INTERACTION.
   type :: interaction_type
      character(:), allocatable :: name       !! name in upper case
      real(dp) :: friction = 0.0_dp           !! coefficient of friction mu [-]
      type(conductance_law_type) :: law       !! conductance law
   end type interaction_type

   !> One *CONTACT PAIR: two surfaces that may meet.
   type :: contact_definition_type
      character(:), allocatable :: name       !! name as the deck writes it
      integer :: slave = 0                    !! index of the slave surface, the paper's body xi
      integer :: master = 0                   !! index of the master surface, the paper's body eta
      integer :: card = 0                     !! card image of the *CONTACT PAIR
      integer :: interaction = 0              !! index into model%interactions
      integer :: pairing = pairing_by_faces   !! PAIRING=
      logical :: has_clearance = .false.      !! whether *CLEARANCE stands in place of the geometry
      real(dp) :: clearance = 0.0_dp     !! its gap of all contact points, negative overlap [length]
   end type contact_definition_type

end module contact_definitions
