!> What the integration points of all elements have in a state, for the energies of bodies.
module point_fields
   use kinds, only: dp
   implicit none
   private
   public :: point_fields_type

   type :: point_fields_type
      real(dp) :: energies(3) = 0.0_dp         !! stored, dissipated by plasticity and by creep
      real(dp), allocatable :: volume(:)       !! (points) that each stands for [length^3]
      real(dp), allocatable :: stress(:, :)    !! (4, points) [stress]
      real(dp), allocatable :: elastic(:, :)   !! (4, points) strain by the stress
      real(dp), allocatable :: free(:, :)      !! (4, points) strain by the temperature
   end type point_fields_type

end module point_fields
