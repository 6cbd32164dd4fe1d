!> How far from equilibrium heat starts, which some schemes of (3.4) keep for ever.
module scheme_start
   use cut_hats, only: cut_hats_type, supplied_heat
   use films, only: net_heat
   use increment_data, only: increment_data_type
   use kinds, only: dp
   use loads, only: loads_type
   use reduced_bodies, only: reduced_bodies_type
   use scheme_properties, only: amplification
   use solution_report, only: solution_report_type
   use solution_state, only: solution_state_type
   use text, only: to_text
   implicit none
   private
   public :: warn_of_imbalance

   real(dp), parameter :: undamped = 1.0_dp - 1.0e-9_dp   !! amplification of which this is warned
   real(dp), parameter :: equilibrium = 1.0e-6_dp         !! largest imbalance that counts as none
   real(dp), parameter :: noise = 1.0e-6_dp !! part of K T below which a rate is no scale

contains

   !> Warns where heat starts out of equilibrium, (K + G) T /= Q, with a scheme that never damps
   !> that, and notes in the state whether the scheme is such a one.
   subroutine warn_of_imbalance(bodies, loads, data, previous, next, record)
      type(reduced_bodies_type), intent(in) :: bodies
      type(loads_type), intent(in) :: loads                   !! loads of the increment
      type(increment_data_type), intent(in) :: data           !! scheme, conductance, jumps
      type(solution_state_type), intent(in) :: previous       !! state at the start
      type(solution_state_type), intent(inout) :: next        !! state at the end
      type(solution_report_type), intent(inout) :: record    !! receives the warning
      real(dp) :: factor, imbalance

      factor = amplification(data%scheme)
      next%keeps_imbalance = abs(factor) >= undamped
      if (.not. next%keeps_imbalance .or. previous%keeps_imbalance) return
      imbalance = start_imbalance(bodies, loads%temperature%active, data, previous)
      if (imbalance <= equilibrium) return
      next%is_out_of_balance = .true.
      call record%warn('heat starts out of equilibrium, (K + G) T - Q is ', imbalance, &
         ' of the largest rate; the scheme of (3.4), amplification '//to_text(factor)// &
         ', never damps that (*THERMAL SCHEME, TYPE=IMPLICIT does)')
   end subroutine warn_of_imbalance

   !> Largest residual of (K + G) T - Q in any row that is not prescribed, at the start of an
   !> increment, relative to the largest rate.
   pure function start_imbalance(bodies, held, data, previous) result(relative)
      type(reduced_bodies_type), intent(in) :: bodies
      logical, intent(in) :: held(:)
      type(increment_data_type), intent(in) :: data
      type(solution_state_type), intent(in) :: previous
      real(dp) :: relative
      real(dp) :: conducted(size(held)), residual(size(held)), contact_heat(size(data%omega_old))
      real(dp) :: scale

      conducted = bodies%thermal%matrix%multiply(previous%temperature)
      contact_heat = bodies%points%weight*data%omega_old*data%jump_old
      residual = supplied_heat(bodies, cut_hats_type(), conducted, net_heat(previous%heat_load, &
         previous%film, previous%temperature), contact_heat)
      scale = max(maxval(abs(conducted)), maxval(abs(previous%heat_load)), &
         maxval([0.0_dp, abs(contact_heat)]), noise*bodies%thermal%largest_entry* &
         maxval(abs(previous%temperature)), tiny(1.0_dp))
      relative = maxval([0.0_dp, pack(abs(residual), .not. held)])/scale
   end function start_imbalance

end module scheme_start
