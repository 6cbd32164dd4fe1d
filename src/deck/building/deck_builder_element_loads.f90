!> Data cards of loads on elements: *DLOAD, *DFLUX and *FILM with an element or a set, *DSLOAD,
!> *DSFLUX and *SFILM with a surface; GRAV and CENTRIF act on the mass of elements.
module deck_builder_element_loads
   use card_values, only: need_field, plane_vector, read_row
   use cards, only: data_card_type
   use deck_builder_rigid, only: need_faces
   use deck_context, only: deck_type
   use element_kinds, only: axisymmetric, element_corner_count, side_nodes
   use kinds, only: dp
   use load_requests, only: request_type
   use mesh, only: surface_type
   use spelling, only: known_choices
   use steps, only: centrifugal_round, load_body_force, load_body_heat, load_centrifugal, &
      load_face_heat, load_film_coefficient, load_film_sink, load_gravity, load_pressure, &
      load_traction
   use text, only: append, string_type, to_text, to_upper
   implicit none
   private
   public :: build_element_load, build_surface_load

   real(dp), parameter :: straight = 1.0e-6_dp   !! bow of a side, by its length

contains

   !> Takes one data card.
   subroutine build_element_load(keyword, data, request, film_amplitude, deck)
      character(*), intent(in) :: keyword                  !! DLOAD, DFLUX or FILM
      type(data_card_type), intent(in) :: data
      type(request_type), intent(inout) :: request         !! step, amplitude, card and place
      integer, intent(in) :: film_amplitude                !! amplitude of the film coefficient
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: label, labels
      real(dp) :: values(9)
      integer :: surface
      logical :: known, valid

      known = .true.
      surface = named_surface(data, deck)
      if (surface == 0) call deck%need_elements(data, 1, request%target_type, known)
      call need_field(data, 2, 'label of the load', deck, label, known)
      if (len(label) == 0) return
      label = to_upper(label)
      select case (keyword)
      case ('DLOAD')
         labels = 'P1/P2/P3/P4/BX/BY/BR/BZ/GRAV/CENTRIF'
      case ('DFLUX')
         labels = 'S1/S2/S3/S4/BF'
      case default
         labels = 'F1/F2/F3/F4'
      end select
      if (surface > 0) then
         labels = labels(1:1)
         ! As in CalculiX: a number in the label does not count.
         if (len(label) == 2 .and. index('01234', label(2:)) > 0) label = label(1:1)
      end if
      if (index('/'//labels//'/', '/'//label//'/') == 0) then
         call report_label(keyword, label, labels, data, deck)
         return
      end if
      request%component = 1
      if (scan(label(2:), '1234') == 1) then
         request%component = index('1234', label(2:2))
         call check_face(data, request, deck, known)
      end if
      if (label == 'BR' .or. label == 'BZ') call check_axis(data, request, deck, known)
      call read_values(data, '@element or set', label, deck, values, valid)
      if (.not. (known .and. valid)) return
      if (surface > 0) then
         call add_on_faces(label, values, deck%mesh%surfaces(surface), request, film_amplitude, &
            deck)
      else if (label == 'GRAV') then
         call add_gravity(data, values, request, deck)
      else if (label == 'CENTRIF') then
         call add_rotation(data, values, request, deck)
      else
         call add_load(label, values, request, film_amplitude, deck)
      end if
   end subroutine build_element_load

   !> Index of the surface that a card names in place of an element or a set; else 0.
   integer function named_surface(data, deck)
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(in) :: deck
      integer :: set

      named_surface = deck%index_of('surface', data%text(1))
      if (.not. data%has(1)) named_surface = 0
      set = deck%index_of('element set', data%text(1))
      if (set == 0) return
      if (.not. deck%mesh%element_sets(set)%of_lines) named_surface = 0
   end function named_surface

   !> Loads of one kind on all faces of a surface.
   subroutine add_on_faces(label, values, surface, request, film_amplitude, deck)
      character(*), intent(in) :: label
      real(dp), intent(in) :: values(:)
      type(surface_type), intent(in) :: surface            !! the faces
      type(request_type), intent(inout) :: request         !! step, amplitude, card and place
      integer, intent(in) :: film_amplitude                !! amplitude of the film coefficient
      type(deck_type), intent(inout) :: deck
      integer :: i

      request%set = 0
      do i = 1, size(surface%faces, 2)
         request%item = surface%faces(1, i)
         request%component = surface%faces(2, i)
         call add_load(label, values, request, film_amplitude, deck)
      end do
   end subroutine add_on_faces

   !> The values behind a label.
   subroutine read_values(data, target, label, deck, values, valid)
      type(data_card_type), intent(in) :: data
      character(*), intent(in) :: target                   ! layout of the first field
      character(*), intent(in) :: label
      type(deck_type), intent(inout) :: deck
      real(dp), intent(out) :: values(9)                   ! (fields)
      logical, intent(out) :: valid
      character(:), allocatable :: layout

      select case (label)
      case ('GRAV', 'TRVEC', 'TRSHR')
         layout = 'magnitude/direction x/direction y/direction z?'
      case ('CENTRIF')
         layout = 'speed squared >=0/x of the axis/y of the axis/z of the axis/'// &
            'direction x/direction y/direction z'
      case ('BX', 'BY', 'BR', 'BZ')
         layout = 'force per volume'
      case ('BF')
         layout = 'heat per volume'
      case default
         if (label(1:1) == 'P') layout = 'pressure'
         if (label(1:1) == 'S') layout = 'heat flux'
         if (label(1:1) == 'F') layout = 'sink temperature/film coefficient >0'
      end select
      values = 0.0_dp
      valid = .false.
      ! The coefficient of a *FILM PROPERTY, which is refused.
      if (label(1:1) == 'F' .and. deck%has_lost('film property', data%text(4))) return
      call read_row(data, target//'/@'//label//'/'//layout, deck, values, valid)
   end subroutine read_values

   !> Reports a label that a keyword does not know.
   subroutine report_label(keyword, label, labels, data, deck)
      character(*), intent(in) :: keyword                  !! keyword
      character(*), intent(in) :: label                    !! what was written
      character(*), intent(in) :: labels                   !! what is known, separated by slashes
      type(data_card_type), intent(in) :: data             !! the card; the label is field 2
      type(deck_type), intent(inout) :: deck
      type(string_type), allocatable :: names(:)
      integer :: first, slash

      first = 1
      do
         slash = index(labels(first:)//'/', '/')
         call append(names, labels(first:first + slash - 2))
         first = first + slash
         if (first > len(labels)) exit
      end do
      call deck%error(data%place(2), 'unknown load '//label//' of *'//keyword// &
         known_choices(label, names))
   end subroutine report_label

   !> Every element of the request has the side.
   subroutine check_face(data, request, deck, valid)
      type(data_card_type), intent(in) :: data
      type(request_type), intent(in) :: request
      type(deck_type), intent(inout) :: deck
      logical, intent(inout) :: valid
      integer, allocatable :: elements(:)
      integer :: i

      if (.not. valid) return
      elements = request%members(deck%mesh%element_sets)
      do i = 1, size(elements)
         if (.not. deck%element_valid(elements(i))) cycle
         associate (sides => element_corner_count(deck%mesh%element_kind(elements(i))))
            if (request%component <= sides) cycle
            call deck%error(data%place(2), 'element '//to_text(deck%mesh%element_number(elements( &
               i)))//' has '//to_text(sides)//' sides')
         end associate
         valid = .false.
         return
      end do
   end subroutine check_face

   !> Every element of the request is axisymmetric.
   subroutine check_axis(data, request, deck, valid)
      type(data_card_type), intent(in) :: data
      type(request_type), intent(in) :: request
      type(deck_type), intent(inout) :: deck
      logical, intent(inout) :: valid
      integer, allocatable :: elements(:)

      if (.not. valid) return
      elements = request%members(deck%mesh%element_sets)
      valid = all(deck%mesh%element_plane(elements) == axisymmetric)
      if (.not. valid) call deck%error(data%place(2), 'BR and BZ are forces on axisymmetric '// &
         'elements; those of a plane are BX and BY')
   end subroutine check_axis

   !> A load that is one number, or a film.
   subroutine add_load(label, values, request, film_amplitude, deck)
      character(*), intent(in) :: label
      real(dp), intent(in) :: values(:)                    ! (fields)
      type(request_type), intent(in) :: request
      integer, intent(in) :: film_amplitude
      type(deck_type), intent(inout) :: deck
      type(request_type) :: load

      load = request
      load%value = values(3)
      select case (label)
      case ('BX', 'BY', 'BR', 'BZ')   ! the radius is x, the axis y
         load%kind = load_body_force
         load%component = mod(index('XYRZ', label(2:2)) - 1, 2) + 1
      case ('BF')
         load%kind = load_body_heat
      case default
         if (label(1:1) == 'P') load%kind = load_pressure
         if (label(1:1) == 'S') load%kind = load_face_heat
         if (label(1:1) == 'F') load%kind = load_film_sink
      end select
      if (load%kind == load_film_sink) call add_film(load)
      call deck%loads%add(load)
   contains
      subroutine add_film(sink)
         type(request_type), intent(in) :: sink
         type(request_type) :: film

         film = sink
         film%kind = load_film_coefficient
         film%amplitude = film_amplitude
         film%value = values(4)
         call deck%loads%add(film)
      end subroutine add_film
   end subroutine add_load

   !> Magnitude and direction; along x and along y the gravity is a load of its own.
   subroutine add_gravity(data, values, request, deck)
      type(data_card_type), intent(in) :: data
      real(dp), intent(in) :: values(:)                    ! (fields)
      type(request_type), intent(inout) :: request         !! step, amplitude, card, elements
      type(deck_type), intent(inout) :: deck
      real(dp) :: vector(2)
      integer :: i

      call plane_vector(data, 3, values(3:6), deck, vector)
      request%kind = load_gravity
      do i = 1, 2
         if (abs(vector(i)) <= 0.0_dp) cycle
         request%component = i
         request%value = vector(i)
         call deck%loads%add(request)
      end do
   end subroutine add_gravity

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
      if (norm2(direction) <= 0.0_dp) then
         call deck%error(data%place(7), 'the direction is zero')
      else if (norm2(direction(:2)) <= 0.0_dp) then
         request%kind = load_centrifugal
         loads(1:2) = request%value
         loads(3:4) = -request%value*point(:2)
         do i = 1, 4
            request%component = i
            request%value = loads(i)
            call deck%loads%add(request)
         end do
      else if (norm2(direction([1, 3])) > 0.0_dp) then
         call deck%error(data%place(7), 'the axis must be the y axis, or along z')
      else if (norm2(point([1, 3])) > 0.0_dp) then
         call deck%error(data%place(4), 'the axis must be the y axis: x and z are 0 on it')
      else
         request%kind = load_centrifugal
         request%component = centrifugal_round
         call deck%loads%add(request)
      end if
   end subroutine add_rotation

   !> Takes one data card.
   subroutine build_surface_load(keyword, data, request, film_amplitude, deck)
      character(*), intent(in) :: keyword                  !! DSLOAD, DSFLUX or SFILM
      type(data_card_type), intent(in) :: data
      type(request_type), intent(inout) :: request         !! step, amplitude, card and place
      integer, intent(in) :: film_amplitude                !! amplitude of the film coefficient
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: advice, label, labels
      real(dp) :: values(9), vector(2)
      integer :: i, surface
      logical :: known, valid

      advice = 'load its reference node by *CLOAD'
      if (keyword /= 'DSLOAD') advice = 'prescribe the temperature of its reference node'
      call deck%need_surface(data, 1, 'surface', surface)
      call need_faces(data%place(1), advice, deck, surface)
      labels = 'P/TRVEC/TRSHR'
      if (keyword == 'DSFLUX') labels = 'S'
      if (keyword == 'SFILM') labels = 'F'
      known = .true.
      call need_field(data, 2, labels, deck, label, known)
      if (len(label) == 0) return
      label = to_upper(label)
      request%set = 0
      if (index('/'//labels//'/', '/'//label//'/') == 0) then
         call report_label(keyword, label, labels, data, deck)
         return
      end if
      call read_values(data, '@surface', label, deck, values, valid)
      if (surface == 0 .or. .not. valid) return
      request%kind = load_traction
      select case (label)
      case ('TRVEC')
         call plane_vector(data, 3, values(3:6), deck, vector)
         do i = 1, 2
            request%value = vector(i)
            call add_faces(deck%mesh%surfaces(surface), request, 2, i - 2, deck)
         end do
      case ('TRSHR')
         call plane_vector(data, 3, values(3:6), deck, vector)
         call add_shear(deck%mesh%surfaces(surface), vector, data, request, deck)
      case default
         call add_on_faces(label, values, deck%mesh%surfaces(surface), request, film_amplitude, &
            deck)
      end select
   end subroutine build_surface_load

   !> Tractions of one magnitude along straight sides, in the sense of a vector.
   subroutine add_shear(surface, vector, data, request, deck)
      type(surface_type), intent(in) :: surface
      real(dp), intent(in) :: vector(2)                    ! of that magnitude
      type(data_card_type), intent(in) :: data
      type(request_type), intent(inout) :: request
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: nodes(:)
      real(dp) :: chord(2), bow(2), along
      integer :: i, j, n

      do i = 1, size(surface%faces, 2)
         associate (element => surface%faces(1, i), face => surface%faces(2, i))
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

   !> One request a face, its component a multiple of the face's number and an offset.
   subroutine add_faces(surface, request, multiple, offset, deck)
      type(surface_type), intent(in) :: surface
      type(request_type), intent(inout) :: request
      integer, intent(in) :: multiple, offset
      type(deck_type), intent(inout) :: deck
      integer :: i

      do i = 1, size(surface%faces, 2)
         request%item = surface%faces(1, i)
         request%component = multiple*surface%faces(2, i) + offset
         call deck%loads%add(request)
      end do
   end subroutine add_faces

end module deck_builder_element_loads
