!> Requests of the cards -> loads, supports and initial temperatures of the model.
module load_application
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use load_requests, only: request_list_type, request_type
   use mesh, only: set_type
   use model, only: model_type
   use sorting, only: sort_order
   use steps, only: boundary_type, face_load_type, nodal_load_type
   implicit none
   private
   public :: apply_loads, apply_boundaries, apply_temperatures

   !> One load: loads of one step on one place add up.
   type :: load_type
      integer :: key = 0   !! place of the load: node and degree of freedom, or element and face
      real(dp) :: value = 0.0_dp    !! value
      integer :: amplitude = 0      !! index into model%amplitudes
      integer :: request = 0        !! where it comes from
   end type load_type

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

   !> Prescribed values, after refinement. What stands before the first step belongs to it.
   subroutine apply_boundaries(context, model)
      type(deck_context_type), intent(in) :: context       !! requests
      type(model_type), intent(inout) :: model             !! receives the prescribed values
      integer, allocatable :: nodes(:)
      integer :: s, i, j, n, counts(size(model%steps))

      counts = 0
      do i = 1, context%boundaries%count
         s = max(1, context%boundaries%items(i)%step)
         counts(s) = counts(s) + target_count(context%boundaries%items(i), model%mesh%node_sets)
      end do
      do s = 1, size(model%steps)
         allocate(model%steps(s)%boundaries(counts(s)))
      end do
      counts = 0
      do i = 1, context%boundaries%count
         associate (request => context%boundaries%items(i))
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

   !> Forces and pressures of all steps, before refinement.
   subroutine apply_loads(context, model, report)
      type(deck_context_type), intent(in) :: context       !! requests
      type(model_type), intent(inout) :: model             !! receives the loads
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(load_type), allocatable :: loads(:)
      integer :: s, i

      do s = 1, size(model%steps)
         call merge_loads(context%forces, s, 2, model%mesh%node_sets, report, loads)
         allocate(model%steps(s)%nodal_loads(size(loads)))
         do i = 1, size(loads)
            model%steps(s)%nodal_loads(i) = nodal_load_type((loads(i)%key - 1)/2 + 1, &
               mod(loads(i)%key - 1, 2) + 1, loads(i)%value, loads(i)%amplitude)
         end do
         call merge_loads(context%pressures, s, 4, model%mesh%element_sets, report, loads)
         allocate(model%steps(s)%face_loads(size(loads)))
         do i = 1, size(loads)
            model%steps(s)%face_loads(i) = face_load_type((loads(i)%key - 1)/4 + 1, &
               mod(loads(i)%key - 1, 4) + 1, loads(i)%value, loads(i)%amplitude)
         end do
      end do
   end subroutine apply_loads

   !> Loads of a step, one for each place: those on the same place add up, as in CalculiX.
   subroutine merge_loads(requests, step, components, sets, report, merged)
      type(request_list_type), intent(in) :: requests
      integer, intent(in) :: step, components
      type(set_type), intent(in) :: sets(:)
      type(deck_report_type), intent(inout) :: report
      type(load_type), allocatable, intent(out) :: merged(:)
      type(load_type), allocatable :: loads(:)
      integer, allocatable :: keys(:)
      integer :: i, n

      call collect_loads(requests, step, components, sets, loads)
      keys = loads%key
      loads = loads(sort_order(keys))
      n = 0
      do i = 1, size(loads)
         if (n > 0) then
            if (loads(n)%key == loads(i)%key) then
               if (loads(n)%amplitude /= loads(i)%amplitude) call report%error( &
                  requests%items(loads(i)%request)%place, &
                  'loads of one step on one place have two amplitudes')
               loads(n)%value = loads(n)%value + loads(i)%value
               cycle
            end if
         end if
         n = n + 1
         loads(n) = loads(i)
      end do
      merged = loads(:n)
   end subroutine merge_loads

   subroutine collect_loads(requests, step, components, sets, loads)
      type(request_list_type), intent(in) :: requests
      integer, intent(in) :: step, components
      type(set_type), intent(in) :: sets(:)
      type(load_type), allocatable, intent(out) :: loads(:)
      integer, allocatable :: items(:)
      integer :: i, j, n

      n = 0
      do i = 1, requests%count
         if (requests%items(i)%step == step) n = n + target_count(requests%items(i), sets)
      end do
      allocate(loads(n))
      n = 0
      do i = 1, requests%count
         associate (request => requests%items(i))
            if (request%step /= step) cycle
            call find_targets(request, sets, items)
            do j = 1, size(items)
               loads(n + j) = load_type(components*(items(j) - 1) + request%component, &
                  request%value, request%amplitude, i)
            end do
            n = n + size(items)
         end associate
      end do
   end subroutine collect_loads

end module load_application
