!> Requests of the cards -> loads, supports and initial temperatures of the model.
module load_application
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use load_requests, only: request_type
   use mesh, only: mesh_type, set_type
   use model, only: model_type
   use sorting, only: sort_order
   use steps, only: boundary_type, load_film_coefficient, load_film_sink, load_force, &
      load_nodal_heat, load_temperature, load_type
   implicit none
   private
   public :: apply_loads, apply_boundaries, apply_temperatures

contains

   !> Items that a request is about.
   pure subroutine find_targets(request, sets, items)
      type(request_type), intent(in) :: request
      type(set_type), intent(in) :: sets(:)
      integer, allocatable, intent(out) :: items(:)

      if (request%set > 0) then
         items = sets(request%set)%members
      else
         items = [request%item]
      end if
   end subroutine find_targets

   pure integer function target_count(request, sets)
      type(request_type), intent(in) :: request
      type(set_type), intent(in) :: sets(:)

      target_count = 1
      if (request%set > 0) target_count = size(sets(request%set)%members)
   end function target_count

   !> Initial temperatures; all = .false. leaves the nodes of the deck as they are, and gives those
   !> that refinement added what their sets say.
   subroutine apply_temperatures(context, deck_nodes, all, model)
      type(deck_context_type), intent(in) :: context       !! requests
      integer, intent(in) :: deck_nodes                    !! number of nodes in the deck
      logical, intent(in) :: all   !! all nodes, or only those behind deck_nodes
      type(model_type), intent(inout) :: model             !! receives the temperatures
      integer, allocatable :: nodes(:)
      integer :: i

      if (all) allocate(model%initial_temperature(size(model%mesh%node_number)), source=0.0_dp)
      do i = 1, context%temperatures%count
         call find_targets(context%temperatures%items(i), model%mesh%node_sets, nodes)
         if (.not. all) nodes = pack(nodes, nodes > deck_nodes)
         model%initial_temperature(nodes) = context%temperatures%items(i)%value
      end do
   end subroutine apply_temperatures

   !> Prescribed values, after refinement. What is before the first step belongs to it.
   subroutine apply_boundaries(context, model, report)
      type(deck_context_type), intent(in) :: context       !! requests
      type(model_type), intent(inout) :: model             !! receives the prescribed values
      type(deck_report_type), intent(in) :: report         !! knows where lines are
      integer, allocatable :: nodes(:)
      integer :: s, i, j, n, counts(size(model%steps))

      counts = 0
      do i = 1, context%boundaries%count
         if (is_ended(context%boundaries%items(i), model)) cycle
         s = max(1, context%boundaries%items(i)%step)
         counts(s) = counts(s) + target_count(context%boundaries%items(i), model%mesh%node_sets)
      end do
      do s = 1, size(model%steps)
         allocate(model%steps(s)%boundaries(counts(s)))
      end do
      counts = 0
      n = 0
      if (context%boundaries%count > 0) n = maxval(context%boundaries%items( &
         :context%boundaries%count)%card)
      allocate (model%boundary_places(n))
      do i = 1, context%boundaries%count
         associate (request => context%boundaries%items(i))
            model%boundary_places(request%card)%value = report%source%words_of(request%place)
            if (is_ended(request, model)) cycle
            s = max(1, request%step)
            call find_targets(request, model%mesh%node_sets, nodes)
            n = counts(s)
            do j = 1, size(nodes)
               model%steps(s)%boundaries(n + j) = boundary_type(nodes(j), request%component, &
                  request%value, request%amplitude, request%card)
            end do
            counts(s) = n + size(nodes)
         end associate
      end do
   end subroutine apply_boundaries

   !> OP=NEW in the first step ends what is before it.
   pure logical function is_ended(request, model)
      type(request_type), intent(in) :: request
      type(model_type), intent(in) :: model

      is_ended = request%step == 0 .and. model%steps(1)%ends_boundaries
   end function is_ended

   !> Loads of all steps, before refinement.
   subroutine apply_loads(context, model, report)
      type(deck_context_type), intent(in) :: context       !! requests
      type(model_type), intent(inout) :: model             !! receives the loads
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(load_type), allocatable :: loads(:)
      integer, allocatable :: requests(:), order(:)
      logical, allocatable :: stays(:)
      integer :: s, i

      do s = 1, size(model%steps)
         call collect_loads(context, s, model%mesh, loads, requests)
         order = sort_order(loads%component)
         order = order(sort_order(loads(order)%item))
         order = order(sort_order(loads(order)%kind))
         loads = loads(order)
         requests = requests(order)
         allocate(stays(size(loads)), source=.true.)
         do i = 1, size(loads) - 1
            if (loads(i)%kind /= loads(i + 1)%kind .or. loads(i)%item /= loads(i + 1)%item .or. &
               loads(i)%component /= loads(i + 1)%component) cycle
            if (any(loads(i)%kind == [load_film_coefficient, load_film_sink, load_temperature])) &
               then
               ! As in CalculiX the last card holds, while others add up.
               stays(i) = .false.
            else if (loads(i)%amplitude /= loads(i + 1)%amplitude) then
               call report%error(context%loads%items(requests(i + 1))%place, &
                  'two loads of one step at one location have different amplitudes')
               exit
            end if
         end do
         model%steps(s)%loads = pack(loads, stays)
         deallocate(stays)
      end do
   end subroutine apply_loads

   !> Loads of a step in the order of the cards, and the request of each.
   subroutine collect_loads(context, step, mesh, loads, requests)
      type(deck_context_type), intent(in) :: context
      integer, intent(in) :: step
      type(mesh_type), intent(in) :: mesh
      type(load_type), allocatable, intent(out) :: loads(:)
      integer, allocatable, intent(out) :: requests(:)
      integer, allocatable :: items(:)
      integer :: i, j, n, pass

      do pass = 1, 2
         n = 0
         do i = 1, context%loads%count
            associate (request => context%loads%items(i))
               if (request%step /= step) cycle
               if (any(request%kind == [load_force, load_nodal_heat, load_temperature])) then
                  call find_targets(request, mesh%node_sets, items)
               else
                  call find_targets(request, mesh%element_sets, items)
               end if
               do j = 1, merge(size(items), 0, pass == 2)
                  loads(n + j) = load_type(request%kind, items(j), request%component, &
                     request%value, request%amplitude, request%card)
               end do
               if (pass == 2) requests(n + 1:n + size(items)) = i
               n = n + size(items)
            end associate
         end do
         if (pass == 1) allocate(loads(n), requests(n))
      end do
   end subroutine collect_loads

end module load_application
