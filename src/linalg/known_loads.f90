!> Loads of a field that were solved for, and what became of them: a load that they make up needs no
!> solution of its own.
module known_loads
   use kinds, only: dp
   implicit none
   private
   public :: known_loads_type

   integer, parameter :: most_kept = 4   !! loads

   !> Orthonormal loads, the latest last.
   type :: known_loads_type
      real(dp), allocatable, private :: rhs(:, :)           !! (equations, n)
      real(dp), allocatable, private :: condensed(:, :)     !! (tail, n)
      real(dp), allocatable, private :: solution(:, :)      !! (equations, n), or none
   contains
      procedure :: take_off
      procedure :: keep
   end type known_loads_type

contains

   !> Takes from a load its parts along known ones, twice for their rounding, and adds these parts'
   !> condensed loads and solutions.
   pure subroutine take_off(self, rhs, condensed, solution)
      class(known_loads_type), intent(in) :: self
      real(dp), intent(inout) :: rhs(:)         !! (equations)
      real(dp), intent(inout) :: condensed(:)   !! (tail)
      real(dp), intent(inout) :: solution(:)    !! (equations), or none
      real(dp) :: part
      integer :: j, turn

      if (.not. allocated(self%rhs)) return
      do turn = 1, 2
         do j = 1, size(self%rhs, 2)
            part = dot_product(self%rhs(:, j), rhs)
            rhs = rhs - part*self%rhs(:, j)
            condensed = condensed + part*self%condensed(:, j)
            solution = solution + part*self%solution(:, j)
         end do
      end do
   end subroutine take_off

   !> Keeps a load that is orthogonal to the known ones, in the place of the oldest where there are
   !> many.
   pure subroutine keep(self, rhs, condensed, solution)
      class(known_loads_type), intent(inout) :: self
      real(dp), intent(in) :: rhs(:)            !! (equations), not zero
      real(dp), intent(in) :: condensed(:)      !! (tail)
      real(dp), intent(in) :: solution(:)       !! (equations), or none
      real(dp) :: length

      length = norm2(rhs)
      if (.not. allocated(self%rhs)) then
         allocate (self%rhs(size(rhs), 0), self%condensed(size(condensed), 0), &
            self%solution(size(solution), 0))
      end if
      associate (n => size(self%rhs, 2), oldest => 1 + size(self%rhs, 2)/most_kept)
         self%rhs = reshape([self%rhs(:, oldest:), rhs/length], [size(rhs), n + 2 - oldest])
         self%condensed = reshape([self%condensed(:, oldest:), condensed/length], &
            [size(condensed), n + 2 - oldest])
         self%solution = reshape([self%solution(:, oldest:), solution/length], &
            [size(solution), n + 2 - oldest])
      end associate
   end subroutine keep

end module known_loads
