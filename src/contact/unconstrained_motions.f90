!> Rigid motions that supports leave free, on the tail of the contact system: which of them an
!> active set leaves free, too, and which load drives them. What decides is which rows the set
!> holds, not a pivot: stiffness against bending may be as small as rounding.
module unconstrained_motions
   use dense, only: least_squares, null_space
   use kinds, only: dp
   implicit none
   private
   public :: free_motions, is_driven, balanced_load, least_drive

   !> Spring of a row, as part of the contact point's stiffness, that does not hold a body.
   real(dp), parameter :: slack = 1.0e-9_dp
   !> Force along a motion that is rounding, as part of the terms that it is the sum of.
   real(dp), parameter :: rounding = 1.0e-13_dp
   !> Part of the applied forces that cancel which coordinates and loads of a deck leave over.
   real(dp), parameter :: cancelled = 1.0e-10_dp

contains

   !> The unsupported motions that no row of the active set holds, orthonormal on the free rows.
   pure function free_motions(motion, free, spring, schur) result(unheld)
      real(dp), intent(in) :: motion(:, :)   !! (tail, q) unsupported motions, orthonormal
      integer, intent(in) :: free(:)         !! (n) rows that are sought
      real(dp), intent(in) :: spring(:)      !! (tail) what holds free rows [force/length]
      real(dp), intent(in) :: schur(:, :)    !! (tail, tail) S [force/length]
      real(dp), allocatable :: unheld(:, :) !! (n, l)
      logical :: held(size(motion, 1))
      integer :: i

      if (size(motion, 2) == 0) then
         allocate (unheld(size(free), 0))
         return
      end if
      held = .true.
      do i = 1, size(free)
         held(free(i)) = spring(free(i)) > slack*abs(schur(free(i), free(i)))
      end do
      associate (tail_rows => pack([(i, i=1, size(held))], held))
         unheld = matmul(motion(free, :), null_space(motion(tail_rows, :)))
      end associate
   end function free_motions

   !> Whether forces drive the motions, by more than rounding. Each row is judged by the terms
   !> that its own motion collects: those of another body may be far larger.
   pure logical function is_driven(unheld, unbalanced, terms, least)
      real(dp), intent(in) :: unheld(:, :)   !! (n, l) orthonormal motions of the free rows
      real(dp), intent(in) :: unbalanced(:)  !! (l) forces along the motions [force]
      real(dp), intent(in) :: terms(:) !! (n) sums without signs of the forces' terms [force]
      real(dp), intent(in) :: least(:)       !! (n) drive that counts as none [force]

      is_driven = any(abs(matmul(unheld, unbalanced)) > least + &
         rounding*matmul(abs(matmul(unheld, transpose(unheld))), terms))
   end function is_driven

   !> A condensed load with the exact resultants along the unsupported motions. Temperatures and
   !> prescribed displacements have none; what the elimination makes of theirs is rounding.
   function balanced_load(load, rigid, motion, resultant) result(balanced)
      real(dp), intent(in) :: load(:)        !! (tail) c [force]
      real(dp), intent(in) :: rigid(:, :)    !! (tail, q) unsupported motions
      real(dp), intent(in) :: motion(:, :)   !! (tail, q) the same, orthonormal
      real(dp), intent(in) :: resultant(:)   !! (q) of the applied forces along `rigid` [force]
      real(dp) :: balanced(size(load))       !! (tail) [force]

      balanced = load
      if (size(motion, 2) == 0) return
      balanced = load - matmul(motion, matmul(load, motion)) + &
         least_squares(transpose(rigid), resultant)
   end function balanced_load

   !> Forces along the unsupported motions that count as none.
   pure function least_drive(rigid, sums) result(least)
      real(dp), intent(in) :: rigid(:, :) !! (tail, q) unsupported motions, each of one body
      real(dp), intent(in) :: sums(:)     !! (q) resultants of the forces without signs [force]
      real(dp) :: least(size(rigid, 1))   !! (tail) [force]
      integer :: q

      least = 0.0_dp
      do q = 1, size(sums)
         least = least + cancelled*sums(q)*abs(rigid(:, q))/max(sum(rigid(:, q)**2), tiny(1.0_dp))
      end do
   end function least_drive

end module unconstrained_motions
