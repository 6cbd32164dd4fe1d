!> *GAP LAW, TYPE=CMY and ROSS-STOUTE: conduction through the spots at which rough faces touch. Both
!> are laws C1 p^n.
module deck_builder_solid_spots
   use card_values, only: check_extra, need_field
   use cards, only: data_card_type, field_place
   use conductance_laws, only: conductance_law_type
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use text, only: largest_magnitude, to_text
   implicit none
   private
   public :: build_solid_spots

   real(dp), parameter :: cmy_factor = 1.25_dp     !! of Cooper, Mikic and Yovanovich
   real(dp), parameter :: cmy_exponent = 0.95_dp   !! of pressure over hardness

contains

   !> Takes one data card. With ks = 2 k1 k2/(k1 + k2), CMY is 1.25 ks (m/sigma) (p/H)^0.95 and
   !> ROSS-STOUTE ks p/(a0 sqrt(R) H).
   subroutine build_solid_spots(data, kind, report, law)
      type(data_card_type), intent(in) :: data
      character(*), intent(in) :: kind                     !! CMY or ROSS-STOUTE
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(conductance_law_type), intent(inout) :: law     !! receives the closed side
      character(12), parameter :: cmy(5) = [character(12) :: 'conductivity', 'conductivity', &
         'slope', 'roughness', 'hardness']
      character(12), parameter :: ross_stoute(5) = [character(12) :: 'conductivity', &
         'conductivity', 'roughness', 'hardness', 'a0']
      character(12) :: names(5)
      real(dp) :: value(5), magnitude
      logical :: valid(5)
      integer :: i

      names = cmy
      if (kind == 'ROSS-STOUTE') names = ross_stoute
      valid = .true.
      value = 1.0_dp
      do i = 1, 5
         call need_field(data, i, trim(names(i)), report, value(i), valid(i))
         if (.not. valid(i) .or. value(i) > 0.0_dp) cycle
         call report%error(field_place(data, i), trim(names(i))//' must be positive')
         valid(i) = .false.
      end do
      if (kind == 'CMY') then
         call check_extra(data, 5, 'two conductivities, slope, roughness, hardness', report)
      else
         call check_extra(data, 5, 'two conductivities, roughness, hardness, a0', report)
      end if
      law%closed_adds = .true.
      if (.not. all(valid)) return
      if (kind == 'CMY') then
         law%power_n = cmy_exponent
         magnitude = log(cmy_factor*harmonic_mean(value(1), value(2))) + log(value(3)) - &
            log(value(4)) - cmy_exponent*log(value(5))
      else
         law%power_n = 1.0_dp
         magnitude = log(harmonic_mean(value(1), value(2))) - 0.5_dp*log(value(3)) - &
            log(value(4)) - log(value(5))
      end if
      if (magnitude > log(largest_magnitude)) then
         call report%error(field_place(data, 1), 'the conductance at a pressure of 1 exceeds '// &
            to_text(largest_magnitude))
      else if (kind == 'CMY') then
         law%power_c1 = cmy_factor*harmonic_mean(value(1), value(2))*(value(3)/value(4))/ &
            value(5)**cmy_exponent
      else
         law%power_c1 = harmonic_mean(value(1), value(2))/(sqrt(value(3))*value(4)*value(5))
      end if
   end subroutine build_solid_spots

   pure real(dp) function harmonic_mean(one, other)
      real(dp), intent(in) :: one, other    ! > 0

      harmonic_mean = 2/(1/one + 1/other)
   end function harmonic_mean

end module deck_builder_solid_spots
