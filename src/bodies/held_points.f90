!> Contact points that supports hold along a direction, an axis of the mesh or one that a *TRANSFORM
!> gives their nodes: no shear acts there, and only their contact condition stays, along their own
!> normal. And contact points of faces that do not match, one of whose forces the others can
!> replace.
!>
!> The hats of a slave face are told apart by the nodes that move with it: each by its own corner
!> of the slave, or, where supports hold that, by the master. Where the slave is held and finer than
!> the master, there are more forces than nodes to act on: some combination of them, of alternating
!> sign, acts on nothing, and pressures are undetermined. The same holds at a corner where supports
!> hold both faces, unless sides with midside nodes meet there. Whether a face is straight makes no
!> difference: on a curved one the combination acts on nearly nothing. So all directions of a face
!> count as one, along its normals or its tangents.
module held_points
   use connections, only: connections_type
   use constraint_rows, only: constraint_rows_type, dependent_rows, of_contact, row_origin_type
   use kinds, only: dp
   implicit none
   private
   public :: held_directions, over_constrained, free_part, tangential_positions, first_redundant, &
      least_slant

   !> Component of a unit vector that is rounding: two axes are one, or the normal motion of a
   !> contact point is prescribed.
   real(dp), parameter :: least_slant = 1.0e-9_dp

   !> Part of a row's largest coefficient that those before must leave. Fully held slaves that are
   !> no finer than the master leave half of it; where less than a fifth is left, the smallest
   !> singular value of the means in the norm of L2 is below a tenth of its usual 0.58.
   real(dp), parameter :: least_left = 0.2_dp

contains

   !> Directions along which supports hold contact points: all nodes, or the two opposite ones if it
   !> is nearer to their tangent, as at the end of a line of symmetry.
   pure function held_directions(points, prescribed) result(directions)
      type(connections_type), intent(in) :: points !! all contact points
      logical, intent(in) :: prescribed(:) !! (2 nodes) prescribed displacements
      !> (2, m) unit vectors along which both nodes are held, while their normal motion is not
      !> prescribed; 0 where there are none
      real(dp) :: directions(2, size(points%slave))
      real(dp) :: axes(2, 2)
      logical :: all_held(2)
      integer :: k

      do k = 1, size(points%slave)
         associate (direction => directions(:, k))
            direction = 0.0_dp
            call find_shared_axes(points, prescribed, k, axes, all_held)
            if (holds_normal(points, k, axes, all_held)) cycle
            if (any(all_held)) then
               direction = axes(:, findloc(all_held, .true., dim=1))
            else if (any(abs(held_along_tangent(points, prescribed, k, points%master(k))) > &
               0.0_dp)) then
               direction = held_along_tangent(points, prescribed, k, points%slave(k))
            end if
         end associate
      end do
   end function held_directions

   !> Contact points whose normal motion is prescribed: their nodes are held along both axes, or
   !> along the one that is their normal.
   pure function over_constrained(points, prescribed) result(too_much)
      type(connections_type), intent(in) :: points
      logical, intent(in) :: prescribed(:)               !! (2 nodes) prescribed displacements
      logical :: too_much(size(points%slave))      !! (m)
      real(dp) :: axes(2, 2)
      logical :: all_held(2)
      integer :: k

      do k = 1, size(points%slave)
         call find_shared_axes(points, prescribed, k, axes, all_held)
         too_much(k) = holds_normal(points, k, axes, all_held)
      end do
   end function over_constrained

   !> Whether supports hold both axes, or the one that is the normal.
   pure logical function holds_normal(points, k, axes, all_held)
      type(connections_type), intent(in) :: points
      integer, intent(in) :: k
      real(dp), intent(in) :: axes(2, 2)
      logical, intent(in) :: all_held(2)

      holds_normal = any(all_held) .and. &
         all(all_held .or. abs(matmul(points%normal(:, k), axes)) <= least_slant)
   end function holds_normal

   !> The axes of a contact point's slave node, and along which of them all nodes whose values it
   !> takes are held.
   pure subroutine find_shared_axes(points, prescribed, k, axes, all_held)
      type(connections_type), intent(in) :: points
      logical, intent(in) :: prescribed(:)
      integer, intent(in) :: k
      real(dp), intent(out) :: axes(2, 2)           ! a unit vector each
      logical, intent(out) :: all_held(2)
      integer :: c, i

      call find_axes(points, prescribed, points%slave(k), axes, all_held)
      associate (nodes => points%nodes_of(k))
         do c = 1, 2
            if (all_held(c)) all_held(c) = all([(free_part(points, prescribed, nodes(i), &
               axes(:, c)) <= least_slant, i=1, size(nodes))])
         end do
      end associate
      if (.not. points%turns()) return
      if (size(points%across%values_of(k)) > 0) all_held = all(all_held)
   end subroutine find_shared_axes

   !> The axis nearer to the tangent of a contact point, if supports hold a node along it; else 0.
   pure function held_along_tangent(points, prescribed, k, node) result(direction)
      type(connections_type), intent(in) :: points
      logical, intent(in) :: prescribed(:)
      integer, intent(in) :: k, node
      real(dp) :: direction(2)
      real(dp) :: axes(2, 2)
      logical :: fixed(2)

      call find_axes(points, prescribed, node, axes, fixed)
      direction = 0.0_dp
      associate (n => abs(matmul(points%normal(:, k), axes)))
         if (fixed(1) .and. n(1) < n(2)) direction = axes(:, 1)
         if (fixed(2) .and. n(2) < n(1)) direction = axes(:, 2)
      end associate
   end function held_along_tangent

   !> Part of a direction along which supports leave a node free.
   pure real(dp) function free_part(points, prescribed, node, direction)
      type(connections_type), intent(in) :: points
      logical, intent(in) :: prescribed(:)               !! (2 nodes) prescribed displacements
      integer, intent(in) :: node
      real(dp), intent(in) :: direction(2)         !! unit vector
      real(dp) :: axes(2, 2)
      logical :: fixed(2)

      call find_axes(points, prescribed, node, axes, fixed)
      free_part = norm2(merge(0.0_dp, matmul(direction, axes), fixed))
   end function free_part

   !> The axes along which cards name the displacements of a node, and which of these supports
   !> prescribe, also by an equation whose other terms they hold.
   pure subroutine find_axes(points, prescribed, node, axes, fixed)
      type(connections_type), intent(in) :: points
      logical, intent(in) :: prescribed(:)
      integer, intent(in) :: node
      real(dp), intent(out) :: axes(2, 2)           ! a unit vector each
      logical, intent(out) :: fixed(2)
      integer :: i, named   ! named: the node whose degrees of freedom cards name for it

      axes = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])
      named = node
      i = findloc(points%partners%node, node, dim=1)
      if (i > 0) then
         axes = points%partners(i)%axes
         named = points%partners(i)%partner
      end if
      fixed = prescribed(2*named - 1:2*named)
      do i = 1, size(points%equations)
         associate (equation => points%equations(i))
            if (equation%node(1) /= node .or. equation%is_thermal()) cycle
            associate (others => equation%places())
               if (all(prescribed(others(2:)))) fixed(equation%dof(1)) = .true.
            end associate
         end associate
      end do
   end subroutine find_axes

   !> Positions of the slave along the tangents, relative to the master. A held contact point slides
   !> only as its supports do: while it is open, the position counts that it would have if it closed
   !> with the supports where they are.
   pure function tangential_positions(points, directions, displacement) result(position)
      type(connections_type), intent(in) :: points !! all contact points
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

   !> A contact point of one interface whose normal force, or friction force, supports leave
   !> undetermined beside those of the others; 0 where there is none. Contact points whose normal
   !> motion is prescribed do not count.
   pure integer function first_redundant(points, first, last, prescribed, has_friction) &
      result(found)
      type(connections_type), intent(in) :: points !! all contact points
      integer, intent(in) :: first, last                  !! those of the interface
      logical, intent(in) :: prescribed(:) !! (2 nodes) prescribed displacements
      logical, intent(in) :: has_friction(:)              !! (m)
      logical :: moves(size(has_friction)), slides(size(has_friction))
      integer :: k

      moves = .not. over_constrained(points, prescribed)
      found = redundant_along(points, pack([(k, k=first, last)], moves(first:last)), &
         points%normal, prescribed)
      if (found > 0) return
      slides = has_friction .and. moves .and. &
         .not. norm2(held_directions(points, prescribed), dim=1) > 0.0_dp
      found = redundant_along(points, pack([(k, k=first, last)], slides(first:last)), &
         points%tangent, prescribed)
   end function first_redundant

   !> The same of some contact points in given directions. Those whose own node is free come first;
   !> only the others can be redundant.
   pure integer function redundant_along(points, chosen, direction, prescribed) result(found)
      type(connections_type), intent(in) :: points
      integer, intent(in) :: chosen(:)
      real(dp), intent(in) :: direction(:, :)             ! (2, m) unit vectors
      logical, intent(in) :: prescribed(:)
      type(constraint_rows_type) :: rows
      integer :: i, k
      integer, allocatable :: order(:)
      logical :: own_is_free(size(chosen))

      own_is_free = [(free_part(points, prescribed, points%slave(chosen(i)), &
         direction(:, chosen(i))) > 0.5_dp, i=1, size(chosen))]
      found = 0
      if (all(own_is_free)) return
      order = [pack(chosen, own_is_free), pack(chosen, .not. own_is_free)]
      rows%dofs = size(prescribed)/2
      allocate (rows%on_tail(0))
      associate (hanging => points%hanging)
         rows%choice = [(0, i=1, hanging%count), points%slave(order)]
         rows%origin = [(row_origin_type(of_contact, i), i=1, size(rows%choice))]
         call rows%reserve(size(rows%choice), 8*size(rows%choice))
         do i = 1, hanging%count
            call rows%add(hanging%values_of(i), hanging%coefficients_of(i))
         end do
      end associate
      do k = 1, size(order)
         associate (nodes => points%nodes_of(order(k)))
            call rows%add(nodes, points%difference%coefficients_of(order(k))* &
               [(free_part(points, prescribed, nodes(i), direction(:, order(k))), &
               i=1, size(nodes))])
         end associate
      end do
      associate (dependent => dependent_rows(rows, least_left), before => points%hanging%count)
         k = findloc(dependent(before + 1:), .true., dim=1)
      end associate
      if (k > 0) found = order(k)
   end function redundant_along

end module held_points
