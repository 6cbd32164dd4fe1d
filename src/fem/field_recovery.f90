!> Stress and heat flux at nodes: evaluated at the points where they are best, extrapolated to the
!> nodes, averaged over the elements of one body and section. A node shared by several sections so
!> is several points.
!>
!> The estimate of Zienkiewicz & Zhu (Int. J. Num. Meth. Eng. 24 (1987) 337) in one element: how far
!> its stress or flux s is from a smooth one s*, which is better, given at the nodes.
!>
!> Points: 3 x 3 in elements of eight nodes, 2 x 2 in those of four, six and three in triangles. In
!> parallelograms and straight triangles these integrate the square of s* - s exactly, s* being of
!> the element's shape functions. Not the 2 x 2 points at which s of elements of eight nodes is
!> best: there s* is s, but for what smoothing leaves, and their sum would be near zero.
module field_recovery
   use element_kinds, only: element_corner_count, element_node_count, kind_count, quad8, &
      quad8_reduced, triangle3, triangle6
   use kinds, only: dp
   use mesh, only: mesh_type, nodes_per_element
   use material_points, only: material_points_type
   use quadrature, only: integration_rule, integration_rules, load_rules, &
      most => most_points_of_rule, point_count, point_rule, point_rule_type, recovery_count, &
      recovery_points, recovery_weights
   use shape_functions, only: node_position
   implicit none
   private
   public :: point_map_type, make_points, recovery_rules, stress_samples, &
      heat_flux_samples, average_samples, fit_of_points, element_error_type, measure_stress, &
      measure_heat_flux, error_rules, error_record_type, squared_errors

   !> Relative error of a body below which its fields are smooth but for rounding.
   real(dp), parameter :: smooth = 1.0e-8_dp

   !> Estimated discretisation error of stress or of heat flux (Zienkiewicz & Zhu).
   type :: error_record_type
      !> (bodies) error in the energy norm, relative to that of the whole; 0 without either
      real(dp), allocatable :: body(:)
      !> (elements) root mean square of the difference to the recovered field [stress or flux]
      real(dp), allocatable :: element(:)
   end type error_record_type

   !> Integrals over an element.
   type :: element_error_type
      real(dp) :: error = 0.0_dp    !! of (s* - s)^T C^-1 (s* - s)
      real(dp) :: energy = 0.0_dp   !! of s^T C^-1 s
      real(dp) :: square = 0.0_dp   !! of |s* - s|^2
      real(dp) :: volume = 0.0_dp   !! of one
   end type element_error_type

   !> The points at which averaged fields live: one per node and section.
   type :: point_map_type
      integer, allocatable :: node(:)               !! (points) node index
      integer, allocatable :: element_points(:, :)  !! (8, elements) point of each node, or 0
      integer, allocatable :: sharing(:)            !! (points) elements that meet there
   end type point_map_type

contains

   !> Numbers the points: first one per node in the order of the nodes, then further ones for
   !> further sections.
   pure function make_points(mesh) result(points)
      type(mesh_type), intent(in) :: mesh
      type(point_map_type) :: points        !! the points
      integer :: owner(size(mesh%node_number)), element, i, k, n, node
      integer, allocatable :: extra_node(:), extra_section(:)

      n = size(mesh%node_number)
      owner = 0
      allocate (extra_node(0), extra_section(0))
      allocate (points%element_points, mold=mesh%element_nodes)
      points%element_points = 0
      do element = 1, size(mesh%element_number)
         do i = 1, element_node_count(mesh%element_kind(element))
            node = mesh%element_nodes(i, element)
            points%element_points(i, element) = node
            if (owner(node) == 0) owner(node) = mesh%element_section(element)
            if (owner(node) == mesh%element_section(element)) cycle
            do k = 1, size(extra_node)
               if (extra_node(k) == node .and. &
                  extra_section(k) == mesh%element_section(element)) exit
            end do
            if (k > size(extra_node)) then
               extra_node = [extra_node, node]
               extra_section = [extra_section, mesh%element_section(element)]
            end if
            points%element_points(i, element) = n + k
         end do
      end do
      points%node = [[(i, i=1, n)], extra_node]
      allocate (points%sharing(size(points%node)), source=0)
      do element = 1, size(mesh%element_number)
         associate (mine => points%element_points(:element_node_count(mesh%element_kind(element)), &
            element))
            points%sharing(mine) = points%sharing(mine) + 1
         end associate
      end do
   end function make_points

   !> Recovery points of every kind of element. Equal weights are right for the four-node element,
   !> whose mean dilatation is that over these points.
   pure function recovery_rules() result(rules)
      type(point_rule_type) :: rules(kind_count)
      integer :: k

      do k = 1, kind_count
         rules(k) = point_rule(k, recovery_points(k), spread(1.0_dp, 1, recovery_count(k)))
      end do
   end function recovery_rules

   !> Stress at all recovery points along x and y, eq. (1.5).
   pure subroutine stress_samples(fields, mesh, displacement, temperature, samples)
      type(material_points_type), intent(in) :: fields   !! at recovery_rules
      type(mesh_type), intent(in) :: mesh
      real(dp), intent(in) :: displacement(:, :)      !! (2, nodes) [length]
      real(dp), intent(in) :: temperature(:) !! (nodes) over the natural state [temperature]
      real(dp), intent(out) :: samples(:, :)          !! (4, recovery points) [stress]
      real(dp) :: values(most, 4)
      integer :: e, i

      values = 0.0_dp
      do e = 1, size(mesh%element_kind)
         call fields%stress(mesh, e, displacement, temperature, values)
         do i = fields%first(e), fields%first(e + 1) - 1
            samples(:, i) = values(i - fields%first(e) + 1, :)
         end do
      end do
   end subroutine stress_samples

   !> Heat flux at all recovery points along x and y, eq. (1.4).
   pure subroutine heat_flux_samples(fields, mesh, temperature, samples)
      type(material_points_type), intent(in) :: fields   !! at recovery_rules
      type(mesh_type), intent(in) :: mesh
      real(dp), intent(in) :: temperature(:)          !! (nodes) [temperature]
      real(dp), intent(out) :: samples(:, :)          !! (2, recovery points) [power/length^2]
      real(dp) :: values(most, 2)
      integer :: e, i

      values = 0.0_dp
      do e = 1, size(mesh%element_kind)
         call fields%heat_flux(mesh, e, temperature, values)
         do i = fields%first(e), fields%first(e + 1) - 1
            samples(:, i) = values(i - fields%first(e) + 1, :)
         end do
      end do
   end subroutine heat_flux_samples

   !> Values at the recovery points by the linear or bilinear fit of values at the integration
   !> points, weighted as the integration. On the square 1, xi, eta and xi eta are orthogonal; in
   !> triangles the fit is that through all points, or their mean.
   pure function fit_of_points(kind) result(fit)
      integer, intent(in) :: kind                    !! kind of the element
      real(dp) :: fit(recovery_count(kind), point_count(kind)), points(2, point_count(kind)), &
         weights(point_count(kind)), there(4, point_count(kind)), here(4, recovery_count(kind))
      integer :: i, j

      call integration_rule(kind, points, weights)
      fit = 0.0_dp
      if (kind == triangle6) then
         fit = reshape([((merge(1.0_dp, 0.0_dp, i == j), i=1, 3), j=1, 3)], [3, 3])
      else if (kind == triangle3) then
         fit(1, :) = weights/sum(weights)
      else
         there = bilinear(points)
         here = bilinear(recovery_points(kind))
         do i = 1, 4
            here(i, :) = here(i, :)/sum(weights*there(i, :)**2)
         end do
         fit = matmul(transpose(here), there)*spread(weights, 1, recovery_count(kind))
      end if
   contains
      pure function bilinear(at) result(values)
         real(dp), intent(in) :: at(:, :)
         real(dp) :: values(4, size(at, 2))

         values(1, :) = 1.0_dp
         values(2:3, :) = at
         values(4, :) = at(1, :)*at(2, :)
      end function bilinear
   end function fit_of_points

   !> Values at the points: extrapolated in each element to its nodes, then averaged.
   pure function average_samples(mesh, points, samples) result(values)
      type(mesh_type), intent(in) :: mesh
      type(point_map_type), intent(in) :: points
      real(dp), intent(in) :: samples(:, :)          !! (components, recovery points), 2 or 4
      real(dp) :: values(size(samples, 1), size(points%node))   !! (components, points)
      real(dp) :: weights(4, 8, kind_count), position(2, 8)
      integer :: e, first, i, k, n, q

      do k = 1, kind_count
         position(:, :element_node_count(k)) = node_position(k)
         do q = 1, element_node_count(k)
            weights(:recovery_count(k), q, k) = recovery_weights(k, position(:, q))
         end do
      end do
      values = 0.0_dp
      first = 1
      do e = 1, size(mesh%element_kind)
         associate (kind => mesh%element_kind(e))
            n = recovery_count(kind)
            do q = 1, element_node_count(kind)
               call add_samples(size(samples, 1), n, samples(:, first:first + n - 1), &
                  weights(:n, q, kind), values(:, points%element_points(q, e)))
            end do
            first = first + n
         end associate
      end do
      do i = 1, size(points%sharing)
         if (points%sharing(i) > 1) values(:, i) = values(:, i)/points%sharing(i)
      end do
   end function average_samples

   pure subroutine add_samples(components, n, samples, weights, values)
      integer, intent(in) :: components, n
      real(dp), intent(in) :: samples(components, n), weights(n)
      real(dp), intent(inout) :: values(components)
      integer :: c, k

      do c = 1, components, 2
         do k = 1, n
            values(c:c + 1) = values(c:c + 1) + weights(k)*samples(c:c + 1, k)
         end do
      end do
   end subroutine add_samples

   !> The points at which errors are integrated.
   pure function error_rules() result(rules)
      type(point_rule_type) :: rules(kind_count)   !! by kind; weights sum to 4 (square) or 1/2
      integer, parameter :: higher(3) = [quad8, quad8_reduced, triangle6]
      type(point_rule_type) :: of_loads(kind_count)

      rules = integration_rules()
      of_loads = load_rules()
      rules(higher) = of_loads(higher)
   end function error_rules

   !> The integrals of stress over two points of an element.
   pure subroutine measure_stress(rule, g, smooth, values, compliance, volume, measured)
      type(point_rule_type), intent(in) :: rule             !! points of the kind
      integer, intent(in) :: g                              !! first of the two points
      real(dp), intent(in) :: smooth(4, nodes_per_element)  !! s* at the nodes [stress]
      real(dp), intent(in) :: values(most, 4)               !! s at the points [stress]
      real(dp), intent(in) :: compliance(4, 4)              !! C^-1 [1/stress]
      real(dp), intent(in) :: volume(2)                     !! that each stands for [length^3]
      type(element_error_type), intent(inout) :: measured   !! the integrals, added to
      real(dp) :: d(2, 4), error(2), energy(2)
      integer :: i, q

      d = -values(g:g + 1, :)
      do q = 1, rule%nodes
         d(:, 1) = d(:, 1) + rule%shape(g:g + 1, q)*smooth(1, q)
         d(:, 2) = d(:, 2) + rule%shape(g:g + 1, q)*smooth(2, q)
         d(:, 3) = d(:, 3) + rule%shape(g:g + 1, q)*smooth(3, q)
         d(:, 4) = d(:, 4) + rule%shape(g:g + 1, q)*smooth(4, q)
      end do
      error = 0.0_dp
      energy = 0.0_dp
      do i = 1, 4
         error = error + d(:, i)*(compliance(1, i)*d(:, 1) + compliance(2, i)*d(:, 2) + &
            compliance(3, i)*d(:, 3) + compliance(4, i)*d(:, 4))
         energy = energy + values(g:g + 1, i)*(compliance(1, i)*values(g:g + 1, 1) + &
            compliance(2, i)*values(g:g + 1, 2) + compliance(3, i)*values(g:g + 1, 3) + &
            compliance(4, i)*values(g:g + 1, 4))
      end do
      measured%error = measured%error + sum(volume*error)
      measured%energy = measured%energy + sum(volume*energy)
      ! Shear stress is twice in the tensor.
      measured%square = measured%square + sum(volume*(d(:, 1)**2 + d(:, 2)**2 + d(:, 3)**2 + &
         2*d(:, 4)**2))
      measured%volume = measured%volume + sum(volume)
   end subroutine measure_stress

   !> The integrals of heat flux over two points of an element.
   pure subroutine measure_heat_flux(rule, g, smooth, values, resistivity, volume, measured)
      type(point_rule_type), intent(in) :: rule             !! points of the kind
      integer, intent(in) :: g                              !! first of the two points
      real(dp), intent(in) :: smooth(2, nodes_per_element)  !! s* at the nodes [power/length^2]
      real(dp), intent(in) :: values(most, 2)               !! s at the points [power/length^2]
      real(dp), intent(in) :: resistivity(2, 2)             !! C^-1 [length temperature/power]
      real(dp), intent(in) :: volume(2)                     !! that each stands for [length^3]
      type(element_error_type), intent(inout) :: measured   !! the integrals, added to
      real(dp) :: d(2, 2), x(2), y(2)
      integer :: q

      x = values(g:g + 1, 1)
      y = values(g:g + 1, 2)
      d(:, 1) = -x
      d(:, 2) = -y
      do q = 1, rule%nodes
         d(:, 1) = d(:, 1) + rule%shape(g:g + 1, q)*smooth(1, q)
         d(:, 2) = d(:, 2) + rule%shape(g:g + 1, q)*smooth(2, q)
      end do
      associate (c => resistivity)
         measured%error = measured%error + sum(volume*(c(1, 1)*d(:, 1)**2 + &
            2*c(1, 2)*d(:, 1)*d(:, 2) + c(2, 2)*d(:, 2)**2))
         measured%energy = measured%energy + sum(volume*(c(1, 1)*x**2 + 2*c(1, 2)*x*y + &
            c(2, 2)*y**2))
      end associate
      measured%square = measured%square + sum(volume*(d(:, 1)**2 + d(:, 2)**2))
      measured%volume = measured%volume + sum(volume)
   end subroutine measure_heat_flux

   !> The part that each element has in the squared relative error of its body.
   pure function squared_errors(mesh, estimate) result(error)
      type(mesh_type), intent(in) :: mesh
      type(error_record_type), intent(in) :: estimate    !! of the fields of an increment, or none
      real(dp) :: error(size(mesh%element_kind)), area, sums(mesh%body_count)
      integer :: e

      error = 0.0_dp
      if (.not. allocated(estimate%element)) return
      sums = 0.0_dp
      do e = 1, size(error)
         associate (b => mesh%element_body(e), x => mesh%coordinates(:, mesh%element_nodes( &
            :element_corner_count(mesh%element_kind(e)), e)))
            area = 0.5_dp*abs(sum(x(1, :)*cshift(x(2, :), 1) - cshift(x(1, :), 1)*x(2, :)))
            if (estimate%body(b) > smooth) error(e) = estimate%element(e)**2*area
            sums(b) = sums(b) + error(e)
         end associate
      end do
      do e = 1, size(error)
         associate (b => mesh%element_body(e))
            if (sums(b) > 0.0_dp) error(e) = estimate%body(b)**2*error(e)/sums(b)
         end associate
      end do
   end function squared_errors

end module field_recovery
