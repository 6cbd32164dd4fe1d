!> Bodies: elements that share nodes hang together.
module bodies
   use element_kinds, only: axisymmetric, element_node_count
   use groups, only: find_root, join, separate_groups
   use mesh, only: mesh_type
   implicit none
   private
   public :: find_bodies, bodies_on_axis

contains

   !> Fills element_body, node_body and body_count of a mesh; bodies are numbered by their first
   !> element.
   pure subroutine find_bodies(mesh)
      type(mesh_type), intent(inout) :: mesh   !! the mesh; nodes without elements get body 0
      integer :: parent(size(mesh%node_number)), body(size(mesh%node_number))
      integer :: e, q, root

      parent = separate_groups(size(parent))
      do e = 1, size(mesh%element_nodes, 2)
         do q = 2, element_node_count(mesh%element_kind(e))
            call join(parent, mesh%element_nodes(1, e), mesh%element_nodes(q, e))
         end do
      end do
      body = 0
      mesh%body_count = 0
      if (allocated(mesh%element_body)) deallocate(mesh%element_body)
      allocate(mesh%element_body(size(mesh%element_nodes, 2)))
      do e = 1, size(mesh%element_body)
         call find_root(parent, mesh%element_nodes(1, e), root)
         if (body(root) == 0) then
            mesh%body_count = mesh%body_count + 1
            body(root) = mesh%body_count
         end if
         mesh%element_body(e) = body(root)
      end do
      if (allocated(mesh%node_body)) deallocate(mesh%node_body)
      allocate(mesh%node_body(size(parent)))
      do q = 1, size(parent)
         call find_root(parent, q, root)
         mesh%node_body(q) = body(root)
      end do
   end subroutine find_bodies

   !> Which bodies turn about the axis: they can only move along it.
   pure function bodies_on_axis(mesh) result(on_axis)
      type(mesh_type), intent(in) :: mesh      !! the mesh, its bodies known
      logical :: on_axis(mesh%body_count)      !! (bodies)

      on_axis = .false.
      on_axis(mesh%element_body) = mesh%element_plane == axisymmetric
   end function bodies_on_axis

end module bodies
