!> Materials and the sections that give them to elements.
module materials
   use kinds, only: dp
   implicit none
   private
   public :: material_type, section_type

   !> Linear elasticity, expansion and conductivity along the material's own axes 1 and 2 in the
   !> plane and 3 across it.
   type :: material_type
      character(:), allocatable :: name               !! name in upper case
      !> Stresses 11, 22, 33, 12 from strains 11, 22, 33 and the shear angle 12 [stress]
      real(dp) :: elasticity(4, 4) = 0.0_dp
      real(dp) :: expansion(3) = 0.0_dp               !! alpha along axes 1, 2, 3 [1/temperature]
      real(dp) :: conductivity(2) = 0.0_dp            !! K_1, K_2 [power/(length temperature)]
      real(dp) :: density = 0.0_dp                    !! mass per volume, 0 where not given
      logical :: has_elasticity = .false.             !! *ELASTIC was given
      logical :: has_expansion = .false.              !! *EXPANSION was given
      logical :: has_conductivity = .false.           !! *CONDUCTIVITY was given
      logical :: has_density = .false.                !! *DENSITY was given
   end type material_type

   !> One *SOLID SECTION.
   type :: section_type
      integer :: material = 0           !! index into model%materials
      integer :: orientation = 0        !! index into model%orientations, 0 for x and y
      real(dp) :: thickness = 1.0_dp    !! thickness [length]
   end type section_type

end module materials
