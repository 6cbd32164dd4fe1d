!> What the quantities of an increment would be on a mesh with divided elements, by a full
!> approximation scheme on two meshes: the fields of the new mesh are smoothed by a few steps of
!> conjugate gradients, and what then is out of balance there acts on the old mesh as a load, for
!> which the increment is solved again,
!>
!>    A_h(x') = A_h(R y) + P' (f - A(y)),   y' = y + P (x' - R y),
!>
!> P being the shape functions of the old mesh and R the values at its nodes. At rest y is the
!> solution on the new mesh, for which no factors were ever formed.
module refinement_error
   use all_contact_points, only: all_contact_points_type
   use balances, only: heat_residual
   use companion_steps, only: implicit_state, implicit_step
   use contact_operator, only: kept_contact, unstrained_forces
   use contact_quantities, only: estimated
   use contact_states, only: contact_open
   use cut_hats, only: joined_conductance
   use errors, only: error_type
   use heat_reduction, only: heat_reduction_type
   use increments, only: simulation_type
   use interface_quantities, only: contact_of, quantities_of, quantities_of_state
   use interruption, only: check_overdue
   use kinds, only: dp
   use linked_relaxation, only: joint_type, relax
   use model, only: model_type
   use held_points, only: find_held_directions
   use records, only: contact_record_type
   use reduced_bodies, only: reduced_bodies_type
   use refined_model, only: refined_model_type
   use refined_points, only: refined_points_type
   use solution_state, only: solution_state_type
   use sparse_matrix, only: sparse_matrix_type
   use steps, only: solves_heat, solves_mechanics, step_type
   use thermal_matrix, only: heat_across, heat_equation_type, heat_sources_type
   implicit none
   private
   public :: find_change_by_refinement

   !> Solutions of the increment: more than the least while they move a force, a heat rate or a
   !> pressure by so large a part of what they changed it by, and so large a part of it. The next
   !> one is expected to move it by no less than the first of these parts of what the last did.
   integer, parameter :: least_corrections = 3, most_corrections = 8
   real(dp), parameter :: moving = 0.25_dp, moving_value = 1.0e-4_dp
   integer, parameter :: smoothing_steps = 8        !! steps of conjugate gradients beside each

   !> The fields of both meshes as they are corrected.
   type :: corrected_type
      type(solution_state_type) :: coarse           !! solution on the old mesh
      real(dp), allocatable :: displacement(:)      !! (2 nodes) on the new one [length]
      real(dp), allocatable :: temperature(:)       !! (nodes) likewise [temperature]
      real(dp), allocatable :: elastic_force(:)     !! (2 nodes) of the displacements [force]
      real(dp), allocatable :: heat(:)              !! (nodes) out of balance [power]
      type(refined_points_type) :: points           !! its contact points
      logical, allocatable :: moves(:)              !! (2 nodes) displacements that are smoothed
      logical, allocatable :: warms(:)              !! (nodes) temperatures that are
      type(sparse_matrix_type) :: film              !! (nodes, nodes) F [power/temperature]
      type(sparse_matrix_type) :: conduction        !! (nodes, nodes) K + F [power/temperature]
   end type corrected_type

contains

   !> What the quantities of the interfaces change by on the refined mesh, at the end of a step, in
   !> the equilibrium of heat there.
   !> Error: the increment has no solution under one of the corrections, or a signal left no time.
   subroutine find_change_by_refinement(refined, simulation, model, previous, change, error)
      type(refined_model_type), intent(inout) :: refined
      type(simulation_type), intent(in) :: simulation            !! the run at the end
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(in) :: previous          !! state before the last increment
      real(dp), intent(out) :: change(:, :)                      !! (quantities, interfaces)
      type(error_type), allocatable, intent(out) :: error
      !> With the films at the end, where that of the run has others.
      type(heat_reduction_type) :: heat

      call correct_fields(refined, simulation, model, previous, heat, change, error)
      call heat%release()
   end subroutine find_change_by_refinement

   !> Corrects the fields of both meshes until nothing moves.
   !> Error: as above.
   subroutine correct_fields(refined, simulation, model, previous, heat, change, error)
      type(refined_model_type), intent(inout) :: refined
      type(simulation_type), intent(in) :: simulation
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(in) :: previous
      type(heat_reduction_type), intent(inout) :: heat
      real(dp), intent(out) :: change(:, :)
      type(error_type), allocatable, intent(out) :: error
      type(corrected_type) :: fields
      real(dp), dimension(size(change, 1), size(change, 2)) :: found, last, moved, values
      type(solution_state_type) :: before
      type(step_type) :: step
      logical :: moves
      integer :: k

      call begin(refined, simulation, model, previous, heat, fields, error)
      if (allocated(error)) return
      call quantities_of_state(simulation%bodies, fields%coarse, values)
      step = implicit_step(model%steps(simulation%control%step))
      before = previous
      found = values
      moved = 0.0_dp
      call smooth(refined, step, fields)
      do k = 1, most_corrections
         call check_overdue(error)
         if (allocated(error)) return
         ! The fixed point starts from the last solution; the implicit scheme takes nothing else
         ! of the conductances before.
         before%omega = fields%coarse%omega
         before%omega_before = fields%coarse%omega
         call correct(refined, simulation, model, step, before, heat, fields, error)
         if (allocated(error)) return
         call smooth(refined, step, fields)
         last = found
         call measure(refined, fields, found)
         call follow(values, last, found, moved, moves)
         if (k >= least_corrections .and. .not. moves) exit
      end do
      change = found - values
   end subroutine correct_fields

   !> Whether corrections still move anything but edges, which go from node to node.
   pure subroutine follow(values, last, found, moved, moves)
      real(dp), intent(in) :: values(:, :)    ! (quantities, interfaces) on the old mesh
      real(dp), intent(in) :: last(:, :)      ! before the last correction
      real(dp), intent(in) :: found(:, :)     ! after it
      real(dp), intent(inout) :: moved(:, :)  ! by what the next one may move them, at least
      logical, intent(out) :: moves
      integer :: q

      moves = .false.
      do q = 1, size(values, 1)
         if (estimated(q)%resolution > 0.0_dp) cycle
         moved(q, :) = max(abs(found(q, :) - last(q, :)), moving*moved(q, :))
         moves = moves .or. any(moved(q, :) > max(moving*abs(found(q, :) - values(q, :)), &
            moving_value*abs(values(q, :))))
      end do
   end subroutine follow

   !> Prolongs the solution on the old mesh, brought to the equilibrium of heat.
   !> Error: it has no solution there.
   subroutine begin(refined, simulation, model, previous, heat, fields, error)
      type(refined_model_type), intent(inout) :: refined
      type(simulation_type), intent(in) :: simulation
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(in) :: previous
      type(heat_reduction_type), intent(inout) :: heat
      type(corrected_type), intent(out) :: fields
      type(error_type), allocatable, intent(out) :: error
      type(heat_equation_type) :: equation

      associate (step => model%steps(simulation%control%step), loads => simulation%loads, &
         bodies => simulation%bodies)
         call refined%assemble(solves_mechanics(step%analysis), solves_heat(step%analysis), &
            allocated(bodies%thermal_load%value))
         call refined%load_to_end(simulation%control%step)
         call refined%points%enter_step(refined%model, simulation%control%step)
         fields%coarse = simulation%state
         call find_held_directions(refined%points, &
            refined%prolong_set(loads%displacement%active, 2))
         ! Sides where elements of two sizes meet move by the solutions on the old mesh alone, so
         ! that the fields stay continuous; so do contact points that no joint can keep.
         fields%moves = .not. (refined%prolong_set(loads%displacement%active, 2) .or. &
            refined%hangs(2))
         associate (nodes => [pack(refined%points%slave, refined%is_shared), &
            pack(refined%points%master, refined%is_shared)])
            fields%moves([2*nodes - 1, 2*nodes]) = .false.
         end associate
         if (solves_heat(step%analysis)) then
            fields%warms = .not. (refined%prolong_set(loads%temperature%active, 1) .or. &
               refined%hangs(1))
            fields%film = refined%loads%film_matrix()
            fields%conduction = refined%conduction_with(fields%film)
            equation = heat_equation_type(step%scheme)
            if (.not. equation%is_steady()) call implicit_state(simulation, heat, model, &
               implicit_step(step), previous, fields%coarse, error)
            if (allocated(error)) return
         end if
      end associate
      fields%displacement = refined%division%prolong(fields%coarse%displacement, 2)
      fields%temperature = refined%division%prolong(fields%coarse%temperature, 1)
      allocate (fields%heat, source=0.0_dp*fields%temperature)
      call fields%points%begin(refined, kept_contact(fields%coarse%contact, &
         fields%coarse%has_mechanics))
   end subroutine begin

   !> Smooths displacements and temperatures of the new mesh.
   subroutine smooth(refined, step, fields)
      type(refined_model_type), intent(in) :: refined
      type(step_type), intent(in) :: step
      type(corrected_type), intent(inout) :: fields
      type(joint_type), allocatable :: joints(:)
      real(dp), allocatable :: load(:), slip_forces(:)
      real(dp) :: residual(size(fields%displacement))

      associate (points => fields%points, u => fields%displacement, t => fields%temperature)
         call points%take_old(refined, kept_contact(fields%coarse%contact, &
            fields%coarse%has_mechanics))
         if (solves_mechanics(step%analysis)) then
            call points%mechanical_joints(refined, &
               refined%division%prolong(fields%coarse%displacement, 2), &
               joints)
            load = mechanical_load(refined, fields)
            slip_forces = points%slip_forces(refined)
            call relax(refined%stiffness, joints, load + slip_forces, fields%moves, &
               smoothing_steps, u, residual)
            fields%elastic_force = load + slip_forces - residual
            call points%update(refined, u, residual - slip_forces)
            call points%take_old(refined, fields%coarse%contact)
         end if
         if (solves_heat(step%analysis)) then
            call points%conduct(refined, t, fields%coarse%omega, fields%coarse%resting)
            call points%conducting_joints(refined, joints)
            call relax(fields%conduction, joints, refined%loads%heat_load(), fields%warms, &
               smoothing_steps, t, fields%heat)
         end if
      end associate
   end subroutine smooth

   !> Forces of loads, temperatures and initial stresses on the new mesh.
   function mechanical_load(refined, fields) result(forces)
      type(refined_model_type), intent(in) :: refined
      type(corrected_type), intent(in) :: fields
      real(dp) :: forces(size(fields%displacement))

      forces = refined%loads%nodal_forces()
      if (allocated(refined%thermal_load%value)) forces = forces + &
         refined%thermal_load%multiply(fields%temperature - refined%model%initial_temperature)
      if (allocated(refined%initial_force)) forces = forces + refined%initial_force
   end function mechanical_load

   !> Solves the increment on the old mesh with what is out of balance on the new one.
   subroutine correct(refined, simulation, model, step, previous, heat, fields, error)
      type(refined_model_type), intent(in) :: refined
      type(simulation_type), intent(in) :: simulation
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      type(solution_state_type), intent(in) :: previous
      type(heat_reduction_type), intent(inout) :: heat
      type(corrected_type), intent(inout) :: fields
      type(error_type), allocatable, intent(out) :: error
      type(solution_state_type) :: trial

      trial = fields%coarse
      associate (bodies => simulation%bodies, u => fields%displacement(:size(trial%displacement)), &
         t => fields%temperature(:size(trial%temperature)))
         if (solves_heat(step%analysis)) trial%sources%load = refined%restrict( &
            fields%heat, 1) + heat_taken(bodies, fields%coarse, t)
         ! Contact forces of both meshes do the same work and cancel.
         if (solves_mechanics(step%analysis)) trial%force_load = refined%restrict( &
            mechanical_load(refined, fields) - fields%elastic_force, 2) + &
            bodies%mechanical%matrix%multiply(u) - unstrained_forces(bodies, t)
      end associate
      call implicit_state(simulation, heat, model, step, previous, trial, error)
      if (allocated(error)) return
      fields%displacement = fields%displacement + refined%division%prolong(trial%displacement - &
         fields%displacement(:size(trial%displacement)), 2)
      fields%temperature = fields%temperature + refined%division%prolong(trial%temperature - &
         fields%temperature(:size(trial%temperature)), 1)
      fields%coarse = trial
   end subroutine correct

   !> K T + F T + what the contact points take, on the old mesh, with the conductances of its last
   !> solution.
   function heat_taken(bodies, coarse, temperature) result(heat)
      type(reduced_bodies_type), intent(in) :: bodies
      type(solution_state_type), intent(in) :: coarse
      real(dp), intent(in) :: temperature(:)
      real(dp) :: heat(size(temperature))
      type(all_contact_points_type) :: points
      type(heat_sources_type) :: sources

      points = coarse%cut%points_crossed(bodies%points)
      associate (t => temperature)
         sources%load = 0.0_dp*t
         sources%film = coarse%sources%film
         heat = heat_residual(bodies%thermal%matrix%multiply(t), sources%net_heat(t), points, &
            heat_across(points%weight, joined_conductance(coarse%omega, coarse%cut), &
            points%jumps(t)))
      end associate
   end function heat_taken

   !> The quantities on the new mesh.
   subroutine measure(refined, fields, values)
      type(refined_model_type), intent(in) :: refined
      type(corrected_type), intent(in) :: fields
      real(dp), intent(out) :: values(:, :)
      type(contact_record_type) :: contact
      real(dp) :: rates(size(refined%old_point))
      logical, allocatable :: closed(:)
      integer :: first, i, last

      rates = fields%points%heat(refined%points, fields%temperature)
      associate (points => fields%points)
         do i = 1, size(refined%interfaces)
            first = refined%points%interface_start(i)
            last = refined%points%interface_start(i + 1) - 1
            closed = points%contact_state(first:last) /= contact_open
            contact = contact_of(refined%interfaces(i), refined%points%friction(first), &
               points%contact_state(first:last), max(points%gap(first:last), 0.0_dp), &
               merge(points%force(first:last), 0.0_dp, closed), &
               merge(points%shear_force(first:last), 0.0_dp, closed), rates(first:last))
            ! What the old mesh lacks at open contact points, the new ones about them carry.
            contact%normal_force = sum(points%force(first:last))
            contact%shear_force = sum(points%shear_force(first:last))
            values(:, i) = quantities_of(refined%interfaces(i), contact)
         end do
      end associate
   end subroutine measure

end module refinement_error
