!> Which free sides of elements lie on each other: a node of one on the other, and both along a part
!> of their length.
module touching_sides
   use element_sides, only: element_sides_type, find_sides
   use kinds, only: dp
   use mesh, only: mesh_type
   implicit none
   private
   public :: touch_type, find_touches

   !> Part of the shorter side by which it may be apart from the other one: coordinates of decks
   !> have few digits.
   real(dp), parameter :: close_by = 1.0e-3_dp

   !> Part of the shorter side along which two sides must lie on each other: at corners of bodies
   !> they meet in a point.
   real(dp), parameter :: overlapping = 0.05_dp

   real(dp), parameter :: margin = 0.1_dp   !! part of a side by which it may bulge past its nodes
   integer, parameter :: few = 8            !! nodes that are compared with each side
   integer, parameter :: deepest = 60       !! halvings of the model
   integer, parameter :: most_steps = 8     !! to the nearest position on a curved side

   !> A node on a free side that is not one of the side's nodes.
   type :: touch_type
      integer :: node = 0      !! node index
      integer :: side = 0      !! the side, index into the sides
      integer :: other = 0     !! side of the node that lies on it
      integer :: partner = 0   !! node of the side at the same place, or 0
   end type touch_type

   !> Nodes on sides, as they are found.
   type :: touch_list_type
      integer :: count = 0
      type(touch_type), allocatable :: items(:)   !! (capacity)
   contains
      procedure :: add
   end type touch_list_type

contains

   !> Finds the nodes that lie on free sides of others.
   subroutine find_touches(mesh, sides, touches)
      type(mesh_type), intent(in) :: mesh                     !! sound, not refined
      type(element_sides_type), intent(out) :: sides          !! its sides
      type(touch_type), allocatable, intent(out) :: touches(:)
      type(touch_list_type) :: near, found
      integer, allocatable :: free(:), start(:), at_node(:)
      real(dp), allocatable :: box(:, :)
      integer :: i, k, s

      sides = find_sides(mesh)
      free = pack([(s, s=1, sides%count)], sides%elements(2, :sides%count) == 0)
      call list_at_nodes(sides, free, size(mesh%node_number), start, at_node)
      allocate (box(4, sides%count))
      do i = 1, size(free)
         box(:, free(i)) = box_of(mesh, sides%ends(:, free(i)))
      end do
      allocate (near%items(64), found%items(64))
      call compare(mesh, sides, box, pack([(k, k=1, size(mesh%node_number))], &
         start(2:) > start(:size(start) - 1)), free, 0, near)
      do i = 1, near%count
         associate (touch => near%items(i))
            do k = start(touch%node), start(touch%node + 1) - 1
               touch%other = at_node(k)
               if (lie_on_each_other(mesh, sides, touch%side, touch%other)) call found%add(touch)
            end do
         end associate
      end do
      touches = found%items(:found%count)
   end subroutine find_touches

   !> The free sides that each node belongs to.
   pure subroutine list_at_nodes(sides, free, nodes, start, at_node)
      type(element_sides_type), intent(in) :: sides
      integer, intent(in) :: free(:)
      integer, intent(in) :: nodes
      integer, allocatable, intent(out) :: start(:)     ! (nodes + 1) first of each node
      integer, allocatable, intent(out) :: at_node(:)   ! sides
      integer :: i, k, n
      integer, allocatable :: next(:)

      allocate (start(nodes + 1), source=0)
      do i = 1, size(free)
         do k = 1, 3
            n = sides%ends(k, free(i))
            if (n > 0) start(n + 1) = start(n + 1) + 1
         end do
      end do
      start(1) = 1
      do n = 1, nodes
         start(n + 1) = start(n + 1) + start(n)
      end do
      next = start
      allocate (at_node(start(nodes + 1) - 1))
      do i = 1, size(free)
         do k = 1, 3
            n = sides%ends(k, free(i))
            if (n == 0) cycle
            at_node(next(n)) = free(i)
            next(n) = next(n) + 1
         end do
      end do
   end subroutine list_at_nodes

   !> Least x and y, largest x and y of a side.
   pure function box_of(mesh, ends) result(box)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: ends(3)     ! as element_sides_type
      real(dp) :: box(4)
      real(dp) :: wider

      associate (a => mesh%coordinates(:, ends(1)), b => mesh%coordinates(:, ends(3)))
         box = [min(a, b), max(a, b)]
      end associate
      if (ends(2) > 0) then
         box(:2) = min(box(:2), mesh%coordinates(:, ends(2)))
         box(3:) = max(box(3:), mesh%coordinates(:, ends(2)))
      end if
      wider = margin*length_of(mesh, ends)
      box(:2) = box(:2) - wider
      box(3:) = box(3:) + wider
   end function box_of

   !> Finds nodes on sides among some of them, halving the region of the nodes until few are left.
   recursive subroutine compare(mesh, sides, box, nodes, some, depth, near)
      type(mesh_type), intent(in) :: mesh
      type(element_sides_type), intent(in) :: sides
      real(dp), intent(in) :: box(:, :)         ! (4, sides)
      integer, intent(in) :: nodes(:)           ! node indexes
      integer, intent(in) :: some(:)            ! sides
      integer, intent(in) :: depth
      type(touch_list_type), intent(inout) :: near
      real(dp) :: least(2), most(2), middle
      integer :: axis, i, k

      if (size(nodes) == 0 .or. size(some) == 0) return
      least = minval(mesh%coordinates(:, nodes), dim=2)
      most = maxval(mesh%coordinates(:, nodes), dim=2)
      axis = maxloc(most - least, dim=1)
      if (size(nodes) > few .and. depth < deepest .and. most(axis) > least(axis)) then
         middle = least(axis) + 0.5_dp*(most(axis) - least(axis))
         call compare(mesh, sides, box, pack(nodes, mesh%coordinates(axis, nodes) <= middle), &
            pack(some, box(axis, some) <= middle .and. box(axis + 2, some) >= least(axis)), &
            depth + 1, near)
         call compare(mesh, sides, box, pack(nodes, mesh%coordinates(axis, nodes) > middle), &
            pack(some, box(axis + 2, some) >= middle .and. box(axis, some) <= most(axis)), &
            depth + 1, near)
         return
      end if
      do i = 1, size(nodes)
         associate (x => mesh%coordinates(:, nodes(i)))
            do k = 1, size(some)
               if (x(1) < box(1, some(k)) .or. x(1) > box(3, some(k))) cycle
               if (x(2) < box(2, some(k)) .or. x(2) > box(4, some(k))) cycle
               if (any(sides%ends(:, some(k)) == nodes(i))) cycle
               if (place_on(mesh, sides%ends(:, some(k)), x, close_by* &
                  length_of(mesh, sides%ends(:, some(k)))) < 0.0_dp) cycle
               call near%add(touch_type(nodes(i), some(k), 0, &
                  partner_of(mesh, sides%ends(:, some(k)), x)))
            end do
         end associate
      end do
   end subroutine compare

   !> The node of a side at a place, or 0.
   pure integer function partner_of(mesh, ends, x) result(partner)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: ends(3)
      real(dp), intent(in) :: x(2)
      integer :: k

      do k = 1, 3
         partner = ends(k)
         if (partner == 0) cycle
         if (norm2(mesh%coordinates(:, partner) - x) <= close_by*length_of(mesh, ends)) return
      end do
      partner = 0
   end function partner_of

   pure function chord(mesh, ends)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: ends(3)
      real(dp) :: chord(2)

      chord = mesh%coordinates(:, ends(3)) - mesh%coordinates(:, ends(1))
   end function chord

   pure real(dp) function length_of(mesh, ends) result(length)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: ends(3)

      length = norm2(chord(mesh, ends))
   end function length_of

   !> Whether two sides of different elements lie on each other along a part of their length, the
   !> elements on either side. Where bodies overlap, as in a press fit, outlines may coincide too.
   pure logical function lie_on_each_other(mesh, sides, one, other) result(touching)
      type(mesh_type), intent(in) :: mesh
      type(element_sides_type), intent(in) :: sides
      integer, intent(in) :: one, other
      real(dp) :: first, last, place, shorter
      integer :: k

      touching = .false.
      if (sides%elements(1, one) == sides%elements(1, other)) return
      associate (mine => sides%ends(:, one), its => sides%ends(:, other))
         shorter = min(length_of(mesh, mine), length_of(mesh, its))
         if (shorter <= 0.0_dp) return
         if (dot_product(chord(mesh, mine), chord(mesh, its)) >= 0.0_dp) return
         first = 1.0_dp
         last = 0.0_dp
         do k = 1, 3
            if (its(k) == 0) cycle
            place = place_on(mesh, mine, mesh%coordinates(:, its(k)), close_by*shorter)
            if (place < 0.0_dp) cycle
            first = min(first, place)
            last = max(last, place)
         end do
         do k = 1, 3
            if (mine(k) == 0) cycle
            if (place_on(mesh, its, mesh%coordinates(:, mine(k)), close_by*shorter) < 0.0_dp) cycle
            place = place_on(mesh, mine, mesh%coordinates(:, mine(k)), close_by*shorter)
            first = min(first, place)
            last = max(last, place)
         end do
         touching = (last - first)*length_of(mesh, mine) > overlapping*shorter
      end associate
   end function lie_on_each_other

   !> Where a point lies on a side, 0 at its first corner and 1 at its second; -1 where it is
   !> farther from the side than a distance.
   pure real(dp) function place_on(mesh, ends, x, distance) result(place)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: ends(3)
      real(dp), intent(in) :: x(2), distance
      real(dp), parameter :: settled = 1.0e-9_dp
      integer :: step
      real(dp) :: along(2), apart(2), bulge(2), slope(2), change, xi

      ! The side is centre + xi along/2 - xi^2 bulge, xi from -1 to 1; straight ones take one step.
      bulge = 0.0_dp
      associate (a => mesh%coordinates(:, ends(1)), b => mesh%coordinates(:, ends(3)))
         along = 0.5_dp*(b - a)
         apart = x - 0.5_dp*(a + b)
         if (ends(2) > 0) bulge = mesh%coordinates(:, ends(2)) - 0.5_dp*(a + b)
      end associate
      apart = apart - bulge
      xi = 0.0_dp
      do step = 1, most_steps
         slope = along - 2*xi*bulge
         if (sum(slope**2) <= 0.0_dp) exit
         change = dot_product(apart - xi*along + xi**2*bulge, slope)/sum(slope**2)
         change = min(max(xi + change, -1.0_dp), 1.0_dp) - xi
         xi = xi + change
         if (abs(change) <= settled .or. ends(2) == 0) exit
      end do
      place = -1.0_dp
      if (sum((apart - xi*along + xi**2*bulge)**2) <= distance**2) place = 0.5_dp*(xi + 1)
   end function place_on

   subroutine add(self, touch)
      class(touch_list_type), intent(inout) :: self
      type(touch_type), intent(in) :: touch
      type(touch_type), allocatable :: more(:)

      if (self%count == size(self%items)) then
         allocate (more(2*self%count))
         more(:self%count) = self%items
         call move_alloc(more, self%items)
      end if
      self%count = self%count + 1
      self%items(self%count) = touch
   end subroutine add

end module touching_sides
