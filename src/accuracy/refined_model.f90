!> The model with some elements divided into four, among them all at the faces of interfaces:
!> matrices of its bodies, its contact points and loads, and the maps between both meshes. The old
!> mesh's fields are fields of the new one.
module refined_model
   use mesh_bodies, only: find_bodies
   use contact_points, only: contact_points_type
   use errors, only: error_type
   use hanging_nodes, only: at_level_changes
   use kinds, only: dp
   use load_histories, only: end_of_step
   use loads, only: loads_type
   use mesh_division, only: divide, division_type, refined_members
   use model, only: model_type
   use all_contact_points, only: all_contact_points_type, match_surfaces, joined_points
   use refinement, only: refine_chosen
   use sparse_matrix, only: linear_combination, sparse_matrix_type
   use stiffness_matrix, only: assemble_initial_force, assemble_stiffness, assemble_thermal_load
   use thermal_matrix, only: assemble_conduction
   implicit none
   private
   public :: refined_model_type

   !> The refined model. Its old nodes keep their indexes, its new ones follow.
   type :: refined_model_type
      !> (old elements) those that are divided; only once the model is prepared in whole
      logical, allocatable :: is_divided(:)
      type(model_type) :: model                 !! the model, refined
      type(division_type) :: division           !! how its elements were divided
      type(contact_points_type), allocatable :: interfaces(:) !! interfaces in the deck's order
      type(all_contact_points_type) :: points   !! all their contact points
      integer, allocatable :: old_point(:)     !! (m) contact point of the old mesh, 0 for a new one
      !> (2, m) old contact points on both sides of a new one; of an old one itself
      integer, allocatable :: neighbours(:, :)
      !> (m) whether a node of it is one of another contact point, too
      logical, allocatable :: is_shared(:)
      type(loads_type) :: loads                 !! its loads
      integer, private :: step = 0              !! the step at whose end they are
      type(sparse_matrix_type) :: stiffness     !! (2 nodes, 2 nodes) [force/length]
      type(sparse_matrix_type) :: thermal_load  !! (2 nodes, nodes) [force/temperature]
      real(dp), allocatable :: initial_force(:) !! (2 nodes) of initial stresses, or none [force]
      type(sparse_matrix_type) :: conduction    !! (nodes, nodes) [power/temperature]
   contains
      procedure :: prepare
      procedure :: load_to_end
      procedure :: assemble
      procedure :: prolong_points
      procedure :: restrict
      procedure :: prolong_set
      procedure :: hangs
      procedure :: conduction_with
   end type refined_model_type

contains

   !> Refines a model and matches its surfaces.
   !> Error: as make_contact_points.
   subroutine prepare(self, model, points, is_divided, error)
      class(refined_model_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(all_contact_points_type), intent(in) :: points
      logical, intent(in) :: is_divided(:)                !! (elements) as choose_neighbours asks
      type(error_type), allocatable, intent(out) :: error
      type(contact_points_type), allocatable :: no_ties(:)
      integer :: i

      self%division = divide(model%mesh, is_divided)
      self%model = model
      call refine_chosen(self%model, is_divided)
      call find_bodies(self%model%mesh)
      allocate (self%interfaces(size(model%contacts)))
      do i = 1, size(self%interfaces)
         call match_surfaces(self%model, i, self%interfaces(i), error)
         if (allocated(error)) return
      end do
      if (allocated(self%model%ties)) deallocate (self%model%ties)
      allocate (self%model%ties(0), no_ties(0))
      self%points = joined_points(self%interfaces, no_ties, self%model)
      call match_points(self, points)
      call self%loads%prepare(self%model)
      self%is_divided = is_divided
   end subroutine prepare

   !> Moves the loads to the end of a step, through the ends of those before it. What a step gives
   !> for the first time ramps from where the node is, which its end does not show.
   pure subroutine load_to_end(self, step)
      class(refined_model_type), intent(inout) :: self    !! prepared
      integer, intent(in) :: step                         !! not before the last one

      associate (steps => self%model%steps, loads => self%loads)
         do while (self%step < step)
            self%step = self%step + 1
            ! Parentheses copy: the step writes these values.
            call loads%begin_step(steps(self%step), (loads%displacement%value), &
               (loads%temperature%value))
            call loads%move_to(end_of_step(steps, self%step), self%model)
         end do
      end associate
   end subroutine load_to_end

   !> Finds the old contact points among all, and those about each new one.
   pure subroutine match_points(self, points)
      class(refined_model_type), intent(inout) :: self
      type(all_contact_points_type), intent(in) :: points
      integer :: first, i, k, last, old, old_last

      allocate (self%old_point(size(self%points%slave)), source=0)
      allocate (self%neighbours(2, size(self%points%slave)))
      self%is_shared = shared_points(self%points, self%division%nodes_after)
      do i = 1, size(self%interfaces)
         first = self%points%interface_start(i)
         last = self%points%interface_start(i + 1) - 1
         old = points%interface_start(i)
         old_last = points%interface_start(i + 1) - 1
         do k = first, last
            if (self%points%slave(k) > self%division%nodes) cycle
            self%old_point(k) = old - 1 + findloc(points%slave(old:old_last), &
               self%points%slave(k), dim=1)
         end do
         do k = first, last
            self%neighbours(:, k) = self%old_point(k)
            ! On a closed face the first and the last contact point are neighbours.
            if (self%old_point(k) == 0) self%neighbours(:, k) = beside(self, points, k, &
               [merge(last, k - 1, k == first), merge(first, k + 1, k == last)])
         end do
      end do
   end subroutine match_points

   !> Which contact points have a node that another one has, too: joints have no unknowns in common.
   pure function shared_points(points, nodes) result(is_shared)
      type(all_contact_points_type), intent(in) :: points
      integer, intent(in) :: nodes          !! of the mesh
      logical :: is_shared(size(points%slave))
      integer :: uses(nodes), k

      uses = 0
      do k = 1, size(is_shared)
         associate (pair => [points%slave(k), points%master(k)])
            uses(pair) = uses(pair) + 1
         end associate
      end do
      is_shared = uses(points%slave) > 1 .or. uses(points%master) > 1
   end function shared_points

   !> Old contact points on both sides of a new one, which are at nodes of the old side that it lies
   !> on. At the tip of a crack, a node that both faces share, there is only the other one.
   pure function beside(self, points, k, places) result(neighbours)
      type(refined_model_type), intent(in) :: self
      type(all_contact_points_type), intent(in) :: points
      integer, intent(in) :: k            !! the new one
      integer, intent(in) :: places(2)    !! contact points before and after it
      integer :: neighbours(2)
      integer :: i

      neighbours = self%old_point(places)
      associate (weights => self%division%weights, node => self%points%slave(k))
         associate (nodes => weights%column(weights%row_start(node): &
            weights%row_start(node + 1) - 1))
            do i = 1, 2
               if (neighbours(i) == 0) cycle
               if (all(nodes /= points%slave(neighbours(i)))) neighbours(i) = 0
            end do
         end associate
      end associate
      where (neighbours == 0) neighbours = neighbours([2, 1])
   end function beside

   !> Assembles the matrices that are asked for.
   subroutine assemble(self, with_mechanics, with_heat, with_strain)
      class(refined_model_type), intent(inout) :: self   !! prepared
      logical, intent(in) :: with_mechanics              !! stiffness
      logical, intent(in) :: with_heat                   !! conduction
      logical, intent(in) :: with_strain                 !! thermal load

      associate (model => self%model)
         if (with_mechanics .and. .not. allocated(self%stiffness%value)) then
            self%stiffness = assemble_stiffness(model%mesh, model%sections, model%materials, &
               model%orientations)
            if (allocated(model%mesh%initial_stress)) self%initial_force = &
               assemble_initial_force(model%mesh, model%sections)
         end if
         if (with_strain .and. .not. allocated(self%thermal_load%value)) then
            self%thermal_load = assemble_thermal_load(model%mesh, model%sections, &
               model%materials, model%orientations)
         end if
         if (with_heat .and. .not. allocated(self%conduction%value)) then
            self%conduction = assemble_conduction(model%mesh, model%sections, model%materials, &
               model%orientations)
         end if
      end associate
   end subroutine assemble

   !> The mean of a quantity of the old contact points about each contact point.
   pure function prolong_points(self, values) result(refined)
      class(refined_model_type), intent(in) :: self
      real(dp), intent(in) :: values(:)               !! (old contact points)
      real(dp) :: refined(size(self%old_point))       !! (m)

      refined = 0.5_dp*(values(self%neighbours(1, :)) + values(self%neighbours(2, :)))
   end function prolong_points

   !> Forces at the nodes of the new mesh as those of the old one that do the same work.
   pure function restrict(self, values, components) result(coarse)
      class(refined_model_type), intent(in) :: self
      real(dp), intent(in) :: values(:)               !! (components*nodes)
      integer, intent(in) :: components               !! values of a node
      real(dp) :: coarse(components*self%division%nodes)
      integer :: c

      do c = 1, components
         coarse(c::components) = self%division%weights%multiply_transposed( &
            values(c::components))
      end do
   end function restrict

   !> Which degrees of freedom of the new mesh are prescribed where those of the old one are.
   pure function prolong_set(self, member, components) result(refined)
      class(refined_model_type), intent(in) :: self
      logical, intent(in) :: member(:)                !! (components*old nodes)
      integer, intent(in) :: components               !! degrees of freedom of a node
      logical :: refined(components*self%division%nodes_after)
      integer :: c

      do c = 1, components
         refined(c::components) = refined_members(self%division, member(c::components))
      end do
   end function prolong_set

   !> Which degrees of freedom of the new mesh are on sides where elements of two sizes meet.
   pure function hangs(self, components)
      class(refined_model_type), intent(in) :: self
      integer, intent(in) :: components               !! degrees of freedom of a node
      logical :: hangs(components*self%division%nodes_after)
      integer :: c

      do c = 1, components
         hangs(c::components) = at_level_changes(self%model%mesh)
      end do
   end function hangs

   !> Conduction of the bodies and their films.
   pure function conduction_with(self, film) result(matrix)
      class(refined_model_type), intent(in) :: self   !! the refined model, assembled
      type(sparse_matrix_type), intent(in) :: film    !! films; without values where there are none
      type(sparse_matrix_type) :: matrix              !! (nodes, nodes) [power/temperature]

      matrix = self%conduction
      if (allocated(film%value)) matrix = linear_combination(1.0_dp, matrix, 1.0_dp, film)
   end function conduction_with

end module refined_model
