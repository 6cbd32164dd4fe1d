!> Contact points of soft faces (overlap_laws). A closed one has the tangent of its law,
!>
!>    force = stiffness (overlap - onset),
!>
!> and the contact system is solved with these tangents until they are those of the solution
!> (Newton), or the solution is on the laws. From one to the next a contact point goes to the
!> overlap that was found, or to that under the pressure that was found, whichever is nearer to
!> where it was: an exponential law would overflow on the way to the former from a small pressure,
!> and lose its pressure on the way to the latter from a large one.
module pressure_overclosure
   use kinds, only: dp
   use overlap_laws, only: overlap_law_type
   implicit none
   private
   public :: pressure_overclosure_type

   !> Change of a tangent, relative, that counts as none: the law is then met to its square.
   real(dp), parameter :: settled_change = 1.0e-7_dp
   !> Distance from a law, relative, that is rounding: on a corner of a table both tangents will do.
   real(dp), parameter :: rounding = 1.0e-12_dp

   !> The tangents of all contact points.
   type :: pressure_overclosure_type
      logical, allocatable :: is_soft(:)         !! (m)
      real(dp), allocatable :: stiffness(:)      !! (m) 0 without area [force/length]
      real(dp), allocatable :: onset(:)          !! (m) 0 of hard faces [length]
      real(dp), allocatable :: reach(:)          !! (m) gap from which on they press [length]
      type(overlap_law_type), allocatable, private :: law(:)   !! (m) none where all are hard
      real(dp), allocatable, private :: area(:)  !! (m) [length^2]
      real(dp), allocatable, private :: at(:)    !! (m) overlaps of the tangents [length]
      logical :: follows = .false.               !! whether the tangents are those of a solution
   contains
      procedure :: press
      procedure :: follow
      procedure :: compliance
   end type pressure_overclosure_type

   interface pressure_overclosure_type
      module procedure new_pressure_overclosure
   end interface pressure_overclosure_type

contains

   !> Contact points without pressure.
   pure function new_pressure_overclosure(points, law, area) result(soft)
      integer, intent(in) :: points                            !! m
      type(overlap_law_type), intent(in), optional :: law(:)   !! (m) absent where all are hard
      real(dp), intent(in), optional :: area(:)                !! (m) [length^2], with the laws
      type(pressure_overclosure_type) :: soft

      allocate (soft%is_soft(points), source=.false.)
      allocate (soft%stiffness(points), soft%onset(points), soft%reach(points), source=0.0_dp)
      if (.not. present(law)) return
      soft%law = law
      soft%area = max(area, 0.0_dp)
      soft%is_soft = law%is_soft()
      soft%reach = law%reach()
      soft%at = -soft%reach
   end function new_pressure_overclosure

   !> The tangents under given forces, unless they are those of a solution.
   pure subroutine press(self, force)
      class(pressure_overclosure_type), intent(inout) :: self
      real(dp), intent(in) :: force(:)           !! (m) compressive [force]
      integer :: k

      if (self%follows) return
      self%follows = .true.
      do k = 1, size(force)
         if (.not. self%is_soft(k)) cycle
         if (self%area(k) > 0.0_dp) self%at(k) = self%law(k)%overlap_under(force(k)/self%area(k))
         call self%law(k)%tangent(self%at(k), self%stiffness(k), self%onset(k))
         self%stiffness(k) = self%stiffness(k)*self%area(k)
      end do
   end subroutine press

   !> The next tangents, unless the solution has settled on the present ones.
   pure subroutine follow(self, overlap, force, settled)
      class(pressure_overclosure_type), intent(inout) :: self
      real(dp), intent(in) :: overlap(:)         !! (m) of the solution [length]
      real(dp), intent(in) :: force(:)           !! (m) compressive [force]
      logical, intent(out) :: settled
      real(dp), dimension(size(force)) :: next, onset, stiffness
      real(dp) :: found
      logical :: is_met, is_same
      integer :: k

      settled = .true.
      next = self%at
      onset = self%onset
      stiffness = self%stiffness
      do k = 1, size(force)
         if (.not. self%is_soft(k) .or. self%area(k) <= 0.0_dp) cycle
         found = self%law(k)%overlap_under(force(k)/self%area(k))
         next(k) = found
         if (abs(overlap(k) - self%at(k)) < abs(next(k) - self%at(k))) next(k) = overlap(k)
         call self%law(k)%tangent(next(k), stiffness(k), onset(k))
         stiffness(k) = stiffness(k)*self%area(k)
         is_same = abs(stiffness(k) - self%stiffness(k)) <= settled_change*self%stiffness(k) .and. &
            abs(onset(k) - self%onset(k)) <= settled_change*abs(next(k) - onset(k))
         is_met = force(k) > 0.0_dp .and. abs(overlap(k) - found) <= rounding*abs(found - onset(k))
         settled = settled .and. (is_same .or. is_met)
      end do
      if (settled) return
      self%at = next
      self%onset = onset
      self%stiffness = stiffness
   end subroutine follow

   !> Overlap of a contact point since it began to press, over its force; 0 of hard faces, and where
   !> there is no area.
   pure real(dp) function compliance(self, k, force)
      class(pressure_overclosure_type), intent(in) :: self
      integer, intent(in) :: k                   !! the contact point
      real(dp), intent(in) :: force              !! compressive [force]

      compliance = 0.0_dp
      if (self%stiffness(k) > 0.0_dp) compliance = 1.0_dp/self%stiffness(k)
      if (self%stiffness(k) > 0.0_dp .and. force > 0.0_dp) compliance = &
         (self%law(k)%overlap_under(force/self%area(k)) + self%reach(k))/force
   end function compliance

end module pressure_overclosure
