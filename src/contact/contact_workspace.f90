!> Workspace of one trial solution of the contact system: what the increment applies to it, the
!> laws of contact points that close in the increment, and the factors of the active set of the
!> moment. A second trial takes a workspace of its own.
module contact_workspace
   use contact_factors, only: contact_factors_type
   use contact_system, only: closing_law_type, contact_open, contact_rows_type, contact_slip, &
      contact_state_type, contact_stick, contact_system_type, is_capped, rows_of, slip_force, &
      state_code
   use errors, only: check_finite, error_type, set_error, status_no_convergence
   use friction_laws, only: friction_law_type
   use kinds, only: dp
   use overlap_laws, only: overlap_law_type
   use pressure_overclosure, only: pressure_overclosure_type
   use sum_lists, only: sum_list_type
   implicit none
   private
   public :: contact_workspace_type

   !> Part of the rounding of coordinates: a load that moves a contact point no farther is a
   !> remainder of loads that were taken off.
   real(dp), parameter :: unresolved = 1.0e-3_dp

   !> Compliance of the contact points of an interface that close in the increment.
   type :: compliance_type
      real(dp), allocatable :: matrix(:, :)   !! (2n, 2n), unallocated until it is sought
   end type compliance_type

   !> What the ways of closing contact points go by, and the set that it belongs to.
   type :: kept_compliances_type
      logical, allocatable :: holds(:)                !! (m) closed in the end
      real(dp), allocatable :: stiffness(:)           !! (m) of soft faces [force/length]
      type(compliance_type), allocatable :: compliance(:)   !! (interfaces)
   end type kept_compliances_type

   !> What the increment applies, and the laws under its load.
   type :: contact_conditions_type
      real(dp), allocatable :: initial_gap(:)     !! (m) h [length]
      type(friction_law_type), allocatable :: friction(:)   !! (m) of nodal forces
      type(pressure_overclosure_type) :: soft               !! tangents of soft faces
      logical, allocatable :: removed(:)          !! (m) open whatever the gap
      real(dp) :: load_scale = 0.0_dp !! largest force that the load is condensed of [force]
      real(dp), allocatable :: least_drive(:) !! (tail) resultants that count as none [force]
      type(closing_law_type), allocatable :: closing(:) !! (m) laws of closing contact points
      !> (tail) relative displacements that unconstrained motions are least from
      real(dp), allocatable :: anchor(:)
   end type contact_conditions_type

   !> These, and the factors for the active set of the last solution.
   type, extends(contact_conditions_type) :: contact_workspace_type
      !> Largest sum of the terms that make a force of the last solution, S d - c, without their
      !> signs: what its rounding goes by where they cancel, as in a body that contact moves [force]
      real(dp) :: largest_term = 0.0_dp
      !> Stiffness that holds the unsupported motions softly, 0 for none [force/length]
      real(dp) :: hold = 0.0_dp
      logical :: keeps_laws = .false.             !! they do not settle in this increment: they stay
      !> Change of a slip by which laws that have settled still differ, beside rounding; above 0
      !> where faces slide, whose places are known no better [length]
      real(dp) :: same_slip = 0.0_dp
      !> (tail, 2) displacements of the last solution on a sparse tail, and S times these
      real(dp), allocatable :: known(:, :)
      type(contact_rows_type) :: rows             !! rows of the active set
      type(sum_list_type) :: unconstrained        !! (l, tail) motions that the set leaves free
      real(dp), allocatable :: drive(:)           !! (l) forces along them that nothing takes up
      logical :: driven = .false.                 !! whether these are more than rounding
      logical, allocatable :: idle(:)  !! (m) closed contact points that carry nothing (idle_points)
      integer :: factorisations = 0               !! of active sets, so far
      type(kept_compliances_type) :: kept         !! where contact points that are closed hold
      logical :: goes_on_changing = .false.       !! whether which ones do changes without end
      logical :: several = .false.                !! whether other states under the load are proven
      type(contact_factors_type) :: factors       !! of these rows
      integer, allocatable, private :: factored(:)   !! (m) state codes of the factors
      type(closing_law_type), allocatable, private :: factored_closing(:) !! (m) and their laws
      real(dp), allocatable, private :: factored_stiffness(:) !! (m) and those of soft faces
   contains
      procedure :: another
      procedure :: solve_set
      procedure :: solve_free
      procedure :: solve_transposed
      procedure :: stiffness
      procedure :: turns_back
      procedure :: slip
      procedure :: gap_rounding
      procedure :: factor_set
      procedure :: factor_rows
      procedure :: keep_holding
   end type contact_workspace_type

   interface contact_workspace_type
      module procedure new_workspace
   end interface contact_workspace_type

contains

   !> A workspace for contact points with these gaps and laws, on which nothing acts.
   pure function new_workspace(system, initial_gap, friction, removed, overlap, area) result(work)
      type(contact_system_type), intent(in) :: system  !! the reduced system
      real(dp), intent(in) :: initial_gap(:)           !! (m) h [length]
      type(friction_law_type), intent(in) :: friction(:) !! (m) of nodal forces
      logical, intent(in) :: removed(:)                !! (m) open whatever the gap
      !> (m) laws of soft faces; absent where all are hard
      type(overlap_law_type), intent(in), optional :: overlap(:)
      real(dp), intent(in), optional :: area(:)        !! (m) with these laws [length^2]
      type(contact_workspace_type) :: work             !! nothing closed, nothing factored

      work%initial_gap = initial_gap
      work%friction = friction
      work%removed = removed
      work%soft = pressure_overclosure_type(size(initial_gap), overlap, area)
      allocate (work%least_drive(system%schur%order), source=0.0_dp)
      allocate (work%anchor(system%schur%order), source=0.0_dp)
      allocate (work%closing(size(initial_gap)))
      allocate (work%idle(size(initial_gap)), source=.false.)
   end function new_workspace

   !> A workspace for another trial under the same load, with the same laws.
   pure function another(self) result(work)
      class(contact_workspace_type), intent(in) :: self  !! of the first trial
      type(contact_workspace_type) :: work               !! nothing factored

      work%contact_conditions_type = self%contact_conditions_type
   end function another

   !> Tangential motion of a contact point since friction acts on it in this increment.
   pure function slip(self, system, state, k)
      class(contact_workspace_type), intent(in) :: self !! laws of closing
      type(contact_system_type), intent(in) :: system   !! the reduced system
      type(contact_state_type), intent(in) :: state
      integer, intent(in) :: k                          !! the contact point
      real(dp) :: slip                                  !! [length]

      associate (law => self%closing(k))
         if (law%acts) then
            slip = (1.0_dp - law%fraction)*(state%tangential(k) - law%start) + law%lag(state)
         else
            slip = state%tangential(k) - state%reference(k)
         end if
         slip = slip + system%compliance(k)*state%shear_force(k)
      end associate
   end function slip

   !> Gap and slip that are rounding.
   pure real(dp) function gap_rounding(self, system, state)
      class(contact_workspace_type), intent(in) :: self
      type(contact_system_type), intent(in) :: system
      type(contact_state_type), intent(in) :: state      !! [length]

      gap_rounding = 1.0e-13_dp*maxval([0.0_dp, abs(state%gap), abs(self%initial_gap), &
         abs(state%tangential)]) + system%least_length + tiny(1.0_dp)
   end function gap_rounding

   !> Solution for one active set. Where the load drives a body that the set leaves unconstrained,
   !> driven is set, and the values stay as they are.
   !> Errors: as factor_set; a body is driven away; forces overflow.
   subroutine solve_set(self, system, load, state, error)
      class(contact_workspace_type), intent(inout) :: self
      type(contact_system_type), intent(in) :: system      !! the reduced system
      real(dp), intent(in) :: load(:)                      !! (tail) c [force]
      type(contact_state_type), intent(inout) :: state     !! its states in, the values out
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: d(size(load)), lambda(size(load)), residual(size(load), 1), terms(size(load))
      real(dp), allocatable :: unbalanced(:, :)
      integer :: k

      self%driven = .false.
      call self%factor_set(system, state, error)
      if (allocated(error)) return
      d = 0.0_dp
      if (allocated(self%known)) d(self%rows%free) = self%known(self%rows%free, 1)
      residual = 0.0_dp
      do k = 1, size(state%contact_state)
         if (state%contact_state(k) == contact_open) cycle
         d(system%normal(k)) = self%initial_gap(k)
         if (system%tangent(k) == 0) cycle
         if (state%contact_state(k) == contact_stick) then
            d(system%tangent(k)) = start_of_slip(self, state, k)
         else if (is_capped(state%direction(k))) then
            ! The friction is the largest whatever the pressure.
            residual(system%tangent(k), 1) = slip_force(state%direction(k), self%friction(k), &
               0.0_dp)
         end if
      end do
      call find_forces(self, system, d, lambda)
      residual(:, 1) = load + residual(:, 1) - lambda
      call self%solve_free(residual, unbalanced)
      d(self%rows%free) = d(self%rows%free) + residual(self%rows%free, 1)
      if (self%unconstrained%count > 0) then
         self%drive = unbalanced(:, 1)
         call check_balance(self, system, load, d, error)
         if (allocated(error)) return
         call move_least(self, system, state, d)
      end if
      terms = abs(load)
      call find_forces(self, system, d, lambda, terms)
      if (system%schur%is_sparse() .and. self%hold <= 0.0_dp) self%known = reshape([d, lambda], &
         [size(d), 2])
      lambda = lambda - load
      self%largest_term = maxval(terms)
      call check_finite([d, lambda], 'displacements and forces of the contact', &
         status_no_convergence, error)
      if (allocated(error)) return
      call take_values(self, system, d, lambda, state)
   end subroutine solve_set

   !> The values of a solution.
   pure subroutine take_values(self, system, d, lambda, state)
      type(contact_workspace_type), intent(in) :: self
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: d(:), lambda(:)
      type(contact_state_type), intent(inout) :: state
      integer :: k

      state%link = d(system%link)
      state%approach = d(system%normal)
      do k = 1, size(state%contact_state)
         state%gap(k) = self%initial_gap(k) - d(system%normal(k))
         state%force(k) = -lambda(system%normal(k))
         if (state%contact_state(k) == contact_open) then
            state%force(k) = 0.0_dp
         else
            state%gap(k) = 0.0_dp
         end if
         if (system%tangent(k) == 0) cycle
         state%tangential(k) = d(system%tangent(k))
         select case (state%contact_state(k))
         case (contact_open)
            state%shear_force(k) = 0.0_dp
         case (contact_slip)
            state%shear_force(k) = slip_force(state%direction(k), self%friction(k), &
               state%force(k))
         case default
            state%shear_force(k) = lambda(system%tangent(k))
         end select
      end do
   end subroutine take_values

   !> Position from which the slip of a contact point counts, but for what its forces add.
   pure real(dp) function start_of_slip(self, state, k)
      type(contact_workspace_type), intent(in) :: self
      type(contact_state_type), intent(in) :: state
      integer, intent(in) :: k

      start_of_slip = merge(self%closing(k)%start, state%reference(k), self%closing(k)%acts)
   end function start_of_slip

   !> S d, with the soft hold. On a sparse tail face nodes have the displacements of their bodies,
   !> beside which strains are small: forces go by the change from the last solution, so that they
   !> have the same rounding from pass to pass, unless that one was farther away.
   pure subroutine find_forces(self, system, d, lambda, terms)
      type(contact_workspace_type), intent(in) :: self
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: d(:)
      real(dp), intent(out) :: lambda(:)
      real(dp), intent(inout), optional :: terms(:)   !! receives the moduli of the terms of S d
      real(dp), dimension(size(d)) :: change, rest

      call system%schur%add_product(d, lambda, terms)
      if (allocated(self%known)) then
         change = d - self%known(:, 1)
         if (maxval(abs(change)) <= maxval(abs(d))) then
            call system%schur%add_product(change, rest)
            lambda = self%known(:, 2) + rest
         end if
      end if
      if (self%hold > 0.0_dp) lambda = lambda + &
         self%hold*system%motions%combined(system%motions%along(d))
   end subroutine find_forces

   !> Whether the load drives the unconstrained motions, by more than rounding.
   !> Error: it does.
   subroutine check_balance(self, system, load, d, error)
      type(contact_workspace_type), intent(inout) :: self
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: load(:), d(:)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: forces(size(d)), least(size(d)), terms(size(d))

      terms = abs(load)
      call system%schur%add_product(d, forces, terms)
      least = self%least_drive + unresolved*system%least_length*abs(system%own)
      self%driven = system%motions%is_driven(self%unconstrained, self%drive, terms, least)
      if (self%driven) call set_error(error, status_no_convergence, &
         'the supports and the closed contact points do not hold what the loads drive')
   end subroutine check_balance

   !> Moves unconstrained bodies so that contact points slip least, and open ones stay at the
   !> anchor.
   subroutine move_least(self, system, state, d)
      type(contact_workspace_type), intent(in) :: self
      type(contact_system_type), intent(in) :: system
      type(contact_state_type), intent(in) :: state
      real(dp), intent(inout) :: d(:)
      real(dp) :: way(size(d))
      logical :: counts(size(d))
      integer :: k

      way = 0.0_dp
      do k = 1, size(state%contact_state)
         associate (normal => system%normal(k), tangent => system%tangent(k))
            if (state%contact_state(k) == contact_open) way(normal) = d(normal) - &
               self%anchor(normal)
            if (tangent == 0) cycle
            way(tangent) = d(tangent) - self%anchor(tangent)
            if (state%contact_state(k) /= contact_slip) cycle
            way(tangent) = d(tangent) - start_of_slip(self, state, k)
         end associate
      end do
      ! Face nodes follow; their way is no length.
      counts = .true.
      counts(system%link) = .not. system%schur%is_sparse()
      call system%motions%approach(self%unconstrained, counts, way, d)
   end subroutine move_least

   !> Factors the system of an active set, unless that is the set factored last.
   !> Error: the system is singular.
   subroutine factor_set(self, system, state, error)
      class(contact_workspace_type), intent(inout) :: self
      type(contact_system_type), intent(in) :: system      !! the reduced system
      type(contact_state_type), intent(in) :: state        !! states and directions
      type(error_type), allocatable, intent(out) :: error
      logical :: singular

      if (is_factored(self, state)) return
      self%rows = rows_of(system, self%friction%coefficient, state, self%closing, self%soft)
      if (self%hold > 0.0_dp) then
         call self%unconstrained%reserve(0, 0)
      else
         self%unconstrained = system%free_motions(self%rows)
      end if
      call self%factor_rows(system, singular)
      self%factorisations = self%factorisations + 1
      if (singular) then
         call set_error(error, status_no_convergence, 'the contact system is singular')
      else
         self%factored = state_code(state)
         self%factored_closing = self%closing
         self%factored_stiffness = self%soft%stiffness
      end if
   end subroutine factor_set

   !> Whether the factors are those of an active set. Where closing starts does not enter them, and
   !> its law does only where the contact point sticks.
   pure logical function is_factored(self, state)
      type(contact_workspace_type), intent(in) :: self
      type(contact_state_type), intent(in) :: state
      integer :: k

      is_factored = .false.
      if (.not. allocated(self%factored)) return
      if (any(self%factored /= state_code(state))) return
      if (any(state%contact_state /= contact_open .and. &
         abs(self%soft%stiffness - self%factored_stiffness) > 0.0_dp)) return
      do k = 1, size(self%closing)
         associate (law => self%closing(k), factored => self%factored_closing(k))
            if (state%contact_state(k) /= contact_stick) cycle
            if (law%acts .neqv. factored%acts) return
            if (.not. law%acts) cycle
            if (abs(law%fraction - factored%fraction) > 0.0_dp) return
            if (any(abs(law%compliance - factored%compliance) > 0.0_dp)) return
         end associate
      end do
      is_factored = .true.
   end function is_factored

   !> Factors the rows as they are, bordered by the unconstrained motions.
   pure subroutine factor_rows(self, system, singular)
      class(contact_workspace_type), intent(inout) :: self
      type(contact_system_type), intent(in) :: system      !! the reduced system
      logical, intent(out) :: singular                     !! the rows depend on each other

      if (allocated(self%factored)) deallocate (self%factored)
      call self%factors%factor(system, self%rows, self%hold, self%unconstrained, singular)
   end subroutine factor_rows

   !> Forgets compliances beside other closed contact points than these.
   pure subroutine keep_holding(self, holds, interfaces)
      class(contact_workspace_type), intent(inout) :: self
      logical, intent(in) :: holds(:)                      !! (m)
      integer, intent(in) :: interfaces                    !! their number

      if (allocated(self%kept%holds)) then
         if (all(self%kept%holds .eqv. holds) .and. all(abs(self%kept%stiffness - &
            self%soft%stiffness) <= 0.0_dp)) return
         deallocate (self%kept%compliance)
      end if
      self%kept%holds = holds
      self%kept%stiffness = self%soft%stiffness
      allocate (self%kept%compliance(interfaces))
   end subroutine keep_holding

   !> Free displacements that take up forces, with the factors of the last active set.
   pure subroutine solve_free(self, x, unbalanced)
      class(contact_workspace_type), intent(in) :: self  !! factors
      real(dp), intent(inout) :: x(:, :) !! (tail, columns) forces; displacements in free rows
      !> (l, columns) forces along the unconstrained motions that nothing takes up.
      real(dp), allocatable, intent(out), optional :: unbalanced(:, :)
      real(dp) :: of_rows(size(x, 1), size(x, 2))

      of_rows = self%rows%combine(x)
      call self%factors%solve(of_rows, unbalanced)
      x(self%rows%free, :) = of_rows(self%rows%free, :)
   end subroutine solve_free

   !> Sums of the forces, from sums of the free displacements that take them up: the transposed of
   !> solve_free, on a sparse tail.
   pure subroutine solve_transposed(self, x)
      class(contact_workspace_type), intent(in) :: self  !! factors
      real(dp), intent(inout) :: x(:) !! (tail) factors of displacements in, those of forces out
      real(dp) :: in_rows(size(x))

      in_rows = 0.0_dp
      in_rows(self%rows%free) = x(self%rows%free)
      call self%factors%solve_transposed(in_rows)
      x = 0.0_dp
      call self%rows%forces%add_shares(in_rows, x)
   end subroutine solve_transposed

   !> Forces at some rows of the tail for unit displacements there, the free ones following; with
   !> the factors of the last active set. Source: (2.4), statically condensed.
   pure function stiffness(self, system, tail_rows)
      class(contact_workspace_type), intent(in) :: self     !! factors
      type(contact_system_type), intent(in) :: system       !! the reduced system
      integer, intent(in) :: tail_rows(:)                   !! (n) rows that are not free
      real(dp) :: stiffness(size(tail_rows), size(tail_rows)) !! (n, n) [force/length]
      real(dp), dimension(system%schur%order, size(tail_rows)) :: columns, response

      columns = system%schur%columns(tail_rows)
      response = -columns
      call self%solve_free(response)
      stiffness = columns(tail_rows, :) + &
         matmul(transpose(columns(self%rows%free, :)), response(self%rows%free, :))
   end function stiffness

   !> Whether the set factored last turns the path of contact states back: its determinant is
   !> negative, which needs friction. The signs at all states under one load add up to one, so that
   !> then there are others. Closing laws, frozen in the set, are no part of that: with them none is
   !> seen to turn.
   pure logical function turns_back(self, system)
      class(contact_workspace_type), intent(in) :: self  !! factors
      type(contact_system_type), intent(in) :: system    !! the reduced system

      turns_back = .false.
      if (any(self%closing%acts)) return
      ! Every link and every unconstrained motion borders a positive matrix, which turns its sign.
      turns_back = self%factors%is_negative() .neqv. &
         (mod(system%links + self%unconstrained%count, 2) == 1)
   end function turns_back

end module contact_workspace
