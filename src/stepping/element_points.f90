!> What *EL PRINT asks for: stress and heat flux at the integration points of the elements of a set.
module element_points
   use due_output, only: table_is_due
   use kinds, only: dp
   use model, only: model_type
   use orientations, only: material_axes
   use point_fields, only: integration_rules, most => most_field_points, &
      point_fields_type
   use point_properties, only: along_axes
   use print_requests, only: print_request_type
   use quadrature, only: point_count
   use records, only: element_points_record_type, increment_record_type
   use solution_state, only: solution_state_type
   use steps, only: solves_heat, step_type
   implicit none
   private
   public :: points_of_elements

contains

   !> One record for each *EL PRINT of a step; empty where its table is not due.
   pure function points_of_elements(model, step, state, increment) result(records)
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      type(solution_state_type), intent(in) :: state            !! state at the end
      type(increment_record_type), intent(in) :: increment      !! position of the increment
      type(element_points_record_type), allocatable :: records(:)
      integer :: i

      allocate (records(size(step%element_prints)))
      do i = 1, size(records)
         if (.not. table_is_due(step%element_prints(i)%frequency, increment)) cycle
         records(i) = points_of_set(model, step%element_prints(i), solves_heat(step%analysis), &
            state)
      end do
   end function points_of_elements

   !> The points of the elements of a set. Stress belongs to the temperatures with which equilibrium
   !> was solved last.
   pure function points_of_set(model, request, with_heat, state) result(record)
      type(model_type), intent(in) :: model
      type(print_request_type), intent(in) :: request
      logical, intent(in) :: with_heat
      type(solution_state_type), intent(in) :: state
      type(element_points_record_type) :: record
      type(point_fields_type) :: fields
      real(dp) :: stress(most, 4), flux(most, 2)
      integer :: first, g, i, last, n

      call fields%prepare(model%mesh, model%sections, model%materials, model%orientations, &
         integration_rules())
      associate (mesh => model%mesh, members => model%mesh%element_sets(request%set)%members)
         n = sum(point_count(mesh%element_kind(members)))
         allocate (record%element(n), record%point(n), record%position(2, n))
         if (state%has_mechanics) allocate (record%stress(4, n))
         if (with_heat) allocate (record%heat_flux(2, n))
         last = 0
         do i = 1, size(members)
            first = last + 1
            last = last + point_count(mesh%element_kind(members(i)))
            record%element(first:last) = members(i)
            record%point(first:last) = [(g, g=1, last - first + 1)]
            record%position(:, first:last) = fields%positions(mesh, members(i))
            if (state%has_mechanics) then
               call fields%stress(mesh, members(i), reshape(state%displacement, &
                  [2, size(state%temperature)]), state%stress_temperature - &
                  model%initial_temperature, stress)
               record%stress(:, first:last) = transpose(stress(:last - first + 1, :))
            end if
            if (with_heat) then
               call fields%heat_flux(mesh, members(i), state%temperature, flux)
               record%heat_flux(:, first:last) = transpose(flux(:last - first + 1, :))
            end if
         end do
      end associate
      if (request%local_axes) call turn(model, record)
   end function points_of_set

   !> Replaces the components along x and y by those along the axes of the material.
   pure subroutine turn(model, record)
      type(model_type), intent(in) :: model
      type(element_points_record_type), intent(inout) :: record
      real(dp) :: axes(2, 2)
      integer :: k

      do k = 1, size(record%element)
         axes = material_axes(model%orientations, model%sections( &
            model%mesh%element_section(record%element(k)))%orientation, record%position(:, k))
         if (allocated(record%stress)) record%stress(:, k) = along_axes(axes, record%stress(:, k))
         if (allocated(record%heat_flux)) record%heat_flux(:, k) = &
            matmul(record%heat_flux(:, k), axes)
      end do
   end subroutine turn

end module element_points
