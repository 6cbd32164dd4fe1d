"""Laws of a surface interaction: two values of each field, of blocks under a known pressure."""

import pytest
from physics import follows, judge, material, mesh, nodes_of
from test_physics_schemes import step

import conduction

XS, HOT, K, PRESSURE = [0.0, 0.4, 1.0], 80.0, 2.0, 5.0
BLOCKS = [*mesh("UPPER", XS, [0.0, 0.5]), *mesh("LOWER", XS, [-1.0, 0.0], first=101)]


def pressed(*laws, gap=None):
    """Return two blocks pressed together, or apart by a clearance, with conductance laws."""
    deck = list(BLOCKS)
    for name in ("UPPER", "LOWER"):
        deck += material(name, (1000.0, 0.3), 0.0, K)
    deck += ["*SURFACE INTERACTION, NAME=FACES", *laws,
             "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "UPPER.BOTTOM, LOWER.TOP"]
    held = ["LOWER.BOTTOM, 2", "UPPER.LEFT, 1", "LOWER.LEFT, 1"]
    heated = [f"UPPER.TOP, 11, 11, {HOT!r}", "LOWER.BOTTOM, 11, 11, 0."]
    if gap is not None:
        deck += [f"*CLEARANCE, MASTER=LOWER.TOP, SLAVE=UPPER.BOTTOM, VALUE={gap!r}"]
        held += ["UPPER.TOP, 2"]
    load = ["*DLOAD", f"1, P3, {PRESSURE!r}", f"2, P3, {PRESSURE!r}"] if gap is None else []
    return [*deck, *step("coupled", "*BOUNDARY", *held, *heated, *load)]


def crossing(omega):
    """Return the checks of the heat through a conductance."""
    flux, _ = conduction.wall([0.5, 1.0], [K, K], HOT, 0.0, contacts=[omega])
    return [("conductance", "FACE", "LAST", omega, 1e-8), ("heat_flux", "FACE", "LAST", flux, 1e-8)]


@pytest.mark.changes("GAP CONDUCTANCE")
@pytest.mark.parametrize("other", [(0.6, 0.0, 1.5, 10.0), (0.5, 1.0, 1.5, 10.0),
                                   (0.5, 0.0, 1.7, 10.0), (0.5, 0.0, 1.5, 12.0)])
def test_every_field_of_a_table_of_pressure(tmp_path, other):
    def make(rows):
        low, start, high, end = rows
        omega = low + (high - low) * (PRESSURE - start) / (end - start)
        return pressed("*GAP CONDUCTANCE", f"{low!r}, {start!r}", f"{high!r}, {end!r}"), \
            crossing(omega)

    follows(tmp_path, make, (0.5, 0.0, 1.5, 10.0), other)


@pytest.mark.changes("CONTACT PAIR, PAIRING")
def test_the_pairing_gives_a_corner_its_part_of_the_face(tmp_path):
    """A sixth of the side by Simpson's rule, or the half of it by a hat; the flux is that of both."""
    def make(pairing):
        weight = {"NODES": XS[1] / 6, "SURFACES": XS[1] / 2}[pairing]
        deck = [card.replace("NAME=FACE", f"NAME=FACE, PAIRING={pairing}")
                if card.startswith("*CONTACT PAIR") else card
                for card in pressed("*GAP CONDUCTANCE", "1., 0.", "1., 10.")]
        return deck, [*crossing(1.0), ("weight", "FACE@0.", "LAST", weight, 1e-10)]

    follows(tmp_path, make, "NODES", "SURFACES")


@pytest.mark.changes("GAP CONDUCTANCE, PRESSURE", "GAP CONDUCTANCE, CLEARANCE")
def test_the_second_column_is_what_the_parameter_says(tmp_path):
    """Under the pressure 5: the mean of two rows, or the value at clearance 0."""
    def make(parameter):
        return pressed(f"*GAP CONDUCTANCE, {parameter}", "0.5, 0.", "1.5, 10.", "0., 20."), \
            crossing({"PRESSURE": 1.0, "CLEARANCE": 0.5}[parameter])

    follows(tmp_path, make, "PRESSURE", "CLEARANCE")


@pytest.mark.changes("GAP CONDUCTANCE")
@pytest.mark.parametrize("other", [(0.9, 0.0, 0.2, 0.4), (0.8, 0.05, 0.2, 0.4),
                                   (0.8, 0.0, 0.3, 0.4), (0.8, 0.0, 0.2, 0.5)])
def test_every_field_of_a_table_of_clearance(tmp_path, other):
    """The faces are 0.1 apart."""
    def make(rows):
        low, start, high, end = rows
        omega = low + (high - low) * (0.1 - start) / (end - start)
        return pressed("*GAP CONDUCTANCE, CLEARANCE", f"{low!r}, {start!r}", f"{high!r}, {end!r}",
                       gap=0.1), crossing(omega)

    follows(tmp_path, make, (0.8, 0.0, 0.2, 0.4), other)


@pytest.mark.parametrize(("last", "end"), [(0.2, 0.099), (0.0, 0.05)])
def test_no_heat_crosses_beyond_the_last_clearance(tmp_path, last, end):
    none = [("conductance", "FACE", "LAST", 0.0, 0.0), ("heat_flux", "FACE", "LAST", 0.0, 0.0)]
    table = ["0.8, 0.", f"{last!r}, {end!r}"]
    judge(tmp_path, pressed("*GAP CONDUCTANCE, CLEARANCE", *table, gap=0.1), none)
    held = crossing(last) if last else none
    judge(tmp_path, pressed("*GAP LAW, TYPE=CLEARANCE", *table, gap=0.1), held)


def test_tables_of_pressure_and_clearance_stand_in_one_interaction(tmp_path):
    laws = ["*GAP CONDUCTANCE, PRESSURE", "0.5, 0.", "1.5, 10.",
            "*GAP CONDUCTANCE, CLEARANCE", "0.5, 0.", "0., 0.4"]
    judge(tmp_path, pressed(*laws), crossing(1.0))
    judge(tmp_path, pressed(*laws, gap=0.1), crossing(0.375))


@pytest.mark.changes("GAP LAW")
@pytest.mark.parametrize("other", [(0.6, 0.1, 2.0), (0.5, 0.12, 2.0), (0.5, 0.1, 1.5)])
def test_every_field_of_a_power_law(tmp_path, other):
    def make(law):
        start, factor, exponent = law
        return pressed("*GAP LAW, TYPE=POWER", f"{start!r}, {factor!r}, {exponent!r}"), \
            crossing(start + factor * PRESSURE**exponent)

    follows(tmp_path, make, (0.5, 0.1, 2.0), other)


@pytest.mark.changes("GAP LAW, TYPE")
@pytest.mark.parametrize("gap", [0.05, 0.2])
def test_type_of_an_open_law(tmp_path, gap):
    """The same two numbers: A/(B + gap), or a table of one row."""
    def make(kind):
        return pressed(f"*GAP LAW, TYPE={kind}", "0.8, 0.1", gap=gap), crossing(
            0.8 / (0.1 + gap) if kind == "GAS" else 0.8)

    follows(tmp_path, make, "GAS", "CLEARANCE")


def test_an_open_law_holds_its_value_at_no_gap_under_pressure(tmp_path):
    judge(tmp_path, pressed("*GAP LAW, TYPE=GAS", "0.8, 0.1"), crossing(8.0))
    judge(tmp_path, pressed("*GAP LAW, TYPE=CLEARANCE", "0.8, 0.", "0.2, 0.3"), crossing(0.8))


@pytest.mark.changes("CONTACT PAIR")
def test_slave_and_master_of_a_pair(tmp_path):
    """Heat goes from the slave to the master: it is negative where the cold block is the slave."""
    flux, faces = conduction.wall([0.5, 1.0], [K, K], HOT, 0.0, contacts=[0.8])
    touching = [n for n, (_, y) in nodes_of(BLOCKS).items() if y == 0.0]
    lowest = {1: min(touching), -1: min(n for n in touching if n > 100)}

    def make(order):
        surfaces = ["UPPER.BOTTOM", "LOWER.TOP"][::order]
        deck = pressed("*GAP LAW, TYPE=POWER", "0.8, 0., 1.")
        deck[deck.index("UPPER.BOTTOM, LOWER.TOP")] = ", ".join(surfaces)
        slave, master = faces[1:3][::order]
        return deck, [("heat_flux", "FACE", "LAST", order * flux, 1e-8),
                      ("slave_temperature", "FACE", "LAST", slave, 1e-8),
                      ("master_temperature", "FACE", "LAST", master, 1e-8),
                      ("slave_node", "MIN", "LAST", lowest[order], 0.0, "ABS")]

    follows(tmp_path, make, 1, -1)
