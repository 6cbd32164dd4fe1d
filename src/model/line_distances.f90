!> Distance between lines of straight pieces.
module line_distances
   use kinds, only: dp
   implicit none
   private
   public :: distance_of_lines

contains

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
         part = dot_product(point - piece(:, 1), along)/max(dot_product(along, along), &
            tiny(1.0_dp))
         to_point = norm2(point - piece(:, 1) - min(max(part, 0.0_dp), 1.0_dp)*along)
      end associate
   end function to_point

end module line_distances
