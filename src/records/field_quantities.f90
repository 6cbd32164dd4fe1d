!> Reported quantities of the fields: over nodes by the names of *VERIFY, over points and elements
!> by those of the result file.
module field_quantities
   use kinds, only: dp
   use quantity_types, only: needs_heat, needs_mechanics, needs_temperature, of_elements, &
      of_nodes, of_points, quantity_type
   use records, only: field_record_type, increment_record_type
   implicit none
   private
   public :: field_table, point_values, element_values

   type(quantity_type), parameter :: field_table(*) = [ &
      quantity_type('U1', of_nodes, 'length', needs_mechanics), &
      quantity_type('U2', of_nodes, 'length', needs_mechanics), &
      quantity_type('NT', of_nodes, 'temperature', needs_temperature), &
      quantity_type('S11', of_nodes, 'stress', needs_mechanics), &
      quantity_type('S22', of_nodes, 'stress', needs_mechanics), &
      quantity_type('S33', of_nodes, 'stress', needs_mechanics), &
      quantity_type('S12', of_nodes, 'stress', needs_mechanics), &
      quantity_type('MISES', of_nodes, 'stress', needs_mechanics), &
      quantity_type('HFL1', of_nodes, 'power/length^2', needs_heat), &
      quantity_type('HFL2', of_nodes, 'power/length^2', needs_heat), &
      quantity_type('RF1', of_nodes, 'stress length^2', needs_mechanics), &
      quantity_type('RF2', of_nodes, 'stress length^2', needs_mechanics), &
      quantity_type('RFL', of_nodes, 'power', needs_heat), &
      quantity_type('displacement', of_points, 'length', needs_mechanics, values=3), &
      quantity_type('stress', of_points, 'stress', needs_mechanics, values=4), &
      quantity_type('von_mises', of_points, 'stress', needs_mechanics), &
      quantity_type('temperature', of_points, 'temperature', needs_temperature, head='temp.', &
      is_traded=.true.), &
      quantity_type('heat_flux', of_points, 'power/length^2', needs_heat, values=3), &
      quantity_type('stress_error', of_elements, 'stress', needs_mechanics), &
      quantity_type('heat_flux_error', of_elements, 'power/length^2', needs_heat)]

contains

   !> A quantity at every point.
   pure function point_values(name, fields, point_node) result(values)
      character(*), intent(in) :: name                !! one of of_nodes or of_points
      type(field_record_type), intent(in) :: fields
      integer, intent(in) :: point_node(:)            !! (points) node index of each point
      !> (values of each, points) in one row; empty where the step has none, and for a name that is
      !> not known.
      real(dp), allocatable :: values(:)

      allocate (values(0))
      select case (name)
      case ('U1')
         values = rows(fields%displacement, [1], point_node)
      case ('U2')
         values = rows(fields%displacement, [2], point_node)
      case ('displacement')
         values = rows(fields%displacement, [1, 2, 0], point_node)
      case ('NT', 'temperature')
         if (allocated(fields%temperature)) values = fields%temperature(point_node)
      case ('S11')
         values = rows(fields%stress, [1])
      case ('S22')
         values = rows(fields%stress, [2])
      case ('S33')
         values = rows(fields%stress, [3])
      case ('S12')
         values = rows(fields%stress, [4])
      case ('stress')
         values = rows(fields%stress, [1, 2, 3, 4])
      case ('MISES', 'von_mises')
         if (allocated(fields%stress)) values = von_mises(fields%stress)
      case ('HFL1')
         values = rows(fields%heat_flux, [1])
      case ('HFL2')
         values = rows(fields%heat_flux, [2])
      case ('heat_flux')
         values = rows(fields%heat_flux, [1, 2, 0])
      case ('RF1')
         values = rows(fields%reaction, [1], point_node)
      case ('RF2')
         values = rows(fields%reaction, [2], point_node)
      case ('RFL')
         if (allocated(fields%reaction_heat)) values = fields%reaction_heat(point_node)
      case default   ! not known: none
      end select
   end function point_values

   !> A quantity of every element.
   pure function element_values(name, record) result(values)
      character(*), intent(in) :: name                     !! one of of_elements
      type(increment_record_type), intent(in) :: record
      real(dp), allocatable :: values(:)                   !! (elements), or none

      allocate (values(0))
      select case (name)
      case ('stress_error')
         if (allocated(record%stress_error%element)) values = record%stress_error%element
      case ('heat_flux_error')
         if (allocated(record%heat_flux_error%element)) values = record%heat_flux_error%element
      case default   ! not known: none
      end select
   end function element_values

   !> Rows of a field one beside the other, row 0 being zeros; of some indexes, or of all.
   pure function rows(field, components, indexes) result(values)
      real(dp), allocatable, intent(in) :: field(:, :)
      integer, intent(in) :: components(:)
      integer, optional, intent(in) :: indexes(:)
      real(dp), allocatable :: values(:)
      integer :: i, n

      if (.not. allocated(field)) then
         allocate (values(0))
         return
      end if
      n = size(components)
      if (present(indexes)) then
         allocate (values(n*size(indexes)))
      else
         allocate (values(n*size(field, 2)))
      end if
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
