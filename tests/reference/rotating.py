#!/usr/bin/env python3
"""Rotating discs and cylinders, and heavy columns, in closed form, to check thercon against: numpy only.

S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, 3rd ed., sections 32 and 134. `plane` is "stress" for a thin
disc (sigma_zz = 0) and "strain" for a cylinder between rigid smooth ends: that is the disc with nu/(1 - nu) for nu.
"""
import numpy as np
from lame import axial_stress, displacement


def disc(r, inner, outer, density, speed, young, poisson, plane):
    """sigma_rr, sigma_tt, sigma_zz and u at r; inner = 0 is a solid one. Speed in radians per unit of time."""
    r = np.asarray(r, float)
    nu = poisson if plane == "stress" else poisson / (1 - poisson)
    force = density * speed**2 * (3 + nu) / 8
    cross = 0.0 * r if inner == 0.0 else inner**2 * outer**2 / r**2
    radial = force * (inner**2 + outer**2 - cross - r**2)
    hoop = force * (inner**2 + outer**2 + cross - (1 + 3 * nu) / (3 + nu) * r**2)
    axial = axial_stress(radial, hoop, poisson, plane)
    return radial, hoop, axial, displacement(r, radial, hoop, young, poisson, plane)


def oedometer(young, poisson):
    """Stiffness of a body that cannot move sideways: sigma = M eps (plane strain and axisymmetric)."""
    return young * (1 - poisson) / (1 + poisson) / (1 - 2 * poisson)


def column(y, height, weight, modulus):
    """Stress and displacement along a column, held at y = 0, under `weight` per unit of volume towards -y."""
    y = np.asarray(y, float)
    return -weight * (height - y), -weight * (height * y - y**2 / 2) / modulus
