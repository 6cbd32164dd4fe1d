!> Whether the equations of the deck say something new; whether what supports prescribe on both
!> sides of a tie agrees with it, and leaves contact points open whose motion it determines.
module constraint_checks
   use connections, only: connections_type
   use contact_pairs, only: touching
   use constraint_rows, only: constraint_rows_type, of_contact, of_equation, of_support, of_tie, &
      origins_of, row_origin_type
   use field_constraints, only: displacement_rows, find_prescribed, temperature_rows
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp
   use linear_constraints, only: linear_constraints_type
   use load_histories, only: load_history_type
   use loads, only: loads_type
   use model, only: model_type
   use reduced_bodies, only: reduced_bodies_type
   use steps, only: solves_heat, solves_mechanics
   use text, only: to_text
   implicit none
   private
   public :: check_equations, check_prescribed

   !> Part of the prescribed values by which they may miss what a tie asks for. Decks give them to a
   !> few digits.
   real(dp), parameter :: agreed = 1.0e-6_dp

contains

   !> Checks the constraints of a step.
   !> Error: an equation that follows from supports or from other equations, or contradicts them.
   subroutine check_equations(model, bodies, loads, step, error)
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies       !! numbered for the step
      type(loads_type), intent(in) :: loads                 !! supports of the step
      integer, intent(in) :: step                           !! the step
      type(error_type), allocatable, intent(out) :: error
      type(constraint_rows_type) :: rows
      logical :: as_found(size(bodies%points%slave))

      as_found = .false.
      associate (analysis => model%steps(step)%analysis, points => bodies%points)
         if (solves_mechanics(analysis)) then
            if (any(bodies%mechanical%map%condition%kind == of_equation)) then
               rows = displacement_rows(loads%displacement%active, points, as_found)
               call check_field(model, points, bodies%mechanical%map, rows, loads%displacement, &
                  error)
            end if
         end if
         if (allocated(error) .or. .not. solves_heat(analysis)) return
         if (.not. any(bodies%thermal%map%condition%kind == of_equation)) return
         rows = temperature_rows(loads%temperature%active, points, as_found)
         call check_field(model, points, bodies%thermal%map, rows, loads%temperature, error)
      end associate
   end subroutine check_equations

   !> Reports the first equation of a field that is left no degree of freedom.
   subroutine check_field(model, points, map, rows, supports, error)
      type(model_type), intent(in) :: model
      type(connections_type), intent(in) :: points
      type(linear_constraints_type), intent(in) :: map
      type(constraint_rows_type), intent(in) :: rows
      type(load_history_type), intent(in) :: supports
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: others
      integer :: i
      logical :: supported

      do i = 1, size(map%condition)
         if (map%condition(i)%kind /= of_equation) cycle
         call name_origins(model, points, rows, supports, map%condition(i), others, supported)
         if (len(others) == 0) cycle
         associate (own => points%equations(map%condition(i)%number))
            if (supported) then
               call set_error(error, status_deck, own%title//' is over-determined: all its '// &
                  'degrees of freedom are prescribed by '//others//'; free one '// &
                  'of them, or leave it out', own%card)
            else
               call set_error(error, status_deck, own%title//' is circular or repeated: it '// &
                  'follows from '//others//'; leave one out', own%card)
            end if
         end associate
         return
      end do
   end subroutine check_field

   !> The cards from which the rows of a constraint follow, in words, and the axis of symmetry.
   subroutine name_origins(model, points, rows, supports, constraint, names, supported)
      type(model_type), intent(in) :: model
      type(connections_type), intent(in) :: points
      type(constraint_rows_type), intent(in) :: rows
      type(load_history_type), intent(in) :: supports
      type(row_origin_type), intent(in) :: constraint
      character(:), allocatable, intent(out) :: names
      logical, intent(out) :: supported             ! whether supports are among them
      type(row_origin_type), allocatable :: origins(:)
      character(:), allocatable :: name
      integer :: i

      names = ''
      supported = .false.
      origins = origins_of(rows, constraint)
      do i = 1, size(origins)
         associate (number => origins(i)%number)
            select case (origins(i)%kind)
            case (of_tie)
               name = model%ties(points%ties%tie(number))%faces%title()
            case (of_support)
               supported = .true.
               name = 'the axis of symmetry'
               if (supports%card(number) > 0) name = '*BOUNDARY, '// &
                  model%boundary_places(supports%card(number))%value
            case (of_equation)
               name = points%equations(number)%title
            case default
               name = ''
            end select
         end associate
         if (len(name) == 0 .or. index(names//' and ', name//' and ') > 0) cycle
         if (len(names) > 0) names = names//' and '
         names = names//name
      end do
   end subroutine name_origins

   !> Sees whether the values that supports prescribe now satisfy the ties they leave no choice, and
   !> leave gaps at contact points that they move.
   !> Errors: a tie that they do not satisfy, with the nodes; a contact point that they close, whose
   !> force is undetermined.
   subroutine check_prescribed(model, bodies, loads, step, error)
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies       !! numbered for the step
      type(loads_type), intent(in) :: loads                 !! loads at the instant
      integer, intent(in) :: step                           !! the step
      type(error_type), allocatable, intent(out) :: error

      associate (analysis => model%steps(step)%analysis)
         if (solves_mechanics(analysis)) then
            call check_given(model, bodies, bodies%mechanical%map, loads%displacement%value, error)
            if (.not. allocated(error)) call check_gaps(model, bodies, loads, error)
         end if
         if (allocated(error) .or. .not. solves_heat(analysis)) return
         call check_given(model, bodies, bodies%thermal%map, loads%temperature%value, error)
      end associate
   end subroutine check_prescribed

   !> Reports a contact point that is prescribed and not open.
   subroutine check_gaps(model, bodies, loads, error)
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      type(loads_type), intent(in) :: loads
      type(error_type), allocatable, intent(out) :: error
      logical, dimension(size(bodies%points%slave)) :: along_normal, is_open, prescribed
      character(:), allocatable :: others
      type(constraint_rows_type) :: rows
      logical :: supported
      integer :: i, k

      associate (points => bodies%points, map => bodies%mechanical%map, &
         number => model%mesh%node_number)
         if (map%link_unknowns%count == 0) return
         call find_prescribed(map, prescribed, along_normal)
         if (.not. any(prescribed)) return
         is_open = bodies%laws%removed .or. along_normal .and. loads%present_gaps(points) - &
            sum(points%normal*points%relative(map%supported(loads%displacement%value)), dim=1) > &
            touching*maxval(abs(model%mesh%coordinates))
         k = findloc(prescribed .and. .not. is_open, .true., dim=1)
         if (k == 0) return
         is_open = .false.
         rows = displacement_rows(loads%displacement%active, points, is_open)
         call name_origins(model, points, rows, loads%displacement, &
            row_origin_type(of_contact, k), others, supported)
         i = points%interface(k)
         call set_error(error, status_deck, model%contacts(i)%title()//': how slave node '// &
            to_text(number(points%slave(k)))//' moves against master node '// &
            to_text(number(points%master(k)))//' is prescribed by '//others//', and leaves no '// &
            'gap between them, so that their contact force is undetermined; free one of the '// &
            'two along the normal of the faces, or leave the nodes out of the *CONTACT PAIR', &
            model%contacts(i)%card)
      end associate
   end subroutine check_gaps

   subroutine check_given(model, bodies, map, given, error)
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      type(linear_constraints_type), intent(in) :: map
      real(dp), intent(in) :: given(:)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: left(map%condition_given%count)
      integer :: i

      if (size(model%ties) == 0) return
      left = 0.0_dp
      call map%condition_given%add_totals(given, left)
      do i = 1, size(left)
         associate (dofs => map%condition_given%values_of(i))
            if (size(dofs) == 0 .or. map%condition(i)%kind /= of_tie) cycle
            if (abs(left(i)) <= agreed*maxval(abs(given(dofs)))) cycle
            call blame_tie(model, bodies, map, i, left(i), error)
            return
         end associate
      end do
   end subroutine check_given

   !> Names the tie and the two prescribed nodes that count most, one for either sign.
   subroutine blame_tie(model, bodies, map, i, difference, error)
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
   end subroutine blame_tie

end module constraint_checks
