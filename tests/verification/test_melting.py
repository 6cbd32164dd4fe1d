"""Melting and solidification: Stefan's and Neumann's fronts, and solids that begin without stress."""

from math import erf, erfc, exp, pi, sqrt

import numpy as np
from manual import Case, Check, check_short, errors_panel
from physics import material, mesh
from pictures import save, subplots
from scipy.optimize import brentq
from test_transients import heat, node_at, start

TITLE = "Melting"
TEXT = """Latent heat, and solids that form without stress (`*ANNEAL TEMPERATURE`): fronts are met
to 0.5 % of their place, half of that on each finer mesh; stress and plastic strain of the solid to
rounding."""
DETAILS = """A front is known by the time at which the last point that melts is solid. Every row halves the
elements, the increments and the interval of the row before."""
TOGETHER = ("Stefan's front",)
PICTURE = "melting"
CAPTION = "Errors of fronts over meshes, increments and intervals"
FINENESS = [1, 2, 4]
STEFAN = {0.1: 0.2200163, 1.0: 0.6200626, 2.0: 0.8006014}   # Ste: l exp(l^2) erf(l) = Ste/sqrt(pi)
INTERVAL = 0.01   # between solidus and liquidus, of the jump of temperature; fineness 1


def label(level):
    """Return how fine a row is."""
    return f"{level} x"


def with_latent(cards, heat_of_mass, solidus, liquidus):
    """Return the cards of a material and its section, with a latent heat."""
    return [*cards[:-1], "*LATENT HEAT", f"{heat_of_mass!r}, {solidus!r}, {liquidus!r}", cards[-1]]


def stefan(number, kind="CPE4"):
    """Return the maker of a bar at the liquidus, whose end is cold from time 0 on."""
    root = STEFAN[number]
    time = (1.0 / (2 * root)) ** 2

    def make(level):
        count = 20 * level
        cards = [*mesh("BAR", [float(x) for x in np.linspace(0.0, 1.0, count + 1)],
                       [0.0, 1.0 / count], kind),
                 *with_latent(material("BAR", None, conductivity=1.0, density=1.0,
                                       specific_heat=1.0), 1 / number, 1.0 - INTERVAL / level, 1.0)]
        return [*cards, *start("BAR", 1.0),
                *heat(time / (7 * count), 1.2 * time, "*BOUNDARY", "BAR.LEFT, 11, 11, 0.")], [
            Check(f"front at the end, Ste = {number:g}", "solid_time", "", time, 0.01 / level)]

    return make


def neumann_root(ratio, warmth, number):
    """Return l of Neumann's front; conductivities solid to liquid, what the melt is above."""
    side = sqrt(ratio)
    return brentq(lambda x: exp(-x * x) / erf(x) - warmth / side * exp(-x * x * ratio) / erfc(
        x * side) - x * sqrt(pi) / number, 1e-3, 3.0)


def neumann(level):
    """Return a bar that is above the liquidus by half of the jump, k = 2 when solid, 1 molten."""
    root = neumann_root(2.0, 0.5, 1.0)
    time = 1.0 / (4 * root**2 * 2.0)
    count = 20 * level
    solidus = 1.0 - INTERVAL / 4 / level
    ways = [(2.0, 1.0 - INTERVAL / level), (1.0, 1.0)]
    melt = with_latent(material("MELT", None, conductivity=ways, density=1.0, specific_heat=1.0),
                       1.0, solidus, 1.0)
    rest = material("REST", None, conductivity=1.0, density=1.0, specific_heat=1.0)
    cards = [*mesh("BAR", [float(x) for x in np.linspace(0.0, 5.0, 5 * count + 1)],
                   [0.0, 1.0 / count], "CPE4"),
             "*ELSET, ELSET=MELT, GENERATE", f"1, {count}",
             "*ELSET, ELSET=REST, GENERATE", f"{count + 1}, {5 * count}", *melt, *rest]
    return [*cards, *start("BAR", 1.5),
            *heat(time / (7 * count), 1.2 * time, "*BOUNDARY", "BAR.LEFT, 11, 11, 0.")], [
        Check("front at x = 1", "solid_time", "", time, 0.01 / level),
        Check("T at x = 0.5, front at x = 1", "NT", node_at(cards, 0.5),
              erf(root / 2) / erf(root), 0.005 / level, when=f"{time!r}"),
        Check("T at x = 2, front at x = 1", "NT", node_at(cards, 2.0),
              1.5 - 0.5 * erfc(2.0 / (2 * sqrt(time))) / erfc(root * sqrt(2.0)), 0.005 / level,
              when=f"{time!r}")]


def clamped(increments):
    """Return a bar between walls that cools from 700, solid below 500, is melted and cools again."""
    cards = [*mesh("BAR", [0.0, 1.0], [0.0, 1.0], "CPS4"),
             *material("BAR", (200e3, 0.3), expansion=1e-5)]
    cards[-1:] = ["*PLASTIC", "300., 0.", "1300., 1.", "*ANNEAL TEMPERATURE", "500.", cards[-1]]
    steps = []
    for end in (450.0, 100.0, 700.0, 300.0):
        steps += ["*STEP, INC=1000", "*STATIC, DIRECT", f"{1 / increments!r}, 1.", "*BOUNDARY",
                  "BAR.LEFT, 1", "BAR.RIGHT, 1", "BAR.BOTTOM, 2", "*TEMPERATURE", f"BAR, {end!r}",
                  "*END STEP"]

    def plastic(cooled):
        return (1e-5 * cooled - 300.0 / 200e3) / (1 + 1000.0 / 200e3)

    return [*cards, *start("BAR", 700.0), *steps], [
        Check(f"{name}, {when}", quantity, "BAR", value, tolerance, how, f"{time!r}")
        for name, quantity, when, time, value, tolerance, how in (
            ("stress", "S11", "cooled by 50 below", 1.0, 100.0, 1e-8, "REL"),
            ("plastic strain", "PEEQ", "by 400", 2.0, plastic(400.0), 1e-8, "REL"),
            ("stress", "S11", "by 400", 2.0, 300.0 + 1000.0 * plastic(400.0), 1e-8, "REL"),
            ("stress", "S11", "molten", 3.0, 0.0, 1e-9, "ABS"),
            ("plastic strain", "PEEQ", "molten", 3.0, 0.0, 1e-12, "ABS"),
            ("plastic strain", "PEEQ", "anew by 200", 4.0, plastic(200.0), 1e-8, "REL"),
            ("stress", "S11", "anew by 200", 4.0, 300.0 + 1000.0 * plastic(200.0), 1e-8, "REL"))]


def cases():
    """Return the cases of the theme."""
    source = """H. S. Carslaw, J. C. Jaeger: Conduction of Heat in Solids, 1959, chapter 11."""
    tolerance = """1 % of the time, 0.5 % of the place of the front, and 0.5 % of temperatures, half
    of it with each finer row. Heat of the interval that is given off behind the front instead of at
    it, a hundredth of the jump on the coarsest mesh, delays it by about half of that part."""
    shared = {"source": source, "tolerance": tolerance, "meshes": FINENESS, "label": label}
    return [
        *(Case(f"Stefan's front, Ste = {number:g}",
               f"""A bar of 1 at the liquidus 1, k = rho c = 1, latent heat {1 / number:g}, one end at
               0 from time 0 on, the other insulated: it is solid when the front 2 l sqrt(t), l =
               {root}, is at its end. 20 elements of four nodes, an interval of {INTERVAL} and 140
               increments, and finer.""", make=stefan(number), **shared)
          for number, root in STEFAN.items()),
        Case("Neumann's front",
             """A long bar at 1.5, rho c = 1, k = 2 when solid and 1 when molten, liquidus and latent
             heat 1, one end at 0 from time 0 on; k changes over the interval above. Only the first fifth melts, the rest is as the
             melt, so that the time is known at which the front is at x = 1. 100 elements, 140
             increments and an interval of a quarter of that above, as the melt behind it is warm
             and its solidus follows its liquidus, twice as fine, and finer.""",
             make=neumann, **{**shared, "meshes": [2, 4]}),
        Case("A bar that becomes solid between walls",
             """A bar in plane stress, E = 200e3, alpha = 1e-5, yield stress 300, which hardens by
             1000, annealing temperature 500. It cools from 700 to 450 and 100, is melted at 700 and
             cools to 300. Increments pass 500 where they like.""", "Closed form.",
             "Rounding: strains are straight in an increment.", [1, 3, 8], clamped,
             named="increments")]


def draw(runs, path):
    """Draw the errors of the fronts."""
    figure, panels = subplots(2, 2, height=6.0)
    fronts = [(title, solved) for title, solved in runs.items()
              if "front" in title]
    for axes, (title, solved) in zip(panels.flat, fronts, strict=True):
        errors_panel(axes, solved, title, "fineness of mesh, increments and interval")
    save(figure, path)


def test_fronts_and_solids_that_begin_against_closed_forms(tmp_path):
    import test_melting

    check_short(test_melting, tmp_path)
