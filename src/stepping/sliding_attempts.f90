!> What an attempt asks of contact points that follow sliding: that they lie where its solution has
!> them, and that they have come there step by step.
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
   public :: check_arrivals, check_slip, lie_where_placed

   real(dp), parameter :: same_place = 1.0e-5_dp   !! part of the spacing of contact points

contains

   !> Whether contact points that follow sliding lie where they were placed.
   pure logical function lie_where_placed(bodies, displacement)
      type(reduced_bodies_type), intent(in) :: bodies !! with such contact points
      real(dp), intent(in) :: displacement(:)         !! (2 nodes) [length]
      real(dp) :: moved(size(bodies%points%slave))
      integer :: i

      moved = movement(bodies, displacement - bodies%faces_at)
      lie_where_placed = .true.
      do i = 1, size(bodies%interfaces)
         associate (first => bodies%points%interface_start(i), edge => bodies%interfaces(i)%edge)
            if (bodies%interfaces(i)%follows_sliding) lie_where_placed = lie_where_placed .and. &
               all(moved(first:first + size(edge) - 1) <= same_place*edge)
         end associate
      end do
   end function lie_where_placed

   !> How far contact points move against their masters; against the master's first node, or its
   !> reference node, where nothing is opposite [length].
   pure function movement(bodies, displacement) result(moved)
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: displacement(:)         ! (2 nodes) [length]
      real(dp) :: moved(size(bodies%points%slave)), relative(2, size(moved))
      integer :: k

      relative = bodies%points%relative(displacement)
      do k = 1, size(moved)
         associate (master => bodies%points%master(k))
            if (bodies%points%is_beyond(k)) relative(:, k) = relative(:, k) - &
               displacement(2*master - 1:2*master)
         end associate
      end do
      moved = norm2(relative, dim=1)
   end function movement

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
      where (bodies%points%is_beyond) slip = movement(bodies, next%displacement - &
         before%displacement)
      where (next%contact%contact_state == contact_open .and. before%contact%contact_state == &
         contact_open) slip = 0.0_dp
      do i = 1, size(bodies%interfaces)
         associate (points => bodies%interfaces(i), first => bodies%points%interface_start(i))
            if (.not. points%follows_sliding) cycle
            associate (spacing => points%edge/((points%side_nodes - 1)*points%node_spacings))
               k = maxloc(slip(first:first + size(spacing) - 1)/spacing, dim=1)
               if (slip(first - 1 + k) <= (1.0_dp + same_place)*spacing(k)) cycle
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
      real(dp), intent(in) :: displacement(:)         !! (2 nodes) at which they were placed [length]
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

end module sliding_attempts
