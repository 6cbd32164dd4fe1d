!> Corners at which the stress of the exact solution may have no limit: reentrant ones, those where
!> a support ends, where materials meet on the outline, where a contact or a tie ends, and nodes
!> with a force of their own. Between two straight sides the stress varies as a power of the
!> distance that is negative where the angle exceeds one that the supports of both sides give
!> (M. L. Williams, J. Appl. Mech. 19 (1952) 526-528).
module singular_corners
   use contact_points, only: contact_points_type
   use contact_system, only: contact_open
   use element_kinds, only: element_corner_count, element_node_count
   use element_sides, only: element_sides_type, find_sides, side_ends
   use equations, only: coupled_nodes
   use kinds, only: dp
   use local_refinement, only: coarse_side, fine_sides, hanging_count
   use mesh, only: mesh_type
   use model, only: model_type
   use records, only: increment_record_type
   use simulation, only: simulation_type
   implicit none
   private
   public :: find_singular_corners

   real(dp), parameter :: degree = acos(-1.0_dp)/180
   !> Angles from which stress has no limit, by the directions that are held on both sides of the
   !> corner: with both on one side and none on the other 62 degrees for nu = 0.3.
   real(dp), parameter :: without_change = 180*degree, held_on_one = 90*degree, &
      clamped_on_one = 70*degree
   !> Angle that straight sides of elements may add where they follow a curve, curved ones.
   real(dp), parameter :: of_chords = 30*degree, of_curves = 10*degree
   real(dp), parameter :: no_force = 1.0e-6_dp   !! of the largest nodal force: none

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

   !> The nodes at which the stress of an increment may have no limit.
   subroutine find_singular_corners(model, simulation, record, is_singular)
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation     !! the run at the end of the increment
      type(increment_record_type), intent(in) :: record   !! with its forces
      logical, intent(out) :: is_singular(:)              !! (nodes)
      type(contact_points_type) :: points
      type(outline_type) :: outline(size(is_singular))
      integer, allocatable :: ends(:)
      integer :: i, k

      outline = outline_of(model, held_directions(model, simulation))
      is_singular = are_sharp(outline)
      is_singular = is_singular .or. are_loaded_alone(model, record)
      do i = 1, size(record%contacts)
         call simulation%bodies%view(i, points)
         ends = points%ends()
         do k = 1, size(ends)
            if (.not. points%at_corner(k)) cycle
            if (record%contacts(i)%contact_state(ends(k)) == contact_open) cycle
            is_singular([points%slave(ends(k)), points%master(ends(k))]) = .true.
         end do
      end do
      do i = 1, size(model%ties)
         associate (faces => model%ties(i)%faces)
            is_singular = is_singular .or. ends_at_side(model%mesh, faces%slave, outline) .or. &
               ends_at_side(model%mesh, faces%master, outline)
         end associate
      end do
   end subroutine find_singular_corners

   !> Directions in which supports and couplings hold each node.
   pure function held_directions(model, simulation) result(is_held)
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      logical :: is_held(2, size(model%mesh%node_number))
      integer, allocatable :: nodes(:)
      integer :: d, i

      is_held = reshape(simulation%loads%displacement%active, shape(is_held))
      do i = 1, size(model%partners)
         associate (partner => model%partners(i))
            is_held(:, partner%node) = is_held(:, partner%partner)
         end associate
      end do
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
      integer :: e, f, h, node

      associate (mesh => model%mesh)
         sides = find_sides(mesh)
         is_inside = sides%elements(2, :sides%count) > 0
         do h = 1, hanging_count(mesh)
            associate (halves => fine_sides(mesh, h))
               is_inside([sides%index_of(coarse_side(mesh, h)), sides%index_of(halves(:, 1)), &
                  sides%index_of(halves(:, 2))]) = .true.
            end associate
         end do
         do e = 1, size(mesh%element_number)
            associate (material => model%sections(mesh%element_section(e))%material)
               do f = 1, element_corner_count(mesh%element_kind(e))
                  node = mesh%element_nodes(f, e)
                  outline(node)%angle = outline(node)%angle + corner_angle(mesh, e, f)
                  outline(node)%joins = outline(node)%joins .or. &
                     all(outline(node)%material /= [0, material])
                  outline(node)%material = material
                  if (.not. is_inside(sides%of_element(f, e))) call add_side(side_ends(mesh, e, f))
               end do
            end associate
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
      integer :: before

      before = corner - 1
      if (before == 0) before = element_corner_count(mesh%element_kind(e))
      associate (next => side_ends(mesh, e, corner), last => side_ends(mesh, e, before))
         to = tangent(next)
         from = tangent(last(3:1:-1))
      end associate
      angle = acos(max(-1.0_dp, min(1.0_dp, dot_product(from, to)/(norm2(from)*norm2(to)))))

   contains

      !> Along a side from its first corner on; a midside node at a quarter leaves the chord.
      pure function tangent(ends) result(direction)
         integer, intent(in) :: ends(3)
         real(dp) :: direction(2)

         associate (x => mesh%coordinates)
            direction = x(:, ends(3)) - x(:, ends(1))
            if (ends(2) == 0) return
            if (norm2(4*x(:, ends(2)) - 3*x(:, ends(1)) - x(:, ends(3))) > 0.1_dp* &
               norm2(direction)) direction = 4*x(:, ends(2)) - 3*x(:, ends(1)) - x(:, ends(3))
         end associate
      end function tangent

   end function corner_angle

   !> Whether stress has no limit between the sides of a corner.
   elemental logical function are_sharp(outline)
      type(outline_type), intent(in) :: outline
      real(dp) :: excess

      are_sharp = .false.
      if (outline%sides == 0) return
      are_sharp = outline%sides > 2 .or. outline%joins
      if (are_sharp) return
      excess = outline%angle - merge(of_curves, of_chords, outline%is_curved)
      associate (least => minval(outline%prescribed), most => maxval(outline%prescribed))
         if (least == 0 .and. most == 2) then
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

   !> Nodes on which loads, supports, springs or trusses act where none does on a node of the same
   !> elements in its direction.
   pure function are_loaded_alone(model, record) result(alone)
      type(model_type), intent(in) :: model
      type(increment_record_type), intent(in) :: record
      logical :: alone(size(model%mesh%node_number))
      logical, dimension(2, size(model%mesh%node_number)) :: acts, has_neighbour
      integer :: d, e, i, k

      alone = .false.
      acts = .false.
      if (.not. allocated(record%fields%external_force)) return
      associate (force => record%fields%external_force)
         acts = abs(force) > no_force*maxval(abs(force))
      end associate
      do i = 1, size(model%bars)
         associate (ends => model%bars(i)%elongation)
            do k = 1, size(ends%node)
               acts(ends%dof(k), ends%node(k)) = .true.
            end do
         end associate
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

end module singular_corners
