!> Gauss points on [-1, 1], on the square and on the triangle; points of each kind of element at
!> which fields are taken or integrated, with what its shape functions are there.
module quadrature
   use element_kinds, only: element_node_count, kind_count, quad4, quad4_enhanced, quad8, &
      quad8_reduced, triangle3, triangle6
   use kinds, only: dp
   use material_laws, only: most_points_of_law
   use mesh, only: nodes_per_element
   use shape_functions, only: element_gradients, element_shape, node_position
   implicit none
   private
   public :: gauss_point_3, gauss_weight_3, gauss_coordinate_2, gauss_point_10, gauss_weight_10
   public :: point_count, most_points, integration_rule, load_point_count, load_rule
   public :: recovery_count, recovery_points, recovery_weights
   public :: point_rule_type, point_rule, integration_rules, load_rules, most_points_of_rule

   real(dp), parameter :: gauss_point_3(3) = &
      [-0.774596669241483377_dp, 0.0_dp, 0.774596669241483377_dp]     !! roots of P3
   real(dp), parameter :: gauss_weight_3(3) = &
      [5.0_dp/9.0_dp, 8.0_dp/9.0_dp, 5.0_dp/9.0_dp]                    !! their weights
   real(dp), parameter :: gauss_coordinate_2 = 0.577350269189625765_dp !! root of P2

   real(dp), parameter :: upper_point_10(5) = [0.148874338981631211_dp, 0.433395394129247191_dp, &
      0.679409568299024406_dp, 0.865063366688984511_dp, 0.973906528517171720_dp] !! roots of P10
   real(dp), parameter :: upper_weight_10(5) = [0.295524224714752870_dp, 0.269266719309996355_dp, &
      0.219086362515982044_dp, 0.149451349150580593_dp, 0.0666713443086881376_dp]
   real(dp), parameter :: gauss_point_10(10) = [-upper_point_10, upper_point_10]
   real(dp), parameter :: gauss_weight_10(10) = [upper_weight_10, upper_weight_10]

   !> Points of integration_rule by the kind of the element.
   integer, parameter :: point_count(kind_count) = [9, 4, 4, 3, 3, 4]

   integer, parameter :: most_points = 9   !! largest of them

   !> Points of recovery_points by the kind of the element.
   integer, parameter :: recovery_count(kind_count) = [4, 4, 4, 3, 1, 4]

   real(dp), parameter :: square_corner(2, 4) = &
      reshape([-1.0_dp, -1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp], [2, 4])

   !> Points of load_rule by the kind of the element.
   integer, parameter :: load_point_count(kind_count) = [9, 9, 9, 6, 6, 9]

   ! The rule of degree 4 on the triangle: two orbits of three points, their area coordinate and
   ! weight. Dunavant, Int. J. Num. Meth. Eng. 21 (1985) 1129.
   real(dp), parameter :: orbit_coordinate(2) = [0.445948490915964886_dp, 0.0915762135097707435_dp]
   real(dp), parameter :: orbit_weight(2) = [0.111690794839005733_dp, 0.0549758718276609338_dp]

   integer, parameter :: most_points_of_rule = most_points_of_law  !! of an element, made even
   integer, parameter :: most = most_points_of_rule

   !> Points of a kind of element, with what its shape functions are there.
   type :: point_rule_type
      integer :: count = 0                         !! number of points
      integer :: nodes = 0                         !! nodes of the kind
      real(dp) :: weight(most) = 0.0_dp            !! sum 4 (square) or 1/2 (triangle)
      real(dp) :: shape(most, nodes_per_element) = 0.0_dp      !! (points, nodes) psi
      real(dp) :: slope_xi(most, nodes_per_element) = 0.0_dp   !! d psi/d xi
      real(dp) :: slope_eta(most, nodes_per_element) = 0.0_dp  !! d psi/d eta
   end type point_rule_type

contains

   !> Points at which the matrices of an element are formed: 3 x 3 on the square, 2 x 2 where the
   !> kind is reduced or linear, three inside the triangle. On the square they are in rows from
   !> the side 1-2 on, as CalculiX numbers them.
   pure subroutine integration_rule(kind, points, weights)
      integer, intent(in) :: kind                           !! kind of the element
      real(dp), intent(out) :: points(2, point_count(kind)) !! xi, eta of each point
      real(dp), intent(out) :: weights(point_count(kind))   !! sum 4 (square) or 1/2 (triangle)

      select case (kind)
      case (quad8)
         call square_3(points, weights)
      case (quad8_reduced, quad4, quad4_enhanced)
         points = gauss_coordinate_2*square_corner(:, [1, 2, 4, 3])
         weights = 1.0_dp
      case (triangle6, triangle3)
         points = orbit(1.0_dp/6.0_dp)
         weights = 1.0_dp/6.0_dp
      case default
         points = 0.0_dp
         weights = 0.0_dp
      end select
   end subroutine integration_rule

   !> Points for integrals of loads, exact where the sides are straight: 3 x 3 on the square, six of
   !> degree 4 in the triangle.
   pure subroutine load_rule(kind, points, weights)
      integer, intent(in) :: kind                                !! kind of the element
      real(dp), intent(out) :: points(2, load_point_count(kind)) !! xi, eta of each point
      real(dp), intent(out) :: weights(load_point_count(kind))   !! sum 4 (square) or 1/2 (triangle)

      if (kind == triangle6 .or. kind == triangle3) then
         points(:, 1:3) = orbit(orbit_coordinate(1))
         points(:, 4:6) = orbit(orbit_coordinate(2))
         weights(1:3) = orbit_weight(1)
         weights(4:6) = orbit_weight(2)
      else
         call square_3(points, weights)
      end if
   end subroutine load_rule

   !> Points at which stress and flux are most accurate: 2 x 2 on the square, the three of
   !> integration_rule in the six-node triangle, the centre of the three-node one.
   pure function recovery_points(kind) result(points)
      integer, intent(in) :: kind                   !! kind of the element
      real(dp) :: points(2, recovery_count(kind))   !! xi, eta of each point

      select case (kind)
      case (triangle6)
         points = orbit(1.0_dp/6.0_dp)
      case (triangle3)
         points = 1.0_dp/3.0_dp
      case default
         points = gauss_coordinate_2*square_corner
      end select
   end function recovery_points

   !> Weights of the values at recovery_points in the value at a point of the element: bilinear on
   !> the square, linear in the six-node triangle, constant in the three-node one.
   pure function recovery_weights(kind, point) result(weights)
      integer, intent(in) :: kind                   !! kind of the element
      real(dp), intent(in) :: point(2)              !! xi, eta
      real(dp) :: weights(recovery_count(kind))     !! their sum is 1
      real(dp) :: scaled(2)

      select case (kind)
      case (triangle6)
         weights = 2*[1 - point(1) - point(2), point(1), point(2)] - 1.0_dp/3.0_dp
      case (triangle3)
         weights = 1.0_dp
      case default
         scaled = point/gauss_coordinate_2
         weights = (1 + scaled(1)*square_corner(1, :))*(1 + scaled(2)*square_corner(2, :))/4
      end select
   end function recovery_weights

   !> The 3 x 3 rule, exact for products of polynomials of degree 5.
   pure subroutine square_3(points, weights)
      real(dp), intent(out) :: points(2, 9), weights(9)
      integer :: i, j

      do j = 1, 3
         do i = 1, 3
            points(:, 3*(j - 1) + i) = [gauss_point_3(i), gauss_point_3(j)]
            weights(3*(j - 1) + i) = gauss_weight_3(i)*gauss_weight_3(j)
         end do
      end do
   end subroutine square_3

   !> The three points of which two area coordinates are a, the first nearest to corner 1 if
   !> a < 1/3.
   pure function orbit(a) result(points)
      real(dp), intent(in) :: a
      real(dp) :: points(2, 3)

      points = reshape([a, a, 1 - 2*a, a, a, 1 - 2*a], [2, 3])
   end function orbit

   !> Points of a kind of element, with its shape functions there.
   pure function point_rule(kind, points, weights) result(rule)
      integer, intent(in) :: kind
      real(dp), intent(in) :: points(:, :)   !! (2, points) xi, eta
      real(dp), intent(in) :: weights(:)     !! (points)
      type(point_rule_type) :: rule
      real(dp) :: slope(2, element_node_count(kind)), jacobian
      integer :: g

      rule%nodes = element_node_count(kind)
      rule%count = size(weights)
      rule%weight(:rule%count) = weights
      do g = 1, rule%count
         rule%shape(g, :rule%nodes) = element_shape(kind, points(:, g))
         ! In the reference element x is xi and y is eta.
         call element_gradients(kind, node_position(kind), points(:, g), slope, jacobian)
         rule%slope_xi(g, :rule%nodes) = slope(1, :)
         rule%slope_eta(g, :rule%nodes) = slope(2, :)
      end do
   end function point_rule

   !> Integration points of every kind of element.
   pure function integration_rules() result(rules)
      type(point_rule_type) :: rules(kind_count)
      real(dp) :: points(2, most), weights(most)
      integer :: kind

      do kind = 1, kind_count
         associate (n => point_count(kind))
            call integration_rule(kind, points(:, :n), weights(:n))
            rules(kind) = point_rule(kind, points(:, :n), weights(:n))
         end associate
      end do
   end function integration_rules

   !> Points for integrals of loads and heat contents.
   pure function load_rules() result(rules)
      type(point_rule_type) :: rules(kind_count)
      real(dp) :: points(2, most), weights(most)
      integer :: kind

      do kind = 1, kind_count
         associate (n => load_point_count(kind))
            call load_rule(kind, points(:, :n), weights(:n))
            rules(kind) = point_rule(kind, points(:, :n), weights(:n))
         end associate
      end do
   end function load_rules

end module quadrature
