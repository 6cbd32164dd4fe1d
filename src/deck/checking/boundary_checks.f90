!> What only shows of *BOUNDARY once all cards are read: whether it acts on something, in a step
!> that has use for it, and says one thing only.
module boundary_checks
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use load_requests, only: request_type
   use model, only: model_type
   use order_reduction, only: side_corners
   use steps, only: dof_temperature, solves_heat, solves_mechanics
   use text, only: counted, others, to_text
   implicit none
   private
   public :: check_boundaries

contains

   !> Checks the requests before the model is refined.
   subroutine check_boundaries(context, model, used, report)
      type(deck_context_type), intent(in) :: context       !! requests
      type(model_type), intent(in) :: model
      logical, intent(in) :: used(0:)                      !! (0:nodes) whether elements have them
      type(deck_report_type), intent(inout) :: report      !! receives warnings
      integer :: i, card

      card = 0
      do i = 1, context%boundaries%count
         associate (request => context%boundaries%items(i))
            if (context%analyses_sound) call check_effect(request, model, report)
            if (request%card /= card) call check_nodes(request, model, used, report)
            card = request%card
         end associate
      end do
      if (any(context%dropped)) call check_dropped(context, model, report)
      do i = 0, size(model%steps)
         call check_conflicts(context, i, model, report)
      end do
   end subroutine check_boundaries

   !> Warns of values that come after the last step that solves for what they prescribe. Supports of
   !> 0 do no harm.
   subroutine check_effect(request, model, report)
      type(request_type), intent(in) :: request
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report

      associate (analyses => model%steps(max(1, request%step):)%analysis)
         if (request%component == dof_temperature) then
            if (.not. (any(solves_heat(analyses)) .or. report%has_lost('heat'))) call &
               report%warning(request%place, 'a temperature without effect: no step from here '// &
               'on solves heat; take *COUPLED TEMPERATURE-DISPLACEMENT', &
               'temperature without effect')
         else if (abs(request%value) > 0.0_dp) then
            if (.not. any(solves_mechanics(analyses))) call report%warning(request%place, &
               'a displacement without effect: no step from here on solves mechanics')
         end if
      end associate
   end subroutine check_effect

   !> Warns of nodes that no element has, as CalculiX does.
   subroutine check_nodes(request, model, used, report)
      type(request_type), intent(in) :: request
      type(model_type), intent(in) :: model
      logical, intent(in) :: used(0:)
      type(deck_report_type), intent(inout) :: report
      integer, allocatable :: nodes(:)

      if (report%has_lost('equation') .or. report%has_lost('element')) return
      nodes = nodes_of(request, model)
      nodes = pack(nodes, .not. used(nodes))
      if (size(nodes) == 0) return
      call report%warning(request%place, 'node '//to_text(model%mesh%node_number(nodes(1)))// &
         ' belongs to no element: what is prescribed there has no effect'// &
         others(size(nodes), '; nodes without one: '))
   end subroutine check_nodes

   !> Where ORDER=1 drops all nodes of a data card, their corners have values in their place.
   subroutine check_dropped(context, model, report)
      type(deck_context_type), intent(in) :: context
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      integer :: corners(2, size(model%mesh%node_number))
      integer :: first(3, size(model%mesh%node_number))   ! first step that gives a value
      integer, allocatable :: nodes(:)
      integer :: i, j, card

      corners = side_corners(model%mesh)
      first = huge(first)
      do i = context%boundaries%count, 1, -1
         associate (request => context%boundaries%items(i))
            first(min(request%component, 3), nodes_of(request, model)) = max(1, request%step)
         end associate
      end do
      card = 0
      do i = 1, context%boundaries%count
         associate (request => context%boundaries%items(i))
            nodes = nodes_of(request, model)
            if (.not. all(context%dropped(nodes)) .or. request%card == card) cycle
            do j = 1, size(nodes)
               if (all(first(min(request%component, 3), corners(:, nodes(j))) <= &
                  max(1, request%step))) cycle
               card = request%card
               call report%error(request%place, 'ORDER=1 drops midside node '// &
                  to_text(model%mesh%node_number(nodes(j)))//' and what is prescribed there; '// &
                  'prescribe it at the corners of its side, '// &
                  to_text(model%mesh%node_number(corners(1, nodes(j))))//' and '// &
                  to_text(model%mesh%node_number(corners(2, nodes(j)))))
               exit
            end do
         end associate
      end do
   end subroutine check_dropped

   !> Warns where a data card replaces what another one of the same step prescribes. What is
   !> before the first step may be replaced in it.
   subroutine check_conflicts(context, step, model, report)
      type(deck_context_type), intent(in) :: context
      integer, intent(in) :: step                          ! 0 for what is before the first
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      integer :: given(3, size(model%mesh%node_number)), i, j, dof, n, node
      integer, allocatable :: nodes(:)

      given = 0
      do i = 1, context%boundaries%count
         associate (request => context%boundaries%items(i))
            if (request%step /= step) cycle
            dof = min(request%component, 3)
            nodes = nodes_of(request, model)
            n = 0
            do j = 1, size(nodes)
               if (given(dof, nodes(j)) > 0) then
                  if (differs(request, context%boundaries%items(given(dof, nodes(j))))) then
                     n = n + 1
                     if (n == 1) node = nodes(j)
                  end if
               end if
               given(dof, nodes(j)) = i
            end do
            if (n > 0) call report%warning(request%place, 'node '// &
               to_text(model%mesh%node_number(node))//': another card of this step gives '// &
               'degree of freedom '//to_text(request%component)// &
               ' another value; the last value is used ('//counted(n, 'node')//')')
         end associate
      end do
   end subroutine check_conflicts

   !> Whether two cards prescribe different time histories.
   pure logical function differs(one, other)
      type(request_type), intent(in) :: one, other

      differs = abs(one%value - other%value) > 0.0_dp .or. &
         (one%amplitude /= other%amplitude .and. abs(one%value) > 0.0_dp)
   end function differs

   pure function nodes_of(request, model) result(nodes)
      type(request_type), intent(in) :: request
      type(model_type), intent(in) :: model
      integer, allocatable :: nodes(:)

      nodes = [request%item]
      if (request%set > 0) nodes = model%mesh%node_sets(request%set)%members
   end function nodes_of

end module boundary_checks
