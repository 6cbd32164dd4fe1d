!> What is told of the way to the solution of an increment.
module solution_report
   use kinds, only: dp, long
   use text, only: string_type
   implicit none
   private
   public :: iteration_record_type, solution_report_type, work_record_type

   !> One pass of the fixed-point iteration.
   type :: iteration_record_type
      integer :: increment = 0           !! running number over all steps
      integer :: iteration = 0           !! pass, from 1
      real(dp) :: residual = 0.0_dp      !! max |U(w) - w|/w over the contact points that carry heat
      real(dp) :: g_min = 1.0_dp         !! smallest g of eq. (4.2) over the contact points
      real(dp) :: g_max = 1.0_dp         !! largest
      integer :: g_kept = 0              !! contact points whose g was kept, eq. (4.2) giving none
      integer :: pairs_changed = 0       !! contact points whose contact state changed in this pass
      integer :: cut_backs = 0           !! cut-backs of the increment so far
   end type iteration_record_type

   !> Work of the partial re-factorisation of (3.4) in one increment.
   type :: work_record_type
      integer :: columns_again = 0           !! columns factored again, over all passes
      integer :: columns_full = 0            !! columns of as many full factorisations
      integer(long) :: flops_again = 0       !! operations of the columns factored again
      integer(long) :: flops_full = 0        !! operations of as many full factorisations
   end type work_record_type

   !> The passes of an increment, and what they showed.
   type :: solution_report_type
      integer :: increment = 0               !! running number over all steps, from 1
      !> Passes of all attempts in their order; unallocated without coupling.
      type(iteration_record_type), allocatable :: iterations(:)
      !> Floor of the residual: what the last places of the displacements change in omega.
      real(dp) :: residual_floor = 0.0_dp
      !> Real part of the eigenvalue of U' largest in modulus; NaN where nothing is iterated.
      real(dp) :: coupling_gain = 0.0_dp
      real(dp) :: coupling_gain_max = 0.0_dp !! largest real eigenvalue of U'; NaN likewise
      type(work_record_type) :: work = work_record_type()       !! re-factorisation
      character(:), allocatable :: runaway   !! thermal runaway, in words; else unallocated
      type(string_type), allocatable :: notes(:)                !! unallocated for none
      type(string_type), allocatable :: warnings(:)             !! unallocated for none
   end type solution_report_type

end module solution_report
