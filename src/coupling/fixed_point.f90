!> The fixed point omega = U(omega), section 4 of the paper: what an accelerator is, the paper's
!> two, (4.1) and (4.2), and Anderson's. The loop and its tolerances are the caller's; an
!> accelerator only chooses the next omega*.
!>
!> Anderson's mixing is that of x = log omega, with the residual f = log U(omega) - x. Contact
!> points that carry no heat before or after a pass have no logarithm: they take the image.
module fixed_point
   use anderson_mixing, only: mixing_type
   use conductance_graph, only: conductance_graph_type
   use kinds, only: dp
   use path_steps, only: path_step_type
   implicit none
   private
   public :: accelerator_type, pass_type, picard_type, zaitsev_type, point_residual, &
      predicted_conductance, anderson_type

   !> One pass of U; then where the next one starts.
   type :: pass_type
      integer :: iteration = 0                !! pass, from 1
      logical :: is_lost = .false.            !! whether the heat runs away from its method
      logical :: found = .true.               !! whether its contact zones were found
      real(dp), allocatable :: omega(:)       !! (m) omega*
      real(dp), allocatable :: image(:)       !! (m) U(omega*)
      real(dp), allocatable :: opening(:)     !! (m) openings that it found [length]
      !> (m) graphs of the conductance, their laws at the temperatures that it found
      type(conductance_graph_type), allocatable :: graph(:)
      !> (m) coordinates on the graphs that give omega* [length]; only where the accelerator goes by
      !> them
      real(dp), allocatable :: coordinate(:)
      !> (m, m) derivative of the openings by omega*, where the accelerator asked and there is one
      real(dp), allocatable :: derivative(:, :)
      !> (m) conductance that the bodies put in series with each contact point; set with the
      !> derivative
      real(dp), allocatable :: body(:)
      !> Of a sparse tail in place of the derivative: (m) Newton's step [length], from products with
      !> it, and the contact points' own derivatives
      real(dp), allocatable :: step(:), own(:)
      real(dp) :: time_step = huge(1.0_dp)  !! tau of this step
      type(path_step_type), allocatable :: path_step   !! the same on a path, with its equation
      !> (m) derivative of the openings by the load factor at constant coordinates, on a branch
      real(dp), allocatable :: by_factor(:)
   contains
      procedure :: coordinates
   end type pass_type

   !> Method that turns omega* and its image U(omega*) into the next omega*.
   type, abstract :: accelerator_type
      real(dp), allocatable :: g(:)   !! (m) part of the way that each contact point goes
      integer :: kept = 0 !! contact points whose g was kept in the last pass, eq. (4.2) giving none
      logical :: follows_path = .false.   !! on a continuous path of conductances (homotopy)
      logical :: retreats = .false. !! whether next goes on from a pass whose zones were not found
   contains
      procedure(next_interface), deferred :: next
      procedure :: asks_derivative
   end type accelerator_type

   abstract interface
      !> The next omega*.
      subroutine next_interface(self, pass)
         import :: accelerator_type, pass_type
         class(accelerator_type), intent(inout) :: self  !! memory of the iteration
         type(pass_type), intent(inout) :: pass          !! the last pass in, next omega* out
      end subroutine next_interface
   end interface

   !> Eq. (4.1): omega* = U(omega*).
   type, extends(accelerator_type) :: picard_type
   contains
      procedure :: next => next_picard
   end type picard_type

   !> Eq. (4.2): each contact point mixed by its own secant.
   type, extends(accelerator_type) :: zaitsev_type
      integer :: constant_iterations = 3 !! number of passes that keep g as it was set
      real(dp), allocatable, private :: last_omega(:)     !! (m) omega*^(i-2)
      real(dp), allocatable, private :: last_image(:)     !! (m) omega^(i-1)
   contains
      procedure :: next => next_zaitsev
   end type zaitsev_type

   real(dp), parameter :: longest_step = 5.0_dp     !! of any x in Anderson's mixing

   !> Anderson's mixing.
   type, extends(accelerator_type) :: anderson_type
      type(mixing_type), private :: mixing
   contains
      procedure :: next => next_anderson
   end type anderson_type

contains

   !> Coordinates of omega* on the graphs: those that the accelerator chose, or by the conductances.
   pure function coordinates(self) result(coordinate)
      class(pass_type), intent(in) :: self
      real(dp) :: coordinate(size(self%omega))       !! (m) z [length]

      if (allocated(self%coordinate)) then
         coordinate = self%coordinate
      else
         coordinate = self%graph%coordinate_of_omega(self%omega, self%opening)
      end if
   end function coordinates

   !> Whether next wants the derivative of this pass: where it follows a path.
   pure function asks_derivative(self, pass) result(asks)
      class(accelerator_type), intent(in) :: self
      type(pass_type), intent(in) :: pass      !! the last pass
      logical :: asks                          !! pass%derivative is to be set

      asks = self%follows_path .and. pass%found
   end function asks_derivative

   !> omega* becomes its image.
   subroutine next_picard(self, pass)
      class(picard_type), intent(inout) :: self
      type(pass_type), intent(inout) :: pass

      pass%omega = pass%image
      self%kept = 0
   end subroutine next_picard

   !> g_i = 1/(1 - tan a_i) clipped to (0, 1]. Where tan a_i >= 1 or is 0/0 the paper is silent: the
   !> contact point's last g stays.
   subroutine next_zaitsev(self, pass)
      class(zaitsev_type), intent(inout) :: self
      type(pass_type), intent(inout) :: pass
      real(dp) :: star_change, tangent
      integer :: k

      self%kept = 0
      if (pass%iteration > max(self%constant_iterations, 1)) then
         do k = 1, size(pass%omega)
            star_change = pass%omega(k) - self%last_omega(k)
            tangent = 1.0_dp
            if (abs(star_change) > 2*epsilon(1.0_dp)*abs(pass%omega(k))) then
               tangent = (pass%image(k) - self%last_image(k))/star_change
            end if
            if (tangent < 1.0_dp) then
               self%g(k) = min(1.0_dp/(1.0_dp - tangent), 1.0_dp)
            else
               self%kept = self%kept + 1
            end if
         end do
      end if
      self%last_omega = pass%omega
      self%last_image = pass%image
      pass%omega = pass%omega*(1.0_dp - self%g) + pass%image*self%g
   end subroutine next_zaitsev

   !> |U(omega) - omega|/omega of a contact point; 1 where only one of both carries no heat.
   elemental function point_residual(omega, image) result(residual)
      real(dp), intent(in) :: omega   !! omega*
      real(dp), intent(in) :: image   !! U(omega*)
      real(dp) :: residual            !! relative residual

      residual = 0.0_dp
      if (omega > 0.0_dp) then
         residual = abs(image - omega)/omega
      else if (image > 0.0_dp) then
         residual = 1.0_dp
      end if
   end function point_residual

   !> omega*^0 of an increment, below (4.2): linear extrapolation; where that is not positive
   !> omega_i is kept.
   elemental function predicted_conductance(omega, omega_before, step_ratio) result(predicted)
      real(dp), intent(in) :: omega          !! omega_i
      real(dp), intent(in) :: omega_before   !! omega_(i-1)
      real(dp), intent(in) :: step_ratio     !! dt_i/dt_(i-1)
      real(dp) :: predicted                  !! omega*^0 of the next increment

      predicted = omega + (omega - omega_before)*step_ratio
      if (predicted <= 0.0_dp) predicted = omega
   end function predicted_conductance

   !> Anderson's mixing of the last changes.
   subroutine next_anderson(self, pass)
      class(anderson_type), intent(inout) :: self   !! memory of the method
      type(pass_type), intent(inout) :: pass        !! the last pass in, next omega* out
      real(dp), dimension(size(pass%omega)) :: x, f, step
      logical :: carries(size(pass%omega))

      carries = pass%omega > 0.0_dp .and. pass%image > 0.0_dp
      x = 0.0_dp
      f = 0.0_dp
      where (carries)
         x = log(pass%omega)
         f = log(pass%image) - x
      end where
      step = self%mixing%step(x, f, self%g)
      if (maxval(abs(step)) > longest_step) step = step*longest_step/maxval(abs(step))
      pass%omega = merge(pass%omega*exp(step), pass%image, carries)
   end subroutine next_anderson

end module fixed_point
