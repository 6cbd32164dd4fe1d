!> The lines and arcs of a drawing, which a rigid body carries: points, tangents, the nearest point
!> of a drawn line, and the one that a normal meets.
module drawn_lines
   use kinds, only: dp
   implicit none
   private
   public :: drawn_line_type, sharpest_corner

   !> Angle of the sides by which an arc is sampled [rad]: a parabola through its ends and its
   !> middle then leaves it by 2e-11 of the radius.
   real(dp), parameter :: sampled_angle = 0.01_dp
   real(dp), parameter :: no_side = 1.0e-6_dp   !! part of a piece that makes no side of its own
   real(dp), parameter :: at_end = 1.0e-9_dp    !! part of a piece beyond its end that is rounding
   integer, parameter :: most_steps = 20        !! for radii that differ by the digits of a deck

   !> Pieces one behind the other, with the rigid body on their left.
   type :: drawn_line_type
      real(dp), allocatable :: start(:, :), finish(:, :)   !! (2, n) ends of the pieces [length]
      real(dp), allocatable :: centre(:, :)                !! (2, n) of arcs [length]
      logical, allocatable :: is_arc(:)                    !! (n)
      logical :: closed = .false.          !! whether the last piece leads back to the first
      integer, allocatable :: line(:)      !! (n) line elements they are; unallocated for a drawing
      integer :: reference = 0             !! index of the body's reference node, 0 for none
      integer :: rotation = 0              !! index of the node of its rotation
   contains
      procedure :: sweep
      procedure :: point
      procedure :: tangent
      procedure :: mean_tangent
      procedure :: find_nearest
      procedure :: find_met
      procedure :: goes_on
      procedure :: samples
   end type drawn_line_type

contains

   !> Angle that an arc turns by, less than 180 degrees, positive to the left [rad].
   pure real(dp) function sweep(self, piece)
      class(drawn_line_type), intent(in) :: self
      integer, intent(in) :: piece

      associate (a => self%start(:, piece) - self%centre(:, piece), &
         b => self%finish(:, piece) - self%centre(:, piece))
         sweep = atan2(cross(a, b), dot_product(a, b))
      end associate
   end function sweep

   !> A point of a piece. The radius of an arc goes from that of its start to that of its end, which
   !> differ by rounding.
   pure function point(self, piece, t)
      class(drawn_line_type), intent(in) :: self
      integer, intent(in) :: piece
      real(dp), intent(in) :: t            !! 0 at its start, 1 at its end
      real(dp) :: point(2)                 !! [length]

      if (.not. self%is_arc(piece)) then
         point = self%start(:, piece) + t*(self%finish(:, piece) - self%start(:, piece))
         return
      end if
      associate (a => self%start(:, piece) - self%centre(:, piece), &
         b => self%finish(:, piece) - self%centre(:, piece), angle => t*self%sweep(piece))
         point = self%centre(:, piece) + ((1.0_dp - t) + t*norm2(b)/norm2(a))* &
            [cos(angle)*a(1) - sin(angle)*a(2), sin(angle)*a(1) + cos(angle)*a(2)]
      end associate
   end function point

   !> Unit tangent of a piece.
   pure function tangent(self, piece, t)
      class(drawn_line_type), intent(in) :: self
      integer, intent(in) :: piece
      real(dp), intent(in) :: t
      real(dp) :: tangent(2)

      if (self%is_arc(piece)) then
         associate (arm => self%point(piece, t) - self%centre(:, piece))
            tangent = sign(1.0_dp, self%sweep(piece))*[-arm(2), arm(1)]/norm2(arm)
         end associate
      else
         tangent = self%finish(:, piece) - self%start(:, piece)
         tangent = tangent/norm2(tangent)
      end if
   end function tangent

   !> Unit tangent where pieces meet, the mean of both; else that of the piece.
   pure function mean_tangent(self, piece, t) result(mean)
      class(drawn_line_type), intent(in) :: self
      integer, intent(in) :: piece
      real(dp), intent(in) :: t
      real(dp) :: mean(2)
      real(dp) :: both(2)                  ! 0 where the line turns back
      integer :: other

      mean = self%tangent(piece, t)
      other = piece + merge(1, -1, t > 0.5_dp)
      if (min(t, 1.0_dp - t) > at_end .or. other < 1 .or. other > size(self%is_arc)) return
      both = mean + self%tangent(other, merge(0.0_dp, 1.0_dp, t > 0.5_dp))
      if (norm2(both) > at_end) mean = both/norm2(both)
   end function mean_tangent

   !> The point nearest to another one. Beyond its ends an open line goes on straight.
   pure subroutine find_nearest(self, x, piece, t, foot, beyond)
      class(drawn_line_type), intent(in) :: self
      real(dp), intent(in) :: x(2)         !! [length]
      integer, intent(out) :: piece
      real(dp), intent(out) :: t
      real(dp), intent(out) :: foot(2)     !! the nearest point [length]
      real(dp), intent(out) :: beyond      !! how far it is beyond an end [length]
      real(dp) :: at, ahead, distance, nearest
      integer :: i

      nearest = huge(nearest)
      piece = 1
      t = 0.0_dp
      do i = 1, size(self%is_arc)
         at = min(max(coordinate_of(self, i, x), 0.0_dp), 1.0_dp)
         distance = norm2(self%point(i, at) - x)
         if (distance >= nearest) cycle
         nearest = distance
         piece = i
         t = at
      end do
      foot = self%point(piece, t)
      beyond = 0.0_dp
      if (self%closed) return
      ahead = dot_product(x - foot, self%tangent(piece, t))
      if ((piece == 1 .and. t <= 0.0_dp .and. ahead < 0.0_dp) .or. &
         (piece == size(self%is_arc) .and. t >= 1.0_dp .and. ahead > 0.0_dp)) then
         beyond = abs(ahead)
         foot = foot + ahead*self%tangent(piece, t)
      end if
   end subroutine find_nearest

   !> Coordinate of the foot of a point on a piece, which may be beyond its ends.
   pure real(dp) function coordinate_of(self, i, x)
      class(drawn_line_type), intent(in) :: self
      integer, intent(in) :: i             ! the piece
      real(dp), intent(in) :: x(2)         ! [length]
      real(dp) :: middle(2)

      if (self%is_arc(i)) then
         middle = self%point(i, 0.5_dp) - self%centre(:, i)
         associate (arm => x - self%centre(:, i))
            coordinate_of = 0.5_dp + atan2(cross(middle, arm), dot_product(middle, arm))/ &
               self%sweep(i)
         end associate
      else
         associate (along => self%finish(:, i) - self%start(:, i))
            coordinate_of = dot_product(x - self%start(:, i), along)/dot_product(along, along)
         end associate
      end if
   end function coordinate_of

   !> The point that the normal of a face meets nearest to it, of those at which the line has its
   !> body behind it.
   pure subroutine find_met(self, x, normal, reach, piece, t, ahead)
      class(drawn_line_type), intent(in) :: self
      real(dp), intent(in) :: x(2)         !! where the normal starts [length]
      real(dp), intent(in) :: normal(2)    !! outward unit normal
      real(dp), intent(in) :: reach        !! by how much it may miss the nearest end [length]
      integer, intent(out) :: piece        !! 0 where it meets none
      real(dp), intent(out) :: t
      real(dp), intent(out) :: ahead       !! how far from x, negative behind it [length]
      real(dp) :: at(2), beyond, distance(2), foot(2), tangent(2)
      integer :: i, k

      piece = 0
      t = 0.0_dp
      ahead = huge(ahead)
      do i = 1, size(self%is_arc)
         call meet_piece(self, i, x, normal, at, distance)
         do k = 1, 2
            if (abs(at(k) - 0.5_dp) > 0.5_dp + at_end .or. abs(distance(k)) >= abs(ahead)) cycle
            at(k) = min(max(at(k), 0.0_dp), 1.0_dp)
            tangent = self%tangent(i, at(k))
            if (cross(normal, tangent) >= 0.0_dp) cycle
            piece = i
            t = at(k)
            ahead = distance(k)
         end do
      end do
      if (piece > 0) return
      call self%find_nearest(x, i, at(1), foot, beyond)
      associate (way => self%point(i, at(1)) - x)
         if (abs(cross(normal, way)) >= reach .or. cross(normal, self%tangent(i, at(1))) >= &
            0.0_dp) return
         piece = i
         t = at(1)
         ahead = dot_product(normal, way)
      end associate
   end subroutine find_met

   !> The two points at which a line meets a piece or what it is part of, a straight line or circle.
   pure subroutine meet_piece(self, i, x, direction, t, ahead)
      class(drawn_line_type), intent(in) :: self
      integer, intent(in) :: i             ! the piece
      real(dp), intent(in) :: x(2), direction(2)   ! of the line; a unit vector
      real(dp), intent(out) :: t(2)        ! huge where it does not meet it
      real(dp), intent(out) :: ahead(2)    ! distances from x along the direction [length]
      real(dp) :: ends(2), half, radius
      integer :: k, step

      t = huge(t)
      ahead = huge(ahead)
      if (.not. self%is_arc(i)) then
         associate (along => self%finish(:, i) - self%start(:, i), arm => x - self%start(:, i))
            if (.not. abs(cross(direction, along)) > 0.0_dp) return
            t(1) = cross(direction, arm)/cross(direction, along)
            ahead(1) = cross(along, arm)/cross(direction, along)
         end associate
         return
      end if
      associate (arm => x - self%centre(:, i))
         ends = [norm2(self%start(:, i) - self%centre(:, i)), norm2(self%finish(:, i) - &
            self%centre(:, i))]
         do k = 1, 2
            radius = ends(1)
            do step = 1, most_steps
               half = radius**2 - cross(direction, arm)**2
               if (half < 0.0_dp) exit
               ahead(k) = merge(-1.0_dp, 1.0_dp, k == 1)*sqrt(half) - dot_product(direction, arm)
               t(k) = coordinate_of(self, i, x + ahead(k)*direction)
               radius = ends(1) + t(k)*(ends(2) - ends(1))
            end do
         end do
      end associate
   end subroutine meet_piece

   pure real(dp) function cross(a, b)
      real(dp), intent(in) :: a(2), b(2)

      cross = a(1)*b(2) - a(2)*b(1)
   end function cross

   !> Whether the line goes on at a point of it: none of its ends is near.
   pure logical function goes_on(self, x, near)
      class(drawn_line_type), intent(in) :: self
      real(dp), intent(in) :: x(2)         !! [length]
      real(dp), intent(in) :: near         !! distance of an end that is at the point [length]

      associate (ends => reshape([self%start(:, 1), self%finish(:, size(self%is_arc))], [2, 2]))
         goes_on = self%closed .or. all(norm2(ends - spread(x, 2, 2), dim=1) > near)
      end associate
   end function goes_on

   !> Points of sides with midside points along the line: straight pieces are one side each, arcs
   !> end sides at equal angles and next to some points, those of the face that meets the line.
   pure function samples(self, x)
      class(drawn_line_type), intent(in) :: self
      real(dp), intent(in) :: x(:, :)      !! (2, n) [length]
      real(dp), allocatable :: samples(:, :)   !! (2, 2 sides + 1), or (2, 2 sides) of a closed line
      real(dp), allocatable :: ends(:), feet(:)
      real(dp) :: beyond, foot(2), t
      integer :: i, k, n, pieces(size(x, 2))

      allocate (feet(size(x, 2)))
      do k = 1, size(feet)
         call self%find_nearest(x(:, k), pieces(k), feet(k), foot, beyond)
      end do
      samples = reshape(self%start(:, 1), [2, 1])
      do i = 1, size(self%is_arc)
         ends = [0.0_dp, 1.0_dp]
         if (self%is_arc(i)) then
            n = ceiling(abs(self%sweep(i))/sampled_angle)
            ends = [(real(k, dp)/n, k=0, n)]
            do k = 1, size(feet)
               t = feet(k)
               if (pieces(k) /= i .or. minval(abs(ends - t)) <= no_side) cycle
               ends = [pack(ends, ends < t), t, pack(ends, ends > t)]
            end do
         end if
         do k = 2, size(ends)
            samples = reshape([samples, self%point(i, 0.5_dp*(ends(k - 1) + ends(k))), &
               self%point(i, ends(k))], [2, size(samples, 2) + 2])
         end do
      end do
      if (self%closed) samples = samples(:, :size(samples, 2) - 1)
   end function samples

   !> The piece at whose end the line turns most, and the cosine of that turn; piece 0, cosine 1 for
   !> a single open piece.
   pure subroutine sharpest_corner(line, piece, cosine)
      type(drawn_line_type), intent(in) :: line
      integer, intent(out) :: piece
      real(dp), intent(out) :: cosine
      real(dp) :: turn
      integer :: i, n

      piece = 0
      cosine = 1.0_dp
      n = size(line%is_arc)
      do i = 1, n - merge(0, 1, line%closed)
         turn = dot_product(line%tangent(i, 1.0_dp), line%tangent(modulo(i, n) + 1, 0.0_dp))
         if (turn >= cosine) cycle
         piece = i
         cosine = turn
      end do
   end subroutine sharpest_corner

end module drawn_lines
