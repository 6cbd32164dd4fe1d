!> A run as a whole: what it models, its sizes, its times, in one table. The listing,
!> `thercon check` and the attributes of `/run` in the result file read this table.
module run_summaries
   use local_refinement, only: hanging_count
   use hdf5_writer, only: hdf5_writer_type
   use json, only: json_type
   use kinds, only: dp, long
   use model, only: model_type
   use model_words, only: alike_words, expansion_words, first_alike, from_to, law_words, &
      material_words, section_words, step_words
   use run_sizes, only: run_seconds_type, run_size_type
   use text, only: or_blank, string_type, to_text
   implicit none
   private
   public :: run_summary_type, accuracy_words_type, run_entry_type, run_entries, write_run, put_run
   public :: in_listing, in_check, in_times, stages

   ! Where an entry is told.
   integer, parameter :: nowhere = 0      !! not in words
   integer, parameter :: in_listing = 1   !! in the listing's section MODEL
   integer, parameter :: in_check = 2     !! by `thercon check`
   integer, parameter :: in_both = 3
   integer, parameter :: in_times = 4     !! in the listing's section SECONDS

   integer, parameter :: format_version = 1   !! of the result file; grows where old readers fail

   !> Stages of a run, whose elapsed seconds are attributes of `/run`: seconds_read ...
   character(*), parameter :: stages(6) = [character(8) :: 'read', 'assemble', 'reduce', &
      'iterate', 'recover', 'write']
   character(*), parameter :: stage_labels(6) = [character(10) :: 'reading', 'assembling', &
      'reducing', 'iterating', 'recovering', 'writing']

   !> A requested accuracy, as listing and terminal tell it.
   type :: accuracy_words_type
      type(string_type), allocatable :: targets(:)  !! verdict, a line for each target, and remarks
      type(string_type), allocatable :: rounds(:)   !! table of the rounds
      type(string_type), allocatable :: advice(:)   !! what limits one that is not reached
      character(:), allocatable :: missed   !! verdict and targets not met; empty where all are
      integer :: later_round = 0            !! round that follows, 0 for none
   end type accuracy_words_type

   !> One run. The caller of the output layer keeps it up to date.
   type :: run_summary_type
      character(:), allocatable :: version       !! version of the program
      character(:), allocatable :: deck_path     !! deck as the command line names it
      character(:), allocatable :: solver        !! SKYLINE or MUMPS
      character(:), allocatable :: modelled      !! heat, contact, friction, coupling: which are on
      character(:), allocatable :: reasons       !! why, in one sentence
      type(run_size_type) :: sizes
      logical :: has_biot = .false.              !! whether contact_biot was computed
      real(dp) :: contact_biot(2) = 0.0_dp       !! omega L/K at the start, smallest and largest [-]
      real(dp) :: seconds_before(size(stages)) = 0.0_dp   !! of the runs that it goes on from [s]
      real(dp) :: seconds_read = 0.0_dp          !! reading the deck [s]
      type(run_seconds_type) :: seconds
      real(dp) :: seconds_write = 0.0_dp         !! writing; the output layer adds to it [s]
      logical :: is_finished = .false.           !! whether nothing is left to be solved
      character(:), allocatable :: settings      !! options that change the deck; empty for none
      character(:), allocatable :: origin        !! where it goes on from; unallocated: its start
      integer :: verify_passed = 0               !! *VERIFY checks that passed
      integer :: verify_failed = 0               !! *VERIFY checks that failed
      type(accuracy_words_type) :: accuracy      !! a requested accuracy, once a round ended
      type(string_type), allocatable :: warnings(:)   !! on the run as a whole, once it has ended
   end type run_summary_type

   !> A fact about a run.
   type :: run_entry_type
      integer, private :: told = nowhere         !! one of the constants above
      character(:), allocatable :: label         !! its name in words
      character(:), allocatable :: words         !! its value in words
      real(dp) :: number = 0.0_dp                !! its value, where it is a number
      character(:), allocatable :: attribute     !! its name in `/run`; empty: not there
      character(:), allocatable :: member        !! its name in JSON
      character(7), private :: kind = 'text'     !! of the attribute: text, integer, long or real
   contains
      procedure :: is_told
   end type run_entry_type

contains

   !> Whether an entry is told somewhere.
   pure logical function is_told(self, where)
      class(run_entry_type), intent(in) :: self
      integer, intent(in) :: where                    !! in_listing, in_check or in_times

      is_told = iand(self%told, where) > 0
   end function is_told

   !> The table, in the order of the listing and of `thercon check`.
   function run_entries(run, model) result(entries)
      type(run_summary_type), intent(in) :: run
      type(model_type), intent(in) :: model
      type(run_entry_type), allocatable :: entries(:)
      type(string_type), allocatable :: lines(:)
      integer, allocatable :: first(:)
      integer :: i

      allocate (entries(0))
      call add(entries, in_check, 'modelled', or_blank(run%modelled), 'modelled')
      call add(entries, in_both, 'bodies', model%mesh%body_count)
      call add(entries, in_both, 'nodes', size(model%mesh%node_number))
      call add(entries, in_both, 'elements', size(model%mesh%element_number))
      call add(entries, in_listing, 'uniform refinements', model%refinement_levels)
      if (hanging_count(model%mesh) > 0) call add(entries, in_listing, &
         'sides with hanging nodes', hanging_count(model%mesh))
      if (model%element_order == 1) call add(entries, in_listing, 'order of the elements', &
         '1 (*OPTIONS, ORDER=1)')
      call add(entries, in_both, 'steps', size(model%steps))
      lines = step_words(model)
      do i = 1, size(lines), 2
         call add(entries, in_listing, lines(i)%value, lines(i + 1)%value)
      end do
      associate (sizes => run%sizes)
         call add(entries, in_both, 'unknown temperatures', sizes%equations_thermal, &
            'equations_thermal')
         call add(entries, in_both, 'unknown displacements', sizes%equations_mechanical, &
            'equations_mechanical')
         call add(entries, in_both, 'contact unknowns', sizes%contact_unknowns, 'contact_unknowns')
         call add(entries, in_check, 'memory of a run', nint(model%memory_needed/1.0e6_dp), &
            behind=' MB (estimate)', member='memory_megabytes')
         call add(entries, in_listing, 'solver', or_blank(run%solver), 'solver')
         call add(entries, in_listing, 'bytes of factors', sizes%factor_bytes, 'factor_bytes')
         call add(entries, in_listing, 'smallest pivot', sizes%smallest_pivot, 'smallest_pivot', &
            ' of its diagonal entry')
      end associate
      call add(entries, in_listing, 'load axis', or_blank(model%load_label))
      if (run%has_biot) call add(entries, in_listing, 'contact Biot number', &
         from_to(run%contact_biot))
      lines = section_words(model)
      first = first_alike(lines)
      do i = 1, size(lines)
         if (first(i) == i) call add(entries, in_both, 'section '//to_text(i)// &
            alike_words(first, i), lines(i)%value)
      end do
      do i = 1, size(model%materials)
         call add(entries, in_both, 'material '//model%materials(i)%name, &
            material_words(model%materials(i)))
         if (law_words(model%materials(i)) /= '') call add(entries, in_both, 'law of '// &
            model%materials(i)%name, law_words(model%materials(i)))
         if (expansion_words(model, i) /= '') call add(entries, in_both, 'strain of '// &
            model%materials(i)%name, expansion_words(model, i))
      end do
      call add_end(entries, run, model)
   end function run_entries

   !> The times, and what only the result file has.
   subroutine add_end(entries, run, model)
      type(run_entry_type), allocatable, intent(inout) :: entries(:)
      type(run_summary_type), intent(in) :: run
      type(model_type), intent(in) :: model
      real(dp) :: times(size(stages))
      integer :: i

      associate (seconds => run%seconds)
         times = run%seconds_before + [run%seconds_read, seconds%assemble, seconds%reduce, &
            seconds%iterate, seconds%recover, run%seconds_write]
      end associate
      do i = 1, size(stages)
         call add(entries, in_times, trim(stage_labels(i)), times(i), 'seconds_'//trim(stages(i)))
      end do
      call add(entries, nowhere, '', format_version, 'format_version')
      call add(entries, nowhere, '', or_blank(run%version), 'version')
      call add(entries, nowhere, '', or_blank(model%heading), 'heading')
      call add(entries, nowhere, '', or_blank(model%units%length), 'unit_length')
      call add(entries, nowhere, '', or_blank(model%units%stress), 'unit_stress')
      call add(entries, nowhere, '', or_blank(model%units%power), 'unit_power')
      call add(entries, nowhere, '', or_blank(model%units%temperature), 'unit_temperature')
      if (or_blank(model%units%time) /= '') call add(entries, nowhere, '', model%units%time, &
         'unit_time')
      if (any(model%steps%is_transient)) call add(entries, nowhere, '', &
         run%sizes%heat_factored, 'factorisations_thermal')
      if (allocated(run%origin)) call add(entries, nowhere, '', run%origin, 'continued_from')
      if (or_blank(run%settings) /= '') call add(entries, nowhere, '', run%settings, 'settings')
      call add(entries, nowhere, '', merge(1, 0, run%is_finished), 'finished')
      call add(entries, nowhere, '', run%verify_passed, 'verify_passed')
      call add(entries, nowhere, '', run%verify_failed, 'verify_failed')
   end subroutine add_end

   subroutine add(entries, told, label, value, attribute, behind, member)
      type(run_entry_type), allocatable, intent(inout) :: entries(:)
      integer, intent(in) :: told
      character(*), intent(in) :: label
      class(*), intent(in) :: value
      character(*), intent(in), optional :: attribute, behind, member
      type(run_entry_type) :: entry

      entry%told = told
      entry%label = label
      entry%attribute = ''
      if (present(attribute)) entry%attribute = attribute
      entry%member = label
      if (entry%attribute /= '') entry%member = attribute
      if (present(member)) entry%member = member
      select type (value)
      type is (character(*))
         entry%words = value
      type is (integer)
         entry%kind = 'integer'
         entry%number = value
         entry%words = to_text(value)
      type is (integer(long))
         entry%kind = 'long'
         entry%number = value
         entry%words = to_text(entry%number)
      type is (real(dp))
         entry%kind = 'real'
         entry%number = value
         entry%words = to_text(value)
      end select
      if (present(behind)) entry%words = entry%words//behind
      entries = [entries, entry]
   end subroutine add

   !> Adds what a deck holds, with the names of the attributes of `/run` where they are there.
   subroutine put_run(document, run, model)
      type(json_type), intent(inout) :: document
      type(run_summary_type), intent(in) :: run
      type(model_type), intent(in) :: model
      type(run_entry_type), allocatable :: entries(:)
      integer :: i

      entries = run_entries(run, model)
      call document%open('{', 'model')
      do i = 1, size(entries)
         associate (entry => entries(i))
            if (.not. entry%is_told(in_check)) cycle
            if (entry%kind == 'text') then
               call document%put(entry%words, entry%member)
            else
               call document%put(entry%number, entry%member)
            end if
         end associate
      end do
      call document%close('}')
   end subroutine put_run

   !> Writes the attributes of `/run`, over those of an earlier publishing.
   subroutine write_run(file, run, model)
      type(hdf5_writer_type), intent(inout) :: file       !! the open file
      type(run_summary_type), intent(in) :: run           !! the run so far
      type(model_type), intent(in) :: model
      character(*), parameter :: group = '/run'
      type(run_entry_type), allocatable :: entries(:)
      integer :: i

      entries = run_entries(run, model)
      do i = 1, size(entries)
         associate (entry => entries(i))
            if (entry%attribute == '') cycle
            select case (entry%kind)
            case ('integer')
               call file%set(group, entry%attribute, nint(entry%number))
            case ('long')
               call file%set(group, entry%attribute, nint(entry%number, long))
            case ('real')
               call file%set(group, entry%attribute, entry%number)
            case default
               call file%set(group, entry%attribute, entry%words)
            end select
         end associate
      end do
   end subroutine write_run

end module run_summaries
