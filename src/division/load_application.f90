!> Requests of a deck -> initial temperatures, loads, supports, equations of couplings and axes of
!> nodes on the mesh of a model, which may be any division of the deck's.
!>
!> Node sets and surfaces are those of the mesh at hand. A load on an element acts on all of its
!> parts, one on a side on the parts along it. What is given for a single node stays on it, and so
!> do forces and heat of the nodes of a set.
module load_application
   use equations, only: coupling_equations, equation_type, facing_nodes
   use kinds, only: dp
   use load_requests, only: nodal_field_type, request_type
   use local_refinement, only: hanging_rows
   use mesh, only: add_node, mesh_type
   use model, only: model_type
   use sorting, only: invert_lists, sort_order
   use steps, only: acts_on_nodes, boundary_type, dof_temperature, load_film_coefficient, &
      load_film_sink, load_force, load_temperature, load_type, loaded_side
   use sum_lists, only: sum_list_type
   use transforms, only: along_axes, axes_at, partner_type
   implicit none
   private
   public :: apply_requests, collect_fields, make_explicit, turn_equations, apply_transforms

   !> The elements of a mesh by the elements of the deck that they are parts of.
   type :: parts_type
      integer, allocatable :: start(:)       !! (deck elements + 1) first one of each
      integer, allocatable :: element(:)     !! (elements) in the order of the deck's
   end type parts_type

contains

   !> Applies all requests of a model to its mesh.
   pure subroutine apply_requests(model)
      type(model_type), intent(inout) :: model
      type(parts_type) :: parts
      type(equation_type), allocatable :: own(:)
      type(load_type), allocatable :: loads(:)
      logical, allocatable :: stays(:)
      integer, allocatable :: order(:)
      integer :: i, owner(1, size(model%mesh%element_kind)), s

      call apply_temperatures(model)
      model%equations = model%equations(:model%deck_equations)
      do s = 1, size(model%couplings)
         ! gfortran does not free a function result within an array constructor.
         own = coupling_equations(model%couplings(s), model%mesh)
         model%equations = [model%equations, own]
      end do
      owner(1, :) = [(s, s=1, size(owner))]
      if (allocated(model%mesh%deck_element)) owner(1, :) = model%mesh%deck_element
      call invert_lists(owner, spread(1, 1, size(owner)), maxval(owner), parts%start, parts%element)
      do s = 1, size(model%steps)
         call collect_loads(parts, s, model, loads)
         order = sort_order(loads%component)
         order = order(sort_order(loads(order)%item))
         loads = loads(order(sort_order(loads(order)%kind)))
         stays = spread(.true., 1, size(loads))
         do i = 1, size(loads) - 1
            if (all(loads(i)%kind /= [load_film_coefficient, load_film_sink])) cycle
            ! As in CalculiX the last card holds, while other loads add up.
            stays(i) = loads(i)%kind /= loads(i + 1)%kind .or. loads(i)%item /= loads(i + 1)%item &
               .or. loads(i)%component /= loads(i + 1)%component
         end do
         model%steps(s)%loads = pack(loads, stays)
         call apply_supports(s, model)
      end do
   end subroutine apply_requests

   !> Initial temperatures. Nodes that a division added have those between their neighbours, unless
   !> a set that they are in has another one.
   pure subroutine apply_temperatures(model)
      type(model_type), intent(inout) :: model
      integer, allocatable :: nodes(:)
      integer :: first_new, i

      first_new = deck_node_count(model%mesh) + 1
      if (.not. allocated(model%initial_temperature)) then
         allocate (model%initial_temperature(size(model%mesh%node_number)), source=0.0_dp)
         first_new = 1
      end if
      do i = 1, model%requests%temperatures%count
         associate (request => model%requests%temperatures%items(i))
            nodes = request%members(model%mesh%node_sets)
            model%initial_temperature(pack(nodes, nodes >= first_new)) = request%value
         end associate
      end do
      do i = 1, size(model%couplings)
         if (.not. model%couplings(i)%is_section()) cycle
         associate (pairs => facing_nodes(model%couplings(i), model%mesh))
            model%initial_temperature(pairs(2, :)) = model%initial_temperature(pairs(1, :))
         end associate
      end do
   end subroutine apply_temperatures

   !> Number of nodes of the deck's mesh, which are the first ones.
   pure integer function deck_node_count(mesh)
      type(mesh_type), intent(in) :: mesh

      deck_node_count = size(mesh%node_number)
      if (allocated(mesh%deck_element)) deck_node_count = mesh%deck_nodes
   end function deck_node_count

   !> Nodes or elements that a load of a request acts on.
   pure function targets_of(request, parts, mesh) result(items)
      type(request_type), intent(in) :: request
      type(parts_type), intent(in) :: parts
      type(mesh_type), intent(in) :: mesh
      integer, allocatable :: items(:)
      integer :: side

      if (acts_on_nodes(request%kind)) then
         items = request%members(mesh%node_sets)
         items = pack(items, items <= deck_node_count(mesh))
         return
      else if (request%set > 0) then
         items = mesh%element_sets(request%set)%members
      else
         items = parts%element(parts%start(request%item):parts%start(request%item + 1) - 1)
      end if
      side = loaded_side(request%kind, request%component)
      if (side > 0 .and. allocated(mesh%on_deck_side)) items = pack(items, &
         mesh%on_deck_side(side, items))
   end function targets_of

   !> Loads of a step in the order of the cards, behind them those of the nodal fields.
   pure subroutine collect_loads(parts, step, model, loads)
      type(parts_type), intent(in) :: parts
      integer, intent(in) :: step
      type(model_type), intent(in) :: model
      type(load_type), allocatable, intent(out) :: loads(:)
      integer, allocatable :: items(:)
      integer :: i, j, n, pass

      do pass = 1, 2
         n = 0
         do i = 1, model%requests%loads%count
            associate (request => model%requests%loads%items(i))
               if (request%step /= step) cycle
               items = targets_of(request, parts, model%mesh)
               if (pass == 2) loads(n + 1:n + size(items)) = [(load_type(request%kind, items(j), &
                  request%component, request%value, request%amplitude, request%card), &
                  j=1, size(items))]
               n = n + size(items)
            end associate
         end do
         do i = 1, size(model%fields)
            associate (field => model%fields(i))
               if (field%step /= step) cycle
               items = pack([(j, j=1, size(field%given))], field%given)
               if (pass == 2) loads(n + 1:n + size(items)) = [(load_type(load_temperature, &
                  items(j), 1, field%values(items(j)), field%amplitude, field%card), &
                  j=1, size(items))]
               n = n + size(items)
            end associate
         end do
         if (pass == 1) allocate (loads(n))
      end do
   end subroutine collect_loads

   !> Prescribed values of a step. What is before the first step belongs to it, unless OP=NEW of
   !> that step ends it.
   pure subroutine apply_supports(step, model)
      integer, intent(in) :: step
      type(model_type), intent(inout) :: model
      type(boundary_type), allocatable :: supports(:)
      integer, allocatable :: nodes(:)
      logical :: is_new
      integer :: i, j, n, pass

      is_new = model%steps(1)%ends_boundaries
      do pass = 1, 2
         n = 0
         do i = 1, model%requests%supports%count
            associate (request => model%requests%supports%items(i))
               if (max(1, request%step) /= step .or. (request%step == 0 .and. is_new)) cycle
               nodes = request%members(model%mesh%node_sets)
               if (pass == 2) supports(n + 1:n + size(nodes)) = [(boundary_type(nodes(j), &
                  request%component, request%value, request%amplitude, request%card, &
                  request%keeps), j=1, size(nodes))]
               n = n + size(nodes)
            end associate
         end do
         if (pass == 1) allocate (supports(n))
      end do
      call move_alloc(supports, model%steps(step)%boundaries)
   end subroutine apply_supports

   !> Takes the temperatures of the steps out of the loads of a deck, as fields on its mesh. The
   !> last card that names a node in a step holds.
   pure subroutine collect_fields(model)
      type(model_type), intent(inout) :: model       !! on the deck's mesh
      type(nodal_field_type) :: field
      integer, allocatable :: nodes(:)
      integer :: f, i, k

      allocate (model%fields(0))
      do i = 1, model%requests%loads%count
         associate (request => model%requests%loads%items(i))
            if (request%kind /= load_temperature) cycle
            k = findloc(model%fields%step == request%step .and. model%fields%amplitude == &
               request%amplitude, .true., dim=1)
            if (k == 0) then
               field%step = request%step
               field%amplitude = request%amplitude
               field%given = spread(.false., 1, size(model%mesh%node_number))
               field%values = spread(0.0_dp, 1, size(model%mesh%node_number))
               model%fields = [model%fields, field]
               k = size(model%fields)
            end if
            nodes = request%members(model%mesh%node_sets)
            do f = 1, size(model%fields)
               if (model%fields(f)%step /= request%step) cycle
               model%fields(f)%given(nodes) = f == k
               model%fields(f)%values(nodes) = merge(request%value, 0.0_dp, f == k)
            end do
            model%fields(k)%card = request%card
         end associate
      end do
      do i = 1, size(model%couplings)
         if (.not. model%couplings(i)%is_section()) cycle
         associate (pairs => facing_nodes(model%couplings(i), model%mesh))
            do f = 1, size(model%fields)
               model%fields(f)%given(pairs(2, :)) = model%fields(f)%given(pairs(1, :))
               model%fields(f)%values(pairs(2, :)) = model%fields(f)%values(pairs(1, :))
            end do
         end associate
      end do
      associate (loads => model%requests%loads)
         if (loads%count == 0) return
         loads%items = pack(loads%items(:loads%count), &
            loads%items(:loads%count)%kind /= load_temperature)
         loads%count = size(loads%items)
      end associate
   end subroutine collect_fields

   !> Replaces the loads that a model requests by those on its mesh, which is the one that further
   !> divisions begin with.
   pure subroutine make_explicit(model)
      type(model_type), intent(inout) :: model       !! requests applied
      type(request_type) :: request
      integer :: i, s

      model%requests%loads%count = 0
      do s = 1, size(model%steps)
         request%step = s
         do i = 1, size(model%steps(s)%loads)
            associate (load => model%steps(s)%loads(i))
               if (load%kind == load_temperature) cycle
               request%kind = load%kind
               request%item = load%item
               request%component = load%component
               request%value = load%value
               request%amplitude = load%amplitude
               request%card = load%card
               call model%requests%loads%add(request)
            end associate
         end do
      end do
      if (allocated(model%mesh%deck_element)) deallocate (model%mesh%deck_element, &
         model%mesh%on_deck_side)
   end subroutine make_explicit

   !> The transform of each node, or 0.
   pure function transform_of(model) result(of_node)
      type(model_type), intent(in) :: model
      integer :: of_node(size(model%mesh%node_number)), i

      of_node = 0
      do i = 1, size(model%transforms)
         of_node(model%mesh%node_sets(model%transforms(i)%set)%members) = i
      end do
   end function transform_of

   !> Writes the equations and springs of a sound deck along x and y.
   subroutine turn_equations(model)
      type(model_type), intent(inout) :: model
      integer :: i, of_node(size(model%mesh%node_number))

      if (size(model%transforms) == 0) return
      of_node = transform_of(model)
      do i = 1, size(model%equations)
         model%equations(i) = along_axes(model%equations(i), model%mesh, model%transforms, of_node)
      end do
      do i = 1, size(model%bars)
         if (model%bars(i)%follows_axes) model%bars(i)%elongation = along_axes( &
            model%bars(i)%elongation, model%mesh, model%transforms, of_node)
      end do
   end subroutine turn_equations

   !> Puts what cards prescribe or load along axes of nodes, once it is applied to the mesh, on the
   !> partners of the nodes.
   subroutine apply_transforms(model)
      type(model_type), intent(inout) :: model
      integer :: of_node(size(model%mesh%node_number)), partner(size(model%mesh%node_number))
      logical :: named(2, size(model%mesh%node_number))
      integer :: i, s

      if (.not. allocated(model%partners)) allocate (model%partners(0))
      if (size(model%transforms) == 0) return
      of_node = transform_of(model)
      call drop_hanging(model, of_node)
      named = .false.
      do s = 1, size(model%steps)
         associate (boundaries => model%steps(s)%boundaries, loads => model%steps(s)%loads)
            do i = 1, size(boundaries)
               if (boundaries(i)%dof == dof_temperature) cycle
               named(boundaries(i)%dof, boundaries(i)%node) = .true.
            end do
            do i = 1, size(loads)
               if (loads(i)%kind /= load_force) cycle
               named(2 - modulo(loads(i)%component, 2), loads(i)%item) = .true.
            end do
         end associate
      end do
      partner = 0
      partner(model%partners%node) = model%partners%partner
      do i = 1, size(of_node)
         if (of_node(i) == 0 .or. .not. any(named(:, i))) cycle
         if (partner(i) == 0) call add_partner(model, i, of_node(i), partner(i))
         call relate(model, findloc(model%partners%node, i, dim=1), of_node(i), named(:, i))
      end do
      do s = 1, size(model%steps)
         associate (boundaries => model%steps(s)%boundaries, loads => model%steps(s)%loads)
            do i = 1, size(boundaries)
               if (boundaries(i)%dof /= dof_temperature) call move(boundaries(i)%node)
            end do
            do i = 1, size(loads)
               if (loads(i)%kind == load_force) call move(loads(i)%item)
            end do
         end associate
      end do
      if (model%load_node > 0 .and. model%load_dof /= dof_temperature) call move(model%load_node)

   contains
      subroutine move(node)
         integer, intent(inout) :: node

         if (partner(node) > 0) node = partner(node)
      end subroutine move
   end subroutine apply_transforms

   !> Drops what is prescribed along axes of nodes that hang: they follow the nodes of their side,
   !> which are in the same set.
   subroutine drop_hanging(model, of_node)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: of_node(:)
      type(sum_list_type) :: rows
      logical :: follows(size(of_node))
      integer :: i, s

      rows = hanging_rows(model%mesh)
      follows = .false.
      do i = 1, rows%count
         follows(rows%value(rows%start(i))) = .true.
      end do
      follows = follows .and. of_node > 0
      do s = 1, size(model%steps)
         model%steps(s)%boundaries = pack(model%steps(s)%boundaries, model%steps(s)%boundaries%dof &
            == dof_temperature .or. .not. follows(model%steps(s)%boundaries%node))
      end do
   end subroutine drop_hanging

   !> Adds the partner of a node.
   pure subroutine add_partner(model, node, transform, partner)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: node, transform
      integer, intent(out) :: partner
      real(dp) :: place(2)
      integer :: i

      place = model%mesh%coordinates(:, node)
      call add_node(model%mesh, place)
      partner = size(model%mesh%node_number)
      model%partners = [model%partners, &
         partner_type(node, partner, axes_at(model%transforms(transform), place))]
      model%initial_temperature = [model%initial_temperature, model%initial_temperature(node)]
      do i = 1, size(model%fields)
         model%fields(i)%given = [model%fields(i)%given, .false.]
         model%fields(i)%values = [model%fields(i)%values, 0.0_dp]
      end do
   end subroutine add_partner

   !> Adds the equations of the components of a partner that cards name.
   pure subroutine relate(model, p, transform, named)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: p, transform
      logical, intent(in) :: named(2)
      type(equation_type) :: equation
      integer :: c

      do c = 1, 2
         if (.not. named(c)) cycle
         associate (pair => model%partners(p))
            equation%title = model%transforms(transform)%title
            equation%card = model%transforms(transform)%card
            equation%node = [pair%partner]
            equation%dof = [c]
            equation%coefficient = [1.0_dp]
            call equation%add_term(pair%node, 1, -pair%axes(1, c))
            call equation%add_term(pair%node, 2, -pair%axes(2, c))
         end associate
         model%equations = [model%equations, equation]
      end do
   end subroutine relate

end module load_application
