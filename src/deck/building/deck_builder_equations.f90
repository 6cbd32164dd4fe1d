!> *EQUATION -> linear equations between degrees of freedom.
module deck_builder_equations
   use card_values, only: check_extra, need_field
   use cards, only: cards_type, data_card_type, field_place, keyword_card_type
   use deck_context, only: deck_context_type, read_target
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use deck_structure, only: cards_of
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

   !> One term, of a node or of all members of a set.
   type :: term_type
      integer :: item = 0, set = 0                 !! node index, or set
      integer :: dof = 0
      real(dp) :: coefficient = 0.0_dp
      type(place_type) :: place                    !! where it is
   end type term_type

contains

   !> Builds all equations.
   subroutine build_equations(cards, context, model, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(in) :: context       !! numbers -> indexes
      type(model_type), intent(inout) :: model             !! receives the equations
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(term_type), allocatable :: terms(:)
      integer, allocatable :: places(:)
      integer :: data, first, k
      logical :: valid

      allocate (model%equations(0))
      places = cards_of(cards, 'EQUATION')
      do k = 1, size(places)
         associate (card => cards%keywords(places(k)))
            data = card%first_data
            do while (data <= card%last_data)
               first = data
               call read_terms(cards, card, data, context, model, report, terms)
               valid = allocated(terms)
               if (valid) call check_terms(terms, model, report, valid)
               if (valid) call add_equations(terms, field_place(cards%data(first), 1), model, &
                  report)
               if (.not. valid) call report%lose('equation')
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
      type(term_type), allocatable, intent(out) :: terms(:)   ! unallocated after an error
      type(term_type), allocatable :: found(:)
      type(place_type) :: place
      integer :: i, n
      logical :: valid

      n = 0
      valid = .true.
      place = field_place(cards%data(data), 1)
      call need_field(cards%data(data), 1, 'number of terms', report, n, valid)
      call check_extra(cards%data(data), 1, 'number of terms', report)
      if (valid .and. n < 1) then
         call report%error(place, 'an equation has at least one term')
         valid = .false.
      end if
      data = data + 1
      allocate (found(0))
      do while (valid .and. size(found) < n .and. data <= card%last_data)
         do i = 1, size(cards%data(data)%fields), term_fields
            call read_term(cards%data(data), i, context, model, report, found, valid)
         end do
         data = data + 1
      end do
      if (.not. valid) then
         data = card%last_data + 1
      else if (size(found) /= n) then
         call report%error(place, 'the equation should have '//to_text(n)//' terms; '// &
            to_text(size(found))//' are given')
      else
         call move_alloc(found, terms)
      end if
   end subroutine read_terms

   !> Reads one term: node or set, degree of freedom, coefficient.
   subroutine read_term(card, position, context, model, report, terms, valid)
      type(data_card_type), intent(in) :: card
      integer, intent(in) :: position
      type(deck_context_type), intent(in) :: context
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      type(term_type), allocatable, intent(inout) :: terms(:)
      logical, intent(inout) :: valid
      type(term_type) :: term

      term%place = field_place(card, position)
      call read_target(card, position, 'node', context%node_index, model%mesh%node_sets, report, &
         term%item, term%set, valid)
      call need_field(card, position + 1, 'degree of freedom', report, term%dof, valid)
      call need_field(card, position + 2, 'coefficient', report, term%coefficient, valid)
      if (.not. valid) return
      if (all(term%dof /= [1, 2, dof_temperature])) then
         call report%error(field_place(card, position + 1), 'degree of freedom '// &
            to_text(term%dof)//'; an equation relates 1 and 2, or 11')
         valid = .false.
      end if
      terms = [terms, term]
   end subroutine read_term

   !> Displacements and temperatures are solved one after the other; sets have one length; the first
   !> term, which the others determine, is there.
   subroutine check_terms(terms, model, report, valid)
      type(term_type), intent(in) :: terms(:)
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      logical, intent(inout) :: valid
      integer :: i, lengths(size(terms))

      lengths = 1
      do i = 1, size(lengths)
         if (terms(i)%set > 0) lengths(i) = size(model%mesh%node_sets(terms(i)%set)%members)
         if (lengths(i) == 1 .or. maxval(lengths(:i - 1)) <= 1) cycle
         if (lengths(i) == maxval(lengths(:i - 1))) cycle
         call report%error(terms(i)%place, 'the node sets of an equation must have the same '// &
            'number of nodes, or one node: '//to_text(maxval(lengths(:i - 1)))//' and '// &
            to_text(lengths(i)))
         valid = .false.
      end do
      i = findloc((terms%dof == dof_temperature) .neqv. (terms(1)%dof == dof_temperature), &
         .true., dim=1)
      if (i > 0) then
         call report%error(terms(i)%place, &
            'an equation relates displacements or temperatures, not both')
         valid = .false.
      end if
      if (abs(terms(1)%coefficient) > 0.0_dp) return
      call report%error(terms(1)%place, 'the coefficient of the first term must not be 0')
      valid = .false.
   end subroutine check_terms

   !> Adds the equation, or one for each member of its sets in the order of the node numbers.
   subroutine add_equations(terms, place, model, report)
      type(term_type), intent(in) :: terms(:)
      type(place_type), intent(in) :: place        ! where the equation begins
      type(model_type), intent(inout) :: model
      type(deck_report_type), intent(inout) :: report
      integer, allocatable :: members(:)
      type(equation_type) :: equation
      integer :: i, k, n, same(size(model%mesh%node_number)), unity(2, 0)

      n = 1
      same = [(i, i=1, size(same))]
      do i = 1, size(terms)
         if (terms(i)%set > 0) n = max(n, size(model%mesh%node_sets(terms(i)%set)%members))
      end do
      do k = 1, n
         equation%title = '*EQUATION, '//report%source%words_of(place)
         equation%card = place%image
         equation%dof = terms%dof
         equation%coefficient = terms%coefficient
         equation%node = terms%item
         do i = 1, size(terms)
            if (terms(i)%set == 0) cycle
            members = model%mesh%node_sets(terms(i)%set)%members
            members = members(sort_order(model%mesh%node_number(members)))
            equation%node(i) = members(min(k, size(members)))
         end do
         call equation%replace(unity, same)
         if (all(abs(equation%coefficient) <= 0.0_dp)) then
            call report%error(place, 'the terms of the equation cancel')
            return
         end if
         model%equations = [model%equations, equation]
      end do
   end subroutine add_equations

end module deck_builder_equations
