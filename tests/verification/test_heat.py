"""Heat across contacts."""

from math import pi, sqrt

import h5py
import numpy as np
from deck_runs import CYLINDER, INPUT
from manual import Case, Check, check_short, log_sizes
from pictures import save, subplots
from physics import material, mesh, nodes_of

import crack
import rods

TITLE = "Heat and contact"
TEXT = """Walls and rods agree with closed forms to 1e-8. The published cylinder agrees with an
independent solver to 0.5 % in force and 2.5 % in heat on the mesh of the paper; on one mesh with
TOL=1e-12, pressure, shear, gap, slip, flux and both edges of all 45 increments agree to 2e-12."""
PICTURE = "heat"
CAPTION = "A crack closed by heat, gaps with gas and radiation, errors of the published cylinder"
COUPLED = ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1."]
HEAT = ["*STEP", "*HEAT TRANSFER, STEADY STATE", "1., 1."]


def walls(kind):
    """Return two walls with a conductance between them: two steady resistances in series."""
    xs = [0.0, 0.2, 0.5]
    left = mesh("LEFT", [0.0, 0.2, 0.495], xs, kind, skew=0.03)
    right = mesh("RIGHT", [0.505, 0.7, 1.0], xs, kind, first=1001, skew=0.03)
    cards = [*left, *right, *material("LEFT", None, conductivity=40.0),
             *material("RIGHT", None, conductivity=40.0), "*INITIAL CONDITIONS, TYPE=TEMPERATURE",
             "LEFT, 100.", "RIGHT, 100.", "*SURFACE INTERACTION, NAME=SLIT",
             "*GAP CONDUCTANCE, CLEARANCE", "80., 0.", "80., 1.",
             "*CONTACT PAIR, INTERACTION=SLIT, NAME=FACE", "LEFT.RIGHT, RIGHT.LEFT",
             *HEAT, "*BOUNDARY", "LEFT.LEFT, 11, 11, 100.", "RIGHT.RIGHT, 11, 11, 300.",
             "*END STEP"]
    flux = 200.0 / (2 * 0.495 / 40 + 1 / 80)
    return cards, [Check("T of the cold face", "slave_temperature", "FACE",
                         100 + flux * 0.495 / 40, 1e-9),
                   Check("T of the hot face", "master_temperature", "FACE",
                         300 - flux * 0.495 / 40, 1e-9),
                   Check("heat flux", "heat_flux", "FACE", -flux, 1e-9)]


HALF, YOUNG, POISSON, EXPANSION, CONDUCTIVITY = 1.3, 1000.0, 0.3, 1e-3, 4.0
SLOPE = 5.0   # of the stress that the heat makes, sigma = SLOPE x
EDGE = 1.2    # the plate ends at this confocal coordinate
CLOSED = np.arccos(-1 / 3)


def confocal(count):
    """Return the cards of an elliptic plate about a crack, and its outer nodes."""
    def to(angle, mu):
        x, y = crack.place(mu, -angle, HALF)
        return float(x), float(y)

    part = round(16 * CLOSED / (2 * pi)) * count // 16
    half = np.concatenate([np.linspace(0.0, CLOSED, part + 1),
                           np.linspace(CLOSED, pi, count // 2 - part + 1)[1:]])
    cards = mesh("PLATE", [*(-half[:0:-1]), *half], list(np.linspace(0.0, EDGE, count // 4 + 1)),
                 "CPS8", to=to, closed=True)
    start = cards.index("*NSET, NSET=PLATE.TOP") + 1
    outer = [int(card) for card in cards[start:cards.index("*SURFACE, NAME=PLATE.TOP")]]
    return [*cards, "*SURFACE, NAME=UP", *(f"{e}, S1" for e in range(1, count // 2 + 1)),
            "*SURFACE, NAME=LOW", *(f"{e}, S1" for e in range(count // 2 + 1, count + 1))], outer


def closing_crack(count):
    """Return a cracked plate, clamped far away, under a temperature that grows along the crack."""
    cards, outer = confocal(count)
    nodes = nodes_of(cards)
    x, y = np.array([nodes[n] for n in outer]).T
    # Clamped, E alpha T/(1 - nu) is the pressure along x and y; no heat crosses the crack.
    gradient = -SLOPE * (1 - POISSON) / YOUNG / EXPANSION
    moved = crack.bent_displacement(x, y, HALF, SLOPE, YOUNG, POISSON, "stress")
    free = EXPANSION * gradient * np.array([(x**2 - y**2) / 2, x * y])
    values = [*np.add(moved, free), gradient * x]
    rows = zip((1, 2, 11), values, strict=True)
    prescribed = [f"{n}, {dof}, {dof}, {value:.17g}" for dof, row in rows
                  for n, value in zip(outer, row, strict=True)]
    on_crack = sorted(p[0] for p in nodes.values() if p[1] == 0.0 and abs(p[0]) <= HALF)
    first = on_crack[1]
    inside, outside = HALF * np.cos(CLOSED + (pi - CLOSED) / 3), HALF * np.cos(0.4 * CLOSED)
    spacing = HALF * sqrt(8) / 3 * 2 * pi / count / 2
    most = 0.05 * (32 / count) ** 2
    return [*cards, *material("PLATE", (YOUNG, POISSON), EXPANSION, CONDUCTIVITY),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "PLATE, 0.",
            "*SURFACE INTERACTION, NAME=SMOOTH", "*GAP LAW, TYPE=POWER", "0., 0., 1.",
            "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=CRACK", "UP, LOW",
            *COUPLED, "*BOUNDARY", *prescribed, "*END STEP"], [
        Check("normal force", "normal_force", "CRACK", crack.bent_force(HALF, SLOPE), most),
        Check("gap in the open part", "gap", f"CRACK@{float(outside - first)!r}",
              crack.bent_opening(outside, HALF, SLOPE, YOUNG, POISSON, "stress"), most),
        Check("pressure in the closed part", "pressure", f"CRACK@{float(inside - first)!r}",
              crack.bent_pressure(inside, HALF, SLOPE), most),
        Check("edge of contact", "edge_contact", "CRACK", float(-HALF / 3 - first), spacing / 4,
              "ABS")]


BOLTZMANN = 5.670374e-8
# Gap, emissivity of both grey faces, conductivity of the gas (0: vacuum), jump distance.
GAPS = {"vacuum": (1e-3, 0.8, 0.0, 0.0), "gas and radiation": (1e-3, 0.8, 0.15, 0.0),
        "gas with jumps": (2e-5, 0.5, 0.15, 1e-5)}
WALL, STEEL = 0.02, 20.0
HOT, COLD = 1200.0, 400.0


def gas_flux(gap, emissivity, gas, jump):
    """Return the flux through two walls and a gap, by bisection of its balance."""
    exchange = 1 / (2 / emissivity - 1)
    low, high = 0.0, (HOT - COLD) * STEEL / (2 * WALL)

    def across(flux):
        one, other = HOT - flux * WALL / STEEL, COLD + flux * WALL / STEEL
        return (gas / (gap + jump) * (one - other)
                + BOLTZMANN * exchange * (one**4 - other**4))

    for _ in range(200):
        flux = (low + high) / 2
        low, high = (flux, high) if across(flux) > flux else (low, flux)
    return flux


def gas_gap(name):
    """Return two walls with a gap between them that gas and radiation bridge."""
    gap, emissivity, gas, jump = GAPS[name]
    ys = [0.0, 0.01, 0.03]
    exchange = 1 / (2 / emissivity - 1)
    more = f", JUMP={jump!r}" if jump else f", ROUGHNESS={1e-12!r}"
    cards = [*mesh("HOT", [-WALL, -WALL / 3, 0.0], ys),
             *mesh("COLD", [gap, gap + 0.7 * WALL, gap + WALL], ys, first=1001),
             *material("HOT", None, conductivity=STEEL),
             *material("COLD", None, conductivity=STEEL),
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"HOT, {HOT!r}", f"COLD, {COLD!r}",
             f"*PHYSICAL CONSTANTS, ABSOLUTE ZERO=0., STEFAN BOLTZMANN={BOLTZMANN!r}",
             "*SURFACE INTERACTION, NAME=GAP",
             f"*GAP LAW, TYPE=GAS, EMISSIVITY={exchange!r}{more}", f"{gas!r}, 0.",
             "*CONTACT PAIR, INTERACTION=GAP, NAME=FACE", "HOT.RIGHT, COLD.LEFT",
             "*FIXED POINT, TOL=1.E-12",
             *HEAT, "*BOUNDARY", f"HOT.LEFT, 11, 11, {HOT!r}", f"COLD.RIGHT, 11, 11, {COLD!r}",
             "*END STEP"]
    flux = gas_flux(gap, emissivity, gas, jump)
    return cards, [Check("heat flux", "heat_flux", "FACE", flux, 1e-8),
                   Check("T of the hot face", "slave_temperature", "FACE",
                         HOT - flux * WALL / STEEL, 1e-8),
                   Check("T of the cold face", "master_temperature", "FACE",
                         COLD + flux * WALL / STEEL, 1e-8)]


# Rods of input/rods: gap, expansions of both, gas A and B, which of the solutions.
RODS = {"r1": (5e-4, 12e-6, 0.0, 0.15, 1e-5, 0), "r1b": (4.4e-4, 12e-6, 0.0, 0.15, 1e-5, 0),
        "r2": (4.7e-4, 12e-6, 0.0, 0.001, 1e-6, 0), "r3-open": (1.2e-4, 0.0, 12e-6, 0.005, 1e-5, 0),
        "r3-middle": (1.2e-4, 0.0, 12e-6, 0.005, 1e-5, 1),
        "r3-closed": (1.2e-4, 0.0, 12e-6, 0.005, 1e-5, 2)}


def rod(name):
    """Return a deck of input/rods and the conductance and flux of its closed form."""
    gap, first, second, a, b, branch = RODS[name]
    both = rods.Rods((0.1, 0.1), (20.0, 20.0), (first, second), (2e11, 2e11), (500.0, 0.0), gap)
    open_law, closed_law = rods.gas(a, b), rods.power(a / b, 1e-4, 1.0)
    omega = rods.solutions(both, open_law, closed_law)[branch]
    text = (INPUT / "rods" / f"{name}.inp").read_text().split("*VERIFY")[0]
    for included in ("rods.inc", "rods.step"):
        text = text.replace(f"*INCLUDE, INPUT={included}",
                            (INPUT / "rods" / included).read_text().strip())
    checks = [Check("conductance", "conductance", "FACE", omega, 1e-8),
              Check("heat flux", "heat_flux", "FACE", both.flux(omega), 1e-8)]
    opening = both.separation(both.flux(omega))
    checks.append(Check("gap", "gap", "FACE", opening, 1e-7) if opening > 0 else
                  Check("pressure", "pressure", "FACE", -opening / both.compliance, 1e-7))
    return text.splitlines(), checks


# Top temperature: normal force, heat rate, peak pressure, edge of contact (independent solver with
# 160 elements along the contact), and what the published mesh may be off by.
PUBLISHED = {180.0: (384.33, 5.044, 167.27, 2.95), 540.0: (1363.74, 17.265, 316.19, 5.54),
             900.0: (2486.96, 30.8, 428.78, 7.46)}


def cylinder(level):
    """Return the published cylinder, refined, and what the independent solver found."""
    text = CYLINDER.read_text().split("*VERIFY")[0]
    head, step, rest = text.partition("*STEP")
    refined = f"*REFINE, LEVELS={level}\n"
    checks = []
    for time, (force, heat, peak, edge) in PUBLISHED.items():
        name = f" at {time:g} C"
        when = f"{time:g}."
        checks += [Check("normal force" + name, "normal_force", "FACE", force, 0.005, when=when),
                   Check("heat rate" + name, "heat_rate", "FACE", heat, 0.025, when=when),
                   Check("peak pressure" + name, "pressure", "MAX", peak, 0.02, when=when),
                   Check("edge of contact" + name, "edge_contact", "FACE", edge, 0.1, "ABS", when)]
    return (head + refined + step + rest).splitlines(), checks


def cases():
    """Return the cases of the theme."""
    return [
        Case("Two walls and a slit",
              """Two walls of 0.495 m, k = 40 W/(m K), 100 and 300 C outside, and between them a
              slit of 10 mm with a conductance of 80 W/(m2 K). Elements inside are distorted.""",
              """Three resistances in series: 5369.13 W/m2, 166.443 and 233.557 C at the faces.""",
              "1e-9: rounding. Temperatures are linear, which every element has exactly.",
              ["CPE8", "CPE8R", "CPE4", "CPE6", "CPE3"], walls, named="element", short=5),
        Case("A crack that heat closes",
             """A plate with a crack of half-length 1.3, clamped far away; plane stress, E = 1000,
             nu = 0.3, alpha = 1e-3. Its temperature falls along the crack, so that the clamped
             plate is under sigma = 5 x in both directions. The crack opens on the cold side and
             closes over a third of its length on the warm one. The mesh is an ellipse of confocal
             elements, whose outer nodes have the displacements and temperatures of the infinite
             plate.""",
             """H. M. Westergaard's functions with K_I = 0 at the closed end, and the free
             displacement of a linear temperature: tests/reference/crack.py.""",
             """5 % with 32 elements around the crack, falling with h^2, the order that quarter
             points at the tips leave. Edge: a quarter of the nodal spacing.""",
             [32, 64, 128], closing_crack, lambda n: f"{n} around", short=1),
        Case("Gas gaps with radiation",
              f"""Two walls of 20 mm, k = 20 W/(m K), {HOT:g} and {COLD:g} K outside, and a gap
              between them: in vacuum (1 mm, emissivities 0.8), with gas of 0.15 W/(m K) as well,
              and a narrow one of 20 um with jump distances of 10 um (emissivities 0.5).""",
              """q = k_gas (T1 - T2)/(gap + jumps) + sigma (T1^4 - T2^4)/(1/e1 + 1/e2 - 1), solved
              by bisection with the walls in series (M. F. Modest, Radiative Heat Transfer, 3rd ed.,
              section 5.1).""",
              "1e-8, a hundred times the least digit to which the conductance is iterated.",
              list(GAPS), gas_gap, named="gap", short=3),
        Case("The rods",
              """Two rods between rigid walls, a gas in their gap (input/rods). R1 and R1b are
              mildly coupled, R2 strongly; R3 is heated from the side that expands less and has
              three solutions.""",
              """J. R. Barber, J. Dundurs, M. Comninou, J. Appl. Mech. 47 (1980) 871-874; roots in
              tests/reference/rods.py.""",
              """1e-8 of the conductance and flux, 1e-7 of the gap or pressure, which small changes
              of the flux change more: the iteration ends at 1e-11.""",
              list(RODS), rod, str.upper, named="rod", short=6),
        Case("The published cylinder",
             """An elastic cylinder on a base, heated from the top, with friction and a conductance
             of gap and pressure: input/cylinder. The mesh is that of the paper, refined up to
             twice.""",
             """V. I. Zaitsev 1987 for the problem. Reference values from an independent solver
             (tests/reference/cylinder_reference.py) with 160 elements along the contact. It works
             by flexibility instead of stiffness and by Newton's method on log omega, and shares
             only the deck.""",
             """Force 0.5 %, heat 2.5 %, pressure 2 %, edge 1 mm: a design value from the mesh of
             the paper, 10 elements along the contact, should be that good. Half a digit of a
             reference is up to 0.2 % of it.""",
             [0, 1, 2], cylinder, lambda n: f"LEVELS={n}", kind="EXTERNAL",
             cite="independent solver", named="refinement", short=1,
             remarks="""On the mesh of the deck, with TOL=1e-12, pressure, shear, gap, slip, flux
             and both edges of all 45 increments agree with the independent solver to 2e-12 of each
             maximum, and the same contact points are closed. CalculiX 2.20 (40 elements along the
             contact, corners near the edge 1-2 mm elsewhere, penalty 1e6 MPa/cm, no conductance
             across a gap) gives at 540 C a force of 1361.3 MPa cm, heat of 17.27 W/cm and a peak of
             316.6 MPa."""),
    ]


def draw(runs, path):
    """Draw the crack, the share of radiation, and the errors of the cylinder."""
    figure, (left, middle, right) = subplots(1, 3, 2.6)
    solved = runs["A crack that heat closes"][1]
    with h5py.File(solved.result) as file:
        face = file["contact/CRACK"]
        x, gap, pressure = face["x"][:] / HALF, face["gap"][-1], face["pressure"][-1]
    opened, pressed = np.linspace(-1 / 3, 1, 200), np.linspace(-0.999, -1 / 3, 200)
    left.plot(opened, 100 * crack.bent_opening(opened * HALF, HALF, SLOPE, YOUNG, POISSON,
                                               "stress"),
              label="100 gap")
    left.plot(pressed, crack.bent_pressure(pressed * HALF, HALF, SLOPE), label="pressure")
    left.plot(x, 100 * gap, ".", color="C0")
    left.plot(x, pressure, ".", color="C1")
    left.set_xlabel("x/a")
    left.set_title("Crack closed by heat")
    left.legend()
    gaps = np.geomspace(1e-5, 1e-2, 40)
    for gas, name in ((0.15, "gas and radiation"), (0.0, "radiation")):
        middle.semilogx(gaps * 1e3, [gas_flux(g, 0.8, gas, 0.0) / 1e3 for g in gaps], label=name)
    for number, name in enumerate(("gas and radiation", "vacuum")):
        found = runs["Gas gaps with radiation"][list(GAPS).index(name)]
        middle.plot(GAPS[name][0] * 1e3, found.verdicts[0].value / 1e3, "o", color=f"C{number}")
    middle.set_xlabel("gap in mm")
    middle.set_ylabel("heat flux in kW/m2")
    middle.set_title("Gas gap with radiation")
    middle.legend()
    solved = runs["The published cylinder"]
    for k, check in enumerate(solved[0].checks[-4:-1]):
        right.semilogy([1, 2, 4], [s.verdicts[len(s.checks) - 4 + k].error for s in solved],
                       marker="o", label=check.name.split(" at ")[0])
    log_sizes(right, [1, 2, 4], "fineness of the mesh")
    right.set_ylabel("difference from the independent solver")
    right.set_title("Published cylinder, 900 C")
    right.legend()
    save(figure, path)


def test_heat(tmp_path):
    import test_heat

    check_short(test_heat, tmp_path)
