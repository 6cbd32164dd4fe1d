!> Element faces of a surface as one line of nodes.
module surface_chains
   use errors, only: error_type, set_error, status_deck
   use mesh, only: face_nodes, mesh_type, surface_type
   implicit none
   private
   public :: chain_faces

contains

   !> Nodes along a surface: corner, midside, corner, ..., corner. Each face is followed by the one
   !> that begins at its second corner, so the line runs with the body on its left.
   !> Error: the faces do not form one open line.
   subroutine chain_faces(mesh, surface, nodes, error)
      type(mesh_type), intent(in) :: mesh                 !! the mesh
      type(surface_type), intent(in) :: surface           !! the surface
      integer, allocatable, intent(out) :: nodes(:)       !! (2 faces + 1) node indexes
      type(error_type), allocatable, intent(out) :: error !! see above
      integer, allocatable :: leaving(:), corners(:, :)
      logical, allocatable :: entered(:)
      integer :: count_faces, face, i
      logical :: branched

      branched = .false.
      count_faces = size(surface%faces, 2)
      allocate (leaving(size(mesh%node_number)), source=0)
      allocate (entered(size(mesh%node_number)), source=.false.)
      allocate (corners(3, count_faces))
      do i = 1, count_faces
         corners(:, i) = mesh%element_nodes(face_nodes(:, surface%faces(2, i)), surface%faces(1, i))
         branched = branched .or. leaving(corners(1, i)) /= 0 .or. entered(corners(3, i))
         leaving(corners(1, i)) = i
         entered(corners(3, i)) = .true.
      end do
      face = 0
      do i = 1, count_faces
         if (.not. entered(corners(1, i))) face = i
      end do
      allocate (nodes(2*count_faces + 1))
      do i = 1, count_faces
         if (face == 0) exit
         nodes(2*i - 1:2*i + 1) = corners(:, face)
         face = leaving(corners(3, face))
      end do
      if (branched .or. i <= count_faces) then
         call set_error(error, status_deck, 'surface '//surface%name// &
            ' is not one line of faces with two ends')
      end if
   end subroutine chain_faces

end module surface_chains
