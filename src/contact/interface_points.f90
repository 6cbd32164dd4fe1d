!> The contact points of an interface: node pairs where its faces match, mortar points where they do
!> not, or what the deck asks for.
module interface_points
   use contact_definitions, only: contact_definition_type, pairing_nodes, pairing_surfaces
   use contact_pairs, only: set_node_pairs
   use contact_points, only: contact_points_type
   use element_kinds, only: axisymmetric
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp
   use mesh, only: mesh_type
   use mortar_points, only: set_mortar_points
   use interface_checks, only: blame_corner, check_corner, check_covered, check_opposite, &
      check_shared, compare_lines
   use interface_warnings, only: mismatch_of_pairs
   use surface_chains, only: aligned_chains, chain_faces, surface_chain_type
   implicit none
   private
   public :: make_contact_points

contains

   !> The contact points of one *CONTACT PAIR. Without PAIRING= they are node pairs where the two
   !> lines have equally many nodes that lie opposite each other.
   !> Errors: surfaces that do not form one line each or that do not fit; PAIRING=NODES on faces
   !> whose nodes are not opposite; faces of which none lies opposite the other surface.
   subroutine make_contact_points(mesh, definition, thickness, points, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition !! the *CONTACT PAIR
      real(dp), intent(in) :: thickness !! thickness of the slave, not used if axisymmetric [length]
      type(contact_points_type), intent(out) :: points
      type(error_type), allocatable, intent(out) :: error
      type(surface_chain_type) :: slave, master

      associate (slave_surface => mesh%surfaces(definition%slave), &
         master_surface => mesh%surfaces(definition%master))
         call chain_faces(mesh, slave_surface, slave, error)
         if (allocated(error)) return
         call chain_faces(mesh, master_surface, master, error)
         if (allocated(error)) return
         call aligned_chains(mesh, slave, master)
         points%name = definition%name
         points%about_axis = mesh%element_plane(slave_surface%faces(1, 1)) == axisymmetric
      end associate
      call check_shared(mesh, definition, slave, master, error)
      if (allocated(error)) return
      call find_points(mesh, definition, slave, master, thickness, points, error)
      if (allocated(error)) return
      if (definition%adjusts) call close_gaps(mesh, definition, points)
      if (definition%has_clearance) points%initial_gap = definition%clearance
   end subroutine make_contact_points

   !> Contact points that start without a gap: those up to a distance, overlaps among them, or those
   !> whose slave nodes are in a set.
   pure subroutine close_gaps(mesh, definition, points)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition
      type(contact_points_type), intent(inout) :: points
      logical :: in_set(size(mesh%node_number))

      if (definition%adjusted_set == 0) then
         where (points%initial_gap <= definition%adjusted) points%initial_gap = 0.0_dp
      else
         in_set = .false.
         in_set(mesh%node_sets(definition%adjusted_set)%members) = .true.
         where (in_set(points%slave_node)) points%initial_gap = 0.0_dp
      end if
   end subroutine close_gaps

   !> The contact points of two lines that run the same way.
   subroutine find_points(mesh, definition, slave, master, thickness, points, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition
      type(surface_chain_type), intent(in) :: slave, master
      real(dp), intent(in) :: thickness
      type(contact_points_type), intent(inout) :: points
      type(error_type), allocatable, intent(out) :: error
      type(contact_points_type) :: found
      character(:), allocatable :: advice, mismatch

      if (definition%pairing /= pairing_surfaces) then
         found = points
         call compare_lines(mesh, definition, slave, master, mismatch, advice)
         if (len(mismatch) == 0) then
            call set_node_pairs(mesh, definition, slave, master, thickness, found, error)
            if (allocated(error)) return
            if (definition%pairing /= pairing_nodes) mismatch = mismatch_of_pairs(mesh, found)
         end if
         if (definition%pairing == pairing_nodes) then
            if (len(mismatch) > 0) then
               call set_error(error, status_deck, definition%title()//': '// &
                  mismatch//advice)
            else
               call check_opposite(mesh, found, error)
            end if
            if (allocated(error)) call blame_corner(mesh, definition, slave, master, error)
         end if
         if (allocated(error)) return
         if (len(mismatch) == 0) then
            points = found
            return
         end if
         points%mismatch = mismatch
      end if
      call check_corner(mesh, definition, slave, error)
      if (allocated(error)) return
      call set_mortar_points(mesh, slave, master, thickness, points)
      call check_covered(mesh, definition, slave, master, size(points%slave_node), error)
   end subroutine find_points

end module interface_points
