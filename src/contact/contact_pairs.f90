!> The contact points of a *CONTACT PAIR: pairs of opposite nodes, as in the published method, where
!> its faces match, mortar points (mortar_points) where they do not, or what the deck asks for. The
!> points of a *TIE, whose relative displacements and jumps of temperature are zero, are made alike.
module contact_pairs
   use, intrinsic :: iso_fortran_env, only: real32
   use chain_geometry, only: edge_lengths
   use contact_definitions, only: contact_definition_type, pairing_nodes, pairing_surfaces, &
      tie_definition_type
   use contact_pieces, only: join_pieces
   use contact_points, only: contact_points_type, end_reach, small_offset
   use drawn_lines, only: drawn_line_type
   use element_kinds, only: axisymmetric
   use errors, only: error_type, set_error, status_deck
   use interface_checks, only: blame_corner, check_corner, check_covered, check_folds, &
      check_idle, check_opposite, check_shared, compare_lines
   use interface_warnings, only: mismatch_of_pairs
   use kinds, only: dp
   use mesh, only: extent_of, mesh_type
   use mortar_points, only: other_chains_type, set_mortar_points
   use node_to_side, only: set_nodes_on_sides
   use node_pairs, only: goes_on, keep_points, set_node_pairs
   use rigid_masters, only: check_facing, follow_reference, opposite_line, sampled_line
   use surface_chains, only: align_chain, chain_faces, facing_chain, surface_chain_type
   use text, only: to_text
   implicit none
   private
   public :: find_opposite_points, make_contact_points, make_tie_points, touching

   real(dp), parameter :: rounding = 1.0e-9_dp   !! relative, of coordinates
   !> Part of the largest coordinate within which faces touch. Coordinates written with 15 digits,
   !> the most that every double keeps, err by 5e-15 of it on either face.
   real(dp), parameter :: touching = 64*epsilon(1.0_dp)
   !> What coordinates in single precision leave between two faces, of the largest coordinate: half
   !> a unit in the last place along both axes of both.
   real(dp), parameter :: single = 2*epsilon(1.0_real32)

contains

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
      type(surface_chain_type), allocatable :: slaves(:)
      logical, allocatable :: in_set(:)
      real(dp) :: largest                                     ! coordinate [length]

      call chain_faces(mesh, mesh%surfaces(definition%slave), slaves, error)
      if (allocated(error)) return
      call find_opposite_points(mesh, definition, slaves, thickness, points, error)
      if (allocated(error)) return
      largest = maxval(abs(mesh%coordinates))
      points%finest_gap = max(points%finest_gap, single*largest)
      if (definition%adjusts .and. definition%adjusted_set == 0) then
         where (points%initial_gap <= definition%adjusted) points%initial_gap = 0.0_dp
      else if (definition%adjusts) then
         allocate (in_set(size(mesh%node_number)), source=.false.)
         in_set(mesh%node_sets(definition%adjusted_set)%members) = .true.
         where (in_set(points%slave)) points%initial_gap = 0.0_dp
      end if
      if (definition%has_clearance) points%initial_gap = definition%clearance
   end subroutine make_contact_points

   !> The contact points where lines of the slave lie opposite the master, on a mesh as it is or as
   !> it is displaced.
   !> Errors: as make_contact_points.
   subroutine find_opposite_points(mesh, definition, slaves, thickness, points, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition
      type(surface_chain_type), intent(in) :: slaves(:)       !! as from chain_faces
      real(dp), intent(in) :: thickness                       !! as above
      type(contact_points_type), intent(out) :: points
      type(error_type), allocatable, intent(out) :: error
      type(surface_chain_type), allocatable :: masters(:)

      associate (slave_surface => mesh%surfaces(definition%slave), &
         master_surface => mesh%surfaces(definition%master))
         points%name = definition%name
         points%about_axis = mesh%element_plane(slave_surface%faces(1, 1)) == axisymmetric
         points%follows_sliding = definition%follows_sliding
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
      end associate
      if (allocated(error) .or. .not. allocated(points%initial_gap)) return
      where (abs(points%initial_gap) <= touching*maxval(abs(mesh%coordinates))) points%initial_gap &
         = 0.0_dp
   end subroutine find_opposite_points

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
      integer :: covered, i

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
            call opposite_line(drawing, slaves(i), merge(end_reach, 0.0_dp, &
               points%follows_sliding)*edge_lengths(mesh%coordinates(:, slaves(i)%nodes), &
               slaves(i)%side_nodes, slaves(i)%closed), points%about_axis, drawn, master)
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
      covered = sum([(size(pieces(i)%slave), i=1, size(pieces))])
      if (definition%follows_sliding .and. covered == 0) return
      call check_covered(drawn, definition, slaves(size(slaves)), master, covered, error)
      if (allocated(error)) return
      call join_pieces(mesh, definition, slaves, [(i, i=1, size(slaves))], pieces, points, error)
      if (allocated(error) .or. definition%follows_sliding) return
      call check_idle(drawn, definition, slaves, [master], reshape([(size(pieces(i)%slave) > 0, &
         i=1, size(pieces))], [size(pieces), 1]), points%idle, error)
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
      integer :: covered, i, j, k

      do i = 1, size(slaves)
         do j = 1, size(masters)
            call check_shared(mesh, definition, slaves(i), aligned(mesh, definition, slaves(i), &
               masters(j)), error)
            if (allocated(error)) return
         end do
      end do
      if (definition%pairing /= pairing_surfaces .and. .not. definition%follows_sliding) then
         call pair_lines(mesh, definition, slaves, masters, thickness, points, error)
         if (allocated(error) .or. allocated(points%slave)) return
      end if
      do k = 1, size(pieces)
         i = slave_of(k)
         j = k - (i - 1)*size(masters)
         master = aligned(mesh, definition, slaves(i), masters(j))
         call check_faces(mesh, definition, slaves(i), master, error)
         if (allocated(error)) return
         pieces(k) = points
         if (definition%pairing == pairing_nodes) then
            call set_nodes_on_sides(mesh, definition, slaves(i), master, thickness, pieces(k), &
               error)
            if (allocated(error)) return
         else
            call set_mortar_points(mesh, slaves(i), master, others_of(slaves, i, masters, j), &
               thickness, pieces(k))
         end if
         call find_ends(mesh, master, pieces(k))
      end do
      covered = sum([(size(pieces(k)%slave), k=1, size(pieces))])
      if (definition%follows_sliding .and. covered == 0) return
      call check_covered(mesh, definition, slaves(1), aligned(mesh, definition, slaves(1), &
         masters(facing_chain(mesh, slaves(1), masters))), covered, error)
      if (allocated(error)) return
      call join_pieces(mesh, definition, slaves, [(slave_of(k), k=1, size(pieces))], pieces, &
         points, error)
      if (allocated(error) .or. definition%follows_sliding) return
      call check_idle(mesh, definition, slaves, masters, transpose(reshape([(size(pieces(k)%slave) &
         > 0, k=1, size(pieces))], [size(masters), size(slaves)])), points%idle, error)
   contains
      pure integer function slave_of(piece)
         integer, intent(in) :: piece

         slave_of = (piece - 1)/size(masters) + 1
      end function slave_of
   end subroutine find_points

   !> A line of the master, along one of the slave.
   function aligned(mesh, definition, slave, line) result(master)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition
      type(surface_chain_type), intent(in) :: slave, line
      type(surface_chain_type) :: master

      master = line
      call align_chain(mesh, slave, master)
      if (definition%either_side) master%turned = .not. slave%turned
   end function aligned

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
      logical :: meets(size(slaves), size(masters))
      integer :: i, j

      meets = .false.
      do i = 1, size(slaves)
         pieces(i) = points
         j = facing_chain(mesh, slaves(i), masters)
         meets(i, j) = .true.
         master = aligned(mesh, definition, slaves(i), masters(j))
         call compare_lines(mesh, definition, slaves(i), master, mismatch, advice)
         if (len(mismatch) == 0) then
            call set_node_pairs(mesh, definition, slaves(i), master, thickness, pieces(i), error)
            if (allocated(error)) return
            if (definition%pairing /= pairing_nodes) mismatch = mismatch_of_pairs(mesh, pieces(i))
         end if
         if (len(mismatch) > 0 .and. size(masters) > 1) then
            mismatch = mismatch//', on the nearest of '//to_text(size(masters))// &
               ' lines of surface '//mesh%surfaces(definition%master)%name
         end if
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
      if (allocated(error)) return
      call check_idle(mesh, definition, slaves, masters, meets, points%idle, error)
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
         where ([(goes_on(mesh, ends(k)), k=1, 2)]) points%to_end = huge(1.0_dp)
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
            goes_on(mesh, node))
      end do
   end function ends_alone

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

end module contact_pairs
