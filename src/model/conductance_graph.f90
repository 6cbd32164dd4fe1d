!> The conductance of a pair along one coordinate, its *place*, that runs from closed to open.
!>
!> The *opening* of a pair is its gap where it is open and -p/modulus where it is closed: one number
!> for both sides of (1.8), with no complementarity left in it. The conductance is a function of it
!> but where the law jumps at gamma = p = 0: there the pair may rest with any conductance between
!> the two values. The place passes through these values as well:
!>
!>    place < -width         closed, opening = place + width
!>    -width <= place <= 0   rest, opening = 0, between the closed and the open value
!>    place > 0              open, opening = place
!>
!> The origin is where the pair opens: a law of the gap is ever so much steeper than one of the
!> pressure, and a small gap must keep its digits.
!>
!> At rest omega/(omega + body) is linear in the place, which is nearly so for the heat that crosses
!> the pair: with 1/body the resistance of the bodies it goes like 1/(1/body + 1/omega).
module conductance_graph
   use conductance_laws, only: conductance, conductance_inverse, conductance_law_type, &
      conductance_derivative, law_clearance, law_pressure
   use kinds, only: dp
   implicit none
   private
   public :: conductance_graph_type

   !> Law and scales of one pair.
   type :: conductance_graph_type
      type(conductance_law_type) :: law   !! the law
      real(dp) :: modulus = 1.0_dp        !! pressure per overlap, > 0 [stress/length]
      real(dp) :: width = 0.0_dp !! length of the rest, 0 where the law is continuous [length]
      real(dp) :: body = 1.0_dp           !! > 0, about that of the bodies [as omega]
   contains
      procedure :: omega
      procedure :: slope
      procedure :: opening
      procedure :: advance
      procedure :: rests
      procedure :: stopped
      procedure :: moved
      procedure :: place_of_opening
      procedure :: place_of_omega
      procedure :: may_rest
      procedure :: kinks
   end type conductance_graph_type

   real(dp), parameter :: straight = 1.0e-3_dp   !! change of omega that a slope gives, relative
   real(dp), parameter :: rounding = 1.0e-12_dp  !! relative change of omega that is none
   real(dp), parameter :: beyond = 1.0e-100_dp   !! gap that counts for none [length]

contains

   !> Conductance at a place.
   elemental function omega(self, place)
      class(conductance_graph_type), intent(in) :: self  !! the pair
      real(dp), intent(in) :: place                      !! [length]
      real(dp) :: omega                                  !! [power/(length^2 temperature)]
      real(dp) :: ends(2), weights(2)

      if (self%rests(place)) then
         ends = rest_ends(self)
         weights = rest_weights(self, place)
         omega = dot_product(weights, ends)/sum(weights)
      else
         omega = conductance(self%law, place < 0.0_dp, place, -self%modulus*(place + self%width))
      end if
   end function omega

   !> Its derivative by the place; on the open side where both meet.
   elemental function slope(self, place)
      class(conductance_graph_type), intent(in) :: self  !! the pair
      real(dp), intent(in) :: place                      !! [length]
      real(dp) :: slope                                  !! d omega/d place
      real(dp) :: ends(2)

      if (self%rests(place)) then
         ends = rest_ends(self)
         slope = (ends(2) - ends(1))/self%width/ &
            product((ends + self%body)*sum(rest_weights(self, place)))
      else if (place < 0.0_dp) then
         slope = -self%modulus*conductance_derivative(self%law, .true., 0.0_dp, &
            -self%modulus*(place + self%width))
      else
         slope = conductance_derivative(self%law, .false., place, 0.0_dp)
      end if
   end function slope

   !> omega at the two ends of the rest: closed and open.
   pure function rest_ends(self) result(ends)
      class(conductance_graph_type), intent(in) :: self
      real(dp) :: ends(2)

      ends = [conductance(self%law, .true., 0.0_dp, 0.0_dp), &
         conductance(self%law, .false., 0.0_dp, 0.0_dp)]
   end function rest_ends

   !> Weights of the two ends in omega at rest: of a mean, because a share that rounds to 1 where
   !> the bodies conduct next to nothing has no omega.
   pure function rest_weights(self, place) result(weights)
      class(conductance_graph_type), intent(in) :: self
      real(dp), intent(in) :: place
      real(dp) :: weights(2)

      weights = [-place, self%width + place]/(self%width*(rest_ends(self) + self%body))
   end function rest_weights

   !> Opening at a place.
   elemental function opening(self, place)
      class(conductance_graph_type), intent(in) :: self  !! the pair
      real(dp), intent(in) :: place                      !! [length]
      real(dp) :: opening                                !! gap, or -p/modulus [length]

      opening = min(place + self%width, 0.0_dp) + max(place, 0.0_dp)
   end function opening

   !> Its derivative by the place.
   elemental function advance(self, place)
      class(conductance_graph_type), intent(in) :: self  !! the pair
      real(dp), intent(in) :: place                      !! [length]
      real(dp) :: advance                                !! 0 at rest, else 1

      advance = merge(0.0_dp, 1.0_dp, self%rests(place))
   end function advance

   !> A move that goes no farther than across the first end of the side it starts on.
   elemental function stopped(self, from, to) result(place)
      class(conductance_graph_type), intent(in) :: self  !! the pair
      real(dp), intent(in) :: from                       !! place where the move starts [length]
      real(dp), intent(in) :: to                         !! place where it would end [length]
      real(dp) :: place                                  !! [length]

      place = to
      if (from < -self%width) then
         place = min(to, -self%width)
      else if (self%width <= 0.0_dp) then
         if (from > 0.0_dp) place = max(to, 0.0_dp)
      else if (self%rests(from)) then
         if (to < -self%width) place = -self%width*(1.0_dp + 2*epsilon(1.0_dp))
         if (to > 0.0_dp) place = beyond
      else if (to <= 0.0_dp) then
         place = 0.0_dp
      end if
   end function stopped

   !> Where a pair comes to that Newton's method would move by `change`, with the law itself in
   !> place of its slope. For the pair alone the equation is opening(z) - kappa share(z) = const,
   !> share = omega/(omega + body): kappa is constant where its heat goes with share. From the
   !> linear change of the left-hand side the move follows by bisection; with kappa >= 0, where heat
   !> opens the gap that it crosses, the left-hand side grows with z on all of the graph. Elsewhere
   !> the move stops at the first kink.
   elemental function moved(self, from, change, body, own) result(place)
      class(conductance_graph_type), intent(in) :: self  !! the pair
      real(dp), intent(in) :: from                       !! place where the move starts [length]
      real(dp), intent(in) :: change                     !! of the place, to first order [length]
      real(dp), intent(in) :: body                       !! of the bodies about the pair [as omega]
      real(dp), intent(in) :: own    !! derivative of the pair's opening by its omega
      real(dp) :: place                                  !! [length]
      real(dp) :: kappa, reach(2), wanted, omega_start, omega_slope
      integer :: i

      omega_start = self%omega(from)
      omega_slope = self%slope(from)
      place = from + change
      if (abs(own) <= 0.0_dp) return
      place = self%stopped(from, place)
      if (own <= 0.0_dp) return
      if (abs(omega_slope*change) <= straight*omega_start .and. &
         (from + self%width)*(place + self%width) > 0.0_dp) return
      kappa = own*(omega_start + body)**2/body
      wanted = (self%advance(from) - own*omega_slope)*change
      reach = self%place_of_opening(self%opening(from) + wanted + &
         kappa*[-omega_start, body]/(omega_start + body))
      if (self%rests(reach(1))) reach(1) = -self%width
      do i = 1, 200
         place = 0.5_dp*(reach(1) + reach(2))
         if (reach(2) - reach(1) <= 2*epsilon(1.0_dp)*abs(place)) exit
         if (self%opening(place) - self%opening(from) - kappa*body*(self%omega(place) - &
            omega_start)/((self%omega(place) + body)*(omega_start + body)) > wanted) then
            reach(2) = place
         else
            reach(1) = place
         end if
      end do
   end function moved

   !> Whether the pair rests at a place.
   elemental function rests(self, place)
      class(conductance_graph_type), intent(in) :: self  !! the pair
      real(dp), intent(in) :: place                      !! [length]
      logical :: rests                                   !! gamma = p = 0 by the place

      rests = self%width > 0.0_dp .and. place >= -self%width .and. place <= 0.0_dp
   end function rests

   !> Whether the pair may rest with a conductance.
   elemental function may_rest(self, omega)
      class(conductance_graph_type), intent(in) :: self  !! the pair
      real(dp), intent(in) :: omega                      !! conductance
      logical :: may_rest                                !! it lies between the two values
      real(dp) :: closed, open

      closed = conductance(self%law, .true., 0.0_dp, 0.0_dp)
      open = conductance(self%law, .false., 0.0_dp, 0.0_dp)
      ! The conductance of an end of the rest is one of the two values but for rounding.
      may_rest = self%width > 0.0_dp .and. omega >= (1.0_dp - rounding)*min(closed, open) .and. &
         omega <= (1.0_dp + rounding)*max(closed, open)
   end function may_rest

   !> Place of an opening that is not 0.
   elemental function place_of_opening(self, opening) result(place)
      class(conductance_graph_type), intent(in) :: self  !! the pair
      real(dp), intent(in) :: opening                    !! gap, or -p/modulus [length]
      real(dp) :: place                                  !! [length]

      place = opening
      if (opening < 0.0_dp) place = opening - self%width
   end function place_of_opening

   !> A place with a given conductance, the one of a given opening where that has it; elsewhere that
   !> of the opening, and then the conductance is another one.
   elemental function place_of_omega(self, omega, opening) result(place)
      class(conductance_graph_type), intent(in) :: self  !! the pair
      real(dp), intent(in) :: omega                      !! conductance
      real(dp), intent(in) :: opening                    !! gap, or -p/modulus [length]
      real(dp) :: place                                  !! [length]
      real(dp) :: at(2), ends(2)

      place = self%place_of_opening(opening)
      if (abs(self%omega(place) - omega) <= rounding*omega) return
      if (self%may_rest(omega)) then
         ends = rest_ends(self)
         place = self%width*(omega - ends(2))/(ends(2) - ends(1))* &
            ((ends(1) + self%body)/(omega + self%body))
         place = min(max(place, -self%width), 0.0_dp)
         return
      end if
      at = [-conductance_inverse(self%law, .true., omega)/self%modulus - self%width, &
         conductance_inverse(self%law, .false., omega)]
      if (at(1) < -self%width .and. (opening < 0.0_dp .or. at(2) < 0.0_dp)) then
         place = at(1)
      else if (at(2) >= 0.0_dp) then
         place = at(2)
      end if
   end function place_of_omega

   !> Places at which the conductance may have a kink: the rows of tables, and the ends of a rest.
   pure function kinks(self) result(place)
      class(conductance_graph_type), intent(in) :: self  !! the pair
      real(dp), allocatable :: place(:)                  !! ascending [length]

      place = [-self%width, 0.0_dp]
      if (self%law%closed_kind == law_pressure) place = [-self%width - self%law%table_pressure( &
         size(self%law%table_pressure):1:-1)/self%modulus, place]
      if (self%law%open_kind == law_clearance) place = [place, self%law%table_gap]
   end function kinks

end module conductance_graph
