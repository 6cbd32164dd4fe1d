!> The thermal matrices of (3.3) and the stepping scheme (3.4).
!>
!> The unknown of a contact point is its jump theta = T_xi - T_eta, not two temperatures whose
!> difference a large omega would swallow. G(omega), lumped on the contact points, then is the
!> diagonal weight*omega of the jumps: positive semidefinite for any omega >= 0 and exact however
!> large. Scheme (3.4), divided by a1, reads
!>
!>    (K + diag(d)) T_i+1 = rhs,   d = weight (a2 omega_i + a3 omega_i+1)/a1,
!>    rhs = -(b1 K T_i + weight (b2 omega_i + b3 omega_i+1) theta_i - c1 Q_i - c2 Q_i+1)/a1,
!>
!> the terms with weight standing in the rows of the jumps only.
module thermal_matrix
   use controls, only: thermal_scheme_type
   use element_assembly, only: element_assembly_type
   use element_conduction, only: conduction_matrix
   use element_kinds, only: element_node_count
   use kinds, only: dp
   use materials, only: material_type, section_type
   use mesh, only: mesh_type
   use orientations, only: orientation_type
   use point_properties, only: axes_at_points, conductivity_in
   use quadrature, only: most_points
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: assemble_conduction, contact_diagonal, contact_history, field_history, scheme_load

contains

   !> K of (3.3), both triangles.
   pure function assemble_conduction(mesh, sections, materials, orientations) result(conduction)
      type(mesh_type), intent(in) :: mesh
      type(section_type), intent(in) :: sections(:)
      type(material_type), intent(in) :: materials(:)
      type(orientation_type), intent(in) :: orientations(:)  !! axes of the materials
      type(sparse_matrix_type) :: conduction                 !! (nodes, nodes) [power/temperature]
      type(element_assembly_type) :: assembly
      real(dp), allocatable :: axes(:, :, :), k(:, :)
      real(dp) :: conductivity(2, 2, most_points)
      integer :: element, g

      call assembly%begin(mesh, 1, 1)
      do element = 1, size(mesh%element_number)
         associate (kind => mesh%element_kind(element), plane => mesh%element_plane(element), &
            section => sections(mesh%element_section(element)), &
            nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(element)), element))
            axes = axes_at_points(kind, mesh%coordinates(:, nodes), orientations, &
               section%orientation)
            do g = 1, size(axes, 3)
               conductivity(:, :, g) = conductivity_in(materials(section%material), axes(:, :, g))
            end do
            k = conduction_matrix(kind, plane, mesh%coordinates(:, nodes), &
               conductivity(:, :, :size(axes, 3)), section%thickness)
            call assembly%add(nodes, k)
         end associate
      end do
      conduction = assembly%matrix
   end function assemble_conduction

   !> Diagonal of the jumps in (a1 K + a2 G_i + a3 G_i+1)/a1.
   pure function contact_diagonal(scheme, weight, omega_old, omega_new) result(diagonal)
      type(thermal_scheme_type), intent(in) :: scheme !! coefficients of (3.4)
      real(dp), intent(in) :: weight(:)               !! (m) tributary areas [length^2]
      real(dp), intent(in) :: omega_old(:)            !! (m) omega_i
      real(dp), intent(in) :: omega_new(:)            !! (m) omega_i+1
      real(dp) :: diagonal(size(weight))              !! (m) [power/temperature]

      diagonal = weight*(scheme%a(2)*omega_old + scheme%a(3)*omega_new)/scheme%a(1)
   end function contact_diagonal

   !> Part of -(b2 G_i + b3 G_i+1) T_i/a1 in the rows of the jumps.
   pure function contact_history(scheme, weight, omega_old, omega_new, jump_old) result(rhs)
      type(thermal_scheme_type), intent(in) :: scheme !! coefficients of (3.4)
      real(dp), intent(in) :: weight(:)               !! (m) tributary areas [length^2]
      real(dp), intent(in) :: omega_old(:)            !! (m) omega_i
      real(dp), intent(in) :: omega_new(:)            !! (m) omega_i+1
      real(dp), intent(in) :: jump_old(:)             !! (m) theta_i [temperature]
      real(dp) :: rhs(size(weight))                   !! (m) [power]

      rhs = -weight*(scheme%b(2)*omega_old + scheme%b(3)*omega_new)*jump_old/scheme%a(1)
   end function contact_history

   !> Part -b1 K T_i/a1 of the right-hand side.
   pure function field_history(scheme, conduction, temperature_old) result(rhs)
      type(thermal_scheme_type), intent(in) :: scheme      !! coefficients of (3.4)
      type(sparse_matrix_type), intent(in) :: conduction   !! K
      real(dp), intent(in) :: temperature_old(:)           !! (nodes) T_i [temperature]
      real(dp) :: rhs(size(temperature_old))               !! (nodes) [power]

      if (abs(scheme%b(1)) > 0.0_dp) then
         rhs = -scheme%b(1)/scheme%a(1)*conduction%multiply(temperature_old)
      else
         rhs = 0.0_dp
      end if
   end function field_history

   !> Part (c1 Q_i + c2 Q_i+1)/a1 of the right-hand side.
   pure function scheme_load(scheme, load_old, load_new) result(rhs)
      type(thermal_scheme_type), intent(in) :: scheme !! coefficients of (3.4)
      real(dp), intent(in) :: load_old(:)             !! (nodes) Q_i [power]
      real(dp), intent(in) :: load_new(:)             !! (nodes) Q_i+1 [power]
      real(dp) :: rhs(size(load_new))                 !! (nodes) [power]

      rhs = (scheme%c(1)*load_old + scheme%c(2)*load_new)/scheme%a(1)
   end function scheme_load

end module thermal_matrix
