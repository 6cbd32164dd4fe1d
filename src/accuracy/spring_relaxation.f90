!> Approximate solution for part of the unknowns of a symmetric positive system, all others held:
!> conjugate gradients, preconditioned by the diagonal and, about each spring, by its unknowns'
!> block.
module spring_relaxation
   use dense, only: lu_type
   use kinds, only: dp
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: spring_type, relax

   !> A spring that ties some unknowns: its force is stiffness (direction . x - rest).
   type :: spring_type
      integer, allocatable :: dof(:)          !! (n) unknowns
      real(dp), allocatable :: direction(:)   !! (n) coefficients
      real(dp) :: stiffness = 0.0_dp          !! force per unit of direction . x
      real(dp) :: rest = 0.0_dp               !! direction . x without force
   end type spring_type

contains

   !> Relaxes the free unknowns x of A x + springs = rhs.
   subroutine relax(matrix, springs, rhs, free, steps, x)
      type(sparse_matrix_type), intent(in) :: matrix   !! (n, n) A, both triangles
      type(spring_type), intent(in) :: springs(:)      !! springs beside it
      real(dp), intent(in) :: rhs(:)                   !! (n) right-hand side
      logical, intent(in) :: free(:)                   !! (n) unknowns that may change
      integer, intent(in) :: steps                     !! number of steps
      real(dp), intent(inout) :: x(:)                  !! (n) guess in, solution out
      type(lu_type), allocatable :: blocks(:)
      real(dp) :: residual(size(x)), direction(size(x)), image(size(x)), z(size(x))
      real(dp) :: diagonal(size(x)), energy, before, step
      integer :: k

      diagonal = diagonal_of(matrix)
      call factor_blocks(matrix, springs, free, diagonal, blocks)
      residual = merge(rhs - spring_image(springs, x, .true.) - matrix%multiply(x), 0.0_dp, free)
      direction = 0.0_dp
      before = 1.0_dp
      do k = 1, steps
         z = preconditioned(springs, free, diagonal, blocks, residual)
         energy = dot_product(z, residual)
         if (energy <= 0.0_dp) exit
         if (k == 1) then
            direction = z
         else
            direction = z + energy/before*direction
         end if
         image = merge(matrix%multiply(direction) + spring_image(springs, direction, .false.), &
            0.0_dp, free)
         step = energy/dot_product(direction, image)
         x = x + step*direction
         residual = residual - step*image
         before = energy
      end do
   end subroutine relax

   !> Forces of the springs; without their rest lengths where these do not count.
   pure function spring_image(springs, x, with_rest) result(image)
      type(spring_type), intent(in) :: springs(:)
      real(dp), intent(in) :: x(:)
      logical, intent(in) :: with_rest
      real(dp) :: image(size(x))
      real(dp) :: stretch
      integer :: k

      image = 0.0_dp
      do k = 1, size(springs)
         associate (spring => springs(k), dof => springs(k)%dof)
            stretch = dot_product(spring%direction, x(dof))
            if (with_rest) stretch = stretch - spring%rest
            image(dof) = image(dof) + spring%stiffness*stretch*spring%direction
         end associate
      end do
   end function spring_image

   !> The diagonal of a matrix.
   pure function diagonal_of(matrix) result(diagonal)
      type(sparse_matrix_type), intent(in) :: matrix
      real(dp) :: diagonal(matrix%row_count)
      integer :: i, k

      diagonal = 0.0_dp
      do i = 1, matrix%row_count
         do k = matrix%row_start(i), matrix%row_start(i + 1) - 1
            if (matrix%column(k) == i) diagonal(i) = matrix%value(k)
         end do
      end do
   end function diagonal_of

   !> Factors, for each spring, the block of its unknowns with all springs on the same ones; blocks
   !> of springs that share their unknowns are the same. Held unknowns are left alone.
   pure subroutine factor_blocks(matrix, springs, free, diagonal, blocks)
      type(sparse_matrix_type), intent(in) :: matrix
      type(spring_type), intent(in) :: springs(:)
      logical, intent(in) :: free(:)
      real(dp), intent(in) :: diagonal(:)
      type(lu_type), allocatable, intent(out) :: blocks(:)
      real(dp), allocatable :: block(:, :)
      logical :: singular
      integer :: i, k, other

      allocate (blocks(size(springs)))
      do k = 1, size(springs)
         associate (dof => springs(k)%dof)
            if (allocated(block)) deallocate (block)
            allocate (block(size(dof), size(dof)), source=0.0_dp)
            call add_entries(matrix, dof, block)
            do other = max(1, k - 1), min(size(springs), k + 1)
               if (.not. same_unknowns(springs(other)%dof, dof)) cycle
               associate (spring => springs(other))
                  do i = 1, size(dof)
                     block(:, i) = block(:, i) + &
                        spring%stiffness*spring%direction*spring%direction(i)
                  end do
               end associate
            end do
            do i = 1, size(dof)
               if (free(dof(i))) cycle
               block(i, :) = 0.0_dp
               block(:, i) = 0.0_dp
               block(i, i) = max(diagonal(dof(i)), tiny(1.0_dp))
            end do
            call blocks(k)%factor(block, singular)
         end associate
      end do
   end subroutine factor_blocks

   pure logical function same_unknowns(one, other)
      integer, intent(in) :: one(:), other(:)

      same_unknowns = size(one) == size(other)
      if (same_unknowns) same_unknowns = all(one == other)
   end function same_unknowns

   pure subroutine add_entries(matrix, dof, block)
      type(sparse_matrix_type), intent(in) :: matrix
      integer, intent(in) :: dof(:)
      real(dp), intent(inout) :: block(:, :)
      integer :: i, j, k

      do i = 1, size(dof)
         do k = matrix%row_start(dof(i)), matrix%row_start(dof(i) + 1) - 1
            j = findloc(dof, matrix%column(k), dim=1)
            if (j > 0) block(i, j) = block(i, j) + matrix%value(k)
         end do
      end do
   end subroutine add_entries

   pure function preconditioned(springs, free, diagonal, blocks, residual) result(z)
      type(spring_type), intent(in) :: springs(:)
      logical, intent(in) :: free(:)
      real(dp), intent(in) :: diagonal(:)
      type(lu_type), intent(in) :: blocks(:)
      real(dp), intent(in) :: residual(:)
      real(dp) :: z(size(residual))
      real(dp), allocatable :: part(:, :)
      integer :: k

      z = 0.0_dp
      where (free .and. diagonal > 0.0_dp) z = residual/diagonal
      do k = 1, size(springs)
         part = reshape(residual(springs(k)%dof), [size(springs(k)%dof), 1])
         call blocks(k)%solve(part)
         z(springs(k)%dof) = part(:, 1)
      end do
      where (.not. free) z = 0.0_dp
   end function preconditioned

end module spring_relaxation
