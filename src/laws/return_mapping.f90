!> Plasticity after von Mises and creep of an isotropic material, by the implicit rule of Euler.
!>
!> S is the deviator of the trial stress, which has the inelastic strains of the start; x and y are
!> the increments of the equivalent plastic and creep strains, q is the equivalent stress and b =
!> 3 G y/q. Everything follows from two numbers, alpha = 1/(1 + b) and g = 1/(1 + gamma x):
!>
!>    eta = alpha S - g C a0,    N = eta/|eta|,    |eta| = Y + 3 G alpha x + C g x,
!>    s = alpha (S - 3 G x N),   X = C a,   a = g (a0 + x N),
!>
!> |.| being von Mises' equivalent stress, Y the size of the yield surface at the end. The number x
!> is found by Newton's method inside a safeguarded one for ln alpha, in which creep of any exponent
!> is nearly linear; both derivatives make the consistent tangent. In plane stress the strain across
!> the plane is found outside of both.
!>
!> A stage of an increment creeps by its part of the strain that its stress, held over the whole
!> increment, makes from the strain at its start: as accurate as the rate at the end of the stage,
!> and exact where the stress is constant.
!>
!> J. C. Simo, R. L. Taylor, Comput. Meth. Appl. Mech. Eng. 48 (1985) 101; Int. J. Num. Meth. Eng.
!> 22 (1986) 649; P. Ellsiepen, S. Hartmann, Int. J. Num. Meth. Eng. 51 (2001) 679.
module return_mapping
   use creep_laws, only: creep_type, exp_less_one, log_one_and
   use hardening_laws, only: hardening_type
   use kinds, only: dp
   use material_laws, only: law_interval_type, law_points_type, material_law_type
   implicit none
   private
   public :: inelastic_law, history_creep, history_plastic

   ! Where a history has what; strains are xx, yy, zz and the angle xy.
   integer, parameter :: history_plastic = 1     !! plastic strain, behind it the equivalent one
   integer, parameter :: history_creep = 6       !! likewise of creep
   integer, parameter :: history_work = 11       !! work of plasticity and of creep [energy/volume]
   integer, parameter :: at_start = 13           !! equivalent creep strain as the increment began
   integer, parameter :: history_back = 14       !! a of the back stress

   real(dp), parameter :: weight(4) = [1.0_dp, 1.0_dp, 1.0_dp, 2.0_dp]   !! of a tensor's product
   real(dp), parameter :: to_tensor(4) = [1.0_dp, 1.0_dp, 1.0_dp, 0.5_dp]
   !> Part of a stress or of ln alpha that is rounding: of stresses of strains a hundred times the
   !> elastic ones, and of logarithms of numbers down to epsilon
   real(dp), parameter :: rounding = 1.0e-13_dp
   integer, parameter :: most_passes = 100

   !> A point at its temperature.
   type :: point_type
      type(hardening_type) :: hardening
      type(creep_type) :: creep
      real(dp) :: temperature = 0.0_dp
      real(dp) :: shear = 0.0_dp, bulk = 0.0_dp   ! G and K [stress]
      real(dp) :: back(2) = 0.0_dp                ! C and gamma
      type(law_interval_type) :: interval
      ! At the start: of the stage, and creep strain of the increment.
      real(dp) :: a0(4) = 0.0_dp, plastic = 0.0_dp, crept = 0.0_dp
   end type point_type

   !> What the numbers alpha and x make of a trial stress.
   type :: return_type
      real(dp) :: alpha = 1.0_dp
      real(dp) :: x = 0.0_dp                      ! plastic strain [-]
      real(dp) :: y = 0.0_dp                      ! creep strain [-]
      real(dp) :: y_slope = 0.0_dp                ! by the equivalent stress [1/stress]
      real(dp) :: trial(4) = 0.0_dp               ! S [stress]
      real(dp) :: eta = 0.0_dp                    ! its equivalent stress [stress]
      real(dp) :: n(4) = 0.0_dp
      real(dp) :: s(4) = 0.0_dp, q = 0.0_dp       ! [stress]
      real(dp) :: slope = 0.0_dp                  ! of the yield stress [stress]
      logical :: found = .true.
   end type return_type

contains

   !> The law of a material.
   function inelastic_law(hardening, creep) result(law)
      type(hardening_type), intent(in) :: hardening
      type(creep_type), intent(in) :: creep
      type(material_law_type) :: law

      law%hardening = hardening
      law%creep = creep
      law%history_count = history_back - 1
      if (hardening%has_back_stress()) law%history_count = history_back + 3
      law%work = history_work
      if (hardening%yields()) law%strains(1) = history_plastic
      if (creep%creeps()) law%strains(2) = history_creep
      allocate (law%of_time(law%history_count), source=.false.)
      law%of_time(history_creep:history_creep + 4) = .true.
      law%of_time([history_work + 1, at_start]) = .true.
      law%respond => respond
   end function inelastic_law

   pure subroutine respond(law, points, interval, history)
      type(material_law_type), intent(in) :: law
      type(law_points_type), intent(inout) :: points
      type(law_interval_type), intent(in) :: interval
      real(dp), intent(inout) :: history(:, :)
      type(point_type) :: point
      integer :: g

      point%hardening = law%hardening
      point%creep = law%creep
      point%interval = interval
      do g = 1, points%count
         point%temperature = points%temperature(g)
         point%back = law%hardening%back_constants(point%temperature)
         point%crept = history(at_start, g)
         point%plastic = history(history_plastic + 4, g)
         if (law%hardening%has_back_stress()) point%a0 = history(history_back:, g)
         call respond_point(point, points%stress(g, :), points%tangent(:, :, g), history(:, g), &
            points%failed)
         if (interval%is_last) history(at_start, g) = history(history_creep + 4, g)
      end do
   end subroutine respond

   !> Stress, tangent and history of a point. Those of elasticity come in; in plane stress they have
   !> no row 3.
   pure subroutine respond_point(point, stress, tangent, history, failed)
      type(point_type), intent(inout) :: point
      real(dp), intent(inout) :: stress(4), tangent(4, 4)
      real(dp), intent(inout) :: history(:)
      logical, intent(inout) :: failed
      type(return_type) :: found
      real(dp) :: across, lambda, trial(4)
      logical :: is_plane_stress
      integer :: i

      is_plane_stress = tangent(3, 3) <= 0.0_dp
      stress = stress - matmul(tangent, history(history_plastic:history_plastic + 3) + &
         history(history_creep:history_creep + 3))
      point%shear = tangent(4, 4)
      lambda = tangent(1, 2)
      ! Condensed, this is nu of the other one.
      if (is_plane_stress) lambda = 2*point%shear*lambda/(tangent(1, 1) - 2*lambda)
      point%bulk = lambda + 2*point%shear/3
      across = 0.0_dp
      do i = 1, most_passes
         trial = stress + across*[lambda, lambda, lambda + 2*point%shear, 0.0_dp]
         found = returned(point, deviator(trial))
         if (.not. found%found) exit
         call find_tangent(point, found, tangent)
         if (.not. is_plane_stress) exit
         associate (normal => found%s(3) + sum(trial(:3))/3)
            if (abs(normal) <= rounding*max(found%q, abs(sum(trial(:3))/3))) exit
            across = across - normal/tangent(3, 3)
         end associate
         found%found = i < most_passes
      end do
      failed = failed .or. .not. found%found
      if (failed) return
      stress = found%s + sum(trial(:3))/3*[1.0_dp, 1.0_dp, 1.0_dp, 0.0_dp]
      call keep_history(point, found, history)
      if (.not. is_plane_stress) return
      stress(3) = 0.0_dp
      tangent = tangent - spread(tangent(:, 3)/tangent(3, 3), 2, 4)*spread(tangent(3, :), 1, 4)
      tangent(3, :) = 0.0_dp
      tangent(:, 3) = 0.0_dp
   end subroutine respond_point

   !> The strains that a return makes join the history, and the work on them.
   pure subroutine keep_history(point, found, history)
      type(point_type), intent(in) :: point
      type(return_type), intent(in) :: found
      real(dp), intent(inout) :: history(:)

      associate (plastic => history(history_plastic:), creep => history(history_creep:), &
         work => history(history_work:))
         if (found%x > 0.0_dp) then
            plastic(:4) = plastic(:4) + 1.5_dp*found%x*found%n/to_tensor
            plastic(5) = plastic(5) + found%x
            work(1) = work(1) + 1.5_dp*found%x*sum(weight*found%s*found%n)
            if (point%hardening%has_back_stress()) history(history_back:) = (point%a0 + &
               found%x*found%n)/(1 + point%back(2)*found%x)
         end if
         if (found%y > 0.0_dp) then
            creep(:4) = creep(:4) + 1.5_dp*found%y*found%s/(found%q*to_tensor)
            creep(5) = creep(5) + found%y
            work(2) = work(2) + found%y*found%q
         end if
      end associate
   end subroutine keep_history

   !> The stress that a trial stress returns to.
   pure function returned(point, trial) result(there)
      type(point_type), intent(in) :: point
      real(dp), intent(in) :: trial(4)            ! deviator [stress]
      type(return_type) :: there
      real(dp) :: b, ends(2), f, slope, u
      integer :: i

      there%trial = trial
      call find_plastic(point, there)
      if (.not. point%creep%creeps() .or. point%interval%real_part <= 0.0_dp .or. &
         there%q <= 0.0_dp .or. .not. there%found) return
      call find_creep(point, there)
      if (there%y <= 0.0_dp) return
      ! ln(b q) = ln(3 G y(q)) for u = ln(1 + b). The stress falls with b, which is less than at u.
      u = log_one_and(3*point%shear*there%y/there%q)
      ends = [0.0_dp, 2*u]
      do i = 1, most_passes
         there%alpha = exp(-u)
         call find_plastic(point, there)
         if (.not. there%found) return
         call find_creep(point, there)
         b = exp_less_one(u)
         f = log(b) - log(3*point%shear*there%y/there%q)
         if (f > 0.0_dp) ends(2) = u
         if (f <= 0.0_dp) ends(1) = u
         slope = (1 + b)/b + (there%y_slope/there%y - 1/there%q)*there%alpha* &
            equivalent_slope(point, there)
         if (abs(f/slope) <= rounding*u) return
         u = u - f/slope
         if (u <= ends(1) .or. u >= ends(2)) u = sum(ends)/2
      end do
      there%found = .false.
   end function returned

   !> Slope of the equivalent stress by alpha.
   pure real(dp) function equivalent_slope(point, there) result(slope)
      type(point_type), intent(in) :: point
      type(return_type), intent(in) :: there

      slope = 1.5_dp*sum(weight*there%s*change_of(point, there, spread(0.0_dp, 1, 4), 1.0_dp))/ &
         there%q
   end function equivalent_slope

   pure subroutine find_creep(point, there)
      type(point_type), intent(in) :: point
      type(return_type), intent(inout) :: there

      there%y = 0.0_dp
      if (there%q <= 0.0_dp) return
      call point%creep%find_strain(there%q, point%temperature, point%crept, &
         point%interval%instants, there%y, there%y_slope)
      there%y = point%interval%real_part*there%y
      there%y_slope = point%interval%real_part*there%y_slope
   end subroutine find_creep

   !> The plastic strain at a given alpha. What is left over falls with it.
   pure subroutine find_plastic(point, there)
      type(point_type), intent(in) :: point
      type(return_type), intent(inout) :: there
      real(dp) :: ends(2), f, g, radius
      integer :: i

      there%x = 0.0_dp
      there%s = there%alpha*there%trial
      there%q = equivalent(there%s)
      if (.not. point%hardening%yields()) return
      ends = [0.0_dp, huge(1.0_dp)]
      do i = 1, most_passes
         g = 1/(1 + point%back(2)*there%x)
         associate (eta => there%alpha*there%trial - g*point%back(1)*point%a0)
            there%eta = equivalent(eta)
            there%n = eta/max(there%eta, tiny(g))
         end associate
         call point%hardening%find_yield(point%plastic + there%x, point%temperature, radius, &
            there%slope)
         f = there%eta - radius - (3*point%shear*there%alpha + point%back(1)*g)*there%x
         if (i == 1 .and. f <= rounding*radius) return
         there%s = there%alpha*(there%trial - 3*point%shear*there%x*there%n)
         there%q = equivalent(there%s)
         if (abs(f) <= rounding*there%eta) return
         if (f > 0.0_dp) ends(1) = there%x
         if (f < 0.0_dp) ends(2) = there%x
         if (ends(2) - ends(1) <= epsilon(f)*ends(2)) return
         there%x = there%x + f/hardening_slope(point, there)
         if (there%x <= ends(1) .or. there%x >= ends(2)) there%x = sum(ends)/2
      end do
      there%found = .false.
   end subroutine find_plastic

   !> How fast what is left over falls with the plastic strain.
   pure real(dp) function hardening_slope(point, there) result(slope)
      type(point_type), intent(in) :: point
      type(return_type), intent(in) :: there
      real(dp) :: g

      g = 1/(1 + point%back(2)*there%x)
      slope = there%slope + 3*point%shear*there%alpha + point%back(1)*g**2*(1 - &
         point%back(2)*1.5_dp*sum(weight*there%n*point%a0))
   end function hardening_slope

   !> Change of the stress with changes of the trial stress and of alpha.
   pure function change_of(point, there, trial, alpha) result(change)
      type(point_type), intent(in) :: point
      type(return_type), intent(in) :: there
      real(dp), intent(in) :: trial(4), alpha
      real(dp) :: change(4)
      real(dp) :: eta(4), g, x

      change = there%alpha*trial + alpha*there%trial
      if (there%x <= 0.0_dp) return
      x = (1.5_dp*sum(weight*there%n*change) - 3*point%shear*there%x*alpha)/ &
         hardening_slope(point, there)
      g = 1/(1 + point%back(2)*there%x)
      eta = change + point%back(2)*g**2*x*point%back(1)*point%a0
      eta = eta - 1.5_dp*sum(weight*there%n*eta)*there%n
      change = change - 3*point%shear*(alpha*there%x*there%n + there%alpha*(x*there%n + &
         there%x*eta/there%eta))
   end function change_of

   !> Tangent of the stress by strains, shear strains being angles.
   pure subroutine find_tangent(point, there, tangent)
      type(point_type), intent(in) :: point
      type(return_type), intent(in) :: there
      real(dp), intent(out) :: tangent(4, 4)
      real(dp) :: by_alpha(4), excess, unit(4)
      integer :: j

      excess = 0.0_dp
      if (there%y > 0.0_dp) then
         by_alpha = change_of(point, there, spread(0.0_dp, 1, 4), 1.0_dp)
         excess = there%alpha**2/there%q*(3*point%shear*there%y_slope - (1/there%alpha - 1))
         excess = -excess/(1 + excess*1.5_dp*sum(weight*there%s*by_alpha)/there%q)
      end if
      do j = 1, 4
         unit = 0.0_dp
         unit(j) = 2*point%shear*to_tensor(j)
         tangent(:, j) = change_of(point, there, deviator(unit), 0.0_dp)
         if (there%y > 0.0_dp) tangent(:, j) = tangent(:, j) + by_alpha*excess*1.5_dp* &
            sum(weight*there%s*tangent(:, j))/there%q
      end do
      tangent(:3, :3) = tangent(:3, :3) + point%bulk
   end subroutine find_tangent

   pure function deviator(stress) result(part)
      real(dp), intent(in) :: stress(4)
      real(dp) :: part(4)

      part = stress - sum(stress(:3))/3*[1.0_dp, 1.0_dp, 1.0_dp, 0.0_dp]
   end function deviator

   !> Von Mises' equivalent stress of a deviator.
   pure real(dp) function equivalent(s)
      real(dp), intent(in) :: s(4)

      equivalent = sqrt(1.5_dp*sum(weight*s**2))
   end function equivalent

end module return_mapping
