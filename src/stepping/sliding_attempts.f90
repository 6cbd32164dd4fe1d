!> What an attempt asks of contact points that follow sliding: that they have come where they are
!> step by step, from in front of their masters, and what their friction takes from the drive.
module sliding_attempts
   use contact_system, only: contact_open
   use errors, only: error_type, set_error, status_no_convergence
   use kinds, only: dp
   use model, only: model_type
   use records, only: increment_record_type
   use reduced_bodies, only: reduced_bodies_type
   use solution_state, only: solution_state_type
   use text, only: to_text
   implicit none
   private
   public :: check_arrivals, check_slip, compare_with_drive

   real(dp), parameter :: over_spacing = 1.0e-5_dp   !! slip over a spacing that is rounding

contains

   !> Whether no contact point that is closed at the start or the end of an increment slips by more
   !> than the spacing of nodes: its master is that of the end, and its friction acts along one
   !> direction.
   !> Error: one does; with DIRECT it is warned of.
   subroutine check_slip(bodies, model, before, next, record, error)
      type(reduced_bodies_type), intent(in) :: bodies !! with such contact points, placed at the end
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(in) :: before, next   !! of the increment
      type(increment_record_type), intent(inout) :: record    !! that of the increment
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: words
      real(dp) :: beyond, slip(size(next%omega))
      integer :: i, k

      slip = abs(next%contact%tangential - before%contact%tangential)
      where (bodies%points%is_beyond) slip = bodies%movement(next%displacement - &
         before%displacement)
      where (next%contact%contact_state == contact_open .and. before%contact%contact_state == &
         contact_open) slip = 0.0_dp
      do i = 1, size(bodies%interfaces)
         associate (points => bodies%interfaces(i), first => bodies%points%interface_start(i))
            if (.not. points%follows_sliding) cycle
            associate (spacing => points%edge/((points%side_nodes - 1)*points%node_spacings))
               k = maxloc(slip(first:first + size(spacing) - 1)/spacing, dim=1)
               record%slip_part = max(record%slip_part, slip(first - 1 + k)/spacing(k))
               if (slip(first - 1 + k) <= (1.0_dp + over_spacing)*spacing(k)) cycle
               beyond = slip(first - 1 + k)
               words = ' in an increment, more than the spacing of nodes, '// &
                  to_text(spacing(k))//', at slave node '//to_text(model%mesh%node_number( &
                  bodies%points%slave(first - 1 + k)))
            end associate
            if (model%steps(record%step)%direct) then
               call record%warn('contact pair '//points%name//' slips by ', beyond, words// &
                  ', time '//to_text(record%time)//', which DIRECT does not allow to be cut back')
            else
               call set_error(error, status_no_convergence, 'contact pair '//points%name// &
                  ' slips by '//to_text(beyond)//words)
               return
            end if
         end associate
      end do
   end subroutine check_slip

   !> Whether no contact point that meets its master comes from behind it.
   !> Error: one does.
   subroutine check_arrivals(bodies, model, before, displacement, error)
      type(reduced_bodies_type), intent(in) :: bodies !! with such contact points, placed
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(in) :: before !! at the start of the increment
      real(dp), intent(in) :: displacement(:)         !! (2 nodes) where they were placed [length]
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: gap(size(before%omega))
      integer :: i, k

      gap = bodies%points%initial_gap - sum(bodies%points%normal* &
         bodies%points%relative(displacement), dim=1)
      do i = 1, size(bodies%interfaces)
         associate (points => bodies%interfaces(i), first => bodies%points%interface_start(i))
            if (.not. points%follows_sliding) cycle
            associate (last => first + size(points%edge) - 1)
               k = first - 1 + findloc(gap(first:last) < -points%edge .and. &
                  before%contact%contact_state(first:last) == contact_open .and. .not. &
                  bodies%points%is_beyond(first:last), .true., dim=1)
            end associate
            if (k < first) cycle
            call set_error(error, status_no_convergence, 'contact pair '//points%name// &
               ': slave node '//to_text(model%mesh%node_number(bodies%points%slave(k)))// &
               ' would pass through the master from behind: it is '//to_text(-gap(k))//' inside')
            return
         end associate
      end do
   end subroutine check_arrivals

   !> Compares the work that friction turns into heat with that of supports and loads, both as
   !> rates: they differ by what bodies store and what their expansion does against stresses. Only
   !> where faces slide in the plane.
   pure subroutine compare_with_drive(bodies, heat, velocity, record)
      type(reduced_bodies_type), intent(in) :: bodies         !! with contact points that are heated
      real(dp), intent(in) :: heat(:)                         !! (n) heat of friction [power]
      real(dp), intent(in) :: velocity(:, :)                  !! (2, nodes) [length/time]
      type(increment_record_type), intent(inout) :: record    !! receives the difference
      real(dp) :: work

      associate (law => bodies%laws%heat)
         if (any(law%speed >= 0.0_dp) .or. any(law%efficiency <= 0.0_dp)) return
         work = sum(heat/law%efficiency)
      end associate
      if (work > 0.0_dp) record%drive_excess = (work - sum(record%fields%external_force* &
         velocity))/work
   end subroutine compare_with_drive

end module sliding_attempts
