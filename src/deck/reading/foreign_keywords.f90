!> Keywords of CalculiX and Abaqus that are no keywords of this program: which are passed over, and
!> which are refused and why. Decks that were written elsewhere use them.
module foreign_keywords
   use spelling, only: is_slip
   use text, only: is_same_name
   implicit none
   private
   public :: foreign_keyword_type, find_foreign, misspelt_foreign
   public :: passed_over, not_printed, refused_with_data, refused_always

   integer, parameter :: passed_over = 1        !! means nothing to this program
   integer, parameter :: not_printed = 2        !! asks for output that there is not
   integer, parameter :: refused_with_data = 3  !! means something only with data cards
   integer, parameter :: refused_always = 4     !! means something that is not modelled

   !> One keyword.
   type :: foreign_keyword_type
      character(36) :: name = ''         !! without the star
      integer :: status = 0              !! one of the four above; 0 for none
      character(20) :: stands_for = ''   !! keyword of this program in whose place it is
      character(100) :: reason = ''      !! why it is passed over or refused, and what to do
   end type foreign_keyword_type

   character(*), parameter :: linear = &
      'materials are linear: *ELASTIC, *EXPANSION, *CONDUCTIVITY; leave it out'
   character(*), parameter :: analyses = &
      'steps are *STATIC, or STEADY STATE *HEAT TRANSFER or *COUPLED TEMPERATURE-DISPLACEMENT'
   character(*), parameter :: plane = &
      'elements are plane: CPE, CPS or CAX, with *SOLID SECTION'
   character(*), parameter :: held = &
      'bodies are held by *BOUNDARY, contact, *TIE, *EQUATION and *COUPLING'
   character(*), parameter :: fixed = &
      'materials, elements and sections are the same in all steps'
   character(*), parameter :: sums = &
      'sums over a set of nodes: *NODE PRINT, TOTALS=ONLY; over a contact: /contact of the result'
   character(*), parameter :: general = 'it belongs to *CONTACT'
   character(*), parameter :: fluid = 'there are no fluids'

   type(foreign_keyword_type), parameter :: ignored(18) = [ &
      foreign_keyword_type('CONTACT INCLUSIONS', passed_over, '', general), &
      foreign_keyword_type('CONTACT EXCLUSIONS', passed_over, '', general), &
      foreign_keyword_type('CONTACT PROPERTY ASSIGNMENT', passed_over, '', general), &
      foreign_keyword_type('CONTACT INITIALIZATION ASSIGNMENT', passed_over, '', general), &
      foreign_keyword_type('CONTACT FORMULATION', passed_over, '', general), &
      foreign_keyword_type('CONTACT CONTROLS', passed_over, '', 'contact is exact'), &
      foreign_keyword_type('SECTION CONTROLS', passed_over, '', &
      'elements have no hourglass modes'), &
      foreign_keyword_type('OUTPUT', passed_over, '', 'fields are written at every increment'), &
      foreign_keyword_type('DAMPING', passed_over, '', 'loads are slow'), &
      foreign_keyword_type('CONTACT DAMPING', passed_over, '', 'loads are slow'), &
      foreign_keyword_type('NORMAL', passed_over, '', 'the normal of the plane is z'), &
      foreign_keyword_type('DEPVAR', passed_over, '', 'materials have no state'), &
      foreign_keyword_type('PREPRINT', passed_over, '', 'the listing has the whole deck'), &
      foreign_keyword_type('PRINT', passed_over, '', 'the listing has all that it has to say'), &
      foreign_keyword_type('MONITOR', passed_over, '', 'the result has all nodes'), &
      foreign_keyword_type('SECTION PRINT', not_printed, '', sums), &
      foreign_keyword_type('FACE PRINT', not_printed, '', sums), &
      foreign_keyword_type('RADIATE', refused_with_data, '', &
      'heat leaves sides by *FILM and *DFLUX; only contact gaps radiate')]

   type(foreign_keyword_type), parameter :: properties(19) = [ &
      foreign_keyword_type('PLASTIC', refused_always, '', linear), &
      foreign_keyword_type('CYCLIC HARDENING', refused_always, '', linear), &
      foreign_keyword_type('DEFORMATION PLASTICITY', refused_always, '', linear), &
      foreign_keyword_type('HYPERELASTIC', refused_always, '', linear), &
      foreign_keyword_type('HYPERFOAM', refused_always, '', linear), &
      foreign_keyword_type('CREEP', refused_always, '', linear), &
      foreign_keyword_type('USER MATERIAL', refused_always, '', linear), &
      foreign_keyword_type('SHELL SECTION', refused_always, 'SOLID SECTION', plane), &
      foreign_keyword_type('BEAM SECTION', refused_always, 'SOLID SECTION', plane), &
      foreign_keyword_type('BEAM GENERAL SECTION', refused_always, 'SOLID SECTION', plane), &
      foreign_keyword_type('MEMBRANE SECTION', refused_always, 'SOLID SECTION', plane), &
      foreign_keyword_type('FLUID SECTION', refused_always, 'SOLID SECTION', fluid), &
      foreign_keyword_type('FLUID CONSTANTS', refused_always, '', fluid), &
      foreign_keyword_type('SPECIFIC GAS CONSTANT', refused_always, '', fluid), &
      foreign_keyword_type('MASS FLOW', refused_always, '', fluid), &
      foreign_keyword_type('NODAL THICKNESS', refused_always, '', &
      'give the thickness on *SOLID SECTION'), &
      foreign_keyword_type('DISTRIBUTION', refused_always, '', &
      'give the axes of each element set on an *ORIENTATION of its own'), &
      foreign_keyword_type('GAP HEAT GENERATION', refused_always, '', 'friction makes no heat'), &
      foreign_keyword_type('VIEWFACTOR', refused_always, '', 'only contact gaps radiate')]

   type(foreign_keyword_type), parameter :: connections(14) = [ &
      foreign_keyword_type('CONTACT', refused_always, 'CONTACT PAIR', &
      'there is no general contact; name the faces of each *CONTACT PAIR'), &
      foreign_keyword_type('KINEMATIC COUPLING', refused_always, '', held), &
      foreign_keyword_type('DISTRIBUTING', refused_always, '', held), &
      foreign_keyword_type('DISTRIBUTING COUPLING', refused_always, '', held), &
      foreign_keyword_type('CYCLIC SYMMETRY MODEL', refused_always, '', held), &
      foreign_keyword_type('PRE-TENSION SECTION', refused_always, '', held), &
      foreign_keyword_type('SUBMODEL', refused_always, '', held), &
      foreign_keyword_type('SPRING', refused_always, '', held), &
      foreign_keyword_type('DASHPOT', refused_always, '', held), &
      foreign_keyword_type('GAP', refused_always, '', 'name the faces of a *CONTACT PAIR'), &
      foreign_keyword_type('MASS', refused_always, '', 'weight is *DENSITY with GRAV on *DLOAD'), &
      foreign_keyword_type('CHANGE MATERIAL', refused_always, '', fixed), &
      foreign_keyword_type('CHANGE SOLID SECTION', refused_always, '', fixed), &
      foreign_keyword_type('CHANGE SURFACE BEHAVIOR', refused_always, '', fixed)]

   type(foreign_keyword_type), parameter :: procedures(14) = [ &
      foreign_keyword_type('FREQUENCY', refused_always, 'STATIC', analyses), &
      foreign_keyword_type('COMPLEX FREQUENCY', refused_always, 'STATIC', analyses), &
      foreign_keyword_type('BUCKLE', refused_always, 'STATIC', analyses), &
      foreign_keyword_type('DYNAMIC', refused_always, 'STATIC', analyses), &
      foreign_keyword_type('MODAL DYNAMIC', refused_always, 'STATIC', analyses), &
      foreign_keyword_type('STEADY STATE DYNAMICS', refused_always, 'STATIC', analyses), &
      foreign_keyword_type('VISCO', refused_always, 'STATIC', analyses), &
      foreign_keyword_type('UNCOUPLED TEMPERATURE-DISPLACEMENT', refused_always, 'STATIC', &
      analyses), &
      foreign_keyword_type('SENSITIVITY', refused_always, 'STATIC', analyses), &
      foreign_keyword_type('GREEN', refused_always, 'STATIC', analyses), &
      foreign_keyword_type('ELECTROMAGNETICS', refused_always, 'STATIC', analyses), &
      foreign_keyword_type('CFD', refused_always, 'STATIC', analyses), &
      foreign_keyword_type('NO ANALYSIS', refused_always, 'STATIC', &
      'thercon check DECK reads a deck without solving it'), &
      foreign_keyword_type('TIME POINTS', refused_always, '', &
      'FREQUENCY= selects the increments that are printed; increments end at the times of *VERIFY')]

   type(foreign_keyword_type), parameter :: all_foreign(65) = &
      [ignored, properties, connections, procedures]

contains

   !> What is known of a foreign keyword, whatever its case and blanks; status 0 for one that nobody
   !> knows.
   pure function find_foreign(name) result(found)
      character(*), intent(in) :: name      !! without the star
      type(foreign_keyword_type) :: found   !! what the table says of it
      integer :: i

      do i = 1, size(all_foreign)
         if (.not. is_same_name(all_foreign(i)%name, name)) cycle
         found = all_foreign(i)
         return
      end do
   end function find_foreign

   !> The foreign keyword of which another one is likely a misspelling; empty where there is none.
   pure function misspelt_foreign(name) result(found)
      character(*), intent(in) :: name      !! without the star
      character(:), allocatable :: found
      integer :: i

      found = ''
      do i = 1, size(all_foreign)
         if (is_slip(name, trim(all_foreign(i)%name))) found = trim(all_foreign(i)%name)
      end do
   end function misspelt_foreign

end module foreign_keywords
