!> Creep under a constant equivalent stress q:
!>
!>    time hardening     deps/dt = A q^n t^m,   t the total time; Norton's law for m = 0
!>    strain hardening   deps/dt = (A q^n ((m + 1) eps)^m)^(1/(m + 1))
!>
!> The strain of an increment is taken by the integral of these over it, so that neither the time
!> nor the strain 0 is singular, and a constant stress creeps exactly.
module creep_laws
   use kinds, only: dp
   use table_rows, only: find_row
   implicit none
   private
   public :: creep_type, exp_less_one, hardens_by_time, hardens_by_strain, log_one_and

   integer, parameter :: hardens_by_time = 1, hardens_by_strain = 2

   !> The law of a material; without rows it does not creep.
   type :: creep_type
      integer :: kind = hardens_by_time
      real(dp), allocatable :: temperature(:)   !! (rows) ascending
      real(dp), allocatable :: constants(:, :)  !! (3, rows) A, n, m
   contains
      procedure :: creeps
      procedure :: find_strain
   end type creep_type

contains

   !> Whether the material creeps.
   elemental logical function creeps(self)
      class(creep_type), intent(in) :: self

      creeps = allocated(self%constants)
   end function creeps

   !> Creep strain that a constant stress makes in an increment, and its slope by the stress.
   pure subroutine find_strain(self, stress, temperature, before, instants, strain, slope)
      class(creep_type), intent(in) :: self
      real(dp), intent(in) :: stress            !! q > 0 [stress]
      real(dp), intent(in) :: temperature
      real(dp), intent(in) :: before            !! equivalent creep strain at its start [-]
      real(dp), intent(in) :: instants(2)       !! its start and its end [time]
      real(dp), intent(out) :: strain           !! [-]
      real(dp), intent(out) :: slope            !! [1/stress]
      real(dp) :: constants(3), part, power, reached, term
      integer :: row

      call find_row(self%temperature, temperature, row, part)
      constants = self%constants(:, row)
      if (part > 0.0_dp) constants = constants + part*(self%constants(:, row + 1) - constants)
      associate (a => constants(1), n => constants(2), m => constants(3))
         power = m + 1.0_dp
         if (self%kind == hardens_by_time .or. abs(m) <= 0.0_dp) then
            ! Nothing cancels where m is 0 and times are large.
            term = instants(2) - instants(1)
            if (abs(m) > 0.0_dp) term = (instants(2)**power - instants(1)**power)/power
            strain = a*stress**n*term
            slope = n*strain/stress
         else
            ! eps^(1/(m + 1)) grows evenly.
            term = (a*stress**n/power)**(1.0_dp/power)*(instants(2) - instants(1))
            reached = before**(1.0_dp/power)
            if (reached > 0.0_dp) then
               strain = before*exp_less_one(power*log_one_and(term/reached))
            else
               strain = term**power
            end if
            slope = 0.0_dp
            if (term > 0.0_dp) slope = (reached + term)**m*term*n/stress
         end if
      end associate
   end subroutine find_strain

   !> exp(x) - 1 without cancellation (Kahan).
   elemental real(dp) function exp_less_one(x)
      real(dp), intent(in) :: x
      real(dp) :: rounded

      rounded = exp(x)
      exp_less_one = rounded - 1
      if (abs(x) < 1.0_dp .and. abs(exp_less_one) > 0.0_dp) exp_less_one = exp_less_one*x/ &
         log(rounded)
      if (abs(exp_less_one) <= 0.0_dp) exp_less_one = x
   end function exp_less_one

   !> ln(1 + x) likewise.
   elemental real(dp) function log_one_and(x)
      real(dp), intent(in) :: x              !! > -1
      real(dp) :: rounded

      rounded = 1 + x
      log_one_and = x
      if (abs(rounded - 1) > 0.0_dp) log_one_and = log(rounded)*(x/(rounded - 1))
   end function log_one_and

end module creep_laws
