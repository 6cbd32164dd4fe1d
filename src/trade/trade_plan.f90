!> The rows of a trade-off study: the grid over mesh, increments and elements; meshes that are finer
!> at the contact faces; one thing at a time around the deck as written.
module trade_plan
   use contact_definitions, only: pairing_name, pairing_nodes, pairing_surfaces
   use controls, only: crank_nicolson_scheme, explicit_scheme, galerkin_scheme, implicit_scheme, &
      method_names, solver_mumps, solver_skyline, thermal_scheme_type
   use element_kinds, only: side_node_count
   use increment_control, only: increment_control_type
   use kinds, only: dp
   use load_histories, only: step_clock_type
   use model, only: model_type
   use steps, only: analysis_coupled, solves_heat
   use text, only: to_text
   use trade_study, only: trade_row_type
   use variations, only: variation_type, varied_increment
   implicit none
   private
   public :: mesh_rows, single_rows, common_instants, instant_at
   public :: factors, most_levels

   !> Factors on the increments of the deck, each half the one before.
   real(dp), parameter :: factors(5) = [4.0_dp, 2.0_dp, 1.0_dp, 0.5_dp, 0.25_dp]
   logical, parameter :: is_local(5) = [.true., .false., .true., .false., .false.]   !! finer there
   integer, parameter :: most_levels = 3            !! refinements beyond those of the deck
   real(dp), parameter :: tolerances(4) = [1.0e-3_dp, 1.0e-5_dp, 1.0e-8_dp, 1.0e-11_dp]
   type(thermal_scheme_type), parameter :: schemes(4) = [implicit_scheme, galerkin_scheme, &
      crank_nicolson_scheme, explicit_scheme]

   integer, parameter :: few = 4             !! instants: fewer all count
   integer, parameter :: most_instants = 60  !! of all steps, but at least three in each

contains

   !> The rows on one mesh: elements by increments; with levels at the contact faces, some with the
   !> deck's elements. Factors that do not change the increments of the deck are left out.
   pure subroutine mesh_rows(model, level, contact_level, rows)
      type(model_type), intent(in) :: model       !! on the deck's mesh
      integer, intent(in) :: level                !! refinements of that mesh
      integer, intent(in) :: contact_level        !! more of them at the contact faces
      type(trade_row_type), allocatable, intent(out) :: rows(:)
      integer :: f, highest, order

      allocate (rows(0))
      highest = highest_order(model)
      do order = 1, highest
         do f = 1, size(factors)
            associate (is_default => order == min(model%written_order, highest))
               if (contact_level > 0 .and. .not. (is_default .and. is_local(f))) cycle
               if (all(0.5_dp*factors(f)*model%steps%first_increment >= &
                  0.999_dp*model%steps%period)) cycle
               call add(variation_type(order=order, levels=level, contact_levels=contact_level, &
                  increments=factors(f)), '', rows)
               rows(size(rows))%is_default = is_default .and. contact_level == 0 .and. &
                  level == model%written_levels .and. abs(factors(f) - 1.0_dp) <= 0.0_dp
            end associate
         end do
      end do
   end subroutine mesh_rows

   !> The rows that vary one thing, each where the deck has a use for it.
   pure subroutine single_rows(model, pairings, rows)
      type(model_type), intent(in) :: model        !! on the deck's mesh
      integer, intent(in) :: pairings(:)           !! (interfaces) as the deck has them
      type(trade_row_type), allocatable, intent(out) :: rows(:)
      type(variation_type) :: written
      integer :: i, coupled, heated, pairing

      allocate (rows(0))
      written = variation_type(order=min(model%written_order, highest_order(model)), &
         levels=model%written_levels)
      coupled = findloc(model%steps%analysis, analysis_coupled, dim=1)
      if (size(model%contacts) == 0) coupled = 0
      heated = findloc(solves_heat(model%steps%analysis), .true., dim=1)
      do i = 1, merge(size(tolerances), 0, coupled > 0)
         if (abs(tolerances(i)/model%steps(coupled)%fixed_point%tolerance - 1.0_dp) < 0.5_dp) cycle
         call add(written, 'TOL='//to_text(tolerances(i)), rows)
         rows(size(rows))%variation%tolerance = tolerances(i)
      end do
      do i = 1, merge(size(schemes), 0, heated > 0)
         if (schemes(i)%name == model%steps(heated)%scheme%name) cycle
         call add(written, trim(schemes(i)%name), rows)
         rows(size(rows))%variation%scheme = schemes(i)
      end do
      do i = 1, merge(size(method_names), 0, coupled > 0)
         if (i == model%steps(coupled)%fixed_point%method) cycle
         call add(written, trim(method_names(i)), rows)
         rows(size(rows))%variation%method = i
      end do
      pairing = merge(pairing_surfaces, 0, all(pairings == pairing_nodes))
      if (any(model%contacts%pairing == pairing_surfaces)) pairing = pairing_nodes
      if (size(pairings) > 0 .and. pairing /= 0) then
         call add(written, pairing_name(pairing), rows)
         rows(size(rows))%variation%pairing = pairing
      end if
      call add(written, trim(merge('MUMPS  ', 'SKYLINE', model%solver == solver_skyline)), rows)
      rows(size(rows))%variation%solver = merge(solver_mumps, solver_skyline, &
         model%solver == solver_skyline)
   end subroutine single_rows

   pure subroutine add(variation, varied, rows)
      type(variation_type), intent(in) :: variation
      character(*), intent(in) :: varied
      type(trade_row_type), allocatable, intent(inout) :: rows(:)
      type(trade_row_type) :: row

      row%variation = variation
      row%varied = varied
      row%reason = ''
      rows = [rows, row]
   end subroutine add

   !> Order of the elements that the deck has.
   pure integer function highest_order(model)
      type(model_type), intent(in) :: model

      highest_order = merge(2, 1, any(side_node_count(model%mesh%element_kind) == 3))
   end function highest_order

   !> Instants at which rows are compared: ends of the longest increments, which shorter ones meet
   !> too, of many every n-th; where increments grow, only the instants on which they land. The
   !> first end of a step is the coarsest part of a path and left out, unless there are few.
   pure function common_instants(model) result(times)
      type(model_type), intent(in) :: model      !! as the deck is written
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
            step%first_increment = varied_increment(step%first_increment, step%period, factors(1))
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

end module trade_plan
