!> The laws of all contact points in a step, made when it begins.
module contact_laws
   use conductance_laws, only: conductance_law_type
   use contact_definitions, only: is_removed, latest_friction
   use friction_laws, only: friction_law_type, unlimited
   use kinds, only: dp
   use model, only: model_type
   use temperature_laws, only: face_temperatures_type, law_at
   implicit none
   private
   public :: contact_laws_type, laws_of_step

   !> The laws of the contact points of all interfaces.
   type :: contact_laws_type
      type(conductance_law_type), allocatable :: conductance(:)    !! (m) as the deck has them
      type(friction_law_type), allocatable :: friction(:)          !! (m) of tractions
      !> (m) the same of nodal forces, with the largest one for a shear; unlimited at contact points
      !> of weight 0, over which no traction acts
      type(friction_law_type), allocatable :: nodal_friction(:)
      !> (m) whether the interface is removed: its contact points are open whatever their gaps, and
      !> have neither friction nor conductance
      logical, allocatable :: removed(:)
   contains
      procedure :: conductance_at
   end type contact_laws_type

contains

   !> The laws of a step.
   pure function laws_of_step(model, interface_start, weight, step) result(laws)
      type(model_type), intent(in) :: model
      integer, intent(in) :: interface_start(:)    !! (interfaces + 1) first contact point of each
      real(dp), intent(in) :: weight(:)            !! (m) tributary areas [length^2]
      integer, intent(in) :: step                  !! index of the step
      type(contact_laws_type) :: laws
      integer :: i

      allocate (laws%conductance(size(weight)), laws%friction(size(weight)))
      allocate (laws%removed(size(weight)), source=.false.)
      do i = 1, size(model%contacts)
         associate (first => interface_start(i), last => interface_start(i + 1) - 1, &
            interaction => model%interactions(model%contacts(i)%interaction))
            laws%removed(first:last) = is_removed(model%steps(:step)%changes, i)
            if (any(laws%removed(first:last))) cycle
            laws%conductance(first:last) = interaction%law
            laws%friction(first:last) = latest_friction(model%steps(:step)%changes, &
               model%contacts(i)%interaction, interaction%friction)
         end associate
      end do
      laws%nodal_friction = laws%friction
      laws%nodal_friction%largest_shear = unlimited
      where (laws%friction%largest_shear < unlimited .and. weight > 0.0_dp) &
         laws%nodal_friction%largest_shear = laws%friction%largest_shear*weight
   end function laws_of_step

   !> The conductance laws with the values that they have at temperatures of the faces.
   pure function conductance_at(self, mean, jump) result(laws)
      class(contact_laws_type), intent(in) :: self
      real(dp), intent(in) :: mean(:)                           !! (m) (T_xi + T_eta)/2
      real(dp), intent(in) :: jump(:)                           !! (m) T_xi - T_eta
      type(conductance_law_type), allocatable :: laws(:)        !! (m)
      integer :: k

      allocate (laws(size(jump)))
      do k = 1, size(jump)
         laws(k) = law_at(self%conductance(k), face_temperatures_type(mean(k), jump(k)))
      end do
   end function conductance_at

end module contact_laws
