!> Materials, the sections that give them to elements, and their axes in the plane (*ORIENTATION).
module materials
   use kinds, only: dp
   use named_items, only: named_type
   implicit none
   private
   public :: material_type, section_type, constant_type, set_constants, orientation_type, &
      material_axes, strain_rotation, heat_capacity

   !> Local axes: axis 1 at a fixed angle to x, or to the radius from a centre.
   type, extends(named_type) :: orientation_type
      logical :: cylindrical = .false.                   !! whether axis 1 follows the radius
      real(dp) :: centre(2) = 0.0_dp                     !! of the radius, x and y [length]
      !> Axis 1, unit vector in x and y, or in the directions of radius and circumference
      real(dp) :: direction(2) = [1.0_dp, 0.0_dp]
      real(dp) :: hand = 1.0_dp                          !! 1: axis 2 is left of axis 1; -1: right
   end type orientation_type

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
      real(dp) :: specific_heat = 0.0_dp              !! c_p [energy/(mass temperature)]
      logical :: has_elasticity = .false.             !! *ELASTIC was given
      logical :: has_expansion = .false.              !! *EXPANSION was given
      logical :: has_conductivity = .false.           !! *CONDUCTIVITY was given
      logical :: has_density = .false.                !! *DENSITY was given
      logical :: has_specific_heat = .false.          !! *SPECIFIC HEAT was given
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

   !> rho c_p, 0 of a material without one.
   elemental real(dp) function heat_capacity(material)
      type(material_type), intent(in) :: material

      heat_capacity = material%density*material%specific_heat
   end function heat_capacity

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

   !> Axes 1 and 2 at a point, as columns in x and y. On the very axis of a cylindrical system the
   !> radius is along x.
   pure function material_axes(orientations, index, position) result(axes)
      type(orientation_type), intent(in) :: orientations(:)   !! all orientations
      integer, intent(in) :: index                            !! which, or 0 for x and y
      real(dp), intent(in) :: position(2)                     !! the point [length]
      real(dp) :: axes(2, 2)                                  !! unit vectors
      real(dp) :: radial(2)

      axes = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])
      if (index == 0) return
      associate (orientation => orientations(index))
         axes(:, 1) = orientation%direction
         if (orientation%cylindrical) then
            radial = position - orientation%centre
            if (norm2(radial) > 0.0_dp) then
               radial = radial/norm2(radial)
               axes(:, 1) = orientation%direction(1)*radial + &
                  orientation%direction(2)*[-radial(2), radial(1)]
            end if
         end if
         axes(:, 2) = orientation%hand*[-axes(2, 1), axes(1, 1)]
      end associate
   end function material_axes

   !> Strains 11, 22, 33 and angle 12 from strains xx, yy, zz and angle xy; its transpose turns
   !> stresses back.
   pure function strain_rotation(axes) result(rotation)
      real(dp), intent(in) :: axes(2, 2)   !! from material_axes
      real(dp) :: rotation(4, 4)           !! [-]

      associate (a => axes(:, 1), b => axes(:, 2))
         rotation(1, :) = [a(1)**2, a(2)**2, 0.0_dp, a(1)*a(2)]
         rotation(2, :) = [b(1)**2, b(2)**2, 0.0_dp, b(1)*b(2)]
         rotation(3, :) = [0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp]
         rotation(4, :) = [2*a(1)*b(1), 2*a(2)*b(2), 0.0_dp, a(1)*b(2) + a(2)*b(1)]
      end associate
   end function strain_rotation

end module materials
