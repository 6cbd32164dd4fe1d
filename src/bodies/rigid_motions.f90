!> Rigid motions of the bodies that supports and contacts leave free.
!>
!> A body of a plane model shifts along x and y and turns about the middle of its nodes; one of an
!> axisymmetric model shifts along the axis y. Every support and every direction in which a contact
!> point holds is one linear condition on these few unknowns; the motions that are free span the
!> null space of all conditions. Nodes of no body that joints take move by themselves. That space
!> comes from a singular value decomposition and is brought to echelon form, so that a motion names
!> as few bodies as possible. Turns count by the displacement that they give at the farthest node of
!> the body.
module rigid_motions
   use mesh_bodies, only: bodies_on_axis
   use dense, only: null_space
   use equations, only: equation_type
   use kinds, only: dp
   use mesh, only: mesh_type
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
      logical :: turns = .false.                !! it turns; else it moves on a line
      character(:), allocatable :: way          !! such as 'along x' or 'about (1, 2)'
      character(:), allocatable :: company      !! other bodies that move with it, or empty
   end type free_motion_type

   !> The bodies as rigid ones.
   type :: rigid_bodies_type
      real(dp), allocatable :: middle(:, :)     !! (2, bodies) mean of the nodes [length]
      real(dp), allocatable :: extent(:)        !! (bodies) distance of the farthest node [length]
      integer, allocatable :: lone(:) !! degrees of freedom, of no body, that joints take
   end type rigid_bodies_type

   !> Conditions of ties and equations.
   interface joints_of
      module procedure :: joints_of_ties, joints_of_equations
   end interface joints_of

contains

   !> The free motions of all bodies, ordered by their first body; none where all is held.
   subroutine find_free_motions(mesh, held, joints, motions)
      type(mesh_type), intent(in) :: mesh
      logical, intent(in) :: held(:)                  !! (2 nodes) prescribed displacements
      type(joint_type), intent(in) :: joints(:)   !! what contact points and ties hold
      type(free_motion_type), allocatable, intent(out) :: motions(:)
      type(rigid_bodies_type) :: bodies
      real(dp), allocatable :: basis(:, :)
      integer :: i

      bodies = measure(mesh, joints, [integer ::])
      basis = free_basis(mesh, bodies, held, joints)
      allocate (motions(size(basis, 2)))
      do i = 1, size(motions)
         motions(i) = motion_of(bodies, reshape(basis(:, i), [3, mesh%body_count]), &
            basis(3*mesh%body_count + 1:, i))
      end do
   end subroutine find_free_motions

   !> Displacements of the nodes in the motions that supports, ties and equations leave free, each
   !> motion of one body, of those that are tied to it, and of the nodes of no body that equations
   !> relate to them: forces act on these, too.
   pure subroutine unsupported_motions(mesh, held, joints, references, fields)
      type(mesh_type), intent(in) :: mesh
      logical, intent(in) :: held(:)                       !! (2 nodes) prescribed displacements
      type(joint_type), intent(in) :: joints(:)            !! what ties and equations hold
      integer, intent(in) :: references(:)  !! nodes of no body that contact points take, each once
      real(dp), allocatable, intent(out) :: fields(:, :)   !! (2 nodes, motions)
      type(rigid_bodies_type) :: bodies
      real(dp), allocatable :: basis(:, :)
      integer :: c, node

      bodies = measure(mesh, joints, references)
      basis = free_basis(mesh, bodies, held, joints)
      allocate (fields(size(held), size(basis, 2)), source=0.0_dp)
      do node = 1, size(mesh%node_body)
         if (mesh%node_body(node) == 0) cycle
         associate (b => mesh%node_body(node))
            do c = 1, 2
               fields(2*(node - 1) + c, :) = matmul(at_point(bodies, b, &
                  mesh%coordinates(:, node), unit(:, c)), basis(3*b - 2:3*b, :))
            end do
         end associate
      end do
      fields(bodies%lone, :) = basis(3*mesh%body_count + 1:, :)
   end subroutine unsupported_motions

   !> Basis of the free motions in reduced echelon form: each has a leading component of its own, 1,
   !> that the others do not have.
   pure function free_basis(mesh, bodies, held, joints) result(basis)
      type(mesh_type), intent(in) :: mesh
      type(rigid_bodies_type), intent(in) :: bodies
      logical, intent(in) :: held(:)
      type(joint_type), intent(in) :: joints(:)
      !> (3 bodies + degrees of freedom of no body, motions)
      real(dp), allocatable :: basis(:, :)
      integer :: column, i, k, pivot

      basis = null_space(conditions(mesh, bodies, held, joints))
      column = 1
      do i = 1, size(basis, 1)
         if (column > size(basis, 2)) exit
         pivot = column - 1 + maxloc(abs(basis(i, column:)), dim=1)
         if (abs(basis(i, pivot)) <= nothing) cycle
         basis(:, [column, pivot]) = basis(:, [pivot, column])
         basis(:, column) = basis(:, column)/basis(i, column)
         do k = 1, size(basis, 2)
            if (k /= column) basis(:, k) = basis(:, k) - basis(i, k)*basis(:, column)
         end do
         column = column + 1
      end do
   end function free_basis

   !> Supports, axes and joints as conditions on the rigid motions, a row each.
   pure function conditions(mesh, bodies, held, joints) result(rows)
      type(mesh_type), intent(in) :: mesh
      type(rigid_bodies_type), intent(in) :: bodies
      logical, intent(in) :: held(:)
      type(joint_type), intent(in) :: joints(:)
      real(dp) :: rows(count(held) + size(joints) + 2*count(bodies_on_axis(mesh)), &
         3*mesh%body_count + size(bodies%lone))
      logical :: on_axis(mesh%body_count)
      integer :: body, c, i, k, n, node

      rows = 0.0_dp
      on_axis = bodies_on_axis(mesh)
      n = 0
      do body = 1, size(on_axis)
         if (.not. on_axis(body)) cycle
         rows(n + 1, 3*body - 2) = 1.0_dp
         rows(n + 2, 3*body) = 1.0_dp
         n = n + 2
      end do
      do node = 1, size(mesh%node_body)
         do c = 1, 2
            if (.not. held(2*(node - 1) + c)) cycle
            n = n + 1
            rows(n, :) = displacement_row(mesh, bodies, node, unit(:, c))
         end do
      end do
      do i = 1, size(joints)
         n = n + 1
         do k = 1, size(joints(i)%nodes)
            rows(n, :) = rows(n, :) + displacement_row(mesh, bodies, joints(i)%nodes(k), &
               joints(i)%share(:, k))
         end do
      end do
   end function conditions

   !> Displacement of a node along a direction by the rigid motions; a node of no body has its own.
   pure function displacement_row(mesh, bodies, node, direction) result(row)
      type(mesh_type), intent(in) :: mesh
      type(rigid_bodies_type), intent(in) :: bodies
      integer, intent(in) :: node
      real(dp), intent(in) :: direction(2)
      real(dp) :: row(3*mesh%body_count + size(bodies%lone))

      row = 0.0_dp
      if (mesh%node_body(node) == 0) then
         where ((bodies%lone + 1)/2 == node) row(3*mesh%body_count + 1:) = &
            direction(2 - modulo(bodies%lone, 2))
         return
      end if
      associate (b => mesh%node_body(node))
         row(3*b - 2:3*b) = at_point(bodies, b, mesh%coordinates(:, node), direction)
      end associate
   end function displacement_row

   !> Displacement along a direction by unit shifts and the unit turn of a body.
   pure function at_point(bodies, body, position, direction) result(displacement)
      type(rigid_bodies_type), intent(in) :: bodies
      integer, intent(in) :: body
      real(dp), intent(in) :: position(2), direction(2)
      real(dp) :: displacement(3)
      real(dp) :: arm(2)

      arm = (position - bodies%middle(:, body))/bodies%extent(body)
      displacement = [direction, direction(2)*arm(1) - direction(1)*arm(2)]
   end function at_point

   pure function measure(mesh, joints, references) result(bodies)
      type(mesh_type), intent(in) :: mesh
      type(joint_type), intent(in) :: joints(:)
      integer, intent(in) :: references(:)
      type(rigid_bodies_type) :: bodies
      integer :: nodes(mesh%body_count), c, i, k, node

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
      allocate (bodies%middle(2, size(nodes)), bodies%extent(size(nodes)), source=0.0_dp)
      nodes = 0
      do node = 1, size(mesh%node_body)
         if (mesh%node_body(node) == 0) cycle
         associate (b => mesh%node_body(node))
            nodes(b) = nodes(b) + 1
            bodies%middle(:, b) = bodies%middle(:, b) + mesh%coordinates(:, node)
         end associate
      end do
      bodies%middle = bodies%middle/spread(real(nodes, dp), 1, 2)
      do node = 1, size(mesh%node_body)
         if (mesh%node_body(node) == 0) cycle
         associate (b => mesh%node_body(node))
            bodies%extent(b) = max(bodies%extent(b), &
               norm2(mesh%coordinates(:, node) - bodies%middle(:, b)))
         end associate
      end do
   end function measure

   !> A motion in words.
   pure function motion_of(bodies, vector, lone) result(motion)
      type(rigid_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: vector(:, :)   !! (3, bodies) shifts, turn times extent
      real(dp), intent(in) :: lone(:)        !! values of the degrees of freedom of no body
      type(free_motion_type) :: motion
      character(:), allocatable :: way
      logical :: turns
      integer :: b

      motion%company = ''
      if (maxval(abs(vector)) <= nothing*maxval(abs([vector, lone]))) then
         ! The first of those that move most: which one rounding makes the largest is chance.
         associate (dof => bodies%lone(findloc(abs(lone) >= (1.0_dp - nothing)* &
            maxval(abs(lone)), .true., dim=1)))
            motion%node = (dof + 1)/2
            motion%way = 'along '//merge('x', 'y', modulo(dof, 2) == 1)
         end associate
         return
      end if
      do b = 1, size(vector, 2)
         if (maxval(abs(vector(:, b))) <= nothing*maxval(abs(vector))) cycle
         call describe(vector(:, b), bodies%middle(:, b), bodies%extent(b), turns, way)
         if (motion%body == 0) then
            motion%body = b
            motion%turns = turns
            motion%way = way
         else if ((turns .eqv. motion%turns) .and. way == motion%way) then
            motion%company = motion%company//' together with body '//to_text(b)
         else if (turns) then
            motion%company = motion%company//' while body '//to_text(b)//' turns '//way
         else
            motion%company = motion%company//' while body '//to_text(b)//' moves '//way
         end if
      end do
   end function motion_of

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
