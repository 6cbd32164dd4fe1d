!> Uniform refinement of a model: each eight-node element becomes four. A child's quadratic map is its parent's on a
!> quarter of the square, so the geometry does not change. Sets, surfaces, sections, initial temperatures and face
!> loads follow; forces on nodes stay where they are.
module refinement
   use kinds, only: dp
   use mesh, only: face_nodes, mesh_type, set_type, surface_type
   use model, only: model_type
   use steps, only: face_load_type
   implicit none
   private
   public :: refine

   !> Shape functions of a three-node side at xi = -1/2; reversed at xi = 1/2.
   real(dp), parameter :: side_weights(3) = [0.375_dp, 0.75_dp, -0.125_dp]

   !> Shape functions of the eight nodes at the centre and half way from it to the midside nodes of faces 1..4.
   real(dp), parameter :: corner_weights(5) = [-0.25_dp, -0.1875_dp, -0.1875_dp, -0.1875_dp, -0.1875_dp]
   real(dp), parameter :: midside_weights(4, 5) = reshape( &
      [0.5_dp, 0.5_dp, 0.5_dp, 0.5_dp, &
      0.75_dp, 0.375_dp, 0.25_dp, 0.375_dp, &
      0.375_dp, 0.75_dp, 0.375_dp, 0.25_dp, &
      0.25_dp, 0.375_dp, 0.75_dp, 0.375_dp, &
      0.375_dp, 0.25_dp, 0.375_dp, 0.75_dp], [4, 5])

   !> Where the new nodes are: behind the old ones two on each side, then five in each element.
   type :: division_type
      integer :: nodes = 0                  !! old nodes
      integer :: elements = 0               !! old elements
      integer :: sides = 0                  !! distinct sides of elements
      integer, allocatable :: side(:)       !! (nodes) side of which the node is the midside node, else 0
      integer, allocatable :: ends(:, :)    !! (3, sides) first corner, midside node, second corner
   end type division_type

contains

   !> Refines a model; its bodies and the nodes of its boundaries must be found anew afterwards.
   subroutine refine(model, levels)
      type(model_type), intent(inout) :: model   !! model with a conforming mesh
      integer, intent(in) :: levels              !! number of refinements, each with four times the elements
      type(division_type) :: division
      integer :: level, s

      do level = 1, levels
         division = divide(model%mesh)
         if (allocated(model%initial_temperature)) &
            model%initial_temperature = refined_values(division, model%mesh%element_nodes, &
            model%initial_temperature)
         if (allocated(model%steps)) then
            do s = 1, size(model%steps)
               if (allocated(model%steps(s)%face_loads)) &
                  call refine_face_loads(division%elements, model%steps(s)%face_loads)
            end do
         end if
         call refine_mesh(division, model%mesh)
      end do
      model%refinement_levels = model%refinement_levels + levels
   end subroutine refine

   !> Numbers the sides in the order of the elements.
   pure function divide(mesh) result(division)
      type(mesh_type), intent(in) :: mesh
      type(division_type) :: division
      integer :: e, f, middle

      division%nodes = size(mesh%node_number)
      division%elements = size(mesh%element_number)
      allocate(division%side(division%nodes), source=0)
      allocate(division%ends(3, 4*division%elements))
      do e = 1, division%elements
         do f = 1, 4
            middle = mesh%element_nodes(face_nodes(2, f), e)
            if (division%side(middle) > 0) cycle
            division%sides = division%sides + 1
            division%side(middle) = division%sides
            division%ends(:, division%sides) = mesh%element_nodes(face_nodes(:, f), e)
         end do
      end do
   end function divide

   !> Index of the new node on a side, next to one of its corners.
   pure integer function side_node(division, middle, corner)
      type(division_type), intent(in) :: division
      integer, intent(in) :: middle, corner

      side_node = division%nodes + 2*division%side(middle)
      if (division%ends(1, division%side(middle)) == corner) side_node = side_node - 1
   end function side_node

   !> Index of an inner node of an element: 1 at the centre, 1 + f half way to face f.
   pure integer function inner_node(division, element, position)
      type(division_type), intent(in) :: division
      integer, intent(in) :: element, position

      inner_node = division%nodes + 2*division%sides + 5*(element - 1) + position
   end function inner_node

   !> Index of a child of an element: the first takes its parent's place.
   pure integer function child_element(elements, parent, child)
      integer, intent(in) :: elements, parent, child

      child_element = elements + 3*(parent - 1) + child - 1
      if (child == 1) child_element = parent
   end function child_element

   !> Values at the old nodes and, by the shape functions, at the new ones.
   pure function refined_values(division, element_nodes, values) result(refined)
      type(division_type), intent(in) :: division
      integer, intent(in) :: element_nodes(:, :)
      real(dp), intent(in) :: values(:)
      real(dp), allocatable :: refined(:)
      integer :: e, s, i

      allocate(refined(division%nodes + 2*division%sides + 5*division%elements))
      refined(:division%nodes) = values
      do s = 1, division%sides
         i = division%nodes + 2*s
         refined(i - 1) = dot_product(side_weights, values(division%ends(:, s)))
         refined(i) = dot_product(side_weights, values(division%ends(3:1:-1, s)))
      end do
      do e = 1, division%elements
         do i = 1, 5
            refined(inner_node(division, e, i)) = &
               corner_weights(i)*sum(values(element_nodes(1:4, e))) + &
               dot_product(midside_weights(:, i), values(element_nodes(5:8, e)))
         end do
      end do
   end function refined_values

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
      allocate(coordinates(2, division%nodes + 2*division%sides + 5*division%elements))
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

   !> New nodes on a side belong to the set if its three nodes do, those inside an element if its eight nodes do.
   subroutine refine_node_set(division, element_nodes, members)
      type(division_type), intent(in) :: division
      integer, intent(in) :: element_nodes(:, :)
      integer, allocatable, intent(inout) :: members(:)
      logical, allocatable :: member(:)
      integer :: i

      allocate(member(division%nodes + 2*division%sides + 5*division%elements), source=.false.)
      member(members) = .true.
      do i = 1, division%sides
         if (all(member(division%ends(:, i)))) member(division%nodes + 2*i - 1:division%nodes + 2*i) = .true.
      end do
      do i = 1, division%elements
         if (all(member(element_nodes(:, i)))) &
            member(inner_node(division, i, 1):inner_node(division, i, 5)) = .true.
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

   subroutine refine_face_loads(elements, loads)
      integer, intent(in) :: elements
      type(face_load_type), allocatable, intent(inout) :: loads(:)
      type(face_load_type), allocatable :: halves(:)
      integer :: i, f

      allocate(halves(2*size(loads)))
      do i = 1, size(loads)
         f = loads(i)%face
         halves(2*i - 1:2*i) = loads(i)
         halves(2*i - 1)%element = child_element(elements, loads(i)%element, f)
         halves(2*i)%element = child_element(elements, loads(i)%element, mod(f, 4) + 1)
      end do
      call move_alloc(halves, loads)
   end subroutine refine_face_loads

end module refinement
