"""The equations of the pairs between two rods of one 8-node element each, assembled anew.

Across the ends of rods, however slender, pairs may be in different states: the middle pair carries
the force, the outer ones conduct over a gap that the heat keeps open. The closed forms of
tests/reference/rods.py know nothing of such solutions."""

import numpy as np
from cylinder_reference import GAUSS, shape

FACE = [0, 4, 1]   # nodes at y = 0 in the order of the pairs


def rod(end, width, conductivity, expansion, young, hot, load):
    """Return temperatures and displacements of the face at y = 0 of a rod whose other end, at
    y = end, is held and has the temperature `hot`; `load` gives heat into the face and forces on
    it along y. Nothing moves across, Poisson's ratio is 0, and the area is 1."""
    xy = np.array([(x * width, y * end) for x, y in (
        (0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0), (1, 0.5), (0.5, 1), (0, 0.5))])
    conduction, stiffness, coupling = np.zeros((3, 8, 8))
    for a, weight_a in GAUSS:
        for b, weight_b in GAUSS:
            value, slope = shape(a, b)
            jacobian = slope @ xy
            slope = np.linalg.solve(jacobian, slope)
            area = weight_a * weight_b * abs(np.linalg.det(jacobian)) / width
            across, along = (np.outer(row, row) * area for row in slope)
            conduction += conductivity * (across + along)
            stiffness += young * (along + across / 2)
            coupling += young * expansion * area * np.outer(slope[1], value)
    heat, force = np.zeros((2, 8))
    heat[FACE], force[FACE] = load
    free = [0, 1, 4, 5, 7]
    temperature, displacement = np.full(8, hot), np.zeros(8)
    temperature[free] += np.linalg.solve(conduction[np.ix_(free, free)], heat[free])
    force += coupling @ temperature
    displacement[free] = np.linalg.solve(stiffness[np.ix_(free, free)], force[free])
    return temperature[FACE], displacement[FACE]


def solves(case, pairs):
    """Return whether pairs (conductance, gap, pressure, heat_flux, weight) satisfy the equations of
    both rods and the laws, to what residual and rounding explain."""
    omega, gap, pressure, flux, weight = (
        pairs[name] for name in ("conductance", "gap", "pressure", "heat_flux", "weight"))
    weight = weight / weight.sum()
    both, width = case.rods, min(case.rods.length) / case.slender
    ends = [rod(sign * length, width, conductivity, expansion, young, hot,
                (-sign * weight * flux, sign * weight * pressure))
            for sign, length, conductivity, expansion, young, hot in zip(
                (1, -1), both.length, both.conductivity, both.expansion, both.young,
                both.temperature, strict=True)]
    jump = ends[0][0] - ends[1][0]
    opening = both.gap + ends[0][1] - ends[1][1]
    near = case.gap_allowed
    hottest = max(abs(t) for t in both.temperature)
    is_open, is_closed = gap > 0, pressure > 0
    open_law, closed_law = case.a / (case.b + gap), case.touch + case.c * pressure
    law = np.where(is_open, open_law, np.where(is_closed, closed_law, np.clip(
        omega, min(case.a / case.b, case.touch), max(case.a / case.b, case.touch))))
    slope = np.where(is_open, open_law / (case.b + gap), case.c / both.compliance)
    return bool(
        (np.minimum(gap, pressure) == 0).all() and (np.maximum(gap, pressure) >= 0).all()
        and (abs(jump - flux / omega) <= 1e-8 * hottest).all()
        and (abs(opening - gap) <= near).all()
        and (abs(law - omega) <= 2 * case.tolerance * omega + near * slope).all())
