!> Parts of a model that are refined: what a *REFINE card with a surface or a set says, or the
!> divisions that a round of a requested accuracy asks for.
module refined_regions
   use kinds, only: dp
   implicit none
   private
   public :: refined_region_type, division_type

   !> Where a model is refined locally, and how often.
   type :: refined_region_type
      integer :: levels = 0              !! number of divisions
      integer, allocatable :: surfaces(:) !! indexes into the mesh's surfaces; unallocated for a set
      integer :: set = 0                 !! index into its element sets
      real(dp) :: distance = 0.0_dp      !! DISTANCE=; 0 where it is not given [length]
      integer :: card = 0                !! card image of the *REFINE
   end type refined_region_type

   !> How often each element is divided, and then those that are left at some points.
   type :: division_type
      integer, allocatable :: levels(:)         !! (elements) >= 0
      real(dp), allocatable :: points(:, :)     !! (2, n) [length]
      integer, allocatable :: point_levels(:)   !! (n) divisions at them
   end type division_type

end module refined_regions
