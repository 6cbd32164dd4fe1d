!> How the contact answers temperatures while its states stay, and the transposed of that: by a
!> solution of the contact system each, for a sparse tail.
!>
!> Changes are those of the conductances of some contact points, of the heats of friction, and of
!> the openings of contact points at edges inside a side, one behind the other.
module contact_answers
   use closing_instant, only: contact_change_type
   use contact_heat, only: changes_by_faces
   use contact_operator, only: opening_changes
   use contact_system, only: contact_open, contact_state_type
   use contact_workspace, only: contact_workspace_type
   use heat_reduction, only: loads_of_temperatures, temperatures_in_loads
   use increment_data, only: increment_workspace_type
   use kinds, only: dp
   use reduced_bodies, only: reduced_bodies_type
   implicit none
   private
   public :: contact_answers_type

   !> What answers go by.
   type :: contact_answers_type
      integer :: changes = 0                       !! n
      integer, allocatable :: active(:)            !! (a) contact points whose conductance counts
      integer :: heated = 0                        !! heats of friction
      integer, allocatable :: at_edge(:)           !! contact points whose openings count
      type(contact_workspace_type) :: tangent      !! factors of the contact states
      type(contact_state_type) :: contact          !! these states
      type(increment_workspace_type) :: laws       !! graphs, faces, heat of friction
      real(dp), allocatable :: coordinate(:)       !! (m) of the laws [length]
      real(dp), allocatable :: slope(:)            !! (m) of omega by the opening
   contains
      procedure :: found_answers
      procedure :: sums_of_answers
   end type contact_answers_type

contains

   !> N: changes y as the contact makes them.
   function found_answers(self, bodies, temperature, growth) result(changes)
      class(contact_answers_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: temperature(:, :)                !! (nodes, columns) [temperature]
      real(dp), intent(in) :: growth                           !! of theirs [1/time]
      real(dp) :: changes(self%changes, size(temperature, 2))  !! (n, columns)
      real(dp), dimension(size(self%slope), size(temperature, 2)) :: by_faces, jump, mean, opening
      type(contact_change_type) :: of_contact
      integer :: k

      call opening_changes(bodies, self%laws%pass%graph, self%tangent, self%contact, &
         loads_of_temperatures(bodies, temperature), opening, of_contact)
      by_faces = 0.0_dp
      if (bodies%points%vary_with_temperature()) then
         do k = 1, size(temperature, 2)
            mean(:, k) = bodies%points%means(temperature(:, k))
            jump(:, k) = bodies%points%jumps(temperature(:, k))
         end do
         by_faces = changes_by_faces(bodies, self%laws, self%coordinate, mean, jump)
      end if
      associate (a => size(self%active))
         do k = 1, a
            associate (j => self%active(k))
               changes(k, :) = self%slope(j)*opening(j, :) + by_faces(j, :)
            end associate
         end do
         if (self%heated > 0) changes(a + 1:a + self%heated, :) = self%laws%friction%changes( &
            bodies, self%contact, of_contact, growth)
         changes(a + self%heated + 1:, :) = opening(self%at_edge, :)
      end associate
   end function found_answers

   !> N^T y: sums of changes y, as they follow the temperatures of the nodes.
   function sums_of_answers(self, bodies, changes, growth) result(sums)
      class(contact_answers_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: changes(:)                       !! (n) y
      real(dp), intent(in) :: growth                           !! [1/time]
      real(dp) :: sums(bodies%thermal%matrix%row_count)        !! (nodes)
      real(dp) :: by_motion(bodies%mechanical%map%tail, 1), by_force(bodies%mechanical%map%tail, 1)
      real(dp), dimension(size(self%slope)) :: by_conductance, by_opening
      real(dp), dimension(size(self%slope), 1) :: by_faces, nothing
      real(dp) :: by_load(bodies%mechanical%map%tail, 1)

      associate (a => size(self%active), system => bodies%equilibrium%contact)
         by_conductance = 0.0_dp
         by_conductance(self%active) = changes(:a)
         by_opening = self%slope*by_conductance
         by_opening(self%at_edge) = by_opening(self%at_edge) + changes(a + self%heated + 1:)
         by_motion = 0.0_dp
         by_force = 0.0_dp
         call add_openings(self, bodies, by_opening, by_motion(:, 1), by_force(:, 1))
         if (self%heated > 0) call add_heats(self, bodies, changes(a + 1:a + self%heated), growth, &
            by_motion(:, 1), by_force(:, 1))
         ! Forces are the load less S times the motion that it makes.
         by_load = by_motion - system%schur%times(by_force)
         call self%tangent%solve_transposed(by_load(:, 1))
         by_load = by_load + by_force
      end associate
      associate (of_loads => temperatures_in_loads(bodies, by_load))
         sums = of_loads(:, 1)
      end associate
      if (.not. bodies%points%vary_with_temperature()) return
      nothing = 0.0_dp
      by_faces = changes_by_faces(bodies, self%laws, self%coordinate, nothing + 1.0_dp, nothing)
      call bodies%points%mean%add_shares(by_faces(:, 1)*by_conductance, sums)
      by_faces = changes_by_faces(bodies, self%laws, self%coordinate, nothing, nothing + 1.0_dp)
      call bodies%points%difference%add_shares(by_faces(:, 1)*by_conductance, sums)
   end function sums_of_answers

   !> Adds what openings have of motions and forces of the tail.
   pure subroutine add_openings(self, bodies, by_opening, by_motion, by_force)
      type(contact_answers_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: by_opening(:)                    ! (m) factors of openings
      real(dp), intent(inout) :: by_motion(:), by_force(:)     ! (tail) likewise
      integer :: k

      do k = 1, size(by_opening)
         associate (row => bodies%equilibrium%contact%normal(k), weight => bodies%points%weight(k))
            if (weight <= 0.0_dp) cycle
            if (self%contact%contact_state(k) == contact_open) then
               by_motion(row) = by_motion(row) - by_opening(k)
            else
               by_force(row) = by_force(row) - by_opening(k)/(weight* &
                  self%laws%pass%graph(k)%modulus)
            end if
         end associate
      end do
   end subroutine add_openings

   !> Adds what heats of friction have of motions and forces of the tail.
   pure subroutine add_heats(self, bodies, by_heat, growth, by_motion, by_force)
      type(contact_answers_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: by_heat(:)                       ! (heats) factors of them
      real(dp), intent(in) :: growth
      real(dp), intent(inout) :: by_motion(:), by_force(:)     ! (tail) likewise
      real(dp) :: unit(size(self%slope), 3, 3)     ! of force, shear and slip, a column each
      real(dp) :: per(size(by_heat), 3)
      integer :: k

      unit = 0.0_dp
      do k = 1, 3
         unit(:, k, k) = 1.0_dp
      end do
      per = self%laws%friction%changes(bodies, self%contact, contact_change_type( &
         force=unit(:, :, 1), shear=unit(:, :, 2), slip=unit(:, :, 3)), growth)
      associate (system => bodies%equilibrium%contact)
         do k = 1, size(by_heat)
            associate (j => bodies%points%heated(k))
               by_force(system%normal(j)) = by_force(system%normal(j)) + by_heat(k)*per(k, 1)
               if (system%tangent(j) == 0) cycle
               by_force(system%tangent(j)) = by_force(system%tangent(j)) - by_heat(k)* &
                  (per(k, 2) + per(k, 3)*system%compliance(j))
               by_motion(system%tangent(j)) = by_motion(system%tangent(j)) + by_heat(k)*per(k, 3)
            end associate
         end do
      end associate
   end subroutine add_heats

end module contact_answers
