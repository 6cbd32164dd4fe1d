"""What the size of the increments does to friction and to the schemes of (3.4)."""

import math
import re

import h5py
import numpy as np
import test_rods as rods
from blocks import write
from deck_runs import CYLINDER, HERTZ, copy_deck, run, solve
from report import Table, check_rows, verdict
from test_contact import faces, springs, step
from test_physics_schemes import ENDS, free, model, sets
from test_physics_schemes import step as heat_step

TITLE = "Time steps"
TEXT = """
Increments are a path of the load; the problem has no physical time. Where friction depends on the
path, errors fall with the second power of the increments; a path on which contact points keep
slipping or sticking in one direction has no error. On the cylinder, whose contact points close one
by one while they slide, convergence is uneven, and only slip, shear and the edge of stick depend on
the increments. The schemes of (3.4) lag behind the conductance with the order of theory; only
CRANK-NICOLSON keeps an initial imbalance, and the run warns of it.

Errors at the end of the loading; the order is that from 40 to 80 increments.
"""
IN_DOCUMENT = ["Schemes: error of the gap"]
COUNTS = [5, 10, 20, 40, 80]
ROUNDING = 1e-9


def row_of(name, errors, should):
    """Return a row with errors, order, what it should be (None: no error at all), and verdict."""
    found = None if max(errors) < ROUNDING else math.log2(errors[-2] / errors[-1])
    holds = found == should if None in (found, should) else abs(found - should) < 0.1
    return [name, *errors, "exact" if found is None else f"{found:.2f}",
            "exact" if should is None else str(should), verdict(holds)]


def head(first):
    """Return the heads of a table of errors."""
    return [first, *(f"{n} increments" for n in COUNTS), "order", "expected", "verdict"]


# One pair on springs, in closed form

FRICTION = 0.6
TURN = 1 / 3  # never an increment's end, and always a third of one away from it


def course(values):
    """Return the points of an amplitude: values at the ends of equal increments from 0 to 1."""
    count = len(values) - 1
    return ", ".join(f"{k / count!r}, {float(v)!r}" for k, v in enumerate(values)).split(", ")


def pair_place(folder, coupling, gap, press, push, count):
    """Return d_t at the end of courses of press and push of one pair, in equal increments."""
    times = np.arange(count + 1) / count
    cards = []
    for name, course_of in (("PRESS", press), ("PUSH", push)):
        points = course(course_of(times))
        cards += [f"*AMPLITUDE, NAME={name}"]
        cards += [", ".join(points[k:k + 8]) for k in range(0, len(points), 8)]
    deck = write(folder / f"pair{count}.inp", ["*OPTIONS, WIDTH=200"],
                 springs(coupling, gap), faces(FRICTION, "ABOVE", "BELOW"), cards,
                 step("*CLOAD, AMPLITUDE=PRESS", "1, 2, -1.", "*CLOAD, AMPLITUDE=PUSH", "1, 1, 1.",
                      increment=f"{1 / count!r}, 1.", analysis="*STATIC, DIRECT"))
    with h5py.File(solve(deck)) as file:
        assert len(file["history/time"]) == count
        displacement = file["VTKHDF/PointData/displacement"]
        return float(displacement[-file["VTKHDF/NumberOfPoints"][-1]][0])


def pairs(folder):
    """Return the table of paths of one pair that are known in closed form."""
    table = Table(
        "Friction: one contact point in closed form", head("path"),
        text="""One contact point on springs, friction 0.6: error of its position at the end. The events at a third of the load fall within an increment for any number of increments. A path on which the point keeps slipping, or sticking, in one direction has no error at all.""")
    speed = 2 * FRICTION * TURN
    nn, tt = 2.0, 1.0
    cases = []
    for coupling in 0.0, -0.8:
        # In slip d_t = (c_t - mu c_n)/(S_tt - mu S_nt), which is largest at c_t' = mu c_n'.
        stops = (speed * TURN - FRICTION * TURN**2) / (tt - FRICTION * coupling)
        cases.append((f"pressed like t^2, pushed like t; S_nt = {coupling}: slips until t = 1/3",
                      coupling, 0.0, lambda t: t**2, lambda t: speed * t, stops, 2))
    # Without coupling the gap closes where c_n = S_nn h; the pair sticks where it is then.
    cases.append(("gap closes at t = 1/3 on a curved path, sticks", 0.0, 0.5,
                  lambda t: nn * 0.5 * 9 * t**2, lambda t: 3 * t**3, 3 * TURN**3 / tt, 2))
    cases.append(("the same on a straight path", 0.0, 0.5,
                  lambda t: nn * 0.5 * 3 * t, lambda t: 0.3 * t, 0.3 * TURN / tt, None))
    cases.append(("pushed to a peak at t = 1/3 and back", 0.0, 0.0, lambda t: 0 * t + 1,
                  lambda t: 2 - (t - TURN) ** 2 * 2, (2 - FRICTION) / tt, 2))
    cases.append(("slips all the way", -0.8, 0.0, lambda t: t, lambda t: 2 * t,
                  (2 - FRICTION) / (tt - FRICTION * -0.8), None))
    for name, coupling, gap, press, push, exact, should in cases:
        errors = [abs(pair_place(folder, coupling, gap, press, push, count) / exact - 1)
                  for count in COUNTS]
        table.rows.append(row_of(name, errors, should))
    return table


# Interfaces where pairs close one after the other

def quiet(text, increment):
    """Return a deck's text with another first increment, fields of the last one, no checks and no
    estimates of errors."""
    text = text[: text.index("*VERIFY")] if "*VERIFY" in text else text
    text = re.sub(r"^\*STEP.*$", "*STEP, INC=100000", text, flags=re.M)
    text = re.sub(r"^[\d.]+, (1\.|900\.)$", rf"{increment}, \1", text, flags=re.M)
    text = re.sub(r"^\*CONTACT PRINT.*\n.*$", "", text, flags=re.M)
    text = "*OPTIONS, ERRORS=NO\n" + text
    return text.replace("*END STEP", "*NODE FILE, FREQUENCY=0\nU\n*CONTACT PRINT, FREQUENCY=0\n"
                        "CDIS\n*END STEP")


def at_the_end(deck, *names):
    """Return datasets of the interface at the last increment."""
    with h5py.File(solve(deck)) as file:
        return [file[f"contact/FACE/{name}"][-1] for name in names]


def hertz(folder, finest=320, frictions=(0.05, 0.3)):
    """Return the table of a mesh whose pairs close one after the other, without heat."""
    table = Table(
        "Friction: Hertz with friction", [*head("case")[:-3], "verdict"],
        text=f"""Different materials (input/hertz), against {finest} increments. Errors fall in steps: they come from increments in which
several contact points close, or one closes and slips. Where all closed points stick and one closes at a time, nothing depends on the
increments.""")
    names = "shear_force", "slip", "shear"
    for friction in frictions:
        found = {}
        for count in [*COUNTS, finest]:
            text = re.sub(r"(\*SURFACE INTERACTION.*)", rf"\1\n*FRICTION\n{friction}",
                          quiet(HERTZ.read_text(), f"{1 / count!r}"))
            (deck := folder / f"hertz{count}.inp").write_text(text)
            found[count] = at_the_end(deck, *names)
        for k, name in enumerate(names):
            scale = abs(found[finest][k]).max()
            if scale < 1e-12:  # nothing slips
                continue
            errors = [float(abs(found[count][k] - found[finest][k]).max() / scale)
                      for count in COUNTS]
            table.rows.append([f"friction {friction}: {name.replace('_', ' ')}", *errors,
                               verdict(errors[-1] < max(errors[0] / 8, ROUNDING))])
    return table


def cylinder(folder, counts=(5, 20, 80, 320, 1280), finest=2560):
    """Return the table of the published cylinder."""
    table = Table(
        "Friction: the cylinder", ["quantity at the end", *(f"{n} increments" for n in counts),
                                   "verdict"],
        text=f"""Its 21 contact points close one after the other while they slide. The reference has {finest} increments, the deck 45. Convergence is uneven: one contact point slips at a time, and each one that closes freezes
its slip, in which the error of the mesh exceeds that of the increments (docs/theory.md, section 6). Errors are relative; that of the edge is in local nodal spacings.""")
    names = "normal_force", "shear_force", "slip", "shear", "edge_stick", "s"
    found = {}
    for count in [*counts, finest]:
        (deck := folder / f"cylinder{count}.inp").write_text(
            quiet(CYLINDER.read_text(), f"{900 / count!r}"))
        found[count] = at_the_end(deck, *names[:-1])
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        s = file["contact/FACE/s"][()]
    edge = float(found[finest][4])
    scales = [abs(values).max() for values in found[finest][:4]]
    scales.append(np.diff(s)[np.searchsorted(s, edge) - 1])
    for k, name in enumerate(names[:-1]):
        errors = [float(abs(found[count][k] - found[finest][k]).max() / scales[k])
                  for count in counts]
        holds = max(errors[1:]) < 1.0 if name == "edge_stick" else errors[-1] < errors[0] / 4
        table.rows.append([name.replace("_", " "), *errors, verdict(holds)])
    return table


# Schemes of (3.4)

# Those of second order have a2 = b3: the residual that a change of G leaves is a2 dG dT then.
FREE = {"FREE, a2 = 0, b3 = 1/4": "FREE\n0.75, 0., 0.75, 0.25, 0., 0.25, 0.25, 0.75",
        "FREE, a2 = b3 = 1/10": "FREE\n0.75, 0.1, 0.65, 0.25, 0.15, 0.1, 0.25, 0.75"}
ORDERS = {"IMPLICIT": None, "GALERKIN": 2, "CRANK-NICOLSON": 2, "EXPLICIT": 1,
          "FREE, a2 = 0, b3 = 1/4": 1, "FREE, a2 = b3 = 1/10": 2}
FACTORS = {"IMPLICIT": 0.0, "GALERKIN": -1 / 2, "CRANK-NICOLSON": -1.0, "EXPLICIT": 0.0,
           "FREE, a2 = 0, b3 = 1/4": -1 / 3, "FREE, a2 = b3 = 1/10": -1 / 3}


def schemes(folder):
    """Return the tables of gap and flux of two rods that a ramp heats."""
    gap, flux = rods.open_rods(rods.MESHED_GAP)
    found = {}
    for scheme in ORDERS:
        for count in COUNTS:
            deck = rods.write_rods(folder / "rods.inp")
            copy_deck(deck, deck, [f"*THERMAL SCHEME, TYPE={FREE.get(scheme, scheme)}"],
                      {"0.1, 1.": f"{1 / count!r}, 1.", "ZAITSEV": "NEWTON"})
            result = solve(deck)
            found[scheme, count] = (abs(rods.last(result, "gap")[0] / gap - 1),
                                    abs(rods.last(result, "slave_temperature")[0]
                                        / (rods.HOT - flux * rods.LENGTH / rods.CONDUCTIVITY) - 1))
    tables = []
    for k, name in enumerate(("gap", "temperature of the slave")):
        table = Table(f"Schemes: error of the {name}", head("scheme"),
                      text="""Two rods that a ramp heats through a gas gap (closed form: tests/decks/test_rods.py), against the
quasi-static solution. A scheme with a3 = a1, b3 = 0 solves (3.3) itself. After a change of conductance dG in an increment the others leave
a residual a2 dG T_i+1 - b3 dG T_i. It is of second order where a2 = b3, else of first, and so is the error.""" * (k == 0))
        for scheme, should in ORDERS.items():
            errors = [float(found[scheme, count][k]) for count in COUNTS]
            table.rows.append(row_of(scheme, errors, should))
        tables.append(table)
    return tables


def imbalance(folder):
    """Return the table of what becomes of temperatures that start out of equilibrium."""
    increments = 6
    table = Table("Schemes: an initial imbalance", ["scheme", "factor -b1/a1",
                                                    *(f"left after {n}" for n in (1, 2, 3, 6)),
                                                    "warning", "verdict"],
                  text="""A uniform temperature at the start, and 0 prescribed at both ends: the part of it that remains. No scheme
makes it grow; the run warns if it never vanishes.""")
    for scheme, factor in FACTORS.items():
        deck = model(f"*THERMAL SCHEME, TYPE={FREE.get(scheme, scheme)}", *ENDS, *heat_step(
            "coupled", "*BOUNDARY", "UPPER.TOP, 11", "LOWER.BOTTOM, 11", "*NODE PRINT, NSET="
            + free("UPPER", "TOP"), "NT", times=f"{1 / increments!r}, 1."), start=10.0)
        at = deck.index("*STEP")
        path = write(folder / "start.inp", ["*OPTIONS, WIDTH=200"], deck[:at], sets(), deck[at:])
        process = run("run", "--quiet", path, "--out", folder)
        assert process.returncode == 0, process.stderr
        with h5py.File(path.with_suffix(".vtkhdf")) as file:
            left = file["contact/FACE/slave_temperature"][:, 0] / 10.0
        powers = factor ** np.arange(1, increments + 1)
        warned = "heat starts out of equilibrium" in process.stderr
        holds = abs(left - powers).max() < 1e-7 and warned == (abs(factor) >= 1)
        table.rows.append([scheme, float(factor), *(shown_part(left[n - 1]) for n in (1, 2, 3, 6)),
                           "yes" if warned else "no", verdict(holds)])
    return table


def shown_part(value):
    """Return a part as text, 0 where it is rounding."""
    return f"{value:.4f}" if math.fabs(value) > 1e-7 else "0"


def tables(folder):
    """Run the cases; return their tables."""
    return [pairs(folder), hertz(folder), cylinder(folder), *schemes(folder), imbalance(folder)]


def test_time_steps(tmp_path):
    """Hertz's contact and the cylinder in fewer increments than the document tells of."""
    check_rows([pairs(tmp_path), hertz(tmp_path, 160, (0.3,)),
                cylinder(tmp_path, (5, 20, 80), 320), *schemes(tmp_path),
                imbalance(tmp_path)])
