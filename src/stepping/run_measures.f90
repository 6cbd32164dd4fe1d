!> What a run costs: where the time goes, and how large its problems are.
module run_measures
   use kinds, only: dp, long
   implicit none
   private
   public :: run_seconds_type, run_size_type

   !> Where the time goes.
   type :: run_seconds_type
      real(dp) :: assemble = 0.0_dp   !! matching and matrices of the bodies [s]
      real(dp) :: reduce = 0.0_dp     !! factors and reduction to the contact points [s]
      real(dp) :: iterate = 0.0_dp    !! increments on the contact points [s]
      real(dp) :: recover = 0.0_dp    !! fields and balances [s]
   end type run_seconds_type

   !> The largest problems of a run.
   type :: run_size_type
      integer :: equations_thermal = 0      !! unknown temperatures, largest of the steps
      integer :: equations_mechanical = 0   !! unknown displacements, largest of the steps
      integer :: contact_unknowns = 0       !! unknowns on the contact points, largest of the steps
      integer(long) :: factor_bytes = 0     !! bytes of factors, largest so far
      real(dp) :: smallest_pivot = 1.0_dp   !! over its diagonal entry, smallest so far [-]
   end type run_size_type

end module run_measures
