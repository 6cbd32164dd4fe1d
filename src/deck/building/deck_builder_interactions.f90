!> *SURFACE INTERACTION with *FRICTION and *SURFACE BEHAVIOR, and the laws of its conductance.
module deck_builder_interactions
   use card_parameters, only: choose, has_parameter, need_parameter, parameter_place, parameter_text
   use card_values, only: check_extra, need_field, take_field
   use cards, only: cards_type, data_card_type, field_place, keyword_card_type
   use conductance_laws, only: conductance, conductance_law_type, law_jump, law_none, table_jump
   use contact_definitions, only: interaction_type
   use decimal_commas, only: check_unneeded
   use deck_builder_gap_conductance, only: build_gap_clearance, build_gap_conductance, &
      join_gap_conductance
   use deck_builder_gap_laws, only: build_gap_law
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use deck_structure, only: card_count
   use kinds, only: dp
   use model, only: model_type
   use text, only: to_text, to_upper
   implicit none
   private
   public :: build_interactions, find_interaction

   real(dp), parameter :: continuous = 1.0e-6_dp   !! a smaller jump is none, relative
   !> Beyond it, from some 1e7 on, a pressure is lost in the last places of mu times it.
   real(dp), parameter :: largest_friction = 1.0e6_dp

contains

   !> Takes all surface interactions; a law belongs to the last *SURFACE INTERACTION before it.
   subroutine build_interactions(cards, context, model, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context    !! receives notes
      type(model_type), intent(inout) :: model             !! receives the interactions
      type(deck_report_type), intent(inout) :: report      !! receives errors and warnings
      type(place_type) :: law_place
      integer :: k, n, errors

      allocate(model%interactions(card_count(cards, 'SURFACE INTERACTION')))
      n = 0
      do k = 1, size(cards%keywords)
         associate (card => cards%keywords(k))
            select case (card%name)
            case ('SURFACE INTERACTION')
               errors = report%error_count()
               n = n + 1
               call need_parameter(card, 'NAME', report, model%interactions(n)%name)
               if (find_interaction(model%interactions(:n - 1), &
                  model%interactions(n)%name) > 0) then
                  call report%error(parameter_place(card, 'NAME'), &
                     'surface interaction '//model%interactions(n)%name//' is defined twice')
                  call report%lose('surface interaction')
               end if
               law_place = card%place
               call pass_thickness(cards, card, context, report)
               call build_laws(cards, k, context, report, model%interactions(n), law_place)
               if (report%error_count() > errors .or. card%flawed) cycle
               call check_law(card, law_place, model%interactions(n), report)
            case ('FRICTION', 'GAP LAW', 'GAP CONDUCTANCE', 'SURFACE BEHAVIOR')
               if (n == 0 .and. len(card%meant) == 0) then
                  call report%missing(card%place, '*'//card%name// &
                     ' has no *SURFACE INTERACTION before it')
               end if
            case default
               cycle
            end select
         end associate
      end do
   end subroutine build_interactions

   !> Thickness of the contact out of the plane, which Abaqus takes for surfaces of nodes alone.
   subroutine pass_thickness(cards, card, context, report)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      real(dp) :: thickness
      logical :: valid

      if (card%last_data < card%first_data) return
      valid = .true.
      thickness = 1.0_dp
      call take_field(cards%data(card%first_data), 1, 'thickness', report, thickness, valid)
      call check_extra(cards%data(card%first_data), 1, 'thickness', report)
      if (thickness <= 0.0_dp) call report%error(field_place(cards%data(card%first_data), 1), &
         'the thickness must be positive')
      call context%note('*SURFACE INTERACTION: the thickness is read and not needed: that of '// &
         '*SOLID SECTION is taken')
   end subroutine pass_thickness

   !> Index of a surface interaction by its name; 0 for an unknown one.
   pure integer function find_interaction(interactions, name)
      type(interaction_type), intent(in) :: interactions(:)
      character(*), intent(in) :: name                        !! name in upper case

      do find_interaction = size(interactions), 1, -1
         if (interactions(find_interaction)%name == name) return
      end do
   end function find_interaction

   !> Takes the laws behind one *SURFACE INTERACTION.
   subroutine build_laws(cards, place, context, report, interaction, law_place)
      type(cards_type), intent(in) :: cards
      integer, intent(in) :: place
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      type(interaction_type), intent(inout) :: interaction
      type(place_type), intent(inout) :: law_place   ! becomes that of the data of the last law
      type(conductance_law_type) :: table
      integer :: k

      do k = place + 1, size(cards%keywords)
         associate (card => cards%keywords(k))
            if (card%name == 'SURFACE INTERACTION') exit
            if (card%name == 'SURFACE BEHAVIOR') call check_behavior(card, context, report)
            if (card%last_data < card%first_data) cycle
            if (card%name == 'GAP LAW' .or. card%name == 'GAP CONDUCTANCE') then
               law_place = field_place(cards%data(card%first_data), 1)
            end if
            select case (card%name)
            case ('FRICTION')
               call build_friction(cards%data(card%first_data), context, report, &
                  interaction%friction)
            case ('GAP LAW')
               call build_gap_law(cards, card, interaction%name, context, report, interaction%law)
            case ('GAP CONDUCTANCE')
               if (has_parameter(card, 'CLEARANCE')) then
                  call build_gap_clearance(cards, card, context, report, interaction%law)
               else
                  call build_gap_conductance(cards, card, interaction%name, context, report, table)
               end if
            case default
               cycle
            end select
         end associate
      end do
      call join_gap_conductance(table, interaction%name, context, interaction%law)
   end subroutine build_laws

   !> What tunes a penalty means nothing here; laws of pressure and overclosure that are no penalty
   !> are refused.
   subroutine check_behavior(card, context, report)
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      character(:), allocatable :: kind

      kind = to_upper(parameter_text(card, 'PRESSURE-OVERCLOSURE'))
      select case (kind)
      case ('EXPONENTIAL', 'TABULAR')
         call report%error(parameter_place(card, 'PRESSURE-OVERCLOSURE'), &
            'PRESSURE-OVERCLOSURE='//kind// &
            ' is refused: closed faces do not overlap')
      case ('TIED')
         call report%error(parameter_place(card, 'PRESSURE-OVERCLOSURE'), &
            'PRESSURE-OVERCLOSURE='//kind// &
            ' is refused: tied faces do not open; take *TIE')
      case default
         call choose(card, 'PRESSURE-OVERCLOSURE', 'LINEAR/HARD', report, kind)
         call context%note('*SURFACE BEHAVIOR is read and not needed: contact is exact')
      end select
   end subroutine check_behavior

   subroutine build_friction(data, context, report, friction)
      type(data_card_type), intent(in) :: data
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      real(dp), intent(inout) :: friction
      real(dp) :: slope
      logical :: valid

      valid = .true.
      call need_field(data, 1, 'coefficient of friction', report, friction, valid)
      call take_field(data, 2, 'stick slope', report, slope, valid)
      call check_extra(data, 2, 'coefficient of friction, stick slope', report)
      if (friction < 0.0_dp) then
         call report%error(field_place(data, 1), 'the coefficient of friction must not be negative')
      else if (friction > largest_friction) then
         call report%error(field_place(data, 1), 'the coefficient of friction must not exceed '// &
            to_text(largest_friction)//'; bodies that never slip are one: let them share nodes')
      end if
      if (size(data%fields) > 1) then
         call context%note('*FRICTION: the stick slope is read and not needed')
         call check_unneeded(data, 2, 'a stick slope', report)
      end if
   end subroutine build_friction

   !> Warns of a law that jumps, where the gap closes or where its table of clearances ends.
   subroutine check_law(card, law_place, interaction, report)
      type(keyword_card_type), intent(in) :: card
      type(place_type), intent(in) :: law_place      ! where the last of its laws stands
      type(interaction_type), intent(in) :: interaction
      type(deck_report_type), intent(inout) :: report
      real(dp) :: open, closed

      if (table_jump(interaction%law) > 0.0_dp) call report%warning(card%place, &
         'the conductance of '//interaction%name//' falls from '// &
         to_text(table_jump(interaction%law))//' to 0 where the gap exceeds that of the last '// &
         'row, '//to_text(maxval(interaction%law%table_gap))//'; an increment in which a gap '// &
         'would stay there has no solution: end the table with a row of conductance 0')
      closed = conductance(interaction%law, .true., 0.0_dp, 0.0_dp)
      open = conductance(interaction%law, .false., 0.0_dp, 0.0_dp)
      if (abs(law_jump(interaction%law)) <= continuous*max(open, closed)) return
      call report%warning(law_place, 'the conductance of '//interaction%name//' jumps by '// &
         to_text(law_jump(interaction%law))//' where the gap closes without pressure: from '// &
         to_text(open)//' open to '//to_text(closed)//' closed'//origin(interaction%law))
   end subroutine check_law

   !> Tells which law is missing, or that the two should meet.
   pure function origin(law) result(words)
      type(conductance_law_type), intent(in) :: law
      character(:), allocatable :: words

      if (law%open_kind == law_none) then
         words = ', for there is no open law'
      else
         words = '; at gap 0 and pressure 0 both laws should give the same'
      end if
   end function origin

end module deck_builder_interactions
