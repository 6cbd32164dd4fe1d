!> Conductance laws at given temperatures of the two faces, and how they change with these.
!>
!> Tables go by the mean temperature T = (T1 + T2)/2. Radiation between two grey faces carries
!> sigma eps (T1^4 - T2^4), T1 and T2 absolute, which is omega (T1 - T2) with
!>
!>    omega = sigma eps (T1^2 + T2^2)(T1 + T2) = 4 sigma eps T (T^2 + d^2/4),   d = T1 - T2:
!>
!> with the mean and the jump of the faces nothing of it is lost.
module temperature_laws
   use conductance_laws, only: conductance, conductance_law_type, conductance_table_type, &
      law_jump, law_none, law_pressure, line_slope, line_value, &
      varies_with_temperature, view_at
   use kinds, only: dp
   implicit none
   private
   public :: face_temperatures_type, law_at, temperature_derivatives, law_jumps, largest_jump
   public :: relative_jump
   public :: is_below_zero, radiates, radiation_ends

   !> Temperatures of the two faces at a contact point.
   type :: face_temperatures_type
      real(dp) :: mean = 0.0_dp   !! (T_xi + T_eta)/2 [temperature]
      real(dp) :: jump = 0.0_dp   !! T_xi - T_eta [temperature]
   end type face_temperatures_type

contains

   !> A law with the values that it has at given temperatures.
   pure function law_at(law, faces) result(there)
      type(conductance_law_type), intent(in) :: law
      type(face_temperatures_type), intent(in) :: faces
      type(conductance_law_type) :: there

      there = law
      if (.not. varies_with_temperature(law)) return
      associate (rows => law%by_temperature, mean => faces%mean)
         if (allocated(rows%gas_temperature)) then
            there%gas_a = line_value(rows%gas_temperature, rows%gas_a, mean)
            there%gas_b = line_value(rows%gas_temperature, rows%gas_b, mean)
         end if
         call set_to(there%open_table, mean)
         call set_to(there%closed_table, mean)
         there%radiation = 4*rows%radiance*max(mean - rows%absolute_zero, 0.0_dp)* &
            ((mean - rows%absolute_zero)**2 + 0.25_dp*faces%jump**2)
      end associate
   end function law_at

   !> Derivatives of omega by the mean temperature and by the jump, at constant gap or pressure.
   pure function temperature_derivatives(law, faces, closed, gap, pressure) result(derivatives)
      type(conductance_law_type), intent(in) :: law      !! as the deck has it
      type(face_temperatures_type), intent(in) :: faces  !! temperatures
      logical, intent(in) :: closed                      !! whether the contact point is closed
      real(dp), intent(in) :: gap                        !! gamma >= 0 [length]
      real(dp), intent(in) :: pressure                   !! p >= 0 in compression [stress]
      real(dp) :: derivatives(2)                         !! [omega/temperature]

      derivatives = 0.0_dp
      if (.not. varies_with_temperature(law)) return
      if (closed .and. law%closed_kind == law_pressure) then
         if (allocated(law%closed_table%temperature)) derivatives(1) = line_value( &
            law%closed_table%abscissa, slope_of(law%closed_table, faces%mean), &
            max(pressure, 0.0_dp))
      else if (.not. closed) then
         derivatives = open_derivatives(law, faces, max(gap, 0.0_dp))
      else if (law%closed_kind == law_none .or. law%closed_adds) then
         derivatives = open_derivatives(law, faces, 0.0_dp)
      end if
   end function temperature_derivatives

   !> Those of the open side.
   pure function open_derivatives(law, faces, gap) result(derivatives)
      type(conductance_law_type), intent(in) :: law
      type(face_temperatures_type), intent(in) :: faces
      real(dp), intent(in) :: gap
      real(dp) :: derivatives(2)
      type(conductance_law_type) :: there
      real(dp) :: length, radiation, seen

      derivatives = 0.0_dp
      there = law_at(law, faces)
      associate (rows => law%by_temperature)
         if (allocated(rows%gas_temperature)) then
            length = there%gas_b + there%added_length + gap
            derivatives(1) = line_slope(rows%gas_temperature, rows%gas_a, faces%mean)/length - &
               there%gas_a/length*line_slope(rows%gas_temperature, rows%gas_b, faces%mean)/length
         end if
         if (allocated(law%open_table%temperature)) then
            radiation = there%radiation
            there%radiation = 0.0_dp
            there%open_table%omega = slope_of(law%open_table, faces%mean)
            derivatives(1) = conductance(there, .false., gap, 0.0_dp)
            there%radiation = radiation
         end if
         if (there%radiation > 0.0_dp) then
            seen = rows%radiance*view_at(law, gap)
            derivatives(1) = derivatives(1) + seen* &
               (12*(faces%mean - rows%absolute_zero)**2 + faces%jump**2)
            derivatives(2) = 2*seen*(faces%mean - rows%absolute_zero)*faces%jump
         end if
      end associate
   end function open_derivatives

   !> Sets a table of several temperatures to a mean temperature.
   pure subroutine set_to(table, mean)
      type(conductance_table_type), intent(inout) :: table
      real(dp), intent(in) :: mean
      integer :: i

      if (allocated(table%temperature)) table%omega = [(line_value(table%temperature, &
         table%columns(i, :), mean), i=1, size(table%omega))]
   end subroutine set_to

   !> How a table of several temperatures changes with the mean temperature.
   pure function slope_of(table, mean) result(slope)
      type(conductance_table_type), intent(in) :: table
      real(dp), intent(in) :: mean
      real(dp) :: slope(size(table%abscissa))
      integer :: i

      slope = [(line_slope(table%temperature, table%columns(i, :), mean), i=1, size(slope))]
   end function slope_of

   !> Whether the law jumps at gamma = p = 0 by more than rounding, at any temperature.
   elemental logical function law_jumps(law)
      type(conductance_law_type), intent(in) :: law      !! as the deck has it
      real(dp), parameter :: rounding = 1.0e-12_dp

      law_jumps = radiation_ends(law)
      if (.not. law_jumps) law_jumps = relative_jump(law) > rounding
   end function law_jumps

   !> The jump of the law at gamma = p = 0 in the larger value there, at the temperatures at which
   !> it is largest [-].
   elemental real(dp) function relative_jump(law)
      type(conductance_law_type), intent(in) :: law      !! as the deck has it
      type(conductance_law_type) :: there
      real(dp) :: larger

      there = law
      if (varies_with_temperature(law)) there = law_at(law, largest_jump(law))
      larger = max(conductance(there, .true., 0.0_dp, 0.0_dp), &
         conductance(there, .false., 0.0_dp, 0.0_dp))
      relative_jump = 0.0_dp
      if (larger > 0.0_dp) relative_jump = abs(law_jump(there))/larger
   end function relative_jump

   !> Whether faces radiate.
   elemental logical function radiates(law)
      type(conductance_law_type), intent(in) :: law      !! as the deck has it

      radiates = law%by_temperature%radiance > 0.0_dp
   end function radiates

   !> Whether faces radiate until they meet, and no longer when they have.
   elemental logical function radiation_ends(law)
      type(conductance_law_type), intent(in) :: law      !! as the deck has it

      radiation_ends = radiates(law) .and. law%closed_kind /= law_none .and. .not. law%closed_adds
   end function radiation_ends

   !> Temperatures, equal on both faces, at which the law without radiation jumps most at
   !> gamma = p = 0: among those of its tables, between which the jump is no larger but for a B that
   !> varies.
   pure function largest_jump(law) result(faces)
      type(conductance_law_type), intent(in) :: law      !! as the deck has it
      type(face_temperatures_type) :: faces
      type(conductance_law_type) :: there
      real(dp), allocatable :: temperature(:)
      real(dp) :: largest
      integer :: i

      if (.not. varies_with_temperature(law)) return
      temperature = [real(dp) ::]
      faces%mean = law%by_temperature%absolute_zero
      if (allocated(law%by_temperature%gas_temperature)) temperature = &
         law%by_temperature%gas_temperature
      if (allocated(law%open_table%temperature)) temperature = [temperature, &
         law%open_table%temperature]
      if (allocated(law%closed_table%temperature)) temperature = [temperature, &
         law%closed_table%temperature]
      largest = -1.0_dp
      do i = 1, size(temperature)
         there = law_at(law, face_temperatures_type(mean=temperature(i)))
         there%radiation = 0.0_dp
         if (abs(law_jump(there)) <= largest) cycle
         largest = abs(law_jump(there))
         faces%mean = temperature(i)
      end do
   end function largest_jump

   !> Whether a face that radiates is below absolute zero.
   elemental logical function is_below_zero(law, faces)
      type(conductance_law_type), intent(in) :: law      !! as the deck has it
      type(face_temperatures_type), intent(in) :: faces

      is_below_zero = radiates(law) .and. faces%mean - 0.5_dp*abs(faces%jump) < &
         law%by_temperature%absolute_zero
   end function is_below_zero

end module temperature_laws
