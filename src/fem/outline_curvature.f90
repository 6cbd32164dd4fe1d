!> What averages of extrapolated values leave out at the outline of a section: extrapolation from
!> 2 x 2 points is bilinear, so that it misses the curvature of the field, on average h^2/12 times
!> the second derivatives. These are taken from quadratics fitted round the next corners inside.
module outline_curvature
   use element_kinds, only: element_node_count, quad8, quad8_reduced
   use element_patches, only: add_weights, centres_for, corners_of, layout_type, midsides_at, &
      sites_of
   use field_recovery, only: point_map_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use patch_fits, only: fit_type, make_fit, quadratic_terms
   use quadrature, only: recovery_count, recovery_weights
   use sample_sums, only: row_type, sample_sums_type
   use shape_functions, only: node_position
   implicit none
   private
   public :: curvature_sums

   !> Mean angle between opposite sides up to which quadratics in x and y follow a field that turns
   !> with the elements better than no curvature does: 20 degrees, eighteen elements round a circle.
   real(dp), parameter :: largest_turn = acos(-1.0_dp)/9

contains

   !> The weights of what is left out at the points of the outline; none elsewhere.
   pure function curvature_sums(mesh, points, layout, inside) result(sums)
      type(mesh_type), intent(in) :: mesh
      type(point_map_type), intent(in) :: points
      type(layout_type), intent(in) :: layout
      logical, intent(in) :: inside(:)             !! (points) that have fits of their own
      type(sample_sums_type) :: sums
      type(row_type) :: rows(size(points%node))
      integer, allocatable :: centres(:), near(:)
      integer :: c, i, p
      real(dp) :: share

      do p = 1, size(rows)
         if (inside(p) .or. layout%start(p + 1) == layout%start(p)) cycle
         centres = centres_for(mesh, points, layout, p, inside)
         near = midsides_at(mesh, points, layout, p)
         share = 1.0_dp/size(centres)
         do c = 1, size(centres)
            if (.not. inside(centres(c))) cycle
            associate (patch => layout%around(layout%start(centres(c)): &
               layout%start(centres(c) + 1) - 1))
               if (.not. suits(mesh, patch)) cycle
               call add_curvature(rows(p), mesh, points, layout, patch, p, share)
               ! A midside node takes the mean of what is missing at the ends of its side.
               do i = 1, size(near)
                  if (.not. inside(near(i))) call add_curvature(rows(near(i)), mesh, points, &
                     layout, patch, near(i), share/2)
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
   pure subroutine add_curvature(row, mesh, points, layout, patch, point, share)
      type(row_type), intent(inout) :: row
      type(mesh_type), intent(in) :: mesh
      type(point_map_type), intent(in) :: points
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: patch(:)
      integer, intent(in) :: point
      real(dp), intent(in) :: share
      type(fit_type) :: fit
      real(dp) :: nodes(2, 8)
      real(dp), allocatable :: sites(:, :), missing(:), extrapolated(:)
      integer :: i, meeting, q, s

      sites = sites_of(mesh, layout, patch)
      fit = make_fit(sites, corners_of(mesh, patch), quadratic_terms)
      missing = fit%weights_at(mesh%coordinates(:, points%node(point)))
      extrapolated = 0*missing
      nodes = node_position(quad8)
      meeting = 0
      do i = 1, size(patch)
         q = findloc(points%element_points(:, patch(i)), point, dim=1)
         if (q == 0) cycle
         meeting = meeting + 1
         associate (weights => recovery_weights(quad8, nodes(:, q)), n => recovery_count(quad8))
            do s = 1, n
               extrapolated = extrapolated + weights(s)*fit%weights_at(sites(:, (i - 1)*n + s))
            end do
         end associate
      end do
      if (meeting > 0) call add_weights(row, mesh, layout, patch, &
         share*(missing - extrapolated/meeting))
   end subroutine add_curvature

end module outline_curvature
