!> Contact points: geometry, normals and tributary areas, taken once from the undeformed mesh.
module contact_pairs
   use chain_geometry, only: arc_lengths, at_tips, chain_tangents, edge_lengths, &
      tributary_lengths, swept_areas
   use contact_definitions, only: contact_definition_type
   use element_kinds, only: axisymmetric
   use errors, only: error_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use interface_checks, only: blame_corner, check_lines, check_opposite, check_sides, check_weights
   use surface_chains, only: chain_faces, precedes, surface_chain_type
   implicit none
   private
   public :: contact_points_type, make_contact_points, never_approached, on_axis

   real(dp), parameter :: no_radius = 1.0e-9_dp  !! part of the largest radius that counts as 0
   real(dp), parameter :: weightless = 0.01_dp   !! part of its neighbour's weight below which the
   !! corner on the axis has none
   real(dp), parameter :: unmoved = 1.0e-9_dp    !! relative change of a gap that is rounding

   !> The contact points of one interface, ordered along the slave from the end with the smaller x
   !> (then y); on a closed face from the corner with the smallest x (then y), with the slave on the
   !> left.
   type :: contact_points_type
      character(:), allocatable :: name        !! name of the *CONTACT PAIR
      integer, allocatable :: slave_node(:)    !! (m) node indexes
      integer, allocatable :: master_node(:)   !! (m) node indexes
      real(dp), allocatable :: position(:, :)  !! (2, m) undeformed slave [length]
      real(dp), allocatable :: arc_length(:)   !! (m) s from the first contact point [length]
      !> (m) tributary length times thickness, axisymmetric times 2 pi r; 0 where three-node sides
      !> give the axis or the tip of quarter points none [length^2]
      real(dp), allocatable :: weight(:)
      real(dp), allocatable :: normal(:, :)    !! (2, m) common unit normal, outward from the slave
      real(dp), allocatable :: tangent(:, :)   !! (2, m) unit tangent towards growing s
      real(dp), allocatable :: initial_gap(:)  !! (m) h [length]
      real(dp), allocatable :: edge(:)         !! (m) longest side of the slave there [length]
      integer :: side_nodes = 2                !! nodes of a side, 2 or 3
      logical :: about_axis = .false.          !! whether the model is axisymmetric
   end type contact_points_type

contains

   !> The contact points of one *CONTACT PAIR: the k-th nodes along its two surfaces. A node that
   !> both surfaces end in, the tip of a crack, is no contact point.
   !> Errors: surfaces that do not form one line each or that do not fit, unequal numbers of nodes,
   !> nodes that are not opposite, bodies on the wrong side, sides without tributary length.
   subroutine make_contact_points(mesh, definition, thickness, points, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition !! the *CONTACT PAIR
      real(dp), intent(in) :: thickness !! thickness of the slave, not used if axisymmetric [length]
      type(contact_points_type), intent(out) :: points
      type(error_type), allocatable, intent(out) :: error
      type(surface_chain_type) :: slave, master
      logical :: turned_slave, turned_master
      integer :: first, last

      points%name = definition%name
      associate (slave_surface => mesh%surfaces(definition%slave), &
         master_surface => mesh%surfaces(definition%master))
         call chain_faces(mesh, slave_surface, slave, error)
         if (allocated(error)) return
         call chain_faces(mesh, master_surface, master, error)
         if (allocated(error)) return
         call align(mesh, slave, master, turned_slave, turned_master)
         call check_lines(mesh, definition, slave, master, error)
         if (allocated(error)) call blame_corner(mesh, definition, slave, master, error)
         if (allocated(error)) return
         points%slave_node = slave%nodes
         points%master_node = master%nodes
         points%about_axis = mesh%element_plane(slave_surface%faces(1, 1)) == axisymmetric
         call set_weights(mesh, slave, master, thickness, points%about_axis, points%weight)
      end associate
      first = 1
      last = size(slave%nodes)
      if (slave%nodes(1) == master%nodes(1)) first = 2
      if (slave%nodes(last) == master%nodes(last)) last = last - 1
      call set_geometry(mesh, slave, master, [turned_slave, turned_master], points)
      call check_sides(mesh, definition, slave, master, [turned_slave, turned_master], &
         [first, last], error)
      if (allocated(error)) return
      points%side_nodes = slave%side_nodes
      points%edge = edge_lengths(mesh%coordinates(:, slave%nodes), slave%side_nodes, slave%closed)
      call cut_ends(first, last, points)
      call check_weights(mesh, points%name, points%slave_node, points%weight, error)
      if (allocated(error)) return
      call check_opposite(mesh, points%name, points%slave_node, points%master_node, &
         points%tangent, max(points%edge, abs(points%initial_gap)), error)
      if (allocated(error)) call blame_corner(mesh, definition, slave, master, error)
      if (allocated(error)) return
      if (definition%has_clearance) points%initial_gap = definition%clearance
   end subroutine make_contact_points

   !> Whether a contact point neither closed nor came nearer than it was.
   elemental function never_approached(initial_gap, smallest_gap) result(never)
      real(dp), intent(in) :: initial_gap    !! h [length]
      real(dp), intent(in) :: smallest_gap   !! smallest gap of all increments [length]
      logical :: never                       !! to be reported

      never = smallest_gap > 0.0_dp .and. smallest_gap >= initial_gap*(1.0_dp - unmoved)
   end function never_approached

   !> Turns both lines to run from the slave's first contact point on: an open one if its ends so
   !> lie nearer to the slave's, a closed face of the master always, for it runs against the slave.
   subroutine align(mesh, slave, master, turned_slave, turned_master)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(inout) :: slave, master
      logical, intent(out) :: turned_slave, turned_master
      real(dp) :: distance(size(master%nodes))
      integer :: n, start

      turned_slave = .false.
      associate (x => mesh%coordinates)
         if (.not. slave%closed) then
            n = size(slave%nodes)
            associate (first => x(:, slave%nodes(1)), last => x(:, slave%nodes(n)))
               turned_slave = precedes(last, first, norm2(last - first))
            end associate
            if (turned_slave) slave%nodes = slave%nodes(n:1:-1)
         end if
         n = size(master%nodes)
         distance = norm2(x(:, master%nodes) - spread(x(:, slave%nodes(1)), 2, n), dim=1)
         if (master%closed) then
            start = 1 + (master%side_nodes - 1)*(minloc(distance(::master%side_nodes - 1), dim=1) &
               - 1)
            master%nodes = cshift(master%nodes, start - 1)
            master%nodes(2:) = master%nodes(n:2:-1)
            turned_master = .true.
         else
            ! Squares of these distances, less what they have in common: bodies may lie far apart.
            turned_master = dot_product(x(:, slave%nodes(size(slave%nodes))) - &
               x(:, slave%nodes(1)), x(:, master%nodes(n)) - x(:, master%nodes(1))) < 0.0_dp
            if (turned_master) master%nodes = master%nodes(n:1:-1)
         end if
      end associate
   end subroutine align

   !> Whether a contact point lies on the axis of an axisymmetric model.
   elemental logical function on_axis(points, k)
      type(contact_points_type), intent(in) :: points !! contact points of one interface
      integer, intent(in) :: k                       !! one of them

      on_axis = .false.
      if (points%about_axis) on_axis = abs(points%position(1, k)) <= &
         no_radius*maxval(abs(points%position(1, :)))
   end function on_axis

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
      if (about_axis) then
         weight = swept_areas(middle, slave%side_nodes, slave%closed)
         if (slave%side_nodes == 3 .and. .not. slave%closed) then
            without(1) = without(1) .or. is_bare(1, 2)
            without(n) = without(n) .or. is_bare(n, n - 1)
         end if
      else
         weight = thickness*tributary_lengths(middle, slave%side_nodes, slave%closed)
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
   subroutine set_geometry(mesh, slave, master, turned, points)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(in) :: slave, master
      logical, intent(in) :: turned(2)
      type(contact_points_type), intent(inout) :: points
      real(dp) :: side
      integer :: k

      associate (x => mesh%coordinates, n => slave%side_nodes, closed => slave%closed)
         points%position = x(:, slave%nodes)
         points%arc_length = arc_lengths(points%position, n, closed)
         points%tangent = chain_tangents(points%position, n, closed) + &
            chain_tangents(x(:, master%nodes), n, closed)
         side = merge(-1.0_dp, 1.0_dp, turned(1))
         allocate (points%normal, mold=points%tangent)
         do k = 1, size(slave%nodes)
            points%tangent(:, k) = points%tangent(:, k)/max(norm2(points%tangent(:, k)), &
               tiny(1.0_dp))
            points%normal(:, k) = side*[points%tangent(2, k), -points%tangent(1, k)]
         end do
         points%initial_gap = sum((x(:, master%nodes) - points%position)*points%normal, dim=1)
      end associate
   end subroutine set_geometry

   !> Keeps the contact points first..last; s begins there.
   pure subroutine cut_ends(first, last, points)
      integer, intent(in) :: first, last
      type(contact_points_type), intent(inout) :: points

      points%slave_node = points%slave_node(first:last)
      points%master_node = points%master_node(first:last)
      points%position = points%position(:, first:last)
      points%arc_length = points%arc_length(first:last) - points%arc_length(first)
      points%weight = points%weight(first:last)
      points%normal = points%normal(:, first:last)
      points%tangent = points%tangent(:, first:last)
      points%initial_gap = points%initial_gap(first:last)
      points%edge = points%edge(first:last)
   end subroutine cut_ends

end module contact_pairs
