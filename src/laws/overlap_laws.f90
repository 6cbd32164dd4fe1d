!> Soft faces: the pressure under which closed faces overlap. Hard faces press without overlap.
!>
!> A law rises from a first overlap on, below which faces do not press; the first overlap is
!> negative where they press before they touch. It is a table of straight lines, of which the last
!> one goes on, or
!>
!>    p = p0 exp(ln(100) overlap/c0),
!>
!> and where that is less than p0/100 its tangent there.
module overlap_laws
   use kinds, only: dp
   implicit none
   private
   public :: overlap_law_type

   real(dp), parameter :: decay = log(100.0_dp)   !! of the exponential law over c0

   !> The law of an interface; as it is at first, of hard faces.
   type :: overlap_law_type
      real(dp), allocatable :: overlap(:)      !! (rows) ascending [length]
      real(dp), allocatable :: pressure(:)     !! (rows) ascending from 0 [stress]
      real(dp) :: clearance = 0.0_dp           !! c0 of the exponential law, 0 for none [length]
      real(dp) :: touching_pressure = 0.0_dp   !! p0 [stress]
   contains
      procedure :: is_soft
      procedure :: reach
      procedure :: overlap_under
      procedure :: tangent
   end type overlap_law_type

contains

   !> Whether faces overlap at all.
   elemental logical function is_soft(self)
      class(overlap_law_type), intent(in) :: self

      is_soft = allocated(self%overlap) .or. self%clearance > 0.0_dp
   end function is_soft

   !> Gap from which on faces press; 0 of hard ones.
   elemental real(dp) function reach(self)
      class(overlap_law_type), intent(in) :: self

      reach = 0.0_dp
      if (self%is_soft()) reach = -self%overlap_under(0.0_dp)
   end function reach

   !> Overlap under a pressure; the first one where there is none.
   elemental function overlap_under(self, pressure) result(overlap)
      class(overlap_law_type), intent(in) :: self    !! of soft faces
      real(dp), intent(in) :: pressure               !! [stress]
      real(dp) :: overlap                            !! [length]
      real(dp) :: part
      integer :: i

      if (allocated(self%overlap)) then
         i = segment_of(self%pressure, pressure)
         overlap = self%overlap(i) + (max(pressure, 0.0_dp) - self%pressure(i))* &
            (self%overlap(i + 1) - self%overlap(i))/(self%pressure(i + 1) - self%pressure(i))
      else
         part = max(pressure, 0.0_dp)/self%touching_pressure
         if (part >= 0.01_dp) then
            overlap = self%clearance*log(part)/decay
         else
            overlap = self%clearance*(100.0_dp*part - 1.0_dp - decay)/decay
         end if
      end if
   end function overlap_under

   !> The tangent of the law at an overlap: pressure = slope (overlap - onset).
   elemental subroutine tangent(self, overlap, slope, onset)
      class(overlap_law_type), intent(in) :: self    !! of soft faces
      real(dp), intent(in) :: overlap                !! [length]
      real(dp), intent(out) :: slope                 !! [stress/length]
      real(dp), intent(out) :: onset                 !! [length]
      integer :: i

      if (allocated(self%overlap)) then
         i = segment_of(self%overlap, overlap)
         slope = (self%pressure(i + 1) - self%pressure(i))/(self%overlap(i + 1) - self%overlap(i))
         onset = self%overlap(i) - self%pressure(i)/slope
      else
         associate (at => max(overlap, -self%clearance))
            slope = self%touching_pressure*exp(decay*at/self%clearance)*decay/self%clearance
            onset = at - self%clearance/decay
         end associate
      end if
   end subroutine tangent

   !> The straight line of a table at a value.
   pure integer function segment_of(values, value)
      real(dp), intent(in) :: values(:), value

      segment_of = min(max(count(values <= value), 1), size(values) - 1)
   end function segment_of

end module overlap_laws
