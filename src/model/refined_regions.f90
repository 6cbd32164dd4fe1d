!> Parts of a model that are refined: what a *REFINE card with a surface or a set says.
module refined_regions
   use kinds, only: dp
   implicit none
   private
   public :: refined_region_type

   !> Where a model is refined locally, and how often.
   type :: refined_region_type
      integer :: levels = 0              !! number of divisions
      integer, allocatable :: surfaces(:) !! indexes into the mesh's surfaces; unallocated for a set
      integer :: set = 0                 !! index into its element sets
      real(dp) :: distance = 0.0_dp      !! DISTANCE=; 0 where it is not given [length]
      integer :: card = 0                !! card image of the *REFINE
   end type refined_region_type

end module refined_regions
