!> Springs and trusses. Each resists its elongation, a sum of displacements of its nodes, by a
!> force; warmth pushes the ends of a truss apart.
module bars
   use equations, only: equation_type
   use kinds, only: dp
   implicit none
   private
   public :: bar_type

   !> A spring or a truss; its force is stiffness*elongation less warm_force*temperature.
   type :: bar_type
      type(equation_type) :: elongation         !! its terms sum up to the elongation [length]
      type(equation_type) :: mean               !! those of the mean temperature
      real(dp) :: stiffness = 0.0_dp            !! of a truss E A/L [force/length]
      real(dp) :: warm_force = 0.0_dp           !! of a truss E A alpha [force/temperature]
      logical :: follows_axes = .false.         !! whether *TRANSFORM turns its displacements
   end type bar_type

end module bars
