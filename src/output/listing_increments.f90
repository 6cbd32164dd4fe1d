!> The block of an accepted increment in the listing: convergence, interfaces, balances, and at the
!> end of a step the errors of bodies in the energy norm and the uncertainties of quantities.
module listing_increments
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use contact_extents, only: is_end_of_face
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values, estimated, has_quantity
   use field_quantities, only: maxima
   use increment_quantities, only: history_estimated, history_value, leading_words, &
      part_values, stability_words
   use kinds, only: dp
   use listing_text, only: column, in_columns, page_type, to_right, zone_counts
   use mesh, only: mesh_type
   use no_estimates, only: mark_of, no_reason, not_on_finer_mesh, words_of_reason
   use model, only: model_type, uncertainty_full
   use quantity_types, only: needs_coupling, needs_dilatation, needs_friction_heat, needs_heat, &
      needs_mechanics, needs_branch, needs_nothing, needs_storage, of_bodies, of_history, &
      of_interface, quantity_type
   use records, only: attempt_record_type, body_uncertainty_type, contact_record_type, &
      increment_record_type, uncertainty_type
   use reported_quantities, only: quantities
   use steps, only: solves_heat, solves_mechanics
   use summary, only: corner_words, largest_at, place_words, words_of
   use text, only: append, or_blank, string_type, to_text, with_decimals
   implicit none
   private
   public :: print_increment, print_attempts, print_interface, print_interfaces, print_balances
   public :: print_body_errors, print_history_uncertainties, print_maxima, print_uncertainties

   character(*), parameter :: kinds_of_error(3) = [character(10) :: 'change', 'scatter', &
      'iteration']
   integer, parameter :: longest_name = 30   !! of a quantity of an interface, in words
   character(*), parameter :: uncertainty_head = '         value  uncertainty          %'// &
      '      change       scatter     iteration  largest part'

contains

   !> Prints which increment it is and how it converged.
   subroutine print_increment(page, record)
      type(page_type), intent(inout) :: page              !! of the listing
      type(increment_record_type), intent(in) :: record
      integer :: passes

      call page%line('')
      call page%line('INCREMENT '//to_text(record%increment)//'   STEP '//to_text(record%step)// &
         '   TIME '//to_text(record%time)//'   LOAD '//to_text(record%load))
      if (allocated(record%failed)) call print_attempts(page, record%failed)
      if (record%corrections > 0) call page%line('   corrections '//to_text(record%corrections)// &
         trim(merge(', operators formed again', repeat(' ', 24), record%has_new_operators)))
      if (.not. allocated(record%iterations)) return
      passes = size(record%iterations)
      if (passes == 0) return
      call page%line('   iterations '//to_text(passes)//'   cut-backs '// &
         to_text(record%cut_backs)//'   residual'//column(history_value('residual', record), 9, &
         2)//'  (floor'//column(history_value('residual_floor', record), 9, 2)//')')
      if (.not. ieee_is_nan(record%coupling_gain)) call page%line(history_line(needs_coupling, &
         record))
   end subroutine print_increment

   !> Prints the attempts at an increment that are not kept.
   subroutine print_attempts(page, attempts)
      type(page_type), intent(inout) :: page                 !! of the listing
      type(attempt_record_type), intent(in) :: attempts(:)   !! these, in their order
      integer :: i

      do i = 1, size(attempts)
         call page%wrapped('   ', 'attempt '//to_text(i)//' of size '// &
            to_text(attempts(i)%increment_size)//', to time '//to_text(attempts(i)%time)// &
            ', not kept: '//attempts(i)%reason)
      end do
   end subroutine print_attempts

   !> Prints zones, edges and sums of an interface.
   subroutine print_interface(page, points, contact)
      type(page_type), intent(inout) :: page              !! of the listing
      type(contact_points_type), intent(in) :: points     !! the interface
      type(contact_record_type), intent(in) :: contact    !! its state
      type(quantity_type) :: quantity
      character(:), allocatable :: edges, sums
      real(dp) :: value(1)
      integer :: i, zones(3)

      edges = ''
      sums = ''
      do i = 1, size(quantities)
         if (quantities(i)%kind /= of_interface .or. quantities(i)%label == '') cycle
         quantity = quantities(i)
         if (.not. has_quantity(contact, quantity%needs)) cycle
         value = contact_values(quantity%name, contact)
         if (quantity%resolution > 0.0_dp) then
            edges = edges//told(quantity, value(1))
         else
            sums = sums//told(quantity, value(1))
         end if
      end do
      zones = zone_counts([contact])
      call page%line('   '//points%name//'   I '//to_text(zones(1))//'   II '// &
         to_text(zones(2))//'   III '//to_text(zones(3))//edges)
      call page%line('   '//sums)
   end subroutine print_interface

   !> Prints the zones of many interfaces, and the largest sums with the interfaces that have them.
   subroutine print_interfaces(page, interfaces, contacts)
      type(page_type), intent(inout) :: page                  !! of the listing
      type(contact_points_type), intent(in) :: interfaces(:)  !! all interfaces
      type(contact_record_type), intent(in) :: contacts(:)    !! their states
      type(quantity_type) :: quantity
      character(:), allocatable :: line
      real(dp) :: value(1)
      integer :: i, q, zones(3)

      zones = zone_counts(contacts)
      call page%line('   '//to_text(size(interfaces))//' interfaces   I '//to_text(zones(1))// &
         '   II '//to_text(zones(2))//'   III '//to_text(zones(3)))
      line = 'largest'
      do q = 1, size(estimated)
         if (estimated(q)%resolution > 0.0_dp) cycle
         quantity = estimated(q)
         i = largest_at(quantity%name, contacts)
         if (i == 0) cycle
         if (.not. has_quantity(contacts(i), quantity%needs)) cycle
         value = contact_values(quantity%name, contacts(i))
         line = line//'   '//words_of(quantity%name)//' '//to_text(value(1))//' ('// &
            interfaces(i)%name//')'
      end do
      call page%wrapped('   ', line)
   end subroutine print_interfaces

   !> The quantities of an increment that need the same, with their labels.
   pure function history_line(needs, record) result(line)
      integer, intent(in) :: needs
      type(increment_record_type), intent(in) :: record
      character(:), allocatable :: line
      type(quantity_type) :: quantity
      integer :: i

      line = ''
      do i = 1, size(quantities)
         if (quantities(i)%kind /= of_history .or. quantities(i)%needs /= needs) cycle
         quantity = quantities(i)
         if (quantity%label /= '') line = line//told(quantity, history_value(quantity%name, record))
      end do
   end function history_line

   !> A quantity with its label before it: edges and gains as one writes numbers, the others in
   !> columns.
   pure function told(quantity, value) result(words)
      type(quantity_type), intent(in) :: quantity
      real(dp), intent(in) :: value
      character(:), allocatable :: words

      words = '   '//trim(quantity%label)
      if (quantity%resolution > 0.0_dp .or. quantity%needs == needs_coupling) then
         if (ieee_is_nan(value)) then
            words = words//' none'
         else
            words = words//' '//to_text(value)
         end if
      else if (quantity%unit == '-') then
         words = words//column(value, 9, 2)
      else
         words = words//column(value, 14, 6)
      end if
   end function told

   !> Prints what balances, and the work of the re-factorisation.
   subroutine print_balances(page, record, model)
      type(page_type), intent(inout) :: page              !! of the listing
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model
      integer, parameter :: parts(7) = [needs_nothing, needs_heat, needs_storage, &
         needs_dilatation, needs_friction_heat, needs_mechanics, needs_branch]
      character(:), allocatable :: unit
      logical :: is_told(size(parts)), has_heat
      integer :: i

      associate (analysis => model%steps(record%step)%analysis)
         has_heat = solves_heat(analysis)
         is_told = [.true., has_heat, has_heat .and. .not. ieee_is_nan(record%heat_stored), &
            has_heat .and. .not. ieee_is_nan(record%heat_dilatation), &
            has_heat .and. .not. ieee_is_nan(record%heat_friction), solves_mechanics(analysis), &
            allocated(record%load_factor)]
      end associate
      do i = 1, size(parts)
         if (is_told(i) .and. history_line(parts(i), record) /= '') call page%line( &
            history_line(parts(i), record))
      end do
      if (allocated(record%drive_excess)) call page%line( &
         '   heat of friction less work of the drive '//trim(adjustl(column(record%drive_excess, &
         9, 2)))//' of it')
      if (allocated(record%pre_tension)) then
         if (size(record%pre_tension) > 0) then
            call page%line('   pre-tension'//in_columns(record%pre_tension, 14, 6))
            if (allocated(record%pre_tension_uncertainties)) then
               call page%line('   uncertainty'//in_columns(record%pre_tension_uncertainties, 14, 6))
            else if (model%uncertainty == uncertainty_full) then
               call page%line('   uncertainty'//mark_of(not_on_finer_mesh))
            end if
         end if
      end if
      if (allocated(record%along_z)) then
         do i = 1, size(record%along_z, 2)
            call page%line('   along z: U3, UR1, UR2   '//in_columns(record%along_z(:3, i), 14, 6))
            call page%line('            RF3, RM1, RM2  '//in_columns(record%along_z(4:, i), 14, 6))
         end do
      end if
      unit = or_blank(model%units%time)
      if (stability_words(record, unit) /= '') call page%wrapped('   ', 'stability: '// &
         stability_words(record, unit))
      if (leading_words(record, unit) /= '') call page%wrapped('   ', leading_words(record, unit))
      associate (work => record%work)
         if (work%columns_full > 0) call page%line('   refactored '// &
            to_text(work%columns_again)//' of '//to_text(work%columns_full)//' columns ('// &
            to_right(with_decimals(100.0_dp*work%columns_again/work%columns_full, 1), 5)// &
            ' %), '//to_text(work%flops_again)//' of '//to_text(work%flops_full)//' flops ('// &
            to_right(with_decimals(100.0_dp*work%flops_again/max(1.0_dp, &
            real(work%flops_full, dp)), 1), 5)//' %)')
      end associate
   end subroutine print_balances

   !> Prints how large the discretisation error of each body is estimated, in the energy norm,
   !> relative to stress and heat flux, at the end of a step.
   subroutine print_body_errors(page, record)
      type(page_type), intent(inout) :: page              !! of the listing
      type(increment_record_type), intent(in) :: record
      type(quantity_type), allocatable :: errors(:)
      real(dp), allocatable :: values(:)
      character(:), allocatable :: line
      integer :: b, bodies, i

      if (.not. record%last_of_step) return
      errors = pack(quantities, quantities%kind == of_bodies .and. len_trim(quantities%label) > 0)
      bodies = 0
      do i = 1, size(errors)
         bodies = max(bodies, size(part_values(errors(i), record)))
      end do
      do b = 1, bodies
         line = ''
         do i = 1, size(errors)
            values = part_values(errors(i), record)
            if (b > size(values)) cycle
            line = line//'   '//trim(errors(i)%label)//column(values(b), 9, 2)
         end do
         call page%line('   estimated error of the mesh, body '//to_text(b)//line// &
            '  (energy norm, relative)')
      end do
   end subroutine print_body_errors

   !> Prints the uncertainties of an interface. What has no value, or no part in the deck, is left
   !> out, and so are edges at the end of the face.
   subroutine print_uncertainties(page, points, errors)
      type(page_type), intent(inout) :: page               !! of the listing
      type(contact_points_type), intent(in) :: points      !! the contact points of the interface
      type(uncertainty_type), intent(in) :: errors(:)      !! (estimated)
      character(longest_name) :: names(size(estimated))
      integer :: q
      logical :: is_told

      do q = 1, size(estimated)
         names(q) = ''
         associate (own => errors(q))
            if (ieee_is_nan(own%value)) cycle
            if (is_end_of_face(estimated(q), points, own%value)) cycle
            ! That of friction is 0 without it.
            is_told = abs(own%value) > 0.0_dp
            if (.not. (is_told .or. estimated(q)%is_of_friction .or. &
               ieee_is_nan(own%total))) is_told = own%total > 0.0_dp
            if (is_told) names(q) = words_of(estimated(q)%name)
         end associate
      end do
      call print_table(page, points%name, names(:)(:maxval([(len(words_of(estimated(q)%name)), &
         q=1, size(estimated))])), errors)
   end subroutine print_uncertainties

   !> Prints those of the quantities of an increment.
   subroutine print_history_uncertainties(page, errors)
      type(page_type), intent(inout) :: page               !! of the listing
      type(uncertainty_type), intent(in) :: errors(:)      !! (history_estimated)
      character(maxval(len_trim(history_estimated%name))) :: names(size(history_estimated))

      names = history_estimated%name(:len(names))
      where (ieee_is_nan(errors%value)) names = ''
      if (any(names /= '')) call print_table(page, 'THE INCREMENT', names, errors)
   end subroutine print_history_uncertainties

   !> Prints the uncertainties of the maxima of a body, where they are, and the corners that are
   !> left out.
   subroutine print_maxima(page, mesh, body, errors)
      type(page_type), intent(inout) :: page               !! of the listing
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: body
      type(body_uncertainty_type), intent(in) :: errors
      character(len('largest ') + maxval(len_trim(maxima%label))) :: names(size(maxima))
      integer :: q

      names = 'largest '//maxima%label(:len(names) - len('largest '))
      where (errors%node == 0) names = ''
      if (any(errors%node > 0)) call print_table(page, 'BODY '//to_text(body), names, errors%maxima)
      do q = 1, size(maxima)
         if (errors%node(q) > 0) call page%wrapped('    ', trim(names(q))//' at '// &
            place_words(mesh, errors%node(q)))
      end do
      if (size(errors%corners) > 0) call page%wrapped('    ', corner_words(mesh, errors))
   end subroutine print_maxima

   !> Prints uncertainties with their parts, and why there are none.
   subroutine print_table(page, title, names, errors)
      type(page_type), intent(inout) :: page
      character(*), intent(in) :: title                    ! what they are of
      character(*), intent(in) :: names(:)                 ! of the quantities; empty: not told
      type(uncertainty_type), intent(in) :: errors(:)      ! of them
      type(string_type), allocatable :: rows(:)
      real(dp) :: part
      integer :: q

      allocate (rows(0))
      call append(rows, '    '//repeat(' ', len(names))//uncertainty_head)
      do q = 1, size(names)
         associate (own => errors(q))
            if (names(q) == '') cycle
            part = ieee_value(part, ieee_quiet_nan)
            if (abs(own%value) > 0.0_dp) part = 100.0_dp*own%total/abs(own%value)
            call append(rows, trim('    '//names(q)//column(own%value, 14, 6)//cell(own%total, 13, &
               'no estimate')//cell(part, 11, '-')//cell(own%change, 12, '-')//cell(own%scatter, &
               14, '-')//cell(own%iteration, 14, '-')//'    '//largest_part(own)))
         end associate
      end do
      call page%table('   NUMERICAL UNCERTAINTY (95 %) OF '//title//': how far values may be '// &
         'off to either side, with its parts', rows)
      do q = 1, size(names)
         associate (why => errors(q)%no_estimate)
            if (why == no_reason .or. names(q) == '') cycle
            if (any(names(:q - 1) /= '' .and. errors(:q - 1)%no_estimate == why)) cycle
            call page%wrapped('    ', 'no estimate: '//words_of_reason(why))
         end associate
      end do
   end subroutine print_table

   !> A number in a column, or a word set to the right where there is none.
   pure function cell(value, width, missing) result(string)
      real(dp), intent(in) :: value
      integer, intent(in) :: width
      character(*), intent(in) :: missing
      character(width) :: string

      string = to_right(missing, width)
      if (.not. ieee_is_nan(value)) string = column(value, width, 2)
   end function cell

   !> Which part of an uncertainty is the largest.
   pure function largest_part(own) result(name)
      type(uncertainty_type), intent(in) :: own
      character(10) :: name
      real(dp) :: parts(3)
      integer :: k

      parts = [own%change, own%scatter, own%iteration]
      name = ''
      if (any(ieee_is_nan(parts))) return
      k = maxloc(parts, dim=1)
      if (parts(k) > 0.0_dp) name = kinds_of_error(k)
   end function largest_part

end module listing_increments
