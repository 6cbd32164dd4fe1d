!> What *EL PRINT asks for: stress and heat flux at the integration points of the elements of a set.
module element_points
   use due_output, only: table_is_due
   use element_fields, only: along_axes, element_axes, element_heat_flux, element_positions, &
      element_stress
   use kinds, only: dp
   use model, only: model_type
   use print_requests, only: print_request_type
   use quadrature, only: integration_rule, most_points, point_count
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

   pure function points_of_set(model, request, with_heat, state) result(record)
      type(model_type), intent(in) :: model
      type(print_request_type), intent(in) :: request
      logical, intent(in) :: with_heat
      type(solution_state_type), intent(in) :: state
      type(element_points_record_type) :: record
      integer :: e, first, n

      associate (mesh => model%mesh, members => model%mesh%element_sets(request%set)%members)
         n = sum(point_count(mesh%element_kind(members)))
         allocate (record%element(n), record%point(n), record%position(2, n))
         if (state%has_mechanics) allocate (record%stress(4, n))
         if (with_heat) allocate (record%heat_flux(2, n))
         first = 1
         do e = 1, size(members)
            call add_element(model, members(e), request%local_axes, state, first, record)
            first = first + point_count(mesh%element_kind(members(e)))
         end do
      end associate
   end function points_of_set

   !> The points of one element. Stress belongs to the temperatures with which equilibrium was
   !> solved last.
   pure subroutine add_element(model, element, local_axes, state, first, record)
      type(model_type), intent(in) :: model
      integer, intent(in) :: element
      logical, intent(in) :: local_axes
      type(solution_state_type), intent(in) :: state
      integer, intent(in) :: first
      type(element_points_record_type), intent(inout) :: record
      real(dp) :: xi_eta(2, most_points), weights(most_points), axes(2, 2, most_points)
      integer :: g, n, last

      n = point_count(model%mesh%element_kind(element))
      last = first + n - 1
      call integration_rule(model%mesh%element_kind(element), xi_eta(:, :n), weights(:n))
      record%element(first:last) = element
      record%point(first:last) = [(g, g=1, n)]
      record%position(:, first:last) = element_positions(model%mesh, element, xi_eta(:, :n))
      axes(:, :, :n) = element_axes(model%mesh, model%sections, model%orientations, element, &
         xi_eta(:, :n))
      if (allocated(record%stress)) then
         record%stress(:, first:last) = element_stress(model%mesh, model%sections, &
            model%materials, model%orientations, element, xi_eta(:, :n), &
            reshape(state%displacement, [2, size(state%temperature)]), &
            state%stress_temperature - model%initial_temperature)
         if (local_axes) then
            do g = 1, n
               record%stress(:, first - 1 + g) = along_axes(axes(:, :, g), &
                  record%stress(:, first - 1 + g))
            end do
         end if
      end if
      if (allocated(record%heat_flux)) then
         record%heat_flux(:, first:last) = element_heat_flux(model%mesh, model%sections, &
            model%materials, model%orientations, element, xi_eta(:, :n), state%temperature)
         if (local_axes) then
            do g = 1, n
               record%heat_flux(:, first - 1 + g) = matmul(record%heat_flux(:, first - 1 + g), &
                  axes(:, :, g))
            end do
         end if
      end if
   end subroutine add_element

end module element_points
