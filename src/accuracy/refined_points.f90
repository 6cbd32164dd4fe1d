!> What happens on the contact points that a division of the elements adds: what keeps them closed
!> or stuck, and the states that follow from their forces and gaps.
module refined_points
   use conductance_laws, only: conductance, conductance_law_type
   use contact_states, only: contact_state_type, contact_open, contact_slip, contact_stick, &
      slip_force
   use friction_laws, only: friction_bound, friction_law_type
   use kinds, only: dp
   use all_contact_points, only: all_contact_points_type
   use refined_model, only: refined_model_type
   use linked_relaxation, only: joint_type
   implicit none
   private
   public :: refined_points_type

   !> State of all contact points of a refined model; those of old ones are taken from the old mesh.
   type :: refined_points_type
      integer, allocatable :: contact_state(:) !! (m) open, slip or stick
      integer, allocatable :: direction(:)     !! (m) as in contact_state_type
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
   end type refined_points_type

contains

   !> New contact points between two of one state have it; between a closed and an open one they
   !> start open.
   subroutine begin(self, refined, contact)
      class(refined_points_type), intent(out) :: self
      type(refined_model_type), intent(in) :: refined
      type(contact_state_type), intent(in) :: contact    !! state of the old contact points

      associate (one => refined%neighbours(1, :), other => refined%neighbours(2, :))
         self%contact_state = min(contact%contact_state(one), contact%contact_state(other))
         self%direction = contact%direction(one)
         where (self%direction == 0) self%direction = contact%direction(other)
         where (self%contact_state == contact_slip .and. self%direction == 0 .and. &
            refined%points%has_friction()) self%contact_state = contact_stick
      end associate
      self%gap = refined%prolong_points(contact%gap)
      self%force = 0.0_dp*self%gap
      self%shear_force = self%force
      self%omega = self%force
   end subroutine begin

   !> Takes the old contact points' state; their forces are what the new ones leave of those on the
   !> old mesh.
   subroutine take_old(self, refined, contact)
      class(refined_points_type), intent(inout) :: self
      type(refined_model_type), intent(in) :: refined
      type(contact_state_type), intent(in) :: contact    !! state of the old contact points
      real(dp) :: shared(2, refined%division%nodes)
      logical :: has_friction(size(self%contact_state))
      integer :: k, old

      shared = slave_forces(self, refined)
      has_friction = refined%points%has_friction()
      do k = 1, size(self%contact_state)
         old = refined%old_point(k)
         if (old == 0) cycle
         associate (points => refined%points, on_slave => shared(:, refined%points%slave(k)))
            self%contact_state(k) = contact%contact_state(old)
            self%direction(k) = contact%direction(old)
            self%gap(k) = contact%gap(old)
            self%force(k) = contact%force(old) + dot_product(on_slave, points%normal(:, k))
            ! Normals of new contact points may differ from those of old ones.
            if (has_friction(k)) self%shear_force(k) = contact%shear_force(old) - &
               dot_product(on_slave, points%tangent(:, k))
         end associate
      end do
   end subroutine take_old

   !> Forces of the new contact points on the slave, at the old nodes that do the same work.
   pure function slave_forces(self, refined) result(forces)
      class(refined_points_type), intent(in) :: self
      type(refined_model_type), intent(in) :: refined
      real(dp) :: forces(2, refined%division%nodes)
      integer :: k, l

      forces = 0.0_dp
      associate (points => refined%points, weights => refined%division%weights)
         do k = 1, size(self%contact_state)
            if (refined%old_point(k) > 0) cycle
            do l = weights%row_start(points%slave(k)), weights%row_start(points%slave(k) + 1) - 1
               forces(:, weights%column(l)) = forces(:, weights%column(l)) + weights%value(l)* &
                  (self%shear_force(k)*points%tangent(:, k) - self%force(k)*points%normal(:, k))
            end do
         end do
      end associate
   end function slave_forces

   !> Forces of friction in slip on both bodies, from the normal forces as they stand.
   pure function slip_forces(self, refined) result(forces)
      class(refined_points_type), intent(in) :: self
      type(refined_model_type), intent(in) :: refined
      real(dp) :: forces(2*size(refined%model%mesh%node_number))     !! [force]
      integer :: k

      forces = 0.0_dp
      do k = 1, size(self%contact_state)
         if (self%contact_state(k) /= contact_slip .or. refined%old_point(k) > 0) cycle
         associate (slave_dof => 2*refined%points%slave(k), &
            master_dof => 2*refined%points%master(k), &
            friction => self%shear_force(k)*refined%points%tangent(:, k))
            forces(slave_dof - 1:slave_dof) = forces(slave_dof - 1:slave_dof) + friction
            forces(master_dof - 1:master_dof) = forces(master_dof - 1:master_dof) - friction
         end associate
      end do
   end function slip_forces

   !> Joints that keep the closed new contact points closed, and the stuck ones where the old mesh
   !> has them. Both nodes of a closed old one move together; the old mesh says what is between
   !> them.
   subroutine mechanical_joints(self, refined, displacement, joints)
      class(refined_points_type), intent(in) :: self
      type(refined_model_type), intent(in) :: refined
      real(dp), intent(in) :: displacement(:) !! (2 nodes) field of the old mesh [length]
      type(joint_type), allocatable, intent(out) :: joints(:)
      real(dp) :: relative(2), gap(size(self%contact_state))
      logical, dimension(size(self%contact_state)) :: is_joined, is_old
      integer :: k, n

      gap = refined%loads%present_gaps(refined%points)
      is_old = refined%old_point > 0
      is_joined = self%contact_state /= contact_open .and. .not. refined%is_shared
      allocate (joints(count(is_joined)))
      n = 0
      do k = 1, size(self%contact_state)
         if (.not. is_joined(k)) cycle
         n = n + 1
         associate (points => refined%points, slave_dof => 2*refined%points%slave(k), &
            master_dof => 2*refined%points%master(k), joint => joints(n))
            joint%dof = [slave_dof - 1, slave_dof, master_dof - 1, master_dof]
            joint%is_rigid = .true.
            joint%direction = reshape([points%normal(:, k), -points%normal(:, k)], [4, 1])
            relative = displacement(slave_dof - 1:slave_dof) - &
               displacement(master_dof - 1:master_dof)
            joint%rest = [merge(dot_product(points%normal(:, k), relative), gap(k), is_old(k))]
            if (points%is_held(k)) cycle
            if (self%contact_state(k) == contact_slip .and. .not. is_old(k)) cycle
            joint%direction = reshape([joint%direction, points%tangent(:, k), &
               -points%tangent(:, k)], [4, 2])
            joint%rest = [joint%rest, dot_product(points%tangent(:, k), relative)]
         end associate
      end do
   end subroutine mechanical_joints

   !> Conductances of all contact points as springs between their temperatures.
   subroutine conducting_joints(self, refined, joints)
      class(refined_points_type), intent(in) :: self
      type(refined_model_type), intent(in) :: refined
      type(joint_type), allocatable, intent(out) :: joints(:)
      integer :: k

      allocate (joints(size(self%omega)))
      do k = 1, size(joints)
         joints(k)%dof = [refined%points%slave(k), refined%points%master(k)]
         joints(k)%direction = reshape([1.0_dp, -1.0_dp], [2, 1])
         joints(k)%rest = [0.0_dp]
         joints(k)%stiffness = self%omega(k)*refined%points%weight(k)
      end do
   end subroutine conducting_joints

   !> Forces and gaps of the new contact points from the displacements that their joints gave, and
   !> the states that follow: a contact point in tension opens, one that overlaps closes.
   subroutine update(self, refined, displacement, load)
      class(refined_points_type), intent(inout) :: self
      type(refined_model_type), intent(in) :: refined
      real(dp), intent(in) :: displacement(:)                !! (2 nodes) [length]
      real(dp), intent(in) :: load(:) !! (2 nodes) forces that the contact points must hold [force]
      real(dp) :: relative(2), on_slave(2), free(2)
      real(dp), dimension(size(self%contact_state)) :: gap, largest
      integer :: k

      gap = refined%loads%present_gaps(refined%points)
      largest = refined%points%largest_friction()
      do k = 1, size(self%contact_state)
         if (refined%old_point(k) > 0) cycle
         associate (points => refined%points, slave_dof => 2*refined%points%slave(k), &
            master_dof => 2*refined%points%master(k))
            if (self%contact_state(k) == contact_open) then
               relative = displacement(slave_dof - 1:slave_dof) - &
                  displacement(master_dof - 1:master_dof)
               self%gap(k) = gap(k) - dot_product(points%normal(:, k), relative)
               self%force(k) = 0.0_dp
               self%shear_force(k) = 0.0_dp
            else
               on_slave = 0.5_dp*(load(master_dof - 1:master_dof) - load(slave_dof - 1:slave_dof))
               self%gap(k) = 0.0_dp
               if (points%is_held(k)) then
                  ! Supports take the rest, and friction with it.
                  free = [-points%held_direction(2, k), points%held_direction(1, k)]
                  self%force(k) = -dot_product(free, on_slave)/dot_product(free, &
                     points%normal(:, k))
                  self%shear_force(k) = 0.0_dp
               else
                  self%force(k) = -dot_product(points%normal(:, k), on_slave)
                  self%shear_force(k) = dot_product(points%tangent(:, k), on_slave)
               end if
               if (self%contact_state(k) == contact_slip) self%shear_force(k) = slip_force( &
                  self%direction(k), points%friction(k)%coefficient, largest(k), self%force(k))
            end if
            call next_state(self, k, points%removed(k), &
               friction_law_type(points%friction(k)%coefficient, largest(k)))
         end associate
      end do
   end subroutine update

   !> The state that a new contact point takes next.
   subroutine next_state(self, k, removed, friction)
      type(refined_points_type), intent(inout) :: self
      integer, intent(in) :: k
      logical, intent(in) :: removed                    ! whether it stays open
      type(friction_law_type), intent(in) :: friction   ! with the largest force for a shear
      logical :: over_largest

      if (self%contact_state(k) == contact_open) then
         if (self%gap(k) < 0.0_dp .and. .not. removed) self%contact_state(k) = &
            merge(contact_stick, contact_slip, friction%coefficient > 0.0_dp)
         return
      end if
      if (self%contact_state(k) == contact_stick .and. abs(self%shear_force(k)) > friction_bound( &
         friction%coefficient, friction%largest_shear, self%force(k))) then
         self%contact_state(k) = contact_slip
         self%direction(k) = merge(1, -1, self%shear_force(k) > 0.0_dp)
      end if
      over_largest = friction%coefficient*self%force(k) > friction%largest_shear
      self%direction(k) = merge(2, 1, over_largest)*min(max(self%direction(k), -1), 1)
      if (self%force(k) >= 0.0_dp) return
      self%contact_state(k) = contact_open
      self%force(k) = 0.0_dp
      self%shear_force(k) = 0.0_dp
   end subroutine next_state

   !> Conductances by the laws, with the temperatures of the faces and the pressures that the
   !> forces give; a contact point that rests on the old mesh keeps the value found there.
   subroutine conduct(self, refined, temperature, omega, resting)
      class(refined_points_type), intent(inout) :: self
      type(refined_model_type), intent(in) :: refined
      real(dp), intent(in) :: temperature(:)             !! (nodes) of the new mesh [temperature]
      real(dp), intent(in) :: omega(:)                   !! (old contact points) conductance
      logical, intent(in) :: resting(:)                  !! (old contact points) whether it rests
      type(conductance_law_type) :: law(size(self%contact_state))
      real(dp) :: pressure
      integer :: k

      law = refined%points%laws_of(temperature, refined%points%jumps(temperature))
      do k = 1, size(self%contact_state)
         associate (points => refined%points, old => refined%old_point(k))
            pressure = 0.0_dp
            if (points%weight(k) > 0.0_dp) pressure = self%force(k)/points%weight(k)
            self%omega(k) = conductance(law(k), self%contact_state(k) /= contact_open, &
               self%gap(k), pressure)
            if (old == 0) cycle
            if (resting(old)) self%omega(k) = omega(old)
         end associate
      end do
   end subroutine conduct

   !> Heat of every contact point from slave to master.
   pure function heat(self, points, temperature) result(rates)
      class(refined_points_type), intent(in) :: self
      type(all_contact_points_type), intent(in) :: points !! the refined model's
      real(dp), intent(in) :: temperature(:)         !! (nodes) [temperature]
      real(dp) :: rates(size(self%contact_state))    !! (m) [power]

      rates = points%weight*self%omega*points%jumps(temperature)
   end function heat

end module refined_points
