!> How the heat of friction follows the contact at given conductances. The heats q that contact
!> points make are found from the contact state under q, q = Q(q); a change of the condensed load by
!> dc at constant q changes them by
!>
!>    dq = (I - Q')^-1 (dQ/dc) dc,
!>
!> and the load by L dq more, L being the loads of unit heat with the jumps that it makes. On a
!> sparse tail neither Q' nor L is formed: GMRES solves for dq, from products.
module friction_tangent
   use closing_instant, only: contact_change_type, contact_response, make_tangent
   use contact_system, only: contact_open, contact_state_type
   use contact_workspace, only: contact_workspace_type
   use dense, only: lu_type, product_of
   use gmres, only: gmres_type
   use heat_reduction, only: heat_reduction_type
   use increment_data, only: increment_workspace_type
   use kinds, only: dp
   use reduced_bodies, only: reduced_bodies_type
   implicit none
   private
   public :: friction_tangent_type

   !> The derivative at a solution.
   type :: friction_tangent_type
      integer, allocatable :: active(:)         !! (a) which of the heats change
      !> Of a full tail: (thermal tail, a) of unit heat, (mechanical tail, a) L, and I - Q'
      real(dp), allocatable, private :: on_tail(:, :), load(:, :)
      type(lu_type) :: lu
      type(contact_state_type), private :: state          !! whose it is
      type(contact_workspace_type), private :: contact    !! of the state, by make_tangent
      logical :: exists = .false.               !! whether Q' exists and I - Q' is regular
   contains
      procedure :: make
      procedure :: solve
      procedure :: follow
   end type friction_tangent_type

   integer, parameter :: most_products = 200         !! for a change
   real(dp), parameter :: solved = 1.0e-12_dp        !! residual of a change, relative

contains

   !> Changes of the heats by those of the condensed load.
   function by_load(self, bodies, workspace, load) result(change)
      class(friction_tangent_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_workspace_type), intent(in) :: workspace
      real(dp), intent(in) :: load(:, :)                         ! (mechanical tail, columns)
      real(dp) :: change(size(workspace%friction%heat), size(load, 2))   ! (n, columns)
      type(contact_change_type) :: of_contact

      call contact_response(bodies%equilibrium%contact, self%contact, self%state, load, &
         of_contact, with_slip=.true.)
      change = workspace%friction%changes(bodies, self%state, of_contact)
   end function by_load

   !> The derivative at the state that the last pass found.
   subroutine make(self, bodies, heat, workspace, state)
      class(friction_tangent_type), intent(inout) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_workspace_type), intent(in) :: workspace  !! as the last pass left it
      type(contact_state_type), intent(in) :: state
      real(dp), allocatable :: by_heat(:, :), matrix(:, :)
      logical :: singular, sound
      integer :: j

      self%exists = .false.
      call make_tangent(bodies%equilibrium%contact, workspace%contact, state, self%contact, sound)
      if (.not. sound) return
      self%state = state
      associate (friction => workspace%friction, heated => bodies%points%heated)
         self%active = pack([(j, j=1, size(heated))], friction%parts(2, :) > 0.0_dp .and. &
            (state%contact_state(heated) /= contact_open .or. abs(friction%heat) > 0.0_dp))
         self%exists = heat%schur%is_sparse()
         if (self%exists) return
         associate (part => friction%parts(2, self%active))
            self%on_tail = heat%friction_heat(:, self%active)*spread(part, 1, &
               size(heat%friction_heat, 1))
            self%load = heat%friction_load(:, self%active)*spread(part, 1, &
               size(heat%friction_load, 1))
         end associate
         call workspace%tail%solve_columns(self%on_tail)
         self%load = self%load + product_of(heat%jump_load, self%on_tail)
         by_heat = by_load(self, bodies, workspace, self%load)
         matrix = -by_heat(self%active, :)
      end associate
      do j = 1, size(matrix, 1)
         matrix(j, j) = matrix(j, j) + 1.0_dp
      end do
      call self%lu%factor(matrix, singular)
      self%exists = .not. singular
   end subroutine make

   !> Changes of the heats that change, (I - Q')^-1 of those at constant heat.
   subroutine solve(self, bodies, heat, workspace, change)
      class(friction_tangent_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_workspace_type), intent(in) :: workspace  !! as the last pass left it
      real(dp), intent(inout) :: change(:, :)                  !! (a, columns)
      real(dp), allocatable :: load(:, :), of_tail(:, :)
      type(gmres_type) :: gmres
      integer :: k

      if (.not. heat%schur%is_sparse()) then
         call self%lu%solve(change)
         return
      end if
      do k = 1, size(change, 2)
         call gmres%begin(change(:, k), solved, max(min(size(change, 1), most_products), 1))
         do while (gmres%wants_product)
            call find_loads(self, bodies, heat, workspace, reshape(gmres%vector, &
               [size(change, 1), 1]), of_tail, load)
            associate (found => by_load(self, bodies, workspace, load))
               call gmres%take(gmres%vector - found(self%active, 1))
            end associate
         end do
         change(:, k) = gmres%solution()
      end do
   end subroutine solve

   !> What heats make on the tails.
   subroutine find_loads(self, bodies, heat, workspace, change, of_tail, load)
      class(friction_tangent_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_workspace_type), intent(in) :: workspace
      real(dp), intent(in) :: change(:, :)                       ! (a, columns)
      real(dp), allocatable, intent(out) :: of_tail(:, :)        ! (thermal tail, columns)
      real(dp), allocatable, intent(out) :: load(:, :)           ! (mechanical tail, columns)
      real(dp) :: entering(size(workspace%friction%heat))
      integer :: k

      if (.not. heat%schur%is_sparse()) then
         of_tail = product_of(self%on_tail, change)
         load = product_of(self%load, change)
         return
      end if
      allocate (of_tail(bodies%thermal%map%tail, size(change, 2)))
      do k = 1, size(change, 2)
         entering = 0.0_dp
         entering(self%active) = workspace%friction%parts(2, self%active)*change(:, k)
         of_tail(:, k) = heat%friction_on_tail(bodies, entering)
      end do
      call workspace%tail%solve_columns(of_tail)
      load = heat%loads_of_tail(bodies, of_tail)
   end subroutine find_loads

   !> Adds to changes at constant heat what the heat makes that follows them.
   subroutine follow(self, bodies, heat, workspace, of_tail, load, friction_heat)
      class(friction_tangent_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_workspace_type), intent(in) :: workspace  !! as the last pass left it
      real(dp), intent(inout) :: of_tail(:, :)        !! (thermal tail, columns)
      real(dp), intent(inout) :: load(:, :)           !! (mechanical tail, columns)
      !> (n, columns) changes of the heats in the end
      real(dp), intent(out), optional :: friction_heat(:, :)
      real(dp), allocatable :: change(:, :), more_load(:, :), more_of_tail(:, :)

      associate (found => by_load(self, bodies, workspace, load))
         change = found(self%active, :)
      end associate
      call self%solve(bodies, heat, workspace, change)
      call find_loads(self, bodies, heat, workspace, change, more_of_tail, more_load)
      of_tail = of_tail + more_of_tail
      load = load + more_load
      if (.not. present(friction_heat)) return
      friction_heat = 0.0_dp
      friction_heat(self%active, :) = change
   end subroutine follow

end module friction_tangent
