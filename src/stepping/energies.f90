!> Energies of bodies that remember, and the work of loads and friction on the way to them. The work
!> of a load in an increment is that of its mean; what materials dissipate is in their histories.
module energies
   use friction_heating, only: slips
   use kinds, only: dp
   use material_laws, only: law_points_type
   use material_points, only: point_history_type
   use model, only: model_type
   use point_rules, only: most => most_points_of_rule
   use records, only: increment_record_type
   use simulation, only: simulation_type
   use solution_state, only: solution_state_type
   use transforms, only: on_nodes
   implicit none
   private
   public :: add_friction_work, measure_energies

contains

   !> Adds the work of friction in a stage to its state.
   pure subroutine add_friction_work(run, next)
      type(simulation_type), intent(in) :: run
      type(solution_state_type), intent(inout) :: next       !! at its end

      if (.not. allocated(next%work)) next%work = [0.0_dp, 0.0_dp]
      if (size(next%contact%gap) == 0) return
      next%work(1) = next%work(1) + abs(dot_product(next%contact%shear_force, &
         slips(run%bodies, next%contact)))
   end subroutine add_friction_work

   !> Adds the work of the loads in an increment, and records all energies at its end.
   subroutine measure_energies(run, model, next, record)
      type(simulation_type), intent(inout) :: run            !! at the start of the increment
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(inout) :: next       !! at its end
      type(increment_record_type), intent(inout) :: record
      real(dp) :: forces(2, size(next%temperature))

      forces = record%fields%external_force
      if (allocated(run%state%reaction)) forces = forces + run%state%reaction + on_nodes( &
         run%bodies%points%partners, reshape(run%state%force_load, shape(forces)))
      next%work(2) = next%work(2) + dot_product([forces], next%displacement - &
         run%state%displacement)/2
      record%energies = [energies_of(run, model, next), next%work]
   end subroutine measure_energies

   !> Energy that is stored, and dissipated by plasticity and by creep.
   function energies_of(run, model, state) result(energies)
      type(simulation_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(in) :: state
      real(dp) :: energies(3)
      type(point_history_type) :: history
      type(law_points_type) :: points
      real(dp) :: u(2, size(state%temperature)), warming(size(state%temperature))
      real(dp) :: work(most, 2)
      integer :: e, g

      energies = 0.0_dp
      history%before = state%history
      history%after = state%history
      u = reshape(state%displacement, shape(u))
      warming = state%stress_temperature - model%initial_temperature
      associate (mesh => model%mesh, fields => run%recovery%integration)
         call fields%set_temperature(mesh, state%stress_temperature, model%initial_temperature)
         do e = 1, size(mesh%element_kind)
            call fields%respond(mesh, e, u, warming, history, points)
            work = fields%inelastic_work(mesh, e, state%history)
            do g = 1, fields%rules(mesh%element_kind(e))%count
               associate (volume => fields%volume(fields%first(e) + g - 1), &
                  s => points%stress(g, :))
                  energies(1) = energies(1) + volume*dot_product(s, matmul(fields%materials( &
                     fields%at_point(e, g))%compliance, s))/2
                  energies(2:3) = energies(2:3) + volume*work(g, :)
               end associate
            end do
         end do
      end associate
   end function energies_of

end module energies
