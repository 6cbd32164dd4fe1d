!> Refinement of a model: elements become four of their kind. A child's map is its parent's on a
!> quarter of the element, so the geometry does not change. Sets, surfaces, sections, initial
!> temperatures and loads follow.
module refinement
   use child_elements, only: refine_elements
   use element_kinds, only: element_corner_count
   use kinds, only: dp
   use load_refinement, only: refine_loads
   use mesh, only: mesh_type
   use mesh_division, only: child_element, divide, division_type, hanging_after, refined_members
   use model, only: model_type
   implicit none
   private
   public :: refine, refine_chosen

contains

   !> Divides all elements of a model; its bodies and the nodes of its boundaries must be found anew
   !> afterwards.
   subroutine refine(model, levels)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: levels   !! number of refinements, each with four times the elements
      integer :: e, level

      do level = 1, levels
         call refine_chosen(model, [(.true., e=1, size(model%mesh%element_number))])
      end do
      model%refinement_levels = model%refinement_levels + levels
   end subroutine refine

   !> Divides some elements of a model; what else must be done is as for all of them.
   subroutine refine_chosen(model, chosen, levels)
      type(model_type), intent(inout) :: model
      logical, intent(in) :: chosen(:)   !! (elements) as in divide
      !> (elements) how often they are still to be divided; afterwards of the children
      integer, allocatable, intent(inout), optional :: levels(:)
      type(division_type) :: division

      division = divide(model%mesh, chosen)
      if (allocated(model%initial_temperature)) then
         model%initial_temperature = division%weights%multiply(model%initial_temperature)
      end if
      if (allocated(model%steps)) call refine_loads(division, model%mesh%element_kind, model%steps)
      if (present(levels)) levels = max(levels(parents_of(division)) - 1, 0)
      call refine_mesh(division, model%mesh)
   end subroutine refine_chosen

   subroutine refine_mesh(division, mesh)
      type(division_type), intent(in) :: division
      type(mesh_type), intent(inout) :: mesh
      real(dp), allocatable :: coordinates(:, :)
      integer :: i, first, parent(division%elements_after)

      do i = 1, size(mesh%node_sets)
         call refine_node_set(division, mesh%node_sets(i)%members)
      end do
      do i = 1, size(mesh%element_sets)
         call refine_element_set(division, mesh%element_sets(i)%members)
      end do
      do i = 1, size(mesh%surfaces)
         call refine_faces(division, mesh%element_kind, mesh%surfaces(i)%faces)
      end do
      mesh%hanging_sides = hanging_after(division, mesh)
      allocate(coordinates(2, division%nodes_after))
      coordinates(1, :) = division%weights%multiply(mesh%coordinates(1, :))
      coordinates(2, :) = division%weights%multiply(mesh%coordinates(2, :))
      call move_alloc(coordinates, mesh%coordinates)
      first = maxval(mesh%node_number) - division%nodes
      mesh%node_number = [mesh%node_number, &
         (first + i, i=division%nodes + 1, division%nodes_after)]
      first = maxval(mesh%element_number) - division%elements
      mesh%element_number = [mesh%element_number, &
         (first + i, i=division%elements + 1, division%elements_after)]
      call refine_elements(division, mesh%element_kind, mesh%element_nodes)
      parent = parents_of(division)
      mesh%element_section = mesh%element_section(parent)
      mesh%element_kind = mesh%element_kind(parent)
      mesh%element_plane = mesh%element_plane(parent)
      if (allocated(mesh%initial_stress)) mesh%initial_stress = mesh%initial_stress(:, parent)
   end subroutine refine_mesh

   !> The element that each one was before; children have their section and kind from it.
   pure function parents_of(division) result(parent)
      type(division_type), intent(in) :: division
      integer :: parent(division%elements_after)
      integer :: e, child

      parent(:division%elements) = [(e, e=1, division%elements)]
      do e = 1, division%elements
         if (division%rank(e) == 0) cycle
         do child = 2, 4
            parent(child_element(division, e, child)) = e
         end do
      end do
   end function parents_of

   subroutine refine_node_set(division, members)
      type(division_type), intent(in) :: division
      integer, allocatable, intent(inout) :: members(:)
      logical :: member(division%nodes)
      integer :: i

      member = .false.
      member(members) = .true.
      members = pack([(i, i=1, division%nodes_after)], refined_members(division, member))
   end subroutine refine_node_set

   subroutine refine_element_set(division, members)
      type(division_type), intent(in) :: division
      integer, allocatable, intent(inout) :: members(:)
      integer, allocatable :: divided(:)
      integer :: i, child

      divided = pack(members, division%rank(members) > 0)
      members = [members, ((child_element(division, divided(i), child), child=2, 4), &
         i=1, size(divided))]
   end subroutine refine_element_set

   !> A face of a divided element becomes the faces of the same name of the two children at it.
   subroutine refine_faces(division, kinds, faces)
      type(division_type), intent(in) :: division
      integer, intent(in) :: kinds(:)
      integer, allocatable, intent(inout) :: faces(:, :)
      integer, allocatable :: after(:, :)
      integer :: i, n

      allocate(after(2, 2*size(faces, 2)))
      n = 0
      do i = 1, size(faces, 2)
         associate (element => faces(1, i), f => faces(2, i), &
            corners => element_corner_count(kinds(faces(1, i))))
            if (division%rank(element) == 0) then
               n = n + 1
               after(:, n) = faces(:, i)
            else
               after(:, n + 1) = [child_element(division, element, f), f]
               after(:, n + 2) = [child_element(division, element, mod(f, corners) + 1), f]
               n = n + 2
            end if
         end associate
      end do
      faces = after(:, :n)
   end subroutine refine_faces

end module refinement
