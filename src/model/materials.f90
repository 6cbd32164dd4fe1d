!> Materials and the sections that give them to elements.
module materials
   use kinds, only: dp
   implicit none
   private
   public :: material_type, section_type

   !> Isotropic linear elasticity and expansion, conductivity along x and y.
   type :: material_type
      character(:), allocatable :: name               !! name in upper case
      real(dp) :: young = 0.0_dp                      !! Young's modulus E [stress]
      real(dp) :: poisson = 0.0_dp                    !! Poisson's ratio nu [-]
      real(dp) :: expansion = 0.0_dp                  !! linear expansion alpha [1/temperature]
      real(dp) :: conductivity(2) = 0.0_dp            !! K_x, K_y [power/(length temperature)]
      real(dp) :: density = 0.0_dp                    !! density [mass/volume]
      logical :: has_elasticity = .false.             !! *ELASTIC was given
      logical :: has_expansion = .false.              !! *EXPANSION was given
      logical :: has_conductivity = .false.           !! *CONDUCTIVITY was given
      logical :: has_density = .false.                !! *DENSITY was given
   end type material_type

   !> One *SOLID SECTION.
   type :: section_type
      integer :: material = 0           !! index into model%materials
      real(dp) :: thickness = 1.0_dp    !! thickness [length]
   end type section_type

end module materials
