!> Contact as the deck defines it: surface interactions, interfaces and ties; and what each step
!> changes of it: friction, contact pairs that are removed or added, interferences.
module contact_definitions
   use conductance_laws, only: conductance_law_type
   use friction_laws, only: friction_heat_type, friction_law_type
   use kinds, only: dp
   use text, only: named_type
   use overlap_laws, only: overlap_law_type
   use wear_laws, only: wear_law_type
   implicit none
   private
   public :: interaction_type, contact_definition_type, tie_definition_type
   public :: friction_change_type, pair_change_type, interference_type, contact_changes_type
   public :: latest_friction, is_removed, steps_with, brings_friction, makes_friction_heat
   public :: pairing_by_faces, pairing_nodes, pairing_surfaces, pairing_name

   integer, parameter :: pairing_by_faces = 0    !! nodes where the faces match, else surfaces
   integer, parameter :: pairing_nodes = 1       !! pairs of opposite nodes
   integer, parameter :: pairing_surfaces = 2    !! mortar points

   !> One *SURFACE INTERACTION.
   type, extends(named_type) :: interaction_type
      type(friction_law_type) :: friction     !! Coulomb's law
      type(friction_heat_type) :: heat        !! heat of this friction
      type(conductance_law_type) :: law       !! conductance law
      type(overlap_law_type) :: overlap       !! of hard faces, or of soft ones
      type(wear_law_type) :: wear             !! of faces that do not wear, or of those that do
   end type interaction_type

   !> One *CONTACT PAIR: two surfaces that may meet; or the faces of one *TIE.
   type, extends(named_type) :: contact_definition_type
      integer :: slave = 0                    !! index of the slave surface, the paper's body xi
      integer :: master = 0                   !! index of the master surface, the paper's body eta
      integer :: card = 0                     !! card image of the *CONTACT PAIR or *TIE
      integer :: interaction = 0              !! index into model%interactions
      integer :: pairing = pairing_by_faces   !! PAIRING=
      logical :: follows_sliding = .false.    !! SLIDING=FINITE: points of the displaced faces
      logical :: has_clearance = .false.      !! whether *CLEARANCE is in place of the geometry
      real(dp) :: clearance = 0.0_dp     !! its gap of all contact points, negative overlap [length]
      logical :: adjusts = .false.            !! ADJUST=: some slave nodes start without a gap
      real(dp) :: adjusted = 0.0_dp           !! those up to this gap [length]; without a set
      integer :: adjusted_set = 0             !! index of their node set, 0 for none
      logical :: is_tied = .false.            !! whether they are the faces of a *TIE
      !> Whether its bodies may be on the same side of the faces: POSITION TOLERANCE= tells then
      !> which points belong to each other
      logical :: either_side = .false.
   contains
      procedure :: title
   end type contact_definition_type

   !> One *TIE: two surfaces without relative displacements and jumps of temperature.
   type :: tie_definition_type
      type(contact_definition_type) :: faces  !! its surfaces, without an interaction
      logical :: has_tolerance = .false.      !! whether POSITION TOLERANCE= is given
      real(dp) :: tolerance = 0.0_dp          !! gap up to which points are tied [length]
   end type tie_definition_type

   !> A *FRICTION behind *CHANGE FRICTION, valid from this step on.
   type :: friction_change_type
      integer :: interaction = 0                  !! index into model%interactions
      type(friction_law_type) :: friction         !! in place of the one before
   end type friction_change_type

   !> An interface of *MODEL CHANGE, from this step on.
   type :: pair_change_type
      integer :: contact = 0                      !! index into model%contacts
      logical :: removes = .false.                !! REMOVE, else ADD
   end type pair_change_type

   !> An interface of *CONTACT INTERFERENCE.
   type :: interference_type
      integer :: contact = 0                      !! index into model%contacts
      real(dp) :: value = 0.0_dp     !! overlap that is allowed, or factor of the initial overlaps
      logical :: shrinks = .false.   !! SHRINK: a factor of each contact point's initial overlap
      integer :: amplitude = 0       !! index into model%amplitudes, 0 for a ramp down to 0
   end type interference_type

   !> All changes of one step.
   type :: contact_changes_type
      type(friction_change_type), allocatable :: frictions(:)      !! *CHANGE FRICTION
      type(pair_change_type), allocatable :: pairs(:)              !! *MODEL CHANGE
      type(interference_type), allocatable :: interferences(:)     !! *CONTACT INTERFERENCE
      logical :: ends_interferences = .false.   !! OP=NEW: those of former steps end
   end type contact_changes_type

contains

   !> Name of an interface in messages, such as 'contact pair FACE'.
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

   !> The friction of an interaction, after the changes of some steps in their order.
   pure function latest_friction(changes, interaction, friction) result(latest)
      type(contact_changes_type), intent(in) :: changes(:)   !! (steps)
      integer, intent(in) :: interaction                     !! index into model%interactions
      type(friction_law_type), intent(in) :: friction        !! before the first of them
      type(friction_law_type) :: latest
      integer :: i, s

      latest = friction
      do s = 1, size(changes)
         if (.not. allocated(changes(s)%frictions)) cycle
         do i = 1, size(changes(s)%frictions)
            if (changes(s)%frictions(i)%interaction == interaction) latest = &
               changes(s)%frictions(i)%friction
         end do
      end do
   end function latest_friction

   !> Whether a step gives some interaction friction.
   pure logical function brings_friction(changes) result(brings)
      type(contact_changes_type), intent(in) :: changes

      brings = .false.
      if (.not. allocated(changes%frictions)) return
      brings = any(changes%frictions%friction%coefficient > 0.0_dp)
   end function brings_friction

   !> Whether friction makes heat at some interface.
   pure logical function makes_friction_heat(interactions, contacts)
      type(interaction_type), intent(in) :: interactions(:)
      type(contact_definition_type), intent(in) :: contacts(:)

      makes_friction_heat = any(interactions(contacts%interaction)%heat%efficiency > 0.0_dp)
   end function makes_friction_heat

   !> Whether an interface is removed, after the changes of some steps in their order.
   pure logical function is_removed(changes, contact) result(removed)
      type(contact_changes_type), intent(in) :: changes(:)   !! (steps)
      integer, intent(in) :: contact                         !! index into model%contacts
      integer :: i, s

      removed = .false.
      do s = 1, size(changes)
         if (.not. allocated(changes(s)%pairs)) cycle
         do i = 1, size(changes(s)%pairs)
            if (changes(s)%pairs(i)%contact == contact) removed = changes(s)%pairs(i)%removes
         end do
      end do
   end function is_removed

   !> The steps in which an interface is not removed.
   pure function steps_with(changes, contact) result(acts)
      type(contact_changes_type), intent(in) :: changes(:)   !! (steps)
      integer, intent(in) :: contact                         !! index into model%contacts
      logical :: acts(size(changes))                         !! (steps)
      integer :: s

      do s = 1, size(changes)
         acts(s) = .not. is_removed(changes(:s), contact)
      end do
   end function steps_with

end module contact_definitions
