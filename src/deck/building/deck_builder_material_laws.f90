!> *PLASTIC, *CYCLIC HARDENING, *CREEP, *ANNEAL TEMPERATURE and *LATENT HEAT -> laws of a material.
module deck_builder_material_laws
   use annealing, only: annealed_law
   use card_values, only: choice, take_parameter, check_ascending, read_row, read_rows
   use creep_laws, only: hardens_by_strain
   use deck_context, only: deck_type
   use hardening_laws, only: yield_table_type
   use kinds, only: dp
   use materials, only: isotropic, material_type, of_density, of_elasticity, of_specific_heat, &
      set_latent_heat
   use return_mapping, only: inelastic_law
   use text, only: to_text
   implicit none
   private
   public :: build_inelasticity, complete_law, build_melting

   real(dp), parameter :: default_fraction = 0.9_dp   ! of inelastic work, as in Abaqus

   character(*), parameter :: table = 'yield stress >0/plastic strain? >=0/temperature?'
   character(*), parameter :: parameters = 'yield stress >0/C >=0/gamma >=0/temperature?'
   character(*), parameter :: powers = 'A >=0/n >0/m?/temperature?'

   !> Least interval of melting, a part of latent over specific heat.
   real(dp), parameter :: least_interval = 1.0e-4_dp

   character(*), parameter :: melting_row = 'latent heat >0/solidus temperature/liquidus '// &
      'temperature'

contains

   !> Reads a card of a material. One with errors in it is not kept.
   subroutine build_inelasticity(deck, material)
      type(deck_type), intent(inout) :: deck
      type(material_type), intent(inout) :: material
      real(dp) :: value(1)
      logical :: valid

      select case (deck%card%name)
      case ('PLASTIC')
         call build_plasticity(deck, material)
      case ('CYCLIC HARDENING')
         if (.not. material%law%hardening%has_back_stress()) then
            call deck%error(deck%card%place, '*CYCLIC HARDENING is the size of a yield surface '// &
               'that moves: it belongs behind *PLASTIC, HARDENING=COMBINED')
            return
         end if
         call read_table(deck, material%law%hardening%yield)
      case ('INELASTIC HEAT FRACTION')
         value = default_fraction
         if (size(deck%card%data) > 0) call read_row(deck%card%data(1), 'fraction? >=0 =0.9', &
            deck, value, valid)
         material%law%heat_fraction = value(1)
         if (value(1) > 1.0_dp) call deck%error(deck%card%data(1)%place(1), 'the fraction is '// &
            'at most 1')
      case ('ANNEAL TEMPERATURE')
         call read_row(deck%card%data(1), 'temperature', deck, value, valid)
         if (valid) material%law%anneal_temperature = value(1)
      case default
         call build_creep(deck, material)
      end select
   end subroutine build_inelasticity

   subroutine build_plasticity(deck, material)
      type(deck_type), intent(inout) :: deck
      type(material_type), intent(inout) :: material
      character(:), allocatable :: data_type, hardening
      integer :: errors, surfaces

      errors = deck%error_count()
      hardening = choice(deck%card, 'HARDENING', 'ISOTROPIC/KINEMATIC/COMBINED', deck, 'ISOTROPIC')
      data_type = choice(deck%card, 'DATA TYPE', 'HALF CYCLE/PARAMETERS', deck, 'HALF CYCLE')
      surfaces = 1
      call take_parameter(deck%card, 'NUMBER BACKSTRESSES', deck, surfaces, '>=1')
      if (surfaces > 1) call deck%error(deck%card%place_of('NUMBER BACKSTRESSES'), 'NUMBER '// &
         'BACKSTRESSES='//to_text(surfaces)//' is refused: a material has one back stress')
      if (hardening == 'COMBINED' .neqv. data_type == 'PARAMETERS') call deck%error( &
         deck%card%place_of('DATA TYPE'), 'HARDENING=COMBINED and DATA TYPE=PARAMETERS go '// &
         'together: yield stress, C and gamma of the back stress')
      if (deck%error_count() > errors) return
      associate (law => material%law%hardening)
         if (allocated(law%back)) deallocate (law%back)
         if (hardening == 'COMBINED') then
            call read_parameters(deck, material)
         else
            call read_table(deck, law%yield)
            if (hardening == 'KINEMATIC' .and. allocated(law%yield%stress)) call make_kinematic( &
               deck, material)
         end if
      end associate
   end subroutine build_plasticity

   !> Reads the rows of a yield stress: blocks of one temperature, each over plastic strain from 0.
   subroutine read_table(deck, yield)
      type(deck_type), intent(inout) :: deck
      type(yield_table_type), intent(out) :: yield
      real(dp) :: values(3, size(deck%card%data))
      logical :: begins(size(deck%card%data)), valid
      integer :: errors, k

      errors = deck%error_count()
      call read_rows(deck%card%data, table, deck, values, valid)
      if (deck%card%flawed .or. .not. valid) return
      associate (temperature => values(3, :), n => size(values, 2))
         begins(1) = .true.
         begins(2:) = abs(temperature(2:) - temperature(:n - 1)) > 0.0_dp
         yield%first = [pack([(k, k=1, n)], begins), n + 1]
         yield%temperature = temperature(yield%first(:size(yield%first) - 1))
      end associate
      k = findloc(values(3, 2:) < values(3, :size(values, 2) - 1), .true., dim=1)
      if (k > 0) call deck%error(deck%card%data(k + 1)%place(3), 'the temperatures of the rows '// &
         'must ascend: '//to_text(values(3, k + 1))//' follows '//to_text(values(3, k)))
      ! Rows out of order are one mistake.
      do k = 1, size(yield%temperature)
         if (deck%error_count() > errors) return
         associate (first => yield%first(k), last => yield%first(k + 1) - 1)
            if (values(2, first) > 0.0_dp) then
               call deck%error(deck%card%data(first)%place(2), 'the first plastic strain'//trim( &
                  merge(' of a temperature', '                 ', size(yield%temperature) > 1))// &
                  ' must be 0')
            else
               call check_ascending(deck%card%data(first:last), 2, 'the plastic strains', values( &
                  2, first:last), deck)
            end if
         end associate
      end do
      if (deck%error_count() > errors) return
      yield%stress = values(1, :)
      yield%strain = values(2, :)
   end subroutine read_table

   subroutine read_parameters(deck, material)
      type(deck_type), intent(inout) :: deck
      type(material_type), intent(inout) :: material
      real(dp) :: values(4, size(deck%card%data))
      integer :: errors, k
      logical :: valid

      errors = deck%error_count()
      call read_rows(deck%card%data, parameters, deck, values, valid)
      if (deck%card%flawed .or. .not. valid) return
      call check_ascending(deck%card%data, 4, 'the temperatures of the rows', values(4, :), deck)
      if (deck%error_count() > errors) return
      associate (law => material%law%hardening)
         law%yield%temperature = values(4, :)
         law%yield%first = [(k, k=1, size(values, 2) + 1)]
         law%yield%stress = values(1, :)
         law%yield%strain = 0*values(1, :)
         law%back_temperature = values(4, :)
         law%back = values(2:3, :)
      end associate
   end subroutine read_parameters

   !> Two rows of each temperature: the yield surface keeps its size and moves.
   subroutine make_kinematic(deck, material)
      type(deck_type), intent(inout) :: deck
      type(material_type), intent(inout) :: material
      integer :: k

      associate (yield => material%law%hardening%yield, law => material%law%hardening)
         do k = 1, size(yield%temperature)
            associate (rows => yield%first(k + 1) - yield%first(k))
               if (rows == 2) cycle
               call deck%error(deck%card%data(yield%first(k) + min(rows, 3) - 1)%place(1), &
                  'HARDENING=KINEMATIC is linear: two rows'//trim(merge(' for each temperature', &
                  '                     ', size(yield%temperature) > 1))//', not '//to_text(rows))
               return
            end associate
         end do
         associate (first => yield%first(:size(yield%temperature)))
            law%back_temperature = yield%temperature
            allocate (law%back(2, size(first)), source=0.0_dp)
            law%back(1, :) = (yield%stress(first + 1) - yield%stress(first))/yield%strain(first + 1)
            k = findloc(law%back(1, :) < 0.0_dp, .true., dim=1)
            if (k > 0) call deck%error(deck%card%data(yield%first(k) + 1)%place(1), &
               'HARDENING=KINEMATIC must not soften: the second stress is below the first')
            yield%stress = yield%stress(first)
            yield%strain = yield%strain(first)
            yield%first = [(k, k=1, size(yield%temperature) + 1)]
         end associate
      end associate
   end subroutine make_kinematic

   !> Reads A, n and m, over temperature.
   subroutine build_creep(deck, material)
      type(deck_type), intent(inout) :: deck
      type(material_type), intent(inout) :: material
      character(:), allocatable :: law
      real(dp) :: values(4, size(deck%card%data))
      integer :: errors, k
      logical :: valid

      errors = deck%error_count()
      law = choice(deck%card, 'LAW', 'NORTON/TIME/STRAIN', deck, 'NORTON')
      call read_rows(deck%card%data, powers, deck, values, valid)
      if (deck%card%flawed .or. .not. valid) return
      do k = 1, size(deck%card%data)
         if (values(3, k) > -1.0_dp .and. values(3, k) <= 0.0_dp) cycle
         call deck%error(deck%card%data(k)%place(3), 'm must lie above -1 and not above 0')
      end do
      call check_ascending(deck%card%data, 4, 'the temperatures of the rows', values(4, :), deck)
      if (deck%error_count() > errors) return
      if (deck%card%lacks('LAW') .and. any(abs(values(3, :)) > 0.0_dp)) then
         call deck%error(deck%card%place, '*CREEP with m other than 0 needs LAW=: NORTON or '// &
            'TIME with a rate A q^n t^m, STRAIN with one of the strain so far; programs differ '// &
            'in what they take without it')
         return
      end if
      if (law == 'STRAIN') material%law%creep%kind = hardens_by_strain
      material%law%creep%temperature = values(4, :)
      material%law%creep%constants = values(:3, :)
   end subroutine build_creep

   !> The law of a material whose cards have all been read.
   subroutine complete_law(m, deck, material)
      integer, intent(in) :: m                               !! its number
      type(deck_type), intent(inout) :: deck
      type(material_type), intent(inout) :: material
      real(dp) :: anneal_temperature, fraction
      integer :: k

      anneal_temperature = material%law%anneal_temperature
      if (.not. (material%law%hardening%yields() .or. material%law%creep%creeps())) then
         if (anneal_temperature < huge(fraction)) material%law = annealed_law(material%law, &
            anneal_temperature)
         return
      end if
      if (allocated(material%given)) then
         do k = 1, size(material%given)
            if (material%given(k)%kind /= of_elasticity) cycle
            if (material%given(k)%symmetry /= isotropic) call deck%error(deck%material_place(m), &
               'material '//material%name//': *PLASTIC and *CREEP need isotropic elasticity, '// &
               '*ELASTIC, TYPE=ISOTROPIC')
         end do
      end if
      fraction = material%law%heat_fraction
      material%law = inelastic_law(material%law%hardening, material%law%creep)
      material%law%heat_fraction = fraction
      if (anneal_temperature < huge(fraction)) material%law = annealed_law(material%law, &
         anneal_temperature)
   end subroutine complete_law

   !> Reads a card of a material whose other cards have all been read.
   subroutine build_melting(deck, material)
      type(deck_type), intent(inout) :: deck
      type(material_type), intent(inout) :: material
      real(dp) :: above, values(3, size(deck%card%data)), width
      integer :: errors, i
      logical :: valid

      errors = deck%error_count()
      call read_rows(deck%card%data, melting_row, deck, values, valid)
      if (deck%card%flawed .or. .not. valid) return
      do i = 1, 2
         if (material%has(merge(of_density, of_specific_heat, i == 1))) cycle
         call deck%missing(deck%card%place, 'material '//material%name//' has *LATENT HEAT, '// &
            'but no '//trim(merge('*DENSITY      ', '*SPECIFIC HEAT', i == 1))//': the heat of '// &
            'a volume needs both', trim(merge('*DENSITY      ', '*SPECIFIC HEAT', i == 1)))
         return
      end do
      if (material%specific_heat <= 0.0_dp) return
      above = -huge(above)
      do i = 1, size(values, 2)
         if (values(3, i) < values(2, i)) call deck%error(deck%card%data(i)%place(3), 'the '// &
            'liquidus, '//to_text(values(3, i))//', is below the solidus, '//to_text(values(2, i)))
         if (deck%error_count() > errors) return
         width = least_interval*values(1, i)/material%specific_heat
         if (values(3, i) - values(2, i) < width) then
            values(2, i) = values(3, i) - width
            call deck%note('*LATENT HEAT: material '//material%name//' melts from '// &
               to_text(values(2, i))//' to '//to_text(values(3, i))//': the smallest interval '// &
               'is 1e-4 of latent over specific heat')
         end if
         if (values(2, i) < above) call deck%error(deck%card%data(i)%place(2), 'rows must '// &
            'ascend and not overlap: melting from '//to_text(values(2, i))//' on follows a '// &
            'liquidus of '//to_text(above))
         above = values(3, i)
      end do
      if (deck%error_count() == errors) call set_latent_heat(material, values(1, :), &
         values(2, :), values(3, :))
   end subroutine build_melting

end module deck_builder_material_laws
