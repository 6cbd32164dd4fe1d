!> The rounds of a requested accuracy: what each found at the ends of its steps.
!>
!> The uncertainties are those of the error estimator: of the last increment of each step, or, where
!> that alone does not tell what is requested, of the whole run (ERRORS=FULL). Increments are halved
!> where a finer mesh brought little. Where a quantity has none for another reason, every round
!> divides both faces, and the last two changes from round to round tell it by the same rule: one
!> change can be small by chance. Of a peak pressure with friction the last increment tells a part,
!> by which meshes are refined; the change from the round before, which has the path in it, adds the
!> rest, also to one near the axis on sides of two nodes, where both have to be small. A pressure
!> that has no limit has none whatever the changes are; where it is at a corner, no round is spent
!> on it.
module accuracy_rounds
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use accuracy_targets, only: accuracy_request_type
   use contact_extents, only: contact_width, is_end_of_face, peak_is_at_end, spacing_at
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values, end_words, estimated
   use kinds, only: dp
   use model, only: has_friction, model_type
   use no_estimates, only: at_corner, grows, no_reason, of_axis, of_path, of_sliding, &
      reason_of_run, remains, slides_far
   use quantity_types, only: find_quantity, quantity_type
   use records, only: increment_record_type, uncertainty_type
   use text, only: to_text
   use uncertainty_rule, only: uncertainty_parts
   implicit none
   private
   public :: accuracy_rounds_type, accuracy_round_type, finding_type, is_of_friction, needs_full

   !> Least scale of a value: parts of the largest one so far, and of those of other interfaces.
   real(dp), parameter :: early = 0.25_dp, beside_others = 0.01_dp
   !> Rounds that leave more than this part of the excess came no nearer to a target; two of them
   !> are the last, from this round on.
   real(dp), parameter :: nearer = 0.7_dp
   integer, parameter :: least_rounds = 4
   integer, parameter, public :: most_levels = 2   !! divisions of an element in one round
   !> How many times smaller an error is where the elements in which it arises are divided: that of
   !> a quantity goes as the square of that of the fields, which falls with the spacing.
   real(dp), parameter, public :: by_division = 4.0_dp

   !> A target of one quantity of one interface.
   type :: demand_type
      integer :: quantity = 0              !! index into estimated
      integer :: interface = 0             !! index into the interfaces
      real(dp) :: target = 0.0_dp          !! a part of the value, or in its unit
      logical :: is_relative = .true.      !! which of these
      character(:), allocatable :: idle    !! what there is if nothing to judge; empty otherwise
   end type demand_type

   !> Finding of one demand at the end of one step.
   type :: finding_type
      logical :: is_there = .false.        !! whether the quantity has a value and an error
      logical :: is_at_end = .false.       !! whether it is a pressure at an end of the interface
      integer :: nodes(2) = 0              !! slave and master node of a peak pressure
      real(dp) :: value = 0.0_dp           !! of the quantity
      real(dp) :: change = 0.0_dp          !! what the round changed it by
      real(dp) :: uncertainty = 0.0_dp     !! NaN: not known
      !> That by the last increment alone where the path counts, too; 0: not known
      real(dp) :: at_end = 0.0_dp
      real(dp) :: spacing = 0.0_dp         !! about an edge [length]
      !> Whether increments half as long are due: what a finer mesh did not bring
      logical :: is_of_increments = .false.
      real(dp) :: allowed = 0.0_dp         !! what the target allows
      integer :: no_estimate = no_reason   !! why there is none, of no_estimates
      character(:), allocatable :: instead !! what there is where it has no value or no edge
   contains
      procedure :: is_met
   end type finding_type

   !> One round.
   type :: accuracy_round_type
      integer :: unknowns = 0              !! temperatures, displacements and contact unknowns
      integer :: elements = 0
      integer :: increments = 0
      real(dp) :: cpu_seconds = 0.0_dp     !! [s]
      type(finding_type), allocatable :: findings(:, :)   !! (demands, steps)
   contains
      procedure :: worst_step
      procedure :: excess
   end type accuracy_round_type

   !> All rounds of a run.
   type :: accuracy_rounds_type
      logical :: is_on = .false.                             !! whether anything is requested
      logical :: goes_on = .false.                           !! whether another round follows
      character(:), allocatable :: reason                    !! why none does; empty where it is
      !! reached
      type(demand_type), allocatable :: demands(:)
      type(accuracy_round_type), allocatable :: rounds(:)    !! the last is the present one
      real(dp), allocatable :: largest(:)                    !! (demands) largest scale so far
   contains
      procedure :: begin_round
      procedure :: follow
      procedure :: settle
      procedure :: is_reached
      procedure :: conclude
      procedure :: stands_still
      procedure :: came_nearer
   end type accuracy_rounds_type

contains

   !> Whether a request is for what neither the last increment nor rounds tell: what builds up along
   !> the path of a whole run, and with friction shear forces and edges of stick, in which errors of
   !> increments may be the larger part.
   pure logical function needs_full(model)
      type(model_type), intent(in) :: model              !! with targets
      integer :: i

      needs_full = any(reason_of_run(model) == [of_sliding, of_path])
      if (needs_full .or. .not. has_friction(model)) return
      needs_full = any([(is_of_friction(model%accuracy%targets(i)%quantity), &
         i=1, size(model%accuracy%targets))])
   end function needs_full

   !> Whether friction decides a quantity.
   pure logical function is_of_friction(quantity)
      character(*), intent(in) :: quantity

      is_of_friction = any(quantity == [character(24) :: 'edge_stick', 'shear_force'])
   end function is_of_friction

   !> Begins a round; the first one takes what is requested, of one interface or of all.
   subroutine begin_round(self, request, interfaces, steps)
      class(accuracy_rounds_type), intent(inout) :: self
      type(accuracy_request_type), intent(in) :: request
      integer, intent(in) :: interfaces                      !! number of them
      integer, intent(in) :: steps                           !! number of them
      type(accuracy_round_type) :: round
      integer :: i, k

      self%is_on = allocated(request%targets)
      if (.not. self%is_on) return
      if (.not. allocated(self%demands)) then
         allocate (self%demands(0), self%rounds(0))
         do i = 1, size(request%targets)
            associate (target => request%targets(i))
               do k = 1, interfaces
                  if (all(target%interface /= [0, k])) cycle
                  self%demands = [self%demands, demand_type(find_quantity(estimated, &
                     target%quantity), k, target%bound, target%is_relative)]
               end do
            end associate
         end do
         allocate (self%largest(size(self%demands)), source=0.0_dp)
      end if
      allocate (round%findings(size(self%demands), steps))
      self%rounds = [self%rounds, round]
   end subroutine begin_round

   !> Follows an accepted increment; the end of a step is judged.
   subroutine follow(self, interfaces, record)
      class(accuracy_rounds_type), intent(inout) :: self
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(increment_record_type), intent(in) :: record
      type(quantity_type) :: quantity
      real(dp) :: scale, value(1)
      integer :: d, n, peak

      n = size(self%rounds)
      self%rounds(n)%increments = record%increment
      do d = 1, size(self%demands)
         quantity = estimated(self%demands(d)%quantity)
         associate (points => interfaces(self%demands(d)%interface), &
            contact => record%contacts(self%demands(d)%interface))
            ! A relative target refers to the value, or of an edge to the width of the contact.
            value = contact_values(quantity%name, contact)
            scale = abs(value(1))
            if (quantity%resolution > 0.0_dp .and. .not. ieee_is_nan(scale)) scale = &
               contact_width(points, contact)
            if (ieee_is_nan(scale)) scale = 0.0_dp
            self%largest(d) = max(self%largest(d), scale)
            if (.not. record%last_of_step) cycle
            scale = max(scale, early*self%largest(d), beside_others*maxval(self%largest, &
               mask=self%demands%quantity == self%demands(d)%quantity))
            associate (finding => self%rounds(n)%findings(d, record%step))
               finding = found(self%demands(d), points, &
                  record%uncertainties(self%demands(d)%quantity, self%demands(d)%interface), scale)
               finding%instead = '0 at the end of each step'
               if (quantity%name == 'heat_rate' .and. .not. &
                  allocated(contact%heat_flux)) finding%instead = 'no heat'
               if (quantity%resolution > 0.0_dp) finding%instead = end_words(quantity%name, contact)
               if (quantity%name == 'peak_pressure') then
                  finding%is_at_end = any(peak_is_at_end(points, contact))
                  peak = maxloc(contact%pressure, dim=1)
                  finding%nodes = [points%slave(peak), points%master(peak)]
                  if (has_grown(self%rounds, d, record%step) .and. .not. &
                     remains(finding%no_estimate)) finding%no_estimate = grows
               end if
            end associate
            call add_change(self%rounds, quantity, d, record)
         end associate
      end do
   end subroutine follow

   !> Gives the end of a step the uncertainties that its targets are judged by.
   subroutine settle(self, record)
      class(accuracy_rounds_type), intent(in) :: self
      type(increment_record_type), intent(inout) :: record
      integer :: d

      do d = 1, size(self%demands)
         associate (finding => self%rounds(size(self%rounds))%findings(d, record%step), &
            own => record%uncertainties(self%demands(d)%quantity, self%demands(d)%interface), &
            q => self%demands(d)%quantity)
            if (.not. finding%is_there) cycle
            own%total = finding%uncertainty
            own%no_estimate = finding%no_estimate
            if (ieee_is_nan(finding%uncertainty) .or. .not. ieee_is_nan(own%change)) cycle
            ! The rounds tell it.
            own%scatter = estimated(q)%resolution*finding%spacing
            own%change = own%total - own%scatter
            own%iteration = 0.0_dp
         end associate
      end do
   end subroutine settle

   !> The uncertainty of one quantity at the end of a step. Where an edge is the end of the
   !> interface there is nothing to judge.
   function found(demand, points, own, scale) result(finding)
      type(demand_type), intent(in) :: demand
      type(contact_points_type), intent(in) :: points
      type(uncertainty_type), intent(in) :: own
      real(dp), intent(in) :: scale
      type(finding_type) :: finding

      associate (q => demand%quantity)
         finding%value = own%value
         finding%allowed = demand%target*merge(scale, 1.0_dp, demand%is_relative)
         finding%is_there = .not. ieee_is_nan(finding%value) .and. scale > 0.0_dp
         if (.not. finding%is_there) return
         finding%is_there = .not. is_end_of_face(estimated(q), points, finding%value)
         finding%uncertainty = own%total
         finding%at_end = own%at_end
         finding%spacing = spacing_at(estimated(q), points, finding%value)
         finding%no_estimate = own%no_estimate
      end associate
   end function found

   !> Lets the changes from the rounds before count where nothing else does.
   subroutine add_change(rounds, quantity, d, record)
      type(accuracy_round_type), intent(inout) :: rounds(:)
      type(quantity_type), intent(in) :: quantity
      integer, intent(in) :: d
      type(increment_record_type), intent(in) :: record   ! of an end of a step
      real(dp) :: change, fall, finer, parts(3)
      integer :: n

      n = size(rounds)
      if (n == 1) return
      associate (now => rounds(n)%findings(d, record%step), &
         before => rounds(n - 1)%findings(d, record%step))
         if (.not. (now%is_there .and. before%is_there)) return
         now%change = abs(now%value - before%value)
         if (remains(now%no_estimate)) return
         if (.not. ieee_is_nan(now%uncertainty)) then
            if (allocated(record%history_uncertainties) .and. .not. ieee_is_nan( &
               before%uncertainty)) now%is_of_increments = now%uncertainty > &
               nearer*before%uncertainty
            return
         end if
         ! A change leads to the finer mesh, whose error is so many times smaller: as that by the
         ! last increment fell, where it is known. A mesh of half the spacing would change the rest.
         finer = 2.0_dp**quantity%order
         fall = finer
         change = max(now%change, before%change/finer)
         if (now%at_end > 0.0_dp .and. before%at_end > 0.0_dp .and. now%no_estimate /= of_axis) then
            fall = min(max(finer, before%at_end/now%at_end), by_division**most_levels)
            change = now%change
         end if
         parts = uncertainty_parts(quantity, change*(1.0_dp - 1.0_dp/finer)/(fall - 1.0_dp), &
            0.0_dp, now%spacing, 0.0_dp)
         now%uncertainty = max(parts(1) + parts(2), now%at_end)
         now%no_estimate = no_reason
      end associate
   end subroutine add_change

   !> Whether a quantity whose changes are all that is known of the mesh grew in the last two
   !> rounds, in the last one by no less than before.
   pure logical function has_grown(rounds, d, step)
      type(accuracy_round_type), intent(in) :: rounds(:)
      integer, intent(in) :: d, step
      real(dp) :: growth(2)
      integer :: i, n

      n = size(rounds)
      associate (finding => rounds(n)%findings(d, step))
         has_grown = n > 2 .and. ieee_is_nan(finding%uncertainty) .and. finding%at_end <= 0.0_dp
      end associate
      if (.not. has_grown) return
      growth = [(rounds(n - 2 + i)%findings(d, step)%value - &
         rounds(n - 3 + i)%findings(d, step)%value, i=1, 2)]
      has_grown = growth(1) > 0.0_dp .and. growth(2) >= growth(1)
   end function has_grown

   !> Whether an uncertainty is inside its target; one that is not known is not.
   elemental logical function is_met(self)
      class(finding_type), intent(in) :: self

      is_met = .not. self%is_there
      if (is_met .or. ieee_is_nan(self%uncertainty)) return
      is_met = self%uncertainty <= self%allowed
   end function is_met

   !> Whether the last round meets all targets; there is one.
   pure logical function is_reached(self)
      class(accuracy_rounds_type), intent(in) :: self

      associate (last => self%rounds(size(self%rounds)))
         is_reached = all(last%findings%is_met())
      end associate
   end function is_reached

   !> The step in which a demand is furthest from its target; 0 where none has it. A pressure at a
   !> corner, which no mesh brings to its target, is told where no other step misses it.
   pure integer function worst_step(self, d)
      class(accuracy_round_type), intent(in) :: self
      integer, intent(in) :: d                    !! the demand
      logical :: is_there(size(self%findings, 2)), counts(size(self%findings, 2))
      integer :: s

      is_there = self%findings(d, :)%is_there
      counts = is_there .and. self%findings(d, :)%no_estimate /= at_corner
      if (all(self%findings(d, :)%is_met() .or. .not. counts)) counts = is_there
      worst_step = maxloc([(over_target(self%findings(d, s)), s=1, size(counts))], dim=1, &
         mask=counts)
   end function worst_step

   !> Largest uncertainty of a demand over what its target allows; 0 for none, huge where it is
   !> unknown.
   pure real(dp) function excess(self, d)
      class(accuracy_round_type), intent(in) :: self
      integer, intent(in) :: d                    !! the demand
      integer :: step

      excess = 0.0_dp
      step = self%worst_step(d)
      if (step > 0) excess = over_target(self%findings(d, step))
   end function excess

   !> An uncertainty over what its target allows; huge where it is unknown, 0 without a value.
   pure real(dp) function over_target(finding)
      type(finding_type), intent(in) :: finding

      over_target = 0.0_dp
      if (.not. finding%is_there) return
      over_target = huge(1.0_dp)
      if (.not. ieee_is_nan(finding%uncertainty)) over_target = finding%uncertainty/finding%allowed
   end function over_target

   !> Concludes a round: whether another one follows, and why not.
   subroutine conclude(self, most_rounds, nothing_is_left, is_late)
      class(accuracy_rounds_type), intent(inout) :: self
      integer, intent(in) :: most_rounds
      logical, intent(in) :: nothing_is_left     !! whether there is nothing to refine
      logical, intent(in) :: is_late             !! whether another round takes longer than is left
      character(:), allocatable :: words
      integer :: d, s
      logical :: only_corners_are_missed, only_slides_are_missed

      ! What there is in place of a quantity that no step of the round has.
      do d = 1, size(self%demands)
         associate (findings => self%rounds(size(self%rounds))%findings(d, :))
            words = ''
            do s = 1, merge(0, size(findings), any(findings%is_there))
               if (index(words, findings(s)%instead) > 0) cycle
               if (words /= '') words = words//' or '
               words = words//findings(s)%instead
            end do
         end associate
         self%demands(d)%idle = words
      end do
      self%reason = ''
      if (self%is_reached()) return
      associate (findings => self%rounds(size(self%rounds))%findings)
         ! No mesh brings a pressure at a corner to its target.
         only_corners_are_missed = all(findings%is_met() .or. findings%no_estimate == at_corner)
         only_slides_are_missed = all(findings%is_met() .or. findings%no_estimate == slides_far)
      end associate
      if (only_slides_are_missed) then
         self%reason = 'no finer mesh helps faces that slide beyond their contact points: take '// &
            'SLIDING=FINITE on *CONTACT PAIR'
      else if (only_corners_are_missed) then
         self%reason = 'a pressure without a limit meets no target: ask for other '// &
            'quantities, on *ACCURACY or as --accuracy force=5%'
      else if (self%stands_still()) then
         self%reason = 'the last two came no nearer to the targets'
      else if (nothing_is_left) then
         self%reason = 'there is nothing left to refine'
      else if (is_late) then
         self%reason = '--limit leaves no time for another one'
      else if (size(self%rounds) >= most_rounds) then
         self%reason = '*ACCURACY, ROUNDS='//to_text(most_rounds)//' allows no more'
      else
         self%goes_on = .true.
      end if
   end subroutine conclude

   !> Whether the last two rounds brought no target nearer that is not met, as where pressures grow
   !> without limit.
   pure logical function stands_still(self)
      class(accuracy_rounds_type), intent(in) :: self
      integer :: d, n

      n = size(self%rounds)
      stands_still = n >= least_rounds
      if (stands_still) stands_still = .not. any([(self%rounds(n)%excess(d) > 1.0_dp .and. &
         self%came_nearer(d, 2), d=1, size(self%rounds(n)%findings, 1))])
   end function stands_still

   !> Whether the last rounds brought a target nearer; so does the first one.
   pure logical function came_nearer(self, d, last)
      class(accuracy_rounds_type), intent(in) :: self
      integer, intent(in) :: d                    !! the demand
      integer, intent(in) :: last                 !! number of rounds

      associate (n => size(self%rounds))
         came_nearer = n <= last
         if (.not. came_nearer) came_nearer = self%rounds(n)%excess(d) <= nearer*self%rounds(n - &
            last)%excess(d)
      end associate
   end function came_nearer

end module accuracy_rounds
