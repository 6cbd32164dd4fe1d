!> *COUPLING with *KINEMATIC -> faces that follow a reference node.
module deck_builder_couplings
   use card_parameters, only: need_parameter, parameter_place
   use card_values, only: check_extra, need_field, take_field
   use cards, only: cards_type, data_card_type, field_place, keyword_card_type
   use couplings, only: coupling_type
   use deck_context, only: deck_context_type, need_named
   use deck_report, only: deck_report_type
   use deck_structure, only: card_count, is_keyword
   use model, only: model_type
   use steps, only: dof_temperature
   use text, only: read_integer, to_text
   implicit none
   private
   public :: build_couplings

contains

   !> Builds all couplings. Each has a node for its rotation, which the builder of nodes left behind
   !> those of the deck.
   subroutine build_couplings(cards, context, model, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context    !! numbers -> indexes; receives notes
      type(model_type), intent(inout) :: model             !! receives the couplings
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer :: errors, k, n

      errors = report%error_count()
      allocate (model%couplings(card_count(cards, 'COUPLING')))
      n = 0
      do k = 1, size(cards%keywords)
         if (cards%keywords(k)%name == 'COUPLING') then
            n = n + 1
            model%couplings(n)%rotation = size(model%mesh%node_number) - size(model%couplings) + n
            call build_coupling(cards%keywords(k), context, model, report, model%couplings(n))
            if (is_keyword(cards, k + 1, 'KINEMATIC') .or. is_keyword(cards, k + 1, '')) cycle
            call report%error(cards%keywords(k)%place, '*KINEMATIC is missing: it must '// &
               'directly follow *COUPLING and name the degrees of freedom')
         else if (cards%keywords(k)%name == 'KINEMATIC') then
            if (is_keyword(cards, k - 1, 'COUPLING')) then
               call read_degrees(cards, cards%keywords(k), context, report, model%couplings(n))
            else
               call report%error(cards%keywords(k)%place, &
                  '*KINEMATIC must directly follow *COUPLING')
            end if
         end if
      end do
      if (report%error_count() > errors) call report%lose('equation')
   end subroutine build_couplings

   !> Name, reference node and surface.
   subroutine build_coupling(card, context, model, report, coupling)
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(in) :: context
      type(model_type), intent(inout) :: model
      type(deck_report_type), intent(inout) :: report
      type(coupling_type), intent(inout) :: coupling
      character(:), allocatable :: name

      coupling%card = card%place%image
      coupling%title = '*COUPLING, '//report%source%words_of(card%place)
      call need_parameter(card, 'REF NODE', report, name)
      if (len(name) > 0) call find_reference(name, card, context, model, report, coupling%reference)
      if (coupling%reference > 0) model%mesh%coordinates(:, coupling%rotation) = &
         model%mesh%coordinates(:, coupling%reference)
      call need_named(card, 'SURFACE', 'surface', model%mesh%surfaces, report, coupling%surface)
   end subroutine build_coupling

   !> The reference node: its number, or a set of one node.
   subroutine find_reference(name, card, context, model, report, node)
      character(*), intent(in) :: name
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(in) :: context
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      integer, intent(inout) :: node
      integer :: number, set
      logical :: is_number

      associate (place => parameter_place(card, 'REF NODE'), sets => model%mesh%node_sets)
         call read_integer(name, number, is_number)
         if (is_number) then
            node = context%node_index%find(number)
            if (node == 0) call report%missing(place, 'there is no node '//name, 'node', name)
            return
         end if
         call need_named(card, 'REF NODE', 'node set', sets, report, set)
         if (set == 0) return
         if (size(sets(set)%members) /= 1) then
            call report%error(place, 'a coupling has one reference node; node set '//name// &
               ' has '//to_text(size(sets(set)%members)))
         else
            node = sets(set)%members(1)
         end if
      end associate
   end subroutine find_reference

   !> First and last degree of freedom on each data card; without one all follow.
   subroutine read_degrees(cards, card, context, report, coupling)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      type(coupling_type), intent(inout) :: coupling
      integer :: j

      if (card%last_data < card%first_data) then
         coupling%follows = .true.
         call context%note('*KINEMATIC without data: displacements along x and y follow')
      end if
      do j = card%first_data, card%last_data
         call read_range(cards%data(j), context, report, coupling)
      end do
   end subroutine read_degrees

   subroutine read_range(data, context, report, coupling)
      type(data_card_type), intent(in) :: data
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      type(coupling_type), intent(inout) :: coupling
      integer :: dof, first, last
      logical :: valid

      valid = .true.
      first = 0
      call need_field(data, 1, 'first degree of freedom', report, first, valid)
      last = first
      call take_field(data, 2, 'last degree of freedom', report, last, valid)
      call check_extra(data, 2, 'first and last degree of freedom', report)
      if (.not. valid) return
      if (last < first) then
         call report%error(field_place(data, 2), 'the last degree of freedom is below the first')
         return
      end if
      do dof = first, last
         select case (dof)
         case (1, 2)
            coupling%follows(dof) = .true.
         case (3:6)
            call context%note('*KINEMATIC: degrees of freedom 3 to 6, which nodes of a face do '// &
               'not have, are ignored')
         case (dof_temperature)
            coupling%is_warm = .true.
         case default
            call report%error(field_place(data, merge(1, 2, dof == first)), &
               'degree of freedom '//to_text(dof)//'; faces follow in 1, 2 and 11')
            return
         end select
      end do
   end subroutine read_range

end module deck_builder_couplings
