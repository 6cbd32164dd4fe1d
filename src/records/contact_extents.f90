!> How far the contact of an interface reaches, by its record: widths and lengths, the spacing at
!> edges, which of these are ends of the face, and where its pressure is largest.
module contact_extents
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use contact_points, only: contact_points_type, on_axis
   use contact_system, only: contact_open
   use kinds, only: dp
   use quantity_types, only: quantity_type
   use records, only: contact_record_type
   implicit none
   private
   public :: closed_length, contact_width, is_end_of_face, peak_is_at_end, peaks_at_axis, &
      peaks_at_corner, point_before, rises_to_end, spacing_at

contains

   !> Width of all zones of contact, from edge to edge as the summary has it. Contact points whose
   !> zones have no width, as one that is closed alone may, have their tributary length.
   pure real(dp) function contact_width(points, contact) result(width)
      type(contact_points_type), intent(in) :: points     !! contact points of the interface
      type(contact_record_type), intent(in) :: contact    !! its state
      integer :: edge, k

      width = 0.0_dp
      edge = 0
      do k = 1, size(points%arc_length) - 1
         if (.not. points%on_one_piece(k, k + 1)) cycle
         associate (is_closed => contact%contact_state(k:k + 1) /= contact_open, &
            s => points%arc_length)
            if (is_closed(1) .neqv. is_closed(2)) then
               edge = edge + 1
               ! Edges beyond those that are kept are half-way between their contact points.
               if (edge > size(contact%edges_contact)) then
                  width = width + 0.5_dp*(s(k + 1) - s(k))
               else
                  width = width + abs(contact%edges_contact(edge) - s(merge(k, k + 1, &
                     is_closed(1))))
               end if
            else if (is_closed(1)) then
               width = width + s(k + 1) - s(k)
            end if
         end associate
      end do
      if (width <= 0.0_dp) width = closed_length(points, contact)
   end function contact_width

   !> Length of the interface that is closed, by the tributary lengths of its contact points.
   pure real(dp) function closed_length(points, contact) result(length)
      type(contact_points_type), intent(in) :: points     !! contact points of the interface
      type(contact_record_type), intent(in) :: contact    !! its state
      real(dp), allocatable :: s(:)
      integer :: k

      length = 0.0_dp
      do k = 1, size(points%arc_length)
         if (contact%contact_state(k) == contact_open) cycle
         s = points%arc_length([k, points%beside(k)])
         length = length + 0.5_dp*(maxval(s) - minval(s))
      end do
   end function closed_length

   !> The spacing that an edge is known to a part of: of the contact points about it for contact, of
   !> the nodes for stick; 0 at or beyond the last contact point of a piece, where a zone ends with
   !> the face, and for what is no edge [length].
   pure real(dp) function spacing_at(quantity, points, edge) result(spacing)
      type(quantity_type), intent(in) :: quantity
      type(contact_points_type), intent(in) :: points  !! the contact points of the interface
      real(dp), intent(in) :: edge                     !! as arc length, or NaN [length]
      integer :: k

      spacing = 0.0_dp
      if (quantity%resolution <= 0.0_dp .or. ieee_is_nan(edge)) return
      if (size(points%arc_length) < 2) return
      associate (s => points%arc_length)
         k = point_before(s, edge)
         if (.not. points%on_one_piece(k, k + 1)) return
         if (edge >= s(k) .and. edge < s(k + 1)) spacing = s(k + 1) - s(k)
      end associate
      if (quantity%name == 'edge_stick') spacing = spacing/points%node_spacings
   end function spacing_at

   !> The contact point before an edge, of those that have a next one.
   pure integer function point_before(s, edge)
      real(dp), intent(in) :: s(:)       !! (m >= 2) arc lengths, ascending [length]
      real(dp), intent(in) :: edge       !! as arc length [length]

      point_before = min(max(count(s <= edge), 1), size(s) - 1)
   end function point_before

   !> Whether a value is an edge at the end of the face: the mesh does not move it.
   pure logical function is_end_of_face(quantity, points, value)
      type(quantity_type), intent(in) :: quantity
      type(contact_points_type), intent(in) :: points   !! the contact points of the interface
      real(dp), intent(in) :: value                     !! of the quantity; NaN: none

      is_end_of_face = quantity%resolution > 0.0_dp .and. .not. ieee_is_nan(value) .and. &
         spacing_at(quantity, points, value) <= 0.0_dp
   end function is_end_of_face

   !> Whether the pressure is largest at the first, at the last contact point of each piece; not
   !> without pressure.
   pure function peak_is_at_end(points, contact) result(at_end)
      type(contact_points_type), intent(in) :: points     !! contact points of the interface
      type(contact_record_type), intent(in) :: contact    !! its state
      logical, allocatable :: at_end(:)                   !! (2 pieces)

      at_end = maxloc(contact%pressure, dim=1) == points%ends() .and. any(contact%pressure > 0.0_dp)
   end function peak_is_at_end

   !> Whether the pressure is largest at a corner, where one of two faces ends. It varies as a power
   !> of the distance to there and has no limit (J. Dundurs, M.-S. Lee, J. Elasticity 2 (1972)
   !> 109-112).
   pure logical function peaks_at_corner(points, contact)
      type(contact_points_type), intent(in) :: points     !! contact points of the interface
      type(contact_record_type), intent(in) :: contact    !! its state

      peaks_at_corner = any(points%at_corner .and. peak_is_at_end(points, contact))
   end function peaks_at_corner

   !> Whether the pressure of sides of two nodes is largest within two of them from the axis, where
   !> errors of two orders may cancel on a mesh.
   pure logical function peaks_at_axis(points, contact)
      type(contact_points_type), intent(in) :: points     !! contact points of the interface
      type(contact_record_type), intent(in) :: contact    !! its state
      integer :: k, peak

      peak = maxloc(contact%pressure, dim=1)
      peaks_at_axis = (points%side_nodes - 1)*points%node_spacings == 1 .and. any(on_axis(points, &
         [(k, k=max(1, peak - 2), min(size(contact%pressure), peak + 2))]))
   end function peaks_at_axis

   !> Whether the pressure is largest at an end of a piece and rises to it beyond the line through
   !> the two contact points before, as where it has no limit: by more than pressures of corners and
   !> midside nodes differ by where it is even.
   pure logical function rises_to_end(points, contact)
      type(contact_points_type), intent(in) :: points     !! contact points of the interface
      type(contact_record_type), intent(in) :: contact    !! its state
      real(dp), parameter :: uneven = 0.03_dp
      integer :: inner(3), k, way

      k = maxloc(contact%pressure, dim=1)
      way = merge(1, -1, points%on_one_piece(k, k + 1))
      rises_to_end = points%on_one_piece(k, k + 2*way) .and. any(peak_is_at_end(points, contact))
      if (.not. rises_to_end) return
      inner = k + way*[0, 1, 2]
      associate (s => points%arc_length(inner), p => contact%pressure(inner))
         rises_to_end = p(1) > (1.0_dp + uneven)*(p(2) + (p(2) - p(3))*(s(1) - s(2))/(s(2) - s(3)))
      end associate
   end function rises_to_end

end module contact_extents
