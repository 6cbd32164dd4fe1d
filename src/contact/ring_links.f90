!> Links that let pairs form rings.
!>
!> The pairs tie their nodes into trees (equation_map). A pair that would close a ring has a twin
!> of its slave node instead, which nothing else is tied to, and the twin is held to the slave by an
!> unknown force, a Lagrange multiplier mu: rows g u = 0, columns g^T mu. Both are scaled by the
!> stiffness k of the bodies at the pair's nodes, so that k mu is the force and mu compares with
!> displacements.
!>
!> Pairs of a ring that all stick share their friction in a way that statics leaves open, and their
!> relations depend on each other. They therefore give by a small part of what the bodies give.
module ring_links
   use kinds, only: dp
   use sparse_matrix, only: sparse_matrix_type, triplet_list_type
   implicit none
   private
   public :: ring_link_type, node_stiffness, stiffness_alone, ring_give
   public :: add_links, link_entries, support_forces

   !> Part of the bodies' compliance at its nodes by which a stuck pair of a ring gives.
   real(dp), parameter :: ring_give = 1.0e-8_dp

   !> Part of the bodies' stiffness at its nodes below which a pair's own is rounding.
   real(dp), parameter :: held_by_others = 1.0e-6_dp

   !> One component of a link: its elongation is coefficient*unknowns + given(base(1)) -
   !> given(base(2)), a base of 0 counting as zero.
   type :: ring_link_type
      integer :: nodes(2) = 0                  !! slave and master of the pair
      integer :: force = 0                     !! the unknown mu
      integer :: base(2) = 0                   !! degrees of freedom with prescribed values, or 0
      integer, allocatable :: term(:)          !! (n) unknowns
      real(dp), allocatable :: coefficient(:)  !! (n) their coefficients
      real(dp) :: stiffness = 1.0_dp           !! k, in the unit of the matrix
   end type ring_link_type

contains

   !> Stiffness of the bodies at two nodes: the smaller one's largest diagonal entry.
   pure function node_stiffness(matrix, nodes, components) result(stiffness)
      type(sparse_matrix_type), intent(in) :: matrix      !! (dofs, dofs) of the bodies
      integer, intent(in) :: nodes(2)                     !! the nodes
      integer, intent(in) :: components                   !! degrees of freedom of a node
      real(dp) :: stiffness                               !! in the unit of the matrix
      real(dp) :: at_node(2)
      integer :: k, n, row

      at_node = 0.0_dp
      do n = 1, 2
         do row = components*(nodes(n) - 1) + 1, components*nodes(n)
            do k = matrix%row_start(row), matrix%row_start(row + 1) - 1
               if (matrix%column(k) == row) at_node(n) = max(at_node(n), matrix%value(k))
            end do
         end do
      end do
      stiffness = minval(at_node)
   end function node_stiffness

   !> Stiffness, or conductance, of a pair of a ring alone. That of the pair that closes the ring,
   !> which only the others hold, is the bodies' at its nodes.
   pure function stiffness_alone(own, matrix, nodes, components) result(stiffness)
      real(dp), intent(in) :: own                         !! diagonal entry on the tail
      type(sparse_matrix_type), intent(in) :: matrix      !! (dofs, dofs) of the bodies
      integer, intent(in) :: nodes(2)                     !! slave and master
      integer, intent(in) :: components                   !! degrees of freedom of a node
      real(dp) :: stiffness                               !! in the unit of the matrix

      stiffness = node_stiffness(matrix, nodes, components)
      if (own >= held_by_others*stiffness) stiffness = own
   end function stiffness_alone

   !> Entries that the links have in the lower triangle.
   pure integer function link_entries(links)
      type(ring_link_type), intent(in) :: links(:)        !! the links
      integer :: i

      link_entries = 0
      do i = 1, size(links)
         link_entries = link_entries + max(size(links(i)%term), 1)
      end do
   end function link_entries

   !> Adds the links to the lower triangle of the matrix on the unknowns.
   pure subroutine add_links(links, list)
      type(ring_link_type), intent(in) :: links(:)        !! the links
      type(triplet_list_type), intent(inout) :: list      !! has room for link_entries
      integer :: i, t

      do i = 1, size(links)
         associate (link => links(i))
            do t = 1, size(link%term)
               call list%add(max(link%force, link%term(t)), min(link%force, link%term(t)), &
                  link%stiffness*link%coefficient(t))
            end do
            ! Between prescribed values there is nothing to hold: the force is a number of its own.
            if (size(link%term) == 0) call list%add(link%force, link%force, -link%stiffness)
         end associate
      end do
   end subroutine add_links

   !> Right-hand side of the links: what prescribed values stretch them by.
   pure subroutine support_forces(links, given, rhs)
      type(ring_link_type), intent(in) :: links(:)        !! the links
      real(dp), intent(in) :: given(:)                    !! (dofs) prescribed values
      real(dp), intent(inout) :: rhs(:)                   !! (equations) set in the links' rows
      integer :: i

      do i = 1, size(links)
         associate (link => links(i))
            rhs(link%force) = 0.0_dp
            if (link%base(1) > 0) rhs(link%force) = -link%stiffness*given(link%base(1))
            if (link%base(2) > 0) rhs(link%force) = rhs(link%force) + &
               link%stiffness*given(link%base(2))
         end associate
      end do
   end subroutine support_forces

end module ring_links
