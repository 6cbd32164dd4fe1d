!> The contact points of a *CONTACT PAIR: pairs of opposite nodes, as in the published method, where
!> its faces match, mortar points (mortar_points) where they do not, or what the deck asks for. The
!> points of a *TIE, whose relative displacements and jumps of temperature are zero, are made alike.
module contact_pairs
   use, intrinsic :: iso_fortran_env, only: real32
   use chain_geometry, only: arc_lengths, at_tips, chain_tangents, edge_lengths, tributary_areas
   use contact_definitions, only: contact_definition_type, pairing_nodes, pairing_surfaces, &
      tie_definition_type
   use contact_pieces, only: join_pieces
   use contact_points, only: contact_points_type, no_radius, small_offset
   use drawn_lines, only: drawn_line_type
   use element_kinds, only: axisymmetric, element_corner_count
   use errors, only: error_type, set_error, status_deck
   use interface_checks, only: blame_corner, check_corner, check_covered, check_folds, &
      check_opposite, check_shared, check_sides, compare_lines
   use interface_warnings, only: mismatch_of_pairs
   use kinds, only: dp
   use mesh, only: extent_of, mesh_type
   use mortar_points, only: other_chains_type, set_mortar_points
   use rigid_masters, only: check_facing, follow_reference, opposite_line, sampled_line
   use sum_lists, only: differences, single_values, sum_list_type
   use surface_chains, only: align_chain, chain_faces, facing_chain, surface_chain_type
   use text, only: to_text
   implicit none
   private
   public :: make_contact_points, make_tie_points, touching

   real(dp), parameter :: rounding = 1.0e-9_dp   !! relative, of coordinates
   !> Part of the largest coordinate within which faces touch. Coordinates written with 15 digits,
   !> the most that every double keeps, err by 5e-15 of it on either face.
   real(dp), parameter :: touching = 64*epsilon(1.0_dp)
   !> What coordinates in single precision leave between two faces, of the largest coordinate: half
   !> a unit in the last place along both axes of both.
   real(dp), parameter :: single = 2*epsilon(1.0_real32)
   real(dp), parameter :: weightless = 0.01_dp   !! part of its neighbour's weight below which the
   !! corner on the axis has none
   !> Angle of a body from which on its outline goes on at a node: it turns away by 45 degrees.
   real(dp), parameter :: going_on = 0.75_dp*acos(-1.0_dp)

contains

   !> The contact points of two lines with equally many nodes: the k-th nodes along both. A node
   !> that both lines end in, the tip of a crack, is none.
   !> Errors: nodes that are not opposite, bodies on the wrong side, sides without tributary length.
   subroutine set_node_pairs(mesh, definition, slave, master, thickness, points, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition !! the *CONTACT PAIR
      type(surface_chain_type), intent(in) :: slave, master   !! both from the slave's first node on
      real(dp), intent(in) :: thickness !! thickness of the slave, not used if axisymmetric [length]
      type(contact_points_type), intent(inout) :: points      !! its name and its axis are set
      type(error_type), allocatable, intent(out) :: error
      integer :: first, k, last
      integer, allocatable :: kept(:)
      logical :: on_drawing

      points%pairing = pairing_nodes
      on_drawing = allocated(master%tangent)
      points%slave = slave%nodes
      points%master = master%nodes
      call set_weights(mesh, slave, master, thickness, points%about_axis, points%weight)
      first = 1
      last = size(slave%nodes)
      if (slave%nodes(1) == master%nodes(1)) first = 2
      if (slave%nodes(last) == master%nodes(last)) last = last - 1
      call set_geometry(mesh, slave, master, points)
      if (.not. on_drawing) then
         call check_sides(mesh, definition, slave, master, [first, last], error)
         if (allocated(error)) return
      end if
      if (.not. (slave%closed .or. master%closed)) then
         ! One face may end at a corner of its body where the other goes on, as a punch on a wider
         ! body: judged by the outlines beyond the lines.
         associate (s => slave%nodes([1, size(slave%nodes)]), &
            m => master%nodes([1, size(slave%nodes)]))
            points%at_corner = [(body_angle(mesh, s(k)) > going_on .neqv. &
               body_angle(mesh, m(k)) > going_on, k=1, 2)]
         end associate
      end if
      points%side_nodes = slave%side_nodes
      points%edge = edge_lengths(mesh%coordinates(:, slave%nodes), slave%side_nodes, slave%closed)
      kept = [(k, k=first, last)]
      if (on_drawing) kept = pack(kept, norm2(master%tangent(:, kept), dim=1) > 0.0_dp)
      call keep_points(kept, points)
      ! 0 is the weight of a corner on the axis or at the tip of quarter points.
      if (.not. all(points%weight >= 0.0_dp)) then
         call set_error(error, status_deck, definition%title()//': no length of the face '// &
            'belongs to slave node '//to_text(mesh%node_number(points%slave(minloc( &
            points%weight, dim=1))))//'; its midside nodes are too far from the middle')
         return
      end if
      points%difference = differences(points%slave, points%master)
      points%slave_mean = single_values(points%slave)
      points%master_mean = single_values(points%master)
      points%face_node = [points%slave, points%master]
      points%at_face_nodes = single_values([(k, k=1, size(points%slave)), &
         (k, k=1, size(points%master))])
   end subroutine set_node_pairs

   !> Weights on the line midway between the faces. On three-node sides the integral vanishes for a
   !> corner on the axis but for the curvature of the side, and at the tip of quarter points but for
   !> the radius; what these leave goes to the neighbours.
   subroutine set_weights(mesh, slave, master, thickness, about_axis, weight)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(in) :: slave, master
      real(dp), intent(in) :: thickness
      logical, intent(in) :: about_axis
      real(dp), allocatable, intent(out) :: weight(:)
      real(dp) :: middle(2, size(slave%nodes))
      logical :: without(size(slave%nodes))
      integer :: k, n
      integer, allocatable :: beside(:)

      n = size(slave%nodes)
      middle = 0.5_dp*(mesh%coordinates(:, slave%nodes) + mesh%coordinates(:, master%nodes))
      without = at_tips(middle, slave%side_nodes, slave%closed)
      weight = tributary_areas(middle, slave%side_nodes, slave%closed, merge(0.0_dp, thickness, &
         about_axis))
      if (about_axis .and. slave%side_nodes == 3 .and. .not. slave%closed) then
         without(1) = without(1) .or. is_bare(1, 2)
         without(n) = without(n) .or. is_bare(n, n - 1)
      end if
      do k = 1, n
         if (.not. without(k)) cycle
         beside = modulo([k - 1, k + 1] - 1, n) + 1
         if (.not. slave%closed) beside = pack(beside, abs(beside - k) == 1)
         weight(beside) = weight(beside) + weight(k)/size(beside)
         weight(k) = 0.0_dp
      end do
   contains
      pure logical function is_bare(corner, neighbour)
         integer, intent(in) :: corner, neighbour

         is_bare = maxval(abs(mesh%coordinates(1, [slave%nodes(corner), master%nodes(corner)]))) &
            <= no_radius*maxval(abs(middle(1, :))) .and. &
            abs(weight(corner)) < weightless*abs(weight(neighbour))
      end function is_bare
   end subroutine set_weights

   !> Positions, arc length, common tangents and normals, and gaps. An unturned line has its body on
   !> the left.
   subroutine set_geometry(mesh, slave, master, points)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(in) :: slave, master
      type(contact_points_type), intent(inout) :: points
      real(dp) :: side
      integer :: k

      associate (x => mesh%coordinates, n => slave%side_nodes, closed => slave%closed)
         points%position = x(:, slave%nodes)
         points%arc_length = arc_lengths(points%position, n, closed)
         points%tangent = chain_tangents(points%position, n, closed)
         if (allocated(master%tangent)) then
            points%tangent = points%tangent + master%tangent
         else
            points%tangent = points%tangent + chain_tangents(x(:, master%nodes), n, closed)
         end if
         side = merge(-1.0_dp, 1.0_dp, slave%turned)
         allocate (points%normal, mold=points%tangent)
         do k = 1, size(slave%nodes)
            points%tangent(:, k) = points%tangent(:, k)/max(norm2(points%tangent(:, k)), &
               tiny(1.0_dp))
            points%normal(:, k) = side*[points%tangent(2, k), -points%tangent(1, k)]
         end do
         points%initial_gap = sum((x(:, master%nodes) - points%position)*points%normal, dim=1)
      end associate
   end subroutine set_geometry

   !> The contact points of one *CONTACT PAIR. Without PAIRING= they are node pairs where the
   !> lines of both surfaces have equally many nodes that lie opposite each other.
   !> Errors: surfaces that do not form lines or that do not fit; PAIRING=NODES on faces whose nodes
   !> are not opposite; faces of which none lies opposite the other surface.
   subroutine make_contact_points(mesh, definition, thickness, points, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition !! the *CONTACT PAIR
      real(dp), intent(in) :: thickness !! thickness of the slave, not used if axisymmetric [length]
      type(contact_points_type), intent(out) :: points
      type(error_type), allocatable, intent(out) :: error
      type(surface_chain_type), allocatable :: masters(:), slaves(:)
      logical :: in_set(size(mesh%node_number))

      associate (slave_surface => mesh%surfaces(definition%slave), &
         master_surface => mesh%surfaces(definition%master))
         call chain_faces(mesh, slave_surface, slaves, error)
         if (allocated(error)) return
         points%name = definition%name
         points%about_axis = mesh%element_plane(slave_surface%faces(1, 1)) == axisymmetric
         points%to_end = [huge(1.0_dp), huge(1.0_dp)]
         points%at_corner = [.false., .false.]
         if (allocated(master_surface%drawing)) then
            call set_rigid_points(mesh, definition, master_surface%drawing, slaves, thickness, &
               points, error)
         else
            call chain_faces(mesh, master_surface, masters, error)
            if (allocated(error)) return
            call find_points(mesh, definition, slaves, masters, thickness, points, error)
         end if
         if (allocated(error)) return
      end associate
      points%finest_gap = max(points%finest_gap, single*maxval(abs(mesh%coordinates)))
      where (abs(points%initial_gap) <= touching*maxval(abs(mesh%coordinates))) &
         points%initial_gap = 0.0_dp
      if (definition%adjusts .and. definition%adjusted_set == 0) then
         where (points%initial_gap <= definition%adjusted) points%initial_gap = 0.0_dp
      else if (definition%adjusts) then
         in_set = .false.
         in_set(mesh%node_sets(definition%adjusted_set)%members) = .true.
         where (in_set(points%slave)) points%initial_gap = 0.0_dp
      end if
      if (definition%has_clearance) points%initial_gap = definition%clearance
   end subroutine make_contact_points

   !> The contact points of a surface and the line of a rigid body: mortar points, or with
   !> PAIRING=NODES the slave's nodes and the points of the line that their normals meet.
   !> Errors: a line that shows its back to the slave; as find_points.
   subroutine set_rigid_points(mesh, definition, drawing, slaves, thickness, points, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition
      type(drawn_line_type), intent(in) :: drawing
      type(surface_chain_type), intent(in) :: slaves(:)       ! as from chain_faces
      real(dp), intent(in) :: thickness
      type(contact_points_type), intent(inout) :: points
      type(error_type), allocatable, intent(out) :: error
      type(contact_points_type) :: pieces(size(slaves))
      type(mesh_type) :: drawn
      type(surface_chain_type) :: master
      real(dp) :: ends(2, 2)
      integer :: i

      do i = 1, size(slaves)
         pieces(i) = points
         drawn = mesh
         call sampled_line(drawing, slaves(i), drawn, master)
         call align_chain(drawn, slaves(i), master)
         ends = drawn%coordinates(:, master%nodes([1, size(master%nodes)]))
         call check_facing(mesh, definition, drawing, slaves(i), error)
         if (allocated(error)) return
         if (definition%pairing == pairing_nodes) then
            drawn = mesh
            call opposite_line(drawing, slaves(i), points%about_axis, drawn, master)
            call set_node_pairs(drawn, definition, slaves(i), master, thickness, pieces(i), error)
            if (allocated(error)) return
         else
            call check_faces(drawn, definition, slaves(i), master, error)
            if (allocated(error)) return
            call set_mortar_points(drawn, slaves(i), master, others_of(slaves, i, [master], 1), &
               thickness, pieces(i))
         end if
         if (size(pieces(i)%slave) == 0) cycle
         if (.not. drawing%closed) call measure_ends(ends, pieces(i))
         if (.not. slaves(i)%closed) pieces(i)%at_corner = ends_alone(mesh, drawing, slaves(i), &
            pieces(i))
         call follow_reference(drawing, size(mesh%node_number), drawn%coordinates, pieces(i))
      end do
      call check_covered(drawn, definition, slaves(i - 1), master, sum([(size(pieces(i)%slave), &
         i=1, size(pieces))]), error)
      if (allocated(error)) return
      call join_pieces(mesh, definition, slaves, [(i, i=1, size(slaves))], pieces, points, error)
   end subroutine set_rigid_points

   !> The contact points of the lines of two surfaces.
   subroutine find_points(mesh, definition, slaves, masters, thickness, points, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition
      type(surface_chain_type), intent(in) :: slaves(:), masters(:)   ! as from chain_faces
      real(dp), intent(in) :: thickness
      type(contact_points_type), intent(inout) :: points
      type(error_type), allocatable, intent(out) :: error
      type(contact_points_type) :: pieces(size(slaves)*size(masters))
      type(surface_chain_type) :: master
      integer :: i, j, k

      do i = 1, size(slaves)
         do j = 1, size(masters)
            call check_shared(mesh, definition, slaves(i), aligned(i, j), error)
            if (allocated(error)) return
         end do
      end do
      if (definition%pairing /= pairing_surfaces) then
         call pair_lines(mesh, definition, slaves, masters, thickness, points, error)
         if (allocated(error) .or. allocated(points%slave)) return
      end if
      do k = 1, size(pieces)
         i = slave_of(k)
         j = k - (i - 1)*size(masters)
         master = aligned(i, j)
         call check_faces(mesh, definition, slaves(i), master, error)
         if (allocated(error)) return
         pieces(k) = points
         call set_mortar_points(mesh, slaves(i), master, others_of(slaves, i, masters, j), &
            thickness, pieces(k))
         call find_ends(mesh, master, pieces(k))
      end do
      call check_covered(mesh, definition, slaves(1), aligned(1, facing_chain(mesh, slaves(1), &
         masters)), sum([(size(pieces(k)%slave), k=1, size(pieces))]), error)
      if (allocated(error)) return
      call join_pieces(mesh, definition, slaves, [(slave_of(k), k=1, size(pieces))], pieces, &
         points, error)
   contains
      pure integer function slave_of(piece)
         integer, intent(in) :: piece

         slave_of = (piece - 1)/size(masters) + 1
      end function slave_of

      !> A line of the master, along one of the slave.
      function aligned(i, j) result(master)
         integer, intent(in) :: i, j
         type(surface_chain_type) :: master

         master = masters(j)
         call align_chain(mesh, slaves(i), master)
         if (definition%either_side) master%turned = .not. slaves(i)%turned
      end function aligned
   end subroutine find_points

   !> Node pairs of each line of the slave and the nearest of the master. Where some are not
   !> opposite, no contact points but why.
   !> Errors: as set_node_pairs; PAIRING=NODES where nodes are not opposite.
   subroutine pair_lines(mesh, definition, slaves, masters, thickness, points, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition
      type(surface_chain_type), intent(in) :: slaves(:), masters(:)   ! as from chain_faces
      real(dp), intent(in) :: thickness
      type(contact_points_type), intent(inout) :: points
      type(error_type), allocatable, intent(out) :: error
      type(contact_points_type) :: pieces(size(slaves))
      type(surface_chain_type) :: master
      character(:), allocatable :: advice, mismatch
      integer :: i

      do i = 1, size(slaves)
         pieces(i) = points
         master = masters(facing_chain(mesh, slaves(i), masters))
         call align_chain(mesh, slaves(i), master)
         if (definition%either_side) master%turned = .not. slaves(i)%turned
         call compare_lines(mesh, definition, slaves(i), master, mismatch, advice)
         if (len(mismatch) == 0) then
            call set_node_pairs(mesh, definition, slaves(i), master, thickness, pieces(i), error)
            if (allocated(error)) return
            if (definition%pairing /= pairing_nodes) mismatch = mismatch_of_pairs(mesh, pieces(i))
         end if
         if (len(mismatch) > 0 .and. size(masters) > 1) mismatch = mismatch//', on the nearest of '// &
            to_text(size(masters))//' lines of surface '//mesh%surfaces(definition%master)%name
         if (definition%pairing == pairing_nodes) then
            if (len(mismatch) > 0) then
               call set_error(error, status_deck, definition%title()//': '// &
                  mismatch//advice)
            else
               call check_opposite(mesh, pieces(i), error)
            end if
            if (allocated(error)) call blame_corner(mesh, definition, slaves(i), master, error)
            if (allocated(error)) return
         else if (len(mismatch) > 0) then
            points%mismatch = mismatch
            return
         end if
         call find_ends(mesh, master, pieces(i))
      end do
      call join_pieces(mesh, definition, slaves, [(i, i=1, size(slaves))], pieces, points, error)
   end subroutine pair_lines

   !> Refuses lines without contact points: they run back, or the slave's goes round a corner.
   subroutine check_faces(mesh, definition, slave, master, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition
      type(surface_chain_type), intent(in) :: slave, master
      type(error_type), allocatable, intent(out) :: error

      call check_folds(mesh, definition%title(), slave, error)
      if (allocated(error)) return
      call check_folds(mesh, definition%title(), master, error)
      if (allocated(error)) return
      call check_corner(mesh, definition, slave, error)
   end subroutine check_faces

   !> The lines beside two of them.
   pure function others_of(slaves, i, masters, j) result(others)
      type(surface_chain_type), intent(in) :: slaves(:), masters(:)
      integer, intent(in) :: i, j                             ! those of the piece
      type(other_chains_type) :: others
      integer :: k

      others%slaves = slaves([(k, k=1, i - 1), (k, k=i + 1, size(slaves))])
      others%masters = masters([(k, k=1, j - 1), (k, k=j + 1, size(masters))])
   end function others_of

   !> How far contact points lie from the ends of the master's body.
   subroutine find_ends(mesh, master, points)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(in) :: master          ! runs as the slave does
      type(contact_points_type), intent(inout) :: points
      integer :: k

      if (size(points%slave) == 0) return
      associate (ends => master%nodes([1, size(master%nodes)]))
         if (.not. master%closed) call measure_ends(mesh%coordinates(:, ends), points)
         where ([(body_angle(mesh, ends(k)) > going_on, k=1, 2)]) points%to_end = huge(1.0_dp)
      end associate
   end subroutine find_ends

   !> How far the first and the last contact point lie from the ends of an open master.
   pure subroutine measure_ends(ends, points)
      real(dp), intent(in) :: ends(2, 2)                      ! the first, the last one [length]
      type(contact_points_type), intent(inout) :: points

      associate (last => [1, size(points%slave)])
         points%to_end = max(0.0_dp, [1, -1]*sum(points%tangent(:, last)* &
            (points%position(:, last) - ends), dim=1))
      end associate
   end subroutine measure_ends

   !> Whether one of the slave's body and the drawing ends at the first, at the last node of the
   !> slave, and the other goes on.
   pure function ends_alone(mesh, drawing, slave, points) result(alone)
      type(mesh_type), intent(in) :: mesh
      type(drawn_line_type), intent(in) :: drawing
      type(surface_chain_type), intent(in) :: slave           ! open
      type(contact_points_type), intent(in) :: points         ! made
      logical :: alone(2)
      real(dp) :: at_end, beyond, foot(2), t
      integer :: k, node, piece

      do k = 1, 2
         node = slave%nodes(merge(1, size(slave%nodes), k == 1))
         call drawing%find_nearest(mesh%coordinates(:, node), piece, t, foot, beyond)
         at_end = small_offset*points%edge(merge(1, size(points%edge), k == 1))
         alone(k) = beyond > at_end .or. (drawing%goes_on(foot, at_end) .neqv. &
            body_angle(mesh, node) > going_on)
      end do
   end function ends_alone

   !> Angle that the elements at a corner fill.
   pure real(dp) function body_angle(mesh, node)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: node
      integer :: e, k

      body_angle = 0.0_dp
      do e = 1, size(mesh%element_number)
         associate (n => element_corner_count(mesh%element_kind(e)))
            k = findloc(mesh%element_nodes(:n, e), node, dim=1)
            if (k == 0) cycle
            associate (x => mesh%coordinates(:, mesh%element_nodes(:n, e)))
               associate (leaving => x(:, mod(k, n) + 1) - x(:, k), &
                  entering => x(:, mod(k + n - 2, n) + 1) - x(:, k))
                  body_angle = body_angle + atan2(leaving(1)*entering(2) - &
                     leaving(2)*entering(1), dot_product(leaving, entering))
               end associate
            end associate
         end associate
      end do
   end function body_angle

   !> The points of one *TIE. Those whose gap exceeds POSITION TOLERANCE= are left out.
   !> Errors: as make_contact_points; no point within the tolerance.
   subroutine make_tie_points(mesh, tie, thickness, points, error)
      type(mesh_type), intent(in) :: mesh
      type(tie_definition_type), intent(in) :: tie
      real(dp), intent(in) :: thickness !! thickness of the slave, not used if axisymmetric [length]
      type(contact_points_type), intent(out) :: points
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: nearest
      integer :: k

      call make_contact_points(mesh, tie%faces, thickness, points, error)
      if (allocated(error) .or. .not. tie%has_tolerance) return
      nearest = minval(abs(points%initial_gap))
      call keep_points(pack([(k, k=1, size(points%slave))], abs(points%initial_gap) <= &
         tie%tolerance + rounding*extent_of(mesh%coordinates)), points)
      if (size(points%slave) == 0) call set_error(error, status_deck, tie%faces%title()// &
         ': no point of the slave is within POSITION TOLERANCE='//to_text(tie%tolerance)// &
         ' of the master, the nearest one is '//to_text(nearest)//' from it', tie%faces%card)
   end subroutine make_tie_points

   !> Keeps some of the contact points.
   pure subroutine keep_points(kept, points)
      integer, intent(in) :: kept(:)
      type(contact_points_type), intent(inout) :: points
      type(sum_list_type) :: difference
      integer :: k

      points%slave = points%slave(kept)
      points%master = points%master(kept)
      points%position = points%position(:, kept)
      points%arc_length = points%arc_length(kept)
      points%weight = points%weight(kept)
      points%normal = points%normal(:, kept)
      points%tangent = points%tangent(:, kept)
      points%initial_gap = points%initial_gap(kept)
      points%edge = points%edge(kept)
      if (points%difference%count == 0) return
      call difference%reserve(size(kept), size(points%difference%value))
      do k = 1, size(kept)
         call difference%add(points%difference%values_of(kept(k)), &
            points%difference%coefficients_of(kept(k)))
      end do
      points%difference = difference
   end subroutine keep_points

end module contact_pairs
