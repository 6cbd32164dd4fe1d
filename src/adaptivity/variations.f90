!> The models that are solved, made of the model of a deck.
!>
!> The deck is read and built once, on its own mesh. `vary` makes of that model the one to solve:
!> its mesh is divided as the deck asks, and further, and the loads and supports that the deck asks
!> for are applied to it. What a variation leaves alone is as the deck says; `variation_type()` is
!> the deck as it is written:
!>
!>     call build_model(cards, verifiable, estimated, read, report, error)
!>     call vary(read, variation_type(), model, error)
!>     call vary(read, variation_type(levels=1, increments=0.5_dp), finer, error)
module variations
   use mesh_bodies, only: find_bodies
   use controls, only: default_solver, mumps_from, solver_by_size, solver_mumps, thermal_scheme_type
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp, long
   use load_application, only: apply_requests, apply_transforms
   use local_refinement, only: choose_neighbours, elements_at_points, elements_in_region
   use memory_calls, only: check_memory
   use memory_needs, only: memory_needed
   use model, only: model_type, needs_full_tail, refined_region_type
   use order_reduction, only: reduce_order
   use refinement, only: numbering_fault, refine, refine_chosen
   use mesh_checks, only: point_jacobians
   use steps, only: solves_heat, solves_mechanics
   use text, only: append, to_text
   implicit none
   private
   public :: variation_type, marked_elements_type, vary, apply_variation, as_written

   integer, parameter :: as_written = -1   !! what the deck says holds

   !> How often each element is divided, and then those that are left at some points.
   type :: marked_elements_type
      integer, allocatable :: levels(:)         !! (elements) >= 0
      real(dp), allocatable :: points(:, :)     !! (2, n) [length]
      integer, allocatable :: point_levels(:)   !! (n) divisions at them
   end type marked_elements_type

   !> Differences from the deck.
   type :: variation_type
      integer :: order = as_written             !! order of the elements, 1 or 2
      integer :: levels = as_written            !! *REFINE, LEVELS=
      integer :: contact_levels = 0             !! more levels at both faces of all contacts
      integer :: method = as_written            !! one of the method_* constants, in all steps
      integer :: solver = as_written            !! one of the solver_* constants
      integer :: pairing = as_written           !! one of the pairing_* constants, of all contacts
      real(dp) :: tolerance = 0.0_dp            !! of the fixed point, in all steps; 0 as written
      real(dp) :: increments = 1.0_dp           !! factor on the size of all increments
      type(thermal_scheme_type), allocatable :: scheme   !! in all steps; unallocated as written
      !> divisions after those of the deck, one after the other, each of the elements that the one
      !> before leaves; unallocated for none
      type(marked_elements_type), allocatable :: divisions(:)
   end type variation_type

contains

   !> Makes the model of a variation.
   !> Errors: status_deck, at the card that asks for what cannot be; as check_memory.
   subroutine vary(read, variation, model, error)
      type(model_type), intent(in) :: read            !! sound, as the deck builder made it
      type(variation_type), intent(in) :: variation   !! what is other than in the deck
      type(model_type), intent(out) :: model          !! to be solved
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: reason
      logical :: with_mechanics

      model = read
      call apply_variation(variation, model)
      call divide_mesh(variation, model, error)
      if (allocated(error)) return
      call apply_requests(model)
      if (order_of(read, variation) == 1) call lower_order(model, error)
      if (allocated(error)) return
      call apply_transforms(model)
      call find_bodies(model%mesh)
      model%has_solver_by_size = model%solver == solver_by_size
      if (.not. model%has_solver_by_size) return
      with_mechanics = any(solves_mechanics(model%steps%analysis))
      associate (nodes => size(model%mesh%node_number))
         reason = trim(', because the nodes have '//to_text(merge(2, 1, with_mechanics)*nodes)// &
            merge(' displacements', ' temperatures ', with_mechanics))
         model%solver = default_solver(real(nodes, dp), with_mechanics)
      end associate
      if (model%solver == solver_mumps) then
         call append(model%notes, 'no *SOLVER: MUMPS'//reason//' (SKYLINE below '// &
            to_text(mumps_from)//')')
      else
         call append(model%notes, 'no *SOLVER: SKYLINE'//reason//' (MUMPS from '// &
            to_text(mumps_from)//' on)')
      end if
   end subroutine vary

   !> Order of the elements of a variation.
   pure integer function order_of(model, variation)
      type(model_type), intent(in) :: model
      type(variation_type), intent(in) :: variation

      order_of = merge(model%written_order, variation%order, variation%order == as_written)
   end function order_of

   !> Varies all but the mesh.
   !> *VERIFY cards that increments land on still make them land; where the increments vary, the
   !> others are left out, for a fixed increment of another size need not end there. Rounds of a
   !> requested accuracy leave out what is expected: the first one has judged it.
   pure subroutine apply_variation(variation, model)
      type(variation_type), intent(in) :: variation   !! what is other
      type(model_type), intent(inout) :: model        !! as the deck builder made it
      logical, allocatable :: lands(:)
      real(dp), allocatable :: ends(:)                ! of the steps, total times
      integer :: i, s

      if (variation%solver /= as_written) model%solver = variation%solver
      if (variation%pairing /= as_written) model%contacts%pairing = variation%pairing
      do s = 1, size(model%steps)
         associate (step => model%steps(s))
            if (variation%method /= as_written) step%fixed_point%method = variation%method
            if (variation%tolerance > 0.0_dp) step%fixed_point%tolerance = variation%tolerance
            if (allocated(variation%scheme) .and. solves_heat(step%analysis)) step%scheme = &
               variation%scheme
            step%first_increment = min(step%first_increment*variation%increments, step%period)
            step%smallest_increment = min(step%smallest_increment, step%first_increment)
            step%largest_increment = max(step%largest_increment, step%first_increment)
            step%local_error = step%local_error*variation%increments**2
            step%max_increments = ceiling(step%max_increments/min(variation%increments, 1.0_dp))
         end associate
      end do
      allocate (lands(size(model%verifications)), source=.true.)
      if (allocated(variation%divisions)) then
         lands = .not. model%verifications%expects
      else if (any(model%steps%direct) .and. abs(variation%increments - 1.0_dp) > 0.0_dp) then
         ends = [(sum(model%steps(:s)%period), s=1, size(model%steps))]
         do i = 1, size(lands)
            associate (check => model%verifications(i))
               lands(i) = .not. check%at_last
               if (lands(i)) lands(i) = .not. model%steps(min(1 + count(check%when > ends), &
                  size(ends)))%direct
            end associate
         end do
      end if
      model%verifications = model%verifications(pack([(i, i=1, size(lands))], lands))
   end subroutine apply_variation

   !> Divides the elements of a mesh: all of them, then those of each region of the deck and at the
   !> contact faces, then those that the variation marks, as often as it does, and those at points,
   !> each time those that are left there.
   !> Errors: as divide_once.
   subroutine divide_mesh(variation, model, error)
      type(variation_type), intent(in) :: variation
      type(model_type), intent(inout) :: model
      type(error_type), allocatable, intent(out) :: error
      type(refined_region_type), allocatable :: regions(:)
      integer, allocatable :: chosen(:), levels(:)
      integer :: i, k, level

      level = merge(model%written_levels, variation%levels, variation%levels == as_written)
      model%memory_needed = memory_needed(model, level, order_of(model, variation))
      call allow_memory(model, error)
      if (allocated(error)) return
      call refine(model, level)
      regions = model%regions
      if (variation%contact_levels > 0) regions = [regions, refined_region_type( &
         levels=variation%contact_levels, surfaces=[model%contacts%slave, model%contacts%master])]
      do i = 1, size(regions)
         do level = 1, regions(i)%levels
            levels = merge(1, 0, elements_in_region(model%mesh, regions(i)))
            call divide_once(variation, regions(i)%card, model, levels, error)
            if (allocated(error)) return
         end do
      end do
      if (.not. allocated(variation%divisions)) return
      do i = 1, size(variation%divisions)
         associate (marked => variation%divisions(i))
            levels = marked%levels
            do while (any(levels > 0))
               call divide_once(variation, 0, model, levels, error)
               if (allocated(error)) return
            end do
            do level = 1, maxval(marked%point_levels)
               chosen = pack([(k, k=1, size(marked%point_levels))], marked%point_levels >= level)
               levels = merge(1, 0, elements_at_points(model%mesh, marked%points(:, chosen)))
               call divide_once(variation, 0, model, levels, error)
               if (allocated(error)) return
            end do
         end associate
      end do
   end subroutine divide_mesh

   !> Divides the elements with levels above 0, and those that must be divided with them.
   !> Errors: status_deck, where the mesh would have more elements than can be numbered; as
   !> check_memory.
   subroutine divide_once(variation, card, model, levels, error)
      type(variation_type), intent(in) :: variation
      integer, intent(in) :: card                          ! card image that asks for it, or 0
      type(model_type), intent(inout) :: model
      integer, allocatable, intent(inout) :: levels(:)     ! (elements); receives what is left
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: fault
      logical :: chosen(size(levels))

      chosen = levels > 0
      call choose_neighbours(model, chosen)
      fault = numbering_fault(model%mesh, size(chosen, kind=long) + 3*count(chosen, kind=long))
      if (len(fault) > 0) then
         call set_error(error, status_deck, fault, card)
         return
      end if
      call refine_chosen(model, chosen, levels)
      model%memory_needed = memory_needed(model, 0, order_of(model, variation))
      call allow_memory(model, error)
   end subroutine divide_once

   !> Compares the memory that a run needs with what it may have; says what of the deck holds the
   !> contact unknowns of many bodies in one full matrix.
   !> Error: as check_memory.
   subroutine allow_memory(model, error)
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      call check_memory(model%memory_needed, error)
      if (.not. allocated(error) .or. model%mesh%body_count <= 2) return
      if (needs_full_tail(model)) error%message = error%message//'; *CONTINUATION needs '// &
         'derivatives between all contact points, and with them a full matrix'
   end subroutine allow_memory

   !> Makes the elements of a model linear ones, as ORDER=1 asks.
   !> Error: status_deck, where an element without its midside nodes is inverted.
   subroutine lower_order(model, error)
      type(model_type), intent(inout) :: model   !! refined, with its loads
      type(error_type), allocatable, intent(out) :: error
      integer :: e, nodes

      nodes = size(model%mesh%node_number)
      call reduce_order(model)
      call apply_requests(model)
      nodes = nodes - size(model%mesh%node_number)
      if (nodes == 0) then
         call append(model%notes, 'ORDER=1 changes nothing: no element has midside nodes')
         return
      end if
      call append(model%notes, 'ORDER=1: elements without midside nodes; '//to_text(nodes)// &
         ' nodes are dropped')
      associate (mesh => model%mesh)
         do e = 1, size(mesh%element_number)
            if (all(point_jacobians(mesh, e) > 0.0_dp)) cycle
            call set_error(error, status_deck, 'the Jacobian of element '// &
               to_text(mesh%element_number(e))//' is not positive without midside nodes: its '// &
               'sides are too curved for ORDER=1', model%order_place%image)
            error%column = model%order_place%column
            return
         end do
      end associate
   end subroutine lower_order

end module variations
