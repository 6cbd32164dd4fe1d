!> The largest von Mises stress, temperature and inelastic strains of each body: where they are on
!> the mesh of a run, and on one some of whose elements are divided. Stress and strains count in
!> elements without singular corners, and in the children of these.
module body_maxima
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use divided_mesh, only: divided_mesh_type
   use element_kinds, only: element_corner_count, element_node_count
   use field_quantities, only: maxima, point_values
   use field_recovery, only: point_map_type
   use kinds, only: dp
   use local_refinement, only: elements_about
   use mesh, only: mesh_type
   use mesh_division, only: child_element
   use model, only: model_type
   use records, only: field_record_type, increment_record_type
   use refinement, only: parents_of
   use simulation, only: simulation_type
   use singular_corners, only: find_singular_corners
   implicit none
   private
   public :: body_maxima_type

   !> Maxima of the bodies of a mesh.
   type :: body_maxima_type
      !> (maxima, bodies) where there is none -huge, of strains 0
      real(dp), allocatable :: value(:, :)
      integer, allocatable :: node(:, :)         !! (maxima, bodies) likewise 0
      logical, allocatable :: counts(:, :)       !! (maxima, elements) those looked at
      logical, allocatable :: is_singular(:)     !! (nodes)
   contains
      procedure :: find
      procedure :: changes
      procedure :: larger_corners
   end type body_maxima_type

contains

   !> Finds the maxima of an increment.
   subroutine find(self, model, simulation, record)
      class(body_maxima_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation        !! the run at its end
      type(increment_record_type), intent(in) :: record      !! with its fields
      logical :: is_sound(size(model%mesh%element_kind))
      integer :: i, q

      allocate (self%is_singular(size(model%mesh%node_number)), source=.false.)
      is_sound = .false.
      if (allocated(record%fields%stress)) then
         call find_singular_corners(model, simulation, record, self%is_singular)
         is_sound = .not. elements_about(model%mesh, &
            pack([(i, i=1, size(self%is_singular))], self%is_singular))
      end if
      allocate (self%counts(size(maxima), size(is_sound)))
      do q = 1, size(maxima)
         self%counts(q, :) = merge(allocated(record%fields%reaction_heat), is_sound, &
            maxima(q)%unit == 'temperature')
      end do
      call find_places(self, model%mesh, simulation%recovery%points, record%fields)
   end subroutine find

   !> The changes of the maxima on a divided mesh: the rms of those of the fields at the nodes of
   !> the elements round them, for at one node they may vanish by chance, and what the fields rise
   !> above them there, between nodes as well; NaN of stress of an earlier step.
   function changes(self, divided, mesh, points, fields) result(change)
      class(body_maxima_type), intent(in) :: self
      type(divided_mesh_type), intent(in) :: divided         !! solved
      type(mesh_type), intent(in) :: mesh                    !! before
      type(point_map_type), intent(in) :: points             !! of stress, before
      type(field_record_type), intent(in) :: fields          !! before
      real(dp) :: change(size(self%value, 1), size(self%value, 2))   !! (maxima, bodies)
      logical :: is_near(size(mesh%element_kind))
      type(point_map_type) :: fine
      real(dp), allocatable :: before(:), after(:)
      integer :: b, e, n, q

      fine = divided%run%recovery%points
      change = 0.0_dp
      do q = 1, size(maxima)
         before = point_values(trim(maxima(q)%name), fields, points%node)
         after = point_values(trim(maxima(q)%name), divided%record%fields, fine%node)
         do b = 1, size(change, 2)
            if (self%node(q, b) == 0) cycle
            if (size(after) == 0) then
               change(q, b) = ieee_value(1.0_dp, ieee_quiet_nan)
               cycle
            end if
            is_near = self%counts(q, :) .and. mesh%element_body == b .and. &
               elements_about(mesh, self%node(q:q, b))
            do e = 1, size(is_near)
               if (.not. is_near(e)) cycle
               n = element_node_count(mesh%element_kind(e))
               change(q, b) = change(q, b) + sum((after(points_after(divided, fine, mesh, &
                  e)) - before(points%element_points(:n, e)))**2)/n
            end do
            change(q, b) = sqrt(change(q, b)/max(1, count(is_near)))
            change(q, b) = max(change(q, b), largest_of(divided%model%mesh, fine, after, &
               is_near(parents_of(divided%division))) - self%value(q, b))
         end do
      end do
   end function changes

   !> The points of a divided mesh that those of an element are there: at the same nodes in its
   !> parts.
   pure function points_after(divided, fine, mesh, e) result(after)
      type(divided_mesh_type), intent(in) :: divided
      type(point_map_type), intent(in) :: fine            ! of the divided mesh
      type(mesh_type), intent(in) :: mesh                 ! before
      integer, intent(in) :: e
      integer :: after(element_node_count(mesh%element_kind(e)))
      integer :: child, k, part, place

      do child = 1, merge(4, 1, divided%division%rank(e) > 0)
         part = child_element(divided%division, e, child)
         do k = 1, size(after)
            place = findloc(divided%model%mesh%element_nodes(:, part), mesh%element_nodes(k, e), &
               dim=1)
            if (place > 0) after(k) = fine%element_points(place, part)
         end do
      end do
   end function points_after

   !> The largest value at the nodes of some elements and, on their sides of three nodes, between
   !> these: by the parabola through them.
   pure real(dp) function largest_of(mesh, points, values, counts) result(largest)
      type(mesh_type), intent(in) :: mesh
      type(point_map_type), intent(in) :: points
      real(dp), intent(in) :: values(:)                   ! (points)
      logical, intent(in) :: counts(:)                    ! (elements)
      real(dp) :: bend, slope
      integer :: corners, e, k, n

      largest = -huge(largest)
      do e = 1, size(counts)
         if (.not. counts(e)) cycle
         n = element_node_count(mesh%element_kind(e))
         corners = element_corner_count(mesh%element_kind(e))
         associate (v => values(points%element_points(:n, e)))
            largest = max(largest, maxval(v))
            do k = 1, merge(corners, 0, n > corners)
               slope = 0.5_dp*(v(modulo(k, corners) + 1) - v(k))
               bend = 0.5_dp*(v(k) + v(modulo(k, corners) + 1)) - v(corners + k)
               if (-2*bend > abs(slope)) largest = max(largest, v(corners + k) - &
                  slope**2/(4*bend))
            end do
         end associate
      end do
   end function largest_of

   !> Singular corners in one of whose elements stress or a strain is at least the body's largest
   !> elsewhere.
   pure function larger_corners(self, mesh, points, fields) result(is_larger)
      class(body_maxima_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      type(point_map_type), intent(in) :: points
      type(field_record_type), intent(in) :: fields
      logical :: is_larger(size(self%is_singular))           !! (nodes)
      real(dp), allocatable :: values(:)
      real(dp) :: largest
      integer :: e, n, q

      is_larger = .false.
      if (.not. any(self%is_singular)) return
      do q = 1, size(maxima)
         if (maxima(q)%unit == 'temperature') cycle
         values = point_values(trim(maxima(q)%name), fields, points%node)
         if (size(values) == 0) cycle
         do e = 1, size(mesh%element_kind)
            n = element_node_count(mesh%element_kind(e))
            largest = maxval(values(points%element_points(:n, e)))
            if (largest <= 0.0_dp .or. largest < self%value(q, mesh%element_body(e))) cycle
            is_larger(mesh%element_nodes(:n, e)) = .true.
         end do
      end do
      is_larger = is_larger .and. self%is_singular
   end function larger_corners

   !> The maxima of fields.
   pure subroutine find_places(self, mesh, points, fields)
      class(body_maxima_type), intent(inout) :: self      ! with those looked at
      type(mesh_type), intent(in) :: mesh
      type(point_map_type), intent(in) :: points          ! of stress
      type(field_record_type), intent(in) :: fields
      real(dp), allocatable :: values(:)
      integer :: e, k, n, q

      allocate (self%node(size(maxima), mesh%body_count), source=0)
      allocate (self%value(size(maxima), mesh%body_count))
      do q = 1, size(maxima)
         self%value(q, :) = merge(0.0_dp, -huge(1.0_dp), maxima(q)%unit == '-')
         values = point_values(trim(maxima(q)%name), fields, points%node)
         do e = 1, merge(size(self%counts, 2), 0, size(values) > 0)
            if (.not. self%counts(q, e)) cycle
            n = element_node_count(mesh%element_kind(e))
            associate (places => points%element_points(:n, e))
               k = places(maxloc(values(places), dim=1))
            end associate
            associate (b => mesh%element_body(e))
               if (values(k) <= self%value(q, b)) cycle
               self%value(q, b) = values(k)
               self%node(q, b) = points%node(k)
            end associate
         end do
      end do
   end subroutine find_places

end module body_maxima
