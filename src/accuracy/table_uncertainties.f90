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
   use field_quantities, only: field_table
   use kinds, only: dp
   use mesh, only: mesh_type
   use model, only: model_type
   use quantity_types, only: find_quantity, of_nodes, quantity_type
   use records, only: contact_record_type, field_record_type, increment_record_type
   use simulation, only: simulation_type
   use uncertainty_rule, only: uncertainty_parts
   implicit none
   private
   public :: find_table_uncertainties

   !> What all numbers of tables but displacements are to the rule: neither maxima nor edges.
   type(quantity_type), parameter :: number = quantity_type('number', of_nodes, '')

contains

   !> Gives an increment the uncertainties of what the tables of its step print.
   subroutine find_table_uncertainties(divided, simulation, model, iteration, record)
      type(divided_mesh_type), intent(in) :: divided           !! solved to the end of the increment
      type(simulation_type), intent(in) :: simulation          !! the run at that end
      type(model_type), intent(in) :: model                    !! of the run
      real(dp), intent(in) :: iteration                        !! what it left, relative
      type(increment_record_type), intent(inout) :: record
      type(contact_points_type), allocatable :: finer(:), points(:)
      real(dp) :: after(3), before(3)
      integer :: i

      if (allocated(record%pre_tension)) record%pre_tension_uncertainties = total(number, &
         divided%record%pre_tension - record%pre_tension, record%pre_tension, iteration)
      associate (step => model%steps(record%step), mesh => model%mesh, fine => divided%model%mesh)
         if (allocated(step%node_prints)) then
            call compare_fields(record%fields, divided%record%fields)
            allocate (record%total_uncertainties(3, size(step%node_prints)))
            do i = 1, size(step%node_prints)
               before = sums_of(record%fields, step%node_prints(i)%members(mesh%node_sets, &
                  size(mesh%node_body)))
               after = sums_of(divided%record%fields, step%node_prints(i)%members( &
                  fine%node_sets, size(fine%node_body)))
               record%total_uncertainties(:, i) = total(number, after - before, before, iteration)
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

   contains

      !> Those of temperatures and displacements; 0 of what is prescribed.
      subroutine compare_fields(before, after)
         type(field_record_type), intent(in) :: before, after
         integer :: c

         allocate (record%field_uncertainties)
         associate (own => record%field_uncertainties, loads => simulation%loads)
            if (allocated(before%temperature)) own%temperature = of_field(number, model%mesh, &
               before%temperature, after%temperature, loads%temperature%active, iteration)
            if (.not. allocated(before%displacement)) return
            allocate (own%displacement, mold=before%displacement)
            do c = 1, 2
               own%displacement(c, :) = of_field(field_table(find_quantity(field_table, 'U1')), &
                  model%mesh, before%displacement(c, :), after%displacement(c, :), &
                  loads%displacement%active(c::2), iteration)
            end do
         end associate
      end subroutine compare_fields

   end subroutine find_table_uncertainties

   !> Those of a field: of the largest root mean square of its change over the nodes of an element
   !> at each node, or of the change itself there.
   pure function of_field(quantity, mesh, before, after, is_prescribed, iteration) result(own)
      type(quantity_type), intent(in) :: quantity
      type(mesh_type), intent(in) :: mesh
      real(dp), intent(in) :: before(:), after(:)  ! (nodes), (nodes of the finer mesh, these first)
      logical, intent(in) :: is_prescribed(:)      ! (nodes)
      real(dp), intent(in) :: iteration
      real(dp), dimension(size(before)) :: change, largest, own
      integer :: e

      change = after(:size(before)) - before
      largest = abs(change)
      do e = 1, size(mesh%element_kind)
         associate (nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(e)), e))
            largest(nodes) = max(largest(nodes), sqrt(sum(change(nodes)**2)/size(nodes)))
         end associate
      end do
      own = merge(0.0_dp, total(quantity, largest, before, iteration), &
         is_prescribed(:size(own)))
   end function of_field

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
   pure function points_of(points, contact, finer, after, iteration) result(own)
      type(contact_points_type), intent(in) :: points, finer
      type(contact_record_type), intent(in) :: contact, after
      real(dp), intent(in) :: iteration
      type(contact_record_type) :: own
      integer :: k, place(size(points%slave))

      place = [(findloc(finer%slave, points%slave(k), dim=1), k=1, size(place))]
      own%contact_state = contact%contact_state
      call compare(contact%gap, after%gap, own%gap)
      call compare(contact%pressure, after%pressure, own%pressure)
      call compare(contact%shear, after%shear, own%shear)
      call compare(contact%slip, after%slip, own%slip)
      call compare(contact%conductance, after%conductance, own%conductance)
      call compare(contact%heat_flux, after%heat_flux, own%heat_flux)
      call compare(contact%slave_temperature, after%slave_temperature, own%slave_temperature)
      call compare(contact%master_temperature, after%master_temperature, own%master_temperature)

   contains

      pure subroutine compare(before, fine, uncertainty)
         real(dp), allocatable, intent(in) :: before(:), fine(:)
         real(dp), allocatable, intent(out) :: uncertainty(:)
         real(dp) :: change(size(place))          ! squared
         integer :: first, k, last

         if (.not. allocated(before)) return
         change = ieee_value(1.0_dp, ieee_quiet_nan)
         where (place > 0) change = (fine(max(place, 1)) - before)**2
         allocate (uncertainty(size(place)))
         do k = 1, size(place)
            first = max(1, k - 1)
            last = min(size(place), k + 1)
            uncertainty(k) = sqrt(max(change(k), sum(change(first:last))/(last - first + 1)))
         end do
         uncertainty = total(number, uncertainty, before, iteration)
      end subroutine compare

   end function points_of

   !> The uncertainty of a number by the one rule.
   elemental real(dp) function total(quantity, change, value, iteration)
      type(quantity_type), intent(in) :: quantity
      real(dp), intent(in) :: change, value, iteration

      total = sum(uncertainty_parts(quantity, change, 0.0_dp, 0.0_dp, iteration*value))
   end function total

end module table_uncertainties
