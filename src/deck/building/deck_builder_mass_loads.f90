!> Data cards of *DLOAD with GRAV and CENTRIF, which act on the mass of elements.
module deck_builder_mass_loads
   use card_values, only: check_extra, need_field, need_plane_vector, need_vector
   use cards, only: data_card_type, field_place
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use load_requests, only: request_type
   use steps, only: centrifugal_round, load_centrifugal, load_gravity
   implicit none
   private
   public :: build_gravity, build_rotation

contains

   !> Magnitude and direction; along x and along y the gravity is a load of its own.
   subroutine build_gravity(data, request, context, report, valid)
      type(data_card_type), intent(in) :: data
      type(request_type), intent(inout) :: request         !! step, amplitude, card, elements
      type(deck_context_type), intent(inout) :: context    !! receives the requests
      type(deck_report_type), intent(inout) :: report      !! receives errors
      logical, intent(inout) :: valid                      !! becomes false after an error
      real(dp) :: vector(2)
      integer :: i

      call need_plane_vector(data, 3, report, vector, valid)
      call check_extra(data, 6, 'element or set, GRAV, magnitude, direction x, y, z', report)
      if (.not. valid) return
      request%kind = load_gravity
      do i = 1, 2
         if (abs(vector(i)) <= 0.0_dp) cycle
         request%component = i
         request%value = vector(i)
         call context%loads%add(request)
      end do
   end subroutine build_gravity

   !> Speed squared, a point and the direction of the axis: the y axis, or one along z, round which
   !> a plane turns. Round a point (x0, y0) the force is that round the origin less (x0, y0) times
   !> the density, which makes four loads of a place.
   subroutine build_rotation(data, request, context, report, valid)
      type(data_card_type), intent(in) :: data
      type(request_type), intent(inout) :: request         !! step, amplitude, card, elements
      type(deck_context_type), intent(inout) :: context    !! receives the requests
      type(deck_report_type), intent(inout) :: report      !! receives errors
      logical, intent(inout) :: valid                      !! becomes false after an error
      real(dp) :: point(3), direction(3), values(4)
      integer :: i

      call need_field(data, 3, 'speed squared', report, request%value, valid)
      call need_vector(data, 4, 'point of the axis', report, point, valid)
      call need_vector(data, 7, 'direction of the axis', report, direction, valid)
      call check_extra(data, 9, &
         'element or set, CENTRIF, speed squared, point x, y, z, direction x, y, z', report)
      if (.not. valid) return
      if (request%value < 0.0_dp) then
         call report%error(field_place(data, 3), 'the square of a speed is not negative')
      else if (norm2(direction) <= 0.0_dp) then
         call report%error(field_place(data, 7), 'the direction is zero')
      else if (norm2(direction(:2)) <= 0.0_dp) then
         request%kind = load_centrifugal
         values(1:2) = request%value
         values(3:4) = -request%value*point(:2)
         do i = 1, 4
            request%component = i
            request%value = values(i)
            call context%loads%add(request)
         end do
      else if (norm2(direction([1, 3])) > 0.0_dp) then
         call report%error(field_place(data, 7), 'the axis must be the y axis, or along z')
      else if (norm2(point([1, 3])) > 0.0_dp) then
         call report%error(field_place(data, 4), 'the axis must be the y axis: x and z are 0 on it')
      else
         request%kind = load_centrifugal
         request%component = centrifugal_round
         call context%loads%add(request)
      end if
   end subroutine build_rotation

end module deck_builder_mass_loads
