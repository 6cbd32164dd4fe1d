!> Keywords and parameters that mean something the dialect says otherwise: words of other programs
!> and of the field -> what to write here. Spelling alone would suggest *HEADING for *SRADIATE.
module keyword_meanings
   use text, only: is_same_name, to_upper, without_blanks
   implicit none
   private
   public :: keyword_advice, is_meaning, parameter_advice

   !> What to write in place of a keyword, found by a word in it.
   type :: keyword_meaning_type
      character(13) :: word      !! part of the keyword, without blanks
      character(96) :: advice    !! what to write
   end type keyword_meaning_type

   !> What to write in place of a parameter.
   type :: parameter_meaning_type
      character(20) :: keyword     !! the keyword that has it; blank for any
      character(22) :: parameter   !! the parameter
      character(96) :: advice      !! what to write
   end type parameter_meaning_type

   character(*), parameter :: radiation = &
      'heat leaves faces by *FILM and *DFLUX; only contact gaps radiate'
   character(*), parameter :: heat = &
      'heat is applied by *CFLUX at nodes, *DFLUX on faces and in bodies'
   character(*), parameter :: films = 'convection is *FILM, on element faces or on a *SURFACE'
   character(*), parameter :: forces = &
      'forces are *CLOAD at nodes, *DLOAD on elements, *DSLOAD on surfaces'
   character(*), parameter :: pressures = &
      'pressure is P1 to P4 on *DLOAD, or P on *DSLOAD for a *SURFACE'
   character(*), parameter :: masses = 'weight and rotation are GRAV and CENTRIF on *DLOAD'
   character(*), parameter :: supports = &
      '*BOUNDARY prescribes displacements (1, 2) and temperatures (11)'
   character(*), parameter :: temperatures = &
      '*BOUNDARY prescribes temperatures (11), *INITIAL CONDITIONS gives the first ones'
   character(*), parameter :: elasticity = '*ELASTIC has Young''s modulus and Poisson''s ratio'
   character(*), parameter :: capacity = 'heat capacity is not modelled; leave it out'
   character(*), parameter :: interfaces = &
      'the conductance of a contact is *GAP LAW or *GAP CONDUCTANCE'
   character(*), parameter :: contact = &
      'contact is *SURFACE, *SURFACE INTERACTION and *CONTACT PAIR'
   character(*), parameter :: output = 'fields are always written; tables are *NODE PRINT, '// &
      '*EL PRINT, *CONTACT PRINT'
   character(*), parameter :: iteration = 'tolerance and iterations are parameters of *FIXED POINT'
   character(*), parameter :: increments = &
      'increments and period are the data of *STATIC, *HEAT TRANSFER or *COUPLED ...'

   !> The first word that a keyword has decides.
   type(keyword_meaning_type), parameter :: of_keywords(54) = [ &
      keyword_meaning_type('GAPRADIA', &
      'gaps radiate by EMISSIVITY= of *GAP LAW, such as *GAP LAW, TYPE=GAS, EMISSIVITY=0.8'), &
      keyword_meaning_type('RADIA', radiation), &
      keyword_meaning_type('FLUX', heat), &
      keyword_meaning_type('CECHARGE', heat), &
      keyword_meaning_type('HEATSOURCE', heat), &
      keyword_meaning_type('HEATGEN', heat), &
      keyword_meaning_type('FILM', films), &
      keyword_meaning_type('CONVECT', films), &
      keyword_meaning_type('COOLING', films), &
      keyword_meaning_type('PRESSURE', pressures), &
      keyword_meaning_type('TRACTION', pressures), &
      keyword_meaning_type('GRAVITY', masses), &
      keyword_meaning_type('WEIGHT', masses), &
      keyword_meaning_type('CENTRIF', masses), &
      keyword_meaning_type('ROTATION', masses), &
      keyword_meaning_type('FORCE', forces), &
      keyword_meaning_type('LOAD', forces), &
      keyword_meaning_type('DISPLACEMENT', supports), &
      keyword_meaning_type('SPC', supports), &
      keyword_meaning_type('SUPPORT', supports), &
      keyword_meaning_type('CONSTRAINT', supports), &
      keyword_meaning_type('FIXED', supports), &
      keyword_meaning_type('SYMMETRY', supports), &
      keyword_meaning_type('TEMP', temperatures), &
      keyword_meaning_type('POISSON', elasticity), &
      keyword_meaning_type('YOUNG', elasticity), &
      keyword_meaning_type('MODULUS', elasticity), &
      keyword_meaning_type('STIFFNESS', elasticity), &
      keyword_meaning_type('CAPACITY', capacity), &
      keyword_meaning_type('LATENT', capacity), &
      keyword_meaning_type('ENTHALPY', capacity), &
      keyword_meaning_type('ALPHA', 'the coefficient of thermal expansion is *EXPANSION'), &
      keyword_meaning_type('CTE', 'the coefficient of thermal expansion is *EXPANSION'), &
      keyword_meaning_type('CONDUCTANCE', interfaces), &
      keyword_meaning_type('RESISTANCE', interfaces), &
      keyword_meaning_type('INTERFERENCE', &
      'give an overlap as a negative VALUE= of *CLEARANCE'), &
      keyword_meaning_type('OVERCLOSURE', &
      'give an overlap as a negative VALUE= of *CLEARANCE'), &
      keyword_meaning_type('CONTACT', contact), &
      keyword_meaning_type('THICKNESS', 'the thickness is the data of *SOLID SECTION'), &
      keyword_meaning_type('SECTION', 'bodies have *SOLID SECTION'), &
      keyword_meaning_type('COORDINATE', 'nodes and their coordinates are *NODE'), &
      keyword_meaning_type('GRID', 'nodes and their coordinates are *NODE'), &
      keyword_meaning_type('CONNECTIVITY', 'elements and their nodes are *ELEMENT'), &
      keyword_meaning_type('TOPOLOGY', 'elements and their nodes are *ELEMENT'), &
      keyword_meaning_type('TITLE', 'the title is the data of *HEADING'), &
      keyword_meaning_type('OUTPUT', output), &
      keyword_meaning_type('FILE', output), &
      keyword_meaning_type('PRINT', output), &
      keyword_meaning_type('TOLERANCE', iteration), &
      keyword_meaning_type('ITERATION', iteration), &
      keyword_meaning_type('CONVERGENCE', iteration), &
      keyword_meaning_type('INCREMENT', increments), &
      keyword_meaning_type('PERIOD', increments), &
      keyword_meaning_type('TIME', increments)]

   character(*), parameter :: coulomb = 'friction is Coulomb''s with one coefficient; leave it out'
   character(*), parameter :: exact = 'contact is exact; leave it out'

   type(parameter_meaning_type), parameter :: of_parameters(11) = [ &
      parameter_meaning_type('', 'RIKS', &
      'loads and temperatures follow the time; leave it out'), &
      parameter_meaning_type('', 'MXDEM', capacity), &
      parameter_meaning_type('', 'CREEP', 'materials are linear; leave it out'), &
      parameter_meaning_type('', 'DEPENDENCIES', 'properties are constant; leave it out'), &
      parameter_meaning_type('', 'TEMPERATURE', 'properties are constant; leave it out'), &
      parameter_meaning_type('', 'INPUT', 'data in a file of their own are *INCLUDE, INPUT='), &
      parameter_meaning_type('', 'INSTANCE', 'write the name as INSTANCE.NAME'), &
      parameter_meaning_type('FRICTION', 'LAGRANGE', coulomb), &
      parameter_meaning_type('CONTACT PAIR', 'HCRIT', exact), &
      parameter_meaning_type('CONTACT PAIR', 'MECHANICAL CONSTRAINT', exact), &
      parameter_meaning_type('CONTACT PAIR', 'EXTENSION ZONE', exact)]

contains

   !> What to write in place of an unknown keyword; empty where its words tell nothing.
   pure function keyword_advice(name) result(advice)
      character(*), intent(in) :: name         !! without the star
      character(:), allocatable :: advice      !! such as "forces are *CLOAD at nodes, ..."
      character(:), allocatable :: wanted
      integer :: i

      advice = ''
      wanted = to_upper(without_blanks(name))
      do i = 1, size(of_keywords)
         if (index(wanted, trim(of_keywords(i)%word)) == 0) cycle
         advice = trim(of_keywords(i)%advice)
         return
      end do
   end function keyword_advice

   !> Whether an unknown keyword is itself a word that tells what is meant, so that its spelling
   !> does not count.
   pure logical function is_meaning(name)
      character(*), intent(in) :: name         !! without the star

      is_meaning = any(of_keywords%word == to_upper(without_blanks(name)))
   end function is_meaning

   !> What to write in place of an unknown parameter; empty where nothing is known of it.
   pure function parameter_advice(keyword, name) result(advice)
      character(*), intent(in) :: keyword      !! as in the table of keywords
      character(*), intent(in) :: name         !! the parameter as written
      character(:), allocatable :: advice      !! such as "contact is exact; leave it out"
      integer :: i

      advice = ''
      do i = 1, size(of_parameters)
         if (.not. is_same_name(of_parameters(i)%parameter, name)) cycle
         if (all(of_parameters(i)%keyword /= [character(20) :: keyword, ''])) cycle
         advice = trim(of_parameters(i)%advice)
         return
      end do
   end function parameter_advice

end module keyword_meanings
