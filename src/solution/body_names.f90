!> Bodies in words, and which of them contact joins.
module body_names
   use model, only: model_type
   use text, only: to_text
   implicit none
   private
   public :: body_name, cold_bodies, reached_bodies

contains

   !> Bodies from which a way over pairs leads to one of the bodies given.
   pure function reached_bodies(node_body, given, slave, master, joins) result(reached)
      integer, intent(in) :: node_body(:)       !! (nodes) body, or 0
      logical, intent(in) :: given(:)           !! (bodies) where the ways end
      integer, intent(in) :: slave(:)           !! (m) slave nodes
      integer, intent(in) :: master(:)          !! (m) master nodes
      logical, intent(in) :: joins(:)           !! (m) pairs that are ways
      logical :: reached(size(given))           !! (bodies) the given ones, too
      logical :: spreads
      integer :: k

      reached = given
      spreads = .true.
      do while (spreads)
         spreads = .false.
         do k = 1, size(joins)
            if (.not. joins(k)) cycle
            associate (bodies => node_body([slave(k), master(k)]))
               if (reached(bodies(1)) .eqv. reached(bodies(2))) cycle
               reached(bodies) = .true.
               spreads = .true.
            end associate
         end do
      end do
   end function reached_bodies

   !> Bodies to which no way over pairs leads from a node whose temperature something fixes, in
   !> words; empty where there are none.
   function cold_bodies(model, warm, slave, master) result(words)
      type(model_type), intent(in) :: model     !! the model
      logical, intent(in) :: warm(:)            !! (nodes) nodes that something fixes
      integer, intent(in) :: slave(:)           !! (m) slave nodes
      integer, intent(in) :: master(:)          !! (m) master nodes
      character(:), allocatable :: words        !! such as the temperature of ... is undetermined
      logical :: given(0:model%mesh%body_count)
      integer :: body

      given = .false.
      given(pack(model%mesh%node_body, warm)) = .true.
      given(1:) = reached_bodies(model%mesh%node_body, given(1:), slave, master, &
         spread(.true., 1, size(slave)))
      words = ''
      do body = 1, model%mesh%body_count
         if (given(body)) cycle
         if (len(words) > 0) words = words//'; '
         words = words//'the temperature of '//body_name(model, body)//' is undetermined'
      end do
   end function cold_bodies

   !> How a body is named to the user: its number, its material, its first node in the deck.
   function body_name(model, body) result(name)
      type(model_type), intent(in) :: model     !! the model
      integer, intent(in) :: body               !! index of the body
      character(:), allocatable :: name         !! such as body 2 (of STEEL, first node 38)
      character(:), allocatable :: materials
      integer :: m

      associate (mesh => model%mesh)
         materials = ''
         do m = 1, size(model%materials)
            if (.not. any(mesh%element_body == body .and. &
               model%sections(mesh%element_section)%material == m)) cycle
            if (.not. allocated(model%materials(m)%name)) cycle
            materials = materials//' and '//model%materials(m)%name
         end do
         name = 'body '//to_text(body)//' ('
         if (len(materials) > 0) name = name//'of '//materials(6:)//', '
         name = name//'first node '//to_text(minval(mesh%node_number, mask= &
            mesh%node_body == body))//')'
      end associate
   end function body_name

end module body_names
