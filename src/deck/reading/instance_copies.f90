!> The cards of a part as those of an instance of it: numbered and named for the whole deck, and
!> moved.
module instance_copies
   use card_parameters, only: has_parameter
   use card_values, only: check_extra, take_field
   use cards, only: add_data, add_keyword, cards_type, data_card_type, field_place, field_text, &
      field_type, keyword_card_type
   use deck_report, only: deck_report_type
   use generated_cards, only: exact_text
   use kinds, only: dp
   use text, only: read_integer, read_real, to_text, to_upper
   implicit none
   private
   public :: instance_type, copy_card, members_of_instance, read_motion

   real(dp), parameter :: degree = acos(-1.0_dp)/180
   real(dp), parameter :: negligible = 1.0e-9_dp   !! part of a direction or distance

   !> Where the cards of a part come to be.
   type :: instance_type
      character(:), allocatable :: name       !! in upper case; empty for the assembly itself
      integer :: offset = 0                   !! what is added to numbers of nodes and elements
      real(dp) :: turn(2, 2) = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2]) !! rotation
      real(dp) :: shift(2) = 0.0_dp           !! displacement after it [length]
      logical :: moves = .false.              !! whether coordinates change
   end type instance_type

contains

   !> Translation; axis and angle of a rotation that follows it. Both stay in the plane.
   subroutine read_motion(cards, card, report, instance)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card           !! *INSTANCE
      type(deck_report_type), intent(inout) :: report       !! receives errors
      type(instance_type), intent(inout) :: instance        !! receives its motion
      character(*), parameter :: layouts(2) = [character(60) :: 'translation along x, y and z', &
         'two points of the axis, x, y and z of each, angle in degrees']
      real(dp) :: x(7, 2)
      integer :: i, j, n
      logical :: valid

      x = 0.0_dp
      valid = .true.
      n = card%last_data - card%first_data + 1
      if (n > 2) then
         call report%error(field_place(cards%data(card%first_data + 2), 1), &
            '*INSTANCE has a translation and a rotation, two data cards')
         return
      end if
      do j = 1, n
         associate (data => cards%data(card%first_data + j - 1))
            do i = 1, merge(3, 7, j == 1)
               call take_field(data, i, trim(layouts(j)), report, x(i, j), valid)
            end do
            call check_extra(data, merge(3, 7, j == 1), trim(layouts(j)), report)
         end associate
      end do
      instance%moves = n > 0
      if (.not. valid .or. n == 0) return
      instance%shift = x(:2, 1)
      if (abs(x(3, 1)) > negligible*maxval(abs(x(:3, 1)))) call report%error( &
         field_place(cards%data(card%first_data), 3), 'an instance stays in the plane: its '// &
         'translation along z must be 0')
      if (n == 1) return
      associate (axis => x(4:6, 2) - x(1:3, 2), data => cards%data(card%first_data + 1))
         if (norm2(axis(:2)) > negligible*norm2(axis) .or. norm2(axis) <= 0.0_dp) then
            call report%error(field_place(data, 1), 'an instance stays in the plane: it turns '// &
               'round an axis along z, such as 0., 0., 0., 0., 0., 1., 90.')
            return
         end if
         associate (c => cos(x(7, 2)*degree), s => sign(1.0_dp, axis(3))*sin(x(7, 2)*degree))
            instance%turn = reshape([c, s, -s, c], [2, 2])
         end associate
      end associate
      instance%shift = x(:2, 2) + matmul(instance%turn, instance%shift - x(:2, 2))
   end subroutine read_motion

   !> Adds a card of a part for an instance. Errors that the copy has are reported where the card
   !> of the part is.
   subroutine copy_card(cards, card, instance, all)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card           !! one of its keyword cards
      type(instance_type), intent(in) :: instance
      type(cards_type), intent(inout) :: all                !! receives the copy
      type(keyword_card_type) :: copy
      type(field_type), allocatable :: fields(:)
      integer :: i, j

      copy = card
      do i = 1, size(copy%parameters)
         if (.not. is_name(card%name, copy%parameters(i)%name)) cycle
         call prefix(instance, copy%parameters(i)%text)
      end do
      call add_keyword(all, copy)
      do j = card%first_data, card%last_data
         fields = cards%data(j)%fields
         call convert(card, cards%data(j), j - card%first_data + 1, instance, fields)
         call add_data(all, fields, cards%data(j)%end)
      end do
   end subroutine copy_card

   !> Whether the value of a parameter is the name of something that the part has for itself.
   pure logical function is_name(keyword, parameter)
      character(*), intent(in) :: keyword, parameter

      select case (parameter)
      case ('NSET', 'ELSET', 'SURFACE', 'ORIENTATION', 'REF NODE')
         is_name = .true.
      case ('NAME')
         is_name = keyword == 'SURFACE' .or. keyword == 'ORIENTATION'
      case default
         is_name = .false.
      end select
   end function is_name

   !> Puts the name of the instance before a name, and adds its offset to a number.
   subroutine prefix(instance, text)
      type(instance_type), intent(in) :: instance
      character(:), allocatable, intent(inout) :: text
      integer :: number
      logical :: is_number

      if (len(text) == 0) return
      call read_integer(text, number, is_number)
      if (is_number) then
         text = to_text(number + instance%offset)
      else if (len(instance%name) > 0) then
         text = instance%name//'.'//text
      end if
   end subroutine prefix

   !> Numbers, names and coordinates of one data card.
   subroutine convert(card, data, position, instance, fields)
      type(keyword_card_type), intent(in) :: card
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: position                       ! of the data card, from 1
      type(instance_type), intent(in) :: instance
      type(field_type), intent(inout) :: fields(:)
      type(instance_type) :: motion
      integer :: i, n

      n = size(fields)
      select case (card%name)
      case ('NODE')
         call prefix_fields(1, min(1, n), 1)
         if (instance%moves) call move_point(data, 2, instance, fields)
      case ('ELEMENT')
         call prefix_fields(1, n, 1)
      case ('NSET', 'ELSET')
         if (has_parameter(card, 'GENERATE')) n = min(2, n)
         call prefix_fields(1, n, 1)
      case ('NGEN')
         call prefix_fields(1, min(2, n), 1)
      case ('ELGEN', 'SURFACE')
         call prefix_fields(1, min(1, n), 1)
      case ('EQUATION')
         if (n > 1) call prefix_fields(1, n, 3)
      case ('TIE', 'CONTACT PAIR')
         call prefix_fields(1, min(2, n), 1)
      case ('ORIENTATION')
         ! Points from the origin, or on the axis of a cylindrical system.
         if (.not. instance%moves .or. position > 1) return
         motion = instance
         if (.not. has_parameter(card, 'SYSTEM')) motion%shift = 0.0_dp
         call move_point(data, 1, motion, fields)
         call move_point(data, 4, motion, fields)
      case default
         continue
      end select

   contains
      subroutine prefix_fields(first, last, step)
         integer, intent(in) :: first, last, step

         do i = first, last, step
            call prefix(instance, fields(i)%text)
         end do
      end subroutine prefix_fields
   end subroutine convert

   !> Turns and shifts the point whose x is a field; what is no number is reported elsewhere.
   subroutine move_point(data, at, instance, fields)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: at
      type(instance_type), intent(in) :: instance
      type(field_type), intent(inout) :: fields(:)
      real(dp) :: x(2)
      integer :: i
      logical :: valid

      do i = 1, 2
         x(i) = 0.0_dp
         if (len(field_text(data, at + i - 1)) == 0) cycle
         call read_real(field_text(data, at + i - 1), x(i), valid)
         if (.not. valid) return
      end do
      x = matmul(instance%turn, x) + instance%shift
      do i = 1, min(2, size(fields) - at + 1)
         fields(at + i - 1)%text = exact_text(x(i))
      end do
   end subroutine move_point

   !> Writes INSTANCE.number as the number that the node or element has in the whole deck.
   subroutine members_of_instance(instances, text)
      type(instance_type), intent(in) :: instances(:)
      character(:), allocatable, intent(inout) :: text
      integer :: dot, i, number
      logical :: is_number

      dot = index(text, '.', back=.true.)
      if (dot < 2 .or. dot == len(text)) return
      if (verify(text(dot + 1:), '0123456789') > 0) return
      do i = 1, size(instances)
         if (len(instances(i)%name) /= dot - 1) cycle
         if (instances(i)%name /= to_upper(text(:dot - 1))) cycle
         call read_integer(text(dot + 1:), number, is_number)
         if (is_number) text = to_text(number + instances(i)%offset)
         return
      end do
   end subroutine members_of_instance

end module instance_copies
