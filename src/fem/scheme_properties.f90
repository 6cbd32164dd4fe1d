!> What follows from the coefficients of a stepping scheme (3.4) alone.
module scheme_properties
   use controls, only: thermal_scheme_type
   use kinds, only: dp
   implicit none
   private
   public :: amplification, has_memory, is_explicit, film_weights, film_history_weights

contains

   !> Factor per increment of an initial imbalance at constant omega. Every mode has a factor
   !> between -b1/a1, its own where only K acts, and -(b2 + b3)/(a2 + a3), its own where only G
   !> acts; the one of larger modulus is given. Both are -b1/a1 for the schemes with names.
   pure function amplification(scheme) result(factor)
      type(thermal_scheme_type), intent(in) :: scheme !! coefficients of (3.4)
      real(dp) :: factor                              !! |factor| < 1: imbalances die away [-]
      real(dp) :: contact_factor

      factor = -scheme%b(1)/scheme%a(1)
      contact_factor = -(scheme%b(2) + scheme%b(3))/(scheme%a(2) + scheme%a(3))
      if (abs(contact_factor) > abs(factor)) factor = contact_factor
   end function amplification

   !> Whether temperatures at the end of an increment depend on anything at its start.
   pure logical function has_memory(scheme)
      type(thermal_scheme_type), intent(in) :: scheme !! coefficients of (3.4)

      has_memory = abs(scheme%a(2)) + sum(abs(scheme%b)) + abs(scheme%c(1)) > 0.0_dp
   end function has_memory

   !> Whether omega at the end of an increment has no part in its temperatures: a3 = b3 = 0.
   pure logical function is_explicit(scheme)
      type(thermal_scheme_type), intent(in) :: scheme !! coefficients of (3.4)

      is_explicit = abs(scheme%a(3)) + abs(scheme%b(3)) <= 0.0_dp
   end function is_explicit

   !> Weights of the film matrices of t_i and t_i+1 on the left of (3.4), divided by a1: those of G,
   !> for both are conductances of faces. Where c1 = 0 loads act as they are at t_i+1, and films,
   !> which are loads, with them.
   pure function film_weights(scheme) result(weights)
      type(thermal_scheme_type), intent(in) :: scheme !! coefficients of (3.4)
      real(dp) :: weights(2)                          !! at t_i and t_i+1 [-]

      weights = film_parts(scheme, scheme%a)
   end function film_weights

   !> Weights of the film matrices of t_i and t_i+1 in the bracket before T_i on the right of (3.4),
   !> divided by a1.
   pure function film_history_weights(scheme) result(weights)
      type(thermal_scheme_type), intent(in) :: scheme !! coefficients of (3.4)
      real(dp) :: weights(2)                          !! at t_i and t_i+1 [-]

      weights = film_parts(scheme, scheme%b)
   end function film_history_weights

   pure function film_parts(scheme, coefficients) result(weights)
      type(thermal_scheme_type), intent(in) :: scheme
      real(dp), intent(in) :: coefficients(3)
      real(dp) :: weights(2)

      weights = coefficients(2:3)/scheme%a(1)
      if (abs(scheme%c(1)) <= 0.0_dp) weights = [0.0_dp, sum(weights)]
   end function film_parts

end module scheme_properties
