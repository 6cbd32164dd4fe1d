!> Cuts a body of a mesh along sides between its elements: as in CalculiX, those on the side of the
!> surface that names them get nodes of their own there.
module section_cuts
   use element_kinds, only: element_node_count
   use element_sides, only: element_sides_type, find_sides, side_ends
   use kinds, only: dp
   use mesh, only: add_node, mesh_type
   implicit none
   private
   public :: cut_mesh, section_normal, unit_vector

   integer, parameter :: near = 1, far = 2   !! parts of the elements at the cut

   real(dp), parameter :: rounding = 1.0e-9_dp   !! component of a unit vector that is zero

contains

   !> Cuts the mesh along the sides of a surface. The new nodes are behind all others.
   pure subroutine cut_mesh(surface, mesh, opposite, first_new, fault)
      integer, intent(in) :: surface                       !! its elements get new nodes
      type(mesh_type), intent(inout) :: mesh
      !> (2, n) element and side beyond each side of the surface
      integer, allocatable, intent(out) :: opposite(:, :)
      integer, intent(out) :: first_new                    !! first of the new nodes
      !> why the mesh stays as it is, behind the words that name the card; else empty
      character(:), allocatable, intent(out) :: fault
      type(element_sides_type) :: sides
      integer :: part(0:size(mesh%element_number)), copy_of(size(mesh%node_number))
      logical :: is_cut(0:4*size(mesh%element_number)), at_cut(0:size(mesh%node_number))
      integer :: e, i, n, q

      first_new = size(mesh%node_number) + 1
      sides = find_sides(mesh)
      is_cut = .false.
      at_cut = .false.
      part = 0
      associate (faces => mesh%surfaces(surface)%faces)
         do i = 1, size(faces, 2)
            is_cut(sides%of_element(faces(2, i), faces(1, i))) = .true.
            at_cut(sides%ends(:, sides%of_element(faces(2, i), faces(1, i)))) = .true.
         end do
         at_cut(0) = .false.
         call seed(faces, sides, part, opposite, fault)
      end associate
      if (len(fault) == 0) call grow(sides, is_cut, at_cut, part, fault)
      if (len(fault) > 0) return
      copy_of = 0
      n = size(copy_of)
      do i = 1, n
         if (.not. at_cut(i)) cycle
         call add_node(mesh, mesh%coordinates(:, i))
         copy_of(i) = size(mesh%node_number)
      end do
      do e = 1, size(mesh%element_number)
         if (part(e) /= near) cycle
         do q = 1, element_node_count(mesh%element_kind(e))
            associate (node => mesh%element_nodes(q, e))
               if (at_cut(node)) node = copy_of(node)
            end associate
         end do
      end do
   end subroutine cut_mesh

   !> Puts the elements on both sides of the cut into their parts.
   pure subroutine seed(faces, sides, part, opposite, fault)
      integer, intent(in) :: faces(:, :)
      type(element_sides_type), intent(in) :: sides
      integer, intent(inout) :: part(0:)                   ! (elements)
      integer, allocatable, intent(out) :: opposite(:, :)
      character(:), allocatable, intent(out) :: fault
      integer :: i, other, side

      fault = ''
      allocate (opposite(2, size(faces, 2)))
      part(faces(1, :)) = near
      do i = 1, size(faces, 2)
         side = sides%of_element(faces(2, i), faces(1, i))
         other = sum(sides%elements(:, side)) - faces(1, i)
         if (other == 0) then
            fault = 'has a side at the edge of the body: a section lies between elements'
         else if (part(other) == near) then
            fault = 'has elements on both sides of the section: name those of one side'
         end if
         if (len(fault) > 0) return
         part(other) = far
         opposite(:, i) = [other, findloc(sides%of_element(:, other), side, dim=1)]
      end do
   end subroutine seed

   !> Puts elements that touch the cut into the part of a neighbour, across sides that end there.
   pure subroutine grow(sides, is_cut, at_cut, part, fault)
      type(element_sides_type), intent(in) :: sides
      logical, intent(in) :: is_cut(0:), at_cut(0:)        ! (sides), (nodes)
      integer, intent(inout) :: part(0:)
      character(:), allocatable, intent(inout) :: fault
      integer :: i
      logical :: is_new

      do
         is_new = .false.
         do i = 1, sides%count
            associate (one => sides%elements(1, i), other => sides%elements(2, i))
               if (is_cut(i) .or. other == 0 .or. .not. any(at_cut(sides%ends(:, i)))) cycle
               if (part(one) == part(other)) cycle
               if (all(part([one, other]) > 0)) then
                  fault = 'ends inside the body: a section cuts it from edge to edge'
                  return
               end if
               part([one, other]) = maxval(part([one, other]))
               is_new = .true.
            end associate
         end do
         if (.not. is_new) return
      end do
   end subroutine grow

   !> Mean normal of the sides of a surface, away from its elements. A component that is rounding is
   !> zero.
   pure function section_normal(surface, mesh) result(normal)
      integer, intent(in) :: surface
      type(mesh_type), intent(in) :: mesh
      real(dp) :: normal(2)                                !! unit vector; zero of a closed surface
      integer :: ends(3), i

      normal = 0.0_dp
      associate (faces => mesh%surfaces(surface)%faces, x => mesh%coordinates)
         do i = 1, size(faces, 2)
            ends = side_ends(mesh, faces(1, i), faces(2, i))
            normal = normal + [x(2, ends(3)) - x(2, ends(1)), x(1, ends(1)) - x(1, ends(3))]
         end do
      end associate
      normal = unit_vector(normal)
   end function section_normal

   !> A vector of length 1, without components that are rounding; zero for zero.
   pure function unit_vector(vector)
      real(dp), intent(in) :: vector(2)
      real(dp) :: unit_vector(2)

      unit_vector = merge(vector, 0.0_dp, abs(vector) > rounding*norm2(vector))
      if (norm2(unit_vector) > 0.0_dp) unit_vector = unit_vector/norm2(unit_vector)
   end function unit_vector

end module section_cuts
