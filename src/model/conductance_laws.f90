!> Contact conductance as a function of the gap and the pressure, eq. (1.8), with its derivatives.
module conductance_laws
   use kinds, only: dp
   implicit none
   private
   public :: conductance_law_type, law_none, law_gas, law_power
   public :: conductance, conductance_slope, law_jump

   integer, parameter :: law_none = 0   !! this side of the law was not given
   integer, parameter :: law_gas = 1    !! open: omega = A/(B + gamma)
   integer, parameter :: law_power = 2  !! closed: omega = C0 + C1 p^n

   !> The open and the closed law of one surface interaction.
   type :: conductance_law_type
      integer :: open_kind = law_none      !! law_none or law_gas
      integer :: closed_kind = law_none    !! law_none or law_power
      real(dp) :: gas_a = 0.0_dp           !! A [power/(length temperature)]
      real(dp) :: gas_b = 1.0_dp           !! B [length]
      real(dp) :: power_c0 = 0.0_dp        !! C0 [power/(length^2 temperature)]
      real(dp) :: power_c1 = 0.0_dp        !! C1 [C0/stress^n]
      real(dp) :: power_n = 1.0_dp         !! n [-]
   end type conductance_law_type

contains

   !> omega of a pair, eq. (1.8). A side that was not given: an open pair carries no heat, a closed
   !> pair has the open law's value at gamma = 0.
   pure function conductance(law, closed, gap, pressure) result(omega)
      type(conductance_law_type), intent(in) :: law !! the law
      logical, intent(in) :: closed                 !! whether the pair is closed
      real(dp), intent(in) :: gap                   !! gamma >= 0 [length]
      real(dp), intent(in) :: pressure              !! p >= 0 in compression [stress]
      real(dp) :: omega                             !! [power/(length^2 temperature)]

      if (closed .and. law%closed_kind == law_power) then
         omega = law%power_c0 + law%power_c1*max(pressure, 0.0_dp)**law%power_n
      else if (closed) then
         omega = open_law(law, 0.0_dp)
      else
         omega = open_law(law, max(gap, 0.0_dp))
      end if
   end function conductance

   !> Derivative of omega by the gap of an open pair or by the pressure of a closed one, eq. (1.8).
   pure function conductance_slope(law, closed, gap, pressure) result(slope)
      type(conductance_law_type), intent(in) :: law !! the law
      logical, intent(in) :: closed                 !! whether the pair is closed
      real(dp), intent(in) :: gap                   !! gamma >= 0 [length]
      real(dp), intent(in) :: pressure              !! p >= 0 in compression [stress]
      real(dp) :: slope                             !! d omega/d gamma or d omega/d p

      slope = 0.0_dp
      if (closed) then
         if (law%closed_kind == law_power .and. pressure > 0.0_dp) then
            slope = law%power_c1*law%power_n*pressure**(law%power_n - 1.0_dp)
         end if
      else if (law%open_kind == law_gas) then
         slope = -law%gas_a/(law%gas_b + max(gap, 0.0_dp))**2
      end if
   end function conductance_slope

   !> Jump of omega from the open to the closed side at gamma = p = 0; zero for a continuous law.
   pure function law_jump(law) result(jump)
      type(conductance_law_type), intent(in) :: law !! the law
      real(dp) :: jump                              !! closed value less open value

      jump = conductance(law, .true., 0.0_dp, 0.0_dp) - conductance(law, .false., 0.0_dp, 0.0_dp)
   end function law_jump

   pure function open_law(law, gap) result(omega)
      type(conductance_law_type), intent(in) :: law
      real(dp), intent(in) :: gap
      real(dp) :: omega

      omega = 0.0_dp
      if (law%open_kind == law_gas) omega = law%gas_a/(law%gas_b + gap)
   end function open_law

end module conductance_laws
