#!/usr/bin/env python3
"""Independent solution of the published cylinder (Zaitsev, 1987), to check thercon against: numpy and scipy only.

It takes the mesh and the material constants from the deck and shares nothing else with the program. Where thercon keeps
the bodies' stiffness on the contact nodes and iterates by eq. (4.2), this solver takes their flexibility (bodies that
their supports hold) and Newton's method on log(omega), the statuses of the pairs held within a step. Element matrices,
refinement, contact geometry and zone edges are written anew from their definitions.

Per pair: gap g >= 0, pressure p >= 0, shear t (on the slave, towards growing s), relative tangential displacement l,
conductance w, heat flux q = w (T_slave - T_master). Nodal force or heat is traction or flux times the pair's weight.

    cylinder_reference.py [--deck DECK] [--levels N] [--step DT]      prints a table at 180, 360, 540, 720 and 900 C
"""
import argparse
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

FRICTION, GAS_A, GAS_B, CLOSED_0, CLOSED_1 = 0.155, 0.24e-5, 0.3e-5, 0.8, 0.24
OPEN, STICK = 0, 2                    # status; +1 and -1: slip with shear of that sign
GAUSS = [(-0.6**0.5, 5 / 9), (0.0, 8 / 9), (0.6**0.5, 5 / 9)]
CORNERS = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
SIDES = [(0, -1), (1, 0), (0, 1), (-1, 0)]
DECK = Path(__file__).resolve().parents[2] / "input" / "cylinder" / "cylinder.inp"


# The deck, shape functions and refinement

def read_deck(path):
    """Bodies of a deck in its order (coordinates, elements, contact face as ordered nodes, material)."""
    blocks = []
    for line in Path(path).read_text().splitlines():
        fields = [field.strip() for field in line.split(",")]
        if line.startswith("*") and not line.startswith("**"):
            blocks.append((fields[0].upper(), []))
        elif not line.startswith("**"):
            blocks[-1][1].append(fields)
    nodes = {int(r[0]): tuple(map(float, r[1:3])) for key, rows in blocks if key == "*NODE" for r in rows}
    elements = [{int(r[0]): [int(n) for n in r[1:]] for r in rows} for key, rows in blocks if key == "*ELEMENT"]
    faces = [[(int(r[0]), int(r[1][1:]) - 1) for r in rows] for key, rows in blocks if key == "*SURFACE"]
    keys = ("*ELASTIC", "*EXPANSION", "*CONDUCTIVITY")
    constants = {key: [[float(v) for v in rows[0]] for name, rows in blocks if name == key] for key in keys}
    bodies = []
    for k, own in enumerate(elements):
        numbers = sorted({n for e in own.values() for n in e})
        index = {n: i for i, n in enumerate(numbers)}
        face = {own[e][place] for e, side in faces[k] for place in (side, (side + 1) % 4, side + 4)}
        (young, poisson), (expansion,), (conductivity,) = (constants[key][k] for key in keys)
        material = SimpleNamespace(young=young, poisson=poisson, expansion=expansion, conductivity=conductivity)
        bodies.append(SimpleNamespace(xy=np.array([nodes[n] for n in numbers]), material=material,
                                      elements=[[index[n] for n in e] for e in own.values()],
                                      face=[index[n] for n in sorted(face, key=lambda n: nodes[n][0])]))
    return bodies


def shape(a, b):
    """The eight shape functions and their derivatives (2, 8) by a and b."""
    value, slope = [], []
    for p, q in CORNERS:
        value.append((1 + a * p) * (1 + b * q) * (a * p + b * q - 1) / 4)
        slope.append((p * (1 + b * q) * (2 * a * p + b * q) / 4, q * (1 + a * p) * (2 * b * q + a * p) / 4))
    for p, q in SIDES:
        value.append((1 - a * a) * (1 + b * q) / 2 if p == 0 else (1 + a * p) * (1 - b * b) / 2)
        slope.append((-a * (1 + b * q), (1 - a * a) * q / 2) if p == 0 else ((1 - b * b) * p / 2, -b * (1 + a * p)))
    return np.array(value), np.array(slope).T


def refine(body):
    """Each element becomes four; new nodes lie at the quarter points of the parametric element."""
    xy, number, elements = list(body.xy), {}, []

    def node(element, a, b, key):
        if key not in number:
            number[key] = len(xy)
            xy.append(shape(a, b)[0] @ body.xy[element])
        return number[key]

    for element in body.elements:
        centre = node(element, 0, 0, ("centre", *element))
        ring = [element[0], element[4], element[1], element[5], element[2], element[6], element[3], element[7]]
        place = [p for pair in zip(CORNERS, SIDES) for p in pair]
        outer = [node(element, *np.add(place[k], place[k - 7]) / 2, tuple(sorted((ring[k], ring[k - 7]))))
                 for k in range(8)]
        inner = [node(element, *np.multiply(SIDES[k], 0.5), (*element, k)) for k in range(4)]
        for k in range(4):
            corners = [ring[2 * k], ring[2 * k + 1], centre, ring[2 * k - 1]]
            elements.append(corners + [outer[2 * k], inner[k], inner[k - 1], outer[2 * k - 1]])
    face = [body.face[0]]
    for first, second in zip(body.face, body.face[1:]):
        face += [number[tuple(sorted((first, second)))], second]
    return SimpleNamespace(xy=np.array(xy), elements=elements, face=face, material=body.material)


# One body: what its contact nodes do under unit nodal forces, unit nodal heat and unit temperature of its end

def respond(body, end, hot):
    """Flexibility of the contact nodes (x and y of each): u = load u_load + heating Q + flexibility F, and
    T = load t_load + resistance Q, with `load` the temperature of the end section y = end when it is `hot`, else 0."""
    xy, elements, m = body.xy, np.array(body.elements), body.material
    count, nodes = len(elements), len(xy)
    factor = m.young / ((1 + m.poisson) * (1 - 2 * m.poisson))
    elasticity = factor * np.array([[1 - m.poisson, m.poisson, 0], [m.poisson, 1 - m.poisson, 0],
                                    [0, 0, 0.5 - m.poisson]])
    thermal_stress = m.young * m.expansion / (1 - 2 * m.poisson) * np.array([1, 1, 0])
    conduction, stiffness = np.zeros((count, 8, 8)), np.zeros((count, 16, 16))
    coupling, strain = np.zeros((count, 16, 8)), np.zeros((count, 3, 16))
    for a, weight_a in GAUSS:
        for b, weight_b in GAUSS:
            value, slope = shape(a, b)
            jacobian = slope @ xy[elements]
            area = weight_a * weight_b * np.linalg.det(jacobian)
            slope = np.linalg.solve(jacobian, np.broadcast_to(slope, (count, 2, 8)))
            strain[:, 0, 0::2] = strain[:, 2, 1::2] = slope[:, 0]
            strain[:, 1, 1::2] = strain[:, 2, 0::2] = slope[:, 1]
            turned = strain.transpose(0, 2, 1) * area[:, None, None]
            conduction += m.conductivity * (slope.transpose(0, 2, 1) * area[:, None, None]) @ slope
            stiffness += turned @ elasticity @ strain
            coupling += (turned @ thermal_stress)[:, :, None] * value
    freedoms = np.stack([2 * elements, 2 * elements + 1], axis=2).reshape(count, 16)

    def assemble(blocks, rows, columns, size):
        where = np.broadcast_arrays(rows[:, :, None], columns[:, None, :])
        return csc_matrix((blocks.ravel(), (where[0].ravel(), where[1].ravel())), shape=size)

    conduction = assemble(conduction, elements, elements, (nodes, nodes))
    stiffness = assemble(stiffness, freedoms, freedoms, (2 * nodes, 2 * nodes))
    coupling = assemble(coupling, freedoms, elements, (2 * nodes, nodes))
    at_end = np.abs(xy[:, 1] - end) < 1e-9
    held = np.stack([np.abs(xy[:, 0]) < 1e-9, at_end], axis=1).ravel()

    def solve(matrix, fixed, right):
        free, result = np.flatnonzero(~fixed), np.zeros(right.shape)
        result[free] = splu(matrix[free][:, free]).solve(np.ascontiguousarray(right[free]))
        return result

    unit_heat = np.zeros((nodes, len(body.face)))
    unit_heat[body.face, range(len(body.face))] = 1
    by_load = at_end * float(hot)
    by_load = by_load + solve(conduction, at_end, -(conduction @ by_load))
    by_heat = solve(conduction, at_end, unit_heat)
    contact = (2 * np.array(body.face)[:, None] + [0, 1]).ravel()
    unit_force = np.zeros((2 * nodes, len(contact)))
    unit_force[contact, range(len(contact))] = 1
    reach = solve(stiffness, held, unit_force)
    return SimpleNamespace(flexibility=reach[contact], heating=reach.T @ (coupling @ by_heat),
                           u_load=reach.T @ (coupling @ by_load),
                           resistance=by_heat[body.face], t_load=by_load[body.face])


# The pairs

def side_functions(t):
    """Shape functions of a three-node side and their derivatives."""
    return np.array([t * (t - 1) / 2, 1 - t * t, t * (t + 1) / 2]), np.array([t - 0.5, -2 * t, t + 0.5])


def pair_geometry(slave, master):
    """Arc length s, weight, common normal and tangent of the pairs, from the undeformed faces (m, 2)."""
    m = len(slave)
    s, weight, along = np.zeros(m), np.zeros(m), np.zeros((2, m, 2))
    for first in range(0, m - 2, 2):
        side = slice(first, first + 3)
        for k, (t, part) in enumerate([(-0.5, 0), (0.5, 1)]):
            s[first + 1 + k] = s[first + k] + sum(
                g * np.linalg.norm(side_functions(t + a / 2)[1] @ slave[side]) / 2 for a, g in GAUSS)
        for a, g in GAUSS:
            value, slope = side_functions(a)
            weight[side] += g * value * np.linalg.norm(slope @ (slave + master)[side] / 2)
        for face, place in enumerate((slave, master)):
            for k in range(3):
                slope = side_functions(k - 1)[1] @ place[side]
                along[face, first + k] += slope / np.linalg.norm(slope)
    along /= np.linalg.norm(along, axis=2, keepdims=True)
    tangent = along.sum(axis=0) / np.linalg.norm(along.sum(axis=0), axis=1, keepdims=True)
    return s, weight, np.stack([tangent[:, 1], -tangent[:, 0]], axis=1), tangent


class Contact:
    """Both bodies reduced to the pairs, and the increments of load on them. The normals of the pairs are common to
    both faces, or, `vertical`, the negative y axis for all."""

    def __init__(self, slave, master, ends, vertical=False):
        upper, lower = respond(slave, ends[0], True), respond(master, ends[1], False)
        faces = slave.xy[slave.face], master.xy[master.face]
        self.s, self.weight, normal, tangent = pair_geometry(*faces)
        if vertical:
            normal, tangent = np.full_like(normal, [0.0, -1.0]), np.full_like(tangent, [1.0, 0.0])
        self.count = m = len(self.s)
        opening, along = np.zeros((m, 2 * m)), np.zeros((m, 2 * m))
        for k in range(2):
            opening[range(m), range(k, 2 * m, 2)] = -normal[:, k]
            along[range(m), range(k, 2 * m, 2)] = tangent[:, k]
        force = np.hstack([opening.T * self.weight, along.T * self.weight])            # of pressure and shear
        relative = np.vstack([opening, along])
        self.initial_gap = opening @ (faces[0] - faces[1]).ravel()
        self.by_traction = relative @ (upper.flexibility + lower.flexibility) @ force   # (g, l) of (p, t)
        self.by_heat = -relative @ (upper.heating + lower.heating) * self.weight        # (g, l) of q
        self.by_load = relative @ (upper.u_load - lower.u_load)
        self.jump_by_load = upper.t_load - lower.t_load
        self.resistance = (upper.resistance + lower.resistance) * self.weight

    def start(self):
        """State before the first increment: no load, the initial gaps."""
        zero = np.zeros(self.count)
        state = SimpleNamespace(load=0.0, p=zero, t=zero, l=zero, g=self.initial_gap, slip=zero,
                                status=np.zeros(self.count, int))
        state.w = state.w_before = self.law(state)
        return state

    def law(self, state):
        """Conductance of the pairs, eq. (1.8)."""
        return np.where(state.status != OPEN, CLOSED_0 + CLOSED_1 * np.maximum(state.p, 0),
                        GAS_A / (GAS_B + np.maximum(state.g, 0)))

    def conditions(self, status, closing):
        """Rows of the contact conditions on the tractions (p, t), and the share of gap or l in each, 0 where tractions
        alone enter. The first pair lies on the axis, its tangent held in both bodies: no shear."""
        m, rows, share = self.count, np.eye(2 * self.count), np.zeros(2 * self.count)
        for k in np.flatnonzero(status != OPEN):
            rows[k], share[k] = self.by_traction[k], 1
            if status[k] != STICK:
                rows[m + k, k] = -FRICTION * status[k]
            elif k > 0:
                fraction, yielding = closing.get(k, (0.0, 0.0))
                share[m + k] = 1 - fraction
                rows[m + k] = share[m + k] * self.by_traction[m + k]
                rows[m + k] += yielding
        return rows, share

    def slips(self, p, t, l, before, closing):
        """Tangential motion in the increment since friction acts: for a pair that closes in it, since that instant."""
        slip = l - before.l
        for k, (fraction, yielding) in closing.items():
            slip[k] = (1 - fraction) * slip[k] + yielding @ np.r_[p, t]
        return slip

    def closing_laws(self, status, before, p, t):
        """Pairs that close in the increment: instant (fraction of it), and what the tractions of all of them add to slip.

        Relieved of the tractions of all that still are open, they go straight to where they would end, all other closed
        pairs holding their places, until the next one closes; it holds its place from there on."""
        m, traction = self.count, np.r_[p, t]
        still_open = [k for k in np.flatnonzero((status != OPEN) & (before.status == OPEN))]
        laws, held = {}, status.copy()
        held[status != OPEN] = STICK
        all_rows = self.conditions(held, {})[0]
        gap, left, yielded = np.maximum(before.g, 0), 1.0, np.zeros((2 * m, 2 * m))
        none = 1e-12 * gap.max()
        while still_open:
            rows = all_rows.copy()
            relieved = still_open + [m + k for k in still_open if k > 0]
            rows[relieved] = np.eye(2 * m)[relieved]
            yielding = np.zeros((2 * m, 2 * m))
            yielding[:, relieved] = self.by_traction @ np.linalg.solve(rows, np.eye(2 * m)[:, relieved])
            end = -(yielding @ traction)[:m]
            part = min([1.0] + [gap[k] / (gap[k] - end[k]) for k in still_open if end[k] < 0])
            gap, left = (1 - part) * gap + part * end, (1 - part) * left
            yielded = (1 - part) * yielded + part * yielding
            closing = [k for k in still_open if gap[k] <= none or part == 1]
            laws.update({k: (1 - left, yielded[m + k].copy()) for k in closing if k > 0})
            still_open = [k for k in still_open if k not in closing]
        return laws

    def mechanics(self, status, before, free):
        """Statuses, tractions and displacements that satisfy every contact condition, by an active set."""
        closing = {}
        for attempt in range(400):
            rows, share = self.conditions(status, closing)
            p, t = traction = np.linalg.solve(rows, share * (np.r_[0 * before.l, before.l] - free)).reshape(2, -1)
            g, l = (free + self.by_traction @ traction.ravel()).reshape(2, -1)
            slip = self.slips(p, t, l, before, closing)
            new = status.copy()
            new[(status == OPEN) & (g < -1e-14)] = STICK
            new[(status != OPEN) & (p < 0)] = OPEN
            beyond = (status == STICK) & (new == STICK) & (np.abs(t) > FRICTION * p * (1 + 1e-12))
            beyond[0] = False
            new[beyond] = np.sign(t[beyond])
            driven = (np.abs(status) == 1) & (new != OPEN) & (status * slip > 1e-14)
            new[driven] = STICK
            laws = self.closing_laws(new, before, p, t)
            same = laws.keys() == closing.keys() and all(abs(laws[k][0] - closing[k][0]) < 1e-13 for k in laws)
            if same and (new == status).all():
                return status, p, t, g, l, slip, closing
            if attempt > 50:                      # a set that comes back: one pair at a time
                changed = np.flatnonzero(new != status)[-1:]
                new = np.where(np.arange(self.count) == changed[0], new, status) if len(changed) else new
            status, closing = new, laws
        raise RuntimeError("the contact zones do not settle")

    def image(self, before, load, w, status):
        """The state to which a conductance leads, with its own conductance w = U: one pass of section 2 of the paper."""
        conductor = np.diag(1 / w) + self.resistance
        q = np.linalg.solve(conductor, load * self.jump_by_load)
        free = np.r_[self.initial_gap, np.zeros(self.count)] + load * self.by_load + self.by_heat @ q
        state = SimpleNamespace(load=load, w_before=before.w, q=q)
        state.status, state.p, state.t, state.g, state.l, state.slip, closing = self.mechanics(status, before, free)
        state.w = self.law(state)
        return state, closing, conductor

    def gains(self, before, state, change=1e-6):
        """Eigenvalues of U' at a solution, by central differences of U."""
        slope = np.empty((self.count, self.count))
        for k in range(self.count):
            ends = []
            for sign in (-1, 1):
                w = state.w.copy()
                w[k] *= 1 + sign * change
                ends.append(self.image(before, state.load, w, state.status)[0].w)
            slope[:, k] = (ends[1] - ends[0]) / (2 * change * state.w[k])
        return np.linalg.eigvals(slope)

    def increment(self, before, load, tolerance=1e-12, guess=None):
        """State at the next load: Newton's method on log(omega) = log(U(omega)), from a guess of omega near it or from
        the last increments."""
        m = self.count
        near = guess is not None
        guess = guess if near else 2 * before.w - before.w_before
        x, status = np.log(np.where(guess > 0, guess, before.w)), before.status
        for iteration in range(100):
            state, closing, conductor = self.image(before, load, np.exp(x), status)
            status, g, q = state.status, state.g, state.q
            residual = np.log(state.w) - x
            if np.abs(residual).max() < tolerance:
                state.slip = np.where(status != OPEN, state.slip + np.where(before.status != OPEN, before.slip, 0), 0)
                state.iterations = iteration + 1
                return state
            if iteration < 3 and not near:
                x = x + residual / 2
                continue
            heat_slope = np.linalg.solve(conductor, np.diag(q * np.exp(-x)))
            rows, share = self.conditions(status, closing)
            moved = self.by_heat @ heat_slope
            traction = np.linalg.solve(rows, -share[:, None] * moved)
            moved = moved + self.by_traction @ traction
            slope = np.where((status != OPEN)[:, None], CLOSED_1 * traction[:m],
                             -(state.w / (GAS_B + np.maximum(g, 0)))[:, None] * moved[:m]) / state.w[:, None]
            change = np.linalg.solve(np.eye(m) - slope, residual)
            x = x + change * min(1, 3 / np.abs(change).max())
        raise RuntimeError(f"no convergence at load {load}")

    # Zone edges, sharpened below the nodal spacing

    def contact_edge(self, state, k):
        """Edge between the closed pair k and the open pair k+1: the zero of a parabola through g^(2/3) of the second to
        fourth open pair, or where there are not so many of the first three, or of a line through the first two, or of
        one through p^2 inside."""
        s, g = self.s, state.g
        last = k
        while last < min(k + 4, self.count - 1) and state.status[last + 1] == OPEN:
            last += 1
        for last in range(last, k + 1, -1):
            pairs = np.arange(max(k + 1, last - 2), last + 1)
            if g[pairs[0]] > 0 and (np.diff(g[pairs]) > 0).all():
                roots = np.roots(np.polyfit(s[pairs] - s[k + 1], g[pairs]**(2 / 3), len(pairs) - 1)) + s[k + 1]
                return np.clip(roots[np.argmin(np.abs(roots - s[k + 1]))].real, s[k], s[k + 1])
        if k == 0 or state.status[k - 1] == OPEN:
            return (s[k] + s[k + 1]) / 2
        inner, outer = state.p[k - 1]**2, state.p[k]**2
        return min(s[k] + (s[k] - s[k - 1]) * outer / (inner - outer), s[k + 1]) if inner > outer else s[k + 1]

    def edges(self, state):
        """(edge_contact, edge_stick): outer edges of the contact zone with the largest s and of the widest stick zone.
        The stick edge is the zero of the straight line through mu p - |t| of the last five stuck pairs."""
        closed = np.flatnonzero(state.status != OPEN)
        stuck = np.flatnonzero(state.status == STICK)
        if len(closed) == 0 or len(stuck) == 0:
            return (self.contact_edge(state, closed[-1]) if len(closed) else np.nan), np.nan
        zone = max(np.split(stuck, np.flatnonzero(np.diff(stuck) > 1) + 1), key=lambda z: self.s[z[-1]] - self.s[z[0]])
        k, inside = zone[-1], zone[-5:]
        slips = state.status[k + 1] != OPEN
        farthest = self.s[k + 1] if slips else self.contact_edge(state, k)
        excess = (FRICTION * state.p - np.sign(state.t[k + 1 if slips else k]) * state.t)[inside]
        s, weight = self.s[inside], self.weight[inside]
        middle, mean = weight @ s / weight.sum(), weight @ excess / weight.sum()
        slope = weight @ ((s - middle) * (excess - mean))
        stick = farthest
        if len(inside) == 1:
            stick = (self.s[k] + farthest) / 2
        elif slope < 0:
            stick = np.clip(middle - mean * (weight @ (s - middle)**2) / slope, self.s[k], farthest)
        return self.contact_edge(state, closed[-1]), stick


def solve_deck(deck=DECK, levels=0, step=20.0, last=900.0, vertical=False):
    """The pairs and the states at every increment. Each state has load, status, p, t, g, l, slip, w, q (per pair) and
    normal_force, shear_force, heat_rate, edge_contact, edge_stick."""
    bodies = read_deck(deck)
    ends = bodies[0].xy[:, 1].max(), bodies[1].xy[:, 1].min()
    for _ in range(levels):
        bodies = [refine(body) for body in bodies]
    contact = Contact(*bodies, ends, vertical)
    states = [contact.start()]
    for k in range(1, round(last / step) + 1):
        state = contact.increment(states[-1], k * step)
        state.normal_force, state.shear_force = contact.weight @ state.p, contact.weight @ state.t
        state.heat_rate = contact.weight @ state.q
        state.edge_contact, state.edge_stick = contact.edges(state)
        states.append(state)
    return contact, states[1:]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--deck", default=DECK, help="deck with the mesh (default: the published cylinder)")
    parser.add_argument("--levels", type=int, default=0, help="uniform refinements")
    parser.add_argument("--step", type=float, default=20.0, help="increment of the load")
    parser.add_argument("--last", type=float, default=900.0, help="last load")
    options = parser.parse_args()
    contact, states = solve_deck(options.deck, options.levels, options.step, options.last)
    names = ("normal_force", "shear_force", "heat_rate", "max pressure", "edge_contact", "edge_stick")
    print(f"{contact.count} pairs\n   load " + " ".join(f"{name:>13}" for name in names))
    for state in states:
        if round(state.load) % 180 == 0 or state is states[-1]:
            values = (state.normal_force, state.shear_force, state.heat_rate, state.p.max(), *contact.edges(state))
            print(f"{state.load:7.1f} " + " ".join(f"{value:13.8g}" for value in values))


if __name__ == "__main__":
    main()
