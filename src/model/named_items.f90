!> Items that a deck defines by a name: sets, surfaces, materials, contact pairs, ...
module named_items
   use text, only: to_upper
   implicit none
   private
   public :: named_type, find_named

   !> Ancestor of all that has a name.
   type :: named_type
      !> in upper case; that of a contact pair as the deck writes it
      character(:), allocatable :: name
   end type named_type

contains

   !> Index of an item by its name, whatever its case; the last one of several, 0 for none.
   pure integer function find_named(items, name) result(found)
      class(named_type), intent(in) :: items(:)
      character(*), intent(in) :: name
      character(:), allocatable :: wanted

      wanted = to_upper(name)
      do found = size(items), 1, -1
         if (to_upper(items(found)%name) == wanted) return
      end do
   end function find_named

end module named_items
