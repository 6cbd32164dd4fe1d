!> Stress or flux at the nodes by superconvergent patch recovery: polynomials fitted to the values
!> at the recovery points of the elements round a corner (Zienkiewicz & Zhu, Int. J. Num. Meth. Eng.
!> 33 (1992) 1331), cubic ones round four quadrilaterals of eight nodes. A fit depends on geometry
!> alone, so each nodal value is a sum of values with weights that are formed once.
!>
!> Plain averages of extrapolated values (field_recovery) will not do for an estimate of errors: in
!> elements of eight nodes they are off at the nodes by the order of the error itself, h^2 times the
!> curvature of the field, which extrapolation by bilinear functions leaves out on all sides alike.
module patch_recovery
   use element_kinds, only: element_corner_count, element_node_count, quad4, triangle3
   use field_recovery, only: point_map_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use patch_fits, only: cubic_terms, fit_type, linear_terms, make_fit, quadratic_terms
   implicit none
   private
   public :: patch_recovery_type

   integer, parameter :: most_layers = 3   !! times that a patch is widened by its neighbours
   integer, parameter :: fewest_for_cubic = 16   !! sites: four elements of eight nodes

   !> Nodal values from values at the recovery points of all elements.
   type :: patch_recovery_type
      integer, allocatable :: first(:)      !! (points + 1) first weight of each point
      integer, allocatable :: sample(:)     !! (weights) recovery point that it belongs to
      real(dp), allocatable :: weight(:)    !! (weights) their sum over a point is 1
   contains
      procedure :: prepare
      procedure :: recover
   end type patch_recovery_type

   !> Weights of one point.
   type :: row_type
      integer :: count = 0
      integer, allocatable :: sample(:)
      real(dp), allocatable :: weight(:)
   end type row_type

   !> What patches are made of.
   type :: layout_type
      integer, allocatable :: first_sample(:)    !! (elements + 1) first recovery point
      real(dp), allocatable :: position(:, :)    !! (2, recovery points) [length]
      integer, allocatable :: start(:)           !! (points + 1) first of the elements round each
      integer, allocatable :: around(:)          !! elements of which the points are corners
   end type layout_type

contains

   !> Fits the patches.
   pure subroutine prepare(self, mesh, points, first_sample, position)
      class(patch_recovery_type), intent(inout) :: self !! the weights
      type(mesh_type), intent(in) :: mesh
      type(point_map_type), intent(in) :: points        !! where averaged fields live
      integer, intent(in) :: first_sample(:)            !! (elements + 1) first recovery point
      real(dp), intent(in) :: position(:, :)            !! (2, recovery points) x, y [length]
      type(row_type) :: rows(size(points%node))
      type(layout_type) :: layout
      type(fit_type) :: fit
      logical :: has_fit(size(points%node))
      integer, allocatable :: centres(:), near(:), patch(:)
      integer :: c, i, p
      real(dp) :: share

      layout%first_sample = first_sample
      layout%position = position
      call find_elements_round_corners(mesh, points, layout)
      do p = 1, size(rows)
         has_fit(p) = .false.
         if (layout%start(p + 1) > layout%start(p)) then
            call fit_round_corner(mesh, points, layout, p, 0, patch, fit)
            has_fit(p) = fit%ample
         end if
      end do
      do p = 1, size(rows)
         if (layout%start(p + 1) == layout%start(p)) cycle
         centres = centres_for(mesh, points, layout, p, has_fit)
         near = midsides_at(mesh, points, layout, p)
         share = 1.0_dp/size(centres)
         do c = 1, size(centres)
            call fit_round_corner(mesh, points, layout, centres(c), most_layers, patch, fit)
            call add_weights(rows(p), mesh, layout, patch, &
               share*fit%weights_at(mesh%coordinates(:, points%node(p))))
            ! A midside node takes the mean of what holds at the ends of its side.
            do i = 1, size(near)
               call add_weights(rows(near(i)), mesh, layout, patch, &
                  share/2*fit%weights_at(mesh%coordinates(:, points%node(near(i)))))
            end do
         end do
      end do
      call join_rows(self, rows)
   end subroutine prepare

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

   pure subroutine join_rows(self, rows)
      class(patch_recovery_type), intent(inout) :: self
      type(row_type), intent(in) :: rows(:)
      integer :: p

      allocate (self%first(size(rows) + 1), source=1)
      do p = 1, size(rows)
         self%first(p + 1) = self%first(p) + rows(p)%count
      end do
      allocate (self%sample(self%first(size(rows) + 1) - 1))
      allocate (self%weight(size(self%sample)))
      do p = 1, size(rows)
         if (rows(p)%count == 0) cycle
         self%sample(self%first(p):self%first(p + 1) - 1) = rows(p)%sample(:rows(p)%count)
         self%weight(self%first(p):self%first(p + 1) - 1) = rows(p)%weight(:rows(p)%count)
      end do
   end subroutine join_rows

   !> The values at all points; zero at those outside all elements.
   pure subroutine recover(self, components, samples, values)
      class(patch_recovery_type), intent(in) :: self    !! the weights
      integer, intent(in) :: components                 !! 2 or 4
      real(dp), intent(in) :: samples(components, *)    !! at the recovery points
      real(dp), intent(out) :: values(components, *)    !! at the points
      integer :: p

      do p = 1, size(self%first) - 1
         associate (first => self%first(p), last => self%first(p + 1) - 1)
            if (components == 4) then
               call sum_four(last - first + 1, self%sample(first:last), self%weight(first:last), &
                  samples, values(:, p))
            else
               call sum_two(last - first + 1, self%sample(first:last), self%weight(first:last), &
                  samples, values(:, p))
            end if
         end associate
      end do
   end subroutine recover

   pure subroutine sum_four(n, sample, weight, samples, total)
      integer, intent(in) :: n, sample(n)
      real(dp), intent(in) :: weight(n), samples(4, *)
      real(dp), intent(out) :: total(4)
      real(dp) :: a(2), b(2)
      integer :: k

      a = 0.0_dp
      b = 0.0_dp
      do k = 1, n
         a = a + weight(k)*samples(1:2, sample(k))
         b = b + weight(k)*samples(3:4, sample(k))
      end do
      total = [a, b]
   end subroutine sum_four

   pure subroutine sum_two(n, sample, weight, samples, total)
      integer, intent(in) :: n, sample(n)
      real(dp), intent(in) :: weight(n), samples(2, *)
      real(dp), intent(out) :: total(2)
      integer :: k

      total = 0.0_dp
      do k = 1, n
         total = total + weight(k)*samples(:, sample(k))
      end do
   end subroutine sum_two

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

   elemental logical function is_linear(kind)
      integer, intent(in) :: kind

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

   pure subroutine add_weight(row, sample, weight)
      type(row_type), intent(inout) :: row
      integer, intent(in) :: sample
      real(dp), intent(in) :: weight
      integer :: k

      if (.not. allocated(row%sample)) allocate (row%sample(24), row%weight(24))
      k = findloc(row%sample(:row%count), sample, dim=1)
      if (k > 0) then
         row%weight(k) = row%weight(k) + weight
         return
      end if
      if (row%count == size(row%sample)) then
         row%sample = [row%sample, row%sample]
         row%weight = [row%weight, row%weight]
      end if
      row%count = row%count + 1
      row%sample(row%count) = sample
      row%weight(row%count) = weight
   end subroutine add_weight

end module patch_recovery
