!> Bodies: elements that share nodes hang together.
module mesh_bodies
   use element_kinds, only: axisymmetric, element_node_count
   use element_sides, only: element_sides_type, find_sides
   use mesh, only: mesh_type
   use model, only: model_type
   use text, only: to_text
   implicit none
   private
   public :: find_bodies, bodies_on_axis, body_name

contains

   !> Fills element_body, node_body, body_count and element_part of a mesh; bodies are numbered by
   !> their first element.
   pure subroutine find_bodies(mesh)
      type(mesh_type), intent(inout) :: mesh   !! the mesh; nodes without elements get body 0
      integer :: parent(size(mesh%node_number)), body(size(mesh%node_number)), e, q, root

      parent = [(q, q=1, size(parent))]
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
      call find_parts(mesh)
   end subroutine find_bodies

   !> Numbers the parts of the bodies by their first element.
   pure subroutine find_parts(mesh)
      type(mesh_type), intent(inout) :: mesh
      integer, dimension(size(mesh%element_nodes, 2)) :: parent, part
      type(element_sides_type) :: sides
      integer :: e, parts, root, s

      if (allocated(mesh%element_part)) deallocate (mesh%element_part)
      parent = [(e, e=1, size(parent))]
      sides = find_sides(mesh)
      do s = 1, sides%count
         if (sides%elements(2, s) > 0) call join(parent, sides%elements(1, s), sides%elements(2, s))
      end do
      parts = 0
      do e = 1, size(parent)
         call find_root(parent, e, root)
         if (root == e) parts = parts + 1
         if (root == e) part(e) = parts
         part(e) = part(root)
      end do
      if (parts > mesh%body_count) mesh%element_part = part
   end subroutine find_parts

   !> Which bodies turn about the axis: they can only move along it.
   pure function bodies_on_axis(mesh) result(on_axis)
      type(mesh_type), intent(in) :: mesh      !! the mesh, its bodies known
      logical :: on_axis(mesh%body_count)      !! (bodies)

      on_axis = .false.
      on_axis(pack(mesh%element_body, mesh%element_plane == axisymmetric)) = .true.
   end function bodies_on_axis

   !> How a body is named to the user, such as 'body 2 (HUB of STEEL, first node 38)': by the
   !> element set of its section, where that holds it alone and its material has another name. Sets
   !> of CAE that begin with _ name nothing.
   pure function body_name(model, body) result(name)
      type(model_type), intent(in) :: model
      integer, intent(in) :: body
      character(:), allocatable :: name
      character(:), allocatable :: materials
      integer :: m, s

      associate (mesh => model%mesh)
         materials = ''
         do m = 1, size(model%materials)
            if (.not. any(mesh%element_body == body .and. &
               model%sections(mesh%element_section)%material == m)) cycle
            if (.not. allocated(model%materials(m)%name)) cycle
            materials = materials//' and '//model%materials(m)%name
         end do
         name = 'body '//to_text(body)//' ('
         do s = 1, size(model%sections)
            if (model%sections(s)%element_set == 0) cycle
            associate (set => mesh%element_sets(model%sections(s)%element_set))
               if (size(set%members) /= count(mesh%element_body == body)) cycle
               if (any(mesh%element_body(set%members) /= body) .or. set%name(:1) == '_') cycle
               if (set%name /= materials(6:)) name = name//set%name//' '
            end associate
         end do
         if (len(materials) > 0) name = name//'of '//materials(6:)//', '
         name = name//'first node '//to_text(minval(mesh%node_number, mask= &
            mesh%node_body == body))//')'
      end associate
   end function body_name

   !> Joins the groups of two things.
   pure subroutine join(parent, a, b)
      integer, intent(inout) :: parent(:)   !! (things) another thing of the group, or itself
      integer, intent(in) :: a, b           !! things
      integer :: root_a, root_b

      call find_root(parent, a, root_a)
      call find_root(parent, b, root_b)
      parent(max(root_a, root_b)) = min(root_a, root_b)
   end subroutine join

   !> The thing that stands for a group; the way to it is halved on the walk.
   pure subroutine find_root(parent, thing, root)
      integer, intent(inout) :: parent(:)   !! (things) another thing of the group, or itself
      integer, intent(in) :: thing          !! thing of the group
      integer, intent(out) :: root          !! its root

      root = thing
      do while (parent(root) /= root)
         parent(root) = parent(parent(root))
         root = parent(root)
      end do
   end subroutine find_root

end module mesh_bodies
