!> Solutions of A x = b by GMRES (Saad & Schultz, SIAM J. Sci. Stat. Comput. 7 (1986) 856), of
!> products with a matrix that is nowhere formed:
!>
!>    call gmres%begin(b, tolerance, most)
!>    do while (gmres%wants_product)
!>       call gmres%take(matmul(A, gmres%vector))
!>    end do
!>    x = gmres%solution()
module gmres
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: dp
   implicit none
   private
   public :: gmres_type

   real(dp), parameter :: rounding = 1.0e-15_dp   !! of a product, relative

   !> The space of the products so far.
   type :: gmres_type
      logical :: wants_product = .false.
      real(dp), allocatable :: vector(:)                 !! (n) whose product is wanted
      real(dp) :: residual = 1.0_dp                      !! |b - A x|/|b| of the solution so far
      integer :: products = 0                            !! so far
      real(dp), private :: tolerance = 0.0_dp
      real(dp), allocatable, private :: basis(:, :)      !! (n, most) orthonormal
      real(dp), allocatable, private :: upper(:, :)      !! (most, most) R of A on it
      real(dp), allocatable, private :: rotation(:, :)   !! (2, most) cosine and sine of Q
      real(dp), allocatable, private :: rest(:)          !! (most + 1) Q^T b
   contains
      procedure :: begin
      procedure :: take
      procedure :: solution
      procedure :: negative_determinant
   end type gmres_type

contains

   !> Begins at x = 0.
   subroutine begin(self, rhs, tolerance, most)
      class(gmres_type), intent(out) :: self
      real(dp), intent(in) :: rhs(:)        !! (n) b
      real(dp), intent(in) :: tolerance     !! residual that is wanted
      integer, intent(in) :: most           !! products, > 0

      self%tolerance = tolerance
      allocate (self%basis(size(rhs), most), self%upper(most, most), self%rotation(2, most))
      allocate (self%rest(most + 1), source=0.0_dp)
      self%rest(1) = norm2(rhs)
      self%wants_product = self%rest(1) > 0.0_dp .and. ieee_is_finite(self%rest(1))
      if (self%wants_product) self%vector = rhs/self%rest(1)
      if (self%rest(1) <= 0.0_dp) self%residual = 0.0_dp
   end subroutine begin

   !> Takes the product of the vector. No more are wanted when the residual is small enough, the
   !> space is invariant or full, or the product overflowed or adds nothing.
   subroutine take(self, product)
      class(gmres_type), intent(inout) :: self
      real(dp), intent(in) :: product(:)    !! (n)
      real(dp) :: column(self%products + 1), remaining(size(product)), length, radius
      integer :: i, pass

      self%wants_product = .false.
      if (.not. all(ieee_is_finite(product))) return
      associate (k => size(column))
         self%basis(:, k) = self%vector
         remaining = product
         column = 0.0_dp
         ! Gram and Schmidt, twice for the rounding.
         do pass = 1, 2
            associate (part => matmul(remaining, self%basis(:, :k)))
               remaining = remaining - matmul(self%basis(:, :k), part)
               column = column + part
            end associate
         end do
         length = norm2(remaining)
         if (length <= rounding*norm2(product)) length = 0.0_dp
         do i = 1, k - 1
            associate (c => self%rotation(1, i), s => self%rotation(2, i))
               column(i:i + 1) = [c*column(i) + s*column(i + 1), c*column(i + 1) - s*column(i)]
            end associate
         end do
         radius = hypot(column(k), length)
         if (radius <= 0.0_dp) return
         self%rotation(:, k) = [column(k), length]/radius
         column(k) = radius
         self%upper(:k, k) = column
         self%rest(k + 1) = -self%rotation(2, k)*self%rest(k)
         self%rest(k) = self%rotation(1, k)*self%rest(k)
         self%products = k
         self%residual = self%residual*abs(self%rotation(2, k))
         self%wants_product = length > 0.0_dp .and. k < size(self%rotation, 2) .and. &
            self%residual > self%tolerance
         if (self%wants_product) self%vector = remaining/length
      end associate
   end subroutine take

   !> The x of the present space with the smallest residual.
   pure function solution(self) result(x)
      class(gmres_type), intent(in) :: self
      real(dp) :: x(size(self%basis, 1))    !! (n)
      real(dp) :: part(self%products)
      integer :: i

      do i = self%products, 1, -1
         part(i) = (self%rest(i) - dot_product(self%upper(i, i + 1:self%products), part(i + 1:)))/ &
            self%upper(i, i)
      end do
      x = matmul(self%basis(:, :self%products), part)
   end function solution

   !> Whether det A is negative on the space of the products. Real eigenvalues below 0 are in it
   !> where the solution needs them; of several that are equal one is.
   pure logical function negative_determinant(self)
      class(gmres_type), intent(in) :: self

      negative_determinant = .false.
      ! Rotations keep the determinant and leave a positive diagonal, but for the last row.
      if (self%products > 0) negative_determinant = self%rotation(1, self%products) < 0.0_dp
   end function negative_determinant

end module gmres
