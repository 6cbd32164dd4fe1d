!> How the heat of friction follows the contact at given conductances. The heats q that contact
!> points make are found from the contact state under q, q = Q(q); a change of the condensed load by
!> dc at constant q changes them by
!>
!>    dq = (I - Q')^-1 (dQ/dc) dc,
!>
!> and the load by L dq more, L being the loads of unit heat with the jumps that it makes.
module friction_tangent
   use closing_instant, only: contact_change_type, contact_response, make_tangent
   use contact_system, only: contact_open, contact_state_type
   use contact_workspace, only: contact_workspace_type
   use dense, only: lu_type, product_of
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
      real(dp), allocatable :: on_tail(:, :)    !! (thermal tail, a) of unit heat
      real(dp), allocatable :: load(:, :)       !! (mechanical tail, a) L
      type(lu_type) :: lu                       !! of I - Q'
      type(contact_workspace_type) :: contact   !! of the state, by make_tangent
      logical :: exists = .false.               !! whether Q' exists and I - Q' is regular
   contains
      procedure :: make
      procedure :: follow
   end type friction_tangent_type

contains

   !> The derivative at the state that the last pass found.
   subroutine make(self, bodies, heat, workspace, state)
      class(friction_tangent_type), intent(inout) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_workspace_type), intent(in) :: workspace  !! as the last pass left it
      type(contact_state_type), intent(in) :: state
      type(contact_change_type) :: change
      real(dp), allocatable :: by_heat(:, :), matrix(:, :)
      logical :: singular, sound
      integer :: j

      self%exists = .false.
      call make_tangent(bodies%equilibrium%contact, workspace%contact, state, self%contact, sound)
      if (.not. sound) return
      associate (friction => workspace%friction, heated => bodies%points%heated)
         self%active = pack([(j, j=1, size(heated))], friction%parts(2, :) > 0.0_dp .and. &
            (state%contact_state(heated) /= contact_open .or. abs(friction%heat) > 0.0_dp))
         associate (part => friction%parts(2, self%active))
            self%on_tail = heat%friction_heat(:, self%active)*spread(part, 1, &
               size(heat%friction_heat, 1))
            self%load = heat%friction_load(:, self%active)*spread(part, 1, &
               size(heat%friction_load, 1))
         end associate
         call workspace%tail%solve_columns(self%on_tail)
         self%load = self%load + product_of(heat%jump_load, self%on_tail)
         call contact_response(bodies%equilibrium%contact, self%contact, state, self%load, &
            change, with_slip=.true.)
         by_heat = friction%changes(bodies, state, change)
         matrix = -by_heat(self%active, :)
      end associate
      do j = 1, size(matrix, 1)
         matrix(j, j) = matrix(j, j) + 1.0_dp
      end do
      call self%lu%factor(matrix, singular)
      self%exists = .not. singular
   end subroutine make

   !> Adds to changes at constant heat what the heat makes that follows them.
   subroutine follow(self, by_contact, of_tail, load, friction_heat)
      class(friction_tangent_type), intent(in) :: self
      real(dp), intent(in) :: by_contact(:, :)        !! (n, columns) changes of the heats
      real(dp), intent(inout) :: of_tail(:, :)        !! (thermal tail, columns)
      real(dp), intent(inout) :: load(:, :)           !! (mechanical tail, columns)
      !> (n, columns) changes of the heats in the end
      real(dp), intent(out) :: friction_heat(:, :)
      real(dp), allocatable :: change(:, :)

      change = by_contact(self%active, :)
      call self%lu%solve(change)
      of_tail = of_tail + product_of(self%on_tail, change)
      load = load + product_of(self%load, change)
      friction_heat = 0.0_dp
      friction_heat(self%active, :) = change
   end subroutine follow

end module friction_tangent
