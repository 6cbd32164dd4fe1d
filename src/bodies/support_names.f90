!> Names of supports in messages.
module support_names
   use load_histories, only: load_history_type
   use model, only: model_type
   implicit none
   private
   public :: support_name, join_name

contains

   !> The card that prescribes a degree of freedom, in words; empty for the axis of symmetry.
   pure function support_name(model, supports, dof) result(name)
      type(model_type), intent(in) :: model
      type(load_history_type), intent(in) :: supports   !! of the step
      integer, intent(in) :: dof                        !! prescribed
      character(:), allocatable :: name

      name = ''
      if (supports%card(dof) > 0) name = '*BOUNDARY, '// &
         model%boundary_places(supports%card(dof))%value
   end function support_name

   !> Adds a name to names joined by "and", once.
   pure subroutine join_name(names, name)
      character(:), allocatable, intent(inout) :: names
      character(*), intent(in) :: name

      if (len(name) == 0 .or. index(names//' and ', name//' and ') > 0) return
      if (len(names) > 0) names = names//' and '
      names = names//name
   end subroutine join_name

end module support_names
