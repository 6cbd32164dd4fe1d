!> Checks once all elements are read: whether their planes agree, whether they meet along whole
!> sides, whether their Jacobian is positive, and no side far shorter than the others.
!>
!> The forces of nodes that nearly coincide, made of stiffnesses that grow as the side shrinks, are
!> known to rounding times the square of the ratio of the sides, in parts of an even load: nothing
!> is left of the pressure at a contact point of such a side at 1e-8.
module mesh_checks
   use deck_context, only: deck_type
   use deck_structure, only: cards_of
   use element_kinds, only: axisymmetric, element_corner_count, element_node_count, &
      generalized_strain, linear_kind, plane_strain, side_node_count
   use element_sides, only: side_ends
   use kinds, only: dp
   use mesh, only: mesh_type
   use quadrature, only: integration_rule, most_points, point_count
   use shape_functions, only: element_gradients, element_shape, node_position
   use sorting, only: sort_order
   use text, only: others, to_text
   implicit none
   private
   public :: check_planes, check_sides, check_jacobians, check_folds, check_slenderness, &
      point_jacobians

   !> One side of one element.
   type :: element_side_type
      integer :: element = 0   !! element index
      integer :: face = 0      !! its side, 1, 2, ...
      integer :: low = 0       !! the corner with the smaller index
      integer :: high = 0      !! the other
      integer :: middle = 0    !! midside node, 0 if there is none
   end type element_side_type

   !> Negative Jacobian at a node, as a part of the largest at the nodes of its element, and part of
   !> a side past a quarter point, from which on an element is warned of. At quarter points and at
   !> corners in one place the Jacobian is 0, but for the few digits of coordinates.
   real(dp), parameter :: folded = 1.0e-2_dp
   real(dp), parameter :: quarter = 0.25_dp    !! nearest to a corner that a midside node may be

   real(dp), parameter :: hopeless = 1.0e-7_dp   !! shortest side over the longest, to be refused
   real(dp), parameter :: doubtful = 1.0e-5_dp   !! the same, to be warned of

   character(*), parameter :: everywhere = 'any integration point'

contains

   !> Beside axisymmetric elements there are none in plane strain; the radius is not negative.
   subroutine check_planes(deck)
      type(deck_type), intent(inout) :: deck
      integer :: e, q, ring, strained
      logical :: turns(size(deck%mesh%element_plane))

      turns = deck%mesh%element_plane == axisymmetric .and. deck%element_valid
      ring = findloc(turns, .true., dim=1)
      strained = findloc((deck%mesh%element_plane == plane_strain .or. deck%mesh%element_plane == &
         generalized_strain) .and. deck%element_valid, .true., dim=1)
      if (ring > 0 .and. strained > 0) then
         call deck%error(deck%element_place(max(ring, strained)), 'element '// &
            to_text(deck%mesh%element_number(ring))//' is axisymmetric and element '// &
            to_text(deck%mesh%element_number(strained))//' in plane strain: plane elements '// &
            'beside axisymmetric ones are in plane stress, such as CPS4')
         return
      end if
      do e = 1, size(turns)
         if (.not. turns(e)) cycle
         do q = 1, element_node_count(deck%mesh%element_kind(e))
            if (deck%mesh%coordinates(1, deck%mesh%element_nodes(q, e)) >= 0.0_dp) cycle
            call deck%error(deck%element_place(e), 'element '//to_text(deck%mesh%element_number( &
               e))//' is axisymmetric: x is the radius, but node '// &
               to_text(deck%mesh%node_number(deck%mesh%element_nodes(q, e)))//' has x < 0')
            exit
         end do
      end do
   end subroutine check_planes

   !> Elements meet along whole sides, two at each; of the faces of surfaces one side is free.
   subroutine check_sides(deck, inverted, uses)
      type(deck_type), intent(inout) :: deck
      logical, intent(in) :: inverted(:)   !! (elements) whether their sides may not be as meant
      !> (4, elements) elements that meet at each side; 0 where an error says that it is wrong
      integer, intent(out) :: uses(:, :)
      type(element_side_type) :: sides(4*size(deck%mesh%element_number))
      integer, allocatable :: order(:)
      integer :: e, f, first, last, n

      n = 0
      do e = 1, size(inverted)
         if (inverted(e) .or. .not. deck%element_valid(e)) cycle
         do f = 1, element_corner_count(deck%mesh%element_kind(e))
            n = n + 1
            associate (ends => side_ends(deck%mesh, e, f))
               sides(n) = element_side_type(e, f, min(ends(1), ends(3)), max(ends(1), ends(3)), &
                  ends(2))
            end associate
         end do
      end do
      order = sort_order(sides(:n)%high)
      order = order(sort_order(sides(order)%low))
      uses = 0
      first = 1
      do while (first <= n)
         last = first
         do while (last < n)
            if (sides(order(last + 1))%low /= sides(order(first))%low) exit
            if (sides(order(last + 1))%high /= sides(order(first))%high) exit
            last = last + 1
         end do
         call check_meeting(deck, sides(order(first:last)), uses)
         first = last + 1
      end do
      call check_middles(deck, sides(:n))
      call check_faces(deck, uses)
   end subroutine check_sides

   subroutine check_meeting(deck, sides, uses)
      type(deck_type), intent(inout) :: deck
      type(element_side_type), intent(in) :: sides(:)
      integer, intent(inout) :: uses(:, :)
      character(:), allocatable :: fault
      integer :: i

      do i = 1, size(sides)
         uses(sides(i)%face, sides(i)%element) = size(sides)
      end do
      do i = 2, size(sides)
         if (i > 2) then
            fault = 'is the third on the side'
         else if (sides(1)%middle == sides(2)%middle) then
            cycle
         else
            fault = 'differs in its midside node from its neighbour '// &
               to_text(deck%mesh%element_number(sides(1)%element))//' on the side'
         end if
         call deck%error(deck%element_place(sides(i)%element), 'element '// &
            to_text(deck%mesh%element_number(sides(i)%element))//' '//fault//' between nodes '// &
            to_text(deck%mesh%node_number(sides(i)%low))//' and '// &
            to_text(deck%mesh%node_number(sides(i)%high)))
      end do
   end subroutine check_meeting

   !> A midside node is no corner, and belongs to one side.
   subroutine check_middles(deck, sides)
      type(deck_type), intent(inout) :: deck
      type(element_side_type), intent(in) :: sides(:)
      logical :: corner(size(deck%mesh%node_number))
      integer :: first(size(deck%mesh%node_number)), i

      corner = .false.
      corner(sides%low) = .true.
      corner(sides%high) = .true.
      first = 0
      do i = 1, size(sides)
         associate (node => sides(i)%middle)
            if (node == 0) cycle
            if (first(node) == 0) first(node) = i
            if (.not. corner(node) .and. sides(first(node))%low == sides(i)%low .and. &
               sides(first(node))%high == sides(i)%high) cycle
            call deck%error(deck%element_place(sides(i)%element), 'element '// &
               to_text(deck%mesh%element_number(sides(i)%element))//' does not share the side '// &
               'with midside node '//to_text(deck%mesh%node_number(node))//' with its neighbour')
         end associate
      end do
   end subroutine check_middles

   !> Faces of surfaces are free: reported once a surface, where the first is named. What is loaded
   !> through such a face is not told again, nor a section that an error kept from being cut.
   subroutine check_faces(deck, uses)
      type(deck_type), intent(inout) :: deck
      integer, intent(inout) :: uses(:, :)   !! (4, elements) elements that meet at each side
      logical :: wrong(size(uses, 1), size(uses, 2)), is_cut(size(deck%mesh%surfaces))
      logical, allocatable :: inside(:)
      integer, allocatable :: sections(:)
      integer :: i, s

      wrong = .false.
      is_cut = .false.
      sections = cards_of(deck%cards, 'PRE-TENSION SECTION')
      do i = 1, size(sections)
         s = deck%index_of('surface', deck%cards%keywords(sections(i))%text('SURFACE'))
         if (s > 0) is_cut(s) = .true.
      end do
      do s = 1, size(deck%mesh%surfaces)
         associate (faces => deck%mesh%surfaces(s)%faces)
            allocate(inside(size(faces, 2)))
            do i = 1, size(inside)
               inside(i) = uses(faces(2, i), faces(1, i)) > 1
               wrong(faces(2, i), faces(1, i)) = wrong(faces(2, i), faces(1, i)) .or. inside(i)
            end do
            i = findloc(inside .and. .not. is_cut(s), .true., dim=1)
            if (i > 0) call deck%error(deck%face_places(s)%items(i), 'face S'//to_text(faces(2, &
               i))//' of element '//to_text(deck%mesh%element_number(faces(1, i)))//' in '// &
               'surface '//deck%mesh%surfaces(s)%name//' lies inside a body: another element '// &
               'has its nodes; bodies that touch need nodes of their own there, in gmsh '// &
               'without BooleanFragments and Coherence'//others(count(inside), '; faces of the '// &
               'surface that do: '))
            deallocate(inside)
         end associate
      end do
      where (wrong) uses = 0
   end subroutine check_faces

   !> The Jacobian is positive at all integration points. Elements that are clockwise are told once.
   subroutine check_jacobians(deck, inverted)
      type(deck_type), intent(inout) :: deck
      logical, intent(out) :: inverted(:)    !! (elements) whether its sides may be wrong
      real(dp), allocatable :: jacobians(:)
      logical :: clockwise(size(inverted))
      real(dp) :: points(2, most_points), weights(most_points), x(2)
      integer :: e, g

      inverted = .false.
      clockwise = .false.
      do e = 1, size(inverted)
         if (.not. deck%element_valid(e)) cycle
         jacobians = point_jacobians(deck%mesh, e)
         inverted(e) = any(jacobians <= 0.0_dp)
         clockwise(e) = all(jacobians < 0.0_dp)
         if (.not. inverted(e) .or. clockwise(e)) cycle
         g = minloc(jacobians, dim=1)
         call integration_rule(deck%mesh%element_kind(e), points, weights)
         x = matmul(deck%mesh%coordinates(:, deck%mesh%element_nodes(:element_node_count( &
            deck%mesh%element_kind(e)), e)), element_shape(deck%mesh%element_kind(e), points(:, g)))
         call deck%error(deck%element_place(e), inversion(deck%mesh, e, 'integration point '// &
            to_text(g)//' at '//to_text(x(1))//', '//to_text(x(2))))
      end do
      e = findloc(clockwise, .true., dim=1)
      if (e > 0) call deck%error(deck%element_place(e), inversion(deck%mesh, e, everywhere)// &
         others(count(clockwise), '; such elements: '))
   end subroutine check_jacobians

   pure function inversion(mesh, e, where) result(message)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e
      character(*), intent(in) :: where
      character(:), allocatable :: message
      integer :: i, k

      message = 'the Jacobian of element '//to_text(mesh%element_number(e))// &
         ' is not positive at '//where//': '
      associate (nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(e)), e))
         do i = 1, size(nodes)
            do k = i + 1, size(nodes)
               associate (way => mesh%coordinates(:, nodes(k)) - mesh%coordinates(:, nodes(i)))
                  if (norm2(way) > 0.0_dp) cycle
               end associate
               message = message//'its nodes '//to_text(mesh%node_number(nodes(i)))//' and '// &
                  to_text(mesh%node_number(nodes(k)))//' are at the same place'
               return
            end do
         end do
      end associate
      message = message//'write its corners anticlockwise'
      if (side_node_count(mesh%element_kind(e)) == 3) message = message// &
         ', then its midside nodes, each near the middle of its side'
      message = message//', or correct their coordinates'
      if (where == everywhere) message = message//'; in gmsh by ReverseMesh Surface'
   end function inversion

   !> Jacobians of an element at its integration points.
   pure function point_jacobians(mesh, e) result(jacobians)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e
      real(dp), allocatable :: jacobians(:)      ! [length^2]
      real(dp) :: points(2, most_points), weights(most_points)

      associate (kind => mesh%element_kind(e))
         call integration_rule(kind, points, weights)
         jacobians = jacobians_at(kind, points(:, :point_count(kind)), &
            mesh%coordinates(:, mesh%element_nodes(:element_node_count(kind), e)))
      end associate
   end function point_jacobians

   pure function jacobians_at(kind, points, coordinates) result(jacobians)
      integer, intent(in) :: kind
      real(dp), intent(in) :: points(:, :)            ! (2, points) xi, eta
      real(dp), intent(in) :: coordinates(:, :)       ! (2, nodes) [length]
      real(dp) :: jacobians(size(points, 2))          ! [length^2]
      real(dp) :: gradients(2, size(coordinates, 2))
      integer :: g

      do g = 1, size(jacobians)
         call element_gradients(kind, coordinates, points(:, g), gradients, jacobians(g))
      end do
   end function jacobians_at

   !> Warns of elements that are folded at a node, although their Jacobian is positive at all
   !> integration points: their map is not one to one.
   subroutine check_folds(deck)
      type(deck_type), intent(inout) :: deck
      integer :: at(size(deck%mesh%element_number)), e, kind, n

      do e = 1, size(at)
         kind = deck%mesh%element_kind(e)
         if (deck%order == 1) kind = linear_kind(kind)
         n = element_node_count(kind)
         at(e) = folded_node(kind, deck%mesh%coordinates(:, deck%mesh%element_nodes(:n, e)))
      end do
      e = findloc(at > 0, .true., dim=1)
      if (e > 0) call deck%warning(deck%element_place(e), 'element '// &
         to_text(deck%mesh%element_number(e))//' is folded at node '// &
         to_text(deck%mesh%node_number(deck%mesh%element_nodes(at(e), e)))//': its Jacobian is '// &
         'negative near it, where fields are wrong; move the midside nodes towards the middle '// &
         'of their sides and make its corners convex'//others(count(at > 0), '; folded elements: '))
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
      jacobians = jacobians_at(kind, node_position(kind), coordinates)
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

   !> No side of an element is far shorter than others; corners in one place go by the Jacobian.
   subroutine check_slenderness(deck)
      type(deck_type), intent(inout) :: deck
      real(dp) :: corners(2, 4), lengths(4), ratio(size(deck%mesh%element_number))
      integer :: e, n

      ratio = 1.0_dp
      do e = 1, size(ratio)
         if (.not. deck%element_valid(e)) cycle
         ! Of corners alone; sides without a length do not count.
         n = element_corner_count(deck%mesh%element_kind(e))
         corners(:, :n) = deck%mesh%coordinates(:, deck%mesh%element_nodes(:n, e))
         lengths(:n) = norm2(cshift(corners(:, :n), 1, dim=2) - corners(:, :n), dim=1)
         if (any(lengths(:n) > 0.0_dp)) ratio(e) = minval(lengths(:n), mask=lengths(:n) > 0.0_dp)/ &
            maxval(lengths(:n))
         if (ratio(e) < hopeless) call deck%error(deck%element_place(e), said(deck%mesh, e, &
            ratio(e))//', and rounding would spoil the result')
      end do
      associate (is_doubtful => ratio >= hopeless .and. ratio < doubtful)
         e = minloc(ratio, dim=1, mask=is_doubtful)
         if (e > 0) call deck%warning(deck%element_place(e), said(deck%mesh, e, ratio(e))// &
            ', and pressures there are accurate to '//to_text(epsilon(1.0_dp)/ratio(e)**2)// &
            ' only (number of such elements: '//to_text(count(is_doubtful))//')')
      end associate
   end subroutine check_slenderness

   !> The part of a message that names an element and the ratio of its sides.
   pure function said(mesh, e, ratio) result(words)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e
      real(dp), intent(in) :: ratio
      character(:), allocatable :: words

      words = 'nodes of element '//to_text(mesh%element_number(e))// &
         ' nearly coincide: its shortest side is '//to_text(ratio)//' of its longest'
   end function said

end module mesh_checks
