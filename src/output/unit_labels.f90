!> Units of reported quantities in the labels of *OPTIONS, UNITS=.
module unit_labels
   use model, only: unit_labels_type
   use text, only: or_blank
   implicit none
   private
   public :: unit_label, unit_in_words

contains

   !> The unit of a quantity in print, such as `MPa cm^2` for `stress length^2`, N where that is
   !> one; empty where the deck has no labels, '-' for a pure number. Words without a label stay.
   pure function unit_label(unit, labels) result(words)
      character(*), intent(in) :: unit                  !! unit of quantity_type
      type(unit_labels_type), intent(in) :: labels      !! those of the deck
      character(:), allocatable :: words

      words = trim(unit)
      if (words == '-') return
      words = ''
      if (or_blank(labels%length) /= '') words = with_labels(trim(unit), labels)
      if (words == 'MPa mm^2' .or. words == 'Pa m^2') words = 'N'
   end function unit_label

   !> The unit in files, forces as stress times area; where the deck has no labels, what is
   !> measured.
   pure function unit_in_words(unit, labels) result(words)
      character(*), intent(in) :: unit                  !! unit of quantity_type
      type(unit_labels_type), intent(in) :: labels      !! those of the deck
      character(:), allocatable :: words

      words = trim(unit)
      if (or_blank(labels%length) /= '') words = with_labels(words, labels)
   end function unit_in_words

   pure function with_labels(unit, labels) result(words)
      character(*), intent(in) :: unit
      type(unit_labels_type), intent(in) :: labels
      character(:), allocatable :: words

      words = with('length', labels%length, unit)
      words = with('stress', labels%stress, words)
      words = with('power', labels%power, words)
      words = with('temperature', labels%temperature, words)
      words = with('time', labels%time, words)
   end function with_labels

   !> A text with a label for one of its words.
   pure recursive function with(word, label, text) result(changed)
      character(*), intent(in) :: word, text
      character(:), allocatable, intent(in) :: label     ! unallocated or empty for none
      character(:), allocatable :: changed
      integer :: k

      changed = text
      k = index(text, word)
      if (k == 0) return
      if (or_blank(label) /= '') changed = text(:k - 1)//label//with(word, label, &
         text(k + len(word):))
   end function with

end module unit_labels
