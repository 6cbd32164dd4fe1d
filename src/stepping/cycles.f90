!> Cycles of steps that *CYCLE repeats, until a quantity is at the end of one what it was at the end
!> of the one before.
module cycles
   use kinds, only: dp
   use model, only: model_type
   use records, only: increment_record_type
   use simulation, only: simulation_type
   use solution_state, only: solution_state_type
   use steps, only: cycle_type, until_force, until_strain
   use text, only: append, to_text
   implicit none
   private
   public :: close_cycle

   real(dp), parameter :: no_strain = 1.0e-6_dp   ! of a cycle, where not strains are compared

contains

   !> At the end of a cycle: compares it with the one before, and ends the cycles where it repeats
   !> that. Without a cycle before it is kept for the next one.
   subroutine close_cycle(run, model, record)
      type(simulation_type), intent(inout) :: run            !! behind an increment
      type(model_type), intent(in) :: model
      type(increment_record_type), intent(inout) :: record   !! of it
      real(dp) :: change

      associate (cycle => model%steps(record%step)%cycle)
         if (cycle%steps == 0 .or. .not. record%last_of_step) return
         if (allocated(run%cycle_before)) then
            change = change_between(run, model, cycle, run%cycle_before)
            record%cycle = words_of(run, model, cycle, run%cycle_before, change)
            if (change <= cycle%tolerance) then
               record%left_out = cycle%last - record%step
               if (record%left_out > 0) call append(record%notes, 'this cycle repeats the '// &
                  'one before: '//to_text(record%left_out/cycle%steps)//' more are left out')
               run%control%step = cycle%last
            end if
         end if
         run%cycle_before = run%state
         if (run%control%step == cycle%last) deallocate (run%cycle_before)
      end associate
   end subroutine close_cycle

   !> How far the quantity of a *CYCLE is from what it was: strains as they are, others over their
   !> largest value.
   real(dp) function change_between(run, model, cycle, before) result(change)
      type(simulation_type), intent(in) :: run
      type(model_type), intent(in) :: model
      type(cycle_type), intent(in) :: cycle
      type(solution_state_type), intent(in) :: before

      associate (state => run%state)
         if (cycle%until == until_strain) then
            change = ratchet(run, model, before)
         else if (cycle%until == until_force) then
            change = relative(state%contact%force, before%contact%force)
         else
            change = relative(state%displacement, before%displacement)
         end if
      end associate
   contains
      pure real(dp) function relative(values, values_before)
         real(dp), intent(in) :: values(:), values_before(:)

         relative = 0.0_dp
         if (size(values) > 0) relative = maxval(abs(values - values_before))/ &
            max(maxval(abs(values)), tiny(1.0_dp))
      end function relative
   end function change_between

   !> Largest change of inelastic strains from cycle to cycle, as an equivalent strain.
   real(dp) function ratchet(run, model, before)
      type(simulation_type), intent(in) :: run
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(in) :: before
      real(dp) :: largest(2)

      ratchet = 0.0_dp
      if (.not. allocated(before%history)) return
      largest = run%corrections%points%difference_of_stages(model%mesh, before%history, &
         run%state%history)
      ratchet = largest(1)
   end function ratchet

   !> What a cycle did, in words.
   function words_of(run, model, cycle, before, change) result(words)
      type(simulation_type), intent(in) :: run
      type(model_type), intent(in) :: model
      type(cycle_type), intent(in) :: cycle
      type(solution_state_type), intent(in) :: before
      real(dp), intent(in) :: change                    ! of what is compared
      character(:), allocatable :: words
      real(dp) :: growth(2), least, moved

      if (.not. allocated(before%history)) then
         words = 'displacements'
         if (cycle%until == until_force) words = 'contact forces'
         words = words//' change by '//to_text(change)//' of the largest one in the last cycle'
         return
      end if
      growth = run%corrections%largest_growth(model, run%state, before)
      moved = ratchet(run, model, before)
      least = no_strain
      if (cycle%until == until_strain) least = cycle%tolerance
      if (growth(1) <= least .and. growth(2) > 0.0_dp) then
         words = 'creeps by '//to_text(growth(2))//' a cycle'
      else if (growth(1) <= least) then
         words = 'shakes down: inelastic strains do not grow in the last cycle'
      else if (moved <= least) then
         words = 'alternates: inelastic strains of '//to_text(maxval(growth))//' a cycle return'
      else
         words = 'ratchets by '//to_text(moved)//' a cycle'
      end if
   end function words_of

end module cycles
