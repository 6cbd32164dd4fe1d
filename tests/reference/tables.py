#!/usr/bin/env python3
"""Bodies whose properties follow the temperature: closed forms, and one-dimensional solutions with
numpy and scipy only.

A table is a list of rows (value, temperature), linear between them and held outside.
"""

from functools import cache
from math import erfc, exp, log, pi, sqrt

import numpy as np
from scipy.integrate import solve_bvp, solve_ivp
from scipy.optimize import brentq


def value(table, temperature):
    """Return the value of a table."""
    values, places = np.transpose(table)
    return np.interp(temperature, places, values)


def integral(table, temperature):
    """Return the integral of a table from its first row to a temperature."""
    values, places = np.transpose(table)
    between = np.concatenate([[0.0], np.cumsum((values[1:] + values[:-1]) / 2 * np.diff(places))])
    at = np.clip(temperature, places[0], places[-1])
    row = np.clip(np.searchsorted(places, at, side="right") - 1, 0, len(places) - 2)
    inside = between[row] + (values[row] + value(table, at)) / 2 * (at - places[row])
    return inside + (temperature - at) * value(table, temperature)


def of_integral(table, total):
    """Return the temperature to which a positive table has an integral."""
    values, places = np.transpose(table)
    ends = integral(table, places)
    row = np.clip(np.searchsorted(ends, total, side="right") - 1, 0, len(places) - 2)
    slope = (values[row + 1] - values[row]) / (places[row + 1] - places[row])
    more = np.clip(total, ends[0], ends[-1]) - ends[row]
    # The root of value rise + slope rise^2/2 that is right for a slope of 0, too.
    rise = 2 * more / (values[row] + np.sqrt(values[row] ** 2 + 2 * slope * more))
    beyond = (total - np.clip(total, ends[0], ends[-1])) / np.where(
        total < ends[0], values[0], values[-1])
    return places[row] + rise + beyond


def across(conductivity, share, first, last):
    """Return the temperature between two others, where a share of Kirchhoff's integral of the
    conductivity is behind: x/L in a slab, ln(r/a)/ln(b/a) in a cylinder."""
    ends = integral(conductivity, first), integral(conductivity, last)
    return of_integral(conductivity, ends[0] + share * (ends[1] - ends[0]))


def flux_into_half_space(place, time):
    """Return the temperature of a half-space with k = rho c = 1 + T/2 under a unit flux.

    Kirchhoff's integral T + T^2/4 is the heat content, too, and follows the linear equation (Carslaw
    and Jaeger, section 2.9).
    """
    if time == 0.0:
        return 0.0
    content = 2 * sqrt(time / pi) * exp(-(place**2) / 4 / time) - place * erfc(
        place / 2 / sqrt(time))
    return 2 * (sqrt(1 + content) - 1)


@cache
def step_of_half_space(slope, constant, capacity, start, face):
    """Return the temperature of a half-space with k = constant + slope T, whose face changes, by
    z = x/sqrt(t): (k T')' + rho c z T'/2 = 0 (Boltzmann)."""
    width = sqrt((constant + slope * face) / capacity)

    def course(rate):
        """Integrate over z/width from the face on, where the temperature changes at a rate."""
        def equations(z, y):
            rise = y[1] / (constant + slope * y[0])
            return [rise, -capacity * width**2 * z / 2 * rise]

        return solve_ivp(equations, (0.0, 12.0), [face, rate * (constant + slope * face)],
                         method="DOP853", rtol=1e-12, atol=1e-12, dense_output=True).sol

    # 1/sqrt(pi) is the rate of a constant conductivity.
    rate = brentq(lambda part: course(part * (start - face))(12.0)[0] - start, 0.2, 1.0, xtol=1e-14)
    found = course(rate * (start - face))
    return lambda x, time: float(found(x / sqrt(time) / width)[0])


def product(one, other, pieces=50):
    """Return a table of the product of two tables, each interval divided into pieces."""
    places = np.union1d(*(np.transpose(table)[1] for table in (one, other)))
    fine = np.interp(np.arange((len(places) - 1) * pieces + 1) / pieces, range(len(places)), places)
    return [(float(value(one, t) * value(other, t)), float(t)) for t in fine]


def bar_stretch(stress, length, first, last):
    """Return the elongation of a bar whose modulus is linear along it."""
    return stress * length * log(first / last) / (first - last)


def thermal_strain(expansion, zero, start, temperature):
    """Return the strain of a table of secants from a temperature without strain."""
    return value(expansion, temperature) * (temperature - zero) - value(expansion, start) * (
        start - zero)


class Cylinder:
    """A thick cylinder in a field of temperatures, under a pressure inside; each of its properties
    is a table.

    The plane is 'strain' (no strain along the axis) or 'stress' (no stress along it). Unknown are the
    radial displacement u and stress s: s' = (hoop - s)/r, and u' from Hooke's law.
    """

    def __init__(self, radii, plane, young, poisson, expansion, zero, start):
        self.radii, self.plane, self.start, self.zero = radii, plane, start, zero
        self.young, self.poisson, self.expansion = young, poisson, expansion

    def compliance(self, temperature):
        """Return the compliances along and across in the plane, and the strain of heat in it."""
        young, nu = value(self.young, temperature), value(self.poisson, temperature)
        warm = thermal_strain(self.expansion, self.zero, self.start, temperature)
        if self.plane == "strain":
            return (1 - nu**2) / young, -nu * (1 + nu) / young, (1 + nu) * warm
        return 1 / young, -nu / young, warm

    def solve(self, temperature, pressure=0.0, outside=0.0):
        """Return u, radial and hoop stress by the radius, for temperatures by the radius."""
        inner, outer = self.radii

        def hoop(r, u, s):
            along, across_it, warm = self.compliance(temperature(r))
            return (u / r - warm - across_it * s) / along

        def equations(r, y):
            along, across_it, warm = self.compliance(temperature(r))
            around = hoop(r, *y)
            return np.array([along * y[1] + across_it * around + warm, (around - y[1]) / r])

        r = np.linspace(inner, outer, 200)
        found = solve_bvp(equations, lambda a, b: np.array([a[1] + pressure, b[1] + outside]), r,
                          np.array([1e-3 * r, -pressure * np.ones_like(r)]), tol=1e-9,
                          max_nodes=200000)
        assert found.success, found.message

        def at(radius):
            u, s = (float(v) for v in found.sol(radius))
            return u, s, float(hoop(radius, u, s))

        return at


def steady_ring(radii, conductivity, inside, outside):
    """Return the temperatures of a cylinder between two others, by the radius."""
    def at(radius):
        return across(conductivity, np.log(radius / radii[0]) / log(radii[1] / radii[0]), inside,
                      outside)

    return at


def warmed_ring(radii, conductivity, capacity, start, film, sink, times, cells=400):
    """Return radii (nodes), and temperatures (times, nodes) of a ring whose bore a film warms,
    insulated outside: control volumes about nodes, and stiff integration in time.

    Errors fall with the square of the cells; `extrapolated` takes the difference of two.
    """
    inner, outer = radii
    r = np.linspace(inner, outer, cells + 1)
    middle = (r[1:] + r[:-1]) / 2
    ends = np.concatenate([[inner], middle, [outer]])
    volume = np.diff(ends**2) / 2
    step = np.diff(r)

    def rates(_, t):
        flow = -value(conductivity, (t[1:] + t[:-1]) / 2) * middle * np.diff(t) / step
        gained = -np.diff(np.concatenate([[-film * (t[0] - sink) * inner], flow, [0.0]]))
        return gained / volume / value(capacity, t)

    band = np.eye(cells + 1) + np.eye(cells + 1, k=1) + np.eye(cells + 1, k=-1)
    found = solve_ivp(rates, (0.0, max(times)), np.full(cells + 1, start), method="BDF",
                      t_eval=times, rtol=1e-9, atol=1e-9, jac_sparsity=band)
    assert found.success, found.message
    return r, found.y.T


def extrapolated(*arguments, cells=100):
    """Return radii and temperatures of `warmed_ring` with the error of h^2 removed."""
    r, coarse = warmed_ring(*arguments, cells=cells)
    _, fine = warmed_ring(*arguments, cells=2 * cells)
    return r, (4 * fine[:, ::2] - coarse) / 3


def main():
    """Print the values of the published cases."""
    print("flux into half-space", [flux_into_half_space(x, t) for x in (0.0, 1.0)
                                   for t in (0.1, 0.3, 1.0)])
    step = step_of_half_space(1.0, 200.0, 8e6, 100.0, 200.0)
    print("step of half-space  ", [step(x, 10.0) for x in (0.01, 0.02, 0.04, 0.06)])
    slab = [(10.0, 0.0), (20.0, 500.0)]
    print("slab                ", integral(slab, 500.0) / 0.1, across(slab, 0.5, 0.0, 500.0))
    print("bar                 ", bar_stretch(1.0, 1.0, 2.0, 1.0))


if __name__ == "__main__":
    main()
