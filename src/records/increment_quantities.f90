!> Reported quantities of an increment as a whole, of its bodies and of its passes.
module increment_quantities
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use kinds, only: dp
   use no_estimates, only: mark_of, no_finer_value
   use quantity_types, only: needs_branch, needs_coupling, needs_creep, needs_dilatation, &
      needs_friction, needs_friction_heat, needs_heat, needs_laws, needs_mechanics, needs_melting, &
      needs_plasticity, needs_references, needs_sections, needs_stability, needs_storage, &
      of_bodies, of_elements, of_history, of_motions, of_passes, of_references, of_sections, &
      quantity_type
   use field_recovery, only: error_record_type
   use records, only: increment_outcome_type, increment_record_type, stability_record_type
   use solution_report, only: iteration_record_type
   use text, only: counted, few_digits
   implicit none
   private
   public :: increment_table, history_estimated, history_value, part_values, pass_value, &
      leading_words, stability_words

   type(quantity_type), parameter :: increment_table(*) = [ &
      quantity_type('time', of_history, 'time', &
      description='total time at the end of the increment'), &
      quantity_type('load', of_history, 'load', &
      description='value on the load axis, which the attribute label names'), &
      quantity_type('iterations', of_history, '-', is_integer=.true., &
      description='iterations of the fixed point'), &
      quantity_type('cut_backs', of_history, '-', is_integer=.true., is_published=.false.), &
      quantity_type('residual', of_history, '-', is_published=.false.), &
      quantity_type('residual_floor', of_history, '-', is_published=.false.), &
      quantity_type('heat_in', of_history, 'power', needs_heat, label='heat in', &
      is_estimated=.true., &
      description='sum of the net heat rates of loads and supports that are positive'), &
      quantity_type('heat_out', of_history, 'power', needs_heat, label='out', &
      is_estimated=.true., &
      description='sum of those that are negative, as a magnitude'), &
      quantity_type('heat_stored', of_history, 'power', needs_storage, label='stored', &
      is_estimated=.true., &
      description='heat that bodies store: in and friction less out and dilatation'), &
      quantity_type('heat_dilatation', of_history, 'power', needs_dilatation, label='dilatation', &
      is_estimated=.true., &
      description='heat that strains take up, the term with T0 beta of (1.2), or '// &
      'minus that of inelastic work'), &
      quantity_type('heat_friction', of_history, 'power', needs_friction_heat, &
      label='heat of friction', is_estimated=.true., &
      description='heat that friction makes'), &
      quantity_type('solid_time', of_history, 'time', needs_melting, is_estimated=.true., &
      resolution=0.2_dp, &
      description='time at which the last point that melts became solid; NaN before'), &
      quantity_type('heat_imbalance', of_history, '-', needs_heat, label='heat imbalance', &
      description='imbalance of the heat balance that the scheme solves, over the largest rate'), &
      quantity_type('heat_imbalance_pointwise', of_history, '-', needs_heat, &
      label='at this instant', &
      description='imbalance of heat at the end of the increment, over the largest rate'), &
      quantity_type('force_imbalance', of_history, '-', needs_mechanics, label='force imbalance', &
      description='imbalance of forces over the largest force'), &
      quantity_type('contact_violation', of_history, '-', needs_mechanics, is_published=.false., &
      label='contact conditions violated by'), &
      quantity_type('coupling_gain', of_history, '-', needs_coupling, &
      label='quasi-static coupling gain', &
      description='real part of the eigenvalue of U'' that is largest in modulus'), &
      quantity_type('coupling_gain_max', of_history, '-', needs_coupling, &
      label='largest real eigenvalue', description='largest real eigenvalue of U'''), &
      quantity_type('ALLSE', of_history, 'stress length^3', needs_laws, &
      description='elastic energy that is stored'), &
      quantity_type('ALLPD', of_history, 'stress length^3', needs_laws, &
      description='energy that plasticity dissipated so far'), &
      quantity_type('ALLCD', of_history, 'stress length^3', needs_laws, &
      description='energy that creep dissipated so far'), &
      quantity_type('ALLFD', of_history, 'stress length^3', needs_friction, &
      description='energy that friction dissipated so far by slip in the plane'), &
      quantity_type('ALLWK', of_history, 'stress length^3', needs_laws, &
      description='work of loads, supports, temperatures and interferences so far'), &
      quantity_type('unstable_modes', of_history, '-', needs_stability, &
      description='small motions of the state that grow'), &
      quantity_type('certain', of_history, '-', needs_stability, is_integer=.true., &
      description='1 where both ways of counting agree and nothing is left out, else 0'), &
      quantity_type('growth_rate', of_history, '1/time', needs_stability, &
      description='rate of the leading mode: the fastest to grow, or the slowest to decay'), &
      quantity_type('period', of_history, 'time', needs_stability, &
      description='period of its oscillation, 0 without one'), &
      quantity_type('growth_rates', of_motions, '1/time', needs_stability, &
      description='rates of the leading modes, the fastest first; a pair that oscillates once'), &
      quantity_type('periods', of_motions, 'time', needs_stability, &
      description='periods of their oscillations, 0 without one'), &
      quantity_type('load_factor', of_history, '-', needs_branch, label='load factor', &
      description='load factor of a point of a branch, which may fall'), &
      quantity_type('fold', of_history, '-', needs_branch, is_integer=.true., label='fold', &
      description='1 where the load factor of a branch turns, else 0'), &
      quantity_type('unstable', of_history, '-', needs_branch, is_integer=.true., &
      label='unstable', description='1 where det(I - U'') < 0: an odd number of modes grows'), &
      quantity_type('pre_tension', of_sections, 'stress length^2', needs_sections, &
      label='pre-tension', description='force across a pre-tension section, positive in '// &
      'tension; a column each where there are several'), &
      quantity_type('U3', of_references, 'length', needs_references, description= &
      'change of the thickness at the reference node; a column each where there are several'), &
      quantity_type('UR1', of_references, '-', needs_references, &
      description='turn about x of one face of the body to the other'), &
      quantity_type('UR2', of_references, '-', needs_references, &
      description='turn about y of one face of the body to the other'), &
      quantity_type('RF3', of_references, 'stress length^2', needs_references, &
      description='force along z on the faces, positive in tension'), &
      quantity_type('RM1', of_references, 'stress length^3', needs_references, &
      description='moment about x on the faces, at the reference node'), &
      quantity_type('RM2', of_references, 'stress length^3', needs_references, &
      description='moment about y on the faces, at the reference node'), &
      quantity_type('stress_error', of_bodies, '-', needs_mechanics, label='stress', &
      description='estimated error of the stress by the mesh, relative; one column per body'), &
      quantity_type('heat_flux_error', of_bodies, '-', needs_heat, label='heat flux', &
      description='estimated error of the heat flux by the mesh, relative; one column per body'), &
      quantity_type('largest_plastic_strain', of_bodies, '-', needs_plasticity, &
      description='largest equivalent plastic strain at a point; one column per body'), &
      quantity_type('largest_creep_strain', of_bodies, '-', needs_creep, &
      description='largest equivalent creep strain at a point; one column per body'), &
      quantity_type('increment', of_passes, '-', head='increment', width=12, is_integer=.true., &
      description='increment of the iteration'), &
      quantity_type('iteration', of_passes, '-', head='iteration', width=11, is_integer=.true., &
      description='number of the iteration in its increment'), &
      quantity_type('residual', of_passes, '-', head='residual', width=12, &
      description='largest change of a conductance by the iteration, relative'), &
      quantity_type('g_min', of_passes, '-', head='g min', width=11, is_plain=.true., &
      description='smallest factor g of eq. (4.2)'), &
      quantity_type('g_max', of_passes, '-', head='g max', width=11, is_plain=.true., &
      description='largest factor g of eq. (4.2)'), &
      quantity_type('g_kept', of_passes, '-', head='g kept', width=8, is_integer=.true., &
      is_published=.false.), &
      quantity_type('pairs_changed', of_passes, '-', head='points changed', width=15, &
      is_integer=.true., description='contact points whose contact state changed'), &
      quantity_type('cut_backs', of_passes, '-', head='cut-backs', width=11, is_integer=.true., &
      description='cut-backs of the increment before the iteration')]

   !> Those with an uncertainty.
   type(quantity_type), parameter :: history_estimated(*) = pack(increment_table, &
      increment_table%is_estimated)

contains

   !> A quantity of an increment.
   pure function history_value(name, record) result(value)
      character(*), intent(in) :: name                     !! one of of_history
      type(increment_record_type), intent(in) :: record
      real(dp) :: value                                    !! NaN for a name that is not known
      integer :: passes

      passes = 0
      if (allocated(record%iterations)) passes = size(record%iterations)
      value = ieee_value(value, ieee_quiet_nan)
      select case (name)
      case ('time')
         value = record%time
      case ('load')
         value = record%load
      case ('iterations')
         value = passes
      case ('cut_backs')
         value = record%cut_backs
      case ('residual')
         value = 0.0_dp
         if (passes > 0) value = record%iterations(passes)%residual
      case ('residual_floor')
         value = record%residual_floor
      case ('ALLSE', 'ALLPD', 'ALLCD', 'ALLFD', 'ALLWK')
         if (allocated(record%energies)) value = record%energies(findloc(['SE', 'PD', 'CD', 'FD', &
            'WK'], name(4:5), dim=1))
      case ('heat_in')
         value = record%heat_in
      case ('heat_out')
         value = record%heat_out
      case ('heat_stored')
         value = record%heat_stored
      case ('heat_dilatation')
         value = record%heat_dilatation
      case ('heat_friction')
         value = record%heat_friction
      case ('solid_time')
         if (allocated(record%solid_time)) value = record%solid_time(1)
      case ('heat_imbalance')
         value = record%heat_imbalance
      case ('heat_imbalance_pointwise')
         value = record%heat_imbalance_pointwise
      case ('force_imbalance')
         value = record%force_imbalance
      case ('contact_violation')
         value = record%contact_violation
      case ('coupling_gain')
         value = record%coupling_gain
      case ('coupling_gain_max')
         value = record%coupling_gain_max
      case ('unstable_modes', 'certain', 'growth_rate', 'period')
         value = stability_value(name, record)
      case ('load_factor')
         if (allocated(record%load_factor)) value = record%load_factor
      case ('fold')
         value = merge(1.0_dp, 0.0_dp, record%is_fold)
      case ('unstable')
         value = merge(1.0_dp, 0.0_dp, record%is_unstable)
      case default   ! not known
      end select
   end function history_value

   !> A quantity of the small motions; NaN where they are not known.
   pure real(dp) function stability_value(name, record) result(value)
      character(*), intent(in) :: name
      type(increment_record_type), intent(in) :: record

      value = ieee_value(value, ieee_quiet_nan)
      if (.not. allocated(record%stability)) return
      if (name == 'certain') value = merge(0.0_dp, 1.0_dp, allocated(record%stability%doubt))
      if (name == 'certain' .or. .not. record%stability%is_known) return
      select case (name)
      case ('unstable_modes')
         value = record%stability%unstable_modes
      case ('growth_rate')
         value = record%stability%growth_rate
      case default
         value = record%stability%period
      end select
   end function stability_value

   !> Whether a state lasts, in words; empty where nothing is known of it.
   pure function stability_words(record, unit) result(words)
      class(increment_outcome_type), intent(in) :: record
      character(*), intent(in) :: unit     !! of time; may be empty
      character(:), allocatable :: words   !! such as 'stable; slowest mode decays in 41 s'

      words = ''
      if (record%is_unstable) words = 'unstable whatever the heat capacities are: det(I - U'') '// &
         'is negative'
      if (.not. allocated(record%stability)) return
      associate (found => record%stability)
         if (found%is_known) words = motion_words(found, unit)
         if (.not. allocated(found%doubt)) return
         if (record%is_unstable .and. .not. found%is_known) return
         if (words == '') then
            words = 'uncertain: '//found%doubt
         else
            words = 'uncertain, '//words//'; '//found%doubt
         end if
      end associate
   end function stability_words

   !> Small motions in words.
   pure function motion_words(found, unit) result(words)
      type(stability_record_type), intent(in) :: found
      character(*), intent(in) :: unit
      character(:), allocatable :: words

      if (found%unstable_modes > 0) then
         words = 'unstable: '//counted(found%unstable_modes, 'mode')//trim(merge(' grows', &
            ' grow ', found%unstable_modes == 1))
         ! Of motions that are in doubt the fastest one that is found may decay.
         if (found%growth_rate > 0.0_dp) words = words//', doubling in '// &
            trim(few_digits(log(2.0_dp)/found%growth_rate, 3)//' '//unit)
      else if (found%growth_rate < 0.0_dp) then
         words = trim('stable; slowest mode decays in '//few_digits(-1.0_dp/found%growth_rate, &
            3)//' '//unit)
      else
         words = 'neutral: a mode neither grows nor decays'
      end if
      if (found%period > 0.0_dp) words = trim(words//', period '// &
         few_digits(found%period, 3)//' '//unit)
   end function motion_words

   !> Growth rates and periods of leading motions in words; empty where none is known.
   pure function leading_words(record, unit) result(words)
      class(increment_outcome_type), intent(in) :: record
      character(*), intent(in) :: unit     !! of time; may be empty
      character(:), allocatable :: words
      integer :: i

      words = ''
      if (.not. allocated(record%stability)) return
      if (.not. allocated(record%stability%leading)) return
      associate (leading => record%stability%leading)
         do i = 1, size(leading, 2)
            words = words//trim(merge(', ', ': ', i > 1))//' '//few_digits(leading(1, i), 4)
            if (leading(2, i) > 0.0_dp) words = words//' (period '// &
               trim(few_digits(leading(2, i), 4)//' '//unit)//')'
         end do
         if (unit /= '') words = ' in 1/'//unit//words
         words = trim(merge('growth rates of the leading modes', &
            'growth rate of the leading mode  ', size(leading, 2) > 1))//words// &
            mark_of(no_finer_value)
      end associate
   end function leading_words

   !> A quantity of the bodies, of the elements, of the pre-tension sections, of reference nodes or
   !> of leading motions.
   pure function part_values(quantity, record) result(values)
      type(quantity_type), intent(in) :: quantity          !! one of those kinds
      type(increment_record_type), intent(in) :: record
      real(dp), allocatable :: values(:)                   !! one each, or none
      type(error_record_type) :: error
      integer :: i, n

      if (quantity%name == 'stress_error') error = record%stress_error
      if (quantity%name == 'heat_flux_error') error = record%heat_flux_error
      allocate (values(0))
      if (allocated(record%inelastic_strain)) then
         if (quantity%name == 'largest_plastic_strain') values = record%inelastic_strain(1, :)
         if (quantity%name == 'largest_creep_strain') values = record%inelastic_strain(2, :)
      end if
      if (quantity%kind == of_bodies .and. allocated(error%body)) values = error%body
      if (quantity%kind == of_elements .and. allocated(error%element)) values = error%element
      if (quantity%kind == of_sections .and. allocated(record%pre_tension)) values = &
         record%pre_tension
      if (quantity%kind == of_references .and. allocated(record%along_z)) values = &
         record%along_z(findloc(['U3 ', 'UR1', 'UR2', 'RF3', 'RM1', 'RM2'], quantity%name(:3), &
         dim=1), :)
      if (quantity%kind /= of_motions) return
      values = spread(ieee_value(1.0_dp, ieee_quiet_nan), 1, quantity%values)
      if (.not. allocated(record%stability)) return
      if (allocated(record%stability%leading)) then
         i = merge(1, 2, quantity%name == 'growth_rates')
         associate (found => record%stability%leading)
            n = min(size(values), size(found, 2))
            values(:n) = found(i, :n)
         end associate
      end if
   end function part_values

   !> A quantity of a pass.
   elemental function pass_value(name, pass) result(value)
      character(*), intent(in) :: name                     !! one of of_passes
      type(iteration_record_type), intent(in) :: pass
      real(dp) :: value                                    !! NaN for a name that is not known

      select case (name)
      case ('increment')
         value = pass%increment
      case ('iteration')
         value = pass%iteration
      case ('residual')
         value = pass%residual
      case ('g_min')
         value = pass%g_min
      case ('g_max')
         value = pass%g_max
      case ('g_kept')
         value = pass%g_kept
      case ('pairs_changed')
         value = pass%pairs_changed
      case ('cut_backs')
         value = pass%cut_backs
      case default
         value = ieee_value(value, ieee_quiet_nan)
      end select
   end function pass_value

end module increment_quantities
