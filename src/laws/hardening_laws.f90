!> Hardening of a plastic material: the size of its yield surface, a table over the equivalent
!> plastic strain for each of some temperatures, and one back stress X, which moves its centre,
!>
!>    X = C a,   da = deps_p 2/3 - gamma a dp,
!>
!> p being the equivalent plastic strain (Armstrong & Frederick; linear kinematic hardening for
!> gamma = 0). That a and not X is remembered lets X follow a C that varies with temperature.
!>
!> J.-L. Chaboche, Int. J. Plasticity 24 (2008) 1642.
module hardening_laws
   use kinds, only: dp
   use table_rows, only: find_row
   implicit none
   private
   public :: hardening_type, yield_table_type

   !> Yield stress over plastic strain, one table a temperature.
   type :: yield_table_type
      real(dp), allocatable :: temperature(:)   !! (tables) ascending
      integer, allocatable :: first(:)          !! (tables + 1) first row of each
      real(dp), allocatable :: strain(:)        !! (rows) plastic strain, from 0 in each [-]
      real(dp), allocatable :: stress(:)        !! (rows) [stress]
   end type yield_table_type

   !> Hardening of a material; without a table it does not yield.
   type :: hardening_type
      type(yield_table_type) :: yield
      real(dp), allocatable :: back_temperature(:)   !! (rows) ascending
      real(dp), allocatable :: back(:, :)            !! (2, rows) C [stress] and gamma [-], or none
   contains
      procedure :: yields
      procedure :: has_back_stress
      procedure :: find_yield
      procedure :: back_constants
   end type hardening_type

contains

   !> Whether the material can yield.
   elemental logical function yields(self)
      class(hardening_type), intent(in) :: self

      yields = allocated(self%yield%stress)
   end function yields

   !> Whether the yield surface moves.
   elemental logical function has_back_stress(self)
      class(hardening_type), intent(in) :: self

      has_back_stress = allocated(self%back)
   end function has_back_stress

   !> Size of the yield surface and its slope; behind its last row a table holds its stress.
   pure subroutine find_yield(self, strain, temperature, stress, slope)
      class(hardening_type), intent(in) :: self
      real(dp), intent(in) :: strain                 !! equivalent plastic strain [-]
      real(dp), intent(in) :: temperature
      real(dp), intent(out) :: stress                !! [stress]
      real(dp), intent(out) :: slope                 !! by the strain [stress]
      real(dp) :: next_stress, next_slope, part
      integer :: table

      call find_row(self%yield%temperature, temperature, table, part)
      call find_in_table(self%yield, table, strain, stress, slope)
      if (part <= 0.0_dp) return
      call find_in_table(self%yield, table + 1, strain, next_stress, next_slope)
      stress = stress + part*(next_stress - stress)
      slope = slope + part*(next_slope - slope)
   end subroutine find_yield

   pure subroutine find_in_table(yield, table, strain, stress, slope)
      type(yield_table_type), intent(in) :: yield
      integer, intent(in) :: table
      real(dp), intent(in) :: strain
      real(dp), intent(out) :: stress, slope
      real(dp) :: part
      integer :: row

      associate (first => yield%first(table), last => yield%first(table + 1) - 1)
         call find_row(yield%strain(first:last), strain, row, part)
         row = first + row - 1
         stress = yield%stress(row)
         slope = 0.0_dp
         if (row == last) return
         slope = (yield%stress(row + 1) - stress)/(yield%strain(row + 1) - yield%strain(row))
         stress = stress + part*(yield%stress(row + 1) - stress)
      end associate
   end subroutine find_in_table

   !> C [stress] and gamma [-]; zero without a back stress.
   pure function back_constants(self, temperature) result(constants)
      class(hardening_type), intent(in) :: self
      real(dp), intent(in) :: temperature
      real(dp) :: constants(2)
      real(dp) :: part
      integer :: row

      constants = 0.0_dp
      if (.not. allocated(self%back)) return
      call find_row(self%back_temperature, temperature, row, part)
      constants = self%back(:, row)
      if (part > 0.0_dp) constants = constants + part*(self%back(:, row + 1) - constants)
   end function back_constants

end module hardening_laws
