!> *TRANSFORM -> nodes with axes of their own; *ORIENTATION -> axes of materials.
module deck_builder_axes
   use card_values, only: choice, read_row
   use cards, only: data_card_type
   use deck_context, only: deck_type
   use deck_structure, only: cards_of
   use kinds, only: dp
   use mesh, only: extent_of
   use text, only: to_text
   use transforms, only: transform_type
   implicit none
   private
   public :: build_orientations, build_transforms

   real(dp), parameter :: negligible = 1.0e-9_dp   !! part of a direction or of the model
   real(dp), parameter :: degree = acos(-1.0_dp)/180

contains

   !> Builds all transforms.
   subroutine build_transforms(deck)
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: places(:)
      integer :: n

      places = cards_of(deck%cards, 'TRANSFORM')
      allocate (deck%model%transforms(size(places)))
      do n = 1, size(places)
         call deck%open_card(places(n))
         associate (transform => deck%model%transforms(n))
            transform%title = '*TRANSFORM, '//deck%source%words_of(deck%card%place)
            transform%card = deck%card%place%image
            call deck%need_named('NSET', 'node set', transform%set)
            transform%cylindrical = choice(deck%card, 'TYPE', 'R/C', deck, 'R') == 'C'
            if (size(deck%card%data) > 0) call read_axes(deck%card%data(1), deck, transform)
            call check_nodes(n, deck)
         end associate
      end do
   end subroutine build_transforms

   !> Builds all orientations; axis 3 is across the plane.
   subroutine build_orientations(deck)
      type(deck_type), intent(inout) :: deck
      type(transform_type) :: axes
      integer, allocatable :: places(:)
      real(dp) :: given(2)
      integer :: n
      logical :: valid

      places = cards_of(deck%cards, 'ORIENTATION')
      allocate (deck%model%orientations(size(places)))
      do n = 1, size(places)
         call deck%open_card(places(n))
         call deck%take_name('orientation', deck%model%orientations(n)%name)
         associate (given_axes => deck%model%orientations(n))
            if (size(deck%card%data) == 0) cycle
            axes = transform_type()
            axes%cylindrical = choice(deck%card, 'SYSTEM', 'RECTANGULAR/CYLINDRICAL', deck, &
               'RECTANGULAR') == 'CYLINDRICAL'
            call read_axes(deck%card%data(1), deck, axes)
            if (axes%out_of_plane /= 3) call deck%error(deck%card%data(1)%place(1), 'axes 1 '// &
               'and 2 of an orientation lie in the plane: the z components of a and b must be 0')
            given_axes%cylindrical = axes%cylindrical
            given_axes%orientation_sign = axes%sense
            if (axes%cylindrical) given_axes%centre = axes%point
            if (.not. axes%cylindrical) given_axes%direction = axes%point
            if (size(deck%card%data) == 1) cycle
            ! A turn round axis 3, from axis 1 towards axis 2.
            call read_row(deck%card%data(2), '#axis/angle in degrees?', deck, given, valid)
            if (valid .and. nint(given(1)) /= 3) call deck%error(deck%card%data(2)%place(1), &
               'a turn about axis 1 or 2 leaves the plane: only axis 3')
            associate (first => given_axes%direction, angle => given(2)*degree)
               first = cos(angle)*first + sin(angle)*axes%sense*[-first(2), first(1)]
            end associate
         end associate
      end do
   end subroutine build_orientations

   !> Two points a and b: on the first axis and in the plane of the first two, on the side of the
   !> second; or on the axis of a cylinder, along which axis 3 points from a to b.
   subroutine read_axes(data, deck, axes)
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(inout) :: deck
      type(transform_type), intent(inout) :: axes          ! whether they are cylindrical is known
      real(dp) :: given(6), unit(3, 3), x(3, 2)
      logical :: valid

      call read_row(data, 'x of point a/y of point a/z of point a?/x of point b/y of point b/'// &
         'z of point b?', deck, given, valid)
      if (.not. valid) return
      x = reshape(given, shape(x))
      axes%point = x(:2, 1)
      if (axes%cylindrical) then
         x(:, 2) = x(:, 2) - x(:, 1)
         axes%sense = sign(1.0_dp, x(3, 2))
         if (norm2(x(:2, 2)) > negligible*norm2(x(:, 2)) .or. norm2(x(:, 2)) <= 0.0_dp) call &
            deck%error(data%place(1), 'a cylindrical system of a plane is round an axis along '// &
            'z, such as 0., 0., 0., 0., 0., 1.')
         return
      end if
      valid = all(norm2(x, dim=1) > 0.0_dp)
      if (valid) then
         unit(:, 1) = x(:, 1)/norm2(x(:, 1))
         unit(:, 2) = x(:, 2)/norm2(x(:, 2))
         unit(:, 2) = unit(:, 2) - dot_product(unit(:, 1), unit(:, 2))*unit(:, 1)
         valid = norm2(unit(:, 2)) > negligible
      end if
      if (valid) then
         unit(:, 2) = unit(:, 2)/norm2(unit(:, 2))
         unit(:, 3) = cshift(unit(:, 1), 1)*cshift(unit(:, 2), 2) - &
            cshift(unit(:, 1), 2)*cshift(unit(:, 2), 1)
         axes%out_of_plane = maxloc(abs(unit(3, :)), dim=1)
         valid = norm2(unit(:2, axes%out_of_plane)) <= negligible
         associate (first => unit(:2, merge(2, 1, axes%out_of_plane == 1)), &
            second => unit(:2, merge(2, 3, axes%out_of_plane == 3)))
            axes%point = first
            axes%sense = sign(1.0_dp, first(1)*second(2) - first(2)*second(1))
         end associate
      end if
      if (.not. valid) call deck%error(data%place(1), 'a rectangular system of a plane has two '// &
         'points, not in line with the origin, that put one of the three axes along z, such as '// &
         '1., 1., 0., -1., 1., 0.')
   end subroutine read_axes

   !> A node has one transform, and is not on the axis of it.
   subroutine check_nodes(n, deck)
      integer, intent(in) :: n
      type(deck_type), intent(inout) :: deck
      integer :: i, k

      if (deck%model%transforms(n)%set == 0) return
      associate (members => deck%mesh%node_sets(deck%model%transforms(n)%set)%members, number => &
         deck%mesh%node_number, x => deck%mesh%coordinates)
         do i = 1, size(members)
            do k = 1, n - 1
               if (deck%model%transforms(k)%set == 0) cycle
               if (all(deck%mesh%node_sets(deck%model%transforms(k)%set)%members /= &
                  members(i))) cycle
               call deck%error(deck%card%place_of('NSET'), 'node '//to_text(number(members(i)))// &
                  ' has axes of its own by '//deck%model%transforms(k)%title//' already')
               return
            end do
            if (.not. deck%model%transforms(n)%cylindrical) cycle
            if (norm2(x(:, members(i)) - deck%model%transforms(n)%point) > &
               negligible*extent_of(x)) cycle
            call deck%error(deck%card%place_of('NSET'), 'node '//to_text(number(members(i)))// &
               ' is on the axis, where no direction is radial')
            return
         end do
      end associate
   end subroutine check_nodes

end module deck_builder_axes
