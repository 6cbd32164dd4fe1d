!> What SLIDING=FINITE does not go with, and decks that may mean it.
module sliding_checks
   use contact_definitions, only: contact_definition_type
   use deck_context, only: deck_type
   use deck_source, only: place_type
   use deck_structure, only: cards_of
   use heat_equation, only: heat_equation_type
   use mesh, only: mesh_type
   use model, only: model_type
   use text, only: to_text
   implicit none
   private
   public :: check_sliding

contains

   !> Errors at *CONTACT PAIR with SLIDING=FINITE beside what its contact points cannot follow; a
   !> note where Abaqus would follow sliding.
   subroutine check_sliding(deck)
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: beside
      integer, allocatable :: cards(:)
      integer :: i

      do i = 1, size(deck%model%contacts)
         associate (contact => deck%model%contacts(i))
            if (.not. contact%follows_sliding) cycle
            beside = what_is_beside(deck%model, i)
            if (len(beside) > 0) call deck%error(place_type(image=contact%card), &
               contact%title()//': SLIDING=FINITE does not go with '//beside)
         end associate
      end do
      cards = cards_of(deck%cards, 'CONTACT PAIR')
      do i = 1, size(cards)
         associate (card => deck%cards%keywords(cards(i)))
            if (card%has('SLIDING') .and. card%has('SMALL SLIDING')) then
               if (card%text('SLIDING') /= 'SMALL') call deck%error(card%place_of('SLIDING'), &
                  'SLIDING= and SMALL SLIDING contradict each other; leave one of them out')
            else if (any(deck%model%steps%nlgeom) .and. .not. (card%has('SLIDING') .or. &
               card%has('SMALL SLIDING'))) then
               call deck%note('*CONTACT PAIR without SMALL SLIDING in a deck with NLGEOM: '// &
                  'Abaqus follows sliding there; here contact points stay those of the '// &
                  'undeformed mesh without SLIDING=FINITE')
               return
            end if
         end associate
      end do
   end subroutine check_sliding

   !> What there is, and what to do; empty for nothing.
   pure function what_is_beside(model, i) result(words)
      type(model_type), intent(in) :: model
      integer, intent(in) :: i                   ! index into its contacts
      character(:), allocatable :: words
      type(heat_equation_type) :: equation
      integer :: k, s

      words = ''
      associate (contact => model%contacts(i))
         if (contact%has_clearance) words = '*CLEARANCE: gaps are those of the displaced '// &
            'faces; move the nodes instead'
         if (contact%adjusts) words = 'ADJUST=: gaps are those of the displaced faces; move '// &
            'the nodes instead'
         do k = 1, size(model%ties)
            if (share_a_face(model%mesh, contact, model%ties(k)%faces)) words = &
               'tie '//model%ties(k)%faces%name//' of the same face: what is tied cannot slide'
         end do
      end associate
      do s = 1, size(model%steps)
         associate (step => model%steps(s), of_step => ' of step '//to_text(s))
            if (allocated(step%changes%interferences)) then
               if (any(step%changes%interferences%contact == i)) words = '*CONTACT INTERFERENCE'// &
                  of_step//'; draw the faces with their overlap'
            end if
            if (step%stability_frequency > 0) words = '*STABILITY'//of_step// &
               ', which keeps contact points where they are; give the speed of a brake, out of '// &
               'the plane, to *GAP HEAT GENERATION instead'
            if (step%continuation%is_on) words = '*CONTINUATION'//of_step// &
               ', whose branches keep contact points where they are'
            if (step%dilates) words = 'DILATATION=YES'//of_step// &
               ', whose operators keep contact points where they are'
            equation%scheme = step%scheme
            if (equation%takes_past_conductance()) words = 'the *THERMAL SCHEME'//of_step// &
               ', which asks for heat across contact points of the past; take TYPE=IMPLICIT'
         end associate
      end do
   end function what_is_beside

   !> The faces of both surfaces.
   pure function faces_of(mesh, definition) result(faces)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition
      integer, allocatable :: faces(:, :)        ! (2, faces) element, side

      associate (of_slave => mesh%surfaces(definition%slave)%faces, &
         of_master => mesh%surfaces(definition%master)%faces)
         faces = reshape([of_slave, of_master], [2, size(of_slave, 2) + size(of_master, 2)])
      end associate
   end function faces_of

   !> Whether a side of an element belongs to the faces of two definitions.
   pure logical function share_a_face(mesh, one, other)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: one, other
      integer :: k

      associate (mine => faces_of(mesh, one), others => faces_of(mesh, other))
         share_a_face = any([(any(mine(1, k) == others(1, :) .and. mine(2, k) == others(2, :)), &
            k=1, size(mine, 2))])
      end associate
   end function share_a_face

end module sliding_checks
