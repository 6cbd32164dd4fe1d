!> Patches of elements round the corners of a mesh, within one section, and polynomials in x and y
!> fitted by least squares to the values at their recovery points. A fit knows the sites alone: its
!> value at a position is a sum of the values with weights.
module element_patches
   use element_kinds, only: element_corner_count, element_node_count, quad4_enhanced
   use element_sides, only: element_sides_type, find_sides
   use field_recovery, only: point_map_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use quadrature, only: recovery_count
   use sorting, only: invert_lists, unique_sorted
   use sparse_matrix, only: sparse_matrix_type, triplet_list_type
   implicit none
   private
   public :: layout_type, layout_of, centres_for, midsides_at, fit_round_corner, is_surrounded, &
      is_linear, sites_of, corners_of, add_weights, fit_type, make_fit, quadratic_terms, &
      summed

   integer, parameter :: fewest_for_cubic = 16   !! sites: four elements of eight nodes

   !> Elements round each corner, and their recovery points.
   type :: layout_type
      type(mesh_type) :: mesh                    !! points for nodes, and the elements that count
      type(element_sides_type) :: sides
      integer, allocatable :: first_sample(:)    !! (elements) first recovery point
      real(dp), allocatable :: position(:, :)    !! (2, recovery points) [length]
      integer, allocatable :: start(:)           !! (points + 1) first of the elements round each
      integer, allocatable :: around(:)          !! elements of which the points are corners
      integer, allocatable :: side_start(:)      !! (points + 1) first of the sides at each
      integer, allocatable :: side_at(:)         !! sides that end at the points
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

   !> The layout of the elements that count.
   pure function layout_of(mesh, points, first_sample, position, counts) result(layout)
      type(mesh_type), intent(in) :: mesh
      type(point_map_type), intent(in) :: points
      integer, intent(in) :: first_sample(:)     !! (elements + 1) first recovery point
      real(dp), intent(in) :: position(:, :)     !! (2, recovery points) x, y [length]
      logical, intent(in) :: counts(:)           !! (elements)
      type(layout_type) :: layout
      integer :: e
      integer, allocatable :: chosen(:)

      chosen = pack([(e, e=1, size(counts))], counts)
      layout%mesh%node_number = points%node
      layout%mesh%coordinates = mesh%coordinates(:, points%node)
      layout%mesh%element_kind = mesh%element_kind(chosen)
      layout%mesh%element_nodes = points%element_points(:, chosen)
      layout%sides = find_sides(layout%mesh)
      layout%first_sample = first_sample(chosen)
      layout%position = position
      associate (kinds => layout%mesh%element_kind, n => size(points%node), sides => layout%sides)
         call invert_lists(layout%mesh%element_nodes, element_corner_count(kinds), n, &
            layout%start, layout%around)
         call invert_lists(sides%ends([1, 3], :sides%count), spread(2, 1, sides%count), n, &
            layout%side_start, layout%side_at)
         layout%is_centred = is_linear(kinds) .and. .not. is_row(layout)
      end associate
   end function layout_of

   !> Whether elements with incompatible modes, which follow bending, have no neighbours on two
   !> opposite sides, so that the centres do not show it.
   pure function is_row(layout)
      type(layout_type), intent(in) :: layout
      logical :: is_row(size(layout%mesh%element_kind)), is_free(4)
      integer :: e

      is_row = .false.
      do e = 1, size(is_row)
         if (layout%mesh%element_kind(e) /= quad4_enhanced) cycle
         is_free = layout%sides%elements(2, layout%sides%of_element(:, e)) == 0
         is_row(e) = any(is_free(:2) .and. is_free(3:))
      end do
   end function is_row

   !> The sides that end at a corner.
   pure function sides_at(layout, corner) result(sides)
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: corner
      integer, allocatable :: sides(:)

      sides = layout%side_at(layout%side_start(corner):layout%side_start(corner + 1) - 1)
   end function sides_at

   !> Corners whose fits hold at a corner: its own, or, where its elements are too few for one, as
   !> at the outline of a body, those of its neighbours inside, first along sides, then across
   !> elements; without any its own, widened.
   pure function centres_for(layout, corner, has_fit) result(centres)
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: corner
      logical, intent(in) :: has_fit(:)
      integer, allocatable :: centres(:)
      integer :: k

      centres = [corner]
      if (has_fit(corner)) return
      centres = sum(layout%sides%ends([1, 3], sides_at(layout, corner)), dim=1) - corner
      centres = pack(centres, has_fit(centres))
      if (size(centres) > 0) return
      do k = layout%start(corner), layout%start(corner + 1) - 1
         associate (e => layout%around(k))
            centres = [centres, layout%mesh%element_nodes(:element_corner_count( &
               layout%mesh%element_kind(e)), e)]
         end associate
      end do
      centres = unique_sorted(pack(centres, has_fit(centres)))
      if (size(centres) == 0) centres = [corner]
   end function centres_for

   !> Whether the elements round a corner close a ring, so that it is not on the outline.
   pure logical function is_surrounded(layout, corner)
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: corner                 !! a point

      is_surrounded = all(layout%sides%elements(2, sides_at(layout, corner)) > 0)
   end function is_surrounded

   !> Midside points of the sides that end at a corner. Where one hangs on a larger element it is a
   !> corner, with a fit of its own.
   pure function midsides_at(layout, corner) result(near)
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: corner
      integer, allocatable :: near(:)

      near = layout%sides%ends(2, sides_at(layout, corner))
      near = pack(near, near > 0)
      near = pack(near, layout%start(near + 1) == layout%start(near))
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
            side = layout%mesh%element_nodes([q, modulo(q, corners) + 1], patch(i))
            do k = layout%start(side(1)), layout%start(side(1) + 1) - 1
               associate (other => layout%around(k))
                  if (any(patch == other)) cycle
                  if (all(layout%mesh%element_nodes(:, other) /= side(2))) cycle
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

      allocate (sites(2, sum(recovery_count(layout%mesh%element_kind(patch)))))
      n = 0
      do i = 1, size(patch)
         associate (first => layout%first_sample(patch(i)), &
            m => recovery_count(layout%mesh%element_kind(patch(i))))
            if (layout%is_centred(patch(i))) then
               sites(:, n + 1) = sum(layout%position(:, first:first + m - 1), dim=2)/m
               n = n + 1
            else
               sites(:, n + 1:n + m) = layout%position(:, first:first + m - 1)
               n = n + m
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

   !> Adds the weights of the sites of a patch in the value at a point.
   pure subroutine add_weights(sums, layout, point, patch, weights)
      type(triplet_list_type), intent(inout) :: sums   !! (points, recovery points)
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: point
      integer, intent(in) :: patch(:)
      real(dp), intent(in) :: weights(:)
      real(dp) :: weight
      integer :: i, n, s

      call sums%make_room(4*size(patch))
      n = 1
      do i = 1, size(patch)
         associate (samples => recovery_count(layout%mesh%element_kind(patch(i))))
            do s = 0, samples - 1
               weight = weights(n)
               if (layout%is_centred(patch(i))) weight = weight/samples
               call sums%add(point, layout%first_sample(patch(i)) + s, weight)
               if (.not. layout%is_centred(patch(i))) n = n + 1
            end do
            if (layout%is_centred(patch(i))) n = n + 1
         end associate
      end do
   end subroutine add_weights

   !> The matrix of weights, those of a recovery point at a point summed where it comes first.
   pure function summed(list, points, samples) result(matrix)
      type(triplet_list_type), intent(in) :: list   !! (points, recovery points)
      integer, intent(in) :: points, samples        !! number of each
      type(sparse_matrix_type) :: matrix
      integer :: k, n, p, place(samples)
      integer, allocatable :: order(:)

      matrix = sparse_matrix_type(points, samples)
      call invert_lists(reshape(list%row(:list%length), [1, list%length]), spread(1, 1, &
         list%length), points, matrix%row_start, order)
      matrix%column = list%column(order)
      matrix%value = list%value(order)
      place = 0
      n = 0
      do p = 1, points
         associate (first => n + 1, own => order(matrix%row_start(p):matrix%row_start(p + 1) - 1))
            matrix%row_start(p) = first
            do k = 1, size(own)
               associate (i => place(list%column(own(k))))
                  if (i < first) then
                     n = n + 1
                     i = n
                     matrix%column(n) = list%column(own(k))
                     matrix%value(n) = 0.0_dp
                  end if
                  matrix%value(i) = matrix%value(i) + list%value(own(k))
               end associate
            end do
         end associate
      end do
      matrix%row_start(points + 1) = n + 1
   end function summed

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

end module element_patches
