!> Element types of the dialect: which are built, which are refused.
module element_types
   use element_kinds, only: axisymmetric, element_node_count, plane_strain, plane_stress, quad4, &
      quad8, quad8_reduced, triangle3, triangle6
   use text, only: nearest_known, string_type, to_upper
   implicit none
   private
   public :: take_element_type, element_type_fields, line_node_count

   character(3), parameter :: plane_names(3) = ['CPE', 'CPS', 'CAX']
   integer, parameter :: planes(3) = [plane_strain, plane_stress, axisymmetric]

   character(2), parameter :: kind_names(5) = ['8 ', '8R', '4 ', '6 ', '3 ']
   integer, parameter :: element_kinds_named(5) = &
      [quad8, quad8_reduced, quad4, triangle6, triangle3]

contains

   !> Kind and plane that an element type names, or why it cannot be used.
   pure subroutine take_element_type(name, kind, plane, message)
      character(*), intent(in) :: name           !! TYPE= in upper case
      integer, intent(out) :: kind               !! quad8, ...; quad8 after an error
      integer, intent(out) :: plane              !! plane_strain, ...; plane_strain after an error
      character(:), allocatable, intent(out) :: message   !! what is wrong, or empty
      type(string_type) :: names(size(plane_names)*size(kind_names))
      character(:), allocatable :: solid_name
      integer :: i, k, n

      kind = quad8
      plane = plane_strain
      message = ''
      n = 0
      ! Abaqus' names of elements that conduct heat; CalculiX takes those of rings too.
      solid_name = name
      if (index(name, 'DCAX') == 1) solid_name = name(2:)
      do i = 1, size(plane_names)
         do k = 1, size(kind_names)
            n = n + 1
            names(n)%value = trim(plane_names(i)//kind_names(k))
            if (solid_name /= names(n)%value) cycle
            kind = element_kinds_named(k)
            plane = planes(i)
            return
         end do
      end do
      if (any(plane_names//'4R' == name)) then
         message = 'element type '//name// &
            ' is refused: linear elements with reduced integration need hourglass control; '// &
            'take '//name(:4)
      else if (index(name, 'C3D') == 1) then
         message = 'element type '//name//' is refused: models are two-dimensional'
      else if (name == 'M3D9') then
         message = 'element type M3D9 is refused: quadrilaterals of second order have 8 nodes; '// &
            'in gmsh set Mesh.SecondOrderIncomplete = 1'
      else if (index(name, 'DC2D') == 1) then
         message = 'element type '//name//' is refused; take CPE'//name(5:)
      else
         message = 'unknown element type '//name//nearest_known(name, names)
      end if
   end subroutine take_element_type

   !> Fields of the data card of an element type; 0 for a type that cannot be used.
   pure integer function element_type_fields(name)
      character(*), intent(in) :: name   !! TYPE= as written
      character(:), allocatable :: message
      integer :: kind, plane

      call take_element_type(to_upper(name), kind, plane, message)
      element_type_fields = 0
      if (line_node_count(to_upper(name)) > 0) then
         element_type_fields = line_node_count(to_upper(name)) + 1
         return
      end if
      if (len(message) == 0) element_type_fields = element_node_count(kind) + 1
   end function element_type_fields

   !> Nodes of a line element, such as gmsh writes for a physical curve; 0 for all other types.
   pure integer function line_node_count(name)
      character(*), intent(in) :: name   !! TYPE= in upper case

      select case (name)
      case ('T3D2')
         line_node_count = 2
      case ('T3D3')
         line_node_count = 3
      case default
         line_node_count = 0
      end select
   end function line_node_count

end module element_types
