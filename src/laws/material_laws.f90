!> Laws of materials beyond linear thermoelasticity, with a history at each point.
module material_laws
   use kinds, only: dp
   implicit none
   private
   public :: material_law_type, law_points_type, most_points_of_law

   integer, parameter :: most_points_of_law = 10   !! of an element, made even
   integer, parameter :: most = most_points_of_law

   !> Points of an element of one material, along x, y and z; its points first.
   type :: law_points_type
      integer :: count = 0                         !! number of points
      integer :: plane = 0                         !! plane_strain, ...
      real(dp) :: strain(most, 4) = 0.0_dp         !! xx, yy, zz and the angle xy [-]
      real(dp) :: temperature(most) = 0.0_dp       !! [temperature]
      !> xx, yy, zz, xy: of thermoelasticity with initial stress; the law replaces it [stress]
      real(dp) :: stress(most, 4) = 0.0_dp
      !> (4, 4, points) of stress by strain: of elasticity; the law replaces it [stress]
      real(dp) :: tangent(4, 4, most) = 0.0_dp
   end type law_points_type

   !> The law of a material: none by default.
   type :: material_law_type
      integer :: history_count = 0                 !! history variables of a point
      real(dp), allocatable :: constants(:)
      procedure(response), pointer, nopass :: respond => null()
   end type material_law_type

   abstract interface
      !> Stress, tangent and history of the points after a time. A response of no duration, to the
      !> strain that a history belongs to, has its stress and leaves it as it is.
      pure subroutine response(law, points, duration, history)
         import :: dp, law_points_type, material_law_type
         type(material_law_type), intent(in) :: law
         type(law_points_type), intent(inout) :: points
         real(dp), intent(in) :: duration          !! [time]
         real(dp), intent(inout) :: history(:, :)  !! (numbers, points) of its start, of its end
      end subroutine response
   end interface

end module material_laws
