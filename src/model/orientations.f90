!> Axes of materials in the plane (*ORIENTATION), and properties turned from them to x and y.
module orientations
   use kinds, only: dp
   use named_items, only: named_type
   implicit none
   private
   public :: orientation_type, material_axes, strain_rotation

   !> Local axes: axis 1 at a fixed angle to x, or to the radius from a centre.
   type, extends(named_type) :: orientation_type
      logical :: cylindrical = .false.                   !! whether axis 1 follows the radius
      real(dp) :: centre(2) = 0.0_dp                     !! of the radius, x and y [length]
      !> Axis 1, unit vector in x and y, or in the directions of radius and circumference
      real(dp) :: direction(2) = [1.0_dp, 0.0_dp]
      real(dp) :: hand = 1.0_dp                          !! 1: axis 2 is left of axis 1; -1: right
   end type orientation_type

contains

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

end module orientations
