!> Temperatures that jump where a step that stores heat begins, on a mesh that is too coarse for its
!> increments: beside them temperatures overshoot until the heat has crossed an element.
module shock_checks
   use element_kinds, only: element_node_count
   use kinds, only: dp
   use materials, only: heat_capacity
   use model, only: model_type
   use records, only: increment_record_type
   use text, only: counted, to_text
   implicit none
   private
   public :: note_shock

   real(dp), parameter :: shock = 0.01_dp   !! part of the range of temperatures that is a jump
   real(dp), parameter :: crossing = 4.0_dp !! least useful increment: rho c h^2/(4 k)

contains

   !> Notes the least increment that does not overshoot beside nodes whose temperature jumps, in the
   !> smallest elements there, and warns of nodes where elements need a longer one. Elements without
   !> midside nodes have lumped capacities and do not overshoot.
   pure subroutine note_shock(model, jump, increment_size, record)
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: jump(:)              !! (nodes) of temperatures [temperature]
      real(dp), intent(in) :: increment_size       !! of the first increment [time]
      type(increment_record_type), intent(inout) :: record   !! of it; receives both
      logical :: jumps(size(jump)), is_coarse(size(jump))
      real(dp) :: least, largest, size_across
      integer :: e, i

      associate (temperature => record%fields%temperature, used => model%mesh%node_body > 0)
         jumps = abs(jump) > shock*max(maxval(abs(jump)), maxval(temperature, mask=used) - &
            minval(temperature, mask=used))
      end associate
      is_coarse = .false.
      largest = 0.0_dp
      do e = 1, size(model%mesh%element_kind)
         associate (nodes => model%mesh%element_nodes(:element_node_count( &
            model%mesh%element_kind(e)), e), x => model%mesh%coordinates, material => &
            model%materials(model%sections(model%mesh%element_section(e))%material))
            if (size(nodes) <= 4 .or. .not. any(jumps(nodes)) .or. all(jumps(nodes))) cycle
            size_across = maxval([(minval(norm2(x(:, nodes) - spread(x(:, nodes(i)), 2, &
               size(nodes)), dim=1), mask=jumps(nodes)), i=1, size(nodes))])
            least = heat_capacity(material)*size_across**2/(crossing*maxval(material%conductivity))
            if (record%useful_increment <= 0.0_dp) record%useful_increment = least
            record%useful_increment = min(record%useful_increment, least)
            if (increment_size >= least) cycle
            is_coarse(nodes) = is_coarse(nodes) .or. jumps(nodes)
            largest = max(largest, least)
         end associate
      end do
      if (.not. any(is_coarse)) return
      call record%warn('temperatures jump at '//counted(count(is_coarse), 'node')//', such as '// &
         to_text(model%mesh%node_number(findloc(is_coarse, .true., dim=1)))//', where elements '// &
         'are so large that temperatures beside them overshoot within '//to_text(largest)// &
         '; refine the mesh there, or take increments of at least this')
   end subroutine note_shock

end module shock_checks
