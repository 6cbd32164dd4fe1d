!> What a run models, in words and numbers, once its first step is prepared.
module run_description
   use conductance_laws, only: law_none
   use controls, only: solver_mumps
   use increments, only: simulation_type
   use kinds, only: dp
   use model, only: model_type
   use run_summaries, only: run_summary_type
   use steps, only: analysis_coupled
   use version, only: program_version
   implicit none
   private
   public :: describe_run

contains

   !> Fills in the summary of a run, but for its times and verdicts.
   subroutine describe_run(path, model, simulation, run)
      character(*), intent(in) :: path                 !! deck as the command line names it
      type(model_type), intent(in) :: model            !! the model
      type(simulation_type), intent(in) :: simulation  !! the run, started
      type(run_summary_type), intent(inout) :: run     !! the summary

      run%version = program_version
      run%deck_path = path
      run%solver = 'SKYLINE'
      if (model%solver == solver_mumps) run%solver = 'MUMPS'
      call name_physics(model, run)
      associate (operators => simulation%operators)
         run%equations_mechanical = operators%mechanical%map%equations
         run%contact_unknowns = operators%mechanical%map%tail
         if (simulation%is_reduced) run%factor_bytes = operators%mechanical%solver%factor_bytes
         if (.not. simulation%with_heat) return
         run%equations_thermal = operators%thermal%map%equations
         run%contact_unknowns = run%contact_unknowns + operators%thermal%map%tail
         if (simulation%is_reduced) then
            run%factor_bytes = run%factor_bytes + operators%thermal%solver%factor_bytes
         end if
      end associate
      call find_biot(model, simulation, run)
   end subroutine describe_run

   !> Which parts of the physics are on, and what in the deck switched them on.
   subroutine name_physics(model, run)
      type(model_type), intent(in) :: model
      type(run_summary_type), intent(inout) :: run
      logical :: heat

      run%modelled = 'elasticity'
      run%reasons = 'every step solves equilibrium'
      heat = any(model%steps%analysis == analysis_coupled)
      if (heat) call name('heat', '*COUPLED TEMPERATURE-DISPLACEMENT')
      if (size(model%contacts) == 0) return
      call name('contact', '*CONTACT PAIR')
      if (any(model%interactions(model%contacts%interaction)%friction > 0.0_dp)) then
         call name('friction', '*FRICTION')
      end if
      if (.not. heat) return
      if (any(model%interactions(model%contacts%interaction)%law%open_kind /= law_none) .or. &
         any(model%interactions(model%contacts%interaction)%law%closed_kind /= law_none)) then
         call name('coupling', 'conductance that depends on gap or pressure')
      end if
   contains
      subroutine name(part, reason)
         character(*), intent(in) :: part, reason

         run%modelled = run%modelled//', '//part
         run%reasons = run%reasons//'; '//part//' by '//reason
      end subroutine name
   end subroutine name_physics

   !> Contact Biot number omega L/K of the initial gaps: L the length of the interface, K the
   !> slave's conductivity.
   subroutine find_biot(model, simulation, run)
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(run_summary_type), intent(inout) :: run
      real(dp) :: conductivity, length
      integer :: element, i, first, last

      run%contact_biot = [huge(1.0_dp), 0.0_dp]
      do i = 1, size(model%contacts)
         element = model%mesh%surfaces(model%contacts(i)%slave)%faces(1, 1)
         associate (material => &
            model%materials(model%sections(model%mesh%element_section(element))%material), &
            pairs => simulation%operators%pairs)
            conductivity = sqrt(product(material%conductivity))
            length = maxval(simulation%operators%interfaces(i)%arc_length)
            first = pairs%interface_start(i)
            last = pairs%interface_start(i + 1) - 1
         end associate
         associate (biot => simulation%state%omega(first:last)*length/conductivity)
            run%contact_biot = [min(run%contact_biot(1), minval(biot)), &
               max(run%contact_biot(2), maxval(biot))]
         end associate
         run%has_biot = .true.
      end do
   end subroutine find_biot

end module run_description
