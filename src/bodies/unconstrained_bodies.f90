!> Bodies that supports and contact points do not constrain, and bodies whose temperature nothing
!> determines, in words: for a whole step, whatever its contact does, and at an instant of it.
module unconstrained_bodies
   use mesh_bodies, only: body_name
   use conductance_laws, only: law_none
   use connections, only: connections_type, contact_laws_type
   use contact_system, only: contact_open, contact_slip, contact_stick
   use kinds, only: dp
   use model, only: model_type
   use rigid_motions, only: find_free_motions, free_motion_type, joint_type, joints_of
   use sparse_null_space, only: null_space_of
   use steps, only: load_film_coefficient
   use sum_lists, only: sum_list_type
   use text, only: append, string_type, to_text
   implicit none
   private
   public :: unconstrained_in_step, unconstrained_now
   public :: undetermined_in_step, undetermined_now, undetermined_beside

   real(dp), parameter :: negligible = 1.0e-6_dp    !! part of a body in a free temperature

contains

   !> Bodies that neither supports nor contact could ever constrain: all contact points that are not
   !> removed count as closed, those with friction as stuck. One message a body.
   subroutine unconstrained_in_step(model, points, laws, prescribed, messages)
      type(model_type), intent(in) :: model
      type(connections_type), intent(in) :: points !! all contact points
      type(contact_laws_type), intent(in) :: laws   !! theirs in the step
      logical, intent(in) :: prescribed(:)                !! (2 nodes) prescribed displacements
      type(string_type), allocatable, intent(out) :: messages(:)
      type(free_motion_type), allocatable :: motions(:)
      character(:), allocatable :: words
      integer :: i, n
      logical :: is_first, is_last

      call free_motions(model, points, prescribed, &
         merge(contact_open, merge(contact_stick, contact_slip, laws%friction%coefficient > &
         0.0_dp), laws%removed), motions)
      allocate (messages(0))
      n = size(motions)
      do i = 1, n
         is_first = i == 1
         if (i > 1) is_first = mover(model, motions(i)) /= mover(model, motions(i - 1))
         is_last = i == n
         if (i < n) is_last = mover(model, motions(i)) /= mover(model, motions(i + 1))
         if (is_first) then
            words = mover(model, motions(i))//' can '
         else
            words = words//trim(merge(' and', ',   ', is_last))//' '
         end if
         words = words//motions(i)%verb()//' '//motions(i)%way
         if (is_last) then
            words = words//motions(i)%company//': no *BOUNDARY and no contact holds it; '// &
               remedy(motions(i))
            if (any(model%interactions%heat%leaves_plane()) .and. .not. motions(i)%deforms) then
               words = words//'; where *GAP HEAT GENERATION gives v, friction does not act in '// &
                  'the plane'
            end if
            call append(messages, words)
         else if (motions(i)%company /= motions(i + 1)%company) then
            words = words//motions(i)%company
         end if
      end do
   end subroutine unconstrained_in_step

   !> Bodies that the supports and the contact points in these states leave free, to be added to a
   !> message, such as '; body 2 (...) is free to slide along x'; empty where all are constrained.
   function unconstrained_now(model, points, has_friction, prescribed, contact_state) result(words)
      type(model_type), intent(in) :: model
      type(connections_type), intent(in) :: points !! all contact points
      logical, intent(in) :: has_friction(:)        !! (m)
      logical, intent(in) :: prescribed(:)                !! (2 nodes) prescribed displacements
      integer, intent(in) :: contact_state(:)     !! (m) contact_open, contact_slip or contact_stick
      character(:), allocatable :: words
      type(free_motion_type), allocatable :: motions(:), welded(:)
      integer, allocatable :: stuck(:)
      character(:), allocatable :: last
      integer :: i

      call free_motions(model, points, prescribed, contact_state, motions)
      stuck = merge(contact_stick, contact_state, contact_state == contact_slip .and. &
         has_friction)
      call free_motions(model, points, prescribed, stuck, welded)
      words = ''
      last = ''
      do i = 1, size(motions)
         if (mover(model, motions(i)) == last) then
            words = words//', '
         else
            words = words//'; '//mover(model, motions(i))//' is free to '
         end if
         last = mover(model, motions(i))
         if (motions(i)%verb() == 'move' .and. size(welded) == 0) then
            words = words//'slide'
         else
            words = words//motions(i)%verb()
         end if
         words = words//' '//motions(i)%way//motions(i)%company
      end do
   end function unconstrained_now

   !> The free motions with the contact points in these states.
   subroutine free_motions(model, points, prescribed, contact_state, motions)
      type(model_type), intent(in) :: model
      type(connections_type), intent(in) :: points
      logical, intent(in) :: prescribed(:)
      integer, intent(in) :: contact_state(:)
      type(free_motion_type), allocatable, intent(out) :: motions(:)
      type(joint_type) :: joints(2*size(contact_state))
      ! gfortran never frees the components of a function's result within an array constructor.
      type(joint_type), allocatable :: of_bars(:), of_equations(:), of_ties(:)
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
      of_ties = joints_of(points%ties)
      of_equations = joints_of(points%equations)
      of_bars = joints_of(points%elongations)
      call find_free_motions(model%mesh, prescribed, [joints(:n), of_ties, of_equations, of_bars], &
         motions)
      if (.not. allocated(model%couplings)) return
      do k = 1, size(motions)
         if (motions(k)%node == 0) cycle
         if (all(model%couplings%rotation /= motions(k)%node)) cycle
         motions(k)%turns = .true.
         motions(k)%way = 'about its reference node'
      end do
   end subroutine free_motions

   !> Condition of a contact point along a direction.
   pure function joint_of(points, k, direction) result(joint)
      type(connections_type), intent(in) :: points
      integer, intent(in) :: k
      real(dp), intent(in) :: direction(2)
      type(joint_type) :: joint
      real(dp), allocatable :: along(:), across(:)

      call points%means_of(k, joint%nodes, along, across)
      joint%share = spread(direction, 2, size(along))*spread(along, 1, 2) + &
         spread([-direction(2), direction(1)], 2, size(along))*spread(across, 1, 2)
   end function joint_of

   !> Bodies whose temperature nothing can ever determine: contact points count as conducting where
   !> one side of their law is given. One message a body.
   subroutine undetermined_in_step(model, points, laws, prescribed, step, messages)
      type(model_type), intent(in) :: model
      type(connections_type), intent(in) :: points !! all contact points
      type(contact_laws_type), intent(in) :: laws   !! theirs in the step
      logical, intent(in) :: prescribed(:)                !! (nodes) prescribed temperatures
      integer, intent(in) :: step                   !! the step, for its films
      type(string_type), allocatable, intent(out) :: messages(:)

      call find_undetermined(model, points, with_source(model, prescribed, step), prescribed, &
         laws%conductance%open_kind /= law_none .or. laws%conductance%closed_kind /= law_none, &
         ': no *BOUNDARY on dof 11, no *FILM and no contact that conducts heat fixes it', messages)
   end subroutine undetermined_in_step

   !> Bodies whose temperature the conductances of an instant leave undetermined, in one message;
   !> empty where there are none.
   function undetermined_now(model, points, prescribed, step, conducts) result(words)
      type(model_type), intent(in) :: model
      type(connections_type), intent(in) :: points !! all contact points
      logical, intent(in) :: prescribed(:)                !! (nodes) prescribed temperatures
      integer, intent(in) :: step                   !! the step, for its films
      logical, intent(in) :: conducts(:)            !! (m) contact points that carry heat
      character(:), allocatable :: words
      type(string_type), allocatable :: messages(:)

      call find_undetermined(model, points, with_source(model, prescribed, step), prescribed, &
         conducts, ': all its contact points have conductance 0', messages)
      words = joined(messages)
   end function undetermined_now

   !> Bodies whose temperature nothing determines beside some nodes, even if all contact points
   !> carried heat, in one message; empty where there are none.
   function undetermined_beside(model, points, determined) result(words)
      type(model_type), intent(in) :: model
      type(connections_type), intent(in) :: points !! all contact points
      logical, intent(in) :: determined(:)          !! (nodes) nodes whose temperature is fixed
      character(:), allocatable :: words
      type(string_type), allocatable :: messages(:)
      logical :: has_source(model%mesh%body_count)

      has_source = .false.
      has_source(pack(model%mesh%node_body, determined .and. model%mesh%node_body > 0)) = .true.
      call find_undetermined(model, points, has_source, determined, &
         spread(.true., 1, size(points%slave)), '', messages)
      words = joined(messages)
   end function undetermined_beside

   !> Messages in one.
   pure function joined(messages) result(words)
      type(string_type), intent(in) :: messages(:)
      character(:), allocatable :: words
      integer :: i

      words = ''
      do i = 1, size(messages)
         if (i > 1) words = words//'; '
         words = words//messages(i)%value
      end do
   end function joined

   !> Bodies whose temperature, uniform in each, is left free by the sources of heat, by conducting
   !> contact points and ties, which make that of two bodies equal, and by the equations.
   subroutine find_undetermined(model, points, has_source, prescribed, conducts, ending, messages)
      type(model_type), intent(in) :: model
      type(connections_type), intent(in) :: points
      logical, intent(in) :: has_source(:)          ! (bodies)
      logical, intent(in) :: prescribed(:)                ! (nodes) prescribed temperatures
      logical, intent(in) :: conducts(:)
      character(*), intent(in) :: ending            ! of each message
      type(string_type), allocatable, intent(out) :: messages(:)
      logical :: joined(0:size(has_source), 0:size(has_source))
      type(sum_list_type) :: rows
      real(dp), allocatable :: free(:, :)
      integer :: body, k, other, unknowns

      joined = .false.
      do k = 1, size(conducts)
         if (conducts(k)) call join(points%slave(k), points%master(k))
      end do
      if (allocated(points%ties%slave)) then
         do k = 1, size(points%ties%slave)
            call join(points%ties%slave(k), points%ties%master(k))
         end do
      end if
      call list_equations(model, points, prescribed, unknowns, rows)
      do body = 1, size(has_source)
         if (has_source(body)) call rows%add([body], [1.0_dp])
         do other = 1, body - 1
            if (joined(body, other)) call rows%add([body, other], [1.0_dp, -1.0_dp])
         end do
      end do
      free = null_space_of(rows, unknowns)
      allocate (messages(0))
      do body = 1, size(has_source)
         if (any(abs(free(body, :)) > negligible)) call append(messages, 'the temperature of '// &
            body_name(model, body)//' is undetermined'//ending)
      end do

   contains
      subroutine join(slave, master)
         integer, intent(in) :: slave, master

         associate (b => model%mesh%node_body([slave, master]))
            joined(maxval(b), minval(b)) = maxval(b) > minval(b)
         end associate
      end subroutine join
   end subroutine find_undetermined

   !> Conditions of equations on the temperatures of the bodies and, behind them, of the nodes of no
   !> body that they name.
   pure subroutine list_equations(model, points, prescribed, unknowns, rows)
      type(model_type), intent(in) :: model
      type(connections_type), intent(in) :: points
      logical, intent(in) :: prescribed(:)
      integer, intent(out) :: unknowns
      type(sum_list_type), intent(out) :: rows
      real(dp), allocatable :: row(:)
      integer :: lone(size(prescribed)), e, i, k

      lone = 0
      do e = 1, size(points%equations)
         if (.not. points%equations(e)%is_thermal()) cycle
         lone(points%equations(e)%node) = 1
      end do
      where (model%mesh%node_body > 0 .or. prescribed) lone = 0
      k = model%mesh%body_count
      do i = 1, size(lone)
         if (lone(i) == 0) cycle
         k = k + 1
         lone(i) = k
      end do
      unknowns = k
      call rows%reserve(size(points%equations) + k, 2*k)
      allocate (row(unknowns))
      do e = 1, size(points%equations)
         if (.not. points%equations(e)%is_thermal()) cycle
         row = 0.0_dp
         do i = 1, size(points%equations(e)%node)
            associate (node => points%equations(e)%node(i))
               k = max(model%mesh%node_body(node), lone(node))
               if (k > 0) row(k) = row(k) + points%equations(e)%coefficient(i)
            end associate
         end do
         call rows%add([(k, k=1, unknowns)], row)
      end do
   end subroutine list_equations

   !> Bodies with a prescribed temperature, with a heat capacity in a transient step, or with a film
   !> in a step: its own ones and those of the steps before that it keeps.
   pure function with_source(model, prescribed, step) result(source)
      type(model_type), intent(in) :: model
      logical, intent(in) :: prescribed(:)
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
      source(pack(model%mesh%node_body, prescribed .and. model%mesh%node_body > 0)) = .true.
      if (model%steps(step)%is_transient) source(pack(model%mesh%element_body, &
         model%materials(model%sections(model%mesh%element_section)%material)%specific_heat > &
         0.0_dp)) = .true.
   end function with_source

   !> The *RIGID BODY whose reference node, or node of its rotation, a node is; 0 for none.
   pure integer function rigid_body_of(model, node)
      type(model_type), intent(in) :: model
      integer, intent(in) :: node

      rigid_body_of = 0
      if (allocated(model%couplings)) rigid_body_of = findloc(model%couplings%is_rigid .and. &
         (model%couplings%reference == node .or. model%couplings%rotation == node), .true., dim=1)
   end function rigid_body_of

   !> What to do about a motion that nothing holds.
   pure function remedy(motion) result(words)
      type(free_motion_type), intent(in) :: motion
      character(:), allocatable :: words

      words = 'hold it by *BOUNDARY'
      if (motion%element > 0) words = words//', or let the parts share sides: they meet '// &
         'at nodes alone'
      if (motion%deforms) words = 'its one element with reduced integration has an hourglass '// &
         'mode: take CPE8 in place of CPE8R, or CPS8 in place of CPS8R, or a finer mesh'
   end function remedy

   !> The moving part, in words.
   function mover(model, motion) result(name)
      type(model_type), intent(in) :: model
      type(free_motion_type), intent(in) :: motion
      character(:), allocatable :: name
      integer :: i

      if (motion%body > 0) then
         name = body_name(model, motion%body)
         if (motion%element > 0) name = 'the part of '//name//' with element '// &
            to_text(motion%element)
      else
         name = 'node '//to_text(model%mesh%node_number(motion%node))//' of an equation'
         i = rigid_body_of(model, motion%node)
         if (i > 0) name = 'the body of '//model%couplings(i)%title//','
      end if
   end function mover

end module unconstrained_bodies
