!> What the derivative U' of the contact operator of section 2 says of a solution omega = U(omega):
!> the gain of the coupling, and whether the solution is one of several.
module coupling_gains
   use arnoldi, only: arnoldi_type
   use conductance_graph, only: conductance_graph_type
   use contact_heat, only: heat_by_omega
   use closing_instant, only: make_tangent
   use contact_workspace, only: contact_workspace_type
   use dense, only: lu_type
   use gap_temperatures, only: changes_by_temperature
   use heat_reduction, only: heat_reduction_type
   use increment_data, only: increment_data_type, increment_workspace_type
   use kinds, only: dp
   use opening_derivatives, only: opening_changes
   use reduced_bodies, only: reduced_bodies_type
   use solution_state, only: solution_state_type
   implicit none
   private
   public :: find_gains, is_one_of_several

   real(dp), parameter :: no_gain = 1.0e-6_dp      !! a largest real gain that is none beside 1
   real(dp), parameter :: least_part = 1.0e-12_dp  !! of the largest factor, that counts in scales

contains

   !> The gains of a solution: eigenvalues of U', of which only the outer ones are found. The
   !> conductance of a contact point that rests is no variable of U'.
   !>
   !> Laws and jumps make rows and columns of U' differ by orders of magnitude. The method works on
   !> a similar matrix without that, which is nearly normal: its eigenvalues are as sharp as their
   !> residuals.
   subroutine find_gains(bodies, heat, data, workspace, solution, gains)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_data_type), intent(in) :: data
      type(increment_workspace_type), intent(in) :: workspace  !! as the last pass left it
      type(solution_state_type), intent(in) :: solution        !! that the last pass found
      type(arnoldi_type), intent(out) :: gains                 !! none found where U' does not exist
      type(contact_workspace_type) :: tangent
      real(dp), dimension(size(solution%jump)) :: coordinate, rate, scale, slope
      real(dp), allocatable :: change(:, :), of_tail(:, :)
      integer, allocatable :: free(:)
      integer :: k
      logical :: sound

      free = pack([(k, k=1, size(rate))], .not. solution%resting)
      if (size(free) == 0) return
      call make_tangent(bodies%equilibrium%contact, workspace%contact, solution%contact, tangent, &
         sound)
      if (.not. sound) return
      associate (graph => workspace%pass%graph, index => bodies%jump_index)
         coordinate = graph%coordinate_of_opening(workspace%pass%opening)
         slope = graph%derivative(coordinate)
         rate = heat_by_omega(bodies, data, workspace, solution%jump)
         scale = sqrt(of_largest(slope)/of_largest(rate))
         allocate (of_tail(bodies%thermal%map%tail, 1), change(size(rate), 1))
         call gains%begin(size(free), no_gain)
         do while (gains%wants_product)
            of_tail = 0.0_dp
            do k = 1, size(free)
               if (index(free(k)) > 0) of_tail(index(free(k)), 1) = rate(free(k))*scale(free(k))* &
                  gains%vector(k)
            end do
            call workspace%tail%solve_columns(of_tail)
            call opening_changes(bodies, heat, graph, tangent, solution%contact, of_tail, change)
            change(:, 1) = slope*change(:, 1)
            if (bodies%points%vary_with_temperature()) change = change + &
               changes_by_temperature(bodies, heat, workspace, coordinate, of_tail)
            call gains%take(change(free, 1)/scale(free))
         end do
      end associate
   end subroutine find_gains

   !> Moduli in the largest one, none of them 0.
   pure function of_largest(values) result(part)
      real(dp), intent(in) :: values(:)
      real(dp) :: part(size(values))

      part = max(abs(values)/max(maxval(abs(values)), tiny(1.0_dp)), least_part)
   end function of_largest

   !> Whether det(I - U') < 0. The degree of I - U over all solutions is 1, as U is bounded: then
   !> there are at least two others. The conductance of a contact point that rests is that of a law
   !> which is all but vertical there.
   pure logical function is_one_of_several(graph, opening, derivative, resting, by_temperature)
      type(conductance_graph_type), intent(in) :: graph(:)  !! (m) graphs of the conductance
      real(dp), intent(in) :: opening(:)                    !! (m) openings [length]
      !> (m, m) derivative of the openings by the conductances
      real(dp), intent(in) :: derivative(:, :)
      logical, intent(in) :: resting(:)                     !! (m) contact points that rest
      !> (m, m) derivative of the conductances by each other at constant openings, by way of the
      !> temperatures; absent where no law varies with these
      real(dp), intent(in), optional :: by_temperature(:, :)
      real(dp) :: matrix(size(opening), size(opening))
      type(lu_type) :: lu
      logical :: singular
      integer :: k

      do k = 1, size(opening)
         if (resting(k)) then
            matrix(k, :) = -sign(1.0_dp, graph(k)%derivative(-0.5_dp*graph(k)%width))* &
               derivative(k, :)
         else
            matrix(k, :) = -graph(k)%derivative(graph(k)%coordinate_of_opening(opening(k)))* &
               derivative(k, :)
            if (present(by_temperature)) matrix(k, :) = matrix(k, :) - by_temperature(k, :)
            matrix(k, k) = matrix(k, k) + 1.0_dp
         end if
      end do
      call lu%factor(matrix, singular)
      is_one_of_several = .not. singular
      if (is_one_of_several) is_one_of_several = lu%negative_determinant()
   end function is_one_of_several

end module coupling_gains
