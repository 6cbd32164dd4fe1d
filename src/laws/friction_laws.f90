!> Coulomb's law with a largest shear: which friction a pressure allows.
module friction_laws
   use kinds, only: dp
   implicit none
   private
   public :: friction_law_type, friction_bound, rough_coefficient, unlimited

   !> Coefficient of a rough interface: no shear that a million times the pressure could hold slips.
   real(dp), parameter :: rough_coefficient = 1.0e6_dp
   real(dp), parameter :: unlimited = huge(1.0_dp)   !! largest shear where there is none

   !> The friction of an interface.
   type :: friction_law_type
      real(dp) :: coefficient = 0.0_dp          !! mu [-]
      real(dp) :: largest_shear = unlimited     !! TAUMAX= [stress]
   end type friction_law_type

contains

   !> Largest friction under a compression: both tractions or, with the largest shear over the
   !> tributary area, both nodal forces.
   elemental function friction_bound(coefficient, largest, compression) result(bound)
      real(dp), intent(in) :: coefficient    !! mu [-]
      real(dp), intent(in) :: largest        !! [stress or force]
      real(dp), intent(in) :: compression    !! no friction where it is negative [stress or force]
      real(dp) :: bound                      !! [stress or force]

      bound = min(coefficient*max(compression, 0.0_dp), largest)
   end function friction_bound

end module friction_laws
