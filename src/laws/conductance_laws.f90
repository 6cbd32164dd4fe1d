!> Contact conductance as a function of the gap and the pressure, eq. (1.8), with its derivatives.
!> Tables are straight lines between points, which hold their end values outside.
module conductance_laws
   use kinds, only: dp
   implicit none
   private
   public :: conductance_law_type, conductance_table_type, law_by_temperature_type, law_none, &
      law_gas, law_power, law_clearance, law_pressure, conductance, conductance_derivative, &
      conductance_inverse, law_jump, table_jump, is_constant, varies_with_temperature, &
      line_value, line_slope, view_at

   integer, parameter :: law_none = 0        !! this side of the law was not given
   integer, parameter :: law_gas = 1         !! open: omega = A/(B + gamma) + radiation
   integer, parameter :: law_power = 2       !! closed: omega = C0 + C1 p^n
   integer, parameter :: law_clearance = 3   !! open: table over gamma
   integer, parameter :: law_pressure = 4    !! closed: table over p

   !> Constants of a law that vary with the temperatures of the faces.
   type :: law_by_temperature_type
      !> (rows) ascending mean temperatures of A and B there; unallocated where they are constant
      real(dp), allocatable :: gas_temperature(:)
      real(dp), allocatable :: gas_a(:), gas_b(:)
      real(dp) :: radiance = 0.0_dp        !! sigma eps of two faces [power/(length^2 T^4)]
      real(dp) :: absolute_zero = 0.0_dp   !! of radiation [temperature]
   end type law_by_temperature_type

   !> Conductance over the gap or the pressure. That of several temperatures has all abscissas at
   !> each of them, on the straight lines between the rows of this temperature.
   type :: conductance_table_type
      real(dp), allocatable :: abscissa(:)      !! (rows) ascending gamma or p, >= 0
      real(dp), allocatable :: omega(:)         !! (rows) omega there, at the first temperature
      real(dp), allocatable :: temperature(:)   !! (columns) ascending means; unallocated for one
      real(dp), allocatable :: columns(:, :)    !! (rows, columns) omega at each of them
   end type conductance_table_type

   !> The open and the closed law of one surface interaction. Tables are straight lines between
   !> their rows and hold their end values outside, unless open_ends. Where a law varies with the
   !> temperatures of the faces, temperature_laws sets the components for given temperatures from
   !> the last one.
   type :: conductance_law_type
      integer :: open_kind = law_none      !! law_none, law_gas or law_clearance
      integer :: closed_kind = law_none    !! law_none, law_power or law_pressure
      real(dp) :: gas_a = 0.0_dp           !! A [power/(length temperature)]
      real(dp) :: gas_b = 1.0_dp           !! B [length]
      real(dp) :: added_length = 0.0_dp    !! JUMP= and ROUGHNESS=, added to B [length]
      real(dp) :: radiation = 0.0_dp       !! open: added, times the view factor [omega]
      real(dp) :: power_c0 = 0.0_dp        !! C0 [power/(length^2 temperature)]
      real(dp) :: power_c1 = 0.0_dp        !! C1 [C0/stress^n]
      real(dp) :: power_n = 1.0_dp         !! n [-]
      logical :: closed_adds = .false.     !! C0 + C1 p^n adds to the open value at gamma = 0
      type(conductance_table_type) :: open_table   !! over gamma [length]
      logical :: open_ends = .false.               !! omega is 0 beyond the last of these gaps
      !> (rows) ascending gamma >= 0, and view factors there; unallocated where it is 1
      real(dp), allocatable :: view_gap(:), view_factor(:)
      type(conductance_table_type) :: closed_table !! over p [stress]
      type(law_by_temperature_type) :: by_temperature   !! beside the temperatures of the tables
   end type conductance_law_type

contains

   !> omega of a contact point, eq. (1.8). A side that was not given: an open contact point carries
   !> no heat, a closed contact point has the open law's value at gamma = 0. A negative gap or
   !> pressure counts as zero.
   elemental function conductance(law, closed, gap, pressure) result(omega)
      type(conductance_law_type), intent(in) :: law
      logical, intent(in) :: closed                 !! whether the contact point is closed
      real(dp), intent(in) :: gap                   !! gamma >= 0 [length]
      real(dp), intent(in) :: pressure              !! p >= 0 in compression [stress]
      real(dp) :: omega                             !! [power/(length^2 temperature)]

      if (.not. closed) then
         omega = open_law(law, max(gap, 0.0_dp))
         return
      end if
      select case (law%closed_kind)
      case (law_power)
         omega = law%power_c0 + law%power_c1*max(pressure, 0.0_dp)**law%power_n
         if (law%closed_adds) omega = omega + open_law(law, 0.0_dp)
      case (law_pressure)
         omega = line_value(law%closed_table%abscissa, law%closed_table%omega, &
            max(pressure, 0.0_dp))
      case default
         omega = open_law(law, 0.0_dp)
      end select
   end function conductance

   !> Derivative of omega by the gap of an open contact point or by the pressure of a closed one,
   !> eq. (1.8), towards larger gaps or pressures where the law has a kink; 0 below zero, and at p =
   !> 0 for n < 1, where it is not bounded.
   pure function conductance_derivative(law, closed, gap, pressure) result(derivative)
      type(conductance_law_type), intent(in) :: law
      logical, intent(in) :: closed                 !! whether the contact point is closed
      real(dp), intent(in) :: gap                   !! gamma >= 0 [length]
      real(dp), intent(in) :: pressure              !! p >= 0 in compression [stress]
      real(dp) :: derivative                        !! d omega/d gamma or d omega/d p

      derivative = 0.0_dp
      if (closed .and. pressure >= 0.0_dp) then
         if (law%closed_kind == law_power) then
            if (pressure > 0.0_dp .or. law%power_n >= 1.0_dp) derivative = &
               law%power_c1*law%power_n*pressure**(law%power_n - 1.0_dp)
         else if (law%closed_kind == law_pressure) then
            derivative = line_slope(law%closed_table%abscissa, law%closed_table%omega, pressure)
         end if
      else if (.not. closed .and. gap >= 0.0_dp) then
         if (law%open_kind == law_gas) then
            derivative = law%gas_b + law%added_length + gap
            derivative = -(law%gas_a/derivative)/derivative
         else if (law%open_kind == law_clearance) then
            derivative = line_slope(law%open_table%abscissa, law%open_table%omega, gap)
         end if
         if (allocated(law%view_gap)) derivative = derivative + &
            law%radiation*line_slope(law%view_gap, law%view_factor, gap)
      end if
   end function conductance_derivative

   !> Gap of an open contact point, or pressure of a closed one, that has a given omega; negative
   !> where there is none, or where the law is constant; of radiation whose view factor varies none
   !> is sought.
   pure function conductance_inverse(law, closed, omega) result(at)
      type(conductance_law_type), intent(in) :: law
      logical, intent(in) :: closed                 !! whether the contact point is closed
      real(dp), intent(in) :: omega                 !! [power/(length^2 temperature)]
      real(dp) :: at                                !! gamma [length] or p [stress]
      real(dp) :: rise

      at = -1.0_dp
      if (closed) then
         if (law%closed_kind == law_power) then
            rise = omega - law%power_c0
            if (law%closed_adds) rise = rise - open_law(law, 0.0_dp)
            if (law%power_c1 > 0.0_dp) at = power_root(rise, law%power_c1, law%power_n)
         else if (law%closed_kind == law_pressure) then
            at = line_abscissa(law%closed_table%abscissa, law%closed_table%omega, omega)
         end if
      else if (allocated(law%view_gap)) then
         at = -1.0_dp
      else if (law%open_kind == law_gas) then
         if (omega > law%radiation) at = law%gas_a/(omega - law%radiation) - &
            (law%gas_b + law%added_length)
      else if (law%open_kind == law_clearance) then
         at = line_abscissa(law%open_table%abscissa, law%open_table%omega, omega - law%radiation)
      end if
   end function conductance_inverse

   !> Pressure with c1 p^n = rise; negative where there is none that can be told.
   elemental function power_root(rise, c1, n) result(pressure)
      real(dp), intent(in) :: rise   ! of omega above C0
      real(dp), intent(in) :: c1     ! > 0
      real(dp), intent(in) :: n      ! > 0
      real(dp) :: pressure

      pressure = rise
      if (rise <= 0.0_dp) return
      pressure = -1.0_dp
      ! With a small n omega is nearly the same at all pressures; the root of another one overflows.
      if (log(rise) - log(c1) < min(n, 1.0_dp)*log(huge(rise))) pressure = (rise/c1)**(1.0_dp/n)
   end function power_root

   !> Jump of omega from the open to the closed side at gamma = p = 0; zero for a continuous law.
   pure function law_jump(law) result(jump)
      type(conductance_law_type), intent(in) :: law
      real(dp) :: jump                              !! closed value less open value

      jump = conductance(law, .true., 0.0_dp, 0.0_dp) - conductance(law, .false., 0.0_dp, 0.0_dp)
   end function law_jump

   !> Decrease of omega beyond the last gap of a table that ends there, at the temperature at which
   !> it is largest; zero for any other law.
   pure function table_jump(law) result(jump)
      type(conductance_law_type), intent(in) :: law !! as the deck has it
      real(dp) :: jump                              !! [power/(length^2 temperature)]

      jump = 0.0_dp
      if (.not. law%open_ends) return
      jump = law%open_table%omega(size(law%open_table%omega))
      if (allocated(law%open_table%temperature)) jump = &
         maxval(law%open_table%columns(size(law%open_table%abscissa), :))
   end function table_jump

   !> Whether omega depends on the temperatures of the faces.
   elemental logical function varies_with_temperature(law)
      type(conductance_law_type), intent(in) :: law

      varies_with_temperature = law%by_temperature%radiance > 0.0_dp .or. &
         allocated(law%by_temperature%gas_temperature) .or. &
         allocated(law%open_table%temperature) .or. allocated(law%closed_table%temperature)
   end function varies_with_temperature

   !> Whether omega is the same at every gap, pressure and temperature.
   elemental logical function is_constant(law)
      type(conductance_law_type), intent(in) :: law

      is_constant = .false.
      if (varies_with_temperature(law)) return
      if (abs(law_jump(law)) > 0.0_dp .or. law%open_kind == law_gas) return
      if (law%open_kind == law_clearance) then
         if (.not. is_level(law%open_table%omega)) return
         if (table_jump(law) > 0.0_dp) return
      end if
      select case (law%closed_kind)
      case (law_power)
         is_constant = law%power_c1 <= 0.0_dp
      case (law_pressure)
         is_constant = is_level(law%closed_table%omega)
      case default
         is_constant = .true.
      end select
   end function is_constant

   pure logical function is_level(values)
      real(dp), intent(in) :: values(:)

      is_level = all(abs(values - values(1)) <= 0.0_dp)
   end function is_level

   pure function open_law(law, gap) result(omega)
      type(conductance_law_type), intent(in) :: law
      real(dp), intent(in) :: gap
      real(dp) :: omega

      omega = 0.0_dp
      if (law%open_kind == law_gas) then
         omega = law%gas_a/(law%gas_b + law%added_length + gap)
      else if (law%open_kind == law_clearance) then
         associate (gaps => law%open_table%abscissa)
            omega = line_value(gaps, law%open_table%omega, gap)
            if (law%open_ends .and. gap > gaps(size(gaps))) omega = 0.0_dp
         end associate
      end if
      if (law%radiation > 0.0_dp) omega = omega + law%radiation*view_at(law, gap)
   end function open_law

   !> View factor of radiation at a gap.
   pure real(dp) function view_at(law, gap)
      type(conductance_law_type), intent(in) :: law
      real(dp), intent(in) :: gap                   !! gamma >= 0 [length]

      view_at = 1.0_dp
      if (allocated(law%view_gap)) view_at = line_value(law%view_gap, law%view_factor, gap)
   end function view_at

   !> Ordinate of a curve of straight lines; beyond its ends that of the end.
   pure function line_value(abscissas, ordinates, at) result(value)
      real(dp), intent(in) :: abscissas(:)   !! (points) ascending, at least one
      real(dp), intent(in) :: ordinates(:)   !! (points)
      real(dp), intent(in) :: at             !! abscissa
      real(dp) :: value                      !! [as the ordinates]
      integer :: i, n

      n = size(abscissas)
      if (at <= abscissas(1)) then
         value = ordinates(1)
      else if (at >= abscissas(n)) then
         value = ordinates(n)
      else
         i = count(abscissas <= at)
         value = ordinates(i) + (ordinates(i + 1) - ordinates(i))*(at - abscissas(i))/ &
            (abscissas(i + 1) - abscissas(i))
      end if
   end function line_value

   !> Slope of a curve: at a point that of the line behind it, 0 where an end value is held.
   pure function line_slope(abscissas, ordinates, at) result(slope)
      real(dp), intent(in) :: abscissas(:)   !! (points) ascending, at least one
      real(dp), intent(in) :: ordinates(:)   !! (points)
      real(dp), intent(in) :: at             !! abscissa
      real(dp) :: slope                      !! [ordinate/abscissa]
      integer :: i

      slope = 0.0_dp
      i = count(abscissas <= at)
      if (i == 0 .or. i == size(abscissas)) return
      slope = (ordinates(i + 1) - ordinates(i))/(abscissas(i + 1) - abscissas(i))
   end function line_slope

   !> Abscissa at which a curve first has a value on a line that is not level; negative where it has
   !> it nowhere, abscissas being positive.
   pure function line_abscissa(abscissas, ordinates, value) result(at)
      real(dp), intent(in) :: abscissas(:)   !! (points) ascending, >= 0, at least one
      real(dp), intent(in) :: ordinates(:)   !! (points)
      real(dp), intent(in) :: value          !! ordinate
      real(dp) :: at                         !! [abscissa]
      integer :: i

      at = -1.0_dp
      do i = 1, size(abscissas) - 1
         associate (from => ordinates(i), to => ordinates(i + 1))
            if (min(from, to) > value .or. max(from, to) < value) cycle
            if (abs(to - from) <= 0.0_dp) cycle
            at = abscissas(i) + (abscissas(i + 1) - abscissas(i))*(value - from)/(to - from)
            return
         end associate
      end do
   end function line_abscissa

end module conductance_laws
