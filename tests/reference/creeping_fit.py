#!/usr/bin/env python3
"""A press fit whose hub creeps, in one dimension, to check thercon against: a shaft that stays
elastic in a hub of Norton's law, each free to change its length but for ends that stay plane, and
free to slide along the other.

Creep keeps the volume. With creep strains e and a dilatation D = u' + u/r in the plane,
equilibrium of the hub is (lambda + 2 mu) D' = 2 mu (e_r' + (e_r - e_t)/r), which is integrated
over log r from the bore on. Three constants remain: D and u at the bore and the strain along
the axis. scipy integrates the rates over time.

    creeping_fit.py    prints the pressures of input/examples/hot_press_fit.inp
"""
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev
from scipy.integrate import solve_ivp


@dataclass
class Fit:
    """A fit: radii of the seat and of the hub's outside, and how much larger than the bore the
    shaft is. shaft and hub are (E, nu, coefficient of expansion) cold, then hot; the hot hub
    creeps at a rate A q^n."""

    seat: float
    outside: float
    interference: float
    shaft: tuple
    hub: tuple
    warming: float
    creep: tuple
    nodes: int = 24

    def __post_init__(self):
        points = np.cos(np.pi * np.arange(self.nodes)[::-1] / (self.nodes - 1))
        basis = chebyshev.chebvander(points, self.nodes - 1)
        integrals = [chebyshev.chebval(points, chebyshev.chebint(row, lbnd=-1))
                     for row in np.eye(self.nodes)]
        half = np.log(self.outside / self.seat) / 2
        self.r = self.seat * np.exp(half * (points + 1))
        # Over log r, from the bore
        self.integral = half * np.linalg.solve(basis.T, np.array(integrals)).T

    def response(self, strains, hot, apart=False):
        """Pressure, gap and stresses (r, t, z) of the hub by creep strains (r, t), cold or hot."""
        (shaft, nu, growth), (young, poisson, hub_growth) = self.shaft[hot], self.hub[hot]
        mu = young / (2 * (1 + poisson))
        lam = young * poisson / ((1 + poisson) * (1 - 2 * poisson))
        e_r, e_t = strains
        stress = [self.stresses(lam, mu, e_r, e_t, 0.0, 0.0, 0.0)]
        stress += [self.stresses(lam, mu, e_r, e_t, *row) - stress[0] for row in np.eye(3)]
        warm = (growth - hub_growth) * self.warming * hot
        overlap = self.interference + warm * self.seat

        def conditions(s, u):
            """Outside, force along the axis, and at the seat the pressure by the shaft, or none."""
            compliance = self.seat * (1 - nu) / shaft
            seat = s[0][0] if apart else u - compliance * s[0][0]
            return np.array([s[0][-1], self.integral[-1] @ (s[2] * self.r**2), seat])

        constant = conditions(stress[0], 0.0)
        matrix = np.array([conditions(s, u) for s, u in zip(stress[1:], (0.0, 1.0, 0.0))]).T
        found = np.linalg.solve(matrix, np.array([0.0, 0.0, 0.0 if apart else overlap]) - constant)
        total = stress[0] + np.tensordot(found, stress[1:], 1)
        if total[0][0] > 0.0 and not apart:
            return self.response(strains, hot, apart=True)
        return -total[0][0], found[1] - overlap if apart else 0.0, total

    def stresses(self, lam, mu, e_r, e_t, dilatation, moved, along):
        """Stresses by creep strains, dilatation and displacement of the bore, and strain along."""
        d = dilatation + 2 * mu / (lam + 2 * mu) * (e_r - e_r[0] + self.integral @ (e_r - e_t))
        hoop = (self.seat * moved + self.integral @ (d * self.r**2)) / self.r**2
        radial, volume = d - hoop, lam * (d + along)
        return np.array([volume + 2 * mu * (radial - e_r), volume + 2 * mu * (hoop - e_t),
                         volume + 2 * mu * (along + e_r + e_t)])

    def rates(self, _time, state):
        """Rates of the creep strains while the joint is hot."""
        a, n = self.creep
        stress = self.response(state.reshape(2, -1), 1)[2]
        deviator = stress - stress.mean(axis=0)
        q = np.sqrt(1.5 * (deviator**2).sum(axis=0))
        return (1.5 * a * q**(n - 1) * deviator[:2]).ravel()

    def course(self, times):
        """Creep strains (r, t) of the hub after times at heat."""
        solved = solve_ivp(self.rates, (0.0, times[-1]), np.zeros(2 * self.nodes), "Radau", times,
                           rtol=1e-8, atol=1e-13)
        return [state.reshape(2, -1) for state in solved.y.T]


EXAMPLE = Fit(seat=50.0, outside=100.0, interference=0.025,
              shaft=((218e3, 0.3, 13.4e-6), (183e3, 0.3, 13.4e-6)),
              hub=((218e3, 0.3, 12.6e-6), (167e3, 0.3, 12.6e-6)), warming=580.0,
              creep=(2.2e-17, 5.0))


def main():
    hours = 4980.0 * np.arange(9)
    for time, strains in zip(hours, EXAMPLE.course(hours)):
        (hot, _, _), (cold, gap, _) = EXAMPLE.response(strains, 1), EXAMPLE.response(strains, 0)
        print(f"{time:6g} h at heat: {hot:10.6f} hot, {cold:10.6f} cold, gap {gap:.8f}")


if __name__ == "__main__":
    main()
