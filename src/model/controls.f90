!> Controls of the numerical method: fixed point, scheme of (3.4), solver.
module controls
   use kinds, only: dp
   implicit none
   private
   public :: continuation_type, fixed_point_type, start_type, thermal_scheme_type, start_previous, &
      start_open, start_closed, start_both, start_given, implicit_scheme, galerkin_scheme, &
      crank_nicolson_scheme, explicit_scheme, l_stable_scheme, stage_part, method_picard, &
      method_zaitsev, method_anderson, method_newton, method_names, solver_by_size, &
      solver_skyline, solver_mumps, mumps_from, default_solver, tail_by_size, tail_full, tail_sparse

   integer, parameter :: method_picard = 1    !! eq. (4.1)
   integer, parameter :: method_zaitsev = 2   !! eq. (4.2)
   integer, parameter :: method_anderson = 3  !! Anderson's mixing of log omega
   integer, parameter :: method_newton = 4    !! semismooth Newton
   character(8), parameter :: method_names(4) = [character(8) :: 'PICARD', 'ZAITSEV', 'ANDERSON', &
      'NEWTON']   !! of *FIXED POINT, by the constants above
   integer, parameter :: solver_by_size = 0   !! the faster of both, until the mesh is known
   integer, parameter :: solver_skyline = 1   !! Crout LDL^T on a skyline
   integer, parameter :: solver_mumps = 2     !! MUMPS with METIS ordering
   integer, parameter :: tail_by_size = 0     !! contact unknowns by their number
   integer, parameter :: tail_full = 1        !! in one full matrix
   integer, parameter :: tail_sparse = 2      !! sparse, beside the faces of the bodies

   !> Unknowns of a model from which MUMPS is the faster solver. Measured, docs/performance.md.
   integer, parameter :: mumps_from = 5000

   integer, parameter :: start_previous = 1   !! from the last increments
   integer, parameter :: start_open = 2       !! from no heat across the contact points
   integer, parameter :: start_closed = 3     !! from perfect contact
   integer, parameter :: start_both = 4       !! from the last increments, and from both ends
   integer, parameter :: start_given = 5      !! from given conductances

   !> *START.
   type :: start_type
      integer :: kind = start_previous          !! one of the start_* constants
      real(dp), allocatable :: conductance(:)   !! (contacts) of start_given [power/(l^2 temp.)]
   end type start_type

   !> *FIXED POINT.
   type :: fixed_point_type
      integer :: method = method_newton       !! one of the method_* constants
      real(dp) :: tolerance = 1.0e-8_dp       !! on max |U(w) - w|/w [-]
      integer :: max_iterations = 50          !! passes of U in an increment
      real(dp) :: g = 0.5_dp                  !! constant g of the first iterations, in (0, 1]
      integer :: constant = 3                 !! number of iterations with the constant g
      logical :: finds_gain = .true.          !! whether the gain at the solution is found
   end type fixed_point_type

   !> *CONTINUATION.
   type :: continuation_type
      logical :: is_on = .false.
      integer :: most_points = 200             !! POINTS=
      real(dp) :: range(2) = [0.0_dp, 1.0_dp]  !! LOWEST=, HIGHEST=: of the load factor [-]
      real(dp) :: longest_step = 0.05_dp       !! ARC=: between points [-]
      logical :: rises = .true.                !! DIRECTION=UP: the load factor at first
   end type continuation_type

   !> Coefficients of eq. (3.4), with a1 + b1 = 1.
   type :: thermal_scheme_type
      real(dp) :: a(3)                !! a1, a2, a3
      real(dp) :: b(3)                !! b1, b2, b3
      real(dp) :: c(2)                !! c1, c2
      character(14) :: name = 'FREE'  !! TYPE= of *THERMAL SCHEME
      integer :: stages = 1           !! implicit solutions that make an increment
   end type thermal_scheme_type

   !> The implicit scheme of the paper: a1 = a3 = c2 = 1.
   type(thermal_scheme_type), parameter :: implicit_scheme = thermal_scheme_type([1.0_dp, 0.0_dp, &
      1.0_dp], [0.0_dp, 0.0_dp, 0.0_dp], [0.0_dp, 1.0_dp], 'IMPLICIT')

   !> Galerkin's scheme of the paper: weight tau on [0, 1], T and G linear in tau.
   type(thermal_scheme_type), parameter :: galerkin_scheme = thermal_scheme_type([4.0_dp, 1.0_dp, &
      3.0_dp]/6.0_dp, [2.0_dp, 1.0_dp, 1.0_dp]/6.0_dp, [1.0_dp, 2.0_dp]/3.0_dp, 'GALERKIN')

   !> Crank and Nicolson's scheme: the mean of both ends, with the mean of both G.
   type(thermal_scheme_type), parameter :: crank_nicolson_scheme = &
      thermal_scheme_type([2.0_dp, 1.0_dp, 1.0_dp]/4.0_dp, [2.0_dp, 1.0_dp, 1.0_dp]/4.0_dp, &
      [1.0_dp, 1.0_dp]/2.0_dp, 'CRANK-NICOLSON')

   !> Explicit in omega: G of the start of the increment.
   type(thermal_scheme_type), parameter :: explicit_scheme = thermal_scheme_type([1.0_dp, 1.0_dp, &
      0.0_dp], [0.0_dp, 0.0_dp, 0.0_dp], [0.0_dp, 1.0_dp], 'EXPLICIT')

   !> The singly diagonally implicit scheme of two stages, L-stable and of second order (R.
   !> Alexander, SIAM J. Numer. Anal. 14 (1977) 1006): both stages are implicit ones of a part of
   !> the increment.
   type(thermal_scheme_type), parameter :: l_stable_scheme = thermal_scheme_type([1.0_dp, 0.0_dp, &
      1.0_dp], [0.0_dp, 0.0_dp, 0.0_dp], [0.0_dp, 1.0_dp], 'L-STABLE', 2)
   real(dp), parameter :: stage_part = 1.0_dp - sqrt(0.5_dp)   !! gamma, this part

contains

   !> The solver of a deck without *SOLVER: by its displacements, without mechanics temperatures.
   pure integer function default_solver(nodes, with_mechanics)
      real(dp), intent(in) :: nodes              !! number of all nodes
      logical, intent(in) :: with_mechanics      !! whether any step solves it

      default_solver = merge(solver_mumps, solver_skyline, merge(2, 1, with_mechanics)*nodes >= &
         mumps_from)
   end function default_solver

end module controls
