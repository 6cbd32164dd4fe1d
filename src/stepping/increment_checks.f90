!> Checks that a solved increment must pass before it is accepted, and what it is warned of:
!> choices that the loads leave open; tables of materials and of conductances that it leaves;
!> temperatures that jump where a step that stores heat begins, on a mesh that is too coarse for its
!> increments. Beside these temperatures overshoot until the heat has crossed an element.
module increment_checks
   use conductance_laws, only: law_clearance, law_none, law_pressure
   use connections, only: connections_type
   use contact_system, only: contact_open
   use contact_workspace, only: contact_workspace_type
   use element_kinds, only: element_node_count
   use errors, only: check_finite, error_type, set_error, status_no_convergence
   use kinds, only: dp
   use materials, only: follows_temperature, heat_capacity, of_elasticity, of_expansion, &
      property_keywords
   use mesh_bodies, only: body_name
   use model, only: follows_temperatures, model_type
   use records, only: increment_record_type
   use simulation, only: simulation_type
   use solution_state, only: solution_state_type
   use steps, only: solves_heat, solves_mechanics
   use text, only: counted, to_text
   use unconstrained_bodies, only: unconstrained_now
   implicit none
   private
   public :: check_balance, check_record, check_values
   public :: note_shock, warn_of_choices, warn_of_tables

   real(dp), parameter :: sound_violation = 1.0e-6_dp !! largest violation of a sound state
   real(dp), parameter :: sound_imbalance = 1.0e-6_dp !! of heat and forces in discrete equations
   real(dp), parameter :: shock = 0.01_dp   !! part of the range of temperatures that is a jump
   real(dp), parameter :: crossing = 4.0_dp !! least useful increment: rho c h^2/(4 k)
   real(dp), parameter :: margin = 1.0e-9_dp   !! of a table, that rounding may leave

contains

   !> The values of an increment are numbers, its rates and forces balance, and contact keeps its
   !> conditions.
   !> Error: status_no_convergence, they do not.
   subroutine check_record(record, analysis, error)
      type(increment_record_type), intent(in) :: record
      integer, intent(in) :: analysis      !! one of the analysis_* constants of steps
      type(error_type), allocatable, intent(out) :: error

      call check_values(record, error)
      if (allocated(error)) return
      if (solves_heat(analysis)) call check_balance(record%heat_imbalance, 'heat rates', error)
      if (allocated(error) .or. .not. solves_mechanics(analysis)) return
      call check_balance(record%force_imbalance, 'forces', error)
      if (allocated(error) .or. record%contact_violation <= sound_violation) return
      call set_error(error, status_no_convergence, &
         'the recovered displacements violate the contact conditions by '// &
         to_text(record%contact_violation)//' of the largest displacement or force')
   end subroutine check_record

   !> The heat rates, or the forces, of the discrete equations balance.
   !> Error: they do not.
   subroutine check_balance(imbalance, what, error)
      real(dp), intent(in) :: imbalance    !! relative to the largest rate or force
      character(*), intent(in) :: what     !! 'heat rates' or 'forces'
      type(error_type), allocatable, intent(out) :: error

      if (imbalance <= sound_imbalance) return
      call set_error(error, status_no_convergence, 'the '//what//' are out of balance by '// &
         to_text(imbalance)//' of the largest: their rounding outweighs them; look for '// &
         'properties, sizes or values that are many orders of magnitude apart')
   end subroutine check_balance

   !> The fields and the contact state of an increment are numbers.
   !> Error: status_no_convergence, something overflowed.
   subroutine check_values(record, error)
      type(increment_record_type), intent(in) :: record
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      associate (fields => record%fields)
         call judge('temperatures', fields%temperature)
         call judge('heat fluxes', table=fields%heat_flux)
         if (allocated(fields%reaction_heat)) call judge('heat fluxes', [record%heat_imbalance])
         call judge('displacements and stresses', table=fields%stress)
         call judge('displacements and stresses', table=fields%displacement)
         call judge('displacements and stresses', table=fields%reaction)
      end associate
      do i = 1, size(record%contacts)
         associate (contact => record%contacts(i))
            call judge('gaps and pressures', [contact%gap, contact%pressure, contact%shear, &
               contact%slip])
         end associate
      end do
   contains
      !> Judges a list or a table; one that is not allocated is absent.
      subroutine judge(what, list, table)
         character(*), intent(in) :: what
         real(dp), intent(in), optional :: list(:), table(:, :)

         if (allocated(error)) return
         if (present(list)) call check_finite(list, what, status_no_convergence, error)
         if (present(table)) call check_finite([table], what, status_no_convergence, error)
      end subroutine judge
   end subroutine check_values

   !> Warns of what the loads leave open, once for as long as it stays: motions that nothing drives
   !> and nothing holds, contact states of which friction allows several.
   subroutine warn_of_choices(run, model, contact, next, undecided, record)
      type(simulation_type), intent(in) :: run                  !! with supports of the increment
      type(model_type), intent(in) :: model
      type(contact_workspace_type), intent(in) :: contact       !! of the solution
      type(solution_state_type), intent(in) :: next             !! state at its end
      character(:), allocatable, intent(inout) :: undecided     !! what was last warned of
      type(increment_record_type), intent(inout) :: record      !! receives the warning
      character(:), allocatable :: free, words

      words = ''
      if (contact%several) words = &
         'with so much friction other contact states satisfy all conditions, too'
      if (contact%unconstrained%count > 0 .or. any(next%idle)) then
         free = unconstrained_now(model, run%bodies%points, &
            run%bodies%laws%friction%coefficient > 0.0_dp, run%loads%displacement%active, &
            merge(contact_open, next%contact%contact_state, next%idle .or. next%resting))
         if (len(free) > 0) words = free(3:)//'; no load drives it: the smallest movement is used'
      end if
      if (words /= undecided .and. len(words) > 0) call record%warn(words)
      undecided = words
   end subroutine warn_of_choices

   !> Notes the least increment that does not overshoot beside nodes whose temperature jumps, in the
   !> smallest elements there, and warns of nodes where elements need a longer one. Elements without
   !> midside nodes have lumped capacities and do not overshoot.
   pure subroutine note_shock(model, jump, increment_size, record)
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: jump(:)              !! (nodes) of temperatures [temperature]
      real(dp), intent(in) :: increment_size       !! of the first increment [time]
      type(increment_record_type), intent(inout) :: record   !! of it; receives both
      logical :: jumps(size(jump)), is_coarse(size(jump))
      real(dp) :: least, largest, size_across
      integer :: e, i

      associate (temperature => record%fields%temperature, used => model%mesh%node_body > 0)
         jumps = abs(jump) > shock*max(maxval(abs(jump)), maxval(temperature, mask=used) - &
            minval(temperature, mask=used))
      end associate
      is_coarse = .false.
      largest = 0.0_dp
      do e = 1, size(model%mesh%element_kind)
         associate (nodes => model%mesh%element_nodes(:element_node_count( &
            model%mesh%element_kind(e)), e), x => model%mesh%coordinates, material => &
            model%materials(model%sections(model%mesh%element_section(e))%material))
            if (size(nodes) <= 4 .or. .not. any(jumps(nodes)) .or. all(jumps(nodes))) cycle
            size_across = maxval([(minval(norm2(x(:, nodes) - spread(x(:, nodes(i)), 2, &
               size(nodes)), dim=1), mask=jumps(nodes)), i=1, size(nodes))])
            least = heat_capacity(material)*size_across**2/(crossing*maxval(material%conductivity))
            if (record%useful_increment <= 0.0_dp) record%useful_increment = least
            record%useful_increment = min(record%useful_increment, least)
            if (increment_size >= least) cycle
            is_coarse(nodes) = is_coarse(nodes) .or. jumps(nodes)
            largest = max(largest, least)
         end associate
      end do
      if (.not. any(is_coarse)) return
      call record%warn('temperatures jump at '//counted(count(is_coarse), 'node')//', such as '// &
         to_text(model%mesh%node_number(findloc(is_coarse, .true., dim=1)))//', where elements '// &
         'are so large that temperatures beside them overshoot within '//to_text(largest)// &
         '; refine the mesh there, or take increments of at least this')
   end subroutine note_shock

   !> Warns of temperatures beyond the first and last rows of tables of the bodies' materials, of
   !> pressures, gaps and temperatures beyond those of conductances, and of gaps beside melts.
   subroutine warn_of_tables(model, points, record)
      type(model_type), intent(in) :: model
      type(connections_type), intent(in) :: points             !! of all interfaces
      type(increment_record_type), intent(inout) :: record     !! receives the warnings
      integer :: i

      if (follows_temperatures(model)) call warn_of_materials(model, record)
      do i = 1, size(record%contacts)
         associate (slave => points%slave(points%interface_start(i): &
            points%interface_start(i + 1) - 1))
            if (.not. allocated(record%contacts(i)%conductance)) cycle
            call warn_of_law(model, i, slave, record)
            if (any(model%materials%law%annealing > 0)) call warn_of_melt(model, i, slave, record)
         end associate
      end do
   end subroutine warn_of_tables

   !> Warns of a gap beside a melt, which would follow the other face, but is computed as a solid
   !> that resists little.
   subroutine warn_of_melt(model, i, slave, record)
      type(model_type), intent(in) :: model
      integer, intent(in) :: i                                 ! index of the interface
      integer, intent(in) :: slave(:)                          ! (m) slave nodes
      type(increment_record_type), intent(inout) :: record     ! receives the warning
      logical :: is_beside(size(slave))
      integer :: k

      associate (contact => record%contacts(i), pair => model%contacts(i))
         is_beside = contact%contact_state == contact_open .and. (contact%slave_temperature > &
            solid_below(pair%slave) .or. contact%master_temperature > solid_below(pair%master)) &
            .and. contact%gap > margin*maxval(abs(model%mesh%coordinates))
         if (.not. any(is_beside)) return
         k = maxloc(contact%gap, dim=1, mask=is_beside)
         call record%warn('contact pair '//pair%name//' opens where a face is above its '// &
            '*ANNEAL TEMPERATURE: a melt would follow the other face, so that too little heat '// &
            'crosses there: gap ', contact%gap(k), ' at slave node '// &
            to_text(model%mesh%node_number(slave(k)))//', time '//to_text(record%time), &
            severity=contact%gap(k))
      end associate
   contains
      !> Annealing temperature of the elements at a surface.
      pure real(dp) function solid_below(surface)
         integer, intent(in) :: surface           ! index

         solid_below = huge(1.0_dp)
         if (.not. allocated(model%mesh%surfaces(surface)%faces)) return
         associate (elements => model%mesh%surfaces(surface)%faces(1, :))
            if (size(elements) > 0) solid_below = minval(model%materials(model%sections( &
               model%mesh%element_section(elements))%material)%law%anneal_temperature)
         end associate
      end function solid_below
   end subroutine warn_of_melt

   !> Those of materials.
   subroutine warn_of_materials(model, record)
      type(model_type), intent(in) :: model
      type(increment_record_type), intent(inout) :: record     ! receives the warnings
      logical :: is_of(size(model%mesh%node_number))
      integer :: e, i, m

      do m = 1, size(model%materials)
         if (.not. follows_temperature(model%materials(m))) cycle
         is_of = .false.
         do e = 1, size(model%mesh%element_kind)
            if (model%sections(model%mesh%element_section(e))%material == m) is_of( &
               model%mesh%element_nodes(:element_node_count(model%mesh%element_kind(e)), e)) = &
               .true.
         end do
         if (.not. any(is_of)) cycle
         associate (t => record%fields%temperature)
            call warn_of_end(minloc(t, dim=1, mask=is_of), -1.0_dp, ' below their first rows')
            call warn_of_end(maxloc(t, dim=1, mask=is_of), 1.0_dp, ' above their last rows')
         end associate
      end do
   contains
      subroutine warn_of_end(node, side, where)
         integer, intent(in) :: node
         real(dp), intent(in) :: side
         character(*), intent(in) :: where
         character(:), allocatable :: left
         real(dp) :: row, beyond

         left = ''
         beyond = 0.0_dp
         associate (material => model%materials(m), there => record%fields%temperature(node))
            do i = 1, size(material%given)
               ! Of what has no stress these two do nothing.
               if (any(material%given(i)%kind == [of_elasticity, of_expansion]) .and. (.not. any( &
                  solves_mechanics(model%steps%analysis)) .or. there >= &
                  material%law%anneal_temperature)) cycle
               associate (rows => material%given(i)%temperature)
                  row = rows(merge(size(rows), 1, side > 0.0_dp))
                  if (size(rows) == 1 .or. side*(there - row) <= margin*(maxval(rows) - &
                     minval(rows))) cycle
               end associate
               left = left//', *'//trim(property_keywords(material%given(i)%kind))//' ('// &
                  to_text(row)//')'
               beyond = max(beyond, side*(there - row))
            end do
            if (len(left) > 0) call record%warn(body_name(model, model%mesh%node_body(node))// &
               ' leaves the tables of '//material%name//where//', and their values there are '// &
               'held: temperature ', there, ' at node '//to_text(model%mesh%node_number(node))// &
               ', time '//to_text(record%time)//'; '//left(3:), severity=beyond)
         end associate
      end subroutine warn_of_end
   end subroutine warn_of_materials

   !> Those of the conductance of an interface.
   subroutine warn_of_law(model, i, slave, record)
      type(model_type), intent(in) :: model
      integer, intent(in) :: i                                 ! index of the interface
      integer, intent(in) :: slave(:)                          ! (m) slave nodes
      type(increment_record_type), intent(inout) :: record     ! receives the warnings
      logical :: closed(size(slave)), opens(size(slave))
      real(dp) :: gap(size(slave)), mean(size(slave)), pressure(size(slave))

      associate (contact => record%contacts(i), &
         interaction => model%interactions(model%contacts(i)%interaction))
         associate (law => interaction%law, by => interaction%law%by_temperature)
            closed = contact%contact_state /= contact_open
            ! The open law at gap 0 is the closed one, or a part of it.
            opens = contact%conductance > 0.0_dp .and. &
               (.not. closed .or. law%closed_kind == law_none .or. law%closed_adds)
            closed = contact%conductance > 0.0_dp .and. closed
            gap = merge(0.0_dp, contact%gap, closed)
            pressure = contact%pressure
            mean = 0.5_dp*(contact%slave_temperature + contact%master_temperature)
            if (law%closed_kind == law_pressure) call judge('pressure', law%closed_table%abscissa, &
               law%closed_table%columns, pressure, closed, .true.)
            if (law%open_kind == law_clearance) call judge('gap', law%open_table%abscissa, &
               law%open_table%columns, gap, opens, .not. law%open_ends)
            if (allocated(law%view_gap)) call judge('gap', law%view_gap, &
               reshape(law%view_factor, [size(law%view_gap), 1]), gap, opens, .true.)
            if (allocated(by%gas_temperature)) call judge('mean temperature', by%gas_temperature, &
               reshape([by%gas_a, by%gas_b], [size(by%gas_a), 2]), mean, opens, .true.)
            if (allocated(law%open_table%temperature)) call judge('mean temperature', &
               law%open_table%temperature, transpose(law%open_table%columns), mean, opens, .true.)
            if (allocated(law%closed_table%temperature)) call judge('mean temperature', &
               law%closed_table%temperature, transpose(law%closed_table%columns), mean, closed, &
               .true.)
         end associate
      end associate
   contains
      !> Judges the contact points that are farthest out of the rows of a table.
      subroutine judge(noun, rows, values, at, counts, holds_last)
         character(*), intent(in) :: noun         ! what it is over
         real(dp), intent(in) :: rows(:)          ! ascending
         real(dp), intent(in) :: values(:, :)     ! (rows, columns)
         real(dp), intent(in) :: at(:)            ! (m) as the rows
         logical, intent(in) :: counts(:)         ! (m) points that conduct by it
         logical, intent(in) :: holds_last        ! whether the last value is held beyond

         real(dp) :: beyond
         integer :: k, next, row, way

         if (size(rows) == 1 .or. .not. any(counts)) return
         do way = -1, merge(1, -1, holds_last), 2
            row = merge(1, size(rows), way < 0)
            next = row - way
            k = maxloc(way*at, dim=1, mask=counts)
            beyond = way*(at(k) - rows(row))
            if (beyond <= margin*(rows(size(rows)) - rows(1))) cycle
            ! A table that is level there, or has come down to 0, goes on so.
            if (all(abs(values(row, :) - values(next, :)) <= 0.0_dp)) cycle
            if (all(abs(values(row, :)) <= 0.0_dp)) cycle
            call record%warn('contact pair '//model%contacts(i)%name//' leaves a table of '// &
               model%interactions(model%contacts(i)%interaction)%name// &
               trim(merge(' below its first', ' above its last ', way < 0))//' '//noun//', '// &
               to_text(rows(row))//', and the conductance there is held: '//noun//' ', at(k), &
               ' at slave node '//to_text(model%mesh%node_number(slave(k)))//', time '// &
               to_text(record%time), severity=beyond)
         end do
      end subroutine judge
   end subroutine warn_of_law

end module increment_checks
