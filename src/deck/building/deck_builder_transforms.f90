!> *TRANSFORM -> nodes with axes of their own, and what cards say of them.
module deck_builder_transforms
   use card_parameters, only: choose, parameter_place
   use card_values, only: check_extra, need_field, take_field
   use cards, only: cards_type, data_card_type, field_place, keyword_card_type
   use deck_context, only: need_named
   use deck_report, only: deck_report_type
   use deck_structure, only: cards_of
   use kinds, only: dp
   use mesh, only: extent_of
   use model, only: model_type
   use text, only: to_text
   use transforms, only: transform_type
   implicit none
   private
   public :: build_transforms

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

end module deck_builder_transforms
