!> The instant at which a contact point closes within an increment, from which its slip counts.
!>
!> A contact point that was open at gap gamma_i and is closed at the end would, alone relieved of
!> its contact forces, end at the gap gamma* < 0 and the tangential position d_t*. It closes at the
!> fraction f = gamma_i/(gamma_i - gamma*) of the increment, and its slip counts from the position
!> that lies there between d_t,i and d_t*:
!>
!>    slip = d_t - d_t,i - f (d_t* - d_t,i).
!>
!> With C the compliance of the contact point while all other closed contact points hold their
!> positions, gamma* = C_n.lambda and d_t* = d_t - C_t.lambda, so that
!>
!>    slip = (1 - f) (d_t - d_t,i) + f C_t.lambda.
!>
!> The contact system is solved with C and f frozen; both are then computed anew, until they stay.
!> Were the others to keep their conditions instead, C would jump when a neighbour turns from stick
!> to slip, and each value could call for the other condition: then there is no solution. C still
!> jumps where another contact point closes or opens. Where that goes round and round, every contact
!> point that was closed on the way counts as one that holds. Then C stays, and only f can go on
!> swinging, with much friction; of each change half is made in the end.
module closing_instant
   use active_set, only: solve_contact
   use contact_states, only: closing_law_type, contact_state_type, contact_open, contact_stick
   use contact_system, only: contact_system_type
   use contact_workspace, only: contact_workspace_type, relief_type
   use errors, only: error_type, set_error, status_no_convergence
   use kinds, only: dp
   use unconstrained_motions, only: free_motions
   implicit none
   private
   public :: solve_increment

   integer, parameter :: most_passes = 120 !! passes over the closing laws
   !> of these, with the contact points holding that are closed
   integer, parameter :: free_passes = 10
   integer, parameter :: plain_passes = 60 !! of these, going all the way to the new laws
   real(dp), parameter :: settled = 1.0e-13_dp !! relative change of a law that counts as none
   real(dp), parameter :: rounding = 1.0e-10_dp   !! the same where it does not come down to that
   !> Determinant of a contact point's stiffness, over that of the contact point alone on held
   !> bodies, that is none.
   real(dp), parameter :: nothing = 1.0e-12_dp

contains

   !> Contact state at the end of an increment, with the references of the contact points that close
   !> in it. Only the states of the guess count: where bodies are unconstrained, the motion is the
   !> least one from the start of the increment. The workspace may have laws of an earlier pass; a
   !> pass that fails leaves none.
   !> Error: as solve_contact, or closing laws that do not settle.
   subroutine solve_increment(system, previous, load, work, held, state, error)
      type(contact_system_type), intent(in) :: system     !! the reduced system
      type(contact_state_type), intent(in) :: previous    !! state at the start of the increment
      real(dp), intent(in) :: load(:)                     !! (tail) condensed load [force]
      type(contact_workspace_type), intent(inout) :: work !! laws and factors of the solution out
      !> Factors of the set whose closed contact points all hold their positions: a fresh one, or
      !> that of an earlier pass of the increment.
      type(contact_workspace_type), intent(inout) :: held
      type(contact_state_type), intent(inout) :: state    !! guess in, solution out
      type(error_type), allocatable, intent(out) :: error

      call settle_laws(system, previous, load, work, held, state, error)
      if (allocated(error)) work%closing = closing_law_type()
   end subroutine solve_increment

   !> Solves with frozen closing laws until they stay.
   subroutine settle_laws(system, previous, load, work, held, state, error)
      type(contact_system_type), intent(in) :: system
      type(contact_state_type), intent(in) :: previous
      real(dp), intent(in) :: load(:)
      type(contact_workspace_type), intent(inout) :: work, held
      type(contact_state_type), intent(inout) :: state
      type(error_type), allocatable, intent(out) :: error
      type(closing_law_type) :: laws(size(state%contact_state))
      logical :: holds(size(state%contact_state))
      real(dp) :: change
      integer :: k, pass

      if (.not. allocated(held%closing)) then
         held = work%another()
         held%closing = closing_law_type()
      end if
      holds = .false.
      do pass = 1, most_passes
         state%gap = previous%gap
         state%tangential = previous%tangential
         call solve_contact(system, load, work, state, error)
         if (allocated(error)) return
         holds = state%contact_state /= contact_open .or. (holds .and. pass > free_passes)
         laws = work%closing
         call find_laws(system, previous, state, holds, held, laws, error)
         if (allocated(error)) return
         change = maxval([0.0_dp, law_change(work%closing, laws)])
         if (pass > plain_passes) where (work%closing%acts .and. laws%acts) &
            laws%fraction = 0.5_dp*(laws%fraction + work%closing%fraction)
         ! Laws that stay keep the factors.
         if (change > settled) work%closing = laws
         if (change <= merge(settled, rounding, pass <= free_passes)) then
            do k = 1, size(state%contact_state)
               if (work%closing(k)%acts .and. state%contact_state(k) /= contact_open) then
                  state%reference(k) = state%tangential(k) - work%slip(system, state, k)
               end if
            end do
            ! An active set satisfies its conditions to rounding.
            where (.not. system%removed) state%gap = max(state%gap, 0.0_dp)
            return
         end if
      end do
      call set_error(error, status_no_convergence, &
         'the instants at which contact points close do not settle')
   end subroutine settle_laws

   !> Closing laws of the contact points that are closed now and were open at the start of the
   !> increment. A contact point that has opened again keeps its law, on which nothing depends:
   !> without it the contact point might close, with it open, for ever.
   !> Error: a singular system.
   subroutine find_laws(system, previous, state, holds, held, laws, error)
      type(contact_system_type), intent(in) :: system
      type(contact_state_type), intent(in) :: previous
      type(contact_state_type), intent(in) :: state
      logical, intent(in) :: holds(:)
      type(contact_workspace_type), intent(inout) :: held
      type(closing_law_type), intent(inout) :: laws(:)
      type(error_type), allocatable, intent(out) :: error
      type(contact_state_type) :: held_state
      type(relief_type) :: relief
      logical :: closes(size(state%contact_state))
      integer :: k

      closes = previous%contact_state == contact_open .and. state%contact_state /= &
         contact_open .and. system%tangent > 0
      if (.not. any(closes)) return
      held_state = state
      held_state%contact_state = merge(contact_stick, contact_open, holds)
      call held%factor_set(system, held_state, error)
      if (allocated(error)) return
      if (.not. allocated(held%relief)) allocate (held%relief(size(closes)))
      do k = 1, size(closes)
         if (.not. closes(k)) cycle
         if (.not. held%relief(k)%is_known) then
            call find_compliance(system, held, held_state, k, relief, error)
            if (allocated(error)) return
            held%relief(k) = relief
            held%reliefs = held%reliefs + 1
         end if
         call make_law(held%relief(k)%compliance, previous, state, k, laws(k))
         if (held%relief(k)%alone) laws(k)%fraction = 0.0_dp
      end do
   end subroutine find_laws

   !> Relative change from one law to another.
   elemental function law_change(old, new) result(change)
      type(closing_law_type), intent(in) :: old, new
      real(dp) :: change

      change = 0.0_dp
      if (old%acts .neqv. new%acts) change = 1.0_dp
      if (.not. (old%acts .and. new%acts)) return
      change = max(abs(new%fraction - old%fraction), &
         maxval(abs(new%compliance - old%compliance))/ &
         max(maxval(abs(new%compliance)), tiny(1.0_dp)))
   end function law_change

   !> Compliance of one contact point while all other closed contact points hold their positions. A
   !> contact point of a cycle may have none along a direction in which the others hold it, so it is
   !> opened there. Where only this contact point holds a body, relieved it would go without end: it
   !> closes at once, for which a normal compliance of zero and the start of the increment are. The
   !> rows that hold the body tell, since its determinant, zero then, may be any rounding.
   !> Error: a singular system.
   subroutine find_compliance(system, held, held_state, k, relief, error)
      type(contact_system_type), intent(in) :: system
      type(contact_workspace_type), intent(in) :: held
      type(contact_state_type), intent(in) :: held_state
      integer, intent(in) :: k
      type(relief_type), intent(out) :: relief
      type(error_type), allocatable, intent(out) :: error
      type(contact_workspace_type) :: opened
      type(contact_state_type) :: opened_state
      real(dp) :: response(size(system%schur, 1), 2), stiffness(2, 2), determinant
      integer :: tail_rows(2)

      tail_rows = [system%normal(k), system%tangent(k)]
      if (system%compliance(k) > 0.0_dp) then
         opened = held%another()
         opened_state = held_state
         opened_state%contact_state(k) = contact_open
         call opened%factor_set(system, opened_state, error)
         if (allocated(error)) return
         response = 0.0_dp
         response(tail_rows(1), 1) = 1.0_dp
         response(tail_rows(2), 2) = 1.0_dp
         call opened%solve_free(response)
         relief%compliance = response(tail_rows, :)
         relief%alone = size(opened%unconstrained, 2) > size(held%unconstrained, 2)
      else
         stiffness = held%stiffness(system, tail_rows)
         determinant = stiffness(1, 1)*stiffness(2, 2) - stiffness(1, 2)*stiffness(2, 1)
         associate (unheld => free_motions(system%motion, [held%rows%free, tail_rows], &
            held%rows%spring, system%schur))
            relief%alone = size(unheld, 2) > size(held%unconstrained, 2) .or. determinant <= &
               nothing*system%schur(tail_rows(1), tail_rows(1))* &
               system%schur(tail_rows(2), tail_rows(2))
         end associate
         if (.not. relief%alone) relief%compliance = reshape([stiffness(2, 2), -stiffness(2, 1), &
            -stiffness(1, 2), stiffness(1, 1)], [2, 2])/determinant
      end if
      relief%is_known = .true.
      if (relief%alone) relief%compliance = reshape([0.0_dp, 0.0_dp, 0.0_dp, &
         1.0_dp/system%alone(k)], [2, 2])
   end subroutine find_compliance

   !> The closing law of one contact point.
   pure subroutine make_law(compliance, previous, state, k, law)
      real(dp), intent(in) :: compliance(2, 2)
      type(contact_state_type), intent(in) :: previous
      type(contact_state_type), intent(in) :: state
      integer, intent(in) :: k
      type(closing_law_type), intent(out) :: law
      real(dp) :: overlap

      overlap = dot_product(compliance(1, :), [state%force(k), -state%shear_force(k)])
      law%acts = .true.
      law%start = previous%tangential(k)
      law%compliance = compliance(2, :)
      if (previous%gap(k) > 0.0_dp) then
         law%fraction = previous%gap(k)/(previous%gap(k) + max(overlap, 0.0_dp))
         if (overlap > 0.0_dp) law%rate = compliance(1, :)*law%fraction/(previous%gap(k) + overlap)
      end if
   end subroutine make_law

end module closing_instant
