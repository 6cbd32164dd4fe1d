!> The numerical uncertainty (95 %) of a number: one rule for all of them.
!>
!> A number is computed on a mesh and on a finer one of half the spacing, in a complete finer run
!> with increments half as long as well. An error that falls with the power p of the spacing is
!> 2^p/(2^p - 1) times the change between both, of which a safety factor makes the uncertainty
!> (P. J. Roache, J. Fluids Eng. 116 (1994) 405-413; ASME V&V 20-2009): F = 3/(2^p - 1). As the edge
!> of contact passes nodes, errors change their sign, and a change may be small by chance: so the
!> scatter over increments is added, and of an edge a part of the spacing about it, of an instant a
!> part of its increment.
!>
!> Powers (`order`) and parts of the spacing (`resolution`) are in the tables of quantities:
!>
!>   0.8 and 0     numbers: fields with edges have 1; F = 4 in place of 3 holds shear forces, too
!>   0.8 and 0.2   when the last point is solid, known between two ends of increments
!>   0.5 and 0     displacements of nodes: where bodies yield or creep, errors by mesh and by
!>                 increments may have opposite signs, of which halving both shows the difference
!>   0.9 and 0     maxima of bodies, whose change is that of the field round them
!>   1.5 and 0.08  edges of contact, whose error on half the spacing is far smaller
!>   1.5 and 0.6   edges of stick, which are known between two nodes only
!>
!> docs/accuracy.md says on which decks they were chosen and which judge them.
module uncertainty_rule
   use kinds, only: dp
   use quantity_types, only: quantity_type
   implicit none
   private
   public :: uncertainty_parts

   real(dp), parameter :: safety = 3.0_dp   !! of the whole change, for p = 1

contains

   !> The parts of an uncertainty: of change, scatter and iteration; their sum is the uncertainty.
   pure function uncertainty_parts(quantity, change, scatter, spacing, iteration) result(parts)
      type(quantity_type), intent(in) :: quantity
      real(dp), intent(in) :: change      !! by the finer mesh, and by shorter increments
      real(dp), intent(in) :: scatter     !! over increments, 0 where it is not known
      real(dp), intent(in) :: spacing     !! about an edge [length], or increment [time]
      real(dp), intent(in) :: iteration   !! what the fixed point has left
      real(dp) :: parts(3)                !! not negative; NaN where the change is

      parts = [safety/(2.0_dp**quantity%order - 1.0_dp)*abs(change), abs(scatter) + &
         quantity%resolution*spacing, abs(iteration)]
   end function uncertainty_parts

end module uncertainty_rule
