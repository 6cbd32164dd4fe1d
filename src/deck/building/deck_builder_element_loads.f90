!> Data cards of loads with a label: *DLOAD, *DFLUX and *FILM with an element, a set or a surface,
!> *DSLOAD, *DSFLUX and *SFILM with a surface; GRAV and CENTRIF act on the mass of elements.
module deck_builder_element_loads
   use card_values, only: read_field, read_row
   use cards, only: data_card_type
   use deck_builder_rigid, only: need_faces
   use deck_builder_sets, only: check_face
   use deck_context, only: deck_type
   use element_kinds, only: axisymmetric, side_nodes
   use kinds, only: dp
   use load_requests, only: request_type
   use spelling, only: known_choices
   use steps, only: centrifugal_round, load_body_force, load_body_heat, load_centrifugal, &
      load_face_heat, load_film_coefficient, load_film_sink, load_gravity, load_pressure, &
      load_traction
   use text, only: split_words, to_text, to_upper
   implicit none
   private
   public :: build_element_load

   !> A label, and what it stands for.
   type :: label_type
      character(7) :: name        !! without the number of a side
      character(12) :: cards      !! that have it: of elements, of surfaces
      integer :: kind             !! load_pressure, ...
      integer :: component        !! of the load, R as X and Z as Y; 0 for a side of an element
      character(118) :: layout    !! fields behind it, as read_row
   end type label_type

   character(*), parameter :: vector_layout = 'magnitude/direction x/direction y/direction z?'

   type(label_type), parameter :: labels(12) = [ &
      label_type('P', 'DLOAD/DSLOAD', load_pressure, 0, 'pressure'), &
      label_type('TRVEC', 'DSLOAD', load_traction, 1, vector_layout), &
      label_type('TRSHR', 'DSLOAD', load_traction, 1, vector_layout), &
      label_type('BX', 'DLOAD', load_body_force, 1, 'force per volume'), &
      label_type('BY', 'DLOAD', load_body_force, 2, 'force per volume'), &
      label_type('BR', 'DLOAD', load_body_force, 1, 'force per volume'), &
      label_type('BZ', 'DLOAD', load_body_force, 2, 'force per volume'), &
      label_type('GRAV', 'DLOAD', load_gravity, 1, vector_layout), &
      label_type('CENTRIF', 'DLOAD', load_centrifugal, 1, 'speed squared >=0/x of the axis/'// &
      'y of the axis/z of the axis/direction x/direction y/direction z'), &
      label_type('S', 'DFLUX/DSFLUX', load_face_heat, 0, 'heat flux'), &
      label_type('BF', 'DFLUX', load_body_heat, 1, 'heat per volume'), &
      label_type('F', 'FILM/SFILM', load_film_sink, 0, 'sink temperature/film coefficient >0')]

   real(dp), parameter :: straight = 1.0e-6_dp   !! bow of a side, by its length

contains

   !> Takes one data card.
   subroutine build_element_load(keyword, data, request, film_amplitude, deck)
      character(*), intent(in) :: keyword                  !! DLOAD, DSLOAD, ...
      type(data_card_type), intent(in) :: data
      type(request_type), intent(inout) :: request         !! step, amplitude, card and place
      integer, intent(in) :: film_amplitude                !! amplitude of the film coefficient
      type(deck_type), intent(inout) :: deck               !! receives the requests
      type(label_type) :: load
      type(request_type) :: film
      character(:), allocatable :: label, names, target, what
      real(dp) :: values(9)
      integer :: surface
      logical :: known, of_surfaces, valid

      of_surfaces = any(keyword == ['DSLOAD', 'DSFLUX', 'SFILM '])
      known = .true.
      if (of_surfaces) then
         target = 'surface'
         call deck%need_item(data, 1, 'surface', target, surface)
         call need_faces(data%place(1), deck, surface)
         known = surface > 0
      else
         target = 'element or set'
         call find_surface(data, deck, surface)
         if (surface == 0) call deck%need_target('element', data, 1, request%target_type, known)
      end if
      names = names_of(keyword, of_surfaces)
      what = 'label of the load'
      if (of_surfaces) what = names
      call read_field(data, 2, what, deck, label, known)
      if (len(label) == 0) return
      label = to_upper(label)
      if (surface > 0 .and. .not. of_surfaces) then
         names = names(:1)
         ! As in CalculiX: a number in the label does not count.
         if (len(label) == 2 .and. scan(label(2:), '01234') > 0) label = label(:1)
      end if
      if (index('/'//names//'/', '/'//label//'/') == 0 .or. index(label, '/') > 0) then
         call deck%error(data%place(2), 'unknown load '//label//' of *'//keyword// &
            known_choices(label, split_words(names)))
         return
      end if
      load = labels(findloc(labels%name == label(:scan(label//'1', '1234') - 1), .true., dim=1))
      request%kind = load%kind
      request%component = load%component
      if (load%component == 0) request%component = index('1234', label(len(label):))
      if (surface == 0) call check_elements(data, label, request, deck, known)
      ! The coefficient of a *FILM PROPERTY, which is refused.
      if (load%kind == load_film_sink .and. deck%has_lost('film property', data%text(4))) return
      call read_row(data, '@'//target//'/@'//label//'/'//trim(load%layout), deck, values, valid)
      if (.not. (known .and. valid)) return
      request%value = values(3)
      select case (load%kind)
      case (load_traction, load_gravity)
         call add_vector(label, data, values(3:6), surface, request, deck)
      case (load_centrifugal)
         call add_rotation(data, values, request, deck)
      case (load_film_sink)
         film = request
         film%kind = load_film_coefficient
         film%amplitude = film_amplitude
         film%value = values(4)
         call add_load(film, surface, deck)
         call add_load(request, surface, deck)
      case default
         call add_load(request, surface, deck)
      end select
   end subroutine build_element_load

   !> The labels of a card, separated by slashes; with the sides of an element where it has some.
   pure function names_of(keyword, of_surfaces) result(names)
      character(*), intent(in) :: keyword
      logical, intent(in) :: of_surfaces
      character(:), allocatable :: names
      integer :: i, side

      names = ''
      do i = 1, size(labels)
         if (index('/'//trim(labels(i)%cards)//'/', '/'//keyword//'/') == 0) cycle
         if (of_surfaces .or. labels(i)%component > 0) then
            names = names//'/'//trim(labels(i)%name)
         else
            do side = 1, 4
               names = names//'/'//trim(labels(i)%name)//to_text(side)
            end do
         end if
      end do
      names = names(2:)
   end function names_of

   !> Index of the surface that a card names in place of an element or a set; else 0.
   subroutine find_surface(data, deck, surface)
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(inout) :: deck
      integer, intent(out) :: surface
      integer :: set

      surface = 0
      set = deck%index_of('element set', data%text(1))
      if (set > 0) then
         if (.not. deck%mesh%element_sets(set)%of_lines) return
      end if
      if (data%has(1)) surface = deck%index_of('surface', data%text(1))
      if (surface > 0) call deck%look_up('surface', data%text(1), data%place(1), surface)
   end subroutine find_surface

   !> Every element of the request has the side of a label, or the plane.
   subroutine check_elements(data, label, request, deck, valid)
      type(data_card_type), intent(in) :: data
      character(*), intent(in) :: label
      type(request_type), intent(in) :: request
      type(deck_type), intent(inout) :: deck
      logical, intent(inout) :: valid
      integer, allocatable :: elements(:)

      if (.not. valid) return
      elements = request%members(deck%mesh%element_sets)
      if (any(label == ['BR', 'BZ'])) then
         valid = all(deck%mesh%element_plane(elements) == axisymmetric)
         if (.not. valid) call deck%error(data%place(2), 'BR and BZ are forces on axisymmetric '// &
            'elements; those of a plane are BX and BY')
      end if
      if (scan(label, '1234') > 0) call check_face(data, elements, request%component, deck, valid)
   end subroutine check_elements

   !> Adds a load, of a surface to each of its faces.
   subroutine add_load(request, surface, deck)
      type(request_type), intent(in) :: request
      integer, intent(in) :: surface                       ! 0 for none
      type(deck_type), intent(inout) :: deck
      type(request_type) :: load
      integer :: i

      load = request
      if (surface == 0) then
         call deck%loads%add(load)
         return
      end if
      load%set = 0
      associate (faces => deck%mesh%surfaces(surface)%faces)
         do i = 1, size(faces, 2)
            load%item = faces(1, i)
            load%component = faces(2, i)
            if (load%kind == load_traction) load%component = 2*faces(2, i) - 2 + request%component
            call deck%loads%add(load)
         end do
      end associate
   end subroutine add_load

   !> Magnitude and direction; along x and along y the load is one of its own.
   subroutine add_vector(label, data, given, surface, request, deck)
      character(*), intent(in) :: label
      type(data_card_type), intent(in) :: data
      real(dp), intent(in) :: given(4)                     ! magnitude, direction x, y and z
      integer, intent(in) :: surface                       ! of tractions
      type(request_type), intent(inout) :: request         ! step, amplitude, card, elements
      type(deck_type), intent(inout) :: deck
      real(dp) :: vector(2)
      integer :: i

      vector = 0.0_dp
      if (abs(given(4)) > 0.0_dp .or. norm2(given(2:3)) <= 0.0_dp) then
         call deck%error(data%place(merge(6, 4, abs(given(4)) > 0.0_dp)), 'the direction lies '// &
            'in the plane and is not zero')
      else
         vector = given(1)*given(2:3)/norm2(given(2:3))
      end if
      if (label == 'TRSHR') then
         call add_shear(surface, vector, data, request, deck)
         return
      end if
      do i = 1, 2
         if (surface == 0 .and. abs(vector(i)) <= 0.0_dp) cycle
         request%component = i
         request%value = vector(i)
         call add_load(request, surface, deck)
      end do
   end subroutine add_vector

   !> Speed squared, a point and the direction of the axis: the y axis, or one along z, round which
   !> a plane turns. Round a point (x0, y0) the force is that round the origin less (x0, y0) times
   !> the density, which makes four loads of a place.
   subroutine add_rotation(data, values, request, deck)
      type(data_card_type), intent(in) :: data
      real(dp), intent(in) :: values(:)                    ! (fields)
      type(request_type), intent(inout) :: request         !! step, amplitude, card, elements
      type(deck_type), intent(inout) :: deck
      real(dp) :: point(3), direction(3), loads(4)
      integer :: i

      request%value = values(3)
      point = values(4:6)
      direction = values(7:)
      if (norm2(direction(:2)) <= 0.0_dp .and. abs(direction(3)) > 0.0_dp) then
         request%kind = load_centrifugal
         loads(1:2) = request%value
         loads(3:4) = -request%value*point(:2)
         do i = 1, 4
            request%component = i
            request%value = loads(i)
            call deck%loads%add(request)
         end do
      else if (norm2(direction([1, 3])) > 0.0_dp .or. abs(direction(2)) <= 0.0_dp) then
         call deck%error(data%place(7), 'the axis must be the y axis, or along z')
      else if (norm2(point([1, 3])) > 0.0_dp) then
         call deck%error(data%place(4), 'the axis must be the y axis: x and z are 0 on it')
      else
         request%kind = load_centrifugal
         request%component = centrifugal_round
         call deck%loads%add(request)
      end if
   end subroutine add_rotation

   !> Tractions of one magnitude along straight sides, in the sense of a vector.
   subroutine add_shear(surface, vector, data, request, deck)
      integer, intent(in) :: surface
      real(dp), intent(in) :: vector(2)                    ! of that magnitude
      type(data_card_type), intent(in) :: data
      type(request_type), intent(inout) :: request
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: nodes(:)
      real(dp) :: chord(2), bow(2), along
      integer :: i, j, n

      do i = 1, size(deck%mesh%surfaces(surface)%faces, 2)
         associate (element => deck%mesh%surfaces(surface)%faces(1, i), &
            face => deck%mesh%surfaces(surface)%faces(2, i))
            if (.not. deck%element_valid(element)) cycle
            nodes = deck%mesh%element_nodes(side_nodes(deck%mesh%element_kind(element), face), &
               element)
            n = size(nodes)
            chord = deck%mesh%coordinates(:, nodes(n)) - deck%mesh%coordinates(:, nodes(1))
            chord = chord/norm2(chord)
            bow = deck%mesh%coordinates(:, nodes(n - 1)) - deck%mesh%coordinates(:, nodes(1))
            along = dot_product(chord, vector)
            if (abs(chord(1)*bow(2) - chord(2)*bow(1)) > straight*norm2(bow)) then
               call deck%error(data%place(2), 'TRSHR acts on straight sides, but that of '// &
                  'element '//to_text(deck%mesh%element_number(element))//' is curved; give TRVEC')
               return
            else if (abs(along) <= straight*norm2(vector) .and. norm2(vector) > 0.0_dp) then
               call deck%error(data%place(4), 'the direction is normal to the side of element '// &
                  to_text(deck%mesh%element_number(element)))
               return
            end if
            do j = 1, 2
               request%item = element
               request%component = 2*face + j - 2
               request%value = sign(norm2(vector), along)*chord(j)
               call deck%loads%add(request)
            end do
         end associate
      end do
   end subroutine add_shear

end module deck_builder_element_loads
