!> Contact points of the slave's nodes and the points of the master's sides that their normals meet:
!> what node pairs become where faces slide. The master's point has the shape functions of its side;
!> the master's normal there is interpolated between those of its nodes, and so does not jump from
!> side to side. On sides that do not match a constant pressure comes out uneven; mortar points pass
!> it exactly.
module node_to_side
   use chain_geometry, only: arc_lengths, side_positions
   use contact_definitions, only: contact_definition_type
   use contact_points, only: contact_points_type, end_reach
   use errors, only: error_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use mortar_sides, only: face_line_type, line_of, opposite_at, outward_normals, project, &
      sides_of, slave_side_type
   use node_pairs, only: set_node_pairs
   use rigid_masters, only: add_points
   use shape_functions, only: side_shape
   use sum_lists, only: sum_list_type
   use surface_chains, only: surface_chain_type
   implicit none
   private
   public :: set_nodes_on_sides

   !> A point of the master's line.
   type :: foot_type
      integer, allocatable :: nodes(:)      !! of its side; unallocated where there is none
      real(dp), allocatable :: shape(:)     !! values of their shape functions
      real(dp) :: place(2) = 0.0_dp         !! [length]
      real(dp) :: tangent(2) = 0.0_dp       !! along the line; 0 where there is none
      real(dp) :: s = 0.0_dp                !! along the line [length]
   end type foot_type

contains

   !> The contact points of the nodes of a line that have a master opposite.
   !> Errors: as set_node_pairs.
   subroutine set_nodes_on_sides(mesh, definition, slave, master, thickness, points, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition !! the *CONTACT PAIR
      type(surface_chain_type), intent(in) :: slave, master   !! open; both run the same way
      real(dp), intent(in) :: thickness !! thickness of the slave, not used if axisymmetric [length]
      type(contact_points_type), intent(inout) :: points      !! its name and its axis are set
      type(error_type), allocatable, intent(out) :: error
      type(foot_type) :: foot(size(slave%nodes))
      type(mesh_type) :: drawn
      type(surface_chain_type) :: feet
      integer :: k
      integer, allocatable :: kept(:)

      call find_feet(mesh, slave, master, foot)
      kept = pack([(k, k=1, size(foot))], [(allocated(foot(k)%nodes), k=1, size(foot))])
      allocate (points%slave(0))
      if (size(kept) == 0) return
      drawn = mesh
      feet%side_nodes = slave%side_nodes
      feet%turned = .not. slave%turned
      feet%tangent = reshape([(foot(k)%tangent, k=1, size(foot))], [2, size(foot)])
      call add_points(reshape([(foot(k)%place, k=1, size(foot))], [2, size(foot)]), drawn, &
         feet%nodes)
      call set_node_pairs(drawn, definition, slave, feet, thickness, points, error)
      if (allocated(error)) return
      call take_shapes(mesh, master, foot, kept, points)
   end subroutine set_nodes_on_sides

   !> The points that the normals of the slave's nodes meet; the node's own place where they meet
   !> none.
   pure subroutine find_feet(mesh, slave, master, foot)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(in) :: slave, master
      type(foot_type), intent(inout) :: foot(:)
      type(face_line_type) :: line
      type(slave_side_type), allocatable :: side(:)
      real(dp) :: normal(2), normals(2, size(master%nodes)), s(size(master%nodes)), eta, xi
      integer :: i, k, opposite, q
      integer, allocatable :: facing(:)

      line = line_of(mesh, master)
      side = sides_of(line_of(mesh, slave), line)
      normals = outward_normals(line)
      s = arc_lengths(line%x, line%side_nodes, line%closed)
      do k = 1, size(foot)
         foot(k)%place = mesh%coordinates(:, slave%nodes(k))
      end do
      do i = 1, size(side)
         do q = 1, slave%side_nodes
            k = side(i)%nodes(q)
            if (allocated(foot(k)%nodes)) cycle
            xi = 2.0_dp*(q - 1)/(slave%side_nodes - 1) - 1.0_dp
            opposite = opposite_at(side(i), xi)
            ! Also one whose end its normal nearly meets.
            if (opposite == 0) opposite = opposite_at(side(i), max(xi - 2*end_reach, -1.0_dp))
            if (opposite == 0) opposite = opposite_at(side(i), min(xi + 2*end_reach, 1.0_dp))
            if (opposite == 0) cycle
            facing = side_positions(opposite, line%side_nodes, size(s))
            eta = 0.0_dp
            call project(side(i), xi, line%x(:, facing), eta)
            eta = min(max(eta, -1.0_dp), 1.0_dp)
            foot(k)%nodes = master%nodes(facing)
            foot(k)%shape = side_shape(line%side_nodes, eta)
            foot(k)%place = matmul(line%x(:, facing), foot(k)%shape)
            foot(k)%s = dot_product(s(facing), foot(k)%shape)
            normal = matmul(normals(:, facing), foot(k)%shape)
            foot(k)%tangent = line%outward*[-normal(2), normal(1)]/norm2(normal)
         end do
      end do
   end subroutine find_feet

   !> Gives contact points the nodes of the master's sides; its nodes have contact quantities
   !> between those of the contact points beside them.
   pure subroutine take_shapes(mesh, master, foot, kept, points)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(in) :: master
      type(foot_type), intent(in) :: foot(:)                  ! of each node
      integer, intent(in) :: kept(:)                          ! those of the contact points
      type(contact_points_type), intent(inout) :: points
      type(sum_list_type) :: difference, mean
      real(dp) :: along(size(kept)), s(size(master%nodes)), share
      integer :: i, k

      call difference%reserve(size(kept), 4*size(kept))
      call mean%reserve(size(kept), 3*size(kept))
      do k = 1, size(kept)
         associate (at => foot(kept(k)))
            call difference%add([points%slave(k), at%nodes], [1.0_dp, -at%shape])
            call mean%add(at%nodes, at%shape)
            points%master(k) = at%nodes(maxloc(at%shape, dim=1))
         end associate
      end do
      points%difference = difference
      points%master_mean = mean
      along = foot(kept)%s
      s = arc_lengths(mesh%coordinates(:, master%nodes), master%side_nodes, master%closed)
      points%face_node = [points%slave, master%nodes]
      call points%at_face_nodes%reserve(size(points%face_node), 2*size(points%face_node))
      do k = 1, size(kept)
         call points%at_face_nodes%add([k], [1.0_dp])
      end do
      do i = 1, size(s)
         k = count(along <= s(i))
         if (k == 0 .or. k == size(kept)) then
            call points%at_face_nodes%add([integer ::], [real(dp) ::])
         else
            share = (s(i) - along(k))/(along(k + 1) - along(k))
            call points%at_face_nodes%add([k, k + 1], [1.0_dp - share, share])
         end if
      end do
   end subroutine take_shapes

end module node_to_side
