!> What the rounds of a requested accuracy say of rounds that would follow: how fast the uncertainty
!> of a target falls from round to round, how many rounds it is away, and how long these take.
module accuracy_outlook
   use accuracy_rounds, only: accuracy_rounds_type
   use kinds, only: dp
   implicit none
   private
   public :: outlook_type, outlook_of

   integer, parameter :: most_before = 2        !! rounds before the last one that count
   real(dp), parameter :: falling = 0.9_dp      !! of the uncertainty of a round before
   real(dp), parameter :: slowest = 0.25_dp     !! order of which rounds can be foretold
   integer, parameter :: most_rounds = 8        !! that can be

   !> The outlook of one target.
   type :: outlook_type
      logical :: is_known = .false.        !! whether two rounds have its uncertainty
      logical :: falls = .false.           !! whether that falls; the next four are 0 otherwise
      real(dp) :: order = 0.0_dp           !! the uncertainty falls as this power of the unknowns
      logical :: is_foretold = .false.     !! whether fast enough to foretell the next two
      integer :: rounds = 0                !! more that would meet it
      real(dp) :: cpu_seconds = 0.0_dp     !! of these rounds [s]
   end type outlook_type

contains

   !> The outlook of a target that the last round misses. Unknowns count at every increment: a round
   !> may divide elements or halve increments.
   pure function outlook_of(accuracy, d) result(outlook)
      type(accuracy_rounds_type), intent(in) :: accuracy
      integer, intent(in) :: d                    !! the target
      type(outlook_type) :: outlook
      real(dp) :: after, before, by_round, growth, seconds, sizes(2)
      integer :: first, i, n

      n = size(accuracy%rounds)
      after = accuracy%rounds(n)%excess(d)
      do first = max(1, n - most_before), n - 1
         before = accuracy%rounds(first)%excess(d)
         if (before > 0.0_dp .and. before < huge(before)) exit
      end do
      outlook%is_known = first < n .and. after > 1.0_dp .and. after < huge(after)
      if (.not. outlook%is_known) return
      associate (rounds => accuracy%rounds, spacing => 1.0_dp/(n - first))
         by_round = (after/before)**spacing
         sizes = [(real(rounds(i)%unknowns, dp)*rounds(i)%increments, i=first, n, n - first)]
         outlook%falls = by_round < falling .and. sizes(2) > sizes(1)
         if (.not. outlook%falls) return
         outlook%order = log(before/after)/log(sizes(2)/sizes(1))
         if (outlook%order < slowest .or. by_round**most_rounds*after > 1.0_dp) return
         outlook%is_foretold = .true.
         outlook%rounds = ceiling(log(after)/(-log(by_round)))
         ! At least as the unknowns, of which a first round has few.
         seconds = rounds(n)%cpu_seconds
         growth = max(sizes(2)/sizes(1), seconds/max(rounds(first)%cpu_seconds, &
            tiny(seconds)))**spacing
         outlook%cpu_seconds = seconds*growth*(growth**outlook%rounds - 1.0_dp)/(growth - 1.0_dp)
      end associate
   end function outlook_of

end module accuracy_outlook
