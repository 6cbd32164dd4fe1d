!> Element types of the dialect: which are built, which come later, which are refused.
module element_types
   use text, only: nearest_known, string_type
   implicit none
   private
   public :: check_element_type

   character(5), parameter :: built_types(1) = ['CPE8 ']              !! plane strain, eight nodes
   character(5), parameter :: other_planes(2) = ['CPS8 ', 'CAX8 ']  !! the same nodes, another plane
   character(5), parameter :: later_types(12) = ['CPE8R', 'CPS8R', 'CAX8R', &
      'CPE4 ', 'CPS4 ', 'CAX4 ', 'CPE3 ', 'CPS3 ', 'CAX3 ', 'CPE6 ', 'CPS6 ', 'CAX6 ']
   character(5), parameter :: hourglass_types(3) = ['CPE4R', 'CPS4R', 'CAX4R']

contains

   !> Why an element type cannot be used; empty where it can.
   pure function check_element_type(name, strain) result(message)
      character(*), intent(in) :: name           !! TYPE= in upper case
      logical, intent(in) :: strain              !! whether PLANE=STRAIN overrides the names
      character(:), allocatable :: message       !! what is wrong, or empty
      type(string_type) :: names(size(built_types) + size(other_planes) + size(later_types))
      integer :: i

      message = ''
      if (any(built_types == name)) return
      if (any(other_planes == name)) then
         if (.not. strain) message = 'element type '//name// &
            ' is not built yet; *OPTIONS, PLANE=STRAIN takes it as CPE8'
      else if (any(later_types == name)) then
         message = 'element type '//name//' is not built yet'
      else if (any(hourglass_types == name)) then
         message = 'element type '//name// &
            ' is refused: linear elements with reduced integration need hourglass control'
      else if (index(name, 'C3D') == 1) then
         message = 'element type '//name//' is refused: models are two-dimensional'
      else
         do i = 1, size(names)
            names(i)%value = type_name(i)
         end do
         message = 'unknown element type '//name//nearest_known(name, names)
      end if
   end function check_element_type

   pure function type_name(i) result(name)
      integer, intent(in) :: i
      character(:), allocatable :: name
      character(5), parameter :: all_types(15) = [built_types, other_planes, later_types]

      name = trim(all_types(i))
   end function type_name

end module element_types
