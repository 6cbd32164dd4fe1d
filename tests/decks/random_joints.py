"""Random stacks of blocks that contact alone may hold, loaded on nodes that constraints relate, and
their referee."""

import sys

import h5py
import numpy as np
from blocks import without_unused_surfaces, write
from deck_runs import DECKS, run
from physics import material, mesh, nodes_of
from scipy.linalg import null_space

sys.path.insert(0, str(DECKS.parent / "reference"))
from equilibrium import Bodies  # noqa: E402

WIDTH, HEIGHT = 10.0, 4.0
EXPANSION = 1e-5


class Stack:
    """A random deck with what its referee has to know: rows that vanish, forces, contacts."""

    def __init__(self, seed):
        self.random = np.random.default_rng(seed)
        pick = self.random.choice
        self.kind = str(pick(["CPE8", "CPS8", "CPS4", "CAX8"], p=[0.4, 0.2, 0.2, 0.2]))
        self.axial = self.kind == "CAX8"
        self.left = float(pick([0.0, 2.0])) if self.axial else 0.0
        self.friction = float(pick([0.0, 0.4]))
        self.places, self.elements = {}, []
        self.rows, self.forces, self.contacts = [], [], []   # sums, loads, interfaces
        self.cards, self.model, self.step = [], [], []
        self.middle = self.left + WIDTH / 2

    # Cards and what they mean

    def node(self, number, x, y, name):
        self.places[number] = x, y
        self.model += [f"*NODE, NSET={name}", f"{number}, {x!r}, {y!r}"]

    def hold(self, number, component, value=0.0):
        self.step += ["*BOUNDARY", f"{number}, {component + 1}, {component + 1}, {value!r}"]
        self.rows.append(([(number, component, 1.0)], value))

    def load(self, number, component, force):
        self.step += ["*CLOAD", f"{number}, {component + 1}, {force!r}"]
        self.forces.append((number, component, force))

    def equation(self, *terms):
        self.model += ["*EQUATION", str(len(terms))]
        self.model += [", ".join(f"{n}, {c + 1}, {value!r}" for n, c, value in terms)]
        self.rows.append((list(terms), 0.0))

    # Bodies

    def build(self):
        count = int(self.random.integers(2, 5))
        columns = int(self.random.integers(1, 4))
        self.faces = []
        ties = self.random.random(count) < 0.3
        ties[1] = False
        for k in range(count):
            tied = k > 0 and ties[k]
            if k > 0 and not tied and self.random.random() < 0.4:
                columns = columns % 3 + 1
            self.block(k, columns)
            if k > 0:
                self.tie(k) if tied else self.join(k)
        self.support()
        self.brackets(ties)
        self.heat = str(self.random.choice(["none", "given", "conducted"]))
        if self.heat == "given":
            self.warm()
        elif self.heat == "conducted":
            self.conduct()
        return self

    def block(self, k, columns):
        rows = int(self.random.integers(1, 3))
        xs = [self.left + WIDTH * i / columns for i in range(columns + 1)]
        ys = [HEIGHT * (k + j / rows) for j in range(rows + 1)]
        name, first = f"B{k}", 1000 * (k + 1)
        cards = mesh(name, xs, ys, self.kind, first)
        elastic = float(self.random.choice([1e3, 1e5, 2e5])), float(self.random.choice([0.0, 0.3]))
        self.cards += [*cards, *material(name, elastic, EXPANSION, 10.0)]
        places = nodes_of(cards)
        self.places.update(places)
        inside = False
        for card in cards:
            if card.startswith("*"):
                inside = card.startswith("*ELEMENT")
            elif inside:
                self.elements.append((self.kind, [int(f) for f in card.split(",")[1:]],
                                      (*elastic, EXPANSION)))
        if self.axial and self.left == 0.0:
            self.rows += [([(n, 0, 1.0)], 0.0) for n, p in places.items() if p[0] == 0.0]
        self.faces.append({side: sorted((n for n, p in places.items() if p[1] == value),
                                        key=lambda n: places[n])
                           for side, value in (("BOTTOM", ys[0]), ("TOP", ys[-1]))})

    def tie(self, k):
        self.model += [f"*TIE, NAME=T{k}", f"B{k}.BOTTOM, B{k - 1}.TOP"]
        for one, other in zip(self.faces[k]["BOTTOM"], self.faces[k - 1]["TOP"], strict=True):
            self.rows += [([(one, c, 1.0), (other, c, -1.0)], 0.0) for c in (0, 1)]

    def join(self, k):
        slave, master = self.faces[k]["BOTTOM"], self.faces[k - 1]["TOP"]
        matched = len(slave) == len(master) and self.random.random() < 0.6
        self.model += [f"*SURFACE INTERACTION, NAME=I{k}"]
        self.model += ["*GAP LAW, TYPE=POWER", "1., 0.01, 1.", "*GAP LAW, TYPE=GAS", "1., 1."]
        if self.friction:
            self.model += ["*FRICTION", repr(self.friction)]
        pairing = "NODES" if matched else "SURFACES"
        self.model += [f"*CONTACT PAIR, INTERACTION=I{k}, NAME=J{k}, PAIRING={pairing}",
                       f"B{k}.BOTTOM, B{k - 1}.TOP"]
        gap = float(self.random.choice([0.0, -2e-3, 1e-3], p=[0.6, 0.2, 0.2]))
        if gap:
            self.model += [f"*CLEARANCE, SLAVE=B{k}.BOTTOM, MASTER=B{k - 1}.TOP, VALUE={gap!r}"]
        self.contacts.append((f"J{k}", matched, slave, master, gap))

    def support(self):
        bottom = self.faces[0]["BOTTOM"]
        if self.random.random() < 0.3 and not self.axial:
            self.node(900, self.middle + 1.0, -3.0, "BASE")
            self.couple(900, 901, "B0.BOTTOM", (0, 1), bottom)
            self.step += ["*BOUNDARY", "BASE, ENCASTRE"]
            self.rows += [([(900, 0, 1.0)], 0.0), ([(900, 1, 1.0)], 0.0), ([(901, 0, 1.0)], 0.0)]
            return
        if self.random.random() < 0.2 and not self.axial:
            self.turn("SKEW", bottom, 0.3)
        self.step += ["*BOUNDARY", "B0.BOTTOM, 1, 2"]
        self.rows += [([(n, c, 1.0)], 0.0) for n in bottom for c in (0, 1)]

    def turn(self, name, nodes, angle):
        """Give nodes axes of their own; return what turns components along x and y to these."""
        cos, sin = float(np.cos(angle)), float(np.sin(angle))
        self.model += [f"*NSET, NSET={name}", *map(str, nodes), f"*TRANSFORM, NSET={name}, TYPE=R",
                       f"{cos!r}, {sin!r}, 0., {-sin!r}, {cos!r}, 0."]
        return np.array([[cos, sin], [-sin, cos]])

    def couple(self, reference, rotation, surface, components, nodes):
        """Couple a face to a node; its rotation is written as a node of its own for the referee."""
        self.model += [f"*COUPLING, REF NODE={reference}, SURFACE={surface}, "
                       f"CONSTRAINT NAME=C{reference}", "*KINEMATIC",
                       ", ".join(str(c + 1) for c in components)]
        x, y = self.places[reference]
        self.places[rotation] = x, y
        for n in nodes:
            arm = self.places[n][0] - x, self.places[n][1] - y
            for c in components:
                self.rows.append(([(n, c, 1.0), (reference, c, -1.0),
                                   (rotation, 0, (arm[1], -arm[0])[c])], 0.0))

    # What loads and holds the blocks above the first

    def brackets(self, ties):
        """Load the topmost block; hold along x what no friction holds; relate nodes below."""
        count = len(self.faces)
        clusters = [[0]]
        for k in range(1, count):
            clusters[-1].append(k) if ties[k] else clusters.append([k])
        sideways = not self.axial and bool(self.friction)
        holds = not self.axial and self.random.random() < (0.2 if self.friction else 0.5)
        self.pressed = force = float(self.random.uniform(100.0, 1000.0))
        side = float(self.random.uniform(-0.1, 0.1)) * force * self.friction
        self.way = str(self.random.choice(["coupled", "followed", "turned", "mean", "lever"]))
        getattr(self, self.way)(self.faces[-1]["TOP"], force, 0.0 if holds else side, holds)
        for cluster in clusters[1:] if not (sideways or self.axial) else []:
            if not (holds and count - 1 in cluster):
                self.hold(self.faces[cluster[0]]["BOTTOM"][0], 0)
        if sideways and len(clusters) > 2 and self.random.random() < 0.3:
            self.spread(clusters[1][0], clusters[2][0], 0.05 * self.pressed * self.friction)
        if self.random.random() < 0.3:
            self.straighten(clusters[1][0])

    def coupled(self, top, force, side, holds):
        """A reference node that is pushed, turned, held in part, or moved."""
        offset = 0.0 if self.axial else float(self.random.uniform(-0.5, 0.5))
        x, y = self.middle + offset, self.places[top[0]][1] + 1.0
        self.node(800, x, y, "REF")
        self.couple(800, 801, f"B{len(self.faces) - 1}.TOP", (1,) if self.axial else (0, 1), top)
        if self.random.random() < 0.2:
            self.hold(800, 1, -1e-3 * float(self.random.uniform(1.0, 5.0)))
            self.pressed = force = side = 0.0   # what friction carries is not known before
        else:
            self.load(800, 1, -force)
        if self.axial:
            return
        if holds:
            self.hold(800, 0, float(self.random.choice([0.0, 1e-4])))
        else:
            self.load(800, 0, side)
        if self.random.random() < 0.4:
            self.step += ["*BOUNDARY", "800, 6, 6"]
            self.rows.append(([(801, 0, 1.0)], 0.0))
        else:
            moment = 0.3 * force * float(self.random.uniform(-1.0, 1.0))
            self.step += ["*CLOAD", f"800, 6, {moment!r}"]
            self.forces.append((801, 0, moment))

    def followed(self, top, force, side, holds):
        """A node of no element that the whole face follows along y, and a corner along x."""
        self.node(810, self.middle, self.places[top[0]][1] + 2.0, "FOLLOWED")
        for n in top:
            self.equation((n, 1, 1.0), (810, 1, -1.0))
        self.load(810, 1, -force)
        if self.axial:
            return
        self.equation((top[0], 0, 1.0), (810, 0, -1.0))
        if holds:
            self.hold(810, 0)
        else:
            self.load(810, 0, side)

    def turned(self, top, force, side, holds):
        """Forces along axes of their own; along x and y they come to `side` and `force`."""
        angle = 0.0 if self.axial else float(self.random.uniform(-0.5, 0.5))
        axes = self.turn("TURNED", (top[0], top[-1]), angle)
        push = np.array([side, -force]) / 2
        for n in (top[0], top[-1]):
            local = axes @ push
            self.step += ["*CLOAD", *(f"{n}, {c + 1}, {float(local[c])!r}" for c in (0, 1))]
            self.forces += [(n, c, float(push[c])) for c in (0, 1)]
        if holds:
            self.hold(self.faces[-1]["BOTTOM"][0], 0)

    def mean(self, top, force, side, holds):
        """A node of no element that moves by the mean of the face."""
        self.node(820, self.middle, self.places[top[0]][1] + 2.0, "MEAN")
        self.equation(*[(n, 1, 1.0) for n in top], (820, 1, -float(len(top))))
        self.load(820, 1, -force)
        self.push_aside(top, side, holds)

    def lever(self, top, force, side, holds):
        """Two nodes of no element, one behind the other, with a lever between."""
        self.node(830, self.middle, self.places[top[0]][1] + 2.0, "NEAR")
        self.node(831, self.middle, self.places[top[0]][1] + 3.0, "FAR")
        self.equation((831, 1, 1.0), (830, 1, -2.0))
        self.equation((830, 1, 2.0), (top[0], 1, -1.0), (top[-1], 1, -1.0))
        self.load(831, 1, -force / 2)
        self.push_aside(top, side, holds)

    def push_aside(self, top, side, holds):
        if holds:
            self.hold(top[0], 0)
        elif not self.axial:
            self.load(top[-1], 0, side)

    def spread(self, one, other, force):
        """A force on a node of no element that presses two blocks apart."""
        self.node(840, self.left - 1.0, 0.0, "APART")
        self.equation((self.faces[one]["BOTTOM"][0], 0, 1.0),
                      (self.faces[other]["BOTTOM"][-1], 0, -1.0), (840, 0, -1.0))
        self.load(840, 0, force)

    def straighten(self, k):
        """Three nodes of a block's face stay on a line, as they do where it moves as a rigid one."""
        face = self.faces[k]["TOP"]
        if len(face) >= 3 and (k < len(self.faces) - 1 or self.way in ("mean", "lever")):
            self.equation((face[0], 1, 1.0), (face[1], 1, -2.0), (face[2], 1, 1.0))

    def warm(self):
        slope = self.random.uniform(-3.0, 3.0, 2)
        meshed = {n for _, nodes, _ in self.elements for n in nodes}
        self.step += ["*TEMPERATURE", *(f"{n}, {float(20.0 + slope @ self.places[n])!r}"
                                        for n in sorted(meshed))]

    def conduct(self):
        """Heat from the top to the bottom, through contacts that conduct by their pressure."""
        hot = float(self.random.uniform(-50.0, 50.0))
        self.step += ["*BOUNDARY", "B0.BOTTOM, 11, 11, 0.",
                      f"B{len(self.faces) - 1}.TOP, 11, 11, {hot!r}"]

    def deck(self, path):
        steps = float(self.random.choice([0.25, 1.0]))
        everything = ", ".join(f"B{k}" for k in range(len(self.faces)))
        start = ["*NSET, NSET=EVERYTHING", everything,
                 "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "EVERYTHING, 0."]
        analysis = ("*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE" if self.heat == "conducted"
                    else "*STATIC")
        cards = [*self.cards, *self.model, *start, "*STEP", analysis, f"{steps}, 1.", *self.step,
                 "*END STEP"]
        return write(path, ["*OPTIONS, WIDTH=300"], without_unused_surfaces(cards))


def nodal(file, name):
    """Return a quantity of the nodes at the end; nothing where the file has none."""
    if f"VTKHDF/PointData/{name}" not in file:
        return {}
    last = file[f"VTKHDF/Steps/PointDataOffsets/{name}"][-1]
    nodes = file["VTKHDF/PointData/node_id"][()]
    found = file[f"VTKHDF/PointData/{name}"][last : last + len(nodes)]
    return {int(n): value for n, value in zip(nodes, found, strict=True)}


def judge(stack, result):
    """Return the largest faults of a result: constraints, equilibrium, contact, sums."""
    placed = stack.places
    with h5py.File(result) as file:
        known, rises = nodal(file, "displacement"), nodal(file, "temperature")
        contacts = {name: {key: file[f"contact/{name}"][key][-1] for key in
                           ("status", "normal_force", "shear_force")}
                    for name, *_ in stack.contacts}
    bodies = Bodies(placed, stack.elements, rises or dict.fromkeys(placed, 0.0))
    size = len(bodies.dof)
    rows = np.array([bodies.row(terms) for terms, _ in stack.rows])
    values = np.array([value for _, value in stack.rows])
    u = np.zeros(size)
    lone = np.ones(size, dtype=bool)
    for (n, c), i in bodies.dof.items():
        if n in known:
            u[i], lone[i] = known[n][c], False
    if lone.any():
        u[lone] = np.linalg.lstsq(rows[:, lone], values - rows @ u, rcond=None)[0]
    length = np.abs(u).max() + 1e-300
    faults = {"constraints": np.abs(rows @ u - values).max() / length}

    forces = np.zeros(size)
    for n, c, value in stack.forces:
        forces[bodies.dof[n, c]] += value
    scale = np.abs(bodies.stiffness @ u - bodies.thermal).max()
    labels, carriers = [], []
    for name, matched, slave, master, initial in stack.contacts:
        states = contacts[name]["status"]
        if matched:
            for k, (s, m) in enumerate(zip(slave, master, strict=True)):
                # On the axis a node of a three-node side has no tributary area and may stay open.
                gap = initial + u[bodies.dof[s, 1]] - u[bodies.dof[m, 1]]
                closed = states[k] and not (stack.axial and placed[s][0] == 0.0)
                faults["gap"] = max(faults.get("gap", 0.0), -gap / length,
                                    abs(gap) / length if closed else 0.0)
                if not states[k]:
                    continue
                labels.append((name, k, 1))
                carriers.append(bodies.row([(s, 1, 1.0), (m, 1, -1.0)]))
                if stack.friction:
                    labels.append((name, k, 0))
                    carriers.append(bodies.row([(s, 0, 1.0), (m, 0, -1.0)]))
        elif states.any():
            faces = [(n, c) for n in (*slave, *master)
                     for c in ((0, 1) if stack.friction else (1,))]
            sums = [[c == d for _, c in faces] for d in ((0, 1) if stack.friction else (1,))]
            if not stack.axial:
                sums.append([placed[n][0] if c else 0.0 for n, c in faces])
            for share in null_space(np.array(sums, dtype=float)).T:
                labels.append((name, None, None))
                carriers.append(bodies.row([(n, c, v) for (n, c), v in
                                            zip(faces, share, strict=True)]))
    left, multipliers, unique = bodies.uncarried(
        u, forces, np.array([*rows, *carriers]) if carriers else rows)
    faults["equilibrium"] = np.abs(left).max() / scale
    if unique:
        faults |= contact_faults(stack, bodies, contacts, labels,
                                 multipliers[len(rows):], carriers, scale)
    return faults, unique


def contact_faults(stack, bodies, contacts, labels, multipliers, carriers, scale):
    """Pull, friction beyond the cone, and sums that differ from the program's."""
    faults = {"pull": 0.0, "cone": 0.0, "normal": 0.0, "shear": 0.0}
    for name, matched, slave, *_ in stack.contacts:
        own = {label[1:]: value for label, value in zip(labels, multipliers, strict=True)
               if label[0] == name}
        if matched:
            normal = sum(v for (_, c), v in own.items() if c == 1)
            shear = sum(v for (_, c), v in own.items() if c == 0)
            for (k, c), value in own.items():
                if c == 1:
                    faults["pull"] = max(faults["pull"], -value / scale)
                    tangent = abs(own.get((k, 0), 0.0)) - stack.friction * value
                    faults["cone"] = max(faults["cone"], tangent / scale)
        else:
            total = sum((row * value for label, row, value in
                         zip(labels, carriers, multipliers, strict=True) if label[0] == name),
                        np.zeros(len(bodies.dof)))
            normal = sum(total[bodies.dof[n, 1]] for n in slave)
            shear = sum(total[bodies.dof[n, 0]] for n in slave)
        faults["normal"] = max(faults["normal"],
                               abs(normal - contacts[name]["normal_force"]) / scale)
        # The shear counts on the slave along the tangent in which s grows: x.
        faults["shear"] = max(faults["shear"],
                              abs(shear - contacts[name]["shear_force"]) / scale)
    return faults


def trial(seed, folder):
    """Solve the deck of a seed; return it, the finished process, its faults, and whether the
    forces of its contacts are unique."""
    stack = Stack(seed).build()
    deck = stack.deck(folder / f"random{seed}.inp")
    process = run("run", "--quiet", deck, "--out", folder)
    faults = judge(stack, deck.with_suffix(".vtkhdf")) if process.returncode == 0 else ({}, False)
    return stack, process, *faults
