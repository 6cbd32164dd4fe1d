#!/usr/bin/env python3
"""A fuel rod over its radius, with numpy and scipy only: conduction with k(T), a gap that the heat
closes, and equilibrium of pellet and tube with E(T) and alpha(T).

Temperatures in C, lengths in mm, stresses in MPa, powers in W. Published properties:

- UO2 of 95 % density: conductivity of J. K. Fink, J. Nucl. Mater. 279 (2000) 1-18; modulus and
  strain of MATPRO (NUREG/CR-6150, volume 4);
- Zircaloy: conductivity and modulus of MATPRO;
- helium: conductivity 2.639e-3 T^0.7085 W/(m K) of MATPRO.
"""

from math import exp, pi

import numpy as np
from scipy.linalg import solve_banded
from scipy.optimize import brentq

import tables

KELVIN = 273.15
CELLS = 400


def oxide_conductivity(celsius):
    """Return the conductivity of UO2 of 95 % density [W/(mm K)]."""
    t = (celsius + KELVIN) / 1000
    return (100 / (7.5408 + 17.692 * t + 3.6142 * t**2)
            + 6400 / t**2.5 * exp(-16.35 / t)) / 1000


def oxide_modulus(celsius):
    """Return Young's modulus of UO2 of 95 % density [MPa]."""
    return 2.334e5 * (1 - 2.752 * 0.05) * (1 - 1.0915e-4 * (celsius + KELVIN))


def oxide_strain(celsius):
    """Return the strain of UO2 from about 300 K on."""
    kelvin = celsius + KELVIN
    return 1e-5 * kelvin - 3e-3 + 4e-2 * exp(-6.9e-20 / (1.380649e-23 * kelvin))


def zircaloy_conductivity(celsius):
    """Return the conductivity of Zircaloy [W/(mm K)]."""
    t = celsius + KELVIN
    return (7.51 + 2.09e-2 * t - 1.45e-5 * t**2 + 7.67e-9 * t**3) / 1000


def zircaloy_modulus(celsius):
    """Return Young's modulus of Zircaloy [MPa]."""
    return 1.088e5 - 54.75 * (celsius + KELVIN)


def helium_conductivity(celsius):
    """Return the conductivity of helium [W/(mm K)]."""
    return 2.639e-6 * (celsius + KELVIN) ** 0.7085


def table(law, temperatures, digits=4):
    """Return the rows of a law, rounded as a deck has them."""
    return [(float(f"{law(t):.{digits - 1}e}"), float(t)) for t in temperatures]


def secants(strain, temperatures, zero, digits=4):
    """Return the rows of mean coefficients of expansion from a temperature on."""
    return table(lambda t: (strain(t) - strain(zero)) / (t - zero), temperatures, digits)


class Ring:
    """A body of the rod, solid where its inner radius is 0, in a plane whose strain along the axis
    is uniform: `along` it is given, or no force is left along the axis where it is None."""

    def __init__(self, radii, young, poisson, expansion, zero, start, along=None):
        self.radii, self.young, self.poisson, self.along = radii, young, poisson, along
        self.expansion, self.zero, self.start = expansion, zero, start

    def parts(self, temperature):
        """Return the force along the axis and the displacements of both faces, for a unit strain
        along it, a unit outer and inner pressure, and heat, in this order: by CELLS and twice as
        many, extrapolated."""
        coarse, fine = (self.divided(temperature, n) for n in (CELLS, 2 * CELLS))
        return (4 * fine - coarse) / 3

    def divided(self, temperature, cells):
        """Return the parts of rings of linear displacements; strains are those of their middles."""
        r = np.linspace(*self.radii, cells + 1)
        middle, width = (r[1:] + r[:-1]) / 2, np.diff(r)
        t = temperature(middle)
        young, nu = tables.value(self.young, t), self.poisson
        warm = tables.thermal_strain(self.expansion, self.zero, self.start, t)
        shear, volume = young / (1 + nu), young * nu / (1 + nu) / (1 - 2 * nu)
        # Strains along the radius and around, of the displacements at both ends.
        strains = np.array([[-1 / width, 1 / width], [0.5 / middle, 0.5 / middle]])
        law = volume + np.array([[shear, 0 * shear], [0 * shear, shear]])
        stiffness = np.einsum("ace,abe,bde,e->cde", strains, law, strains, middle * width)
        band = np.zeros((3, cells + 1))
        for c in (0, 1):
            band[1, c:cells + c] += stiffness[c, c]
        band[0, 1:], band[2, :-1] = stiffness[0, 1], stiffness[1, 0]
        # Stress in the plane of a unit strain along the axis, and of heat held back.
        initial = np.array([volume, 0 * warm, 0 * warm, -(shear + 3 * volume) * warm])
        loads = np.zeros((cells + 1, 4))
        for c in (0, 1):
            loads[c:cells + c] -= (strains[:, c].sum(axis=0) * initial * middle * width).T
        loads[-1, 1] -= self.radii[1]
        loads[0, 2] += self.radii[0]
        if self.radii[0] == 0.0:
            band[:2, 0:2] = [[0.0, 0.0], [1.0, band[1, 1]]]
            band[2, 0], loads[0] = 0.0, 0.0
        u = solve_banded((1, 1), band, loads)
        dilated = np.einsum("ace,cek->ke", strains, np.array([u[:-1], u[1:]]))
        axial = volume * dilated + np.array([(shear + volume) * np.ones(cells), 0 * warm, 0 * warm,
                                             -(shear + 3 * volume) * warm])
        return np.array([(axial * middle * width).sum(axis=1), u[0], u[-1]]).T

    def faces(self, parts, inside, outside):
        """Return the displacements of the inner and the outer face under pressures."""
        along = self.along
        loads = parts[3] + outside * parts[1] + inside * parts[2]
        if along is None:
            along = -loads[0] / parts[0][0]
        return (loads + along * parts[0])[1:]


class Rod:
    """Pellet and tube: radii (a, b, c), tables of conductivities, bodies, the conductance of gas by
    gap and mean temperature, and what a unit pressure adds to it."""

    def __init__(self, radii, pellet, tube, conductivities, film, coolant, gas, touching):
        self.radii, self.pellet, self.tube, self.film = radii, pellet, tube, film
        self.oxide, self.wall = conductivities
        self.coolant, self.gas, self.touching = coolant, gas, touching

    def wall_temperature(self, power):
        """Return the temperature of the tube by the radius; power is of a unit volume of pellet."""
        a, _, c = self.radii
        heat = power * a**2 / 2   # of a unit length and angle
        outside = self.coolant + heat / (c * self.film)
        total = tables.integral(self.wall, outside)
        return lambda r: tables.of_integral(self.wall, total + heat * np.log(c / r))

    def pellet_temperature(self, power, face):
        """Return the temperature of the pellet by the radius."""
        a = self.radii[0]
        total = tables.integral(self.oxide, face)
        return lambda r: tables.of_integral(self.oxide, total + power * (a**2 - r**2) / 4)

    def solve(self, power):
        """Return gap, pressure, temperatures of pellet (centre, face) and tube (bore, outside), and
        the conductance."""
        a, b, c = self.radii
        seat = (a + b) / 2
        wall = self.wall_temperature(power)
        tube = self.tube.parts(wall)
        bore = float(wall(b))

        def state(face):
            pellet = self.pellet.parts(self.pellet_temperature(power, face))
            free = (b - a + self.tube.faces(tube, 0.0, 0.0)[0]
                    - self.pellet.faces(pellet, 0.0, 0.0)[1])
            # Areas of the contact are those half-way between the faces.
            pressed = (b - a + self.tube.faces(tube, seat / b, 0.0)[0]
                       - self.pellet.faces(pellet, 0.0, seat / a)[1])
            pressure = max(0.0, -free / (pressed - free))
            gap = max(0.0, free)
            mean = (face + bore) / 2
            return gap, pressure, self.gas(gap, mean) + self.touching * pressure

        def left(face):
            return state(face)[2] * (face - bore) * seat - power * a**2 / 2

        face = brentq(left, bore + 1e-6, bore + 3000.0, xtol=1e-9) if power else bore
        gap, pressure, conductance = state(face)
        centre = float(self.pellet_temperature(power, face)(0.0))
        return {"gap": gap, "pressure": pressure, "conductance": conductance, "centre": centre,
                "face": face, "bore": bore, "outside": float(wall(c))}


POINTS = (20.0, 300.0, 500.0, 750.0, 1000.0, 1250.0, 1500.0, 1800.0)
COLD = 20.0


def example(along=None):
    """Return the rod of the example fuel_pellet."""
    gas = table(helium_conductivity, POINTS[:5])
    pellet = Ring((0.0, 4.1), table(oxide_modulus, POINTS), 0.316,
                  secants(oxide_strain, POINTS[1:], COLD), COLD, COLD, along)
    tube = Ring((4.12, 4.70), table(zircaloy_modulus, POINTS[:5]), 0.35, [(6e-6, COLD), (6e-6, 1e3)],
                COLD, COLD, along)
    return Rod((4.1, 4.12, 4.70), pellet, tube,
               (table(oxide_conductivity, POINTS), table(zircaloy_conductivity, POINTS[:5])),
               0.03, 300.0, lambda gap, mean: tables.value(gas, mean) / (5e-3 + gap), 2e-3)


def main():
    """Print the states of the example at several powers."""
    rod = example()
    print("oxide ", table(oxide_conductivity, POINTS), table(oxide_modulus, POINTS),
          secants(oxide_strain, POINTS[1:], COLD))
    for power in (0.0, 0.2, 0.4, 0.5, 0.6, 0.7, 0.8):
        print(power, pi * power * 4.1**2, rod.solve(power))


if __name__ == "__main__":
    main()
