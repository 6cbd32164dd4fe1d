"""A deck of two blocks that store heat, in many forms.

The upper block is pressed on the lower one, and films warm its top and cool the bottom of the other
one from time 0 on. Both are held across, so that all fields follow y whatever the meshes. The
closed law follows the pressure, which expansion changes: heat and contact are coupled.
"""

import h5py
import numpy as np
from blocks import write
from physics import material, mesh

START, HOT, COLD, ZERO = 10.0, 60.0, 0.0, -20.0
HOT_FILM, COLD_FILM = 5.0, 3.0
PROPERTIES = {
    "UPPER": {"elastic": (1000.0, 0.3), "expansion": 2e-4, "conductivity": 2.0, "density": 1.5,
              "specific_heat": 0.8},
    "LOWER": {"elastic": (2000.0, 0.2), "expansion": 1e-4, "conductivity": 1.0, "density": 1.0,
              "specific_heat": 2.0}}
CAPACITY = {name: body["density"] * body["specific_heat"] for name, body in PROPERTIES.items()}
XS, HIGH, LOW = [0.0, 0.4, 1.0], [0.0, 0.2, 0.5, 1.0], [-1.0, -0.5, -0.2, 0.0]
PRESSED = -0.01
LAWS = ["*GAP LAW, TYPE=GAS", "2.E-3, 5.E-3", "*GAP LAW, TYPE=POWER", "0.4, 0.5, 1."]
COUPLED = "*COUPLED TEMPERATURE-DISPLACEMENT"
FIRST, PERIOD = 0.05, 0.5
TIE = ["*TIE, NAME=GLUE", "UPPER.BOTTOM, MIDDLE.TOP"]
# What one coordinate decides: the same at all contact points, and of both blocks.
OF_POINTS = ("gap", "pressure", "heat_flux", "conductance", "slave_temperature",
             "master_temperature")
OF_BODIES = "heat_in", "heat_out", "heat_stored", "heat_dilatation"


def bodies(kind="CPE8", upper=(XS, HIGH), lower=(XS, LOW), middle=None, held=None, apart=1000,
           zero=ZERO):
    """Return the cards of both blocks, corners at xs and ys, and of what is held; a middle one is
    the lower part of the upper one, and another card joins it. Numbers of nodes and elements of
    the parts are apart."""
    parts = {"UPPER": upper, "LOWER": lower} | ({"MIDDLE": middle} if middle else {})
    cards = [f"*PHYSICAL CONSTANTS, ABSOLUTE ZERO={zero!r}"]
    starts = ["*INITIAL CONDITIONS, TYPE=TEMPERATURE"]
    for k, (name, (xs, ys)) in enumerate(parts.items()):
        like = PROPERTIES["LOWER" if name == "LOWER" else "UPPER"]
        cards += [*mesh(name, xs, ys, kind, first=1 + apart * k), *material(name, **like)]
        starts += [f"{name}, {START!r}"]
    held = held or ["LOWER.BOTTOM, 2", *(f"{name}, 1" for name in parts)]
    return [*cards, *starts, "*BOUNDARY", *held]


def contact(slave="UPPER.BOTTOM", pairing="NODES", laws=LAWS):
    """Return the cards of the interface."""
    return ["*SURFACE INTERACTION, NAME=FACES", *laws,
            f"*CONTACT PAIR, INTERACTION=FACES, NAME=FACE, PAIRING={pairing}",
            f"{slave}, LOWER.TOP"]


def heated(*cards, times=f"{FIRST!r}, {PERIOD!r}", how=", DIRECT",
           pressed=("*BOUNDARY", f"UPPER.TOP, 2, 2, {PRESSED!r}")):
    """Return the step."""
    return ["*STEP, INC=1000000", COUPLED + how, times, *pressed,
            "*SFILM", f"UPPER.TOP, F, {HOT!r}, {HOT_FILM!r}",
            f"LOWER.BOTTOM, F, {COLD!r}, {COLD_FILM!r}", *cards, "*END STEP"]


def write_deck(path, *parts):
    """Write a deck of these lists of cards; return its path."""
    return write(path, [card for part in parts for card in part])


def two_blocks(path, *cards, **of_step):
    """Write the deck of two blocks whose nodes match, with more cards; return its path."""
    return write_deck(path, bodies(), contact(), ["*FIXED POINT, TOL=1.E-12"], cards,
                      heated(**of_step))


def history(result, *names):
    """Return datasets of the history."""
    with h5py.File(result) as file:
        return [file[f"history/{name}"][()] for name in names]


def course(result):
    """Return what one coordinate decides, over time; it is the same along the faces."""
    with h5py.File(result) as file:
        points = {name: file[f"contact/FACE/{name}"][()] for name in OF_POINTS}
        found = {name: file[f"history/{name}"][()] for name in ("time", *OF_BODIES)
                 if name in file["history"]}
    for name, values in points.items():
        scale = np.abs(values).max()
        np.testing.assert_allclose(np.ptp(values, axis=1), 0.0, atol=1e-9 * scale, err_msg=name)
        found[name] = values[:, 0]
    return found


def assert_same_course(one, other, tolerance=1e-9):
    """Assert that two courses agree to a part of the largest value of each quantity."""
    for name, values in one.items():
        np.testing.assert_allclose(other[name], values, rtol=0.0, err_msg=name,
                                   atol=tolerance * np.abs(values).max())


def content(result):
    """Return times and the heat above the start that the blocks hold, the integral of the written
    temperatures; it takes rectangles with nodes at corners and at the middles of sides."""
    with h5py.File(result) as file:
        grid = file["VTKHDF"]
        times, places = grid["Steps/Values"][()], grid["Points"][()]
        cells = np.array(np.split(grid["Connectivity"][()], grid["Offsets"][1:-1]))
        rise = grid["PointData/temperature"][()].reshape(len(times), -1) - START
    corners = places[cells[:, :4]]
    area = np.ptp(corners[:, :, 0], axis=1) * np.ptp(corners[:, :, 1], axis=1)
    of_cell = area * np.where(corners[:, :, 1].mean(axis=1) > 0, CAPACITY["UPPER"],
                              CAPACITY["LOWER"])
    shares = np.array([-1 / 12] * 4 + [1 / 3] * 4)
    return times, rise[:, cells] @ shares @ of_cell
