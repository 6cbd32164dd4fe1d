!> *EQUATION, *COUPLING with *KINEMATIC, *RIGID BODY -> linear equations between degrees of freedom;
!> *PRE-TENSION SECTION -> a body cut in two, and the section that joins its faces again.
module deck_builder_equations
   use card_values, only: need_parameter, read_field, read_row
   use deck_builder_rigid, only: build_rigid_body, check_rigid_masters, need_faces
   use deck_context, only: deck_type
   use deck_source, only: place_type
   use deck_structure, only: cards_of, is_keyword
   use equations, only: coupling_type, equation_type
   use kinds, only: dp
   use load_requests, only: target_type
   use mesh, only: surface_type
   use section_cuts, only: cut_mesh, section_normal, unit_vector
   use sorting, only: sort_order
   use steps, only: dof_temperature
   use text, only: read_integer, to_text
   use transforms, only: axis_in_plane
   implicit none
   private
   public :: build_equations, build_couplings, find_reference, build_pre_tensions

   integer, parameter :: term_fields = 3   !! node or set, degree of freedom, coefficient

   !> One term, of a node or of all members of a set.
   type, extends(target_type) :: term_type
      integer :: dof = 0
      real(dp) :: coefficient = 0.0_dp
      type(place_type) :: place                    !! where it is
   end type term_type

contains

   !> Builds all equations.
   subroutine build_equations(deck)
      type(deck_type), intent(inout) :: deck
      type(term_type), allocatable :: terms(:)
      integer, allocatable :: places(:)
      type(equation_type), allocatable :: list(:)   ! (capacity)
      integer :: count, data, first, k
      logical :: valid

      count = 0
      allocate (list(64))
      places = cards_of(deck%cards, 'EQUATION')
      do k = 1, size(places)
         call deck%open_card(places(k))
         data = 1
         do while (data <= size(deck%card%data))
            first = data
            call read_terms(data, deck, terms)
            valid = allocated(terms)
            if (valid) call check_terms(terms, deck, valid)
            if (valid) call add_equations(terms, deck%card%data(first)%place(1), deck, list, count)
            if (.not. valid) call deck%lose('equation')
         end do
      end do
      deck%model%equations = list(:count)
   end subroutine build_equations

   !> Reads one equation: the number of its terms, then the terms, any number on a card, each a node
   !> or set, degree of freedom, coefficient.
   subroutine read_terms(data, deck, terms)
      integer, intent(inout) :: data               ! its first data card; then that behind it
      type(deck_type), intent(inout) :: deck
      type(term_type), allocatable, intent(out) :: terms(:)   ! unallocated after an error
      type(term_type), allocatable :: found(:)
      type(term_type) :: term
      type(place_type) :: place
      real(dp) :: given(1)
      integer :: dof, i, n
      logical :: valid

      place = deck%card%data(data)%place(1)
      call read_row(deck%card%data(data), '#number of terms >0', deck, given, valid)
      n = nint(given(1))
      data = data + 1
      allocate (found(0))
      do while (valid .and. size(found) < n .and. data <= size(deck%card%data))
         do i = 1, size(deck%card%data(data)%fields), term_fields
            associate (row => deck%card%data(data))
               term%place = row%place(i)
               call deck%need_target('node', row, i, term%target_type, valid)
               call read_field(row, i + 1, 'degree of freedom', deck, dof, valid)
               call read_field(row, i + 2, 'coefficient', deck, term%coefficient, valid)
               if (.not. valid) cycle
               term%dof = axis_in_plane(deck%model%transforms, deck%mesh%node_sets, &
                  term%members(deck%mesh%node_sets), dof)
               valid = any(term%dof == [1, 2, dof_temperature])
               if (.not. valid) call deck%error(row%place(i + 1), 'degree of freedom '// &
                  to_text(dof)//'; an equation relates 1 and 2, or 11')
               found = [found, term]
            end associate
         end do
         data = data + 1
      end do
      if (.not. valid) then
         data = size(deck%card%data) + 1
      else if (size(found) /= n) then
         call deck%error(place, 'the equation should have '//to_text(n)//' terms; '// &
            to_text(size(found))//' are given')
      else
         call move_alloc(found, terms)
      end if
   end subroutine read_terms

   !> Displacements and temperatures are solved one after the other; sets have one length; the first
   !> term, which the others determine, is there.
   subroutine check_terms(terms, deck, valid)
      type(term_type), intent(in) :: terms(:)
      type(deck_type), intent(inout) :: deck
      logical, intent(out) :: valid
      integer :: errors, i, lengths(size(terms))

      errors = deck%error_count()
      lengths = 1
      do i = 1, size(lengths)
         lengths(i) = size(terms(i)%members(deck%mesh%node_sets))
         if (lengths(i) == 1 .or. maxval(lengths(:i - 1)) <= 1) cycle
         if (lengths(i) /= maxval(lengths(:i - 1))) call deck%error(terms(i)%place, 'the node '// &
            'sets of an equation must have the same number of nodes, or one node: '// &
            to_text(maxval(lengths(:i - 1)))//' and '//to_text(lengths(i)))
      end do
      i = findloc((terms%dof == dof_temperature) .neqv. (terms(1)%dof == dof_temperature), &
         .true., dim=1)
      if (i > 0) call deck%error(terms(i)%place, 'an equation relates displacements or '// &
         'temperatures, not both')
      if (abs(terms(1)%coefficient) <= 0.0_dp) call deck%error(terms(1)%place, 'the '// &
         'coefficient of the first term must not be 0')
      ! A set without nodes has an error on its card.
      valid = all(lengths > 0) .and. deck%error_count() == errors
   end subroutine check_terms

   !> Adds the equation, or one for each member of its sets in the order of the node numbers.
   subroutine add_equations(terms, place, deck, list, count)
      type(term_type), intent(in) :: terms(:)
      type(place_type), intent(in) :: place        ! where the equation begins
      type(deck_type), intent(inout) :: deck
      type(equation_type), allocatable, intent(inout) :: list(:)   ! (capacity)
      integer, intent(inout) :: count
      integer, allocatable :: members(:), nodes(:, :)
      type(equation_type), allocatable :: longer(:)
      type(equation_type) :: equation
      integer :: i, k, n

      n = maxval([(size(terms(i)%members(deck%mesh%node_sets)), i=1, size(terms))])
      allocate (nodes(n, size(terms)))
      do i = 1, size(terms)
         members = terms(i)%members(deck%mesh%node_sets)
         members = members(sort_order(deck%mesh%node_number(members)))
         nodes(:, i) = members(min([(k, k=1, n)], size(members)))
      end do
      equation%title = '*EQUATION, '//deck%source%words_of(place)
      equation%card = place%image
      do k = 1, n
         equation%node = [integer ::]
         equation%dof = [integer ::]
         equation%coefficient = [real(dp) ::]
         do i = 1, size(terms)
            call equation%add_term(nodes(k, i), terms(i)%dof, terms(i)%coefficient)
         end do
         if (all(abs(equation%coefficient) <= 0.0_dp)) then
            call deck%error(place, 'the terms of the equation cancel')
            return
         end if
         if (count == size(list)) then
            allocate (longer(2*count))
            longer(:count) = list
            call move_alloc(longer, list)
         end if
         count = count + 1
         list(count) = equation
      end do
   end subroutine add_equations

   !> Builds all couplings and rigid bodies. Each has a node for its rotation, which the builder of
   !> nodes left behind those of the deck.
   subroutine build_couplings(deck)
      type(deck_type), intent(inout) :: deck
      integer :: errors, k, n

      errors = deck%error_count()
      allocate (deck%model%couplings(size(cards_of(deck%cards, 'COUPLING')) + &
         size(cards_of(deck%cards, 'RIGID BODY'))))
      n = 0
      do k = 1, size(deck%cards%keywords)
         call deck%open_card(k)
         if (any(deck%card%name == [character(10) :: 'RIGID BODY', 'COUPLING'])) then
            n = n + 1
            associate (coupling => deck%model%couplings(n), nodes => deck%mesh%node_number)
               coupling%rotation = size(nodes) - size(deck%model%couplings) + n
               coupling%card = deck%card%place%image
               coupling%title = '*'//deck%card%name//', '//deck%source%words_of(deck%card%place)
               call find_reference('REF NODE', deck, coupling%reference)
               if (coupling%reference > 0) deck%mesh%coordinates(:, coupling%rotation) = &
                  deck%mesh%coordinates(:, coupling%reference)
            end associate
         end if
         select case (deck%card%name)
         case ('RIGID BODY')
            if (deck%card%has('ROT NODE')) call find_reference('ROT NODE', deck, &
               deck%model%couplings(n)%rotation_node)
            call build_rigid_body(deck, deck%model%couplings(n))
         case ('COUPLING')
            call deck%need_named('SURFACE', 'surface', deck%model%couplings(n)%surface)
            call need_faces(deck%card%place_of('SURFACE'), deck, deck%model%couplings(n)%surface)
            if (.not. is_keyword(deck%cards, k + 1, 'KINEMATIC')) call deck%error(deck%card%place, &
               '*KINEMATIC is missing: it must directly follow *COUPLING and name the degrees '// &
               'of freedom')
         case ('KINEMATIC')
            if (is_keyword(deck%cards, k - 1, 'COUPLING')) then
               call read_degrees(deck, deck%model%couplings(n))
            else
               call deck%error(deck%card%place, '*KINEMATIC must directly follow *COUPLING')
            end if
         case default
            cycle
         end select
      end do
      if (deck%error_count() > errors) call deck%lose('equation')
      call check_rigid_masters(deck)
   end subroutine build_couplings

   !> The node that a parameter names, which the card must have: its number, or a set of one node.
   subroutine find_reference(parameter, deck, node)
      character(*), intent(in) :: parameter
      type(deck_type), intent(inout) :: deck
      integer, intent(out) :: node                         !! its index; 0 after an error
      character(:), allocatable :: name
      integer :: number, set
      logical :: is_number

      node = 0
      call need_parameter(deck%card, parameter, deck, name)
      if (len(name) == 0) return
      associate (place => deck%card%place_of(parameter), sets => deck%mesh%node_sets)
         call read_integer(name, number, is_number)
         if (is_number) then
            node = deck%node_index%find(number)
            if (node == 0) call deck%missing(place, 'there is no node '//name, 'node', name)
            return
         end if
         call deck%need_named(parameter, 'node set', set)
         if (set == 0) return
         if (size(sets(set)%members) /= 1) then
            call deck%error(place, 'there is one reference node; node set '//name//' has '// &
               to_text(size(sets(set)%members)))
         else
            node = sets(set)%members(1)
         end if
      end associate
   end subroutine find_reference

   !> First and last degree of freedom on each data card; without one all follow.
   subroutine read_degrees(deck, coupling)
      type(deck_type), intent(inout) :: deck
      type(coupling_type), intent(inout) :: coupling
      real(dp) :: range(2)
      integer :: dof, j
      logical :: valid

      if (size(deck%card%data) == 0) then
         coupling%follows = .true.
         call deck%note('*KINEMATIC without data: displacements along x and y follow')
      end if
      do j = 1, size(deck%card%data)
         associate (data => deck%card%data(j))
            call read_row(data, '#first degree of freedom/#last degree of freedom?', deck, range, &
               valid)
            if (.not. valid) cycle
            if (.not. data%has(2)) range(2) = range(1)
            if (range(2) < range(1)) call deck%error(data%place(2), 'the last degree of '// &
               'freedom is below the first')
            do dof = nint(range(1)), nint(range(2))
               select case (dof)
               case (1, 2)
                  coupling%follows(dof) = .true.
               case (3:6)
                  call deck%note('*KINEMATIC: degrees of freedom 3 to 6, which nodes of a face '// &
                     'do not have, are ignored')
               case (dof_temperature)
                  coupling%is_warm = .true.
               case default
                  call deck%error(data%place(merge(1, 2, dof == nint(range(1)))), 'degree of '// &
                     'freedom '//to_text(dof)//'; faces follow in 1, 2 and 11')
                  exit
               end select
            end do
         end associate
      end do
   end subroutine read_degrees

   !> Builds all pre-tension sections, behind the couplings: their nodes are behind all others.
   subroutine build_pre_tensions(deck)
      type(deck_type), intent(inout) :: deck
      type(coupling_type) :: section
      integer, allocatable :: places(:)
      integer :: k

      places = cards_of(deck%cards, 'PRE-TENSION SECTION')
      do k = 1, size(places)
         call deck%open_card(places(k))
         call build_section(deck, section)
         if (section%opposite == 0) call deck%lose('equation')
         if (section%opposite > 0) deck%model%couplings = [deck%model%couplings, section]
      end do
   end subroutine build_pre_tensions

   !> Builds one section; without an opposite face after an error.
   subroutine build_section(deck, section)
      type(deck_type), intent(inout) :: deck
      type(coupling_type), intent(out) :: section
      character(:), allocatable :: fault
      real(dp) :: given(3)
      logical :: sound, valid

      section%card = deck%card%place%image
      section%title = '*PRE-TENSION SECTION, '//deck%source%words_of(deck%card%place)
      call find_reference('NODE', deck, section%reference)
      call deck%need_named('SURFACE', 'surface', section%surface)
      call need_faces(deck%card%place_of('SURFACE'), deck, section%surface)
      valid = section%reference > 0 .and. section%surface > 0 .and. all(deck%element_valid)
      if (valid) valid = size(deck%mesh%surfaces(section%surface)%faces) > 0
      if (valid) section%normal = section_normal(section%surface, deck%mesh)
      if (size(deck%card%data) > 0) then
         call read_row(deck%card%data(1), 'x of the normal/y of the normal/z of the normal?', &
            deck, given, sound)
         valid = valid .and. sound
         section%normal = unit_vector(given(:2))
         if (sound .and. (norm2(section%normal) <= 0.0_dp .or. abs(given(3)) > 0.0_dp)) then
            call deck%error(deck%card%data(1)%place(1), 'the normal of a section is a '// &
               'direction in the plane, such as 0., 1., 0.')
            valid = .false.
         end if
      end if
      if (.not. valid) return
      fault = ''
      if (norm2(section%normal) <= 0.0_dp) fault = 'is closed: it has no normal'
      if (any(deck%mesh%element_nodes == section%reference) .or. &
         any(deck%model%couplings%reference == section%reference)) fault = 'has node '// &
         to_text(deck%mesh%node_number(section%reference))//', which elements or another card '// &
         'have: the reference node is a node of its own'
      if (len(fault) == 0) call cut(deck, section, fault)
      if (len(fault) > 0) call deck%error(deck%card%place, 'this section '//fault)
   end subroutine build_section

   subroutine cut(deck, section, fault)
      type(deck_type), intent(inout) :: deck
      type(coupling_type), intent(inout) :: section
      character(:), allocatable, intent(out) :: fault
      type(surface_type) :: other
      integer :: first, last

      call cut_mesh(section%surface, deck%mesh, other%faces, first, fault)
      if (len(fault) > 0) return
      last = size(deck%mesh%node_number)
      ! No deck can name it.
      other%name = section%title
      other%card = section%card
      deck%mesh%surfaces = [deck%mesh%surfaces, other]
      section%opposite = size(deck%mesh%surfaces)
      deck%face_places = [deck%face_places, deck%face_places(section%surface)]
      deck%node_place = [deck%node_place, spread(deck%card%place, 1, last - first + 1)]
      deck%node_valid = [deck%node_valid, spread(.true., 1, last - first + 1)]
      deck%dropped = [deck%dropped, spread(.false., 1, last - first + 1)]
      call deck%note(section%title//': the elements of its surface have the nodes '// &
         to_text(deck%mesh%node_number(first))//' to '//to_text(deck%mesh%node_number(last))// &
         ' there, which the deck does not have')
   end subroutine cut

end module deck_builder_equations
