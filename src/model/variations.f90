!> Variations of a deck: the same model with another mesh, other increments or another method.
module variations
   use controls, only: thermal_scheme_type
   use kinds, only: dp
   use model, only: model_type, verify_type
   use refined_regions, only: division_type, refined_region_type
   use steps, only: solves_heat
   implicit none
   private
   public :: variation_type, apply_variation, add_contact_levels, varied_increment
   public :: as_written

   integer, parameter :: as_written = -1   !! what the deck says holds

   !> What is other than in the deck.
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
      type(division_type), allocatable :: divisions(:)
   end type variation_type

contains

   !> Varies a model that was built from the cards, before its mesh is made linear or refined.
   !> *VERIFY cards that increments land on still make them land; the others are left out, for a
   !> fixed increment of another size need not end there. Rounds of a requested accuracy leave all
   !> out: the first one has judged them.
   pure subroutine apply_variation(variation, order, levels, model)
      type(variation_type), intent(in) :: variation   !! what is other
      integer, intent(inout) :: order                 !! order of the elements
      integer, intent(inout) :: levels                !! refinements that are to be made
      type(model_type), intent(inout) :: model
      integer :: s

      model%written_order = order
      model%written_levels = levels
      if (variation%order /= as_written) order = variation%order
      if (variation%levels /= as_written) levels = variation%levels
      if (variation%solver /= as_written) model%solver = variation%solver
      if (variation%pairing /= as_written) model%contacts%pairing = variation%pairing
      do s = 1, size(model%steps)
         associate (step => model%steps(s))
            if (variation%method /= as_written) step%fixed_point%method = variation%method
            if (variation%tolerance > 0.0_dp) step%fixed_point%tolerance = variation%tolerance
            if (allocated(variation%scheme) .and. solves_heat(step%analysis)) then
               step%scheme = variation%scheme
            end if
            step%first_increment = varied_increment(step%first_increment, step%period, &
               variation%increments)
            step%smallest_increment = min(step%smallest_increment, step%first_increment)
            step%largest_increment = max(step%largest_increment, step%first_increment)
            step%max_increments = ceiling(step%max_increments/min(variation%increments, 1.0_dp))
         end associate
      end do
      if (allocated(variation%divisions)) then
         deallocate (model%verifications)
         allocate (model%verifications(0))
      else if (any(model%steps%direct)) then
         call keep_landings(model)
      end if
   end subroutine apply_variation

   !> Refines the contact faces after the regions of the deck.
   pure subroutine add_contact_levels(variation, model, regions)
      type(variation_type), intent(in) :: variation   !! what is other
      type(model_type), intent(in) :: model           !! its contacts
      type(refined_region_type), allocatable, intent(inout) :: regions(:)   !! receives the faces
      type(refined_region_type) :: faces

      if (variation%contact_levels == 0) return
      faces%levels = variation%contact_levels
      faces%surfaces = [model%contacts%slave, model%contacts%master]
      regions = [regions, faces]
   end subroutine add_contact_levels

   !> An increment that a factor makes longer or shorter; none is longer than its step.
   elemental function varied_increment(first, period, factor) result(increment)
      real(dp), intent(in) :: first    !! first increment as written [time]
      real(dp), intent(in) :: period   !! length of the step [time]
      real(dp), intent(in) :: factor   !! factor on its size
      real(dp) :: increment            !! the size that it has then [time]

      increment = min(first*factor, period)
   end function varied_increment

   !> Leaves the *VERIFY cards of steps with fixed increments out.
   pure subroutine keep_landings(model)
      type(model_type), intent(inout) :: model
      type(verify_type), allocatable :: kept(:)
      logical :: lands(size(model%verifications))
      integer :: i, n

      do i = 1, size(lands)
         associate (check => model%verifications(i))
            lands(i) = .not. check%at_last
            if (lands(i)) lands(i) = .not. model%steps(step_at(model, check%when))%direct
         end associate
      end do
      allocate (kept(count(lands)))
      n = 0
      do i = 1, size(lands)
         if (.not. lands(i)) cycle
         n = n + 1
         kept(n) = model%verifications(i)
      end do
      call move_alloc(kept, model%verifications)
   end subroutine keep_landings

   !> The step in which a total time lies.
   pure integer function step_at(model, time)
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: time
      real(dp) :: ending

      ending = 0.0_dp
      do step_at = 1, size(model%steps) - 1
         ending = ending + model%steps(step_at)%period
         if (time <= ending) return
      end do
   end function step_at

end module variations
