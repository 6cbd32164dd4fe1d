!> Linear equations between degrees of freedom, as a deck gives them; kinematic couplings: faces or
!> bodies that follow a reference node as a rigid body does; and pre-tension sections: cuts through
!> a body whose two faces a reference node pulls together.
module equations
   use element_kinds, only: axisymmetric, side_nodes
   use kinds, only: dp
   use mesh, only: mesh_type
   use steps, only: dof_temperature
   implicit none
   private
   public :: equation_type, equation_nodes, coupling_type, coupling_equations, constrained_nodes, &
      fill_equation, surface_nodes, facing_nodes, section_nodes, coupled_nodes, tabled_nodes

   !> A sum of coefficient*degree of freedom that is zero, of displacements or of temperatures.
   type :: equation_type
      character(:), allocatable :: title           !! card and line, for messages
      integer :: card = 0                          !! card image
      integer, allocatable :: node(:)              !! (n) node indexes
      integer, allocatable :: dof(:)               !! (n) 1 and 2, or dof_temperature
      real(dp), allocatable :: coefficient(:)      !! (n) none is zero
   contains
      procedure :: is_thermal
      procedure :: places
      procedure :: replace
      procedure :: add_term
   end type equation_type

   !> One *COUPLING with *KINEMATIC, one *RIGID BODY, or one *PRE-TENSION SECTION.
   type :: coupling_type
      character(:), allocatable :: title       !! card and line, for messages
      integer :: card = 0                      !! card image
      integer :: reference = 0                 !! index of the reference node
      !> index of the node whose first degree of freedom is its rotation; 0 at a section
      integer :: rotation = 0
      integer :: rotation_node = 0             !! index of ROT NODE=, 0 for none
      integer :: surface = 0                   !! index of the surface
      integer :: element_set = 0               !! index of the element set
      integer, allocatable :: node_sets(:)     !! indexes of node sets
      integer, allocatable :: nodes(:)         !! nodes of line elements
      logical :: is_rigid = .false.            !! whether it is a *RIGID BODY
      integer :: opposite = 0   !! surface of the other face of a section; 0 at a coupling
      real(dp) :: normal(2) = 0.0_dp           !! of a section, unit vector
      logical :: follows(2) = .false.          !! displacements along x and y
      logical :: is_warm = .false.             !! temperatures
   contains
      procedure :: is_section
   end type coupling_type

contains

   !> Whether it is one of temperatures.
   pure logical function is_thermal(self)
      class(equation_type), intent(in) :: self

      is_thermal = self%dof(1) == dof_temperature
   end function is_thermal

   !> Whether it is a pre-tension section.
   elemental logical function is_section(self)
      class(coupling_type), intent(in) :: self

      is_section = self%opposite > 0
   end function is_section

   !> Reference nodes of the pre-tension sections, in the order of the deck.
   pure function section_nodes(couplings) result(nodes)
      type(coupling_type), intent(in) :: couplings(:)
      integer, allocatable :: nodes(:)             !! (sections)

      nodes = pack(couplings%reference, couplings%is_section())
   end function section_nodes

   !> Positions of its terms among the degrees of freedom of a field.
   pure function places(self)
      class(equation_type), intent(in) :: self
      integer :: places(size(self%node))           !! (n)

      places = self%node
      if (.not. self%is_thermal()) places = 2*(self%node - 1) + self%dof
   end function places

   !> Writes the values of nodes that are dropped as the mean of two other ones, and numbers the
   !> nodes anew.
   pure subroutine replace(self, parents, new_index)
      class(equation_type), intent(inout) :: self
      integer, intent(in) :: parents(:, :)         !! (2, nodes) the other ones
      integer, intent(in) :: new_index(:)          !! (nodes) 0 where dropped
      type(equation_type) :: other
      integer :: i, k

      allocate (other%node(0), other%dof(0), other%coefficient(0))
      do i = 1, size(self%node)
         associate (node => self%node(i), dof => self%dof(i), coefficient => self%coefficient(i))
            if (new_index(node) > 0) then
               call other%add_term(new_index(node), dof, coefficient)
            else
               do k = 1, 2
                  call other%add_term(new_index(parents(k, node)), dof, 0.5_dp*coefficient)
               end do
            end if
         end associate
      end do
      self%node = other%node
      self%dof = other%dof
      self%coefficient = other%coefficient
   end subroutine replace

   !> Adds a term; each degree of freedom is there once.
   pure subroutine add_term(self, node, dof, coefficient)
      class(equation_type), intent(inout) :: self
      integer, intent(in) :: node, dof
      real(dp), intent(in) :: coefficient
      integer :: at

      at = findloc(self%node == node .and. self%dof == dof, .true., dim=1)
      if (at > 0) then
         self%coefficient(at) = self%coefficient(at) + coefficient
      else
         self%node = [self%node, node]
         self%dof = [self%dof, dof]
         self%coefficient = [self%coefficient, coefficient]
      end if
   end subroutine add_term

   !> Nodes that equations name.
   pure function equation_nodes(equations, nodes) result(named)
      type(equation_type), intent(in) :: equations(:)
      integer, intent(in) :: nodes                 !! number of nodes
      logical :: named(nodes)
      integer :: i

      named = .false.
      do i = 1, size(equations)
         named(equations(i)%node) = .true.
      end do
   end function equation_nodes

   !> The equations of a coupling or a section.
   pure function coupling_equations(coupling, mesh) result(equations)
      type(coupling_type), intent(in) :: coupling
      type(mesh_type), intent(in) :: mesh
      type(equation_type), allocatable :: equations(:)
      integer :: k

      if (coupling%is_section()) then
         equations = section_equations(coupling, mesh)
      else
         equations = rigid_equations(coupling, mesh)
      end if
      equations%card = coupling%card
      do k = 1, size(equations)
         equations(k)%title = coupling%title
      end do
   end function coupling_equations

   !> The equations of its nodes, in linear theory: u = u_r + theta x (x - x_r). The node of the
   !> rotation has no second degree of freedom, which contact points of a rigid surface name.
   pure function rigid_equations(coupling, mesh) result(equations)
      type(coupling_type), intent(in) :: coupling
      type(mesh_type), intent(in) :: mesh
      type(equation_type), allocatable :: equations(:)
      integer, allocatable :: nodes(:)
      integer :: c, k, n
      real(dp) :: arm(2)

      nodes = coupled_nodes(mesh, coupling)
      nodes = pack(nodes, nodes /= coupling%reference .and. .not. follow_sides(mesh, nodes))
      allocate (equations(size(nodes)*(count(coupling%follows) + merge(1, 0, coupling%is_warm)) + &
         merge(1, 0, coupling%is_rigid)))
      n = 0
      do k = 1, size(nodes)
         arm = mesh%coordinates(:, nodes(k)) - mesh%coordinates(:, coupling%reference)
         do c = 1, 2
            if (.not. coupling%follows(c)) cycle
            n = n + 1
            call fill_equation([nodes(k), coupling%reference, coupling%rotation], [c, c, 1], &
               [1.0_dp, -1.0_dp, merge(arm(2), -arm(1), c == 1)], equations(n))
         end do
         if (.not. coupling%is_warm) cycle
         n = n + 1
         call fill_equation([nodes(k), coupling%reference], [dof_temperature, dof_temperature], &
            [1.0_dp, -1.0_dp], equations(n))
      end do
      if (.not. coupling%is_rigid) return
      n = n + 1
      call fill_equation([coupling%rotation], [2], [1.0_dp], equations(n))
   end function rigid_equations

   !> Whether each of some nodes hangs on a side whose nodes are among them: it moves with these.
   pure function follow_sides(mesh, nodes) result(follow)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: nodes(:)
      logical :: follow(size(nodes)), is_one(0:size(mesh%node_number)), &
         hangs(0:size(mesh%node_number))
      integer :: h

      follow = .false.
      if (.not. allocated(mesh%hanging_sides)) return
      is_one = .false.
      is_one(nodes) = .true.
      hangs = .false.
      do h = 1, size(mesh%hanging_sides, 2)
         associate (side => mesh%hanging_sides(:, h))
            ! Of a side of two nodes the middle hangs, of one of three what is half way to its ends.
            if (side(4) == 0) then
               hangs(side(2)) = all(is_one(side([1, 3])))
            else
               hangs(side(4:5)) = all(is_one(side(:3)))
            end if
         end associate
      end do
      follow = hangs(nodes)
   end function follow_sides

   !> The equations of the nodes of both faces of a section: u = u' + n u_r, where u' is that of the
   !> opposite face and u_r the first degree of freedom of the reference node, by which the faces
   !> overlap; temperatures are equal. On the axis of an axisymmetric body no node moves along the
   !> radius.
   pure function section_equations(section, mesh) result(equations)
      type(coupling_type), intent(in) :: section
      type(mesh_type), intent(in) :: mesh
      type(equation_type), allocatable :: equations(:)
      integer, allocatable :: pairs(:, :)
      logical, allocatable :: on_axis(:)
      integer :: c, k, n

      pairs = facing_nodes(section, mesh)
      on_axis = mesh%coordinates(1, pairs(1, :)) <= 0.0_dp .and. &
         mesh%element_plane(mesh%surfaces(section%surface)%faces(1, 1)) == axisymmetric
      allocate (equations(3*size(pairs, 2) - count(on_axis)))
      n = 0
      do k = 1, size(pairs, 2)
         do c = 1, 2
            if (c == 1 .and. on_axis(k)) cycle
            n = n + 1
            call fill_equation([pairs(2, k), pairs(1, k), section%reference], [c, c, 1], &
               [1.0_dp, -1.0_dp, -section%normal(c)], equations(n))
         end do
         n = n + 1
         call fill_equation(pairs(2:1:-1, k), [dof_temperature, dof_temperature], &
            [1.0_dp, -1.0_dp], equations(n))
      end do
   end function section_equations

   !> Nodes of the two faces of a section that are at one place: those of the deck, on the opposite
   !> face, and those of the surface. Both faces are divided alike.
   pure function facing_nodes(section, mesh) result(pairs)
      type(coupling_type), intent(in) :: section
      type(mesh_type), intent(in) :: mesh
      integer, allocatable :: pairs(:, :)          !! (2, n)
      integer, allocatable :: one(:), other(:)
      integer :: k

      one = surface_nodes(mesh, section%opposite)
      other = surface_nodes(mesh, section%surface)
      allocate (pairs(2, size(one)))
      pairs(1, :) = one
      do k = 1, size(one)
         pairs(2, k) = other(minloc((mesh%coordinates(1, other) - mesh%coordinates(1, one(k)))**2 &
            + (mesh%coordinates(2, other) - mesh%coordinates(2, one(k)))**2, dim=1))
      end do
   end function facing_nodes

   !> Nodes that tables of nodes have rows for: those of elements, springs and trusses, and
   !> reference nodes of couplings, rigid bodies and sections.
   pure function tabled_nodes(mesh, elongations, couplings) result(tabled)
      type(mesh_type), intent(in) :: mesh
      type(equation_type), intent(in) :: elongations(:)   !! of springs and trusses
      type(coupling_type), intent(in) :: couplings(:)
      logical :: tabled(size(mesh%node_number)), is_used(0:size(mesh%node_number))

      is_used = .false.
      is_used([mesh%element_nodes]) = .true.
      tabled = is_used(1:) .or. equation_nodes(elongations, size(tabled))
      tabled(couplings%reference) = .true.
   end function tabled_nodes

   !> Nodes that equations relate, and those that couplings bring.
   pure function constrained_nodes(equations, couplings, nodes) result(related)
      type(equation_type), intent(in) :: equations(:)
      type(coupling_type), intent(in) :: couplings(:)
      integer, intent(in) :: nodes                 !! number of nodes
      logical :: related(nodes)
      integer :: i

      related = equation_nodes(equations, nodes)
      do i = 1, size(couplings)
         associate (nodes => [couplings(i)%reference, couplings(i)%rotation, &
            couplings(i)%rotation_node])
            related(pack(nodes, nodes > 0)) = .true.
         end associate
         if (allocated(couplings(i)%nodes)) related(couplings(i)%nodes) = .true.
      end do
   end function constrained_nodes

   !> Fills an equation, without the terms whose coefficient is zero.
   pure subroutine fill_equation(nodes, dofs, coefficients, equation)
      integer, intent(in) :: nodes(:), dofs(:)         !! (n) of its terms
      real(dp), intent(in) :: coefficients(:)          !! (n)
      type(equation_type), intent(inout) :: equation

      associate (there => abs(coefficients) > 0.0_dp)
         equation%node = pack(nodes, there)
         equation%dof = pack(dofs, there)
         equation%coefficient = pack(coefficients, there)
      end associate
   end subroutine fill_equation

   !> Nodes of a surface, each once.
   pure function surface_nodes(mesh, surface) result(nodes)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: surface
      integer, allocatable :: nodes(:)
      logical :: found(size(mesh%node_number))
      integer :: f, i

      found = .false.
      associate (faces => mesh%surfaces(surface)%faces)
         do f = 1, size(faces, 2)
            found(mesh%element_nodes(side_nodes(mesh%element_kind(faces(1, f)), faces(2, f)), &
               faces(1, f))) = .true.
         end do
      end associate
      nodes = pack([(i, i=1, size(found))], found)
   end function surface_nodes

   !> Nodes that follow the reference node, each once.
   pure function coupled_nodes(mesh, coupling) result(nodes)
      type(mesh_type), intent(in) :: mesh
      type(coupling_type), intent(in) :: coupling
      integer, allocatable :: nodes(:)
      logical :: found(0:size(mesh%node_number))
      integer :: i

      found = .false.
      if (coupling%surface > 0) found(surface_nodes(mesh, coupling%surface)) = .true.
      if (coupling%element_set > 0) found([mesh%element_nodes(:, &
         mesh%element_sets(coupling%element_set)%members)]) = .true.
      if (allocated(coupling%node_sets)) then
         do i = 1, size(coupling%node_sets)
            found(mesh%node_sets(coupling%node_sets(i))%members) = .true.
         end do
      end if
      if (allocated(coupling%nodes)) found(coupling%nodes) = .true.
      nodes = pack([(i, i=1, size(mesh%node_number))], found(1:))
   end function coupled_nodes

end module equations
