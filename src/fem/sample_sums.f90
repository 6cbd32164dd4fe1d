!> Values at points that are weighted sums of the values at recovery points.
module sample_sums
   use kinds, only: dp
   implicit none
   private
   public :: sample_sums_type, row_type, add_weight

   !> The weights of all points, joined.
   type :: sample_sums_type
      integer, allocatable :: first(:)      !! (points + 1) first weight of each point
      integer, allocatable :: sample(:)     !! (weights) recovery point that it belongs to
      real(dp), allocatable :: weight(:)    !! (weights)
   contains
      procedure :: join
      procedure :: add
   end type sample_sums_type

   !> Weights of one point.
   type :: row_type
      private
      integer :: count = 0
      integer, allocatable :: sample(:)
      real(dp), allocatable :: weight(:)
   end type row_type

contains

   !> Adds a weight to those of a point.
   pure subroutine add_weight(row, sample, weight)
      type(row_type), intent(inout) :: row   !! weights of the point
      integer, intent(in) :: sample          !! recovery point
      real(dp), intent(in) :: weight         !! added to what the recovery point has
      integer :: k

      if (.not. allocated(row%sample)) allocate (row%sample(24), row%weight(24))
      k = findloc(row%sample(:row%count), sample, dim=1)
      if (k > 0) then
         row%weight(k) = row%weight(k) + weight
         return
      end if
      if (row%count == size(row%sample)) then
         row%sample = [row%sample, row%sample]
         row%weight = [row%weight, row%weight]
      end if
      row%count = row%count + 1
      row%sample(row%count) = sample
      row%weight(row%count) = weight
   end subroutine add_weight

   !> Joins the weights of the points.
   pure subroutine join(self, rows)
      class(sample_sums_type), intent(inout) :: self !! the weights, not yet formed
      type(row_type), intent(in) :: rows(:)          !! (points)
      integer :: p

      allocate (self%first(size(rows) + 1), source=1)
      do p = 1, size(rows)
         self%first(p + 1) = self%first(p) + rows(p)%count
      end do
      allocate (self%sample(self%first(size(rows) + 1) - 1))
      allocate (self%weight(size(self%sample)))
      do p = 1, size(rows)
         if (rows(p)%count == 0) cycle
         self%sample(self%first(p):self%first(p + 1) - 1) = rows(p)%sample(:rows(p)%count)
         self%weight(self%first(p):self%first(p + 1) - 1) = rows(p)%weight(:rows(p)%count)
      end do
   end subroutine join

   !> Adds the sums to the values at the points.
   pure subroutine add(self, components, samples, values)
      class(sample_sums_type), intent(in) :: self       !! the weights
      integer, intent(in) :: components                 !! 2 or 4
      real(dp), intent(in) :: samples(components, *)    !! at the recovery points
      real(dp), intent(inout) :: values(components, *)  !! at the points
      integer :: p

      do p = 1, size(self%first) - 1
         associate (first => self%first(p), last => self%first(p + 1) - 1)
            if (components == 4) then
               call sum_four(last - first + 1, self%sample(first:last), self%weight(first:last), &
                  samples, values(:, p))
            else
               call sum_two(last - first + 1, self%sample(first:last), self%weight(first:last), &
                  samples, values(:, p))
            end if
         end associate
      end do
   end subroutine add

   pure subroutine sum_four(n, sample, weight, samples, total)
      integer, intent(in) :: n, sample(n)
      real(dp), intent(in) :: weight(n), samples(4, *)
      real(dp), intent(inout) :: total(4)
      real(dp) :: a(2), b(2)
      integer :: k

      a = total(1:2)
      b = total(3:4)
      do k = 1, n
         a = a + weight(k)*samples(1:2, sample(k))
         b = b + weight(k)*samples(3:4, sample(k))
      end do
      total = [a, b]
   end subroutine sum_four

   pure subroutine sum_two(n, sample, weight, samples, total)
      integer, intent(in) :: n, sample(n)
      real(dp), intent(in) :: weight(n), samples(2, *)
      real(dp), intent(inout) :: total(2)
      integer :: k

      do k = 1, n
         total = total + weight(k)*samples(:, sample(k))
      end do
   end subroutine sum_two

end module sample_sums
