!> Materials, surface interactions and pairings in words, as they were understood.
module model_words
   use conductance_laws, only: conductance_law_type, law_clearance, law_gas, law_power, law_pressure
   use contact_definitions, only: pairing_by_faces, pairing_name, pairing_nodes
   use contact_points, only: contact_points_type
   use kinds, only: dp
   use materials, only: constant_type, material_type
   use text, only: to_text
   implicit none
   private
   public :: material_words, friction_words, open_law_words, closed_law_words
   public :: open_words, pairing_words, points_words

contains

   !> What contact points are.
   pure function points_words(points) result(words)
      type(contact_points_type), intent(in) :: points    !! contact points of the interface
      character(:), allocatable :: words

      words = trim(merge('node pairs    ', 'contact points', points%pairing == pairing_nodes))
   end function points_words

   !> The pairing of an interface and, where the deck does not ask for one, why.
   pure function pairing_words(asked, points) result(words)
      integer, intent(in) :: asked                       !! what the deck asks for
      type(contact_points_type), intent(in) :: points    !! contact points of the interface
      character(:), allocatable :: words

      words = pairing_name(points%pairing)
      if (asked /= pairing_by_faces) return
      if (allocated(points%mismatch)) then
         words = words//', because the faces do not match: '//points%mismatch
      else
         words = words//', because the faces match'
      end if
   end function pairing_words

   !> What the master leaves open of the slave; empty for nothing.
   pure function open_words(points) result(words)
      type(contact_points_type), intent(in) :: points    !! contact points of the interface
      character(:), allocatable :: words

      words = ''
      if (points%open_corners == 0) return
      words = to_text(points%open_corners)//' of '//to_text(points%corners)// &
         ' slave corners have no master opposite and stay open'
   end function open_words

   !> The constants of a material.
   pure function material_words(material) result(words)
      type(material_type), intent(in) :: material
      character(:), allocatable :: words            !! such as Young's modulus 2E5, ...
      integer :: i

      words = 'no constants'
      if (.not. allocated(material%constants)) return
      if (size(material%constants) == 0) return
      words = constant_words(material%constants(1))
      do i = 2, size(material%constants)
         words = words//', '//constant_words(material%constants(i))
      end do
   end function material_words

   pure function constant_words(constant) result(words)
      type(constant_type), intent(in) :: constant
      character(:), allocatable :: words

      words = trim(constant%name)//' '//to_text(constant%value)
   end function constant_words

   !> A coefficient of friction.
   pure function friction_words(friction) result(words)
      real(dp), intent(in) :: friction     !! coefficient of friction, 0 for none
      character(:), allocatable :: words   !! such as 0.155

      words = 'none'
      if (friction > 0.0_dp) words = to_text(friction)
   end function friction_words

   !> The open side of a law.
   pure function open_law_words(law) result(words)
      type(conductance_law_type), intent(in) :: law
      character(:), allocatable :: words              !! such as A/(B + gap), A = 1, B = 1E-3

      select case (law%open_kind)
      case (law_gas)
         words = 'A/(B + gap), A = '//to_text(law%gas_a)//', B = '//to_text(law%gas_b)
      case (law_clearance)
         words = 'table over the gap: '//table_words(law%open_omega, law%table_gap)
         if (law%open_ends) words = words//', 0 beyond'
      case default
         words = 'not given'
      end select
   end function open_law_words

   !> The closed side of a law.
   pure function closed_law_words(law) result(words)
      type(conductance_law_type), intent(in) :: law
      character(:), allocatable :: words              !! such as C0 + C1 p^n, C0 = 1, C1 = 2, n = 1

      select case (law%closed_kind)
      case (law_power)
         words = 'C0 + C1 p^n, C0 = '//to_text(law%power_c0)//', C1 = '//to_text(law%power_c1)// &
            ', n = '//to_text(law%power_n)
      case (law_pressure)
         words = 'table over the pressure: '//table_words(law%closed_omega, law%table_pressure)
      case default
         words = 'not given'
      end select
   end function closed_law_words

   pure function table_words(omega, abscissas) result(words)
      real(dp), intent(in) :: omega(:), abscissas(:)
      character(:), allocatable :: words
      integer :: i

      words = to_text(omega(1))//' at '//to_text(abscissas(1))
      do i = 2, size(omega)
         words = words//', '//to_text(omega(i))//' at '//to_text(abscissas(i))
      end do
   end function table_words

end module model_words
