!> Which rows a trade has: the grid over mesh, increments and elements, level by level; meshes that
!> are finer at the contact faces; and one thing at a time around the deck as it is written.
module trade_plan
   use contact_definitions, only: pairing_name
   use controls, only: crank_nicolson_scheme, explicit_scheme, galerkin_scheme, implicit_scheme, &
      method_names, solver_mumps, solver_skyline, thermal_scheme_type
   use element_kinds, only: quad8, quad8_reduced, triangle6
   use kinds, only: dp
   use model, only: model_type
   use steps, only: analysis_coupled, solves_heat
   use text, only: to_text
   use trade_rows, only: trade_row_type, trade_type
   use variations, only: variation_type, varied_increment
   implicit none
   private
   public :: make_room, add_level, add_contact_level, add_singles, find_row
   public :: factors, longest_factor, most_levels

   !> Factors on the increments of the deck, each half the one before.
   real(dp), parameter :: factors(5) = [4.0_dp, 2.0_dp, 1.0_dp, 0.5_dp, 0.25_dp]
   real(dp), parameter :: longest_factor = 4.0_dp   !! the first of them
   integer, parameter :: most_levels = 3            !! refinements beyond those of the deck
   real(dp), parameter :: tolerances(4) = [1.0e-3_dp, 1.0e-5_dp, 1.0e-8_dp, 1.0e-11_dp]
   integer, parameter :: most_singles = 17          !! rows that vary one thing

   !> Factors of the rows whose meshes are finer at the contact faces.
   real(dp), parameter :: local_factors(2) = [longest_factor, 1.0_dp]
   type(thermal_scheme_type), parameter :: schemes(4) = [implicit_scheme, galerkin_scheme, &
      crank_nicolson_scheme, explicit_scheme]

contains

   !> Makes room for all rows that there can be.
   pure subroutine make_room(model, trade)
      type(model_type), intent(in) :: model        !! the model on the deck's mesh
      type(trade_type), intent(inout) :: trade     !! receives the room

      associate (levels => model%written_levels + most_levels)
         allocate (trade%rows(2*size(factors)*(levels + 1) + &
            size(local_factors)*levels*(levels + 1)/2 + most_singles))
      end associate
      allocate (trade%left_out(0))
   end subroutine make_room

   !> Adds the rows of the grid on one level: elements by increments. What has no effect on the deck
   !> is not varied.
   pure subroutine add_level(model, level, trade)
      type(model_type), intent(in) :: model       !! the model on the deck's mesh
      integer, intent(in) :: level                !! refinements of that mesh
      type(trade_type), intent(inout) :: trade    !! receives the rows
      type(trade_row_type) :: row
      integer :: order, f

      do order = 1, merge(2, 1, is_quadratic(model))
         do f = 1, size(factors)
            if (.not. is_new(model, f)) cycle
            row = trade_row_type()
            row%order = order
            row%level = level
            row%variation%order = order
            row%variation%levels = level
            row%variation%increments = factors(f)
            row%varied = ''
            row%reason = ''
            row%is_default = order == default_order(model) .and. level == model%written_levels &
               .and. abs(factors(f) - 1.0_dp) <= 0.0_dp
            call add(trade, row)
         end do
      end do
   end subroutine add_level

   !> Adds the rows with the deck's elements whose meshes have some levels more at the contact
   !> faces, on all levels that leave room for these. A deck without contact has none.
   pure subroutine add_contact_level(model, contact_level, trade)
      type(model_type), intent(in) :: model       !! the model on the deck's mesh
      integer, intent(in) :: contact_level        !! refinements of contact faces, at least 1
      type(trade_type), intent(inout) :: trade    !! receives the rows
      type(trade_row_type) :: row
      integer :: level, f

      if (size(model%contacts) == 0) return
      do level = 0, model%written_levels + most_levels - contact_level
         do f = 1, size(factors)
            if (all(abs(factors(f) - local_factors) > 0.0_dp)) cycle
            if (.not. is_new(model, f)) cycle
            row = trade_row_type()
            row%order = default_order(model)
            row%level = level
            row%contact_level = contact_level
            row%variation%order = row%order
            row%variation%levels = level
            row%variation%contact_levels = contact_level
            row%variation%increments = factors(f)
            row%is_grid = .false.
            row%varied = ''
            row%reason = ''
            call add(trade, row)
         end do
      end do
   end subroutine add_contact_level

   !> Adds the rows that vary one thing, each where the deck has a use for it.
   pure subroutine add_singles(model, other_pairing, trade)
      type(model_type), intent(in) :: model        !! the model on the deck's mesh
      integer, intent(in) :: other_pairing         !! pairing that the deck could have too, or 0
      type(trade_type), intent(inout) :: trade     !! receives the rows
      integer :: i, coupled, heated

      coupled = first_coupled(model)
      heated = first_heat(model)
      associate (fixed_point => model%steps(coupled)%fixed_point, &
         scheme => model%steps(heated)%scheme)
         do i = 1, size(tolerances)
            if (.not. is_coupled(model)) exit
            if (abs(tolerances(i)/fixed_point%tolerance - 1.0_dp) < 0.5_dp) cycle
            call add_single(model, 'TOL='//to_text(tolerances(i)), &
               variation_type(tolerance=tolerances(i)), trade)
         end do
         do i = 1, size(schemes)
            if (.not. any(solves_heat(model%steps%analysis))) exit
            if (schemes(i)%name == scheme%name) cycle
            call add_single(model, trim(schemes(i)%name), variation_type(scheme=schemes(i)), trade)
         end do
         do i = 1, size(method_names)
            if (.not. is_coupled(model)) exit
            if (i == fixed_point%method) cycle
            call add_single(model, trim(method_names(i)), variation_type(method=i), trade)
         end do
      end associate
      if (other_pairing /= 0) call add_single(model, pairing_name(other_pairing), &
         variation_type(pairing=other_pairing), trade)
      if (model%solver == solver_skyline) then
         call add_single(model, 'MUMPS', variation_type(solver=solver_mumps), trade)
      else
         call add_single(model, 'SKYLINE', variation_type(solver=solver_skyline), trade)
      end if
   end subroutine add_singles

   pure subroutine add_single(model, varied, variation, trade)
      type(model_type), intent(in) :: model
      character(*), intent(in) :: varied
      type(variation_type), intent(in) :: variation   ! of one thing
      type(trade_type), intent(inout) :: trade
      type(trade_row_type) :: row

      row%order = default_order(model)
      row%level = model%written_levels
      row%variation = variation
      row%variation%order = row%order
      row%variation%levels = row%level
      row%is_grid = .false.
      row%varied = varied
      row%reason = ''
      call add(trade, row)
   end subroutine add_single

   pure subroutine add(trade, row)
      type(trade_type), intent(inout) :: trade
      type(trade_row_type), intent(in) :: row

      trade%count = trade%count + 1
      trade%rows(trade%count) = row
   end subroutine add

   !> Index of the row with these elements, mesh and increments that varies nothing else; 0 for
   !> none.
   pure integer function find_row(trade, order, level, contact_level, factor)
      type(trade_type), intent(in) :: trade
      integer, intent(in) :: order            !! order of the elements
      integer, intent(in) :: level            !! refinements
      integer, intent(in) :: contact_level    !! more of them at the contact faces
      real(dp), intent(in) :: factor          !! factor on the increments

      do find_row = trade%count, 1, -1
         associate (row => trade%rows(find_row))
            if (.not. (row%is_grid .or. row%contact_level > 0)) cycle
            if (row%order == order .and. row%level == level .and. &
               row%contact_level == contact_level .and. &
               abs(row%variation%increments - factor) <= 0.0_dp) return
         end associate
      end do
   end function find_row

   !> Whether a factor gives other increments than the one half of it.
   pure logical function is_new(model, f)
      type(model_type), intent(in) :: model
      integer, intent(in) :: f

      is_new = f == size(factors)
      if (is_new) return
      associate (first => model%steps%first_increment, period => model%steps%period)
         is_new = any(varied_increment(first, period, factors(f)) > &
            1.001_dp*varied_increment(first, period, factors(f + 1)))
      end associate
   end function is_new

   pure logical function is_quadratic(model)
      type(model_type), intent(in) :: model
      integer :: e

      is_quadratic = .false.
      do e = 1, size(model%mesh%element_kind)
         is_quadratic = is_quadratic .or. &
            any(model%mesh%element_kind(e) == [quad8, quad8_reduced, triangle6])
      end do
   end function is_quadratic

   !> Order of the elements as the deck is written.
   pure integer function default_order(model)
      type(model_type), intent(in) :: model

      default_order = min(model%written_order, merge(2, 1, is_quadratic(model)))
   end function default_order

   pure logical function is_coupled(model)
      type(model_type), intent(in) :: model

      is_coupled = size(model%contacts) > 0 .and. any(model%steps%analysis == analysis_coupled)
   end function is_coupled

   pure integer function first_coupled(model)
      type(model_type), intent(in) :: model

      first_coupled = max(findloc(model%steps%analysis == analysis_coupled, .true., dim=1), 1)
   end function first_coupled

   pure integer function first_heat(model)
      type(model_type), intent(in) :: model

      first_heat = max(findloc(solves_heat(model%steps%analysis), .true., dim=1), 1)
   end function first_heat

end module trade_plan
