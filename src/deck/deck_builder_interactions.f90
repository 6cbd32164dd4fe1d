!> *SURFACE INTERACTION with *FRICTION, *GAP LAW and *SURFACE BEHAVIOR.
module deck_builder_interactions
   use card_parameters, only: choose, has_parameter, need_parameter, parameter_place, &
      parameter_text
   use card_values, only: check_extra, field_place, need_field, take_field
   use cards, only: cards_type, data_card_type, keyword_card_type
   use conductance_laws, only: conductance, conductance_law_type, law_gas, law_jump, law_none, &
      law_power
   use contact_definitions, only: interaction_type
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use deck_structure, only: card_count
   use kinds, only: dp
   use model, only: model_type
   use text, only: to_text, to_upper
   implicit none
   private
   public :: build_interactions, find_interaction

   real(dp), parameter :: continuous = 1.0e-6_dp   !! a smaller jump is none, relative

contains

   !> Takes all surface interactions; a law belongs to the last *SURFACE INTERACTION before it.
   subroutine build_interactions(cards, context, model, report)
      type(cards_type), intent(in) :: cards                !! the cards
      type(deck_context_type), intent(inout) :: context    !! receives notes
      type(model_type), intent(inout) :: model             !! receives the interactions
      type(deck_report_type), intent(inout) :: report      !! receives errors and warnings
      integer :: k, n, last, errors

      allocate(model%interactions(card_count(cards, 'SURFACE INTERACTION')))
      n = 0
      last = 0
      errors = 0
      do k = 1, size(cards%keywords)
         associate (card => cards%keywords(k))
            select case (card%name)
            case ('SURFACE INTERACTION')
               if (n > 0 .and. report%error_count() == errors) then
                  call check_law(cards%keywords(last), model%interactions(n), report)
               end if
               errors = report%error_count()
               n = n + 1
               last = k
               call need_parameter(card, 'NAME', report, model%interactions(n)%name)
               if (find_interaction(model%interactions(:n - 1), &
                  model%interactions(n)%name) > 0) then
                  call report%error(parameter_place(card, 'NAME'), &
                     'surface interaction '//model%interactions(n)%name//' is defined twice')
               end if
            case ('FRICTION', 'GAP LAW', 'SURFACE BEHAVIOR')
               if (n == 0) then
                  call report%error(card%place, '*'//card%name// &
                     ' has no *SURFACE INTERACTION before it')
               else
                  call build_law(cards, card, context, report, model%interactions(n))
               end if
            case default
               cycle
            end select
         end associate
      end do
      if (n > 0 .and. report%error_count() == errors) then
         call check_law(cards%keywords(last), model%interactions(n), report)
      end if
   end subroutine build_interactions

   !> Index of a surface interaction by its name; 0 for an unknown one.
   pure integer function find_interaction(interactions, name)
      type(interaction_type), intent(in) :: interactions(:)   !! interactions
      character(*), intent(in) :: name                        !! name in upper case

      do find_interaction = size(interactions), 1, -1
         if (interactions(find_interaction)%name == name) return
      end do
   end function find_interaction

   subroutine build_law(cards, card, context, report, interaction)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      type(interaction_type), intent(inout) :: interaction

      if (card%name == 'SURFACE BEHAVIOR') then
         call check_behavior(card, context, report)
      else if (card%last_data >= card%first_data) then
         if (card%name == 'FRICTION') then
            call build_friction(cards%data(card%first_data), context, report, interaction%friction)
         else
            call build_gap_law(card, cards%data(card%first_data), report, interaction%law)
         end if
      end if
   end subroutine build_law

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
            ' is refused: tied faces do not open; let the bodies share nodes')
      case default
         call choose(card, 'PRESSURE-OVERCLOSURE', 'LINEAR/HARD', '', report, kind)
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
      end if
      if (size(data%fields) > 1) then
         call context%note('*FRICTION: the stick slope is read and not needed')
      end if
   end subroutine build_friction

   subroutine build_gap_law(card, data, report, law)
      type(keyword_card_type), intent(in) :: card
      type(data_card_type), intent(in) :: data
      type(deck_report_type), intent(inout) :: report
      type(conductance_law_type), intent(inout) :: law
      character(:), allocatable :: kind

      kind = ''
      if (.not. has_parameter(card, 'TYPE')) call report%error(card%place, '*GAP LAW needs TYPE=')
      call choose(card, 'TYPE', 'GAS/POWER', 'CLEARANCE', report, kind)
      if (kind == 'GAS') then
         if (law%open_kind /= law_none) then
            call report%error(card%place, 'a second open law in one surface interaction')
         end if
         law%open_kind = law_gas
         call build_gas_law(data, report, law)
      else if (kind == 'POWER') then
         if (law%closed_kind /= law_none) then
            call report%error(card%place, 'a second closed law in one surface interaction')
         end if
         law%closed_kind = law_power
         call build_power_law(data, report, law)
      end if
   end subroutine build_gap_law

   !> omega = A/(B + gamma).
   subroutine build_gas_law(data, report, law)
      type(data_card_type), intent(in) :: data
      type(deck_report_type), intent(inout) :: report
      type(conductance_law_type), intent(inout) :: law
      logical :: valid

      valid = .true.
      call need_field(data, 1, 'A', report, law%gas_a, valid)
      call need_field(data, 2, 'B', report, law%gas_b, valid)
      call check_extra(data, 2, 'A, B of A/(B + gap)', report)
      if (law%gas_a < 0.0_dp) call report%error(field_place(data, 1), 'A must not be negative')
      if (law%gas_b > 0.0_dp) return
      call report%error(field_place(data, 2), 'B must be positive')
      law%gas_b = 1.0_dp
   end subroutine build_gas_law

   !> omega = C0 + C1 p^n.
   subroutine build_power_law(data, report, law)
      type(data_card_type), intent(in) :: data
      type(deck_report_type), intent(inout) :: report
      type(conductance_law_type), intent(inout) :: law
      logical :: valid

      valid = .true.
      call need_field(data, 1, 'C0', report, law%power_c0, valid)
      call need_field(data, 2, 'C1', report, law%power_c1, valid)
      call need_field(data, 3, 'n', report, law%power_n, valid)
      call check_extra(data, 3, 'C0, C1, n of C0 + C1 pressure^n', report)
      if (law%power_c0 < 0.0_dp) call report%error(field_place(data, 1), 'C0 must not be negative')
      if (law%power_c1 < 0.0_dp) call report%error(field_place(data, 2), 'C1 must not be negative')
      if (law%power_n > 0.0_dp) return
      call report%error(field_place(data, 3), 'n must be positive')
      law%power_n = 1.0_dp
   end subroutine build_power_law

   !> Warns of a law that jumps where the gap closes.
   subroutine check_law(card, interaction, report)
      type(keyword_card_type), intent(in) :: card
      type(interaction_type), intent(in) :: interaction
      type(deck_report_type), intent(inout) :: report
      real(dp) :: jump, larger

      jump = law_jump(interaction%law)
      larger = max(conductance(interaction%law, .true., 0.0_dp, 0.0_dp), &
         conductance(interaction%law, .false., 0.0_dp, 0.0_dp))
      if (abs(jump) <= continuous*larger) return
      call report%warning(card%place, 'the conductance of '//interaction%name//' jumps by '// &
         to_text(jump)//' where the gap closes without pressure')
   end subroutine check_law

end module deck_builder_interactions
