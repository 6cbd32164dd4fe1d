!> A requested accuracy in words, which targets are met and what each round cost; and its rounds in
!> the group `/accuracy` of the result file.
module accuracy_lines
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use accuracy_advice, only: advice_of, demand_name
   use accuracy_rounds, only: accuracy_round_type, accuracy_rounds_type, finding_type
   use contact_points, only: contact_points_type
   use contact_quantities, only: estimated
   use growing_datasets, only: growing_dataset, growing_dataset_type, write_integers, write_once
   use hdf5_writer, only: as_integer, as_real, hdf5_writer_type
   use kinds, only: dp
   use model, only: model_type, unit_labels_type
   use no_estimates, only: at_corner, grows, no_reason, words_of_reason
   use quantity_types, only: quantity_type
   use run_summaries, only: accuracy_words_type
   use text, only: append, counted, digits_above, few_digits, listed, percent, string_type, to_text
   use unit_labels, only: unit_label
   implicit none
   private
   public :: told_of_rounds, write_accuracy

   character(*), parameter :: group = '/accuracy'
   integer, parameter :: columns = 4   !! step, value, uncertainty, target

   integer, parameter :: name_width = 30   !! least columns of interface and quantity
   integer, parameter :: most_named = 3    !! targets in one line
   real(dp), parameter :: rounding = 1.0e-12_dp   !! relative

contains

   !> All that is told of the rounds; nothing where no accuracy is requested.
   function told_of_rounds(accuracy, has_checks, interfaces, model) result(words)
      type(accuracy_rounds_type), intent(in) :: accuracy
      logical, intent(in) :: has_checks                      !! whether the deck has *VERIFY checks
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(model_type), intent(in) :: model
      type(accuracy_words_type) :: words
      character(:), allocatable :: name
      integer :: i

      allocate (words%targets(0), words%rounds(0), words%advice(0))
      words%missed = ''
      if (.not. accuracy%is_on) return
      if (size(accuracy%rounds) == 0) then
         call append(words%targets, &
            'requested accuracy not reached: round 1 did not come to its end')
         return
      end if
      call append(words%targets, verdict(accuracy))
      do i = 1, size(accuracy%demands)
         name = demand_name(accuracy, i, interfaces)
         name = name//repeat(' ', max(name_width - len(name), 0))
         call append(words%targets, name//' '//target_words(accuracy, i, model%units))
      end do
      if (any([(is_of_more(accuracy, i), i=1, size(accuracy%demands))])) call append( &
         words%targets, &
         '% of an edge: of the closed length; of a small value: of a part of the largest so far')
      if (size(accuracy%rounds) > 1 .and. has_checks) call append(words%targets, &
         'the *VERIFY checks were judged in round 1, on the deck as written')
      words%missed = missed_words(accuracy, interfaces)
      if (accuracy%goes_on) words%later_round = size(accuracy%rounds) + 1
      call append(words%rounds, '   round   CPU seconds    unknowns    elements  increments  '// &
         'largest uncertainty/target')
      do i = 1, size(accuracy%rounds)
         call append(words%rounds, round_words(i, accuracy%rounds(i)))
      end do
      if (accuracy%reason /= '') words%advice = advice_of(accuracy, interfaces, &
         model%mesh%node_number)
   end function told_of_rounds

   !> Whether the per cent told of a target are not those of its value.
   pure logical function is_of_more(accuracy, d)
      type(accuracy_rounds_type), intent(in) :: accuracy
      integer, intent(in) :: d
      integer :: step

      associate (demand => accuracy%demands(d), last => accuracy%rounds(size(accuracy%rounds)))
         step = last%worst_step(d)
         is_of_more = step > 0 .and. demand%is_relative
         if (.not. is_of_more) return
         associate (finding => last%findings(d, step))
            is_of_more = abs(finding%allowed - demand%target*abs(finding%value)) > &
               rounding*finding%allowed
         end associate
      end associate
   end function is_of_more

   !> Whether the accuracy is reached, and why no further round follows.
   function verdict(accuracy) result(words)
      type(accuracy_rounds_type), intent(in) :: accuracy
      character(:), allocatable :: words

      words = 'requested accuracy '//trim(merge('reached    ', 'not reached', &
         accuracy%is_reached()))//' after '//counted(size(accuracy%rounds), 'round')
      ! Read only while another round is solved, or where that did not come to its end.
      if (accuracy%goes_on) words = words//'; round '//to_text(size(accuracy%rounds) + 1)// &
         ' was begun'
      if (accuracy%reason /= '') words = words//': '//accuracy%reason
   end function verdict

   !> The verdict and the targets that are not met, in one line; nothing where all are.
   function missed_words(accuracy, interfaces) result(words)
      type(accuracy_rounds_type), intent(in) :: accuracy
      type(contact_points_type), intent(in) :: interfaces(:)
      character(:), allocatable :: words
      type(string_type), allocatable :: missed(:)
      integer :: d

      allocate (missed(0))
      associate (last => accuracy%rounds(size(accuracy%rounds)))
         do d = 1, size(accuracy%demands)
            if (.not. all(last%findings(d, :)%is_met())) call append(missed, &
               demand_name(accuracy, d, interfaces))
         end do
      end associate
      words = ''
      if (size(missed) > 0) words = verdict(accuracy)//'; not met: '//listed(missed, most_named)
   end function missed_words

   !> The uncertainty at the end of the step that is furthest from a target; the summary tells the
   !> values of the last step.
   function target_words(accuracy, d, labels) result(words)
      type(accuracy_rounds_type), intent(in) :: accuracy
      integer, intent(in) :: d
      type(unit_labels_type), intent(in) :: labels
      character(:), allocatable :: words
      type(finding_type) :: finding
      integer :: step

      associate (demand => accuracy%demands(d), last => accuracy%rounds(size(accuracy%rounds)))
         words = 'nothing to judge: '//demand%idle
         if (demand%idle /= '') return
         words = 'not judged'
         step = last%worst_step(d)
         if (step == 0) return
         finding = last%findings(d, step)
         words = trim(merge('met:    ', 'not met:', finding%is_met()))
         if (ieee_is_nan(finding%uncertainty)) then
            words = words//' no estimate'
         else
            words = words//' uncertainty '//amount(finding%uncertainty)
            if (demand%is_relative) words = words//' of '// &
               with_unit(to_text(finding%allowed/demand%target))
         end if
         words = words//', target '//amount(finding%allowed)
         if (step < size(last%findings, 2)) then
            words = words//', step '//to_text(step)//' with '
            if (ieee_is_nan(finding%uncertainty)) then
               words = words//with_unit(to_text(finding%value))
            else
               words = words//with_unit(to_text(finding%value)//' +- '// &
                  few_digits(finding%uncertainty))
            end if
         else if (step > 1) then
            words = words//', step '//to_text(step)
         end if
         if (finding%is_met()) return
         if (finding%no_estimate /= no_reason) words = words//': '//words_of_reason( &
            finding%no_estimate)
         if (finding%is_at_end .and. all(finding%no_estimate /= [at_corner, grows]) .and. &
            accuracy%stands_still()) words = words// &
            '; the peak is at an end of the face, where the pressure may grow '//'without limit'
      end associate
   contains
      !> The uncertainty or what is allowed, as a part of the value's scale where the target is one;
      !> more digits where only these show that the target is missed.
      function amount(number)
         real(dp), intent(in) :: number
         character(:), allocatable :: amount
         real(dp) :: part

         associate (demand => accuracy%demands(d))
            if (demand%is_relative) then
               part = demand%target/finding%allowed
               amount = percent(part*number, shown_digits(100.0_dp*part))
            else
               amount = with_unit(few_digits(number, shown_digits(1.0_dp)))
            end if
         end associate
      end function amount

      integer function shown_digits(factor)
         real(dp), intent(in) :: factor

         shown_digits = 2
         if (.not. ieee_is_nan(finding%uncertainty)) shown_digits = digits_above( &
            factor*finding%uncertainty, factor*finding%allowed)
      end function shown_digits

      function with_unit(number)
         character(*), intent(in) :: number
         character(:), allocatable :: with_unit

         with_unit = trim(number//' '//unit_label(estimated(accuracy%demands(d)%quantity)%unit, &
            labels))
      end function with_unit
   end function target_words

   function round_words(number, round) result(words)
      integer, intent(in) :: number
      type(accuracy_round_type), intent(in) :: round
      character(:), allocatable :: words
      character(80) :: line
      real(dp) :: excess(size(round%findings, 1)), largest
      integer :: d, missing

      write (line, '(i8, f14.2, 3i12)') number, round%cpu_seconds, round%unknowns, &
         round%elements, round%increments
      words = trim(line)//'  '
      excess = [(round%excess(d), d=1, size(excess))]
      missing = count(excess >= huge(1.0_dp))
      if (missing < size(excess)) then
         largest = maxval(excess, mask=excess < huge(1.0_dp))
         words = words//few_digits(largest, digits_above(largest, 1.0_dp))
      end if
      if (missing > 0 .and. missing < size(excess)) words = words//', '
      if (missing > 0) words = words//to_text(missing)//' without estimate'
   end function round_words

   !> Writes the rounds, where an accuracy is requested and the first one came to its end.
   subroutine write_accuracy(file, accuracy, interfaces)
      type(hdf5_writer_type), intent(inout) :: file          !! the open file
      type(accuracy_rounds_type), intent(in) :: accuracy
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      integer :: d, i

      if (.not. accuracy%is_on) return
      if (size(accuracy%rounds) == 0) return
      call file%create_group(group)
      associate (rounds => accuracy%rounds)
         call write_once(file, growing_dataset(group//'/cpu_seconds', as_real, 0, 1, 1, &
            'CPU seconds of the round', 's'), rounds%cpu_seconds)
         call write_integers(file, group//'/unknowns', rounds%unknowns, as_integer, &
            'unknown temperatures, displacements and contact unknowns')
         call write_integers(file, group//'/elements', rounds%elements, as_integer, &
            'elements of the mesh')
         call write_integers(file, group//'/increments', rounds%increments, as_integer, &
            'accepted increments')
      end associate
      call file%set(group, 'reached', merge(1, 0, accuracy%is_reached()))
      call file%set(group, 'later_round_begun', merge(1, 0, accuracy%goes_on))
      call file%create_group(group//'/uncertainty')
      call file%link(group//'/uncertainty', group//'/bounds')
      do i = 1, size(interfaces)
         if (.not. any(accuracy%demands%interface == i)) cycle
         call file%create_group(group//'/uncertainty/'//interfaces(i)%name)
         do d = 1, size(accuracy%demands)
            if (accuracy%demands(d)%interface == i) call write_demand(file, accuracy, d, &
               group//'/uncertainty/'//interfaces(i)%name)
         end do
      end do
   end subroutine write_accuracy

   !> A row for each round: step, value, uncertainty and what the target allows, at the end of the
   !> step that is furthest from the target; zeros where no step has the quantity.
   subroutine write_demand(file, accuracy, d, path)
      type(hdf5_writer_type), intent(inout) :: file
      type(accuracy_rounds_type), intent(in) :: accuracy
      integer, intent(in) :: d
      character(*), intent(in) :: path
      real(dp) :: rows(columns, size(accuracy%rounds))
      integer :: i, step
      type(growing_dataset_type) :: dataset
      type(quantity_type) :: quantity

      rows = 0.0_dp
      do i = 1, size(accuracy%rounds)
         step = accuracy%rounds(i)%worst_step(d)
         if (step == 0) cycle
         associate (finding => accuracy%rounds(i)%findings(d, step))
            rows(:, i) = [real(step, dp), finding%value, finding%uncertainty, finding%allowed]
         end associate
      end do
      quantity = estimated(accuracy%demands(d)%quantity)
      dataset = growing_dataset(path//'/'//trim(quantity%name), as_real, columns, 1, 1, &
         'rounds of the requested accuracy: '//trim(quantity%description), quantity%unit)
      dataset%components = 'step value uncertainty target'
      call write_once(file, dataset, [rows])
   end subroutine write_demand

end module accuracy_lines
