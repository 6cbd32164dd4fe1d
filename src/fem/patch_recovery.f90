!> Stress or flux at the nodes by superconvergent patch recovery: polynomials fitted to the values
!> at the recovery points of the elements round a corner (Zienkiewicz & Zhu, Int. J. Num. Meth. Eng.
!> 33 (1992) 1331), cubic ones round four quadrilaterals of eight nodes. A fit depends on geometry
!> alone, so each nodal value is a sum of values with weights that are formed once.
!>
!> Plain averages of extrapolated values (field_recovery) will not do for an estimate of errors: in
!> elements of eight nodes they are off at the nodes by the order of the error itself: extrapolation
!> from 2 x 2 points is bilinear, so that it misses the curvature of the field, on average h^2/12
!> times the second derivatives. At the outline of a section, where patches have too few elements,
!> these are taken from quadratics fitted round the next corners inside.
module patch_recovery
   use element_kinds, only: element_corner_count, quad4_enhanced, quad8, quad8_reduced
   use element_patches, only: add_weights, centres_for, corners_of, fit_round_corner, fit_type, &
      is_linear, is_surrounded, layout_type, make_fit, midsides_at, quadratic_terms, row_type, &
      sample_sums_type, sites_of
   use field_recovery, only: point_map_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use quadrature, only: recovery_count, recovery_weights
   use shape_functions, only: node_position
   use sorting, only: invert_lists
   implicit none
   private
   public :: patch_recovery_type

   integer, parameter :: most_layers = 3   !! times that a patch is widened by its neighbours
   !> Mean angle between opposite sides up to which quadratics in x and y follow a field that turns
   !> with the elements better than no curvature does: 20 degrees, eighteen elements round a circle.
   real(dp), parameter :: largest_turn = acos(-1.0_dp)/9

   !> Nodal values from values at the recovery points of all elements.
   type :: patch_recovery_type
      private
      type(sample_sums_type) :: smooth      !! the fits' values; the weights of a point sum to 1
      logical, allocatable :: inside(:)     !! (points) on which fits excel averages
      type(sample_sums_type) :: curvature   !! what averages leave out at the other points
   contains
      procedure :: prepare
      procedure :: recover
      procedure :: improve
   end type patch_recovery_type

contains

   !> Fits the patches, of some elements alone where only what these have is asked for.
   subroutine prepare(self, mesh, points, first_sample, position, counts)
      class(patch_recovery_type), intent(inout) :: self !! the weights, not yet formed
      type(mesh_type), intent(in), target :: mesh
      type(point_map_type), intent(in), target :: points   !! where averaged fields live
      integer, intent(in) :: first_sample(:)            !! (elements + 1) first recovery point
      real(dp), intent(in) :: position(:, :)            !! (2, recovery points) x, y [length]
      logical, intent(in) :: counts(:)                  !! (elements)
      type(row_type) :: rows(size(points%node))
      type(layout_type) :: layout
      type(fit_type) :: fit
      logical :: has_fit(size(points%node))
      integer, allocatable :: centres(:), near(:), patch(:)
      integer :: c, i, p
      real(dp) :: share

      layout%mesh => mesh
      layout%points => points
      layout%first_sample = first_sample
      layout%position = position
      call invert_lists(points%element_points, merge(element_corner_count(mesh%element_kind), &
         0, counts), size(rows), layout%start, layout%around)
      layout%is_centred = is_linear(mesh%element_kind) .and. .not. is_row(layout)
      allocate (self%inside(size(rows)), source=.false.)
      do p = 1, size(rows)
         has_fit(p) = .false.
         if (layout%start(p + 1) > layout%start(p)) then
            call fit_round_corner(layout, p, 0, patch, fit)
            has_fit(p) = fit%ample
            ! Averages over linear elements are as good inside a regular mesh as fits are.
            self%inside(p) = fit%ample .and. is_surrounded(layout, p) .and. &
               .not. any(is_linear(mesh%element_kind(patch)))
         end if
      end do
      do p = 1, size(rows)
         if (layout%start(p + 1) == layout%start(p)) cycle
         centres = centres_for(layout, p, has_fit)
         near = midsides_at(layout, p)
         share = 1.0_dp/size(centres)
         do c = 1, size(centres)
            call fit_round_corner(layout, centres(c), most_layers, patch, fit)
            call add_weights(rows(p), layout, patch, &
               share*fit%weights_at(mesh%coordinates(:, points%node(p))))
            ! A midside node has the mean of what holds at the ends of its side.
            do i = 1, size(near)
               call add_weights(rows(near(i)), layout, patch, &
                  share/2*fit%weights_at(mesh%coordinates(:, points%node(near(i)))))
            end do
         end do
      end do
      call self%smooth%join(rows)
      do p = 1, size(rows)
         if (self%inside(p)) self%inside(midsides_at(layout, p)) = .true.
      end do
      self%curvature = curvature_sums(layout, self%inside)
   end subroutine prepare

   !> Whether elements with incompatible modes, which follow bending, have no neighbours on two
   !> opposite sides, so that the centres do not show it.
   pure function is_row(layout)
      type(layout_type), intent(in) :: layout
      logical :: is_row(size(layout%mesh%element_kind)), is_free(4)
      integer :: e, k, q

      do e = 1, size(is_row)
         is_row(e) = .false.
         if (layout%mesh%element_kind(e) /= quad4_enhanced) cycle
         is_free = .true.
         do q = 1, 4
            associate (side => layout%points%element_points([q, modulo(q, 4) + 1], e))
               do k = layout%start(side(1)), layout%start(side(1) + 1) - 1
                  if (layout%around(k) /= e .and. any(layout%points%element_points(:, &
                     layout%around(k)) == side(2))) is_free(q) = .false.
               end do
            end associate
         end do
         is_row(e) = any(is_free(:2) .and. is_free(3:))
      end do
   end function is_row

   !> The values of the fits at all points; zero at those outside all elements.
   pure subroutine recover(self, components, samples, values)
      class(patch_recovery_type), intent(in) :: self    !! the weights
      integer, intent(in) :: components                 !! 2 or 4
      real(dp), intent(in) :: samples(components, *)    !! at the recovery points
      real(dp), intent(out) :: values(components, size(self%inside))   !! at the points

      values = 0.0_dp
      call self%smooth%add(components, samples, values)
   end subroutine recover

   !> The best values at the points, from averages: inside a section those of the fits, at its
   !> outline the averages and what they leave out.
   pure subroutine improve(self, components, samples, smooth, values)
      class(patch_recovery_type), intent(in) :: self    !! the weights
      integer, intent(in) :: components                 !! 2 or 4
      real(dp), intent(in) :: samples(components, *)    !! at the recovery points
      real(dp), intent(in) :: smooth(:, :)              !! (components, points) of recover
      real(dp), intent(inout) :: values(:, :)           !! (components, points) averages, bettered
      integer :: p

      do p = 1, size(self%inside)
         if (self%inside(p)) values(:, p) = smooth(:, p)
      end do
      call self%curvature%add(components, samples, values)
   end subroutine improve

   !> The weights of what is left out at the points of the outline; none elsewhere.
   pure function curvature_sums(layout, inside) result(sums)
      type(layout_type), intent(in) :: layout
      logical, intent(in) :: inside(:)             !! (points) that have fits of their own
      type(sample_sums_type) :: sums
      type(row_type) :: rows(size(layout%points%node))
      integer, allocatable :: centres(:), near(:)
      integer :: c, i, p
      real(dp) :: share

      do p = 1, size(rows)
         if (inside(p) .or. layout%start(p + 1) == layout%start(p)) cycle
         centres = centres_for(layout, p, inside)
         near = midsides_at(layout, p)
         share = 1.0_dp/size(centres)
         do c = 1, size(centres)
            if (.not. inside(centres(c))) cycle
            associate (patch => layout%around(layout%start(centres(c)): &
               layout%start(centres(c) + 1) - 1))
               if (.not. suits(layout%mesh, patch)) cycle
               call add_curvature(rows(p), layout, patch, p, share)
               ! A midside node has the mean of what is missing at the ends of its side.
               do i = 1, size(near)
                  if (.not. inside(near(i))) call add_curvature(rows(near(i)), layout, patch, &
                     near(i), share/2)
               end do
            end associate
         end do
      end do
      call sums%join(rows)
   end function curvature_sums

   !> Whether a patch has superconvergent values, those of eight-node elements, and follows them.
   pure logical function suits(mesh, patch)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: patch(:)
      real(dp) :: angle(2), turn
      integer :: i, k

      turn = 0.0_dp
      do i = 1, size(patch)
         associate (x => mesh%coordinates(:, mesh%element_nodes(:4, patch(i))))
            do k = 1, 2
               associate (one => x(:, k + 1) - x(:, k), &
                  other => x(:, k + 2) - x(:, modulo(k + 2, 4) + 1))
                  angle(k) = atan2(abs(one(1)*other(2) - one(2)*other(1)), dot_product(one, other))
               end associate
            end do
         end associate
         turn = turn + maxval(angle)/size(patch)
      end do
      suits = turn <= largest_turn .and. all(mesh%element_kind(patch) == quad8 .or. &
         mesh%element_kind(patch) == quad8_reduced)
   end function suits

   !> Adds the difference, at a point, of the polynomial of a patch and of its bilinear
   !> extrapolation in the elements of the patch that meet there.
   pure subroutine add_curvature(row, layout, patch, point, share)
      type(row_type), intent(inout) :: row
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: patch(:), point
      real(dp), intent(in) :: share
      type(fit_type) :: fit
      real(dp) :: nodes(2, 8)
      real(dp), allocatable :: sites(:, :), missing(:), extrapolated(:)
      integer :: i, meeting, q, s

      sites = sites_of(layout, patch)
      fit = make_fit(sites, corners_of(layout, patch), quadratic_terms)
      missing = fit%weights_at(layout%mesh%coordinates(:, layout%points%node(point)))
      extrapolated = 0*missing
      nodes = node_position(quad8)
      meeting = 0
      do i = 1, size(patch)
         q = findloc(layout%points%element_points(:, patch(i)), point, dim=1)
         if (q == 0) cycle
         meeting = meeting + 1
         associate (weights => recovery_weights(quad8, nodes(:, q)), n => recovery_count(quad8))
            do s = 1, n
               extrapolated = extrapolated + weights(s)*fit%weights_at(sites(:, (i - 1)*n + s))
            end do
         end associate
      end do
      if (meeting > 0) call add_weights(row, layout, patch, share*(missing - extrapolated/meeting))
   end subroutine add_curvature

end module patch_recovery
