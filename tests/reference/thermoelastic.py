#!/usr/bin/env python3
"""Closed forms of bodies that strains warm, with numpy only.

C_e T' + T0 beta:eps' = div(k grad T), C_e = rho c_p - T0 beta:alpha. Bodies are isotropic, and T0
stays the temperature of the start.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Solid:
    """A material, and the temperature T0 from absolute zero."""

    young: float
    poisson: float
    expansion: float
    conductivity: float
    capacity: float        # rho c_p
    temperature: float

    @property
    def column_modulus(self):
        """Return the modulus of a column that cannot widen."""
        nu = self.poisson
        return self.young * (1 - nu) / (1 + nu) / (1 - 2 * nu)

    @property
    def beta(self):
        """Return the stress of a degree where nothing expands."""
        return self.young * self.expansion / (1 - 2 * self.poisson)

    @property
    def clamped_capacity(self):
        """Return C_e."""
        return self.capacity - 3 * self.temperature * self.beta * self.expansion

    @property
    def coupling(self):
        """Return delta = beta^2 T0/(M C_e) of a column that cannot widen."""
        return self.beta**2 * self.temperature / self.column_modulus / self.clamped_capacity

    @property
    def relaxation(self):
        """Return E alpha^2 T0/(rho c_p): how much stiffer a bar is where heat stays in it."""
        return self.young * self.expansion**2 * self.temperature / self.capacity

    def pulled(self, stress):
        """Return by how much a bar becomes warmer when it is pulled at once (W. Thomson 1853)."""
        return -self.expansion * self.temperature * stress / self.capacity

    def pressed(self, pressure):
        """Return by how much a column that cannot widen becomes warmer when it is pressed at once.

        eps = (beta T - p)/M and C_e T + T0 beta eps = 0: eps is 1/(1 + delta) of -p/M.
        """
        return self.temperature * self.beta * pressure / self.column_modulus \
            / self.clamped_capacity / (1 + self.coupling)

    def diffusivity_of_column(self):
        """Return k/(C_e (1 + delta)): the stress stays, so that the strain follows T."""
        return self.conductivity / self.clamped_capacity / (1 + self.coupling)

    def bent_modulus(self, frequency, thickness):
        """Return the complex modulus of a strip whose curvature is exp(i w t), its faces insulated.

        sigma = E (y - alpha T) and (rho c_p - T0 E alpha^2) T' + T0 E alpha y' = k T'', so that
        T = -T0 E alpha/C (y - sinh(q y)/(q cosh(q b/2))) with q^2 = i w C/k. The modulus is the
        moment over that of E = 1. C. Zener, Phys. Rev. 52 (1937) 230, has this in modes.
        """
        capacity = self.capacity * (1 - self.relaxation)
        q = np.sqrt(1j * frequency * capacity / self.conductivity)
        b = thickness
        even = 12 / b**3 * (b / q**2 - 2 * np.tanh(q * b / 2) / q**3)
        return self.young * (1 + self.relaxation / (1 - self.relaxation) * (1 - even))


def time_constant(solid, thickness):
    """Return Zener's tau of a strip in bending."""
    return solid.capacity * thickness**2 / np.pi**2 / solid.conductivity


def main():
    """Print the values of published tables."""
    steel = Solid(2.1e11, 0.3, 1.2e-5, 50.0, 3.588e6, 293.0)
    print("pulled  ", steel.pulled(1e8))
    print("pressed ", steel.pressed(1e8), steel.coupling, steel.clamped_capacity,
          steel.column_modulus)
    tau = time_constant(steel, 1.0)
    for part in (0.1, 0.3, 1.0, 3.0, 10.0):
        modulus = steel.bent_modulus(part / tau, 1.0)
        print("strip   ", part, modulus.imag / modulus.real, steel.relaxation * part
              / (1 + part**2))


if __name__ == "__main__":
    main()
