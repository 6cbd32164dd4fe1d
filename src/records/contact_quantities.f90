!> Reported quantities of an interface and of its contact points.
module contact_quantities
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use contact_points, only: contact_points_type
   use contact_system, only: contact_open, contact_stick
   use kinds, only: dp
   use quantity_types, only: needs_heat, needs_wear, of_interface, of_contact_points, quantity_type
   use records, only: contact_record_type
   use zone_edges, only: edges_kept
   implicit none
   private
   public :: contact_table, estimated, contact_values, end_words, estimated_values, &
      geometry_values, has_quantity, zone_words

   ! Contact points are in the order of the columns of *CONTACT PRINT.
   type(quantity_type), parameter :: contact_table(*) = [ &
      quantity_type('normal_force', of_interface, 'stress length^2', label='normal force', &
      head='force', is_estimated=.true., is_traded=.true., &
      description='sum of the normal contact forces; compression is positive'), &
      quantity_type('shear_force', of_interface, 'stress length^2', label='shear force', &
      is_estimated=.true., is_of_friction=.true., follows_path=.true., &
      description='sum of the shear forces on the slave towards growing s'), &
      quantity_type('heat_rate', of_interface, 'power', needs_heat, label='heat rate', &
      head='heat', is_estimated=.true., is_traded=.true., &
      description='heat that crosses from slave to master'), &
      quantity_type('worn_volume_slave', of_interface, 'length^3', needs_wear, &
      label='worn volume, slave', &
      description='volume that the slave has lost'), &
      quantity_type('worn_volume_master', of_interface, 'length^3', needs_wear, &
      label='worn volume, master', &
      description='volume that the master has lost'), &
      quantity_type('peak_pressure', of_interface, 'stress', head='peak', is_estimated=.true., &
      is_traded=.true., is_published=.false., follows_path=.true., &
      description='largest contact pressure'), &
      quantity_type('edge_contact', of_interface, 'length', label='edge of contact s =', &
      head='contact', is_estimated=.true., is_traded=.true., order=1.5_dp, resolution=0.08_dp, &
      description='outer edge of the contact zone with the largest s; NaN: none'), &
      quantity_type('edge_stick', of_interface, 'length', label='of stick s =', head='stick', &
      is_estimated=.true., is_traded=.true., order=1.5_dp, resolution=0.6_dp, &
      follows_path=.true., &
      description='outer edge of the widest stick zone; NaN: none'), &
      quantity_type('edges_contact', of_interface, 'length', values=edges_kept, &
      description='s of all edges of contact, ascending, padded with NaN'), &
      quantity_type('edges_stick', of_interface, 'length', values=edges_kept, &
      description='s of all edges of stick, ascending, padded with NaN'), &
      quantity_type('slave_node', of_contact_points, '-', head='slave', width=8, &
      is_integer=.true., is_geometry=.true., description='number of the slave node in the deck'), &
      quantity_type('master_node', of_contact_points, '-', head='master', width=8, &
      is_integer=.true., is_geometry=.true., &
      description='number of the master node that is opposite or nearest'), &
      quantity_type('x', of_contact_points, 'length', head='x', width=11, is_geometry=.true., &
      description='x of the contact point on the undeformed slave'), &
      quantity_type('y', of_contact_points, 'length', head='y', width=11, is_geometry=.true., &
      description='y of the contact point on the undeformed slave'), &
      quantity_type('s', of_contact_points, 'length', is_geometry=.true., &
      description='arc length along the slave from the first contact point'), &
      quantity_type('piece', of_contact_points, '-', is_integer=.true., is_geometry=.true., &
      description='number of the piece of the faces, from 1'), &
      quantity_type('weight', of_contact_points, 'length^2', is_geometry=.true., &
      description='area of the contact point of the undeformed mesh; times pressure it is the '// &
      'normal force, unless faces follow sliding'), &
      quantity_type('status', of_contact_points, '-', head='zone', width=5, is_integer=.true., &
      is_on_faces=.true., &
      description='contact state: 0 open, 1 slip, 2 stick; 1 where closed without friction'), &
      quantity_type('gap', of_contact_points, 'length', head='gap', width=10, is_on_faces=.true., &
      description='gap, >= 0; NaN where no master is opposite'), &
      quantity_type('pressure', of_contact_points, 'stress', head='p', width=10, &
      is_on_faces=.true., description='contact pressure, >= 0 in compression'), &
      quantity_type('shear', of_contact_points, 'stress', head='tau', width=11, &
      is_on_faces=.true., description='shear traction on the slave towards growing s'), &
      quantity_type('slip', of_contact_points, 'length', head='slip', width=11, &
      description='displacement of the slave along s against the master since closing'), &
      quantity_type('wear_slave', of_contact_points, 'length', needs_wear, head='wear1', &
      width=11, is_on_faces=.true., description='depth that the slave has lost'), &
      quantity_type('wear_master', of_contact_points, 'length', needs_wear, head='wear2', &
      width=11, is_on_faces=.true., description='depth that the master has lost'), &
      quantity_type('slave_temperature', of_contact_points, 'temperature', needs_heat, head='T1', &
      width=11, description='temperature of the slave'), &
      quantity_type('master_temperature', of_contact_points, 'temperature', needs_heat, head='T2', &
      width=11, description='temperature of the master'), &
      quantity_type('conductance', of_contact_points, 'power/(length^2 temperature)', needs_heat, &
      head='omega', width=10, is_on_faces=.true., description='conductance of the contact'), &
      quantity_type('heat_flux', of_contact_points, 'power/length^2', needs_heat, head='q', &
      width=11, is_on_faces=.true., description='heat flux from slave to master')]

   !> Those with an uncertainty; uncertainties of an interface are in this order.
   type(quantity_type), parameter :: estimated(*) = pack(contact_table, contact_table%is_estimated)

contains

   !> Whether an interface has a quantity of its table: heat is solved, its faces wear.
   elemental logical function has_quantity(contact, needs) result(has)
      type(contact_record_type), intent(in) :: contact   !! state of the interface
      integer, intent(in) :: needs                       !! of the quantity

      has = .true.
      if (needs == needs_heat) has = allocated(contact%heat_flux)
      if (needs == needs_wear) has = allocated(contact%wear_slave)
   end function has_quantity

   !> A quantity of an interface, or of its contact points: those of the mesh excepted.
   pure function contact_values(name, contact) result(values)
      character(*), intent(in) :: name                   !! one of of_interface or of_contact_points
      type(contact_record_type), intent(in) :: contact   !! state of the interface
      !> One a contact point, one an edge, or one alone; NaN where the step has none; empty for a
      !> name that is not known.
      real(dp), allocatable :: values(:)

      select case (name)
      case ('normal_force')
         values = [contact%normal_force]
      case ('shear_force')
         values = [contact%shear_force]
      case ('heat_rate')
         values = [contact%heat_rate]
      case ('peak_pressure')
         values = [maxval(or_nan(contact%pressure))]
      case ('edge_contact')
         values = [contact%edge_contact]
      case ('edge_stick')
         values = [contact%edge_stick]
      case ('edges_contact')
         values = contact%edges_contact
      case ('edges_stick')
         values = contact%edges_stick
      case ('status')
         values = real(contact%contact_state, dp)
      case ('gap')
         values = of_masters(or_nan(contact%gap))
      case ('pressure')
         values = or_nan(contact%pressure)
      case ('shear')
         values = or_nan(contact%shear)
      case ('slip')
         values = or_nan(contact%slip)
      case ('worn_volume_slave')
         values = [contact%worn_volume(1)]
      case ('worn_volume_master')
         values = [contact%worn_volume(2)]
      case ('wear_slave')
         values = or_nan(contact%wear_slave)
      case ('wear_master')
         values = or_nan(contact%wear_master)
      case ('slave_temperature')
         values = or_nan(contact%slave_temperature)
      case ('master_temperature')
         values = of_masters(or_nan(contact%master_temperature))
      case ('conductance')
         values = or_nan(contact%conductance)
      case ('heat_flux')
         values = or_nan(contact%heat_flux)
      case default
         allocate (values(0))
      end select
   contains
      !> Values, or a NaN for each contact point where there are none.
      pure function or_nan(given) result(filled)
         real(dp), allocatable, intent(in) :: given(:)
         real(dp) :: filled(size(contact%contact_state))

         filled = ieee_value(1.0_dp, ieee_quiet_nan)
         if (allocated(given)) filled = given
      end function or_nan

      !> Values that take a master opposite; NaN without.
      pure function of_masters(given) result(filled)
         real(dp), intent(in) :: given(:)
         real(dp) :: filled(size(given))

         filled = given
         if (.not. allocated(contact%is_beyond)) return
         where (contact%is_beyond) filled = ieee_value(1.0_dp, ieee_quiet_nan)
      end function of_masters
   end function contact_values

   !> Those with an uncertainty; NaN for an edge where there is none.
   pure function estimated_values(contact) result(values)
      type(contact_record_type), intent(in) :: contact   !! state of the interface
      real(dp) :: values(size(estimated))
      integer :: q

      do q = 1, size(estimated)
         values(q:q) = contact_values(estimated(q)%name, contact)
      end do
   end function estimated_values

   !> A quantity of the contact points that the mesh gives.
   pure function geometry_values(name, points, node_number) result(values)
      character(*), intent(in) :: name                     !! one of those with is_geometry
      type(contact_points_type), intent(in) :: points       !! contact points of the interface
      integer, intent(in) :: node_number(:)                !! (nodes) numbers in the deck
      real(dp), allocatable :: values(:)                   !! (m), empty for an unknown name
      integer :: k

      select case (name)
      case ('slave_node')
         values = real(node_number(points%slave), dp)
      case ('master_node')
         values = real(node_number(points%master), dp)
      case ('x')
         values = points%position(1, :)
      case ('y')
         values = points%position(2, :)
      case ('s')
         values = points%arc_length
      case ('piece')
         associate (ends => points%ends())
            values = [(real(count(ends(1::2) <= k), dp), k=1, size(points%slave))]
         end associate
      case ('weight')
         values = points%weight
      case default
         allocate (values(0))
      end select
   end function geometry_values

   !> Words in place of an edge where its zone is the whole face, or none; else nothing.
   pure function zone_words(name, contact) result(words)
      character(*), intent(in) :: name                   !! of a quantity of an interface
      type(contact_record_type), intent(in) :: contact   !! its state
      character(:), allocatable :: words

      words = ''
      associate (states => contact%contact_state)
         if (name == 'edge_contact') then
            if (all(states == contact_open)) words = 'none (open)'
            if (all(states /= contact_open)) words = 'whole face'
         else if (name == 'edge_stick') then
            if (all(states /= contact_stick)) words = 'none'
            if (all(states == contact_stick)) words = 'whole face'
         end if
      end associate
   end function zone_words

   !> Words on an edge at the end of the face.
   pure function end_words(name, contact) result(words)
      character(*), intent(in) :: name                   !! of an edge
      type(contact_record_type), intent(in) :: contact   !! state of its interface
      character(:), allocatable :: words

      words = zone_words(name, contact)
      if (words == '') words = 'up to an end of the face'
   end function end_words

end module contact_quantities
