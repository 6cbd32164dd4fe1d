!> The contact system of the reduced bodies: the Schur complement of equilibrium on the pairs.
module contact_reduction
   use contact_constraints, only: in_ring, ring_give, stiffness_alone
   use contact_system, only: contact_system_type
   use dense, only: column_space
   use field_problem, only: field_problem_type
   use kinds, only: dp
   use linear_constraints, only: node_stiffness
   use pair_rows, only: pair_row_type
   implicit none
   private
   public :: contact_system_of

contains

   !> The contact system from the mechanical Schur complement.
   pure function contact_system_of(mechanical, pairs, rigid) result(contact)
      type(field_problem_type), intent(in) :: mechanical !! equilibrium, reduced
      type(pair_row_type), intent(in) :: pairs           !! all pairs
      real(dp), intent(in) :: rigid(:, :) !! (2 nodes, motions) that the supports leave free
      type(contact_system_type) :: contact               !! the system, nothing closed
      integer :: m

      m = size(pairs%slave)
      allocate (contact%normal(m), contact%tangent(m))
      associate (map => mechanical%map)
         contact%normal(:) = map%tail_index(map%introduced(1::2))
         contact%tangent(:) = map%tail_index(map%introduced(2::2))
      end associate
      contact%schur = mechanical%solver%schur
      contact%friction = pairs%friction
      call set_motions(pairs, rigid, contact)
      call set_rings(mechanical, pairs, contact)
   end function contact_system_of

   !> The rigid motions that the supports leave free, on the tail. In exact arithmetic they need no
   !> force; what S makes of them is rounding, and is taken from it.
   pure subroutine set_motions(pairs, rigid, contact)
      type(pair_row_type), intent(in) :: pairs
      real(dp), intent(in) :: rigid(:, :)
      type(contact_system_type), intent(inout) :: contact
      real(dp), allocatable :: forces(:, :), relative(:, :)
      integer :: k, m, s

      allocate (contact%rigid(size(contact%schur, 1), size(rigid, 2)), source=0.0_dp)
      do k = 1, size(pairs%slave)
         s = 2*pairs%slave(k)
         m = 2*pairs%master(k)
         relative = rigid(s - 1:s, :) - rigid(m - 1:m, :)
         contact%rigid(contact%normal(k), :) = matmul(pairs%normal(:, k), relative)
         if (contact%tangent(k) > 0) then
            contact%rigid(contact%tangent(k), :) = matmul(pairs%tangent(:, k), relative)
         end if
      end do
      contact%motion = column_space(contact%rigid)
      if (size(contact%motion, 2) == 0) return
      associate (z => contact%motion)
         forces = matmul(contact%schur, z)
         contact%schur = contact%schur - matmul(forces, transpose(z)) - &
            matmul(z, transpose(forces)) + &
            matmul(z, matmul(matmul(transpose(z), forces), transpose(z)))
      end associate
   end subroutine set_motions

   !> The links of the rings, and how much their stuck pairs give.
   pure subroutine set_rings(mechanical, pairs, contact)
      type(field_problem_type), intent(in) :: mechanical
      type(pair_row_type), intent(in) :: pairs
      type(contact_system_type), intent(inout) :: contact
      integer :: k, nodes(2)

      associate (map => mechanical%map, ring => in_ring(mechanical%map, size(pairs%slave)))
         contact%link = map%tail_index(map%link_force)
         allocate (contact%compliance(size(pairs%slave)), source=0.0_dp)
         contact%alone = [(contact%schur(contact%normal(k), contact%normal(k)), &
            k=1, size(pairs%slave))]
         do k = 1, size(pairs%slave)
            if (.not. ring(k)) cycle
            nodes = [pairs%slave(k), pairs%master(k)]
            contact%compliance(k) = ring_give/node_stiffness(mechanical%matrix, nodes, 2)
            contact%alone(k) = stiffness_alone(contact%alone(k), mechanical%matrix, nodes, 2)
         end do
      end associate
   end subroutine set_rings

end module contact_reduction
