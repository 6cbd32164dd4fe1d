"""Mistakes that leave a deck solvable are told: faces that nothing relates, nodes that hang, folded elements,
constants of other units, two plane states at one interface, characters that look like others."""

import re

import h5py
import numpy as np
import pytest
from blocks import block, solid, without_unused_surfaces, write
from deck_runs import run, solve
from physics import mesh, nodes_of

XS = [0.0, 1.0, 2.0, 3.0, 4.0]


def warnings(folder, *cards, status=0):
    """Check a deck; return the warnings, or the errors of one that is refused, as (line image, message)."""
    deck = write(folder / "deck.inp", without_unused_surfaces([c for part in cards for c in part]))
    process = run("check", "--quiet", deck)
    assert process.returncode == status, process.stderr
    return re.findall(r"^[^\n]*:\d+:\d+: (?:warning|error): (.*)\n(.*)$", process.stderr, re.M)


def one(found, card):
    """Return the message of the only warning, which stands at a card."""
    assert len(found) == 1, found
    assert found[0][1].startswith(card), found
    return found[0][0]


def blocks(xs=XS, shift=0.0, gap=0.0, kinds=("CPE8", "CPE8"), to=None):
    """Return two blocks, one on the other, of materials LOW and HIGH; the upper one starts at node 101."""
    cards = mesh("LOW", XS, [0.0, 1.0, 2.0], kinds[0], to=to)
    cards += mesh("HIGH", [x + shift for x in xs], [2.0 + gap, 3.0 + gap], kinds[1], first=101, to=to)
    return [*cards, *solid("LOW", 2e5, 0.3), *solid("HIGH", 2e5, 0.3)]


HELD = ["*BOUNDARY", "LOW.BOTTOM, 1, 2", "HIGH.TOP, 1"]
PAIR = ["*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I, NAME=F", "HIGH.BOTTOM, LOW.TOP"]
TIE = ["*TIE, NAME=F", "HIGH.BOTTOM, LOW.TOP"]
STEP = ["*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "HIGH.TOP, 2, 2, -0.001", "*END STEP"]


def opposite_nodes(cards):
    """Return the numbers of the nodes at y = 2 of the lower and the upper block, by their x."""
    at = {n: p for n, p in nodes_of(cards).items() if p[1] == 2.0}
    low = sorted((p[0], n) for n, p in at.items() if n < 101)
    return low, sorted((p[0], n) for n, p in at.items() if n > 100)


@pytest.mark.parametrize("kind", ["CPE8", "CPE4", "CPE6", "CAX8R"])
def test_bodies_that_touch_without_a_pair(tmp_path, kind):
    cards = blocks(kinds=(kind, kind))
    low, high = opposite_nodes(cards)
    first, partner = min((n, m) for (_, n), (_, m) in zip(low, high, strict=True))
    message = one(warnings(tmp_path, cards, HELD, STEP), f"{first}, ")
    assert message.startswith("body 1 (of LOW, first node 1) and body 2 (of HIGH, first node 101) touch at "
                              f"{len(low)} places, first node {first} and node {partner} at ")
    for card in ("*CONTACT PAIR", "*TIE", "*EQUATION", "*COUPLING"):
        assert card in message


def equations():
    """Return equations of all opposite nodes."""
    low, high = opposite_nodes(blocks())
    return [card for (_, n), (_, m) in zip(low, high, strict=True) for dof in (1, 2)
            for card in ("*EQUATION", "2", f"{n}, {dof}, 1., {m}, {dof}, -1.")]


COUPLINGS = ["*NODE", "901, 2., 2.5", *(card for name, surface in (("A", "LOW.TOP"), ("B", "HIGH.BOTTOM")) for card in (
    f"*COUPLING, REF NODE=901, SURFACE={surface}, CONSTRAINT NAME={name}", "*KINEMATIC", "1, 2"))]


@pytest.mark.parametrize("related", [PAIR, TIE, equations(), COUPLINGS],
                         ids=["pair", "tie", "equations", "couplings"])
def test_bodies_that_are_related_may_touch(tmp_path, related):
    assert warnings(tmp_path, blocks(), related, HELD, STEP) == []


@pytest.mark.parametrize(("shift", "gap", "touch"), [(0.0, 0.0, True), (0.0, 0.1, False), (4.0, 0.0, False),
                                                     (3.5, 0.0, True), (-4.0, 0.0, False), (0.0, 1e-7, True)])
def test_bodies_touch_along_a_length(tmp_path, shift, gap, touch):
    """Not where they meet in a corner."""
    assert len(warnings(tmp_path, blocks(shift=shift, gap=gap), HELD, STEP)) == touch


@pytest.mark.parametrize(("kinds", "bent"), [(("CPE8", "CPE8"), False), (("CPE8", "CPE8"), True),
                                             (("CPE4", "CPE8"), False), (("CPE3", "CPE4"), False)])
def test_faces_touch_whose_nodes_do_not_match(tmp_path, kinds, bent):
    """Straight, or bent to rings of inner radius 10: chords of unequal length would have gaps between them."""
    def to(x, y):
        angle, radius = 0.1 * x, 10.0 + y
        return radius * np.sin(angle), radius * np.cos(angle)

    cards = blocks(xs=[0.0, 0.7, 1.9, 3.1, 4.0], kinds=kinds, to=to if bent else None)
    found = warnings(tmp_path, cards, HELD, STEP)
    assert len(found) == 1
    assert "touch at " in found[0][0]
    assert warnings(tmp_path, cards, TIE, HELD, STEP) == []


def test_bodies_that_touch_are_told_once_for_two(tmp_path):
    """Three in a row, of which the upper two are paired, or none are."""
    top = mesh("LAST", XS, [3.0, 4.0], first=201)
    cards = [*blocks(), *top, *solid("LAST", 2e5, 0.3)]
    held = [*HELD, "LAST.TOP, 1, 2"]
    found = warnings(tmp_path, cards, held, STEP)
    assert [re.findall(r"body \d", message) for message, _ in found] == [["body 1", "body 2"], ["body 2", "body 3"]]
    pair = [*PAIR[:2], "LAST.BOTTOM, HIGH.TOP"]
    assert "body 1 (" in one(warnings(tmp_path, cards, pair, held, STEP), "")


@pytest.mark.parametrize("kind", ["CPE8", "CPE4", "CPE3"])
@pytest.mark.parametrize(("xs", "gap", "told"), [
    (XS, -2.0, True), (XS, -1.0, True), ([1.0, 2.0], -1.5, True), (XS, -0.5, False), (XS, -2.5, False),
    ([3.5, 4.5], -1.5, False)])
@pytest.mark.parametrize("related", [[], PAIR], ids=["apart", "pair"])
def test_a_body_that_lies_wholly_inside_another(tmp_path, kind, xs, gap, told, related):
    """The inner one fills the upper or the lower half, or is within; not where only a part of it is."""
    found = [message for message, _ in warnings(tmp_path, blocks(xs=xs, gap=gap, kinds=(kind, kind)), related,
                                                HELD, STEP) if "wholly" in message]
    assert found == told * ["body 2 (of HIGH, first node 101) lies wholly inside body 1 (of LOW, first node "
                            "1): both fill the same place; check the positions of the bodies"]


def test_two_bodies_of_one_shape_at_one_place_are_told_once(tmp_path):
    twin = [card for name, first in (("LOW", 1), ("HIGH", 101))
            for card in mesh(name, XS, [0.0, 1.0, 2.0], first=first)]
    found = warnings(tmp_path, twin, *(solid(name, 2e5, 0.3) for name in ("LOW", "HIGH")), HELD, STEP)
    assert [message for message, _ in found if "wholly" in message] == [found[0][0]]


@pytest.mark.parametrize("kind", ["CPE8", "CPE4"])
@pytest.mark.parametrize("thickness", [0.02, 1.0])
def test_a_sleeve_in_a_bore_lies_inside_nothing(tmp_path, kind, thickness):
    """However thin: sides of the ring and of the sleeve have the same ends, or lie between them."""
    cards = []
    for name, radii, count, first in (("LOW", [2.0, 3.0], 12, 1), ("HIGH", [2.0 - thickness, 2.0], 24, 501)):
        def to(x, y):
            angle = 2 * np.pi * x / count  # noqa: B023  used before the next one
            return y * np.cos(angle), -y * np.sin(angle)

        cards += mesh(name, list(map(float, range(count + 1))), radii, kind, first, to=to, closed=True)
        cards += solid(name, 2e5, 0.3)
    found = warnings(tmp_path, cards, HELD, STEP)
    assert not [message for message, _ in found if "wholly" in message]


def ring(closed, count=12):
    """Return a ring, closed or cut along a seam, with its bore held."""
    def to(x, y):
        angle = 2 * np.pi * x / count
        return (2.0 + y) * np.cos(angle), -(2.0 + y) * np.sin(angle)

    cards = mesh("RING", list(map(float, range(count + 1))), [0.0, 0.5, 1.0], to=to, closed=closed)
    return [*cards, *solid("RING", 2e5, 0.3), "*BOUNDARY", "RING.BOTTOM, 1, 2", "*STEP", "*STATIC", "1., 1.",
            "*DSLOAD", "RING.TOP, P, 1.", "*END STEP"]


def test_a_body_that_is_cut_along_a_seam(tmp_path):
    """Nodes of two rows of elements with midsides: 5."""
    message = one(warnings(tmp_path, ring(closed=False)), "")
    assert message.startswith("body 1 (of RING, first node 1) is cut along a seam: its faces touch at 5 places, first ")
    assert warnings(tmp_path, ring(closed=True)) == []


def coarse_on_fine(fine, kind="CPE4"):
    """Return one body: two elements, and above each `fine` that share its ends."""
    xs = np.linspace(0.0, 2.0, 2 * fine + 1)
    nodes = {(x, 0.0): 1 + k for k, x in enumerate((0.0, 1.0, 2.0))} | {(x, 1.0): 11 + k for k, x in enumerate(xs)}
    nodes |= {(x, 2.0): 101 + k for k, x in enumerate(xs)}
    cards = ["*NODE", *(f"{n}, {x:.15g}, {y:.15g}" for (x, y), n in nodes.items()), f"*ELEMENT, TYPE={kind}, ELSET=ALL"]
    cards += [f"{k + 1}, {k + 1}, {k + 2}, {11 + (k + 1) * fine}, {11 + k * fine}" for k in (0, 1)]
    cards += [f"{k + 11}, {k + 11}, {k + 12}, {k + 102}, {k + 101}" for k in range(2 * fine)]
    return [*cards, *solid("ALL", 2e5, 0.3), "*BOUNDARY", "1, 1, 2", "2, 2", "3, 2", "*STEP", "*STATIC", "1., 1.", "*CLOAD",
            "101, 2, 1.", "*END STEP"]


@pytest.mark.parametrize(("fine", "hanging"), [(1, 0), (2, 2), (3, 4)])
def test_nodes_that_hang(tmp_path, fine, hanging):
    found = warnings(tmp_path, coarse_on_fine(fine))
    if not hanging:
        assert found == []
        return
    message = one(found, "12, ")
    assert re.match(r"node 12 at \S+, 1 hangs: it lies on side 3 of element 1 and is no node of it", message)
    assert message.endswith(f"; hanging nodes: {hanging}")


def test_an_equation_may_hold_a_hanging_node(tmp_path):
    rows = [card for n, a, b in ((12, 11, 13), (14, 13, 15)) for dof in (1, 2)
            for card in ("*EQUATION", "3", f"{n}, {dof}, 1., {a}, {dof}, -0.5, {b}, {dof}, -0.5")]
    cards = coarse_on_fine(2)
    at = cards.index("*BOUNDARY")
    assert warnings(tmp_path, [*cards[:at], *rows, *cards[at:]]) == []


def element(kind, places):
    """Return a deck of one element with these nodes, held at the first two corners."""
    return ["*NODE", *(f"{n}, {x!r}, {y!r}" for n, (x, y) in enumerate(places, start=1)),
            f"*ELEMENT, TYPE={kind}, ELSET=ALL", ", ".join(map(str, [1, *range(1, len(places) + 1)])),
            *solid("ALL", 1e3, 0.3), "*BOUNDARY", "1, 1, 2", "2, 1, 2", "*STEP", "*STATIC", "1., 1.", "*CLOAD", "3, 1, 1.",
            "*END STEP"]


SQUARE = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]
MIDDLES = [(1.0, 0.0), (2.0, 1.0), (1.0, 2.0), (0.0, 1.0)]
TRIANGLE = [(0.0, 0.0), (2.0, 0.0), (2.0, 3.0), (1.0, 1.0), (2.0, 1.5), (1.0, 1.5)]


@pytest.mark.parametrize(("kind", "places", "node"), [
    ("CPE6", TRIANGLE, 1), ("CPE6", [*TRIANGLE[:3], (1.0, 0.0), *TRIANGLE[4:]], None),
    ("CPE8", SQUARE + MIDDLES, None),
    ("CPE8", SQUARE + [(0.5, 0.0), *MIDDLES[1:3], (0.0, 0.5)], None),
    ("CPE8", SQUARE + [(0.499, 0.0), *MIDDLES[1:]], None),
    ("CPE8", SQUARE + [(0.1, 0.0), *MIDDLES[1:3], (0.0, 0.1)], 1),
    ("CPE8", SQUARE + [(0.4, 0.0), *MIDDLES[1:3], (0.0, 1.0)], 1),
    ("CPE8", [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 0.0), (1.0, 0.0), (2.0, 1.0), (1.0, 1.0), (0.0, 0.0)], None),
    ("CPE4", SQUARE, None), ("CPE4", [*SQUARE[:2], (0.9, 0.9), SQUARE[3]], 3)])
def test_elements_that_are_folded_at_a_node(tmp_path, kind, places, node):
    """A midside node nearer to a corner than a quarter of the side, or far off it, a corner that is not convex. The
    Jacobian is 0 at quarter points, of few digits, and where corners are in one place; at a corner to which two
    sides return it is positive."""
    found = warnings(tmp_path, element(kind, places))
    if node is None:
        assert found == []
        return
    assert one(found, "1, 1, 2, 3").startswith(f"element 1 is folded at node {node}: its Jacobian is negative near it")


def test_folded_elements_are_counted(tmp_path):
    cards = mesh("ALL", [0.0, 1.0, 2.0], [0.0, 1.0])
    moved = next(n for n, p in nodes_of(cards).items() if p == (1.0, 0.5))
    at = next(k for k, card in enumerate(cards) if card.startswith(f"{moved}, "))
    cards[at] = f"{moved}, 1., 0.8"
    step = [*solid("ALL", 1e3, 0.3), "*BOUNDARY", "ALL.BOTTOM, 1, 2", "*STEP", "*STATIC", "1., 1.", "*CLOAD",
            f"{moved}, 1, 1.", "*END STEP"]
    assert one(warnings(tmp_path, cards, step), "1, ").endswith("; folded elements: 2")


@pytest.mark.parametrize("heat", [False, True])
def test_errors_of_folded_elements_are_numbers(tmp_path, heat):
    """Points at which errors are integrated are inside the fold."""
    second = ["*NODE", "7, 0., 3.", "8, 1., 3.", "9, 0., 1.5", "*ELEMENT, TYPE=CPE6, ELSET=ALL", "2, 1, 3, 7, 6, 8, 9"]
    start = element("CPE6", TRIANGLE)
    cards = [*start[:9], *second, *solid("ALL", 1e3, 0.3)]
    if heat:
        cards += ["*STEP", "*HEAT TRANSFER, STEADY STATE", "1., 1.", "*BOUNDARY", "3, 11", "7, 11", "8, 11", "*CFLUX",
                  "1, 11, 1.", "*END STEP"]
    else:
        cards += ["*BOUNDARY", "3, 2", "8, 2", "7, 1, 2", "*STEP", "*STATIC", "1., 1.", "*CLOAD", "1, 2, -2.", "2, 2, -1.",
                  "4, 2, -3.", "*END STEP"]
    with h5py.File(solve(write(tmp_path / "deck.inp", cards))) as file:
        errors = file["history/heat_flux_error" if heat else "history/stress_error"][:]
    assert np.all(errors > 0.0), errors
    assert np.all(errors < 1.0), errors


def test_errors_of_an_element_that_is_pinched_are_numbers(tmp_path):
    """Two opposite midside nodes at the centre: x = xi eta^2 + 1, y = eta + 1, so the Jacobian eta^2 is 0 on a row of
    points at which errors are integrated."""
    cards = element("CPE8R", SQUARE + [MIDDLES[0], (1.0, 1.0), MIDDLES[2], (1.0, 1.0)])
    with h5py.File(solve(write(tmp_path / "deck.inp", cards))) as file:
        errors = file["history/stress_error"][:]
    assert np.all((errors >= 0.0) & (errors < 1.0)), errors


CONSTANTS = "*PHYSICAL CONSTANTS, ABSOLUTE ZERO={}, STEFAN BOLTZMANN={}"


@pytest.mark.parametrize(("units", "zero", "boltzmann", "told"), [
    ("mm MPa W C", "-273.15", "5.670374E-14", []), ("m Pa W K", "0.", "5.67E-8", []),
    ("mm MPa W °C", "-273", "5.67E-14", []), ("cm MPa W degC", "-273.15", "5.67E-12", []),
    ("mm MPa mW C", "-273.15", "5.67E-11", []), ("m Pa kW K", "0.", "5.67E-11", []),
    # 0.1714E-8 BTU/(h ft2 R4), as in tables of heat transfer
    ("ft psf BTU/h F", "-459.67", "0.1714E-8", []), ("in psi BTU/h R", "0.", "1.19E-11", []),
    ("furlong MPa horse Z", "-200.", "3.", []),
    ("mm MPa W C", "273.15", "5.67E-14", ["absolute zero is 273.15, but -273.15 in C"]),
    ("mm MPa W C", "0.", "5.67E-14", ["absolute zero is 0, but -273.15 in C"]),
    ("m Pa W K", "-273.15", "5.67E-8", ["absolute zero is -273.15, but 0 in K"]),
    ("ft psf BTU/h F", "-273.15", "0.1714E-8", ["absolute zero is -273.15, but -459.67 in F"]),
    ("mm MPa W C", "-273.15", "5.67E-8", ["is 5.67E-8, but 5.670374E-14 in the units"]),
    ("m Pa W K", "0.", "5.67E-14", ["is 5.67E-14, but 5.670374E-8 in the units"]),
    ("mm MPa mW C", "-273.15", "5.67E-14", ["is 5.67E-14, but 5.670374E-11 in the units"]),
    ("mm MPa MW C", "-273.15", "5.67E-14", ["is 5.67E-14, but 5.670374E-20 in the units"]),
    (None, "-273.15", "1.", []), (None, "0.", "1.", []), (None, "273.15", "1.", ["absolute zero is 273.15, above 0"]),
    (None, "30.", "1.", ["absolute zero is 30, above 0"])])
def test_constants_of_radiation_in_other_units(tmp_path, units, zero, boltzmann, told):
    label = [f'*OPTIONS, UNITS="{units}"'] if units else []
    found = warnings(tmp_path, label, [CONSTANTS.format(zero, boltzmann)], heated("20."))
    found = [(message, card) for message, card in found if "Young" not in message and "conductivity" not in message]
    assert len(found) == len(told)
    for (message, card), words in zip(found, told, strict=True):
        assert words in message
        assert card.startswith("*PHYSICAL CONSTANTS")


@pytest.mark.parametrize(("units", "young", "conductivity", "told"), [
    ("mm MPa W C", 2.1e5, 0.05, {}), ("mm MPa W C", 1e8, 2.0, {}), ("m Pa W K", 2.1e11, 50.0, {}), ("in psi BTU/h F", 3e7, 2.2, {}),
    ("mm N/mm2 mW C", 2.1e5, 50.0, {}), ("m Pa W C", 5e3, 0.02, {}), ("m GPa kW C", 1050.0, 2.0, {}),
    ("furlong stone horse Z", 1e30, 1e30, {}), (None, 1e30, 1e30, {}),
    ("mm MPa W C", 2.1e11, 50.0, {"*ELASTIC": "2.1E+11 of LOW is 2.1E+17 Pa", "*CONDUCTIVITY": "50 of LOW is 50000 W/(m K)"}),
    ("m Pa W C", 210.0, 50.0, {"*ELASTIC": "210 of LOW is 210 Pa"}),
    ("m kPa kW K", 2.1e8, 50.0, {"*CONDUCTIVITY": "50 of LOW is 50000 W/(m K)"}),
    ("in psi BTU/h F", 2.1e12, 2.2, {"*ELASTIC": "is 1.447"})])
def test_properties_that_no_solid_has_in_the_units_of_the_deck(tmp_path, units, young, conductivity, told):
    label = [f'*OPTIONS, UNITS="{units}"'] if units else []
    cards = [*mesh("LOW", [0.0, 1.0], [0.0, 1.0]), *solid("LOW", young, 0.3, 0.0, conductivity), *HEATED]
    found = warnings(tmp_path, label, cards)
    assert {card for _, card in found} == told.keys()
    assert all(told[card] in message and "units of *OPTIONS, UNITS=, beyond the" in message for message, card in found)


@pytest.mark.parametrize(("units", "told"), [
    ("MPa mm W C s", "MPa is a stress, but stands where the length is"), ("mm N W K s", "N is a force, but stands where the stress is"),
    ("mm MPa C W", "C is a temperature, but stands where the power is"), ("m Pa W s", "s is a time, but stands where the temperature is"),
    ("mm MPa W degC s", None), ("furlong stone horse Z", None), ("mm MPa", None)])
def test_a_unit_in_the_place_of_another(tmp_path, units, told):
    label = f'*OPTIONS, UNITS="{units}"'
    found = [message for message, card in warnings(tmp_path, [label], heated("20.")) if card == label]
    words = ": UNITS= has length, stress, power, temperature, time"
    assert found == ([told + words] if told else [])


@pytest.mark.parametrize(("heat", "units", "told"), [
    (3.9e5, "mm MPa W C", False), (390.0, "mm MPa W C", True), (3.9e8, "mm MPa W C", True), (390.0, "furlong MPa W Z", False)])
def test_a_latent_heat_in_other_units_than_the_specific_heat(tmp_path, heat, units, told):
    cards = [f'*OPTIONS, UNITS="{units}"', *heated("20.")]
    melt = ["*DENSITY", "2.7E-6", "*SPECIFIC HEAT", "1000.", "*LATENT HEAT", f"{heat!r}, 30., 60."]
    where = cards.index("*ELASTIC")
    found = [message for message, card in warnings(tmp_path, [*cards[:where], *melt, *cards[where:]]) if "latent heat of" in message]
    assert len(found) == told
    assert all("K times its specific heat" in message for message in found)


# Steel by its handbook in each system, and how much heat a unit of work is there.
@pytest.mark.parametrize(("units", "density", "specific_heat", "work"), [
    ("mm MPa W C", 7.85e-6, 480.0, 1e-3), ("m Pa W K", 7850.0, 480.0, 1.0), ("cm MPa W C", 7.85e-3, 480.0, 1.0),
    ("mm MPa mW C", 7.85e-9, 4.8e8, 1.0), ("mm MPa W C min", 7.85e-6, 8.0, 1e-3 / 60), ("m kPa kW C h", 7850.0, 0.48 / 3600, 1 / 3600),
    ("in psi BTU/h F h", 0.284, 0.115, 1.071e-4)])
@pytest.mark.parametrize(("times", "parts", "told"), [
    (1.0, (1.0, 0.9), []), (1e3, (0.5, 0.1), ["*SPECIFIC HEAT"]), (1e-3, (0.5, 0.0), ["*SPECIFIC HEAT"]), (1.0, (0.0, 0.0), []),
    (1.0, (1.05, 0.9), ["*GAP HEAT GENERATION"]), (1.0, (0.5, 0.005), ["*INELASTIC HEAT FRACTION"])])
def test_heat_of_a_volume_and_of_work_in_other_units(tmp_path, units, density, specific_heat, work, times, parts, told):
    eta, fraction = (min(part * work, 1.0) for part in parts)
    told = [card for card in told if card != "*GAP HEAT GENERATION" or parts[0] * work <= 1.0]
    cards = [f'*OPTIONS, UNITS="{units}"', *blocks()]
    where = cards.index("*ELASTIC")
    cards[where:where] = ["*PLASTIC", "1.E30, 0.", "*DENSITY", repr(density), "*SPECIFIC HEAT", repr(specific_heat * times),
                          "*INELASTIC HEAT FRACTION", repr(fraction)]
    pair = [PAIR[0], "*FRICTION", "0.3", "*GAP HEAT GENERATION", repr(eta), *PAIR[1:]]
    step = ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "LOW, 20.", "HIGH, 20.", "*BOUNDARY", "HIGH, 11, 11, 20.", *(
        "*COUPLED TEMPERATURE-DISPLACEMENT" if card == "*STATIC" else card for card in STEP)]
    found = [(message, card) for message, card in warnings(tmp_path, cards, pair, HELD, step) if "UNITS=" in message]
    assert [card for _, card in found if not card.startswith(("*ELASTIC", "*CONDUCTIVITY"))] == told


@pytest.mark.parametrize(("units", "told"), [
    ("mm MPa W C", "1 MPa mm^3/s is 1E-3 W"), ("mm MPa mW C", None), ("m Pa W C", None), ("m kPa W C min", "1 kPa m^3/min is 16.6667 W")])
def test_heat_of_strains_needs_the_unit_of_work(tmp_path, units, told):
    cards = heated("20.")
    where = cards.index("*ELASTIC")
    cards[where:where] = ["*DENSITY", "7.85E-6", "*SPECIFIC HEAT", "480.", "*EXPANSION", "1.E-9"]
    cards = ["*COUPLED TEMPERATURE-DISPLACEMENT, DILATATION=YES" if card.startswith("*HEAT") else card for card in cards]
    cards = [f'*OPTIONS, UNITS="{units}"', CONSTANTS.format("-273.15", "1."), *cards[:-1], "LOW.BOTTOM, 1, 2", cards[-1]]
    found = [(message, card) for message, card in warnings(tmp_path, cards) if "DILATATION" in message]
    assert len(found) == (told is not None)
    for message, card in found:
        assert told in message
        assert card.startswith("*COUPLED")


def test_units_are_judged_beside_errors_elsewhere(tmp_path):
    """A property that cannot be read has no unit; that of the other is told in the same check."""
    label = ['*OPTIONS, UNITS="m Pa W C"']
    cards = [*mesh("LOW", [0.0, 1.0], [0.0, 1.0]), *solid("LOW", 210.0, 0.3, 0.0, 50.0), *HEATED]
    where = cards.index("*CONDUCTIVITY") + 1
    wrong = [*cards[:where], "fifty", *cards[where + 1:], "*MATERIAL, NAME=NONE", "*LATENT HEAT", "3.9E5, 555., 615."]
    found = warnings(tmp_path, label, wrong, status=1)
    assert [card for message, card in found if "of solids" in message] == ["*ELASTIC"]
    assert [card for message, card in found if "fifty" in message] == ["fifty"]


@pytest.mark.parametrize("analysis", ["*STATIC", "*HEAT TRANSFER, STEADY STATE"])
def test_units_of_properties_that_no_step_needs_are_not_judged(tmp_path, analysis):
    cards = [*mesh("LOW", [0.0, 1.0], [0.0, 1.0]), *solid("LOW", 2.1e11, 0.3, 0.0, 50.0),
             *(analysis if card.startswith("*COUPLED") else card for card in HEATED
               if analysis != "*STATIC" or ", 11," not in card)]
    found = warnings(tmp_path, ['*OPTIONS, UNITS="mm MPa W C"'], cards)
    assert [card for message, card in found if "of solids" in message] == [
        "*ELASTIC" if analysis == "*STATIC" else "*CONDUCTIVITY"]


HEATED = ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "LOW, 20.", "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE",
          "1., 1.", "*BOUNDARY", "LOW.BOTTOM, 1, 2", "LOW.TOP, 2, 2, 1.E-5", "LOW.BOTTOM, 11, 11, 20.", "LOW.TOP, 11, 11, 90.",
          "*END STEP"]


def heated(cold):
    """Return a block between 100 degrees and another temperature."""
    return [*mesh("LOW", [0.0, 1.0], [0.0, 1.0]), *solid("LOW", 1.0, 0.3),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "LOW, 100.", "*STEP", "*HEAT TRANSFER, STEADY STATE", "1., 1.", "*BOUNDARY",
            "LOW.BOTTOM, 11, 11, 100.", f"LOW.TOP, 11, 11, {cold}", "*END STEP"]


@pytest.mark.parametrize(("cold", "zero", "warned"), [("-20.", "0.", True), ("0.", "0.", False), ("-300.", "-273.15", True),
                                                      ("-270.", "-273.15", False)])
def test_temperatures_below_absolute_zero(tmp_path, cold, zero, warned):
    found = warnings(tmp_path, [CONSTANTS.format(zero, "1.")], heated(cold))
    assert len(found) == warned
    if warned:
        assert f"but the deck has a temperature of {cold[:-1]}, below it" in one(found, "*PHYSICAL")


@pytest.mark.parametrize("joint", [PAIR, TIE], ids=["pair", "tie"])
@pytest.mark.parametrize(("kinds", "warned"), [(("CPE8", "CPS8"), True), (("CPS4", "CPE4"), True),
                                               (("CPS8", "CPS8"), False), (("CPE8", "CPE8R"), False)])
def test_plane_stress_and_plane_strain_at_one_interface(tmp_path, joint, kinds, warned):
    found = warnings(tmp_path, blocks(kinds=kinds), joint, HELD, STEP)
    assert len(found) == warned
    if warned:
        stress, strain = (101, 3) if kinds[1].startswith("CPS") else (3, 101)
        words = "tie F" if joint is TIE else "contact pair F"
        assert re.match(rf"{words}: element \d+ is in plane stress and element \d+ in plane strain", one(found, joint[-2]))
        numbers = list(map(int, re.findall(r"element (\d+)", found[0][0])))
        assert [n > 100 for n in numbers] == [stress > 100, strain > 100]


QUOTED = [("“", "”", "U+201C (left double quote)"), ("„", "“", "U+201E (low double quote)"),
          ("‘", "’", "U+2018 (left single quote)"), ("«", "»", "U+00AB (left guillemet)")]


@pytest.mark.parametrize(("begin", "end", "name"), QUOTED)
def test_typographic_quotes(tmp_path, begin, end, name):
    """Where the card can be taken as it is, a warning; else they are the error. Columns are those of characters."""
    units = f"*OPTIONS, UNITS={begin}mm MPa W C{end}"
    message = one(warnings(tmp_path, [units], heated("20.")), units)
    assert message.startswith(f"this character is {name}; type a plain ")
    deck = write(tmp_path / "deck.inp", [units], heated("20."))
    assert f"deck.inp:1:{units.index(begin) + 1}: warning: " in run("check", deck).stderr
    wrong = f"*MATERIAL, NAMES={begin}A B{end}"
    assert name in one(warnings(tmp_path, [wrong], heated("20."), status=1), wrong)


@pytest.mark.parametrize(("character", "name", "plain"), [
    ("\u00a0", "U+00A0 (no-break space)", "a blank"), ("\u202f", "U+202F (narrow no-break space)", "a blank"),
    ("\u2212", "U+2212 (minus sign)", "a plain -"), ("\u2013", "U+2013 (en dash)", "a plain -"),
    ("\u2010", "U+2010 (hyphen)", "a plain -")])
def test_numbers_with_characters_that_look_like_others(tmp_path, character, name, plain):
    """Anywhere on the card; one message a card."""
    for card, position in ((f"LOW,{character}20.", 5), (f"LOW, 1.E{character}3", 9), (f"LOW{character}, 20.", 4)):
        cards = heated("20.")
        cards[cards.index("LOW, 100.")] = card
        deck = write(tmp_path / "deck.inp", cards)
        assert one(warnings(tmp_path, cards, status=1), card) == f"this character is {name}; type {plain}"
        assert f":{position}: error: this character" in run("check", deck).stderr


def test_other_characters_are_taken(tmp_path):
    """Letters of any language, degrees, and whatever stands in comments, titles and the origin of a value."""
    cards = heated("20.")
    cards = [card.replace("NAME=LOW", "NAME=Stößel_é").replace("MATERIAL=LOW", "MATERIAL=Stößel_é") for card in cards]
    text = ["*HEADING", "“Hot” – cold −5 °C", "** “comment” – −5", '*OPTIONS, UNITS="mm MPa W °C"']
    check = ["*VERIFY, KIND=ANALYTIC, SOURCE=\"Carslaw – Jaeger’s book\"", "NT, LOW.TOP, LAST, 20., 1.E-9"]
    assert warnings(tmp_path, text, cards, check) == []


@pytest.mark.parametrize(("gap", "film", "warned"), [
    (0.0, "HIGH.BOTTOM, F, 20., 1.", True), (0.01, "LOW, F3, 20., 1.", True), (-0.01, "HIGH.BOTTOM, F, 20., 1.", True),
    (0.2, "HIGH.BOTTOM, F, 20., 1.", False), (0.0, "HIGH, F3, 20., 1.", False)])
def test_films_on_faces_in_contact(tmp_path, gap, film, warned):
    """The upper block is over the right half of the lower one."""
    cards = blocks(shift=2.0, gap=gap, kinds=("CPE4", "CPE4"))
    step = ["*STEP", "*HEAT TRANSFER, STEADY STATE", "1., 1.", "*FILM", film, "*BOUNDARY", "LOW.BOTTOM, 11, 11, 0.",
            "*END STEP"]
    pair = [PAIR[0], "*GAP CONDUCTANCE", "1., 0.", *PAIR[1:]]
    found = [each for each in warnings(tmp_path, cards, pair, step) if "film" in each[0]]
    assert found == ([] if not warned else [(
        "the film acts on faces of contact pair F that touch the other surface; leave these faces out", film)])


@pytest.mark.parametrize("used", [True, False])
def test_surfaces_of_included_files_that_nothing_uses(tmp_path, used):
    """Their sets and materials may well be more than a deck needs."""
    body = [card for card in mesh("LOW", [0.0, 1.0], [0.0, 1.0]) if not card.startswith("*SURFACE")
            and not re.match(r"\d+, S\d", card)]
    write(tmp_path / "body.mesh", [*body, "*SURFACE, NAME=RIM", "1, S3", "*NSET, NSET=SPARE", "1",
                                   "*MATERIAL, NAME=SPARE", "*CONDUCTIVITY", "1."])
    load = ["*DSFLUX", "RIM, S, 1."] if used else ["*DFLUX", "1, S3, 1."]
    deck = write(tmp_path / "deck.inp", ["*INCLUDE, INPUT=body.mesh"], solid("LOW", 1.0, 0.3), [
        "*STEP", "*HEAT TRANSFER, STEADY STATE", "1., 1.", "*BOUNDARY", "LOW.BOTTOM, 11, 11, 0.", *load, "*END STEP"])
    process = run("check", "--quiet", deck)
    assert process.returncode == 0
    assert ("warning: nothing uses the surface RIM\n" in process.stderr) != used
    assert process.stderr.count("warning") == (not used)


def test_the_cut_of_a_pre_tension_section_touches_nothing(tmp_path):
    """A bolt is drawn over the flange that it goes through, and is cut where the face of the flange is."""
    cards = [*mesh("FLANGE", [-1.0, 0.0, 1.0, 2.0], [0.0, 1.0], "CPE4"), *solid("FLANGE", 2e5, 0.3),
             *mesh("BOLT", [0.0, 1.0], [0.5, 1.0, 2.0], "CPE4", first=101), *solid("BOLT", 2e5, 0.3),
             "*NODE", "9000, 0., 9.", "*SURFACE, NAME=CUT", "101, S3",
             "*PRE-TENSION SECTION, NODE=9000, SURFACE=CUT", "*STEP", "*STATIC", "*BOUNDARY",
             "FLANGE, 1, 2", "BOLT.TOP, 1, 2", "BOLT.BOTTOM, 1, 2", "*CLOAD", "9000, 1, 5.", "*END STEP"]
    assert "touch" not in str(warnings(tmp_path, cards))
