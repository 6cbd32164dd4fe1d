!> The largest von Mises stress and temperature of each body: where they are on the mesh of a run,
!> and on one some of whose elements are divided. Stress counts in elements without singular
!> corners, and in the children of these.
module body_maxima
   use divided_mesh, only: divided_mesh_type
   use element_kinds, only: element_node_count
   use field_quantities, only: maxima, point_values
   use field_recovery, only: point_map_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use mesh_division, only: child_element
   use records, only: field_record_type
   use refinement, only: parents_of
   implicit none
   private
   public :: places_type, values_type, places_of, divided_places, divided_point, vertex_near, &
      largest_change, elements_about, of_stress, of_temperature

   integer, parameter :: of_stress = 1, of_temperature = 2   !! as in maxima

   !> Maxima of the bodies; point 0 where there is none.
   type :: places_type
      integer, allocatable :: point(:, :)        !! (maxima, bodies)
      real(dp), allocatable :: value(:, :)       !! (maxima, bodies)
   end type places_type

   !> Values of a quantity at the points of two meshes.
   type :: values_type
      real(dp), allocatable :: before(:), after(:)
   end type values_type

contains

   !> The maxima of fields.
   pure function places_of(mesh, points, fields, counts) result(found)
      type(mesh_type), intent(in) :: mesh
      type(point_map_type), intent(in) :: points          !! of stress
      type(field_record_type), intent(in) :: fields
      logical, intent(in) :: counts(:, :)                 !! (maxima, elements) those looked at
      type(places_type) :: found
      integer :: e, n

      allocate (found%point(size(maxima), mesh%body_count), source=0)
      allocate (found%value(size(maxima), mesh%body_count), source=-huge(1.0_dp))
      associate (stress => point_values('von_mises', fields, points%node))
         do e = 1, size(counts, 2)
            n = element_node_count(mesh%element_kind(e))
            associate (places => points%element_points(:n, e))
               if (size(stress) > 0 .and. counts(of_stress, e)) call take(of_stress, &
                  mesh%element_body(e), places, stress(places), found)
               if (counts(of_temperature, e)) call take(of_temperature, mesh%element_body(e), &
                  places, fields%temperature(points%node(places)), found)
            end associate
         end do
      end associate
   end function places_of

   !> Keeps the largest value at some points of a body where it exceeds what was found.
   pure subroutine take(q, body, places, values, found)
      integer, intent(in) :: q, body
      integer, intent(in) :: places(:)           ! (n) points
      real(dp), intent(in) :: values(:)          ! (n)
      type(places_type), intent(inout) :: found
      integer :: k

      k = maxloc(values, dim=1)
      if (values(k) <= found%value(q, body)) return
      found%value(q, body) = values(k)
      found%point(q, body) = places(k)
   end subroutine take

   !> The maxima where some elements are divided, of the children of those looked at.
   pure function divided_places(divided, counts) result(found)
      type(divided_mesh_type), intent(in) :: divided
      logical, intent(in) :: counts(:, :)                 !! (maxima, elements) before
      type(places_type) :: found

      found = places_of(divided%model%mesh, divided%points(), divided%fields, &
         counts(:, parents_of(divided%division)))
   end function divided_places

   !> The point of a divided mesh that a point is there.
   pure integer function divided_point(divided, mesh, points, point)
      type(divided_mesh_type), intent(in) :: divided
      type(mesh_type), intent(in) :: mesh                 !! before
      type(point_map_type), intent(in) :: points          !! before
      integer, intent(in) :: point
      integer, allocatable :: after(:)
      integer :: e

      divided_point = 0
      do e = 1, size(mesh%element_kind)
         if (all(points%element_points(:, e) /= point)) cycle
         after = points_after(divided, divided%points(), mesh, e)
         divided_point = after(findloc(points%element_points(:, e), point, dim=1))
         return
      end do
   end function divided_point

   !> The largest change of values at the nodes of the elements at a node.
   pure real(dp) function largest_change(divided, mesh, points, values, node) result(largest)
      type(divided_mesh_type), intent(in) :: divided
      type(mesh_type), intent(in) :: mesh                 !! before
      type(point_map_type), intent(in) :: points          !! before
      type(values_type), intent(in) :: values             !! at the points of both meshes
      integer, intent(in) :: node                         !! of the mesh before
      type(point_map_type) :: fine
      integer :: e, n

      fine = divided%points()
      largest = 0.0_dp
      do e = 1, size(mesh%element_kind)
         n = element_node_count(mesh%element_kind(e))
         if (all(mesh%element_nodes(:n, e) /= node)) cycle
         largest = max(largest, maxval(abs(values%after(points_after(divided, fine, mesh, e)) - &
            values%before(points%element_points(:n, e)))))
      end do
   end function largest_change

   !> The points of a divided mesh that those of an element are there: at the same nodes in its
   !> parts.
   pure function points_after(divided, fine, mesh, e) result(after)
      type(divided_mesh_type), intent(in) :: divided
      type(point_map_type), intent(in) :: fine            ! of the divided mesh
      type(mesh_type), intent(in) :: mesh                 ! before
      integer, intent(in) :: e
      integer :: after(element_node_count(mesh%element_kind(e)))
      integer :: child, k, part, place

      do child = 1, merge(4, 1, divided%is_divided(e))
         part = e
         if (divided%is_divided(e)) part = child_element(divided%division, e, child)
         do k = 1, size(after)
            place = findloc(divided%model%mesh%element_nodes(:, part), mesh%element_nodes(k, e), &
               dim=1)
            if (place > 0) after(k) = fine%element_points(place, part)
         end do
      end do
   end function points_after

   !> The largest value on the sides of the elements at a node by the parabola through both ends and
   !> the middle of each, which is new on sides of two nodes; -huge where none has its vertex
   !> within.
   pure real(dp) function vertex_near(divided, mesh, values, node) result(largest)
      type(divided_mesh_type), intent(in) :: divided
      type(mesh_type), intent(in) :: mesh                 !! before
      real(dp), intent(in) :: values(:)                   !! (nodes of the divided mesh and more)
      integer, intent(in) :: node                         !! of the mesh before
      logical :: is_near(size(mesh%node_number))
      integer :: e, middle, s
      real(dp) :: bend, slope

      is_near = .false.
      do e = 1, size(mesh%element_kind)
         associate (own => mesh%element_nodes(:element_node_count(mesh%element_kind(e)), e))
            if (any(own == node)) is_near(own) = .true.
         end associate
      end do
      largest = -huge(1.0_dp)
      associate (sides => divided%division%sides)
         do s = 1, sides%count
            if (.not. all(is_near(sides%ends([1, 3], s)))) cycle
            middle = merge(sides%ends(2, s), divided%division%between(1, s), sides%ends(2, s) > 0)
            if (middle == 0) cycle
            associate (a => values(sides%ends(1, s)), b => values(middle), c => &
               values(sides%ends(3, s)))
               slope = 0.5_dp*(c - a)
               bend = 0.5_dp*(a + c) - b
               if (2*abs(bend) > abs(slope)) largest = max(largest, b - slope**2/(4*bend))
            end associate
         end do
      end associate
   end function vertex_near

   !> The elements at some nodes, and in further layers those beside them.
   pure function elements_about(mesh, nodes, layers) result(is_near)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: nodes(:)
      integer, intent(in) :: layers
      logical :: is_near(size(mesh%element_kind))
      logical :: is_reached(size(mesh%node_number))
      integer :: e, layer

      is_reached = .false.
      is_reached(nodes) = .true.
      do layer = 1, layers
         do e = 1, size(is_near)
            associate (own => mesh%element_nodes(:element_node_count(mesh%element_kind(e)), e))
               is_near(e) = any(is_reached(own))
            end associate
         end do
         do e = 1, size(is_near)
            associate (own => mesh%element_nodes(:element_node_count(mesh%element_kind(e)), e))
               if (is_near(e)) is_reached(own) = .true.
            end associate
         end do
      end do
   end function elements_about

end module body_maxima
