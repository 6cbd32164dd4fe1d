!> The quantities of a record by the names that the result file and *VERIFY know them by.
module record_values
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use contact_pairs, only: contact_pairs_type
   use kinds, only: dp
   use records, only: contact_record_type, field_record_type, increment_record_type
   implicit none
   private
   public :: name_length, history_names, history_body_names, contact_pair_names, contact_heat_names
   public :: contact_total_names, contact_edge_names
   public :: history_value, history_body_values, contact_values, point_values, not_a_number

   integer, parameter :: name_length = 24   !! length of the names below

   !> Datasets of `/history`, one number an increment.
   character(name_length), parameter :: history_names(10) = [character(name_length) :: &
      'time', 'load', 'iterations', 'heat_in', 'heat_out', 'heat_imbalance', &
      'heat_imbalance_pointwise', 'force_imbalance', 'coupling_gain', 'coupling_gain_max']

   !> Datasets of `/history`, one number a body and increment: with mechanics, with heat.
   character(name_length), parameter :: history_body_names(2) = [character(name_length) :: &
      'stress_error', 'heat_flux_error']

   !> Datasets of `/contact/<name>`, one number a pair and increment.
   character(name_length), parameter :: contact_pair_names(5) = [character(name_length) :: &
      'gap', 'pressure', 'shear', 'slip', 'status']

   !> The same, where the deck has heat.
   character(name_length), parameter :: contact_heat_names(4) = [character(name_length) :: &
      'conductance', 'heat_flux', 'slave_temperature', 'master_temperature']

   !> Datasets of `/contact/<name>`, one number an increment; the last one where the deck has heat.
   character(name_length), parameter :: contact_total_names(5) = [character(name_length) :: &
      'normal_force', 'shear_force', 'edge_contact', 'edge_stick', 'heat_rate']

   !> Datasets of `/contact/<name>`, four numbers an increment.
   character(name_length), parameter :: contact_edge_names(2) = [character(name_length) :: &
      'edges_contact', 'edges_stick']

contains

   !> A quiet NaN, the mark of what a step neither solves nor keeps.
   function not_a_number() result(value)
      real(dp) :: value   !! NaN

      value = ieee_value(value, ieee_quiet_nan)
   end function not_a_number

   !> A number of `/history`.
   function history_value(name, record) result(value)
      character(*), intent(in) :: name                     !! one of history_names
      type(increment_record_type), intent(in) :: record    !! the increment
      real(dp) :: value                                    !! NaN for a name that is not known

      select case (name)
      case ('time')
         value = record%time
      case ('load')
         value = record%load
      case ('iterations')
         value = 0.0_dp
         if (allocated(record%iterations)) value = size(record%iterations)
      case ('heat_in')
         value = record%heat_in
      case ('heat_out')
         value = record%heat_out
      case ('heat_imbalance')
         value = record%heat_imbalance
      case ('heat_imbalance_pointwise')
         value = record%heat_imbalance_pointwise
      case ('force_imbalance')
         value = record%force_imbalance
      case ('coupling_gain')
         value = record%coupling_gain
      case ('coupling_gain_max')
         value = record%coupling_gain_max
      case default
         value = not_a_number()
      end select
   end function history_value

   !> The numbers of `/history`, one a body.
   function history_body_values(name, record, bodies) result(values)
      character(*), intent(in) :: name                     !! one of history_body_names
      type(increment_record_type), intent(in) :: record    !! the increment
      integer, intent(in) :: bodies                        !! number of bodies
      real(dp), allocatable :: values(:)                   !! (bodies) NaN where there are none

      if (name == history_body_names(1)) then
         if (allocated(record%stress_error%body)) values = record%stress_error%body
      else
         if (allocated(record%heat_flux_error%body)) values = record%heat_flux_error%body
      end if
      if (.not. allocated(values)) allocate(values(bodies), source=not_a_number())
   end function history_body_values

   !> The numbers of a dataset of `/contact/<name>` in one increment: over the pairs, the edges, or
   !> one alone; the undeformed geometry too. Empty for a name that is not known.
   function contact_values(name, pairs, contact) result(values)
      character(*), intent(in) :: name                     !! name of the dataset
      type(contact_pairs_type), intent(in) :: pairs        !! pairs of the interface
      type(contact_record_type), intent(in) :: contact     !! its state
      real(dp), allocatable :: values(:)                   !! NaN where the step has none

      select case (name)
      case ('gap')
         values = or_nan(contact%gap)
      case ('pressure')
         values = or_nan(contact%pressure)
      case ('shear')
         values = or_nan(contact%shear)
      case ('slip')
         values = or_nan(contact%slip)
      case ('status')
         values = real(contact%status, dp)
      case ('conductance')
         values = or_nan(contact%conductance)
      case ('heat_flux')
         values = or_nan(contact%heat_flux)
      case ('slave_temperature')
         values = or_nan(contact%slave_temperature)
      case ('master_temperature')
         values = or_nan(contact%master_temperature)
      case ('normal_force')
         values = [contact%normal_force]
      case ('shear_force')
         values = [contact%shear_force]
      case ('heat_rate')
         values = [contact%heat_rate]
      case ('edge_contact')
         values = [contact%edge_contact]
      case ('edge_stick')
         values = [contact%edge_stick]
      case ('edges_contact')
         values = contact%edges_contact
      case ('edges_stick')
         values = contact%edges_stick
      case ('x')
         values = pairs%position(1, :)
      case ('y')
         values = pairs%position(2, :)
      case ('s')
         values = pairs%arc_length
      case ('weight')
         values = pairs%weight
      case default
         allocate(values(0))
      end select

   contains

      function or_nan(given) result(filled)
         real(dp), allocatable, intent(in) :: given(:)
         real(dp), allocatable :: filled(:)

         if (allocated(given)) then
            filled = given
         else
            allocate(filled(size(pairs%slave_node)), source=not_a_number())
         end if
      end function or_nan

   end function contact_values

   !> A nodal quantity at every point, by its name in *VERIFY. Empty for a name that is not known
   !> or a quantity that the step has not.
   pure function point_values(name, fields, point_node) result(values)
      character(*), intent(in) :: name                !! U1 U2 NT S11 MISES HFL1 RF1 ...
      type(field_record_type), intent(in) :: fields   !! the fields
      integer, intent(in) :: point_node(:)            !! (points) node index of each point
      real(dp), allocatable :: values(:)              !! (points)

      integer :: all_points(size(point_node)), i

      all_points = [(i, i=1, size(point_node))]
      select case (name)
      case ('U1')
         values = row(fields%displacement, 1, point_node)
      case ('U2')
         values = row(fields%displacement, 2, point_node)
      case ('NT')
         allocate(values(0))
         if (allocated(fields%temperature)) values = fields%temperature(point_node)
      case ('S11')
         values = row(fields%stress, 1, all_points)
      case ('S22')
         values = row(fields%stress, 2, all_points)
      case ('S33')
         values = row(fields%stress, 3, all_points)
      case ('S12')
         values = row(fields%stress, 4, all_points)
      case ('MISES')
         allocate(values(0))
         if (allocated(fields%stress)) values = von_mises(fields%stress)
      case ('HFL1')
         values = row(fields%heat_flux, 1, all_points)
      case ('HFL2')
         values = row(fields%heat_flux, 2, all_points)
      case ('RF1')
         values = row(fields%reaction, 1, point_node)
      case ('RF2')
         values = row(fields%reaction, 2, point_node)
      case ('RFL')
         allocate(values(0))
         if (allocated(fields%reaction_heat)) values = fields%reaction_heat(point_node)
      case default
         allocate(values(0))
      end select
   end function point_values

   pure function row(field, component, places) result(values)
      real(dp), allocatable, intent(in) :: field(:, :)
      integer, intent(in) :: component
      integer, intent(in) :: places(:)
      real(dp), allocatable :: values(:)

      if (allocated(field)) then
         values = field(component, places)
      else
         allocate(values(0))
      end if
   end function row

   !> Von Mises' equivalent stress; scaled, so that no square of a stress overflows.
   pure function von_mises(stress) result(equivalent)
      real(dp), intent(in) :: stress(:, :)            !! (4, points) xx, yy, zz, xy [stress]
      real(dp) :: equivalent(size(stress, 2))         !! (points) [stress]

      real(dp) :: s(4), scale
      integer :: i

      do i = 1, size(stress, 2)
         scale = maxval(abs(stress(:, i)))
         s = stress(:, i)/max(scale, tiny(scale))
         equivalent(i) = scale*sqrt(0.5_dp*((s(1) - s(2))**2 + (s(2) - s(3))**2 + &
            (s(3) - s(1))**2) + 3.0_dp*s(4)**2)
      end do
   end function von_mises

end module record_values
