!> Whether the state of a coupled step lasts: the number of small motions that grow, and the
!> fastest one.
!>
!> The number is that of the bodies projected on their responses at rates from a tenth of the
!> slowest conduction on, up to one beyond which the bound of the gain says that nothing grows, and,
!> where some grow or swing with little decay, once more above the fastest of these. That is found
!> on the bodies themselves (leading_modes), where the growing ones are counted again: the one
!> checks the other.
!>
!> On a sparse tail the bodies are not projected. Where the bound of the gain does not say that
!> nothing grows at all, motions that grow are sought on the bodies alone, at rates up to the one
!> beyond which it does, and nothing proves that those that are found are all.
module growing_modes
   use due_output, only: is_nth
   use errors, only: error_type
   use kinds, only: dp
   use leading_modes, only: leading_modes_type
   use materials, only: heat_capacity
   use model, only: follows_temperatures, model_type
   use motion_responses, only: motion_response_type
   use projected_motions, only: projected_motions_type
   use records, only: increment_record_type
   use simulation, only: simulation_type
   use linear_perturbations, only: linear_perturbation_type
   use text, only: counted, to_text
   implicit none
   private
   public :: analyse_stability

   real(dp), parameter :: slower = 0.1_dp      !! than the slowest conduction: the first rate
   real(dp), parameter :: ratio = 10.0_dp      !! of one rate to the next
   integer, parameter :: least_rates = 3
   integer, parameter :: most_rates = 24
   real(dp), parameter :: instant = 1.0e9_dp   !! times a rate: no node passes on its heat
   real(dp), parameter :: above = 1.5_dp       !! the fastest rate: where it is sought
   real(dp), parameter :: light = 0.5_dp       !! decay in a modulus, below which it may be growth
   real(dp), parameter :: neutral_part = 1.0e-8_dp   !! of the slowest conduction that is no growth
   real(dp), parameter :: at_limit = 1.0e-2_dp !! from 1, a gain with which rounding hides the rest
   real(dp), parameter :: alike = 0.05_dp      !! relative difference of both fastest rates
   real(dp), parameter :: nearly_real = 1.0e-6_dp !! imaginary part of a rate that is none, relative
   real(dp), parameter :: full_turn = 8*atan(1.0_dp)

contains

   !> Analyses the state at the end of an increment, where that is due.
   subroutine analyse_stability(model, simulation, record)
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation        !! the run at its end
      type(increment_record_type), intent(inout) :: record
      type(error_type), allocatable :: error

      if (.not. is_nth(model%steps(record%step)%stability_frequency, record)) return
      allocate (record%stability)
      associate (found => record%stability)
         if (.not. any(heat_capacity(model%materials(model%sections%material)) > 0.0_dp)) then
            call found%add_doubt('bodies without *SPECIFIC HEAT and *DENSITY have no course in '// &
               'time, and det(I - U'') is not negative')
            return
         end if
         call find_motions(model, simulation, record, error)
         if (allocated(error)) call found%add_doubt(error%message)
         if (any(simulation%state%resting)) call found%add_doubt( &
            'contact points rest where their law jumps')
         if (follows_temperatures(model)) call found%add_doubt( &
            'changes of properties with the temperature are left out')
         if (model%steps(record%step)%dilates) call found%add_doubt( &
            'the heat that strains take up is left out')
      end associate
   end subroutine analyse_stability

   !> Counts the growing motions and finds the fastest one: at the first rate where none seems to
   !> grow or nearly so, else at one above those, which is one more of the projection.
   !> Errors: as linear_perturbation_type's begin and motion_response_type's make.
   subroutine find_motions(model, simulation, record, error)
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(increment_record_type), intent(inout) :: record   ! with an empty stability record
      type(error_type), allocatable, intent(out) :: error
      type(linear_perturbation_type) :: motion
      type(motion_response_type) :: response
      type(projected_motions_type) :: projection
      complex(dp), allocatable :: rates(:)
      real(dp) :: bound, fastest, slowest
      logical :: is_known, is_sparse

      call motion%begin(simulation%bodies, simulation%state, simulation%heat_reductions( &
         simulation%in_use), simulation%solved, error)
      if (allocated(error)) return
      slowest = slowest_conduction(model)
      call response%make(model, simulation, motion, slower*slowest, error)
      if (allocated(error)) return
      rates = [complex(dp) ::]
      is_known = .true.
      bound = 0.0_dp
      is_sparse = simulation%bodies%thermal%division%is_tail()
      if (is_sparse) then
         call seek(model, simulation, motion, slowest, rates, bound, error)
         if (allocated(error)) return
      else if (motion%changes > 0) then
         call project(model, simulation, motion, response, projection, bound, error)
         if (allocated(error)) return
         call projection%rates(rates, is_known)
      end if
      if (any(real(rates) > -light*abs(rates))) then
         fastest = abs(rates(maxloc(real(rates), dim=1, mask=real(rates) > -light*abs(rates))))
         call response%make(model, simulation, motion, above*max(fastest, slower*slowest), &
            error)
         if (allocated(error)) return
         if (.not. is_sparse) then
            call sample(simulation, response, projection)
            call projection%rates(rates, is_known)
         end if
      end if
      if (.not. is_sparse) record%stability%unstable_modes = &
         count(real(rates) > neutral_part*slowest)
      call find_fastest(simulation, motion, response, rates, neutral_part*slowest, &
         model%steps(record%step)%stability_modes, record)
      call response%release()
      if (.not. is_known) then
         if (abs(record%coupling_gain_max - 1.0_dp) < at_limit) then
            call record%stability%add_doubt('at the limit of stability: a growth rate is nearly 0')
         else
            call record%stability%add_doubt('the growing modes could not be checked')
         end if
      end if
      if (bound < 1.0_dp) return
      if (is_sparse) then
         call record%stability%add_doubt('on a sparse tail nothing proves that no other motion '// &
            'grows')
      else
         call record%stability%add_doubt('faster motions may grow, as where what expands, or '// &
            'is heated by its slip, has no heat capacity')
      end if
   end subroutine find_motions

   !> Seeks growing motions of a sparse tail, unless the bound of the gain says that none grows.
   !> Errors: as motion_response_type's make.
   subroutine seek(model, simulation, motion, slowest, rates, bound, error)
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(linear_perturbation_type), intent(in) :: motion
      real(dp), intent(in) :: slowest                        ! conduction [1/time]
      complex(dp), allocatable, intent(out) :: rates(:)      ! that are found
      real(dp), intent(out) :: bound                         ! of the gain at all rates
      type(error_type), allocatable, intent(out) :: error
      type(motion_response_type) :: response
      type(leading_modes_type) :: modes
      integer :: i

      rates = [complex(dp) ::]
      bound = 0.0_dp
      if (motion%takes_rates) then
         call response%make(model, simulation, motion, instant*slowest, error)
         if (allocated(error)) return
         bound = response%gain_bound(simulation%bodies, motion)
      end if
      call response%make(model, simulation, motion, neutral_part*slowest, error)
      if (allocated(error)) return
      bound = hypot(bound, response%gain_bound(simulation%bodies, motion))
      if (bound < 1.0_dp) return
      do i = 1, most_rates
         call response%make(model, simulation, motion, slower*slowest*ratio**(i - 1), error)
         if (allocated(error)) return
         call modes%find(simulation, motion, response, 0.0_dp, 0, 1)
         rates = [rates, pack(modes%rate, modes%is_sharp)]
         if (i >= least_rates .and. response%gain_bound(simulation%bodies, motion) < 1.0_dp) exit
      end do
      call response%release()
   end subroutine seek

   !> Projects the bodies on their responses, from the first one on, up to a rate beyond which no
   !> motion grows by the bound of the gain. The part of it that takes rates grows with them: it is
   !> that of heat that no node passes on.
   !> Errors: as motion_response_type's make.
   subroutine project(model, simulation, motion, first, projection, bound, error)
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(linear_perturbation_type), intent(in) :: motion
      type(motion_response_type), intent(in) :: first
      type(projected_motions_type), intent(inout) :: projection
      real(dp), intent(out) :: bound                         ! of the gain beyond all rates
      type(error_type), allocatable, intent(out) :: error
      type(motion_response_type) :: response
      integer :: i

      call sample(simulation, first, projection)
      do i = 2, most_rates
         call response%make(model, simulation, motion, ratio**(i - 1)*first%sigma, error)
         if (allocated(error)) return
         call sample(simulation, response, projection)
         bound = response%gain_bound(simulation%bodies, motion)
         if (i >= least_rates .and. bound < 1.0_dp) exit
      end do
      call projection%choose()
      if (motion%takes_rates) then
         call response%make(model, simulation, motion, instant*response%sigma, error)
         if (.not. allocated(error)) bound = hypot(bound, response%gain_bound( &
            simulation%bodies, motion))
      end if
      call response%release()
   end subroutine project

   !> Adds a response to the projection.
   subroutine sample(simulation, response, projection)
      type(simulation_type), intent(in) :: simulation
      type(motion_response_type), intent(in) :: response
      type(projected_motions_type), intent(inout) :: projection

      call projection%add(response%sigma, response%exchange, response%stored(simulation), &
         response%answer, response%by_rate)
   end subroutine sample

   !> Rate at which temperatures even out over the largest body that conducts worst, k/(rho c L^2).
   pure real(dp) function slowest_conduction(model) result(rate)
      type(model_type), intent(in) :: model
      real(dp) :: diffusivity(size(model%sections)), extent(2)
      integer :: body, e

      diffusivity = sqrt(huge(rate))   ! nothing stored; squares of lengths divide it
      do e = 1, size(diffusivity)
         associate (material => model%materials(model%sections(e)%material))
            if (heat_capacity(material) > 0.0_dp) diffusivity(e) = &
               maxval(material%conductivity)/heat_capacity(material)
         end associate
      end do
      rate = huge(rate)
      associate (mesh => model%mesh)
         do body = 1, mesh%body_count
            extent = [(maxval(mesh%coordinates(e, :), mask=mesh%node_body == body) - &
               minval(mesh%coordinates(e, :), mask=mesh%node_body == body), e=1, 2)]
            rate = min(rate, minval(diffusivity(mesh%element_section), mask=mesh%element_body == &
               body)/maxval(extent)**2)
         end do
      end associate
   end function slowest_conduction

   !> Finds it and those that follow, and sees whether as many motions grow as among the projected
   !> ones.
   subroutine find_fastest(simulation, motion, response, projected, neutral, wanted, record)
      type(simulation_type), intent(in) :: simulation        !! the run at its end
      type(linear_perturbation_type), intent(in) :: motion
      type(motion_response_type), intent(in) :: response     !! at a rate above it
      complex(dp), intent(in) :: projected(:)                !! rates of the projected bodies
      real(dp), intent(in) :: neutral                        !! a rate that is no growth [1/time]
      integer, intent(in) :: wanted                          !! motions that are told
      type(increment_record_type), intent(inout) :: record   !! receives them
      type(leading_modes_type) :: modes
      integer, allocatable :: leading(:)
      integer :: growing, i

      call modes%find(simulation, motion, response, neutral, record%stability%unstable_modes, &
         wanted)
      leading = modes%leading
      if (size(leading) == 0) then
         call record%stability%add_doubt('Arnoldi''s method finds no motion')
         return
      end if
      growing = count(modes%is_sharp .and. real(modes%rate) > neutral)
      associate (found => record%stability, rates => modes%rate, is_sharp => modes%is_sharp, &
         fastest => leading(1))
         call take_motion(modes%space%eigenvector(fastest), rates(fastest), simulation, motion, &
            record)
         if (abs(rates(fastest)) <= neutral) found%growth_rate = 0.0_dp
         ! Those behind one that is not sharp are not told: it may be faster.
         leading = pack(leading, [(i == 1 .or. .not. any(real(rates) > real(rates(leading(i))) &
            .and. .not. is_sharp), i=1, size(leading))])
         found%leading = reshape([(found%growth_rate, found%period, i=1, size(leading))], &
            [2, size(leading)])
         do i = 2, size(leading)
            found%leading(:, i) = [real(rates(leading(i))), period_of(rates(leading(i)))]
         end do
         if (simulation%bodies%thermal%division%is_tail()) then
            found%unstable_modes = growing
         else if (growing /= found%unstable_modes) then
            call found%add_doubt('the projected bodies have '//counted(found%unstable_modes, &
               'growing motion')//', Arnoldi''s method finds '//to_text(growing))
            ! Those that it finds are motions of the bodies themselves.
            found%unstable_modes = max(growing, found%unstable_modes)
         else if (growing > 0) then
            ! Beside the first rate of the projection the digits of a smaller one are rounding.
            if (minval(abs(projected - rates(fastest))) > alike*max(abs(rates(fastest)), &
               slower/neutral_part*neutral)) call found%add_doubt( &
               'the growth rate could not be checked')
         end if
      end associate
   end subroutine find_fastest

   !> Period of the oscillation of a rate; 0 without one.
   pure real(dp) function period_of(rate) result(period)
      complex(dp), intent(in) :: rate

      period = 0.0_dp
      if (abs(aimag(rate)) > nearly_real*abs(rate)) period = full_turn/abs(aimag(rate))
   end function period_of

   !> The motion, with a largest temperature of 1.
   subroutine take_motion(vector, rate, simulation, motion, record)
      real(dp), intent(in) :: vector(:, :)                   ! (nodes, 2) real and imaginary part
      complex(dp), intent(in) :: rate
      type(simulation_type), intent(in) :: simulation
      type(linear_perturbation_type), intent(in) :: motion
      type(increment_record_type), intent(inout) :: record
      complex(dp) :: largest

      associate (found => record%stability)
         found%is_known = .true.
         found%growth_rate = real(rate)
         found%period = period_of(rate)
      end associate
      associate (k => maxloc(hypot(vector(:, 1), vector(:, 2)), dim=1))
         largest = cmplx(vector(k, 1), vector(k, 2), dp)
      end associate
      associate (temperature => real(cmplx(vector(:, 1), vector(:, 2), dp)/largest))
         record%fields%mode_temperature = temperature
         record%fields%mode_displacement = reshape(motion%displacement(simulation%bodies, &
            simulation%state, temperature), [2, size(temperature)])
      end associate
   end subroutine take_motion

end module growing_modes
