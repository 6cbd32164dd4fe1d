!> The accuracy that a deck or the command line asks for.
module accuracy_targets
   use kinds, only: dp
   use spelling, only: nearest_known
   use text, only: read_real, string_type
   implicit none
   private
   public :: accuracy_target_type, accuracy_request_type, read_request, short_name, whole_request

   !> Quantities that --accuracy bounds at every interface, the usual ones first, and their names
   !> there.
   integer, parameter :: usual = 4
   character(*), parameter :: quantities(6) = [character(13) :: 'normal_force', 'heat_rate', &
      'peak_pressure', 'edge_contact', 'shear_force', 'edge_stick']
   character(*), parameter :: short_names(6) = [character(8) :: 'force', 'heat', 'pressure', &
      'edge', 'shear', 'stick']

   !> Bound that the error of a quantity must not exceed at the end of each step.
   type :: accuracy_target_type
      character(:), allocatable :: quantity   !! its name
      real(dp) :: bound = 0.0_dp              !! > 0: a part of the value, or in its unit
      logical :: is_relative = .true.         !! REL, else ABS
      integer :: interface = 0                !! index into the model's contacts; 0 for all
   end type accuracy_target_type

   !> *ACCURACY.
   type :: accuracy_request_type
      type(accuracy_target_type), allocatable :: targets(:)   !! unallocated: nothing is requested
      integer :: rounds = 8                                   !! ROUNDS=
   end type accuracy_request_type

contains

   !> The targets of the usual quantities of all interfaces.
   pure function whole_request(bound) result(targets)
      real(dp), intent(in) :: bound   !! a part of the values
      type(accuracy_target_type), allocatable :: targets(:)
      integer :: i

      allocate (targets(usual))
      do i = 1, usual
         targets(i)%quantity = trim(quantities(i))
         targets(i)%bound = bound
      end do
   end function whole_request

   !> The name of a quantity on the command line.
   pure function short_name(quantity) result(name)
      character(*), intent(in) :: quantity    !! one that has a target
      character(:), allocatable :: name

      name = trim(short_names(findloc(quantities, quantity, dim=1)))
   end function short_name

   !> Reads a request such as 1%, of the usual quantities, or force=1%,heat=2%, each quantity once;
   !> unallocated where it is none.
   pure subroutine read_request(words, targets, hint)
      character(*), intent(in) :: words
      type(accuracy_target_type), allocatable, intent(out) :: targets(:)
      character(:), allocatable, intent(out) :: hint      !! what an unknown name may mean, or empty
      character(:), allocatable :: part, rest
      type(accuracy_target_type) :: target
      type(string_type) :: known(size(short_names))
      real(dp) :: bound
      integer :: comma, equals, i, q
      logical :: valid

      allocate (targets(0))
      hint = ''
      do i = 1, size(known)
         known(i)%value = trim(short_names(i))
      end do
      rest = words//','
      do while (len(rest) > 0)
         comma = index(rest, ',')
         part = rest(:comma - 1)
         rest = rest(comma + 1:)
         equals = index(part, '=')
         valid = index(part, '%') == len(part) .and. len(part) > equals + 1
         if (valid) call read_real(part(equals + 1:len(part) - 1), bound, valid)
         if (valid) valid = bound > 0.0_dp .and. bound < 100.0_dp
         q = findloc(quantities == part(:max(equals - 1, 0)) .or. &
            short_names == part(:max(equals - 1, 0)), .true., dim=1)
         if (equals == 0) valid = valid .and. size(targets) == 0 .and. len(rest) == 0
         if (equals > 0) valid = valid .and. q > 0
         if (equals > 0 .and. q == 0) hint = nearest_known(part(:equals - 1), known)
         do i = 1, size(targets)
            if (q > 0) valid = valid .and. targets(i)%quantity /= quantities(q)
         end do
         if (.not. valid) deallocate (targets)
         if (.not. valid) return
         if (equals == 0) targets = whole_request(bound/100.0_dp)
         if (equals == 0) cycle
         target%quantity = trim(quantities(q))
         target%bound = bound/100.0_dp
         targets = [targets, target]
      end do
   end subroutine read_request

end module accuracy_targets
