!> The largest von Mises stress, temperature and inelastic strains of each body: where they are on
!> the mesh of a run, and on one some of whose elements are divided. Stress and strains count in
!> elements without singular corners, and in the children of these.
!>
!> Singular corners are those at which the stress of the exact solution may have no limit: reentrant
!> ones, those where a support ends, where materials meet on the outline, where a contact or a tie
!> ends, and nodes with a force of their own. Between two straight sides the stress varies as a
!> power of the distance that is negative where the angle exceeds one that the supports of both
!> sides give (M. L. Williams, J. Appl. Mech. 19 (1952) 526-528).
module body_maxima
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use contact_points, only: contact_points_type
   use contact_system, only: contact_open
   use divided_mesh, only: divided_mesh_type
   use element_kinds, only: element_corner_count, element_node_count
   use element_sides, only: element_sides_type, find_sides, side_ends
   use equations, only: coupled_nodes, equation_type
   use field_quantities, only: maxima, point_values
   use field_recovery, only: point_map_type
   use kinds, only: dp
   use local_refinement, only: coarse_side, elements_about, fine_sides, hanging_count
   use mesh, only: mesh_type
   use mesh_division, only: child_element
   use model, only: model_type
   use records, only: field_record_type, increment_record_type
   use refinement, only: parents_of
   use simulation, only: simulation_type
   implicit none
   private
   public :: body_maxima_type

   real(dp), parameter :: degree = acos(-1.0_dp)/180
   !> Angles from which stress has no limit, by the directions that are held on both sides of the
   !> corner: with both on one side and none on the other 62 degrees for nu = 0.3.
   real(dp), parameter :: without_change = 180*degree, held_on_one = 90*degree, &
      clamped_on_one = 70*degree
   !> Angle that straight sides of elements may add where they follow a curve, curved ones.
   real(dp), parameter :: of_chords = 30*degree, of_curves = 10*degree
   real(dp), parameter :: no_force = 1.0e-6_dp   !! of the largest nodal force: none
   real(dp), parameter :: rounding = 1.0e-10_dp  !! part of the largest value

   !> Maxima of the bodies of a mesh.
   type :: body_maxima_type
      !> (maxima, bodies) NaN where there is none, as of strains that are nowhere above 0
      real(dp), allocatable :: value(:, :)
      integer, allocatable :: node(:, :)         !! (maxima, bodies) likewise 0
      logical, allocatable :: counts(:, :)       !! (elements, maxima) those looked at
      logical, allocatable :: is_singular(:)     !! (nodes)
      !> Nodes of these in one of whose elements stress or a strain is at least the body's maximum
      integer, allocatable :: corners(:)
   contains
      procedure :: find
      procedure :: changes
   end type body_maxima_type

   !> The outline at a corner.
   type :: outline_type
      real(dp) :: angle = 0.0_dp        !! within the body
      integer :: sides = 0              !! that are not between two elements
      integer :: prescribed(2) = 0 !! directions in which the first, the second one is held
      logical :: is_curved = .false.    !! whether sides have three nodes
      integer :: material = 0           !! of its elements
      logical :: joins = .false.        !! whether these have several
   end type outline_type

contains

   !> Finds the maxima of an increment.
   subroutine find(self, model, simulation, record)
      class(body_maxima_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation        !! the run at its end
      type(increment_record_type), intent(in) :: record      !! with its fields
      logical :: is_larger(size(model%mesh%node_number))
      real(dp), allocatable :: values(:)
      integer :: i, q

      is_larger = .false.
      allocate (self%is_singular(size(is_larger)), source=.false.)
      allocate (self%counts(size(model%mesh%element_kind), size(maxima)), source=.false.)
      allocate (self%value(size(maxima), model%mesh%body_count))
      allocate (self%node(size(maxima), model%mesh%body_count), source=0)
      if (allocated(record%fields%stress)) then
         self%is_singular = singular_corners(model, simulation, record)
         self%counts = spread(.not. elements_about(model%mesh, &
            pack([(i, i=1, size(is_larger))], self%is_singular)), 2, size(maxima))
      end if
      do q = 1, size(maxima)
         if (maxima(q)%unit == 'temperature') self%counts(:, q) = &
            allocated(record%fields%reaction_heat)
         self%value(q, :) = merge(0.0_dp, -huge(1.0_dp), maxima(q)%unit == '-')
         values = resolved_values(q, record%fields, simulation%recovery%points%node)
         if (size(values) > 0) call find_one(self, q, model%mesh, simulation%recovery%points, &
            values, is_larger)
      end do
      where (self%node == 0) self%value = ieee_value(1.0_dp, ieee_quiet_nan)
      self%corners = pack([(i, i=1, size(is_larger))], self%is_singular .and. is_larger)
   end subroutine find

   !> Values of a quantity; stress and strains that are rounding of the largest ones are 0.
   function resolved_values(q, fields, node) result(values)
      integer, intent(in) :: q
      type(field_record_type), intent(in) :: fields
      integer, intent(in) :: node(:)                         ! (points)
      real(dp), allocatable :: values(:)                     ! (points)

      values = point_values(trim(maxima(q)%name), fields, node)
      if (maxima(q)%unit /= 'temperature') where (abs(values) <= rounding*maxval(abs(values))) &
         values = 0.0_dp
   end function resolved_values

   !> Finds the maximum of one quantity in each body, and the nodes of elements that reach it.
   pure subroutine find_one(self, q, mesh, points, values, is_larger)
      class(body_maxima_type), intent(inout) :: self      ! with those looked at
      integer, intent(in) :: q
      type(mesh_type), intent(in) :: mesh
      type(point_map_type), intent(in) :: points          ! of stress
      real(dp), intent(in) :: values(:)                   ! (points)
      logical, intent(inout) :: is_larger(:)              ! (nodes) not of temperatures
      integer :: e, largest(size(mesh%element_kind))

      do e = 1, size(largest)
         associate (places => points%element_points(:element_node_count(mesh%element_kind(e)), e), &
            b => mesh%element_body(e))
            largest(e) = places(maxloc(values(places), dim=1))
            if (.not. self%counts(e, q) .or. values(largest(e)) <= self%value(q, b)) cycle
            self%value(q, b) = values(largest(e))
            self%node(q, b) = points%node(largest(e))
         end associate
      end do
      if (maxima(q)%unit == 'temperature') return
      do e = 1, size(largest)
         if (values(largest(e)) <= 0.0_dp .or. values(largest(e)) < &
            self%value(q, mesh%element_body(e))) cycle
         is_larger(mesh%element_nodes(:element_node_count(mesh%element_kind(e)), e)) = .true.
      end do
   end subroutine find_one

   !> The changes of the maxima on a divided mesh: the rms of those of the fields at the nodes of
   !> the elements round them, for at one node they may vanish by chance, and what the fields rise
   !> above them there, between nodes as well; 0 of a prescribed temperature, NaN of stress of an
   !> earlier step.
   function changes(self, divided, mesh, simulation, fields) result(change)
      class(body_maxima_type), intent(in) :: self
      type(divided_mesh_type), intent(in) :: divided         !! solved
      type(mesh_type), intent(in) :: mesh                    !! of the run
      type(simulation_type), intent(in) :: simulation        !! the run at the end
      type(field_record_type), intent(in) :: fields          !! of its increment
      real(dp) :: change(size(self%value, 1), size(self%value, 2))   !! (maxima, bodies)
      logical :: is_near(size(mesh%element_kind))
      type(point_map_type) :: fine
      real(dp), allocatable :: before(:), after(:)
      integer :: b, e, q

      fine = divided%run%recovery%points
      change = 0.0_dp
      do q = 1, size(maxima)
         before = resolved_values(q, fields, simulation%recovery%points%node)
         after = resolved_values(q, divided%record%fields, fine%node)
         if (size(after) == 0) change(q, :) = ieee_value(1.0_dp, ieee_quiet_nan)
         do b = 1, size(change, 2)
            if (self%node(q, b) == 0 .or. size(after) == 0) cycle
            if (maxima(q)%name == 'temperature' .and. simulation%loads%temperature%active( &
               self%node(q, b))) cycle
            is_near = self%counts(:, q) .and. mesh%element_body == b .and. &
               elements_about(mesh, self%node(q:q, b))
            do e = 1, size(is_near)
               if (is_near(e)) change(q, b) = change(q, b) + mean_square(e)
            end do
            change(q, b) = sqrt(change(q, b)/max(1, count(is_near)))
            change(q, b) = max(change(q, b), largest_of(divided%model%mesh, fine, after, &
               is_near(parents_of(divided%division))) - self%value(q, b))
         end do
      end do

   contains

      !> Mean square of the change at the nodes of an element, which are those of its parts, too.
      pure real(dp) function mean_square(e)
         integer, intent(in) :: e
         integer :: child, k, part, place
         real(dp) :: there(element_node_count(mesh%element_kind(e)))

         do child = 1, merge(4, 1, divided%division%rank(e) > 0)
            part = child_element(divided%division, e, child)
            do k = 1, size(there)
               place = findloc(divided%model%mesh%element_nodes(:, part), mesh%element_nodes(k, &
                  e), dim=1)
               if (place > 0) there(k) = after(fine%element_points(place, part))
            end do
         end do
         mean_square = sum((there - before(simulation%recovery%points%element_points( &
            :size(there), e)))**2)/size(there)
      end function mean_square

   end function changes

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

   !> The nodes at which the stress of an increment may have no limit.
   function singular_corners(model, simulation, record) result(is_singular)
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation     ! the run at the end of the increment
      type(increment_record_type), intent(in) :: record   ! with its forces
      logical :: is_singular(size(model%mesh%node_number))
      type(contact_points_type) :: points
      type(outline_type) :: outline(size(is_singular))
      integer, allocatable :: ends(:), tied(:)
      integer :: i

      outline = outline_of(model, held_directions(model, simulation))
      is_singular = are_sharp(outline) .or. are_loaded_alone(model, record)
      do i = 1, size(record%contacts)
         call simulation%bodies%view(i, points)
         ends = pack(points%ends(), points%at_corner)
         ends = pack(ends, record%contacts(i)%contact_state(ends) /= contact_open)
         is_singular([points%slave(ends), points%master(ends)]) = .true.
      end do
      tied = [model%ties%faces%slave, model%ties%faces%master]
      do i = 1, size(tied)
         is_singular = is_singular .or. ends_at_side(model%mesh, tied(i), outline)
      end do
   end function singular_corners

   !> Directions in which supports and couplings hold each node.
   pure function held_directions(model, simulation) result(is_held)
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      logical :: is_held(2, size(model%mesh%node_number))
      integer, allocatable :: nodes(:)
      integer :: d, i

      is_held = reshape(simulation%loads%displacement%active, shape(is_held))
      is_held(:, model%partners%node) = is_held(:, model%partners%partner)
      do i = 1, size(model%couplings)
         nodes = coupled_nodes(model%mesh, model%couplings(i))
         do d = 1, 2
            if (model%couplings(i)%follows(d)) is_held(d, nodes) = .true.
         end do
      end do
   end function held_directions

   !> The outline at all nodes.
   function outline_of(model, is_held) result(outline)
      type(model_type), intent(in) :: model
      logical, intent(in) :: is_held(:, :)                ! (2, nodes)
      type(outline_type) :: outline(size(is_held, 2))
      type(element_sides_type) :: sides
      logical, allocatable :: is_inside(:)
      integer :: e, f, h, halves(3, 2), material, node

      associate (mesh => model%mesh)
         sides = find_sides(mesh)
         is_inside = sides%elements(2, :sides%count) > 0
         do h = 1, hanging_count(mesh)
            halves = fine_sides(mesh, h)
            is_inside([sides%index_of(coarse_side(mesh, h)), sides%index_of(halves(:, 1)), &
               sides%index_of(halves(:, 2))]) = .true.
         end do
         do e = 1, size(mesh%element_number)
            material = model%sections(mesh%element_section(e))%material
            do f = 1, element_corner_count(mesh%element_kind(e))
               node = mesh%element_nodes(f, e)
               outline(node)%angle = outline(node)%angle + corner_angle(mesh, e, f)
               outline(node)%joins = outline(node)%joins .or. &
                  all(outline(node)%material /= [0, material])
               outline(node)%material = material
               if (.not. is_inside(sides%of_element(f, e))) call add_side(side_ends(mesh, e, f))
            end do
         end do
      end associate

   contains

      subroutine add_side(ends)
         integer, intent(in) :: ends(3)
         integer :: d, prescribed, i

         prescribed = count([(all(is_held(d, pack(ends, ends > 0))), d=1, 2)])
         do i = 1, 3, 2
            associate (corner => outline(ends(i)))
               corner%sides = corner%sides + 1
               if (corner%sides <= 2) corner%prescribed(corner%sides) = prescribed
               corner%is_curved = ends(2) > 0
            end associate
         end do
      end subroutine add_side

   end function outline_of

   !> Angle of an element at a corner.
   pure real(dp) function corner_angle(mesh, e, corner) result(angle)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e, corner
      real(dp) :: from(2), to(2)
      integer :: last(3)

      last = side_ends(mesh, e, 1 + modulo(corner - 2, element_corner_count(mesh%element_kind(e))))
      to = tangent(mesh, side_ends(mesh, e, corner))
      from = tangent(mesh, last(3:1:-1))
      angle = acos(max(-1.0_dp, min(1.0_dp, dot_product(from, to)/(norm2(from)*norm2(to)))))
   end function corner_angle

   !> Along a side from its first corner on; a midside node at a quarter leaves the chord.
   pure function tangent(mesh, ends) result(direction)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: ends(3)
      real(dp) :: direction(2), slope(2)

      associate (x => mesh%coordinates)
         direction = x(:, ends(3)) - x(:, ends(1))
         if (ends(2) == 0) return
         slope = 4*x(:, ends(2)) - 3*x(:, ends(1)) - x(:, ends(3))
         if (norm2(slope) > 0.1_dp*norm2(direction)) direction = slope
      end associate
   end function tangent

   !> Whether stress has no limit between the sides of a corner.
   elemental logical function are_sharp(outline)
      type(outline_type), intent(in) :: outline
      real(dp) :: excess

      excess = outline%angle - merge(of_curves, of_chords, outline%is_curved)
      associate (least => minval(outline%prescribed), most => maxval(outline%prescribed))
         if (outline%sides == 0) then
            are_sharp = .false.
         else if (outline%sides > 2 .or. outline%joins) then
            are_sharp = .true.
         else if (least == 0 .and. most == 2) then
            are_sharp = outline%angle > clamped_on_one
         else if (least /= most) then
            are_sharp = excess > held_on_one
         else if (least == 1) then
            ! Two sides of one straight line are no corner.
            are_sharp = excess > held_on_one .and. abs(outline%angle - without_change) > of_chords
         else
            are_sharp = excess > without_change
         end if
      end associate
   end function are_sharp

   !> Nodes on which loads, supports, springs, trusses or equations act where none does on a node of
   !> the same elements in its direction.
   pure function are_loaded_alone(model, record) result(alone)
      type(model_type), intent(in) :: model
      type(increment_record_type), intent(in) :: record
      logical :: alone(size(model%mesh%node_number))
      logical, dimension(2, size(model%mesh%node_number)) :: acts, has_neighbour
      integer :: d, e, i

      alone = .false.
      acts = .false.
      if (.not. allocated(record%fields%external_force)) return
      associate (force => record%fields%external_force)
         acts = abs(force) > no_force*maxval(abs(force))
      end associate
      do i = 1, size(model%bars)
         call mark(model%bars(i)%elongation, acts)
      end do
      do i = 1, model%deck_equations
         if (.not. model%equations(i)%is_thermal()) call mark(model%equations(i), acts)
      end do
      has_neighbour = .false.
      do e = 1, size(model%mesh%element_number)
         associate (nodes => model%mesh%element_nodes(:element_node_count( &
            model%mesh%element_kind(e)), e))
            do d = 1, 2
               if (count(acts(d, nodes)) > 1) has_neighbour(d, nodes) = .true.
            end do
         end associate
      end do
      alone = any(acts .and. .not. has_neighbour, dim=1)
   contains
      pure subroutine mark(relation, acts)
         type(equation_type), intent(in) :: relation
         logical, intent(inout) :: acts(:, :)             ! (2, nodes)
         integer :: k

         do k = 1, size(relation%node)
            acts(relation%dof(k), relation%node(k)) = .true.
         end do
      end subroutine mark
   end function are_loaded_alone

   !> The ends of a surface, which are in one of its sides alone; not those on a line of symmetry,
   !> where the next side is held in one direction.
   pure function ends_at_side(mesh, surface, outline) result(is_end)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: surface
      type(outline_type), intent(in) :: outline(:)        ! (nodes)
      logical :: is_end(size(outline))
      integer :: ends(3), i, sides(size(outline))

      sides = 0
      associate (faces => mesh%surfaces(surface)%faces)
         do i = 1, size(faces, 2)
            ends = side_ends(mesh, faces(1, i), faces(2, i))
            sides(ends([1, 3])) = sides(ends([1, 3])) + 1
         end do
      end associate
      is_end = sides == 1 .and. outline%prescribed(1) /= 1 .and. outline%prescribed(2) /= 1
   end function ends_at_side

end module body_maxima
