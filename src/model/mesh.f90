!> The finite-element mesh of a model: nodes, elements, sets and surfaces.
!> Nodes and elements are known inside the program by their index; the deck's numbers are kept for
!> messages and output.
module mesh
   use drawn_lines, only: drawn_line_type
   use kinds, only: dp
   use text, only: named_type
   implicit none
   private
   public :: mesh_type, set_type, surface_type, extent_of, add_node, nodes_per_element

   integer, parameter :: nodes_per_element = 8 !! four corners, then four midside nodes

   !> A named set of node or element indexes.
   type, extends(named_type) :: set_type
      integer, allocatable :: members(:)    !! indexes, each once, ascending
      !> whether all that the deck has in it are lines, which are no elements of a mesh
      logical :: of_lines = .false.
   end type set_type

   !> A named set of element faces, or a line of a rigid body.
   type, extends(named_type) :: surface_type
      integer, allocatable :: faces(:, :)   !! (2, face count): element index, face 1..4
      integer :: card = 0                   !! card image of the *SURFACE
      type(drawn_line_type), allocatable :: drawing   !! of a rigid surface, which has no faces
   end type surface_type

   !> Nodes and elements, with what is grouped over them.
   type :: mesh_type
      integer, allocatable :: node_number(:)          !! (nodes) numbers in the deck
      real(dp), allocatable :: coordinates(:, :)      !! (2, nodes) x and y [length]
      integer, allocatable :: element_number(:)       !! (elements) numbers in the deck
      !> (8, elements) indexes, corners, midsides; zero beyond the nodes that the kind has
      integer, allocatable :: element_nodes(:, :)
      integer, allocatable :: element_kind(:)         !! (elements) quad8, ... of element_kinds
      integer, allocatable :: element_plane(:)        !! (elements) plane_strain, ...
      integer, allocatable :: element_section(:)      !! (elements) index into model%sections
      !> (4, elements) xx, yy, zz, xy, from *INITIAL CONDITIONS. Not allocated: none [stress]
      real(dp), allocatable :: initial_stress(:, :)
      integer, allocatable :: element_body(:)         !! (elements) 1..body_count: share nodes
      integer, allocatable :: node_body(:)            !! (nodes) body, 0 where no element uses it
      integer :: body_count = 0                       !! number of bodies
      !> (elements) parts of the bodies whose elements share sides, which others hinge on at nodes.
      !> Not allocated: every body is one part
      integer, allocatable :: element_part(:)
      !> (5, sides) sides of an element beside which two elements of half its size lie: corner,
      !> middle node, corner, and the midside nodes of the small elements between them, or 0, 0;
      !> the latter hang, or the middle node if there are none. Not allocated: none
      integer, allocatable :: hanging_sides(:, :)
      integer :: deck_nodes = 0   !! of a divided mesh: nodes before its first division, its first
      !> (elements) element before the first division of which each is a part. Not allocated: itself
      integer, allocatable :: deck_element(:)
      !> (4, elements) whether sides are parts of those of deck_element. Not allocated: all
      logical, allocatable :: on_deck_side(:, :)
      type(set_type), allocatable :: node_sets(:)     !! node sets
      type(set_type), allocatable :: element_sets(:)  !! element sets
      type(surface_type), allocatable :: surfaces(:)  !! surfaces
   end type mesh_type

contains

   !> Adds a node of no element behind all others.
   pure subroutine add_node(mesh, place)
      type(mesh_type), intent(inout) :: mesh
      real(dp), intent(in) :: place(2)            !! [length]
      real(dp), allocatable :: coordinates(:, :)
      integer :: n

      n = size(mesh%node_number)
      allocate (coordinates(2, n + 1))
      coordinates(:, :n) = mesh%coordinates
      coordinates(:, n + 1) = place
      call move_alloc(coordinates, mesh%coordinates)
      mesh%node_number = [mesh%node_number, maxval(mesh%node_number) + 1]
   end subroutine add_node

   !> Largest extent of the nodes along x or y.
   pure real(dp) function extent_of(coordinates)
      real(dp), intent(in) :: coordinates(:, :)   !! (2, nodes) x and y [length]

      extent_of = maxval(maxval(coordinates, dim=2) - minval(coordinates, dim=2))
   end function extent_of

end module mesh
