!> Motions without strain of the bodies that supports and contacts leave free.
!>
!> In a plane model a rigid part (rigid_parts) shifts along x and y and turns; in an axisymmetric
!> one it shifts along the axis y. Every support and every direction in which a contact point holds
!> is one linear condition on these few unknowns, and so is each component at a hinge; the motions
!> that are free span the null space of all conditions. Nodes of no body that joints take move by
!> themselves. That space comes from elimination and is brought to echelon form, so that a motion
!> names as few bodies as possible.
module rigid_motions
   use mesh_bodies, only: bodies_on_axis
   use equations, only: equation_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use rigid_parts, only: find_rigid_parts, rigid_parts_type
   use sorting, only: unique_sorted
   use sparse_null_space, only: null_space_of
   use sum_lists, only: sum_list_type
   use text, only: to_text
   use connections, only: tie_points_type
   implicit none
   private
   public :: joint_type, free_motion_type, find_free_motions, joints_of, unsupported_motions

   real(dp), parameter :: nothing = 1.0e-6_dp        !! component of a motion that counts as none
   real(dp), parameter :: unit(2, 2) = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])

   !> Condition of a contact point or a tie: a sum of displacements of nodes is zero.
   type :: joint_type
      integer, allocatable :: nodes(:)          !! (n) node indexes
      real(dp), allocatable :: share(:, :)      !! (2, n) coefficients of their components
   end type joint_type

   !> A motion that nothing hinders.
   type :: free_motion_type
      integer :: body = 0                       !! the first body that moves; 0 for a node of none
      integer :: node = 0                       !! the first node of no body that moves
      integer :: element = 0     !! the first element of the part that moves; 0 for all of the body
      logical :: turns = .false.                !! it turns; else it moves on a line
      logical :: deforms = .false.              !! or it deforms without strain
      character(:), allocatable :: way          !! such as 'along x' or 'about (1, 2)'
      character(:), allocatable :: company      !! other bodies that move with it, or empty
   contains
      procedure :: verb
   end type free_motion_type

   !> Conditions of ties and equations.
   interface joints_of
      module procedure :: joints_of_ties, joints_of_equations
   end interface joints_of

contains

   !> The free motions of all bodies, ordered by their first body; none where all is held.
   subroutine find_free_motions(mesh, prescribed, joints, motions)
      type(mesh_type), intent(in) :: mesh
      logical, intent(in) :: prescribed(:)                  !! (2 nodes) prescribed displacements
      type(joint_type), intent(in) :: joints(:)   !! what contact points and ties hold
      type(free_motion_type), allocatable, intent(out) :: motions(:)
      type(rigid_parts_type) :: bodies
      real(dp), allocatable :: basis(:, :)
      integer :: i

      bodies = measure(mesh, joints, [integer ::])
      basis = free_basis(mesh, bodies, prescribed, joints)
      allocate (motions(size(basis, 2)))
      do i = 1, size(motions)
         motions(i) = motion_of(mesh, bodies, basis(:, i))
      end do
   end subroutine find_free_motions

   !> Displacements of the nodes in the motions that supports, ties and equations leave free, each
   !> motion of one body, of those that are tied to it, and of the nodes of no body that equations
   !> relate to them: forces act on these, too.
   pure subroutine unsupported_motions(mesh, prescribed, joints, references, motions)
      type(mesh_type), intent(in) :: mesh
      logical, intent(in) :: prescribed(:) !! (2 nodes) prescribed displacements
      type(joint_type), intent(in) :: joints(:)            !! what ties and equations hold
      integer, intent(in) :: references(:)  !! nodes of no body that contact points take, each once
      type(sum_list_type), intent(out) :: motions          !! (motions, 2 nodes)
      type(rigid_parts_type) :: bodies
      real(dp), allocatable :: basis(:, :)
      integer :: i

      bodies = measure(mesh, joints, references)
      basis = free_basis(mesh, bodies, prescribed, joints)
      call motions%reserve(size(basis, 2), size(prescribed))
      do i = 1, size(basis, 2)
         call add_motion(mesh, bodies, basis(:, i), motions)
      end do
   end subroutine unsupported_motions

   !> Adds the displacements of a motion.
   pure subroutine add_motion(mesh, bodies, unknown, motions)
      type(mesh_type), intent(in) :: mesh
      type(rigid_parts_type), intent(in) :: bodies
      real(dp), intent(in) :: unknown(:)                ! (unknowns)
      type(sum_list_type), intent(inout) :: motions
      real(dp) :: field(2*size(mesh%node_body))
      integer :: c, i, k, node

      field = 0.0_dp
      do node = 1, size(mesh%node_body)
         if (bodies%part(node) == 0) cycle
         associate (own => unknown(3*bodies%part(node) - 2:3*bodies%part(node)))
            if (all(abs(own) <= 0.0_dp)) cycle
            do c = 1, 2
               field(2*(node - 1) + c) = dot_product(bodies%at_point(bodies%part(node), &
                  mesh%coordinates(:, node), unit(:, c)), own)
            end do
         end associate
      end do
      do k = 1, size(bodies%soft)
         do node = 1, size(bodies%corner, 1)
            if (bodies%part(bodies%corner(node, k)) /= bodies%soft(k)) cycle
            do c = 1, 2
               associate (of_node => field(2*(bodies%corner(node, k) - 1) + c))
                  of_node = of_node + bodies%mode(c, node, k)*unknown(3*size(bodies%body) + k)
               end associate
            end do
         end do
      end do
      field(bodies%lone) = unknown(bodies%unknowns() - size(bodies%lone) + 1:)
      call motions%add([(i, i=1, size(field))], field)
   end subroutine add_motion

   !> Basis of the free motions in reduced echelon form: each has a leading component of its own, 1,
   !> that the others do not have.
   pure function free_basis(mesh, bodies, prescribed, joints) result(basis)
      type(mesh_type), intent(in) :: mesh
      type(rigid_parts_type), intent(in) :: bodies
      logical, intent(in) :: prescribed(:)
      type(joint_type), intent(in) :: joints(:)
      !> (unknowns, motions)
      real(dp), allocatable :: basis(:, :)
      integer :: column, i, k, pivot

      basis = null_space_of(conditions(mesh, bodies, prescribed, joints), bodies%unknowns())
      column = 1
      do i = 1, size(basis, 1)
         if (column > size(basis, 2)) exit
         pivot = column - 1 + maxloc(abs(basis(i, column:)), dim=1)
         if (abs(basis(i, pivot)) <= nothing) cycle
         basis(:, [column, pivot]) = basis(:, [pivot, column])
         basis(:, column) = basis(:, column)/basis(i, column)
         do k = 1, size(basis, 2)
            if (k /= column .and. abs(basis(i, k)) > 0.0_dp) basis(:, k) = basis(:, k) - &
               basis(i, k)*basis(:, column)
         end do
         column = column + 1
      end do
   end function free_basis

   !> Supports, axes and joints as conditions on the rigid motions, a row each.
   pure function conditions(mesh, bodies, prescribed, joints) result(rows)
      type(mesh_type), intent(in) :: mesh
      type(rigid_parts_type), intent(in) :: bodies
      logical, intent(in) :: prescribed(:)
      type(joint_type), intent(in) :: joints(:)
      type(sum_list_type) :: rows
      real(dp) :: row(bodies%unknowns())
      logical :: on_axis(mesh%body_count)
      integer :: all_unknowns(size(row)), c, i, k, node, p

      all_unknowns = [(i, i=1, size(row))]
      on_axis = bodies_on_axis(mesh)
      associate (n => count(prescribed) + size(joints) + 2*size(bodies%body) + &
         2*size(bodies%hinge, 2))
         call rows%reserve(n, 6*n)
      end associate
      do p = 1, size(bodies%body)
         if (.not. on_axis(bodies%body(p))) cycle
         call rows%add([3*p - 2], [1.0_dp])
         call rows%add([3*p], [1.0_dp])
      end do
      do i = 1, size(bodies%hinge, 2)
         do c = 1, 2
            call rows%add(all_unknowns, displacement_row(mesh, bodies, bodies%hinge(1, i), &
               unit(:, c)) - row_in_part(mesh, bodies, bodies%hinge(2, i), bodies%hinge(1, i), &
               unit(:, c)))
         end do
      end do
      do node = 1, size(mesh%node_body)
         do c = 1, 2
            if (prescribed(2*(node - 1) + c)) call rows%add(all_unknowns, &
               displacement_row(mesh, bodies, node, unit(:, c)))
         end do
      end do
      do i = 1, size(joints)
         row = 0.0_dp
         do k = 1, size(joints(i)%nodes)
            row = row + displacement_row(mesh, bodies, joints(i)%nodes(k), joints(i)%share(:, k))
         end do
         call rows%add(all_unknowns, row)
      end do
   end function conditions

   !> Displacement of a node along a direction by the unknowns; a node of no body has its own.
   pure function displacement_row(mesh, bodies, node, direction) result(row)
      type(mesh_type), intent(in) :: mesh
      type(rigid_parts_type), intent(in) :: bodies
      integer, intent(in) :: node
      real(dp), intent(in) :: direction(2)
      real(dp) :: row(bodies%unknowns())

      if (bodies%part(node) > 0) then
         row = row_in_part(mesh, bodies, bodies%part(node), node, direction)
         return
      end if
      row = 0.0_dp
      where ((bodies%lone + 1)/2 == node) row(size(row) - size(bodies%lone) + 1:) = &
         direction(2 - modulo(bodies%lone, 2))
   end function displacement_row

   !> The same by the unknowns of a part that has the node.
   pure function row_in_part(mesh, bodies, part, node, direction) result(row)
      type(mesh_type), intent(in) :: mesh
      type(rigid_parts_type), intent(in) :: bodies
      integer, intent(in) :: part, node
      real(dp), intent(in) :: direction(2)
      real(dp) :: row(bodies%unknowns())
      integer :: k

      row = 0.0_dp
      row(3*part - 2:3*part) = bodies%at_point(part, mesh%coordinates(:, node), direction)
      k = findloc(bodies%soft, part, dim=1)
      if (k > 0) row(3*size(bodies%body) + k) = dot_product(direction, &
         bodies%mode(:, findloc(bodies%corner(:, k), node, dim=1), k))
   end function row_in_part

   pure function measure(mesh, joints, references) result(bodies)
      type(mesh_type), intent(in) :: mesh
      type(joint_type), intent(in) :: joints(:)
      integer, intent(in) :: references(:)
      type(rigid_parts_type) :: bodies
      integer :: c, i, k

      bodies%lone = [((2*(references(i) - 1) + c, c=1, 2), i=1, size(references))]
      do i = 1, size(joints)
         do k = 1, size(joints(i)%nodes)
            if (mesh%node_body(joints(i)%nodes(k)) > 0) cycle
            do c = 1, 2
               if (abs(joints(i)%share(c, k)) <= 0.0_dp) cycle
               associate (dof => 2*(joints(i)%nodes(k) - 1) + c)
                  if (all(bodies%lone /= dof)) bodies%lone = [bodies%lone, dof]
               end associate
            end do
         end do
      end do
      call find_rigid_parts(mesh, bodies)
   end function measure

   !> A motion in words.
   pure function motion_of(mesh, bodies, unknown) result(motion)
      type(mesh_type), intent(in) :: mesh
      type(rigid_parts_type), intent(in) :: bodies
      real(dp), intent(in) :: unknown(:)          !! (unknowns)
      type(free_motion_type) :: motion
      type(free_motion_type) :: other
      logical :: alike(size(bodies%body))         ! parts that move as the first one does
      integer :: p, parts

      parts = size(bodies%body)
      alike = .false.
      motion%company = ''
      associate (lone => unknown(size(unknown) - size(bodies%lone) + 1:), &
         own => unknown(:size(unknown) - size(bodies%lone)))
         if (maxval(abs(own)) <= nothing*maxval(abs(unknown))) then
            ! The first of those that move most: which one rounding makes the largest is chance.
            associate (dof => bodies%lone(findloc(abs(lone) >= (1.0_dp - nothing)* &
               maxval(abs(lone)), .true., dim=1)))
               motion%node = (dof + 1)/2
               motion%way = 'along '//merge('x', 'y', modulo(dof, 2) == 1)
            end associate
            return
         end if
         do p = 1, parts
            associate (vector => own(3*p - 2:3*p), mode => pack(own(3*parts + 1:), &
               bodies%soft == p))
               if (maxval(abs([vector, mode])) <= nothing*maxval(abs(own))) cycle
               other%deforms = any(abs(mode) > nothing*maxval(abs(own)))
               if (other%deforms) then
                  other%way = 'without stress'
                  other%turns = .false.
               else
                  call describe(vector, bodies%middle(:, p), bodies%extent(p), other%turns, &
                     other%way)
               end if
            end associate
            if (motion%body == 0) then
               alike(p) = .true.
               motion%body = bodies%body(p)
               if (bodies%first(p) > 0) motion%element = mesh%element_number(bodies%first(p))
               motion%turns = other%turns
               motion%deforms = other%deforms
               motion%way = other%way
            else if ((other%turns .eqv. motion%turns) .and. other%way == motion%way) then
               alike(p) = .true.
            else
               motion%company = motion%company//' while body '//to_text(bodies%body(p))//' '// &
                  other%verb()//'s '//other%way
            end if
         end do
         motion%company = together_with(unique_sorted(pack(bodies%body, alike .and. &
            bodies%body /= motion%body)))//motion%company
         if (all(alike .or. bodies%body /= motion%body)) motion%element = 0
      end associate
   end function motion_of

   !> The bodies that move as another one does, in words.
   pure function together_with(bodies) result(words)
      integer, intent(in) :: bodies(:)            ! ascending, each once
      character(:), allocatable :: words
      integer :: first, last

      words = ''
      first = 1
      do while (first <= size(bodies))
         last = first
         do while (last < size(bodies))
            if (bodies(last + 1) > bodies(last) + 1) exit
            last = last + 1
         end do
         words = words//', '//to_text(bodies(first))
         if (last < first + 2) last = first
         if (last > first) words = words//' to '//to_text(bodies(last))
         first = last + 1
      end do
      if (size(bodies) == 1) words = ' together with body '//words(3:)
      if (size(bodies) > 1) words = ' together with bodies '//words(3:)
   end function together_with

   !> What a motion does, in a word.
   pure function verb(self) result(word)
      class(free_motion_type), intent(in) :: self
      character(:), allocatable :: word

      word = 'move'
      if (self%turns) word = 'turn'
      if (self%deforms) word = 'deform'
   end function verb

   !> The motion of one body in words.
   pure subroutine describe(vector, middle, extent, turns, way)
      real(dp), intent(in) :: vector(3), middle(2), extent
      logical, intent(out) :: turns
      character(:), allocatable, intent(out) :: way
      real(dp) :: direction(2)

      turns = abs(vector(3)) > nothing*maxval(abs(vector))
      if (turns) then
         way = 'about '//point(middle + extent*[-vector(2), vector(1)]/vector(3), extent)
         return
      end if
      direction = vector(:2)/norm2(vector(:2))
      if (abs(direction(2)) <= nothing) then
         way = 'along x'
      else if (abs(direction(1)) <= nothing) then
         way = 'along y'
      else
         way = 'along '//point(direction, 1.0_dp)
      end if
   end subroutine describe

   !> A point or a direction as it is printed, without the rounding of the decomposition.
   pure function point(x, scale) result(words)
      real(dp), intent(in) :: x(2)
      real(dp), intent(in) :: scale
      character(:), allocatable :: words

      associate (rounded => merge(0.0_dp, x, abs(x) <= nothing*scale))
         words = '('//to_text(rounded(1))//', '//to_text(rounded(2))//')'
      end associate
   end function point

   !> Conditions of ties, along x and y.
   pure function joints_of_ties(ties) result(joints)
      type(tie_points_type), intent(in) :: ties
      type(joint_type), allocatable :: joints(:)    !! (2 n)
      integer :: c, k

      allocate (joints(2*ties%difference%count))
      do k = 1, ties%difference%count
         do c = 1, 2
            associate (joint => joints(2*(k - 1) + c))
               joint%nodes = ties%difference%values_of(k)
               allocate (joint%share(2, size(joint%nodes)), source=0.0_dp)
               joint%share(c, :) = ties%difference%coefficients_of(k)
            end associate
         end do
      end do
   end function joints_of_ties

   !> Conditions of equations of displacements.
   pure function joints_of_equations(equations) result(joints)
      type(equation_type), intent(in) :: equations(:)
      type(joint_type), allocatable :: joints(:)
      integer :: i, k, n

      allocate (joints(count([(.not. equations(i)%is_thermal(), i=1, size(equations))])))
      n = 0
      do i = 1, size(equations)
         if (equations(i)%is_thermal()) cycle
         n = n + 1
         joints(n)%nodes = equations(i)%node
         allocate (joints(n)%share(2, size(equations(i)%node)), source=0.0_dp)
         do k = 1, size(equations(i)%node)
            joints(n)%share(equations(i)%dof(k), k) = equations(i)%coefficient(k)
         end do
      end do
   end function joints_of_equations

end module rigid_motions
