!> LU factors of a sparse matrix without symmetry, by rows exchanged inside of its band (LAPACK's
!> dgbtrf), in an order of its unknowns that keeps the band narrow.
module band_lu
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use blas_lapack, only: dgbtrf, dgbtrs
   use kinds, only: dp
   implicit none
   private
   public :: band_lu_type

   !> Pivot, relative to its column, below which it is rounding.
   real(dp), parameter :: lost = 1.0e-14_dp

   !> The matrix, then its factors.
   type :: band_lu_type
      integer, allocatable, private :: place(:)         !! (n) of each unknown
      integer, private :: lower = 0, upper = 0          !! diagonals beside the main one
      real(dp), allocatable, private :: factors(:, :)   !! (2 lower + upper + 1, n)
      integer, allocatable, private :: pivots(:)        !! (n) row exchanges
   contains
      procedure :: begin
      procedure :: reach
      procedure :: add
      procedure :: factor
      procedure :: solve
      procedure :: negative_determinant
   end type band_lu_type

contains

   !> Begins a matrix without entries.
   pure subroutine begin(self, rank)
      class(band_lu_type), intent(inout) :: self
      integer, intent(in) :: rank(:)            !! (n) all different: order that keeps a band narrow
      integer :: at(maxval([0, rank])), i, n

      at = 0
      at(rank) = [(i, i=1, size(rank))]
      n = 0
      self%place = rank
      do i = 1, size(at)
         if (at(i) == 0) cycle
         n = n + 1
         self%place(at(i)) = n
      end do
      self%lower = 0
      self%upper = 0
      if (allocated(self%factors)) deallocate (self%factors)
   end subroutine begin

   !> Widens the band for an entry. All entries come here before any is added.
   pure subroutine reach(self, row, column)
      class(band_lu_type), intent(inout) :: self
      integer, intent(in) :: row, column

      associate (below => self%place(row) - self%place(column))
         self%lower = max(self%lower, below)
         self%upper = max(self%upper, -below)
      end associate
   end subroutine reach

   !> Adds to an entry.
   pure subroutine add(self, row, column, value)
      class(band_lu_type), intent(inout) :: self
      integer, intent(in) :: row, column
      real(dp), intent(in) :: value

      if (.not. allocated(self%factors)) allocate (self%factors(2*self%lower + self%upper + 1, &
         size(self%place)), source=0.0_dp)
      associate (i => self%lower + self%upper + 1 + self%place(row) - self%place(column), &
         j => self%place(column))
         self%factors(i, j) = self%factors(i, j) + value
      end associate
   end subroutine add

   !> Factors the matrix with each row divided by its largest entry, if that is asked for.
   pure subroutine factor(self, scale, singular)
      class(band_lu_type), intent(inout) :: self
      !> (n) factors of the rows: 1 in, what they were multiplied by out; absent for none
      real(dp), intent(inout), optional :: scale(:)
      logical, intent(out) :: singular !! a pivot is zero or lost, or the matrix overflowed
      real(dp) :: largest(size(self%place))
      integer :: i, info, j, n

      n = size(self%place)
      singular = .false.
      self%pivots = self%place
      if (n == 0) return
      associate (diagonal => self%lower + self%upper + 1)
         if (present(scale)) then
            largest = tiny(1.0_dp)
            do j = 1, n
               do i = max(1, j - self%upper), min(n, j + self%lower)
                  largest(i) = max(largest(i), abs(self%factors(diagonal + i - j, j)))
               end do
            end do
            do j = 1, n
               do i = max(1, j - self%upper), min(n, j + self%lower)
                  self%factors(diagonal + i - j, j) = self%factors(diagonal + i - j, j)/largest(i)
               end do
            end do
            scale = scale/largest(self%place)
         end if
         largest = maxval(abs(self%factors), dim=1)
         singular = .not. all(ieee_is_finite(largest))
         if (singular) return
         call dgbtrf(n, n, self%lower, self%upper, self%factors, size(self%factors, 1), &
            self%pivots, info)
         singular = info /= 0 .or. any(abs(self%factors(diagonal, :)) <= lost*largest)
      end associate
   end subroutine factor

   !> Solves with the factors.
   pure subroutine solve(self, x)
      class(band_lu_type), intent(in) :: self
      real(dp), intent(inout) :: x(:, :)        !! (n, right-hand sides) in, solutions out
      real(dp) :: in_place(size(x, 1), size(x, 2))
      integer :: info

      if (size(x) == 0) return
      in_place(self%place, :) = x
      call dgbtrs('N', size(x, 1), self%lower, self%upper, size(x, 2), self%factors, &
         size(self%factors, 1), self%pivots, in_place, size(x, 1), info)
      x = in_place(self%place, :)
   end subroutine solve

   !> Whether the determinant of the matrix is negative.
   pure logical function negative_determinant(self) result(negative)
      class(band_lu_type), intent(in) :: self
      integer :: i

      negative = .false.
      do i = 1, size(self%pivots)
         negative = negative .neqv. (self%factors(self%lower + self%upper + 1, i) < 0.0_dp)
         negative = negative .neqv. (self%pivots(i) /= i)
      end do
   end function negative_determinant

end module band_lu
