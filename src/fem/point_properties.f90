!> Properties of a material at a point of an element, along x, y and z: turned from the axes of the
!> material, and condensed in plane stress.
module point_properties
   use element_kinds, only: plane_stress
   use kinds, only: dp
   use materials, only: properties_type, strain_rotation
   implicit none
   private
   public :: elasticity_in, thermal_modulus_in, conductivity_in, along_axes, are_x_and_y

contains

   !> E of (1.1): stresses xx, yy, zz, xy from strains xx, yy, zz and the angle xy. In plane stress
   !> eps_zz is eliminated by sigma_zz = 0, and its row and column are zero.
   pure function elasticity_in(plane, material, axes) result(e)
      integer, intent(in) :: plane                  !! plane_strain, ...
      class(properties_type), intent(in) :: material
      real(dp), intent(in) :: axes(2, 2)            !! its axes 1 and 2 as columns
      real(dp) :: e(4, 4)                           !! [stress]
      real(dp) :: across(4)
      integer :: j

      e = in_global_axes(material, axes)
      if (plane /= plane_stress .or. e(3, 3) <= 0.0_dp) return
      across = e(:, 3)/e(3, 3)
      do j = 1, 4
         e(:, j) = e(:, j) - across*e(3, j)
      end do
      e(3, :) = 0.0_dp
      e(:, 3) = 0.0_dp
   end function elasticity_in

   !> beta = E:alpha of (1.1): the stress that holds back a unit temperature, in plane stress with
   !> sigma_zz = 0.
   pure function thermal_modulus_in(plane, material, expansion, axes) result(beta)
      integer, intent(in) :: plane                  !! plane_strain, ...
      class(properties_type), intent(in) :: material
      real(dp), intent(in) :: expansion(3)          !! along axes 1, 2, 3 [1/temperature]
      real(dp), intent(in) :: axes(2, 2)            !! its axes 1 and 2 as columns
      real(dp) :: beta(4)                           !! xx, yy, zz, xy [stress/temperature]
      real(dp) :: e(4, 4)

      beta = matmul(material%elasticity, [expansion, 0.0_dp])
      if (.not. are_x_and_y(axes)) beta = matmul(transpose(strain_rotation(axes)), beta)
      e = in_global_axes(material, axes)
      if (plane /= plane_stress .or. e(3, 3) <= 0.0_dp) return
      beta = beta - e(:, 3)*(beta(3)/e(3, 3))
      beta(3) = 0.0_dp
   end function thermal_modulus_in

   !> K of (1.4).
   pure function conductivity_in(material, axes) result(k)
      class(properties_type), intent(in) :: material
      real(dp), intent(in) :: axes(2, 2)            !! its axes 1 and 2 as columns
      real(dp) :: k(2, 2)                           !! [power/(length temperature)]

      associate (a => axes(:, 1), b => axes(:, 2), c => material%conductivity)
         k(:, 1) = a*(c(1)*a(1)) + b*(c(2)*b(1))
         k(:, 2) = a*(c(1)*a(2)) + b*(c(2)*b(2))
      end associate
   end function conductivity_in

   !> Stresses xx, yy, zz, xy as 11, 22, 33, 12 of axes.
   pure function along_axes(axes, stress) result(turned)
      real(dp), intent(in) :: axes(2, 2)   !! axes 1 and 2 as columns
      real(dp), intent(in) :: stress(4)    !! along x and y [stress]
      real(dp) :: turned(4)                !! along the axes [stress]

      turned = matmul(transpose(strain_rotation(transpose(axes))), stress)
   end function along_axes

   !> Whether unit vectors are those along x and y.
   pure logical function are_x_and_y(axes)
      real(dp), intent(in) :: axes(2, 2)    !! as columns

      are_x_and_y = abs(axes(2, 1)) + abs(axes(1, 2)) <= 0.0_dp .and. axes(1, 1) > 0.0_dp .and. &
         axes(2, 2) > 0.0_dp
   end function are_x_and_y

   pure function in_global_axes(material, axes) result(e)
      class(properties_type), intent(in) :: material
      real(dp), intent(in) :: axes(2, 2)
      real(dp) :: e(4, 4), rotation(4, 4)

      e = material%elasticity
      if (are_x_and_y(axes)) return
      rotation = strain_rotation(axes)
      e = matmul(transpose(rotation), matmul(e, rotation))
   end function in_global_axes

end module point_properties
