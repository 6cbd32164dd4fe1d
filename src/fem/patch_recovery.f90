!> Stress or flux at the nodes by superconvergent patch recovery: polynomials fitted to the values
!> at the recovery points of the elements round a corner (Zienkiewicz & Zhu, Int. J. Num. Meth. Eng.
!> 33 (1992) 1331), cubic ones round four quadrilaterals of eight nodes. A fit depends on geometry
!> alone, so each nodal value is a sum of values with weights that are formed once.
!>
!> Plain averages of extrapolated values (field_recovery) will not do for an estimate of errors: in
!> elements of eight nodes they are off at the nodes by the order of the error itself, h^2 times the
!> curvature of the field, which extrapolation by bilinear functions leaves out on all sides.
module patch_recovery
   use element_patches, only: add_weights, centres_for, find_elements_round_corners, &
      fit_round_corner, is_linear, is_surrounded, layout_type, midsides_at
   use field_recovery, only: point_map_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use outline_curvature, only: curvature_sums
   use patch_fits, only: fit_type
   use sample_sums, only: row_type, sample_sums_type
   implicit none
   private
   public :: patch_recovery_type

   integer, parameter :: most_layers = 3   !! times that a patch is widened by its neighbours

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
      allocate (self%inside(size(rows)), source=.false.)
      do p = 1, size(rows)
         has_fit(p) = .false.
         if (layout%start(p + 1) > layout%start(p)) then
            call fit_round_corner(mesh, points, layout, p, 0, patch, fit)
            has_fit(p) = fit%ample
            ! Averages over linear elements are as good inside a regular mesh as fits are.
            self%inside(p) = fit%ample .and. is_surrounded(mesh, points, layout, p) .and. &
               .not. any(is_linear(mesh%element_kind(patch)))
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
      call self%smooth%join(rows)
      do p = 1, size(rows)
         if (self%inside(p)) self%inside(midsides_at(mesh, points, layout, p)) = .true.
      end do
      self%curvature = curvature_sums(mesh, points, layout, self%inside)
   end subroutine prepare

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

end module patch_recovery
