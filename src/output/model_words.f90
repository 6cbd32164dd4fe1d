!> Materials, surface interactions and pairings in words, as they were understood.
module model_words
   use conductance_laws, only: conductance_law_type, conductance_table_type, law_clearance, &
      law_gas, law_power, law_pressure
   use contact_definitions, only: pairing_by_faces, pairing_name, pairing_nodes
   use contact_points, only: contact_points_type
   use kinds, only: dp
   use element_kinds, only: axisymmetric, generalized_strain, plane_strain, plane_stress
   use friction_laws, only: friction_heat_type, friction_law_type, rough_coefficient, unlimited
   use materials, only: follows_temperature, material_type, melts, of_expansion, thermal_strain
   use model, only: model_type
   use overlap_laws, only: overlap_law_type
   use steps, only: analysis_heat, analysis_static
   use text, only: append, counted, string_type, to_text
   use wear_laws, only: wear_law_type
   implicit none
   private
   public :: expansion_words, law_words, material_words, friction_words, friction_heat_words, &
      overlap_words, wear_words, open_law_words, closed_law_words, open_words, pairing_words, &
      points_words, section_words, step_words, from_to, has_many, first_alike, alike_words

   integer, parameter :: most_told = 10   !! interfaces, bodies or sections that are told one by one

contains

   !> The sections of a model: material, plane, thickness, one line each.
   pure function section_words(model) result(lines)
      type(model_type), intent(in) :: model
      type(string_type), allocatable :: lines(:)
      character(:), allocatable :: words
      integer :: i, elements, plane

      allocate (lines(0))
      do i = 1, size(model%sections)
         associate (section => model%sections(i), mesh => model%mesh)
            do plane = plane_strain, generalized_strain
               elements = count(mesh%element_section == i .and. mesh%element_plane == plane)
               if (elements == 0) cycle
               select case (plane)
               case (axisymmetric)
                  words = 'axisymmetric, full circumference'
               case (plane_stress)
                  words = 'plane stress, thickness '//to_text(section%thickness)
               case (generalized_strain)
                  words = 'generalized plane strain of node '//to_text(mesh%node_number( &
                     section%reference(1)))//', thickness '//to_text(section%thickness)
               case default
                  words = 'plane strain, thickness '//to_text(section%thickness)
               end select
               call append(lines, 'material '//model%materials(section%material)%name//', '// &
                  words//', '//counted(elements, 'element'))
            end do
         end associate
      end do
   end function section_words

   !> Analysis and scheme of (3.4) of every step, equal steps together: which steps, then their
   !> words, in turn.
   pure function step_words(model) result(lines)
      type(model_type), intent(in) :: model
      type(string_type), allocatable :: lines(:)
      character(:), allocatable :: words, range
      integer :: first, i

      allocate (lines(0))
      first = 1
      do i = 1, size(model%steps)
         words = analysis_of(i)
         if (i < size(model%steps)) then
            if (analysis_of(i + 1) == words) cycle
         end if
         range = 'step '//to_text(first)
         if (i > first) range = 'steps '//to_text(first)//' to '//to_text(i)
         call append(lines, range)
         call append(lines, words)
         first = i + 1
      end do
   contains
      pure function analysis_of(number) result(analysis)
         integer, intent(in) :: number
         character(:), allocatable :: analysis

         associate (step => model%steps(number))
            select case (step%analysis)
            case (analysis_static)
               analysis = 'mechanics'
               if (.not. step%is_viscous) return
               analysis = 'mechanics in real time'
            case (analysis_heat)
               analysis = 'heat'
            case default
               analysis = 'heat and mechanics'
            end select
            if (step%is_transient) analysis = analysis//', transient'
            analysis = analysis//', scheme '//trim(step%scheme%name)
         end associate
      end function analysis_of
   end function step_words

   !> The ends of a range.
   pure function from_to(ends) result(words)
      real(dp), intent(in) :: ends(2)
      character(:), allocatable :: words

      words = to_text(ends(1))//' to '//to_text(ends(2))
   end function from_to

   !> Kind of the contact points, in the plural.
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
      if (points%is_rigid .and. points%pairing == pairing_nodes) then
         words = words//' of the slave alone: the master is a rigid drawing'
      else if (asked /= pairing_by_faces) then
         return
      else if (points%is_rigid) then
         words = words//', because the master is a rigid drawing without nodes to pair'
      else if (points%follows_sliding) then
         words = words//', because SLIDING=FINITE moves the faces along each other'
      else if (allocated(points%mismatch)) then
         words = words//', because the faces do not match: '//points%mismatch
      else if (points%pairing == pairing_nodes) then
         words = words//', because the faces match'
      end if
   end function pairing_words

   !> Corners of the slave that no master is opposite to; empty for none.
   pure function open_words(points) result(words)
      type(contact_points_type), intent(in) :: points    !! contact points of the interface
      character(:), allocatable :: words

      words = ''
      if (.not. allocated(points%is_open_corner)) return
      if (.not. any(points%is_open_corner)) return
      words = to_text(count(points%is_open_corner))//' of '//to_text( &
         size(points%is_open_corner))//' slave corners have no master opposite and stay open'
   end function open_words

   !> Whether interfaces, bodies or sections are too many to be told one by one.
   pure logical function has_many(parts)
      integer, intent(in) :: parts      !! number of them

      has_many = parts > most_told
   end function has_many

   !> The first interface, or section, with each description; of a few each has its own.
   pure function first_alike(texts) result(first)
      type(string_type), intent(in) :: texts(:)    !! descriptions of all
      integer :: first(size(texts)), i, k

      do i = 1, size(texts)
         first(i) = i
         if (.not. has_many(size(texts))) cycle
         do k = 1, i - 1
            if (first(k) == k .and. texts(k)%value == texts(i)%value) exit
         end do
         first(i) = k
      end do
   end function first_alike

   !> How many further ones have the description of one.
   pure function alike_words(first, i) result(words)
      integer, intent(in) :: first(:)              !! of first_alike
      integer, intent(in) :: i                     !! which one
      character(:), allocatable :: words           !! such as ' and 19 more like it', or nothing

      words = ''
      if (count(first == i) > 1) words = ' and '//to_text(count(first == i) - 1)//' more like it'
   end function alike_words

   !> The constants of a material.
   pure function material_words(material) result(words)
      type(material_type), intent(in) :: material
      character(:), allocatable :: words            !! such as Young's modulus 2E5, ...
      integer :: i, k, row

      words = ''
      if (allocated(material%given)) then
         do i = 1, size(material%given)
            associate (property => material%given(i))
               do k = 1, size(property%names)
                  if (words /= '') words = words//', '
                  words = words//trim(property%names(k))//' '//to_text(property%values(k, 1))
                  do row = 2, size(property%temperature)
                     if (row == 2) words = words//' at '//to_text(property%temperature(1))
                     words = words//', '//to_text(property%values(k, row))//' at '// &
                        to_text(property%temperature(row))
                  end do
               end do
            end associate
         end do
      end if
      if (words == '') words = 'no constants'
   end function material_words

   !> Plasticity, creep, annealing and melting of a material; empty without them. Creep is told as
   !> the strain that a five-hundredth of the shear modulus G makes in a time of 1, which shows
   !> wrong units.
   pure function law_words(material) result(words)
      type(material_type), intent(in) :: material
      character(:), allocatable :: words
      real(dp) :: slope, strain, stress, temperature
      integer :: n

      words = ''
      associate (hardening => material%law%hardening, creep => material%law%creep)
         if (hardening%yields()) then
            associate (table => hardening%yield)
               n = size(table%temperature)
               words = 'yields at '//to_text(table%stress(1))
               if (n > 1) words = words//' at temperature '//to_text(table%temperature(1))//', '// &
                  to_text(table%stress(table%first(n)))//' at '//to_text(table%temperature(n))
               n = size(table%stress)
               if (table%strain(n) > 0.0_dp) words = words//', last row '// &
                  to_text(table%stress(n))//' at plastic strain '//to_text(table%strain(n))
               if (hardening%has_back_stress()) words = words//', back stress with C '// &
                  to_text(hardening%back(1, 1))//' and gamma '//to_text(hardening%back(2, 1))
            end associate
         end if
         if (creep%creeps()) then
            if (words /= '') words = words//'; '
            temperature = creep%temperature(1)
            slope = 0.0_dp
            stress = material%elasticity(4, 4)/500
            call creep%find_strain(stress, temperature, 0.0_dp, [0.0_dp, 1.0_dp], strain, slope)
            words = words//'creeps by '//to_text(strain)//' in a time of 1 under '// &
               to_text(stress)//' (G/500)'
            if (size(creep%temperature) > 1) words = words//' at temperature '//to_text(temperature)
         end if
      end associate
      if (material%law%annealing > 0) then
         if (words /= '') words = words//'; '
         words = words//'carries no stress above temperature '// &
            to_text(material%law%anneal_temperature)
      end if
      if (.not. melts(material)) return
      if (words /= '') words = words//'; '
      words = words//'melts from '//to_text(material%melting(1)%solidus)//' to '// &
         to_text(material%melting(size(material%melting))%liquidus)//' with '// &
         to_text(sum(material%melting%content))//' a volume'
   end function law_words

   !> What a table of expansion coefficients means: strains at its ends from the initial temperature
   !> of the material's first element on; empty without a table.
   pure function expansion_words(model, m) result(words)
      type(model_type), intent(in) :: model
      integer, intent(in) :: m                      !! which material
      character(:), allocatable :: words            !! such as strain -2E-4 at 0, 5E-3 at 500
      real(dp) :: initial, slope(3), strain(3)
      integer :: e, i, row

      words = ''
      e = findloc(model%sections(model%mesh%element_section)%material, m, dim=1)
      if (e == 0) return
      associate (material => model%materials(m))
         if (.not. follows_temperature(material, of_expansion)) return
         i = findloc(material%given%kind, of_expansion, dim=1)
         initial = model%initial_temperature(model%mesh%element_nodes(1, e))
         associate (rows => material%given(i)%temperature)
            words = 'along axis 1 from '//to_text(initial)//' on'
            do row = 1, size(rows), size(rows) - 1
               call thermal_strain(material, initial, rows(row), strain, slope)
               words = words//', '//to_text(strain(1))//' to '//to_text(rows(row))
            end do
         end associate
      end associate
   end function expansion_words

   !> A law of friction.
   pure function friction_words(friction) result(words)
      type(friction_law_type), intent(in) :: friction
      character(:), allocatable :: words   !! such as 0.155, no shear above 20

      words = 'none'
      if (friction%coefficient > 0.0_dp) words = to_text(friction%coefficient)
      if (friction%coefficient >= rough_coefficient) words = 'rough, no slip'
      if (friction%largest_shear < unlimited) words = words//', no shear above '// &
         to_text(friction%largest_shear)
   end function friction_words

   !> The pressure of soft faces.
   pure function overlap_words(law) result(words)
      type(overlap_law_type), intent(in) :: law
      character(:), allocatable :: words   !! such as 0 at 0, 100 at 0.01 over the overlap

      if (allocated(law%overlap)) then
         words = table_words(law%pressure, law%overlap)//' over the overlap'
      else
         words = to_text(law%touching_pressure)//' at the touch, a hundredth of it at gap '// &
            to_text(law%clearance)//', exponential'
      end if
   end function overlap_words

   !> The wear of faces.
   pure function wear_words(law) result(words)
      type(wear_law_type), intent(in) :: law
      character(:), allocatable :: words   !! such as 1E-8 per pressure and slip, 1 on the slave

      if (size(law%rate) == 1) then
         words = to_text(law%rate(1))
      else
         words = table_words(law%rate, law%temperature)//' over the temperature'
      end if
      words = words//' per pressure and slip, '//to_text(law%slave_share)//' on the slave'
   end function wear_words

   !> The heat of friction.
   pure function friction_heat_words(heat) result(words)
      type(friction_heat_type), intent(in) :: heat
      character(:), allocatable :: words   !! such as 0.9 of the work of slip, 0.5 on the slave

      words = 'none'
      if (heat%efficiency <= 0.0_dp) return
      words = to_text(heat%efficiency)//' of the work of '
      if (heat%angular_velocity > 0.0_dp) then
         words = words//'turning about the axis with '//to_text(heat%angular_velocity)
      else if (heat%speed >= 0.0_dp) then
         words = words//'sliding out of the plane with '//to_text(heat%speed)
      else
         words = words//'slip'
      end if
      words = words//', '//to_text(heat%slave_share)//' of it on the slave'
   end function friction_heat_words

   !> The open side of a law.
   pure function open_law_words(law) result(words)
      type(conductance_law_type), intent(in) :: law
      character(:), allocatable :: words              !! such as A/(B + gap), A = 1, B = 1E-3

      select case (law%open_kind)
      case (law_gas)
         words = gas_words(law)
      case (law_clearance)
         words = 'table over the gap: '//conductance_words(law%open_table)
         if (law%open_ends) words = words//', 0 beyond'
         words = words//radiation_words(law)
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
         if (law%closed_adds) words = 'C1 p^n, C1 = '//to_text(law%power_c1)//', n = '// &
            to_text(law%power_n)//', added to the open value at gap 0'
      case (law_pressure)
         words = 'table over the pressure: '//conductance_words(law%closed_table)
      case default
         words = 'not given'
      end select
   end function closed_law_words

   !> The law of a gas, with what is added to it.
   pure function gas_words(law) result(words)
      type(conductance_law_type), intent(in) :: law
      character(:), allocatable :: words
      integer :: i

      if (law%added_length > 0.0_dp) then
         words = 'A/(B + '//to_text(law%added_length)//' + gap)'
      else
         words = 'A/(B + gap)'
      end if
      associate (rows => law%by_temperature)
         words = words//radiation_words(law)//constants(law%gas_a, law%gas_b)
         if (.not. allocated(rows%gas_temperature)) return
         words = words//' at mean temperature '//to_text(rows%gas_temperature(1))
         do i = 2, size(rows%gas_temperature)
            words = words//constants(rows%gas_a(i), rows%gas_b(i))//' at '// &
               to_text(rows%gas_temperature(i))
         end do
      end associate
   contains
      pure function constants(a, b) result(words)
         real(dp), intent(in) :: a, b
         character(:), allocatable :: words

         words = ', A = '//to_text(a)//', B = '//to_text(b)
      end function constants
   end function gas_words

   !> What radiation adds to the conductance of a gap; empty for none.
   pure function radiation_words(law) result(words)
      type(conductance_law_type), intent(in) :: law
      character(:), allocatable :: words

      words = ''
      associate (rows => law%by_temperature)
         if (rows%radiance <= 0.0_dp) return
         words = ' + '//to_text(rows%radiance)//' (T1^2 + T2^2) (T1 + T2)'
         if (allocated(law%view_gap)) words = words//' times the view factor over the gap: '// &
            table_words(law%view_factor, law%view_gap)
         words = words//', absolute zero '//to_text(rows%absolute_zero)
      end associate
   end function radiation_words

   !> A table, at each of its temperatures where it has several.
   pure function conductance_words(table) result(words)
      type(conductance_table_type), intent(in) :: table
      character(:), allocatable :: words
      integer :: i

      words = table_words(table%omega, table%abscissa)
      if (.not. allocated(table%temperature)) return
      words = words//' at mean temperature '//to_text(table%temperature(1))
      do i = 2, size(table%temperature)
         words = words//'; '//table_words(table%columns(:, i), table%abscissa)//' at '// &
            to_text(table%temperature(i))
      end do
   end function conductance_words

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
