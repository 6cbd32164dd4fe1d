!> Errors and warnings on the interfaces of a deck once they are made, and on *VERIFY cards at
!> positions that only contact points can tell.
module interface_reports
   use checked_values, only: is_on_interface
   use conductance_laws, only: law_none
   use connections, only: match_surfaces, match_tie
   use contact_points, only: contact_points_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use contact_definitions, only: contact_definition_type, is_removed, steps_with
   use element_kinds, only: axisymmetric, plane_stress
   use errors, only: error_type
   use interface_warnings, only: clearance_warning, curved_gap_warning, distance_warning, &
      offset_warning, overlap_warning, tie_words, unresolved_warning
   use kinds, only: dp
   use model, only: model_type
   use steps, only: solves_heat, solves_mechanics
   use temperature_laws, only: largest_jump, law_at, radiates
   use text, only: append, read_real, string_type, to_text, to_upper
   implicit none
   private
   public :: make_interfaces, make_ties, first_repeated, check_arc_lengths

   real(dp), parameter :: parallel = 0.99_dp   !! cosine between normals that count as one

contains

   !> Matches the surfaces of every *CONTACT PAIR; reports those that cannot be matched, and warns
   !> of those that may not be meant so.
   subroutine make_interfaces(model, interfaces, report)
      type(model_type), intent(in) :: model
      !> (interfaces) their contact points
      type(contact_points_type), allocatable, intent(out) :: interfaces(:)
      type(deck_report_type), intent(inout) :: report        !! receives errors and warnings
      type(error_type), allocatable :: error
      integer, allocatable :: slave(:), master(:), blamed(:)
      real(dp), allocatable :: normal(:, :)
      integer :: card, i, known, repeated

      allocate (slave(0), master(0), normal(2, 0), interfaces(size(model%contacts)), blamed(0))
      do i = 1, size(model%contacts)
         call match_surfaces(model, i, interfaces(i), error)
         if (allocated(error)) then
            ! An error of a surface is reported for the first of its interfaces.
            card = merge(error%card, model%contacts(i)%card, error%card > 0)
            if (all(blamed /= card)) call report%error(place_type(image=card), error%message)
            blamed = [blamed, card]
            cycle
         end if
         call warn_of_interface(model, i, interfaces(i), report)
         known = size(slave)
         slave = [slave, interfaces(i)%slave]
         master = [master, interfaces(i)%master]
         normal = reshape([normal, interfaces(i)%normal], [2, size(slave)])
         repeated = first_repeated(slave, master, normal)
         if (repeated == 0) cycle
         associate (number => model%mesh%node_number)
            call report%error(place_type(image=model%contacts(i)%card), 'contact pair '// &
               interfaces(i)%name//': nodes '//to_text(number(slave(repeated)))//' and '// &
               to_text(number(master(repeated)))//' are paired along the same normal by an '// &
               'earlier *CONTACT PAIR already; leave one of the two out')
         end associate
         slave = slave(:known)
         master = master(:known)
         normal = normal(:, :known)
      end do
   end subroutine make_interfaces

   !> Matches the surfaces of every *TIE; reports those that cannot be matched, and notes what each
   !> of the others holds.
   subroutine make_ties(model, ties, notes, report)
      type(model_type), intent(in) :: model
      type(contact_points_type), allocatable, intent(out) :: ties(:)   !! (ties) their points
      type(string_type), allocatable, intent(inout) :: notes(:)        !! receives what they hold
      type(deck_report_type), intent(inout) :: report        !! receives errors and warnings
      type(error_type), allocatable :: error
      character(:), allocatable :: warning
      integer :: i

      allocate (ties(size(model%ties)))
      do i = 1, size(ties)
         call match_tie(model, i, ties(i), error)
         associate (card => place_type(image=model%ties(i)%faces%card))
            if (allocated(error)) then
               call report%error(merge(place_type(image=error%card), card, error%card > 0), &
                  error%message)
               cycle
            end if
            warning = distance_warning(model%mesh, model%ties(i), ties(i))
            if (len(warning) > 0) call report%warning(card, warning)
            warning = plane_warning(model, model%ties(i)%faces)
            if (len(warning) > 0) call report%warning(card, warning)
         end associate
         call append(notes, tie_words(model%mesh, model%ties(i), ties(i)))
      end do
   end subroutine make_ties

   !> The first contact point that is among those before it already: the same two nodes, and
   !> normals along one line; 0 where there is none.
   pure integer function first_repeated(slave, master, normal)
      integer, intent(in) :: slave(:)            !! (m) slave nodes
      integer, intent(in) :: master(:)           !! (m) master nodes
      real(dp), intent(in) :: normal(:, :)       !! (2, m) unit vectors
      integer :: before(size(slave)), i, k
      integer :: last(maxval([0, slave, master]))   ! of those whose lower node it is

      last = 0
      do k = 1, size(slave)
         associate (lower => min(slave(k), master(k)))
            i = last(lower)
            before(k) = i
            last(lower) = k
         end associate
         do while (i > 0)
            first_repeated = k
            if (slave(i) + master(i) == slave(k) + master(k) .and. &
               abs(dot_product(normal(:, i), normal(:, k))) > parallel) return
            i = before(i)
         end do
      end do
      first_repeated = 0
   end function first_repeated

   subroutine warn_of_interface(model, i, points, report)
      type(model_type), intent(in) :: model
      integer, intent(in) :: i
      type(contact_points_type), intent(in) :: points
      type(deck_report_type), intent(inout) :: report
      logical :: begins_with_heat

      if (allocated(points%idle)) call warn(model%contacts(i)%title()//': '//points%idle// &
         ' takes no part: no face of the other surface is opposite, or other lines hide it; '// &
         'leave it out, or name the faces that are missing')
      call warn(offset_warning(model%mesh, points))
      if (model%contacts(i)%has_clearance) then
         call warn(clearance_warning(model%mesh, points))
      else
         if (size(model%steps) == 0 .or. any(steps_with(model%steps%changes, i))) call warn( &
            overlap_warning(model%mesh, points))
         ! Where heat crosses the initial gaps before any mechanics.
         begins_with_heat = .false.
         if (size(model%steps) > 0) begins_with_heat = solves_heat(model%steps(1)%analysis) .and. &
            .not. (solves_mechanics(model%steps(1)%analysis) .or. &
            is_removed(model%steps(:1)%changes, i))
         if (begins_with_heat) then
            associate (law => model%interactions(model%contacts(i)%interaction)%law)
               call warn(unresolved_warning(model%mesh, points, law_at(law, largest_jump(law))))
            end associate
         end if
      end if
      associate (law => model%interactions(model%contacts(i)%interaction)%law)
         if (any(solves_heat(model%steps%analysis)) .and. law%open_kind /= law_none) call &
            warn(curved_gap_warning(model%mesh, points, radiates(law)))
      end associate
      call warn(thickness_warning(model, i))
      call warn(plane_warning(model, model%contacts(i)))
   contains
      subroutine warn(message)
         character(*), intent(in) :: message

         if (len(message) > 0) call report%warning(place_type(image=model%contacts(i)%card), &
            message)
      end subroutine warn
   end subroutine warn_of_interface

   !> The areas of all contact points are those of the slave's first element; empty where all
   !> elements at the interface are as thick.
   pure function thickness_warning(model, i) result(warning)
      type(model_type), intent(in) :: model
      integer, intent(in) :: i
      character(:), allocatable :: warning
      integer, allocatable :: elements(:)
      real(dp), allocatable :: thickness(:)
      integer :: f

      warning = ''
      associate (mesh => model%mesh, contact => model%contacts(i))
         elements = [mesh%surfaces(contact%slave)%faces(1, :), &
            mesh%surfaces(contact%master)%faces(1, :)]
         if (any(mesh%element_plane(elements) == axisymmetric)) return
         thickness = model%sections(mesh%element_section(elements))%thickness
         f = findloc(abs(thickness - thickness(1)) > 0.0_dp, .true., dim=1)
         if (f == 0) return
         warning = 'contact pair '//contact%name//': element '// &
            to_text(mesh%element_number(elements(f)))//' is '//to_text(thickness(f))// &
            ' thick; pressure and flux of all contact points are for the thickness '// &
            to_text(thickness(1))//' of the slave''s element '// &
            to_text(mesh%element_number(elements(1)))
      end associate
   end function thickness_warning

   !> Plane stress and plane strain meet where one body may be free to become thicker and the other
   !> is not; areas beside axisymmetric elements are those of the slave. Empty where all elements at
   !> the interface are of one plane.
   pure function plane_warning(model, definition) result(warning)
      type(model_type), intent(in) :: model
      type(contact_definition_type), intent(in) :: definition
      character(:), allocatable :: warning
      integer, allocatable :: elements(:)
      logical, allocatable :: is_stress(:)
      integer :: other

      warning = ''
      associate (mesh => model%mesh)
         elements = [mesh%surfaces(definition%slave)%faces(1, :), &
            mesh%surfaces(definition%master)%faces(1, :)]
         is_stress = mesh%element_plane(elements) == plane_stress
         if (all(is_stress .eqv. is_stress(1))) return
         other = elements(findloc(is_stress, .false., dim=1))
         warning = definition%title()//': element '//to_text(mesh%element_number(elements( &
            findloc(is_stress, .true., dim=1))))//' is in plane stress and element '// &
            to_text(mesh%element_number(other))
         if (mesh%element_plane(other) == axisymmetric) then
            warning = warning//' axisymmetric: pressure and flux are for the area of the slave'
         else
            warning = warning//' in plane strain: one may become thicker where the other may '// &
               'not; give both bodies elements of one kind, or *OPTIONS, PLANE='
         end if
      end associate
   end function plane_warning

   !> Reports every check at an arc length that is on no piece of its interface.
   subroutine check_arc_lengths(model, interfaces, report)
      type(model_type), intent(in) :: model                !! its checks name known interfaces
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(deck_report_type), intent(inout) :: report      !! receives errors
      character(:), allocatable :: words   ! such as 'goes from 0 to 2, from 3 to 5'
      real(dp), allocatable :: ends(:)
      real(dp) :: s
      integer :: at, i, k, p
      logical :: valid

      do i = 1, size(model%verifications)
         associate (check => model%verifications(i))
            at = index(check%where, '@')
            if (at == 0) cycle
            call read_real(trim(adjustl(check%where(at + 1:))), s, valid)
            if (.not. valid) cycle
            do k = 1, size(interfaces)
               if (to_upper(interfaces(k)%name) /= to_upper(trim(check%where(:at - 1)))) cycle
               if (is_on_interface(s, interfaces(k))) cycle
               ends = interfaces(k)%arc_length(interfaces(k)%ends())
               words = 'ends at '//to_text(ends(size(ends)))
               if (size(ends) > 2) words = 'goes'
               do p = 1, merge(size(ends), 0, size(ends) > 2), 2
                  words = words//trim(merge(' ', ',', p == 1))//' from '//to_text(ends(p))// &
                     ' to '//to_text(ends(p + 1))
               end do
               call report%error(place_type(check%line, check%columns(2)), &
                  'the arc length of contact pair '//interfaces(k)%name//' '//words)
            end do
         end associate
      end do
   end subroutine check_arc_lengths

end module interface_reports
