!> Whether the constants of radiation fit the units and the temperatures of a deck.
module radiation_checks
   use card_parameters, only: has_parameter, parameter_place
   use cards, only: cards_type, keyword_card_type
   use deck_report, only: deck_report_type
   use heat_checks, only: temperature_range
   use kinds, only: dp
   use model, only: model_type, unit_labels_type
   use text, only: to_text, to_upper
   implicit none
   private
   public :: check_constants

   !> Stefan-Boltzmann constant, CODATA 2018 [W/(m^2 K^4)].
   real(dp), parameter :: stefan_boltzmann = 5.670374419e-8_dp

   real(dp), parameter :: other_digits = 0.01_dp   !! relative difference of a constant
   real(dp), parameter :: other_scale = 0.5_dp     !! difference of absolute zero [K]

contains

   !> Warns of an absolute zero or a constant of Stefan and Boltzmann in another unit than the deck
   !> says, and of temperatures below absolute zero.
   subroutine check_constants(cards, model, report)
      type(cards_type), intent(in) :: cards
      type(model_type), intent(in) :: model               !! with its loads and supports
      type(deck_report_type), intent(inout) :: report     !! receives warnings
      integer :: k

      do k = 1, size(cards%keywords)
         if (cards%keywords(k)%name /= 'PHYSICAL CONSTANTS') cycle
         call check_zero(cards%keywords(k), model, report)
         call check_boltzmann(cards%keywords(k), model, report)
      end do
   end subroutine check_constants

   subroutine check_zero(card, model, report)
      type(keyword_card_type), intent(in) :: card
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      character(:), allocatable :: message
      real(dp) :: degree, least(2), zero

      if (.not. has_parameter(card, 'ABSOLUTE ZERO')) return
      call read_scale(model%units%temperature, degree, zero)
      least = temperature_range(model)
      associate (given => model%constants%absolute_zero, label => model%units%temperature)
         message = 'absolute zero is '//to_text(given)
         if (degree > 0.0_dp .and. abs(given - zero)*degree > other_scale) then
            message = message//', but '//to_text(zero)//' in '//label//', the unit of '// &
               '*OPTIONS, UNITS=; give that, or correct UNITS='
         else if (given > 0.0_dp) then
            message = message//', above 0: it is -273.15 in C, -459.67 in F and 0 in K'
         else if (least(1) < given) then
            message = message//', but the deck has a temperature of '//to_text(least(1))// &
               ', below it; give both in one unit: absolute zero is -273.15 in C, -459.67 in F '// &
               'and 0 in K'
         else
            return
         end if
      end associate
      call report%warning(parameter_place(card, 'ABSOLUTE ZERO'), message)
   end subroutine check_zero

   subroutine check_boltzmann(card, model, report)
      type(keyword_card_type), intent(in) :: card
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      real(dp) :: constant, degree, metres, watts, zero

      if (.not. has_parameter(card, 'STEFAN BOLTZMANN')) return
      call read_scale(model%units%temperature, degree, zero)
      metres = length_unit(model%units%length)
      watts = power_unit(model%units%power)
      if (min(degree, metres, watts) <= 0.0_dp) return
      constant = stefan_boltzmann*metres**2*degree**4/watts
      associate (given => model%constants%stefan_boltzmann, units => model%units)
         if (abs(given - constant) <= other_digits*constant) return
         call report%warning(parameter_place(card, 'STEFAN BOLTZMANN'), 'the constant of '// &
            'Stefan and Boltzmann is '//to_text(given)//', but '//to_text(constant)//' in the '// &
            'units of *OPTIONS, UNITS=, '//boltzmann_unit(units)//'; give that, or correct UNITS=')
      end associate
   end subroutine check_boltzmann

   pure function boltzmann_unit(units) result(words)
      type(unit_labels_type), intent(in) :: units
      character(:), allocatable :: words

      words = units%power//'/('//units%length//'^2 '//units%temperature//'^4)'
   end function boltzmann_unit

   !> A scale of temperature by its label.
   pure subroutine read_scale(label, degree, zero)
      character(*), intent(in) :: label
      real(dp), intent(out) :: degree   ! a degree [K]; 0 where the label is not known
      real(dp), intent(out) :: zero     ! absolute zero in it
      character(*), parameter :: degree_sign = char(194)//char(176)
      character(:), allocatable :: name

      name = to_upper(label)
      if (index(name, degree_sign) == 1) name = name(3:)
      if (index(name, 'DEG') == 1) name = name(4:)
      degree = 0.0_dp
      zero = 0.0_dp
      select case (name)
      case ('C', 'CELSIUS')
         degree = 1.0_dp
         zero = -273.15_dp
      case ('K', 'KELVIN')
         degree = 1.0_dp
      case ('F', 'FAHRENHEIT')
         degree = 5.0_dp/9.0_dp
         zero = -459.67_dp
      case ('R', 'RANKINE')
         degree = 5.0_dp/9.0_dp
      case default
         return
      end select
   end subroutine read_scale

   !> A unit of length by its label [m]; 0 where it is not known.
   pure real(dp) function length_unit(label)
      character(*), intent(in) :: label

      select case (to_upper(label))
      case ('M')
         length_unit = 1.0_dp
      case ('DM')
         length_unit = 1.0e-1_dp
      case ('CM')
         length_unit = 1.0e-2_dp
      case ('MM')
         length_unit = 1.0e-3_dp
      case ('UM')
         length_unit = 1.0e-6_dp
      case ('IN', 'INCH')
         length_unit = 0.0254_dp
      case ('FT')
         length_unit = 0.3048_dp
      case default
         length_unit = 0.0_dp
      end select
   end function length_unit

   !> A unit of power by its label, where m is milli and M mega [W]; 0 where it is not known.
   pure real(dp) function power_unit(label)
      character(*), intent(in) :: label

      select case (label)
      case ('W', 'w', 'J/s')
         power_unit = 1.0_dp
      case ('mW', 'mJ/s', 'Nmm/s', 'N*mm/s')
         power_unit = 1.0e-3_dp
      case ('kW', 'KW', 'kJ/s')
         power_unit = 1.0e3_dp
      case ('MW', 'MJ/s')
         power_unit = 1.0e6_dp
      case ('erg/s')
         power_unit = 1.0e-7_dp
      case ('BTU/h', 'Btu/h', 'BTU/hr', 'Btu/hr')
         power_unit = 0.29307107_dp
      case ('BTU/s', 'Btu/s')
         power_unit = 1055.05585_dp
      case default
         power_unit = 0.0_dp
      end select
   end function power_unit

end module radiation_checks
