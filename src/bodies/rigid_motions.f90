!> Motions without strain of the bodies that supports and contacts leave free.
!>
!> A body, or each of the parts that it hinges together from, is rigid. In a plane model it shifts
!> along x and y and turns about the middle of its nodes; in an axisymmetric one it shifts along the
!> axis y. Every support and every direction in which a contact point holds is one linear condition
!> on these few unknowns, and so is each component at a hinge; the motions that are free span the
!> null space of all conditions. Nodes of no body that joints take move by themselves. That space
!> comes from a singular value decomposition and is brought to echelon form, so that a motion names
!> as few bodies as possible. Turns count by the displacement that they give at the farthest node of
!> the body. A part of one element with reduced integration deforms, too, without any strain at its
!> integration points: its hourglass mode.
module rigid_motions
   use mesh_bodies, only: bodies_on_axis
   use dense, only: null_space
   use element_kinds, only: axisymmetric, element_node_count, quad8_reduced
   use equations, only: equation_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use quadrature, only: integration_rule
   use shape_functions, only: element_gradients
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

   !> The bodies as rigid parts. Unknowns are two shifts and a turn of each part, the amplitudes of
   !> hourglass modes, and the degrees of freedom of no body.
   type :: rigid_bodies_type
      integer, allocatable :: body(:)           !! (parts) body of each
      integer, allocatable :: first(:)          !! (parts) first element, 0 for all of the body
      integer, allocatable :: part(:)           !! (nodes) a part that has it, or 0
      integer, allocatable :: hinge(:, :)       !! (2, hinges) node, another part that has it
      real(dp), allocatable :: middle(:, :)     !! (2, parts) mean of the nodes [length]
      real(dp), allocatable :: extent(:)        !! (parts) distance of the farthest node [length]
      integer, allocatable :: soft(:)           !! (modes) part that has an hourglass mode
      integer, allocatable :: corner(:, :)      !! (8, modes) nodes of its element
      real(dp), allocatable :: mode(:, :, :)    !! (2, 8, modes) their displacements
      integer, allocatable :: lone(:) !! degrees of freedom, of no body, that joints take
   contains
      procedure :: unknowns
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
         motions(i) = motion_of(mesh, bodies, basis(:, i))
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
      integer :: c, k, node

      bodies = measure(mesh, joints, references)
      basis = free_basis(mesh, bodies, held, joints)
      allocate (fields(size(held), size(basis, 2)), source=0.0_dp)
      do node = 1, size(mesh%node_body)
         if (bodies%part(node) == 0) cycle
         associate (p => bodies%part(node))
            do c = 1, 2
               fields(2*(node - 1) + c, :) = matmul(at_point(bodies, p, &
                  mesh%coordinates(:, node), unit(:, c)), basis(3*p - 2:3*p, :))
            end do
         end associate
      end do
      do k = 1, size(bodies%soft)
         do node = 1, size(bodies%corner, 1)
            if (bodies%part(bodies%corner(node, k)) /= bodies%soft(k)) cycle
            do c = 1, 2
               associate (dof => 2*(bodies%corner(node, k) - 1) + c)
                  fields(dof, :) = fields(dof, :) + bodies%mode(c, node, k)* &
                     basis(3*size(bodies%body) + k, :)
               end associate
            end do
         end do
      end do
      fields(bodies%lone, :) = basis(bodies%unknowns() - size(bodies%lone) + 1:, :)
   end subroutine unsupported_motions

   !> Basis of the free motions in reduced echelon form: each has a leading component of its own, 1,
   !> that the others do not have.
   pure function free_basis(mesh, bodies, held, joints) result(basis)
      type(mesh_type), intent(in) :: mesh
      type(rigid_bodies_type), intent(in) :: bodies
      logical, intent(in) :: held(:)
      type(joint_type), intent(in) :: joints(:)
      !> (unknowns, motions)
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
      real(dp), allocatable :: rows(:, :)
      logical :: on_axis(mesh%body_count)
      integer :: c, i, k, n, node, p

      on_axis = bodies_on_axis(mesh)
      allocate (rows(count(held) + size(joints) + 2*count(on_axis(bodies%body)) + &
         2*size(bodies%hinge, 2), bodies%unknowns()), source=0.0_dp)
      n = 0
      do p = 1, size(bodies%body)
         if (.not. on_axis(bodies%body(p))) cycle
         rows(n + 1, 3*p - 2) = 1.0_dp
         rows(n + 2, 3*p) = 1.0_dp
         n = n + 2
      end do
      do i = 1, size(bodies%hinge, 2)
         do c = 1, 2
            n = n + 1
            rows(n, :) = displacement_row(mesh, bodies, bodies%hinge(1, i), unit(:, c)) - &
               row_in_part(mesh, bodies, bodies%hinge(2, i), bodies%hinge(1, i), unit(:, c))
         end do
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

   !> Displacement of a node along a direction by the unknowns; a node of no body has its own.
   pure function displacement_row(mesh, bodies, node, direction) result(row)
      type(mesh_type), intent(in) :: mesh
      type(rigid_bodies_type), intent(in) :: bodies
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
      type(rigid_bodies_type), intent(in) :: bodies
      integer, intent(in) :: part, node
      real(dp), intent(in) :: direction(2)
      real(dp) :: row(bodies%unknowns())
      integer :: k

      row = 0.0_dp
      row(3*part - 2:3*part) = at_point(bodies, part, mesh%coordinates(:, node), direction)
      k = findloc(bodies%soft, part, dim=1)
      if (k > 0) row(3*size(bodies%body) + k) = dot_product(direction, &
         bodies%mode(:, findloc(bodies%corner(:, k), node, dim=1), k))
   end function row_in_part

   !> Number of unknowns.
   pure integer function unknowns(self)
      class(rigid_bodies_type), intent(in) :: self

      unknowns = 3*size(self%body) + size(self%soft) + size(self%lone)
   end function unknowns

   !> Displacement along a direction by unit shifts and the unit turn of a part.
   pure function at_point(bodies, part, position, direction) result(displacement)
      type(rigid_bodies_type), intent(in) :: bodies
      integer, intent(in) :: part
      real(dp), intent(in) :: position(2), direction(2)
      real(dp) :: displacement(3)
      real(dp) :: arm(2)

      arm = (position - bodies%middle(:, part))/bodies%extent(part)
      displacement = [direction, direction(2)*arm(1) - direction(1)*arm(2)]
   end function at_point

   pure function measure(mesh, joints, references) result(bodies)
      type(mesh_type), intent(in) :: mesh
      type(joint_type), intent(in) :: joints(:)
      integer, intent(in) :: references(:)
      type(rigid_bodies_type) :: bodies
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
      call divide(mesh, bodies)
      call place(mesh, bodies)
      call find_modes(mesh, bodies)
   end function measure

   !> The parts of the bodies and their hinges: nodes that several parts have.
   pure subroutine divide(mesh, bodies)
      type(mesh_type), intent(in) :: mesh
      type(rigid_bodies_type), intent(inout) :: bodies
      integer :: e, p, q

      bodies%part = mesh%node_body
      allocate (bodies%hinge(2, 0))
      if (.not. allocated(mesh%element_part)) then
         bodies%body = [(p, p=1, mesh%body_count)]
         bodies%first = 0*bodies%body
         return
      end if
      bodies%first = [(findloc(mesh%element_part, p, dim=1), p=1, maxval(mesh%element_part))]
      bodies%body = mesh%element_body(bodies%first)
      bodies%part = 0
      do e = 1, size(mesh%element_part)
         do q = 1, element_node_count(mesh%element_kind(e))
            associate (own => bodies%part(mesh%element_nodes(q, e)), part => mesh%element_part(e))
               if (own == 0) own = part
               if (own == part) cycle
               if (any(bodies%hinge(1, :) == mesh%element_nodes(q, e) .and. &
                  bodies%hinge(2, :) == part)) cycle
               bodies%hinge = reshape([bodies%hinge, mesh%element_nodes(q, e), part], &
                  [2, size(bodies%hinge, 2) + 1])
            end associate
         end do
      end do
   end subroutine divide

   !> The middles and extents of the parts.
   pure subroutine place(mesh, bodies)
      type(mesh_type), intent(in) :: mesh
      type(rigid_bodies_type), intent(inout) :: bodies
      integer :: nodes(size(bodies%body)), node

      allocate (bodies%middle(2, size(nodes)), bodies%extent(size(nodes)), source=0.0_dp)
      nodes = 0
      do node = 1, size(bodies%part)
         if (bodies%part(node) == 0) cycle
         associate (p => bodies%part(node))
            nodes(p) = nodes(p) + 1
            bodies%middle(:, p) = bodies%middle(:, p) + mesh%coordinates(:, node)
         end associate
      end do
      bodies%middle = bodies%middle/spread(real(nodes, dp), 1, 2)
      do node = 1, size(bodies%part)
         if (bodies%part(node) == 0) cycle
         associate (p => bodies%part(node))
            bodies%extent(p) = max(bodies%extent(p), &
               norm2(mesh%coordinates(:, node) - bodies%middle(:, p)))
         end associate
      end do
   end subroutine place

   !> The hourglass modes of plane parts that are one element with four points for eight nodes.
   pure subroutine find_modes(mesh, bodies)
      type(mesh_type), intent(in) :: mesh
      type(rigid_bodies_type), intent(inout) :: bodies
      integer :: elements(size(bodies%body)), e, p
      integer, allocatable :: part(:)

      allocate (bodies%soft(0), bodies%corner(8, 0), bodies%mode(2, 8, 0))
      if (.not. allocated(mesh%element_kind)) return
      part = mesh%element_body
      if (allocated(mesh%element_part)) part = mesh%element_part
      elements = 0
      do e = 1, size(part)
         elements(part(e)) = elements(part(e)) + 1
      end do
      do e = 1, size(part)
         p = part(e)
         if (elements(p) > 1 .or. mesh%element_kind(e) /= quad8_reduced .or. &
            mesh%element_plane(e) == axisymmetric) cycle
         bodies%soft = [bodies%soft, p]
         bodies%corner = reshape([bodies%corner, mesh%element_nodes(:, e)], [8, size(bodies%soft)])
         bodies%mode = reshape([bodies%mode, hourglass(mesh%coordinates(:, &
            mesh%element_nodes(:, e)))], [2, 8, size(bodies%soft)])
      end do
   end subroutine find_modes

   !> Displacements, across the rigid motions, that no integration point of such an element strains
   !> by; the largest one is 1.
   pure function hourglass(coordinates) result(mode)
      real(dp), intent(in) :: coordinates(:, :)   ! (2, 8) [length]
      real(dp) :: mode(2, 8)
      real(dp) :: gradients(2, 8), jacobian, points(2, 4), rows(15, 16), weights(4)
      real(dp), allocatable :: basis(:, :)
      integer :: i

      call integration_rule(quad8_reduced, points, weights)
      rows = 0.0_dp
      associate (extent => maxval(coordinates) - minval(coordinates))
         do i = 1, 4
            call element_gradients(quad8_reduced, coordinates, points(:, i), gradients, jacobian)
            rows(3*i - 2, 1::2) = gradients(1, :)*extent
            rows(3*i - 1, 2::2) = gradients(2, :)*extent
            rows(3*i, 1::2) = gradients(2, :)*extent
            rows(3*i, 2::2) = gradients(1, :)*extent
         end do
         rows(13, 1::2) = 1.0_dp
         rows(14, 2::2) = 1.0_dp
         rows(15, 1::2) = -(coordinates(2, :) - sum(coordinates(2, :))/8)/extent
         rows(15, 2::2) = (coordinates(1, :) - sum(coordinates(1, :))/8)/extent
      end associate
      basis = null_space(rows)
      mode = reshape(basis(:, 1)/maxval(abs(basis(:, 1))), [2, 8])
   end function hourglass

   !> A motion in words.
   pure function motion_of(mesh, bodies, unknown) result(motion)
      type(mesh_type), intent(in) :: mesh
      type(rigid_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: unknown(:)          !! (unknowns)
      type(free_motion_type) :: motion
      type(free_motion_type) :: other
      integer :: p, parts

      parts = size(bodies%body)
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
               motion%body = bodies%body(p)
               if (bodies%first(p) > 0) motion%element = mesh%element_number(bodies%first(p))
               motion%turns = other%turns
               motion%deforms = other%deforms
               motion%way = other%way
            else if ((other%turns .eqv. motion%turns) .and. other%way == motion%way) then
               motion%company = motion%company//' together with body '//to_text(bodies%body(p))
            else
               motion%company = motion%company//' while body '//to_text(bodies%body(p))//' '// &
                  other%verb()//'s '//other%way
            end if
         end do
      end associate
   end function motion_of

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
