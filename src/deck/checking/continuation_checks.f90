!> Checks of steps of which a branch is followed: it is one of steady states whose loads are
!> proportional to the load factor.
module continuation_checks
   use cards, only: cards_type
   use deck_context, only: deck_type
   use kinds, only: dp
   use model, only: follows_temperatures, model_type
   use steps, only: analysis_coupled, load_film_coefficient, step_type
   use text, only: to_text
   implicit none
   private
   public :: check_continuations

contains

   !> Reports what stands against the *CONTINUATION of each step.
   subroutine check_continuations(cards, model, deck)
      type(cards_type), intent(in) :: cards
      type(model_type), intent(in) :: model               !! with its loads
      type(deck_type), intent(inout) :: deck   !! receives errors
      character(:), allocatable :: obstacle
      integer :: k, n

      n = 0
      do k = 1, size(cards%keywords)
         if (cards%keywords(k)%name == 'STEP') n = n + 1
         if (cards%keywords(k)%name /= 'CONTINUATION' .or. n == 0) cycle
         obstacle = obstacle_of_analysis(model, model%steps(n))
         if (obstacle == '') obstacle = obstacle_of_loads(model, n)
         if (obstacle == '') obstacle = obstacle_of_start(model%steps(n))
         if (obstacle /= '') call deck%error(cards%keywords(k)%place, obstacle)
      end do
   end subroutine check_continuations

   !> Why the analysis of a step has no branch of steady states; nothing where it has.
   pure function obstacle_of_analysis(model, step) result(words)
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      character(:), allocatable :: words
      integer :: i

      words = ''
      if (step%is_transient) then
         words = '*CONTINUATION follows steady states, but the step stores heat; give STEADY STATE'
      else if (step%analysis /= analysis_coupled) then
         words = '*CONTINUATION needs *COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, and heat'
      else if (step%scheme%name /= 'IMPLICIT') then
         words = '*CONTINUATION needs *THERMAL SCHEME, TYPE=IMPLICIT: with '// &
            trim(step%scheme%name)//' a state depends on the increments before'
      else if (follows_temperatures(model)) then
         words = '*CONTINUATION needs properties that are the same at all temperatures'
      else if (step%restart_frequency > 0) then
         words = '*CONTINUATION keeps no states for a restart; give *RESTART, WRITE, '// &
            'FREQUENCY=0 in this step'
      end if
      if (words /= '') return
      do i = 1, size(model%contacts)
         associate (interaction => model%interactions(model%contacts(i)%interaction))
            if (interaction%heat%efficiency <= 0.0_dp .or. interaction%heat%leaves_plane()) cycle
            words = '*CONTINUATION has no time, by which slip in '//model%contacts(i)%name// &
               ' would make heat; give *GAP HEAT GENERATION a velocity, or leave it out'
         end associate
      end do
   end function obstacle_of_analysis

   !> Why the loads of a step are not proportional to the load factor.
   function obstacle_of_loads(model, n) result(words)
      type(model_type), intent(in) :: model
      integer, intent(in) :: n                  ! number of the step
      character(:), allocatable :: words
      integer :: amplitude, s

      words = ''
      amplitude = 0
      do s = 1, n
         associate (step => model%steps(s))
            call look_at(step%boundaries%amplitude, s)
            call look_at(step%loads%amplitude, s)
         end associate
      end do
      associate (step => model%steps(n))
         if (amplitude > 0) then
            words = 'loads of *CONTINUATION are proportional to the load factor, but some '// &
               'follow amplitude '//model%amplitudes(amplitude)%name//'; leave out '// &
               'AMPLITUDE= in this step'
         else if (.not. step%ramped) then
            words = 'loads of *CONTINUATION grow with the load factor; leave out '// &
               'AMPLITUDE=STEP on *STEP'
         else if (any(step%loads%kind == load_film_coefficient) .or. &
            step%ends_loads(load_film_coefficient)) then
            words = 'films change the conduction, to which no load factor is proportional; '// &
               'give *FILM in a step before that of *CONTINUATION'
         else if (allocated(step%changes%interferences)) then
            words = 'give *CONTACT INTERFERENCE in a step before that of *CONTINUATION: the '// &
               'branch follows loads and prescribed values'
         end if
      end associate
   contains
      !> The first amplitude that loads of the step follow.
      subroutine look_at(amplitudes, given_in)
         integer, intent(in) :: amplitudes(:), given_in
         integer :: i

         do i = 1, size(amplitudes)
            if (amplitude > 0 .or. amplitudes(i) == 0) cycle
            if (given_in == n .or. model%amplitudes(amplitudes(i))%total_time) amplitude = &
               amplitudes(i)
         end do
      end subroutine look_at
   end function obstacle_of_loads

   !> Why the first increment is no point to begin at.
   pure function obstacle_of_start(step) result(words)
      type(step_type), intent(in) :: step
      character(:), allocatable :: words
      real(dp) :: first

      words = ''
      first = step%first_increment/step%period
      associate (range => step%continuation%range)
         if (first < range(1) .or. first > range(2)) then
            words = 'the branch begins with the first increment, at load factor '// &
               to_text(first)//', outside its range from '//to_text(range(1))//' to '// &
               to_text(range(2))
         else if (step%continuation%rises .and. first >= range(2)) then
            words = 'the branch begins with the first increment, at load factor '// &
               to_text(first)//', the end of its range; give a shorter first increment, a '// &
               'higher HIGHEST= or DIRECTION=DOWN'
         else if (.not. step%continuation%rises .and. first <= range(1)) then
            words = 'the branch begins with the first increment, at load factor '// &
               to_text(first)//', the end of its range; give a longer first increment, a lower '// &
               'LOWEST= or DIRECTION=UP'
         end if
      end associate
   end function obstacle_of_start

end module continuation_checks
