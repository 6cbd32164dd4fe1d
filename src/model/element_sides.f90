!> The distinct sides of a mesh's elements, and the elements on both sides of each.
module element_sides
   use element_kinds, only: element_corner_count, side_node_count, side_nodes
   use mesh, only: mesh_type
   implicit none
   private
   public :: element_sides_type, find_sides, side_ends

   !> Sides, in the order of the elements.
   type :: element_sides_type
      integer :: count = 0                          !! distinct sides
      integer, allocatable :: ends(:, :)            !! (3, sides) corner, midside node or 0, corner
      integer, allocatable :: of_element(:, :)      !! (4, elements) sides, zero beyond the kind's
      integer, allocatable :: elements(:, :)        !! (2, sides) elements that have it, or 0
      integer, allocatable :: latest(:) !! (nodes) side found last at a node as its lower corner
      integer, allocatable :: before(:) !! (sides) the one found before it there
   contains
      procedure :: index_of
   end type element_sides_type

contains

   !> Finds the sides. Sides are the same if all their nodes are: two faces of a crack may share
   !> both ends.
   pure function find_sides(mesh) result(sides)
      type(mesh_type), intent(in) :: mesh           !! elements of any kinds
      type(element_sides_type) :: sides
      integer :: e, f, ends(3), low, most, side

      most = 4*size(mesh%element_kind)
      allocate(sides%ends(3, most), sides%elements(2, most), sides%before(most), source=0)
      allocate(sides%of_element(4, size(mesh%element_kind)), source=0)
      allocate(sides%latest(size(mesh%node_number)), source=0)
      do e = 1, size(mesh%element_kind)
         do f = 1, element_corner_count(mesh%element_kind(e))
            ends = side_ends(mesh, e, f)
            side = sides%index_of(ends)
            if (side == 0) then
               sides%count = sides%count + 1
               side = sides%count
               low = min(ends(1), ends(3))
               sides%ends(:, side) = ends
               sides%before(side) = sides%latest(low)
               sides%latest(low) = side
               sides%elements(1, side) = e
            else
               sides%elements(2, side) = e
            end if
            sides%of_element(f, e) = side
         end do
      end do
   end function find_sides

   !> The side with these nodes, in either direction; 0 where no element has it.
   pure integer function index_of(self, ends) result(side)
      class(element_sides_type), intent(in) :: self
      integer, intent(in) :: ends(3)                !! corner, midside node or 0, corner

      side = self%latest(min(ends(1), ends(3)))
      do while (side > 0)
         if (all(self%ends(:, side) == ends) .or. all(self%ends(:, side) == ends(3:1:-1))) return
         side = self%before(side)
      end do
   end function index_of

   !> First corner, midside node or 0, second corner of a side of an element.
   pure function side_ends(mesh, element, side) result(ends)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element                !! the element
      integer, intent(in) :: side                   !! 1..element_corner_count
      integer :: ends(3)

      associate (kind => mesh%element_kind(element))
         associate (local => side_nodes(kind, side))
            ends = 0
            ends([1, 3]) = mesh%element_nodes(local([1, side_node_count(kind)]), element)
            if (side_node_count(kind) == 3) ends(2) = mesh%element_nodes(local(2), element)
         end associate
      end associate
   end function side_ends

end module element_sides
