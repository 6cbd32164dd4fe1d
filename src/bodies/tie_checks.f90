!> Whether what supports prescribe on both sides of a tie agrees with it.
module tie_checks
   use constraint_rows, only: of_tie
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp
   use linear_constraints, only: linear_constraints_type
   use loads, only: loads_type
   use model, only: model_type
   use reduced_bodies, only: reduced_bodies_type
   use steps, only: solves_heat, solves_mechanics
   use text, only: to_text
   implicit none
   private
   public :: check_prescribed_ties

   !> Part of the prescribed values by which they may miss what a tie asks for. Decks give them to a
   !> few digits.
   real(dp), parameter :: agreed = 1.0e-6_dp

contains

   !> Sees whether the values that supports prescribe now satisfy the ties they leave no choice.
   !> Error: a tie that they do not satisfy, with the nodes.
   subroutine check_prescribed_ties(model, bodies, loads, step, error)
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies       !! numbered for the step
      type(loads_type), intent(in) :: loads                 !! loads at the instant
      integer, intent(in) :: step                           !! the step
      type(error_type), allocatable, intent(out) :: error

      if (size(model%ties) == 0) return
      associate (analysis => model%steps(step)%analysis)
         if (solves_mechanics(analysis)) call check_field(model, bodies, bodies%mechanical%map, &
            loads%displacement%value, error)
         if (allocated(error) .or. .not. solves_heat(analysis)) return
         call check_field(model, bodies, bodies%thermal%map, loads%temperature%value, error)
      end associate
   end subroutine check_prescribed_ties

   subroutine check_field(model, bodies, map, given, error)
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      type(linear_constraints_type), intent(in) :: map
      real(dp), intent(in) :: given(:)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: left(map%condition_given%count)
      integer :: i

      left = 0.0_dp
      call map%condition_given%add_totals(given, left)
      do i = 1, size(left)
         associate (dofs => map%condition_given%values_of(i))
            if (size(dofs) == 0 .or. map%condition(i)%kind /= of_tie) cycle
            if (abs(left(i)) <= agreed*maxval(abs(given(dofs)))) cycle
            call blame(model, bodies, map, i, left(i), error)
            return
         end associate
      end do
   end subroutine check_field

   !> Names the tie and the two prescribed nodes that count most, one for either sign.
   subroutine blame(model, bodies, map, i, difference, error)
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      type(linear_constraints_type), intent(in) :: map
      integer, intent(in) :: i
      real(dp), intent(in) :: difference
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: what
      integer :: component, nodes(2)

      associate (dofs => map%condition_given%values_of(i), &
         share => map%condition_given%coefficients_of(i), &
         tie => model%ties(bodies%points%ties%tie(map%condition(i)%number)))
         nodes = (dofs([maxloc(share, dim=1), minloc(share, dim=1)]) - 1)/map%components + 1
         component = modulo(dofs(1) - 1, map%components) + 1
         what = 'temperatures'
         if (map%components == 2) what = 'displacements along '//merge('x', 'y', component == 1)
         call set_error(error, status_deck, tie%faces%title()//': *BOUNDARY prescribes '//what// &
            ' at nodes '//to_text(model%mesh%node_number(nodes(1)))//' and '// &
            to_text(model%mesh%node_number(nodes(2)))//' that differ by '// &
            to_text(abs(difference))//', but the tie makes them equal; prescribe equal values, '// &
            'or free one of the two', tie%faces%card)
      end associate
   end subroutine blame

end module tie_checks
