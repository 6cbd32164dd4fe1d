!> Bodies that nothing holds and bodies whose temperature nothing determines, in words.
module loose_bodies
   use bodies, only: bodies_on_axis
   use body_names, only: body_name, reached_bodies
   use conductance_laws, only: law_none
   use contact_states, only: status_open, status_slip, status_stick
   use kinds, only: dp
   use model, only: model_type
   use pair_rows, only: pair_row_type
   use rigid_motions, only: contact_tie_type, find_free_motions, free_motion_type
   use steps, only: load_film_coefficient
   use text, only: append, string_type, to_text
   implicit none
   private
   public :: bodies_held_by_nothing, bodies_held_by_no_pair
   public :: bodies_without_temperature, bodies_heated_by_no_pair

contains

   !> Bodies that neither supports nor contact could ever hold: all pairs count as closed, those
   !> with friction as stuck.
   subroutine bodies_held_by_nothing(model, pairs, held, messages)
      type(model_type), intent(in) :: model         !! the model
      type(pair_row_type), intent(in) :: pairs      !! all pairs
      logical, intent(in) :: held(:)                !! (2 nodes) prescribed displacements
      type(string_type), allocatable, intent(out) :: messages(:) !! one a motion; none where held
      type(free_motion_type), allocatable :: motions(:)
      integer :: i

      call free_motions(model, pairs, held, &
         merge(status_stick, status_slip, pairs%friction > 0.0_dp), motions)
      allocate (messages(0))
      do i = 1, size(motions)
         call append(messages, body_name(model, motions(i)%body)//' can '// &
            trim(merge('turn', 'move', motions(i)%turns))//' '//motions(i)%way// &
            motions(i)%company//': no *BOUNDARY and no contact holds it')
      end do
   end subroutine bodies_held_by_nothing

   !> Bodies that the supports and the pairs in contact leave free, to be added to a message; empty
   !> where all are held.
   function bodies_held_by_no_pair(model, pairs, held, status) result(words)
      type(model_type), intent(in) :: model         !! the model
      type(pair_row_type), intent(in) :: pairs      !! all pairs
      logical, intent(in) :: held(:)                !! (2 nodes) prescribed displacements
      integer, intent(in) :: status(:) !! (m) status_open, status_slip or status_stick
      character(:), allocatable :: words            !! such as '; body 2 (...) slides along x'
      type(free_motion_type), allocatable :: motions(:), welded(:)
      integer, allocatable :: stuck(:)

      call free_motions(model, pairs, held, status, motions)
      stuck = merge(status_stick, status, status == status_slip .and. pairs%friction > 0.0_dp)
      call free_motions(model, pairs, held, stuck, welded)
      words = in_words(model, motions, trim(merge('moves ', 'slides', size(welded) > 0)))
   end function bodies_held_by_no_pair

   !> Motions, each body named once.
   function in_words(model, motions, moves) result(words)
      type(model_type), intent(in) :: model
      type(free_motion_type), intent(in) :: motions(:)
      character(*), intent(in) :: moves
      character(:), allocatable :: words
      integer :: i, last

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
            words = words//moves
         end if
         words = words//' '//motions(i)%way//motions(i)%company
      end do
   end function in_words

   !> The free motions with the pairs in these states.
   subroutine free_motions(model, pairs, held, status, motions)
      type(model_type), intent(in) :: model
      type(pair_row_type), intent(in) :: pairs
      logical, intent(in) :: held(:)
      integer, intent(in) :: status(:)
      type(free_motion_type), allocatable, intent(out) :: motions(:)
      type(contact_tie_type) :: ties(2*size(status))
      integer :: k, n

      n = 0
      do k = 1, size(status)
         if (status(k) == status_open) cycle
         n = n + 1
         ties(n) = contact_tie_type(pairs%slave(k), pairs%master(k), pairs%normal(:, k))
         if (status(k) /= status_stick) cycle
         n = n + 1
         ties(n) = contact_tie_type(pairs%slave(k), pairs%master(k), pairs%tangent(:, k))
      end do
      call find_free_motions(model%mesh%coordinates, model%mesh%node_body, &
         bodies_on_axis(model%mesh), held, ties(:n), motions)
   end subroutine free_motions

   !> Bodies whose temperature nothing can ever determine: pairs count as conducting where one side
   !> of their law is given.
   subroutine bodies_without_temperature(model, pairs, held, step, messages)
      type(model_type), intent(in) :: model         !! the model
      type(pair_row_type), intent(in) :: pairs      !! all pairs
      logical, intent(in) :: held(:)                !! (nodes) prescribed temperatures
      integer, intent(in) :: step                   !! the step, for its films
      type(string_type), allocatable, intent(out) :: messages(:) !! one a body
      logical :: undetermined(model%mesh%body_count)
      integer :: body

      undetermined = undetermined_bodies(model, pairs, held, step, pairs%law%open_kind /= law_none &
         .or. pairs%law%closed_kind /= law_none)
      allocate (messages(0))
      do body = 1, size(undetermined)
         if (undetermined(body)) call append(messages, 'the temperature of '// &
            body_name(model, body)//' is undetermined: no *BOUNDARY on dof 11, no *FILM and no '// &
            'contact that conducts heat fixes it')
      end do
   end subroutine bodies_without_temperature

   !> Bodies whose temperature the conductances of an instant leave undetermined, as a message;
   !> empty where there are none.
   function bodies_heated_by_no_pair(model, pairs, held, step, conducts) result(words)
      type(model_type), intent(in) :: model         !! the model
      type(pair_row_type), intent(in) :: pairs      !! all pairs
      logical, intent(in) :: held(:)                !! (nodes) prescribed temperatures
      integer, intent(in) :: step                   !! the step, for its films
      logical, intent(in) :: conducts(:)            !! (m) pairs that carry heat
      character(:), allocatable :: words            !! the message
      logical :: undetermined(model%mesh%body_count)
      integer :: body

      undetermined = undetermined_bodies(model, pairs, held, step, conducts)
      words = ''
      do body = 1, size(undetermined)
         if (.not. undetermined(body)) cycle
         if (len(words) > 0) words = words//'; '
         words = words//'the temperature of '//body_name(model, body)// &
            ' is undetermined: all its pairs have conductance 0'
      end do
   end function bodies_heated_by_no_pair

   !> Bodies that neither a prescribed temperature nor a film supplies with heat, nor a way over
   !> conducting pairs to a body that one does.
   pure function undetermined_bodies(model, pairs, held, step, conducts) result(undetermined)
      type(model_type), intent(in) :: model             !! the model
      type(pair_row_type), intent(in) :: pairs          !! all pairs
      logical, intent(in) :: held(:)                    !! (nodes) prescribed temperatures
      integer, intent(in) :: step                       !! the step, for its films
      logical, intent(in) :: conducts(:)                !! (m) pairs that carry heat
      logical :: undetermined(model%mesh%body_count)    !! (bodies)
      logical :: determined(model%mesh%body_count)
      integer :: k

      determined = bodies_with_film(model, step)
      do k = 1, size(held)
         if (held(k) .and. model%mesh%node_body(k) > 0) then
            determined(model%mesh%node_body(k)) = .true.
         end if
      end do
      undetermined = .not. reached_bodies(model%mesh%node_body, determined, pairs%slave, &
         pairs%master, conducts)
   end function undetermined_bodies

   !> Bodies with a film in a step: its own ones and those of the steps before that it keeps.
   pure function bodies_with_film(model, step) result(film)
      type(model_type), intent(in) :: model
      integer, intent(in) :: step
      logical :: film(model%mesh%body_count)
      integer :: i, s

      film = .false.
      do s = 1, step
         associate (given => model%steps(s))
            if (given%ends_loads(load_film_coefficient)) film = .false.
            if (.not. allocated(given%loads)) cycle
            do i = 1, size(given%loads)
               if (given%loads(i)%kind /= load_film_coefficient) cycle
               film(model%mesh%element_body(given%loads(i)%item)) = .true.
            end do
         end associate
      end do
   end function bodies_with_film

end module loose_bodies
