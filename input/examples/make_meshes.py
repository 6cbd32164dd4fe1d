#!/usr/bin/env python3
"""Write the meshes that the examples include, beside this file: NAME.mesh for NAME.inp.

A mesh is made of blocks of eight-node elements. A block's node set and element set have its name; its sides are the
node sets NAME.LEFT, NAME.RIGHT, NAME.BOTTOM and NAME.TOP. Those that the deck pairs or loads are surfaces, too.
"""
from itertools import pairwise
from pathlib import Path

FACES = {"BOTTOM": 1, "RIGHT": 2, "TOP": 3, "LEFT": 4}


def spaced(start, end, count, ratio=1.0):
    """Ends of `count` intervals from start to end, the last `ratio` times as long as the first."""
    growth = ratio ** (1 / (count - 1)) if count > 1 else 1.0
    lengths = [growth**k for k in range(count)]
    return [start + (end - start) * sum(lengths[:k]) / sum(lengths) for k in range(count + 1)]


def numbers(values, width=12):
    """Data cards with whole numbers, `width` a card."""
    return [", ".join(map(str, values[i:i + width])) for i in range(0, len(values), width)]


def block(name, xs, ys, first, kind, faces, cut=None):
    """Cards of a block with corner nodes at xs and ys; nodes and elements are numbered from `first`. The sides
    `faces`, such as "TOP RIGHT", are surfaces. `cut=(y, tip)` parts the block along y from its left side to x = tip;
    the faces are the surfaces NAME.LOWER and NAME.UPPER."""
    number, points, elements, where = {}, {}, [], {}

    def node(x, y, above):
        key = round(x, 9), round(y, 9), bool(cut) and above and key_on_cut(x, y)
        if key not in number:
            number[key] = first + len(number)
            points[number[key]] = x, y
        return number[key]

    def key_on_cut(x, y):
        return abs(y - cut[0]) < 1e-9 and x < cut[1] - 1e-9

    for low, high in pairwise(ys):
        for left, right in pairwise(xs):
            corners = [(left, low), (right, low), (right, high), (left, high)]
            middles = [((p[0] + q[0]) / 2, (p[1] + q[1]) / 2) for p, q in pairwise([*corners, corners[0]])]
            above = bool(cut) and low >= cut[0] - 1e-9
            where[first + len(elements)] = left, right, low, high
            elements.append([node(*p, above) for p in corners + middles])
    cards = [f"*NODE, NSET={name}"] + [f"{n}, {x:.10g}, {y:.10g}" for n, (x, y) in points.items()]
    cards += [f"*ELEMENT, TYPE={kind}, ELSET={name}"]
    cards += [", ".join(map(str, [first + k, *e])) for k, e in enumerate(elements)]
    for side, axis, value, place in (("LEFT", 0, xs[0], 0), ("RIGHT", 0, xs[-1], 1),
                                     ("BOTTOM", 1, ys[0], 2), ("TOP", 1, ys[-1], 3)):
        cards += [f"*NSET, NSET={name}.{side}"] + numbers([n for n, p in points.items() if p[axis] == value])
        if side in faces:
            cards += surface(f"{name}.{side}", [n for n, box in where.items() if box[place] == value], FACES[side])
    if cut:
        at_cut = {n: box for n, box in where.items() if box[1] <= cut[1] + 1e-9}
        cards += surface(f"{name}.LOWER", [n for n, box in at_cut.items() if box[3] == cut[0]], 3)
        cards += surface(f"{name}.UPPER", [n for n, box in at_cut.items() if box[2] == cut[0]], 1)
    return cards


def surface(name, elements, face):
    """Cards of a surface of one face of some elements."""
    return [f"*SURFACE, NAME={name}"] + [f"{n}, S{face}" for n in elements]


def part(name, xs, ys, first, start, end):
    """Cards of the surface `name` on the top row of a block, between x = start and end."""
    row = first + (len(xs) - 1) * (len(ys) - 2)
    chosen = [row + k for k, (a, b) in enumerate(pairwise(xs)) if a >= start - 1e-9 and b <= end + 1e-9]
    return surface(name, chosen, FACES["TOP"])


def side_part(name, xs, ys, first, start, end):
    """Cards of the surface `name` on the left column of a block, between y = start and end."""
    chosen = [first + k * (len(xs) - 1) for k, (a, b) in enumerate(pairwise(ys)) if a >= start - 1e-9 and b <= end + 1e-9]
    return surface(name, chosen, FACES["LEFT"])


def press_fit():
    """Two rings, 20 to 40 and 40 to 60, 10 high."""
    heights = spaced(0.0, 10.0, 2)
    return block("HUB", spaced(20.0, 40.0, 8, 1.5), heights, 1, "CAX8", "RIGHT") + block(
        "RIM", spaced(40.0, 60.0, 8, 1.3), heights, 1001, "CAX8", "LEFT")


def fuel_pellet():
    """Three pellets, radius 4.1 and height 10, in a tube of radii 4.12 and 4.70."""
    cards, radii, height = [], spaced(0.0, 4.1, 6, 0.4), 10.0
    for k in range(3):
        rows = [height * k + v for v in [0.0, 0.7, 2.0, 3.5, 5.0, 6.5, 8.0, 9.3, 10.0]]
        name, first = f"PELLET{k + 1}", 1000 * k + 1
        cards += block(name, radii, rows, first, "CAX8", "RIGHT TOP BOTTOM" if k else "RIGHT TOP")
    rows = sorted({height * k + v for k in range(3) for v in [0.0, 0.7, 2.0, 3.5, 5.0, 6.5, 8.0, 9.3, 10.0]})
    wall = spaced(4.12, 4.70, 2)
    cards += block("TUBE", wall, rows, 4001, "CAX8", "")
    for k in range(3):
        cards += side_part(f"BORE{k + 1}", wall, rows, 4001, height * k, height * (k + 1))
    return cards


def brake_pad():
    """A pad 40 wide and 12 high, on a disc 80 wide and 10 high."""
    across = spaced(-20.0, 20.0, 16)
    disc_xs = spaced(-40.0, -20.0, 4)[:-1] + across + spaced(20.0, 40.0, 4)[1:]
    disc_ys = spaced(-10.0, 0.0, 4, 0.5)
    cards = block("PAD", across, spaced(0.0, 12.0, 5, 2.0), 1, "CPE8", "BOTTOM TOP")
    cards += block("DISC", disc_xs, disc_ys, 1001, "CPE8", "")
    return cards + part("TRACK", disc_xs, disc_ys, 1001, -20.0, 20.0)


def cracked_plate():
    """Half of a plate 80 wide and 160 high, with a crack of half-length 10 across its middle."""
    xs = spaced(0.0, 10.0, 8, 0.2) + spaced(10.0, 40.0, 9, 8.0)[1:]
    half = spaced(0.0, 80.0, 11, 30.0)
    ys = [-y for y in reversed(half)] + half[1:]
    return block("PLATE", xs, ys, 1, "CPS8", "TOP", cut=(0.0, 10.0))


def turbine_joint():
    """A blade's foot 20 wide, a shim and a disc of equal width, one on the other."""
    xs = spaced(0.0, 20.0, 10)
    return (block("FOOT", xs, spaced(2.0, 14.0, 6, 3.0), 1, "CPE8", "BOTTOM TOP")
            + block("SHIM", xs, spaced(0.0, 2.0, 2), 1001, "CPE8", "BOTTOM TOP")
            + block("DISC", xs, spaced(-15.0, 0.0, 6, 1 / 3), 2001, "CPE8", "TOP"))


def thermal_cycling():
    """A strip 40 long and 1 high on a base of equal length and 4 high."""
    xs = spaced(0.0, 40.0, 40)
    return block("STRIP", xs, [0.0, 1.0], 1, "CPS8", "BOTTOM TOP") + block(
        "BASE", xs, spaced(-4.0, 0.0, 2, 0.5), 1001, "CPS8", "TOP")


def warm_blocks():
    """Two blocks 20 long and 8 high, 0.036 apart."""
    heights = spaced(0.0, 8.0, 2)
    return block("HOT", spaced(-20.0, 0.0, 14, 20.0), heights, 1, "CPE8", "RIGHT") + block(
        "COLD", spaced(0.036, 20.036, 10), heights, 1001, "CPE8", "LEFT")


def shrink_shock():
    """A shaft of radius 20 and a hub of radii 20 and 40, the upper half of a joint 40 high."""
    heights = spaced(0.0, 20.0, 10, 0.4)
    return block("SHAFT", spaced(0.0, 20.0, 8, 0.4), heights, 1, "CAX8", "RIGHT") + block(
        "HUB", spaced(20.0, 40.0, 10, 0.4), heights, 1001, "CAX8", "LEFT RIGHT")


def brake_disc():
    """Half of a disc of radii 60 and 130, 6 thick, and a lining of radii 80 and 120, 10 thick."""
    across = spaced(80.0, 120.0, 16)
    disc_xs = spaced(60.0, 80.0, 6, 0.5)[:-1] + across + spaced(120.0, 130.0, 4, 1.5)[1:]
    disc_ys = spaced(-6.0, 0.0, 8, 0.2)
    cards = block("LINING", across, spaced(0.0, 10.0, 12, 30.0), 1, "CAX8", "BOTTOM TOP")
    cards += block("DISC", disc_xs, disc_ys, 1001, "CAX8", "")
    return cards + part("TRACK", disc_xs, disc_ys, 1001, 80.0, 120.0)


def bolted_flange():
    """The lower half of a bolt M20, of a flange of radii 11 and 40, 30 thick, and of a gasket 2 thick."""
    under = spaced(0.0, 10.0, 5)
    seat, ring = spaced(11.0, 16.0, 5), spaced(16.0, 30.0, 8)
    head_xs, head_ys = [*under, *seat], spaced(-44.0, -31.0, 6, 0.5)
    flange_xs, flange_ys = [*seat, *ring[1:], *spaced(30.0, 40.0, 4)[1:]], spaced(-31.0, -1.0, 14)
    cards = block("SHANK", under, spaced(-31.0, 0.0, 14, 1.5), 1, "CAX8", "BOTTOM")
    cards += block("HEAD", head_xs, head_ys, 1001, "CAX8", "BOTTOM")
    cards += part("SEAT", head_xs, head_ys, 1001, 11.0, 16.0) + part("NECK", head_xs, head_ys, 1001, 0.0, 10.0)
    cards += block("FLANGE", flange_xs, flange_ys, 2001, "CAX8", "RIGHT")
    cards += surface("FACE", [2001 + k for k in range(5)], FACES["BOTTOM"])
    cards += part("WET", flange_xs, flange_ys, 2001, 11.0, 16.0) + part(
        "LAND", flange_xs, flange_ys, 2001, 16.0, 30.0)
    cards += block("GASKET", ring, [-1.0, -0.5, 0.0], 4001, "CAX8", "BOTTOM")
    return cards + surface("CUT", [1 + 5 * 7 + k for k in range(5)], FACES["TOP"])


def rail_pad():
    """A pad 20 wide and 2 thick on a rail 80 long and 40 deep."""
    rail_ys = spaced(-40.0, 0.0, 10, 1 / 16)
    cards = block("RAIL", spaced(-20.0, 60.0, 32), rail_ys, 1, "CPE8", "TOP")
    return cards + block("PAD", spaced(-10.0, 10.0, 8), [0.0, 0.5, 2.0], 5001, "CPE8", "BOTTOM TOP")


def pin_in_hole():
    """A hub of radii 10 and 14, 40 high."""
    return block("HUB", spaced(10.0, 14.0, 4), spaced(-40.0, 0.0, 40), 1, "CAX8", "LEFT")


def valve_stem():
    """A stem of radius 4, 40 long, in a bush of radii 4 and 8, 8 long."""
    cards = block("STEM", spaced(0.0, 4.0, 3, 0.5), spaced(-20.0, 20.0, 25), 1, "CAX8", "RIGHT")
    return cards + block("BUSH", spaced(3.998, 8.0, 3, 2.0), spaced(-4.0, 4.0, 5), 5001, "CAX8", "LEFT")


def main():
    makers = (press_fit, fuel_pellet, brake_pad, cracked_plate, turbine_joint, thermal_cycling, warm_blocks,
              shrink_shock, brake_disc, bolted_flange, rail_pad, pin_in_hole, valve_stem)
    for make in makers:
        cards = [f"** Written by make_meshes.py. {make.__doc__}", *make()]
        assert max(map(len, cards[1:])) <= 80
        (Path(__file__).parent / f"{make.__name__}.mesh").write_text("\n".join(cards) + "\n")


if __name__ == "__main__":
    main()
