"""Benchmarks of NAFEMS for single bodies."""

import numpy as np
from manual import Case, Check, check_short, errors_panel
from pictures import save, subplots
from physics import material, mesh, nodes_of

TITLE = "NAFEMS benchmarks"
TEXT = """On the finest mesh all values are within 1 % of the targets of *The Standard NAFEMS
Benchmarks*, TNSB Rev. 3, NAFEMS 1990, and the targets, with their digits, are
within the program's own uncertainties."""
PICTURE = "nafems"
CAPTION = "Errors of the NAFEMS benchmarks over the mesh"
STATIC = ["*STEP", "*STATIC", "1., 1."]


def node_at(cards, x, y):
    """Return the number of the node at a point."""
    (found,) = [n for n, p in nodes_of(cards).items() if abs(p[0] - x) + abs(p[1] - y) < 1e-9]
    return str(found)


def ellipse(s, angle):
    """Return a point between the ellipses of LE1."""
    inner = np.array([2.0 * np.cos(angle), np.sin(angle)])
    outer = np.array([3.25 * np.cos(angle), 2.75 * np.sin(angle)])
    x, y = (1 - s) * inner + s * outer
    return (0.0 if abs(x) < 1e-12 else float(x)), float(y)


def le1(size):
    """Return the elliptic membrane: elements along the ellipses and between them."""
    along, between, kind = size
    cards = mesh("PLATE", list(np.linspace(0, 1, between + 1)),
                 list(np.linspace(0, np.pi / 2, along + 1)), kind, to=ellipse)
    allowed = (0.1 if kind == "CPS8" else 0.4) * 4 / along
    return [*cards, *material("PLATE", (2.1e5, 0.3)), *STATIC, "*BOUNDARY", "PLATE.TOP, 1",
            "PLATE.BOTTOM, 2", "*DSLOAD", "PLATE.RIGHT, P, -10.", "*END STEP"], [
                Check("sigma_yy at D", "S22", node_at(cards, 2.0, 0.0), 92.7, allowed)]


CONE = np.array([1.4 * np.sqrt(0.75), 0.7]), np.array([1.0, 1.39])  # D and G


def le11_point(s, v):
    """Return a point of LE11; v = 0, 1, 2 is the line AB, CD, EF or above, 4 the top HI.

    Outside: a sphere of radius 1.4 from B to D at 30 degrees, a cone from D to G, a cylinder from G
    to I. Inside: a sphere of radius 1 from A to E at 45 degrees, a cylinder from E to H.
    """
    height = np.sqrt(0.5)
    if v <= 1:
        inside = np.array([np.cos(v * np.pi / 8), np.sin(v * np.pi / 8)])
        outside = 1.4 * np.array([np.cos(v * np.pi / 6), np.sin(v * np.pi / 6)])
    elif v <= 2:
        angle = np.pi / 8 * v
        inside = np.array([np.cos(angle), np.sin(angle)])
        outside = (3 - v) / 2 * CONE[0] + (v - 1) / 2 * CONE[1]
    elif v <= 3:
        inside = np.array([height, height + (v - 2) / 2 * (1.79 - height)])
        outside = (3 - v) / 2 * CONE[0] + (v - 1) / 2 * CONE[1]
    else:
        inside = np.array([height, height + (v - 2) / 2 * (1.79 - height)])
        outside = np.array([1.0, 1.39 + (v - 3) * 0.4])
    r, z = (1 - s) * inside + s * outside
    return float(r), float(z)


def le11(size):
    """Return the cylinder, taper and sphere of LE11 under T = r + z."""
    across, kind = size
    cards = mesh("BODY", list(np.linspace(0, 1, across + 1)),
                 [4 * k / (8 * across) for k in range(8 * across + 1)], kind, to=le11_point)
    heat = [f"{n}, {r + z:.15g}" for n, (r, z) in nodes_of(cards).items()]
    allowed = 0.15 / across
    return [*cards, *material("BODY", (2.1e5, 0.3), 2.3e-4),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 0.", *STATIC, "*BOUNDARY",
            "BODY.BOTTOM, 2", "BODY.TOP, 2", "*TEMPERATURE", *heat, "*END STEP"], [
                Check("sigma_zz at A", "S22", node_at(cards, 1.0, 0.0), -105.0, allowed)]


SPOT, PLATE = 1.0, 10.0


def hot_spot(s, angle):
    """Return a point of the quarter of a square about the hot spot."""
    far = PLATE / max(np.cos(angle), np.sin(angle))
    place = np.array([np.cos(angle), np.sin(angle)]) * SPOT * (1 - s) + s * far * np.array(
        [np.cos(angle), np.sin(angle)])
    x, y = np.where(np.abs(place) < 1e-12, 0.0, place)
    return float(x), float(y)


def disc(s, t):
    """Return a point of the quarter of a disc for the unit square."""
    radius = max(s, t)
    if radius == 0.0:
        return 0.0, 0.0
    # Squares about the centre become circles on the way out.
    angle = np.pi / 4 * (t / s if s >= t else 2 - s / t)
    around = radius * np.array([np.cos(angle), np.sin(angle)])
    share = radius
    x, y = SPOT * ((1 - share) * 0.75 * np.array([s, t]) + share * around)
    return (0.0 if abs(x) < 1e-12 else float(x)), (0.0 if abs(y) < 1e-12 else float(y))


def t1(size):
    """Return the membrane with its hot spot, two bodies tied node to node."""
    count, kind = size
    growth = [((PLATE / SPOT) ** (k / (2 * count)) - 1) / (PLATE / SPOT - 1)
              for k in range(2 * count + 1)]
    side = [k / count for k in range(count + 1)]
    spot = mesh("SPOT", side, side, kind, to=disc)
    rest = mesh("REST", growth, [np.pi / 4 * k / count for k in range(2 * count + 1)], kind,
                first=100001, to=hot_spot)
    rim = ["*SURFACE, NAME=RIM"]
    for side_name in ("RIGHT", "TOP"):
        start = spot.index(f"*SURFACE, NAME=SPOT.{side_name}") + 1
        for card in spot[start:]:
            if card.startswith("*"):
                break
            rim.append(card)
    allowed = 0.01 + 0.15 / count
    return [*spot, *rest, *rim, *material("SPOT", (1e5, 0.3), 1e-5),
            *material("REST", (1e5, 0.3), 0.0),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "SPOT, 0.", "REST, 0.",
            "*TIE, NAME=EDGE", "REST.LEFT, RIM", *STATIC, "*BOUNDARY", "SPOT.BOTTOM, 2",
            "SPOT.LEFT, 1", "REST.BOTTOM, 2", "REST.TOP, 1", "*TEMPERATURE", "SPOT, 100.",
            "*END STEP"], [Check("sigma_yy at D", "S22", node_at(rest, SPOT, 0.0), 50.0, allowed)]


def t4(size):
    """Return the plate of T4: the point E is a corner of every mesh."""
    count, kind = size
    cards = mesh("PLATE", list(np.linspace(0, 0.6, 3 * count + 1)),
                 list(np.linspace(0, 1.0, 5 * count + 1)), kind)
    allowed = {1: 0.05, 2: 0.05, 4: 0.005, 8: 0.001}[count]
    films = [f"PLATE.{side}, F, 0., 750." for side in ("RIGHT", "TOP")]
    return [*cards, *material("PLATE", None, conductivity=52.0),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "PLATE, 0.",
            "*STEP", "*HEAT TRANSFER, STEADY STATE", "1., 1.", "*BOUNDARY",
            "PLATE.BOTTOM, 11, 11, 100.", "*FILM", *films, "*END STEP"], [
                Check("T at E", "NT", node_at(cards, 0.6, 0.2), 18.25, allowed)]


def cases():
    """Return the cases of the theme."""
    return [
        Case("LE1, elliptic membrane",
             """A quarter of a membrane between the ellipses (x/2)^2 + y^2 = 1 and (x/3.25)^2 +
             (y/2.75)^2 = 1 m, pulled by 10 MPa on the outer one; plane stress, E = 210 GPa, nu =
             0.3. Meshes: elements along x across. Stresses in MPa.""",
             "Target 92.7 MPa at D (2, 0).",
             """10 % on the coarsest mesh, halved on each finer one: stress at a boundary is
             extrapolated from inside the elements. Abaqus is 9 % off with CPS8 on the coarse mesh
             of NAFEMS.""",
             [(4, 3, "CPS8"), (8, 6, "CPS8"), (16, 12, "CPS8"), (32, 24, "CPS8")], le1,
             lambda m: f"{m[0]} x {m[1]} {m[2]}", kind="EXTERNAL", cite="NAFEMS LE1", short=2,
             bounded=True, rounded=0.05),
        Case("LE1 of CPS4I",
             "The same with incompatible modes.", "As above.",
             """40 % on the coarsest mesh, halved on each finer one: stresses of linear elements are
             of the first order.""",
             [(n, 3 * n // 4, "CPS4I") for n in (4, 8, 16, 32)], le1,
             lambda m: f"{m[0]} x {m[1]} {m[2]}", kind="EXTERNAL", cite="NAFEMS LE1", short=2,
             bounded=True, rounded=0.05),
        Case("LE11, cylinder, taper and sphere under heat",
             """A hollow solid of revolution, inside a sphere of radius 1 m and above 45 degrees a
             cylinder, outside a sphere of radius 1.4 m up to 30 degrees, a cone and a cylinder of
             radius 1 m, 1.79 m high, held along z at both ends. T = r + z, E = 210 GPa, nu = 0.3,
             alpha = 2.3e-4.""",
             "Target -105 MPa at A (1, 0).",
             """15 % with one element through the wall, halved on each finer mesh, as for LE1.
             Published values of elements of the second order on meshes of NAFEMS are 11 to 14 % off
             on the coarse, 6 % on the fine one (OptiStruct, OS-V 0070).""",
             [(1, "CAX8"), (2, "CAX8"), (4, "CAX8"), (8, "CAX8")], le11,
             lambda m: f"{m[0]} x {8 * m[0]} {m[1]}", kind="EXTERNAL", cite="NAFEMS LE11", short=2,
             bounded=True, rounded=0.5),
        Case("T1, membrane with a hot spot",
             """A spot of radius 1 mm in a square membrane of 20 mm expands by 1e-3; plane stress, E
             = 100 GPa, nu = 0.3, a quarter. Spot and membrane are tied node to node, so that the
             stress outside is not averaged with that of the spot.""",
             """Target 50 MPa at D (1, 0), outside. It is E alpha T/2 of an infinite membrane; a
             round one of radius b raises it by (1 mm/b)^2, 1 % here (Timoshenko and Goodier,
             section 150).""",
             """1 % for the finite membrane, and 7.5 % with 2 elements along an eighth of the edge
             of the spot, halved on each finer mesh, for the extrapolated stress.""",
             [(2, "CPS8"), (4, "CPS8"), (8, "CPS8"), (16, "CPS8")], t1,
             lambda m: f"{m[0]} {m[1]}", kind="EXTERNAL", cite="NAFEMS T1", short=1),
        Case("T4, conduction with convection",
             """A plate of 0.6 x 1 m, k = 52 W/(m K), 100 C below, insulated on the left, a film of
             750 W/(m2 K) to 0 C on the right and above.""",
             "Target 18.25 C at E (0.6, 0.2).",
             """5 % while elements (0.2 and 0.1 m) are longer than k/h = 0.069 m, over which the
             temperature falls at the film; then 0.5 and 0.1 %. The target is rounded to 0.03 %.""",
             [(1, "CPE8"), (2, "CPE8"), (4, "CPE8"), (8, "CPE8")], t4,
             lambda m: f"{3 * m[0]} x {5 * m[0]} {m[1]}", kind="EXTERNAL", cite="NAFEMS T4",
             short=2, bounded=True, rounded=0.005),
    ]


def draw(runs, path):
    """Draw the errors."""
    figure, all_axes = subplots(1, len(runs), 2.4)
    for axes, (title, solved) in zip(all_axes, runs.items(), strict=True):
        errors_panel(axes, solved, title.split(",")[0])
    save(figure, path)


def test_nafems(tmp_path):
    import test_nafems

    check_short(test_nafems, tmp_path)
