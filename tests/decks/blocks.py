"""Cards of rectangular blocks of eight-node elements, for small decks."""

from itertools import accumulate, pairwise


def block(name, xs, ys, first=1, skew=0.0):
    """Return the cards of a block with corner nodes at xs and ys; inner ones are moved by skew.

    Node set and element set have the block's name, the node sets of its sides end in .LEFT,
    .RIGHT, .BOTTOM and .TOP, and the surfaces of the last two have the same names.
    """
    corner, number, nodes, elements = {}, {}, {}, []
    for j, y in enumerate(ys):
        for i, x in enumerate(xs):
            inner = 0 < i < len(xs) - 1 and 0 < j < len(ys) - 1
            corner[i, j] = (x + skew, y - skew / 2) if inner else (x, y)

    def node(*ends):
        key = tuple(sorted(ends))
        if key not in number:
            number[key] = first + len(number)
            nodes[number[key]] = tuple(sum(corner[e][k] for e in ends) / len(ends) for k in (0, 1))
        return number[key]

    for j, _ in enumerate(pairwise(ys)):
        for i, _ in enumerate(pairwise(xs)):
            around = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            sides = [node(p, q) for p, q in pairwise([*around, around[0]])]
            elements.append([node(p) for p in around] + sides)
    cards = [f"*NODE, NSET={name}"] + [f"{n}, {x:.15g}, {y:.15g}" for n, (x, y) in nodes.items()]
    cards += [f"*ELEMENT, TYPE=CPE8, ELSET={name}"]
    cards += [", ".join(map(str, [first + k, *e])) for k, e in enumerate(elements)]
    for side, axis, value in (("LEFT", 0, xs[0]), ("RIGHT", 0, xs[-1]),
                              ("BOTTOM", 1, ys[0]), ("TOP", 1, ys[-1])):
        cards += [f"*NSET, NSET={name}.{side}"]
        cards += [str(n) for n, p in nodes.items() if p[axis] == value]
    columns, count = len(xs) - 1, len(elements)
    cards += [f"*SURFACE, NAME={name}.BOTTOM"] + [f"{first + k}, S1" for k in range(columns)]
    cards += [f"*SURFACE, NAME={name}.TOP"]
    return cards + [f"{first + k}, S3" for k in range(count - columns, count)]


def without_unused_surfaces(cards):
    """Return the cards without surfaces that no pair, tie, coupling, section or load names."""
    keywords = list(accumulate(cards, lambda last, card: card if card.startswith("*") else last))
    used = {field.strip().removeprefix("SURFACE=")
            for keyword, card in zip(keywords, cards, strict=True)
            if keyword.startswith(("*CONTACT PAIR", "*TIE", "*COUPLING", "*DSLOAD", "*DFLUX",
                                   "*PRE-TENSION", "*REFINE"))
            for field in card.split(",")}
    return [card for keyword, card in zip(keywords, cards, strict=True)
            if not keyword.startswith("*SURFACE, NAME=") or keyword.split("=")[1] in used]


def solid(name, young, poisson, expansion=0.0, conductivity=1.0):
    """Return the cards of a material and its section."""
    return [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{young!r}, {poisson!r}",
            "*EXPANSION", f"{expansion!r}", "*CONDUCTIVITY", f"{conductivity!r}",
            f"*SOLID SECTION, ELSET={name}, MATERIAL={name}"]


def write(path, *parts):
    """Write a deck of texts and lists of cards; return its path. Lines are not indented, but for
    data in fixed columns."""
    lines, fixed = [], False
    for part in parts:
        for line in part.strip().splitlines() if isinstance(part, str) else part:
            if line.lstrip().startswith("*"):
                fixed = "FORMAT=" in line
            lines.append(line if fixed else line.strip())
    path.write_text("\n".join(lines) + "\n")
    return path
