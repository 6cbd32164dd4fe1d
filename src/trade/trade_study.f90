!> A trade-off study: the instants and numbers by which its rows are compared; its rows: the grid
!> over mesh, increments and elements, meshes that are finer at the contact faces, one thing at a
!> time around the deck as written; which of them are worth their cost: the Pareto-optimal ones, and
!> the cheapest for each target.
module trade_study
   use contact_definitions, only: pairing_name, pairing_nodes, pairing_surfaces
   use controls, only: crank_nicolson_scheme, explicit_scheme, galerkin_scheme, implicit_scheme, &
      l_stable_scheme, method_names, solver_mumps, solver_skyline, thermal_scheme_type
   use element_kinds, only: kind_count, linear_kind
   use increment_control, only: increment_control_type
   use kinds, only: dp
   use load_histories, only: step_clock_type
   use model, only: model_type
   use reported_quantities, only: traded
   use steps, only: analysis_coupled, solves_heat
   use text, only: percent, rounded, string_type, to_text
   use variations, only: variation_type
   implicit none
   private
   public :: trade_row_type, trade_type, targets, target_count, quantity_count, figure_count, &
      closed_length, is_there, absent, item_quantities, judge_rows, are_optimal, &
      same_time, mesh_rows, single_rows, factors, most_levels, common_instants, instant_at

   integer, parameter :: quantity_count = size(traded)       !! quantities that rows are judged by
   integer, parameter :: figure_count = quantity_count - 1   !! all but the last: the temperatures
   integer, parameter :: closed_length = 0                   !! no quantity: the scale of edges
   real(dp), parameter :: absent = -1.0e300_dp               !! marks a value that does not exist

   integer, parameter :: target_count = 3
   real(dp), parameter :: targets(target_count) = [0.1_dp, 0.01_dp, 0.001_dp] !! relative errors
   real(dp), parameter :: negligible = 1.0e-6_dp   !! errors below it are equal
   real(dp), parameter :: same_time = 2.0e-3_dp    !! what runs of one row differ by anyway [s]

   !> A variation of the deck, measured.
   type :: trade_row_type
      type(variation_type) :: variation                 !! with its order and levels
      character(:), allocatable :: elements             !! their names, such as Q8
      character(:), allocatable :: varied               !! one thing; empty: mesh or increments
      real(dp) :: accuracy = 0.0_dp                     !! requested, a part of the values; 0: none
      logical :: is_default = .false.                   !! the deck as written
      integer :: status = 0                             !! exit status
      character(:), allocatable :: reason               !! why it failed; empty where it did not
      real(dp), allocatable :: cpu(:)                   !! CPU seconds, a run each [s]
      real(dp) :: cpu_seconds = 0.0_dp                  !! their median [s]
      real(dp) :: peak_bytes = 0.0_dp                   !! largest resident memory [byte]
      integer :: increments = 0                         !! accepted increments
      integer :: passes = 0                             !! passes of the fixed point in all of them
      real(dp) :: imbalance = 0.0_dp                    !! largest heat_imbalance_pointwise
      real(dp), allocatable :: values(:, :)             !! (items, instants), or absent
      real(dp) :: errors(quantity_count) = absent       !! stated errors [-]
      real(dp) :: worst = absent                        !! largest of them
      logical :: is_optimal = .false.                   !! Pareto-optimal
      logical :: is_recommended(target_count) = .false.
   end type trade_row_type

   !> A trade-off study.
   type :: trade_type
      type(trade_row_type), allocatable :: rows(:)
      type(trade_row_type), allocatable :: left_out(:)  !! by --limit, with the reason
      character(:), allocatable :: ended_early          !! why rows are missing; else unallocated
      real(dp), allocatable :: instants(:)              !! total times of comparison [time]
      integer, allocatable :: items(:)                  !! as from item_quantities
      real(dp) :: uncertainty(quantity_count) = absent  !! of the reference; absent: not judged
      !> Limits of a recommendation, or why there is none; empty for neither
      type(string_type) :: remarks(target_count)
   end type trade_type

   character(3), parameter :: shapes(kind_count) = ['Q8 ', 'Q8R', 'Q4 ', 'T6 ', 'T3 ', 'Q4I']

   !> Factors on the increments of the deck, each half the one before.
   real(dp), parameter :: factors(5) = [4.0_dp, 2.0_dp, 1.0_dp, 0.5_dp, 0.25_dp]
   logical, parameter :: is_local(5) = [.true., .false., .true., .false., .false.]   !! finer there
   integer, parameter :: most_levels = 3            !! refinements beyond those of the deck
   integer, parameter :: few = 4             !! instants of comparison: fewer all count
   integer, parameter :: most_instants = 60  !! of all steps, but at least three in each
   real(dp), parameter :: tolerances(4) = [1.0e-3_dp, 1.0e-5_dp, 1.0e-8_dp, 1.0e-11_dp]
   type(thermal_scheme_type), parameter :: schemes(5) = [l_stable_scheme, implicit_scheme, &
      galerkin_scheme, crank_nicolson_scheme, explicit_scheme]

contains

   elemental logical function is_there(value)
      real(dp), intent(in) :: value   !! a value, or absent

      is_there = value > 0.5_dp*absent
   end function is_there

   !> Which quantity each of the compared values is of: for every interface its figures, then its
   !> closed length; then the temperatures of nodes. A deck without contact counts as one interface,
   !> whose heat is that which enters.
   pure function item_quantities(interfaces, nodes) result(quantities)
      integer, intent(in) :: interfaces, nodes       !! number of each
      integer, allocatable :: quantities(:)          !! indexes into traded, or closed_length
      integer :: q, i

      quantities = [([(q, q=1, figure_count), closed_length], i=1, max(interfaces, 1)), &
         (quantity_count, i=1, nodes)]
   end function item_quantities

   !> Marks the rows that are Pareto-optimal by CPU seconds and worst error, both with two digits,
   !> negligible errors as one; recommends one row for each target: the cheapest that meets it, and
   !> the targets before it, in all quantities in which some row does.
   pure subroutine judge_rows(trade)
      type(trade_type), intent(inout) :: trade   !! with the errors of its rows
      logical, dimension(size(trade%rows)) :: is_best, meets
      logical, dimension(quantity_count) :: is_known, is_reachable
      real(dp) :: errors(size(trade%rows)), least(quantity_count)
      character(:), allocatable :: words
      integer :: k, q, i

      associate (rows => trade%rows)
         rows%is_optimal = are_optimal(rounded(rows%cpu_seconds), &
            rounded(max(rows%worst, negligible)), rows%status == 0 .and. is_there(rows%worst))
         is_known = is_there(trade%uncertainty)
         least = [(minval(rows%errors(q), mask=rows%status == 0), q=1, quantity_count)]
         meets = rows%status == 0
         do k = 1, target_count
            is_reachable = is_known .and. least <= targets(k)
            meets = meets .and. [(all(rows(i)%errors <= targets(k) .or. .not. is_reachable), &
               i=1, size(rows))]
            if (any(is_reachable) .and. any(meets)) then
               ! Of those that cost the same the most accurate one, of these the deck as written or
               ! the first.
               is_best = meets .and. rows%cpu_seconds <= minval(rows%cpu_seconds, mask=meets) + &
                  same_time
               errors = rounded(max(rows%worst, negligible))
               is_best = is_best .and. errors <= minval(errors, mask=is_best)
               i = findloc(is_best .and. rows%is_default, .true., dim=1)
               if (i == 0) i = findloc(is_best, .true., dim=1)
               rows(i)%is_recommended(k) = .true.
            end if
            words = ''
            do q = 1, quantity_count
               if (is_reachable(q) .or. .not. is_known(q)) cycle
               words = words//'; '//trim(traded(q)%name)//': '
               if (trade%uncertainty(q) < targets(k)) words = words//'the best row has '// &
                  percent(least(q))
               if (trade%uncertainty(q) >= targets(k)) words = words// &
                  'the reference itself is uncertain by '//percent(trade%uncertainty(q))
            end do
            if (words == '' .and. .not. any(rows%is_recommended(k))) words = '; '//trim(merge( &
               'no row meets it in all quantities', 'there is nothing to judge by     ', &
               any(is_known)))
            trade%remarks(k)%value = words(3:)
         end do
      end associate
   end subroutine judge_rows

   !> Which points no other one beats: none is as cheap and better, or cheaper and as good.
   pure function are_optimal(costs, errors, count) result(optimal)
      real(dp), intent(in) :: costs(:)        !! (n) costs [s]
      real(dp), intent(in) :: errors(:)       !! (n) errors
      logical, intent(in) :: count(:)         !! (n) whether a point takes part
      logical :: optimal(size(costs))         !! (n) whether none beats it
      integer :: i

      optimal = count .and. [(.not. any(count .and. (costs <= costs(i) + same_time .and. errors < &
         errors(i) .or. costs < costs(i) - same_time .and. errors <= errors(i))), i=1, size(costs))]
   end function are_optimal

   !> The rows on one mesh: elements by increments; with levels at the contact faces, some with the
   !> deck's elements. Factors that do not change the increments of the deck are left out.
   pure subroutine mesh_rows(model, highest, level, contact_level, rows)
      type(model_type), intent(in) :: model       !! on the deck's mesh
      integer, intent(in) :: highest              !! order of its elements
      integer, intent(in) :: level                !! refinements of that mesh
      integer, intent(in) :: contact_level        !! more of them at the contact faces
      type(trade_row_type), allocatable, intent(out) :: rows(:)
      type(trade_row_type) :: row
      integer :: f, order

      allocate (rows(0))
      row%varied = ''
      do order = 1, highest
         row%elements = elements_of(model, order)
         do f = 1, size(factors)
            associate (is_default => order == min(model%written_order, highest))
               if (contact_level > 0 .and. .not. (is_default .and. is_local(f))) cycle
               if (all(0.5_dp*factors(f)*model%steps%first_increment >= &
                  0.999_dp*model%steps%period)) cycle
               row%variation = variation_type(order=order, levels=level, &
                  contact_levels=contact_level, increments=factors(f))
               row%is_default = is_default .and. contact_level == 0 .and. &
                  level == model%written_levels .and. abs(factors(f) - 1.0_dp) <= 0.0_dp
               rows = [rows, row]
            end associate
         end do
      end do
   end subroutine mesh_rows

   !> Names of the elements of an order, such as Q8 or Q8+T6.
   pure function elements_of(model, order) result(names)
      type(model_type), intent(in) :: model
      integer, intent(in) :: order
      character(:), allocatable :: names
      integer :: k, kinds(size(model%mesh%element_kind))

      kinds = model%mesh%element_kind
      if (order == 1) kinds = linear_kind(kinds)
      names = ''
      do k = 1, kind_count
         if (any(kinds == k)) names = names//'+'//trim(shapes(k))
      end do
      names = names(2:)
   end function elements_of

   !> The rows that vary one thing, each where the deck has a use for it, and those of requested
   !> accuracies.
   subroutine single_rows(model, highest, pairings, rows)
      type(model_type), intent(in) :: model        !! on the deck's mesh
      integer, intent(in) :: highest               !! order of its elements
      integer, intent(in) :: pairings(:)           !! (interfaces) as the deck has them
      type(trade_row_type), allocatable, intent(out) :: rows(:)
      type(variation_type) :: written, varied
      integer :: i, coupled, pairing
      logical :: follows(size(model%steps))   ! the scheme that is varied

      allocate (rows(0))
      written = variation_type(order=min(model%written_order, highest), levels=model%written_levels)
      varied = written
      coupled = findloc(model%steps%analysis, analysis_coupled, dim=1)
      if (size(model%contacts) == 0) coupled = 0
      do i = 1, merge(size(tolerances), 0, coupled > 0)
         if (abs(tolerances(i)/model%steps(coupled)%fixed_point%tolerance - 1.0_dp) < 0.5_dp) cycle
         varied%tolerance = tolerances(i)
         call add('TOL='//to_text(tolerances(i)))
      end do
      do i = 1, size(schemes)
         ! Steady steps do as with the implicit one.
         follows = solves_heat(model%steps%analysis) .and. (model%steps%is_transient .or. &
            schemes(i)%stages == 1)
         if (all(model%steps%scheme%name == schemes(i)%name .or. .not. follows)) cycle
         varied%scheme = schemes(i)
         call add(schemes(i)%name)
      end do
      do i = 1, merge(size(method_names), 0, coupled > 0)
         if (i == model%steps(coupled)%fixed_point%method) cycle
         varied%method = i
         call add(method_names(i))
      end do
      pairing = merge(pairing_surfaces, 0, all(pairings == pairing_nodes))
      if (any(model%contacts%pairing == pairing_surfaces)) pairing = pairing_nodes
      varied%pairing = pairing
      if (size(pairings) > 0 .and. pairing /= 0) call add(pairing_name(pairing))
      varied = written
      varied%solver = merge(solver_mumps, solver_skyline, model%solver == solver_skyline)
      call add(merge('MUMPS  ', 'SKYLINE', model%solver == solver_skyline))
      if (size(model%contacts) == 0 .or. any(model%steps%continuation%is_on)) return
      do i = 1, target_count
         call add('--accuracy '//percent(targets(i)), targets(i))
      end do
   contains
      !> Adds the row with what is varied, and goes back to the deck.
      subroutine add(name, accuracy)
         character(*), intent(in) :: name
         real(dp), intent(in), optional :: accuracy
         type(trade_row_type) :: row

         row%variation = varied
         row%elements = elements_of(model, written%order)
         if (present(accuracy)) row%accuracy = accuracy
         row%varied = trim(name)
         rows = [rows, row]
         varied = written
      end subroutine add
   end subroutine single_rows

   !> Instants at which variations are compared: ends of the longest increments, which shorter ones
   !> meet too, of many every n-th; where increments grow, only the instants on which they land. The
   !> first end of a step is the coarsest part of a path and left out, unless there are few.
   function common_instants(model, longest_factor) result(times)
      type(model_type), intent(in) :: model      !! as the deck is written
      real(dp), intent(in) :: longest_factor     !! on its increments; that of others is halved
      real(dp), allocatable :: times(:)          !! total times, ascending [time]
      type(model_type) :: longest
      type(increment_control_type) :: control
      type(step_clock_type) :: clock
      real(dp), allocatable :: ends(:)
      integer :: s, count

      longest = model
      allocate (times(0))
      do s = 1, size(model%steps)
         associate (step => longest%steps(s), most => max(most_instants/size(model%steps), 2))
            step%first_increment = min(step%first_increment*longest_factor, step%period)
            count = floor(step%period/step%first_increment + 1.0e-6_dp)
            step%first_increment = step%first_increment*(1 + (count - 1)/most)
            if (step%grows) step%first_increment = step%period
            step%grows = .false.
         end associate
         call control%enter_step(longest)
         allocate (ends(0))
         do while (.not. control%step_is_over(longest))
            clock = control%next_instant(longest)
            call control%accept(longest, clock)
            ends = [ends, clock%total_time]
         end do
         times = [times, ends(merge(2, 1, count >= few .and. .not. model%steps(s)%grows):)]
         deallocate (ends)
      end do
   end function common_instants

   !> Which of some instants a time is; 0 for none.
   pure integer function instant_at(times, time)
      real(dp), intent(in) :: times(:)   !! instants [time]
      real(dp), intent(in) :: time       !! a total time [time]

      do instant_at = size(times), 1, -1
         if (abs(times(instant_at) - time) <= 1.0e-9_dp*times(size(times))) return
      end do
   end function instant_at

end module trade_study
