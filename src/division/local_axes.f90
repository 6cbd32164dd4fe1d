!> Nodes with axes of their own on the mesh of a model, and their partners.
module local_axes
   use equations, only: equation_type
   use hanging_nodes, only: hanging_rows
   use kinds, only: dp
   use mesh, only: add_node
   use model, only: model_type
   use steps, only: dof_temperature, load_force
   use sum_lists, only: sum_list_type
   use transforms, only: along_axes, axes_at, partner_type
   implicit none
   private
   public :: turn_equations, apply_transforms

contains

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
         model%steps(s)%boundaries = pack(model%steps(s)%boundaries, &
            model%steps(s)%boundaries%dof == dof_temperature .or. &
            .not. follows(model%steps(s)%boundaries%node))
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

end module local_axes
