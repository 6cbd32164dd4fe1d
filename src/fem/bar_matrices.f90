!> The stiffness of springs and trusses, and the forces that temperatures exert on them, as those of
!> the bodies in `stiffness_matrix`.
module bar_matrices
   use model, only: bar_type
   use kinds, only: dp
   use sparse_matrix, only: sparse_matrix_type, triplet_list_type
   implicit none
   private
   public :: bar_stiffness, bar_thermal_load

contains

   !> Nodal forces a k a^T per nodal displacement, a being the terms of the elongation.
   pure function bar_stiffness(bars, nodes) result(stiffness)
      type(bar_type), intent(in) :: bars(:)
      integer, intent(in) :: nodes                     !! number of nodes
      type(sparse_matrix_type) :: stiffness            !! (2 nodes, 2 nodes) [force/length]
      type(triplet_list_type) :: list
      integer :: i, j, k

      call list%reserve(sum([(size(bars(k)%elongation%node)**2, k=1, size(bars))]))
      do k = 1, size(bars)
         associate (a => bars(k)%elongation)
            do i = 1, size(a%node)
               do j = 1, size(a%node)
                  call list%add(2*(a%node(i) - 1) + a%dof(i), 2*(a%node(j) - 1) + a%dof(j), &
                     bars(k)%stiffness*a%coefficient(i)*a%coefficient(j))
               end do
            end do
         end associate
      end do
      stiffness = list%compress(2*nodes, 2*nodes)
   end function bar_stiffness

   !> Nodal forces per nodal temperature over the natural state.
   pure function bar_thermal_load(bars, nodes) result(load)
      type(bar_type), intent(in) :: bars(:)
      integer, intent(in) :: nodes                     !! number of nodes
      type(sparse_matrix_type) :: load                 !! (2 nodes, nodes) [force/temperature]
      type(triplet_list_type) :: list
      integer :: entries, i, j, k

      entries = 0
      do k = 1, size(bars)
         if (allocated(bars(k)%mean%node)) entries = entries + size(bars(k)%elongation%node)* &
            size(bars(k)%mean%node)
      end do
      call list%reserve(entries)
      do k = 1, size(bars)
         if (.not. allocated(bars(k)%mean%node)) cycle
         associate (a => bars(k)%elongation, mean => bars(k)%mean)
            do i = 1, size(a%node)
               do j = 1, size(mean%node)
                  call list%add(2*(a%node(i) - 1) + a%dof(i), mean%node(j), &
                     bars(k)%warm_force*a%coefficient(i)*mean%coefficient(j))
               end do
            end do
         end associate
      end do
      load = list%compress(2*nodes, nodes)
   end function bar_thermal_load

end module bar_matrices
