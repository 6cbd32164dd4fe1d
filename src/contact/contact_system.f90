!> Contact with friction on the reduced system, the partial solution of (2.4).
!>
!> Unknowns are the relative displacements d = u_xi - u_eta of the contact points, in their own
!> frame; the bodies behind them enter by the Schur complement S and the condensed load c, so that
!> the contact forces on xi are lambda = S d - c. Per contact point and direction either the force
!> is known and the displacement sought, or the other way round:
!>
!>    open   lambda_n = 0                            lambda_t = 0
!>    stick  d_n = h                                 d_t = reference
!>    slip   d_n = h                                 lambda_t = direction mu (-lambda_n)
!>    capped d_n = h                                 lambda_t = direction times the largest shear
!>
!> A contact point that closes within the increment sticks where it closed, a position that depends
!> on its forces (closing_instant):
!>
!>    stick  d_n = h           (1 - f) (d_t - d_t,i) + f (c_n lambda_n + c_t lambda_t) = 0
!>
!> Contact points that form cycles have the forces of their links (linear_constraints) among the
!> unknowns, on which nothing else acts; where such a contact point sticks it has a small
!> compliance: d_t + compliance lambda_t replaces d_t.
!>
!> Supports may leave bodies free to move as rigid ones: S has these motions as null vectors. Where
!> an active set does not hold them either, the system is solved beside the motions, bordered by
!> them. A load that drives one of them has no solution; without such a load the least motion is
!> taken.
!>
!> What is solved with it, and what of it changes, is in contact_workspace.
module contact_system
   use kinds, only: dp
   implicit none
   private
   public :: contact_system_type

   !> The reduced system, which no increment changes.
   type :: contact_system_type
      integer, allocatable :: normal(:)           !! (m) row of d_n on the tail
      integer, allocatable :: tangent(:) !! (m) row of d_t, 0 without friction or held
      real(dp), allocatable :: schur(:, :)        !! (tail, tail) S [force/length]
      real(dp), allocatable :: friction(:)        !! (m) mu [-]
      real(dp), allocatable :: largest_shear(:)   !! (m) largest friction [force]
      logical, allocatable :: removed(:)          !! (m) open whatever the gap
      !> (m) of stuck contact points, not zero in cycles [length/force]
      real(dp), allocatable :: compliance(:)
      !> (m) normal stiffness of a contact point alone [force/length]
      real(dp), allocatable :: alone(:)
      integer, allocatable :: link(:)             !! (links) rows of the links' forces
      real(dp), allocatable :: rigid(:, :)  !! (tail, q) unsupported rigid motions
      real(dp), allocatable :: motion(:, :) !! (tail, q) the same, orthonormal
      real(dp) :: least_length = 0.0_dp           !! rounding of the coordinates [length]
   end type contact_system_type

end module contact_system
