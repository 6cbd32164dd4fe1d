!> Checks once all cards are read: whether elements, materials, surfaces and steps fit
!> together.
module deck_checks
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use elasticity, only: equivalent_poisson
   use element_kinds, only: axisymmetric, linear_kind, plane_stress, quad8, triangle3, triangle6
   use mesh_checks, only: check_jacobians, check_planes, check_sides, check_slenderness
   use kinds, only: dp, long
   use load_checks, only: check_loads
   use model, only: model_type
   use refinement, only: numbering_fault
   use steps, only: solves_heat, solves_mechanics
   use text, only: to_text
   implicit none
   private
   public :: check_model

   !> Largest equivalent Poisson's ratio that is not warned of where elements lock: 0.49, which the
   !> entries of the stiffness give but for rounding.
   real(dp), parameter :: most_compressible = 0.49_dp*(1 + 1.0e-9_dp)

contains

   !> Checks the model before it is refined.
   subroutine check_model(context, model, report)
      type(deck_context_type), intent(in) :: context       !! places for messages
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer :: uses(4, size(model%mesh%element_number))
      logical :: inverted(size(model%mesh%element_number))
      character(:), allocatable :: fault

      ! The mesh once it is refined.
      fault = numbering_fault(model%mesh, size(model%mesh%element_number)*4_long**context%levels)
      if (len(fault) > 0) call report%error(context%levels_place, fault)
      call check_sections(context, model, report)
      call check_materials(context, model, report)
      call check_planes(context, model%mesh, report)
      call check_orientations(context, model, report)
      call check_jacobians(context, model%mesh, inverted, report)
      call check_slenderness(context, model%mesh, report)
      call check_sides(context, model%mesh, inverted, uses, report)
      call check_loads(context, model, uses, report)
   end subroutine check_model

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
      logical :: mechanics, heat
      integer :: m

      if (.not. context%analyses_sound) return
      mechanics = any(solves_mechanics(model%steps%analysis))
      heat = any(solves_heat(model%steps%analysis))
      do m = 1, size(model%materials)
         if (.not. any(model%sections%material == m)) cycle
         associate (material => model%materials(m))
            if (mechanics .and. .not. material%has_elasticity) call report%missing( &
               context%material_place(m), 'material '//material%name// &
               ' has no *ELASTIC, which a step with displacements needs', '*ELASTIC')
            if (heat .and. .not. material%has_conductivity) call report%missing( &
               context%material_place(m), 'material '//material%name// &
               ' has no *CONDUCTIVITY, which a step with heat needs', '*CONDUCTIVITY')
            if (mechanics .and. material%has_elasticity) call check_locking(context, model, m, &
               report)
         end associate
      end do
   end subroutine check_materials

   !> Warns of a nearly incompressible material in elements that cannot follow it: those with too
   !> many integration points lock; six-node triangles do not, but their mean stress scatters and
   !> does not converge.
   subroutine check_locking(context, model, m, report)
      type(deck_context_type), intent(in) :: context
      type(model_type), intent(in) :: model
      integer, intent(in) :: m
      type(deck_report_type), intent(inout) :: report

      if (maxval(abs(model%materials(m)%elasticity)) <= 0.0_dp) return
      if (equivalent_poisson(model%materials(m)%elasticity) <= most_compressible) return
      call warn_of_kinds(context, model, m, [quad8, triangle3], 'elements such as ', &
         ' are too stiff', report)
      call warn_of_kinds(context, model, m, [triangle6], 'the stresses of elements such as ', &
         ' scatter', report)
   end subroutine check_locking

   !> Warns of the first element of some kinds that has the material and is not in plane stress.
   subroutine warn_of_kinds(context, model, m, kinds, subject, trouble, report)
      type(deck_context_type), intent(in) :: context
      type(model_type), intent(in) :: model
      integer, intent(in) :: m
      integer, intent(in) :: kinds(:)
      character(*), intent(in) :: subject, trouble
      type(deck_report_type), intent(inout) :: report
      integer :: e, kind

      associate (mesh => model%mesh)
         do e = 1, size(mesh%element_number)
            if (mesh%element_section(e) == 0 .or. .not. context%element_valid(e)) cycle
            if (model%sections(mesh%element_section(e))%material /= m) cycle
            if (mesh%element_plane(e) == plane_stress) cycle
            kind = mesh%element_kind(e)
            if (context%order == 1) kind = linear_kind(kind)
            if (all(kind /= kinds)) cycle
            call report%warning(context%material_place(m), 'material '//model%materials(m)%name// &
               ' is nearly incompressible: '//subject//to_text(mesh%element_number(e))// &
               trouble//' with it; take '//trim(merge('CAX8R', 'CPE8R', &
               mesh%element_plane(e) == axisymmetric)))
            return
         end do
      end associate
   end subroutine warn_of_kinds

   !> The axis of a cylindrical orientation is parallel to z, where an axisymmetric model has none.
   subroutine check_orientations(context, model, report)
      type(deck_context_type), intent(in) :: context
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      integer :: e

      do e = 1, size(model%mesh%element_number)
         if (model%mesh%element_section(e) == 0) cycle
         if (model%mesh%element_plane(e) /= axisymmetric) cycle
         associate (index => model%sections(model%mesh%element_section(e))%orientation)
            if (index == 0) cycle
            if (.not. model%orientations(index)%cylindrical) cycle
            call report%error(context%element_place(e), 'element '// &
               to_text(model%mesh%element_number(e))//' is axisymmetric: the cylindrical '// &
               'orientation '//model%orientations(index)%name//' has its axis along z')
            return
         end associate
      end do
   end subroutine check_orientations

end module deck_checks
