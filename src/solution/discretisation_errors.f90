!> Stress and flux of an increment, and how far they are from smooth ones (Zienkiewicz & Zhu): what
!> geometry and materials give is formed once a run.
module discretisation_errors
   use element_fields, only: element_positions
   use element_kinds, only: element_node_count, kind_count
   use field_recovery, only: average_samples, heat_flux_samples, make_points, point_map_type, &
      prepare_samples, stress_samples
   use kinds, only: dp
   use model, only: model_type
   use patch_recovery, only: patch_recovery_type
   use point_fields, only: most => most_field_points, point_fields_type
   use quadrature, only: recovery_points
   use records, only: error_record_type
   use recovered_error, only: element_error_type, error_points, measure_element
   implicit none
   private
   public :: recovery_type

   !> Largest value, or the inverse of the smallest, of which squares are taken as they are.
   real(dp), parameter :: large = 1.0e70_dp

   !> Where stress and flux are taken, averaged, smoothed and compared.
   type :: recovery_type
      private
      type(point_map_type), public :: points     !! where averaged fields live
      type(point_fields_type) :: samples         !! recovery points
      type(point_fields_type) :: quadrature      !! points at which errors are integrated
      type(patch_recovery_type) :: patches       !! smooth nodal values from the recovery points
   contains
      procedure :: prepare
      procedure :: recover_stress
      procedure :: recover_heat_flux
   end type recovery_type

contains

   !> Forms what stays.
   subroutine prepare(self, model)
      class(recovery_type), intent(out) :: self   !! the recovery
      type(model_type), intent(in) :: model       !! the model
      real(dp) :: points(2, most, kind_count), weights(most, kind_count)
      real(dp), allocatable :: position(:, :)
      integer :: counts(kind_count), e

      self%points = make_points(model%mesh)
      call prepare_samples(model%mesh, model%sections, model%materials, model%orientations, &
         self%samples)
      call error_points(points, weights, counts)
      call self%quadrature%prepare(model%mesh, model%sections, model%materials, &
         model%orientations, points, weights, counts)
      allocate (position(2, size(self%samples%volume)))
      do e = 1, size(model%mesh%element_kind)
         position(:, self%samples%first(e):self%samples%first(e + 1) - 1) = &
            element_positions(model%mesh, e, recovery_points(model%mesh%element_kind(e)))
      end do
      call self%patches%prepare(model%mesh, self%points, self%samples%first, position)
   end subroutine prepare

   !> Stress, averaged at the points, and its estimated error.
   subroutine recover_stress(self, model, displacement, temperature, stress, estimate)
      class(recovery_type), intent(in) :: self             !! the recovery
      type(model_type), intent(in) :: model                !! the model
      real(dp), intent(in) :: displacement(:, :)           !! (2, nodes) [length]
      real(dp), intent(in) :: temperature(:) !! (nodes) over the natural state [temperature]
      real(dp), allocatable, intent(out) :: stress(:, :)   !! (4, points) xx, yy, zz, xy [stress]
      type(error_record_type), intent(out) :: estimate     !! its error
      type(element_error_type) :: errors(size(model%mesh%element_kind))
      real(dp), allocatable :: samples(:, :), smooth(:, :)
      real(dp) :: values(most, 4), scale
      integer :: e

      allocate (samples(4, size(self%samples%volume)), smooth(4, size(self%points%node)))
      call stress_samples(self%samples, model%mesh, displacement, temperature, samples)
      stress = average_samples(model%mesh, self%points, samples)
      call self%patches%recover(4, samples, smooth)
      scale = scale_of(samples)
      do e = 1, size(errors)
         call self%quadrature%stress(model%mesh, e, displacement, temperature, values)
         call compare(self, model, e, 4, scale, smooth, values, errors(e))
      end do
      estimate = sum_up(model, scale, errors)
   end subroutine recover_stress

   !> Heat flux, averaged at the points, and its estimated error.
   subroutine recover_heat_flux(self, model, temperature, flux, estimate)
      class(recovery_type), intent(in) :: self             !! the recovery
      type(model_type), intent(in) :: model                !! the model
      real(dp), intent(in) :: temperature(:)               !! (nodes) [temperature]
      real(dp), allocatable, intent(out) :: flux(:, :)     !! (2, points) x, y [power/length^2]
      type(error_record_type), intent(out) :: estimate     !! its error
      type(element_error_type) :: errors(size(model%mesh%element_kind))
      real(dp), allocatable :: samples(:, :), smooth(:, :)
      real(dp) :: values(most, 2), scale
      integer :: e

      allocate (samples(2, size(self%samples%volume)), smooth(2, size(self%points%node)))
      call heat_flux_samples(self%samples, model%mesh, temperature, samples)
      flux = average_samples(model%mesh, self%points, samples)
      call self%patches%recover(2, samples, smooth)
      scale = scale_of(samples)
      do e = 1, size(errors)
         call self%quadrature%heat_flux(model%mesh, e, temperature, values)
         call compare(self, model, e, 2, scale, smooth, values, errors(e))
      end do
      estimate = sum_up(model, scale, errors)
   end subroutine recover_heat_flux

   !> What values are divided by, so that squares neither overflow nor vanish.
   pure real(dp) function scale_of(samples)
      real(dp), intent(in) :: samples(:, :)
      real(dp) :: largest

      scale_of = 1.0_dp
      largest = maxval(abs(samples))
      if (largest > large .or. (largest < 1/large .and. largest > tiny(largest))) &
         scale_of = largest
   end function scale_of

   !> The integrals over an element.
   pure subroutine compare(self, model, e, components, scale, smooth, values, measured)
      class(recovery_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: e, components
      real(dp), intent(in) :: scale, smooth(:, :)
      real(dp), intent(inout) :: values(most, components)
      type(element_error_type), intent(out) :: measured
      real(dp) :: nodal(4, 8)
      integer :: first, g, i, last, q

      associate (fields => self%quadrature, kind => model%mesh%element_kind(e))
         first = fields%first(e)
         do q = 1, element_node_count(kind)
            nodal(:components, q) = smooth(:, self%points%element_points(q, e))
         end do
         if (abs(scale - 1.0_dp) > 0.0_dp) then
            nodal(:components, :element_node_count(kind)) = &
               nodal(:components, :element_node_count(kind))/scale
            values(:fields%rules(kind)%count, :) = values(:fields%rules(kind)%count, :)/scale
         end if
         do g = 1, fields%rules(kind)%count
            i = fields%material(e)
            if (.not. fields%one_material(e)) i = i - 1 + g
            last = merge(fields%rules(kind)%count, g, fields%one_material(e))
            if (components == 4) then
               call measure_element(4, g, last, fields%rules(kind)%shape, nodal, values, &
                  fields%materials(i)%compliance, fields%volume(first:), measured)
            else
               call measure_element(2, g, last, fields%rules(kind)%shape, nodal, values, &
                  fields%materials(i)%resistivity, fields%volume(first:), measured)
            end if
            if (last == fields%rules(kind)%count) exit
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
