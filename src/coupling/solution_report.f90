!> Report of the way to the solution of an increment.
module solution_report
   use kinds, only: dp, long
   use text, only: string_type, to_text
   implicit none
   private
   public :: iteration_record_type, solution_report_type, work_record_type
   public :: warning_type

   !> One pass of the fixed-point iteration.
   type :: iteration_record_type
      integer :: increment = 0           !! running number over all steps
      integer :: iteration = 0           !! pass, from 1
      real(dp) :: residual = 0.0_dp      !! max |U(w) - w|/w over the contact points that carry heat
      real(dp) :: g_min = 1.0_dp         !! smallest g of eq. (4.2) over the contact points
      real(dp) :: g_max = 1.0_dp         !! largest
      integer :: g_kept = 0              !! contact points whose g was kept, eq. (4.2) giving none
      integer :: pairs_changed = 0       !! contact points whose contact state changed in this pass
      integer :: cut_backs = 0           !! cut-backs of the increment so far
   end type iteration_record_type

   !> Work of the partial re-factorisation of (3.4) in one increment.
   type :: work_record_type
      integer :: columns_again = 0           !! columns factored again, over all passes
      integer :: columns_full = 0            !! columns of as many full factorisations
      integer(long) :: flops_again = 0       !! operations of the columns factored again
      integer(long) :: flops_full = 0        !! operations of as many full factorisations
   end type work_record_type

   !> A warning of an increment. Those with the same words but for the value are one kind.
   type :: warning_type
      character(:), allocatable :: before    !! words before the value, or all of them
      logical :: has_value = .false.         !! whether there is one
      real(dp) :: value = 0.0_dp             !! what was found, such as a gain
      real(dp) :: severity = 0.0_dp          !! of two of a kind the larger one is worse
      character(:), allocatable :: behind    !! words behind the value
   contains
      procedure :: words
      procedure :: is_like
   end type warning_type

   !> The passes of an increment, and what they showed.
   type :: solution_report_type
      integer :: increment = 0               !! running number over all steps, from 1
      !> Passes of all attempts in their order; unallocated without coupling.
      type(iteration_record_type), allocatable :: iterations(:)
      !> Floor of the residual: what the last places of the displacements change in omega.
      real(dp) :: residual_floor = 0.0_dp
      !> Real part of the eigenvalue of U' largest in modulus; NaN where nothing is iterated.
      real(dp) :: coupling_gain = 0.0_dp
      real(dp) :: coupling_gain_max = 0.0_dp !! largest real eigenvalue of U'; NaN likewise
      !> Whether a steady state is proven to be unstable: det(I - U') < 0.
      logical :: is_unstable = .false.
      type(work_record_type) :: work = work_record_type()       !! re-factorisation
      character(:), allocatable :: runaway   !! thermal runaway, in words; else unallocated
      type(string_type), allocatable :: notes(:)                !! unallocated for none
      type(warning_type), allocatable :: warnings(:)            !! unallocated for none
   contains
      procedure :: warn
   end type solution_report_type

contains

   !> Adds a warning: words, or words about a value.
   pure subroutine warn(self, before, value, behind, severity)
      class(solution_report_type), intent(inout) :: self
      character(*), intent(in) :: before               !! words before the value, or all of them
      real(dp), intent(in), optional :: value          !! what was found
      character(*), intent(in), optional :: behind     !! words behind it
      real(dp), intent(in), optional :: severity       !! its magnitude where that is not given
      type(warning_type), allocatable :: more(:)
      integer :: n

      n = 0
      if (allocated(self%warnings)) n = size(self%warnings)
      allocate (more(n + 1))
      if (n > 0) more(:n) = self%warnings
      more(n + 1)%before = before
      more(n + 1)%behind = ''
      if (present(behind)) more(n + 1)%behind = behind
      more(n + 1)%has_value = present(value)
      if (present(value)) then
         more(n + 1)%value = value
         more(n + 1)%severity = abs(value)
      end if
      if (present(severity)) more(n + 1)%severity = severity
      call move_alloc(more, self%warnings)
   end subroutine warn

   !> The sentence.
   pure function words(self) result(sentence)
      class(warning_type), intent(in) :: self
      character(:), allocatable :: sentence

      sentence = self%before
      if (self%has_value) sentence = sentence//to_text(self%value)
      sentence = sentence//self%behind
   end function words

   !> Whether two warnings are of one kind: they begin alike.
   pure logical function is_like(self, other)
      class(warning_type), intent(in) :: self
      type(warning_type), intent(in) :: other

      is_like = self%before == other%before
   end function is_like

end module solution_report
