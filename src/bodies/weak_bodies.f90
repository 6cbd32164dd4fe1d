!> Why the stiffness of a body is singular although its rigid motions are held, in words.
module weak_bodies
   use mesh_bodies, only: body_name
   use element_kinds, only: axisymmetric, quad8_reduced
   use kinds, only: dp
   use model, only: model_type
   use text, only: to_text
   implicit none
   private
   public :: weakness_of_bodies

   !> Ratio of the stiffnesses of two bodies from which rounding of the one hides the other
   real(dp), parameter :: hidden = 1.0e12_dp

contains

   !> The first body whose elements or material explain a singular matrix, and what to do; empty
   !> where none does.
   pure function weakness_of_bodies(model) result(words)
      type(model_type), intent(in) :: model
      character(:), allocatable :: words   !! such as 'body 1 (...) is ...: take CPE8'
      real(dp) :: stiffness(model%mesh%body_count)
      integer :: body, e

      words = ''
      associate (mesh => model%mesh)
         stiffness = 0.0_dp
         do e = 1, size(mesh%element_body)
            associate (own => stiffness(mesh%element_body(e)))
               own = max(own, maxval(abs(model%materials(model%sections( &
                  mesh%element_section(e))%material)%elasticity)))
            end associate
         end do
         do body = 1, mesh%body_count
            if (stiffness(body) < maxval(stiffness)/hidden) then
               words = body_name(model, body)//' is '//to_text(maxval(stiffness)/stiffness(body)) &
                  //' times softer than '//body_name(model, maxloc(stiffness, dim=1))// &
                  ': check the values and units of *ELASTIC'
               return
            end if
            if (count(mesh%element_body == body) > 1) cycle
            e = findloc(mesh%element_body, body, dim=1)
            if (mesh%element_kind(e) /= quad8_reduced) cycle
            if (mesh%element_plane(e) == axisymmetric) cycle
            words = body_name(model, body)//' has a single element, '// &
               to_text(mesh%element_number(e))//', with reduced integration, which can deform '// &
               'without stress (hourglass mode): take CPE8 in place of CPE8R, or CPS8 in place '// &
               'of CPS8R, or a finer mesh'
            return
         end do
      end associate
   end function weakness_of_bodies

end module weak_bodies
