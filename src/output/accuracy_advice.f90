!> After a requested accuracy that was not reached: what limits it and what to change, in words.
module accuracy_advice
   use accuracy_outlook, only: outlook_of, outlook_type
   use accuracy_rounds, only: accuracy_rounds_type, finding_type
   use accuracy_targets, only: short_name
   use contact_points, only: contact_points_type
   use contact_quantities, only: estimated
   use kinds, only: dp
   use no_estimates, only: at_corner, grows
   use summary, only: words_of
   use text, only: append, counted, few_digits, percent, string_type, to_text, without_blanks
   implicit none
   private
   public :: advice_of, demand_name

   integer, parameter :: most_told = 3          !! targets
   character(*), parameter :: limits = ' limits it: '

contains

   !> A line for each target that is missed and that something is known of.
   function advice_of(accuracy, interfaces, node_number) result(lines)
      type(accuracy_rounds_type), intent(in) :: accuracy     !! with at least one round
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      integer, intent(in) :: node_number(:)                  !! (nodes) numbers in the deck
      type(string_type), allocatable :: lines(:)
      character(:), allocatable :: words
      integer :: d

      allocate (lines(0))
      associate (last => accuracy%rounds(size(accuracy%rounds)))
         do d = 1, size(accuracy%demands)
            if (size(lines) == most_told) exit
            if (all(last%findings(d, :)%is_met())) cycle
            words = advice(accuracy, d, last%findings(d, last%worst_step(d)), node_number)
            if (words /= '') call append(lines, demand_name(accuracy, d, interfaces)//limits//words)
         end do
      end associate
   end function advice_of

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

   !> What limits a target, and what to change; empty where nothing is known of it.
   function advice(accuracy, d, finding, node_number) result(words)
      type(accuracy_rounds_type), intent(in) :: accuracy
      integer, intent(in) :: d
      type(finding_type), intent(in) :: finding              ! where it is missed most
      integer, intent(in) :: node_number(:)
      character(:), allocatable :: words
      type(outlook_type) :: outlook

      words = ''
      outlook = outlook_of(accuracy, d)
      if (any(finding%no_estimate == [at_corner, grows])) then
         words = 'it has no limit where nodes '//to_text(node_number(finding%nodes(1)))//' and '// &
            to_text(node_number(finding%nodes(2)))//' meet; round that corner, or ask for '// &
            'other quantities: '//others(accuracy, d)
      else if (outlook%is_known .and. .not. outlook%falls) then
         words = 'its uncertainty did not fall in the last rounds'
         if (finding%is_at_end) words = words//', and its peak is at an end of the face, where '// &
            'nodes '//to_text(node_number(finding%nodes(1)))//' and '// &
            to_text(node_number(finding%nodes(2)))//' meet'
         words = words//within_reach(accuracy, d)
      else if (outlook%falls .and. .not. outlook%is_foretold) then
         words = 'its uncertainty falls only as unknowns to the power -'// &
            few_digits(outlook%order)//', too slowly for more rounds to reach it; begin with a '// &
            'finer mesh (*REFINE with one more of LEVELS=)'//within_reach(accuracy, d)
      else if (outlook%is_known) then
         words = 'its uncertainty falls as unknowns to the power -'//few_digits(outlook%order)// &
            '; about '//counted(outlook%rounds, 'more round')//' ('// &
            few_digits(outlook%cpu_seconds)//' CPU seconds) would do'
         if (index(accuracy%reason, 'ROUNDS=') > 0) words = words//': *ACCURACY, ROUNDS='// &
            to_text(size(accuracy%rounds) + outlook%rounds)
         words = words//within_reach(accuracy, d)
      else if (size(accuracy%rounds) == 1) then
         words = 'a second round would show how many it takes'//within_reach(accuracy, d)
      end if
   end function advice

   !> The target that the last round meets, as the command line has it.
   function within_reach(accuracy, d) result(words)
      type(accuracy_rounds_type), intent(in) :: accuracy
      integer, intent(in) :: d
      character(:), allocatable :: words
      real(dp), parameter :: steps(4) = [1.0_dp, 2.0_dp, 5.0_dp, 10.0_dp]
      real(dp) :: found, scale

      words = ''
      associate (demand => accuracy%demands(d), last => accuracy%rounds(size(accuracy%rounds)))
         if (.not. demand%is_relative .or. last%excess(d) >= huge(1.0_dp)) return
         found = demand%target*last%excess(d)
         scale = 10.0_dp**floor(log10(found))
         found = scale*steps(findloc(steps*scale >= found, .true., dim=1))
         if (found < 1.0_dp) words = '; this mesh reaches --accuracy '// &
            short_name(estimated(demand%quantity)%name)//'='//without_blanks(percent(found))
      end associate
   end function within_reach

   !> The targets of other quantities, as the command line has them; an example where there is none.
   function others(accuracy, d) result(words)
      type(accuracy_rounds_type), intent(in) :: accuracy
      integer, intent(in) :: d
      character(:), allocatable :: words
      integer :: i, k

      words = ''
      associate (demands => accuracy%demands)
         do i = 1, size(demands)
            if (demands(i)%quantity == demands(d)%quantity .or. .not. demands(i)%is_relative) cycle
            if (demands(i)%idle /= '') cycle
            if (any([(demands(k)%quantity == demands(i)%quantity, k=1, i - 1)])) cycle
            words = words//','//short_name(estimated(demands(i)%quantity)%name)//'='// &
               without_blanks(percent(demands(i)%target))
         end do
      end associate
      if (words == '') words = ',force=5%'
      words = '--accuracy '//words(2:)
   end function others

end module accuracy_advice
