!> Patches of elements round the corners of a mesh, within one section, and polynomials fitted to
!> the values at their recovery points.
module element_patches
   use element_kinds, only: element_corner_count, element_node_count, quad4, triangle3
   use field_recovery, only: point_map_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use patch_fits, only: cubic_terms, fit_type, linear_terms, make_fit, quadratic_terms
   use sample_sums, only: add_weight, row_type
   implicit none
   private
   public :: layout_type, find_elements_round_corners, centres_for, midsides_at, fit_round_corner
   public :: is_surrounded, is_linear, sites_of, corners_of, add_weights

   integer, parameter :: fewest_for_cubic = 16   !! sites: four elements of eight nodes

   !> What patches are made of.
   type :: layout_type
      integer, allocatable :: first_sample(:)    !! (elements + 1) first recovery point
      real(dp), allocatable :: position(:, :)    !! (2, recovery points) [length]
      integer, allocatable :: start(:)           !! (points + 1) first of the elements round each
      integer, allocatable :: around(:)          !! elements of which the points are corners
   end type layout_type

contains

   !> Finds the elements of which each point is a corner.
   pure subroutine find_elements_round_corners(mesh, points, layout)
      type(mesh_type), intent(in) :: mesh
      type(point_map_type), intent(in) :: points
      type(layout_type), intent(inout) :: layout
      integer :: next(size(points%node)), e, p, q

      allocate (layout%start(size(points%node) + 1), source=0)
      do e = 1, size(mesh%element_kind)
         do q = 1, element_corner_count(mesh%element_kind(e))
            p = points%element_points(q, e)
            layout%start(p + 1) = layout%start(p + 1) + 1
         end do
      end do
      layout%start(1) = 1
      do p = 1, size(points%node)
         layout%start(p + 1) = layout%start(p + 1) + layout%start(p)
      end do
      next = layout%start(:size(next))
      allocate (layout%around(layout%start(size(layout%start)) - 1))
      do e = 1, size(mesh%element_kind)
         do q = 1, element_corner_count(mesh%element_kind(e))
            p = points%element_points(q, e)
            layout%around(next(p)) = e
            next(p) = next(p) + 1
         end do
      end do
   end subroutine find_elements_round_corners

   !> Corners whose fits hold at a corner: its own, or, where its elements are too few for one, as
   !> at the outline of a body, those of its neighbours inside; without any its own, widened.
   pure function centres_for(mesh, points, layout, corner, has_fit) result(centres)
      type(mesh_type), intent(in) :: mesh
      type(point_map_type), intent(in) :: points
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: corner
      logical, intent(in) :: has_fit(:)
      integer, allocatable :: centres(:)
      integer :: corners, k, other, q, reach

      centres = [corner]
      if (has_fit(corner)) return
      deallocate (centres)
      allocate (centres(0))
      ! First along sides, then across elements.
      do reach = 1, 2
         do k = layout%start(corner), layout%start(corner + 1) - 1
            associate (mine => points%element_points(:, layout%around(k)))
               corners = element_corner_count(mesh%element_kind(layout%around(k)))
               do q = 1, corners
                  other = mine(q)
                  if (.not. has_fit(other) .or. any(centres == other)) cycle
                  if (reach == 1 .and. mine(modulo(q, corners) + 1) /= corner .and. &
                     mine(modulo(q - 2, corners) + 1) /= corner) cycle
                  centres = [centres, other]
               end do
            end associate
         end do
         if (size(centres) > 0) return
      end do
      centres = [corner]
   end function centres_for

   !> Whether the elements round a corner close a ring, so that it is not on the outline.
   pure logical function is_surrounded(mesh, points, layout, corner)
      type(mesh_type), intent(in) :: mesh
      type(point_map_type), intent(in) :: points
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: corner                 !! a point
      integer :: corners, k, q
      integer, allocatable :: before(:), after(:)

      allocate (before(0), after(0))
      do k = layout%start(corner), layout%start(corner + 1) - 1
         associate (e => layout%around(k))
            corners = element_corner_count(mesh%element_kind(e))
            q = findloc(points%element_points(:corners, e), corner, dim=1)
            before = [before, points%element_points(modulo(q - 2, corners) + 1, e)]
            after = [after, points%element_points(modulo(q, corners) + 1, e)]
         end associate
      end do
      is_surrounded = size(before) > 0
      do k = 1, size(before)
         is_surrounded = is_surrounded .and. any(after == before(k))
      end do
   end function is_surrounded

   !> Midside points of the sides that end at a corner, each once.
   pure function midsides_at(mesh, points, layout, corner) result(near)
      type(mesh_type), intent(in) :: mesh
      type(point_map_type), intent(in) :: points
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: corner
      integer, allocatable :: near(:)
      integer :: corners, i, k, q, sides(2)

      allocate (near(0))
      do k = layout%start(corner), layout%start(corner + 1) - 1
         associate (e => layout%around(k))
            corners = element_corner_count(mesh%element_kind(e))
            if (element_node_count(mesh%element_kind(e)) == corners) cycle
            q = findloc(points%element_points(:corners, e), corner, dim=1)
            sides = corners + [q, modulo(q - 2, corners) + 1]
            do i = 1, 2
               associate (midside => points%element_points(sides(i), e))
                  ! Where it hangs on a larger element it is a corner, with a fit of its own.
                  if (layout%start(midside + 1) > layout%start(midside)) cycle
               end associate
               if (any(near == points%element_points(sides(i), e))) cycle
               near = [near, points%element_points(sides(i), e)]
            end do
         end associate
      end do
   end function midsides_at

   !> Fits the elements round a corner, with their neighbours where they are too few.
   pure subroutine fit_round_corner(mesh, points, layout, corner, layers, patch, fit)
      type(mesh_type), intent(in) :: mesh
      type(point_map_type), intent(in) :: points
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: corner
      integer, intent(in) :: layers                 !! times that the patch may be widened
      integer, allocatable, intent(out) :: patch(:)
      type(fit_type), intent(out) :: fit
      real(dp), allocatable :: sites(:, :)
      type(fit_type) :: cubic
      integer :: before, fewest, layer, terms

      patch = layout%around(layout%start(corner):layout%start(corner + 1) - 1)
      terms = quadratic_terms
      fewest = 2*terms
      if (any(is_linear(mesh%element_kind(patch)))) then
         terms = linear_terms
         fewest = terms + 1
      end if
      before = 0
      do layer = 0, layers
         if (layer > 0) call widen(mesh, points, layout, patch)
         if (size(patch) == before) exit
         before = size(patch)
         sites = sites_of(mesh, layout, patch)
         fit = make_fit(sites, corners_of(mesh, patch), terms)
         if (fit%complete .and. size(sites, 2) >= fewest) exit
      end do
      if (terms == quadratic_terms .and. size(sites, 2) >= fewest_for_cubic .and. &
         all(element_corner_count(mesh%element_kind(patch)) == 4)) then
         cubic = make_fit(sites, corners_of(mesh, patch), cubic_terms)
         if (cubic%complete) fit = cubic
      end if
      fit%ample = fit%complete .and. size(sites, 2) >= fewest
   end subroutine fit_round_corner

   !> Whether elements of a kind have corner nodes only.
   elemental logical function is_linear(kind)
      integer, intent(in) :: kind   !! kind of the element

      is_linear = kind == quad4 .or. kind == triangle3
   end function is_linear

   !> Adds the elements beyond the sides of a patch.
   pure subroutine widen(mesh, points, layout, patch)
      type(mesh_type), intent(in) :: mesh
      type(point_map_type), intent(in) :: points
      type(layout_type), intent(in) :: layout
      integer, allocatable, intent(inout) :: patch(:)
      integer :: corners, i, k, q, side(2), within

      within = size(patch)
      do i = 1, within
         corners = element_corner_count(mesh%element_kind(patch(i)))
         do q = 1, corners
            side = points%element_points([q, modulo(q, corners) + 1], patch(i))
            do k = layout%start(side(1)), layout%start(side(1) + 1) - 1
               associate (other => layout%around(k))
                  if (any(patch == other)) cycle
                  if (all(points%element_points(:, other) /= side(2))) cycle
                  patch = [patch, other]
               end associate
            end do
         end do
      end do
   end subroutine widen

   !> Where the values of a patch are fitted: at all recovery points, but in elements of four nodes
   !> at their mean, as the centre is where these are best.
   pure function sites_of(mesh, layout, patch) result(sites)
      type(mesh_type), intent(in) :: mesh
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: patch(:)
      real(dp), allocatable :: sites(:, :)
      integer :: i, n

      allocate (sites(2, sum(layout%first_sample(patch + 1) - layout%first_sample(patch))))
      n = 0
      do i = 1, size(patch)
         associate (mine => layout%position(:, layout%first_sample(patch(i)): &
            layout%first_sample(patch(i) + 1) - 1))
            if (mesh%element_kind(patch(i)) == quad4) then
               sites(:, n + 1) = sum(mine, dim=2)/size(mine, 2)
               n = n + 1
            else
               sites(:, n + 1:n + size(mine, 2)) = mine
               n = n + size(mine, 2)
            end if
         end associate
      end do
      sites = sites(:, :n)
   end function sites_of

   pure function corners_of(mesh, patch) result(corners)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: patch(:)
      real(dp), allocatable :: corners(:, :)
      integer :: c, i, n

      allocate (corners(2, sum(element_corner_count(mesh%element_kind(patch)))))
      n = 0
      do i = 1, size(patch)
         c = element_corner_count(mesh%element_kind(patch(i)))
         corners(:, n + 1:n + c) = mesh%coordinates(:, mesh%element_nodes(:c, patch(i)))
         n = n + c
      end do
   end function corners_of

   !> Adds weights of the sites of a patch to those of a point.
   pure subroutine add_weights(row, mesh, layout, patch, weights)
      type(row_type), intent(inout) :: row
      type(mesh_type), intent(in) :: mesh
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: patch(:)
      real(dp), intent(in) :: weights(:)
      integer :: i, n, s, samples

      n = 0
      do i = 1, size(patch)
         samples = layout%first_sample(patch(i) + 1) - layout%first_sample(patch(i))
         do s = 0, samples - 1
            if (mesh%element_kind(patch(i)) == quad4) then
               call add_weight(row, layout%first_sample(patch(i)) + s, weights(n + 1)/samples)
            else
               call add_weight(row, layout%first_sample(patch(i)) + s, weights(n + 1 + s))
            end if
         end do
         n = n + merge(1, samples, mesh%element_kind(patch(i)) == quad4)
      end do
   end subroutine add_weights

end module element_patches
