!> A requested accuracy in words: which targets are met, and what each round cost.
module accuracy_lines
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use accuracy_rounds, only: accuracy_round_type, accuracy_rounds_type, finding_type
   use contact_points, only: contact_points_type
   use contact_quantities, only: estimated
   use kinds, only: dp
   use summary, only: words_of
   use text, only: append, counted, few_digits, percent, string_type, to_text
   implicit none
   private
   public :: add_accuracy, add_missed

   integer, parameter :: name_width = 30   !! columns of interface and quantity

contains

   !> Adds verdict, targets and rounds; no line where nothing is requested.
   subroutine add_accuracy(accuracy, interfaces, lines)
      type(accuracy_rounds_type), intent(in) :: accuracy
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(string_type), allocatable, intent(inout) :: lines(:)
      character(:), allocatable :: verdict
      character(name_width) :: name
      integer :: d, i

      if (.not. accuracy%is_on) return
      if (size(accuracy%rounds) == 0) then
         call append(lines, 'requested accuracy not reached: round 1 did not come to its end')
         return
      end if
      verdict = 'requested accuracy '//trim(merge('reached    ', 'not reached', &
         accuracy%is_reached()))//' after '//counted(size(accuracy%rounds), 'round')
      ! Read only while another round is solved, or where that did not come to its end.
      if (accuracy%goes_on) verdict = verdict//'; round '//to_text(size(accuracy%rounds) + 1)// &
         ' was begun'
      if (accuracy%reason /= '') verdict = verdict//': '//accuracy%reason
      call append(lines, verdict)
      do d = 1, size(accuracy%demands)
         name = demand_name(accuracy, d, interfaces)
         call append(lines, '   '//name//' '//target_words(accuracy, d))
      end do
      if (size(accuracy%rounds) > 1 .and. accuracy%checks_passed + &
         accuracy%checks_failed > 0) call append(lines, &
         '   the *VERIFY checks were judged in round 1, on the deck as written')
      call append(lines, '   round   CPU seconds    unknowns    elements  increments  '// &
         'largest bound/target')
      do i = 1, size(accuracy%rounds)
         call append(lines, round_words(i, accuracy%rounds(i)))
      end do
   end subroutine add_accuracy

   !> Adds one line for each target that is not met, and one with the reason why the rounds ended.
   subroutine add_missed(accuracy, interfaces, lines)
      type(accuracy_rounds_type), intent(in) :: accuracy
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(string_type), allocatable, intent(inout) :: lines(:)
      integer :: d

      if (.not. accuracy%is_on) return
      if (size(accuracy%rounds) == 0) return
      associate (last => accuracy%rounds(size(accuracy%rounds)))
         do d = 1, size(accuracy%demands)
            if (all(last%findings(d, :)%is_met())) cycle
            call append(lines, 'the requested accuracy is not reached: '// &
               demand_name(accuracy, d, interfaces)//' '//target_words(accuracy, d))
         end do
      end associate
      if (size(lines) > 0 .and. accuracy%reason /= '') call append(lines, &
         'the requested accuracy is not reached after '//counted(size(accuracy%rounds), 'round')// &
         ': '//accuracy%reason)
   end subroutine add_missed

   !> Interface and quantity of a target.
   function demand_name(accuracy, d, interfaces) result(name)
      type(accuracy_rounds_type), intent(in) :: accuracy
      integer, intent(in) :: d
      type(contact_points_type), intent(in) :: interfaces(:)
      character(:), allocatable :: name

      associate (demand => accuracy%demands(d))
         name = interfaces(demand%interface)%name//' '//words_of(estimated(demand%quantity)%name)
      end associate
   end function demand_name

   !> The bound at the end of the step that is furthest from a target.
   function target_words(accuracy, d) result(words)
      type(accuracy_rounds_type), intent(in) :: accuracy
      integer, intent(in) :: d
      character(:), allocatable :: words
      type(finding_type) :: finding
      integer :: step

      associate (demand => accuracy%demands(d), last => accuracy%rounds(size(accuracy%rounds)))
         words = 'skipped: '//demand%idle
         if (demand%idle /= '') return
         words = 'not judged'
         step = last%worst_step(d)
         if (step == 0) return
         finding = last%findings(d, step)
         words = trim(merge('met:    ', 'not met:', finding%is_met()))
         if (ieee_is_nan(finding%bound)) then
            words = words//' uncertain'
         else
            words = words//' bound '//amount(finding%bound)
         end if
         words = words//', target '//amount(finding%allowed)
         if (size(last%findings, 2) > 1) words = words//', step '//to_text(step)
         if (finding%is_met()) return
         words = words//reason(finding)
         if (finding%is_at_end .and. finding%has_limit .and. accuracy%stands_still()) then
            words = words//'; the peak is at an end of the face, where the pressure may grow '// &
               'without limit'
         end if
      end associate
   contains
      !> A bound, with its part of the value's scale where the target is one.
      function amount(bound)
         real(dp), intent(in) :: bound
         character(:), allocatable :: amount

         amount = few_digits(bound)
         associate (demand => accuracy%demands(d))
            if (demand%is_relative) amount = percent(demand%target*bound/finding%allowed)
         end associate
      end function amount
   end function target_words

   !> What is the larger part of a bound.
   function reason(finding)
      type(finding_type), intent(in) :: finding
      character(:), allocatable :: reason

      reason = ' (of the mesh)'
      if (.not. finding%has_limit) reason = ' (no limit: it grows from mesh to mesh)'
      if (ieee_is_nan(finding%mesh)) return
      if (ieee_is_nan(finding%increment)) then
         reason = ' (of the increments)'
      else if (finding%increment > finding%mesh) then
         reason = ' (of the increments)'
      end if
   end function reason

   function round_words(number, round) result(words)
      integer, intent(in) :: number
      type(accuracy_round_type), intent(in) :: round
      character(:), allocatable :: words
      character(80) :: line
      real(dp) :: excess(size(round%findings, 1))
      integer :: d, uncertain

      write (line, '(i8, f14.2, 3i12)') number, round%cpu_seconds, round%unknowns, &
         round%elements, round%increments
      words = trim(line)//'  '
      excess = [(round%excess(d), d=1, size(excess))]
      uncertain = count(excess >= huge(1.0_dp))
      if (uncertain < size(excess)) words = words//few_digits(maxval(excess, &
         mask=excess < huge(1.0_dp)))
      if (uncertain > 0 .and. uncertain < size(excess)) words = words//', '
      if (uncertain > 0) words = words//to_text(uncertain)//' uncertain'
   end function round_words

end module accuracy_lines
