!> Bounds of the errors that the mesh makes in the quantities of an interface.
!>
!> They follow from the change that halved elements make, as for errors that fall with h only. At a
!> single load this is partly chance, for errors change their sign as the edge of contact passes a
!> node; so the scatter of a quantity over the increments before is added. What friction locked in
!> while the contact grew over the nodes is known from the old mesh only: its error is a part of the
!> stuck shear forces that falls with the spacing. The error of an edge depends on where it lies
!> between two nodes, and is far smaller on halved elements: it is nearly what these move it by, and
!> a part of the spacing for what they leave. Elements that are not halved move it by as large a
!> part of the contact as they change the force by.
!>
!> docs/accuracy.md says on which decks the constants were chosen and which judge them.
module mesh_bounds
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use contact_definitions, only: pairing_surfaces
   use contact_points, only: contact_points_type, on_axis
   use contact_quantities, only: estimated
   use contact_system, only: contact_open, contact_slip, contact_stick
   use interface_quantities, only: closed_length, edge_spacing, peaks_at_corner, &
      resolved_length
   use kinds, only: dp
   use quantity_types, only: find_quantity
   use records, only: contact_record_type
   implicit none
   private
   public :: bounds_of_mesh, locked_in

   !> Error in the change that halved elements make: errors that fall with h are just twice as
   !> large, and need some room; with hats, and where there is no scatter, more.
   real(dp), parameter :: of_change = 2.1_dp, of_change_alone = 3.0_dp
   !> The same where contact ends at a corner: stresses there vary nearly as the inverse root of the
   !> distance, and errors fall with the root of h: 1/(1 - 2^(-1/2)).
   real(dp), parameter :: of_change_at_corner = 3.4_dp
   !> Error of the heat rate in its scatter without hats.
   real(dp), parameter :: of_scatter_in_heat = 0.7_dp
   !> Error of shear force, that with hats, and that of peak pressure in what friction locked in.
   real(dp), parameter :: of_locked = 0.4_dp, of_locked_with_hats = 0.6_dp
   real(dp), parameter :: of_locked_in_peak = 0.15_dp
   !> How much more of it there is between node pairs of triangles.
   real(dp), parameter :: of_triangles = 2.0_dp
   !> Error of an edge of contact in what halved elements move it by. The part of the spacing of the
   !> contact points is in the table of quantities; it grows by the relative jump of the conductance
   !> there: heat enters up to a node, an error of first order.
   real(dp), parameter :: of_edge_change = 1.5_dp, of_jump = 1.0_dp
   !> Error of an edge of stick in what halved elements move it by, in that with hats, and, beyond
   !> that, in the spacing of the nodes: where contact ends too, and elsewhere. There it is at least
   !> that of the table of quantities.
   real(dp), parameter :: of_stick_change = 1.0_dp, of_stick_change_with_hats = 1.5_dp
   real(dp), parameter :: of_both = 0.15_dp, of_stick = 0.5_dp
   real(dp), parameter :: same_place = 1.0e-6_dp    !! of the spacing
   !> Error of normal force and heat rate in the squared relative error of the energy norm that
   !> elements have that are not halved: all of it, and what is left of it beside the scatter.
   real(dp), parameter :: of_energy_alone = 1.0_dp, of_energy = 0.25_dp

contains

   !> The bounds, for the quantities with an estimate; NaN where none can be given.
   pure function bounds_of_mesh(points, contact, change, scatter, most_locked, energy, jump) &
      result(bounds)
      type(contact_points_type), intent(in) :: points    !! contact points of the interface
      type(contact_record_type), intent(in) :: contact   !! its state
      real(dp), intent(in) :: change(:)                  !! of the quantities by halved elements
      real(dp), intent(in) :: scatter(:)                 !! over increments; NaN: too few of them
      real(dp), intent(in) :: most_locked                !! largest of locked_in so far
      !> Squared relative error of the energy norms left in elements that were not halved [-]
      real(dp), intent(in) :: energy
      !> Jump of the conductance at an edge in the larger value there; 0 where no heat moves it [-]
      real(dp), intent(in) :: jump
      real(dp) :: bounds(size(estimated))
      real(dp), dimension(size(estimated)) :: known_scatter, not_halved
      real(dp) :: length, locked
      logical :: has_hats, is_alone(size(estimated))

      has_hats = points%pairing == pairing_surfaces
      ! No edge passes a node of a face with a single contact state.
      is_alone = ieee_is_nan(scatter) .or. all(contact%contact_state == contact%contact_state(1))
      known_scatter = known(merge(0.0_dp, scatter, is_alone), has_hats)
      bounds = merge(of_change_alone, of_change, has_hats .or. is_alone)
      if (any(points%at_corner .and. contact%contact_state(points%ends()) /= contact_open)) then
         bounds = max(bounds, of_change_at_corner)
      end if
      bounds = bounds*abs(change) + known_scatter
      ! Where displacements and temperatures are prescribed, force and heat rate err as the energy,
      ! by the square of its norm's error.
      not_halved = energy*merge(of_energy_alone, of_energy, is_alone)
      associate (force => find_quantity(estimated, 'normal_force'), &
         heat => find_quantity(estimated, 'heat_rate'))
         bounds(force) = bounds(force) + not_halved(force)*abs(contact%normal_force)
         bounds(heat) = bounds(heat) + not_halved(heat)*abs(contact%heat_rate)
      end associate
      length = closed_length(points, contact)
      locked = 0.0_dp
      if (length > 0.0_dp) locked = most_locked/length
      associate (force => bounds(find_quantity(estimated, 'normal_force')), &
         shear => bounds(find_quantity(estimated, 'shear_force')), &
         peak => bounds(find_quantity(estimated, 'peak_pressure')))
         shear = shear + locked*merge(of_locked_with_hats, of_locked, has_hats) + &
            missing_friction(points, contact)
         if (locked > 0.0_dp) peak = peak + of_locked_in_peak*locked*maxval(contact%pressure)/ &
            contact%normal_force
         peak = peak + rise_on_axis(points, contact%pressure)
         ! Both meshes may have the same peak by chance: it errs by as large a part as the force.
         if (contact%normal_force > 0.0_dp .and. .not. ieee_is_nan(peak + force)) peak = max(peak, &
            force*maxval(contact%pressure)/contact%normal_force)
         if (peaks_at_corner(points, contact)) peak = ieee_value(1.0_dp, ieee_quiet_nan)
      end associate
      call bound_edges(points, contact, change, known_scatter, 1.0_dp + of_jump*jump, bounds)
      ! What is left in other elements; halved ones show how far the force moves an edge.
      where (estimated%resolution > 0.0_dp) bounds = bounds + of_energy*energy*length
   end function bounds_of_mesh

   !> How far scatter counts. An edge of stick between node pairs lies within its part of the
   !> spacing without.
   pure function known(scatter, has_hats)
      real(dp), intent(in) :: scatter(:)
      logical, intent(in) :: has_hats
      real(dp) :: known(size(scatter))

      known = scatter
      if (has_hats) return
      associate (heat => known(find_quantity(estimated, 'heat_rate')))
         heat = of_scatter_in_heat*heat
      end associate
      known(find_quantity(estimated, 'edge_stick')) = 0.0_dp
   end function known

   !> The bounds of both edges.
   pure subroutine bound_edges(points, contact, change, scatter, of_nodes, bounds)
      type(contact_points_type), intent(in) :: points
      type(contact_record_type), intent(in) :: contact
      real(dp), intent(in) :: change(:), scatter(:)
      real(dp), intent(in) :: of_nodes      ! error of an edge of contact in its resolution
      real(dp), intent(inout) :: bounds(:)
      real(dp) :: part, spacing

      spacing = nodal_spacing(points, contact%edge_stick)
      associate (outer => find_quantity(estimated, 'edge_contact'), &
         inner => find_quantity(estimated, 'edge_stick'))
         part = of_nodes*resolved_length(estimated(outer), points, contact%edge_contact)
         bounds(outer) = edge_bound(contact%edge_contact, change(outer), of_edge_change, part, &
            0.0_dp)
         if (ends_with_contact(points, contact)) then
            bounds(inner) = edge_bound(contact%edge_stick, change(inner), of_edge_change, &
               max(of_both*spacing, part), 0.0_dp)
         else
            bounds(inner) = scatter(inner) + edge_bound(contact%edge_stick, change(inner), &
               merge(of_stick_change_with_hats, of_stick_change, points%pairing == &
               pairing_surfaces), of_stick*spacing, resolved_length(estimated(inner), points, &
               contact%edge_stick))
         end if
      end associate
   end subroutine bound_edges

   !> A multiple of what halved elements move an edge by, and a length, at least another one; NaN
   !> where there is no edge, or none on the finer mesh.
   pure real(dp) function edge_bound(edge, change, of_change, length, least) result(bound)
      real(dp), intent(in) :: edge, change, of_change, length, least

      bound = change + edge
      if (.not. ieee_is_nan(bound)) bound = max(of_change*abs(change) + length, least)
   end function edge_bound

   !> How far the pressure on the axis, which few elements tell, is from the even parabola through
   !> the two contact points beside it, where it is the largest there; 0 elsewhere.
   pure real(dp) function rise_on_axis(points, pressure) result(rise)
      type(contact_points_type), intent(in) :: points
      real(dp), intent(in) :: pressure(:)
      real(dp) :: square(2)
      integer :: k, way
      integer, allocatable :: ends(:)

      rise = 0.0_dp
      ends = points%ends()
      ends = pack(ends, on_axis(points, ends))
      if (size(ends) == 0) return
      k = ends(1)
      way = merge(1, -1, points%on_one_piece(k, k + 1))
      if (.not. points%on_one_piece(k, k + 2*way)) return
      if (abs(maxloc(pressure, dim=1) - k) > 1) return
      square = (points%arc_length([k + way, k + 2*way]) - points%arc_length(k))**2
      rise = abs(pressure(k) - (pressure(k + way)*square(2) - pressure(k + 2*way)*square(1))/ &
         (square(2) - square(1)))
   end function rise_on_axis

   !> Spacing of the slave's nodes at an edge.
   pure real(dp) function nodal_spacing(points, edge)
      type(contact_points_type), intent(in) :: points
      real(dp), intent(in) :: edge

      nodal_spacing = edge_spacing(points, edge)/points%node_spacings
   end function nodal_spacing

   !> Whether all that is closed up to its outer edge sticks.
   pure logical function ends_with_contact(points, contact)
      type(contact_points_type), intent(in) :: points
      type(contact_record_type), intent(in) :: contact

      ends_with_contact = .not. ieee_is_nan(contact%edge_stick + contact%edge_contact)
      if (ends_with_contact) ends_with_contact = abs(contact%edge_stick - contact%edge_contact) &
         <= same_place*edge_spacing(points, contact%edge_contact)
   end function ends_with_contact

   !> Sum of the shear forces of stuck contact points, without their signs, times the spacing at
   !> the edge of contact, over which the last of them came to stick [force length]. What slides
   !> across several node pairs before it sticks does so at a slip whose error is as many times
   !> smaller. With triangles the mesh on both sides of a node differs: it slips with any pressure,
   !> however wide the zone of slip is.
   pure real(dp) function locked_in(points, contact, has_triangles)
      type(contact_points_type), intent(in) :: points
      type(contact_record_type), intent(in) :: contact
      logical, intent(in) :: has_triangles

      locked_in = 0.0_dp
      if (.not. allocated(contact%shear)) return
      associate (spacing => nodal_spacing(points, contact%edge_contact))
         locked_in = sum(abs(points%weight*contact%shear), &
            mask=contact%contact_state == contact_stick)*spacing
         if (points%pairing == pairing_surfaces) return
         if (has_triangles) then
            locked_in = of_triangles*locked_in
         else if (spacing > 0.0_dp) then
            locked_in = locked_in/max(1.0_dp, least_slip_zone(points, contact)/spacing)
         end if
      end associate
   end function locked_in

   !> Width of the narrowest zone of slip between stuck contact points and open ones; 0 where there
   !> is none [length].
   pure real(dp) function least_slip_zone(points, contact) result(width)
      type(contact_points_type), intent(in) :: points
      type(contact_record_type), intent(in) :: contact
      integer :: last, k

      width = huge(width)
      last = 0
      do k = 1, size(points%arc_length)
         if (contact%contact_state(k) == contact_slip) cycle
         if (points%on_one_piece(k, last)) then
            ! From the middle between two points to the middle between the next two.
            if (contact%contact_state(k) /= contact%contact_state(last)) width = min(width, &
               0.5_dp*(points%arc_length(k) + points%arc_length(k - 1) - &
               points%arc_length(last) - points%arc_length(last + 1)))
         end if
         last = k
      end do
      if (width >= huge(width)) width = 0.0_dp
   end function least_slip_zone

   !> Friction that is missing where supports hold both nodes of a closed contact point along the
   !> face, and the one beside it slips: the part of the face that it stands for slips as well, but
   !> for the point itself [force].
   pure real(dp) function missing_friction(points, contact)
      type(contact_points_type), intent(in) :: points
      type(contact_record_type), intent(in) :: contact
      real(dp), allocatable :: slipping(:)
      integer :: k

      missing_friction = 0.0_dp
      if (.not. allocated(contact%shear)) return
      slipping = merge(abs(contact%shear), 0.0_dp, contact%contact_state == contact_slip)
      do k = 1, size(contact%shear)
         if (contact%pressure(k) <= 0.0_dp .or. abs(contact%shear(k)) > 0.0_dp) cycle
         missing_friction = missing_friction + &
            points%weight(k)*maxval(slipping([k, points%beside(k)]))
      end do
   end function missing_friction

end module mesh_bounds
