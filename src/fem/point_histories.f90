!> Histories of the materials at the points of all elements: where each one lies, and what is read
!> from it.
module point_histories
   use material_laws, only: law_interval_type
   use materials, only: has_law, material_type, section_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use point_materials, only: point_materials_type
   use quadrature, only: most => most_points_of_rule, point_count
   implicit none
   private
   public :: point_histories_type, point_history_type, history_count

   !> The points of all elements, with their histories.
   type, extends(point_materials_type) :: point_histories_type
      integer, allocatable :: history_start(:)   !! (elements + 1) where the history of each begins
   contains
      procedure :: place_histories
      procedure :: follows_law
      procedure :: start_history
      procedure :: largest_growth
      procedure :: second_start
      procedure :: difference_of_stages
      procedure :: inelastic_work
      procedure :: take_strains
   end type point_histories_type

   !> Histories of all points at both ends of a time increment.
   type, extends(law_interval_type) :: point_history_type
      real(dp), allocatable :: before(:)   !! (numbers) at the start; unallocated for none
      real(dp), allocatable :: after(:)    !! (numbers) at the end
   end type point_history_type

contains

   !> Finds where they lie.
   pure subroutine place_histories(self, mesh)
      class(point_histories_type), intent(inout) :: self
      type(mesh_type), intent(in) :: mesh

      self%history_start = 1 + history_before(mesh, self%sections, self%library)
   end subroutine place_histories

   !> Size of the history of all integration points.
   pure integer function history_count(mesh, sections, materials)
      type(mesh_type), intent(in) :: mesh
      type(section_type), intent(in) :: sections(:)
      type(material_type), intent(in) :: materials(:)
      integer :: before(size(mesh%element_kind) + 1)

      before = history_before(mesh, sections, materials)
      history_count = before(size(before))
   end function history_count

   !> Size of the history of the elements before each one, and of all.
   pure function history_before(mesh, sections, materials) result(before)
      type(mesh_type), intent(in) :: mesh
      type(section_type), intent(in) :: sections(:)
      type(material_type), intent(in) :: materials(:)
      integer :: before(size(mesh%element_kind) + 1), e

      before = 0
      do e = 1, size(mesh%element_kind)
         before(e + 1) = before(e) + point_count(mesh%element_kind(e))* &
            materials(sections(mesh%element_section(e))%material)%law%history_count
      end do
   end function history_before

   !> Whether an element responds by a law beyond thermoelasticity.
   pure logical function follows_law(self, mesh, element)
      class(point_histories_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element                         !! which element

      follows_law = has_law(self%library(self%sections(mesh%element_section(element))%material))
   end function follows_law

   !> Gives the history of points that anneal their first temperature.
   pure subroutine start_history(self, mesh, temperature, history)
      class(point_histories_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      real(dp), intent(in) :: temperature(:)                 !! (nodes) [temperature]
      real(dp), intent(inout) :: history(:)                  !! (numbers)
      integer :: e, g

      do e = 1, size(mesh%element_kind)
         associate (law => self%library(self%sections(mesh%element_section(e))%material)%law, &
            rule => self%rules(mesh%element_kind(e)))
            if (law%annealing == 0) cycle
            do g = 1, rule%count
               history(self%history_start(e) + (g - 1)*law%history_count + law%annealing + 3) = &
                  dot_product(rule%shape(g, :rule%nodes), &
                  temperature(mesh%element_nodes(:rule%nodes, e)))
            end do
         end associate
      end do
   end subroutine start_history

   !> Largest equivalent plastic and creep strains of the bodies [-], or their growth since another
   !> history.
   pure function largest_growth(self, mesh, after, before) result(growth)
      class(point_histories_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      real(dp), intent(in) :: after(:)                       !! (numbers)
      real(dp), optional, intent(in) :: before(:)            !! (numbers) likewise
      real(dp) :: growth(2, mesh%body_count), grown
      integer :: e, i, k

      growth = 0.0_dp
      do e = 1, size(mesh%element_kind)
         associate (law => self%library(self%sections(mesh%element_section(e))%material)%law)
            do k = 1, 2
               if (law%strains(k) == 0) cycle
               do i = self%history_start(e) + law%strains(k) + 3, self%history_start(e + 1) - 1, &
                  law%history_count
                  grown = after(i)
                  if (present(before)) grown = grown - before(i)
                  growth(k, mesh%element_body(e)) = max(growth(k, mesh%element_body(e)), grown)
               end do
            end do
         end associate
      end do
   end function largest_growth

   !> History at which the second stage of an increment starts: beyond that of the first one by
   !> a factor less one. What strain alone changes starts where the first stage ended if strains
   !> jumped in it. Where a point becomes solid is found in the whole increment.
   pure function second_start(self, mesh, start, middle, factor, jumps) result(history)
      class(point_histories_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      real(dp), intent(in) :: start(:), middle(:)            !! (numbers) of the first stage
      real(dp), intent(in) :: factor
      logical, intent(in) :: jumps
      real(dp) :: history(size(start))
      integer :: e, i, k

      history = start + factor*(middle - start)
      if (.not. (jumps .or. any(self%library%law%annealing > 0))) return
      do e = 1, size(mesh%element_kind)
         associate (law => self%library(self%sections(mesh%element_section(e))%material)%law)
            if (.not. allocated(law%of_time)) cycle
            do i = self%history_start(e), self%history_start(e + 1) - 1
               k = 1 + modulo(i - self%history_start(e), law%history_count)
               if (jumps .and. .not. law%of_time(k)) history(i) = middle(i)
               if (law%annealing > 0 .and. k >= law%annealing) history(i) = start(i)
            end do
         end associate
      end do
   end function second_start

   !> Largest difference of the changes of inelastic strain in the two stages of an increment, as an
   !> equivalent strain: of all, and of creep alone.
   pure function difference_of_stages(self, mesh, first, second) result(largest)
      class(point_histories_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      real(dp), intent(in) :: first(:), second(:)            !! (numbers) changes in them
      real(dp) :: largest(2), strains(most, 10, 2), creep(4), whole(4)
      integer :: e, g

      largest = 0.0_dp
      do e = 1, size(mesh%element_kind)
         if (self%history_start(e + 1) == self%history_start(e)) cycle
         call self%take_strains(mesh, e, first, strains(:, :, 1))
         call self%take_strains(mesh, e, second, strains(:, :, 2))
         do g = 1, self%rules(mesh%element_kind(e))%count
            creep = strains(g, 6:9, 2) - strains(g, 6:9, 1)
            whole = creep + strains(g, 1:4, 2) - strains(g, 1:4, 1)
            largest = max(largest, [equivalent(whole), equivalent(creep)])
         end do
      end do
   contains
      pure real(dp) function equivalent(strain)
         real(dp), intent(in) :: strain(4)

         equivalent = sqrt((2*sum(strain(:3)**2) + strain(4)**2)/3)
      end function equivalent
   end function difference_of_stages

   !> Work of plasticity and creep at the points of an element so far, in columns; 0 of none.
   pure function inelastic_work(self, mesh, element, remembered) result(work)
      class(point_histories_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element                         !! which element
      real(dp), intent(in) :: remembered(:)                  !! (numbers) by all points
      real(dp) :: work(most, 2)                              !! its points first [energy/volume]
      integer :: g, i

      work = 0.0_dp
      associate (law => self%library(self%sections(mesh%element_section(element))%material)%law)
         if (law%work == 0) return
         do g = 1, self%rules(mesh%element_kind(element))%count
            i = self%history_start(element) + (g - 1)*law%history_count + law%work - 1
            work(g, :) = remembered(i:i + 1)
         end do
      end associate
   end function inelastic_work

   !> Plastic strains of the points of an element, then those of creep, in columns; 0 of none.
   pure subroutine take_strains(self, mesh, element, remembered, strains)
      class(point_histories_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element                         !! which element
      real(dp), intent(in) :: remembered(:)                  !! (numbers) by all points
      !> Its points first; xx, yy, zz, the angle xy and the equivalent one of each
      real(dp), intent(out) :: strains(most, 10)
      integer :: g, i, k

      strains = 0.0_dp
      associate (law => self%library(self%sections(mesh%element_section(element))%material)%law)
         do k = 1, 2
            if (law%strains(k) == 0) cycle
            do g = 1, self%rules(mesh%element_kind(element))%count
               i = self%history_start(element) + (g - 1)*law%history_count + law%strains(k) - 1
               strains(g, 5*k - 4:5*k) = remembered(i:i + 4)
            end do
         end do
      end associate
   end subroutine take_strains

end module point_histories
