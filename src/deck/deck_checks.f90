!> What only shows once all cards are read: whether elements, materials, surfaces and steps fit
!> together.
module deck_checks
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use kinds, only: dp, long
   use mesh, only: face_nodes, mesh_type
   use model, only: model_type
   use quadrature, only: square_points
   use shape_functions, only: element_shape
   use steps, only: dof_temperature, solves_heat, solves_mechanics
   use text, only: to_text
   implicit none
   private
   public :: check_model

   !> The entries of all elements' 16 x 16 matrices are numbered in default integers.
   integer, parameter :: most_elements = 2**23 - 1

contains

   !> Checks the model before it is refined.
   subroutine check_model(context, model, report)
      type(deck_context_type), intent(in) :: context       !! places for messages
      type(model_type), intent(in) :: model                !! the model
      type(deck_report_type), intent(inout) :: report      !! receives errors

      call check_size(context, model%mesh, report)
      call check_sections(context, model, report)
      call check_materials(context, model, report)
      call check_jacobians(context, model%mesh, report)
      call check_sides(context, model%mesh, report)
      call check_forces(context, model%mesh, report)
      call check_temperatures(context, model, report)
   end subroutine check_model

   !> The refined mesh, its matrices and the new numbers of its nodes fit into default integers.
   subroutine check_size(context, mesh, report)
      type(deck_context_type), intent(in) :: context
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report
      integer(long) :: elements, largest

      elements = size(mesh%element_number)*4_long**context%levels
      if (elements > most_elements) then
         call report%error(context%levels_place, 'the mesh would have '//to_text(elements)// &
            ' elements, more than the '//to_text(most_elements)//' that can be numbered')
         return
      end if
      if (context%levels == 0 .or. elements == 0 .or. size(mesh%node_number) == 0) return
      ! An element brings at most its eight nodes.
      largest = max(maxval(mesh%node_number), maxval(mesh%element_number)) + 8*elements
      if (largest > huge(1)) call report%error(context%levels_place, &
         'the numbers of new nodes and elements, behind the largest of the deck, would exceed '// &
         to_text(huge(1)))
   end subroutine check_size

   !> Every element has a section.
   subroutine check_sections(context, model, report)
      type(deck_context_type), intent(in) :: context
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      integer :: without, e

      without = count(model%mesh%element_section == 0)
      if (size(model%sections) == 0 .or. without == 0) return
      if (.not. (context%sections_sound .and. context%sets_sound)) return
      do e = 1, size(model%mesh%element_section)
         if (model%mesh%element_section(e) == 0) exit
      end do
      call report%error(context%element_place(e), 'no *SOLID SECTION for element '// &
         to_text(model%mesh%element_number(e))//'; elements without one: '//to_text(without))
   end subroutine check_sections

   !> Every material in use has what the steps need.
   subroutine check_materials(context, model, report)
      type(deck_context_type), intent(in) :: context
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      integer :: m

      do m = 1, size(model%materials)
         if (.not. any(model%sections%material == m)) cycle
         associate (material => model%materials(m))
            if (any(solves_mechanics(model%steps%analysis)) .and. .not. &
               material%has_elasticity) call report%error(context%material_place(m), &
               'material '//material%name//' has no *ELASTIC')
            if (any(solves_heat(model%steps%analysis)) .and. .not. &
               material%has_conductivity) call report%error(context%material_place(m), &
               'material '//material%name//' has no *CONDUCTIVITY, which a step with heat needs')
         end associate
      end do
   end subroutine check_materials

   !> The Jacobian is positive at the Gauss points of every element.
   subroutine check_jacobians(context, mesh, report)
      type(deck_context_type), intent(in) :: context
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report
      real(dp) :: points(2, 9), weights(9), slope(8, 2, 9), map(2, 2)
      integer :: e, g

      call square_points(points, weights)
      do g = 1, 9
         ! Along xi, and along eta, each shape function is a parabola: its difference over
         ! a distance of 2 is its slope.
         slope(:, 1, g) = (element_shape(points(:, g) + [1.0_dp, 0.0_dp]) - &
            element_shape(points(:, g) - [1.0_dp, 0.0_dp]))/2
         slope(:, 2, g) = (element_shape(points(:, g) + [0.0_dp, 1.0_dp]) - &
            element_shape(points(:, g) - [0.0_dp, 1.0_dp]))/2
      end do
      do e = 1, size(mesh%element_number)
         if (.not. context%element_valid(e)) cycle
         do g = 1, 9
            map = matmul(mesh%coordinates(:, mesh%element_nodes(:, e)), slope(:, :, g))
            if (map(1, 1)*map(2, 2) - map(1, 2)*map(2, 1) > 0.0_dp) cycle
            call report%error(context%element_place(e), 'the Jacobian of element '// &
               to_text(mesh%element_number(e))//' is not positive: its corners must go round '// &
               'anticlockwise, its midside nodes lie near the middle')
            exit
         end do
      end do
   end subroutine check_jacobians

   !> Elements meet along whole sides, and surfaces are faces of which one side is free.
   subroutine check_sides(context, mesh, report)
      type(deck_context_type), intent(in) :: context
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report
      integer :: first(size(mesh%node_number)), uses(size(mesh%node_number))
      logical :: corner(size(mesh%node_number))
      integer :: e, f, node, s, i

      corner = .false.
      uses = 0
      do e = 1, size(mesh%element_number)
         if (context%element_valid(e)) corner(mesh%element_nodes(1:4, e)) = .true.
      end do
      first = 0
      do e = 1, size(mesh%element_number)
         if (.not. context%element_valid(e)) cycle
         do f = 1, 4
            node = mesh%element_nodes(face_nodes(2, f), e)
            uses(node) = uses(node) + 1
            if (first(node) == 0) first(node) = 4*e + f - 1
            if (corner(node) .or. uses(node) > 2 .or. .not. is_same_side(mesh, first(node), e, &
               f)) then
               call report%error(context%element_place(e), 'element '// &
                  to_text(mesh%element_number(e))//' does not share the side with midside node '// &
                  to_text(mesh%node_number(node))//' with its neighbour')
            end if
         end do
      end do
      do s = 1, size(mesh%surfaces)
         do i = 1, size(mesh%surfaces(s)%faces, 2)
            e = mesh%surfaces(s)%faces(1, i)
            f = mesh%surfaces(s)%faces(2, i)
            if (.not. context%element_valid(e)) cycle
            if (uses(mesh%element_nodes(face_nodes(2, f), e)) > 1) call report%error( &
               context%surface_place(s), 'face S'//to_text(f)//' of element '// &
               to_text(mesh%element_number(e))//' in surface '//mesh%surfaces(s)%name// &
               ' lies inside a body')
         end do
      end do
   end subroutine check_sides

   !> A force acts on an element.
   subroutine check_forces(context, mesh, report)
      type(deck_context_type), intent(in) :: context
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report
      logical :: used(0:size(mesh%node_number))
      integer :: i

      used = .false.
      used([mesh%element_nodes]) = .true.
      do i = 1, context%forces%count
         associate (request => context%forces%items(i))
            if (request%set > 0) then
               if (all(used(mesh%node_sets(request%set)%members))) cycle
            else if (used(request%item)) then
               cycle
            end if
            call report%error(request%place, 'a force on a node that no element has')
         end associate
      end do
   end subroutine check_forces

   !> Warns of temperatures that come after the last step that solves heat.
   subroutine check_temperatures(context, model, report)
      type(deck_context_type), intent(in) :: context
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      integer :: i

      do i = 1, context%boundaries%count
         associate (request => context%boundaries%items(i))
            if (request%component /= dof_temperature) cycle
            if (any(solves_heat(model%steps(max(1, request%step):)%analysis))) cycle
            call report%warning(request%place, &
               'a temperature without effect: no step from here '// &
               'on solves heat')
         end associate
      end do
   end subroutine check_temperatures

   !> Whether a side has the corners of the one that was met first with its midside node.
   pure logical function is_same_side(mesh, first, e, f)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: first, e, f
      integer :: known(3), side(3)

      known = mesh%element_nodes(face_nodes(:, mod(first, 4) + 1), first/4)
      side = mesh%element_nodes(face_nodes(:, f), e)
      is_same_side = all(known == side) .or. all(known == side(3:1:-1))
   end function is_same_side

end module deck_checks
