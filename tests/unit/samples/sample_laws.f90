!> A law of materials that remembers: linear, with a clock and a counter for its history.
module sample_laws
   use kinds, only: dp
   use material_laws, only: law_interval_type, law_points_type, material_law_type
   implicit none
   private
   public :: counting_law, failing_law

contains

   !> Stress is a part of that of thermoelasticity; a point remembers for how long, and how many
   !> times, it responded.
   function counting_law(part) result(law)
      real(dp), intent(in) :: part
      type(material_law_type) :: law

      law%history_count = 2
      law%constants = [part]
      law%respond => respond
   end function counting_law

   !> Thermoelasticity that finds no stress in long increments.
   function failing_law(longest) result(law)
      real(dp), intent(in) :: longest   !! that it survives [time]
      type(material_law_type) :: law

      law%history_count = 1
      law%constants = [longest]
      law%respond => fail
   end function failing_law

   pure subroutine fail(law, points, interval, history)
      type(material_law_type), intent(in) :: law
      type(law_points_type), intent(inout) :: points
      type(law_interval_type), intent(in) :: interval
      real(dp), intent(inout) :: history(:, :)

      points%failed = interval%duration > law%constants(1)
      history = history + interval%duration
   end subroutine fail

   pure subroutine respond(law, points, interval, history)
      type(material_law_type), intent(in) :: law
      type(law_points_type), intent(inout) :: points
      type(law_interval_type), intent(in) :: interval
      real(dp), intent(inout) :: history(:, :)

      points%stress(:points%count, :) = law%constants(1)*points%stress(:points%count, :)
      points%tangent(:, :, :points%count) = law%constants(1)*points%tangent(:, :, :points%count)
      history(1, :) = history(1, :) + interval%duration
      if (interval%duration > 0.0_dp) history(2, :) = history(2, :) + 1
   end subroutine respond

end module sample_laws
