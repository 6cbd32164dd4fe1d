!> What happens on the pairs that a division of the elements adds: what keeps them closed or stuck,
!> and the states that follow from their forces and gaps.
module refined_pairs
   use conductance_laws, only: conductance
   use contact_states, only: contact_state_type, status_open, status_slip, status_stick
   use kinds, only: dp
   use pair_rows, only: pair_row_type
   use refined_model, only: refined_model_type
   use linked_relaxation, only: joint_type
   implicit none
   private
   public :: refined_pairs_type

   !> State of all pairs of a refined model; those of old ones are taken from the old mesh.
   type :: refined_pairs_type
      integer, allocatable :: status(:)        !! (m) open, slip or stick
      integer, allocatable :: direction(:)     !! (m) sign of friction on the slave in slip
      real(dp), allocatable :: gap(:)          !! (m) [length]
      real(dp), allocatable :: force(:)        !! (m) nodal, positive in compression [force]
      real(dp), allocatable :: shear_force(:)  !! (m) on the slave [force]
      real(dp), allocatable :: omega(:)        !! (m) [power/(length^2 temperature)]
   contains
      procedure :: begin
      procedure :: take_old
      procedure :: mechanical_joints
      procedure :: slip_forces
      procedure :: conducting_joints
      procedure :: update
      procedure :: conduct
      procedure :: heat
   end type refined_pairs_type

contains

   !> New pairs between two of one state have it; between a closed and an open one they start open.
   subroutine begin(self, refined, contact)
      class(refined_pairs_type), intent(out) :: self
      type(refined_model_type), intent(in) :: refined
      type(contact_state_type), intent(in) :: contact    !! state of the old pairs

      associate (one => refined%neighbours(1, :), other => refined%neighbours(2, :))
         self%status = min(contact%status(one), contact%status(other))
         self%direction = contact%direction(one)
         where (self%direction == 0) self%direction = contact%direction(other)
         where (self%status == status_slip .and. self%direction == 0 .and. &
            refined%pairs%friction > 0.0_dp) self%status = status_stick
      end associate
      self%gap = refined%prolong_pairs(contact%gap)
      self%force = 0.0_dp*self%gap
      self%shear_force = self%force
      self%omega = self%force
   end subroutine begin

   !> Takes the old pairs' state; their forces are what the new ones leave of those on the old mesh.
   subroutine take_old(self, refined, contact)
      class(refined_pairs_type), intent(inout) :: self
      type(refined_model_type), intent(in) :: refined
      type(contact_state_type), intent(in) :: contact    !! state of the old pairs
      real(dp) :: shared(2*size(refined%coarse%node_number)), on_slave(2)
      integer :: k, old

      shared = refined%restrict(slave_forces(self, refined), 2)
      do k = 1, size(self%status)
         old = refined%old_pair(k)
         if (old == 0) cycle
         associate (pairs => refined%pairs, s => 2*refined%pairs%slave(k))
            self%status(k) = contact%status(old)
            self%direction(k) = contact%direction(old)
            self%gap(k) = contact%gap(old)
            on_slave = shared(s - 1:s)
            self%force(k) = contact%force(old) + dot_product(on_slave, pairs%normal(:, k))
            self%shear_force(k) = contact%shear_force(old) - &
               dot_product(on_slave, pairs%tangent(:, k))
         end associate
      end do
   end subroutine take_old

   !> Forces of the new pairs on the slave's nodes.
   pure function slave_forces(self, refined) result(forces)
      class(refined_pairs_type), intent(in) :: self
      type(refined_model_type), intent(in) :: refined
      real(dp) :: forces(2*size(refined%model%mesh%node_number))
      integer :: k

      forces = 0.0_dp
      do k = 1, size(self%status)
         if (refined%old_pair(k) > 0) cycle
         associate (pairs => refined%pairs, s => 2*refined%pairs%slave(k))
            forces(s - 1:s) = forces(s - 1:s) + self%shear_force(k)*pairs%tangent(:, k) - &
               self%force(k)*pairs%normal(:, k)
         end associate
      end do
   end function slave_forces

   !> Forces of friction in slip on both bodies, from the normal forces as they stand.
   pure function slip_forces(self, refined) result(forces)
      class(refined_pairs_type), intent(in) :: self
      type(refined_model_type), intent(in) :: refined
      real(dp) :: forces(2*size(refined%model%mesh%node_number))     !! [force]
      integer :: k

      forces = 0.0_dp
      do k = 1, size(self%status)
         if (self%status(k) /= status_slip .or. refined%old_pair(k) > 0) cycle
         associate (s => 2*refined%pairs%slave(k), m => 2*refined%pairs%master(k), &
            friction => self%shear_force(k)*refined%pairs%tangent(:, k))
            forces(s - 1:s) = forces(s - 1:s) + friction
            forces(m - 1:m) = forces(m - 1:m) - friction
         end associate
      end do
   end function slip_forces

   !> Joints that keep the closed new pairs closed, and the stuck ones where the old mesh has them.
   subroutine mechanical_joints(self, refined, displacement, joints)
      class(refined_pairs_type), intent(in) :: self
      type(refined_model_type), intent(in) :: refined
      real(dp), intent(in) :: displacement(:) !! (2 nodes) field of the old mesh [length]
      type(joint_type), allocatable, intent(out) :: joints(:)
      real(dp) :: relative(2)
      integer :: k, n

      allocate (joints(count(self%status /= status_open .and. refined%old_pair == 0)))
      n = 0
      do k = 1, size(self%status)
         if (self%status(k) == status_open .or. refined%old_pair(k) > 0) cycle
         n = n + 1
         associate (pairs => refined%pairs, s => 2*refined%pairs%slave(k), &
            m => 2*refined%pairs%master(k), joint => joints(n))
            joint%dof = [s - 1, s, m - 1, m]
            joint%is_rigid = .true.
            joint%direction = reshape([pairs%normal(:, k), -pairs%normal(:, k)], [4, 1])
            joint%rest = [pairs%initial_gap(k)]
            if (self%status(k) == status_slip .or. pairs%held_axis(k) > 0) cycle
            relative = displacement(s - 1:s) - displacement(m - 1:m)
            joint%direction = reshape([joint%direction, pairs%tangent(:, k), &
               -pairs%tangent(:, k)], [4, 2])
            joint%rest = [joint%rest, dot_product(pairs%tangent(:, k), relative)]
         end associate
      end do
   end subroutine mechanical_joints

   !> Conductances of all pairs as springs between their temperatures.
   subroutine conducting_joints(self, refined, joints)
      class(refined_pairs_type), intent(in) :: self
      type(refined_model_type), intent(in) :: refined
      type(joint_type), allocatable, intent(out) :: joints(:)
      integer :: k

      allocate (joints(size(self%omega)))
      do k = 1, size(joints)
         joints(k)%dof = [refined%pairs%slave(k), refined%pairs%master(k)]
         joints(k)%direction = reshape([1.0_dp, -1.0_dp], [2, 1])
         joints(k)%rest = [0.0_dp]
         joints(k)%stiffness = self%omega(k)*refined%pairs%weight(k)
      end do
   end subroutine conducting_joints

   !> Forces and gaps of the new pairs from the displacements that their joints gave, and the states
   !> that follow: a pair in tension opens, one that overlaps closes.
   subroutine update(self, refined, displacement, load)
      class(refined_pairs_type), intent(inout) :: self
      type(refined_model_type), intent(in) :: refined
      real(dp), intent(in) :: displacement(:)                !! (2 nodes) [length]
      real(dp), intent(in) :: load(:) !! (2 nodes) forces that the pairs must hold [force]
      real(dp) :: relative(2), on_slave(2)
      integer :: free, k

      do k = 1, size(self%status)
         if (refined%old_pair(k) > 0) cycle
         associate (pairs => refined%pairs, s => 2*refined%pairs%slave(k), &
            m => 2*refined%pairs%master(k))
            if (self%status(k) == status_open) then
               relative = displacement(s - 1:s) - displacement(m - 1:m)
               self%gap(k) = pairs%initial_gap(k) - dot_product(pairs%normal(:, k), relative)
               self%force(k) = 0.0_dp
               self%shear_force(k) = 0.0_dp
            else
               on_slave = 0.5_dp*(load(m - 1:m) - load(s - 1:s))
               self%gap(k) = 0.0_dp
               free = 3 - pairs%held_axis(k)
               if (free < 3) then
                  ! Supports take the rest, and friction with it.
                  self%force(k) = -on_slave(free)/pairs%normal(free, k)
                  self%shear_force(k) = 0.0_dp
               else
                  self%force(k) = -dot_product(pairs%normal(:, k), on_slave)
                  self%shear_force(k) = dot_product(pairs%tangent(:, k), on_slave)
               end if
               if (self%status(k) == status_slip) self%shear_force(k) = &
                  self%direction(k)*pairs%friction(k)*self%force(k)
            end if
            call next_state(self, k, pairs%friction(k))
         end associate
      end do
   end subroutine update

   !> The state that a new pair takes next.
   subroutine next_state(self, k, friction)
      type(refined_pairs_type), intent(inout) :: self
      integer, intent(in) :: k
      real(dp), intent(in) :: friction

      if (self%status(k) == status_open) then
         if (self%gap(k) < 0.0_dp) self%status(k) = merge(status_stick, status_slip, &
            friction > 0.0_dp)
         return
      end if
      if (self%status(k) == status_stick .and. &
         abs(self%shear_force(k)) > friction*self%force(k)) then
         self%status(k) = status_slip
         self%direction(k) = merge(1, -1, self%shear_force(k) > 0.0_dp)
      end if
      if (self%force(k) >= 0.0_dp) return
      self%status(k) = status_open
      self%force(k) = 0.0_dp
      self%shear_force(k) = 0.0_dp
   end subroutine next_state

   !> Conductances by the laws, with the pressures that the forces give; a pair that rests on the
   !> old mesh keeps the value found there.
   subroutine conduct(self, refined, omega, resting)
      class(refined_pairs_type), intent(inout) :: self
      type(refined_model_type), intent(in) :: refined
      real(dp), intent(in) :: omega(:)                   !! (old pairs) conductance
      logical, intent(in) :: resting(:)                  !! (old pairs) whether it rests
      real(dp) :: pressure
      integer :: k

      do k = 1, size(self%status)
         associate (pairs => refined%pairs, old => refined%old_pair(k))
            pressure = 0.0_dp
            if (pairs%weight(k) > 0.0_dp) pressure = self%force(k)/pairs%weight(k)
            self%omega(k) = conductance(pairs%law(k), self%status(k) /= status_open, self%gap(k), &
               pressure)
            if (old == 0) cycle
            if (resting(old)) self%omega(k) = omega(old)
         end associate
      end do
   end subroutine conduct

   !> Heat of every pair from slave to master.
   pure function heat(self, pairs, temperature) result(rates)
      class(refined_pairs_type), intent(in) :: self
      type(pair_row_type), intent(in) :: pairs       !! the refined model's
      real(dp), intent(in) :: temperature(:)         !! (nodes) [temperature]
      real(dp) :: rates(size(self%status))           !! (m) [power]

      rates = pairs%weight*self%omega*(temperature(pairs%slave) - temperature(pairs%master))
   end function heat

end module refined_pairs
