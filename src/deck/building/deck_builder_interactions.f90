!> *SURFACE INTERACTION with *FRICTION and *SURFACE BEHAVIOR, and the laws of its conductance.
module deck_builder_interactions
   use card_parameters, only: choose, has_parameter, need_parameter, parameter_place, parameter_text
   use card_values, only: check_extra, take_field
   use cards, only: cards_type, field_place, keyword_card_type
   use conductance_laws, only: conductance, conductance_law_type, law_jump, law_none, &
      table_jump, varies_with_temperature
   use contact_definitions, only: interaction_type
   use deck_builder_friction, only: build_friction
   use deck_builder_gap_conductance, only: build_gap_clearance, build_gap_conductance, &
      join_gap_conductance
   use deck_builder_gap_laws, only: build_gap_law
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use deck_structure, only: card_count, report_twice
   use kinds, only: dp
   use model, only: model_type, physical_constants_type
   use temperature_laws, only: face_temperatures_type, largest_jump, law_at, &
      radiation_ends
   use text, only: to_text, to_upper
   implicit none
   private
   public :: build_interactions, find_interaction

   real(dp), parameter :: continuous = 1.0e-6_dp   !! a smaller jump is none, relative

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
            if (card%name == 'STEP') exit
            select case (card%name)
            case ('SURFACE INTERACTION')
               errors = report%error_count()
               n = n + 1
               call need_parameter(card, 'NAME', report, model%interactions(n)%name)
               if (find_interaction(model%interactions(:n - 1), &
                  model%interactions(n)%name) > 0) then
                  call report_twice(cards, k, 'surface interaction '// &
                     model%interactions(n)%name, report)
                  call report%lose('surface interaction')
               end if
               law_place = card%place
               call pass_thickness(cards, card, context, report)
               call build_laws(cards, k, model%constants, context, report, &
                  model%interactions(n), law_place)
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
      call context%note('*SURFACE INTERACTION: the thickness is ignored: that of '// &
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
   subroutine build_laws(cards, place, constants, context, report, interaction, law_place)
      type(cards_type), intent(in) :: cards
      integer, intent(in) :: place
      type(physical_constants_type), intent(in) :: constants
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      type(interaction_type), intent(inout) :: interaction
      type(place_type), intent(inout) :: law_place   ! becomes that of the data of the last law
      type(conductance_law_type) :: table
      integer :: friction, k

      friction = 0
      do k = place + 1, size(cards%keywords)
         associate (card => cards%keywords(k))
            if (any(card%name == ['SURFACE INTERACTION', 'STEP               '])) exit
            if (card%name == 'SURFACE BEHAVIOR') call check_behavior(card, context, report)
            if (card%last_data < card%first_data .and. card%name /= 'FRICTION') cycle
            if (card%name == 'GAP LAW' .or. card%name == 'GAP CONDUCTANCE') then
               law_place = field_place(cards%data(card%first_data), 1)
            end if
            select case (card%name)
            case ('FRICTION')
               if (friction > 0) call report%error(card%place, 'a second *FRICTION in one '// &
                  'surface interaction; the first is on '// &
                  report%source%words_of(cards%keywords(friction)%place)//': leave one of them out')
               friction = k
               call build_friction(cards, card, context, report, interaction%friction)
            case ('GAP LAW')
               call build_gap_law(cards, card, interaction%name, constants, context, report, &
                  interaction%law)
            case ('GAP CONDUCTANCE')
               if (has_parameter(card, 'CLEARANCE')) then
                  call build_gap_clearance(cards, card, interaction%name, context, report, &
                     interaction%law)
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
         call context%note('*SURFACE BEHAVIOR is ignored: contact is exact')
      end select
   end subroutine check_behavior

   !> Warns of a law that jumps, where the gap closes or where its table of clearances ends.
   subroutine check_law(card, law_place, interaction, report)
      type(keyword_card_type), intent(in) :: card
      type(place_type), intent(in) :: law_place      ! where the last of its laws is
      type(interaction_type), intent(in) :: interaction
      type(deck_report_type), intent(inout) :: report
      type(conductance_law_type) :: law
      type(face_temperatures_type) :: faces
      real(dp) :: open, closed
      character(:), allocatable :: there

      if (table_jump(interaction%law) > 0.0_dp) call report%warning(card%place, &
         'the conductance of '//interaction%name//' falls from '// &
         to_text(table_jump(interaction%law))//' to 0 where the gap exceeds that of the last '// &
         'row, '//to_text(maxval(interaction%law%table_gap))//'; an increment in which a gap '// &
         'would stay there has no solution: end the table with a row of conductance 0')
      if (radiation_ends(interaction%law)) call report%warning(law_place, 'faces of '// &
         interaction%name//' radiate where they are open and not where they are closed: the '// &
         'conductance jumps by that of radiation where the gap closes; TYPE=CMY and '// &
         'TYPE=ROSS-STOUTE add to it')
      faces = largest_jump(interaction%law)
      law = law_at(interaction%law, faces)
      law%radiation = 0.0_dp
      there = ''
      if (varies_with_temperature(interaction%law)) there = ' at a mean temperature of '// &
         to_text(faces%mean)
      closed = conductance(law, .true., 0.0_dp, 0.0_dp)
      open = conductance(law, .false., 0.0_dp, 0.0_dp)
      if (abs(law_jump(law)) <= continuous*max(open, closed)) return
      call report%warning(law_place, 'the conductance of '//interaction%name//' jumps by '// &
         to_text(law_jump(law))//' where the gap closes without pressure'//there//': from '// &
         to_text(open)//' open to '//to_text(closed)//' closed'//origin(law))
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
