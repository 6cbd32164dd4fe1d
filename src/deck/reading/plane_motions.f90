!> Motions that cards of Abaqus give by a translation and a rotation; both stay in the plane.
module plane_motions
   use card_values, only: read_row
   use cards, only: data_card_type
   use deck_report, only: deck_report_type
   use kinds, only: dp
   implicit none
   private
   public :: motion_type, read_motion, rotation, axis_layout

   !> Two points of an axis, as read_row.
   character(*), parameter :: axis_layout = 'x of point 1?/y of point 1?/z of point 1?/'// &
      'x of point 2?/y of point 2?/z of point 2? =1'

   real(dp), parameter :: degree = acos(-1.0_dp)/180
   real(dp), parameter :: negligible = 1.0e-9_dp   !! part of a direction or distance

   !> What becomes of a place x: turn x + shift.
   type :: motion_type
      real(dp) :: turn(2, 2) = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])
      real(dp) :: shift(2) = 0.0_dp   !! [length]
   contains
      procedure :: moved
   end type motion_type

contains

   !> A place behind the motion.
   pure function moved(self, x)
      class(motion_type), intent(in) :: self
      real(dp), intent(in) :: x(2)                       !! [length]
      real(dp) :: moved(2)                               !! [length]

      moved = matmul(self%turn, x) + self%shift
   end function moved

   !> Reads a translation and, on a second card, axis and angle of the rotation that follows it.
   subroutine read_motion(rows, times, report, motion)
      type(data_card_type), intent(in) :: rows(:)
      integer, intent(in) :: times                       !! the angle counts as often
      class(deck_report_type), intent(inout) :: report   !! receives errors
      type(motion_type), intent(out) :: motion           !! receives what is sound of it
      real(dp) :: x(7)
      logical :: valid

      if (size(rows) == 0) return
      call read_row(rows(1), 'translation along x?/translation along y?/translation along z?', &
         report, x(:3), valid)
      motion%shift = x(:2)
      if (abs(x(3)) > negligible*maxval(abs(x(:3)))) call report%error(rows(1)%place(3), &
         'models stay in the plane: the translation along z must be 0')
      if (size(rows) == 1) return
      call read_row(rows(2), axis_layout//'/angle in degrees?', report, x, valid)
      if (.not. valid) return
      associate (axis => x(4:6) - x(:3))
         if (norm2(axis(:2)) > negligible*norm2(axis) .or. norm2(axis) <= 0.0_dp) call &
            report%error(rows(2)%place(1), 'models stay in the plane: the axis of the rotation '// &
            'is along z, such as 0., 0., 0., 0., 0., 1., 90.')
         motion%turn = rotation(sign(times*degree, axis(3))*x(7))
      end associate
      motion%shift = x(:2) + matmul(motion%turn, motion%shift - x(:2))
   end subroutine read_motion

   !> Turns a place about the origin.
   pure function rotation(angle)
      real(dp), intent(in) :: angle                      !! anticlockwise [rad]
      real(dp) :: rotation(2, 2)

      rotation = reshape([cos(angle), sin(angle), -sin(angle), cos(angle)], [2, 2])
   end function rotation

end module plane_motions
