!> Bodies that supports and contact points do not constrain, and bodies whose temperature nothing
!> determines, in words: for a whole step, whatever its contact does, and at an instant of it.
module unconstrained_bodies
   use conductance_laws, only: law_none
   use contact_states, only: contact_open, contact_slip, contact_stick
   use kinds, only: dp
   use model, only: model_type
   use all_contact_points, only: all_contact_points_type
   use rigid_motions, only: find_free_motions, free_motion_type, joint_type
   use steps, only: load_film_coefficient
   use text, only: append, string_type, to_text
   use tie_constraints, only: joints_of
   implicit none
   private
   public :: unconstrained_in_step, unconstrained_now
   public :: undetermined_in_step, undetermined_now, undetermined_beside

contains

   !> Bodies that neither supports nor contact could ever constrain: all contact points count as
   !> closed, those with friction as stuck. One message a motion.
   subroutine unconstrained_in_step(model, points, held, messages)
      type(model_type), intent(in) :: model
      type(all_contact_points_type), intent(in) :: points !! all contact points
      logical, intent(in) :: held(:)                !! (2 nodes) prescribed displacements
      type(string_type), allocatable, intent(out) :: messages(:)
      type(free_motion_type), allocatable :: motions(:)
      integer :: i

      call free_motions(model, points, held, &
         merge(contact_stick, contact_slip, points%friction > 0.0_dp), motions)
      allocate (messages(0))
      do i = 1, size(motions)
         call append(messages, body_name(model, motions(i)%body)//' can '// &
            trim(merge('turn', 'move', motions(i)%turns))//' '//motions(i)%way// &
            motions(i)%company//': no *BOUNDARY and no contact holds it')
      end do
   end subroutine unconstrained_in_step

   !> Bodies that the supports and the contact points in these states leave free, to be added to a
   !> message, such as '; body 2 (...) slides along x'; empty where all are constrained.
   function unconstrained_now(model, points, held, contact_state) result(words)
      type(model_type), intent(in) :: model
      type(all_contact_points_type), intent(in) :: points !! all contact points
      logical, intent(in) :: held(:)                !! (2 nodes) prescribed displacements
      integer, intent(in) :: contact_state(:)     !! (m) contact_open, contact_slip or contact_stick
      character(:), allocatable :: words
      type(free_motion_type), allocatable :: motions(:), welded(:)
      integer, allocatable :: stuck(:)
      integer :: i, last

      call free_motions(model, points, held, contact_state, motions)
      stuck = merge(contact_stick, contact_state, contact_state == contact_slip .and. &
         points%friction > 0.0_dp)
      call free_motions(model, points, held, stuck, welded)
      words = ''
      last = 0
      do i = 1, size(motions)
         if (motions(i)%body == last) then
            words = words//', '
         else
            words = words//'; '//body_name(model, motions(i)%body)//' '
         end if
         last = motions(i)%body
         if (motions(i)%turns) then
            words = words//'turns'
         else
            words = words//trim(merge('moves ', 'slides', size(welded) > 0))
         end if
         words = words//' '//motions(i)%way//motions(i)%company
      end do
   end function unconstrained_now

   !> The free motions with the contact points in these states.
   subroutine free_motions(model, points, held, contact_state, motions)
      type(model_type), intent(in) :: model
      type(all_contact_points_type), intent(in) :: points
      logical, intent(in) :: held(:)
      integer, intent(in) :: contact_state(:)
      type(free_motion_type), allocatable, intent(out) :: motions(:)
      type(joint_type) :: joints(2*size(contact_state))
      integer :: k, n

      n = 0
      do k = 1, size(contact_state)
         if (contact_state(k) == contact_open) cycle
         n = n + 1
         joints(n) = joint_of(points, k, points%normal(:, k))
         if (contact_state(k) /= contact_stick) cycle
         n = n + 1
         joints(n) = joint_of(points, k, points%tangent(:, k))
      end do
      call find_free_motions(model%mesh, held, [joints(:n), joints_of(points%ties)], motions)
   end subroutine free_motions

   !> What a contact point holds along a direction.
   pure function joint_of(points, k, direction) result(joint)
      type(all_contact_points_type), intent(in) :: points
      integer, intent(in) :: k
      real(dp), intent(in) :: direction(2)
      type(joint_type) :: joint

      if (points%turns()) then
         joint%nodes = [points%along%values_of(k), points%across%values_of(k)]
         joint%share = reshape([parts(points%along%coefficients_of(k), direction), &
            parts(points%across%coefficients_of(k), [-direction(2), direction(1)])], &
            [2, size(joint%nodes)])
      else
         joint%nodes = points%nodes_of(k)
         joint%share = reshape(parts(points%difference%coefficients_of(k), direction), &
            [2, size(joint%nodes)])
      end if

   contains
      !> Multiples of a vector, one after another.
      pure function parts(factor, vector)
         real(dp), intent(in) :: factor(:), vector(2)
         real(dp) :: parts(2*size(factor))
         integer :: i

         parts = [(factor(i)*vector, i=1, size(factor))]
      end function parts
   end function joint_of

   !> Bodies whose temperature nothing can ever determine: contact points count as conducting where
   !> one side of their law is given. One message a body.
   subroutine undetermined_in_step(model, points, held, step, messages)
      type(model_type), intent(in) :: model
      type(all_contact_points_type), intent(in) :: points !! all contact points
      logical, intent(in) :: held(:)                !! (nodes) prescribed temperatures
      integer, intent(in) :: step                   !! the step, for its films
      type(string_type), allocatable, intent(out) :: messages(:)
      integer :: i

      call find_undetermined(model, points, with_source(model, held, step), &
         points%law%open_kind /= law_none .or. points%law%closed_kind /= law_none, messages)
      do i = 1, size(messages)
         messages(i)%value = messages(i)%value//': no *BOUNDARY on dof 11, no *FILM and no '// &
            'contact that conducts heat fixes it'
      end do
   end subroutine undetermined_in_step

   !> Bodies whose temperature the conductances of an instant leave undetermined, in one message;
   !> empty where there are none.
   function undetermined_now(model, points, held, step, conducts) result(words)
      type(model_type), intent(in) :: model
      type(all_contact_points_type), intent(in) :: points !! all contact points
      logical, intent(in) :: held(:)                !! (nodes) prescribed temperatures
      integer, intent(in) :: step                   !! the step, for its films
      logical, intent(in) :: conducts(:)            !! (m) contact points that carry heat
      character(:), allocatable :: words
      type(string_type), allocatable :: messages(:)

      call find_undetermined(model, points, with_source(model, held, step), conducts, messages)
      words = joined(messages, ': all its contact points have conductance 0')
   end function undetermined_now

   !> Bodies whose temperature nothing determines beside some nodes, even if all contact points
   !> carried heat, in one message; empty where there are none.
   function undetermined_beside(model, points, determined) result(words)
      type(model_type), intent(in) :: model
      type(all_contact_points_type), intent(in) :: points !! all contact points
      logical, intent(in) :: determined(:)          !! (nodes) nodes whose temperature is fixed
      character(:), allocatable :: words
      type(string_type), allocatable :: messages(:)
      logical :: has_source(model%mesh%body_count)

      has_source = .false.
      has_source(pack(model%mesh%node_body, determined .and. model%mesh%node_body > 0)) = .true.
      call find_undetermined(model, points, has_source, spread(.true., 1, size(points%slave)), &
         messages)
      words = joined(messages, '')
   end function undetermined_beside

   !> Messages in one, each with an ending.
   pure function joined(messages, ending) result(words)
      type(string_type), intent(in) :: messages(:)
      character(*), intent(in) :: ending
      character(:), allocatable :: words
      integer :: i

      words = ''
      do i = 1, size(messages)
         if (i > 1) words = words//'; '
         words = words//messages(i)%value//ending
      end do
   end function joined

   !> Bodies without a source of heat from which no way over conducting contact points and ties
   !> leads to one that has.
   subroutine find_undetermined(model, points, has_source, conducts, messages)
      type(model_type), intent(in) :: model
      type(all_contact_points_type), intent(in) :: points
      logical, intent(in) :: has_source(:)
      logical, intent(in) :: conducts(:)
      type(string_type), allocatable, intent(out) :: messages(:)
      logical :: reached(size(has_source))
      logical :: spreads
      integer, allocatable :: slave(:), master(:)
      integer :: body, k

      reached = has_source
      slave = pack(points%slave, conducts)
      master = pack(points%master, conducts)
      if (allocated(points%ties%slave)) then
         slave = [slave, points%ties%slave]
         master = [master, points%ties%master]
      end if
      spreads = .true.
      do while (spreads)
         spreads = .false.
         do k = 1, size(slave)
            associate (bodies => model%mesh%node_body([slave(k), master(k)]))
               if (reached(bodies(1)) .eqv. reached(bodies(2))) cycle
               reached(bodies) = .true.
               spreads = .true.
            end associate
         end do
      end do
      allocate (messages(0))
      do body = 1, size(reached)
         if (.not. reached(body)) call append(messages, 'the temperature of '// &
            body_name(model, body)//' is undetermined')
      end do
   end subroutine find_undetermined

   !> Bodies with a prescribed temperature, or with a film in a step: its own ones and those of the
   !> steps before that it keeps.
   pure function with_source(model, held, step) result(source)
      type(model_type), intent(in) :: model
      logical, intent(in) :: held(:)
      integer, intent(in) :: step
      logical :: source(model%mesh%body_count)
      integer :: i, s

      source = .false.
      do s = 1, step
         associate (given => model%steps(s))
            if (given%ends_loads(load_film_coefficient)) source = .false.
            if (.not. allocated(given%loads)) cycle
            do i = 1, size(given%loads)
               if (given%loads(i)%kind /= load_film_coefficient) cycle
               source(model%mesh%element_body(given%loads(i)%item)) = .true.
            end do
         end associate
      end do
      source(pack(model%mesh%node_body, held .and. model%mesh%node_body > 0)) = .true.
   end function with_source

   !> How a body is named to the user, such as 'body 2 (of STEEL, first node 38)'.
   function body_name(model, body) result(name)
      type(model_type), intent(in) :: model
      integer, intent(in) :: body
      character(:), allocatable :: name
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

end module unconstrained_bodies
