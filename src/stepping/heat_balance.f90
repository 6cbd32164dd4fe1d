!> Heat balances of an increment: of the discrete equation (3.4), and of the states at its ends.
module heat_balance
   use balances, only: imbalance
   use cut_hats, only: cut_hats_type, joined_conductance, supplied_heat
   use increment_data, only: increment_data_type
   use kinds, only: dp
   use loads, only: loads_type
   use model, only: model_type
   use records, only: increment_record_type
   use reduced_bodies, only: reduced_bodies_type
   use solution_state, only: solution_state_type
   use text, only: to_text
   use thermal_matrix, only: heat_across, heat_equation_type, heat_rates_type
   implicit none
   private
   public :: balance_heat, sound_imbalance

   !> Part of K T below which a rate is no scale to measure by: only rounding is left of it. The sum
   !> over a body collects that of all nodes, for which the norm of T is.
   real(dp), parameter :: noise = 1.0e-6_dp

   !> Largest imbalance at the end of an increment of which nothing is said.
   real(dp), parameter :: sound_imbalance = 1.0e-2_dp

   !> Largest imbalance at the start of an increment that counts as none.
   real(dp), parameter :: equilibrium = 1.0e-6_dp

contains

   !> Heat that enters by loads and prescribed temperatures, and both balances of heat. Warns where
   !> heat starts or ends out of balance.
   pure subroutine balance_heat(bodies, model, loads, data, next, record)
      type(reduced_bodies_type), intent(in) :: bodies
      type(model_type), intent(in) :: model
      type(loads_type), intent(in) :: loads                   !! loads at the end of the increment
      type(increment_data_type), intent(in) :: data           !! its start
      type(solution_state_type), intent(in) :: next           !! state at its end
      type(increment_record_type), intent(inout) :: record    !! receives rates and balances
      type(heat_rates_type) :: rates
      real(dp), allocatable :: residual(:)
      real(dp) :: omega(size(next%omega)), scale

      omega = joined_conductance(next%omega, next%cut)
      rates%conducted = bodies%thermal%matrix%multiply(next%temperature)
      rates%entering = next%sources%net_heat(next%temperature)
      rates%crossing = heat_across(bodies%points%weight, next%carrying, next%jump)
      residual = supplied_heat(bodies, next%cut, rates)
      call sum_rates(loads, next%temperature, residual, record)
      associate (held => loads%temperature%active, body => model%mesh%node_body)
         scale = max(record%heat_in, record%heat_out, abs(sum(rates%crossing)), &
            maxval(abs(residual), mask=held), maxval(abs(rates%entering)), &
            noise*bodies%thermal%largest_entry*norm2(next%temperature), tiny(1.0_dp))
         record%fields%reaction_heat = merge(residual, 0.0_dp, held)
         record%fields%external_heat = record%fields%reaction_heat + rates%entering
         rates%crossing = heat_across(bodies%points%weight, omega, next%jump)
         record%heat_imbalance_pointwise = imbalance(rates%conducted, &
            supplied_heat(bodies, next%cut, rates), held, body, [.true.], scale)
         rates = data%equation%rates(bodies%thermal%matrix, next%temperature, omega, next%jump)
         record%heat_imbalance = imbalance(rates%conducted, supplied_heat(bodies, next%cut, &
            rates), held, body, [.true.], scale)
         call warn_of_imbalances(bodies, held, data, next%is_out_of_balance, record)
      end associate
   end subroutine balance_heat

   !> Warns where heat starts out of equilibrium, (K + G) T /= Q, with a scheme that never damps
   !> that; else where the scheme leaves heat out of balance at the end of the increment, once for
   !> as long as it stays so.
   pure subroutine warn_of_imbalances(bodies, held, data, was_out, record)
      type(reduced_bodies_type), intent(in) :: bodies
      logical, intent(in) :: held(:)                          !! (nodes) prescribed temperatures
      type(increment_data_type), intent(in) :: data
      logical, intent(in) :: was_out                          !! whether the last increment was
      type(increment_record_type), intent(inout) :: record
      real(dp) :: at_start

      at_start = 0.0_dp
      if (data%equation%never_damps() .and. .not. data%kept_imbalance) at_start = &
         start_imbalance(bodies, held, data%equation)
      if (at_start > equilibrium) then
         call record%warn('heat starts out of equilibrium, (K + G) T - Q is ', at_start, &
            ' of the largest rate; the scheme of (3.4), amplification '// &
            to_text(data%equation%amplification())// &
            ', never damps that (*THERMAL SCHEME, TYPE=IMPLICIT does)')
      else if (.not. was_out .and. record%heat_imbalance_pointwise > sound_imbalance) then
         call record%warn('at its end heat is out of balance by ', &
            100.0_dp*record%heat_imbalance_pointwise, ' % of the largest rate '// &
            '(heat_imbalance_pointwise), left by the scheme '//trim(data%equation%scheme%name)// &
            '; *THERMAL SCHEME, TYPE=IMPLICIT leaves none')
      end if
   end subroutine warn_of_imbalances

   !> Largest residual of (K + G) T - Q in any row that is not prescribed, at the start of an
   !> increment, relative to the largest rate.
   pure real(dp) function start_imbalance(bodies, held, equation) result(relative)
      type(reduced_bodies_type), intent(in) :: bodies
      logical, intent(in) :: held(:)
      type(heat_equation_type), intent(in) :: equation
      type(heat_rates_type) :: rates
      real(dp) :: scale

      rates = equation%rates_at_start(bodies%thermal%matrix)
      scale = max(maxval(abs(rates%conducted)), maxval(abs(equation%old%load)), &
         maxval([0.0_dp, abs(rates%crossing)]), noise*bodies%thermal%largest_entry* &
         maxval(abs(equation%temperature_old)), tiny(1.0_dp))
      relative = maxval([0.0_dp, pack(abs(supplied_heat(bodies, cut_hats_type(), rates)), &
         .not. held)])/scale
   end function start_imbalance

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
