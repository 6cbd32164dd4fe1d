!> The stepping scheme (3.4), eq. (3.3) of one increment.
!>
!> The unknown of a contact point is its jump theta = T_xi - T_eta, not two temperatures whose
!> difference a large omega would swallow. G(omega), lumped on the contact points, then is the
!> diagonal weight*omega of the jumps: positive semidefinite for any omega >= 0 and exact however
!> large. Scheme (3.4), divided by a1, reads
!>
!>    (K + diag(d)) T_i+1 = rhs,   d = weight (a2 omega_i + a3 omega_i+1)/a1,
!>    rhs = -(b1 K T_i + weight (b2 omega_i + b3 omega_i+1) theta_i - c1 Q_i - c2 Q_i+1)/a1,
!>
!> the terms with weight standing in the rows of the jumps only. Films, conductances of faces to a
!> sink, are beside G: their matrices F have the weights of G. Where c1 = 0 loads act as they are at
!> t_i+1, and films, which are loads, with them. Bodies that store heat, (1.2), add
!> C (T_i+1 - T*)/(a1 dt) on the left, where T* is T_i; in the second of two stages, what the first
!> one makes of it (hold_heat).
module heat_equation
   use controls, only: implicit_scheme, thermal_scheme_type
   use kinds, only: dp
   use sparse_matrix, only: linear_combination, sparse_matrix_type
   implicit none
   private
   public :: heat_across, heat_equation_type, heat_rates_type, heat_sources_type

   real(dp), parameter :: undamped = 1.0_dp - 1.0e-9_dp   !! amplification that damps nothing

   !> Sources of heat at one instant.
   type :: heat_sources_type
      real(dp), allocatable :: load(:)              !! (nodes) Q of (3.3) [power]
      !> (nodes, nodes) F of films; without values where there is none [power/temperature]
      type(sparse_matrix_type) :: film = sparse_matrix_type()
   contains
      procedure :: net_heat
   end type heat_sources_type

   !> Heat rates at one instant, or those that (3.4) balances.
   type :: heat_rates_type
      real(dp), allocatable :: conducted(:)         !! (nodes) K T of the bodies alone [power]
      real(dp), allocatable :: entering(:)          !! (nodes) by loads and films, Q - F T [power]
      real(dp), allocatable :: crossing(:)          !! (m) from slave to master [power]
      real(dp), allocatable :: stored(:)            !! (nodes) by heat capacities, or none [power]
      real(dp), allocatable :: friction_heat(:) !! (n) by friction at contact points [power]
   end type heat_rates_type

   !> Eq. (3.4) of one increment, from what is known at its start.
   type :: heat_equation_type
      type(thermal_scheme_type) :: scheme = implicit_scheme
      !> At t_i and at t_i+1.
      type(heat_sources_type) :: old = heat_sources_type(), new = heat_sources_type()
      real(dp), allocatable :: temperature_old(:)   !! (nodes) T_i [temperature]
      real(dp), allocatable :: weight(:)            !! (m) tributary areas [length^2]
      real(dp), allocatable :: omega_old(:)         !! (m) omega_i
      real(dp), allocatable :: jump_old(:)          !! (m) theta_i [temperature]
      !> a1 dt, 0 where no heat is stored [time]
      real(dp) :: duration = 0.0_dp
      real(dp), allocatable :: content_old(:)       !! (nodes) C T* [energy]
      real(dp), allocatable :: stored_old(:)        !! (nodes) rate of stored heat at t_i [power]
      !> (nodes) heat that is taken up in dt beside C: by strains, and where C does not follow the
      !> temperatures; unallocated where there is none [energy]
      real(dp), allocatable :: taken_up(:)
      !> (nodes) heat that K conducts beyond the bodies at t_i and t_i+1; unallocated where K
      !> follows their temperatures [power]
      real(dp), allocatable :: beyond_old(:), beyond(:)
   contains
      procedure :: takes_past_conductance
      procedure :: is_explicit
      procedure :: amplification
      procedure :: never_damps
      procedure :: hold_heat
      procedure :: stored_rate
      procedure :: left_film
      procedure :: history
      procedure :: contact_diagonal
      procedure :: contact_history
      procedure :: crossing_by_omega
      procedure :: flux_conductance
      procedure :: rates
      procedure :: rates_at_start
   end type heat_equation_type

contains

   !> Heat that crosses a contact point from slave to master; of a unit area, its heat flux.
   elemental real(dp) function heat_across(weight, omega, jump)
      real(dp), intent(in) :: weight   !! tributary area [length^2]
      real(dp), intent(in) :: omega    !! conductance [power/(length^2 temperature)]
      real(dp), intent(in) :: jump     !! T_xi - T_eta [temperature]

      heat_across = weight*omega*jump
   end function heat_across

   !> Whether heat across contact points depends on their conductances or jumps at the start of the
   !> increment, by G_i or beside T_i.
   pure logical function takes_past_conductance(self)
      class(heat_equation_type), intent(in) :: self

      associate (a => self%scheme%a, b => self%scheme%b)
         takes_past_conductance = abs(a(2)) + abs(b(2)) + abs(b(3)) > 0.0_dp
      end associate
   end function takes_past_conductance

   !> Whether omega at the end of the increment has no part in its temperatures: a3 = b3 = 0.
   pure logical function is_explicit(self)
      class(heat_equation_type), intent(in) :: self

      is_explicit = abs(self%scheme%a(3)) + abs(self%scheme%b(3)) <= 0.0_dp
   end function is_explicit

   !> Factor per increment of an initial imbalance at constant omega, below 1 in modulus where
   !> imbalances die away. Every mode has a factor between -b1/a1, its own where only K acts, and
   !> -(b2 + b3)/(a2 + a3), its own where only G acts; the one of larger modulus is given. Both are
   !> -b1/a1 for the schemes with names.
   pure real(dp) function amplification(self)
      class(heat_equation_type), intent(in) :: self
      real(dp) :: of_contact

      associate (a => self%scheme%a, b => self%scheme%b)
         amplification = -b(1)/a(1)
         of_contact = -(b(2) + b(3))/(a(2) + a(3))
      end associate
      if (abs(of_contact) > abs(amplification)) amplification = of_contact
   end function amplification

   !> Whether an imbalance at the start of a step stays for ever.
   pure logical function never_damps(self)
      class(heat_equation_type), intent(in) :: self

      never_damps = abs(self%amplification()) >= undamped
   end function never_damps

   !> Bodies store heat.
   pure subroutine hold_heat(self, capacity, duration, temperature, stored)
      class(heat_equation_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: capacity  !! C [energy/temperature]
      real(dp), intent(in) :: duration                  !! dt of the increment or stage [time]
      real(dp), intent(in) :: temperature(:)            !! (nodes) T* [temperature]
      real(dp), intent(in) :: stored(:)                 !! (nodes) rate of stored heat at t_i

      self%duration = self%scheme%a(1)*duration
      self%content_old = capacity%multiply(temperature)
      self%stored_old = stored
   end subroutine hold_heat

   !> Rate of heat that is stored, or taken up by strains, at the end of the increment: the mean is
   !> a1 of it and b1 of that at the start.
   pure function stored_rate(self, capacity, temperature) result(stored)
      class(heat_equation_type), intent(in) :: self     !! that stores heat
      type(sparse_matrix_type), intent(in) :: capacity  !! C [energy/temperature]
      real(dp), intent(in) :: temperature(:)            !! (nodes) T_i+1 [temperature]
      real(dp) :: stored(size(temperature))             !! (nodes) [power]

      stored = gain(self, capacity, temperature)/self%duration
      associate (a => self%scheme%a, b => self%scheme%b)
         if (abs(b(1)) > 0.0_dp) stored = stored - b(1)/a(1)*self%stored_old
      end associate
   end function stored_rate

   !> Heat that is stored and taken up from the start of the increment on.
   pure function gain(equation, capacity, temperature) result(heat)
      type(heat_equation_type), intent(in) :: equation
      type(sparse_matrix_type), intent(in) :: capacity
      real(dp), intent(in) :: temperature(:)
      real(dp) :: heat(size(temperature))

      heat = capacity%multiply(temperature) - equation%content_old
      if (allocated(equation%taken_up)) heat = heat + equation%taken_up
   end function gain

   !> F and C/(a1 dt) beside K on the left of (3.4) divided by a1; without values where no film acts
   !> and no heat is stored.
   pure function left_film(self, capacity) result(film)
      class(heat_equation_type), intent(in) :: self     !! scheme and sources
      type(sparse_matrix_type), intent(in) :: capacity  !! C; without values where there is none
      type(sparse_matrix_type) :: film                  !! (nodes, nodes) [power/temperature]
      real(dp) :: part(2)

      if (has_entries(self%old%film) .or. has_entries(self%new%film)) then
         part = film_parts(self%scheme, self%scheme%a)
         film = linear_combination(part(1), self%old%film, part(2), self%new%film)
      end if
      if (self%duration <= 0.0_dp) return
      if (has_entries(film)) then
         film = linear_combination(1.0_dp, film, 1.0_dp/self%duration, capacity)
      else
         film = capacity
         film%value = film%value/self%duration
      end if
   end function left_film

   !> Parts of F_i and F_i+1 in a bracket of (3.4) divided by a1.
   pure function film_parts(scheme, coefficients) result(parts)
      type(thermal_scheme_type), intent(in) :: scheme
      real(dp), intent(in) :: coefficients(3)           ! a or b
      real(dp) :: parts(2)

      parts = coefficients(2:3)/scheme%a(1)
      if (abs(scheme%c(1)) <= 0.0_dp) parts = [0.0_dp, sum(parts)]
   end function film_parts

   !> Right-hand side of (3.4) divided by a1, without the terms of the contact points.
   pure function history(self, conduction) result(rhs)
      class(heat_equation_type), intent(in) :: self
      type(sparse_matrix_type), intent(in) :: conduction   !! K
      real(dp) :: rhs(size(self%temperature_old))          !! (nodes) [power]

      rhs = film_history(self)
      associate (a => self%scheme%a, b => self%scheme%b, c => self%scheme%c)
         if (abs(b(1)) > 0.0_dp) rhs = -b(1)/a(1)*conduction%multiply(self%temperature_old) + rhs
         rhs = rhs + (c(1)*self%old%load + c(2)*self%new%load)/a(1)
         if (self%duration > 0.0_dp) rhs = rhs + self%content_old/self%duration
         if (allocated(self%taken_up)) rhs = rhs - self%taken_up/self%duration
         if (allocated(self%beyond)) rhs = rhs + self%beyond + b(1)/a(1)*self%beyond_old
      end associate
   end function history

   !> Part of the films in it.
   pure function film_history(self) result(rhs)
      class(heat_equation_type), intent(in) :: self
      real(dp) :: rhs(size(self%temperature_old)), part(2)

      part = film_parts(self%scheme, self%scheme%b)
      rhs = -part(1)*film_heat(self%old%film, self%temperature_old) - &
         part(2)*film_heat(self%new%film, self%temperature_old)
   end function film_history

   !> Diagonal of the jumps on the left of (3.4) divided by a1.
   pure function contact_diagonal(self, omega) result(diagonal)
      class(heat_equation_type), intent(in) :: self
      real(dp), intent(in) :: omega(:)                  !! (m) omega_i+1
      real(dp) :: diagonal(size(omega))                 !! (m) [power/temperature]

      associate (a => self%scheme%a)
         diagonal = heat_across(self%weight, a(2)*self%omega_old + a(3)*omega, 1.0_dp)/a(1)
      end associate
   end function contact_diagonal

   !> Right-hand side of (3.4) divided by a1 in the rows of the jumps.
   pure function contact_history(self, omega) result(rhs)
      class(heat_equation_type), intent(in) :: self
      real(dp), intent(in) :: omega(:)                  !! (m) omega_i+1
      real(dp) :: rhs(size(omega))                      !! (m) [power]

      associate (a => self%scheme%a, b => self%scheme%b)
         rhs = -heat_across(self%weight, b(2)*self%omega_old + b(3)*omega, self%jump_old)/a(1)
      end associate
   end function contact_history

   !> Derivative by omega_i+1 of the heat that contact points take from the slave, divided by a1.
   pure function crossing_by_omega(self, jump) result(derivative)
      class(heat_equation_type), intent(in) :: self
      real(dp), intent(in) :: jump(:)                   !! (m) theta_i+1 [temperature]
      real(dp) :: derivative(size(jump))                !! (m) [length^2 temperature]

      associate (a => self%scheme%a, b => self%scheme%b)
         derivative = heat_across(self%weight/a(1), 1.0_dp, a(3)*jump + b(3)*self%jump_old)
      end associate
   end function crossing_by_omega

   !> The conductances by which heat crosses: those of the start in an explicit scheme.
   pure function flux_conductance(self, omega)
      class(heat_equation_type), intent(in) :: self
      real(dp), intent(in) :: omega(:)                  !! (m) omega_i+1
      real(dp) :: flux_conductance(size(omega)) !! (m) [power/(length^2 temperature)]

      flux_conductance = omega
      if (self%is_explicit()) flux_conductance = self%omega_old
   end function flux_conductance

   !> The heat rates that (3.4) balances, means over the increment: each side divided by a1 + b1.
   pure function rates(self, conduction, capacity, temperature, omega, jump)
      class(heat_equation_type), intent(in) :: self
      type(sparse_matrix_type), intent(in) :: conduction   !! K
      type(sparse_matrix_type), intent(in) :: capacity     !! C, where heat is stored
      real(dp), intent(in) :: temperature(:)               !! (nodes) T_i+1 [temperature]
      real(dp), intent(in) :: omega(:)                     !! (m) omega_i+1
      real(dp), intent(in) :: jump(:)                      !! (m) theta_i+1 [temperature]
      type(heat_rates_type) :: rates
      real(dp) :: part(2), whole

      part = film_parts(self%scheme, self%scheme%a)
      associate (a => self%scheme%a, b => self%scheme%b, c => self%scheme%c)
         whole = a(1) + b(1)
         rates%conducted = a(1)*conduction%multiply(temperature)
         if (abs(b(1)) > 0.0_dp) rates%conducted = rates%conducted + &
            b(1)*conduction%multiply(self%temperature_old)
         rates%entering = c(1)*self%old%load + c(2)*self%new%load + a(1)*(film_history(self) - &
            part(1)*film_heat(self%old%film, temperature) - &
            part(2)*film_heat(self%new%film, temperature))
         rates%crossing = heat_across(self%weight, a(2)*self%omega_old + a(3)*omega, jump) + &
            heat_across(self%weight, b(2)*self%omega_old + b(3)*omega, self%jump_old)
      end associate
      if (self%duration > 0.0_dp) rates%stored = self%scheme%a(1)/whole/self%duration* &
         gain(self, capacity, temperature)
      if (allocated(self%beyond)) rates%conducted = rates%conducted - self%scheme%a(1)* &
         self%beyond - self%scheme%b(1)*self%beyond_old
      rates%conducted = rates%conducted/whole
      rates%entering = rates%entering/whole
      rates%crossing = rates%crossing/whole
   end function rates

   !> The heat rates at the start of the increment; what they leave over is stored.
   pure function rates_at_start(self, conduction) result(rates)
      class(heat_equation_type), intent(in) :: self
      type(sparse_matrix_type), intent(in) :: conduction   !! K
      type(heat_rates_type) :: rates

      rates%conducted = conduction%multiply(self%temperature_old)
      if (allocated(self%beyond)) rates%conducted = rates%conducted - self%beyond_old
      rates%entering = self%old%net_heat(self%temperature_old)
      rates%crossing = heat_across(self%weight, self%omega_old, self%jump_old)
   end function rates_at_start

   !> Q - F T: heat by sources, fluxes and films.
   pure function net_heat(self, temperature) result(heat)
      class(heat_sources_type), intent(in) :: self
      real(dp), intent(in) :: temperature(:)            !! (nodes) [temperature]
      real(dp) :: heat(size(temperature))               !! (nodes) into the bodies [power]

      heat = self%load - film_heat(self%film, temperature)
   end function net_heat

   pure function film_heat(film, temperature) result(heat)
      type(sparse_matrix_type), intent(in) :: film
      real(dp), intent(in) :: temperature(:)
      real(dp) :: heat(size(temperature))

      heat = 0.0_dp
      if (has_entries(film)) heat = film%multiply(temperature)
   end function film_heat

   !> Whether any film acts.
   pure logical function has_entries(film)
      type(sparse_matrix_type), intent(in) :: film

      has_entries = .false.
      if (allocated(film%value)) has_entries = size(film%value) > 0
   end function has_entries

end module heat_equation
