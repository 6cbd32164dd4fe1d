!> Contact points of faces that slide along each other by any distance, SLIDING=FINITE. They are
!> those of the slave, so that friction, conductance and what they remember stay with the material:
!> one for each corner of the slave (each node with PAIRING=NODES), at all times. What lies opposite
!> is found on the displaced faces, as contact_pairs finds it on the mesh; a contact point without
!> a master is there, too, with its slave's own displacement, and open.
!>
!> With the displacements u of the geometry, the relative displacement D u of the points and their
!> normal n, the gap of any displacements v near u is
!>
!>    gap(v) = gap(u) - n.D (v - u) = h - n.D v,   h = gap(u) + n.D u,
!>
!> so that h takes the place of the initial gap: gaps are not summed up along the path.
module sliding_faces
   use chain_geometry, only: arc_lengths, chain_tangents, edge_lengths, tributary_areas
   use contact_definitions, only: contact_definition_type, pairing_nodes, pairing_surfaces
   use contact_pairs, only: find_opposite_points
   use contact_pieces, only: line_starts
   use contact_points, only: contact_points_type
   use element_kinds, only: axisymmetric
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp
   use mesh, only: mesh_type
   use mortar_segments, only: hats_of
   use sum_lists, only: single_values, sum_list_type
   use surface_chains, only: chain_faces, surface_chain_type
   implicit none
   private
   public :: place_points

contains

   !> The contact points of an interface on displaced faces.
   !> Errors: closed faces, a master of several lines; as make_contact_points.
   subroutine place_points(mesh, definition, thickness, displacement, points, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition !! the *CONTACT PAIR
      real(dp), intent(in) :: thickness !! thickness of the slave, not used if axisymmetric [length]
      real(dp), intent(in) :: displacement(:)                 !! (2 nodes) [length]
      type(contact_points_type), intent(out) :: points
      type(error_type), allocatable, intent(out) :: error
      type(surface_chain_type), allocatable :: slaves(:), masters(:)
      type(contact_points_type) :: opposite
      type(mesh_type) :: displaced
      integer, allocatable :: master_nodes(:), place(:)   ! place: (m) among these, 0 for none
      integer :: i

      call chain_faces(mesh, mesh%surfaces(definition%slave), slaves, error)
      if (allocated(error)) return
      associate (master => mesh%surfaces(definition%master))
         if (allocated(master%drawing)) then
            allocate (masters(0))
            master_nodes = [master%drawing%reference]
         else
            call chain_faces(mesh, master, masters, error)
            if (allocated(error)) return
            master_nodes = [(masters(i)%nodes, i=1, size(masters))]
         end if
      end associate
      call check_lines(mesh, definition, slaves, masters, error)
      if (allocated(error)) return
      displaced = displaced_mesh(mesh, displacement)
      call find_opposite_points(displaced, definition, slaves, thickness, opposite, error)
      if (allocated(error)) return
      call begin_points(mesh, definition, slaves, thickness, master_nodes, points)
      allocate (place(size(points%slave)), source=0)
      if (allocated(opposite%slave)) then
         opposite%initial_gap = opposite%initial_gap + sum(opposite%normal* &
            opposite%relative(displacement), dim=1)
         place = [(findloc(opposite%slave, points%slave(i), dim=1), i=1, size(place))]
         call take_opposite(displaced%coordinates, opposite, place, points)
      end if
      call set_sums(opposite, place, points)
   end subroutine place_points

   !> Refuses what has no ends to slide along, and masters whose lines would share a contact point.
   subroutine check_lines(mesh, definition, slaves, masters, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition
      type(surface_chain_type), intent(in) :: slaves(:), masters(:)
      type(error_type), allocatable, intent(out) :: error
      logical :: is_closed

      is_closed = any(slaves%closed) .or. any(masters%closed)
      if (allocated(mesh%surfaces(definition%master)%drawing)) is_closed = is_closed .or. &
         mesh%surfaces(definition%master)%drawing%closed
      if (is_closed) then
         call set_error(error, status_deck, definition%title()//': SLIDING=FINITE needs faces '// &
            'with ends, and one of these is a closed ring; leave a part of it out', &
            definition%card)
      else if (size(masters) > 1) then
         call set_error(error, status_deck, definition%title()//': SLIDING=FINITE needs a '// &
            'master of one line, and surface '//mesh%surfaces(definition%master)%name// &
            ' has several; make a surface and a *CONTACT PAIR of each', definition%card)
      end if
   end subroutine check_lines

   !> The mesh with its nodes and drawings where displacements take them.
   pure function displaced_mesh(mesh, displacement) result(displaced)
      type(mesh_type), intent(in) :: mesh
      real(dp), intent(in) :: displacement(:)                 ! (2 nodes) [length]
      type(mesh_type) :: displaced
      real(dp) :: arm(2), rotation
      integer :: i, k

      displaced = mesh
      displaced%coordinates = mesh%coordinates + reshape(displacement, shape(mesh%coordinates))
      do i = 1, size(mesh%surfaces)
         if (.not. allocated(mesh%surfaces(i)%drawing)) cycle
         associate (drawing => displaced%surfaces(i)%drawing)
            ! Its value along x is the angle.
            rotation = displacement(2*drawing%rotation - 1)
            arm = mesh%coordinates(:, drawing%reference)
            displaced%coordinates(:, drawing%rotation) = mesh%coordinates(:, drawing%rotation)
            do k = 1, size(drawing%is_arc)
               drawing%start(:, k) = moved(drawing%start(:, k))
               drawing%finish(:, k) = moved(drawing%finish(:, k))
               drawing%centre(:, k) = moved(drawing%centre(:, k))
            end do
         end associate
      end do
   contains
      pure function moved(x)
         real(dp), intent(in) :: x(2)
         real(dp) :: moved(2)

         associate (reference => displaced%surfaces(i)%drawing%reference)
            moved = x + displacement(2*reference - 1:2*reference) + rotation*[arm(2) - x(2), &
               x(1) - arm(1)]
         end associate
      end function moved
   end function displaced_mesh

   !> All contact points of the slave, none with a master yet.
   subroutine begin_points(mesh, definition, slaves, thickness, master_nodes, points)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition
      type(surface_chain_type), intent(in) :: slaves(:)
      real(dp), intent(in) :: thickness
      integer, intent(in) :: master_nodes(:)                  ! of its line, or the reference node
      type(contact_points_type), intent(inout) :: points      ! empty
      real(dp) :: section, start(size(slaves))
      integer :: i, k, step

      points%name = definition%name
      points%pairing = merge(pairing_nodes, pairing_surfaces, definition%pairing == pairing_nodes)
      points%follows_sliding = .true.
      points%is_rigid = allocated(mesh%surfaces(definition%master)%drawing)
      points%side_nodes = merge(slaves(1)%side_nodes, 2, points%pairing == pairing_nodes)
      points%node_spacings = merge(1, slaves(1)%side_nodes - 1, points%pairing == pairing_nodes)
      points%about_axis = mesh%element_plane(mesh%surfaces(definition%slave)%faces(1, 1)) == &
         axisymmetric
      section = merge(0.0_dp, thickness, points%about_axis)
      step = points%node_spacings
      points%slave = [(slaves(i)%nodes(::step), i=1, size(slaves))]
      points%cuts = [(size(slaves(i)%nodes(::step)), i=1, size(slaves) - 1)]
      do i = 2, size(points%cuts)
         points%cuts(i) = points%cuts(i) + points%cuts(i - 1)
      end do
      if (size(slaves) == 1) deallocate (points%cuts)
      points%to_end = [(huge(1.0_dp), i=1, 2*size(slaves))]
      points%at_corner = [(.false., i=1, 2*size(slaves))]
      allocate (points%arc_length(0), points%edge(0), points%weight(0), points%tangent(2, 0))
      start = line_starts(mesh, slaves)
      do i = 1, size(slaves)
         associate (x => mesh%coordinates(:, slaves(i)%nodes), n => slaves(i)%side_nodes)
            associate (s => arc_lengths(x, n, .false.), edge => edge_lengths(x, n, .false.), &
               weight => tributary_areas(x(:, ::step), merge(n, 2, step == 1), .false., &
               section), along => chain_tangents(x, n, .false.))
               points%arc_length = [points%arc_length, start(i) + s(::step)]
               points%edge = [points%edge, edge(::step)]
               points%weight = [points%weight, weight]
               points%tangent = reshape([points%tangent, along(:, ::step)], &
                  [2, size(points%weight)])
            end associate
         end associate
      end do
      associate (side => [(spread(merge(-1.0_dp, 1.0_dp, slaves(i)%turned), 1, &
         size(slaves(i)%nodes(::step))), i=1, size(slaves))])
         points%normal = reshape([(side(k)*[points%tangent(2, k), -points%tangent(1, k)], k=1, &
            size(side))], [2, size(side)])
      end associate
      points%master = spread(master_nodes(1), 1, size(points%slave))
      points%position = mesh%coordinates(:, points%slave)
      points%initial_gap = points%edge   ! as good as any where nothing is opposite
      points%is_beyond = spread(.true., 1, size(points%slave))
      points%is_open_corner = points%is_beyond
      points%face_node = [(slaves(i)%nodes, i=1, size(slaves))]
      if (.not. points%is_rigid) points%face_node = [points%face_node, master_nodes]
      if (points%pairing == pairing_surfaces) then
         allocate (points%mortar%segments(0))
         points%mortar%hats = hats_of(points%mortar%segments, size(points%slave))
      end if
   end subroutine begin_points

   !> The sums of nodal values: those of what lies opposite, or of the slave's nodes alone; and the
   !> contact quantities at all nodes of both faces, empty where they are not opposite each other.
   pure subroutine set_sums(opposite, place, points)
      type(contact_points_type), intent(in) :: opposite
      integer, intent(in) :: place(:)                         ! (m) as above
      type(contact_points_type), intent(inout) :: points
      type(sum_list_type) :: own, none
      integer :: i, k, number(0:maxval(place))

      own = single_values(points%slave)
      call none%reserve(size(place), 1)
      number = 0
      do k = 1, size(place)
         call none%add([integer ::], [real(dp) ::])
         number(place(k)) = k
      end do
      points%difference = replaced(own, opposite%difference)
      points%slave_mean = replaced(own, opposite%slave_mean)
      points%master_mean = replaced(none, opposite%master_mean)
      if (opposite%turns()) then
         points%along = replaced(own, opposite%along)
         points%across = replaced(none, opposite%across)
      end if
      call points%at_face_nodes%reserve(size(points%face_node), 2*size(points%face_node))
      do i = 1, size(points%face_node)
         k = 0
         if (any(place > 0)) k = findloc(opposite%face_node, points%face_node(i), dim=1)
         if (k > 0) then
            call points%at_face_nodes%add(number(opposite%at_face_nodes%values_of(k)), &
               opposite%at_face_nodes%coefficients_of(k))
         else
            call points%at_face_nodes%add([integer ::], [real(dp) ::])
         end if
      end do
   contains
      !> The sums of contact points without a master, and those of the others.
      pure function replaced(without, with) result(sums)
         type(sum_list_type), intent(in) :: without, with
         type(sum_list_type) :: sums
         integer :: k

         call sums%reserve(size(place), 8*size(place))
         do k = 1, size(place)
            if (place(k) > 0) then
               call sums%add(with%values_of(place(k)), with%coefficients_of(place(k)))
            else
               call sums%add(without%values_of(k), without%coefficients_of(k))
            end if
         end do
      end function replaced
   end subroutine set_sums

   !> Gives those of the contact points that have a master what they have beside it. Places and arc
   !> length stay those of the undeformed slave: the contact point of a side that is covered in part
   !> lies where the cover ends.
   pure subroutine take_opposite(x, opposite, place, points)
      real(dp), intent(in) :: x(:, :)                         ! (2, nodes) displaced [length]
      type(contact_points_type), intent(in) :: opposite
      integer, intent(in) :: place(:)                         ! (m) among these, 0 for none
      type(contact_points_type), intent(inout) :: points
      integer :: i, j, k
      integer :: number(0:size(opposite%slave))

      number = 0
      do k = 1, size(place)
         j = place(k)
         if (j == 0) cycle
         number(j) = k
         points%master(k) = opposite%master(j)
         points%weight(k) = opposite%weight(j)
         points%normal(:, k) = opposite%normal(:, j)
         points%tangent(:, k) = opposite%tangent(:, j)
         points%initial_gap(k) = opposite%initial_gap(j)
         associate (beyond => opposite%position(:, j) - x(:, points%slave(k)))
            points%position(:, k) = points%position(:, k) + beyond
            points%arc_length(k) = points%arc_length(k) + &
               dot_product(beyond, opposite%tangent(:, j))
         end associate
         points%is_beyond(k) = .false.
         points%is_open_corner(k) = .false.
      end do
      points%finest_gap = opposite%finest_gap
      if (.not. allocated(opposite%mortar%segments)) return
      points%mortar = opposite%mortar
      if (size(opposite%slave) == size(place) .and. all(number(1:) == [(k, k=1, size(number) - &
         1)])) return
      do i = 1, size(points%mortar%segments)
         associate (ends => points%mortar%segments(i)%points)
            ends = number(ends)
         end associate
      end do
      points%mortar%hats = hats_of(points%mortar%segments, size(place))
   end subroutine take_opposite

end module sliding_faces
