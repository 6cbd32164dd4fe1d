!> A path to the solution of an increment from a state that is the only one of its problem:
!>
!>    F(z, t) = opening(z) - (1 - t) o - t H(L(omega(z))) = 0,
!>
!> z being the coordinates of the points on the graphs of their laws (conductance_graph) and o
!> constant openings. At t = 0 there is one solution, at t = 1 they are those of the increment. As H
!> is bounded where the temperatures are, the path from t = 0 leads to t = 1, past all turning
!> points, and to a solution with det(I - U') > 0 (Ortega & Rheinboldt 1970, chapters 6 and 7;
!> Allgower & Georg 1990). It leaves every bound only where the temperatures do. Where one advance
!> passes the kinks of several points at once, the orientation may be lost; the path can then end at
!> a solution with det(I - U') < 0, of which a warning tells.
!>
!> Each pass gives one step: a Newton correction normal to the path and an advance along it, which
!> is shortened where the correction is not small beside it. Laws and contact states have kinks, at
!> which the path may turn back sharply: the sign of det [F_z F_t; tangent], constant all along,
!> tells where it goes on. Lengths are measured along the graphs, in opening/length and in the share
!> omega/(omega + body), in which steep laws and contact points at rest are as long as flat ones.
module homotopy
   use conductance_graph, only: conductance_graph_type
   use kinds, only: dp
   use path_steps, only: coordinate_rate, moved_along, path_equation_type, path_step_type
   implicit none
   private
   public :: homotopy_type

   real(dp), parameter :: first_step = 0.1_dp       !! length of the first advance
   real(dp), parameter :: longest_step = 0.5_dp     !! of any, for one point or t
   real(dp), parameter :: shortest_step = 1.0e-8_dp !! below it another path is tried
   !> Correction over the way to the trial that rejects a pass. After steps as short as the
   !> corrections none may grow.
   real(dp), parameter :: too_large = 0.5_dp
   real(dp), parameter :: small = 0.1_dp            !! the same below which the next step is longer
   real(dp), parameter :: first_near = 0.02_dp      !! correction after which the path goes on
   real(dp), parameter :: nearest = 1.0e-11_dp      !! smallest one that is asked for
   real(dp), parameter :: closer = 0.25_dp          !! by which it becomes smaller at sharp turns
   real(dp), parameter :: rounding = 1.0e-12_dp     !! correction that cannot become smaller
   real(dp), parameter :: least_t = 1.0e-8_dp       !! of the tangent that leads to t = 1
   real(dp), parameter :: no_part = 1.0e-100_dp     !! of the tangent, whose quotients stay finite
   real(dp), parameter :: unlike = 0.1_dp           !! part of the openings by which points differ
   real(dp), parameter :: golden = 0.5_dp*(sqrt(5.0_dp) - 1.0_dp)   !! spreads them evenly
   real(dp), parameter :: touching = 1.0e-6_dp      !! opening over length that is none

   !> Where the path is.
   type :: homotopy_type
      real(dp), private :: length = 1.0_dp        !! scale of openings, > 0 [length]
      real(dp), allocatable, private :: first(:)  !! (m) o [length]
      real(dp), allocatable, private :: base(:)   !! (m) z of the last pass taken [length]
      real(dp), allocatable, private :: trial(:)  !! (m) z of the pass that runs [length]
      real(dp), private :: base_t = 0.0_dp, trial_t = 0.0_dp   !! t of both
      real(dp), allocatable, private :: correction(:) !! (m + 1) from the base to the path
      real(dp), allocatable, private :: tangent(:)    !! (m + 1) of the path there, of length 1
      real(dp), private :: step = first_step      !! length of the present advance
      real(dp), private :: near = first_near      !! correction after which the path goes on
      logical, private :: has_turned = .false.    !! whether the path turned back at the base
      real(dp), private :: way = huge(1.0_dp)     !! length of the move to the trial
   contains
      procedure :: begin
      procedure :: equation
      procedure :: next
      procedure :: retreat
   end type homotopy_type

contains

   !> Begins a path at openings, where no point rests.
   subroutine begin(self, graph, opening, coordinate)
      class(homotopy_type), intent(out) :: self             !! a new path
      type(conductance_graph_type), intent(in) :: graph(:)  !! (m) laws of the points
      real(dp), intent(in) :: opening(:)                    !! (m) o [length]
      real(dp), intent(out) :: coordinate(:)                !! (m) z of the first pass [length]

      self%length = max(maxval(abs(opening)), tiny(1.0_dp))
      call restart(self, graph, opening)
      coordinate = self%trial
   end subroutine begin

   !> Goes back to t = 0, to openings where no point rests. Points that symmetry makes equal begin
   !> apart: where several come to a kink at once, the sign of the determinant tells nothing.
   subroutine restart(self, graph, opening)
      class(homotopy_type), intent(inout) :: self
      type(conductance_graph_type), intent(in) :: graph(:)
      real(dp), intent(in) :: opening(:)
      integer :: k

      self%first = opening + unlike*self%length*[(modulo(k*golden, 1.0_dp), k=1, size(opening))]
      where (abs(self%first) < touching*self%length) self%first = touching*self%length
      self%base = graph%coordinate_of_opening(self%first)
      self%trial = self%base
      self%base_t = 0.0_dp
      self%trial_t = 0.0_dp
      self%step = first_step
      self%way = huge(1.0_dp)
      self%correction = [(0.0_dp, k=0, size(opening))]
      self%tangent = self%correction
      self%tangent(size(self%tangent)) = 1.0_dp
   end subroutine restart

   !> The coordinates of the next pass.
   subroutine next(self, graph, body, opening, derivative, coordinate, found)
      class(homotopy_type), intent(inout) :: self           !! the path
      type(conductance_graph_type), intent(in) :: graph(:)  !! (m) laws of the points
      real(dp), intent(in) :: body(:)         !! (m) of the bodies about a point [as omega]
      real(dp), intent(in) :: opening(:)                    !! (m) H(L(omega)) of the pass [length]
      !> (m, m) its derivative by omega; not allocated where there is none
      real(dp), allocatable, intent(in) :: derivative(:, :)
      real(dp), intent(out) :: coordinate(:)                !! (m) z [length]
      !> step by products, where the derivative is not formed
      type(path_step_type), intent(in), optional :: found
      type(path_equation_type) :: equation
      type(path_step_type) :: step

      if (present(found)) step = found
      if (.not. allocated(step%equation)) then
         call self%equation(graph, body, opening, equation)
         if (allocated(derivative)) call equation%solve(derivative, step)
      end if
      if (self%step < shortest_step) then
         call restart(self, graph, opening)
         coordinate = self%trial
         return
      end if
      if (step%sound) call turn(self, step)
      if (step%sound) call judge(self, step)
      if (.not. step%sound) then
         self%step = 0.5_dp*self%step
         call advance(self, graph, body)
      else if (self%trial_t >= 1.0_dp .or. norm2(step%change) > self%near) then
         call move(self, graph, body, self%trial, self%trial_t, step)
      else
         call take(self, step)
         call advance(self, graph, body)
      end if
      coordinate = self%trial
   end subroutine next

   !> Whether a pass is one on the way: its correction is small, and at t = 1 the path goes forward.
   subroutine judge(self, step)
      class(homotopy_type), intent(in) :: self
      type(path_step_type), intent(inout) :: step

      associate (correction => norm2(step%change))
         step%sound = correction <= merge(too_large, 1.0_dp, self%step > self%near)*self%way
         if (self%trial_t < 1.0_dp) return
         step%sound = (step%sound .or. correction <= rounding) .and. &
            dot_product(step%tangent, self%tangent) >= 0.0_dp
      end associate
   end subroutine judge

   !> Takes the trial as the base. A path that turns back at a kink was overshot by as much as a
   !> step. Where it seems to turn again at once, its branches are nearer to each other than the
   !> points to them.
   subroutine take(self, step)
      class(homotopy_type), intent(inout) :: self
      type(path_step_type), intent(in) :: step
      logical :: turns

      turns = dot_product(step%tangent, self%tangent) < 0.0_dp
      if (norm2(step%change) <= small*self%way .or. turns) self%step = 2*self%step
      if (turns .and. self%has_turned) self%near = max(closer*self%near, nearest)
      self%has_turned = turns
      self%base = self%trial
      self%base_t = self%trial_t
      self%correction = step%change
      self%tangent = step%tangent
   end subroutine take

   !> A shorter advance, where the contact zones of a pass were not found.
   subroutine retreat(self, graph, body, coordinate, possible)
      class(homotopy_type), intent(inout) :: self           !! the path
      type(conductance_graph_type), intent(in) :: graph(:)  !! (m) laws of the points
      real(dp), intent(in) :: body(:)         !! (m) of the bodies about a point [as omega]
      real(dp), intent(out) :: coordinate(:)                !! (m) z [length]
      logical, intent(out) :: possible                      !! whether there is one

      self%step = 0.5_dp*self%step
      possible = self%step > shortest_step
      if (possible) call advance(self, graph, body)
      coordinate = self%trial
   end subroutine retreat

   !> The trial from the base: to the path and along it, no point by more than a part of its opening
   !> where that is large.
   subroutine advance(self, graph, body)
      class(homotopy_type), intent(inout) :: self
      type(conductance_graph_type), intent(in) :: graph(:)
      real(dp), intent(in) :: body(:)
      real(dp) :: longest(size(self%tangent))

      longest = longest_step*[max(1.0_dp, abs(graph%opening(self%base))/self%length), 1.0_dp]
      self%step = min(self%step, minval(longest/max(abs(self%tangent), no_part)))
      call move(self, graph, body, self%base, self%base_t, path_step_type(.true., &
         self%correction + self%step*self%tangent, self%tangent))
   end subroutine advance

   !> The trial: a change from coordinates and t, back along the tangent to t = 1 where it would
   !> lead beyond. There is no path below t = 0.
   subroutine move(self, graph, body, from, from_t, step)
      class(homotopy_type), intent(inout) :: self
      type(conductance_graph_type), intent(in) :: graph(:)
      real(dp), intent(in) :: body(:), from(:), from_t
      type(path_step_type), intent(in) :: step
      real(dp) :: way(size(body) + 1)
      integer :: n

      n = size(body)
      way = step%change
      if (from_t < 1.0_dp .and. from_t + way(n + 1) >= 1.0_dp) way = way - &
         (from_t + way(n + 1) - 1.0_dp)/max(step%tangent(n + 1), least_t)*step%tangent
      self%way = norm2(way)
      self%trial = moved_along(graph, from, way(:n), body, self%length)
      self%trial_t = min(max(from_t + way(n + 1), 0.0_dp), 1.0_dp)
      if (from_t + step%change(n + 1) >= 1.0_dp) self%trial_t = 1.0_dp
   end subroutine move

   !> The equation of Newton's correction of the trial, at t = 1 with t held, elsewhere as near as
   !> the tangent allows.
   subroutine equation(self, graph, body, opening, found)
      class(homotopy_type), intent(inout) :: self           !! the path
      type(conductance_graph_type), intent(in) :: graph(:)  !! (m) laws of the points
      real(dp), intent(in) :: body(:)         !! (m) of the bodies about a point [as omega]
      real(dp), intent(in) :: opening(:)                    !! (m) H(L(omega)) of the pass [length]
      type(path_equation_type), intent(out) :: found
      real(dp) :: rate(size(opening))
      integer :: k

      if (self%base_t <= 0.0_dp .and. self%trial_t <= 0.0_dp) self%length = max(self%length, &
         maxval(abs(opening)))
      rate = [(coordinate_rate(graph(k), self%trial(k), body(k), self%length), k=1, size(rate))]
      found%advance = rate*graph%advance(self%trial)
      found%slope = self%trial_t*rate*graph%derivative(self%trial)
      found%by_parameter = self%first - opening
      found%border = self%tangent
      if (self%trial_t >= 1.0_dp) found%border = [(0.0_dp, k=1, size(rate)), 1.0_dp]
      found%rest = -(graph%opening(self%trial) - (1.0_dp - self%trial_t)*self%first - &
         self%trial_t*opening)
   end subroutine equation

   !> Turns the tangent the way that the path goes on, and the correction normal to it.
   subroutine turn(self, step)
      class(homotopy_type), intent(in) :: self
      type(path_step_type), intent(inout) :: step

      if (step%is_reversed) step%tangent = -step%tangent
      if (self%trial_t < 1.0_dp) step%change = step%change - &
         dot_product(step%change, step%tangent)*step%tangent
   end subroutine turn

end module homotopy
