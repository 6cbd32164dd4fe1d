!> Condensed mechanical loads of unit temperature jumps at the contact points, by elimination.
!>
!> A unit temperature jump at a contact point has a condensed mechanical load: what (3.4) and (2.4)
!> say of each other on the contact unknowns. With heat K_T T = q, equilibrium K_u u = f + B T, and
!> l and t for leading and tail unknowns, the load is (B R)_t - K_u,tl K_u,ll^-1 (B R)_l, where R
!> are the temperatures of unit jumps. It is also the block between both fields of the Schur
!> complement, on both tails, of
!>
!>    [ K_T  B^T ]
!>    [ B    K_u ]
!>
!> for a B so small that its square is none beside K_T and K_u. A solver that is better at many
!> unknowns than at many right-hand sides takes that way; others take R (heat_reduction).
module jump_loads
   use errors, only: error_type
   use field_problem, only: field_problem_type
   use kinds, only: dp
   use mumps_solver, only: schur_complement
   use ordering, only: adjacency, nested_dissection
   use sparse_matrix, only: linear_combination, sparse_matrix_type, triplet_list_type
   implicit none
   private
   public :: loads_by_elimination

   !> Factor of B, a power of the base: the digits of the loads stay, their squares vanish.
   real(dp), parameter :: small = 2.0_dp**(-200)

contains

   !> The loads from one elimination of both fields, by MUMPS.
   !> Errors: as schur_complement; METIS fails.
   subroutine loads_by_elimination(thermal, film, mechanical, thermal_load, node_rank, loads, error)
      type(field_problem_type), intent(in) :: thermal            !! numbered
      type(sparse_matrix_type), intent(in) :: film               !! added to its matrix
      type(field_problem_type), intent(in) :: mechanical         !! numbered
      type(sparse_matrix_type), intent(in) :: thermal_load !! B, forces per nodal temperature
      !> (nodes) in nested dissection, of both fields as numbered; made where it is not allocated
      integer, allocatable, intent(inout) :: node_rank(:)
      real(dp), allocatable, intent(out) :: loads(:, :)    !! (mechanical tail, thermal tail)
      type(error_type), allocatable, intent(out) :: error
      type(triplet_list_type) :: entries
      type(sparse_matrix_type) :: graph
      real(dp), allocatable :: schur(:, :)
      integer, allocatable :: node(:)

      call join_fields(thermal, film, mechanical, thermal_load, entries, graph, node)
      if (.not. allocated(node_rank)) then
         call nested_dissection(graph, node_rank, error)
         if (allocated(error)) return
      end if
      associate (heat => thermal%map%tail, motion => mechanical%map%tail)
         call schur_complement(entries, node_rank(node), heat + motion, schur, error)
         if (allocated(error)) return
         loads = schur(heat + 1:, :heat)/small
      end associate
   end subroutine loads_by_elimination

   !> The matrix of both fields, and the nodes by which its leading unknowns are ordered.
   subroutine join_fields(thermal, film, mechanical, thermal_load, entries, graph, node)
      type(field_problem_type), intent(in) :: thermal, mechanical
      type(sparse_matrix_type), intent(in) :: film, thermal_load
      type(triplet_list_type), intent(out) :: entries    ! lower triangle
      type(sparse_matrix_type), intent(out) :: graph     ! (nodes, nodes) which of them are joined
      integer, allocatable, intent(out) :: node(:)       ! (leading unknowns) their nodes
      type(sparse_matrix_type) :: heat, motion, coupling, nothing
      integer, allocatable :: of_heat(:), of_motion(:)
      integer :: i

      heat = thermal%matrix_of_unknowns(film)
      motion = mechanical%matrix_of_unknowns(nothing)
      associate (h => thermal%map%equations, m => mechanical%map%equations)
         associate (h_leads => h - thermal%map%tail, m_leads => m - mechanical%map%tail)
            node = [thermal%map%leading_nodes(), mechanical%map%leading_nodes()]
            graph = linear_combination(1.0_dp, adjacency(heat, node(:h_leads)), &
               1.0_dp, adjacency(motion, node(h_leads + 1:)))
            of_heat = [(i, i=1, h_leads), (m_leads + i, i=h_leads + 1, h)]
            of_motion = [(h_leads + i, i=1, m_leads), (h + i, i=m_leads + 1, m)]
         end associate
      end associate
      coupling = mechanical%map%between(thermal_load, thermal%map)
      call entries%reserve(size(heat%value) + size(motion%value) + size(coupling%value))
      call add_block(heat, of_heat, of_heat, 1.0_dp, entries)
      deallocate (heat%value, heat%column)
      call add_block(motion, of_motion, of_motion, 1.0_dp, entries)
      deallocate (motion%value, motion%column)
      call add_block(coupling, of_motion, of_heat, small, entries)
   end subroutine join_fields

   !> Adds a block, its rows and columns renumbered, below the diagonal.
   pure subroutine add_block(block, rows, columns, factor, entries)
      type(sparse_matrix_type), intent(in) :: block
      integer, intent(in) :: rows(:), columns(:)
      real(dp), intent(in) :: factor
      type(triplet_list_type), intent(inout) :: entries
      integer :: i, k

      do i = 1, block%row_count
         do k = block%row_start(i), block%row_start(i + 1) - 1
            associate (j => columns(block%column(k)))
               call entries%add(max(rows(i), j), min(rows(i), j), factor*block%value(k))
            end associate
         end do
      end do
   end subroutine add_block

end module jump_loads
