!> The listing's summary of the model: what will be modelled and why, sizes, interfaces.
module listing_model
   use contact_pairs, only: contact_pairs_type
   use kinds, only: dp
   use listing_text, only: print_title, print_wrapped
   use model, only: model_type
   use run_summaries, only: or_blank, run_summary_type
   use text, only: to_text
   implicit none
   private
   public :: print_model

contains

   !> Prints the summary.
   subroutine print_model(unit, model, pairs, run)
      integer, intent(in) :: unit                         !! unit of the listing
      type(model_type), intent(in) :: model               !! the model
      type(contact_pairs_type), intent(in) :: pairs(:)    !! pairs of every interface
      type(run_summary_type), intent(in) :: run           !! the run

      call print_title(unit, 'WHAT IS MODELLED')
      call print_wrapped(unit, '   ', or_blank(run%modelled))
      if (or_blank(run%reasons) /= '') call print_wrapped(unit, '   ', run%reasons)
      call print_title(unit, 'MODEL')
      call print_count(unit, 'bodies', model%mesh%body_count)
      call print_count(unit, 'nodes', size(model%mesh%node_number))
      call print_count(unit, 'elements', size(model%mesh%element_number))
      call print_count(unit, 'uniform refinements', model%refinement_levels)
      call print_count(unit, 'steps', size(model%steps))
      call print_count(unit, 'unknown temperatures', run%equations_thermal)
      call print_count(unit, 'unknown displacements', run%equations_mechanical)
      call print_count(unit, 'contact unknowns', run%contact_unknowns)
      call print_entry(unit, 'solver', or_blank(run%solver))
      call print_entry(unit, 'bytes of factors', to_text(real(run%factor_bytes, dp)))
      call print_entry(unit, 'load axis', or_blank(model%load_label))
      if (run%has_biot) call print_entry(unit, 'contact Biot number', from_to(run%contact_biot))
      call print_interfaces(unit, model, pairs)
   end subroutine print_model

   subroutine print_interfaces(unit, model, pairs)
      integer, intent(in) :: unit
      type(model_type), intent(in) :: model
      type(contact_pairs_type), intent(in) :: pairs(:)
      integer :: i

      do i = 1, size(pairs)
         write (unit, '(/, 3x, 2a)') 'CONTACT PAIR ', pairs(i)%name
         call print_count(unit, 'node pairs', size(pairs(i)%slave_node))
         call print_entry(unit, 'length', to_text(maxval(pairs(i)%arc_length)))
         call print_entry(unit, 'initial gaps', &
            from_to([minval(pairs(i)%initial_gap), maxval(pairs(i)%initial_gap)]))
         call print_entry(unit, 'coefficient of friction', &
            to_text(model%interactions(model%contacts(i)%interaction)%friction))
      end do
   end subroutine print_interfaces

   subroutine print_count(unit, name, number)
      integer, intent(in) :: unit
      character(*), intent(in) :: name
      integer, intent(in) :: number

      call print_entry(unit, name, to_text(number))
   end subroutine print_count

   subroutine print_entry(unit, name, value)
      integer, intent(in) :: unit
      character(*), intent(in) :: name
      character(*), intent(in) :: value

      write (unit, '(3x, 4a)') name, ' ', repeat('.', 26 - len(name)), ' '//value
   end subroutine print_entry

   pure function from_to(ends) result(string)
      real(dp), intent(in) :: ends(2)
      character(:), allocatable :: string

      string = to_text(ends(1))//' to '//to_text(ends(2))
   end function from_to

end module listing_model
