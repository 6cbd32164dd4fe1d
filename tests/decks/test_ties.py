"""Tied faces: blocks whose nodes do not match are as one, in tension, shear, bending and conduction.

Blocks of every element type are tied along a line; what is expected is the uniform state of one
block, beam theory, Lame's ring, or CalculiX's *TIE.
"""

import h5py
import numpy as np
import pytest
from blocks import solid, write
from calculix import calculix
from changes import note_changes
from deck_runs import run, solve

KINDS = "CPE8", "CPE8R", "CPE4", "CPE6", "CPE3"
SIDES = {"BOTTOM": (1, 0), "RIGHT": (0, -1), "TOP": (1, -1), "LEFT": (0, 0)}


def patch(name, xs, ys, first, kind="CPE8", place=lambda x, y: (x, y)):
    """Return the cards of a block with corners at xs and ys; sets of nodes and surfaces of its
    sides are called NAME.BOTTOM and so on; place moves it."""
    quadratic, triangles = kind[3] in "68", kind[3] in "36"
    half = [np.interp(np.arange(2 * len(v) - 1) / 2, np.arange(len(v)), v) for v in (xs, ys)]
    number, elements, faces = {}, [], {side: [] for side in SIDES}

    def node(i, j):
        return number.setdefault((i, j), first + len(number))

    def element(*corners):
        points = list(corners)
        ring = [*corners, corners[0]]
        if quadratic:
            points += [((a + c) // 2, (b + d) // 2)
                       for (a, b), (c, d) in zip(ring, ring[1:], strict=False)]
        elements.append([first + len(elements), *(node(*p) for p in points)])
        for face, ends in enumerate(zip(ring, ring[1:], strict=False), 1):
            for side, (axis, end) in SIDES.items():
                at = range(len(half[axis]))[end]
                if all(p[axis] == at for p in ends):
                    faces[side].append(f"{elements[-1][0]}, S{face}")

    for j in range(0, len(half[1]) - 1, 2):
        for i in range(0, len(half[0]) - 1, 2):
            a, b, c, d = (i, j), (i + 2, j), (i + 2, j + 2), (i, j + 2)
            if triangles:
                element(a, b, c)
                element(a, c, d)
            else:
                element(a, b, c, d)
    cards = [f"*NODE, NSET={name}"]
    cards += ["{}, {:.16g}, {:.16g}".format(n, *place(half[0][i], half[1][j]))
              for (i, j), n in number.items()]
    cards += [f"*ELEMENT, TYPE={kind}, ELSET={name}"]
    cards += [", ".join(map(str, e)) for e in elements]
    for side, (axis, end) in SIDES.items():
        at = range(len(half[axis]))[end]
        cards += [f"*NSET, NSET={name}.{side}"]
        cards += [str(n) for p, n in number.items() if p[axis] == at]
        cards += [f"*SURFACE, NAME={name}.{side}", *faces[side]]
    return cards


def parts(count, low=0.0, high=1.0):
    """Return the corners of equal parts, the inner ones a little aside."""
    x = np.linspace(low, high, count + 1)
    x[1:-1] += 0.07 * (high - low) / count * np.sin(np.arange(1, count))
    return list(x)


def used(cards):
    """Return the cards without the surfaces that no *TIE, *CONTACT PAIR or surface load names."""
    text = [c for card in cards for c in (card.strip().splitlines() if isinstance(card, str)
                                          else card)]
    keyword, names = "", set()
    for card in text:
        keyword = card.strip() if card.strip().startswith("*") else keyword
        if keyword.startswith(("*TIE", "*CONTACT PAIR", "*DSLOAD", "*DFLUX")):
            names |= {field.strip() for field in card.split(",")}
    kept, keep = [], True
    for card in text:
        if card.strip().startswith("*"):
            keep = not card.startswith("*SURFACE, NAME=") or card.split("=")[1] in names
        kept += [card] if keep else []
    return kept


def last(result, name):
    """Return node numbers, coordinates and a nodal field at the last increment."""
    with h5py.File(result) as file:
        data = file["VTKHDF"]
        number = data["PointData/node_id"][()]
        count = len(set(number))
        return (number[-count:], data["Points"][()][-count:, :2],
                data[f"PointData/{name}"][()][-count:])


def turned(angle):
    c, s = np.cos(angle), np.sin(angle)
    return lambda x, y: (c * x - s * y, s * x + c * y)


STRAIN = {"along": ((1e-3, 0.0), (0.0, 0.0)), "across": ((0.0, 0.0), (0.0, -2e-3)),
          "shear": ((0.0, 1.5e-3), (0.5e-3, 0.0))}


def uniform(folder, kind, counts, state, angle=0.0, cards=(), ends=(0, 1)):
    """Solve two tied blocks whose outer sides move as a uniform strain and temperature gradient
    ask; ends says of which blocks the ends of the tied faces do, too. Return the result."""
    gradient = np.array(STRAIN[state])
    place = turned(angle)
    mesh = [patch("LOWER", parts(counts[0]), [-0.5, -0.2, 0.0], 1, kind, place),
            patch("UPPER", parts(counts[1]), [0.0, 0.3, 0.6], 5001, kind, place)]
    boundary = []
    for card in [c for block in mesh for c in block[1:block.index(next(
            k for k in block if k.startswith("*ELEMENT")))]]:
        n, x, y = card.split(", ")
        p = np.array([float(x), float(y)])
        q = turned(-angle)(*p)
        if min(abs(q[1] + 0.5), abs(q[1] - 0.6), abs(q[0]), abs(q[0] - 1)) > 1e-9:
            continue
        if abs(q[1]) < 1e-9 and (not 0 < q[0] + 1e-9 < 1e-6 and not abs(q[0] - 1) < 1e-9
                                 or int(n) // 5000 not in ends):
            continue
        u = gradient @ p
        boundary += [f"{n}, 1, 1, {u[0]:.15g}", f"{n}, 2, 2, {u[1]:.15g}",
                     f"{n}, 11, 11, {50 + 20 * p[0] - 30 * p[1]:.15g}"]
    deck = write(folder / "uniform.inp", used([
        *mesh, solid("LOWER", 1e4, 0.3), solid("UPPER", 1e4, 0.3),
        "*TIE, NAME=GLUE\nUPPER.BOTTOM, LOWER.TOP", *cards,
        "*STEP\n*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE\n1., 1.\n*BOUNDARY",
        boundary, "*END STEP"]))
    result = solve(deck)
    _, x, u = last(result, "displacement")
    assert np.allclose(u[:, :2], x @ gradient.T, rtol=0, atol=1e-9 * 2e-3), \
        abs(u[:, :2] - x @ gradient.T).max()
    _, _, t = last(result, "temperature")
    assert np.allclose(t, 50 + x @ [20, -30], rtol=1e-9)
    return result


@pytest.mark.parametrize("ends", [(0, 1), (0,), (1,)], ids=["both", "master", "slave"])
@pytest.mark.parametrize("counts", [(3, 7), (7, 3)], ids=["fine-slave", "coarse-slave"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_uniform_state_crosses_a_tie(tmp_path, kind, counts, ends):
    """An inclined face; a gradient of temperature along and across it. Where only one of two nodes
    at the end of the faces is prescribed, the tie carries its reaction over."""
    uniform(tmp_path, kind, counts, "shear", 0.3, ends=ends)
