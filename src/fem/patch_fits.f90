!> Polynomials in x and y fitted by least squares to values at sites in the plane. A fit knows the
!> sites alone: its value at a position is a sum of the values with weights.
module patch_fits
   use kinds, only: dp
   implicit none
   private
   public :: fit_type, make_fit, linear_terms, quadratic_terms, cubic_terms

   integer, parameter :: linear_terms = 3      !! 1, x, y
   integer, parameter :: quadratic_terms = 6   !! and xy, x^2, y^2
   integer, parameter :: cubic_terms = 10      !! and x^2 y, x y^2, x^3, y^3

   !> Root mean square over the sites of what is new in a term, below which the sites do not tell
   !> it from the terms before: a single row of elements has no slope, or no curvature, across.
   real(dp), parameter :: undetermined = 0.1_dp

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

   !> Fits polynomials to sites; terms that these do not determine are left out.
   pure function make_fit(sites, corners, terms) result(fit)
      real(dp), intent(in) :: sites(:, :)     !! (2, sites) [length]
      !> (2, corners) of the elements that they lie in: the size of the patch [length]
      real(dp), intent(in) :: corners(:, :)
      integer, intent(in) :: terms            !! linear_terms, quadratic_terms or cubic_terms
      type(fit_type) :: fit
      real(dp) :: column(size(sites, 2))
      integer :: i, j

      fit%terms = terms
      fit%origin = sum(corners, dim=2)/size(corners, 2)
      fit%scaling = scaling_of(corners, fit%origin)
      allocate (fit%q(size(sites, 2), terms), source=0.0_dp)
      do j = 1, terms
         do i = 1, size(sites, 2)
            column(i) = term(j, matmul(fit%scaling, sites(:, i) - fit%origin))
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
   !> patches of slender elements in any direction are fitted like those of square ones.
   pure function scaling_of(corners, centre) result(scaling)
      real(dp), intent(in) :: corners(:, :), centre(2)
      real(dp) :: scaling(2, 2)
      real(dp) :: xx, yy, xy, angle, axis(2), unit
      integer :: i

      unit = maxval(abs(corners - spread(centre, 2, size(corners, 2))))
      xx = sum(((corners(1, :) - centre(1))/unit)**2)
      yy = sum(((corners(2, :) - centre(2))/unit)**2)
      xy = sum((corners(1, :) - centre(1))/unit*((corners(2, :) - centre(2))/unit))
      angle = 0.0_dp
      if (abs(xy) > 0.0_dp) angle = atan2(2*xy, xx - yy)/2
      do i = 1, 2
         axis = merge([cos(angle), sin(angle)], [-sin(angle), cos(angle)], i == 1)
         scaling(i, :) = axis/(unit*sqrt((axis(1)**2*xx + axis(2)**2*yy + 2*axis(1)*axis(2)*xy)/ &
            size(corners, 2)))
      end do
   end function scaling_of

end module patch_fits
