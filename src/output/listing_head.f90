!> The head of the listing: the summary of the run, what is modelled and why, sizes, interfaces.
module listing_head
   use contact_definitions, only: makes_friction_heat
   use contact_points, only: contact_points_type
   use deck_outcomes, only: counts_of_checks, end_of_run
   use interface_warnings, only: gap_range
   use kinds, only: dp
   use listing_text, only: page_type, page_width
   use model, only: model_type
   use model_words, only: alike_words, closed_law_words, first_alike, friction_heat_words, &
      friction_words, from_to, open_law_words, open_words, overlap_words, pairing_words, &
      points_words, wear_words
   use run_summaries, only: in_listing, run_entries, run_entry_type, run_summary_type
   use steps, only: solves_heat
   use text, only: append, counted, or_blank, string_type, to_text
   use verification, only: verifier_type
   implicit none
   private
   public :: print_model, ending, checks, summary_block

contains

   !> How the run ended.
   pure function ending(run, has_failed, increments) result(line)
      type(run_summary_type), intent(in) :: run
      logical, intent(in) :: has_failed          !! whether it ended early
      integer, intent(in) :: increments          !! accepted ones
      character(:), allocatable :: line

      line = end_of_run(run%verify_failed, run%accuracy%missed /= '')//', '// &
         counted(increments, 'increment')
      ! Read only while that round is solved, or where it did not come to its end.
      if (run%accuracy%later_round > 0) line = line//'; round '// &
         to_text(run%accuracy%later_round)//' is being solved, or see ENDED EARLY at the end'
      if (has_failed) line = 'ended early after '//counted(increments, 'increment')// &
         ', see ENDED EARLY below'
   end function ending

   !> How many checks passed.
   pure function checks(verifier, run) result(line)
      type(verifier_type), intent(in) :: verifier  !! of this round
      type(run_summary_type), intent(in) :: run
      character(:), allocatable :: line

      line = ''
      if (run%verify_passed + run%verify_failed > 0) line = ', '//counts_of_checks( &
         run%verify_passed, run%verify_failed)
      associate (waiting => count(.not. verifier%outcomes%judged))
         if (waiting > 0) line = line//', '//to_text(waiting)//' not judged'
      end associate
      if (line == '') line = ', no *VERIFY checks'
      line = line(3:)
   end function checks

   !> The lines of the summary, those that are too long in several ones.
   pure function summary_block(lines) result(block)
      type(string_type), intent(in) :: lines(:)
      character(:), allocatable :: block
      character(:), allocatable :: rest
      integer :: i, k

      block = ''
      do i = 1, size(lines)
         rest = '   '//lines(i)%value
         do while (len(rest) > page_width)
            k = index(rest(:page_width + 1), ' ', back=.true.)
            if (k <= 10) exit   ! no blank to go on behind
            block = block//rest(:k - 1)//new_line('a')
            rest = repeat(' ', 9)//rest(k + 1:)
         end do
         block = block//trim(rest)//new_line('a')
      end do
   end function summary_block

   !> Prints the physics, sizes and choices of a run, and its interfaces.
   subroutine print_model(page, model, interfaces, run)
      type(page_type), intent(inout) :: page              !! of the listing
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(run_summary_type), intent(in) :: run
      type(run_entry_type), allocatable :: entries(:)
      type(page_type) :: blocks(size(interfaces))
      type(string_type) :: texts(size(interfaces))
      integer :: first(size(interfaces)), i

      call page%title('PHYSICS')
      call page%wrapped('   ', or_blank(run%modelled))
      if (or_blank(run%reasons) /= '') call page%wrapped('   ', run%reasons)
      call page%title('MODEL')
      entries = run_entries(run, model)
      do i = 1, size(entries)
         if (entries(i)%is_told(in_listing)) call print_entry(page, entries(i)%label, &
            entries(i)%words)
      end do
      do i = 1, size(interfaces)
         call print_interface(blocks(i), model, interfaces(i), i)
         call blocks(i)%take(texts(i)%value)
      end do
      first = first_alike(texts)
      do i = 1, size(interfaces)
         if (first(i) /= i) cycle
         call page%line('')
         call page%line('   INTERFACE '//interfaces(i)%name//alike_words(first, i))
         call page%append(texts(i)%value)
      end do
   end subroutine print_model

   subroutine print_interface(page, model, points, i)
      type(page_type), intent(inout) :: page
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: i                       ! number of the interface
      character(:), allocatable :: pieces

      call print_entry(page, 'pairing', pairing_words(model%contacts(i)%pairing, points))
      pieces = ''
      if (allocated(points%cuts)) pieces = ', in '//to_text(size(points%cuts) + 1)// &
         ' pieces of the faces'
      call print_entry(page, points_words(points), to_text(size(points%slave))//pieces)
      if (len(open_words(points)) > 0) call print_entry(page, 'note', open_words(points))
      call print_entry(page, 'length', to_text(points%length()))
      call print_entry(page, 'initial gaps', from_to(gap_range(model%mesh, points)))
      associate (interaction => model%interactions(model%contacts(i)%interaction))
         call print_entry(page, 'coefficient of friction', friction_words(interaction%friction))
         if (interaction%overlap%is_soft()) call print_entry(page, 'pressure', &
            overlap_words(interaction%overlap))
         if (interaction%wear%wears()) call print_entry(page, 'wear', wear_words(interaction%wear))
         if (interaction%wear%wears() .and. model%contacts(i)%follows_sliding .and. &
            interaction%wear%slave_share < 1.0_dp) call print_entry(page, 'note', 'what the '// &
            'master loses opens no gap: the slave leaves it behind')
         if (.not. any(solves_heat(model%steps%analysis))) return
         if (makes_friction_heat(model%interactions, model%contacts(i:i))) call print_entry( &
            page, 'heat of friction', friction_heat_words(interaction%heat))
         call print_entry(page, 'conductance, open', open_law_words(interaction%law))
         call print_entry(page, 'conductance, closed', closed_law_words(interaction%law))
      end associate
   end subroutine print_interface

   subroutine print_entry(page, name, value)
      type(page_type), intent(inout) :: page
      character(*), intent(in) :: name, value

      call page%wrapped('   '//name//' '//repeat('.', max(26 - len(name), 2))//' ', value)
   end subroutine print_entry

end module listing_head
