!> Reported quantities of the fields: over nodes by the names of *VERIFY, over points and elements
!> by those of the result file.
module field_quantities
   use kinds, only: dp
   use quantity_types, only: needs_creep, needs_heat, needs_laws, needs_mechanics, &
      needs_melting, needs_plasticity, needs_stability, needs_temperature, of_bodies, of_elements, &
      of_nodes, of_points, quantity_type
   use records, only: field_record_type
   implicit none
   private
   public :: field_table, maxima, point_values, von_mises

   type(quantity_type), parameter :: field_table(*) = [ &
      quantity_type('U1', of_nodes, 'length', needs_mechanics, order=0.5_dp), &
      quantity_type('U2', of_nodes, 'length', needs_mechanics, order=0.5_dp), &
      quantity_type('NT', of_nodes, 'temperature', needs_temperature), &
      quantity_type('SOLID', of_nodes, '-', needs_melting), &
      quantity_type('S11', of_nodes, 'stress', needs_mechanics), &
      quantity_type('S22', of_nodes, 'stress', needs_mechanics), &
      quantity_type('S33', of_nodes, 'stress', needs_mechanics), &
      quantity_type('S12', of_nodes, 'stress', needs_mechanics), &
      quantity_type('MISES', of_nodes, 'stress', needs_mechanics), &
      quantity_type('PEEQ', of_nodes, '-', needs_plasticity), &
      quantity_type('PE11', of_nodes, '-', needs_plasticity), &
      quantity_type('PE22', of_nodes, '-', needs_plasticity), &
      quantity_type('PE33', of_nodes, '-', needs_plasticity), &
      quantity_type('PE12', of_nodes, '-', needs_plasticity), &
      quantity_type('CEEQ', of_nodes, '-', needs_creep), &
      quantity_type('CE11', of_nodes, '-', needs_creep), &
      quantity_type('CE22', of_nodes, '-', needs_creep), &
      quantity_type('CE33', of_nodes, '-', needs_creep), &
      quantity_type('CE12', of_nodes, '-', needs_creep), &
      quantity_type('HFL1', of_nodes, 'power/length^2', needs_heat), &
      quantity_type('HFL2', of_nodes, 'power/length^2', needs_heat), &
      quantity_type('RF1', of_nodes, 'stress length^2', needs_mechanics), &
      quantity_type('RF2', of_nodes, 'stress length^2', needs_mechanics), &
      quantity_type('RFL', of_nodes, 'power', needs_heat), &
      quantity_type('displacement', of_points, 'length', needs_mechanics, values=3, &
      description='displacement', components='x y z'), &
      quantity_type('stress', of_points, 'stress', needs_mechanics, values=4, &
      description='stress, averaged per body and section', components='xx yy zz xy'), &
      quantity_type('von_mises', of_points, 'stress', needs_mechanics, &
      description='equivalent stress of von Mises'), &
      quantity_type('principal_stress', of_points, 'stress', needs_mechanics, values=3, &
      description='principal stresses, the largest first', components='1 2 3'), &
      quantity_type('radial_stress', of_points, 'stress', needs_mechanics, &
      description='stress along the radius: from the axis, in plane models from the origin'), &
      quantity_type('hoop_stress', of_points, 'stress', needs_mechanics, &
      description='stress around the axis, in plane models around the origin'), &
      quantity_type('plastic_strain', of_points, '-', needs_plasticity, values=4, &
      description='plastic strain, xy the angle', components='xx yy zz xy'), &
      quantity_type('equivalent_plastic_strain', of_points, '-', needs_plasticity, &
      description='equivalent plastic strain so far'), &
      quantity_type('creep_strain', of_points, '-', needs_creep, values=4, &
      description='creep strain, xy the angle', components='xx yy zz xy'), &
      quantity_type('equivalent_creep_strain', of_points, '-', needs_creep, &
      description='equivalent creep strain so far'), &
      quantity_type('temperature', of_points, 'temperature', needs_temperature, head='temp.', &
      is_traded=.true., description='temperature'), &
      quantity_type('solid_fraction', of_points, '-', needs_melting, &
      description='part of the latent heat that is given off, 1 where nothing melts'), &
      quantity_type('heat_flux', of_points, 'power/length^2', needs_heat, values=3, &
      description='heat flux, averaged per body and section', components='x y z'), &
      quantity_type('mode_temperature', of_points, '-', needs_stability, &
      description='temperature of the leading mode, the largest 1'), &
      quantity_type('mode_displacement', of_points, 'length/temperature', needs_stability, &
      values=3, description='displacement of the leading mode', components='x y z'), &
      quantity_type('stress_error', of_elements, 'stress', needs_mechanics, &
      description='estimated error of the stress by the mesh, rms in the element'), &
      quantity_type('heat_flux_error', of_elements, 'power/length^2', needs_heat, &
      description='estimated error of the heat flux by the mesh, rms in the element')]

   !> The maxima of a body; those of body_uncertainty_type are in this order.
   type(quantity_type), parameter :: maxima(*) = [ &
      quantity_type('von_mises', of_bodies, 'stress', needs_mechanics, label='von Mises stress', &
      head='MISES', order=0.9_dp, &
      description='largest equivalent stress of von Mises away from singular corners'), &
      quantity_type('temperature', of_bodies, 'temperature', needs_heat, label='temperature', &
      head='NT', order=0.9_dp, description='largest temperature'), &
      quantity_type('equivalent_plastic_strain', of_bodies, '-', needs_laws, &
      label='plastic strain', head='PEEQ', order=0.9_dp, &
      description='largest equivalent plastic strain away from singular corners'), &
      quantity_type('equivalent_creep_strain', of_bodies, '-', needs_laws, label='creep strain', &
      head='CEEQ', order=0.9_dp, &
      description='largest equivalent creep strain away from singular corners')]

contains

   !> A quantity at every point.
   pure function point_values(name, fields, point_node, radial) result(values)
      character(*), intent(in) :: name                !! one of of_nodes or of_points
      type(field_record_type), intent(in) :: fields
      integer, intent(in) :: point_node(:)            !! (points) node index of each point
      !> (2, points) unit vectors away from the origin in plane models; absent: axisymmetric
      real(dp), intent(in), optional :: radial(:, :)
      !> (values of each, points) in one row; empty where the step has none, and for a name that is
      !> not known.
      real(dp), allocatable :: values(:)

      allocate (values(0))
      select case (name)
      case ('U1', 'U2')
         values = rows(fields%displacement, [index('12', name(2:2))], point_node)
      case ('displacement')
         values = rows(fields%displacement, [1, 2, 0], point_node)
      case ('mode_displacement')
         values = rows(fields%mode_displacement, [1, 2, 0], point_node)
      case ('mode_temperature')
         if (allocated(fields%mode_temperature)) values = fields%mode_temperature(point_node)
      case ('NT', 'temperature')
         if (allocated(fields%temperature)) values = fields%temperature(point_node)
      case ('SOLID', 'solid_fraction')
         if (allocated(fields%solid_fraction)) values = fields%solid_fraction(point_node)
      case ('S11', 'S22', 'S33', 'S12')
         values = rows(fields%stress, [place_in_tensor(name(2:3))])
      case ('stress')
         values = rows(fields%stress, [1, 2, 3, 4])
      case ('MISES', 'von_mises')
         if (allocated(fields%stress)) values = von_mises(fields%stress)
      case ('principal_stress')
         if (allocated(fields%stress)) values = principal(fields%stress)
      case ('radial_stress')
         values = rows(fields%stress, [1])
         if (present(radial) .and. allocated(fields%stress)) values = along(fields%stress, radial)
      case ('hoop_stress')
         values = rows(fields%stress, [3])
         if (present(radial) .and. allocated(fields%stress)) values = fields%stress(1, :) + &
            fields%stress(2, :) - along(fields%stress, radial)
      case ('PE11', 'PE22', 'PE33', 'PE12')
         values = rows(fields%inelastic_strain, [place_in_tensor(name(3:4))])
      case ('PEEQ', 'equivalent_plastic_strain')
         values = rows(fields%inelastic_strain, [5])
      case ('plastic_strain')
         values = rows(fields%inelastic_strain, [1, 2, 3, 4])
      case ('CE11', 'CE22', 'CE33', 'CE12')
         values = rows(fields%inelastic_strain, [5 + place_in_tensor(name(3:4))])
      case ('CEEQ', 'equivalent_creep_strain')
         values = rows(fields%inelastic_strain, [10])
      case ('creep_strain')
         values = rows(fields%inelastic_strain, [6, 7, 8, 9])
      case ('HFL1', 'HFL2')
         values = rows(fields%heat_flux, [index('12', name(4:4))])
      case ('heat_flux')
         values = rows(fields%heat_flux, [1, 2, 0])
      case ('RF1', 'RF2')
         values = rows(fields%reaction, [index('12', name(3:3))], point_node)
      case ('RFL')
         if (allocated(fields%reaction_heat)) values = fields%reaction_heat(point_node)
      case default   ! not known: none
      end select
   end function point_values

   !> Row of a component such as 12.
   pure integer function place_in_tensor(component)
      character(2), intent(in) :: component

      place_in_tensor = findloc(['11', '22', '33', '12'], component, dim=1)
   end function place_in_tensor

   !> Rows of a field one beside the other, row 0 being zeros; of some indexes, or of all.
   pure function rows(field, components, indexes) result(values)
      real(dp), allocatable, intent(in) :: field(:, :)
      integer, intent(in) :: components(:)
      integer, optional, intent(in) :: indexes(:)
      real(dp), allocatable :: values(:)
      integer :: i, n

      n = 0
      if (allocated(field)) n = size(field, 2)
      if (n > 0 .and. present(indexes)) n = size(indexes)
      allocate (values(size(components)*n))
      if (n == 0) return
      n = size(components)
      do i = 1, n
         if (components(i) == 0) then
            values(i::n) = 0.0_dp
         else if (present(indexes)) then
            values(i::n) = field(components(i), indexes)
         else
            values(i::n) = field(components(i), :)
         end if
      end do
   end function rows

   !> Principal stresses of every point in one row, the largest of each first.
   pure function principal(stress) result(values)
      real(dp), intent(in) :: stress(:, :)            !! (4, points) xx, yy, zz, xy [stress]
      real(dp) :: values(3*size(stress, 2))
      real(dp) :: centre, radius
      integer :: i

      do i = 1, size(stress, 2)
         associate (s => stress(:, i), p => values(3*i - 2:3*i))
            centre = 0.5_dp*s(1) + 0.5_dp*s(2)
            radius = hypot(0.5_dp*s(1) - 0.5_dp*s(2), s(4))
            p = [centre + radius, centre - radius, s(3)]
            p = [max(p(1), p(3)), min(max(p(2), p(3)), p(1)), min(p(2), p(3))]
         end associate
      end do
   end function principal

   !> Normal stress along a direction of the plane at every point.
   pure function along(stress, direction) result(values)
      real(dp), intent(in) :: stress(:, :)            !! (4, points) xx, yy, zz, xy [stress]
      real(dp), intent(in) :: direction(:, :)         !! (2, points) unit vectors
      real(dp) :: values(size(stress, 2))

      associate (c => direction(1, :), s => direction(2, :))
         values = stress(1, :)*c**2 + stress(2, :)*s**2 + 2.0_dp*stress(4, :)*c*s
      end associate
   end function along

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

end module field_quantities
