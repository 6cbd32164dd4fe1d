!> Where something is in a deck.
module card_places
   implicit none
   private
   public :: place_type

   !> A place in a deck.
   type :: place_type
      integer :: image = 0    !! running number of the card image; 0 for the deck as a whole
      integer :: column = 1   !! byte in the image
   end type place_type

end module card_places
