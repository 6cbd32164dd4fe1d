!> Which elements a local refinement divides: those at a surface, of a set or at points, and with
!> them those that must be divided so that elements side by side differ by one level, and so that
!> faces whose nodes match still do.
!>
!> Nodes that hang: on a side of an element beside which lie two elements of half its size, nodes of
!> these that the large element does not have. The fields along the side are those of the large
!> element, and so the values at these nodes follow from the side's nodes by its shape functions.
!> Distance between lines of straight pieces; the largest values that have a part of a sum.
module local_refinement
   use contact_definitions, only: contact_definition_type, pairing_surfaces
   use element_kinds, only: element_corner_count, element_node_count
   use element_sides, only: element_sides_type, find_sides, side_ends
   use errors, only: error_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use model, only: model_type, refined_region_type
   use sum_lists, only: sum_list_type
   use surface_chains, only: align_chain, chain_faces, facing_chain, surface_chain_type
   implicit none
   private
   public :: choose_neighbours, elements_about, elements_at_points, elements_at_surfaces, &
      elements_in_region, hanging_count, coarse_side, fine_sides, hanging_rows, &
      place_hanging, distance_of_lines, largest_part

   !> Part of DISTANCE= by which an element must come nearer: what only touches stays out.
   real(dp), parameter :: rounding = 1.0e-9_dp

   !> Part of its longest side within which an element lies at a point.
   real(dp), parameter :: near = 0.75_dp

   integer, parameter :: halvings = 50   !! of the interval that holds the least of largest_part
   real(dp), parameter :: alike = 0.99_dp   !! part of a value that counts as the same

contains

   !> Chooses the elements that must be divided with those that are chosen.
   subroutine choose_neighbours(model, chosen)
      type(model_type), intent(in) :: model
      logical, intent(inout) :: chosen(:)                  !! (elements) those that are divided
      integer, allocatable :: small(:, :), together(:, :)
      type(element_sides_type) :: sides
      integer :: i, large
      logical :: is_new

      call find_opposite(model, together)
      sides = find_sides(model%mesh)
      do
         is_new = .false.
         do i = 1, size(together, 2)
            if (chosen(together(1, i)) .eqv. chosen(together(2, i))) cycle
            chosen(together(:, i)) = .true.
            is_new = .true.
         end do
         ! Those with sides twice as long beside them.
         do i = 1, hanging_count(model%mesh)
            large = sides%elements(1, sides%index_of(coarse_side(model%mesh, i)))
            small = fine_sides(model%mesh, i)
            if (chosen(large) .or. .not. (chosen(sides%elements(1, sides%index_of(small(:, 1)))) &
               .or. chosen(sides%elements(1, sides%index_of(small(:, 2)))))) cycle
            chosen(large) = .true.
            is_new = .true.
         end do
         if (.not. is_new) exit
      end do
   end subroutine choose_neighbours

   !> Elements that a region asks to divide.
   function elements_in_region(mesh, region) result(inside)
      type(mesh_type), intent(in) :: mesh
      type(refined_region_type), intent(in) :: region
      logical :: inside(size(mesh%element_number))         !! (elements)
      real(dp), allocatable :: lines(:, :, :)
      integer :: e, f

      if (allocated(region%surfaces)) then
         inside = elements_at_surfaces(mesh, region%surfaces)
      else
         inside = .false.
         inside(mesh%element_sets(region%set)%members) = .true.
      end if
      if (region%distance <= 0.0_dp) return
      call find_lines(mesh, region, lines)
      do e = 1, size(inside)
         do f = 1, element_corner_count(mesh%element_kind(e))
            if (inside(e)) exit
            inside(e) = is_near(side_line(mesh, side_ends(mesh, e, f)), lines, &
               region%distance*(1.0_dp - rounding))
         end do
      end do
   end function elements_in_region

   !> Elements with a face on one of some surfaces.
   pure function elements_at_surfaces(mesh, surfaces) result(at_surface)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: surfaces(:)                   !! indexes into the mesh's surfaces
      logical :: at_surface(size(mesh%element_number))     !! (elements)
      integer :: i

      at_surface = .false.
      do i = 1, size(surfaces)
         at_surface(mesh%surfaces(surfaces(i))%faces(1, :)) = .true.
      end do
   end function elements_at_surfaces

   !> The elements at some nodes.
   pure function elements_about(mesh, nodes) result(is_near)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: nodes(:)                  !! indexes
      logical :: is_near(size(mesh%element_kind)), is_one(size(mesh%node_number))
      integer :: e

      is_one = .false.
      is_one(nodes) = .true.
      do e = 1, size(is_near)
         is_near(e) = any(is_one(mesh%element_nodes(:element_node_count(mesh%element_kind(e)), e)))
      end do
   end function elements_about

   !> Elements with a corner near one of some points, measured by their own size.
   pure function elements_at_points(mesh, points) result(at_point)
      type(mesh_type), intent(in) :: mesh
      real(dp), intent(in) :: points(:, :)                 !! (2, n) [length]
      logical :: at_point(size(mesh%element_number))       !! (elements)
      real(dp) :: square
      integer :: e, i, n

      at_point = .false.
      do e = 1, size(at_point)
         n = element_corner_count(mesh%element_kind(e))
         associate (x => mesh%coordinates(:, mesh%element_nodes(:n, e)))
            square = near**2*maxval(sum((x - cshift(x, 1, dim=2))**2, dim=1))
            do i = 1, size(points, 2)
               if (at_point(e)) exit
               at_point(e) = any((x(1, :) - points(1, i))**2 + (x(2, :) - points(2, i))**2 <= &
                  square)
            end do
         end associate
      end do
   end function elements_at_points

   !> Sides from which the distance counts: those of the surfaces, or those that elements of the set
   !> do not share.
   subroutine find_lines(mesh, region, lines)
      type(mesh_type), intent(in) :: mesh
      type(refined_region_type), intent(in) :: region
      real(dp), allocatable, intent(out) :: lines(:, :, :)   ! (2, 3, sides)
      type(element_sides_type) :: sides
      integer :: i, k, n
      logical :: is_member(0:size(mesh%element_number))

      n = 0
      if (allocated(region%surfaces)) then
         allocate(lines(2, 3, sum([(size(mesh%surfaces(region%surfaces(k))%faces, 2), &
            k=1, size(region%surfaces))])))
         do k = 1, size(region%surfaces)
            associate (faces => mesh%surfaces(region%surfaces(k))%faces)
               do i = 1, size(faces, 2)
                  n = n + 1
                  lines(:, :, n) = side_line(mesh, side_ends(mesh, faces(1, i), faces(2, i)))
               end do
            end associate
         end do
         return
      end if
      is_member = .false.
      is_member(mesh%element_sets(region%set)%members) = .true.
      sides = find_sides(mesh)
      allocate(lines(2, 3, sides%count))
      do i = 1, sides%count
         if (count(is_member(sides%elements(:, i))) /= 1) cycle
         n = n + 1
         lines(:, :, n) = side_line(mesh, sides%ends(:, i))
      end do
      lines = lines(:, :, :n)
   end subroutine find_lines

   !> A side as three points; where it has no midside node, the one in its middle.
   pure function side_line(mesh, ends) result(line)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: ends(3)            ! as in side_ends
      real(dp) :: line(2, 3)

      line(:, [1, 3]) = mesh%coordinates(:, ends([1, 3]))
      line(:, 2) = 0.5_dp*(line(:, 1) + line(:, 3))
      if (ends(2) > 0) line(:, 2) = mesh%coordinates(:, ends(2))
   end function side_line

   !> Whether a line is nearer than a distance to any of others.
   pure logical function is_near(line, others, distance)
      real(dp), intent(in) :: line(2, 3), others(:, :, :), distance
      real(dp) :: low(2), high(2)
      integer :: i

      low = minval(line, dim=2) - distance
      high = maxval(line, dim=2) + distance
      is_near = .true.
      do i = 1, size(others, 3)
         if (any(minval(others(:, :, i), dim=2) > high)) cycle
         if (any(maxval(others(:, :, i), dim=2) < low)) cycle
         if (distance_of_lines(line, others(:, :, i)) < distance) return
      end do
      is_near = .false.
   end function is_near

   !> Pairs of elements on both faces of interfaces and ties whose nodes match, and of sections.
   subroutine find_opposite(model, pairs)
      type(model_type), intent(in) :: model
      integer, allocatable, intent(out) :: pairs(:, :)   ! (2, pairs)
      type(contact_definition_type) :: faces
      integer :: i

      allocate(pairs(2, 0))
      if (allocated(model%contacts)) then
         do i = 1, size(model%contacts)
            call add_opposite(model%mesh, model%contacts(i), pairs)
         end do
      end if
      if (allocated(model%ties)) then
         do i = 1, size(model%ties)
            call add_opposite(model%mesh, model%ties(i)%faces, pairs)
         end do
      end if
      if (.not. allocated(model%couplings)) return
      do i = 1, size(model%couplings)
         if (.not. model%couplings(i)%is_section()) cycle
         faces%slave = model%couplings(i)%surface
         faces%master = model%couplings(i)%opposite
         call add_opposite(model%mesh, faces, pairs)
      end do
   end subroutine find_opposite

   !> Lines with equally many sides count as matching: if they do not, dividing both does no harm.
   !> Surfaces that form no lines are reported elsewhere.
   subroutine add_opposite(mesh, definition, pairs)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition
      integer, allocatable, intent(inout) :: pairs(:, :)
      type(surface_chain_type) :: master
      type(surface_chain_type), allocatable :: masters(:), slaves(:)
      type(error_type), allocatable :: error
      integer, allocatable :: of_slave(:), of_master(:)
      integer :: i

      if (definition%pairing == pairing_surfaces .or. &
         allocated(mesh%surfaces(definition%master)%drawing)) return
      call chain_faces(mesh, mesh%surfaces(definition%slave), slaves, error)
      if (allocated(error)) return
      call chain_faces(mesh, mesh%surfaces(definition%master), masters, error)
      if (allocated(error)) return
      do i = 1, size(slaves)
         master = masters(facing_chain(mesh, slaves(i), masters))
         if (size(slaves(i)%nodes) /= size(master%nodes) .or. slaves(i)%side_nodes /= &
            master%side_nodes .or. (slaves(i)%closed .neqv. master%closed)) cycle
         call align_chain(mesh, slaves(i), master)
         call elements_along(mesh, mesh%surfaces(definition%slave)%faces, slaves(i), of_slave)
         call elements_along(mesh, mesh%surfaces(definition%master)%faces, master, of_master)
         pairs = reshape([pairs, transpose(reshape([of_slave, of_master], [size(of_slave), 2]))], &
            [2, size(pairs, 2) + size(of_slave)])
      end do
   end subroutine add_opposite

   !> The elements of the sides of a line of a surface, in its order.
   pure subroutine elements_along(mesh, faces, chain, elements)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: faces(:, :)                ! (2, sides) of the surface
      type(surface_chain_type), intent(in) :: chain
      integer, allocatable, intent(out) :: elements(:)  ! (sides of the line)
      integer :: position(size(mesh%node_number)), ends(3), i, k

      position = 0
      do i = 1, size(chain%nodes)
         position(chain%nodes(i)) = i
      end do
      allocate (elements((size(chain%nodes) - merge(0, 1, chain%closed))/(chain%side_nodes - 1)), &
         source=0)
      do i = 1, size(faces, 2)
         ends = side_ends(mesh, faces(1, i), faces(2, i))
         if (position(ends(1)) == 0) cycle
         associate (a => minval(position(ends([1, 3]))), b => maxval(position(ends([1, 3]))))
            ! The last side of a closed face leads back to its first node.
            k = merge((a - 1)/(chain%side_nodes - 1) + 1, size(elements), &
               b - a == chain%side_nodes - 1)
         end associate
         elements(k) = faces(1, i)
      end do
   end subroutine elements_along

   !> The side of the large element: corner, midside node or 0, corner.
   pure function coarse_side(mesh, h) result(ends)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: h                      !! 1..hanging_count
      integer :: ends(3)

      ends = mesh%hanging_sides(:3, h)
      if (mesh%hanging_sides(4, h) == 0) ends(2) = 0
   end function coarse_side

   !> The sides of the small elements there.
   pure function fine_sides(mesh, h) result(ends)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: h                      !! 1..hanging_count
      integer :: ends(3, 2)

      associate (nodes => mesh%hanging_sides(:, h))
         ends(:, 1) = nodes([1, 4, 2])
         ends(:, 2) = nodes([2, 5, 3])
      end associate
   end function fine_sides

   !> Number of sides where nodes hang.
   pure integer function hanging_count(mesh)
      type(mesh_type), intent(in) :: mesh

      hanging_count = 0
      if (allocated(mesh%hanging_sides)) hanging_count = size(mesh%hanging_sides, 2)
   end function hanging_count

   !> Conditions of hanging nodes on a field: a sum for each of them, itself first, that is 0.
   pure function hanging_rows(mesh) result(rows)
      type(mesh_type), intent(in) :: mesh
      type(sum_list_type) :: rows                   !! (hanging nodes, nodes)
      integer :: h

      call rows%reserve(2*hanging_count(mesh), 8*hanging_count(mesh))
      do h = 1, hanging_count(mesh)
         associate (side => mesh%hanging_sides(:, h))
            if (side(4) == 0) then
               call rows%add(side([2, 1, 3]), [1.0_dp, -0.5_dp, -0.5_dp])
            else
               ! Shape functions of a three-node side half way between its middle and an end.
               call rows%add(side([4, 1, 2, 3]), [1.0_dp, -0.375_dp, -0.75_dp, 0.125_dp])
               call rows%add(side([5, 3, 2, 1]), [1.0_dp, -0.375_dp, -0.75_dp, 0.125_dp])
            end if
         end associate
      end do
   end function hanging_rows

   !> Moves hanging nodes onto their sides, which were curved before they lost their midside nodes.
   !> Ends that hang themselves go first.
   pure subroutine place_hanging(mesh)
      type(mesh_type), intent(inout) :: mesh
      logical :: waits(size(mesh%node_number)), left(hanging_count(mesh))
      integer :: h

      left = .true.
      do while (any(left))
         waits = .false.
         do h = 1, size(left)
            if (left(h)) waits(mesh%hanging_sides(2, h)) = .true.
         end do
         do h = 1, size(left)
            associate (side => mesh%hanging_sides(:3, h))
               if (.not. left(h) .or. any(waits(side([1, 3])))) cycle
               mesh%coordinates(:, side(2)) = 0.5_dp*(mesh%coordinates(:, side(1)) + &
                  mesh%coordinates(:, side(3)))
               left(h) = .false.
            end associate
         end do
      end do
   end subroutine place_hanging

   !> Least distance between points of two lines; 0 where they cross.
   pure real(dp) function distance_of_lines(one, other) result(distance)
      real(dp), intent(in) :: one(:, :)         !! (2, n) points [length]
      real(dp), intent(in) :: other(:, :)       !! (2, m) points [length]
      integer :: i, j

      distance = huge(1.0_dp)
      do i = 1, size(one, 2) - 1
         do j = 1, size(other, 2) - 1
            distance = min(distance, of_pieces(one(:, i:i + 1), other(:, j:j + 1)))
         end do
      end do
   end function distance_of_lines

   pure real(dp) function of_pieces(one, other)
      real(dp), intent(in) :: one(2, 2), other(2, 2)

      of_pieces = 0.0_dp
      if (side_of(one, other(:, 1))*side_of(one, other(:, 2)) < 0.0_dp .and. &
         side_of(other, one(:, 1))*side_of(other, one(:, 2)) < 0.0_dp) return
      of_pieces = min(to_point(one, other(:, 1)), to_point(one, other(:, 2)), &
         to_point(other, one(:, 1)), to_point(other, one(:, 2)))
   end function of_pieces

   !> Positive where a point lies on the left of a piece.
   pure real(dp) function side_of(piece, point)
      real(dp), intent(in) :: piece(2, 2), point(2)

      associate (along => piece(:, 2) - piece(:, 1), to => point - piece(:, 1))
         side_of = along(1)*to(2) - along(2)*to(1)
      end associate
   end function side_of

   pure real(dp) function to_point(piece, point)
      real(dp), intent(in) :: piece(2, 2), point(2)
      real(dp) :: part

      associate (along => piece(:, 2) - piece(:, 1))
         part = dot_product(point - piece(:, 1), along)/max(dot_product(along, along), tiny(1.0_dp))
         to_point = norm2(point - piece(:, 1) - min(max(part, 0.0_dp), 1.0_dp)*along)
      end associate
   end function to_point

   !> The largest values, as many as have a part of the sum of all, and those like the least of
   !> them: rounding chooses none.
   pure function largest_part(values, part) result(chosen)
      real(dp), intent(in) :: values(:)     !! not negative
      real(dp), intent(in) :: part          !! of their sum
      logical :: chosen(size(values))
      real(dp) :: high, least, middle
      integer :: k

      least = 0.0_dp
      high = max(0.0_dp, maxval(values))          ! -huge of none
      do k = 1, halvings
         middle = 0.5_dp*(least + high)
         if (sum(values, mask=values >= middle) >= part*sum(values)) then
            least = middle
         else
            high = middle
         end if
      end do
      chosen = values >= alike*least .and. values > 0.0_dp
   end function largest_part

end module local_refinement
