!> *EQUATION -> linear equations between degrees of freedom.
module deck_builder_equations
   use card_values, only: check_extra, need_field
   use cards, only: cards_type, field_place, keyword_card_type
   use deck_context, only: deck_context_type, read_target
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use equations, only: equation_type
   use kinds, only: dp
   use model, only: model_type
   use sorting, only: sort_order
   use steps, only: dof_temperature
   use text, only: to_text
   implicit none
   private
   public :: build_equations

   integer, parameter :: term_fields = 3   !! node or set, degree of freedom, coefficient

   !> The terms of one equation of the deck, of single nodes or of all members of sets.
   type :: terms_type
      type(place_type) :: place                    !! where the equation begins
      integer, allocatable :: item(:), set(:)      !! node indexes, or sets
      integer, allocatable :: dof(:)
      real(dp), allocatable :: coefficient(:)
      type(place_type), allocatable :: at(:)       !! where each term is
      logical :: valid = .true.                    !! whether no error was found in it
   end type terms_type

contains

   !> Takes all equations.
   subroutine build_equations(cards, context, model, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(in) :: context       !! numbers -> indexes
      type(model_type), intent(inout) :: model             !! receives the equations
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(terms_type) :: terms
      integer :: data, k

      allocate (model%equations(0))
      do k = 1, size(cards%keywords)
         associate (card => cards%keywords(k))
            if (card%name /= 'EQUATION') cycle
            data = card%first_data
            do while (data <= card%last_data)
               call read_terms(cards, card, data, context, model, report, terms)
               if (terms%valid) call check_terms(terms, model, report)
               if (terms%valid) call add_equations(terms, model, report)
               if (.not. terms%valid) call report%lose('equation')
            end do
         end associate
      end do
   end subroutine build_equations

   !> Reads one equation: the number of its terms, then the terms, any number on a card.
   subroutine read_terms(cards, card, data, context, model, report, terms)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      integer, intent(inout) :: data               ! its first data card; then that behind it
      type(deck_context_type), intent(in) :: context
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      type(terms_type), intent(out) :: terms
      integer :: i, n

      n = 0
      terms%place = field_place(cards%data(data), 1)
      call need_field(cards%data(data), 1, 'number of terms', report, n, terms%valid)
      call check_extra(cards%data(data), 1, 'number of terms', report)
      if (terms%valid .and. n < 1) then
         call report%error(terms%place, 'an equation has at least one term')
         terms%valid = .false.
      end if
      data = data + 1
      allocate (terms%item(0), terms%set(0), terms%dof(0), terms%coefficient(0), terms%at(0))
      do while (terms%valid .and. size(terms%dof) < n .and. data <= card%last_data)
         do i = 1, size(cards%data(data)%fields), term_fields
            call read_term(cards, data, i, context, model, report, terms)
         end do
         data = data + 1
      end do
      if (.not. terms%valid) then
         data = card%last_data + 1
      else if (size(terms%dof) /= n) then
         call report%error(terms%place, 'the equation should have '//to_text(n)//' terms; '// &
            to_text(size(terms%dof))//' are given')
         terms%valid = .false.
      end if
   end subroutine read_terms

   !> Reads one term: node or set, degree of freedom, coefficient.
   subroutine read_term(cards, data, position, context, model, report, terms)
      type(cards_type), intent(in) :: cards
      integer, intent(in) :: data, position
      type(deck_context_type), intent(in) :: context
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      type(terms_type), intent(inout) :: terms
      integer :: dof, item, set
      real(dp) :: coefficient

      dof = 0
      coefficient = 0.0_dp
      associate (card => cards%data(data))
         call read_target(card, position, 'node', context%node_index, model%mesh%node_sets, &
            report, item, set, terms%valid)
         call need_field(card, position + 1, 'degree of freedom', report, dof, terms%valid)
         call need_field(card, position + 2, 'coefficient', report, coefficient, terms%valid)
         if (.not. terms%valid) return
         if (all(dof /= [1, 2, dof_temperature])) then
            call report%error(field_place(card, position + 1), 'degree of freedom '// &
               to_text(dof)//'; an equation relates 1 and 2, or 11')
            terms%valid = .false.
         end if
         terms%item = [terms%item, item]
         terms%set = [terms%set, set]
         terms%dof = [terms%dof, dof]
         terms%coefficient = [terms%coefficient, coefficient]
         terms%at = [terms%at, field_place(card, position)]
      end associate
   end subroutine read_term

   !> Displacements and temperatures are solved one after the other; sets have one length; the first
   !> term, which the others determine, is there.
   subroutine check_terms(terms, model, report)
      type(terms_type), intent(inout) :: terms
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      integer :: i, lengths(size(terms%set))

      lengths = 1
      do i = 1, size(lengths)
         if (terms%set(i) > 0) lengths(i) = size(model%mesh%node_sets(terms%set(i))%members)
         if (lengths(i) == 1 .or. maxval(lengths(:i - 1)) <= 1) cycle
         if (lengths(i) == maxval(lengths(:i - 1))) cycle
         call report%error(terms%at(i), 'the node sets of an equation must have the same '// &
            'number of nodes, or one node: '//to_text(maxval(lengths(:i - 1)))//' and '// &
            to_text(lengths(i)))
         terms%valid = .false.
      end do
      i = findloc((terms%dof == dof_temperature) .neqv. (terms%dof(1) == dof_temperature), &
         .true., dim=1)
      if (i > 0) then
         call report%error(terms%at(i), &
            'an equation relates displacements or temperatures, not both')
         terms%valid = .false.
      end if
      if (abs(terms%coefficient(1)) > 0.0_dp) return
      call report%error(terms%at(1), 'the coefficient of the first term must not be 0')
      terms%valid = .false.
   end subroutine check_terms

   !> Adds the equation, or one for each member of its sets in the order of the node numbers.
   subroutine add_equations(terms, model, report)
      type(terms_type), intent(in) :: terms
      type(model_type), intent(inout) :: model
      type(deck_report_type), intent(inout) :: report
      integer, allocatable :: members(:)
      type(equation_type) :: equation
      integer :: i, k, n, same(size(model%mesh%node_number)), unity(2, 0)

      n = 1
      same = [(i, i=1, size(same))]
      do i = 1, size(terms%set)
         if (terms%set(i) > 0) n = max(n, size(model%mesh%node_sets(terms%set(i))%members))
      end do
      do k = 1, n
         equation%title = '*EQUATION, '//report%source%words_of(terms%place)
         equation%card = terms%place%image
         equation%dof = terms%dof
         equation%coefficient = terms%coefficient
         equation%node = terms%item
         do i = 1, size(terms%set)
            if (terms%set(i) == 0) cycle
            members = model%mesh%node_sets(terms%set(i))%members
            members = members(sort_order(model%mesh%node_number(members)))
            equation%node(i) = members(min(k, size(members)))
         end do
         call equation%replace(unity, same)
         if (all(abs(equation%coefficient) <= 0.0_dp)) then
            call report%error(terms%place, 'the terms of the equation cancel')
            return
         end if
         model%equations = [model%equations, equation]
      end do
   end subroutine add_equations

end module deck_builder_equations
