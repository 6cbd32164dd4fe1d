!> Steps on a path of solutions of n equations in n + 1 unknowns, of which n are the coordinates of
!> the contact points on the graphs of their laws (conductance_graph) and the last is a parameter.
!> Lengths are measured along the graphs, in opening/length and in the share omega/(omega + body),
!> in which steep laws and contact points at rest are as long as flat ones.
module path_steps
   use conductance_graph, only: conductance_graph_type
   use dense, only: lu_type
   use kinds, only: dp
   implicit none
   private
   public :: path_equation_type, path_step_type, coordinate_rate, moved_along, distance

   !> The equations of a step, whose unknowns are lengths along the graphs and the parameter: beside
   !> the derivative D of the openings by the conductances
   !>
   !>    [diag(advance) - D diag(slope)  by_parameter] step = [rest]
   !>    [               border                      ]        [    ]
   type :: path_equation_type
      real(dp), allocatable :: advance(:)       !! (n) of the openings [length]
      !> (n) of the conductances [power/(length^2 temperature)]
      real(dp), allocatable :: slope(:)
      real(dp), allocatable :: by_parameter(:)  !! (n) [length]
      real(dp), allocatable :: border(:)        !! (n + 1)
      real(dp), allocatable :: rest(:)          !! (n) what the equations lack [length]
   contains
      procedure :: solve
   end type path_equation_type

   !> Newton's correction of a trial, and the way that the path goes on.
   type :: path_step_type
      logical :: sound = .false.               !! whether there is one
      real(dp), allocatable :: change(:)       !! (n + 1) the correction
      real(dp), allocatable :: tangent(:)      !! (n + 1) of the path, of length 1
      logical :: is_reversed = .false.         !! whether det [F_z F_t; border] is negative
      type(path_equation_type), allocatable :: equation   !! where products solve it
   end type path_step_type

contains

   !> The step where D is a matrix, its tangent's product with the border positive; not sound where
   !> the equations are singular.
   subroutine solve(self, derivative, step)
      class(path_equation_type), intent(in) :: self
      real(dp), intent(in) :: derivative(:, :)   !! (n, n) D [length/(power/(length^2 temperature))]
      type(path_step_type), intent(out) :: step
      real(dp) :: matrix(size(self%border), size(self%border)), x(size(self%border), 2)
      type(lu_type) :: lu
      logical :: singular
      integer :: k, n

      n = size(self%rest)
      do k = 1, n
         matrix(:n, k) = -self%slope(k)*derivative(:, k)
         matrix(k, k) = matrix(k, k) + self%advance(k)
      end do
      matrix(:n, n + 1) = self%by_parameter
      matrix(n + 1, :) = self%border
      call lu%factor(matrix, singular)
      step%sound = .not. singular
      if (singular) return
      x = 0.0_dp
      x(:n, 1) = self%rest
      x(n + 1, 2) = 1.0_dp
      call lu%solve(x)
      step%tangent = x(:, 2)/norm2(x(:, 2))
      step%change = x(:, 1)
      step%is_reversed = lu%negative_determinant()
   end subroutine solve

   !> Change of the coordinate for the length along the graph.
   pure function coordinate_rate(graph, coordinate, body, length) result(rate)
      type(conductance_graph_type), intent(in) :: graph
      real(dp), intent(in) :: coordinate    !! [length]
      real(dp), intent(in) :: body          !! of the bodies about the contact point [as omega]
      real(dp), intent(in) :: length        !! scale of openings [length]
      real(dp) :: rate                      !! [length]

      associate (omega => graph%omega(coordinate), advance => graph%advance(coordinate), &
         slope => graph%derivative(coordinate))
         rate = 1.0_dp/(advance/length + body/(omega + body)*abs(slope)/(omega + body))
      end associate
   end function coordinate_rate

   !> Coordinates at the ends of walks along the graphs, of given lengths.
   elemental function moved_along(graph, from, walk, body, length) result(coordinate)
      type(conductance_graph_type), intent(in) :: graph
      real(dp), intent(in) :: from     !! [length]
      real(dp), intent(in) :: walk     !! towards open where it is positive [-]
      real(dp), intent(in) :: body     !! [as omega]
      real(dp), intent(in) :: length   !! [length]
      real(dp) :: coordinate           !! [length]
      real(dp) :: near, far
      integer :: i

      near = from
      far = from + walk*length + sign(graph%width, walk)
      do i = 1, 200
         coordinate = 0.5_dp*(near + far)
         if (abs(far - near) <= 2*epsilon(1.0_dp)*abs(coordinate)) exit
         if (distance(graph, min(from, coordinate), max(from, coordinate), body, &
            length) > abs(walk)) then
            far = coordinate
         else
            near = coordinate
         end if
      end do
   end function moved_along

   !> Length along the graph between two coordinates: the opening's change and the variation of the
   !> share, which may turn at the rows of tables and at the ends of a rest.
   pure function distance(graph, low, high, body, length)
      type(conductance_graph_type), intent(in) :: graph
      real(dp), intent(in) :: low, high, body, length
      real(dp) :: distance
      real(dp), allocatable :: coordinate(:), share(:)

      associate (kinks => graph%kinks())
         coordinate = [low, pack(kinks, kinks > low .and. kinks < high), high]
      end associate
      share = graph%omega(coordinate)
      share = share/(share + body)
      distance = (graph%opening(high) - graph%opening(low))/length + &
         sum(abs(share(2:) - share(:size(share) - 1)))
   end function distance

end module path_steps
