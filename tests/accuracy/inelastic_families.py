"""Families of decks that yield or creep, for judged_decks: seeds below 1000 may be looked at while
constants are chosen, those from 1000 on judge. True values of tubes and fits are those of
inelastic_rings, which has nothing of the program but the laws.
"""

from dataclasses import replace

import numpy as np
from drawn_decks import log_uniform
from inelastic_rings import Ring, Step, solution
from judged_families import FORMS, pressed, stacked
from judged_joint import BASE, Joint, JudgedDeck
from physics import material, mesh, nodes_of

KINDS = "8R", "8R", "8", "4", "4I"   # of elements in rings, which do not bend
FLOWS = "8R", "4", "4I"              # that follow all plastic flow
LONG = 0.5                           # plastic strain at which tables end
RADIUS = 100.0                       # of the bore of a tube, of the shaft of a fit
EXPANSION, CONDUCTIVITY = 1e-5, 0.05


def plasticity(draw, young, limit):
    """Return the cards of a drawn hardening, and what a ring has of it."""
    modulus = 0.0 if draw.uniform() < 0.5 else log_uniform(draw, 0.01, 0.1) * young
    moves = bool(modulus) and draw.uniform() < 0.5
    cards = [f"*PLASTIC, HARDENING={'KINEMATIC' if moves else 'ISOTROPIC'}", f"{limit:.12g}, 0."]
    cards += [f"{limit + LONG * modulus:.12g}, {LONG}"] if modulus else []
    return cards, {"yield_stress": limit, "hardening": modulus, "moves": moves}


class Rings:
    """A tube, or a hub on a shaft, between planes that do not move: cards, and steps of the
    independent solution."""

    def __init__(self, family, seed):
        self.family, self.seed = family, seed
        self.draw = draw = np.random.default_rng([seed, 500 + len(family)])
        self.kind, self.high = "CAX" + str(draw.choice(KINDS)), draw.uniform(2.0, 10.0)
        self.young, self.poisson = 1e5 * log_uniform(draw, 0.5, 3.0), draw.uniform(0.2, 0.45)
        self.limit, self.power = self.young * log_uniform(draw, 5e-4, 3e-3), draw.uniform(2.0, 6.0)
        self.outer = RADIUS * draw.uniform(1.3, 2.5)
        self.cards, self.loads, self.steps, self.heat = [], [], [], {}

    def body(self, name, inner, outer, first=1):
        """Add a ring; return the node at its outside."""
        corners = np.linspace(0, 1, int(self.draw.integers(4, 13)) + 1) ** self.draw.uniform(1, 1.4)
        xs = [float(x) for x in inner + (outer - inner) * corners]
        cards = mesh(name, xs, [0.0, self.high], self.kind, first)
        self.cards += cards
        return max((x, -y, n) for n, (x, y) in nodes_of(cards).items())[2]

    def warm(self):
        """Give materials to come what heat takes."""
        self.heat = {"expansion": EXPANSION, "conductivity": CONDUCTIVITY}

    def law(self, name, cards=()):
        """Add the material of a ring."""
        given = material(name, (self.young, self.poisson), **self.heat)
        self.cards += [*given[:3], *cards, *given[3:]]
        self.cards += ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"{name}, 0."] if self.heat else []

    def creep(self, stress, time):
        """Return the cards of creep that is some times the elastic strain of a stress in a time,
        and what a ring has of it."""
        strain = log_uniform(self.draw, 0.5, 10.0) * stress / self.young
        rate = strain / (stress**self.power * time)
        return (["*CREEP", f"{rate:.12g}, {self.power:.12g}"],
                {"rate": rate, "power": self.power})

    def step(self, analysis, *cards, **acts):
        """Add a step of both solutions."""
        count, allowed = int(self.draw.integers(3, 17)), log_uniform(self.draw, 1e-3, 2e-2)
        if time := acts.get("time"):
            analysis += f", LOCAL ERROR={allowed:.3g}"
            sizes = f"{1e-4 * time:.12g}, {time:.12g}, {1e-9 * time:.12g}"
        else:
            analysis += ", DIRECT"
            sizes = f"{1 / count:.12g}, 1."
        self.steps += ["*STEP, INC=100000", analysis, sizes, *cards, "*NODE FILE, FREQUENCY=0", "U",
                       "*END STEP"]
        self.loads.append(Step(**acts))

    def deck(self, rings, node, work, joint=(), heat=()):
        """Return the deck, of rings of the independent solution, the node whose displacement
        counts, and what *VERIFY calls the work of the law; joint and heat are true values of an
        interface."""
        named = {(f"body {k}", "von_mises"): (("mises", k), 1.0) for k in range(1, len(rings) + 1)}
        named |= {(f"node {node}", "displacement"): ("outside", 1.0),
                  ("model", "dissipated"): ("dissipated", self.high)} | dict(joint)

        def exact():
            found = solution(rings, self.loads)
            return {key: [tuple(factor * part for part in values[name]) for values in found]
                    for key, (name, factor) in named.items()} | dict(heat)

        return JudgedDeck(
            self.family, f"{self.family} {self.seed}", "\n".join(self.cards + self.steps) + "\n",
            ("FACE",) if joint else (), True,
            maxima=tuple((k, "von_mises", None) for k in range(1, len(rings) + 1)),
            checks=(("displacement", "U1", node), ("dissipated", work, 0)), exact=exact)


def tubes(seed):
    """Tubes: pressure up to 95 % of collapse, then less; heat that makes them yield, then less;
    creep under pressure."""
    tube, form = Rings("tubes", seed), ("pressure", "heat", "creep")[seed % 3]
    draw, thick = tube.draw, np.log(tube.outer / RADIUS)
    node, time = tube.body("TUBE", RADIUS, tube.outer), float(10 ** draw.integers(0, 5))
    if form == "creep":
        pressure = tube.limit * thick * draw.uniform(0.3, 0.9)
        bore = np.sqrt(3) * pressure / (1 - (RADIUS / tube.outer) ** 2) / 2
        cards, ring = tube.creep(bore, time)
    else:
        cards, ring = plasticity(draw, tube.young, tube.limit)
        pressure = draw.uniform(0.5, 0.95) * 2 / np.sqrt(3) * tube.limit * thick
    if form == "heat":
        tube.warm()
        ring["expansion"] = EXPANSION
    tube.law("TUBE", cards)
    tube.cards += ["*BOUNDARY", "TUBE, 2"]
    parts = 1.0, draw.uniform(0.0, 0.5)
    rise = draw.uniform(1.0, 2.0) * tube.limit / (tube.young * EXPANSION) * draw.choice([-1, 1])
    for part in parts if form != "creep" else parts[:1]:
        if form == "heat":
            tube.step("*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "*BOUNDARY",
                      f"TUBE.LEFT, 11, 11, {part * rise:.12g}", "TUBE.RIGHT, 11, 11, 0.",
                      temperatures=(part * rise, 0.0, 0.0, 0.0))
        else:
            tube.step("*STATIC", "*DSLOAD", f"TUBE.LEFT, P, {part * pressure:.12g}",
                      pressure=part * pressure)
    if form == "creep":
        tube.step("*VISCO", pressure=pressure, time=time)
    return tube.deck([Ring(RADIUS, tube.outer, tube.young, tube.poisson, **ring)], node,
                     "ALLCD" if form == "creep" else "ALLPD")


def fits(seed):
    """Press fits: a hub that yields as it is pressed on; the same on a bored shaft, then heated or
    cooled; one that creeps."""
    fit, form = Rings("fits", seed), ("cold", "heat", "creep")[seed % 3]
    draw, bore = fit.draw, 0.0
    if form == "heat":
        bore = RADIUS * draw.uniform(0.2, 0.6)
        fit.warm()
    fit.body("SHAFT", bore, RADIUS)
    node = fit.body("HUB", RADIUS, fit.outer, BASE)
    overlap = fit.limit / fit.young * RADIUS * draw.uniform(1.0, 3.0) * (2.0 if bore else 1.0)
    time = float(10 ** draw.integers(0, 5))
    if form == "creep":
        cards, ring = fit.creep(0.5 * fit.young * overlap / RADIUS, time)
    else:
        cards, ring = plasticity(draw, fit.young, fit.limit)
    fit.law("SHAFT")
    fit.law("HUB", cards)
    conductance = log_uniform(draw, 0.3, 10.0) * CONDUCTIVITY / RADIUS
    law = ["*GAP LAW, TYPE=POWER", f"{conductance:.12g}, 0., 1."] if bore else []
    pair, pairing = "SHAFT.RIGHT, HUB.LEFT", ("NODES", "SURFACES")[seed // 3 % 2]
    fit.cards += ["*SURFACE INTERACTION, NAME=JOINT", *law,
                  f"*CONTACT PAIR, INTERACTION=JOINT, NAME=FACE, PAIRING={pairing}", pair,
                  f"*CLEARANCE, SLAVE=SHAFT.RIGHT, MASTER=HUB.LEFT, VALUE={-overlap:.12g}",
                  "*BOUNDARY", "SHAFT, 2", "HUB, 2", *([] if bore else ["SHAFT.LEFT, 1"])]
    ramp = [] if form == "creep" else ["*CONTACT INTERFERENCE", f"{pair}, {overlap:.12g}"]
    fit.step("*STATIC", *ramp, overlap=overlap)
    around, heat, own = 2 * np.pi * fit.high, {}, {}
    if form == "heat":
        # Cooled less than opens the joint of what has yielded
        rise = (1.0 if draw.uniform() < 0.5 else -0.4) * draw.uniform(0.3, 1.0) * fit.limit / (
            fit.young * EXPANSION)
        parts = np.array([np.log(RADIUS / bore) / CONDUCTIVITY, 1 / (conductance * RADIUS),
                          np.log(fit.outer / RADIUS) / CONDUCTIVITY])
        drops, own = rise * parts / parts.sum(), {"expansion": EXPANSION}
        heat = {("FACE", "heat_rate"): [(0.0, 0.0), (around * rise / parts.sum(), 0.0)]}
        fit.step("*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "*BOUNDARY",
                 f"SHAFT.LEFT, 11, 11, {rise:.12g}", "HUB.RIGHT, 11, 11, 0.", overlap=overlap,
                 temperatures=(rise, rise - drops[0], drops[2], 0.0))
    elif form == "creep":
        fit.step("*VISCO", overlap=overlap, time=time)
    rings = [Ring(bore, RADIUS, fit.young, fit.poisson, **own),
             Ring(RADIUS, fit.outer, fit.young, fit.poisson, **own, **ring)]
    joint = {("FACE", "normal_force"): ("joint", around * RADIUS),
             ("FACE", "peak_pressure"): ("joint", 1.0)}
    return fit.deck(rings, node, "ALLCD" if form == "creep" else "ALLPD", joint, heat)


def punches(seed):
    """A block that yields under a rigid roller, a rigid punch with round edges or an elastic body
    with a round face, which may yield, too; with friction or without."""
    form = FORMS[seed % 3]
    kind = str(np.random.default_rng([seed, 501]).choice(FLOWS))
    is_mesh, is_mortar = form == "mesh", seed // 3 % 2
    more = {"pairing": "SURFACES", "part": 0.8 if is_mesh else 1.0} if is_mortar else {}
    joint = Joint("punches", seed, is_mesh and seed % 2 == 1, (kind, kind),
                  most=7 if kind == "8R" else 12, **more)
    joint.young[:] = joint.young.mean()
    joint.counts = [min(count, 6) for count in joint.counts]   # finer meshes take their time
    limit = float(joint.draw.uniform(0.2, 0.6) * joint.young[1] * joint.down / 3)
    joint.laws["LOW"] = plasticity(joint.draw, joint.young[1], limit)[0]
    if joint.draw.uniform() < 0.3:
        joint.laws["UP"] = joint.laws["LOW"]
    deck = stacked(joint) if is_mesh else pressed(joint, form)
    return replace(deck, text=deck.text.replace(", DIRECT", ""), has_path=True,
                   checks=(("dissipated", "ALLPD", 0), ("work", "ALLWK", 0)))


FAMILIES = {make.__name__: make for make in (tubes, fits, punches)}
