!> Heat balances of an increment: of the discrete equation (3.4), and of the state at its end.
module heat_balance
   use balances, only: imbalance, scheme_contact_heat
   use controls, only: thermal_scheme_type
   use films, only: net_heat, scheme_net_heat
   use kinds, only: dp
   use loads, only: loads_type
   use model, only: model_type
   use records, only: increment_record_type
   use reduced_bodies, only: reduced_bodies_type
   use cut_hats, only: joined_conductance, supplied_heat
   use solution_state, only: carrying_conductance, solution_state_type
   implicit none
   private
   public :: balance_heat, warn_of_heat, sound_imbalance

   !> Part of K T below which a rate is no scale to measure by: only rounding is left of it. The sum
   !> over a body collects that of all nodes, for which the norm of T is.
   real(dp), parameter :: noise = 1.0e-6_dp

   !> Largest imbalance at the end of an increment of which nothing is said.
   real(dp), parameter :: sound_imbalance = 1.0e-2_dp

contains

   !> Heat that enters by loads and prescribed temperatures, and both balances of heat.
   pure subroutine balance_heat(bodies, model, loads, scheme, previous, next, record)
      type(reduced_bodies_type), intent(in) :: bodies
      type(model_type), intent(in) :: model
      type(loads_type), intent(in) :: loads                   !! loads at the end of the increment
      type(thermal_scheme_type), intent(in) :: scheme         !! coefficients of (3.4)
      type(solution_state_type), intent(in) :: previous       !! state at the start
      type(solution_state_type), intent(in) :: next           !! state at the end
      type(increment_record_type), intent(inout) :: record    !! receives rates and balances
      real(dp), allocatable :: conducted(:), heat(:), residual(:), contact_heat(:)
      real(dp) :: omega(size(next%omega)), scale

      omega = joined_conductance(next%omega, next%cut)
      contact_heat = bodies%points%weight*carrying_conductance(next, scheme)*next%jump
      conducted = bodies%thermal%matrix%multiply(next%temperature)
      heat = net_heat(next%heat_load, next%film, next%temperature)
      residual = supplied_heat(bodies, next%cut, conducted, heat, contact_heat)
      call sum_rates(loads, next%temperature, residual, record)
      associate (held => loads%temperature%active, weight => bodies%points%weight, &
         body => model%mesh%node_body)
         scale = max(record%heat_in, record%heat_out, abs(sum(contact_heat)), &
            maxval(abs(residual), mask=held), maxval(abs(heat)), &
            noise*bodies%thermal%largest_entry*norm2(next%temperature), &
            tiny(1.0_dp))
         record%fields%reaction_heat = merge(residual, 0.0_dp, held)
         record%fields%external_heat = record%fields%reaction_heat + heat
         residual = supplied_heat(bodies, next%cut, conducted, heat, weight*omega*next%jump)
         record%heat_imbalance_pointwise = imbalance(conducted, residual, held, body, [.true.], &
            scale)
         associate (whole => scheme%a(1) + scheme%b(1))
            conducted = (scheme%a(1)*conducted + scheme%b(1)* &
               bodies%thermal%matrix%multiply(previous%temperature))/whole
            contact_heat = scheme_contact_heat(scheme, weight, next%omega_start, omega, &
               previous%jump, next%jump)/whole
            heat = scheme_net_heat(scheme, previous%heat_load, next%heat_load, previous%film, &
               next%film, previous%temperature, next%temperature)/whole
         end associate
         residual = supplied_heat(bodies, next%cut, conducted, heat, contact_heat)
         record%heat_imbalance = imbalance(conducted, residual, held, body, [.true.], &
            scale)
      end associate
   end subroutine balance_heat

   !> Warns where the scheme leaves heat out of balance at the end of the increment, once for as
   !> long as it stays so.
   pure subroutine warn_of_heat(scheme, next, record)
      type(thermal_scheme_type), intent(in) :: scheme         !! coefficients of (3.4)
      type(solution_state_type), intent(in) :: next           !! whether it was
      type(increment_record_type), intent(inout) :: record    !! receives the warning

      if (next%is_out_of_balance .or. record%heat_imbalance_pointwise <= sound_imbalance) return
      call record%warn('at its end heat is out of balance by ', &
         100.0_dp*record%heat_imbalance_pointwise, ' % of the largest rate '// &
         '(heat_imbalance_pointwise), left by the scheme '//trim(scheme%name)// &
         '; *THERMAL SCHEME, TYPE=IMPLICIT leaves none')
   end subroutine warn_of_heat

   !> Net rates, one per load card and per card of prescribed temperatures, summed by their sign.
   pure subroutine sum_rates(loads, temperature, residual, record)
      type(loads_type), intent(in) :: loads
      real(dp), intent(in) :: temperature(:)
      real(dp), intent(in) :: residual(:)
      type(increment_record_type), intent(inout) :: record
      real(dp) :: net(0:maxval(loads%temperature%card))
      real(dp), allocatable :: rates(:)
      integer :: i

      net = 0.0_dp
      do i = 1, size(residual)
         if (.not. loads%temperature%active(i)) cycle
         associate (rate => net(loads%temperature%card(i)))
            rate = rate + residual(i)
         end associate
      end do
      rates = [net, loads%card_heat(temperature)]
      record%heat_in = sum(rates, mask=rates > 0.0_dp)
      record%heat_out = -sum(rates, mask=rates < 0.0_dp)
   end subroutine sum_rates

end module heat_balance
