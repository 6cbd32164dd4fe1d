!> What ties and equations hold, as joints of rigid motions.
module constraint_joints
   use equations, only: equation_type
   use kinds, only: dp
   use rigid_motions, only: joint_type
   use tie_points, only: tie_points_type
   implicit none
   private
   public :: joints_of

   interface joints_of
      module procedure :: joints_of_ties, joints_of_equations
   end interface joints_of

contains

   !> What ties hold, along x and y.
   pure function joints_of_ties(ties) result(joints)
      type(tie_points_type), intent(in) :: ties
      type(joint_type), allocatable :: joints(:)    !! (2 n)
      integer :: c, k

      allocate (joints(2*ties%difference%count))
      do k = 1, ties%difference%count
         do c = 1, 2
            associate (joint => joints(2*(k - 1) + c))
               joint%nodes = ties%difference%values_of(k)
               allocate (joint%share(2, size(joint%nodes)), source=0.0_dp)
               joint%share(c, :) = ties%difference%coefficients_of(k)
            end associate
         end do
      end do
   end function joints_of_ties

   !> What equations of displacements hold.
   pure function joints_of_equations(equations) result(joints)
      type(equation_type), intent(in) :: equations(:)
      type(joint_type), allocatable :: joints(:)
      integer :: i, k, n

      allocate (joints(count([(.not. equations(i)%is_thermal(), i=1, size(equations))])))
      n = 0
      do i = 1, size(equations)
         if (equations(i)%is_thermal()) cycle
         n = n + 1
         joints(n)%nodes = equations(i)%node
         allocate (joints(n)%share(2, size(equations(i)%node)), source=0.0_dp)
         do k = 1, size(equations(i)%node)
            joints(n)%share(equations(i)%dof(k), k) = equations(i)%coefficient(k)
         end do
      end do
   end function joints_of_equations

end module constraint_joints
