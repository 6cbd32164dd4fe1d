!> Archard's law of wear: faces that slip by ds under a pressure p lose the depth K p ds together,
!> of which a share is the slave's.
!> J. F. Archard, J. Appl. Phys. 24 (1953) 981.
module wear_laws
   use conductance_laws, only: line_value
   use kinds, only: dp
   implicit none
   private
   public :: wear_law_type

   !> The law of an interface; as it is at first, faces do not wear.
   type :: wear_law_type
      real(dp), allocatable :: rate(:)          !! (rows) K [1/stress]
      real(dp), allocatable :: temperature(:)   !! (rows) of the faces, ascending [temperature]
      real(dp) :: slave_share = 1.0_dp          !! part of the depth that the slave loses [-]
   contains
      procedure :: wears
      procedure :: rate_at
   end type wear_law_type

contains

   !> Whether faces wear at all.
   elemental logical function wears(self)
      class(wear_law_type), intent(in) :: self

      wears = allocated(self%rate)
   end function wears

   !> K at a mean temperature of the faces; beyond the rows that of the last one.
   elemental real(dp) function rate_at(self, temperature)
      class(wear_law_type), intent(in) :: self
      real(dp), intent(in) :: temperature       !! [temperature]

      rate_at = 0.0_dp
      if (self%wears()) rate_at = line_value(self%temperature, self%rate, temperature)
   end function rate_at

end module wear_laws
