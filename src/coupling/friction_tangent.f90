!> How the contact, and with it the heat of friction, follows its load at given conductances. The
!> heats q that contact points make are found from the contact state under q, q = Q(q); a change of
!> the condensed load by dc at constant q changes them by
!>
!>    dq = (I - Q')^-1 (dQ/dc) dc,
!>
!> and the load by L dq more, L being the loads of unit heat with the jumps that it makes. On a
!> sparse tail Q' is not formed: GMRES solves for dq, from products.
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
      type(contact_workspace_type) :: contact   !! of the state, by make_tangent
      logical :: makes_heat = .false.           !! whether friction does
      !> Whether the derivative of the contact exists, Q' too, and I - Q' is regular
      logical :: exists = .false.
      integer, allocatable :: active(:)         !! (a) which of the heats change
      type(lu_type) :: lu                       !! I - Q' of a full tail
      type(contact_state_type), private :: state          !! whose it is
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
      real(dp), allocatable :: by_heat(:, :), load(:, :), matrix(:, :), of_tail(:, :)
      logical :: singular
      integer :: j

      call make_tangent(bodies%equilibrium%contact, workspace%contact, state, self%contact, &
         self%exists)
      self%makes_heat = allocated(workspace%friction%heat)
      if (.not. (self%exists .and. self%makes_heat)) return
      self%state = state
      associate (friction => workspace%friction, heated => bodies%points%heated)
         self%active = pack([(j, j=1, size(heated))], friction%parts(2, :) > 0.0_dp .and. &
            (state%contact_state(heated) /= contact_open .or. abs(friction%heat) > 0.0_dp))
      end associate
      if (heat%schur%is_sparse()) return
      allocate (matrix(size(self%active), size(self%active)), source=0.0_dp)
      do j = 1, size(matrix, 1)
         matrix(j, j) = 1.0_dp
      end do
      call find_loads(self, bodies, heat, workspace, matrix, of_tail, load)
      by_heat = by_load(self, bodies, workspace, load)
      matrix = matrix - by_heat(self%active, :)
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
      real(dp) :: entering(size(workspace%friction%heat), size(change, 2))
      integer :: k

      entering = 0.0_dp
      entering(self%active, :) = change
      entering = workspace%friction%entering_part(entering)
      allocate (of_tail(bodies%thermal%map%tail, size(change, 2)))
      do k = 1, size(change, 2)
         of_tail(:, k) = heat%friction_on_tail(bodies, entering(:, k))
      end do
      call workspace%tail%solve_columns(of_tail)
      load = heat%loads_of_tail(bodies, of_tail)
      if (.not. heat%schur%is_sparse()) load = load + product_of(heat%friction_load, entering)
   end subroutine find_loads

   !> Adds to changes at constant heat what the heat makes that follows them.
   subroutine follow(self, bodies, heat, workspace, of_tail, load, friction_heat)
      class(friction_tangent_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_workspace_type), intent(in) :: workspace  !! as the last pass left it
      real(dp), intent(inout) :: of_tail(:, :)        !! (thermal tail, columns)
      real(dp), intent(inout) :: load(:, :)           !! (mechanical tail, columns)
      !> (n, columns) changes of the heats in the end, where friction makes any
      real(dp), allocatable, intent(inout), optional :: friction_heat(:, :)
      real(dp), allocatable :: change(:, :), more_load(:, :), more_of_tail(:, :)

      if (.not. self%makes_heat) return
      associate (found => by_load(self, bodies, workspace, load))
         change = found(self%active, :)
      end associate
      call self%solve(bodies, heat, workspace, change)
      call find_loads(self, bodies, heat, workspace, change, more_of_tail, more_load)
      of_tail = of_tail + more_of_tail
      load = load + more_load
      if (.not. present(friction_heat)) return
      friction_heat = spread(0.0_dp*workspace%friction%heat, 2, size(load, 2))
      friction_heat(self%active, :) = change
   end subroutine follow

end module friction_tangent
