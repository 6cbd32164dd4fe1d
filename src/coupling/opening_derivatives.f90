!> The derivative of the contact operator of section 2, point by point on the reduced system: how
!> the openings of the contact points follow their conductances.
!>
!> The jumps follow them by contact_heat, from (3.4) on the tail, (S_T + diag(d)) theta = Q_c -
!> history with d = weight (a2 omega_i + a3 omega)/a1; the condensed load follows by J dtheta, gaps
!> and forces by the contact system with the conditions that hold.
module opening_derivatives
   use conductance_graph, only: conductance_graph_type
   use contact_heat, only: jump_derivatives_type
   use contact_operator, only: law_pressure
   use contact_states, only: contact_state_type, contact_open
   use closing_instant, only: contact_response, make_tangent
   use contact_workspace, only: contact_workspace_type
   use dense, only: product_of
   use heat_reduction, only: heat_reduction_type
   use increment_data, only: increment_workspace_type
   use kinds, only: dp
   use reduced_bodies, only: reduced_bodies_type
   use temperature_laws, only: law_jumps
   implicit none
   private
   public :: make_graph, openings, opening_derivative, opening_changes

   !> Smallest stiffness of a contact point, of the largest one, that scales its overlap: a contact
   !> point alone that holds a body has none.
   real(dp), parameter :: least_stiffness = 1.0e-6_dp

contains

   !> Graphs of the conductance of all contact points.
   pure function make_graph(bodies, heat, length) result(graph)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      real(dp), intent(in) :: length                          !! of a rest, > 0 [length]
      type(conductance_graph_type), allocatable :: graph(:)   !! (m)
      real(dp) :: stiffness(size(bodies%points%weight)), weight(size(bodies%points%weight))
      real(dp), allocatable :: conductor(:)
      integer :: k

      allocate (graph(size(weight)))
      weight = bodies%points%weight
      where (weight <= 0.0_dp) weight = maxval(weight)
      do k = 1, size(weight)
         stiffness(k) = bodies%equilibrium%contact%alone(k)
         graph(k)%law = bodies%laws%conductance(k)
      end do
      stiffness = max(stiffness, least_stiffness*maxval(stiffness))
      where (stiffness <= 0.0_dp) stiffness = 1.0_dp
      graph%modulus = stiffness/weight
      if (.not. any([(law_jumps(graph(k)%law), k=1, size(graph))])) return
      conductor = heat%conductors(bodies)
      do k = 1, size(weight)
         if (bodies%points%weight(k) <= 0.0_dp .or. bodies%jump_index(k) == 0) cycle
         if (.not. law_jumps(graph(k)%law)) cycle
         graph(k)%width = length
         graph(k)%body = conductor(k)/weight(k)
      end do
   end function make_graph

   !> Openings of the contact points: gaps, or pressures as overlaps.
   pure function openings(bodies, graph, state) result(opening)
      type(reduced_bodies_type), intent(in) :: bodies
      type(conductance_graph_type), intent(in) :: graph(:)    !! (m) graphs of the conductance
      type(contact_state_type), intent(in) :: state
      real(dp) :: opening(size(graph))                        !! (m) [length]

      opening = -law_pressure(bodies, state)/graph%modulus
      where (state%contact_state == contact_open) opening = max(state%gap, 0.0_dp)
   end function openings

   !> Derivative of the openings by the conductances, for the state that the last pass found;
   !> unallocated where it does not exist. Contact points of weight 0 carry no heat: their rows stay
   !> 0.
   subroutine opening_derivative(bodies, heat, workspace, by_omega, state, derivative, body)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_workspace_type), intent(in) :: workspace  !! as the last pass left it
      type(jump_derivatives_type), intent(in) :: by_omega     !! of the last pass
      type(contact_state_type), intent(in) :: state
      real(dp), allocatable, intent(out) :: derivative(:, :)  !! (m, m)
      !> (m) conductance that the bodies put in series with each contact point, 1 where that means
      !> nothing
      real(dp), allocatable, intent(out) :: body(:)
      type(contact_workspace_type) :: tangent
      real(dp), allocatable :: change(:, :)
      integer :: k, m, n
      logical :: sound

      m = size(state%contact_state)
      allocate (derivative(m, m), source=0.0_dp)
      allocate (body(m), source=1.0_dp)
      n = size(by_omega%active)
      if (n == 0) return
      associate (tail_index => bodies%jump_index, active => by_omega%active)
         do k = 1, n
            associate (j => active(k))
               body(j) = (by_omega%heat(k)/by_omega%of_tail(tail_index(j), k) - &
                  workspace%tail%diagonal(tail_index(j)))/bodies%points%weight(j)
            end associate
         end do
         where (body <= 0.0_dp) body = 1.0_dp
         call make_tangent(bodies%equilibrium%contact, workspace%contact, state, tangent, sound)
         if (sound) then
            allocate (change(m, n))
            call opening_changes(bodies, heat, workspace%pass%graph, tangent, state, &
               by_omega%of_tail, change)
            derivative(:, active) = change
         else
            deallocate (derivative)
         end if
      end associate
   end subroutine opening_derivative

   !> Changes of the openings with the unknowns of the thermal tail.
   pure subroutine opening_changes(bodies, heat, graph, tangent, state, of_tail, change)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(conductance_graph_type), intent(in) :: graph(:)    !! (m) graphs of the conductance
      type(contact_workspace_type), intent(in) :: tangent     !! of the state, by make_tangent
      type(contact_state_type), intent(in) :: state
      real(dp), intent(in) :: of_tail(:, :)                   !! (thermal tail, n)
      real(dp), intent(out) :: change(:, :)                   !! (m, n) [length]
      real(dp), dimension(size(change, 1), size(change, 2)) :: gap, force
      integer :: k

      call contact_response(bodies%equilibrium%contact, tangent, state, &
         product_of(heat%jump_load, of_tail), gap, force)
      change = 0.0_dp
      associate (weight => bodies%points%weight)
         do k = 1, size(graph)
            if (weight(k) <= 0.0_dp) cycle
            if (state%contact_state(k) == contact_open) then
               change(k, :) = gap(k, :)
            else
               change(k, :) = -force(k, :)/(weight(k)*graph(k)%modulus)
            end if
         end do
      end associate
   end subroutine opening_changes

end module opening_derivatives
