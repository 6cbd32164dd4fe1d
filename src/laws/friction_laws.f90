!> Coulomb's law with a largest shear: which friction a pressure allows, and the heat that friction
!> makes.
module friction_laws
   use kinds, only: dp
   implicit none
   private
   public :: friction_law_type, friction_heat_type, friction_bound, rough_coefficient, unlimited

   !> Coefficient of a rough interface: no shear that a million times the pressure could hold slips.
   real(dp), parameter :: rough_coefficient = 1.0e6_dp
   real(dp), parameter :: unlimited = huge(1.0_dp)   !! largest shear where there is none

   !> The friction of an interface.
   type :: friction_law_type
      real(dp) :: coefficient = 0.0_dp          !! mu [-]
      real(dp) :: largest_shear = unlimited     !! TAUMAX= [stress]
   end type friction_law_type

   !> Heat of the friction of an interface.
   type :: friction_heat_type
      real(dp) :: efficiency = 0.0_dp           !! eta, heat per work of friction [-]
      real(dp) :: slave_share = 0.5_dp          !! f, part of it that enters the slave [-]
      !> Speed v of sliding out of the plane; negative where faces slip in the plane [length/time]
      real(dp) :: speed = -1.0_dp
      real(dp) :: angular_velocity = 0.0_dp     !! v over the radius about the axis; 0 for none
   contains
      procedure :: leaves_plane
   end type friction_heat_type

contains

   !> Whether faces slide out of the plane, so that their shear is not in it.
   elemental logical function leaves_plane(self)
      class(friction_heat_type), intent(in) :: self

      leaves_plane = self%speed > 0.0_dp .or. self%angular_velocity > 0.0_dp
   end function leaves_plane

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
