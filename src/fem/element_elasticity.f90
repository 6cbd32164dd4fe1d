!> Plane-strain thermoelasticity in one eight-node element, eq. (1.5) for an isotropic body.
!> Degrees of freedom are ordered u_x, u_y of node 1, u_x, u_y of node 2, ...
module element_elasticity
   use element_kinds, only: quad8
   use kinds, only: dp
   use quadrature, only: integration_rule
   use shape_functions, only: element_gradients, element_shape
   implicit none
   private
   public :: elastic_matrix, thermal_modulus, element_stiffness, element_thermal_load
   public :: stress_at

contains

   !> E of (1.5) in plane strain: (sigma_xx, sigma_yy, sigma_xy) from (eps_xx, eps_yy, gamma_xy).
   pure function elastic_matrix(young, poisson) result(e)
      real(dp), intent(in) :: young     !! E [stress]
      real(dp), intent(in) :: poisson   !! nu [-]
      real(dp) :: e(3, 3)               !! [stress]
      real(dp) :: lambda, shear

      lambda = young*poisson/((1 + poisson)*(1 - 2*poisson))
      shear = young/(2*(1 + poisson))
      e = 0.0_dp
      e(1, 1) = lambda + 2*shear
      e(2, 2) = e(1, 1)
      e(1, 2) = lambda
      e(2, 1) = lambda
      e(3, 3) = shear
   end function elastic_matrix

   !> beta = E:alpha of (1.1), the in-plane stress that holds back a unit temperature.
   pure function thermal_modulus(young, poisson, expansion) result(beta)
      real(dp), intent(in) :: young       !! E [stress]
      real(dp), intent(in) :: poisson     !! nu [-]
      real(dp), intent(in) :: expansion   !! alpha [1/temperature]
      real(dp) :: beta                    !! [stress/temperature]

      beta = young*expansion/(1 - 2*poisson)
   end function thermal_modulus

   !> Stiffness matrix, the element's part of K^n in (2.4): integral of B^T E B.
   pure function element_stiffness(coordinates, e, thickness) result(k)
      real(dp), intent(in) :: coordinates(2, 8)   !! nodes [length]
      real(dp), intent(in) :: e(3, 3)             !! from elastic_matrix [stress]
      real(dp), intent(in) :: thickness           !! thickness [length]
      real(dp) :: k(16, 16)                       !! [stress length]
      real(dp) :: points(2, 9), weights(9), gradients(2, 8), b(3, 16), jacobian
      integer :: g

      call integration_rule(quad8, points, weights)
      k = 0.0_dp
      do g = 1, 9
         call element_gradients(quad8, coordinates, points(:, g), gradients, jacobian)
         b = strain_matrix(gradients)
         k = k + weights(g)*jacobian*thickness*matmul(transpose(b), matmul(e, b))
      end do
   end function element_stiffness

   !> Nodal forces of a temperature increment, per unit nodal temperature: integral of B^T beta
   !> psi^q.
   pure function element_thermal_load(coordinates, beta, thickness) result(load)
      real(dp), intent(in) :: coordinates(2, 8)   !! nodes [length]
      real(dp), intent(in) :: beta                !! from thermal_modulus [stress/temperature]
      real(dp), intent(in) :: thickness           !! thickness [length]
      real(dp) :: load(16, 8)                     !! [stress length^2/temperature]
      real(dp) :: points(2, 9), weights(9), gradients(2, 8), psi(8), jacobian
      integer :: g, q

      call integration_rule(quad8, points, weights)
      load = 0.0_dp
      do g = 1, 9
         call element_gradients(quad8, coordinates, points(:, g), gradients, jacobian)
         psi = element_shape(quad8, points(:, g))
         do q = 1, 8
            load(:, q) = load(:, q) + weights(g)*jacobian*thickness*beta*psi(q) &
               *reshape(gradients, [16])
         end do
      end do
   end function element_thermal_load

   !> Stress at a point of an element, eq. (1.5): sigma = E eps - beta T, and sigma_zz of plane
   !> strain.
   pure function stress_at(coordinates, point, e, beta, displacement, temperature) result(stress)
      real(dp), intent(in) :: coordinates(2, 8)    !! nodes [length]
      real(dp), intent(in) :: point(2)             !! xi, eta
      real(dp), intent(in) :: e(3, 3)              !! from elastic_matrix [stress]
      real(dp), intent(in) :: beta                 !! from thermal_modulus [stress/temperature]
      real(dp), intent(in) :: displacement(2, 8)   !! at the nodes [length]
      real(dp), intent(in) :: temperature(8)       !! increment over the natural state [temperature]
      real(dp) :: stress(4)                        !! xx, yy, zz, xy [stress]
      real(dp) :: gradients(2, 8), strain(3), jacobian, thermal

      call element_gradients(quad8, coordinates, point, gradients, jacobian)
      strain = matmul(strain_matrix(gradients), reshape(displacement, [16]))
      thermal = beta*dot_product(element_shape(quad8, point), temperature)
      stress([1, 2, 4]) = matmul(e, strain) - [thermal, thermal, 0.0_dp]
      stress(3) = e(1, 2)*(strain(1) + strain(2)) - thermal
   end function stress_at

   !> B: (eps_xx, eps_yy, gamma_xy) from the nodal displacements.
   pure function strain_matrix(gradients) result(b)
      real(dp), intent(in) :: gradients(2, 8)
      real(dp) :: b(3, 16)

      b = 0.0_dp
      b(1, 1::2) = gradients(1, :)
      b(2, 2::2) = gradients(2, :)
      b(3, 1::2) = gradients(2, :)
      b(3, 2::2) = gradients(1, :)
   end function strain_matrix

end module element_elasticity
