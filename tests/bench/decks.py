"""The deck of the cylinder for both programs; README.md says what differs from the published."""

from dataclasses import astuple, dataclass, replace  # noqa: F401

import meshes

# How many times smaller than published the strains are, and what conducts heat.
MODELS = {"small": (100.0, "closed"), "published": (1.0, "closed"), "gas": (1.0, "gas")}
RADIUS, YOUNG, EXPANSION = 100.0, 2e4, 1.2e-5
LOADS = (180.0, 360.0, 540.0, 720.0, 900.0)
# Temperatures of the top at the whole times; the last five are those at which runs are judged.
COURSES = {"even": (0.0, *LOADS), "doubling": (0.0, 22.5, 45.0, 90.0, *LOADS)}


@dataclass(frozen=True)
class Case:
    """A run: who solves what on which mesh in how many increments."""

    program: str
    family: str
    sides: int
    element: str
    course: str            # of the temperature, whose sections have as many increments each
    each: int
    penalty: float = 0.0   # [MPa/cm] of the published strains; CalculiX alone
    slope: float = 1.0     # stick slope by penalty
    model: str = "small"   # one of MODELS

    @property
    def small(self):
        """Return how many times smaller than published the strains are."""
        return MODELS[self.model][0]

    @property
    def order(self):
        """Return the order of the elements."""
        return 2 if "8" in self.element else 1

    @property
    def increments(self):
        """Return the number of increments."""
        return self.each * self.sections

    @property
    def sections(self):
        """Return the number of sections of the course, each a unit of time."""
        return len(COURSES[self.course]) - 1

    @property
    def name(self):
        """Return a name for the folder of the run."""
        return "-".join(f"{value:g}" if isinstance(value, float) else str(value)
                        for value in astuple(self))


def listed(numbers, width=10):
    """Return data cards of numbers."""
    return [", ".join(map(str, numbers[k:k + width])) for k in range(0, len(numbers), width)]


def mesh_cards(bodies, element):
    """Return the cards of nodes, elements, sets and surfaces."""
    cards = []
    names = "CYLINDER", "BASE"
    for body, name, surface in zip(bodies, names, ("CURVED", "FLAT"), strict=True):
        first = min(body.nodes)
        cards += [f"*NODE, NSET={name}"]
        cards += [f"{n}, {x:.12g}, {y:.12g}" for n, (x, y) in body.nodes.items()]
        cards += [f"*ELEMENT, TYPE={element}, ELSET={name}"]
        cards += [", ".join(map(str, [n, *e])) for n, e in enumerate(body.elements, start=first)]
        cards += [f"*SURFACE, NAME={surface}, TYPE=ELEMENT"]
        cards += [f"{first + k}, S1" for k in range(body.sides)]
        axis = [n for n, (x, _) in body.nodes.items() if x == 0.0]
        cards += [f"*NSET, NSET=AXIS{name}", *listed(axis)]
    for body, name, pick in zip(bodies, ("TOP", "BOTTOM"), (max, min), strict=True):
        height = pick(y for _, y in body.nodes.values())
        held = [n for n, (_, y) in body.nodes.items() if y == height]
        cards += [f"*NSET, NSET={name}", *listed(held)]
    return cards


def material(name, poisson, small):
    """Return the cards of a material."""
    return [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{YOUNG * small:.12g}, {poisson}",
            "*EXPANSION", f"{EXPANSION / small:.12g}", "*CONDUCTIVITY", "0.18"]


def common_cards(case, divided=True):
    """Return what both programs read alike, up to the interaction."""
    small, bodies = case.small, bodies_of(case, divided)
    return [*mesh_cards(bodies, case.element),
            *(hanging_cards(bodies) if divided else refinement(case)),
            *material("UPPER", 0.4, small), *material("LOWER", 0.2, small),
            "*SOLID SECTION, ELSET=CYLINDER, MATERIAL=UPPER", "1.",
            "*SOLID SECTION, ELSET=BASE, MATERIAL=LOWER", "1.",
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "CYLINDER, 0.", "BASE, 0.",
            "*BOUNDARY", "TOP, 2, 2, 0.", "BOTTOM, 2, 2, 0.",
            "AXISCYLINDER, 1, 1, 0.", "AXISBASE, 1, 1, 0.",
            "*SURFACE INTERACTION, NAME=FACES"]


CLOSED = ["*GAP CONDUCTANCE", "0.8, 0.", "480.8, 2000."]
LAWS = {"closed": CLOSED, "gas": [*CLOSED, "*GAP LAW, TYPE=GAS", "0.24E-5, 0.3E-5"]}
COUPLED = "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT"


def heated(top, course=""):
    """Return the cards of the temperatures."""
    return ["*BOUNDARY", "BOTTOM, 11, 11, 0.", f"*BOUNDARY{course}", f"TOP, 11, 11, {top!r}"]


def course(case, start=0.0):
    """Return the cards of the amplitude, which begins with a temperature."""
    rows = list(enumerate(COURSES[case.course]))
    first = [(0, start)] if start == 0.0 else [(0, start), (1 / case.each, rows[1][1] / case.each)]
    return ["*AMPLITUDE, NAME=RISE", *(f"{t!r}, {v!r}" for t, v in first + rows[1:]
                                       if (t, v) not in first[:-1])]


def bodies_of(case, divided=True):
    """Return cylinder and base as meshed."""
    return meshes.make(case.family, case.sides, case.order, RADIUS * case.small, divided)


def refinement(case):
    """Return the cards that refine a mesh where contact ends; the base follows the cylinder."""
    if case.family != "refined":
        return []
    row = meshes.face(case.family, case.sides)
    sides = [k for k, side in enumerate(zip(row, row[1:], strict=False), start=1)
             if meshes.is_divided(*side)]
    return ["*ELSET, ELSET=EDGE", *listed(sides), "*REFINE, LEVELS=1, ELSET=EDGE"]


def hanging_cards(bodies):
    """Return the equations of hanging nodes."""
    cards = []
    for node, terms in (item for body in bodies for item in body.hanging.items()):
        for dof in (1, 2, 11):
            cards += ["*EQUATION", f"{len(terms) + 1}", ", ".join(
                [f"{node}, {dof}, -1."] + [f"{n}, {dof}, {factor}" for n, factor in terms.items()])]
    return cards


def thercon_deck(case):
    """Return the deck for thercon, which writes fields at the end alone."""
    law = LAWS[MODELS[case.model][1]]
    return ["*OPTIONS, WIDTH=200, LOAD=TOP,11, ERRORS=NO", *common_cards(case, divided=False),
            "*FRICTION", "0.155", *law,
            "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "CURVED, FLAT", *course(case),
            f"*STEP, INC={case.increments}", COUPLED, f"{1 / case.each!r}, {case.sections}",
            *heated(1.0, ", AMPLITUDE=RISE"), "*NODE FILE, FREQUENCY=0", "U", "*END STEP"]


# A first small step: CalculiX does not find a contact that closes in a large first increment, and
# ramps out over the whole of the first step what overlaps in it.
FIRST = 0.5
CONTROLS = ["*CONTROLS, PARAMETERS=TIME INCREMENTATION", "40, 60, 9, 100, 10, 4, , 20, , "]


def calculix_deck(case):
    """Return the deck for CalculiX: sums of reactions and the displacements of both faces."""
    bodies = bodies_of(case)
    penalty = case.penalty * case.small
    faces = [n for body in bodies for n, (_, y) in list(body.nodes.items())[: face_nodes(body)]]
    cards = [*common_cards(case),
             "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{penalty:.12g}, 1.",
             "*FRICTION", f"0.155, {penalty * case.slope:.12g}", *CLOSED,
             "*CONTACT PAIR, INTERACTION=FACES, TYPE=SURFACE TO SURFACE", "CURVED, FLAT",
             "*NSET, NSET=FACES", *listed(faces),
             *course(case, FIRST),
             "*STEP", COUPLED, "1., 1.", *CONTROLS, *heated(FIRST), "*END STEP",
             "*STEP, INC=1000", COUPLED, f"{1 / case.each!r}, {case.sections}", *CONTROLS,
             *heated(1.0, ", AMPLITUDE=RISE")]
    prints = [f"*NODE PRINT, NSET={name}, TOTALS=ONLY, FREQUENCY={case.each}\n{quantity}"
              for name, quantity in (("TOP", "RF, RFL"), ("AXISCYLINDER", "RF"))]
    return [*cards, *prints, f"*NODE PRINT, NSET=FACES, FREQUENCY={case.each}", "U", "*END STEP"]


def face_nodes(body):
    """Return how many nodes a face has; they are the first of each body."""
    return body.sides * (2 if len(body.elements[0]) == 8 else 1) + 1
