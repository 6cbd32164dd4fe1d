!> The result file `NAME.vtkhdf` of a run, with its `.sta` and `.cvg`.
!>
!> Increments gather in memory and are published together: the file in the making is closed and
!> renamed over the one in place, then their lines go to `.sta`. So a killed run leaves a file that
!> opens and holds every increment of its `.sta`. A run publishes the end of every step and its own
!> end, and in between whenever that costs less than a tenth of the time, or an increment was long.
!> The first publishing replaces the files of an earlier run. A draft publishes its end only.
module results
   use accuracy_rounds, only: accuracy_rounds_type
   use contact_definitions, only: makes_friction_heat, pairing_name
   use contact_points, only: contact_points_type
   use contact_quantities, only: estimated
   use due_output, only: ends_run, fields_are_due
   use errors, only: error_type
   use field_quantities, only: maxima
   use file_calls, only: identity_of, remove_file, rename_file, try_file
   use growing_datasets, only: bytes_in, flush_sets, write_integers
   use history_results, only: history_results_type
   use materials, only: heats_by_work, melts, of_expansion, reference_nodes
   use increment_quantities, only: history_estimated
   use result_tables, only: result_table_type, with_uncertainty, write_geometry, &
      write_rigid_surfaces
   use equations, only: section_nodes
   use hdf5_writer, only: as_integer, end_hdf5, hdf5_writer_type, start_hdf5
   use kinds, only: dp, long
   use mesh_bodies, only: body_name
   use model, only: has_friction, model_type, uncertainty_full
   use no_estimates, only: no_reason, reason_count, reason_inside_step, reason_of_run, &
      words_of_reason
   use quantity_types, only: needs_branch, needs_coupling, needs_creep, needs_dilatation, &
      needs_friction, needs_friction_heat, needs_heat, needs_laws, needs_mechanics, needs_melting, &
      needs_nothing, needs_plasticity, needs_references, needs_sections, needs_stability, &
      needs_storage, needs_temperature, needs_wear, last_need, of_bodies, of_contact_points, &
      of_history, of_interface, of_motions, of_passes, of_references, of_sections, quantity_type
   use records, only: increment_record_type
   use reported_quantities, only: datasets, geometry
   use accuracy_lines, only: write_accuracy
   use restart_results, only: restart_results_type
   use result_fields, only: cell_sets, contact_grid_type, field_results_type, interface_sets, &
      node_sets
   use run_summaries, only: run_summary_type, write_run
   use state_tables, only: integers, state_table_type
   use status_files, only: status_file_type
   use steps, only: dof_temperature, planned_increments, solves_heat, solves_mechanics
   use clock, only: wall_seconds
   use text, only: or_blank, string_type, to_text
   use unit_labels, only: unit_in_words
   use working_files, only: working_file_type
   implicit none
   private
   public :: results_type

   type(quantity_type), parameter :: step_time = quantity_type('time', of_history, 'time', &
      description='total time at the end of the step (with ERRORS=FULL, of the increment)')
   integer, parameter :: history = 1, convergence = 2, stability = 3   !! tables
   character(*), parameter :: contact_end = '.contact.vtkhdf', end_of_name = '.vtkhdf'
   character(*), parameter :: earlier = '.earlier'   !! before the end of the name
   integer(long), parameter :: memory_limit = 67108864_long   !! bytes that may wait in memory

   !> Writer of the results of one run.
   type :: results_type
      private
      type(working_file_type), public :: file                         !! the result file
      type(status_file_type) :: increments                    !! `.sta`
      type(status_file_type) :: passes                        !! `.cvg`
      type(field_results_type) :: fields                      !! `/VTKHDF`
      type(restart_results_type) :: restarts                  !! `/restart`
      type(history_results_type), public :: histories         !! of sets, in `/history`
      !> `/history`, `/convergence`, `/stability`, `/contact/<name>` of each interface, then, where
      !> uncertainties are estimated, `/uncertainty` and `/uncertainty/<name>` of each interface,
      !> each body and, with ERRORS=FULL, the increment
      type(result_table_type), allocatable :: tables(:)
      type(working_file_type) :: contact_file                 !! `NAME.contact.vtkhdf`
      type(contact_grid_type) :: contact_grid                 !! its contents
      logical, public :: has_contact = .false.                !! whether there is such a file
      integer, allocatable :: element_points(:, :)            !! (8, elements)
      type(string_type), allocatable :: cards(:)              !! card images
      !> Contact points of every interface where the run began, for what is written once
      type(contact_points_type), allocatable :: interfaces(:)
      logical :: is_draft = .false.                           !! whether only its end is published
      logical :: is_broken = .false.                          !! whether writing has failed
      integer, public :: accepted = 0                         !! increments appended
      integer, public :: published = 0                        !! of these, in the file in place
   contains
      procedure :: reserve
      procedure :: open => open_results
      procedure :: go_on
      procedure :: append
      procedure :: take_passes
      procedure :: finish
      procedure :: give_up
      procedure :: set_aside
   end type results_type

contains

   !> Names the files and tries whether all of them can be written; they are left as they are.
   !> Error: status_internal, when one of them cannot.
   subroutine reserve(self, path, is_draft, has_lock, error)
      class(results_type), intent(inout) :: self          !! the writer
      character(*), intent(in) :: path                    !! path of the results without extension
      logical, intent(in) :: is_draft                     !! whether only their end is published
      logical, intent(in) :: has_lock                     !! whether no other run writes them
      type(error_type), allocatable, intent(out) :: error !! what went wrong

      self%is_draft = is_draft
      call self%file%start(path//end_of_name)
      call self%contact_file%start(path//contact_end)
      call self%increments%start_increments(path//'.sta')
      call self%passes%start_iterations(path//'.cvg')
      call try_file(path//'.sta', error)
      if (allocated(error)) return
      call try_file(path//'.cvg', error)
      if (allocated(error)) return
      call self%file%reserve(has_lock, error)
      if (allocated(error)) return
      call self%contact_file%reserve(has_lock, error)
   end subroutine reserve

   !> Gives the files of an earlier run, which this one does not replace, other names.
   subroutine set_aside(self, path, moved)
      class(results_type), intent(in) :: self
      character(*), intent(in) :: path                    !! path of the results without extension
      logical, intent(out) :: moved                       !! whether there were any
      character(*), parameter :: ends(3) = [character(len(contact_end)) :: end_of_name, &
         contact_end, '.sta']
      type(error_type), allocatable :: error
      logical :: is_there
      integer :: i

      moved = .false.
      if (self%accepted > 0 .or. self%is_draft) return
      do i = 1, size(ends)
         inquire (file=path//trim(ends(i)), exist=is_there)
         if (.not. is_there) cycle
         call rename_file(path//trim(ends(i)), path//earlier//trim(ends(i)), error)
         moved = moved .or. .not. allocated(error)
      end do
   end subroutine set_aside

   !> Prepares the results of a run, whose files are reserved; none is touched yet.
   !> Error: status_internal, when HDF5 does not start.
   subroutine open_results(self, model, interfaces, point_node, element_points, cards, error)
      class(results_type), intent(inout) :: self          !! the writer
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      integer, intent(in) :: point_node(:)                !! (points) node index of each point
      integer, intent(in) :: element_points(:, :)         !! (8, elements) points, like the nodes
      type(string_type), intent(in) :: cards(:)           !! card images as read
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      type(quantity_type), allocatable :: along_z(:), leading(:), of_cuts(:), &
         of_history_alone(:), of_stability(:)
      logical :: has(0:last_need)
      integer :: bodies, i, expected, n

      call start_hdf5(error)
      if (allocated(error)) return
      self%file%content%labels = model%units
      self%contact_file%content%labels = model%units
      self%element_points = element_points
      self%cards = cards
      self%interfaces = interfaces
      has = what_is_solved(model, size(interfaces) > 0)
      n = size(interfaces)
      expected = max(1, nint(min(sum(min(planned_increments(model%steps), &
         real(model%steps%max_increments, dp))), 1.0e6_dp)))
      call self%fields%start(model, interfaces, point_node, has, expected)
      call self%histories%start(model, expected)
      self%has_contact = n > 0
      if (self%has_contact) call self%contact_grid%start_grid(datasets(of_contact_points, has), &
         [quantity_type ::], sum([(size(interfaces(i)%slave), i=1, n)]), 0, expected)
      bodies = merge(model%mesh%body_count, 0, reason_of_run(model) == no_reason)
      allocate (self%tables(4 + 2*n + bodies + merge(1, 0, is_full(model))))
      associate (tables => self%tables, steps => size(model%steps))
         of_stability = datasets(of_history, has)
         of_history_alone = pack(of_stability, of_stability%needs /= needs_stability)
         of_stability = pack(of_stability, of_stability%needs == needs_stability)
         leading = datasets(of_motions, has)
         leading%values = maxval([0, model%steps%stability_modes])
         if (size(of_stability) > 0) of_stability = [of_history_alone(1), of_stability, leading]
         call tables(stability)%start('/stability', of_stability, 0, expected)
         of_cuts = datasets(of_sections, has)
         of_cuts%values = size(section_nodes(model%couplings))
         along_z = datasets(of_references, has)
         along_z%values = size(reference_nodes(model%sections))
         call tables(history)%start('/history', [of_history_alone, of_cuts, along_z, &
            datasets(of_bodies, has)], model%mesh%body_count, expected)
         call tables(convergence)%start('/convergence', datasets(of_passes, has), 0, 8*expected)
         do i = 1, n
            call tables(3 + i)%start('/contact/'//interfaces(i)%name, [datasets(of_contact_points, &
               has), datasets(of_interface, has)], size(interfaces(i)%slave), expected)
         end do
         call tables(4 + n)%start('/uncertainty', [step_time], 0, steps)
         do i = 1, n
            call tables(4 + n + i)%start('/uncertainty/'//interfaces(i)%name, &
               with_uncertainty(estimated), 0, steps)
         end do
         do i = 1, bodies
            call tables(4 + 2*n + i)%start('/uncertainty/body '//to_text(i), with_uncertainty( &
               pack(maxima, has(maxima%needs) .or. maxima%needs /= needs_laws)), 0, steps)
         end do
         if (is_full(model)) call tables(size(tables))%start('/uncertainty/increment', &
            with_uncertainty(pack(history_estimated, has(history_estimated%needs) .or. &
            history_estimated%needs /= needs_melting)), 0, steps)
      end associate
   end subroutine open_results

   !> Goes on behind an earlier result up to where a state of it was kept: what it holds behind that
   !> is dropped. The files in place stay as they are until the first publishing.
   !> Error: status_internal, when a file cannot be written.
   subroutine go_on(self, path, restart, counts, model, error)
      class(results_type), intent(inout) :: self          !! the writer, opened
      character(*), intent(in) :: path                    !! of the earlier result, with its end
      type(state_table_type), intent(inout) :: restart    !! that state, to be restored
      integer, intent(in) :: counts(2)                    !! restarts up to it, their values
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      character(:), allocatable :: stem
      integer, allocatable :: rows(:)
      integer :: i, k
      logical :: is_new

      call integers(restart, 'rows', rows)
      self%accepted = rows(1)
      if (identity_of(self%file%path) == identity_of(path)) self%published = self%accepted
      stem = path(:len(path) - len(end_of_name))
      self%file%source = path
      call self%file%open(is_new)
      associate (file => self%file%content)
         do i = 1, size(self%tables)
            if (size(self%tables(i)%sets) == 0) cycle
            ! Steps that are new may be the first to have such rows.
            if (.not. file%has(self%tables(i)%group)) call file%create_group(self%tables(i)%group)
            do k = 1, size(self%tables(i)%sets)
               call self%tables(i)%sets(k)%go_on(file, rows(2 + i))
            end do
         end do
         call self%fields%go_on(file, rows(2))
         call self%histories%go_on(file, rows(3 + size(self%tables):))
         call self%restarts%go_on(file, restart, counts)
         call file%remove('/uncertainty/reasons')
         call write_reasons(file, model)
         call file%remove('/deck')
         call file%write('/deck', self%cards, 'card images as read')
      end associate
      call self%file%check(error)
      if (self%has_contact .and. .not. allocated(error)) then
         self%contact_file%source = stem//contact_end
         call self%contact_file%open(is_new)
         call self%contact_grid%go_on(self%contact_file%content, self%accepted)
         call self%contact_file%check(error)
      end if
      call self%increments%go_on(stem//'.sta', self%accepted)
      call self%passes%go_on(stem//'.cvg', self%accepted)
      if (allocated(error)) call self%give_up()
   end subroutine go_on

   !> Adds an accepted increment, whose tables `histories` has; publishes where that is due. The
   !> last increment of the last step waits for `finish`.
   !> Error: status_internal, when a file cannot be written.
   subroutine append(self, record, model, interfaces, run, error, restart)
      class(results_type), intent(inout) :: self          !! the writer
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(run_summary_type), intent(in) :: run           !! the run so far
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      !> Of the run, where one is due; receives the rows of all datasets
      type(state_table_type), intent(inout), optional :: restart
      integer, allocatable :: rows(:)
      logical :: is_due
      integer :: i, n

      self%accepted = self%accepted + 1
      call self%tables(history)%append(record)
      call self%increments%add_increment(record)
      if (allocated(record%stability)) call self%tables(stability)%append(record)
      call self%take_passes(record)
      do i = 1, size(interfaces)
         call self%tables(3 + i)%append(record, i)
      end do
      if (self%has_contact) call self%contact_grid%append(record)
      if (allocated(record%uncertainties)) then
         n = size(interfaces)
         call self%tables(4 + n)%append(record)
         do i = 1, n
            call self%tables(4 + n + i)%append(record%uncertainties(:, i))
         end do
         do i = 1, merge(size(record%body_uncertainties), 0, reason_of_run(model) == no_reason)
            call self%tables(4 + 2*n + i)%append(record%body_uncertainties(i)%maxima)
         end do
         if (allocated(record%history_uncertainties)) call self%tables(size(self%tables))% &
            append(record%history_uncertainties)
      end if
      if (fields_are_due(record, model)) call self%fields%append(record, interfaces)
      if (present(restart)) then
         rows = [self%accepted, self%fields%increments, (self%tables(i)%rows(), &
            i=1, size(self%tables)), self%histories%rows()]
         call integers(restart, 'rows', rows)
         call self%restarts%append(record, restart, model%steps(record%step)%overlays_restarts)
         self%file%is_synced = .true.
         self%contact_file%is_synced = .true.
      end if
      is_due = self%file%is_due()
      if ((record%last_of_step .or. is_due) .and. .not. (ends_run(record, model) .or. &
         self%is_draft)) then
         call publish(self, model, interfaces, run, error)
      else if (waiting_bytes(self) > memory_limit) then
         call flush_all(self, model)
         call self%file%check(error)
         if (.not. allocated(error)) call self%contact_file%check(error)
      end if
      if (allocated(error)) call self%give_up()
   end subroutine append

   !> Adds the passes of an increment, of one that failed, too.
   subroutine take_passes(self, record)
      class(results_type), intent(inout) :: self          !! the writer
      type(increment_record_type), intent(in) :: record

      if (.not. allocated(record%iterations)) return
      if (size(record%iterations) > 0) call self%tables(convergence)%append(record)
      call self%passes%add_iterations(record%iterations)
   end subroutine take_passes

   !> Publishes what is left and ends HDF5. Without any accepted increment the files of an earlier
   !> run stay, but for `.cvg`, which then holds the iterations that failed.
   !> Error: status_internal, when a file cannot be written.
   subroutine finish(self, model, interfaces, run, accuracy, error)
      class(results_type), intent(inout) :: self          !! the writer
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(run_summary_type), intent(in) :: run           !! the whole run
      type(accuracy_rounds_type), intent(in) :: accuracy
      type(error_type), allocatable, intent(out) :: error !! what went wrong

      if (self%is_broken) return
      if (self%accepted > 0) then
         call publish(self, model, interfaces, run, error, accuracy)
      else
         call self%passes%empty(error)
         if (.not. allocated(error)) call self%passes%write_waiting(error)
      end if
      if (allocated(error)) then
         call self%give_up()
      else
         call self%increments%close()
         call self%passes%close()
         call end_hdf5()
      end if
   end subroutine finish

   !> Leaves the file in place as it is: what could not be written whole is dropped, and nothing
   !> more is written.
   subroutine give_up(self)
      class(results_type), intent(inout) :: self          !! the writer

      self%is_broken = .true.
      call self%file%discard()
      call self%contact_file%discard()
      call self%increments%close()
      call self%passes%close()
   end subroutine give_up

   !> Fields that the steps of a deck solve, by needs_*.
   pure function what_is_solved(model, has_contact) result(has)
      type(model_type), intent(in) :: model
      logical, intent(in) :: has_contact
      logical :: has(0:last_need)

      associate (analysis => model%steps%analysis)
         has(needs_nothing) = .true.
         has(needs_heat) = any(solves_heat(analysis))
         has(needs_temperature) = has(needs_heat) .or. any(model%materials%has(of_expansion))
         has(needs_mechanics) = any(solves_mechanics(analysis))
         has(needs_storage) = any(model%steps%is_transient)
         has(needs_dilatation) = any(model%steps%dilates .or. model%steps%is_transient .and. &
            any(heats_by_work(model%materials)))
         has(needs_stability) = any(model%steps%stability_frequency > 0)
         has(needs_branch) = any(model%steps%continuation%is_on)
         has(needs_sections) = has(needs_mechanics) .and. size(section_nodes(model%couplings)) > 0
         has(needs_references) = has(needs_mechanics) .and. any(model%sections%reference(1) > 0)
         has(needs_plasticity) = has(needs_mechanics) .and. any(model%materials%law%strains(1) > 0)
         has(needs_creep) = has(needs_mechanics) .and. any(model%materials%law%strains(2) > 0)
         has(needs_laws) = has(needs_plasticity) .or. has(needs_creep)
         has(needs_friction) = has(needs_laws) .or. (has(needs_mechanics) .and. has_friction(model))
         has(needs_melting) = has(needs_heat) .and. any(melts(model%materials))
         has(needs_friction_heat) = has(needs_heat) .and. makes_friction_heat( &
            model%interactions, model%contacts)
         has(needs_wear) = has(needs_mechanics) .and. &
            any(model%interactions(model%contacts%interaction)%wear%wears())
         has(needs_coupling) = has_contact .and. any(solves_heat(analysis) .and. &
            solves_mechanics(analysis))
      end associate
   end function what_is_solved

   pure integer(long) function waiting_bytes(self) result(bytes)
      class(results_type), intent(in) :: self
      integer :: i

      bytes = bytes_in(self%fields%sets) + self%histories%bytes()
      if (self%has_contact) bytes = bytes + bytes_in(self%contact_grid%sets)
      do i = 1, size(self%tables)
         bytes = bytes + bytes_in(self%tables(i)%sets)
      end do
      if (allocated(self%restarts%sets)) bytes = bytes + bytes_in(self%restarts%sets)
   end function waiting_bytes

   subroutine publish(self, model, interfaces, run, error, accuracy)
      class(results_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:)
      type(run_summary_type), intent(in) :: run
      type(error_type), allocatable, intent(out) :: error
      type(accuracy_rounds_type), intent(in), optional :: accuracy   ! at the end of the run
      type(run_summary_type) :: until_now
      real(dp) :: since
      logical :: is_first

      since = wall_seconds()
      is_first = .not. self%file%in_place
      call flush_all(self, model)
      until_now = run
      until_now%seconds_write = run%seconds_write + (wall_seconds() - since)
      call write_run(self%file%content, until_now, model)
      if (present(accuracy)) call write_accuracy(self%file%content, accuracy, interfaces)
      call self%file%close(error)
      if (allocated(error)) return
      if (self%has_contact) then
         call self%contact_file%close(error)
         if (.not. allocated(error)) call self%contact_file%put_in_place(error)
      else
         call remove_file(self%contact_file%path)   ! of an earlier run of a deck with contact
      end if
      if (allocated(error)) return
      if (is_first) then
         call self%increments%empty(error)
         if (allocated(error)) return
         call self%passes%empty(error)
         if (allocated(error)) return
      end if
      call self%file%put_in_place(error)
      if (allocated(error)) return
      self%published = self%accepted
      call self%passes%write_waiting(error)
      if (allocated(error)) return
      call self%increments%write_waiting(error)
      call self%file%note_publishing(since)
   end subroutine publish

   subroutine flush_all(self, model)
      class(results_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      logical :: is_new
      integer :: i

      call self%file%open(is_new)
      associate (file => self%file%content)
         if (is_new) call write_heads(self, model)
         call self%fields%flush_grid(file, .not. self%file%in_place, node_sets, cell_sets)
         call self%restarts%flush(file)
         do i = 1, size(self%tables)
            call flush_sets(self%tables(i)%sets, file)
         end do
         call self%histories%flush(file)
         if (is_new) then
            call file%set('/history/load', 'label', or_blank(model%load_label))
            call file%set('/history/load', 'unit', unit_in_words(trim(merge('time       ', &
               merge('temperature', 'length     ', model%load_dof == dof_temperature), &
               model%load_dof == 0)), model%units))
         end if
      end associate
      if (.not. self%has_contact) return
      call self%contact_file%open(is_new)
      associate (file => self%contact_file%content)
         if (is_new) call self%contact_grid%write_head(file, self%interfaces, &
            model%mesh%node_number)
         call self%contact_grid%flush_grid(file, .not. self%contact_file%in_place, &
            geometry%name, interface_sets)
      end associate
   end subroutine flush_all

   subroutine write_heads(self, model)
      class(results_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer :: i

      associate (file => self%file%content, interfaces => self%interfaces)
         call self%fields%write_head(file, model, self%element_points)
         call write_rigid_surfaces(file, model%mesh)
         call file%create_group('/contact')
         do i = 1, size(self%tables)
            if (size(self%tables(i)%sets) > 0) call file%create_group(self%tables(i)%group)
         end do
         do i = 1, size(interfaces)
            associate (group => self%tables(3 + i)%group)
               call file%set(group, 'friction', &
                  model%interactions(model%contacts(i)%interaction)%friction%coefficient)
               call file%set(group, 'pairing', pairing_name(interfaces(i)%pairing))
               if (interfaces(i)%follows_sliding) then
                  call file%set(group, 'sliding', 'FINITE')
                  call write_integers(file, group//'/face_node', &
                     model%mesh%node_number(interfaces(i)%face_node), as_integer, &
                     'numbers of the nodes of both faces')
               end if
               call write_geometry(file, group//'/', interfaces(i:i), model%mesh%node_number)
            end associate
         end do
         if (reason_of_run(model) == no_reason) then
            do i = 1, model%mesh%body_count
               call file%set(self%tables(4 + 2*size(interfaces) + i)%group, 'label', body_name( &
                  model, i))
            end do
         end if
         call write_reasons(file, model)
         call file%link('/uncertainty', '/errors')
         call file%create_group('/run')
         call file%write('/deck', self%cards, 'card images as read')
      end associate
   end subroutine write_heads

   !> Writes the words of the reasons for which there are no uncertainties, and the one that holds
   !> at increments that end no step.
   subroutine write_reasons(file, model)
      type(hdf5_writer_type), intent(inout) :: file
      type(model_type), intent(in) :: model
      type(string_type) :: reasons(0:reason_count)
      integer :: i

      do i = no_reason, reason_count
         reasons(i)%value = words_of_reason(i)
      end do
      call file%write('/uncertainty/reasons', reasons, &
         'words of the reasons for which there is no uncertainty, from 0 on')
      call file%set('/uncertainty', 'inside_step', words_of_reason(reason_inside_step(model)))
   end subroutine write_reasons

   !> Whether uncertainties are those of the whole run.
   pure logical function is_full(model)
      type(model_type), intent(in) :: model

      is_full = reason_of_run(model) == no_reason .and. model%uncertainty == uncertainty_full
   end function is_full

end module results
