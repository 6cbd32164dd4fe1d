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
   use element_kinds, only: quad8, quad8_reduced
   use element_patches, only: add_weights, centres_for, corners_of, fit_round_corner, fit_type, &
      is_linear, is_surrounded, layout_of, layout_type, make_fit, midsides_at, &
      quadratic_terms, sites_of, summed
   use field_recovery, only: add_averages, point_map_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use quadrature, only: recovery_count, recovery_weights
   use shape_functions, only: node_position
   use sparse_matrix, only: sparse_matrix_type, triplet_list_type
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
      type(sparse_matrix_type) :: smooth    !! the fits' values; the weights of a point sum to 1
      logical, allocatable :: inside(:)     !! (points) on which fits excel averages
      type(sparse_matrix_type) :: outline   !! averages and what they leave out at the other points
   contains
      procedure :: prepare
      procedure :: recover
      procedure :: improve
   end type patch_recovery_type

contains

   !> Fits the patches, of some elements alone where only what these have is asked for.
   subroutine prepare(self, mesh, points, first_sample, position, counts)
      class(patch_recovery_type), intent(inout) :: self !! the weights, not yet formed
      type(mesh_type), intent(in) :: mesh
      type(point_map_type), intent(in) :: points   !! where averaged fields live
      integer, intent(in) :: first_sample(:)            !! (elements + 1) first recovery point
      real(dp), intent(in) :: position(:, :)            !! (2, recovery points) x, y [length]
      logical, intent(in) :: counts(:)                  !! (elements)
      type(triplet_list_type) :: sums
      type(layout_type) :: layout
      type(fit_type) :: fit
      logical :: has_fit(size(points%node))
      integer, allocatable :: centres(:), patch(:), places(:)
      integer :: c, i, p

      layout = layout_of(mesh, points, first_sample, position, counts)
      call sums%reserve(100*size(layout%first_sample))
      allocate (self%inside(size(points%node)), source=.false.)
      do p = 1, size(self%inside)
         has_fit(p) = .false.
         if (layout%start(p + 1) > layout%start(p)) then
            call fit_round_corner(layout, p, 0, patch, fit)
            has_fit(p) = fit%ample
            ! Averages over linear elements are as good inside a regular mesh as fits are.
            self%inside(p) = fit%ample .and. is_surrounded(layout, p) .and. &
               .not. any(is_linear(layout%mesh%element_kind(patch)))
         end if
      end do
      do p = 1, size(self%inside)
         if (layout%start(p + 1) == layout%start(p)) cycle
         centres = centres_for(layout, p, has_fit)
         places = [p, midsides_at(layout, p)]
         do c = 1, size(centres)
            call fit_round_corner(layout, centres(c), most_layers, patch, fit)
            do i = 1, size(places)
               call add_weights(sums, layout, places(i), patch, share_of(places(i) == p, centres)* &
                  fit%weights_at(layout%mesh%coordinates(:, places(i))))
            end do
         end do
      end do
      self%smooth = summed(sums, size(points%node), size(position, 2))
      do p = 1, size(has_fit)
         if (self%inside(p)) self%inside(midsides_at(layout, p)) = .true.
      end do
      call sums%reserve(0)
      call add_averages(mesh, points, .not. self%inside, sums)
      call add_curvatures(layout, self%inside, sums)
      self%outline = summed(sums, size(points%node), size(position, 2))
   end subroutine prepare

   !> The values of the fits at all points; zero at those outside all elements.
   pure subroutine recover(self, components, samples, values)
      class(patch_recovery_type), intent(in) :: self    !! the weights
      integer, intent(in) :: components                 !! 2 or 4
      real(dp), intent(in) :: samples(components, *)    !! at the recovery points
      real(dp), intent(out) :: values(components, size(self%inside))   !! at the points

      values = 0.0_dp
      call self%smooth%add_product(components, samples, values)
   end subroutine recover

   !> The best values at the points: inside a section those of the fits, at its outline averages and
   !> what they leave out.
   pure subroutine improve(self, components, samples, smooth, values)
      class(patch_recovery_type), intent(in) :: self    !! the weights
      integer, intent(in) :: components                 !! 2 or 4
      real(dp), intent(in) :: samples(components, *)    !! at the recovery points
      real(dp), intent(in) :: smooth(:, :)              !! (components, points) of recover
      real(dp), intent(out) :: values(:, :)             !! (components, points)
      integer :: p

      do p = 1, size(self%inside)
         values(:, p) = 0.0_dp
         if (self%inside(p)) values(:, p) = smooth(:, p)
      end do
      call self%outline%add_product(components, samples, values)
   end subroutine improve

   !> Adds the weights of what averages leave out at the points of the outline.
   pure subroutine add_curvatures(layout, inside, sums)
      type(layout_type), intent(in) :: layout
      logical, intent(in) :: inside(:)             !! (points) that have fits of their own
      type(triplet_list_type), intent(inout) :: sums
      integer, allocatable :: centres(:), places(:)
      integer :: c, i, p

      do p = 1, size(inside)
         if (inside(p) .or. layout%start(p + 1) == layout%start(p)) cycle
         centres = centres_for(layout, p, inside)
         places = [p, midsides_at(layout, p)]
         places = pack(places, .not. inside(places))
         do c = 1, size(centres)
            if (.not. inside(centres(c))) cycle
            associate (patch => layout%around(layout%start(centres(c)): &
               layout%start(centres(c) + 1) - 1))
               if (.not. suits(layout%mesh, patch)) cycle
               do i = 1, size(places)
                  call add_curvature(sums, layout, patch, places(i), share_of(places(i) == p, &
                     centres))
               end do
            end associate
         end do
      end do
   end subroutine add_curvatures

   !> Share of what holds round a centre in the value at a corner; a midside node has the mean of
   !> what holds at the ends of its side.
   pure real(dp) function share_of(is_corner, centres) result(share)
      logical, intent(in) :: is_corner
      integer, intent(in) :: centres(:)

      share = merge(1.0_dp, 0.5_dp, is_corner)/size(centres)
   end function share_of

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
   pure subroutine add_curvature(sums, layout, patch, point, share)
      type(triplet_list_type), intent(inout) :: sums
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: patch(:), point
      real(dp), intent(in) :: share
      type(fit_type) :: fit
      real(dp) :: nodes(2, 8)
      real(dp), allocatable :: sites(:, :), missing(:), extrapolated(:)
      integer :: i, meeting, q, s

      sites = sites_of(layout, patch)
      fit = make_fit(sites, corners_of(layout, patch), quadratic_terms)
      missing = fit%weights_at(layout%mesh%coordinates(:, point))
      extrapolated = 0*missing
      nodes = node_position(quad8)
      meeting = 0
      do i = 1, size(patch)
         q = findloc(layout%mesh%element_nodes(:, patch(i)), point, dim=1)
         if (q == 0) cycle
         meeting = meeting + 1
         associate (weights => recovery_weights(quad8, nodes(:, q)), n => recovery_count(quad8))
            do s = 1, n
               extrapolated = extrapolated + weights(s)*fit%weights_at(sites(:, (i - 1)*n + s))
            end do
         end associate
      end do
      if (meeting > 0) call add_weights(sums, layout, point, patch, &
         share*(missing - extrapolated/meeting))
   end subroutine add_curvature

end module patch_recovery
