!> Faces that touch though nothing relates them: of two bodies without a pair or a tie, of one body
!> along a seam, and of elements that do not share whole sides; bodies that are drawn on each other,
!> where nothing keeps one from passing through the other.
module touch_checks
   use contact_definitions, only: contact_definition_type
   use deck_context, only: deck_type
   use element_kinds, only: element_corner_count
   use element_sides, only: element_sides_type, find_sides
   use equations, only: coupled_nodes, equation_nodes
   use kinds, only: dp
   use mesh, only: mesh_type
   use mesh_bodies, only: body_name
   use model, only: model_type
   use sorting, only: invert_lists, number_index_type, sort_order
   use text, only: counted, others, to_text
   implicit none
   private
   public :: check_touches

   !> Part of the shorter side by which it may be apart from the other: decks have few digits.
   real(dp), parameter :: close_by = 1.0e-3_dp

   !> Part of the shorter side along which two sides must touch: at corners they meet in a point.
   real(dp), parameter :: overlapping = 0.05_dp

   real(dp), parameter :: margin = 0.1_dp   !! part of a side by which it may bulge past its nodes
   integer, parameter :: nodes_per_stripe = 8
   integer, parameter :: most_steps = 8     !! to the nearest position on a curved side

   !> A node on a free side that is not one of the side's nodes.
   type :: touch_type
      integer :: node = 0      !! node index
      integer :: side = 0      !! the side, index into the sides
      integer :: other = 0     !! side of the node that lies on it
      integer :: partner = 0   !! node of the side at the same place, or 0
   end type touch_type

   integer, parameter :: most_looked_at = 50      !! elements of a body
   real(dp), parameter :: drawn_in = 0.9_dp       !! part of the way from the middle to a corner

contains

   !> Warns of faces that touch unrelated, once for two bodies, seams of a body and hanging nodes.
   subroutine check_touches(deck)
      type(deck_type), intent(inout) :: deck
      type(element_sides_type) :: sides
      type(touch_type), allocatable :: touches(:)
      !> (2, touches) touches share a message: hanging nodes, 0, or faces of the same two bodies
      integer, allocatable :: key(:, :), order(:)
      logical, allocatable :: shared(:, :)                ! (2, sides)
      integer :: bodies(2), first, i, k, last

      sides = find_sides(deck%mesh)
      call check_overlaps(deck, sides)
      call find_touches(deck%mesh, sides, touches)
      if (size(touches) == 0) return
      call drop_related(deck%model, sides, touches)
      ! Nodes hang on a side if both its corners are nodes of the sides that lie on it.
      allocate (shared(2, sides%count), source=.false.)
      do i = 1, size(touches)
         associate (touch => touches(i))
            do k = 1, 2
               shared(k, touch%side) = shared(k, touch%side) .or. &
                  any(sides%ends(:, touch%other) == sides%ends(2*k - 1, touch%side))
            end do
         end associate
      end do
      allocate (key(2, size(touches)), source=0)
      do i = 1, size(touches)
         if (all(shared(:, touches(i)%side))) cycle
         bodies = deck%mesh%element_body(sides%elements(1, [touches(i)%side, touches(i)%other]))
         key(:, i) = [minval(bodies), maxval(bodies)]
      end do
      order = sort_order(touches%node)
      do k = 1, 2
         order = order(sort_order(key(k, order)))
      end do
      first = 1
      do while (first <= size(order))
         last = first
         do while (last < size(order))
            if (any(key(:, order(last + 1)) /= key(:, order(first)))) exit
            last = last + 1
         end do
         call warn(deck, sides, touches(order(first:last)), key(:, order(first)))
         first = last + 1
      end do
   end subroutine check_touches

   !> Finds the nodes that lie on free sides of others, which lie on free sides of the nodes.
   subroutine find_touches(mesh, sides, touches)
      type(mesh_type), intent(in) :: mesh                     ! sound, not refined
      type(element_sides_type), intent(in) :: sides
      type(touch_type), allocatable, intent(out) :: touches(:)
      type(touch_type), allocatable :: found(:), more(:)
      integer, allocatable :: free(:), nodes(:), others(:)
      !> Nodes in stripes across the longer extent of the mesh, and free sides of each node
      integer, allocatable :: in_stripe(:), of_node(:), stripe_start(:), start(:)
      logical :: is_free(0:size(mesh%node_number))
      real(dp) :: box(4), extent(2), lowest(2)
      integer :: along, count_found, i, j, k, n, partner, s, stripes

      free = pack([(s, s=1, sides%count)], sides%elements(2, :sides%count) == 0)
      is_free = .false.
      is_free([sides%ends(:, free)]) = .true.
      nodes = pack([(n, n=1, size(is_free) - 1)], is_free(1:))
      allocate (found(0), touches(0))
      if (size(nodes) == 0) return
      count_found = 0
      lowest = minval(mesh%coordinates(:, nodes), dim=2)
      extent = maxval(mesh%coordinates(:, nodes), dim=2) - lowest
      along = maxloc(extent, dim=1)
      stripes = size(nodes)/nodes_per_stripe + 1
      call invert_lists(reshape(stripe(mesh%coordinates(along, nodes)), [1, size(nodes)]), &
         [(1, n=1, size(nodes))], stripes, stripe_start, in_stripe)
      call invert_lists(sides%ends([1, 3, 2], free), 2 + merge(1, 0, sides%ends(2, free) > 0), &
         size(is_free) - 1, start, of_node)
      do i = 1, size(free)
         associate (ends => sides%ends(:, free(i)))
            box = [minval(mesh%coordinates(:, pack(ends, ends > 0)), dim=2), &
               maxval(mesh%coordinates(:, pack(ends, ends > 0)), dim=2)] + &
               margin*length_of(mesh, ends)*[-1, -1, 1, 1]
            do j = stripe_start(stripe(box(along))), stripe_start(stripe(box(along + 2)) + 1) - 1
               n = nodes(in_stripe(j))
               associate (x => mesh%coordinates(:, n))
                  if (x(1) < box(1) .or. x(1) > box(3)) cycle
                  if (x(2) < box(2) .or. x(2) > box(4)) cycle
                  if (any(ends == n)) cycle
                  if (place_on(mesh, ends, x, close_by*length_of(mesh, ends)) < 0.0_dp) cycle
                  others = free(of_node(start(n):start(n + 1) - 1))
                  others = pack(others, [(lie_on_each_other(mesh, sides, free(i), others(k)), &
                     k=1, size(others))])
                  partner = 0
                  do k = 3, 1, -1
                     if (ends(k) == 0) cycle
                     if (norm2(mesh%coordinates(:, ends(k)) - x) <= close_by*length_of(mesh, &
                        ends)) partner = ends(k)
                  end do
                  more = [(touch_type(n, free(i), others(k), partner), k=1, size(others))]
               end associate
               if (count_found + size(more) > size(found)) found = [found, found, more]
               found(count_found + 1:count_found + size(more)) = more
               count_found = count_found + size(more)
            end do
         end associate
      end do
      touches = found(:count_found)
   contains
      elemental integer function stripe(x)
         real(dp), intent(in) :: x

         stripe = 1 + int(min(max((x - lowest(along))/extent(along), 0.0_dp), 1.0_dp)*(stripes - 1))
      end function stripe
   end subroutine find_touches

   !> Drops the touches of faces that a *CONTACT PAIR, *TIE, *EQUATION or *COUPLING relates, and of
   !> the cuts of pre-tension sections, which are within a body.
   subroutine drop_related(model, sides, touches)
      type(model_type), intent(in) :: model
      type(element_sides_type), intent(in) :: sides
      type(touch_type), allocatable, intent(inout) :: touches(:)
      type(number_index_type) :: of_surface(size(model%mesh%surfaces))   ! sides of each
      type(contact_definition_type), allocatable :: pairs(:)
      logical :: constrained(size(model%mesh%node_number)), related(size(touches))
      logical :: is_cut(0:sides%count)
      integer :: i, k

      pairs = [model%contacts, model%ties%faces]
      do k = 1, size(of_surface)
         if (all(pairs%slave /= k) .and. all(pairs%master /= k)) cycle
         associate (faces => model%mesh%surfaces(k)%faces)
            call of_surface(k)%build([(sides%of_element(faces(2, i), faces(1, i)), i=1, &
               size(faces, 2))])
         end associate
      end do
      is_cut = .false.
      constrained = equation_nodes(model%equations, size(constrained))
      do i = 1, size(model%couplings)
         constrained(coupled_nodes(model%mesh, model%couplings(i))) = .true.
         if (.not. model%couplings(i)%is_section()) cycle
         associate (faces => [model%mesh%surfaces(model%couplings(i)%surface)%faces, &
            model%mesh%surfaces(model%couplings(i)%opposite)%faces])
            is_cut([(sides%of_element(faces(2*k), faces(2*k - 1)), k=1, size(faces)/2)]) = .true.
         end associate
      end do
      do i = 1, size(touches)
         related(i) = is_paired(touches(i)%side, touches(i)%other) .or. &
            is_cut(touches(i)%side) .or. is_cut(touches(i)%other) .or. &
            (constrained(touches(i)%node) .and. &
            any(constrained(pack(sides%ends(:, touches(i)%side), &
            sides%ends(:, touches(i)%side) > 0))))
      end do
      touches = pack(touches, .not. related)
   contains
      logical function is_paired(one, other)
         integer, intent(in) :: one, other
         integer :: p

         is_paired = .true.
         do p = 1, size(pairs)
            associate (slave => of_surface(pairs(p)%slave), master => of_surface(pairs(p)%master))
               if (slave%find(one) > 0 .and. master%find(other) > 0) return
               if (slave%find(other) > 0 .and. master%find(one) > 0) return
            end associate
         end do
         is_paired = .false.
      end function is_paired
   end subroutine drop_related

   subroutine warn(deck, sides, touches, key)
      type(deck_type), intent(inout) :: deck
      type(element_sides_type), intent(in) :: sides
      type(touch_type), intent(in) :: touches(:)          ! by their nodes
      integer, intent(in) :: key(2)
      character(:), allocatable :: message, node, place
      integer :: before, i, places

      ! Two nodes at one place are both found.
      places = 0
      before = 0
      do i = 1, size(touches)
         if (touches(i)%node == before) cycle
         before = touches(i)%node
         if (touches(i)%partner == 0 .or. touches(i)%partner > touches(i)%node) places = places + 1
      end do
      node = to_text(deck%mesh%node_number(touches(1)%node))
      associate (x => deck%mesh%coordinates(:, touches(1)%node))
         place = to_text(x(1))//', '//to_text(x(2))
         if (key(1) == 0) then
            message = 'node '//node//' at '//place//' hangs: it lies on '//side_words(deck%mesh, &
               sides, touches(1)%side)//' and is no node of it, so that the fields on both '// &
               'sides differ; let elements meet along whole sides, or give the two parts nodes '// &
               'of their own and join them by *TIE'//others(places, '; hanging nodes: ')
         else
            if (touches(1)%partner > 0) then
               place = 'node '//node//' and node '//to_text(deck%mesh%node_number(touches( &
                  1)%partner))//' at '//place
            else
               place = 'node '//node//' at '//place//' on '//side_words(deck%mesh, sides, &
                  touches(1)%side)
            end if
            message = body_name(deck%model, key(1))//' is cut along a seam: its faces touch at '
            if (key(1) /= key(2)) message = body_name(deck%model, key(1))//' and '// &
               body_name(deck%model, key(2))//' touch at '
            message = message//counted(places, 'place')//', first '//place//', but no '// &
               '*CONTACT PAIR, *TIE, *EQUATION or *COUPLING relates them, so that they pass '// &
               'through each other and exchange no heat; pair or tie these faces, or let them '// &
               'share their nodes'
         end if
      end associate
      call deck%warning(deck%node_place(touches(1)%node), message)
   end subroutine warn

   !> A side as messages name it, such as 'side 3 of element 1'.
   pure function side_words(mesh, sides, side) result(words)
      type(mesh_type), intent(in) :: mesh
      type(element_sides_type), intent(in) :: sides
      integer, intent(in) :: side
      character(:), allocatable :: words

      words = 'side '//to_text(findloc(sides%of_element(:, sides%elements(1, side)), side, &
         dim=1))//' of element '//to_text(mesh%element_number(sides%elements(1, side)))
   end function side_words

   pure real(dp) function length_of(mesh, ends) result(length)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: ends(3)

      length = norm2(mesh%coordinates(:, ends(3)) - mesh%coordinates(:, ends(1)))
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
         if (dot_product(mesh%coordinates(:, mine(3)) - mesh%coordinates(:, mine(1)), &
            mesh%coordinates(:, its(3)) - mesh%coordinates(:, its(1))) >= 0.0_dp) return
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

      ! The side is centre + xi along/2 - xi^2 bulge, xi from -1 to 1; straight ones need one step.
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

   !> Warns of every body that lies wholly inside another.
   subroutine check_overlaps(deck, sides)
      type(deck_type), intent(inout) :: deck
      type(element_sides_type), intent(in) :: sides   !! those of all elements
      real(dp) :: box(4, deck%mesh%body_count)        ! lowest x and y, highest x and y
      logical :: is_told(deck%mesh%body_count)
      integer :: inner, n, outer

      box(:2, :) = huge(1.0_dp)
      box(3:, :) = -huge(1.0_dp)
      do n = 1, size(deck%mesh%node_body)
         if (deck%mesh%node_body(n) == 0) cycle
         associate (x => deck%mesh%coordinates(:, n), own => box(:, deck%mesh%node_body(n)))
            own = [min(own(:2), x), max(own(3:), x)]
         end associate
      end do
      is_told = .false.
      do inner = 1, size(box, 2)
         do outer = 1, size(box, 2)
            if (outer == inner .or. is_told(outer)) cycle
            associate (low => box(:2, :), high => box(3:, :))
               if (any(low(:, inner) < low(:, outer) .or. high(:, inner) > high(:, outer))) cycle
            end associate
            if (.not. lies_inside(deck%mesh, sides, inner, outer)) cycle
            is_told(inner) = .true.
            call deck%warning(deck%node_place(findloc(deck%mesh%node_body, inner, dim=1)), &
               body_name(deck%model, inner)//' lies wholly inside '//body_name(deck%model, &
               outer)//': both fill the same place; check the positions of the bodies')
            exit
         end do
      end do
   end subroutine check_overlaps

   !> Whether elements of one body, evenly chosen, are within another with all their corners: these
   !> are drawn in a little, as outlines may coincide.
   pure logical function lies_inside(mesh, sides, inner, outer)
      type(mesh_type), intent(in) :: mesh
      type(element_sides_type), intent(in) :: sides
      integer, intent(in) :: inner, outer    ! bodies
      integer, allocatable :: corners(:), elements(:), outline(:)
      real(dp) :: middle(2)
      integer :: i, k

      elements = pack([(i, i=1, size(mesh%element_body))], mesh%element_body == inner)
      outline = pack([(i, i=1, sides%count)], sides%elements(2, :sides%count) == 0 .and. &
         mesh%element_body(sides%elements(1, :sides%count)) == outer)
      lies_inside = .false.
      do i = 1, size(elements), size(elements)/most_looked_at + 1
         corners = mesh%element_nodes(:element_corner_count(mesh%element_kind(elements(i))), &
            elements(i))
         middle = sum(mesh%coordinates(:, corners), dim=2)/size(corners)
         do k = 1, size(corners)
            if (.not. is_within(mesh, sides%ends(:, outline), middle + drawn_in* &
               (mesh%coordinates(:, corners(k)) - middle))) return
         end do
      end do
      lies_inside = .true.
   end function lies_inside

   !> Whether a ray from a point along x crosses an outline an odd number of times.
   pure logical function is_within(mesh, outline, x)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: outline(:, :)   ! (3, sides)
      real(dp), intent(in) :: x(2)
      integer :: k

      is_within = .false.
      do k = 1, size(outline, 2)
         if (outline(2, k) == 0) then
            if (crosses(outline(1, k), outline(3, k))) is_within = .not. is_within
         else
            if (crosses(outline(1, k), outline(2, k))) is_within = .not. is_within
            if (crosses(outline(2, k), outline(3, k))) is_within = .not. is_within
         end if
      end do
   contains
      pure logical function crosses(first, second)
         integer, intent(in) :: first, second   ! nodes of a straight line

         associate (a => mesh%coordinates(:, first) - x, b => mesh%coordinates(:, second) - x)
            crosses = .false.
            if ((a(2) > 0.0_dp) .eqv. (b(2) > 0.0_dp)) return
            crosses = (a(1)*b(2) - a(2)*b(1) > 0.0_dp) .eqv. (b(2) > a(2))
         end associate
      end function crosses
   end function is_within

end module touch_checks
