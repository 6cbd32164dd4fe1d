!> Uncertainties of pre-tensions, and of the numbers that tables print, node by node and contact
!> point by contact point, from a finer run. At one place a change may vanish by chance, so that
!> those round it count with it: the mean squares over the nodes of each element there, or over
!> three contact points in a row. Forces and heat of single nodes change with the mesh; their sums
!> do not.
module table_uncertainties
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use contact_points, only: contact_points_type
   use divided_mesh, only: divided_mesh_type
   use due_output, only: table_is_due
   use element_kinds, only: element_node_count
   use kinds, only: dp
   use mesh, only: mesh_type
   use model, only: model_type
   use quantity_types, only: find_quantity, quantity_type
   use records, only: contact_record_type, field_record_type, increment_record_type
   use reported_quantities, only: verifiable
   use simulation, only: simulation_type
   use uncertainty_rule, only: uncertainty_parts
   implicit none
   private
   public :: find_table_uncertainties

contains

   !> Gives an increment the uncertainties of what the tables of its step print.
   subroutine find_table_uncertainties(divided, simulation, model, iteration, record)
      type(divided_mesh_type), intent(in) :: divided           !! solved to the end of the increment
      type(simulation_type), intent(in) :: simulation          !! the run at that end
      type(model_type), intent(in) :: model                    !! of the run
      real(dp), intent(in) :: iteration                        !! what it left, relative
      type(increment_record_type), intent(inout) :: record
      type(contact_points_type), allocatable :: finer(:), points(:)
      real(dp) :: before(3), change(3)
      integer :: i

      if (allocated(record%pre_tension)) record%pre_tension_uncertainties = total('pre_tension', &
         divided%record%pre_tension - record%pre_tension, record%pre_tension, iteration)
      associate (step => model%steps(record%step), mesh => model%mesh, fine => divided%model%mesh)
         if (allocated(step%node_prints)) then
            record%field_uncertainties = fields_of(divided, simulation, mesh, iteration, &
               record%fields)
            allocate (record%total_uncertainties(3, size(step%node_prints)))
            do i = 1, size(step%node_prints)
               before = sums_of(record%fields, step%node_prints(i)%members(mesh%node_sets, &
                  size(mesh%node_body)))
               change = sums_of(divided%record%fields, step%node_prints(i)%members( &
                  fine%node_sets, size(fine%node_body))) - before
               record%total_uncertainties(:, i) = [total('RF1', change(:2), before(:2), &
                  iteration), total('RFL', change(3:), before(3:), iteration)]
            end do
         end if
         if (.not. table_is_due(step%contact_print_frequency, step%contact_print_points, record, &
            model)) return
      end associate
      call simulation%bodies%views(points)
      call divided%run%bodies%views(finer)
      allocate (record%contact_uncertainties(size(points)))
      do i = 1, size(points)
         record%contact_uncertainties(i) = points_of(points(i), record%contacts(i), finer(i), &
            divided%record%contacts(i), iteration)
      end do
   end subroutine find_table_uncertainties

   !> Those of displacements and temperatures; 0 of what is prescribed.
   function fields_of(divided, simulation, mesh, iteration, fields) result(own)
      type(divided_mesh_type), intent(in) :: divided
      type(simulation_type), intent(in) :: simulation
      type(mesh_type), intent(in) :: mesh
      real(dp), intent(in) :: iteration
      type(field_record_type), intent(in) :: fields
      type(field_record_type) :: own
      integer :: c, n

      n = size(mesh%node_number)
      associate (finer => divided%record%fields, loads => simulation%loads)
         if (allocated(fields%temperature)) own%temperature = merge(0.0_dp, total('NT', &
            around_nodes(mesh, finer%temperature(:n) - fields%temperature), &
            fields%temperature, iteration), loads%temperature%active(:n))
         if (.not. allocated(fields%displacement)) return
         allocate (own%displacement(2, n))
         do c = 1, 2
            own%displacement(c, :) = merge(0.0_dp, total('U1', around_nodes(mesh, &
               finer%displacement(c, :n) - fields%displacement(c, :)), fields%displacement(c, :), &
               iteration), loads%displacement%active(c:2*n:2))
         end do
      end associate
   end function fields_of

   !> Sums of external forces and heat over a set; NaN where the step does not have these.
   pure function sums_of(fields, nodes) result(sums)
      type(field_record_type), intent(in) :: fields
      integer, intent(in) :: nodes(:)
      real(dp) :: sums(3)

      sums = ieee_value(1.0_dp, ieee_quiet_nan)
      if (allocated(fields%external_force)) sums(:2) = sum(fields%external_force(:, nodes), dim=2)
      if (allocated(fields%external_heat)) sums(3) = sum(fields%external_heat(nodes))
   end function sums_of

   !> Those of the columns of contact points; NaN at points that the finer mesh does not have.
   function points_of(points, contact, finer, after, iteration) result(own)
      type(contact_points_type), intent(in) :: points, finer
      type(contact_record_type), intent(in) :: contact, after
      real(dp), intent(in) :: iteration
      type(contact_record_type) :: own
      integer :: place(size(points%slave)), k

      place = [(findloc(finer%slave, points%slave(k), dim=1), k=1, size(place))]
      own%contact_state = contact%contact_state
      own%gap = column('gap', contact%gap, after%gap)
      own%pressure = column('pressure', contact%pressure, after%pressure)
      own%shear = column('shear', contact%shear, after%shear)
      own%slip = column('slip', contact%slip, after%slip)
      if (.not. allocated(contact%conductance)) return
      own%conductance = column('conductance', contact%conductance, after%conductance)
      own%heat_flux = column('heat_flux', contact%heat_flux, after%heat_flux)
      own%slave_temperature = column('slave_temperature', contact%slave_temperature, &
         after%slave_temperature)
      own%master_temperature = column('master_temperature', contact%master_temperature, &
         after%master_temperature)

   contains

      function column(name, before, fine) result(uncertainty)
         character(*), intent(in) :: name
         real(dp), intent(in) :: before(:), fine(:)
         real(dp) :: uncertainty(size(before)), change(size(before))
         integer :: first, last

         change = ieee_value(1.0_dp, ieee_quiet_nan)
         where (place > 0) change = (fine(max(place, 1)) - before)**2
         do k = 1, size(change)
            first = max(1, k - 1)
            last = min(size(change), k + 1)
            uncertainty(k) = sqrt(max(change(k), sum(change(first:last))/(last - first + 1)))
         end do
         uncertainty = total(name, uncertainty, before, iteration)
      end function column

   end function points_of

   !> At each node the largest root mean square of a change over the nodes of an element there, or
   !> the change itself.
   pure function around_nodes(mesh, change) result(largest)
      type(mesh_type), intent(in) :: mesh
      real(dp), intent(in) :: change(:)                        ! (nodes)
      real(dp) :: largest(size(change))
      integer :: e, n

      largest = abs(change)
      do e = 1, size(mesh%element_kind)
         n = element_node_count(mesh%element_kind(e))
         associate (nodes => mesh%element_nodes(:n, e))
            largest(nodes) = max(largest(nodes), sqrt(sum(change(nodes)**2)/n))
         end associate
      end do
   end function around_nodes

   !> Uncertainties of numbers by the one rule.
   pure function total(name, change, value, iteration)
      character(*), intent(in) :: name                         ! of their quantity
      real(dp), intent(in) :: change(:), value(:), iteration
      real(dp) :: total(size(change))
      type(quantity_type) :: quantity
      integer :: k

      quantity = verifiable(find_quantity(verifiable, name))
      do k = 1, size(change)
         total(k) = sum(uncertainty_parts(quantity, change(k), 0.0_dp, 0.0_dp, iteration*value(k)))
      end do
   end function total

end module table_uncertainties
