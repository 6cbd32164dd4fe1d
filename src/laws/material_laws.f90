!> Laws of materials beyond linear thermoelasticity, with a history at each point.
module material_laws
   use creep_laws, only: creep_type
   use hardening_laws, only: hardening_type
   use kinds, only: dp
   implicit none
   private
   public :: law_interval_type, material_law_type, law_points_type, most_points_of_law

   integer, parameter :: most_points_of_law = 10   !! of an element, made even
   integer, parameter :: most = most_points_of_law

   !> Points of an element of one material, along x, y and z; its points first.
   type :: law_points_type
      integer :: count = 0                         !! number of points
      integer :: plane = 0                         !! plane_strain, ...
      real(dp) :: strain(most, 4) = 0.0_dp         !! xx, yy, zz and the angle xy [-]
      real(dp) :: temperature(most) = 0.0_dp       !! [temperature]
      !> xx, yy, zz, xy: of thermoelasticity with initial stress; the law replaces it [stress]
      real(dp) :: stress(most, 4) = 0.0_dp
      !> (4, 4, points) of stress by strain: of elasticity; the law replaces it [stress]
      real(dp) :: tangent(4, 4, most) = 0.0_dp
      !> Part of the elasticity that a point resists with at most
      real(dp) :: stiffness(most) = 1.0_dp
      logical :: failed = .false.                  !! whether the law found no stress
   end type law_points_type

   !> The time that passes between two histories: a stage of an increment, or the whole of it.
   type :: law_interval_type
      real(dp) :: duration = 0.0_dp                !! [time]
      real(dp) :: instants(2) = 0.0_dp !! start and end of the increment, total time [time]
      logical :: is_last = .true.                  !! whether it ends the increment
      !> Part that it has of an increment in real time; 0 of one whose time is the load's
      real(dp) :: real_part = 0.0_dp
   end type law_interval_type

   !> The law of a material: none by default.
   type :: material_law_type
      integer :: history_count = 0                 !! history variables of a point
      !> Where the strains of plasticity and of creep begin among these: xx, yy, zz, the angle xy
      !> and the equivalent one; 0 for none
      integer :: strains(2) = 0
      integer :: work = 0 !! where that of both begins, so far [energy/volume]; 0 for none
      real(dp) :: heat_fraction = 0.0_dp           !! part of this work that heats the body
      !> (history_count) variables that change with time; others change with strain alone, and at
      !> once where that jumps. All where this is unallocated
      logical, allocatable :: of_time(:)
      real(dp), allocatable :: constants(:)
      type(hardening_type) :: hardening
      type(creep_type) :: creep
      procedure(response), pointer, nopass :: respond => null()
      ! Of a material that carries no stress above a temperature: this, where the history of
      ! annealing begins, 0 for none, and the law below it, or none of elasticity.
      real(dp) :: anneal_temperature = huge(1.0_dp)
      integer :: annealing = 0
      procedure(response), pointer, nopass :: respond_solid => null()
   end type material_law_type

   abstract interface
      !> Stress, tangent and history of the points after a time. A response of no duration, to the
      !> strain that a history belongs to, has its stress and leaves it as it is. An increment
      !> in which a law fails is shortened.
      pure subroutine response(law, points, interval, history)
         import :: dp, law_interval_type, law_points_type, material_law_type
         type(material_law_type), intent(in) :: law
         type(law_points_type), intent(inout) :: points
         type(law_interval_type), intent(in) :: interval
         real(dp), intent(inout) :: history(:, :)  !! (numbers, points) of its start, of its end
      end subroutine response
   end interface

end module material_laws
