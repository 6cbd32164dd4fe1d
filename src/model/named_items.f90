!> Items that a deck defines by a name: sets, surfaces, materials, contact pairs, ...
module named_items
   implicit none
   private
   public :: named_type

   !> Ancestor of all that has a name.
   type :: named_type
      !> in upper case; that of a contact pair as the deck writes it
      character(:), allocatable :: name
   end type named_type

end module named_items
