!> Rigid motions that an active set leaves free, on the tail of the contact system. What decides is
!> which places the set holds, not a pivot: stiffness against bending may be as small as rounding.
module loose_motions
   use dense, only: null_space
   use kinds, only: dp
   implicit none
   private
   public :: free_motions, is_driven

   !> Spring of a row, as part of the pair's stiffness, that does not hold a body.
   real(dp), parameter :: slack = 1.0e-9_dp
   !> Force along a motion that is rounding, as part of the load and of the terms of S d.
   real(dp), parameter :: balanced = 1.0e-10_dp, rounding = 1.0e-13_dp

contains

   !> The unsupported motions that no place of the active set holds, orthonormal on the free places.
   pure function free_motions(motion, free, spring, schur) result(loose)
      real(dp), intent(in) :: motion(:, :)   !! (tail, q) unsupported motions, orthonormal
      integer, intent(in) :: free(:)         !! (n) places that are sought
      real(dp), intent(in) :: spring(:)      !! (tail) what holds free places [force/length]
      real(dp), intent(in) :: schur(:, :)    !! (tail, tail) S [force/length]
      real(dp), allocatable :: loose(:, :)   !! (n, l)
      logical :: held(size(motion, 1))
      integer :: i

      if (size(motion, 2) == 0) then
         allocate (loose(size(free), 0))
         return
      end if
      held = .true.
      do i = 1, size(free)
         held(free(i)) = spring(free(i)) > slack*abs(schur(free(i), free(i)))
      end do
      associate (places => pack([(i, i=1, size(held))], held))
         loose = matmul(motion(free, :), null_space(motion(places, :)))
      end associate
   end function free_motions

   !> Whether a load drives the motions, by more than rounding.
   pure logical function is_driven(unbalanced, load, schur, d)
      real(dp), intent(in) :: unbalanced(:)  !! (l) forces along the motions [force]
      real(dp), intent(in) :: load(:)        !! (tail) condensed load [force]
      real(dp), intent(in) :: schur(:, :)    !! (tail, tail) S [force/length]
      real(dp), intent(in) :: d(:)           !! (tail) relative displacements [length]

      is_driven = maxval(abs(unbalanced)) > balanced*maxval(abs(load)) + &
         rounding*maxval(matmul(abs(schur), abs(d)))
   end function is_driven

end module loose_motions
