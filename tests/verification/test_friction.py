"""Contact with friction."""

from math import pi, sqrt

import h5py
import numpy as np
from manual import Case, Check, check_short
from pictures import save, subplots
from physics import material, mesh, nodes_of

TITLE = "Friction"
TEXT = """Edges of stick are within half a side of an element, shear tractions within 0.3 % of the
largest, displacements within 3 %."""
PICTURE = "friction"
CAPTION = "Shear of Cattaneo's and Mindlin's contact, and the displacement of the block"

# Two equal cylinders, pressed by a displacement of the top, then moved aside and back.
RADIUS, YOUNG, POISSON, FRICTION = 1e4, 1e4, 0.3, 0.4
FIRST_SIDE = 0.2  # side of the elements at the contact before they are refined
MODULUS = YOUNG / (1 - POISSON**2) / 2
SIZE_OF_BODIES = 40.0
LOAD = 2.0
HALF_WIDTH = sqrt(4 * LOAD * RADIUS / pi / MODULUS)
PEAK = 2 * LOAD / pi / HALF_WIDTH
SHARE = 0.6  # largest shear force over the largest friction


def grown(side, count, end):
    """Return places from 0: sides of equal length, then growing ones, to the end or beyond."""
    places = [side * k for k in range(count + 1)]
    while places[-1] < end:
        places.append(places[-1] + 1.5 * (places[-1] - places[-2]))
    return places


def ellipse(x, width):
    """Return the ellipse of a half-width, in parts of the peak of that of a."""
    return width / HALF_WIDTH * np.sqrt(np.clip(1 - (np.asarray(x) / width) ** 2, 0, None))


def first_shear(x, share):
    """Return the shear over mu p0 under a force of a share of the friction, for the first time."""
    return ellipse(x, HALF_WIDTH) - ellipse(x, HALF_WIDTH * sqrt(1 - share))


def reversed_shear(x, most, share):
    """Return it after the largest share, back at a share: slip is undone from the edge inward."""
    back = (most - share) / 2
    return first_shear(x, most) - 2 * (ellipse(x, HALF_WIDTH)
                                       - ellipse(x, HALF_WIDTH * sqrt(1 - back)))


def sliding(level):
    """Return the cylinders and the checks: pressed by a force, pushed and pulled."""
    half = grown(FIRST_SIDE, 12, SIZE_OF_BODIES)
    ys = grown(FIRST_SIDE, 3, SIZE_OF_BODIES)
    xs, height = [-x for x in half[:0:-1]] + half, ys[-1]
    cards = [*mesh("UP", xs, ys, to=lambda x, y: (x, y + (1 - y / height) * x * x / 2 / RADIUS)),
             *mesh("LO", xs, [-y for y in ys[::-1]], first=20001),
             *material("UP", (YOUNG, POISSON)), *material("LO", (YOUNG, POISSON)),
             "*SURFACE INTERACTION, NAME=I", "*FRICTION", f"{FRICTION!r}",
             "*CONTACT PAIR, INTERACTION=I, NAME=FACE", "UP.BOTTOM, LO.TOP",
             f"*REFINE, LEVELS={level}"]
    most = SHARE * FRICTION * LOAD
    width = xs[-1] - xs[0]
    at = {(round(x, 6), round(y, 6)): n for n, (x, y) in nodes_of(cards).items()}
    # Both bodies are loaded equally, so that without a push nothing slips. The supports hold rigid
    # motions only: loads balance, with a couple for the moment of the push about the face.
    below, far = round(-height, 6), round(xs[-1], 6)
    couple = most * height / width
    press = [f"{side}, P, {LOAD / width!r}" for side in ("UP.TOP", "LO.BOTTOM")]
    cards += ["*STEP", "*STATIC", "0.1, 1.", "*BOUNDARY", f"{at[0.0, below]}, 1, 2",
              f"{at[far, below]}, 2", "*DSLOAD", *press, "*END STEP"]
    for sign in (1, -1):
        corners = [f"{at[x, y]}, 2, {sign * couple * (1 if x > 0 else -1)!r}"
                   for x in (-far, far) for y in (below, -below)]
        cards += ["*STEP, INC=200", "*STATIC", "0.05, 1.", "*DSLOAD", *press,
                  f"UP.TOP, TRVEC, {sign * most / width!r}, 1., 0., 0.",
                  f"LO.BOTTOM, TRVEC, {-sign * most / width!r}, 1., 0., 0.",
                  "*CLOAD", *corners, "*END STEP"]
    side = FIRST_SIDE / 2**level
    offset = xs[-1]  # s begins at the left end of the face
    stick = HALF_WIDTH * sqrt(1 - SHARE)
    top = FRICTION * PEAK
    allowed = 0.003 + 0.02 / 2**level
    checks = [Check("edge of stick, pushed", "edge_stick", "FACE", offset + stick, side / 2, "ABS",
                    "2."),
              Check("shear force, pushed", "shear_force", "FACE", -most, 1e-3, "REL", "2.")]
    for part in (0.3, 0.9):
        x = part * HALF_WIDTH
        checks.append(Check(f"shear at {part:g} a, pushed", "shear", f"FACE@{offset + x!r}",
                            -top * float(first_shear(x, SHARE)), allowed * top, "ABS", "2."))
    for part in (0.0, 0.5, 0.9):
        x = part * HALF_WIDTH
        checks.append(Check(f"shear at {part:g} a, back at 0", "shear", f"FACE@{offset + x!r}",
                            -top * float(reversed_shear(x, SHARE, 0.0)), allowed * top, "ABS",
                            "2.5"))
    checks.append(Check("shear at 0.9 a, reversed", "shear", f"FACE@{offset + 0.9 * HALF_WIDTH!r}",
                        top * float(first_shear(0.9 * HALF_WIDTH, SHARE)), allowed * top, "ABS"))
    return cards, checks


BLOCK = [(0.0, 28.6), (1.25, 27.2), (5.0, 22.8), (7.5, 19.8), (11.25, 15.0)]


def block(count):
    """Return the half of Feijoo's block on a base that is all but rigid."""
    side = 40.0
    xs = [side * k / count for k in range(count + 1)]
    cards = [*mesh("BLOCK", xs, xs), *mesh("BASE", xs, [-1.25, 0.0], first=100001),
             *material("BLOCK", (1.3e5, 0.2)), *material("BASE", (1.3e5, 0.2)),
             "*SURFACE INTERACTION, NAME=I", "*FRICTION", "1.",
             "*CONTACT PAIR, INTERACTION=I, NAME=FACE", "BLOCK.BOTTOM, BASE.TOP",
             "*STEP", "*STATIC", "0.1, 1.", "*BOUNDARY", "BASE, 1, 2", "BLOCK.RIGHT, 1",
             "*DSLOAD", "BLOCK.TOP, P, 50.", "BLOCK.LEFT, P, 150.", "*END STEP"]
    at = {round(p[0], 6): n for n, p in nodes_of(cards).items() if p[1] == 0.0 and n < 100000}
    return cards, [Check(f"u_x at x = {x:g} mm", "U1", str(at[x]), value * 1e-3, 0.05)
                   for x, value in BLOCK]


def cases():
    """Return the cases of the theme."""
    return [
        Case("Cattaneo and Mindlin, with reversal",
             f"""Two equal cylinders (R = 1e4, E = 1e4, nu = 0.3, friction 0.4) are pressed by 2,
             then pushed aside by {SHARE:g} of the largest friction and back to the opposite, plane
             strain. The sides of elements at the contact are 0.2 long, a/11, before they are
             refined. Both bodies are 40 or more wide and high and loaded equally, far from the face;
             a couple takes the moment of the push. The load comes in 10, each push in 20
             increments.""",
             """C. Cattaneo 1938, R. D. Mindlin 1949; reversal: R. D. Mindlin, H. Deresiewicz, J.
             Appl. Mech. 20 (1953) 327-344; K. L. Johnson, Contact Mechanics, 1985, sections 7.2 and
             7.4.""",
             """Shear: 2 % of mu p0, halved on each finer mesh, as for Hertz's pressures, and 0.3 %
             for the size of the bodies, (a/40)^2; that part does not fall with the mesh. Edge of
             stick: half a side, since slip is frozen node by node as the front moves.""",
             [0, 1], sliding, lambda n: f"h = {FIRST_SIDE / 2**n:g}", named="side", short=1),
        Case("Block of Feijoo, Barbosa and Zouain",
             """Half of a block of 80 x 40 mm on a rigid base, E = 1.3e11 Pa, nu = 0.2, friction 1,
             pressed by 5e7 Pa from above and 15e7 Pa from the side x = 0; plane strain, x = 40 mm
             is the line of symmetry.""",
             """R. A. Feijoo, H. J. C. Barbosa, N. Zouain, Numerical formulations for contact
             problems with friction, J. Mec. Theor. Appl. 7, suppl. 1 (1988). Geometry and loads as
             for test SSNV128 of code_aster (V6.04.128).""",
             """5 %: the values are those of a numerical solution, given with three digits.""",
             [16, 32, 64], block, lambda n: f"{n} x {n}", kind="EXTERNAL",
             cite="Feijoo and Barbosa and Zouain", named="elements", short=1,
             remarks="""Three meshes agree to 0.1 %. At x = 11.25 mm all of them are 2.8 % above the
             cited value, at the other points at most 0.3 %."""),
    ]


def profile(path, row):
    """Return places about the middle and shears over mu p0."""
    with h5py.File(path) as file:
        times = file["history/time"][:]
        face = file["contact/FACE"]
        k = int(np.argmin(abs(times - row)))
        return face["x"][:], face["shear"][k] / FRICTION / PEAK


def draw(runs, path):
    """Draw the shears and the displacements."""
    figure, (left, right) = subplots(1, 2, 2.9)
    x = np.linspace(-1, 1, 401) * HALF_WIDTH
    solved = runs["Cattaneo and Mindlin, with reversal"][-1]
    for time, known, name in ((2.0, first_shear(x, SHARE), "pushed"),
                              (2.5, reversed_shear(x, SHARE, 0.0), "back at 0"),
                              (3.0, -first_shear(x, SHARE), "reversed")):
        (line,) = left.plot(x / HALF_WIDTH, -known, label=name)
        places, shear = profile(solved.result, time)
        near = abs(places) < 1.2 * HALF_WIDTH
        left.plot(places[near] / HALF_WIDTH, shear[near], ".", color=line.get_color())
    left.set_xlabel("x/a")
    left.set_ylabel("shear over mu p0")
    left.set_title("Cattaneo and Mindlin: lines known, points computed")
    left.legend()
    right.plot(*zip(*BLOCK, strict=True), "o", label="Feijoo, Barbosa and Zouain")
    for solved in runs["Block of Feijoo, Barbosa and Zouain"]:
        right.plot([x for x, _ in BLOCK], [v.value * 1e3 for v in solved.verdicts],
                   label=f"{solved.mesh} x {solved.mesh}")
    right.set_xlabel("x in mm")
    right.set_ylabel("u_x in um")
    right.set_title("Block")
    right.legend()
    save(figure, path)


def test_friction(tmp_path):
    import test_friction

    check_short(test_friction, tmp_path)
