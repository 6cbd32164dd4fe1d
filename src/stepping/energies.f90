!> Work of friction, and of bodies that remember all energies and the work of loads. The work
!> of a load, an interference or a temperature in an increment is that of the mean of its force or
!> stress; what materials dissipate is in their histories.
module energies
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use connections, only: connections_type
   use friction_heating, only: slips
   use kinds, only: dp
   use material_laws, only: law_points_type
   use point_histories, only: point_history_type
   use model, only: model_type
   use quadrature, only: most => most_points_of_rule
   use records, only: increment_record_type
   use simulation, only: point_fields_type, simulation_type
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

   !> Records the work of friction up to the end of an increment that is to be accepted. Where
   !> bodies remember it adds that of loads, interferences and temperatures, and records all
   !> energies.
   subroutine measure_energies(run, model, next, record)
      type(simulation_type), intent(inout) :: run            !! at the start of the increment
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(inout) :: next       !! at its end
      type(increment_record_type), intent(inout) :: record
      type(point_fields_type) :: after
      real(dp) :: forces(2, size(next%temperature)), temperature(size(next%temperature))

      if (.not. allocated(next%work)) return
      if (.not. run%corrections%has_laws) then
         record%energies = spread(ieee_value(1.0_dp, ieee_quiet_nan), 1, 5)
         record%energies(4) = next%work(1)
         return
      end if
      forces = record%fields%external_force
      if (allocated(run%state%reaction)) forces = forces + run%state%reaction + on_nodes( &
         run%bodies%points%partners, reshape(run%state%force_load, shape(forces)))
      next%work(2) = next%work(2) + dot_product([forces], next%displacement - &
         run%state%displacement)/2 + work_of_overlaps(run%bodies%points, run%state, next)
      after = fields_of(run, model, next)
      temperature = model%initial_temperature
      if (allocated(run%state%stress_temperature)) temperature = run%state%stress_temperature
      if (any(abs(next%stress_temperature - temperature) > 0.0_dp)) then
         if (.not. allocated(run%point_fields%stress)) run%point_fields = fields_of(run, model, &
            run%state)
         ! On strains that temperatures free, and what elasticity that follows them adds.
         associate (before => run%point_fields)
            next%work(2) = next%work(2) + dot_product(after%volume, sum(after%stress* &
               before%elastic - before%stress*after%elastic - (before%stress + after%stress)* &
               (after%free - before%free), dim=1))/2
         end associate
      end if
      run%point_fields = after
      record%energies = [after%energies, next%work]
   end subroutine measure_energies

   !> Work of the pressures on the bodies as what keeps the faces of closed contact points apart
   !> changes: interferences, and overlaps of soft faces, which store what bodies lose.
   pure real(dp) function work_of_overlaps(points, before, after) result(work)
      type(connections_type), intent(in) :: points
      type(solution_state_type), intent(in) :: before, after   ! at both ends of the increment

      work = -dot_product(before%contact%force + after%contact%force, distance(after) - &
         distance(before))/2
   contains
      pure function distance(state)
         type(solution_state_type), intent(in) :: state
         real(dp) :: distance(size(points%slave))

         distance = max(state%contact%gap, 0.0_dp) + sum(points%relative(state%displacement)* &
            points%normal, dim=1)
      end function distance
   end function work_of_overlaps

   !> Fields of a state at all integration points, and its energies.
   function fields_of(run, model, state) result(found)
      type(simulation_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(in) :: state
      type(point_fields_type) :: found
      type(point_history_type) :: history
      type(law_points_type) :: points
      real(dp), dimension(size(state%temperature)) :: there, warming
      real(dp) :: u(2, size(state%temperature)), work(most, 2)
      integer :: e, g, p

      history%before = state%history
      history%after = state%history
      u = reshape(state%displacement, shape(u))
      there = model%initial_temperature
      if (allocated(state%stress_temperature)) there = state%stress_temperature
      warming = there - model%initial_temperature
      associate (mesh => model%mesh, fields => run%recovery%integration)
         call fields%set_temperature(mesh, there, model%initial_temperature)
         found%volume = fields%volume(:fields%first(size(fields%first)) - 1)
         allocate (found%stress(4, size(found%volume)), source=0.0_dp)
         found%elastic = found%stress
         found%free = found%stress
         do e = 1, size(mesh%element_kind)
            call fields%respond(mesh, e, u, warming, history, points)
            work = fields%inelastic_work(mesh, e, state%history)
            associate (rule => fields%rules(mesh%element_kind(e)))
               do g = 1, rule%count
                  p = fields%first(e) + g - 1
                  associate (material => fields%materials(fields%at_point(e, g)), &
                     nodes => mesh%element_nodes(:rule%nodes, e))
                     found%stress(:, p) = points%stress(g, :)
                     found%elastic(:, p) = matmul(material%compliance, found%stress(:, p))
                     found%free(:, p) = matmul(material%compliance, material%thermal_stress + &
                        material%thermal_modulus*dot_product(rule%shape(g, :rule%nodes), &
                        warming(nodes)))
                  end associate
                  found%energies = found%energies + found%volume(p)*[dot_product( &
                     found%stress(:, p), found%elastic(:, p))/2, work(g, :)]
               end do
            end associate
         end do
      end associate
   end function fields_of

end module energies
