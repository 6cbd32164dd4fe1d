!> Films in the stepping scheme (3.4). Their matrices F of both ends of an increment are beside G;
!> a matrix without entries stands for no film.
module films
   use controls, only: thermal_scheme_type
   use kinds, only: dp
   use scheme_properties, only: film_history_weights, film_weights
   use sparse_matrix, only: linear_combination, sparse_matrix_type
   implicit none
   private
   public :: left_films, film_history, net_heat, scheme_net_heat

contains

   !> Whether there is any film in a matrix.
   pure logical function has_entries(film)
      type(sparse_matrix_type), intent(in) :: film   !! F [power/temperature]

      has_entries = .false.
      if (allocated(film%value)) has_entries = size(film%value) > 0
   end function has_entries

   !> What the films of both ends of an increment add to K on the left of (3.4), divided by a1.
   pure function left_films(scheme, film_old, film_new) result(film)
      type(thermal_scheme_type), intent(in) :: scheme       !! coefficients of (3.4)
      type(sparse_matrix_type), intent(in) :: film_old      !! F_i [power/temperature]
      type(sparse_matrix_type), intent(in) :: film_new      !! F_i+1 [power/temperature]
      type(sparse_matrix_type) :: film                      !! [power/temperature]
      real(dp) :: weights(2)

      if (.not. (has_entries(film_old) .or. has_entries(film_new))) return
      weights = film_weights(scheme)
      film = linear_combination(weights(1), film_old, weights(2), film_new)
   end function left_films

   !> What they add to the right-hand side of (3.4) divided by a1.
   pure function film_history(scheme, film_old, film_new, temperature_old) result(rhs)
      type(thermal_scheme_type), intent(in) :: scheme       !! coefficients of (3.4)
      type(sparse_matrix_type), intent(in) :: film_old      !! F_i [power/temperature]
      type(sparse_matrix_type), intent(in) :: film_new      !! F_i+1 [power/temperature]
      real(dp), intent(in) :: temperature_old(:)            !! (nodes) T_i [temperature]
      real(dp) :: rhs(size(temperature_old))                !! (nodes) [power]
      real(dp) :: weights(2)

      weights = film_history_weights(scheme)
      rhs = -weights(1)*film_heat(film_old, temperature_old) - &
         weights(2)*film_heat(film_new, temperature_old)
   end function film_history

   !> Q - F T: what sources, fluxes and films bring into the bodies.
   pure function net_heat(load, film, temperature) result(heat)
      real(dp), intent(in) :: load(:)                       !! (nodes) Q [power]
      type(sparse_matrix_type), intent(in) :: film          !! F [power/temperature]
      real(dp), intent(in) :: temperature(:)                !! (nodes) [temperature]
      real(dp) :: heat(size(load))                          !! (nodes) [power]

      heat = load - film_heat(film, temperature)
   end function net_heat

   !> The same in the discrete equation: c1 Q_i + c2 Q_i+1 less the films of both sides.
   pure function scheme_net_heat(scheme, load_old, load_new, film_old, film_new, temperature_old, &
      temperature_new) result(heat)
      type(thermal_scheme_type), intent(in) :: scheme       !! coefficients of (3.4)
      real(dp), intent(in) :: load_old(:), load_new(:)      !! (nodes) Q_i, Q_i+1 [power]
      type(sparse_matrix_type), intent(in) :: film_old      !! F_i [power/temperature]
      type(sparse_matrix_type), intent(in) :: film_new      !! F_i+1 [power/temperature]
      real(dp), intent(in) :: temperature_old(:)            !! (nodes) T_i [temperature]
      real(dp), intent(in) :: temperature_new(:)            !! (nodes) T_i+1 [temperature]
      real(dp) :: heat(size(load_old))                      !! (nodes) [power]
      real(dp) :: weights(2)

      weights = film_weights(scheme)
      heat = scheme%c(1)*load_old + scheme%c(2)*load_new + scheme%a(1)*( &
         film_history(scheme, film_old, film_new, temperature_old) - &
         weights(1)*film_heat(film_old, temperature_new) - &
         weights(2)*film_heat(film_new, temperature_new))
   end function scheme_net_heat

   pure function film_heat(film, temperature) result(heat)
      type(sparse_matrix_type), intent(in) :: film
      real(dp), intent(in) :: temperature(:)
      real(dp) :: heat(size(temperature))

      if (has_entries(film)) then
         heat = film%multiply(temperature)
      else
         heat = 0.0_dp
      end if
   end function film_heat

end module films
