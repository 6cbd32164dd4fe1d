!> *ORIENTATION -> axes of materials.
module deck_builder_orientations
   use card_parameters, only: choose, need_parameter
   use card_values, only: check_extra, need_field, take_field
   use cards, only: cards_type, data_card_type, field_place, has_field, keyword_card_type
   use deck_report, only: deck_report_type
   use deck_structure, only: card_count, report_twice
   use kinds, only: dp
   use model, only: model_type
   use orientations, only: orientation_type
   implicit none
   private
   public :: build_orientations, find_orientation

   real(dp), parameter :: degree = acos(-1.0_dp)/180

contains

   !> Takes all orientations.
   subroutine build_orientations(cards, model, report)
      type(cards_type), intent(in) :: cards
      type(model_type), intent(inout) :: model             !! receives the orientations
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer :: k, n

      allocate(model%orientations(card_count(cards, 'ORIENTATION')))
      n = 0
      do k = 1, size(cards%keywords)
         if (cards%keywords(k)%name /= 'ORIENTATION') cycle
         n = n + 1
         associate (card => cards%keywords(k), mine => model%orientations(n))
            call need_parameter(card, 'NAME', report, mine%name)
            if (find_orientation(model%orientations(:n - 1), mine%name) > 0) then
               call report_twice(cards, k, 'orientation '//mine%name, report)
            end if
            if (card%last_data >= card%first_data) call build_axes(cards, card, mine, report)
         end associate
      end do
   end subroutine build_orientations

   !> Index of an orientation by its name; 0 for an unknown one.
   pure integer function find_orientation(orientations, name)
      type(orientation_type), intent(in) :: orientations(:)
      character(*), intent(in) :: name                        !! name in upper case

      do find_orientation = size(orientations), 1, -1
         if (orientations(find_orientation)%name == name) return
      end do
   end function find_orientation

   subroutine build_axes(cards, card, orientation, report)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(orientation_type), intent(inout) :: orientation
      type(deck_report_type), intent(inout) :: report
      character(:), allocatable :: system
      real(dp) :: a(3), b(3)
      logical :: valid

      system = 'RECTANGULAR'
      call choose(card, 'SYSTEM', 'RECTANGULAR/CYLINDRICAL', report, system)
      valid = .true.
      associate (data => cards%data(card%first_data))
         call read_point(data, 1, 'a', report, a, valid)
         call read_point(data, 4, 'b', report, b, valid)
         call check_extra(data, 6, 'a(1), a(2), a(3), b(1), b(2), b(3)', report)
         if (.not. valid) return
         orientation%cylindrical = system == 'CYLINDRICAL'
         if (orientation%cylindrical) then
            call take_cylindrical(data, a, b, orientation, report)
         else
            call take_rectangular(data, a, b, orientation, report)
         end if
      end associate
      if (card%last_data > card%first_data) then
         call turn_axes(cards%data(card%first_data + 1), orientation, report)
      end if
   end subroutine build_axes

   subroutine read_point(data, first, name, report, point, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: first
      character(*), intent(in) :: name
      type(deck_report_type), intent(inout) :: report
      real(dp), intent(out) :: point(3)
      logical, intent(inout) :: valid
      integer :: i

      point = 0.0_dp
      do i = 1, 3
         call need_field(data, first + i - 1, 'component of '//name, report, point(i), valid)
         if (.not. has_field(data, first + i - 1)) exit
      end do
   end subroutine read_point

   !> a lies on axis 1, b in the plane of axes 1 and 2 on the side of axis 2.
   subroutine take_rectangular(data, a, b, orientation, report)
      type(data_card_type), intent(in) :: data
      real(dp), intent(in) :: a(3), b(3)
      type(orientation_type), intent(inout) :: orientation
      type(deck_report_type), intent(inout) :: report
      real(dp) :: turn

      if (abs(a(3)) > 0.0_dp .or. abs(b(3)) > 0.0_dp) then
         call report%error(field_place(data, merge(3, 6, abs(a(3)) > 0.0_dp)), &
            'axes 1 and 2 lie in the plane: the z components of a and b must be 0')
         return
      end if
      turn = a(1)*b(2) - a(2)*b(1)
      if (.not. abs(turn) > epsilon(turn)*norm2(a)*norm2(b)) then
         call report%error(field_place(data, 1), 'a and b must not lie on one line')
         return
      end if
      orientation%direction = a(1:2)/norm2(a(1:2))
      orientation%hand = sign(1.0_dp, turn)
   end subroutine take_rectangular

   !> a and b are two points of the axis; axis 3 points from a to b.
   subroutine take_cylindrical(data, a, b, orientation, report)
      type(data_card_type), intent(in) :: data
      real(dp), intent(in) :: a(3), b(3)
      type(orientation_type), intent(inout) :: orientation
      type(deck_report_type), intent(inout) :: report

      if (norm2(b(1:2) - a(1:2)) > 0.0_dp .or. .not. abs(b(3) - a(3)) > 0.0_dp) then
         call report%error(field_place(data, 4), 'the axis through a and b must be parallel to z')
         return
      end if
      orientation%centre = a(1:2)
      orientation%hand = sign(1.0_dp, b(3) - a(3))
   end subroutine take_cylindrical

   !> The second card: a turn round axis 3, from axis 1 towards axis 2.
   subroutine turn_axes(data, orientation, report)
      type(data_card_type), intent(in) :: data
      type(orientation_type), intent(inout) :: orientation
      type(deck_report_type), intent(inout) :: report
      real(dp) :: angle
      integer :: axis
      logical :: valid

      valid = .true.
      axis = 3
      angle = 0.0_dp
      call need_field(data, 1, 'axis', report, axis, valid)
      call take_field(data, 2, 'angle in degrees', report, angle, valid)
      call check_extra(data, 2, 'axis, angle', report)
      if (.not. valid) return
      if (axis /= 3) then
         call report%error(field_place(data, 1), &
            'a turn about axis 1 or 2 leaves the plane: only axis 3')
         return
      end if
      angle = angle*degree
      associate (first => orientation%direction, &
         second => orientation%hand*[-orientation%direction(2), orientation%direction(1)])
         orientation%direction = cos(angle)*first + sin(angle)*second
      end associate
   end subroutine turn_axes

end module deck_builder_orientations
