!> The quantities that *VERIFY may name.
module verify_quantities
   use card_values, only: field_place, need_field
   use cards, only: data_card_type
   use deck_report, only: deck_report_type
   use text, only: nearest_known, string_type, to_upper
   implicit none
   private
   public :: quantities, find_quantity, read_quantity, of_history, of_interface, of_pairs, of_nodes

   integer, parameter :: of_history = 1     !! one number an increment
   integer, parameter :: of_interface = 2   !! one number an increment and interface
   integer, parameter :: of_pairs = 3       !! a profile over the pairs of an interface
   integer, parameter :: of_nodes = 4       !! a field over the nodes

   !> A quantity that *VERIFY may name.
   type :: quantity_type
      character(24) :: name        !! dataset, or nodal quantity
      integer :: kind              !! one of the constants above
      logical :: is_heat = .false. !! whether only a step that solves heat gives it
   end type quantity_type

   type(quantity_type), parameter :: quantities(45) = [ &
      quantity_type('time', of_history), quantity_type('load', of_history), &
      quantity_type('iterations', of_history), quantity_type('heat_in', of_history, .true.), &
      quantity_type('heat_out', of_history, .true.), &
      quantity_type('heat_imbalance', of_history, .true.), &
      quantity_type('heat_imbalance_pointwise', of_history, .true.), &
      quantity_type('force_imbalance', of_history), &
      quantity_type('coupling_gain', of_history, .true.), &
      quantity_type('coupling_gain_max', of_history, .true.), &
      quantity_type('normal_force', of_interface), &
      quantity_type('shear_force', of_interface), &
      quantity_type('heat_rate', of_interface, .true.), &
      quantity_type('edge_contact', of_interface), quantity_type('edge_stick', of_interface), &
      quantity_type('edges_contact', of_interface), quantity_type('edges_stick', of_interface), &
      quantity_type('gap', of_pairs), quantity_type('pressure', of_pairs), &
      quantity_type('shear', of_pairs), quantity_type('slip', of_pairs), &
      quantity_type('status', of_pairs), quantity_type('conductance', of_pairs, .true.), &
      quantity_type('heat_flux', of_pairs, .true.), &
      quantity_type('slave_temperature', of_pairs, .true.), &
      quantity_type('master_temperature', of_pairs, .true.), quantity_type('x', of_pairs), &
      quantity_type('y', of_pairs), quantity_type('s', of_pairs), &
      quantity_type('weight', of_pairs), quantity_type('slave_node', of_pairs), &
      quantity_type('master_node', of_pairs), quantity_type('U1', of_nodes), &
      quantity_type('U2', of_nodes), quantity_type('NT', of_nodes), &
      quantity_type('S11', of_nodes), quantity_type('S22', of_nodes), &
      quantity_type('S33', of_nodes), quantity_type('S12', of_nodes), &
      quantity_type('MISES', of_nodes), quantity_type('HFL1', of_nodes, .true.), &
      quantity_type('HFL2', of_nodes, .true.), quantity_type('RF1', of_nodes), &
      quantity_type('RF2', of_nodes), quantity_type('RFL', of_nodes, .true.)]

contains

   !> Index into quantities of a name in any case; 0 for one that is not known.
   pure integer function find_quantity(name)
      character(*), intent(in) :: name   !! the name

      do find_quantity = size(quantities), 1, -1
         if (to_upper(trim(quantities(find_quantity)%name)) == to_upper(name)) return
      end do
   end function find_quantity

   !> Reads the first field of a *VERIFY card.
   subroutine read_quantity(data, report, quantity)
      type(data_card_type), intent(in) :: data           !! data card
      type(deck_report_type), intent(inout) :: report    !! receives errors
      integer, intent(out) :: quantity                   !! index into quantities, 0 after an error
      character(:), allocatable :: name
      type(string_type) :: names(size(quantities))
      logical :: valid
      integer :: i

      valid = .true.
      quantity = 0
      call need_field(data, 1, 'quantity', report, name, valid)
      if (.not. valid) return
      do i = 1, size(quantities)
         names(i)%value = trim(quantities(i)%name)
      end do
      quantity = find_quantity(name)
      if (quantity > 0) return
      call report%error(field_place(data, 1), 'unknown quantity '//name//nearest_known(name, names))
   end subroutine read_quantity

end module verify_quantities
