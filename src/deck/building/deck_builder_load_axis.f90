!> LOAD= of *OPTIONS: the prescribed value that the load axis follows.
module deck_builder_load_axis
   use deck_context, only: deck_context_type, find_set, report_unknown, set_names
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use model, only: model_type
   use steps, only: dof_temperature
   use text, only: read_integer, to_text
   implicit none
   private
   public :: build_load_axis

contains

   !> Takes LOAD=nset,dof of *OPTIONS: the prescribed value that the load axis follows.
   subroutine build_load_axis(last, context, model, report)
      type(place_type), intent(in) :: last                 !! where the deck ends
      type(deck_context_type), intent(inout) :: context    !! set, its place, and what is prescribed
      type(model_type), intent(inout) :: model   !! receives node, degree of freedom and label
      type(deck_report_type), intent(inout) :: report      !! receives errors
      character(:), allocatable :: name
      integer, allocatable :: members(:)
      integer :: comma, set, dof, i
      logical :: valid

      model%load_label = 'time'
      if (.not. allocated(context%load_set)) then
         call context%note('*OPTIONS without LOAD=: the load axis is the time')
         return
      end if
      comma = index(context%load_set, ',')
      if (comma == 0) comma = len(context%load_set) + 1
      name = context%load_set(:comma - 1)
      call read_integer(context%load_set(min(comma + 1, len(context%load_set) + 1):), dof, valid)
      if (.not. valid .or. .not. any(dof == [1, 2, dof_temperature])) then
         call report%error(context%load_place, &
            'LOAD= has a node set and a degree of freedom 1, 2 or 11')
         return
      end if
      set = find_set(model%mesh%node_sets, name)
      if (set == 0) then
         call report_unknown('node set', name, set_names(model%mesh%node_sets), &
            context%load_place, report)
         return
      end if
      members = model%mesh%node_sets(set)%members
      if (size(members) == 0) return
      members = pack(members, .not. context%dropped(members))
      if (size(members) == 0) then
         call report%error(context%load_place, 'ORDER=1 leaves no node of '//name// &
            ', which has midside nodes only; LOAD= needs one at a corner')
         return
      end if
      model%load_node = members(1)
      model%load_dof = dof
      model%load_label = dof_name(dof)//' of '//name
      if (.not. (context%boundaries_sound .and. context%sets_sound)) return
      if (is_prescribed(context, model)) return
      do i = 1, context%boundaries%count
         if (context%boundaries%items(i)%component /= dof) cycle
         call report%error(context%load_place, 'LOAD= follows a value that no *BOUNDARY '// &
            'prescribes: '//dof_name(dof)//' of '//name)
         return
      end do
      if (report%has_lost('*STEP')) return
      call report%error(last, 'no *BOUNDARY prescribes any '//dof_name(dof)// &
         ' (degree of freedom '//to_text(dof)//'), which LOAD='//context%load_set// &
         ' of *OPTIONS follows; give the values, as '//name//', '//to_text(dof)//', '// &
         to_text(dof)//', value')
   end subroutine build_load_axis

   pure function dof_name(dof) result(name)
      integer, intent(in) :: dof
      character(:), allocatable :: name

      select case (dof)
      case (1)
         name = 'u_x'
      case (2)
         name = 'u_y'
      case default
         name = 'temperature'
      end select
   end function dof_name

   !> Whether a *BOUNDARY prescribes the degree of freedom of the load axis at its node.
   pure logical function is_prescribed(context, model)
      type(deck_context_type), intent(in) :: context
      type(model_type), intent(in) :: model
      integer :: i

      is_prescribed = .true.
      do i = 1, context%boundaries%count
         associate (request => context%boundaries%items(i))
            if (request%component /= model%load_dof) cycle
            if (request%item == model%load_node) return
            if (request%set == 0) cycle
            if (any(model%mesh%node_sets(request%set)%members == model%load_node)) return
         end associate
      end do
      is_prescribed = .false.
   end function is_prescribed

end module deck_builder_load_axis
