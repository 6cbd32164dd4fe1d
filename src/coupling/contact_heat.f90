!> L of section 2: from the conductance to the temperature jumps, eq. (3.4) on the tail, and how the
!> jumps follow the conductance.
module contact_heat
   use heat_reduction, only: heat_reduction_type
   use increment_data, only: increment_data_type, increment_workspace_type
   use kinds, only: dp
   use reduced_bodies, only: reduced_bodies_type
   use tail_factors, only: tail_flops
   use thermal_matrix, only: heat_across
   implicit none
   private
   public :: jump_derivatives_type, temperature_jumps, jump_derivatives, heat_by_omega

   !> How the unknowns of the tail follow the conductance of each contact point that carries heat.
   type :: jump_derivatives_type
      integer, allocatable :: active(:)        !! (n) the contact points
      real(dp), allocatable :: of_tail(:, :)   !! (tail, n)
      real(dp), allocatable :: heat(:)         !! (n) load of the tail per omega
   end type jump_derivatives_type

contains

   !> L: the jumps for a given conductance, eq. (3.4) on the tail. Only the columns from the first
   !> changed one on are factored again.
   subroutine temperature_jumps(bodies, heat, data, omega, workspace, jump)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_data_type), intent(in) :: data
      real(dp), intent(in) :: omega(:)                           !! (m) omega*
      type(increment_workspace_type), intent(inout) :: workspace !! heat in, factors out
      real(dp), intent(out) :: jump(:)                           !! (m) T_xi - T_eta [temperature]
      real(dp) :: x(bodies%thermal%map%tail), diagonal(bodies%thermal%map%tail)
      real(dp) :: of_point(size(omega)), history(size(omega))
      real(dp), allocatable :: of_cut(:)
      integer :: k

      associate (tail_index => bodies%jump_index, solver => heat%solver, &
         tail => workspace%tail, work => workspace%record%work)
         of_point = data%equation%contact_diagonal(omega)
         history = data%equation%contact_history(omega)
         x = workspace%heat%condensed
         diagonal = 0.0_dp
         do k = 1, size(omega)
            if (tail_index(k) == 0) cycle
            diagonal(tail_index(k)) = of_point(k)
            x(tail_index(k)) = x(tail_index(k)) + history(k)
         end do
         if (allocated(workspace%cut%point)) then
            associate (j => tail_index(workspace%cut%point))
               diagonal(j) = [(solver%schur(j(k), j(k)), k=1, size(j))]
            end associate
         end if
         call tail%refactor(solver%schur, diagonal)
         work%columns_again = work%columns_again + size(x) + 1 - tail%first_changed
         work%columns_full = work%columns_full + solver%order
         work%flops_again = work%flops_again + tail_flops(size(x), tail%first_changed)
         work%flops_full = work%flops_full + solver%full_flops + tail_flops(size(x), 1)
         if (allocated(workspace%cut%point)) then
            call solve_with_cuts(bodies, diagonal, workspace, x, of_cut)
         else
            call tail%solve(x)
         end if
         jump = data%held_jump
         do k = 1, size(omega)
            if (tail_index(k) > 0) jump(k) = x(tail_index(k))
         end do
         if (allocated(of_cut)) jump(workspace%cut%point) = of_cut
         workspace%on_tail = x
      end associate
   end subroutine temperature_jumps

   !> Solves on the tail where an edge cuts hats. Their jumps have the diagonal of the bodies in the
   !> factors; it is taken off again, and the heat of the cut hats put in its place.
   subroutine solve_with_cuts(bodies, diagonal, workspace, x, jump)
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: diagonal(:)                        !! (tail)
      type(increment_workspace_type), intent(inout) :: workspace
      real(dp), intent(inout) :: x(:)                            !! (tail) heat in, solution out
      real(dp), allocatable, intent(out) :: jump(:)              !! (cut hats)
      real(dp) :: sums(size(x), 2*size(workspace%cut%point)), given(size(workspace%cut%point))
      real(dp), dimension(size(given)) :: heat, back
      integer :: i, n, t

      n = size(given)
      sums = 0.0_dp
      given = 0.0_dp
      if (.not. allocated(workspace%supported)) workspace%supported = &
         bodies%thermal%map%supported(workspace%heat%given)
      associate (cut => workspace%cut, map => bodies%thermal%map)
         heat = heat_across(bodies%points%weight(cut%point), cut%conductance, 1.0_dp)
         back = -diagonal(bodies%jump_index(cut%point))
         do i = 1, n
            sums(bodies%jump_index(cut%point(i)), n + i) = 1.0_dp
            associate (nodes => cut%jump%values_of(i), share => cut%jump%coefficients_of(i))
               given(i) = dot_product(share, workspace%supported(nodes))
               do t = 1, size(nodes)
                  associate (k => map%tail_index(map%by_unknowns%values_of(nodes(t))), &
                     part => map%by_unknowns%coefficients_of(nodes(t)))
                     sums(k, i) = sums(k, i) + share(t)*part
                  end associate
               end do
            end associate
            x = x - heat(i)*given(i)*sums(:, i)
         end do
         call workspace%tail%add_sums(sums, [heat, back])
         call workspace%tail%solve(x)
         jump = matmul(x, sums(:, :n)) + given
      end associate
   end subroutine solve_with_cuts

   !> The derivatives by the conductance, with the factors of the last pass:
   !>
   !>    dtheta = -(S_T + diag(d))^-1 diag(weight (a3 theta + b3 theta_i)/a1) domega.
   subroutine jump_derivatives(bodies, data, workspace, jump, by_omega)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_data_type), intent(in) :: data
      type(increment_workspace_type), intent(in) :: workspace  !! as the last pass left it
      real(dp), intent(in) :: jump(:)                         !! (m) T_xi - T_eta [temperature]
      type(jump_derivatives_type), intent(out) :: by_omega
      real(dp) :: heat(size(jump))
      integer :: k

      heat = heat_by_omega(bodies, data, workspace, jump)
      by_omega%active = pack([(k, k=1, size(jump))], abs(heat) > 0.0_dp)
      by_omega%heat = heat(by_omega%active)
      allocate (by_omega%of_tail(bodies%thermal%map%tail, size(by_omega%active)), source=0.0_dp)
      do k = 1, size(by_omega%active)
         by_omega%of_tail(bodies%jump_index(by_omega%active(k)), k) = by_omega%heat(k)
      end do
      call workspace%tail%solve_columns(by_omega%of_tail)
   end subroutine jump_derivatives

   !> Load of the tail per conductance of each contact point, 0 where it has no jump.
   pure function heat_by_omega(bodies, data, workspace, jump) result(heat)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_data_type), intent(in) :: data
      type(increment_workspace_type), intent(in) :: workspace  !! as the last pass left it
      real(dp), intent(in) :: jump(:)                         !! (m) T_xi - T_eta [temperature]
      real(dp) :: heat(size(jump))                            !! (m)

      heat = -data%equation%crossing_by_omega(jump)
      if (allocated(workspace%cut%point)) heat(workspace%cut%point) = heat(workspace%cut%point)* &
         workspace%cut%own
      where (bodies%jump_index == 0) heat = 0.0_dp
   end function heat_by_omega

end module contact_heat
