!> Uniform refinement of a model: each element becomes four of its kind. A child's map is its
!> parent's on a quarter of the element, so the geometry does not change. Sets, surfaces, sections,
!> initial temperatures and loads follow.
module refinement
   use element_kinds, only: element_corner_count, quad4, quad8, quad8_reduced, triangle3, triangle6
   use kinds, only: dp
   use load_refinement, only: refine_loads
   use mesh, only: mesh_type
   use mesh_division, only: child_element, divide, division_type, inner_node, refined_members, &
      refined_values, side_node
   use model, only: model_type
   implicit none
   private
   public :: refine

contains

   !> Refines a model; its bodies and the nodes of its boundaries must be found anew afterwards.
   subroutine refine(model, levels)
      type(model_type), intent(inout) :: model   !! model with a conforming mesh
      integer, intent(in) :: levels   !! number of refinements, each with four times the elements
      type(division_type) :: division
      integer :: level

      do level = 1, levels
         division = divide(model%mesh)
         if (allocated(model%initial_temperature)) then
            model%initial_temperature = refined_values(division, model%mesh, &
               model%initial_temperature)
         end if
         if (allocated(model%steps)) call refine_loads(division, model%mesh, model%steps)
         call refine_mesh(division, model%mesh)
      end do
      model%refinement_levels = model%refinement_levels + levels
   end subroutine refine

   subroutine refine_mesh(division, mesh)
      type(division_type), intent(in) :: division
      type(mesh_type), intent(inout) :: mesh
      real(dp), allocatable :: coordinates(:, :)
      integer :: i, first

      do i = 1, size(mesh%node_sets)
         call refine_node_set(division, mesh, mesh%node_sets(i)%members)
      end do
      do i = 1, size(mesh%element_sets)
         call refine_element_set(division%elements, mesh%element_sets(i)%members)
      end do
      do i = 1, size(mesh%surfaces)
         call refine_faces(division%elements, mesh%element_kind, mesh%surfaces(i)%faces)
      end do
      allocate(coordinates(2, division%nodes_after))
      coordinates(1, :) = refined_values(division, mesh, mesh%coordinates(1, :))
      coordinates(2, :) = refined_values(division, mesh, mesh%coordinates(2, :))
      call move_alloc(coordinates, mesh%coordinates)
      first = maxval(mesh%node_number) - division%nodes
      mesh%node_number = [mesh%node_number, &
         (first + i, i=division%nodes + 1, division%nodes_after)]
      first = maxval(mesh%element_number) - division%elements
      mesh%element_number = [mesh%element_number, &
         (first + i, i=division%elements + 1, 4*division%elements)]
      call refine_elements(division, mesh%element_kind, mesh%element_nodes)
      mesh%element_section = of_children(mesh%element_section)
      mesh%element_kind = of_children(mesh%element_kind)
      mesh%element_plane = of_children(mesh%element_plane)
   end subroutine refine_mesh

   !> What the children have from their parents.
   pure function of_children(parents) result(children)
      integer, intent(in) :: parents(:)
      integer :: children(4*size(parents))
      integer :: e, child

      do e = 1, size(parents)
         do child = 1, 4
            children(child_element(size(parents), e, child)) = parents(e)
         end do
      end do
   end function of_children

   subroutine refine_elements(division, kinds, element_nodes)
      type(division_type), intent(in) :: division
      integer, intent(in) :: kinds(:)
      integer, allocatable, intent(inout) :: element_nodes(:, :)
      integer, allocatable :: children(:, :)
      integer :: e, nodes(8, 4), child

      allocate(children(8, 4*division%elements))
      do e = 1, division%elements
         nodes = 0
         select case (kinds(e))
         case (quad8, quad8_reduced)
            nodes = quad8_children(division, element_nodes(:, e), e)
         case (quad4)
            nodes(:4, :) = quad4_children(division, element_nodes(:, e), e)
         case (triangle6)
            nodes(:6, :) = triangle6_children(division, element_nodes(:, e), e)
         case default
            nodes(:3, :) = triangle3_children(division, element_nodes(:, e), e)
         end select
         do child = 1, 4
            children(:, child_element(division%elements, e, child)) = nodes(:, child)
         end do
      end do
      call move_alloc(children, element_nodes)
   end subroutine refine_elements

   !> Nodes of the four children of an eight-node element.
   pure function quad8_children(division, nodes, e) result(children)
      type(division_type), intent(in) :: division
      integer, intent(in) :: nodes(8), e
      integer :: children(8, 4)
      integer :: f, centre, inner(4), near_first(4), near_second(4)

      centre = inner_node(division, e, 1)
      do f = 1, 4
         near_first(f) = side_node(division, e, f, nodes(f))
         near_second(f) = side_node(division, e, f, nodes(mod(f, 4) + 1))
         inner(f) = inner_node(division, e, 1 + f)
      end do
      associate (c => nodes(1:4), m => nodes(5:8))
         children(:, 1) = [c(1), m(1), centre, m(4), &
            near_first(1), inner(1), inner(4), near_second(4)]
         children(:, 2) = [m(1), c(2), m(2), centre, &
            near_second(1), near_first(2), inner(2), inner(1)]
         children(:, 3) = [centre, m(2), c(3), m(3), &
            inner(2), near_second(2), near_first(3), inner(3)]
         children(:, 4) = [m(4), centre, m(3), c(4), &
            inner(4), inner(3), near_second(3), near_first(4)]
      end associate
   end function quad8_children

   !> Nodes of the four children of a four-node element.
   pure function quad4_children(division, nodes, e) result(children)
      type(division_type), intent(in) :: division
      integer, intent(in) :: nodes(8), e
      integer :: children(4, 4)
      integer :: f, centre, m(4)

      centre = inner_node(division, e, 1)
      m = [(side_node(division, e, f, nodes(f)), f=1, 4)]
      associate (c => nodes(1:4))
         children(:, 1) = [c(1), m(1), centre, m(4)]
         children(:, 2) = [m(1), c(2), m(2), centre]
         children(:, 3) = [centre, m(2), c(3), m(3)]
         children(:, 4) = [m(4), centre, m(3), c(4)]
      end associate
   end function quad4_children

   !> Nodes of the four children of a six-node triangle; the fourth lies between its midside nodes.
   pure function triangle6_children(division, nodes, e) result(children)
      type(division_type), intent(in) :: division
      integer, intent(in) :: nodes(8), e
      integer :: children(6, 4)
      integer :: f, inner(3), near_first(3), near_second(3)

      do f = 1, 3
         near_first(f) = side_node(division, e, f, nodes(f))
         near_second(f) = side_node(division, e, f, nodes(mod(f, 3) + 1))
         inner(f) = inner_node(division, e, f)
      end do
      associate (c => nodes(1:3), m => nodes(4:6))
         children(:, 1) = [c(1), m(1), m(3), near_first(1), inner(1), near_second(3)]
         children(:, 2) = [m(1), c(2), m(2), near_second(1), near_first(2), inner(2)]
         children(:, 3) = [m(3), m(2), c(3), inner(3), near_second(2), near_first(3)]
         children(:, 4) = [m(1), m(2), m(3), inner(2), inner(3), inner(1)]
      end associate
   end function triangle6_children

   !> Nodes of the four children of a three-node triangle; the fourth is in the middle.
   pure function triangle3_children(division, nodes, e) result(children)
      type(division_type), intent(in) :: division
      integer, intent(in) :: nodes(8), e
      integer :: children(3, 4)
      integer :: f, m(3)

      m = [(side_node(division, e, f, nodes(f)), f=1, 3)]
      associate (c => nodes(1:3))
         children(:, 1) = [c(1), m(1), m(3)]
         children(:, 2) = [m(1), c(2), m(2)]
         children(:, 3) = [m(3), m(2), c(3)]
         children(:, 4) = m
      end associate
   end function triangle3_children

   subroutine refine_node_set(division, mesh, members)
      type(division_type), intent(in) :: division
      type(mesh_type), intent(in) :: mesh
      integer, allocatable, intent(inout) :: members(:)
      logical :: member(division%nodes)
      integer :: i

      member = .false.
      member(members) = .true.
      members = pack([(i, i=1, division%nodes_after)], refined_members(division, mesh, member))
   end subroutine refine_node_set

   subroutine refine_element_set(elements, members)
      integer, intent(in) :: elements
      integer, allocatable, intent(inout) :: members(:)
      integer :: i, child

      members = [members, ((child_element(elements, members(i), child), child=2, 4), &
         i=1, size(members))]
   end subroutine refine_element_set

   !> A face becomes the faces of the same name of the two children at it.
   subroutine refine_faces(elements, kinds, faces)
      integer, intent(in) :: elements
      integer, intent(in) :: kinds(:)
      integer, allocatable, intent(inout) :: faces(:, :)
      integer, allocatable :: halves(:, :)
      integer :: i, f

      allocate(halves(2, 2*size(faces, 2)))
      do i = 1, size(faces, 2)
         associate (element => faces(1, i), corners => element_corner_count(kinds(faces(1, i))))
            f = faces(2, i)
            halves(:, 2*i - 1) = [child_element(elements, element, f), f]
            halves(:, 2*i) = [child_element(elements, element, mod(f, corners) + 1), f]
         end associate
      end do
      call move_alloc(halves, faces)
   end subroutine refine_faces

end module refinement
