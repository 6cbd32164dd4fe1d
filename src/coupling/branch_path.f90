!> The geometry of a branch of solutions over the load factor:
!>
!>    F(z, f) = opening(z) - H(L(omega(z)); f) = 0,
!>
!> z being the coordinates of the contact points on the graphs of their laws (conductance_graph) and
!> f the load factor, in which loads are affine. Lengths of the branch are those of path_steps, the
!> square of each contact point's by its share of the area, so that meshes do not change them.
!>
!> Laws and contact states have kinks, at which the branch may turn sharply, even back. All kinks
!> are places on the graphs of the contact points: the coordinate that passes one goes on in its
!> sense.
module branch_path
   use conductance_graph, only: conductance_graph_type
   use fixed_point, only: pass_type
   use kinds, only: dp
   use path_steps, only: coordinate_rate, distance, moved_along, path_equation_type, &
      path_step_type
   implicit none
   private
   public :: branch_measure_type, branch_point_type

   real(dp), parameter :: caught = 1.0e-3_dp       !! part of the way past a kink that is none
   real(dp), parameter :: no_way = 1.0e-11_dp      !! change of an opening that is none, over length
   real(dp), parameter :: longest_move = 0.25_dp   !! along the graph of one contact point

   !> A point of the branch, or near it.
   type :: branch_point_type
      real(dp), allocatable :: coordinate(:)   !! (m) z [length]
      real(dp) :: factor = 0.0_dp              !! f [-]
      real(dp), allocatable :: omega(:)        !! (m) conductances that the pass there found
      real(dp), allocatable :: tangent(:)      !! (m + 1) of the branch, of length 1, the last of f
   end type branch_point_type

   !> What measures lengths.
   type :: branch_measure_type
      type(conductance_graph_type), allocatable :: graph(:)   !! (m) laws of the last pass
      real(dp), allocatable :: body(:)         !! (m) of the bodies about a contact point [as omega]
      real(dp), allocatable :: part(:)         !! (m) root of the share of the area; 0 carries none
      real(dp) :: length = 1.0_dp              !! scale of openings [length]
   contains
      procedure :: moved
      procedure :: way
      procedure :: longest
      procedure :: correction
      procedure :: kinked
      procedure :: at_kink
      procedure :: is_caught
   end type branch_measure_type

contains

   !> The point at the end of a way.
   pure function moved(self, from, way) result(to)
      class(branch_measure_type), intent(in) :: self
      type(branch_point_type), intent(in) :: from
      real(dp), intent(in) :: way(:)            !! (m + 1) in lengths
      type(branch_point_type) :: to             !! with the tangent of the other one
      integer :: n

      n = size(self%part)
      to = from
      where (self%part > 0.0_dp) to%coordinate = moved_along(self%graph, from%coordinate, &
         way(:n)/max(self%part, tiny(1.0_dp)), self%body, self%length)
      to%factor = from%factor + way(n + 1)
   end function moved

   !> The way from one point to another.
   pure function way(self, from, to)
      class(branch_measure_type), intent(in) :: self
      type(branch_point_type), intent(in) :: from, to
      real(dp) :: way(size(self%part) + 1)      !! in lengths
      integer :: k

      do k = 1, size(self%part)
         associate (a => from%coordinate(k), b => to%coordinate(k))
            way(k) = sign(self%part(k)*distance(self%graph(k), min(a, b), max(a, b), &
               self%body(k), self%length), b - a)
         end associate
      end do
      way(size(way)) = to%factor - from%factor
   end function way

   !> Longest step along a tangent that moves no contact point too far.
   pure real(dp) function longest(self, tangent)
      class(branch_measure_type), intent(in) :: self
      real(dp), intent(in) :: tangent(:)

      longest = longest_move/max(maxval(abs(tangent(:size(self%part)))/max(self%part, &
         tiny(1.0_dp)), mask=self%part > 0.0_dp), longest_move)
   end function longest

   !> Newton's correction of a point, normal to the branch, or with one unknown held; and the
   !> tangent there, the way of the point's own one.
   subroutine correction(self, point, pass, fixed_coordinate, step)
      class(branch_measure_type), intent(in) :: self
      type(branch_point_type), intent(in) :: point
      type(pass_type), intent(in) :: pass         !! with its derivatives
      integer, intent(in) :: fixed_coordinate                 !! a contact point, m + 1 for f, or 0
      type(path_step_type), intent(out) :: step   !! not sound where there is none
      type(path_equation_type) :: equation
      real(dp) :: rate(size(self%part))
      integer :: k

      if (.not. allocated(pass%derivative)) return
      ! Without an area a contact point carries no heat: its row of the derivative is zero, and its
      ! coordinate means nothing.
      associate (z => point%coordinate, counts => self%part > 0.0_dp)
         rate = [(coordinate_rate(pass%graph(k), z(k), self%body(k), self%length), k=1, &
            size(rate))]/merge(self%part, 1.0_dp, counts)
         equation%advance = merge(rate*pass%graph%advance(z), 1.0_dp, counts)
         equation%slope = merge(rate*pass%graph%derivative(z), 0.0_dp, counts)
         equation%by_parameter = -pass%by_factor
         equation%rest = merge(pass%opening - pass%graph%opening(z), 0.0_dp, counts)
      end associate
      equation%border = point%tangent
      if (fixed_coordinate > 0) equation%border = [(merge(1.0_dp, 0.0_dp, &
         k == fixed_coordinate), k=1, size(rate) + 1)]
      call equation%solve(pass%derivative, step)
      if (.not. step%sound) return
      if (dot_product(step%tangent, point%tangent) < 0.0_dp) step%tangent = -step%tangent
      if (fixed_coordinate == 0) step%change = step%change - &
         dot_product(step%change, step%tangent)*step%tangent
   end subroutine correction

   !> The contact point whose coordinate passes a kink between two points, the fastest one of
   !> several; 0 for none.
   pure integer function kinked(self, from, to)
      class(branch_measure_type), intent(in) :: self
      type(branch_point_type), intent(in) :: from, to
      real(dp) :: fastest
      integer :: k

      kinked = 0
      fastest = 0.0_dp
      do k = 1, size(self%part)
         if (self%part(k) <= 0.0_dp) cycle
         associate (a => from%coordinate(k), b => to%coordinate(k), kinks => self%graph(k)%kinks())
            if (.not. any(kinks > min(a, b) .and. kinks < max(a, b))) cycle
         end associate
         if (abs(from%tangent(k))/self%part(k) <= fastest) cycle
         fastest = abs(from%tangent(k))/self%part(k)
         kinked = k
      end do
   end function kinked

   !> A point with the coordinate that passes a kink up to another point at that kink, the first one
   !> of several.
   pure function at_kink(self, from, to) result(point)
      class(branch_measure_type), intent(in) :: self
      type(branch_point_type), intent(in) :: from, to
      type(branch_point_type) :: point
      integer :: k

      k = self%kinked(from, to)
      point = from
      associate (a => from%coordinate(k), b => to%coordinate(k), kinks => self%graph(k)%kinks())
         point%coordinate(k) = kinks(minloc(abs(kinks - a), mask=kinks > min(a, b) .and. &
            kinks < max(a, b), dim=1))
      end associate
   end function at_kink

   !> Whether corrections end in a kink, where contact and law need not be on one side of it: the
   !> branch turns there.
   pure logical function is_caught(self, from, trial, to)
      class(branch_measure_type), intent(in) :: self
      type(branch_point_type), intent(in) :: from, trial, to
      integer :: k

      is_caught = .false.
      do k = 1, size(self%part)
         if (self%part(k) <= 0.0_dp .or. is_caught) cycle
         associate (a => from%coordinate(k), b => trial%coordinate(k), c => to%coordinate(k), &
            kinks => self%graph(k)%kinks(), none => no_way*self%length)
            is_caught = any((kinks > min(a, b) .and. kinks < max(a, b) .and. &
               abs(c - kinks) < caught*abs(b - kinks)) .or. (abs(c - kinks) < none .and. &
               abs(a - kinks) > none))
         end associate
      end do
   end function is_caught

end module branch_path
