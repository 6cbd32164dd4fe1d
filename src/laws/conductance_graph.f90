!> The conductance of a contact point along one *coordinate* that runs from closed to open.
!>
!> The *opening* of a contact point is its gap where it is open and -p/modulus where it is closed:
!> one number for both sides of (1.8), with no complementarity left in it. The conductance is a
!> function of it but where the law jumps at gamma = p = 0: there the contact point may rest with
!> any conductance between the two values. The coordinate passes through these values as well:
!>
!>    coordinate < -width         closed, opening = coordinate + width
!>    -width <= coordinate <= 0   rest, opening = 0, between the closed and the open value
!>    coordinate > 0              open, opening = coordinate
!>
!> The origin is where the contact point opens: a law of the gap is far steeper than one of
!> the pressure, and a small gap must keep its digits.
!>
!> At rest omega/(omega + body) is linear in the coordinate, which is nearly so for the heat that
!> crosses the contact point: with 1/body the resistance of the bodies it goes like 1/(1/body +
!> 1/omega).
module conductance_graph
   use conductance_laws, only: conductance, conductance_inverse, conductance_law_type, &
      conductance_derivative, law_clearance, law_pressure
   use kinds, only: dp
   implicit none
   private
   public :: conductance_graph_type

   !> Law and scales of one contact point.
   type :: conductance_graph_type
      type(conductance_law_type) :: law   !! the law
      real(dp) :: modulus = 1.0_dp        !! pressure per overlap, > 0 [stress/length]
      real(dp) :: width = 0.0_dp !! length of the rest, 0 where the law is continuous [length]
      real(dp) :: body = 1.0_dp           !! > 0, about that of the bodies [as omega]
   contains
      procedure :: omega
      procedure :: derivative
      procedure :: opening
      procedure :: advance
      procedure :: rests
      procedure :: stopped
      procedure :: moved
      procedure :: coordinate_of_opening
      procedure :: coordinate_of_omega
      procedure :: may_rest
      procedure :: kinks
   end type conductance_graph_type

   real(dp), parameter :: straight = 1.0e-3_dp  !! change of omega that a derivative gives, relative
   real(dp), parameter :: rounding = 1.0e-12_dp  !! relative change of omega that is none
   real(dp), parameter :: beyond = 1.0e-100_dp   !! gap that counts for none [length]

contains

   !> Conductance at a coordinate.
   elemental function omega(self, coordinate)
      class(conductance_graph_type), intent(in) :: self  !! the contact point
      real(dp), intent(in) :: coordinate                 !! [length]
      real(dp) :: omega                                  !! [power/(length^2 temperature)]
      real(dp) :: ends(2), weights(2)

      if (self%rests(coordinate)) then
         ends = rest_ends(self)
         weights = rest_weights(self, coordinate)
         omega = dot_product(weights, ends)/sum(weights)
      else
         omega = conductance(self%law, coordinate < 0.0_dp, coordinate, &
            -self%modulus*(coordinate + self%width))
      end if
   end function omega

   !> Its derivative by the coordinate; on the open side where both meet.
   elemental function derivative(self, coordinate)
      class(conductance_graph_type), intent(in) :: self  !! the contact point
      real(dp), intent(in) :: coordinate                 !! [length]
      real(dp) :: derivative                             !! d omega/d coordinate
      real(dp) :: ends(2)

      if (self%rests(coordinate)) then
         ends = rest_ends(self)
         derivative = (ends(2) - ends(1))/self%width/ &
            product((ends + self%body)*sum(rest_weights(self, coordinate)))
      else if (coordinate < 0.0_dp) then
         derivative = -self%modulus*conductance_derivative(self%law, .true., 0.0_dp, &
            -self%modulus*(coordinate + self%width))
      else
         derivative = conductance_derivative(self%law, .false., coordinate, 0.0_dp)
      end if
   end function derivative

   !> omega at the two ends of the rest: closed and open.
   pure function rest_ends(self) result(ends)
      class(conductance_graph_type), intent(in) :: self
      real(dp) :: ends(2)

      ends = [conductance(self%law, .true., 0.0_dp, 0.0_dp), &
         conductance(self%law, .false., 0.0_dp, 0.0_dp)]
   end function rest_ends

   !> Weights of the two ends in omega at rest: of a mean, because a share that rounds to 1 where
   !> the bodies conduct next to nothing has no omega.
   pure function rest_weights(self, coordinate) result(weights)
      class(conductance_graph_type), intent(in) :: self
      real(dp), intent(in) :: coordinate
      real(dp) :: weights(2)

      weights = [-coordinate, self%width + coordinate]/(self%width*(rest_ends(self) + self%body))
   end function rest_weights

   !> Opening at a coordinate.
   elemental function opening(self, coordinate)
      class(conductance_graph_type), intent(in) :: self  !! the contact point
      real(dp), intent(in) :: coordinate                 !! [length]
      real(dp) :: opening                                !! gap, or -p/modulus [length]

      opening = min(coordinate + self%width, 0.0_dp) + max(coordinate, 0.0_dp)
   end function opening

   !> Its derivative by the coordinate.
   elemental function advance(self, coordinate)
      class(conductance_graph_type), intent(in) :: self  !! the contact point
      real(dp), intent(in) :: coordinate                 !! [length]
      real(dp) :: advance                                !! 0 at rest, else 1

      advance = merge(0.0_dp, 1.0_dp, self%rests(coordinate))
   end function advance

   !> A move that goes no farther than across the first end of the side it starts on.
   elemental function stopped(self, from, to) result(coordinate)
      class(conductance_graph_type), intent(in) :: self  !! the contact point
      real(dp), intent(in) :: from                      !! coordinate where the move starts [length]
      real(dp), intent(in) :: to                         !! coordinate where it would end [length]
      real(dp) :: coordinate                             !! [length]

      coordinate = to
      if (from < -self%width) then
         coordinate = min(to, -self%width)
      else if (self%width <= 0.0_dp) then
         if (from > 0.0_dp) coordinate = max(to, 0.0_dp)
      else if (self%rests(from)) then
         if (to < -self%width) coordinate = -self%width*(1.0_dp + 2*epsilon(1.0_dp))
         if (to > 0.0_dp) coordinate = beyond
      else if (to <= 0.0_dp) then
         coordinate = 0.0_dp
      end if
   end function stopped

   !> Where a contact point comes to that Newton's method would move by `change`, with the law
   !> itself in coordinate of its derivative. For the contact point alone the equation is opening(z)
   !> - kappa share(z) = const, share = omega/(omega + body): kappa is constant where its heat goes
   !> with share. From the linear change of the left-hand side the move follows by bisection; with
   !> kappa >= 0, where heat opens the gap that it crosses, the left-hand side grows with z on all
   !> of the graph. Elsewhere the move stops at the first kink.
   elemental function moved(self, from, change, body, own) result(coordinate)
      class(conductance_graph_type), intent(in) :: self  !! the contact point
      real(dp), intent(in) :: from                      !! coordinate where the move starts [length]
      real(dp), intent(in) :: change                   !! of the coordinate, to first order [length]
      real(dp), intent(in) :: body               !! of the bodies about the contact point [as omega]
      real(dp), intent(in) :: own    !! derivative of the contact point's opening by its omega
      real(dp) :: coordinate                             !! [length]
      real(dp) :: kappa, reach(2), wanted, omega_start, omega_derivative
      integer :: i

      omega_start = self%omega(from)
      omega_derivative = self%derivative(from)
      coordinate = from + change
      if (abs(own) <= 0.0_dp) return
      coordinate = self%stopped(from, coordinate)
      if (own <= 0.0_dp) return
      if (abs(omega_derivative*change) <= straight*omega_start .and. &
         (from + self%width)*(coordinate + self%width) > 0.0_dp) return
      kappa = own*(omega_start + body)**2/body
      wanted = (self%advance(from) - own*omega_derivative)*change
      reach = self%coordinate_of_opening(self%opening(from) + wanted + &
         kappa*[-omega_start, body]/(omega_start + body))
      if (self%rests(reach(1))) reach(1) = -self%width
      do i = 1, 200
         coordinate = 0.5_dp*(reach(1) + reach(2))
         if (reach(2) - reach(1) <= 2*epsilon(1.0_dp)*abs(coordinate)) exit
         if (self%opening(coordinate) - self%opening(from) - kappa*body*(self%omega(coordinate) - &
            omega_start)/((self%omega(coordinate) + body)*(omega_start + body)) > wanted) then
            reach(2) = coordinate
         else
            reach(1) = coordinate
         end if
      end do
   end function moved

   !> Whether the contact point rests at a coordinate.
   elemental function rests(self, coordinate)
      class(conductance_graph_type), intent(in) :: self  !! the contact point
      real(dp), intent(in) :: coordinate                 !! [length]
      logical :: rests                                   !! gamma = p = 0 by the coordinate

      rests = self%width > 0.0_dp .and. coordinate >= -self%width .and. coordinate <= 0.0_dp
   end function rests

   !> Whether the contact point may rest with a conductance.
   elemental function may_rest(self, omega)
      class(conductance_graph_type), intent(in) :: self  !! the contact point
      real(dp), intent(in) :: omega                      !! conductance
      logical :: may_rest                                !! it lies between the two values
      real(dp) :: ends(2)

      ends = rest_ends(self)
      ! The conductance of an end of the rest is one of the two values but for rounding.
      may_rest = self%width > 0.0_dp .and. omega >= (1.0_dp - rounding)*minval(ends) .and. &
         omega <= (1.0_dp + rounding)*maxval(ends)
   end function may_rest

   !> Coordinate of an opening that is not 0.
   elemental function coordinate_of_opening(self, opening) result(coordinate)
      class(conductance_graph_type), intent(in) :: self  !! the contact point
      real(dp), intent(in) :: opening                    !! gap, or -p/modulus [length]
      real(dp) :: coordinate                             !! [length]

      coordinate = opening
      if (opening < 0.0_dp) coordinate = opening - self%width
   end function coordinate_of_opening

   !> A coordinate with a given conductance, the one of a given opening where that has it; elsewhere
   !> that of the opening, and then the conductance is another one.
   elemental function coordinate_of_omega(self, omega, opening) result(coordinate)
      class(conductance_graph_type), intent(in) :: self  !! the contact point
      real(dp), intent(in) :: omega                      !! conductance
      real(dp), intent(in) :: opening                    !! gap, or -p/modulus [length]
      real(dp) :: coordinate                             !! [length]
      real(dp) :: at(2), ends(2)

      coordinate = self%coordinate_of_opening(opening)
      if (abs(self%omega(coordinate) - omega) <= rounding*omega) return
      if (self%may_rest(omega)) then
         ends = rest_ends(self)
         coordinate = -0.5_dp*self%width
         if (abs(ends(2) - ends(1)) > 0.0_dp) coordinate = self%width*(omega - ends(2))/ &
            (ends(2) - ends(1))*((ends(1) + self%body)/(omega + self%body))
         coordinate = min(max(coordinate, -self%width), 0.0_dp)
         return
      end if
      at = [-conductance_inverse(self%law, .true., omega)/self%modulus - self%width, &
         conductance_inverse(self%law, .false., omega)]
      if (at(1) < -self%width .and. (opening < 0.0_dp .or. at(2) < 0.0_dp)) then
         coordinate = at(1)
      else if (at(2) >= 0.0_dp) then
         coordinate = at(2)
      end if
   end function coordinate_of_omega

   !> Coordinates at which the conductance may have a kink: the rows of tables, and the ends of a
   !> rest.
   pure function kinks(self) result(coordinate)
      class(conductance_graph_type), intent(in) :: self  !! the contact point
      real(dp), allocatable :: coordinate(:)             !! ascending [length]

      coordinate = [-self%width, 0.0_dp]
      associate (pressure => self%law%closed_table%abscissa)
         if (self%law%closed_kind == law_pressure) coordinate = &
            [-self%width - pressure(size(pressure):1:-1)/self%modulus, coordinate]
      end associate
      if (self%law%open_kind == law_clearance) coordinate = &
         [coordinate, self%law%open_table%abscissa]
      if (allocated(self%law%view_gap)) coordinate = [coordinate, self%law%view_gap]
   end function kinks

end module conductance_graph
