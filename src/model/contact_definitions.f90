!> What the deck says of contact: surface interactions, interfaces and ties.
module contact_definitions
   use conductance_laws, only: conductance_law_type
   use friction_laws, only: friction_law_type
   use kinds, only: dp
   use named_items, only: named_type
   implicit none
   private
   public :: interaction_type, contact_definition_type, tie_definition_type
   public :: pairing_by_faces, pairing_nodes, pairing_surfaces, pairing_name

   integer, parameter :: pairing_by_faces = 0    !! nodes where the faces match, else surfaces
   integer, parameter :: pairing_nodes = 1       !! pairs of opposite nodes
   integer, parameter :: pairing_surfaces = 2    !! mortar points

   !> One *SURFACE INTERACTION.
   type, extends(named_type) :: interaction_type
      type(friction_law_type) :: friction     !! Coulomb's law
      type(conductance_law_type) :: law       !! conductance law
   end type interaction_type

   !> One *CONTACT PAIR: two surfaces that may meet; or the faces of one *TIE.
   type, extends(named_type) :: contact_definition_type
      integer :: slave = 0                    !! index of the slave surface, the paper's body xi
      integer :: master = 0                   !! index of the master surface, the paper's body eta
      integer :: card = 0                     !! card image of the *CONTACT PAIR or *TIE
      integer :: interaction = 0              !! index into model%interactions
      integer :: pairing = pairing_by_faces   !! PAIRING=
      logical :: has_clearance = .false.      !! whether *CLEARANCE is in place of the geometry
      real(dp) :: clearance = 0.0_dp     !! its gap of all contact points, negative overlap [length]
      logical :: adjusts = .false.            !! ADJUST=: some slave nodes start without a gap
      real(dp) :: adjusted = 0.0_dp           !! those up to this gap [length]; without a set
      integer :: adjusted_set = 0             !! index of their node set, 0 for none
      logical :: is_tied = .false.            !! whether they are the faces of a *TIE
   contains
      procedure :: title
   end type contact_definition_type

   !> One *TIE: two surfaces without relative displacements and jumps of temperature.
   type :: tie_definition_type
      type(contact_definition_type) :: faces  !! its surfaces, without an interaction
      logical :: has_tolerance = .false.      !! whether POSITION TOLERANCE= is given
      real(dp) :: tolerance = 0.0_dp          !! gap up to which points are tied [length]
   end type tie_definition_type

contains

   !> What messages call an interface, such as 'contact pair FACE'.
   pure function title(self) result(words)
      class(contact_definition_type), intent(in) :: self
      character(:), allocatable :: words

      words = trim(merge('tie         ', 'contact pair', self%is_tied))//' '//self%name
   end function title

   !> The name of a pairing, as the deck has it.
   pure function pairing_name(pairing) result(name)
      integer, intent(in) :: pairing          !! pairing_nodes or pairing_surfaces
      character(:), allocatable :: name

      name = trim(merge('NODES   ', 'SURFACES', pairing == pairing_nodes))
   end function pairing_name

end module contact_definitions
