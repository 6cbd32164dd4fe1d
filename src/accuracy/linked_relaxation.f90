!> A few steps of conjugate gradients for a symmetric positive system some of whose unknowns are
!> joined, by springs or rigidly. The preconditioner is the diagonal, and the block of its unknowns
!> about each joint, which a rigid one projects: what it fixes stays fixed.
module linked_relaxation
   use dense, only: lu_type
   use kinds, only: dp
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: joint_type, relax

   !> What joins some unknowns x: direction . x = rest, or a force stiffness (direction . x - rest).
   !> Joints have no unknowns in common.
   type :: joint_type
      integer, allocatable :: dof(:)             !! (n) unknowns
      real(dp), allocatable :: direction(:, :)   !! (n, conditions)
      real(dp), allocatable :: rest(:)           !! (conditions)
      logical :: is_rigid = .false.              !! whether the conditions hold exactly
      real(dp) :: stiffness = 0.0_dp             !! of a spring, which has one condition
      real(dp), allocatable :: inverse(:, :)     !! (n, n) of the block; relax fills it
   end type joint_type

contains

   !> Relaxes the free unknowns x of A x + springs = rhs, with what is rigid kept.
   subroutine relax(matrix, joints, rhs, free, steps, x, residual)
      type(sparse_matrix_type), intent(in) :: matrix    !! (n, n) A, both triangles
      type(joint_type), intent(inout) :: joints(:)
      real(dp), intent(in) :: rhs(:)                    !! (n) right-hand side
      logical, intent(in) :: free(:)                    !! (n) unknowns that may change
      integer, intent(in) :: steps                      !! number of steps
      real(dp), intent(inout) :: x(:)                   !! (n) guess in, solution out
      real(dp), intent(out) :: residual(:)              !! (n) rhs - A x - springs
      real(dp) :: direction(size(x)), image(size(x)), z(size(x))
      real(dp) :: diagonal(size(x)), inverse(size(x)), before, energy, length
      integer :: k

      diagonal = diagonal_of(matrix)
      inverse = 0.0_dp
      where (free .and. diagonal > 0.0_dp) inverse = 1/diagonal
      do k = 1, size(joints)
         call prepare_joint(matrix, free, diagonal, joints(k), x)
      end do
      residual = rhs - matrix%multiply(x)
      call add_springs(joints, x, .true., -1.0_dp, residual)
      direction = 0.0_dp
      before = 1.0_dp
      do k = 1, steps
         z = inverse*residual
         call precondition_joints(joints, residual, z)
         energy = dot_product(z, residual)
         if (energy <= 0.0_dp) exit
         direction = z + energy/before*direction
         image = matrix%multiply(direction)
         call add_springs(joints, direction, .false., 1.0_dp, image)
         length = energy/dot_product(direction, image)
         x = x + length*direction
         residual = residual - length*image
         before = energy
      end do
   end subroutine relax

   !> Inverse of the block of a joint. A rigid one is brought to its rest, and what would move it is
   !> taken from the inverse. Held unknowns have no part in it.
   subroutine prepare_joint(matrix, free, diagonal, joint, x)
      type(sparse_matrix_type), intent(in) :: matrix
      logical, intent(in) :: free(:)
      real(dp), intent(in) :: diagonal(:)
      type(joint_type), intent(inout) :: joint
      real(dp), intent(inout) :: x(:)
      real(dp), allocatable :: block(:, :), moved(:, :), off(:, :)
      type(lu_type) :: factors
      logical :: singular
      integer :: i, n

      n = size(joint%dof)
      associate (dof => joint%dof, a => joint%direction)
         block = block_of(matrix, dof)
         if (.not. joint%is_rigid) block = block + joint%stiffness*matmul(a, transpose(a))
         joint%inverse = 0.0_dp*block
         do i = 1, n
            joint%inverse(i, i) = 1.0_dp
            if (free(dof(i))) cycle
            block(i, :) = 0.0_dp
            block(:, i) = 0.0_dp
            block(i, i) = max(diagonal(dof(i)), 1.0_dp)
         end do
         call factors%factor(block, singular)
         if (singular) then
            joint%inverse = 0.0_dp
            return
         end if
         call factors%solve(joint%inverse)
         do i = 1, n
            if (free(dof(i))) cycle
            joint%inverse(i, :) = 0.0_dp
            joint%inverse(:, i) = 0.0_dp
         end do
         if (.not. joint%is_rigid) return
         moved = matmul(joint%inverse, a)
         off = reshape(joint%rest - matmul(x(dof), a), [size(a, 2), 1])
         call factors%factor(matmul(transpose(a), moved), singular)
         ! Held on both sides nothing can be kept.
         if (singular) return
         call factors%solve(off)
         x(dof) = x(dof) + matmul(moved, off(:, 1))
         block = transpose(moved)
         call factors%solve(block)
         joint%inverse = joint%inverse - matmul(moved, block)
      end associate
   end subroutine prepare_joint

   !> The entries of a matrix between some unknowns.
   pure function block_of(matrix, dof) result(block)
      type(sparse_matrix_type), intent(in) :: matrix
      integer, intent(in) :: dof(:)
      real(dp) :: block(size(dof), size(dof))
      integer :: i, j, k

      block = 0.0_dp
      do i = 1, size(dof)
         do k = matrix%row_start(dof(i)), matrix%row_start(dof(i) + 1) - 1
            j = findloc(dof, matrix%column(k), dim=1)
            if (j > 0) block(i, j) = matrix%value(k)
         end do
      end do
   end function block_of

   !> Adds a multiple of the forces of the springs; without their rest where this does not count.
   pure subroutine add_springs(joints, x, with_rest, factor, forces)
      type(joint_type), intent(in) :: joints(:)
      real(dp), intent(in) :: x(:)
      logical, intent(in) :: with_rest
      real(dp), intent(in) :: factor
      real(dp), intent(inout) :: forces(:)
      real(dp) :: stretch
      integer :: k

      do k = 1, size(joints)
         if (joints(k)%is_rigid) cycle
         associate (along => joints(k)%direction(:, 1), dof => joints(k)%dof)
            stretch = dot_product(along, x(dof))
            if (with_rest) stretch = stretch - joints(k)%rest(1)
            forces(dof) = forces(dof) + factor*joints(k)%stiffness*stretch*along
         end associate
      end do
   end subroutine add_springs

   pure function diagonal_of(matrix) result(diagonal)
      type(sparse_matrix_type), intent(in) :: matrix
      real(dp) :: diagonal(matrix%row_count)
      integer :: i, k

      diagonal = 0.0_dp
      do i = 1, matrix%row_count
         do k = matrix%row_start(i), matrix%row_start(i + 1) - 1
            if (matrix%column(k) < i) cycle
            if (matrix%column(k) == i) diagonal(i) = matrix%value(k)
            exit
         end do
      end do
   end function diagonal_of

   pure subroutine precondition_joints(joints, residual, z)
      type(joint_type), intent(in) :: joints(:)
      real(dp), intent(in) :: residual(:)
      real(dp), intent(inout) :: z(:)
      integer :: k

      do k = 1, size(joints)
         z(joints(k)%dof) = matmul(joints(k)%inverse, residual(joints(k)%dof))
      end do
   end subroutine precondition_joints

end module linked_relaxation
