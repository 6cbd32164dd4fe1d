!> Nodes that hang: on a side of an element beside which lie two elements of half its size, nodes of
!> these that the large element does not have. The fields along the side are those of the large
!> element, and so the values at these nodes follow from the side's nodes by its shape functions.
module hanging_nodes
   use kinds, only: dp
   use mesh, only: mesh_type
   use sum_lists, only: sum_list_type
   implicit none
   private
   public :: hanging_count, coarse_side, fine_sides, nodes_between, hanging_rows, place_hanging

contains

   !> Number of sides where nodes hang.
   pure integer function hanging_count(mesh)
      type(mesh_type), intent(in) :: mesh

      hanging_count = 0
      if (allocated(mesh%hanging_sides)) hanging_count = size(mesh%hanging_sides, 2)
   end function hanging_count

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

   !> The nodes that hang there, the one next to an end of the side first, or 0 for the second.
   pure function nodes_between(mesh, h, first) result(nodes)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: h                      !! 1..hanging_count
      integer, intent(in) :: first                  !! the end
      integer :: nodes(2)

      associate (side => mesh%hanging_sides(:, h))
         if (side(4) == 0) then
            nodes = [side(2), 0]
         else if (side(1) == first) then
            nodes = side(4:5)
         else
            nodes = side([5, 4])
         end if
      end associate
   end function nodes_between

   !> What hanging nodes say of a field: a sum for each of them, itself first, that is 0.
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

end module hanging_nodes
