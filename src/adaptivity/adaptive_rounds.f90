!> The rounds of a requested accuracy: each solves a variation of the deck and bounds its errors;
!> the next one divides elements and shortens increments where these are too large. A run without a
!> request is one round, and so is a row of a trade-off study.
!>
!> Elements are divided where the energy norm of the error that recovery finds in stress and heat
!> flux (Zienkiewicz & Zhu) is largest, each body and field counted by its relative error (the
!> marking of Doerfler, SIAM J. Numer. Anal. 33 (1996) 1106), and near the edges of zones, where the
!> fields of the interface have roots: each time those that are left there, so that their size falls
!> with the distance. For the peak pressure errors count by their influence on it: the field of a
!> point force falls as 1/r, what an element cannot represent of it as 1/r^4.
module adaptive_rounds
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use accuracy_rounds, only: accuracy_rounds_type, by_division, finding_type, is_of_friction, &
      most_levels
   use clock, only: wall_seconds
   use contact_extents, only: closed_length, point_before, spacing_at
   use contact_points, only: contact_points_type
   use contact_quantities, only: estimated
   use element_kinds, only: element_corner_count, side_node_count
   use error_estimator, only: error_estimator_type
   use errors, only: error_type
   use field_recovery, only: squared_errors
   use growing_modes, only: analyse_stability
   use increments, only: advance
   use kinds, only: dp
   use local_refinement, only: elements_at_surfaces, largest_part
   use mesh, only: mesh_type
   use model, only: model_type
   use no_estimates, only: at_corner
   use records, only: contact_record_type, increment_record_type
   use restarts, only: keep_restart
   use simulation, only: simulation_type
   use state_tables, only: state_table_type
   use variations, only: marked_elements_type, variation_type
   implicit none
   private
   public :: adaptive_rounds_type, increment_taker_type, round_indicators_type

   !> The rounds so far, and the variation of the present one.
   type :: adaptive_rounds_type
      type(accuracy_rounds_type) :: accuracy            !! their findings
      type(variation_type), allocatable :: variation    !! of the deck; unallocated: none
      real(dp) :: deadline = huge(1.0_dp)               !! when no round begins any more [s]
      real(dp), private :: cpu_start = 0.0_dp           !! CPU seconds of the process before it [s]
      real(dp), private :: start = 0.0_dp               !! when it began [s]
   contains
      procedure :: begin_round
      procedure :: solve_increments
   end type adaptive_rounds_type

   !> Receives the increments of a round.
   type, abstract :: increment_taker_type
   contains
      procedure(take_increment), deferred :: take
   end type increment_taker_type

   abstract interface
      !> Takes an increment, with the bounds of its errors where a step ends.
      subroutine take_increment(self, simulation, record, error)
         import :: error_type, increment_record_type, increment_taker_type, simulation_type
         class(increment_taker_type), intent(inout) :: self
         type(simulation_type), intent(in) :: simulation           !! the run at its end
         type(increment_record_type), intent(inout) :: record      !! of a failed one its passes
         !> In: why the increment failed; out: why none follows
         type(error_type), allocatable, intent(inout) :: error
      end subroutine take_increment
   end interface

   !> Part of the squared error that is marked, in the first round but half of what a target allows
   real(dp), parameter :: most_marked = 0.8_dp
   real(dp), parameter :: part = 0.4_dp         !! of a target that the resolution of edges may take
   real(dp), parameter :: reach = 0.5_dp        !! of the contact length: where influence falls

   !> Demands at the ends of the steps of a round.
   type :: round_indicators_type
      private
      type(marked_elements_type) :: division           !! of the elements
      integer :: halvings = 0                   !! of the increments
   contains
      procedure :: start
      procedure :: take
      procedure :: add_to
   end type round_indicators_type

contains

   !> Begins a round, which is to prepare the model of the variation and to solve its increments;
   !> another one follows where the accuracy then goes on.
   subroutine begin_round(self)
      class(adaptive_rounds_type), intent(inout) :: self

      call cpu_time(self%cpu_start)
      self%start = wall_seconds()
      self%accuracy%goes_on = .false.
   end subroutine begin_round

   !> Solves the increments of a round and judges it.
   !> Errors: as simulation_type's advance, and those of the taker.
   subroutine solve_increments(self, model, simulation, taker, record, error, restart)
      class(adaptive_rounds_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(inout) :: simulation      !! a run at its start, reduced
      class(increment_taker_type), intent(inout) :: taker
      type(increment_record_type), intent(out) :: record      !! the last
      !> In: allocated where not even the first can be solved
      type(error_type), allocatable, intent(inout) :: error
      type(state_table_type), intent(inout), optional :: restart   !! from which the run goes on
      type(error_estimator_type), allocatable :: estimator
      type(contact_points_type), allocatable :: interfaces(:)
      type(round_indicators_type) :: indicators
      real(dp) :: began, estimating, in_stages

      allocate (estimator)
      call estimator%start(model)
      if (present(restart)) call estimator%exchange(size(model%contacts), restart, error)
      call self%accuracy%begin_round(model%accuracy, size(model%contacts), size(model%steps))
      call indicators%start(model)
      do while (.not. (allocated(error) .or. simulation%finished(model)))
         call estimator%begin_increment(simulation)
         began = wall_seconds()
         estimating = 0.0_dp
         associate (seconds => simulation%seconds)
            in_stages = seconds%assemble + seconds%reduce + seconds%recover
         end associate
         call advance(simulation, model, record, error)
         if (.not. allocated(error)) then
            estimating = wall_seconds()
            call estimator%end_increment(model, simulation, record)
            estimating = wall_seconds() - estimating
            if (self%accuracy%is_on) then
               call simulation%bodies%views(interfaces)
               call self%accuracy%follow(interfaces, record)
               if (record%last_of_step) call indicators%take(model, interfaces, self%accuracy, &
                  record)
               if (record%last_of_step) call self%accuracy%settle(record)
            end if
            call analyse_stability(model, simulation, record)
            ! A run that goes on shall solve such an increment with its finer mesh.
            if (.not. estimator%is_interrupted) call keep_restart(model, simulation, record)
            if (allocated(record%restart)) call estimator%exchange(size(model%contacts), &
               record%restart, error)
         end if
         ! What is in no other stage.
         associate (seconds => simulation%seconds)
            seconds%iterate = seconds%iterate + (wall_seconds() - began - estimating - &
               (seconds%assemble + seconds%reduce + seconds%recover - in_stages))
         end associate
         call taker%take(simulation, record, error)
      end do
      call estimator%release()
      if (.not. self%accuracy%is_on) return
      if (allocated(error)) then
         ! It did not come to its end.
         self%accuracy%rounds = self%accuracy%rounds(:size(self%accuracy%rounds) - 1)
      else
         call end_round(self, model, simulation, indicators)
      end if
   end subroutine solve_increments

   !> Adds up what a round cost, and plans the next one where one follows.
   subroutine end_round(self, model, simulation, indicators)
      type(adaptive_rounds_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(round_indicators_type), intent(in) :: indicators
      real(dp) :: now

      call cpu_time(now)
      associate (round => self%accuracy%rounds(size(self%accuracy%rounds)), &
         sizes => simulation%sizes)
         round%unknowns = sizes%equations_thermal + sizes%equations_mechanical + &
            sizes%contact_unknowns
         round%elements = size(model%mesh%element_kind)
         round%cpu_seconds = now - self%cpu_start
      end associate
      ! Whether no other mesh and no other increments would help; whether a round that takes as long
      ! as this one ends too late.
      call self%accuracy%conclude(model%accuracy%rounds, indicators%halvings == 0 .and. size( &
         indicators%division%point_levels) == 0 .and. .not. any(indicators%division%levels > 0), &
         2.0_dp*wall_seconds() - self%start > self%deadline)
      if (.not. self%accuracy%goes_on) return
      if (.not. allocated(self%variation)) allocate (self%variation)
      call indicators%add_to(self%variation)
   end subroutine end_round

   !> Starts a round.
   subroutine start(self, model)
      class(round_indicators_type), intent(out) :: self
      type(model_type), intent(in) :: model

      allocate (self%division%levels(size(model%mesh%element_kind)), source=0)
      allocate (self%division%points(2, 0), self%division%point_levels(0))
   end subroutine start

   !> Takes the end of a step, whose findings the last round has.
   subroutine take(self, model, interfaces, rounds, record)
      class(round_indicators_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(accuracy_rounds_type), intent(in) :: rounds
      type(increment_record_type), intent(in) :: record
      type(finding_type) :: finding
      real(dp), allocatable :: edges(:)
      real(dp) :: length, marked, uncertainty, weight(size(self%division%levels))
      logical :: at_faces(size(self%division%levels))
      integer :: d, levels, of_edges

      do d = 1, size(rounds%demands)
         finding = rounds%rounds(size(rounds%rounds))%findings(d, record%step)
         if (finding%is_met() .or. finding%no_estimate == at_corner) cycle
         if (finding%is_of_increments) self%halvings = 1
         uncertainty = finding%uncertainty
         if (ieee_is_nan(uncertainty)) uncertainty = finding%at_end
         associate (i => rounds%demands(d)%interface, q => rounds%demands(d)%quantity, &
            of_elements => self%division%levels)
            at_faces = elements_at_surfaces(model%mesh, [model%contacts(i)%slave, &
               model%contacts(i)%master])
            ! More than two rounds of one division bring is due at once.
            levels = 1
            if (uncertainty > by_division**most_levels*finding%allowed) levels = most_levels
            ! Where the last increment alone tells no error, the change by sides of half the size
            ! does; so where the recovered error does not tell where it arises. Where sides of two
            ! lengths meet, pressures of linear elements alternate.
            if (ieee_is_nan(record%uncertainties(q, i)%total) .and. finding%at_end <= 0.0_dp &
               .or. .not. rounds%came_nearer(d, 1) .or. estimated(q)%name == 'peak_pressure' .and. &
               any(at_faces .and. side_node_count(model%mesh%element_kind) == 2)) then
               where (at_faces) of_elements = max(of_elements, levels)
            end if
            ! Edges near which it errs: those of stick only for what friction decides.
            edges = record%contacts(i)%edges_contact
            if (is_of_friction(estimated(q)%name)) edges = [edges, record%contacts(i)%edges_stick]
            ! How often the sides at an edge must be divided for its resolution.
            length = estimated(q)%resolution*spacing_at(estimated(q), interfaces(i), &
               record%uncertainties(q, i)%value)
            of_edges = 0
            if (length > 0.0_dp) of_edges = min(most_levels, ceiling(log(length/ &
               (part*finding%allowed))/log(2.0_dp)))
            call mark_edges(self, interfaces(i), edges, max(levels, of_edges))
            weight = influence(q, model%mesh, interfaces(i), record%contacts(i), finding%allowed)
            marked = most_marked
            if (size(rounds%rounds) == 1) marked = min(most_marked, 1.0_dp - 0.5_dp* &
               finding%allowed/max(uncertainty, finding%allowed))
            weight = weight*(squared_errors(model%mesh, record%stress_error) + &
               squared_errors(model%mesh, record%heat_flux_error))
            ! Hanging nodes between elements of the same error would bring a larger one.
            where (largest_part(weight, marked)) of_elements = max(of_elements, levels)
         end associate
      end do
   end subroutine take

   !> How much the squared error of each element counts for a quantity. The peak of a pressure may
   !> be wherever it is as high but for what is allowed; one that is uniform follows all of the
   !> bodies.
   pure function influence(q, mesh, points, contact, allowed) result(weight)
      integer, intent(in) :: q
      type(mesh_type), intent(in) :: mesh
      type(contact_points_type), intent(in) :: points
      type(contact_record_type), intent(in) :: contact
      real(dp), intent(in) :: allowed
      real(dp) :: weight(size(mesh%element_kind)), length, middle(2)
      integer, allocatable :: peaks(:)
      integer :: e, k, n

      weight = 1.0_dp
      if (estimated(q)%name /= 'peak_pressure') return
      peaks = pack([(k, k=1, size(contact%pressure))], contact%pressure >= &
         maxval(contact%pressure) - allowed)
      length = reach*closed_length(points, contact)
      if (length <= 0.0_dp .or. size(peaks) == count(contact%pressure > 0.0_dp)) return
      do e = 1, size(weight)
         n = element_corner_count(mesh%element_kind(e))
         middle = sum(mesh%coordinates(:, mesh%element_nodes(:n, e)), dim=2)/n
         weight(e) = (1.0_dp + minval(norm2(points%position(:, peaks) - spread(middle, 2, &
            size(peaks)), dim=1))/length)**(-8)
      end do
   end function influence

   !> Marks the edges of zones on both faces, where elements are divided so often.
   subroutine mark_edges(self, points, edges, levels)
      class(round_indicators_type), intent(inout) :: self
      type(contact_points_type), intent(in) :: points
      real(dp), intent(in) :: edges(:)
      integer, intent(in) :: levels
      real(dp) :: master(2), part_of_side, slave(2)
      integer :: i, k

      associate (s => points%arc_length, x => points%position, h => points%initial_gap, &
         n => points%normal)
         do i = 1, size(edges)
            if (ieee_is_nan(edges(i)) .or. size(s) < 2) cycle
            k = point_before(s, edges(i))
            ! Two pieces may meet in one s.
            part_of_side = min(max((edges(i) - s(k))/max(s(k + 1) - s(k), tiny(s)), 0.0_dp), 1.0_dp)
            slave = between(x(:, k), x(:, k + 1), part_of_side)
            master = slave + between(h(k)*n(:, k), h(k + 1)*n(:, k + 1), part_of_side)
            self%division%points = reshape([self%division%points, slave, master], &
               [2, size(self%division%point_levels) + 2])
            self%division%point_levels = [self%division%point_levels, levels, levels]
         end do
      end associate
   end subroutine mark_edges

   !> The vector that lies between two.
   pure function between(first, second, part_of_way) result(vector)
      real(dp), intent(in) :: first(2), second(2), part_of_way
      real(dp) :: vector(2)

      vector = (1.0_dp - part_of_way)*first + part_of_way*second
   end function between

   !> Adds the divisions and the increments of the next round to those of the present one.
   subroutine add_to(self, variation)
      class(round_indicators_type), intent(in) :: self
      type(variation_type), intent(inout) :: variation

      variation%increments = variation%increments*0.5_dp**self%halvings
      if (.not. allocated(variation%divisions)) allocate (variation%divisions(0))
      variation%divisions = [variation%divisions, self%division]
   end subroutine add_to

end module adaptive_rounds
