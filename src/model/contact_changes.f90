!> What a step says of contact: frictions that change, contact pairs that are removed or added,
!> interferences that are allowed for a while.
module contact_changes
   use friction_laws, only: friction_law_type
   use kinds, only: dp
   implicit none
   private
   public :: friction_change_type, pair_change_type, interference_type, contact_changes_type
   public :: latest_friction, is_removed, brings_friction

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

   !> All that one step says.
   type :: contact_changes_type
      type(friction_change_type), allocatable :: frictions(:)      !! *CHANGE FRICTION
      type(pair_change_type), allocatable :: pairs(:)              !! *MODEL CHANGE
      type(interference_type), allocatable :: interferences(:)     !! *CONTACT INTERFERENCE
      logical :: ends_interferences = .false.   !! OP=NEW: those of former steps end
   end type contact_changes_type

contains

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
   pure function brings_friction(changes) result(brings)
      type(contact_changes_type), intent(in) :: changes
      logical :: brings

      brings = .false.
      if (.not. allocated(changes%frictions)) return
      brings = any(changes%frictions%friction%coefficient > 0.0_dp)
   end function brings_friction

   !> Whether an interface is removed, after the changes of some steps in their order.
   pure function is_removed(changes, contact) result(removed)
      type(contact_changes_type), intent(in) :: changes(:)   !! (steps)
      integer, intent(in) :: contact                         !! index into model%contacts
      logical :: removed
      integer :: i, s

      removed = .false.
      do s = 1, size(changes)
         if (.not. allocated(changes(s)%pairs)) cycle
         do i = 1, size(changes(s)%pairs)
            if (changes(s)%pairs(i)%contact == contact) removed = changes(s)%pairs(i)%removes
         end do
      end do
   end function is_removed

end module contact_changes
