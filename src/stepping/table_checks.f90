!> Tables of materials and of conductances that an increment leaves.
module table_checks
   use conductance_laws, only: law_by_temperature_type, law_clearance, law_none, law_pressure
   use connections, only: connections_type
   use contact_system, only: contact_open
   use element_kinds, only: element_node_count
   use kinds, only: dp
   use materials, only: follows_temperature, property_keywords
   use mesh_bodies, only: body_name
   use model, only: follows_temperatures, model_type
   use records, only: increment_record_type
   use text, only: to_text
   implicit none
   private
   public :: warn_of_tables

   real(dp), parameter :: margin = 1.0e-9_dp          !! of a table, that rounding may leave

contains

   !> Warns of temperatures beyond the first and last rows of tables of the bodies' materials, and
   !> of pressures, gaps and temperatures beyond those of conductances.
   subroutine warn_of_tables(model, points, record)
      type(model_type), intent(in) :: model
      type(connections_type), intent(in) :: points             !! of all interfaces
      type(increment_record_type), intent(inout) :: record     !! receives the warnings
      integer :: i

      if (follows_temperatures(model)) call warn_of_materials(model, record)
      do i = 1, size(record%contacts)
         if (allocated(record%contacts(i)%conductance)) call warn_of_law(model, i, &
            points%slave(points%interface_start(i):points%interface_start(i + 1) - 1), record)
      end do
   end subroutine warn_of_tables

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
            if (model%sections(model%mesh%element_section(e))%material == m) then
               is_of(model%mesh%element_nodes(:element_node_count(model%mesh%element_kind(e)), &
               e)) = .true.
            end if
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
               'held: temperature ', there, ' at node '// &
               to_text(model%mesh%node_number(node))//', time '//to_text(record%time)//'; '// &
               left(3:), severity=beyond)
         end associate
      end subroutine warn_of_end
   end subroutine warn_of_materials

   !> Those of the conductance of an interface.
   subroutine warn_of_law(model, i, slave, record)
      type(model_type), intent(in) :: model
      integer, intent(in) :: i                                 ! index of the interface
      integer, intent(in) :: slave(:)                          ! (m) slave nodes
      type(increment_record_type), intent(inout) :: record     ! receives the warnings
      type(law_by_temperature_type) :: by
      logical :: closed(size(slave)), opens(size(slave))
      real(dp) :: gap(size(slave)), mean(size(slave)), pressure(size(slave))

      associate (contact => record%contacts(i), &
         interaction => model%interactions(model%contacts(i)%interaction))
         associate (law => interaction%law)
            if (allocated(law%by_temperature)) by = law%by_temperature
            closed = contact%contact_state /= contact_open
            ! The open law at gap 0 is the closed one, or a part of it.
            opens = contact%conductance > 0.0_dp .and. &
               (.not. closed .or. law%closed_kind == law_none .or. law%closed_adds)
            closed = contact%conductance > 0.0_dp .and. closed
            gap = merge(0.0_dp, contact%gap, closed)
            pressure = contact%pressure
            mean = 0.5_dp*(contact%slave_temperature + contact%master_temperature)
            if (law%closed_kind == law_pressure) call judge('pressure', law%table_pressure, &
               columns_of(law%closed_omega, by%closed_columns), pressure, closed, .true.)
            if (law%open_kind == law_clearance) call judge('gap', law%table_gap, &
               columns_of(law%open_omega, by%open_columns), gap, opens, .not. law%open_ends)
            if (allocated(law%view_gap)) call judge('gap', law%view_gap, &
               reshape(law%view_factor, [size(law%view_gap), 1]), gap, opens, .true.)
         end associate
      end associate
      if (allocated(by%gas_temperature)) call judge('mean temperature', by%gas_temperature, &
         reshape([by%gas_a, by%gas_b], [size(by%gas_a), 2]), mean, opens, .true.)
      if (allocated(by%open_temperature)) call judge('mean temperature', by%open_temperature, &
         transpose(by%open_columns), mean, opens, .true.)
      if (allocated(by%closed_temperature)) call judge('mean temperature', &
         by%closed_temperature, transpose(by%closed_columns), mean, closed, .true.)
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

   !> A table in columns, one for each temperature.
   pure function columns_of(values, by_temperature) result(columns)
      real(dp), intent(in) :: values(:)                        ! (rows)
      !> (rows, columns) those of several temperatures; unallocated for one
      real(dp), allocatable, intent(in) :: by_temperature(:, :)
      real(dp), allocatable :: columns(:, :)

      columns = reshape(values, [size(values), 1])
      if (allocated(by_temperature)) columns = by_temperature
   end function columns_of

end module table_checks
