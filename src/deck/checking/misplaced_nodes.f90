!> Which nodes are out of place where elements are inverted. With all other nodes where they are,
!> the Jacobian at a point and the area of a corner are linear in the coordinates of one node, so
!> the positions at which all elements round it are sound form a convex polygon. A node for which
!> that is not empty explains its inverted elements.
module misplaced_nodes
   use element_kinds, only: element_corner_count, element_node_count
   use kinds, only: dp
   use mesh, only: extent_of, mesh_type
   use quadrature, only: integration_rule, most_points, point_count
   use shape_functions, only: element_gradients, node_position
   implicit none
   private
   public :: find_misplaced, element_jacobians, node_jacobians, corner_areas

   real(dp), parameter :: rounding = 1.0e-9_dp   !! part of the square searched that is no position

contains

   !> Finds the nodes, any one of which could be moved to make the most inverted elements sound that
   !> an element shares with others.
   subroutine find_misplaced(mesh, valid, inverted, element, nodes)
      type(mesh_type), intent(in) :: mesh
      logical, intent(in) :: valid(:)                !! (elements) whether all nodes are known
      logical, intent(in) :: inverted(:)             !! (elements) those that are to be explained
      integer, intent(in) :: element                 !! one of them
      integer, allocatable, intent(out) :: nodes(:)  !! node indexes; none where no node explains it
      integer, allocatable :: around(:)
      integer :: e, i, most, n

      allocate(nodes(0))
      most = 0
      do i = 1, element_node_count(mesh%element_kind(element))
         n = mesh%element_nodes(i, element)
         around = pack([(e, e=1, size(valid))], valid .and. any(mesh%element_nodes == n, dim=1))
         if (count(inverted(around)) < most) cycle
         if (.not. has_place(mesh, n, around)) cycle
         if (count(inverted(around)) > most) nodes = [integer ::]
         most = count(inverted(around))
         nodes = [nodes, n]
      end do
      if (size(nodes) > 1) call keep_likeliest(mesh, valid, nodes)
   end subroutine find_misplaced

   !> Of nodes that explain the same, keeps those that leave the elements round all of them the
   !> least bent, once moved to the position that their neighbours predict.
   subroutine keep_likeliest(mesh, valid, nodes)
      type(mesh_type), intent(in) :: mesh
      logical, intent(in) :: valid(:)
      integer, allocatable, intent(inout) :: nodes(:)
      real(dp) :: left(size(nodes)), coordinates(2, size(mesh%node_number))
      integer, allocatable :: around(:)
      integer :: e, i
      logical :: near(size(valid))

      near = .false.
      do i = 1, size(nodes)
         near = near .or. (valid .and. any(mesh%element_nodes == nodes(i), dim=1))
      end do
      around = pack([(e, e=1, size(valid))], near)
      do i = 1, size(nodes)
         coordinates = mesh%coordinates
         coordinates(:, nodes(i)) = predicted(mesh, nodes(i), around)
         left(i) = sum([(bend(mesh, around(e), coordinates), e=1, size(around))])
      end do
      nodes = pack(nodes, left <= minval(left) + rounding*extent_of(mesh%coordinates))
   end subroutine keep_likeliest

   !> Where a node is expected: a midside node in the middle of its side, a corner where it makes
   !> parallelograms of the elements round it, on the mean; of triangles midway between the others.
   function predicted(mesh, node, around) result(position)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: node
      integer, intent(in) :: around(:)
      real(dp) :: position(2)
      integer :: corners, i, k, n

      position = 0.0_dp
      n = 0
      do i = 1, size(around)
         k = findloc(mesh%element_nodes(:, around(i)), node, dim=1)
         if (k == 0) cycle
         n = n + 1
         corners = element_corner_count(mesh%element_kind(around(i)))
         associate (x => mesh%coordinates(:, mesh%element_nodes(:corners, around(i))))
            if (k > corners) then
               position = position + 0.5_dp*(x(:, k - corners) + &
                  x(:, mod(k - corners, corners) + 1))
            else if (corners == 4) then
               position = position + x(:, mod(k, 4) + 1) + x(:, mod(k + 2, 4) + 1) - &
                  x(:, mod(k + 1, 4) + 1)
            else
               position = position + 0.5_dp*(sum(x, dim=2) - x(:, k))
            end if
         end associate
      end do
      position = position/max(n, 1)
   end function predicted

   !> How far an element is from straight sides with midside nodes in the middle, a quadrilateral
   !> from a parallelogram [length].
   function bend(mesh, element, coordinates) result(distance)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element
      real(dp), intent(in) :: coordinates(:, :)     ! (2, nodes)
      real(dp) :: distance
      integer :: corners, k, total

      corners = element_corner_count(mesh%element_kind(element))
      total = element_node_count(mesh%element_kind(element))
      associate (x => coordinates(:, mesh%element_nodes(:total, element)))
         distance = 0.0_dp
         if (corners == 4) distance = norm2(x(:, 1) - x(:, 2) + x(:, 3) - x(:, 4))
         do k = 1, total - corners
            distance = distance + norm2(x(:, k) + x(:, mod(k, corners) + 1) - 2*x(:, corners + k))
         end do
      end associate
   end function bend

   !> Whether there is a position for a node at which all elements round it are sound.
   logical function has_place(mesh, node, around)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: node
      integer, intent(in) :: around(:)
      real(dp) :: centre(2), half
      real(dp), allocatable :: polygon(:, :), values(:, :)
      logical :: others(size(mesh%node_number))
      integer :: i, k

      others = .true.
      others(node) = .false.
      do k = 1, 2
         centre(k) = 0.5_dp*(maxval(mesh%coordinates(k, :), mask=others) + &
            minval(mesh%coordinates(k, :), mask=others))
      end do
      half = max(maxval(abs(mesh%coordinates(1, :) - centre(1)), mask=others), &
         maxval(abs(mesh%coordinates(2, :) - centre(2)), mask=others))
      polygon = 2*reshape([-1.0_dp, -1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp], &
         [2, 4])
      do i = 1, size(around)
         values = soundness(mesh, around(i), node, reshape([centre, centre + [half, 0.0_dp], &
            centre + [0.0_dp, half]], [2, 3]))
         do k = 1, size(values, 1)
            call clip(values(k, 1), values(k, 2:) - values(k, 1), polygon)
         end do
      end do
      has_place = area(polygon) > rounding
   end function has_place

   !> What must be positive in an element, with a node of it at other positions.
   function soundness(mesh, element, node, positions) result(values)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element, node
      real(dp), intent(in) :: positions(:, :)          ! (2, positions)
      real(dp), allocatable :: values(:, :)         ! (conditions, positions)
      real(dp), allocatable :: coordinates(:, :)
      integer :: n, p

      associate (kind => mesh%element_kind(element))
         n = element_node_count(kind)
         allocate(values(point_count(kind) + element_corner_count(kind), size(positions, 2)))
         do p = 1, size(positions, 2)
            coordinates = mesh%coordinates(:, mesh%element_nodes(:n, element))
            coordinates(:, findloc(mesh%element_nodes(:n, element), node, dim=1)) = positions(:, p)
            values(:, p) = [element_jacobians(kind, coordinates), corner_areas( &
               coordinates(:, :element_corner_count(kind)))]
         end do
      end associate
   end function soundness

   !> Jacobians of an element at its Gauss points.
   pure function element_jacobians(kind, coordinates) result(jacobians)
      integer, intent(in) :: kind                   !! quad8, ... of element_kinds
      real(dp), intent(in) :: coordinates(:, :)     !! (2, nodes) [length]
      real(dp) :: jacobians(point_count(kind))      !! [length^2]
      real(dp) :: points(2, most_points), weights(most_points)
      real(dp) :: gradients(2, size(coordinates, 2))
      integer :: g

      call integration_rule(kind, points, weights)
      do g = 1, size(jacobians)
         call element_gradients(kind, coordinates, points(:, g), gradients, jacobians(g))
      end do
   end function element_jacobians

   !> Jacobians of an element at its nodes.
   pure function node_jacobians(kind, coordinates) result(jacobians)
      integer, intent(in) :: kind                         !! quad8, ... of element_kinds
      real(dp), intent(in) :: coordinates(:, :)           !! (2, nodes) [length]
      real(dp) :: jacobians(element_node_count(kind))     !! [length^2]
      real(dp) :: at(2, size(jacobians)), gradients(2, size(jacobians))
      integer :: q

      at = node_position(kind)
      do q = 1, size(jacobians)
         call element_gradients(kind, coordinates, at(:, q), gradients, jacobians(q))
      end do
   end function node_jacobians

   !> Twice the area of the triangle that each corner forms with its neighbours, positive where it
   !> turns anticlockwise.
   pure function corner_areas(corners) result(areas)
      real(dp), intent(in) :: corners(:, :)      !! (2, corners) [length]
      real(dp) :: areas(size(corners, 2))        !! [length^2]

      associate (ahead => cshift(corners, 1, dim=2) - corners, &
         back => cshift(corners, -1, dim=2) - corners)
         areas = ahead(1, :)*back(2, :) - ahead(2, :)*back(1, :)
      end associate
   end function corner_areas

   !> Keeps the part of a convex polygon where value + slope*x is not negative.
   pure subroutine clip(value, slope, polygon)
      real(dp), intent(in) :: value, slope(2)
      real(dp), allocatable, intent(inout) :: polygon(:, :)
      real(dp) :: kept(2, 2*size(polygon, 2)), f(size(polygon, 2))
      integer :: i, n, next

      f = value + matmul(slope, polygon)
      n = 0
      do i = 1, size(f)
         next = mod(i, size(f)) + 1
         if (f(i) >= 0.0_dp) then
            n = n + 1
            kept(:, n) = polygon(:, i)
         end if
         if ((f(i) >= 0.0_dp) .eqv. (f(next) >= 0.0_dp)) cycle
         n = n + 1
         kept(:, n) = (polygon(:, i)*f(next) - polygon(:, next)*f(i))/(f(next) - f(i))
      end do
      polygon = kept(:, :n)
   end subroutine clip

   pure real(dp) function area(polygon)
      real(dp), intent(in) :: polygon(:, :)

      area = 0.0_dp
      if (size(polygon, 2) < 3) return
      associate (next => cshift(polygon, 1, dim=2))
         area = 0.5_dp*sum(polygon(1, :)*next(2, :) - polygon(2, :)*next(1, :))
      end associate
   end function area

end module misplaced_nodes
