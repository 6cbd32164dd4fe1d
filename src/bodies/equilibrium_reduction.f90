!> Equilibrium reduced to the contact points: factors, and the contact system from their Schur
!> complement.
module equilibrium_reduction
   use contact_constraints, only: in_cycle, cycle_compliance, stiffness_alone
   use contact_system, only: contact_system_type
   use dense, only: column_space
   use errors, only: error_type
   use field_problem, only: field_problem_type, field_reduction_type
   use kinds, only: dp
   use linear_constraints, only: node_stiffness
   use sparse_matrix, only: sparse_matrix_type
   use all_contact_points, only: all_contact_points_type
   implicit none
   private

   !> Part of the bodies' stiffness at its nodes below which a contact point's is rounding.
   real(dp), parameter :: strainless = 1.0e-10_dp
   public :: equilibrium_reduction_type

   !> Equilibrium, (2.4), reduced for a set of supports.
   type, extends(field_reduction_type) :: equilibrium_reduction_type
      type(contact_system_type) :: contact                !! partial solution of (2.4)
   contains
      procedure :: reduce
   end type equilibrium_reduction_type

contains

   !> Factors the stiffness, and forms the contact system.
   !> Errors: unconstrained bodies, a failure of the solver.
   subroutine reduce(self, mechanical, points, rigid, solver_kind, node_rank, error)
      class(equilibrium_reduction_type), intent(inout) :: self
      type(field_problem_type), intent(in) :: mechanical  !! equilibrium, numbered
      type(all_contact_points_type), intent(in) :: points !! all contact points
      real(dp), intent(in) :: rigid(:, :) !! (2 nodes, motions) that the supports leave free
      integer, intent(in) :: solver_kind                  !! solver_skyline or solver_mumps
      !> (nodes) ranks in nested dissection, where they are known
      integer, allocatable, intent(in) :: node_rank(:)
      type(error_type), allocatable, intent(out) :: error

      call self%release()
      call self%factor(mechanical, sparse_matrix_type(), solver_kind, node_rank, error)
      if (allocated(error)) return
      call make_system(mechanical, points, rigid, self%solver%schur, self%contact)
   end subroutine reduce

   !> The contact system, nothing closed, from the mechanical Schur complement.
   pure subroutine make_system(mechanical, points, rigid, schur, contact)
      type(field_problem_type), intent(in) :: mechanical
      type(all_contact_points_type), intent(in) :: points
      real(dp), intent(in) :: rigid(:, :)
      real(dp), allocatable, intent(inout) :: schur(:, :)   ! becomes a part of the system
      type(contact_system_type), intent(out) :: contact
      integer :: m

      m = size(points%slave)
      allocate (contact%normal(m), contact%tangent(m))
      associate (map => mechanical%map)
         contact%normal(:) = map%tail_index(map%introduced(1::2))
         contact%tangent(:) = map%tail_index(map%introduced(2::2))
      end associate
      call move_alloc(schur, contact%schur)
      call set_motions(points, rigid, contact)
      call set_cycles(mechanical, points, contact)
   end subroutine make_system

   !> The rigid motions that the supports leave free, on the tail. In exact arithmetic they need no
   !> force; what S makes of them is rounding, and is taken from it.
   pure subroutine set_motions(points, rigid, contact)
      type(all_contact_points_type), intent(in) :: points
      real(dp), intent(in) :: rigid(:, :)
      type(contact_system_type), intent(inout) :: contact
      real(dp), allocatable :: forces(:, :)
      real(dp) :: relative(2, size(points%slave))
      integer :: i, k

      allocate (contact%rigid(size(contact%schur, 1), size(rigid, 2)), source=0.0_dp)
      do i = 1, size(rigid, 2)
         relative = points%relative(rigid(:, i))
         do k = 1, size(points%slave)
            contact%rigid(contact%normal(k), i) = dot_product(points%normal(:, k), relative(:, k))
            if (contact%tangent(k) > 0) contact%rigid(contact%tangent(k), i) = &
               dot_product(points%tangent(:, k), relative(:, k))
         end do
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

   !> The links of the cycles, the compliance of their stuck contact points, and what each contact
   !> point has for stiffness alone.
   pure subroutine set_cycles(mechanical, points, contact)
      type(field_problem_type), intent(in) :: mechanical
      type(all_contact_points_type), intent(in) :: points
      type(contact_system_type), intent(inout) :: contact
      integer :: k
      real(dp) :: own

      associate (map => mechanical%map, cyclic => in_cycle(mechanical%map, size(points%slave)))
         contact%link = map%tail_index(map%link_force)
         allocate (contact%compliance(size(points%slave)), source=0.0_dp)
         contact%alone = [(contact%schur(contact%normal(k), contact%normal(k)), &
            k=1, size(points%slave))]
         do k = 1, size(points%slave)
            associate (nodes => points%nodes_of(k))
               own = node_stiffness(mechanical%matrix, nodes, 2)
               if (.not. cyclic(k)) then
                  ! Two contact points that carry a body on their own move it without any strain.
                  if (contact%alone(k) <= strainless*own) contact%alone(k) = own
                  cycle
               end if
               contact%compliance(k) = cycle_compliance/own
               contact%alone(k) = stiffness_alone(contact%alone(k), mechanical%matrix, nodes, 2)
            end associate
         end do
      end associate
   end subroutine set_cycles

end module equilibrium_reduction
