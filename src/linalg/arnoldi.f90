!> Eigenvalues at the outside of a spectrum, by Arnoldi's method (Saad, Numerical Methods for Large
!> Eigenvalue Problems, 2011, section 6.2): of products with a matrix that is nowhere formed.
!>
!>    call arnoldi%begin(n, nothing)
!>    do while (arnoldi%wants_product)
!>       call arnoldi%take(matmul(A, arnoldi%vector))
!>    end do
!>
!> The start is a vector without any order: one that is near an eigenvector would hide the others.
!> Products are wanted until the eigenvalue of largest modulus and the largest real one are sharp,
!> after many, or where the caller says what will do, only until they are known beside 1.
!> A caller that seeks others says how many products it can have, and stops when it likes.
module arnoldi
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use dense, only: eigenvalues
   use kinds, only: dp
   implicit none
   private
   public :: arnoldi_type

   integer, parameter :: first_check = 8   !! products after which eigenvalues are sought first
   real(dp), parameter :: golden = 0.5_dp*(sqrt(5.0_dp) - 1.0_dp)   !! spreads the start evenly
   real(dp), parameter :: nearly_real = 1.0e-8_dp !! imaginary part of a real eigenvalue, relative
   real(dp), parameter :: sharp = 1.0e-12_dp      !! residual of an eigenvalue, relative
   !> Products after which a residual that is small beside 1 will do: where many parts are alike so
   !> are their eigenvalues, and of hundreds of products rounding alone would be left.
   integer, parameter :: patience = 40
   real(dp), parameter :: blurred = 1.0e-4_dp     !! such a residual
   real(dp), parameter :: rounding = 1.0e-15_dp   !! of a product, relative

   !> The space of the products so far.
   type :: arnoldi_type
      logical :: wants_product = .false.
      logical :: found = .false.                   !! whether the eigenvalues are known
      real(dp), allocatable :: vector(:)           !! (n) whose product is wanted
      complex(dp) :: largest = (0.0_dp, 0.0_dp)    !! the eigenvalue of largest modulus
      real(dp) :: largest_real = -huge(1.0_dp)     !! the largest real one; -huge without any
      integer :: products = 0                      !! so far
      logical :: is_checked = .false.              !! whether eigenvalues were sought with the last
      complex(dp), allocatable :: value(:)         !! (k) all eigenvalues of the space then
      real(dp), allocatable :: residual(:)         !! (k) of these
      real(dp), private :: nothing = 0.0_dp        !! as begin has it
      real(dp), private :: enough = 0.0_dp         !! as begin has it
      integer, private :: most = 0                 !! products
      logical, private :: stops_itself = .true.
      real(dp), allocatable, private :: vectors(:, :)   !! (k, k) on the basis, as eigenvalues
      integer, private :: next_check = first_check
      real(dp), allocatable, private :: basis(:, :)      !! (n, products) orthonormal
      real(dp), allocatable, private :: projected(:, :)  !! (products, products) the matrix on it
   contains
      procedure :: begin
      procedure :: take
      procedure :: eigenvector
   end type arnoldi_type

contains

   !> Begins with a matrix of which nothing is known.
   subroutine begin(self, n, nothing, most, enough)
      class(arnoldi_type), intent(out) :: self
      integer, intent(in) :: n                     !! rows, > 0
      !> Modulus below which the largest real eigenvalue, where the others may be dense, need not be
      !> sharp.
      real(dp), intent(in) :: nothing
      !> Products that the caller can have, who stops; absent: until both eigenvalues are sharp
      integer, intent(in), optional :: most
      real(dp), intent(in), optional :: enough     !! residual beside 1 that will always do
      integer :: i

      self%nothing = nothing
      if (present(enough)) self%enough = enough
      self%most = n
      self%stops_itself = .not. present(most)
      if (present(most)) self%most = min(n, most)
      self%vector = [(modulo(golden*i, 1.0_dp) - 0.5_dp, i=1, n)]
      self%vector = self%vector/norm2(self%vector)
      allocate (self%basis(n, self%most), self%projected(self%most, self%most))
      self%wants_product = .true.
   end subroutine begin

   !> Takes the product of the vector. No more are wanted when both eigenvalues are sharp, the space
   !> is invariant or full, or the product overflowed; then none is found.
   subroutine take(self, product)
      class(arnoldi_type), intent(inout) :: self
      real(dp), intent(in) :: product(:)           !! (n)
      real(dp) :: rest(size(product)), part(self%products + 1), length
      integer :: pass

      self%wants_product = .false.
      self%is_checked = .false.
      if (.not. all(ieee_is_finite(product))) return
      self%products = self%products + 1
      associate (n => size(product), k => self%products)
         self%basis(:, k) = self%vector
         self%projected(:, k) = 0.0_dp
         rest = product
         ! Gram and Schmidt, twice for the rounding.
         do pass = 1, 2
            part = matmul(rest, self%basis(:, :k))
            rest = rest - matmul(self%basis(:, :k), part)
            self%projected(:k, k) = self%projected(:k, k) + part
         end do
         length = norm2(rest)
         if (k == n .or. length <= rounding*norm2(product)) length = 0.0_dp
         if (length <= 0.0_dp .or. k == self%next_check .or. k == self%most) then
            call seek(self, length)
            self%wants_product = self%wants_product .and. k < self%most .and. length > 0.0_dp
            if (.not. self%wants_product) return
            self%next_check = k + k/2
         end if
         self%projected(k + 1, k) = length
         self%vector = rest/length
         self%wants_product = .true.
      end associate
   end subroutine take

   !> Seeks both eigenvalues in the present space.
   subroutine seek(self, length)
      type(arnoldi_type), intent(inout) :: self
      real(dp), intent(in) :: length   !! what the last product is outside of the space
      real(dp), allocatable :: real_part(:), imaginary_part(:), residual(:)
      real(dp) :: least
      integer :: i, largest, largest_real

      associate (k => self%products)
         call eigenvalues(self%projected(:k, :k), real_part, imaginary_part, self%found, &
            self%vectors)
         if (.not. self%found) return
         residual = length*abs(self%vectors(k, :))
         do i = 1, k - 1
            if (imaginary_part(i) > 0.0_dp) residual(i:i + 1) = hypot(residual(i), residual(i + 1))
         end do
      end associate
      self%is_checked = .true.
      self%value = cmplx(real_part, imaginary_part, dp)
      self%residual = residual
      self%wants_product = .not. self%stops_itself
      if (self%wants_product) return
      largest = maxloc(hypot(real_part, imaginary_part), dim=1)
      largest_real = maxloc(real_part, mask=abs(imaginary_part) <= nearly_real* &
         maxval(abs(real_part)), dim=1)
      self%largest = cmplx(real_part(largest), imaginary_part(largest), dp)
      self%largest_real = -huge(1.0_dp)
      least = self%enough
      if (self%products >= patience) least = max(least, blurred)
      self%wants_product = residual(largest) > max(sharp*abs(self%largest), least)
      if (largest_real == 0) return
      self%largest_real = real_part(largest_real)
      self%wants_product = self%wants_product .or. (residual(largest_real) > &
         max(sharp*abs(self%largest_real), least) .and. abs(self%largest_real) + &
         residual(largest_real) > self%nothing)
   end subroutine seek

   !> The eigenvector of an eigenvalue, its real and imaginary part.
   pure function eigenvector(self, i) result(vector)
      class(arnoldi_type), intent(in) :: self
      integer, intent(in) :: i                     !! index into value
      real(dp) :: vector(size(self%basis, 1), 2)   !! (n, 2)

      vector = 0.0_dp
      associate (k => self%products, imaginary => aimag(self%value(i)))
         vector(:, 1) = matmul(self%basis(:, :k), self%vectors(:, i))
         if (imaginary > 0.0_dp) vector(:, 2) = matmul(self%basis(:, :k), self%vectors(:, i + 1))
      end associate
   end function eigenvector

end module arnoldi
