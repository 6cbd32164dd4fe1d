!> Data cards of *DSLOAD, *DSFLUX and *SFILM: surface, label, values.
module deck_builder_surface_loads
   use card_values, only: check_extra, need_field, need_plane_vector
   use cards, only: data_card_type
   use deck_builder_element_loads, only: build_on_faces, report_label
   use deck_context, only: deck_context_type, read_surface
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use load_requests, only: request_type
   use mesh, only: surface_type
   use model, only: model_type
   use steps, only: load_pressure, load_traction
   use text, only: to_upper
   implicit none
   private
   public :: build_surface_load

contains

   !> Takes one data card.
   subroutine build_surface_load(keyword, data, request, film_amplitude, model, context, report)
      character(*), intent(in) :: keyword                  !! DSLOAD, DSFLUX or SFILM
      type(data_card_type), intent(in) :: data
      type(request_type), intent(inout) :: request         !! step, amplitude, card and place
      integer, intent(in) :: film_amplitude                !! amplitude of the film coefficient
      type(model_type), intent(in) :: model                !! surfaces
      type(deck_context_type), intent(inout) :: context    !! receives the requests
      type(deck_report_type), intent(inout) :: report      !! receives errors
      character(:), allocatable :: label, labels
      integer :: errors, surface
      logical :: valid

      valid = .true.
      errors = report%error_count()
      call read_surface(data, 1, 'surface', model%mesh%surfaces, report, surface)
      valid = surface > 0
      select case (keyword)
      case ('DSFLUX')
         labels = 'S'
         call check_extra(data, 3, 'surface, S, heat flux', report)
      case ('SFILM')
         labels = 'F'
         call check_extra(data, 4, 'surface, F, sink temperature, film coefficient', report)
      case default
         labels = 'P/TRVEC'
      end select
      call need_field(data, 2, labels, report, label, valid)
      if (len(label) == 0) return
      label = to_upper(label)
      request%set = 0
      if (index('/'//labels//'/', '/'//label//'/') == 0) then
         call report_label(keyword, label, labels, data, report)
         return
      end if
      select case (label)
      case ('P')
         call need_field(data, 3, 'pressure', report, request%value, valid)
         call check_extra(data, 3, 'surface, P, pressure', report)
         request%kind = load_pressure
         if (valid) call add_faces(model%mesh%surfaces(surface), request, 1, 0, context)
      case ('TRVEC')
         call build_traction(data, request, model, surface, context, report, valid)
      case default
         if (surface == 0 .or. report%error_count() > errors) return
         call build_on_faces(label//'1', model%mesh%surfaces(surface), data, &
            request, film_amplitude, context, report)
      end select
   end subroutine build_surface_load

   !> Magnitude and direction of a traction vector.
   subroutine build_traction(data, request, model, surface, context, report, valid)
      type(data_card_type), intent(in) :: data
      type(request_type), intent(inout) :: request
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      logical, intent(inout) :: valid
      real(dp) :: vector(2)
      integer :: i

      call need_plane_vector(data, 3, report, vector, valid)
      call check_extra(data, 6, 'surface, TRVEC, magnitude, direction x, y, z', report)
      if (.not. valid) return
      request%kind = load_traction
      do i = 1, 2
         request%value = vector(i)
         call add_faces(model%mesh%surfaces(surface), request, 2, i - 2, context)
      end do
   end subroutine build_traction

   !> One request a face, its component a multiple of the face's number and an offset.
   subroutine add_faces(surface, request, multiple, offset, context)
      type(surface_type), intent(in) :: surface
      type(request_type), intent(inout) :: request
      integer, intent(in) :: multiple, offset
      type(deck_context_type), intent(inout) :: context
      integer :: i

      do i = 1, size(surface%faces, 2)
         request%item = surface%faces(1, i)
         request%component = multiple*surface%faces(2, i) + offset
         call context%loads%add(request)
      end do
   end subroutine add_faces

end module deck_builder_surface_loads
