!> Uniform refinement of a model: each eight-node element becomes four. A child's quadratic map is
!> its parent's on a quarter of the square, so the geometry does not change. Sets, surfaces,
!> sections, initial temperatures and face loads follow; forces on nodes stay where they are.
module refinement
   use kinds, only: dp
   use mesh, only: mesh_type
   use mesh_division, only: child_element, divide, division_type, inner_node, node_count, &
      refined_values, side_node
   use model, only: model_type
   use steps, only: load_body_force, load_body_heat, load_centrifugal, load_face_heat, &
      load_film_coefficient, load_film_sink, load_gravity, load_pressure, load_traction, load_type
   implicit none
   private
   public :: refine

contains

   !> Refines a model; its bodies and the nodes of its boundaries must be found anew afterwards.
   subroutine refine(model, levels)
      type(model_type), intent(inout) :: model   !! model with a conforming mesh
      integer, intent(in) :: levels   !! number of refinements, each with four times the elements
      type(division_type) :: division
      integer :: level, s

      do level = 1, levels
         division = divide(model%mesh)
         if (allocated(model%initial_temperature)) then
            model%initial_temperature = refined_values(division, model%mesh%element_nodes, &
               model%initial_temperature)
         end if
         if (allocated(model%steps)) then
            do s = 1, size(model%steps)
               if (allocated(model%steps(s)%loads)) then
                  call refine_loads(division%elements, model%steps(s)%loads)
               end if
            end do
         end if
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
         call refine_node_set(division, mesh%element_nodes, mesh%node_sets(i)%members)
      end do
      do i = 1, size(mesh%element_sets)
         call refine_element_set(division%elements, mesh%element_sets(i)%members)
      end do
      do i = 1, size(mesh%surfaces)
         call refine_faces(division%elements, mesh%surfaces(i)%faces)
      end do
      allocate(coordinates(2, node_count(division)))
      coordinates(1, :) = refined_values(division, mesh%element_nodes, mesh%coordinates(1, :))
      coordinates(2, :) = refined_values(division, mesh%element_nodes, mesh%coordinates(2, :))
      call move_alloc(coordinates, mesh%coordinates)
      first = maxval(mesh%node_number) - division%nodes
      mesh%node_number = [mesh%node_number, &
         (first + i, i=division%nodes + 1, size(mesh%coordinates, 2))]
      first = maxval(mesh%element_number) - division%elements
      mesh%element_number = [mesh%element_number, &
         (first + i, i=division%elements + 1, 4*division%elements)]
      mesh%element_section = [mesh%element_section, &
         (spread(mesh%element_section(i), 1, 3), i=1, division%elements)]
      mesh%element_kind = [mesh%element_kind, &
         (spread(mesh%element_kind(i), 1, 3), i=1, division%elements)]
      mesh%element_plane = [mesh%element_plane, &
         (spread(mesh%element_plane(i), 1, 3), i=1, division%elements)]
      call refine_elements(division, mesh%element_nodes)
   end subroutine refine_mesh

   subroutine refine_elements(division, element_nodes)
      type(division_type), intent(in) :: division
      integer, allocatable, intent(inout) :: element_nodes(:, :)
      integer, allocatable :: children(:, :)
      integer :: e, f, c(4), m(4), near_first(4), near_second(4), centre, inner(4)

      allocate(children(8, 4*division%elements))
      do e = 1, division%elements
         c = element_nodes(1:4, e)
         m = element_nodes(5:8, e)
         centre = inner_node(division, e, 1)
         do f = 1, 4
            near_first(f) = side_node(division, m(f), c(f))
            near_second(f) = side_node(division, m(f), c(mod(f, 4) + 1))
            inner(f) = inner_node(division, e, 1 + f)
         end do
         children(:, child_element(division%elements, e, 1)) = [c(1), m(1), centre, m(4), &
            near_first(1), inner(1), inner(4), near_second(4)]
         children(:, child_element(division%elements, e, 2)) = [m(1), c(2), m(2), centre, &
            near_second(1), near_first(2), inner(2), inner(1)]
         children(:, child_element(division%elements, e, 3)) = [centre, m(2), c(3), m(3), &
            inner(2), near_second(2), near_first(3), inner(3)]
         children(:, child_element(division%elements, e, 4)) = [m(4), centre, m(3), c(4), &
            inner(4), inner(3), near_second(3), near_first(4)]
      end do
      call move_alloc(children, element_nodes)
   end subroutine refine_elements

   !> New nodes on a side belong to the set if its three nodes do, those inside an element if its
   !> eight nodes do.
   subroutine refine_node_set(division, element_nodes, members)
      type(division_type), intent(in) :: division
      integer, intent(in) :: element_nodes(:, :)
      integer, allocatable, intent(inout) :: members(:)
      logical, allocatable :: member(:)
      integer :: i

      allocate(member(node_count(division)), source=.false.)
      member(members) = .true.
      do i = 1, division%sides
         if (all(member(division%ends(:, i)))) then
            member(division%nodes + 2*i - 1:division%nodes + 2*i) = .true.
         end if
      end do
      do i = 1, division%elements
         if (all(member(element_nodes(:, i)))) then
            member(inner_node(division, i, 1):inner_node(division, i, 5)) = .true.
         end if
      end do
      members = pack([(i, i=1, size(member))], member)
   end subroutine refine_node_set

   subroutine refine_element_set(elements, members)
      integer, intent(in) :: elements
      integer, allocatable, intent(inout) :: members(:)
      integer :: i, child

      members = [members, ((child_element(elements, members(i), child), child=2, 4), &
         i=1, size(members))]
   end subroutine refine_element_set

   !> A face becomes the faces of the same name of the two children at it.
   subroutine refine_faces(elements, faces)
      integer, intent(in) :: elements
      integer, allocatable, intent(inout) :: faces(:, :)
      integer, allocatable :: halves(:, :)
      integer :: i, f

      allocate(halves(2, 2*size(faces, 2)))
      do i = 1, size(faces, 2)
         f = faces(2, i)
         halves(:, 2*i - 1) = [child_element(elements, faces(1, i), f), f]
         halves(:, 2*i) = [child_element(elements, faces(1, i), mod(f, 4) + 1), f]
      end do
      call move_alloc(halves, faces)
   end subroutine refine_faces

   !> Loads on a side go to the two children at it, those on an element to all four.
   subroutine refine_loads(elements, loads)
      integer, intent(in) :: elements
      type(load_type), allocatable, intent(inout) :: loads(:)
      type(load_type), allocatable :: refined(:)
      integer :: i, n, f, children(4), child

      allocate(refined(4*size(loads)))
      n = 0
      do i = 1, size(loads)
         children = [(child_element(elements, loads(i)%item, child), child=1, 4)]
         select case (loads(i)%kind)
         case (load_pressure, load_traction, load_face_heat, load_film_coefficient, load_film_sink)
            f = loads(i)%component
            if (loads(i)%kind == load_traction) f = (f + 1)/2
            refined(n + 1:n + 2) = loads(i)
            refined(n + 1:n + 2)%item = children([f, mod(f, 4) + 1])
            n = n + 2
         case (load_body_force, load_gravity, load_centrifugal, load_body_heat)
            refined(n + 1:n + 4) = loads(i)
            refined(n + 1:n + 4)%item = children
            n = n + 4
         case default
            n = n + 1
            refined(n) = loads(i)
         end select
      end do
      loads = refined(:n)
   end subroutine refine_loads

end module refinement
