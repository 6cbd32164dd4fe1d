!> The table of reported quantities, by which listing, result file, *VERIFY, estimates of errors and
!> the trade-off study know them.
module reported_quantities
   use contact_quantities, only: contact_table
   use field_quantities, only: field_table
   use increment_quantities, only: increment_table
   use quantity_types, only: of_contact_points, of_history, of_interface, of_nodes, of_references, &
      of_sections, quantity_type
   implicit none
   private
   public :: quantities, verifiable, geometry, traded, datasets

   type(quantity_type), parameter :: quantities(*) = [increment_table, contact_table, field_table]

   !> Those that *VERIFY may name.
   type(quantity_type), parameter :: verifiable(*) = pack(quantities, quantities%is_published &
      .and. (quantities%kind == of_history .or. quantities%kind == of_interface .or. &
      quantities%kind == of_contact_points .or. quantities%kind == of_nodes .or. &
      quantities%kind == of_sections .or. quantities%kind == of_references))

   !> Those of contact points before deformation.
   type(quantity_type), parameter :: geometry(*) = pack(quantities, quantities%is_geometry)

   !> Those that rows of a trade are judged by: of an interface, then of points.
   type(quantity_type), parameter :: traded(*) = pack(quantities, quantities%is_traded)

contains

   !> The quantities of a kind that the result file of a deck has and that change.
   pure function datasets(kind, has) result(list)
      integer, intent(in) :: kind                        !! one of the of_* constants
      logical, intent(in) :: has(0:)                     !! what the deck solves, by needs_*
      type(quantity_type), allocatable :: list(:)        !! in the order of the table

      list = pack(quantities, quantities%kind == kind .and. quantities%is_published .and. &
         .not. quantities%is_geometry .and. has(quantities%needs))
   end function datasets

end module reported_quantities
