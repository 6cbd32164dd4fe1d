!> Heat that strains take up, the term T0 beta:eps' of (1.2), beside the capacity rho c_p of the
!> bodies: with C_e = rho c_p - T0 beta:alpha, the capacity at constant strain,
!>
!>    C_e T' + T0 beta:eps' = rho c_p T' + (T0 B^T u - C_alpha T)',
!>
!> where B are the nodal forces of nodal temperatures and C_alpha has the coefficient T0 beta:alpha.
!> A body that expands freely takes up nothing. T0 is the initial temperature from absolute zero.
module dilatation
   use kinds, only: dp
   use materials, only: expansion_heat
   use model, only: model_type
   use sparse_matrix, only: sparse_matrix_type
   use thermal_matrix, only: assemble_capacity
   implicit none
   private
   public :: dilatation_type

   !> The operators of the term.
   type :: dilatation_type
      real(dp), allocatable :: absolute(:)          !! (nodes) T0 from absolute zero [temperature]
      type(sparse_matrix_type) :: expansion         !! (nodes, nodes) C_alpha/T0
   contains
      procedure :: prepare
      procedure :: taken_up
      procedure :: of_strains
   end type dilatation_type

contains

   !> Assembles the operators.
   pure subroutine prepare(self, model)
      class(dilatation_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer :: e

      self%absolute = model%initial_temperature - model%constants%absolute_zero
      associate (mesh => model%mesh)
         self%expansion = assemble_capacity(mesh, model%sections, [(expansion_heat( &
            model%materials(model%sections(mesh%element_section(e))%material), &
            mesh%element_plane(e)), e=1, size(mesh%element_plane))])
      end associate
   end subroutine prepare

   !> T0 B^T u - C_alpha T: heat that bodies have taken up beside rho c_p T.
   pure function taken_up(self, thermal_load, displacement, temperature) result(heat)
      class(dilatation_type), intent(in) :: self
      type(sparse_matrix_type), intent(in) :: thermal_load   !! B [force/temperature]
      real(dp), intent(in) :: displacement(:)                !! (2 nodes) [length]
      real(dp), intent(in) :: temperature(:)                 !! (nodes) [temperature]
      real(dp) :: heat(size(temperature))                    !! (nodes) [energy]

      heat = self%of_strains(thermal_load, displacement) - &
         self%absolute*self%expansion%multiply(temperature)
   end function taken_up

   !> T0 B^T u of it.
   pure function of_strains(self, thermal_load, displacement) result(heat)
      class(dilatation_type), intent(in) :: self
      type(sparse_matrix_type), intent(in) :: thermal_load   !! B [force/temperature]
      real(dp), intent(in) :: displacement(:)                !! (2 nodes) [length]
      real(dp) :: heat(size(self%absolute))                  !! (nodes) [energy]

      heat = self%absolute*thermal_load%multiply_transposed(displacement)
   end function of_strains

end module dilatation
