!> A run as one document in JSON, which `--json` prints, and as a row of a table of runs: its
!> results at the last increment, with their uncertainties, and its checks. docs/results.md
!> describes the document, docs/batch.md the row.
module run_documents
   use contact_extents, only: is_end_of_face
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_table, contact_values, estimated, has_quantity
   use contact_system, only: contact_open
   use field_quantities, only: maxima
   use increment_quantities, only: history_estimated, leading_words, stability_words
   use json, only: json_type
   use kinds, only: dp
   use model, only: model_type
   use no_estimates, only: no_finer_value, no_reason, reason_inside_step, reason_without_check, &
      words_of_reason
   use quantity_types, only: find_quantity, of_interface, quantity_type
   use records, only: uncertainty_type
   use result_rows, only: result_row_type
   use summary, only: heat_quantities, heat_units, summary_type
   use text, only: or_blank, to_text
   use unit_labels, only: unit_in_words
   use verification, only: verifier_type
   implicit none
   private
   public :: put_summary, put_checks

contains

   !> Adds the results of the last increment; before the first one its number 0 alone.
   subroutine put_summary(document, row, summary, model, interfaces)
      type(json_type), intent(inout) :: document
      type(result_row_type), intent(inout) :: row
      type(summary_type), intent(in) :: summary
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:)   !! contact points of every interface
      character(:), allocatable :: stability
      logical :: has_leading
      integer :: i

      call document%open('{', 'summary')
      call document%put(summary%last%increment, 'increment')
      if (summary%last%increment > 0) then
         call document%put(summary%last%time, 'time')
         call document%put(summary%last%load, 'load')
         call document%put(or_blank(model%load_label), 'load_label')
         if (allocated(summary%last%load_factor)) call document%put(summary%last%load_factor, &
            'load_factor')
         stability = stability_words(summary%last, or_blank(model%units%time))
         if (stability /= '') call document%put(stability, 'stability')
         has_leading = leading_words(summary%last, '') /= ''
         if (has_leading) then
            call document%open('[', 'leading_modes')
            do i = 1, size(summary%last%stability%leading, 2)
               call document%open('{')
               call document%put(summary%last%stability%leading(1, i), 'growth_rate')
               call document%put(summary%last%stability%leading(2, i), 'period')
               call document%put(words_of_reason(no_finer_value), 'no_estimate')
               call document%close('}')
            end do
            call document%close(']')
         end if
         call document%open('{', 'interfaces')
         do i = 1, size(interfaces)
            call put_interface(document, row, summary, model, interfaces(i), i)
         end do
         call document%close('}')
         call put_fields(document, row, summary, model)
         call put_bodies(document, row, summary, model)
         if (has_leading) then
            associate (found => summary%last%stability)
               call row%put('unstable_modes', real(found%unstable_modes, dp))
               call row%put('growth_rate', found%leading(1, 1))
               call row%put('period', found%leading(2, 1))
            end associate
         end if
      end if
      call document%close('}')
   end subroutine put_summary

   subroutine put_interface(document, row, summary, model, points, i)
      type(json_type), intent(inout) :: document
      type(result_row_type), intent(inout) :: row
      type(summary_type), intent(in) :: summary
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: i                       ! number of the interface
      type(quantity_type) :: quantity
      real(dp) :: value(1)
      integer :: k, q

      call document%open('{', points%name)
      associate (contact => summary%last%contacts(i))
         call document%put(size(contact%contact_state), 'contact_points')
         call document%put(count(contact%contact_state /= contact_open), 'closed_contact_points')
         do k = 1, size(contact_table)
            quantity = contact_table(k)
            if (quantity%kind /= of_interface .or. quantity%values > 1) cycle
            if (.not. has_quantity(contact, quantity%needs)) cycle
            value = contact_values(quantity%name, contact)
            call open_quantity(document, quantity, value(1), model)
            call row%put(trim(quantity%name)//' '//points%name, value(1))
            q = find_quantity(estimated, quantity%name)
            if (is_end_of_face(quantity, points, value(1))) then
               call document%put('end of the face', 'no_estimate')
            else if (q > 0 .and. allocated(summary%last%uncertainties)) then
               call put_uncertainty(document, row, summary%last%uncertainties(q, i))
            else if (q > 0) then
               call document%put(words_of_reason(reason_inside_step(model)), 'no_estimate')
            else
               call document%put(words_of_reason(reason_without_check(model)), 'no_estimate')
            end if
            call document%close('}')
         end do
      end associate
      call document%close('}')
   end subroutine put_interface

   !> Ranges of the fields, heat, and when all is solid.
   subroutine put_fields(document, row, summary, model)
      type(json_type), intent(inout) :: document
      type(result_row_type), intent(inout) :: row
      type(summary_type), intent(in) :: summary
      type(model_type), intent(in) :: model
      integer :: k

      call document%open('{', 'fields')
      if (allocated(summary%heat)) then
         do k = 1, size(heat_quantities)
            call put_plain(trim(heat_quantities(k)), summary%heat(k), heat_units(k))
         end do
      end if
      if (allocated(summary%displacement)) call put_plain('largest_displacement', &
         summary%displacement, 'length')
      if (allocated(summary%last%solid_time)) call put_plain('solid_time', &
         summary%last%solid_time(1), 'time')
      call document%close('}')
   contains
      subroutine put_plain(name, value, unit)
         character(*), intent(in) :: name, unit
         real(dp), intent(in) :: value
         integer :: q

         call document%open('{', name)
         call document%put(value, 'value')
         call document%put(unit_in_words(unit, model%units), 'unit')
         call row%put(name, value)
         q = find_quantity(history_estimated, name)
         if (q > 0 .and. allocated(summary%last%history_uncertainties)) then
            call put_uncertainty(document, row, summary%last%history_uncertainties(q))
         else if (q > 0) then
            call document%put(words_of_reason(reason_inside_step(model)), 'no_estimate')
         end if
         call document%close('}')
      end subroutine put_plain
   end subroutine put_fields

   !> Maxima of the bodies at the end of a step, with ERRORS=FULL of any increment.
   subroutine put_bodies(document, row, summary, model)
      type(json_type), intent(inout) :: document
      type(result_row_type), intent(inout) :: row
      type(summary_type), intent(in) :: summary
      type(model_type), intent(in) :: model
      type(quantity_type) :: quantity
      integer :: b, k, q

      call document%open('[', 'bodies')
      if (allocated(summary%last%body_uncertainties)) then
         do b = 1, size(summary%last%body_uncertainties)
            call document%open('{')
            associate (errors => summary%last%body_uncertainties(b), number => &
               model%mesh%node_number)
               do q = 1, size(maxima)
                  if (errors%node(q) == 0) cycle
                  quantity = maxima(q)
                  call open_quantity(document, quantity, errors%maxima(q)%value, model)
                  call row%put(trim(quantity%name)//' body '//to_text(b), errors%maxima(q)%value)
                  call document%put(number(errors%node(q)), 'node')
                  call put_uncertainty(document, row, errors%maxima(q))
                  call document%close('}')
               end do
               call document%open('[', 'singular_corners')
               do k = 1, size(errors%corners)
                  call document%put(number(errors%corners(k)))
               end do
               call document%close(']')
            end associate
            call document%close('}')
         end do
      end if
      call document%close(']')
   end subroutine put_bodies

   !> Begins the object of a quantity; the caller closes it.
   subroutine open_quantity(document, quantity, value, model)
      type(json_type), intent(inout) :: document
      type(quantity_type), intent(in) :: quantity
      real(dp), intent(in) :: value
      type(model_type), intent(in) :: model

      call document%open('{', trim(quantity%name))
      call document%put(value, 'value')
      call document%put(unit_in_words(quantity%unit, model%units), 'unit')
   end subroutine open_quantity

   !> The uncertainty of a quantity, or why there is none.
   subroutine put_uncertainty(document, row, own)
      type(json_type), intent(inout) :: document
      type(result_row_type), intent(inout) :: row    ! whose last quantity it is of
      type(uncertainty_type), intent(in) :: own

      if (own%no_estimate == no_reason) then
         call document%put(own%total, 'uncertainty')
         call row%put_uncertainty(own%total)
      else
         call document%put(words_of_reason(own%no_estimate), 'no_estimate')
      end if
   end subroutine put_uncertainty

   !> Adds the *VERIFY checks in the order of the deck.
   subroutine put_checks(document, row, model, verifier)
      type(json_type), intent(inout) :: document
      type(result_row_type), intent(inout) :: row
      type(model_type), intent(in) :: model
      type(verifier_type), intent(in) :: verifier
      character(:), allocatable :: name
      integer :: i

      call document%open('[', 'checks')
      do i = 1, size(verifier%outcomes)
         associate (check => model%verifications(i), outcome => verifier%outcomes(i))
            call document%open('{')
            call document%put(check%title(), 'quantity')
            call document%put(check%where, 'where')
            call document%put(check%address, 'address')
            if (check%expects) then
               call document%put(check%value, 'expected')
               call document%put(check%tolerance, 'tolerance')
               call document%put(trim(merge('relative', 'absolute', check%relative)), 'kind')
            end if
            call document%put(outcome%passed, 'passed')
            if (outcome%reason /= '') then
               call document%put(outcome%reason, 'reason')
            else
               call document%put(outcome%time, 'time')
               call document%put(outcome%found, 'found')
               if (check%expects) call document%put(outcome%deviation, 'deviation')
               if (outcome%node > 0) call document%put(outcome%node, 'node')
            end if
            if (outcome%no_estimate /= no_reason) call document%put(words_of_reason( &
               outcome%no_estimate), 'no_estimate')
            if (allocated(outcome%uncertainty)) call document%put(outcome%uncertainty, &
               'uncertainty')
            call document%close('}')
            name = trim(check%title()//' '//check%where)
            if (.not. check%at_last) name = name//' at '//to_text(check%when)
            if (outcome%reason /= '' .or. row%has(name)) cycle
            call row%put(name, outcome%found)
            if (allocated(outcome%uncertainty)) call row%put_uncertainty(outcome%uncertainty)
         end associate
      end do
      call document%close(']')
   end subroutine put_checks

end module run_documents
