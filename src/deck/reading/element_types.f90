!> Element types of the dialect: which are built, which are refused.
module element_types
   use element_kinds, only: axisymmetric, element_node_count, generalized_strain, plane_strain, &
      plane_stress, quad4, quad4_enhanced, quad8, quad8_reduced, triangle3, triangle6
   use spelling, only: nearest_known
   use text, only: string_type, to_upper
   implicit none
   private
   public :: take_element_type, element_type_fields, line_node_count, line_kind
   public :: rigid_line, drawn_line, truss, axial_spring, ground_spring, relative_spring

   ! Kinds of elements with the nodes of a line: of rigid bodies, curves of a drawing, trusses,
   ! springs.
   integer, parameter :: rigid_line = -1, drawn_line = 0, truss = 1, axial_spring = 2, &
      ground_spring = 3, relative_spring = 4

   character(3), parameter :: plane_names(3) = ['CPE', 'CPS', 'CAX']
   integer, parameter :: planes(3) = [plane_strain, plane_stress, axisymmetric]

   character(2), parameter :: kind_names(6) = ['8 ', '8R', '4 ', '6 ', '3 ', '4I']
   integer, parameter :: element_kinds_named(6) = &
      [quad8, quad8_reduced, quad4, triangle6, triangle3, quad4_enhanced]

   character(7), parameter :: line_names(8) = [character(7) :: 'R2D2', 'RAX2', 'T3D2', 'T3D3', &
      'T2D2', 'SPRINGA', 'SPRING1', 'SPRING2']
   integer, parameter :: line_kinds(8) = [rigid_line, rigid_line, drawn_line, drawn_line, truss, &
      axial_spring, ground_spring, relative_spring]
   integer, parameter :: line_node_counts(8) = [2, 2, 2, 3, 2, 2, 1, 2]

contains

   !> Kind and plane that an element type names, or why it cannot be used. Types of Abaqus for heat
   !> (DC2D, DCAX), for both fields (T) and hybrid ones (H) are those of this program. CPEG is CPE
   !> with another plane.
   pure subroutine take_element_type(name, kind, plane, message, note)
      character(*), intent(in) :: name           !! TYPE= in upper case
      integer, intent(out) :: kind               !! quad8, ...; quad8 after an error
      integer, intent(out) :: plane              !! plane_strain, ...; plane_strain after an error
      character(:), allocatable, intent(out) :: message   !! what is wrong, or empty
      !> The type that is used in its place, or empty
      character(:), allocatable, intent(out), optional :: note
      type(string_type) :: names(size(plane_names)*size(kind_names))
      character(:), allocatable :: own, plain
      integer :: i, k, n
      logical :: is_general

      kind = quad8
      plane = plane_strain
      message = ''
      if (present(note)) note = ''
      n = 0
      is_general = index(name, 'CPEG') == 1
      plain = name
      if (is_general) plain = 'CPE'//name(5:)
      own = own_name(plain)
      do i = 1, size(plane_names)
         do k = 1, size(kind_names)
            n = n + 1
            names(n)%value = trim(plane_names(i)//kind_names(k))
            if (own /= names(n)%value) cycle
            kind = element_kinds_named(k)
            plane = merge(generalized_strain, planes(i), is_general)
            if (present(note) .and. own /= plain) note = '*ELEMENT, TYPE='//name//' is '// &
               own(:3)//trim(merge('G', ' ', is_general))//own(4:)//difference(plain)
            return
         end do
      end do
      message = 'element type '//name//' is refused: '
      if (index(name, 'C3D') == 1 .or. index(name, 'DC3D') == 1) then
         message = message//'models are two-dimensional'
      else if (name == 'M3D9') then
         message = message//'quadrilaterals of second order have 8 nodes; in gmsh set '// &
            'Mesh.SecondOrderIncomplete = 1'
      else
         message = 'unknown element type '//name//nearest_known(name, names)
      end if
   end subroutine take_element_type

   !> The type of this program that has the shape functions and points of one of Abaqus.
   pure function own_name(name) result(own)
      character(*), intent(in) :: name
      character(:), allocatable :: own
      integer :: last

      own = name
      if (index(name, 'DC2D') == 1) own = 'CPE'//name(5:)
      if (index(name, 'DCAX') == 1) own = name(2:)
      if (all(own(:min(3, len(own))) /= plane_names)) return
      ! Displacement and temperature, then the pressure of its own that a hybrid element has.
      last = len(own)
      if (own(last:) == 'T') last = last - 1
      if (last > 4 .and. own(last:last) == 'H' .and. own(:3) /= 'CPS') last = last - 1
      own = own(:last)
      if (own(4:) == '4R') own(5:) = 'I'
      if (own(4:) == '6M') own = own(:4)
   end function own_name

   !> In what a type of Abaqus differs from that of this program in whose place it is.
   pure function difference(name) result(words)
      character(*), intent(in) :: name
      character(:), allocatable :: words

      words = ''
      if (index(name(4:), '4R') == 1) words = '; its hourglass control is that of '// &
         'incompatible modes'
      if (index(name(4:), '6M') == 1) words = '; it has no modes of its own'
      if (scan(name(4:), '68') > 0 .and. name(len(name):) == 'T') words = words// &
         '; its temperatures are quadratic, as its displacements'
      if (index(name(4:), 'H') > 0) words = words//'; it has no pressure of its own'
   end function difference

   !> Fields of the data card of an element type; 0 for a type that cannot be used.
   pure integer function element_type_fields(name)
      character(*), intent(in) :: name   !! TYPE= as written
      character(:), allocatable :: message
      integer :: kind, plane

      call take_element_type(to_upper(name), kind, plane, message)
      element_type_fields = line_node_count(to_upper(name))
      if (len(message) == 0) element_type_fields = element_node_count(kind)
      if (element_type_fields > 0) element_type_fields = element_type_fields + 1
   end function element_type_fields

   !> What kind of line an element type names; drawn_line where it names none.
   pure integer function line_kind(name)
      character(*), intent(in) :: name   !! TYPE= in upper case

      line_kind = sum(line_kinds, mask=line_names == name)
   end function line_kind

   !> Nodes of a spring, a truss, a line of a rigid body, or a line element, such as gmsh writes for
   !> a physical curve; 0 for all other types.
   pure integer function line_node_count(name)
      character(*), intent(in) :: name   !! TYPE= in upper case

      line_node_count = sum(line_node_counts, mask=line_names == name)
   end function line_node_count

end module element_types
