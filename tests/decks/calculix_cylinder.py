"""The published cylinder as a deck for CalculiX, which thercon runs as it is."""

from itertools import pairwise

PENALTY = 1.0e5   # of CalculiX, MPa/cm; its stick slope is the same
FIRST = 0.018     # degrees of a first step that settles the penalty at the initial touch


def graded(count, length, share, power):
    """Return count + 1 positions from 0 to length, dense at 0 with about share of the mean there."""
    places = [k / count for k in range(count + 1)]
    return [length * (share * s + (1.0 - share) * s**power) for s in places]


def body(name, first, first_element, heights, face, turned):
    """Return the cards of a body that has its face along the contact.

    heights are the corner rows from the contact as fractions of the body, face(x) the height of
    the face, turned says that the body lies below it.
    """
    xs, bottom = heights["x"], -60.0 if turned else 60.0
    rows, columns = len(heights["y"]) - 1, len(xs) - 1
    numbers, nodes = {}, []

    def fine(corners):
        return [v for p, q in pairwise(corners) for v in (p, (p + q) / 2)] + [corners[-1]]

    for j, eta in enumerate(fine(heights["y"])):
        for i, x in enumerate(fine(xs)):
            if i % 2 and j % 2:
                continue
            numbers[i, j] = first + len(nodes)
            nodes.append(f"{numbers[i, j]}, {x:.12g}, {face(x) + (bottom - face(x)) * eta:.12g}")
    elements = []
    for j in range(0, 2 * rows, 2):
        for i in range(0, 2 * columns, 2):
            around = [(i, j), (i + 2, j), (i + 2, j + 2), (i, j + 2)]
            if turned:
                around = [around[k] for k in (3, 2, 1, 0)]
            middles = [((p[0] + q[0]) // 2, (p[1] + q[1]) // 2)
                       for p, q in pairwise([*around, around[0]])]
            fields = [first_element + len(elements), *(numbers[p] for p in around + middles)]
            elements.append(", ".join(map(str, fields)))
    side = "S3" if turned else "S1"
    return [
        "*NODE, NSET=Nall", *nodes,
        f"*ELEMENT, TYPE=CPE8, ELSET=E{name}", *elements,
        f"*NSET, NSET=N{name}axis", *(f"{n}," for (i, _), n in numbers.items() if i == 0),
        f"*NSET, NSET=N{name}end", *(f"{n}," for (_, j), n in numbers.items() if j == 2 * rows),
        f"*SURFACE, NAME=S{name}, TYPE=ELEMENT",
        *(f"{first_element + k}, {side}" for k in range(columns)),
    ], first + len(nodes), first_element + len(elements)


def cylinder(count, last=900.0, increment=20.0, output="20"):
    """Return the cards for CalculiX with count elements along the contact, heated to last."""
    heights = {"x": graded(count, 30.0, 0.15, 3), "y": graded(count, 1.0, 0.2, 3)}
    upper, node, element = body("upper", 1, 1, heights, lambda x: x * x / 200.0, turned=False)
    lower, _, _ = body("lower", node, element, heights, lambda x: 0.0 * x, turned=True)
    materials = []
    for name, poisson in (("upper", 0.4), ("lower", 0.2)):
        materials += [f"*MATERIAL, NAME={name}", "*ELASTIC", f"20000., {poisson}",
                      "*EXPANSION, ZERO=0.", "1.2E-5", "*CONDUCTIVITY", "0.18",
                      f"*SOLID SECTION, ELSET=E{name}, MATERIAL={name}", "1."]
    contact = ["*SURFACE INTERACTION, NAME=faces",
               "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{PENALTY}",
               "*FRICTION", f"0.155, {PENALTY}",
               "*GAP CONDUCTANCE", "0.8, 0.", "480.8, 2000.",
               "*CONTACT PAIR, INTERACTION=faces, TYPE=SURFACE TO SURFACE", "Supper, Slower"]
    cards = ["*HEADING", "Cylinder on a base, heated from the top", *upper, *lower, *materials,
             *contact, "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "Nall, 0.",
             "*BOUNDARY", "Nupperaxis, 1, 1", "Nloweraxis, 1, 1",
             "Nupperend, 2, 2", "Nlowerend, 2, 2"]
    for hot, first, period in ((FIRST, FIRST, FIRST), (last, increment, last)):
        cards += ["*STEP, INC=1000",
                  "*CONTROLS, PARAMETERS=TIME INCREMENTATION", "40,60,9,100,10,4,,20,,",
                  "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT",
                  f"{first}, {period}",
                  "*BOUNDARY", f"Nupperend, 11, 11, {hot}", "Nlowerend, 11, 11, 0.",
                  f"*NODE FILE, FREQUENCY={output}", "U, NT",
                  f"*EL FILE, FREQUENCY={output}", "S, HFL",
                  f"*CONTACT FILE, FREQUENCY={output}", "CDIS, CSTR",
                  "*NODE PRINT, NSET=Nlowerend, TOTALS=ONLY", "RF, RFL", "*END STEP"]
    return cards
