"""Contact without friction and heat."""

from math import pi, sqrt

import h5py
import numpy as np
from deck_runs import HERTZ
from manual import Case, Check, check_short
from pictures import save, subplots
from physics import material, mesh

import lame
import receding

TITLE = "Contact"
TEXT = """A uniform pressure is transferred to rounding between faces whose nodes do not match;
Hertz's largest pressures are met to 0.1 %, edges of contact to a fraction of a side."""
PICTURE = "contact"
CAPTION = "Pressures of Hertz's contacts and of a receding layer: points computed, lines known"
SMOOTH = ["*SURFACE INTERACTION, NAME=SMOOTH"]
STATIC = ["*STEP", "*STATIC", "1., 1."]


def patch(kind):
    """Return two blocks whose nodes do not match, pushed together."""
    upper = mesh("UPPER", [0.0, 0.3, 0.6, 1.0], [1.0, 1.5, 2.0], kind, skew=0.05)
    lower = mesh("LOWER", [0.0, 0.15, 0.4, 0.55, 0.8, 1.0], [0.0, 0.4, 1.0], kind, first=1001,
                 skew=0.04)
    cards = [*upper, *lower, *material("UPPER", (2e6, 0.0)), *material("LOWER", (2e6, 0.0)),
             *SMOOTH,
             "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE, PAIRING=SURFACES",
             "LOWER.TOP, UPPER.BOTTOM", *STATIC, "*BOUNDARY", "UPPER.TOP, 2, 2, -0.1",
             "LOWER.BOTTOM, 2", "UPPER.LEFT, 1", "LOWER.LEFT, 1", "*END STEP"]
    return cards, [Check("pressure, all contact points", "pressure", "FACE", 1e5, 1e-9),
                   Check("sigma_yy, smallest", "S22", "MIN", -1e5, 1e-9),
                   Check("sigma_yy, largest", "S22", "MAX", -1e5, 1e-9)]


def without_checks(path):
    """Return the cards of a deck of input/ without its checks."""
    cards, inside = [], False
    for line in path.read_text().splitlines():
        if line.startswith("*") and not line.startswith("**"):
            inside = line.upper().startswith("*VERIFY")
        if not inside:
            cards.append(line)
    return cards


MODULUS = 1 / (0.91 / 2.1e5 + (1 - 0.33**2) / 7e4)
CURVATURE, SIZE = 100.0, 40.0
LINE_FORCE = 2 * 6.0 * SIZE
LINE_WIDTH = sqrt(4 * LINE_FORCE * CURVATURE / pi / MODULUS)
SPHERE_WIDTH = 1.0
SPHERE_FORCE = 4 * MODULUS * SPHERE_WIDTH**3 / 3 / CURVATURE
FIRST_SIDE = 0.25


def hertz_checks(width, peak, force, level):
    """Return the checks of an elliptic pressure."""
    side = FIRST_SIDE / 2**level
    most = 0.02 / 2**level
    return [Check("edge of contact", "edge_contact", "FACE", width, side / 4, "ABS"),
            Check("pressure in the middle", "pressure", "FACE@0.", peak, most),
            Check("pressure at a/2", "pressure", f"FACE@{width / 2!r}", peak * sqrt(0.75), most),
            Check("normal force", "normal_force", "FACE", force, 1e-4)]


def hertz_line(level):
    """Return input/hertz at a level."""
    cards = [c.replace("*REFINE, LEVELS=1", f"*REFINE, LEVELS={level}")
             for c in without_checks(HERTZ)]
    return cards, hertz_checks(LINE_WIDTH, 2 * LINE_FORCE / pi / LINE_WIDTH, LINE_FORCE / 2, level)


def hertz_sphere(level):
    """Return the same mesh about the axis: a sphere on a cylinder."""
    cards, _ = hertz_line(level)
    at = cards.index("LOADED, P2, 6.")
    cards[at] = f"LOADED, P2, {SPHERE_FORCE / pi / SIZE**2!r}"
    peak = 1.5 * SPHERE_FORCE / pi / SPHERE_WIDTH**2
    return ["*OPTIONS, PLANE=AXISYMMETRIC", *cards], hertz_checks(
        SPHERE_WIDTH, peak, SPHERE_FORCE, level)


RIGID = 7e4 / (1 - 0.33**2)


def rigid(kind, level):
    """Return a rigid cylinder or sphere, an arc, on a block, pressed to a half-width of 1."""
    across, down = graded(FIRST_SIDE, 8, SIZE), graded(FIRST_SIDE, 6, SIZE)
    force, peak = pi * RIGID / 8 / CURVATURE, RIGID / 2 / CURVATURE
    if kind == "CAX8":
        force, peak = 4 * RIGID / 3 / CURVATURE, 2 * RIGID / pi / CURVATURE
    cards = [*mesh("BLOCK", across, [-y for y in down[::-1]], kind), "*NODE", "90001, 0., 100.",
             "*SURFACE, NAME=ARC, TYPE=SEGMENTS", "START, 60., 20.", "CIRCL, -60., 20., 0., 100.",
             "*RIGID BODY, REF NODE=90001, ANALYTICAL SURFACE=ARC",
             *material("BLOCK", (7e4, 0.33)), *SMOOTH,
             "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE, PAIRING=NODES", "BLOCK.TOP, ARC",
             f"*REFINE, LEVELS={level}", *STATIC, "*BOUNDARY", "BLOCK.LEFT, 1", "BLOCK.BOTTOM, 2",
             "90001, 1", "90001, 6", "*CLOAD", f"90001, 2, {-force!r}", "*END STEP"]
    return cards, hertz_checks(1.0, peak, force, level)


ROLLER = 50.0


def graded(fine, count, end, ratio=1.35):
    """Return places from 0: `count` sides of equal length, then growing ones to the end."""
    places, side = [fine * k for k in range(count + 1)], fine
    while places[-1] + side * ratio < end - side * ratio / 2:
        side *= ratio
        places.append(places[-1] + side)
    return [*places[:-1], end] if end - places[-1] < side / 2 else [*places, end]


def roller(level):
    """Return a half cylinder, cut off at the side, on a block of 200 mm; the right half."""
    across = graded(1.5, 6, 45.0)
    wide = across + [45.0 + x for x in graded(12.0, 1, 55.0)[1:]]
    up, down = graded(1.5, 4, ROLLER), graded(1.5, 4, 200.0)

    def curved(x, y):
        arc = ROLLER - sqrt(ROLLER**2 - x**2)
        return x, arc + y * (ROLLER - arc) / ROLLER

    cards = [*mesh("ROLLER", across, up, "CPE8", to=curved),
             *mesh("BLOCK", wide, [-y for y in down[::-1]], "CPE8", first=100001)]
    faces = sum(x < 25.0 for x in across[:-1])
    rows = (len(down) - 2) * (len(wide) - 1)
    half_force = 17500.0
    cards += ["*SURFACE, NAME=CURVED", *(f"{1 + k}, S1" for k in range(faces)),
              "*SURFACE, NAME=FLAT", *(f"{100001 + rows + k}, S3" for k in range(faces)),
              *material("ROLLER", (2.1e5, 0.3)), *material("BLOCK", (7e4, 0.3)), *SMOOTH,
              "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE", "CURVED, FLAT",
              f"*REFINE, LEVELS={level}", "*STEP", "*STATIC", "1., 1.", "*BOUNDARY",
              "ROLLER.LEFT, 1", "BLOCK.LEFT, 1", "BLOCK.BOTTOM, 2", "*DSLOAD",
              f"ROLLER.TOP, P, {half_force / across[-1]!r}", "*END STEP"]
    return cards, [Check("edge of contact", "edge_contact", "FACE", 6.21, 0.02),
                   Check("largest pressure", "pressure", "MAX", 3585.0, 0.02),
                   Check("normal force", "normal_force", "FACE", half_force, 0.02)]


HALF_LOAD = 0.5


def layer(level):
    """Return the half of two equal layers pressed together: each lies as on a rigid base."""
    xs = [0.05 * i for i in range(33)] + [1.7, 1.85, 2.1, 2.5, 3.0, 4.0]
    ys = [0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0]
    pressed = sum(x < HALF_LOAD - 1e-9 for x in xs[:-1])
    rows = (len(ys) - 2) * (len(xs) - 1)
    loads = [f"{first + rows + k}, P{side}, 1." for first, side, rows in
             ((1, 3, rows), (5001, 1, 0)) for k in range(pressed)]
    cards = [*mesh("UP", xs, ys), *mesh("LO", xs, [-y for y in ys[::-1]], first=5001),
             *material("UP", (1000.0, 0.3)), *material("LO", (1000.0, 0.3)), *SMOOTH,
             "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE", "UP.BOTTOM, LO.TOP",
             f"*REFINE, LEVELS={level}"]
    below = next(card.split(",")[0] for card in cards[cards.index("*NODE, NSET=LO"):]
                 if card.endswith(" 0, -1"))
    extent, middle = receding.extent(HALF_LOAD)
    side = 0.05 / 2**level
    return [*cards, *STATIC, "*BOUNDARY", "UP.LEFT, 1", "LO.LEFT, 1", f"{below}, 2", "*DLOAD",
            *loads, "*END STEP"], [
                Check("edge of contact", "edge_contact", "FACE", extent, side / 4, "ABS"),
                Check("pressure in the middle", "pressure", "FACE@0.", middle, 0.01 / 4**level)]


def press_fit(n):
    """Return two rings that overlap, n elements through each."""
    inner, face, outer = 1.0, 2.0, 3.0
    hub, rim, overlap = (2000.0, 0.3), (700.0, 0.33), 0.01
    cards = [*mesh("HUB", list(np.linspace(inner, face, n + 1)), [0.0, 0.2, 0.5], "CAX8"),
             *mesh("RIM", list(np.linspace(face, outer, n + 1)), [0.0, 0.2, 0.5], "CAX8", 1001),
             *material("HUB", hub), *material("RIM", rim), *SMOOTH,
             "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE", "HUB.RIGHT, RIM.LEFT",
             f"*CLEARANCE, MASTER=RIM.LEFT, SLAVE=HUB.RIGHT, VALUE={-overlap!r}",
             *STATIC, "*BOUNDARY", "HUB.BOTTOM, 2", "RIM.BOTTOM, 2", "*END STEP"]
    pressure = lame.press_fit(inner, face, outer, hub, rim, overlap, "stress")
    hoop = lame.cylinder(inner, inner, face, 0.0, pressure)[1]
    return cards, [Check("pressure", "pressure", "FACE", pressure, 0.02 * (2 / n) ** 3),
                   Check("hoop stress in the bore", "S33", "HUB.LEFT", hoop, 0.1 * (2 / n) ** 2)]


def cases():
    """Return the cases of the theme."""
    edges = """Edge: a quarter of the side of an element, since it is sharpened below the nodal
        spacing. """
    return [
        Case("Contact patch test",
             """Two blocks, together 2 high, of E = 2e6, nu = 0 and elements that do not match, 3 on
             5 along the face and distorted inside; the top goes down by 0.1.""",
             """N. El-Abbasi, K. J. Bathe, Stability and patch test performance of contact
             discretizations, Computers and Structures 79 (2001) 1473-1486: pressure 1e5,
             uniform.""",
             "1e-9: rounding. A uniform state is exact or the method is wrong.",
             ["CPE8", "CPE8R", "CPE4", "CPE4I", "CPE6", "CPE3"], patch, named="element", short=6),
        Case("Hertz, line contact",
             """A cylinder of radius 100 mm (E 210 GPa, nu 0.3) on a block (70 GPa, 0.33), 480 N/mm,
             plane strain: input/hertz. Sides of elements at the contact are 0.25 mm long, a/4,
             before they are refined.""",
             "H. Hertz; K. L. Johnson, Contact Mechanics, 1985, section 4.2.",
             edges + """Pressures: 2 %, halved on each mesh; bodies 40 mm in size change them by
             (a/40)^2, 0.07 %. Force: 1e-4, the lean of the normals.""",
             [0, 1, 2], hertz_line, lambda n: f"a/{4 * 2**n}", short=1),
        Case("Hertz, sphere",
             """The same section about the axis: a sphere on a cylinder, with the force for which a
             = 1 mm.""", "Johnson, section 4.2.", edges + "Pressures and force as above.",
             [0, 1, 2], hertz_sphere, lambda n: f"a/{4 * 2**n}", short=1),
        Case("Hertz, rigid cylinder",
             """A rigid cylinder of radius 100 mm, an arc of `*SURFACE, TYPE=SEGMENTS`, on a block of
             E 70 GPa, nu 0.33, 40 mm wide and high, that the force of a = 1 mm presses down at its
             reference node; node pairs.""",
             "H. Hertz; K. L. Johnson, Contact Mechanics, 1985, section 4.2.",
             edges + """Pressures: 2 %, 1 % and 0.5 %, as of two elastic bodies.""",
             [0, 1, 2], lambda n: rigid("CPE8", n), lambda n: f"a/{4 * 2**n}", short=1),
        Case("Hertz, rigid sphere",
             "The same about the axis.",
             "H. Hertz; K. L. Johnson, Contact Mechanics, 1985, section 4.2.",
             edges + """Pressures: 2 %, 1 % and 0.5 %.""",
             [0, 1, 2], lambda n: rigid("CAX8", n), lambda n: f"a/{4 * 2**n}", short=1),
        Case("NAFEMS, cylinder on block",
             """A steel cylinder of radius 50 mm (E 210 GPa, nu 0.3) is pressed on an aluminium
             block of 200 x 200 mm (70 GPa, 0.3) with 35 kN/mm; plane strain, right half,
             frictionless. The cylinder is its lower half, cut off at 0.9 of its radius, with the
             load on the cut through its axis.""",
             """A. W. A. Konter, Advanced Finite Element Contact Benchmarks, NAFEMS 2006, benchmark
             1: a = 6.21 mm and p0 = 3585 MPa by Hertz.""",
             """2 %: Hertz takes half-planes and a parabola, which neglects terms of the order of
             (a/R)^2 = 1.5 %; this does not vanish with the mesh.""",
             [0, 1, 2], roller, lambda n: f"a/{4 * 2**n}", kind="EXTERNAL",
             cite="NAFEMS contact benchmark 1", named="side", short=1),
        Case("Receding contact of a layer",
             """A layer of height 1 on a rigid base, pressed by 1 over the width of 1, lifts off; E
             1000, nu 0.3, plane strain. It is half of two layers pressed together. Sides 0.05 long
             before they are refined.""",
             """J. Dundurs, M. Stippes, J. Appl. Mech. 37 (1970) 965-970; numbers of the integral
             equation in tests/reference/receding.py.""",
             edges + "Pressure: 1 % with sides of 0.05, falling with h^2.",
             [0, 1, 2], layer, lambda n: f"h = {0.05 / 2**n:g}", short=1),
        Case("Press fit",
             """Rings of radii 1 to 2 (E 2000, nu 0.3) and 2 to 3 (700, 0.33) overlap by 0.01, ends
             free; CAX8, n elements through each.""",
             "G. Lamé; Timoshenko and Goodier, section 28.",
             """Pressure: 2 % with two elements, falling with h^3, the order of displacements; hoop
             stress at the bore, which is extrapolated: 10 %, falling with h^2.""",
             [2, 4, 8], press_fit, lambda n: f"n = {n}", short=2),
    ]


def profile(solved, name="pressure"):
    """Return places and values of the last increment."""
    with h5py.File(solved.result) as file:
        face = file["contact/FACE"]
        return face["s"][:], face[name][-1]


def draw(runs, path):
    """Draw the pressures."""
    figure, all_axes = subplots(1, 4, 2.4)
    known = {"Hertz, line contact": (LINE_WIDTH, 2 * LINE_FORCE / pi / LINE_WIDTH),
             "Hertz, sphere": (SPHERE_WIDTH, 1.5 * SPHERE_FORCE / pi / SPHERE_WIDTH**2),
             "NAFEMS, cylinder on block": (6.21, 3585.0)}
    for axes, (title, (width, peak)) in zip(all_axes, known.items(), strict=False):
        x = np.linspace(0, width, 200)
        axes.plot(x, peak * np.sqrt(1 - (x / width) ** 2), label="Hertz")
        places, pressure = profile(runs[title][1])
        axes.plot(places, pressure, ".", label="a/8")
        axes.set_xlim(0, 1.4 * width)
        axes.set_title(title)
        axes.set_xlabel("x in mm")
        axes.set_ylabel("pressure in MPa")
        axes.legend()
    axes = all_axes[-1]
    extent, _ = receding.extent(HALF_LOAD)
    terms = receding.pressure(extent, HALF_LOAD, 0.0)[1:]
    angles = np.linspace(0, pi / 2, 200)
    values = sum(q * np.sin((2 * k + 1) * (pi / 2 - angles)) for k, q in enumerate(terms))
    axes.plot(extent * np.sin(angles), values, label="theory")
    places, pressure = profile(runs["Receding contact of a layer"][0])
    axes.plot(places, pressure, ".", label="h = 0.05")
    axes.set_xlim(0, 1.4 * extent)
    axes.set_title("Receding layer")
    axes.set_xlabel("x")
    axes.set_ylabel("pressure")
    axes.legend(loc="lower left")
    save(figure, path)


def test_contact(tmp_path):
    import test_contact

    check_short(test_contact, tmp_path)
