!> Contact points that supports hold along a direction: an axis of the mesh, or an axis that a
!> *TRANSFORM gives their nodes. No shear acts there; only their contact condition stays, along
!> their own normal.
module held_points
   use all_contact_points, only: all_contact_points_type
   use kinds, only: dp
   implicit none
   private
   public :: held_directions, over_constrained, normal_supports, free_part
   public :: tangential_positions

   !> Component of a unit vector that is rounding: two axes are one, or the normal motion of a
   !> contact point is prescribed.
   real(dp), parameter :: least_slant = 1.0e-9_dp

contains

   !> Directions along which supports hold contact points: all nodes, or the two opposite ones if it
   !> is nearer to their tangent, as at the end of a line of symmetry.
   pure function held_directions(points, held) result(directions)
      type(all_contact_points_type), intent(in) :: points !! all contact points
      logical, intent(in) :: held(:)                      !! (2 nodes) prescribed displacements
      !> (2, m) unit vectors along which both nodes are held, while one of them is free across; 0
      !> where there are none
      real(dp) :: directions(2, size(points%slave))
      real(dp) :: axes(2, 2)
      logical :: all_held(2)
      integer :: k

      do k = 1, size(points%slave)
         associate (direction => directions(:, k))
            direction = 0.0_dp
            call find_shared_axes(points, held, k, axes, all_held)
            if (all(all_held)) cycle
            if (any(all_held)) then
               direction = axes(:, findloc(all_held, .true., dim=1))
            else if (norm2(held_along_tangent(points, held, k, points%master(k))) > 0.0_dp) then
               direction = held_along_tangent(points, held, k, points%slave(k))
            end if
         end associate
      end do
   end function held_directions

   !> Contact points whose normal motion is prescribed: their nodes are held along both axes, or
   !> along the one that is their normal.
   pure function over_constrained(points, held) result(too_much)
      type(all_contact_points_type), intent(in) :: points
      logical, intent(in) :: held(:)               !! (2 nodes) prescribed displacements
      logical :: too_much(size(points%slave))      !! (m)
      real(dp) :: axes(2, 2)
      logical :: all_held(2)
      integer :: k

      do k = 1, size(points%slave)
         call find_shared_axes(points, held, k, axes, all_held)
         too_much(k) = any(all_held) .and. &
            all(all_held .or. abs(matmul(points%normal(:, k), axes)) <= least_slant)
      end do
   end function over_constrained

   !> The degrees of freedom, of a contact point's nodes, that supports hold and that move it along
   !> its normal.
   pure function normal_supports(points, held, k) result(dofs)
      type(all_contact_points_type), intent(in) :: points
      logical, intent(in) :: held(:)               !! (2 nodes) prescribed displacements
      integer, intent(in) :: k                     !! a contact point
      integer, allocatable :: dofs(:)
      real(dp) :: axes(2, 2)
      logical :: fixed(2)
      integer, allocatable :: nodes(:)
      integer :: c, i

      nodes = points%nodes_of(k)
      allocate (dofs(0))
      do i = 1, size(nodes)
         call find_axes(points, held, nodes(i), axes, fixed)
         do c = 1, 2
            if (fixed(c) .and. abs(dot_product(points%normal(:, k), axes(:, c))) > least_slant) then
               dofs = [dofs, 2*named_node(points, nodes(i)) - 2 + c]
            end if
         end do
      end do
   end function normal_supports

   !> The axes of a contact point's slave node, and along which of them all nodes whose values it
   !> takes are held.
   pure subroutine find_shared_axes(points, held, k, axes, all_held)
      type(all_contact_points_type), intent(in) :: points
      logical, intent(in) :: held(:)
      integer, intent(in) :: k
      real(dp), intent(out) :: axes(2, 2)           ! a unit vector each
      logical, intent(out) :: all_held(2)
      integer :: c, i

      call find_axes(points, held, points%slave(k), axes, all_held)
      associate (nodes => points%nodes_of(k))
         do c = 1, 2
            if (all_held(c)) all_held(c) = all([(free_part(points, held, nodes(i), axes(:, c)) <= &
               least_slant, i=1, size(nodes))])
         end do
      end associate
      if (.not. points%turns()) return
      if (size(points%across%values_of(k)) > 0) all_held = all(all_held)
   end subroutine find_shared_axes

   !> The axis nearer to the tangent of a contact point, if supports hold a node along it; else 0.
   pure function held_along_tangent(points, held, k, node) result(direction)
      type(all_contact_points_type), intent(in) :: points
      logical, intent(in) :: held(:)
      integer, intent(in) :: k, node
      real(dp) :: direction(2)
      real(dp) :: axes(2, 2)
      logical :: fixed(2)

      call find_axes(points, held, node, axes, fixed)
      direction = 0.0_dp
      associate (n => abs(matmul(points%normal(:, k), axes)))
         if (fixed(1) .and. n(1) < n(2)) direction = axes(:, 1)
         if (fixed(2) .and. n(2) < n(1)) direction = axes(:, 2)
      end associate
   end function held_along_tangent

   !> Part of a direction along which supports leave a node free.
   pure real(dp) function free_part(points, held, node, direction)
      type(all_contact_points_type), intent(in) :: points
      logical, intent(in) :: held(:)               !! (2 nodes) prescribed displacements
      integer, intent(in) :: node
      real(dp), intent(in) :: direction(2)         !! unit vector
      real(dp) :: axes(2, 2)
      logical :: fixed(2)

      call find_axes(points, held, node, axes, fixed)
      free_part = norm2(merge(0.0_dp, matmul(direction, axes), fixed))
   end function free_part

   !> The axes along which cards name the displacements of a node, and which of these supports
   !> prescribe.
   pure subroutine find_axes(points, held, node, axes, fixed)
      type(all_contact_points_type), intent(in) :: points
      logical, intent(in) :: held(:)
      integer, intent(in) :: node
      real(dp), intent(out) :: axes(2, 2)           ! a unit vector each
      logical, intent(out) :: fixed(2)
      integer :: i

      axes = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])
      i = findloc(points%partners%node, node, dim=1)
      if (i > 0) axes = points%partners(i)%axes
      fixed = held(2*named_node(points, node) - 1:2*named_node(points, node))
   end subroutine find_axes

   !> The node whose degrees of freedom cards name for a node: its partner where *TRANSFORM turns
   !> its axes.
   pure integer function named_node(points, node)
      type(all_contact_points_type), intent(in) :: points
      integer, intent(in) :: node
      integer :: i

      named_node = node
      i = findloc(points%partners%node, node, dim=1)
      if (i > 0) named_node = points%partners(i)%partner
   end function named_node

   !> Positions of the slave along the tangents, relative to the master. A held contact point slides
   !> only as its supports do: while it is open, the position counts that it would have if it closed
   !> with the supports where they are.
   pure function tangential_positions(points, directions, displacement) result(position)
      type(all_contact_points_type), intent(in) :: points !! all contact points
      real(dp), intent(in) :: directions(:, :)     !! (2, m) as from held_directions
      real(dp), intent(in) :: displacement(:)      !! (2 nodes) [length]
      real(dp) :: position(size(points%slave))     !! (m) [length]
      real(dp) :: relative(2, size(position))
      integer :: k

      relative = points%relative(displacement)
      do k = 1, size(position)
         associate (d => directions(:, k), n => points%normal(:, k), &
            t => points%tangent(:, k))
            if (norm2(d) > 0.0_dp) then
               position(k) = (dot_product(d, relative(:, k)) - &
                  points%initial_gap(k)*dot_product(d, n))/dot_product(d, t)
            else
               position(k) = dot_product(t, relative(:, k))
            end if
         end associate
      end do
   end function tangential_positions

end module held_points
