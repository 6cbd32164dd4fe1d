!> Refinement of a model: elements become four of their kind. A child's map is its parent's on a
!> quarter of the element, so the geometry does not change. Sets, surfaces, sections and given
!> temperatures follow; loads and supports are applied anew.
module refinement
   use mesh_bodies, only: find_bodies
   use element_kinds, only: element_corner_count, element_node_count
   use kinds, only: dp, long
   use load_application, only: apply_requests, apply_transforms
   use mesh, only: mesh_type
   use mesh_division, only: child_element, divide, division_type, hanging_after, &
      refined_members, side_node
   use model, only: model_type
   use text, only: to_text
   implicit none
   private
   public :: refine, refine_chosen, divide_model, numbering_fault, parents_of

   !> The entries of all elements' 16 x 16 matrices are numbered in default integers.
   integer, parameter :: most_elements = 2**23 - 1

   !> Nodes of the children of quadrilaterals and triangles, corners first, among those of
   !> nodes_of_children. The fourth child of a triangle lies between its midside nodes.
   integer, parameter :: quad_children(8, 4) = reshape([1, 5, 17, 8, 9, 18, 21, 16, &
      5, 2, 6, 17, 13, 10, 19, 18, 17, 6, 3, 7, 19, 14, 11, 20, &
      8, 17, 7, 4, 21, 20, 15, 12], [8, 4])
   integer, parameter :: triangle_children(6, 4) = reshape([1, 4, 6, 7, 13, 12, &
      4, 2, 5, 10, 8, 14, 6, 5, 3, 15, 11, 9, 4, 5, 6, 14, 15, 13], [6, 4])

contains

   !> Why a mesh with more elements, its matrices and the new numbers of its nodes do not fit into
   !> default integers; empty if they do.
   pure function numbering_fault(mesh, elements) result(fault)
      type(mesh_type), intent(in) :: mesh                  !! the mesh before
      integer(long), intent(in) :: elements                !! elements that there will be
      character(:), allocatable :: fault
      integer(long) :: largest

      fault = ''
      if (elements > most_elements) then
         fault = 'the mesh would have '//to_text(elements)//' elements, more than the '// &
            to_text(most_elements)//' that can be numbered'
         return
      end if
      if (elements == size(mesh%element_number) .or. size(mesh%node_number) == 0) return
      ! An element brings at most its eight nodes.
      largest = max(maxval(mesh%node_number), maxval(mesh%element_number)) + 8*elements
      if (largest > huge(1)) fault = 'the numbers of new nodes and elements, behind the '// &
         'largest of the deck, would exceed '//to_text(huge(1))
   end function numbering_fault

   !> Divides all elements of a model, without its loads and supports.
   subroutine refine(model, levels)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: levels   !! number of refinements, each with four times the elements
      integer :: e, level

      do level = 1, levels
         call refine_chosen(model, [(.true., e=1, size(model%mesh%element_number))])
      end do
      model%refinement_levels = model%refinement_levels + levels
   end subroutine refine

   !> Divides a model that is complete, and puts its loads and supports on the new mesh.
   subroutine divide_model(model, division)
      type(model_type), intent(inout) :: model
      type(division_type), intent(in) :: division   !! of its mesh

      call apply_division(model, division)
      if (allocated(model%requests)) then
         call apply_requests(model)
         call apply_transforms(model)
      end if
      call find_bodies(model%mesh)
   end subroutine divide_model

   !> Divides some elements of a model, without its loads and supports.
   subroutine refine_chosen(model, chosen, levels)
      type(model_type), intent(inout) :: model
      logical, intent(in) :: chosen(:)   !! (elements) as in divide
      !> (elements) how often they are still to be divided; afterwards of the children
      integer, allocatable, intent(inout), optional :: levels(:)
      type(division_type) :: division

      division = divide(model%mesh, chosen)
      if (present(levels)) levels = max(levels(parents_of(division)) - 1, 0)
      call apply_division(model, division)
   end subroutine refine_chosen

   subroutine apply_division(model, division)
      type(model_type), intent(inout) :: model
      type(division_type), intent(in) :: division
      integer :: i

      if (allocated(model%initial_temperature)) model%initial_temperature = &
         division%weights%multiply(model%initial_temperature)
      if (allocated(model%fields)) then
         do i = 1, size(model%fields)
            associate (field => model%fields(i))
               field%values = division%weights%multiply(field%values)
               field%given = refined_members(division, field%given)
            end associate
         end do
      end if
      call refine_mesh(division, model%mesh)
   end subroutine apply_division

   subroutine refine_mesh(division, mesh)
      type(division_type), intent(in) :: division
      type(mesh_type), intent(inout) :: mesh
      real(dp), allocatable :: coordinates(:, :)
      integer :: child, i, first, k, nodes(8, 4), parent(division%elements_after)
      integer, allocatable :: children(:, :), divided(:)
      logical :: is_member(division%nodes)

      do i = 1, size(mesh%node_sets)
         associate (members => mesh%node_sets(i)%members)
            is_member = .false.
            is_member(members) = .true.
            mesh%node_sets(i)%members = pack([(k, k=1, division%nodes_after)], &
               refined_members(division, is_member))
         end associate
      end do
      do i = 1, size(mesh%element_sets)
         associate (members => mesh%element_sets(i)%members)
            divided = pack(members, division%rank(members) > 0)
            mesh%element_sets(i)%members = [members, ((child_element(division, divided(k), &
               child), child=2, 4), k=1, size(divided))]
         end associate
      end do
      do i = 1, size(mesh%surfaces)
         call refine_faces(division, mesh%element_kind, mesh%surfaces(i)%faces)
      end do
      mesh%hanging_sides = hanging_after(division, mesh)
      call follow_deck(division, mesh)
      allocate(coordinates(2, division%nodes_after))
      coordinates(1, :) = division%weights%multiply(mesh%coordinates(1, :))
      coordinates(2, :) = division%weights%multiply(mesh%coordinates(2, :))
      call move_alloc(coordinates, mesh%coordinates)
      first = maxval(mesh%node_number) - division%nodes
      mesh%node_number = [mesh%node_number, (first + i, i=division%nodes + 1, division%nodes_after)]
      first = maxval(mesh%element_number) - division%elements
      mesh%element_number = [mesh%element_number, &
         (first + i, i=division%elements + 1, division%elements_after)]
      ! The children take the place of the elements that are divided.
      allocate(children(8, division%elements_after))
      children(:, :division%elements) = mesh%element_nodes
      do i = 1, division%elements
         if (division%rank(i) == 0) cycle
         nodes = nodes_of_children(division, mesh%element_kind(i), mesh%element_nodes(:, i), i)
         do child = 1, 4
            children(:, child_element(division, i, child)) = nodes(:, child)
         end do
      end do
      call move_alloc(children, mesh%element_nodes)
      parent = parents_of(division)
      mesh%element_section = mesh%element_section(parent)
      mesh%element_kind = mesh%element_kind(parent)
      mesh%element_plane = mesh%element_plane(parent)
      if (allocated(mesh%initial_stress)) mesh%initial_stress = mesh%initial_stress(:, parent)
   end subroutine refine_mesh

   !> Which elements of the deck those of the divided mesh are parts of, and along which of their
   !> sides.
   subroutine follow_deck(division, mesh)
      type(division_type), intent(in) :: division
      type(mesh_type), intent(inout) :: mesh         ! with the element kinds before
      integer :: child, corners, e, parent(division%elements_after)
      logical :: along(4)

      if (.not. allocated(mesh%deck_element)) then
         mesh%deck_nodes = division%nodes
         mesh%deck_element = [(e, e=1, division%elements)]
         allocate (mesh%on_deck_side(4, division%elements), source=.true.)
      end if
      parent = parents_of(division)
      mesh%deck_element = mesh%deck_element(parent)
      mesh%on_deck_side = mesh%on_deck_side(:, parent)
      do e = 1, division%elements
         if (division%rank(e) == 0) cycle
         corners = element_corner_count(mesh%element_kind(e))
         do child = 1, 4
            ! A child lies at its corner, between the sides before and behind it; the fourth one of
            ! a triangle lies inside.
            along = .false.
            if (child <= corners) along([child, modulo(child - 2, corners) + 1]) = .true.
            associate (on_side => mesh%on_deck_side(:, child_element(division, e, child)))
               on_side = on_side .and. along
            end associate
         end do
      end do
   end subroutine follow_deck

   !> The element that each one was before; children have their section and kind from it.
   pure function parents_of(division) result(parent)
      type(division_type), intent(in) :: division
      integer :: parent(division%elements_after)   !! (elements afterwards)
      integer :: e, child

      parent(:division%elements) = [(e, e=1, division%elements)]
      do e = 1, division%elements
         if (division%rank(e) == 0) cycle
         do child = 2, 4
            parent(child_element(division, e, child)) = e
         end do
      end do
   end function parents_of

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

   !> Nodes of the four children of an element, (8, 4) as in mesh_type: of its corners, the middles
   !> of its sides, the nodes near the first corner and near the second one of each side, and those
   !> inside.
   pure function nodes_of_children(division, kind, nodes, e) result(children)
      type(division_type), intent(in) :: division
      integer, intent(in) :: kind, nodes(8), e
      integer :: children(8, 4), corners, f, i, own(21)

      corners = element_corner_count(kind)
      own(:2*corners) = nodes(:2*corners)
      do f = 1, corners
         own(2*corners + f) = side_node(division, e, f, nodes(f))
         own(3*corners + f) = side_node(division, e, f, nodes(mod(f, corners) + 1))
      end do
      ! A side of two nodes has one new node, its middle.
      if (element_node_count(kind) == corners) own(corners + 1:2*corners) = &
         own(2*corners + 1:3*corners)
      own(4*corners + 1:) = division%inner_start(e) + [(i, i=1, size(own) - 4*corners)]
      children = 0
      associate (n => element_node_count(kind))
         if (corners == 4) children(:n, :) = reshape(own([quad_children(:n, :)]), [n, 4])
         if (corners == 3) children(:n, :) = reshape(own([triangle_children(:n, :)]), [n, 4])
      end associate
   end function nodes_of_children

end module refinement
