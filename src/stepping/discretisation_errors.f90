!> Stress and flux of an increment, and how far they are from smooth ones (Zienkiewicz & Zhu): what
!> geometry and materials give is formed once a run.
module discretisation_errors
   use element_kinds, only: element_node_count, kind_count
   use field_recovery, only: average_samples, element_error_type, error_record_type, error_rules, &
      fit_of_points, heat_flux_samples, make_points, measure_heat_flux, measure_stress, &
      point_map_type, recovery_rules, stress_samples
   use kinds, only: dp
   use material_laws, only: law_points_type
   use materials, only: has_law, varies
   use mesh, only: mesh_type, nodes_per_element
   use model, only: model_type
   use patch_recovery, only: patch_recovery_type
   use material_points, only: material_points_type
   use point_histories, only: point_history_type
   use quadrature, only: integration_rules, most => most_points_of_rule, point_count, &
      recovery_count, recovery_weights
   use shape_functions, only: node_position
   implicit none
   private
   public :: recovery_type

   !> Largest value, or the inverse of the smallest, of which squares are taken as they are.
   real(dp), parameter :: large = 1.0e70_dp
   !> A field is rounding where it is below this part of the terms that cancel in it, some hundred
   !> spacings of numbers; rounding is nowhere smooth, so its error is above `unsmooth`.
   real(dp), parameter :: rounding = 1.0e-13_dp, unsmooth = 0.1_dp

   !> Where stress and flux are taken, averaged, smoothed and compared.
   type :: recovery_type
      private
      type(point_map_type), public :: points     !! where averaged fields live
      type(material_points_type) :: samples         !! recovery points
      type(material_points_type) :: quadrature      !! points at which errors are integrated
      !> Integration points, where laws of materials are or points of elements are asked for
      type(material_points_type), allocatable, public :: integration
      !> (recovery points, points of integration or quadrature, kinds) bilinear fits
      real(dp) :: fits(4, most, kind_count) = 0.0_dp, at_quadrature(4, most, kind_count) = 0.0_dp
      type(patch_recovery_type) :: patches       !! smooth nodal values from the recovery points
      !> (elements) factors of displacements, of temperatures over the natural state, and of
      !> temperatures in stress, stress and heat flux, at most
      real(dp), allocatable :: of_displacement(:), of_expansion(:), of_temperature(:)
   contains
      procedure :: prepare
      procedure :: recover_stress
      procedure :: recover_strains
      procedure :: recover_heat_flux
   end type recovery_type

contains

   !> Forms what stays; fields are as good as they can be in the elements that count.
   subroutine prepare(self, model, counts)
      class(recovery_type), intent(out) :: self
      type(model_type), intent(in) :: model
      logical, intent(in) :: counts(:)           !! (elements)
      real(dp), allocatable :: position(:, :)
      real(dp) :: gradient
      integer :: e, n

      self%points = make_points(model%mesh)
      call self%samples%prepare(model%mesh, model%sections, model%materials, &
         model%orientations, recovery_rules())
      call self%quadrature%prepare(model%mesh, model%sections, model%materials, &
         model%orientations, error_rules())
      ! A point of these rules may be in the fold of an element: the integrand counts as elsewhere.
      self%quadrature%volume = abs(self%quadrature%volume)
      allocate (position(2, self%samples%first(size(self%samples%first)) - 1))
      do e = 1, size(model%mesh%element_kind)
         position(:, self%samples%first(e):self%samples%first(e + 1) - 1) = &
            self%samples%positions(model%mesh, e)
      end do
      call self%patches%prepare(model%mesh, self%points, self%samples%first, position, counts)
      associate (fields => self%samples)
         n = size(fields%material)
         allocate (self%of_displacement(n), self%of_expansion(n), self%of_temperature(n))
         do e = 1, n
            gradient = maxval(abs(fields%inverse(:, fields%first(e):fields%first(e + 1) - 1)))
            associate (material => fields%materials(fields%material(e)))
               self%of_displacement(e) = gradient*maxval(abs(material%elasticity))
               self%of_expansion(e) = maxval(abs(material%thermal_modulus))
               self%of_temperature(e) = gradient*maxval(abs(material%conductivity))
            end associate
         end do
      end associate
      if (any(has_law(model%materials)) .or. any([(allocated(model%steps(e)%element_prints), &
         e=1, size(model%steps))])) call prepare_integration(self, model)
   end subroutine prepare

   !> Forms what stays of integration points.
   subroutine prepare_integration(self, model)
      type(recovery_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(dp) :: points(2, most)
      integer :: g, k

      allocate (self%integration)
      call self%integration%prepare(model%mesh, model%sections, model%materials, &
         model%orientations, integration_rules())
      do k = 1, kind_count
         self%fits(:recovery_count(k), :point_count(k), k) = fit_of_points(k)
         associate (rule => self%quadrature%rules(k))
            points(:, :rule%count) = matmul(node_position(k), transpose(rule%shape(:rule%count, &
               :rule%nodes)))
            do g = 1, rule%count
               self%at_quadrature(:recovery_count(k), g, k) = recovery_weights(k, points(:, g))
            end do
         end associate
      end do
   end subroutine prepare_integration

   !> Stress, averaged at the points, and its estimated error.
   pure subroutine recover_stress(self, model, displacement, temperature, remembered, stress, &
      estimate)
      class(recovery_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: displacement(:, :)           !! (2, nodes) [length]
      real(dp), intent(in) :: temperature(:) !! (nodes) over the natural state [temperature]
      real(dp), allocatable, intent(in) :: remembered(:)   !! by all points, or none
      real(dp), allocatable, intent(out) :: stress(:, :)   !! (4, points) xx, yy, zz, xy [stress]
      type(error_record_type), intent(out) :: estimate
      type(element_error_type) :: errors(size(model%mesh%element_kind))
      real(dp), allocatable :: samples(:, :), smooth(:, :)
      real(dp) :: values(most, 4), least, scale
      integer :: e
      logical :: follows

      call set_temperature(self, model, temperature + model%initial_temperature)
      values = 0.0_dp
      allocate (samples(4, self%samples%first(size(self%samples%first)) - 1))
      allocate (smooth(4, size(self%points%node)))
      call stress_samples(self%samples, model%mesh, displacement, temperature, samples)
      if (allocated(remembered)) call follow_laws(self, model, displacement, temperature, &
         remembered, samples)
      stress = average_samples(model%mesh, self%points, samples)
      call self%patches%recover(4, samples, smooth)
      call self%patches%improve(4, samples, smooth, stress)
      scale = scale_of(samples)
      do e = 1, size(errors)
         call self%quadrature%stress(model%mesh, e, displacement, temperature, values)
         follows = allocated(remembered)
         if (follows) follows = self%integration%follows_law(model%mesh, e)
         if (follows) then
            associate (kind => model%mesh%element_kind(e), first => self%samples%first(e))
               associate (n => self%quadrature%rules(kind)%count, m => recovery_count(kind))
                  values(:n, :) = transpose(matmul(samples(:, first:first + m - 1), &
                     self%at_quadrature(:m, :n, kind)))
               end associate
            end associate
         end if
         call compare(self, model, e, 1/scale, smooth, values, errors(e))
      end do
      estimate = sum_up(model, scale, errors)
      if (.not. any(estimate%body > unsmooth)) return
      least = largest_term(model%mesh, self%of_displacement, maxval(abs(displacement), dim=1)) + &
         largest_term(model%mesh, self%of_expansion, temperature)
      call drop_rounding(model, self%samples%first, samples, rounding*least, estimate%body)
   end subroutine recover_stress

   !> Stress by the laws of materials: the fit of that at the integration points.
   pure subroutine follow_laws(self, model, displacement, temperature, remembered, samples)
      type(recovery_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: displacement(:, :), temperature(:), remembered(:)
      real(dp), intent(inout) :: samples(:, :)             ! (4, recovery points)
      type(point_history_type) :: history
      type(law_points_type) :: points
      integer :: e, n

      history%before = remembered
      history%after = remembered
      do e = 1, size(model%mesh%element_kind)
         if (.not. self%integration%follows_law(model%mesh, e)) cycle
         call self%integration%respond(model%mesh, e, displacement, temperature, history, points)
         associate (kind => model%mesh%element_kind(e), first => self%samples%first(e))
            n = recovery_count(kind)
            samples(:, first:first + n - 1) = transpose(matmul(self%fits(:n, :points%count, &
               kind), points%stress(:points%count, :)))
         end associate
      end do
   end subroutine follow_laws

   !> Inelastic strains, averaged at the points, of what the integration points remember.
   pure subroutine recover_strains(self, model, remembered, strains)
      class(recovery_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: remembered(:)                !! by all points
      real(dp), allocatable, intent(out) :: strains(:, :)  !! (10, points) as in the record
      real(dp) :: samples(10, self%samples%first(size(self%samples%first)) - 1), there(most, 10)
      integer :: e, n

      do e = 1, size(model%mesh%element_kind)
         call self%integration%take_strains(model%mesh, e, remembered, there)
         associate (kind => model%mesh%element_kind(e), first => self%samples%first(e))
            n = recovery_count(kind)
            samples(:, first:first + n - 1) = transpose(matmul(self%fits(:n, :point_count(kind), &
               kind), there(:point_count(kind), :)))
         end associate
      end do
      strains = average_samples(model%mesh, self%points, samples)
      ! What is extrapolated to a node behind the plastic zone may be below 0.
      strains([5, 10], :) = max(strains([5, 10], :), 0.0_dp)
   end subroutine recover_strains

   !> Heat flux, averaged at the points, and its estimated error.
   pure subroutine recover_heat_flux(self, model, temperature, flux, estimate)
      class(recovery_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: temperature(:)               !! (nodes) [temperature]
      real(dp), allocatable, intent(out) :: flux(:, :)     !! (2, points) x, y [power/length^2]
      type(error_record_type), intent(out) :: estimate
      type(element_error_type) :: errors(size(model%mesh%element_kind))
      real(dp), allocatable :: samples(:, :), smooth(:, :)
      real(dp) :: values(most, 2), least, scale
      integer :: e

      call set_temperature(self, model, temperature)
      values = 0.0_dp
      allocate (samples(2, self%samples%first(size(self%samples%first)) - 1))
      allocate (smooth(2, size(self%points%node)))
      call heat_flux_samples(self%samples, model%mesh, temperature, samples)
      flux = average_samples(model%mesh, self%points, samples)
      call self%patches%recover(2, samples, smooth)
      call self%patches%improve(2, samples, smooth, flux)
      scale = scale_of(samples)
      do e = 1, size(errors)
         call self%quadrature%heat_flux(model%mesh, e, temperature, values)
         call compare(self, model, e, 1/scale, smooth, values, errors(e))
      end do
      estimate = sum_up(model, scale, errors)
      if (.not. any(estimate%body > unsmooth)) return
      least = largest_term(model%mesh, self%of_temperature, temperature)
      call drop_rounding(model, self%samples%first, samples, rounding*least, estimate%body)
   end subroutine recover_heat_flux

   !> Properties that follow temperatures are those of the field.
   pure subroutine set_temperature(self, model, temperature)
      type(recovery_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: temperature(:)               ! (nodes) [temperature]

      if (.not. any(varies(model%materials))) return
      call self%samples%set_temperature(model%mesh, temperature, model%initial_temperature)
      call self%quadrature%set_temperature(model%mesh, temperature, model%initial_temperature)
      if (allocated(self%integration)) call self%integration%set_temperature(model%mesh, &
         temperature, model%initial_temperature)
   end subroutine set_temperature

   !> The largest of the terms whose sum a field is.
   pure real(dp) function largest_term(mesh, factor, on_nodes)
      type(mesh_type), intent(in) :: mesh
      real(dp), intent(in) :: factor(:)       ! (elements)
      real(dp), intent(in) :: on_nodes(:)     ! (nodes)
      integer :: e

      largest_term = 0.0_dp
      do e = 1, size(factor)
         associate (nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(e)), e))
            largest_term = max(largest_term, factor(e)*maxval(abs(on_nodes(nodes))))
         end associate
      end do
   end function largest_term

   !> Bodies in which no sample is above rounding have no error.
   pure subroutine drop_rounding(model, first, samples, least, error)
      type(model_type), intent(in) :: model
      integer, intent(in) :: first(:)             ! (elements + 1) first of the samples of each
      real(dp), intent(in) :: samples(:, :)
      real(dp), intent(in) :: least               ! rounding
      real(dp), intent(inout) :: error(:)         ! (bodies)
      logical :: is_there(size(error))
      integer :: e

      is_there = .false.
      do e = 1, size(first) - 1
         associate (b => model%mesh%element_body(e))
            if (.not. is_there(b)) is_there(b) = &
               maxval(abs(samples(:, first(e):first(e + 1) - 1))) > least
         end associate
      end do
      where (.not. is_there) error = 0.0_dp
   end subroutine drop_rounding

   !> Divisor of values whose squares must neither overflow nor vanish.
   pure real(dp) function scale_of(samples)
      real(dp), intent(in) :: samples(:, :)
      real(dp) :: largest

      scale_of = 1.0_dp
      largest = maxval(abs(samples))
      if (largest > large) scale_of = largest
      if (largest < 1/large .and. largest > tiny(largest)) scale_of = largest
   end function scale_of

   !> The integrals of stress or heat flux over an element.
   pure subroutine compare(self, model, e, scale, smooth, values, measured)
      class(recovery_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: e
      real(dp), intent(in) :: scale, smooth(:, :)
      real(dp), intent(inout) :: values(:, :)          ! (most, 4 or 2)
      type(element_error_type), intent(out) :: measured
      real(dp) :: nodal(size(smooth, 1), nodes_per_element), volume(2)
      integer :: g, i, q, steps

      associate (fields => self%quadrature, rule => self%quadrature%rules( &
         model%mesh%element_kind(e)))
         do q = 1, rule%nodes
            nodal(:, q) = smooth(:, self%points%element_points(q, e))*scale
         end do
         if (abs(scale - 1.0_dp) > 0.0_dp) values = values*scale
         i = fields%material(e)
         steps = merge(2, 1, fields%one_material(e))
         do g = 1, rule%count, steps
            volume = 0.0_dp
            q = min(steps, rule%count + 1 - g)
            volume(:q) = fields%volume(fields%first(e) + g - 1:fields%first(e) + g + q - 2)
            if (size(smooth, 1) == 4) then
               call measure_stress(rule, g, nodal, values, fields%materials(i)%compliance, &
                  volume, measured)
            else
               call measure_heat_flux(rule, g, nodal, values, fields%materials(i)%resistivity, &
                  volume, measured)
            end if
            if (steps == 1) i = i + 1
         end do
      end associate
   end subroutine compare

   !> Relative error of each body, and the field over the elements.
   pure function sum_up(model, scale, errors) result(estimate)
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: scale
      type(element_error_type), intent(in) :: errors(:)
      type(error_record_type) :: estimate
      real(dp) :: energy(model%mesh%body_count)
      integer :: b, e

      allocate (estimate%element(size(errors)))
      allocate (estimate%body(model%mesh%body_count), source=0.0_dp)
      energy = 0.0_dp
      do e = 1, size(errors)
         b = model%mesh%element_body(e)
         estimate%body(b) = estimate%body(b) + errors(e)%error
         energy(b) = energy(b) + errors(e)%energy
         estimate%element(e) = scale*sqrt(errors(e)%square/errors(e)%volume)
      end do
      where (estimate%body + energy > 0.0_dp)
         estimate%body = sqrt(estimate%body/(estimate%body + energy))
      end where
   end function sum_up

end module discretisation_errors
