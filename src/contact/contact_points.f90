!> The contact points of one interface: geometry, normals and tributary areas, taken once from the
!> undeformed mesh. A contact point is two opposite nodes (contact_pairs) or a corner of the slave
!> face with its hat function (mortar_points).
module contact_points
   use contact_definitions, only: pairing_nodes
   use mortar_segments, only: hat_geometry_type
   use kinds, only: dp
   use sum_lists, only: sum_list_type
   implicit none
   private
   public :: contact_row_type, contact_points_type, end_reach, ends_of_pieces, join_rows, &
      never_approached, no_radius, on_axis, small_offset

   real(dp), parameter :: no_radius = 1.0e-9_dp  !! part of the largest radius that counts as 0
   real(dp), parameter :: unmoved = 1.0e-9_dp    !! relative change of a gap that is rounding

   !> Contact points in a row: what the solution asks of them.
   type :: contact_row_type
      integer, allocatable :: slave(:)         !! (m) node indexes
      integer, allocatable :: master(:)        !! (m) the one opposite, or the nearest one
      !> (m, nodes) slave's value of a field less master's
      type(sum_list_type) :: difference = sum_list_type()
      !> (m, nodes) the same of displacements where the normal turns along the face of a contact
      !> point: displacements turned back by the angle a from its own normal, cos a and sin a of the
      !> means; without terms where no normal turns
      type(sum_list_type) :: along = sum_list_type(), across = sum_list_type()
      !> (m) tributary length times thickness, axisymmetric times 2 pi r; 0 where three-node sides
      !> give the axis or the tip of quarter points none [length^2]
      real(dp), allocatable :: weight(:)
      real(dp), allocatable :: normal(:, :)    !! (2, m) common unit normal, outward from the slave
      real(dp), allocatable :: tangent(:, :)   !! (2, m) unit tangent towards growing s
      real(dp), allocatable :: initial_gap(:)  !! (m) h [length]
      !> (m) whether no master is opposite; unallocated where all have one
      logical, allocatable :: is_beyond(:)
   contains
      procedure :: part
      procedure :: turns
      procedure :: jumps
      procedure :: relative
      procedure :: add_forces
      procedure :: nodes_of
      procedure :: means_of
      procedure :: references
   end type contact_row_type

   !> The contact points of one interface, ordered along the slave from the end with the smaller x
   !> (then y); on a closed face from the corner with the smallest x (then y), with the slave on the
   !> left. Where its surfaces consist of several lines, those between one line of each are a piece;
   !> pieces follow each other in the order of the slave's lines, and along these.
   type, extends(contact_row_type) :: contact_points_type
      character(:), allocatable :: name        !! name of the *CONTACT PAIR
      integer :: pairing = pairing_nodes       !! pairing_nodes or pairing_surfaces
      character(:), allocatable :: mismatch    !! why the faces do not match; unallocated if they do
      type(sum_list_type) :: slave_mean        !! (m, nodes) slave's value of a field
      type(sum_list_type) :: master_mean       !! (m, nodes) master's
      integer, allocatable :: face_node(:)     !! (n) nodes of both faces in the covered part
      !> (n, m) their contact quantities, interpolated between the contact points
      type(sum_list_type) :: at_face_nodes
      real(dp), allocatable :: position(:, :)  !! (2, m) undeformed slave [length]
      !> (m) s from the first contact point; from a line of the slave to the next one straight on
      !> [length]
      real(dp), allocatable :: arc_length(:)
      !> Contact points that are the last of their pieces, but for the last piece; unallocated where
      !> there is one piece
      integer, allocatable :: cuts(:)
      real(dp), allocatable :: edge(:)         !! (m) longest side of the slave there [length]
      character(:), allocatable :: idle        !! lines that take no part; unallocated without one
      integer :: side_nodes = 2                !! contact points of a side, 2 or 3
      integer :: node_spacings = 1             !! of the slave, from a contact point to the next
      !> (corners of the slave) whether no master is opposite; unallocated for node pairs
      logical, allocatable :: is_open_corner(:)
      !> (2 pieces) how far the first contact point of each piece lies from where the master's body
      !> ends, and the last one, along the slave, at least 0; large where the body goes on [length]
      real(dp), allocatable :: to_end(:)
      !> (2 pieces) whether one face ends at the first, at the last contact point of each piece and
      !> the other goes on
      logical, allocatable :: at_corner(:)
      type(hat_geometry_type) :: mortar        !! of mortar points; empty for node pairs
      !> Gap that the mesh cannot tell from none: that of mortar points between chords of one curve,
      !> or of coordinates of single precision, as those of 7 to 9 digits [length]
      real(dp) :: finest_gap = 0.0_dp
      logical :: about_axis = .false.          !! whether the model is axisymmetric
      !> Whether the master is a rigid surface: the master nodes are its reference node
      logical :: is_rigid = .false.
      !> Whether they lie on displaced faces (sliding_faces)
      logical :: follows_sliding = .false.
   contains
      procedure :: ends
      procedure :: on_one_piece
      procedure :: beside
      procedure :: length
   end type contact_points_type

   !> Part of the node spacing by which nodes may lie beside each other. An offset misplaces the
   !> force of a node pair, as lumping does: where the pressure varies by half of its mean from node
   !> to node, the resultant over a tributary length lies 1/24 of the spacing beside the node.
   !> Smaller offsets are no coarser than the mesh itself, and far larger ones than those of rounded
   !> coordinates.
   real(dp), parameter :: small_offset = 0.05_dp
   !> Part of its side by which the normal of a slave's node that follows sliding may miss the end
   !> of the master. Where both faces end, what crosses at the node tilts its normal: were it open
   !> for that, it would be so in every other solution.
   real(dp), parameter :: end_reach = 0.01_dp

contains

   !> Whether a contact point neither closed nor came nearer than it was.
   elemental function never_approached(initial_gap, smallest_gap) result(never)
      real(dp), intent(in) :: initial_gap    !! h [length]
      real(dp), intent(in) :: smallest_gap   !! smallest gap of all increments [length]
      logical :: never                       !! to be reported

      never = smallest_gap > 0.0_dp .and. smallest_gap >= initial_gap*(1.0_dp - unmoved)
   end function never_approached

   !> Puts rows one behind the other.
   pure subroutine join_rows(rows, row)
      type(contact_row_type), intent(in) :: rows(:)
      class(contact_row_type), intent(inout) :: row
      integer :: i, k

      row%slave = [(rows(i)%slave, i=1, size(rows))]
      row%master = [(rows(i)%master, i=1, size(rows))]
      row%weight = [(rows(i)%weight, i=1, size(rows))]
      row%initial_gap = [(rows(i)%initial_gap, i=1, size(rows))]
      row%normal = reshape([(rows(i)%normal, i=1, size(rows))], [2, size(row%slave)])
      row%tangent = reshape([(rows(i)%tangent, i=1, size(rows))], [2, size(row%slave)])
      call row%difference%reserve(size(row%slave), 2*size(row%slave))
      do i = 1, size(rows)
         call row%difference%add_sums(rows(i)%difference)
      end do
      if (allocated(row%is_beyond)) deallocate (row%is_beyond)
      do i = 1, size(rows)
         if (.not. allocated(rows(i)%is_beyond)) cycle
         if (.not. allocated(row%is_beyond)) allocate (row%is_beyond(size(row%slave)), &
            source=.false.)
         associate (before => sum([(size(rows(k)%slave), k=1, i - 1)]))
            row%is_beyond(before + 1:before + size(rows(i)%slave)) = rows(i)%is_beyond
         end associate
      end do
      row%along = sum_list_type()
      row%across = sum_list_type()
      if (.not. any([(rows(i)%turns(), i=1, size(rows))])) return
      call row%along%reserve(size(row%slave), 2*size(row%slave))
      call row%across%reserve(size(row%slave), 2*size(row%slave))
      do i = 1, size(rows)
         if (rows(i)%turns()) then
            call row%along%add_sums(rows(i)%along)
            call row%across%add_sums(rows(i)%across)
            cycle
         end if
         call row%along%add_sums(rows(i)%difference)
         do k = 1, size(rows(i)%slave)
            call row%across%add([integer ::], [real(dp) ::])
         end do
      end do
   end subroutine join_rows

   !> First and last contact point of each piece.
   pure function ends(self)
      class(contact_points_type), intent(in) :: self
      integer, allocatable :: ends(:)              !! (2 pieces)

      ends = ends_of_pieces(size(self%arc_length), self%cuts)
   end function ends

   !> First and last of some contact points in each piece.
   pure function ends_of_pieces(points, cuts) result(ends)
      integer, intent(in) :: points                !! how many there are
      integer, intent(in), optional :: cuts(:)     !! those behind which another piece begins
      integer, allocatable :: ends(:)              !! (2 pieces)
      integer :: i

      ends = [1, points]
      if (present(cuts)) ends = [1, (cuts(i), cuts(i) + 1, i=1, size(cuts)), points]
   end function ends_of_pieces

   !> Whether two contact points are on one piece; false for a number that is that of none.
   pure logical function on_one_piece(self, k, other)
      class(contact_points_type), intent(in) :: self
      integer, intent(in) :: k                     !! a contact point
      integer, intent(in) :: other                 !! may be out of range

      on_one_piece = other >= 1 .and. other <= size(self%arc_length)
      if (on_one_piece .and. allocated(self%cuts)) on_one_piece = .not. any(self%cuts >= &
         min(k, other) .and. self%cuts < max(k, other))
   end function on_one_piece

   !> The contact points beside one, on its piece.
   pure function beside(self, k)
      class(contact_points_type), intent(in) :: self
      integer, intent(in) :: k                     !! a contact point
      integer, allocatable :: beside(:)            !! none to two, ascending

      beside = pack([k - 1, k + 1], [self%on_one_piece(k, k - 1), self%on_one_piece(k, k + 1)])
   end function beside

   !> Length of all pieces, each from its first to its last contact point [length].
   pure real(dp) function length(self)
      class(contact_points_type), intent(in) :: self
      real(dp), allocatable :: s(:)

      s = self%arc_length(self%ends())
      length = sum(s(2::2) - s(1::2))
   end function length

   !> Whether a contact point lies on the axis of an axisymmetric model.
   elemental logical function on_axis(points, k)
      type(contact_points_type), intent(in) :: points !! contact points of one interface
      integer, intent(in) :: k                       !! one of them

      on_axis = .false.
      if (points%about_axis) on_axis = abs(points%position(1, k)) <= &
         no_radius*maxval(abs(points%position(1, :)))
   end function on_axis

   !> Some contact points of a row, without the sums of nodal values.
   pure function part(self, first, last) result(points)
      class(contact_row_type), intent(in) :: self
      integer, intent(in) :: first, last           !! the first and the last of them
      type(contact_row_type) :: points

      points%slave = self%slave(first:last)
      points%master = self%master(first:last)
      points%weight = self%weight(first:last)
      points%normal = self%normal(:, first:last)
      points%tangent = self%tangent(:, first:last)
      points%initial_gap = self%initial_gap(first:last)
      if (allocated(self%is_beyond)) points%is_beyond = self%is_beyond(first:last)
   end function part

   !> Whether the normal turns along the face of some contact point.
   pure logical function turns(self)
      class(contact_row_type), intent(in) :: self

      turns = allocated(self%across%start)
   end function turns

   !> Slave's value less master's of a field, at every contact point.
   pure function jumps(self, field)
      class(contact_row_type), intent(in) :: self
      real(dp), intent(in) :: field(:)             !! (nodes)
      real(dp) :: jumps(size(self%slave))          !! (m)

      jumps = 0.0_dp
      call self%difference%add_totals(field, jumps)
   end function jumps

   !> Slave's displacement less master's, at every contact point, in the directions of its normal:
   !> the mean of displacements that are turned with the face.
   pure function relative(self, displacement)
      class(contact_row_type), intent(in) :: self
      real(dp), intent(in) :: displacement(:)      !! (2 nodes) [length]
      real(dp) :: relative(2, size(self%slave))    !! (2, m) [length]
      real(dp) :: across(2, size(self%slave))

      relative(1, :) = self%jumps(displacement(1::2))
      relative(2, :) = self%jumps(displacement(2::2))
      if (.not. self%turns()) return
      relative = 0.0_dp
      across = 0.0_dp
      call self%along%add_totals(displacement(1::2), relative(1, :))
      call self%along%add_totals(displacement(2::2), relative(2, :))
      call self%across%add_totals(displacement(1::2), across(1, :))
      call self%across%add_totals(displacement(2::2), across(2, :))
      relative = relative + reshape([across(2, :), -across(1, :)], shape(across), order=[2, 1])
   end function relative

   !> Adds the nodal forces of forces on the slave at the contact points, and of their opposites on
   !> the master.
   pure subroutine add_forces(self, on_slave, forces)
      class(contact_row_type), intent(in) :: self
      real(dp), intent(in) :: on_slave(:, :)       !! (2, m) [force]
      real(dp), intent(inout) :: forces(:)         !! (2 nodes) [force]

      if (.not. self%turns()) then
         call self%difference%add_shares(on_slave(1, :), forces(1::2))
         call self%difference%add_shares(on_slave(2, :), forces(2::2))
         return
      end if
      call self%along%add_shares(on_slave(1, :), forces(1::2))
      call self%along%add_shares(on_slave(2, :), forces(2::2))
      call self%across%add_shares(on_slave(1, :), forces(2::2))
      call self%across%add_shares(-on_slave(2, :), forces(1::2))
   end subroutine add_forces

   !> The nodes whose values a contact point takes.
   pure function nodes_of(self, k) result(nodes)
      class(contact_row_type), intent(in) :: self
      integer, intent(in) :: k                     !! a contact point
      integer, allocatable :: nodes(:)

      nodes = self%difference%values_of(k)
   end function nodes_of

   !> Nodes of no body whose displacements contact points take: those by which rigid bodies move.
   pure function references(self, of_no_body)
      class(contact_row_type), intent(in) :: self
      logical, intent(in) :: of_no_body(:)         !! (nodes)
      integer, allocatable :: references(:)        !! each once
      logical :: taken(size(of_no_body))
      integer :: i

      taken = .false.
      if (self%turns()) then
         taken(self%along%value(:self%along%start(self%along%count + 1) - 1)) = .true.
         taken(self%across%value(:self%across%start(self%across%count + 1) - 1)) = .true.
      end if
      references = pack([(i, i=1, size(taken))], taken .and. of_no_body)
   end function references

   !> Coefficients of nodal displacements in a contact point: slave's less master's along an axis
   !> are along.u of that axis, and across.u of the other one, added for x and subtracted for y.
   pure subroutine means_of(self, k, nodes, along, across)
      class(contact_row_type), intent(in) :: self
      integer, intent(in) :: k                     !! a contact point
      integer, allocatable, intent(out) :: nodes(:)   !! (n) each once
      real(dp), allocatable, intent(out) :: along(:)  !! (n)
      real(dp), allocatable, intent(out) :: across(:) !! (n) zero where no normal turns
      integer :: i

      if (.not. self%turns()) then
         nodes = self%nodes_of(k)
         along = self%difference%coefficients_of(k)
         across = 0.0_dp*along
         return
      end if
      associate (a => self%along, b => self%across)
         associate (straight => a%value(a%start(k):a%start(k + 1) - 1), &
            turned => b%value(b%start(k):b%start(k + 1) - 1))
            nodes = [straight, pack(turned, [(all(straight /= turned(i)), i=1, size(turned))])]
            allocate (along(size(nodes)), across(size(nodes)), source=0.0_dp)
            along(:size(straight)) = a%coefficient(a%start(k):a%start(k + 1) - 1)
            do i = 1, size(turned)
               across(findloc(nodes, turned(i), dim=1)) = b%coefficient(b%start(k) - 1 + i)
            end do
         end associate
      end associate
   end subroutine means_of

end module contact_points
