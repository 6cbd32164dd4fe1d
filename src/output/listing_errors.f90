!> Errors in the listing: of bodies in the energy norm, and bounds of those of an interface's
!> quantities, with the parts of mesh, increments and iteration beside each other.
module listing_errors
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use contact_points, only: contact_points_type
   use contact_quantities, only: estimated
   use increment_quantities, only: body_values
   use interface_quantities, only: is_end_of_face
   use kinds, only: dp
   use listing_text, only: column, page_width, print_wrapped
   use quantity_types, only: of_bodies, quantity_type
   use records, only: increment_record_type, interface_errors_type
   use summary, only: words_of
   use reported_quantities, only: quantities
   implicit none
   private
   public :: print_body_errors, print_interface_errors

   character(*), parameter :: kinds_of_error(3) = [character(10) :: 'mesh', 'increments', &
      'iteration']

contains

   !> Prints how large the discretisation error of each body is estimated, in the energy norm,
   !> relative to stress and heat flux, at the end of a step.
   subroutine print_body_errors(unit, record)
      integer, intent(in) :: unit                         !! unit of the listing
      type(increment_record_type), intent(in) :: record
      type(quantity_type), allocatable :: errors(:)
      real(dp), allocatable :: values(:)
      character(:), allocatable :: line
      integer :: b, bodies, i

      if (.not. record%last_of_step) return
      errors = pack(quantities, quantities%kind == of_bodies)
      bodies = 0
      do i = 1, size(errors)
         bodies = max(bodies, size(body_values(errors(i)%name, record)))
      end do
      do b = 1, bodies
         line = ''
         do i = 1, size(errors)
            values = body_values(errors(i)%name, record)
            if (b > size(values)) cycle
            line = line//'   '//trim(errors(i)%label)//column(values(b), 9, 2)
         end do
         write (unit, '(3x, a, i0, 2a)') 'estimated error of the mesh, body ', b, line, &
            '  (energy norm, relative)'
      end do
   end subroutine print_body_errors

   !> Prints the bounds of an interface. What has no value, or no part in the deck, is left out, and
   !> so are edges at the end of the face.
   subroutine print_interface_errors(unit, points, errors)
      integer, intent(in) :: unit                          !! unit of the listing
      type(contact_points_type), intent(in) :: points      !! the contact points of the interface
      type(interface_errors_type), intent(in) :: errors
      character(page_width) :: line
      integer :: k, q, width
      logical :: is_told(size(estimated))

      width = maxval([(len(words_of(estimated(q)%name)), q=1, size(estimated))])
      write (unit, '(/, 3a)') '   BOUNDS OF THE ERRORS OF ', points%name, &
         ': how far values may be off to either side, with the parts of each bound'
      write (unit, '(4x, a, a14, a13, a11, a12, 2a14, a14)') repeat(' ', width), 'value', &
         'bound', '%', 'mesh', 'increments', 'iteration', 'largest part'
      do q = 1, size(estimated)
         associate (value => errors%value(q), bound => errors%bound(q))
            is_told(q) = is_worth_telling(q, value, bound) .and. &
               .not. is_end_of_face(estimated(q), points, value)
            if (.not. is_told(q)) cycle
            write (line, '(4x, a, a14, a13, a11, a12, 2a14, a14)') &
               name_of(q, width), column(value, 14, 6), bound_word(bound), &
               percent(bound, value), shown(errors%mesh(q), 12), shown(errors%increment(q), 14), &
               shown(errors%iteration(q), 14), largest_part(errors, q)
            write (unit, '(a)') trim(line)
         end associate
      end do
      do q = 1, size(estimated)
         associate (why_not => errors%why_not(q)%value)
            if (why_not == '' .or. .not. is_told(q)) cycle
            if (any([(is_told(k) .and. errors%why_not(k)%value == why_not, k=1, q - 1)])) cycle
            call print_wrapped(unit, '    ', 'uncertain: '//why_not)
         end associate
      end do
   end subroutine print_interface_errors

   !> The name of an estimated quantity in words.
   pure function name_of(q, width) result(name)
      integer, intent(in) :: q, width
      character(width) :: name

      name = words_of(estimated(q)%name)
   end function name_of

   !> Whether a quantity has a value and a part in the deck; that of friction is 0 without it.
   pure logical function is_worth_telling(q, value, bound)
      integer, intent(in) :: q
      real(dp), intent(in) :: value, bound

      is_worth_telling = .not. ieee_is_nan(value)
      if (.not. is_worth_telling) return
      is_worth_telling = abs(value) > 0.0_dp
      if (is_worth_telling .or. estimated(q)%is_of_friction .or. ieee_is_nan(bound)) return
      is_worth_telling = bound > 0.0_dp
   end function is_worth_telling

   !> A bound, or the word where there is none.
   function bound_word(bound) result(string)
      real(dp), intent(in) :: bound
      character(13) :: string

      string = '    uncertain'
      if (.not. ieee_is_nan(bound)) string = column(bound, 13, 2)
   end function bound_word

   function shown(value, width) result(string)
      real(dp), intent(in) :: value
      integer, intent(in) :: width
      character(width) :: string

      string = repeat(' ', width - 1)//'-'
      if (.not. ieee_is_nan(value)) string = column(value, width, 2)
   end function shown

   function percent(bound, value) result(string)
      real(dp), intent(in) :: bound, value
      character(11) :: string

      string = repeat(' ', 10)//'-'
      if (ieee_is_nan(bound)) return
      if (abs(value) > 0.0_dp) string = column(100.0_dp*bound/abs(value), 11, 2)
   end function percent

   !> Which part of a bound is the largest.
   pure function largest_part(errors, q) result(name)
      type(interface_errors_type), intent(in) :: errors
      integer, intent(in) :: q
      character(10) :: name
      real(dp) :: parts(3)
      integer :: k

      parts = [errors%mesh(q), errors%increment(q), errors%iteration(q)]
      name = ''
      if (any(ieee_is_nan(parts))) return
      k = maxloc(parts, dim=1)
      if (parts(k) > 0.0_dp) name = kinds_of_error(k)
   end function largest_part

end module listing_errors
