!> Points of each kind of element at which fields are taken or integrated, with what its shape
!> functions are there.
module point_rules
   use element_kinds, only: element_node_count, kind_count
   use kinds, only: dp
   use material_laws, only: most_points_of_law
   use mesh, only: nodes_per_element
   use quadrature, only: integration_rule, load_point_count, load_rule, point_count
   use shape_functions, only: element_gradients, element_shape, node_position
   implicit none
   private
   public :: point_rule_type, point_rule, integration_rules, load_rules, most_points_of_rule

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

end module point_rules
