!> Lines along the sides of elements -> the faces under them.
module line_faces
   use element_kinds, only: element_corner_count, side_node_count, side_nodes
   use mesh, only: mesh_type
   use sorting, only: sort_order
   implicit none
   private
   public :: find_line_faces

   integer, parameter :: key_nodes = 3   !! nodes of a line or a side, 0 for one that it has not

contains

   !> Finds the sides that have the nodes of a line, all of them and no others.
   pure subroutine find_line_faces(mesh, valid, line_nodes, faces, uses)
      type(mesh_type), intent(in) :: mesh          !! its elements
      logical, intent(in) :: valid(:)              !! (elements) whether the nodes are known
      integer, intent(in) :: line_nodes(:, :)      !! (3, lines) in any order, 0 for none
      integer, intent(out) :: faces(:, :)          !! (2, lines) element and face, 0 for none
      integer, intent(out) :: uses(:)              !! (lines) number of sides
      integer :: keys(key_nodes, 4*size(valid) + size(uses)), owner(2, 4*size(valid) + size(uses))
      integer :: face(2), n, i, first, last
      integer, allocatable :: order(:)

      call list_sides(mesh, valid, keys, owner, n)
      do i = 1, size(uses)
         keys(:, n + i) = ascending(line_nodes(:, i))
         owner(:, n + i) = [0, i]
      end do
      n = n + size(uses)
      order = sort_order(keys(3, :n))
      order = order(sort_order(keys(2, order)))
      order = order(sort_order(keys(1, order)))
      faces = 0
      uses = 0
      first = 1
      do while (first <= n)
         last = first
         do while (last < n)
            if (any(keys(:, order(last + 1)) /= keys(:, order(first)))) exit
            last = last + 1
         end do
         ! Sorting keeps the order of equals: sides are before lines.
         face = owner(:, order(first))
         do i = first, last
            if (owner(1, order(i)) > 0 .or. face(1) == 0) cycle
            faces(:, owner(2, order(i))) = face
            uses(owner(2, order(i))) = count(owner(1, order(first:last)) > 0)
         end do
         first = last + 1
      end do
   end subroutine find_line_faces

   !> The nodes of all sides, ascending, with the element and the face of each.
   pure subroutine list_sides(mesh, valid, keys, owner, n)
      type(mesh_type), intent(in) :: mesh
      logical, intent(in) :: valid(:)
      integer, intent(inout) :: keys(:, :), owner(:, :)
      integer, intent(out) :: n
      integer :: e, f, nodes(key_nodes)

      n = 0
      do e = 1, size(valid)
         if (.not. valid(e)) cycle
         associate (kind => mesh%element_kind(e))
            do f = 1, element_corner_count(kind)
               n = n + 1
               nodes = 0
               nodes(:side_node_count(kind)) = mesh%element_nodes(side_nodes(kind, f), e)
               keys(:, n) = ascending(nodes)
               owner(:, n) = [e, f]
            end do
         end associate
      end do
   end subroutine list_sides

   pure function ascending(nodes) result(sorted)
      integer, intent(in) :: nodes(key_nodes)
      integer :: sorted(key_nodes)

      sorted(1) = minval(nodes)
      sorted(3) = maxval(nodes)
      sorted(2) = sum(nodes) - sorted(1) - sorted(3)
   end function ascending

end module line_faces
