!> Whether the Jacobian of every element is positive, and why where it is not: a node that is out of
!> place, or nodes that are not in order.
module jacobian_checks
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use element_kinds, only: element_corner_count, element_node_count, linear_kind, side_node_count
   use kinds, only: dp
   use mesh, only: mesh_type
   use misplaced_nodes, only: corner_areas, element_jacobians, find_misplaced, node_jacobians
   use node_orders, only: alternates, exchanged_midsides
   use text, only: others, to_text
   implicit none
   private
   public :: check_jacobians, check_corners, check_folds

   integer, parameter :: most_searched = 50   !! elements for which a misplaced node is looked for

   !> Negative Jacobian at a node, as a part of the largest at the nodes of its element, and part of
   !> a side past a quarter point, from which on an element is warned of. At quarter points and at
   !> corners in one place the Jacobian is 0, but for the few digits of coordinates.
   real(dp), parameter :: folded = 1.0e-2_dp
   real(dp), parameter :: quarter = 0.25_dp    !! nearest to a corner that a midside node may be

contains

   !> The Jacobian is positive at the Gauss points of every element. A node that is out of place is
   !> reported where it is, once for all elements that it inverts; elements that go round
   !> clockwise, or whose cards have their nodes in another order, are reported once.
   subroutine check_jacobians(context, mesh, misordered, report)
      type(deck_context_type), intent(in) :: context       !! places for messages
      type(mesh_type), intent(in) :: mesh
      logical, intent(out) :: misordered(:)  !! (elements) whether its sides are others than meant
      type(deck_report_type), intent(inout) :: report      !! receives errors
      logical, dimension(size(mesh%element_number)) :: inverted, turned
      integer, allocatable :: nodes(:)
      integer :: e, searched

      inverted = .false.
      turned = .false.
      do e = 1, size(inverted)
         if (.not. context%element_valid(e)) cycle
         associate (kind => mesh%element_kind(e))
            inverted(e) = .not. is_sound(kind, &
               mesh%coordinates(:, mesh%element_nodes(:element_node_count(kind), e)))
            if (inverted(e)) turned(e) = all(corner_areas(mesh%coordinates(:, &
               mesh%element_nodes(:element_corner_count(kind), e))) < 0.0_dp)
         end associate
      end do
      e = findloc(turned, .true., dim=1)
      if (e > 0) call report%error(context%element_place(e), inverted_element(mesh, e)// &
         advice(mesh%element_kind(e))//others(count(turned), '; elements that do not: '))
      misordered = turned
      inverted = inverted .and. .not. turned
      call check_orders(context, mesh, inverted, misordered, report)
      searched = 0
      do e = 1, size(inverted)
         if (.not. inverted(e)) cycle
         nodes = [integer ::]
         searched = searched + 1
         if (searched <= most_searched .and. .not. is_crossed(mesh, e)) then
            call find_misplaced(mesh, context%element_valid, inverted, e, nodes)
         end if
         select case (size(nodes))
         case (1)
            call report_misplaced(context, mesh, nodes(1), inverted, report)
         case (2:3)
            call report%error(context%element_place(e), inverted_element(mesh, e)//': '// &
               listed('node', mesh%node_number(nodes), ' or ')//' is out of place')
         case default
            call report%error(context%element_place(e), inverted_element(mesh, e)// &
               advice(mesh%element_kind(e)))
         end select
      end do
   end subroutine check_jacobians

   !> Reports the inverted elements whose cards have their nodes in another order; they are
   !> explained then.
   subroutine check_orders(context, mesh, inverted, misordered, report)
      type(deck_context_type), intent(in) :: context
      type(mesh_type), intent(in) :: mesh
      logical, intent(inout) :: inverted(:), misordered(:)
      type(deck_report_type), intent(inout) :: report
      integer, allocatable :: nodes(:)
      integer :: e

      do e = 1, size(inverted)
         if (.not. inverted(e)) cycle
         if (alternates(mesh, e)) then
            call report%error(context%element_place(e), inverted_element(mesh, e)//': its '// &
               'nodes are corner, midside node, corner and so on; write the corners first, '// &
               'then the midside nodes', 'alternating nodes')
         else
            nodes = exchanged_midsides(mesh, e)
            if (size(nodes) == 0) cycle
            call report%error(context%element_place(e), inverted_element(mesh, e)//': its '// &
               listed('midside node', mesh%node_number(nodes), ' and ')//' are exchanged on '// &
               'this card', 'exchanged nodes')
         end if
         inverted(e) = .false.
         misordered(e) = .true.
      end do
   end subroutine check_orders

   !> Reports a node that is out of place; the elements that it inverts are explained then.
   subroutine report_misplaced(context, mesh, node, inverted, report)
      type(deck_context_type), intent(in) :: context
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: node
      logical, intent(inout) :: inverted(:)
      type(deck_report_type), intent(inout) :: report
      logical :: by_node(size(inverted))

      by_node = inverted .and. any(mesh%element_nodes == node, dim=1)
      call report%error(context%node_place(node), 'node '//to_text(mesh%node_number(node))// &
         ' at '//to_text(mesh%coordinates(1, node))//', '//to_text(mesh%coordinates(2, node))// &
         ' is out of place: it inverts '//listed('element', &
         pack(mesh%element_number, by_node), ' and ')//'; correct its coordinates')
      inverted = inverted .and. .not. by_node
   end subroutine report_misplaced

   pure function inverted_element(mesh, e) result(subject)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e
      character(:), allocatable :: subject

      subject = 'the Jacobian of element '//to_text(mesh%element_number(e))//' is not positive'
   end function inverted_element

   pure function advice(kind) result(words)
      integer, intent(in) :: kind
      character(:), allocatable :: words

      words = ': its corners must go round anticlockwise'
      if (side_node_count(kind) == 3) words = words//', its midside nodes lie near the middle'
   end function advice

   !> Numbers in a row: elements 1, 2 and 3.
   pure function listed(noun, numbers, conjunction) result(words)
      character(*), intent(in) :: noun
      integer, intent(in) :: numbers(:)
      character(*), intent(in) :: conjunction   ! before the last
      character(:), allocatable :: words
      integer :: i

      words = noun//' '//to_text(numbers(1))
      if (size(numbers) > 1 .and. conjunction == ' and ') words = noun//'s '//to_text(numbers(1))
      do i = 2, size(numbers) - 1
         words = words//', '//to_text(numbers(i))
      end do
      if (size(numbers) > 1) words = words//conjunction//to_text(numbers(size(numbers)))
   end function listed

   !> Whether two opposite corners of an element are neighbours in another one: its nodes are not in
   !> order.
   pure logical function is_crossed(mesh, e)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e
      integer :: d, first(2), k, n, other

      is_crossed = .false.
      if (element_corner_count(mesh%element_kind(e)) < 4) return
      do other = 1, size(mesh%element_number)
         if (other == e) cycle
         n = element_corner_count(mesh%element_kind(other))
         do d = 1, 2
            do k = 1, 2
               first(k) = findloc(mesh%element_nodes(:n, other), &
                  mesh%element_nodes(d + 2*k - 2, e), dim=1)
            end do
            if (any(first == 0)) cycle
            is_crossed = is_crossed .or. any(modulo(first(1) - first(2), n) == [1, n - 1])
         end do
      end do
   end function is_crossed

   !> Warns of elements that are folded at a node, although their Jacobian is positive at all Gauss
   !> points: their map is not one to one.
   subroutine check_folds(context, mesh, report)
      type(deck_context_type), intent(in) :: context       !! places for messages, order
      type(mesh_type), intent(in) :: mesh                  !! sound at the Gauss points
      type(deck_report_type), intent(inout) :: report      !! receives a warning
      integer :: at, e, first, kind, n, node, number_folded

      number_folded = 0
      do e = 1, size(mesh%element_number)
         kind = mesh%element_kind(e)
         if (context%order == 1) kind = linear_kind(kind)
         n = element_node_count(kind)
         at = folded_node(kind, mesh%coordinates(:, mesh%element_nodes(:n, e)))
         if (at == 0) cycle
         number_folded = number_folded + 1
         if (number_folded > 1) cycle
         first = e
         node = mesh%node_number(mesh%element_nodes(at, e))
      end do
      if (number_folded == 0) return
      call report%warning(context%element_place(first), 'element '// &
         to_text(mesh%element_number(first))//' is folded at node '//to_text(node)// &
         ': its Jacobian is negative near it, where fields are wrong; move the midside nodes '// &
         'towards the middle of their sides and make its corners convex'// &
         others(number_folded, '; folded elements: '))
   end subroutine check_folds

   !> The node at which an element is folded, as its position in the element; 0 where there is none.
   !> At a corner to which both its sides return the Jacobian is positive again.
   pure integer function folded_node(kind, coordinates)
      integer, intent(in) :: kind
      real(dp), intent(in) :: coordinates(:, :)            ! (2, nodes) [length]
      real(dp) :: jacobians(size(coordinates, 2)), part
      integer :: corners, i

      folded_node = 0
      corners = element_corner_count(kind)
      if (is_straight(coordinates, corners)) return
      jacobians = node_jacobians(kind, coordinates)
      if (minval(jacobians) < -folded*maxval(jacobians)) folded_node = minloc(jacobians, dim=1)
      if (folded_node > 0 .or. size(coordinates, 2) == corners) return
      do i = 1, corners
         associate (a => coordinates(:, i), b => coordinates(:, mod(i, corners) + 1))
            if (all(abs(b - a) <= 0.0_dp)) cycle
            part = dot_product(coordinates(:, corners + i) - a, b - a)/sum((b - a)**2)
         end associate
         if (part < quarter - folded) folded_node = i
         if (part > 1 - quarter + folded) folded_node = mod(i, corners) + 1
      end do
   end function folded_node

   !> Whether an element is convex and its midside nodes are in the middle of its sides, so that its
   !> Jacobian is positive everywhere.
   pure logical function is_straight(coordinates, corners)
      real(dp), intent(in) :: coordinates(:, :)            ! (2, nodes) [length]
      integer, intent(in) :: corners
      real(dp), parameter :: central = 1.0e-3_dp           ! of the side
      real(dp), dimension(2) :: ahead, back
      integer :: i, next

      is_straight = .false.
      back = coordinates(:, 1) - coordinates(:, corners)
      do i = 1, corners
         next = mod(i, corners) + 1
         ahead = coordinates(:, next) - coordinates(:, i)
         if (back(1)*ahead(2) - back(2)*ahead(1) <= 0.0_dp) return
         if (size(coordinates, 2) > corners) then
            if (sum((coordinates(:, corners + i) - coordinates(:, i) - 0.5_dp*ahead)**2) > &
               central**2*sum(ahead**2)) return
         end if
         back = ahead
      end do
      is_straight = .true.
   end function is_straight

   !> The same of elements that lost their midside nodes; the first that is not sound is named.
   subroutine check_corners(place, mesh, report)
      type(place_type), intent(in) :: place                !! where the order of elements is
      type(mesh_type), intent(in) :: mesh                  !! the mesh, of linear elements
      type(deck_report_type), intent(inout) :: report      !! receives an error
      integer :: e

      do e = 1, size(mesh%element_number)
         associate (kind => mesh%element_kind(e))
            if (is_sound(kind, &
               mesh%coordinates(:, mesh%element_nodes(:element_node_count(kind), e)))) cycle
         end associate
         call report%error(place, 'the Jacobian of element '//to_text(mesh%element_number(e))// &
            ' is not positive without midside nodes: its sides are too curved for ORDER=1')
         return
      end do
   end subroutine check_corners

   pure logical function is_sound(kind, coordinates)
      integer, intent(in) :: kind
      real(dp), intent(in) :: coordinates(:, :)

      is_sound = all(element_jacobians(kind, coordinates) > 0.0_dp)
   end function is_sound

end module jacobian_checks
