!> The pairs of all interfaces in one row, as the solution works on them.
module pair_rows
   use conductance_laws, only: conductance_law_type
   use contact_pairs, only: contact_pairs_type, make_pairs
   use errors, only: error_type
   use kinds, only: dp
   use model, only: model_type
   implicit none
   private
   public :: pair_row_type, pair_surfaces, row_of, align_frames, over_constrained

   !> Cosine of a normal that counts as along an axis.
   real(dp), parameter :: nearly_aligned = 0.99_dp

   !> The pairs of all interfaces in one row.
   type :: pair_row_type
      integer, allocatable :: interface_start(:)              !! (interfaces + 1) first pair of each
      integer, allocatable :: slave(:), master(:)             !! (m) node indexes
      real(dp), allocatable :: weight(:)                      !! (m) tributary areas [length^2]
      real(dp), allocatable :: initial_gap(:)                 !! (m) h [length]
      real(dp), allocatable :: friction(:)                    !! (m) mu [-]
      real(dp), allocatable :: normal(:, :), tangent(:, :)    !! (2, m) unit vectors
      type(conductance_law_type), allocatable :: law(:)       !! (m) conductance laws
   end type pair_row_type

contains

   !> Pairs the surfaces of one *CONTACT PAIR, with the thickness of the slave's first element.
   !> Error: as make_pairs.
   subroutine pair_surfaces(model, i, pairs, error)
      type(model_type), intent(in) :: model               !! the model
      integer, intent(in) :: i                            !! index into model%contacts
      type(contact_pairs_type), intent(out) :: pairs      !! the pairs
      type(error_type), allocatable, intent(out) :: error !! see above
      real(dp) :: thickness

      thickness = 1.0_dp
      associate (faces => model%mesh%surfaces(model%contacts(i)%slave)%faces)
         if (size(faces, 2) > 0) then
            thickness = model%sections(model%mesh%element_section(faces(1, 1)))%thickness
         end if
      end associate
      call make_pairs(model%mesh, model%contacts(i), thickness, pairs, error)
   end subroutine pair_surfaces

   !> Puts the pairs of all interfaces in one row.
   pure function row_of(interfaces, model) result(row)
      type(contact_pairs_type), intent(in) :: interfaces(:) !! in the order of the deck
      type(model_type), intent(in) :: model                 !! the model
      type(pair_row_type) :: row                            !! all their pairs
      integer :: i, first, last, m

      allocate (row%interface_start(size(interfaces) + 1))
      row%interface_start(1) = 1
      do i = 1, size(interfaces)
         row%interface_start(i + 1) = row%interface_start(i) + size(interfaces(i)%slave_node)
      end do
      m = row%interface_start(size(interfaces) + 1) - 1
      allocate (row%slave(m), row%master(m), row%weight(m), row%initial_gap(m), row%friction(m), &
         row%normal(2, m), row%tangent(2, m), row%law(m))
      do i = 1, size(interfaces)
         first = row%interface_start(i)
         last = row%interface_start(i + 1) - 1
         row%slave(first:last) = interfaces(i)%slave_node
         row%master(first:last) = interfaces(i)%master_node
         row%weight(first:last) = interfaces(i)%weight
         row%initial_gap(first:last) = interfaces(i)%initial_gap
         row%normal(:, first:last) = interfaces(i)%normal
         row%tangent(:, first:last) = interfaces(i)%tangent
         row%friction(first:last) = model%interactions(model%contacts(i)%interaction)%friction
         row%law(first:last) = model%interactions(model%contacts(i)%interaction)%law
      end do
   end function row_of

   !> A pair that is held along one axis on both nodes, as on an axis of symmetry, moves along the
   !> other one. Its normal, which a curved side gives only nearly so, is then taken along the axes.
   pure subroutine align_frames(pairs, held)
      type(pair_row_type), intent(inout) :: pairs           !! all pairs
      logical, intent(in) :: held(:)                        !! (2 nodes) prescribed displacements
      logical :: both(2)
      integer :: along, k

      do k = 1, size(pairs%slave)
         both = held(2*pairs%slave(k) - 1:2*pairs%slave(k)) .and. &
            held(2*pairs%master(k) - 1:2*pairs%master(k))
         if (both(1) .eqv. both(2)) cycle
         along = merge(2, 1, both(1))
         if (abs(pairs%normal(along, k)) < nearly_aligned) cycle
         pairs%normal(3 - along, k) = 0.0_dp
         pairs%normal(along, k) = sign(1.0_dp, pairs%normal(along, k))
         pairs%tangent(along, k) = 0.0_dp
         pairs%tangent(3 - along, k) = sign(1.0_dp, pairs%tangent(3 - along, k))
      end do
   end subroutine align_frames

   !> Pairs whose normal motion is prescribed on both nodes, or their motion along a direction that
   !> is neither their normal nor their tangent, once frames are aligned.
   pure function over_constrained(pairs, held) result(too_much)
      type(pair_row_type), intent(in) :: pairs     !! the pairs
      logical, intent(in) :: held(:)               !! (2 nodes) prescribed displacements
      logical :: too_much(size(pairs%slave))       !! (m)
      logical :: both(2)
      integer :: k

      do k = 1, size(pairs%slave)
         both = held(2*pairs%slave(k) - 1:2*pairs%slave(k)) .and. &
            held(2*pairs%master(k) - 1:2*pairs%master(k))
         too_much(k) = any(both) .and. (all(both) .or. &
            abs(pairs%normal(merge(2, 1, both(1)), k)) < nearly_aligned)
      end do
   end function over_constrained

end module pair_rows
