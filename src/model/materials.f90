!> Materials and the sections that give them to elements.
module materials
   use kinds, only: dp
   use named_items, only: named_type
   implicit none
   private
   public :: material_type, section_type, constant_type, set_constants

   !> A constant of a material as the deck gives it.
   type :: constant_type
      character(16) :: property = ''    !! keyword of its card
      character(24) :: name = ''        !! what it is called
      real(dp) :: value = 0.0_dp        !! its value
   end type constant_type

   !> Linear elasticity, expansion and conductivity along the material's own axes 1 and 2 in the
   !> plane and 3 across it.
   type, extends(named_type) :: material_type
      !> Stresses 11, 22, 33, 12 from strains 11, 22, 33 and the shear angle 12 [stress]
      real(dp) :: elasticity(4, 4) = 0.0_dp
      real(dp) :: expansion(3) = 0.0_dp               !! alpha along axes 1, 2, 3 [1/temperature]
      real(dp) :: conductivity(2) = 0.0_dp            !! K_1, K_2 [power/(length temperature)]
      real(dp) :: density = 0.0_dp                    !! mass per volume, 0 where not given
      logical :: has_elasticity = .false.             !! *ELASTIC was given
      logical :: has_expansion = .false.              !! *EXPANSION was given
      logical :: has_conductivity = .false.           !! *CONDUCTIVITY was given
      logical :: has_density = .false.                !! *DENSITY was given
      !> All constants as the deck gives them; unallocated for none
      type(constant_type), allocatable :: constants(:)
   end type material_type

   !> One *SOLID SECTION.
   type :: section_type
      integer :: material = 0           !! index into model%materials
      integer :: orientation = 0        !! index into model%orientations, 0 for x and y
      real(dp) :: thickness = 1.0_dp    !! thickness [length]
   end type section_type

contains

   !> Keeps the constants of a property; those of an earlier card of the same property end.
   pure subroutine set_constants(material, property, names, values)
      type(material_type), intent(inout) :: material
      character(*), intent(in) :: property              !! keyword of the card
      character(*), intent(in) :: names(:)              !! (constants) what they are called
      real(dp), intent(in) :: values(:)                 !! (constants) their values
      type(constant_type) :: constants(size(values))

      constants%property = property
      constants%name = names
      constants%value = values
      if (.not. allocated(material%constants)) allocate (material%constants(0))
      material%constants = [pack(material%constants, material%constants%property /= property), &
         constants]
   end subroutine set_constants

end module materials
