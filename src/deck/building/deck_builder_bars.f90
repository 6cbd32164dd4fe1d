!> *SPRING, and *SOLID SECTION of trusses -> springs and trusses.
module deck_builder_bars
   use model, only: bar_type
   use card_values, only: read_field, read_row
   use deck_context, only: deck_type
   use deck_structure, only: cards_of
   use element_types, only: axial_spring, drawn_line, ground_spring, truss
   use equations, only: fill_equation
   use kinds, only: dp
   use materials, only: follows_temperature, isotropic, of_elasticity, of_expansion
   use steps, only: dof_temperature
   use text, only: to_text
   use transforms, only: axis_in_plane
   implicit none
   private
   public :: build_bars

contains

   !> Builds all springs and trusses; sections are known.
   subroutine build_bars(deck)
      type(deck_type), intent(inout) :: deck
      type(bar_type) :: of_line(size(deck%line_number))
      integer :: i
      integer, allocatable :: cards(:)

      cards = cards_of(deck%cards, 'SPRING')
      do i = 1, size(cards)
         call deck%open_card(cards(i))
         call read_spring(deck, of_line)
      end do
      cards = cards_of(deck%cards, 'SOLID SECTION')
      do i = 1, size(cards)
         call deck%open_card(cards(i))
         call take_section(i, deck, of_line)
      end do
      do i = 1, size(of_line)
         if (deck%line_kind(i) <= drawn_line .or. of_line(i)%stiffness > 0.0_dp) cycle
         if (.not. deck%has_errors()) call deck%error(deck%line_place(i), 'element '// &
            to_text(deck%line_number(i))//' has no '// &
            trim(merge('*SOLID SECTION', '*SPRING       ', deck%line_kind(i) == truss)))
      end do
      deck%model%bars = pack(of_line, [(allocated(of_line(i)%elongation%node), i=1, size(of_line))])
   end subroutine build_bars

   !> Reads one *SPRING: degrees of freedom where its elements have some, then the constant.
   subroutine read_spring(deck, of_line)
      type(deck_type), intent(inout) :: deck
      type(bar_type), intent(inout) :: of_line(:)
      integer, allocatable :: members(:)
      integer :: dof(2), i, k, set
      real(dp) :: stiffness(1)
      logical :: has_dofs, sound, valid

      call deck%need_named('ELSET', 'element set', set)
      if (set == 0 .or. size(deck%card%data) == 0) return
      members = deck%line_sets(set)%members
      valid = size(members) > 0 .and. all(deck%line_kind(members) > truss)
      if (.not. valid) call deck%error(deck%card%place_of('ELSET'), 'this set has elements '// &
         'that are no springs')
      has_dofs = any(deck%line_kind(members) >= ground_spring)
      dof = 0
      if (has_dofs .and. valid) then
         associate (data => deck%card%data(1))
            do k = 1, maxval(deck%line_kind(members)) - ground_spring + 1
               call read_field(data, k, 'degree of freedom', deck, dof(k), valid)
               associate (ends => deck%line_nodes(k, members))
                  if (valid) dof(k) = axis_in_plane(deck%model%transforms, deck%mesh%node_sets, &
                     pack(ends, ends > 0), dof(k))
               end associate
               if (valid .and. (dof(k) < 1 .or. dof(k) > 2)) then
                  call deck%error(data%place(k), 'springs act along 1 or 2')
                  valid = .false.
               end if
            end do
         end associate
      end if
      if (size(deck%card%data) /= merge(2, 1, has_dofs) .and. valid) then
         call deck%error(deck%card%place, '*SPRING has one constant, behind a card of degrees '// &
            'of freedom for SPRING1 and SPRING2')
         return
      end if
      call read_row(deck%card%data(size(deck%card%data)), 'spring constant >0', deck, stiffness, &
         sound)
      if (.not. (valid .and. sound)) return
      do i = 1, size(members)
         associate (bar => of_line(members(i)), nodes => deck%line_nodes(:2, members(i)))
            if (any(nodes(:merge(1, 2, deck%line_kind(members(i)) == ground_spring)) == 0)) cycle
            bar%stiffness = stiffness(1)
            bar%follows_axes = has_dofs
            select case (deck%line_kind(members(i)))
            case (axial_spring)
               call set_axial(nodes, deck, bar)
            case (ground_spring)
               call fill_equation(nodes(:1), dof(:1), [1.0_dp], bar%elongation)
            case default
               call fill_equation(nodes, dof, [1.0_dp, -1.0_dp], bar%elongation)
            end select
         end associate
      end do
   end subroutine read_spring

   !> Gives the trusses of a *SOLID SECTION their stiffness; its thickness is their area.
   subroutine take_section(n, deck, of_line)
      integer, intent(in) :: n                         ! index of the section
      type(deck_type), intent(inout) :: deck
      type(bar_type), intent(inout) :: of_line(:)
      integer, allocatable :: members(:)
      integer :: i, set
      logical :: is_plain

      if (deck%has_errors()) return
      call deck%need_named('ELSET', 'element set', set)
      members = deck%line_sets(set)%members
      members = pack(members, deck%line_kind(members) == truss)
      if (size(members) == 0) return
      associate (material => deck%model%materials(deck%model%sections(n)%material), area => &
         deck%model%sections(n)%thickness)
         is_plain = material%has(of_elasticity) .and. .not. follows_temperature(material)
         if (allocated(material%given)) is_plain = is_plain .and. all([( &
            material%given(i)%symmetry == isotropic .and. (material%given(i)%kind /= &
            of_expansion .or. size(material%given(i)%values, 1) == 1), i=1, size(material%given))])
         if (.not. is_plain) then
            call deck%error(deck%card%place_of('MATERIAL'), 'trusses need *ELASTIC, isotropic, '// &
               'and properties that are constant')
            return
         end if
         do i = 1, size(members)
            associate (bar => of_line(members(i)), nodes => deck%line_nodes(:2, members(i)))
               call set_axial(nodes, deck, bar)
               if (deck%has_errors()) return
               bar%stiffness = youngs_modulus(material%elasticity)*area/norm2( &
                  deck%mesh%coordinates(:, nodes(2)) - deck%mesh%coordinates(:, nodes(1)))
               if (.not. material%has(of_expansion)) cycle
               bar%warm_force = youngs_modulus(material%elasticity)*area*material%expansion(1)
               call fill_equation(nodes, [dof_temperature, dof_temperature], [0.5_dp, 0.5_dp], &
                  bar%mean)
            end associate
         end do
      end associate
   end subroutine take_section

   !> Makes the distance of two nodes an elongation.
   subroutine set_axial(nodes, deck, bar)
      integer, intent(in) :: nodes(2)
      type(deck_type), intent(inout) :: deck
      type(bar_type), intent(inout) :: bar
      real(dp) :: along(2)

      if (nodes(1) == nodes(2)) return   ! as its element says
      along = deck%mesh%coordinates(:, nodes(2)) - deck%mesh%coordinates(:, nodes(1))
      if (all(abs(along) <= 0.0_dp)) then
         call deck%error(deck%card%place, 'nodes '//to_text(deck%mesh%node_number(nodes(1)))// &
            ' and '//to_text(deck%mesh%node_number(nodes(2)))//' of an element of this set '// &
            'stand at one place: it has no direction; take SPRING2')
         return
      end if
      along = along/norm2(along)
      call fill_equation([nodes(1), nodes(1), nodes(2), nodes(2)], [1, 2, 1, 2], &
         [-along, along], bar%elongation)
   end subroutine set_axial

   pure real(dp) function youngs_modulus(elasticity) result(modulus)
      real(dp), intent(in) :: elasticity(4, 4)         !! [stress]

      associate (lambda => elasticity(1, 2), mu => elasticity(4, 4))
         modulus = mu*(3*lambda + 2*mu)/(lambda + mu)
      end associate
   end function youngs_modulus

end module deck_builder_bars
