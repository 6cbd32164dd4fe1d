!> Kind of the real numbers of the whole program.
module kinds
   use, intrinsic :: iso_fortran_env, only: int64, real64
   implicit none
   private
   public :: dp, long

   integer, parameter :: dp = real64   !! kind of every real number
   integer, parameter :: long = int64  !! kind of counters that outgrow a default integer

end module kinds
