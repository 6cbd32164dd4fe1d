!> Warnings that only a whole run can give: contact that never closes, no load that acts, large
!> strains and rotations, and the warnings of its increments by kinds.
module run_judgement
   use contact_definitions, only: is_removed, steps_with
   use contact_points, only: contact_points_type
   use contact_system, only: contact_open
   use kinds, only: dp
   use materials, only: has_law
   use mesh, only: extent_of
   use model, only: model_type
   use records, only: increment_record_type
   use solution_report, only: warning_type
   use state_tables, only: integers, logicals, reals, state_table_type
   use steps, only: solves_heat, solves_mechanics
   use element_elasticity, only: largest_deformation, of_strain
   use text, only: append, counted, percent, string_type, to_text
   implicit none
   private
   public :: run_judgement_type, warning_summary_type

   !> Largest strain and rotation for which the linear theory holds, and where NLGEOM is asked for
   real(dp), parameter :: small = 0.1_dp, small_with_nlgeom = 0.05_dp
   real(dp), parameter :: elastic = 0.5_dp   !! strain beyond those that solids recover from
   character(*), parameter :: of_units = '; check the units of *ELASTIC, *EXPANSION, '// &
      'loads and lengths'
   integer, parameter :: most_named = 5   !! contact pairs that never close
   real(dp), parameter :: unmoved = 1.0e-12_dp     !! part of the extent that is no displacement
   real(dp), parameter :: unheated = 1.0e-12_dp    !! part of a temperature that is no change

   !> Warnings of one kind.
   type :: kind_type
      type(warning_type) :: worst            !! the worst of them; of equals the first
      integer :: at = 0                      !! increment that had it
      integer :: first = 0, last = 0         !! increments
      integer :: count = 0                   !! increments that had one
   end type kind_type

   !> All kinds of a run, in the order of their first increments.
   type :: warning_summary_type
      private
      type(kind_type), allocatable :: kinds(:)
   contains
      procedure :: take => take_warnings
      procedure :: lines
   end type warning_summary_type

   !> Observations of a run so far.
   type :: run_judgement_type
      private
      logical :: moves = .false.                   !! whether a node was displaced
      logical :: warms = .false.                   !! whether a temperature left its initial value
      logical, allocatable :: closes(:)           !! (interfaces) whether a contact point was closed
      real(dp), allocatable :: smallest_gap(:)     !! (interfaces) of all increments [length]
      real(dp) :: largest(2) = 0.0_dp              !! strain and rotation so far [-], [radian]
      integer :: element(2) = 0                    !! elements that have them
      integer :: increment(2) = 0                  !! increments that have them
      integer :: step = 0                          !! that the increment after the last one is in
      !> Whether the run failed, so that what never happened might still have done
      logical, public :: ended_early = .false.
      type(warning_summary_type) :: repeated       !! warnings of its increments
   contains
      procedure :: take
      procedure :: exchange
      procedure :: warnings
   end type run_judgement_type

contains

   !> Takes an accepted increment.
   subroutine take(self, record, model, interfaces)
      class(run_judgement_type), intent(inout) :: self    !! what was seen
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      real(dp) :: largest(2)
      integer :: element(2), i

      if (.not. allocated(self%closes)) then
         allocate (self%closes(size(interfaces)), source=.false.)
         ! The initial gap is that of no increment: bodies that touch may part at once.
         allocate (self%smallest_gap(size(interfaces)), source=huge(1.0_dp))
      end if
      self%step = min(record%step + merge(1, 0, record%last_of_step), size(model%steps))
      if (allocated(record%warnings)) call self%repeated%take(record%increment, record%warnings)
      associate (analysis => model%steps(record%step)%analysis, fields => record%fields)
         if (solves_heat(analysis)) self%warms = self%warms .or. any(abs(fields%temperature - &
            model%initial_temperature) > unheated*maxval(abs(fields%temperature)))
         if (.not. solves_mechanics(analysis)) return
         self%moves = self%moves .or. &
            any(abs(fields%displacement) > unmoved*extent_of(model%mesh%coordinates))
         do i = 1, size(interfaces)
            if (is_removed(model%steps(:record%step)%changes, i)) cycle
            self%closes(i) = self%closes(i) .or. any(record%contacts(i)%contact_state /= &
               contact_open)
            self%smallest_gap(i) = min(self%smallest_gap(i), minval(record%contacts(i)%gap))
         end do
         if (.not. allocated(fields%stress)) return
         call largest_deformation(model%mesh, model%sections, fields%displacement, largest, element)
         where (largest > self%largest)
            self%largest = largest
            self%element = element
            self%increment = record%increment
         end where
      end associate
   end subroutine take

   !> What was seen so far, in either direction, but for the warnings of increments, which only the
   !> listing has.
   subroutine exchange(self, table)
      class(run_judgement_type), intent(inout) :: self
      type(state_table_type), intent(inout) :: table
      integer, allocatable :: places(:)
      logical, allocatable :: seen(:)
      real(dp), allocatable :: largest(:)

      seen = [self%moves, self%warms]
      places = [self%element, self%increment]
      largest = self%largest
      call logicals(table, 'seen', seen)
      call logicals(table, 'closes', self%closes)
      call reals(table, 'smallest_gaps', self%smallest_gap)
      call reals(table, 'largest_deformation', largest)
      call integers(table, 'deformed_most', places)
      self%moves = seen(1)
      self%warms = seen(2)
      self%largest = largest
      self%element = places(:2)
      self%increment = places(3:)
   end subroutine exchange

   !> The warnings on the run.
   pure function warnings(self, model, interfaces) result(lines)
      class(run_judgement_type), intent(in) :: self       !! what was seen
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(string_type), allocatable :: lines(:)          !! one a warning
      logical, allocatable :: never(:)
      real(dp) :: limit
      integer :: i

      lines = self%repeated%lines()
      if (.not. allocated(self%closes)) return
      limit = small
      if (any(model%steps%nlgeom)) limit = small_with_nlgeom
      do i = 1, size(self%largest)
         if (self%largest(i) <= limit) cycle
         call append(lines, 'increment '//to_text(self%increment(i))//': the '// &
            trim(merge('strain  ', 'rotation', i == of_strain))//' of element '// &
            to_text(model%mesh%element_number(self%element(i)))//' is '// &
            amount(i, self%largest(i))//'; the theory of small strains and displacements is '// &
            'not valid above '//amount(i, limit)//trim(merge(of_units, repeat(' ', len(of_units)), &
            i == of_strain .and. self%largest(i) > elastic .and. .not. any(has_law( &
            model%materials)))))
      end do
      if (self%ended_early) then
         if (self%step == 0) return
         if (model%steps(self%step)%stability_frequency == huge(1)) call append( &
            lines, 'step '//to_text(self%step)//' ended before its analysis of *STABILITY, '// &
            'which is made at its end; FREQUENCY=n asks for one at every n-th increment, too')
         return
      end if
      if (any(solves_mechanics(model%steps%analysis))) then
         if (.not. self%moves) call append(lines, 'no load acts: all displacements are 0 in '// &
            'all increments')
         ! One that is removed in all steps has no gap.
         never = [(.not. self%closes(i) .and. any(steps_with(model%steps%changes, i) .and. &
            solves_mechanics(model%steps%analysis)), i=1, size(interfaces))]
         do i = 1, size(interfaces)
            if (.not. never(i) .or. count(never(:i)) > most_named) cycle
            call append(lines, 'contact pair '//interfaces(i)%name// &
               ' never closes: its smallest gap is '//to_text(self%smallest_gap(i)))
         end do
         associate (others => count(never) - most_named)
            if (others > 0) call append(lines, counted(others, 'further contact pair')// &
               ' never '//trim(merge('closes', 'close ', others == 1))//'; their gaps are in '// &
               '/contact of the result file')
         end associate
      end if
      if (any(solves_heat(model%steps%analysis)) .and. .not. self%warms) call append(lines, &
         'no heat load acts: all temperatures keep their initial values in all increments')
   end function warnings

   !> A strain in percent, a rotation in percent of a radian.
   pure function amount(i, value) result(words)
      integer, intent(in) :: i            ! of_strain or of_rotation
      real(dp), intent(in) :: value
      character(:), allocatable :: words

      words = percent(value, digits=3)
      if (i /= of_strain) words = words//' of a radian'
   end function amount

   !> Takes the warnings of an increment.
   pure subroutine take_warnings(self, increment, warnings)
      class(warning_summary_type), intent(inout) :: self
      integer, intent(in) :: increment               !! its running number
      type(warning_type), intent(in) :: warnings(:)
      type(kind_type) :: kind
      integer :: i, k

      if (.not. allocated(self%kinds)) allocate (self%kinds(0))
      do i = 1, size(warnings)
         do k = 1, size(self%kinds)
            if (self%kinds(k)%worst%is_like(warnings(i))) exit
         end do
         if (k > size(self%kinds)) then
            kind%first = increment
            kind%at = increment
            kind%worst = warnings(i)
            self%kinds = [self%kinds, kind]
         end if
         associate (kind => self%kinds(k))
            if (kind%last < increment) kind%count = kind%count + 1
            kind%last = increment
            if (warnings(i)%severity <= kind%worst%severity) cycle
            kind%worst = warnings(i)
            kind%at = increment
         end associate
      end do
   end subroutine take_warnings

   !> One line a kind, such as `increments 13 to 21, worst at 17: ...`.
   pure function lines(self)
      class(warning_summary_type), intent(in) :: self
      type(string_type), allocatable :: lines(:)
      character(:), allocatable :: words
      integer :: k

      allocate (lines(0))
      if (.not. allocated(self%kinds)) return
      do k = 1, size(self%kinds)
         associate (kind => self%kinds(k))
            words = 'increment '//to_text(kind%first)
            if (kind%last > kind%first) then
               words = 'increments '//to_text(kind%first)//' to '//to_text(kind%last)
               if (kind%count <= kind%last - kind%first) words = to_text(kind%count)//' of the '// &
                  words
               if (kind%worst%has_value) words = words//', worst at '//to_text(kind%at)
            end if
            call append(lines, words//': '//kind%worst%words())
         end associate
      end do
   end function lines

end module run_judgement
