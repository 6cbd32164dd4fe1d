!> *TRANSFORM -> nodes with axes of their own, and what cards say of them.
module deck_builder_transforms
   use card_parameters, only: choose, parameter_place
   use card_values, only: check_extra, need_field, take_field
   use cards, only: cards_type, data_card_type, field_place, keyword_card_type
   use deck_context, only: need_named
   use deck_report, only: deck_report_type
   use deck_structure, only: cards_of
   use equations, only: equation_type
   use hanging_nodes, only: hanging_rows
   use kinds, only: dp
   use mesh, only: add_node, extent_of
   use model, only: model_type
   use steps, only: dof_temperature, load_force
   use sum_lists, only: sum_list_type
   use text, only: to_text
   use transforms, only: along_axes, axes_at, partner_type, transform_type
   implicit none
   private
   public :: build_transforms, turn_equations, apply_transforms

   real(dp), parameter :: negligible = 1.0e-9_dp   !! part of a direction or of the model

contains

   !> Builds all transforms.
   subroutine build_transforms(cards, model, report)
      type(cards_type), intent(in) :: cards
      type(model_type), intent(inout) :: model             !! receives them
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer, allocatable :: places(:)
      integer :: n

      places = cards_of(cards, 'TRANSFORM')
      allocate (model%transforms(size(places)))
      do n = 1, size(places)
         call build_transform(cards, cards%keywords(places(n)), model, report, model%transforms(n))
         call check_nodes(cards%keywords(places(n)), n, model, report)
      end do
   end subroutine build_transforms

   subroutine build_transform(cards, card, model, report, transform)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      type(transform_type), intent(out) :: transform
      character(:), allocatable :: kind

      transform%title = '*TRANSFORM, '//report%source%words_of(card%place)
      transform%card = card%place%image
      call need_named(card, 'NSET', 'node set', model%mesh%node_sets, report, transform%set)
      kind = 'R'
      call choose(card, 'TYPE', 'R/C', report, kind)
      transform%cylindrical = kind == 'C'
      if (card%last_data >= card%first_data) call read_points(cards%data(card%first_data), report, &
         transform)
   end subroutine build_transform

   !> Two points: on the first axis and in the plane of the first two; or on the axis of a cylinder.
   subroutine read_points(data, report, transform)
      type(data_card_type), intent(in) :: data
      type(deck_report_type), intent(inout) :: report
      type(transform_type), intent(inout) :: transform
      character(*), parameter :: names = 'xyz'
      real(dp) :: x(3, 2), across
      integer :: i, j
      logical :: valid

      valid = .true.
      x = 0.0_dp
      do j = 1, 2
         do i = 1, 3
            if (i < 3) call need_field(data, 3*(j - 1) + i, names(i:i)//' of point '// &
               'ab'(j:j), report, x(i, j), valid)
            if (i == 3) call take_field(data, 3*j, 'z of point '//'ab'(j:j), report, x(3, j), valid)
         end do
      end do
      call check_extra(data, 6, 'x, y and z of two points', report)
      if (.not. valid) return
      transform%point = x(:2, 1)
      if (transform%cylindrical) then
         x(:, 2) = x(:, 2) - x(:, 1)
         transform%sense = sign(1.0_dp, x(3, 2))
         if (norm2(x(:2, 2)) > negligible*norm2(x(:, 2)) .or. norm2(x(:, 2)) <= 0.0_dp) call &
            report%error(field_place(data, 1), 'TYPE=C of a plane is round an axis along z, '// &
            'such as 0., 0., 0., 0., 0., 1.')
      else
         across = x(1, 1)*x(2, 2) - x(2, 1)*x(1, 2)
         transform%sense = sign(1.0_dp, across)
         if (maxval(abs(x(3, :))) > negligible*maxval(abs(x)) .or. &
            abs(across) <= negligible*norm2(x(:, 1))*norm2(x(:, 2))) call report%error( &
            field_place(data, 1), 'TYPE=R of a plane has two points in it that are '// &
            'not in line with the origin, such as 1., 1., 0., -1., 1., 0.')
      end if
   end subroutine read_points

   !> A node has one transform, and is not on the axis of it.
   subroutine check_nodes(card, n, model, report)
      type(keyword_card_type), intent(in) :: card
      integer, intent(in) :: n
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      integer :: i, k

      if (model%transforms(n)%set == 0) return
      associate (members => model%mesh%node_sets(model%transforms(n)%set)%members, &
         number => model%mesh%node_number, x => model%mesh%coordinates)
         do i = 1, size(members)
            do k = 1, n - 1
               if (model%transforms(k)%set == 0) cycle
               if (all(model%mesh%node_sets(model%transforms(k)%set)%members /= members(i))) cycle
               call report%error(parameter_place(card, 'NSET'), 'node '// &
                  to_text(number(members(i)))//' has axes of its own by '// &
                  model%transforms(k)%title//' already')
               return
            end do
            if (.not. model%transforms(n)%cylindrical) cycle
            if (norm2(x(:, members(i)) - model%transforms(n)%point) > negligible*extent_of(x)) cycle
            call report%error(parameter_place(card, 'NSET'), 'node '// &
               to_text(number(members(i)))//' is on the axis, where no direction is radial')
            return
         end do
      end associate
   end subroutine check_nodes

   !> The transform of each node, or 0.
   pure function transform_of(model) result(of_node)
      type(model_type), intent(in) :: model
      integer :: of_node(size(model%mesh%node_number))
      integer :: i

      of_node = 0
      do i = 1, size(model%transforms)
         of_node(model%mesh%node_sets(model%transforms(i)%set)%members) = i
      end do
   end function transform_of

   !> Writes the equations of a sound deck along x and y.
   subroutine turn_equations(model)
      type(model_type), intent(inout) :: model
      integer :: i, of_node(size(model%mesh%node_number))

      if (size(model%transforms) == 0) return
      of_node = transform_of(model)
      do i = 1, size(model%equations)
         model%equations(i) = along_axes(model%equations(i), model%mesh, model%transforms, of_node)
      end do
   end subroutine turn_equations

   !> Puts what cards prescribe or load along axes of nodes on the partners of the nodes. The mesh
   !> is final.
   subroutine apply_transforms(model)
      type(model_type), intent(inout) :: model
      integer :: of_node(size(model%mesh%node_number)), partner(size(model%mesh%node_number))
      logical :: named(2, size(model%mesh%node_number))
      integer :: i, s

      allocate (model%partners(0))
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
      do i = 1, size(of_node)
         if (of_node(i) > 0 .and. any(named(:, i))) call add_partner(model, i, of_node(i), &
            named(:, i), partner(i))
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
         model%steps(s)%boundaries = pack(model%steps(s)%boundaries, &
            model%steps(s)%boundaries%dof == dof_temperature .or. &
            .not. follows(model%steps(s)%boundaries%node))
      end do
   end subroutine drop_hanging

   !> Adds the partner of a node, and the equations of the components that cards name.
   subroutine add_partner(model, node, transform, named, partner)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: node, transform
      logical, intent(in) :: named(2)
      integer, intent(out) :: partner
      type(equation_type) :: equation
      type(partner_type) :: pair
      real(dp) :: place(2)
      integer :: c

      place = model%mesh%coordinates(:, node)
      call add_node(model%mesh, place)
      partner = size(model%mesh%node_number)
      pair%node = node
      pair%partner = partner
      pair%axes = axes_at(model%transforms(transform), place)
      model%initial_temperature = [model%initial_temperature, model%initial_temperature(node)]
      model%partners = [model%partners, pair]
      do c = 1, 2
         if (.not. named(c)) cycle
         equation%title = model%transforms(transform)%title
         equation%card = model%transforms(transform)%card
         equation%node = [partner]
         equation%dof = [c]
         equation%coefficient = [1.0_dp]
         call equation%add_term(node, 1, -pair%axes(1, c))
         call equation%add_term(node, 2, -pair%axes(2, c))
         model%equations = [model%equations, equation]
      end do
   end subroutine add_partner

end module deck_builder_transforms
