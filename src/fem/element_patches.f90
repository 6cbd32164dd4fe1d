!> Patches of elements round the corners of a mesh, within one section, and polynomials in x and y
!> fitted by least squares to the values at their recovery points. A fit knows the sites alone: its
!> value at a position is a sum of the values with weights.
module element_patches
   use element_kinds, only: element_corner_count, element_node_count
   use field_recovery, only: point_map_type
   use kinds, only: dp
   use mesh, only: mesh_type
   implicit none
   private
   public :: layout_type, centres_for, midsides_at, fit_round_corner, is_surrounded, is_linear, &
      sites_of, corners_of, add_weights, fit_type, make_fit, quadratic_terms, sample_sums_type, &
      row_type, add_weight

   !> The weights of all points, joined.
   type :: sample_sums_type
      integer, allocatable :: first(:)      !! (points + 1) first weight of each point
      integer, allocatable :: sample(:)     !! (weights) recovery point that it belongs to
      real(dp), allocatable :: weight(:)    !! (weights)
   contains
      procedure :: join
      procedure :: add
   end type sample_sums_type

   !> Weights of one point.
   type :: row_type
      private
      integer :: count = 0
      integer, allocatable :: sample(:)
      real(dp), allocatable :: weight(:)
   end type row_type

   integer, parameter :: fewest_for_cubic = 16   !! sites: four elements of eight nodes

   !> Elements round each corner, and their recovery points.
   type :: layout_type
      type(mesh_type), pointer :: mesh => null()
      type(point_map_type), pointer :: points => null()   !! where averaged fields live
      integer, allocatable :: first_sample(:)    !! (elements + 1) first recovery point
      real(dp), allocatable :: position(:, :)    !! (2, recovery points) [length]
      integer, allocatable :: start(:)           !! (points + 1) first of the elements round each
      integer, allocatable :: around(:)          !! elements of which the points are corners
      !> (elements) whether the mean of an element's values is fitted at their centre
      logical, allocatable :: is_centred(:)
   end type layout_type

   integer, parameter :: linear_terms = 3      !! 1, x, y
   integer, parameter :: quadratic_terms = 6   !! and xy, x^2, y^2
   integer, parameter :: cubic_terms = 10      !! and x^2 y, x y^2, x^3, y^3

   !> Root mean square over the sites of what is new in a term, below which the sites do not tell
   !> it from the terms before: a single row of elements has no slope, or no curvature, across.
   real(dp), parameter :: undetermined = 0.1_dp
   !> Least variance of corners on a line across it, over that along it and that of the sites.
   real(dp), parameter :: on_a_line = 1.0e-4_dp

   !> Orthogonal polynomials over sites.
   type :: fit_type
      private
      logical, public :: complete = .false.   !! whether the sites determine all terms
      logical, public :: ample = .false.      !! whether there are more sites than that takes
      real(dp) :: origin(2) = 0.0_dp          !! [length]
      real(dp) :: scaling(2, 2) = 0.0_dp      !! to coordinates of about unit size [1/length]
      integer :: terms = 0                    !! linear_terms, quadratic_terms or cubic_terms
      logical :: kept(cubic_terms) = .false.
      real(dp) :: r(cubic_terms, cubic_terms) = 0.0_dp !! terms = orthogonal ones times r
      real(dp), allocatable :: q(:, :)        !! (sites, terms) the orthogonal ones at the sites
   contains
      procedure :: weights_at
   end type fit_type

contains

   !> Corners whose fits hold at a corner: its own, or, where its elements are too few for one, as
   !> at the outline of a body, those of its neighbours inside; without any its own, widened.
   pure function centres_for(layout, corner, has_fit) result(centres)
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
            associate (mine => layout%points%element_points(:, layout%around(k)))
               corners = element_corner_count(layout%mesh%element_kind(layout%around(k)))
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
   pure logical function is_surrounded(layout, corner)
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: corner                 !! a point
      integer :: corners, k, q
      integer, allocatable :: before(:), after(:)

      allocate (before(0), after(0))
      do k = layout%start(corner), layout%start(corner + 1) - 1
         associate (e => layout%around(k))
            corners = element_corner_count(layout%mesh%element_kind(e))
            q = findloc(layout%points%element_points(:corners, e), corner, dim=1)
            before = [before, layout%points%element_points(modulo(q - 2, corners) + 1, e)]
            after = [after, layout%points%element_points(modulo(q, corners) + 1, e)]
         end associate
      end do
      is_surrounded = size(before) > 0
      do k = 1, size(before)
         is_surrounded = is_surrounded .and. any(after == before(k))
      end do
   end function is_surrounded

   !> Midside points of the sides that end at a corner, each once.
   pure function midsides_at(layout, corner) result(near)
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: corner
      integer, allocatable :: near(:)
      integer :: corners, i, k, q, sides(2)

      allocate (near(0))
      do k = layout%start(corner), layout%start(corner + 1) - 1
         associate (e => layout%around(k))
            corners = element_corner_count(layout%mesh%element_kind(e))
            if (element_node_count(layout%mesh%element_kind(e)) == corners) cycle
            q = findloc(layout%points%element_points(:corners, e), corner, dim=1)
            sides = corners + [q, modulo(q - 2, corners) + 1]
            do i = 1, 2
               associate (midside => layout%points%element_points(sides(i), e))
                  ! Where it hangs on a larger element it is a corner, with a fit of its own.
                  if (layout%start(midside + 1) > layout%start(midside)) cycle
               end associate
               if (any(near == layout%points%element_points(sides(i), e))) cycle
               near = [near, layout%points%element_points(sides(i), e)]
            end do
         end associate
      end do
   end function midsides_at

   !> Fits the elements round a corner, with their neighbours where they are too few.
   pure subroutine fit_round_corner(layout, corner, layers, patch, fit)
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
      if (any(is_linear(layout%mesh%element_kind(patch)))) then
         terms = linear_terms
         fewest = terms + 1
      end if
      before = 0
      do layer = 0, layers
         if (layer > 0) call widen(layout, patch)
         if (size(patch) == before) exit
         before = size(patch)
         sites = sites_of(layout, patch)
         fit = make_fit(sites, corners_of(layout, patch), terms)
         if (fit%complete .and. size(sites, 2) >= fewest) exit
      end do
      if (terms == quadratic_terms .and. size(sites, 2) >= fewest_for_cubic .and. &
         all(element_corner_count(layout%mesh%element_kind(patch)) == 4)) then
         cubic = make_fit(sites, corners_of(layout, patch), cubic_terms)
         if (cubic%complete) fit = cubic
      end if
      fit%ample = fit%complete .and. size(sites, 2) >= fewest
   end subroutine fit_round_corner

   !> Whether elements of a kind have corner nodes only.
   elemental logical function is_linear(kind)
      integer, intent(in) :: kind   !! kind of the element

      is_linear = element_node_count(kind) == element_corner_count(kind)
   end function is_linear

   !> Adds the elements beyond the sides of a patch.
   pure subroutine widen(layout, patch)
      type(layout_type), intent(in) :: layout
      integer, allocatable, intent(inout) :: patch(:)
      integer :: corners, i, k, q, side(2), within

      within = size(patch)
      do i = 1, within
         corners = element_corner_count(layout%mesh%element_kind(patch(i)))
         do q = 1, corners
            side = layout%points%element_points([q, modulo(q, corners) + 1], patch(i))
            do k = layout%start(side(1)), layout%start(side(1) + 1) - 1
               associate (other => layout%around(k))
                  if (any(patch == other)) cycle
                  if (all(layout%points%element_points(:, other) /= side(2))) cycle
                  patch = [patch, other]
               end associate
            end do
         end do
      end do
   end subroutine widen

   !> Where the values of a patch are fitted: at all recovery points, or at their centre.
   pure function sites_of(layout, patch) result(sites)
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: patch(:)
      real(dp), allocatable :: sites(:, :)
      integer :: i, n

      allocate (sites(2, sum(layout%first_sample(patch + 1) - layout%first_sample(patch))))
      n = 0
      do i = 1, size(patch)
         associate (mine => layout%position(:, layout%first_sample(patch(i)): &
            layout%first_sample(patch(i) + 1) - 1))
            if (layout%is_centred(patch(i))) then
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

   pure function corners_of(layout, patch) result(corners)
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: patch(:)
      real(dp), allocatable :: corners(:, :)
      integer :: c, i, n

      allocate (corners(2, sum(element_corner_count(layout%mesh%element_kind(patch)))))
      n = 0
      do i = 1, size(patch)
         c = element_corner_count(layout%mesh%element_kind(patch(i)))
         corners(:, n + 1:n + c) = &
            layout%mesh%coordinates(:, layout%mesh%element_nodes(:c, patch(i)))
         n = n + c
      end do
   end function corners_of

   !> Adds weights of the sites of a patch to those of a point.
   pure subroutine add_weights(row, layout, patch, weights)
      type(row_type), intent(inout) :: row
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: patch(:)
      real(dp), intent(in) :: weights(:)
      integer :: i, n, s, samples

      n = 0
      do i = 1, size(patch)
         samples = layout%first_sample(patch(i) + 1) - layout%first_sample(patch(i))
         do s = 0, samples - 1
            if (layout%is_centred(patch(i))) then
               call add_weight(row, layout%first_sample(patch(i)) + s, weights(n + 1)/samples)
            else
               call add_weight(row, layout%first_sample(patch(i)) + s, weights(n + 1 + s))
            end if
         end do
         n = n + merge(1, samples, layout%is_centred(patch(i)))
      end do
   end subroutine add_weights

   !> Fits polynomials to sites; terms that these do not determine are left out.
   pure function make_fit(sites, corners, terms) result(fit)
      real(dp), intent(in) :: sites(:, :)     !! (2, sites) [length]
      !> (2, corners) of the elements that they lie in: the size of the patch [length]
      real(dp), intent(in) :: corners(:, :)
      integer, intent(in) :: terms            !! linear_terms, quadratic_terms or cubic_terms
      type(fit_type) :: fit
      real(dp) :: column(size(sites, 2)), places(2, size(sites, 2))
      integer :: i, j

      fit%terms = terms
      fit%origin = sum(corners, dim=2)/size(corners, 2)
      fit%scaling = scaling_of(corners, sites, fit%origin)
      do i = 1, size(sites, 2)
         places(:, i) = matmul(fit%scaling, sites(:, i) - fit%origin)
      end do
      allocate (fit%q(size(sites, 2), terms), source=0.0_dp)
      do j = 1, terms
         do i = 1, size(sites, 2)
            column(i) = term(j, places(:, i))
         end do
         do i = 1, j - 1
            if (.not. fit%kept(i)) cycle
            fit%r(i, j) = dot_product(fit%q(:, i), column)
            column = column - fit%r(i, j)*fit%q(:, i)
         end do
         fit%r(j, j) = norm2(column)
         fit%kept(j) = fit%r(j, j) > undetermined*sqrt(real(size(column), dp))
         if (fit%kept(j)) fit%q(:, j) = column/fit%r(j, j)
      end do
      fit%complete = all(fit%kept(:terms))
   end function make_fit

   !> Weights of the values at the sites in the value at a position.
   pure function weights_at(self, position) result(weights)
      class(fit_type), intent(in) :: self
      real(dp), intent(in) :: position(2)          !! x, y [length]
      real(dp) :: weights(size(self%q, 1))         !! their sum is 1
      real(dp) :: value(cubic_terms), local(2)
      integer :: j

      local = matmul(self%scaling, position - self%origin)
      weights = 0.0_dp
      value = 0.0_dp
      do j = 1, self%terms
         if (.not. self%kept(j)) cycle
         value(j) = (term(j, local) - dot_product(self%r(:j - 1, j), value(:j - 1)))/self%r(j, j)
         weights = weights + value(j)*self%q(:, j)
      end do
   end function weights_at

   pure real(dp) function term(j, local)
      integer, intent(in) :: j
      real(dp), intent(in) :: local(2)

      select case (j)
      case (1)
         term = 1.0_dp
      case (2, 3)
         term = local(j - 1)
      case (4)
         term = local(1)*local(2)
      case (5, 6)
         term = local(j - 4)**2
      case (7, 8)
         term = local(1)*local(2)*local(j - 6)
      case default
         term = local(j - 8)**3
      end select
   end function term

   !> The principal axes of a cloud of corners, each divided by its standard deviation, so that
   !> patches of slender elements in any direction are fitted like those of square ones. Corners
   !> may lie on a line, as those of half a ring that is one element; sites beside it do not.
   pure function scaling_of(corners, sites, centre) result(scaling)
      real(dp), intent(in) :: corners(:, :), sites(:, :), centre(2)
      real(dp) :: scaling(2, 2), xx, yy, xy, angle, axis(2), unit, variance
      integer :: i

      unit = maxval(abs(corners - spread(centre, 2, size(corners, 2))))
      xx = sum(((corners(1, :) - centre(1))/unit)**2)
      yy = sum(((corners(2, :) - centre(2))/unit)**2)
      xy = sum((corners(1, :) - centre(1))/unit*((corners(2, :) - centre(2))/unit))
      angle = 0.0_dp
      if (abs(xy) > 0.0_dp) angle = atan2(2*xy, xx - yy)/2
      do i = 1, 2
         axis = merge([cos(angle), sin(angle)], [-sin(angle), cos(angle)], i == 1)
         variance = (axis(1)**2*xx + axis(2)**2*yy + 2*axis(1)*axis(2)*xy)/size(corners, 2)
         if (variance < on_a_line*(xx + yy)/size(corners, 2)) variance = max(variance, on_a_line* &
            sum((matmul(axis, sites - spread(centre, 2, size(sites, 2)))/unit)**2)/size(sites, 2))
         scaling(i, :) = axis/(unit*sqrt(variance))
      end do
   end function scaling_of

   !> Adds a weight to those of a point.
   pure subroutine add_weight(row, sample, weight)
      type(row_type), intent(inout) :: row   !! weights of the point
      integer, intent(in) :: sample          !! recovery point
      real(dp), intent(in) :: weight         !! added to what the recovery point has
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

   !> Joins the weights of the points.
   pure subroutine join(self, rows)
      class(sample_sums_type), intent(inout) :: self !! the weights, not yet formed
      type(row_type), intent(in) :: rows(:)          !! (points)
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
   end subroutine join

   !> Adds the sums to the values at the points.
   pure subroutine add(self, components, samples, values)
      class(sample_sums_type), intent(in) :: self       !! the weights
      integer, intent(in) :: components                 !! 2 or 4
      real(dp), intent(in) :: samples(components, *)    !! at the recovery points
      real(dp), intent(inout) :: values(components, *)  !! at the points
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
   end subroutine add

   pure subroutine sum_four(n, sample, weight, samples, total)
      integer, intent(in) :: n, sample(n)
      real(dp), intent(in) :: weight(n), samples(4, *)
      real(dp), intent(inout) :: total(4)
      real(dp) :: a(2), b(2)
      integer :: k

      a = total(1:2)
      b = total(3:4)
      do k = 1, n
         a = a + weight(k)*samples(1:2, sample(k))
         b = b + weight(k)*samples(3:4, sample(k))
      end do
      total = [a, b]
   end subroutine sum_four

   pure subroutine sum_two(n, sample, weight, samples, total)
      integer, intent(in) :: n, sample(n)
      real(dp), intent(in) :: weight(n), samples(2, *)
      real(dp), intent(inout) :: total(2)
      integer :: k

      do k = 1, n
         total = total + weight(k)*samples(:, sample(k))
      end do
   end subroutine sum_two

end module element_patches
