!> Contact points of faces that do not match, one of whose forces the others can replace.
!>
!> The hats of a slave face are told apart by the nodes that move with it: each by its own corner
!> of the slave, or, where supports hold that, by the master. Where the slave is held and finer than
!> the master, there are more forces than nodes to act on: some combination of them, of alternating
!> sign, acts on nothing, and pressures are undetermined. The same holds at a corner where supports
!> hold both faces, unless sides with midside nodes meet there.
!>
!> Whether a face is straight makes no difference: on a curved one the combination acts on nearly
!> nothing. So all directions of a face count as one, along its normals or its tangents.
module redundant_points
   use all_contact_points, only: all_contact_points_type
   use constraint_rows, only: constraint_rows_type, of_contact, row_origin_type
   use held_points, only: free_part, held_directions
   use kinds, only: dp
   use row_origins, only: dependent_rows
   implicit none
   private
   public :: first_redundant

   !> Part of a row's largest coefficient that those before must leave. Fully held slaves that are
   !> no finer than the master leave half of it; where less than a fifth is left, the smallest
   !> singular value of the means in the norm of L2 is below a tenth of its usual 0.58.
   real(dp), parameter :: least_left = 0.2_dp

contains

   !> A contact point of one interface whose normal force, or friction force, supports leave
   !> undetermined beside those of the others; 0 where there is none.
   pure integer function first_redundant(points, first, last, held, has_friction) result(found)
      type(all_contact_points_type), intent(in) :: points !! all contact points
      integer, intent(in) :: first, last                  !! those of the interface
      logical, intent(in) :: held(:)                      !! (2 nodes) prescribed displacements
      logical, intent(in) :: has_friction(:)              !! (m)
      logical :: slides(size(has_friction))
      integer :: k

      found = redundant_along(points, [(k, k=first, last)], points%normal, held)
      if (found > 0) return
      slides = has_friction .and. .not. norm2(held_directions(points, held), dim=1) > 0.0_dp
      found = redundant_along(points, pack([(k, k=first, last)], slides(first:last)), &
         points%tangent, held)
   end function first_redundant

   !> The same of some contact points in given directions. Those whose own node is free come first;
   !> only the others can be redundant.
   pure integer function redundant_along(points, chosen, direction, held) result(found)
      type(all_contact_points_type), intent(in) :: points
      integer, intent(in) :: chosen(:)
      real(dp), intent(in) :: direction(:, :)             ! (2, m) unit vectors
      logical, intent(in) :: held(:)
      type(constraint_rows_type) :: rows
      integer :: i, k
      integer, allocatable :: order(:)
      logical :: own_is_free(size(chosen))

      own_is_free = [(free_part(points, held, points%slave(chosen(i)), &
         direction(:, chosen(i))) > 0.5_dp, i=1, size(chosen))]
      found = 0
      if (all(own_is_free)) return
      order = [pack(chosen, own_is_free), pack(chosen, .not. own_is_free)]
      rows%dofs = size(held)/2
      allocate (rows%on_tail(0))
      associate (hanging => points%hanging)
         rows%choice = [(0, i=1, hanging%count), points%slave(order)]
         rows%origin = [(row_origin_type(of_contact, i), i=1, size(rows%choice))]
         call rows%reserve(size(rows%choice), 8*size(rows%choice))
         do i = 1, hanging%count
            call rows%add(hanging%values_of(i), hanging%coefficients_of(i))
         end do
      end associate
      do k = 1, size(order)
         associate (nodes => points%nodes_of(order(k)))
            call rows%add(nodes, points%difference%coefficients_of(order(k))* &
               [(free_part(points, held, nodes(i), direction(:, order(k))), i=1, size(nodes))])
         end associate
      end do
      associate (dependent => dependent_rows(rows, least_left), before => points%hanging%count)
         k = findloc(dependent(before + 1:), .true., dim=1)
      end associate
      if (k > 0) found = order(k)
   end function redundant_along

end module redundant_points
