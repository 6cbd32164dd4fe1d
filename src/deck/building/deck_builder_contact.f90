!> *CONTACT PAIR and *CLEARANCE -> contact between surfaces.
module deck_builder_contact
   use card_parameters, only: choose, has_parameter, need_parameter, parameter_place, &
      parameter_text, take_parameter
   use card_values, only: check_extra, need_field
   use cards, only: cards_type, data_card_type, field_place, keyword_card_type
   use contact_definitions, only: contact_definition_type, pairing_nodes, pairing_surfaces
   use deck_builder_interactions, only: find_interaction
   use deck_context, only: deck_context_type, find_set, report_unknown, set_names
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use deck_structure, only: card_count
   use kinds, only: dp
   use mesh, only: mesh_type
   use model, only: model_type
   use text, only: read_real, string_type, to_upper
   implicit none
   private
   public :: build_contacts, named_surface, read_surface

contains

   !> Takes all interfaces and their clearances.
   subroutine build_contacts(cards, context, model, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context    !! receives notes
      type(model_type), intent(inout) :: model             !! receives the interfaces
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer :: k, n

      allocate(model%contacts(card_count(cards, 'CONTACT PAIR')))
      n = 0
      do k = 1, size(cards%keywords)
         if (cards%keywords(k)%name /= 'CONTACT PAIR') cycle
         n = n + 1
         call build_contact(cards, cards%keywords(k), context, model, report, model%contacts(n))
         call check_name(cards%keywords(k), model%contacts(:n), report)
      end do
      do k = 1, size(cards%keywords)
         if (cards%keywords(k)%name == 'CLEARANCE') then
            call build_clearance(cards%keywords(k), model%mesh, report, model%contacts)
         end if
      end do
   end subroutine build_contacts

   !> Takes one clearance, for the interface of the two surfaces that it names.
   subroutine build_clearance(card, mesh, report, contacts)
      type(keyword_card_type), intent(in) :: card
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report
      type(contact_definition_type), intent(inout) :: contacts(:)
      character(:), allocatable :: text
      real(dp) :: value
      integer :: i, master, slave

      call named_surface(card, 'MASTER', mesh, report, master)
      call named_surface(card, 'SLAVE', mesh, report, slave)
      call need_parameter(card, 'VALUE', report, text)
      value = 0.0_dp
      call take_parameter(card, 'VALUE', report, value)
      if (master == 0 .or. slave == 0) return
      do i = 1, size(contacts)
         if (contacts(i)%slave == slave .and. contacts(i)%master == master) exit
      end do
      if (i > size(contacts)) then
         call report%missing(card%place, 'no *CONTACT PAIR has the slave surface '// &
            mesh%surfaces(slave)%name//' and the master surface '//mesh%surfaces(master)%name, &
            'surface')
      else if (contacts(i)%has_clearance) then
         call report%error(card%place, 'the clearance of contact pair '//contacts(i)%name// &
            ' is given twice')
      else
         contacts(i)%has_clearance = .true.
         contacts(i)%clearance = value
      end if
   end subroutine build_clearance

   !> Index of the surface that a parameter names; 0 after an error.
   subroutine named_surface(card, parameter, mesh, report, surface)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: parameter                !! the parameter
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer, intent(out) :: surface
      character(:), allocatable :: name

      surface = 0
      call need_parameter(card, parameter, report, name)
      if (len(name) > 0) surface = find_surface(mesh, name, parameter_place(card, parameter), &
         report)
   end subroutine named_surface

   subroutine build_contact(cards, card, context, model, report, contact)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(inout) :: context
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      type(contact_definition_type), intent(out) :: contact
      character(:), allocatable :: name, pairing
      type(string_type), allocatable :: names(:)
      integer :: i

      contact%card = card%place%image
      call need_parameter(card, 'INTERACTION', report, name)
      contact%interaction = find_interaction(model%interactions, name)
      if (contact%interaction == 0 .and. len(name) > 0) then
         allocate(names(size(model%interactions)))
         do i = 1, size(names)
            names(i)%value = model%interactions(i)%name
         end do
         call report_unknown('surface interaction', name, names, &
            parameter_place(card, 'INTERACTION'), report)
      end if
      call choose(card, 'PAIRING', 'NODES/SURFACES', report, pairing)
      if (allocated(pairing)) contact%pairing = merge(pairing_nodes, pairing_surfaces, &
         pairing == 'NODES')
      if (has_parameter(card, 'ADJUST')) call read_adjustment(card, model%mesh, report, contact)
      contact%name = parameter_text(card, 'NAME')
      if (card%last_data < card%first_data) return
      associate (data => cards%data(card%first_data))
         call read_surface(data, 1, 'slave surface', model%mesh, report, contact%slave)
         call read_surface(data, 2, 'master surface', model%mesh, report, contact%master)
         call check_extra(data, 2, 'slave surface, master surface', report)
         if (contact%slave > 0 .and. contact%slave == contact%master) then
            call report%error(field_place(data, 2), 'a surface cannot be in contact with itself')
         end if
         if (has_parameter(card, 'NAME')) return
         if (size(data%fields) > 0) contact%name = data%fields(1)%text
         call context%note('*CONTACT PAIR without NAME=: '//contact%name//', the slave surface')
      end associate
   end subroutine build_contact

   !> A distance, or a node set.
   subroutine read_adjustment(card, mesh, report, contact)
      type(keyword_card_type), intent(in) :: card
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report
      type(contact_definition_type), intent(inout) :: contact
      logical :: is_number

      contact%adjusts = .true.
      call read_real(parameter_text(card, 'ADJUST'), contact%adjusted, is_number)
      if (is_number) then
         if (contact%adjusted < 0.0_dp) call report%error(parameter_place(card, 'ADJUST'), &
            'the distance of ADJUST= must not be negative')
         return
      end if
      contact%adjusted_set = find_set(mesh%node_sets, parameter_text(card, 'ADJUST'))
      if (contact%adjusted_set == 0) call report_unknown('node set', &
         to_upper(parameter_text(card, 'ADJUST')), set_names(mesh%node_sets), &
         parameter_place(card, 'ADJUST'), report)
   end subroutine read_adjustment

   !> Takes a surface by its name in a field of a data card.
   subroutine read_surface(data, position, what, mesh, report, surface)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: position                      !! the field
      character(*), intent(in) :: what                     !! what the field holds
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer, intent(inout) :: surface                    !! its index, as it was after an error
      character(:), allocatable :: name
      logical :: valid

      valid = .true.
      call need_field(data, position, what, report, name, valid)
      if (valid) surface = find_surface(mesh, to_upper(name), field_place(data, position), report)
   end subroutine read_surface

   !> Index of a surface by its name in upper case; 0 with an error for an unknown one.
   integer function find_surface(mesh, name, place, report)
      type(mesh_type), intent(in) :: mesh
      character(*), intent(in) :: name
      type(place_type), intent(in) :: place
      type(deck_report_type), intent(inout) :: report
      type(string_type), allocatable :: names(:)
      integer :: i

      find_surface = 0
      allocate(names(size(mesh%surfaces)))
      do i = 1, size(names)
         names(i)%value = mesh%surfaces(i)%name
         if (names(i)%value == name) find_surface = i
      end do
      if (find_surface == 0) call report_unknown('surface', name, names, place, report)
   end function find_surface

   !> A name stands for a group of the result file: it is used once, and is one that HDF5
   !> takes for a group.
   subroutine check_name(card, contacts, report)
      type(keyword_card_type), intent(in) :: card
      type(contact_definition_type), intent(in) :: contacts(:)
      type(deck_report_type), intent(inout) :: report
      integer :: i, n

      n = size(contacts)
      do i = 1, n - 1
         if (to_upper(contacts(i)%name) == to_upper(contacts(n)%name)) then
            call report%error(parameter_place(card, 'NAME'), 'contact pair '//contacts(n)%name// &
               ' is defined twice')
         end if
      end do
      if (scan(contacts(n)%name, '/@') > 0) call report%error(parameter_place(card, 'NAME'), &
         'the name of a contact pair must not contain / or @')
      if (contacts(n)%name == '.' .or. contacts(n)%name == '..') call report%error( &
         parameter_place(card, 'NAME'), 'a contact pair must not be named . or ..: its name is '// &
         'a group of the result file')
   end subroutine check_name

end module deck_builder_contact
