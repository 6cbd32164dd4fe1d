#!/usr/bin/env python3
"""Thick cylinders in closed form, to check thercon against: numpy only.

Lame's solution, press fits, and the thermal stresses of a tube through which heat flows (S. P. Timoshenko and
J. N. Goodier, Theory of Elasticity, 3rd ed., sections 28, 150, 151). `plane` is "stress" (ends free and sigma_zz = 0
everywhere) or "strain" (no axial strain). Radial displacements follow from the hoop strain, u = r eps_tt.

    lame.py        prints the press fit of input/examples/press_fit.inp
"""
import numpy as np


def axial_stress(radial, hoop, poisson, plane, free_expansion=0.0, young=0.0):
    """sigma_zz; free_expansion is alpha (T - T0)."""
    return 0.0 * radial if plane == "stress" else poisson * (radial + hoop) - young * free_expansion


def displacement(r, radial, hoop, young, poisson, plane, free_expansion=0.0):
    """Radial displacement from the stresses at r."""
    axial = axial_stress(radial, hoop, poisson, plane, free_expansion, young)
    return r * ((hoop - poisson * (radial + axial)) / young + free_expansion)


def cylinder(r, inner, outer, inside=0.0, outside=0.0):
    """sigma_rr and sigma_tt at r in a cylinder with pressures inside and outside; inner = 0 is a solid one."""
    r = np.asarray(r, float)
    mean = (inside * inner**2 - outside * outer**2) / (outer**2 - inner**2)
    if inner == 0.0:
        return mean + 0.0 * r, mean + 0.0 * r
    swing = (inside - outside) * inner**2 * outer**2 / (outer**2 - inner**2) / r**2
    return mean - swing, mean + swing


def wall_compliance(inner, outer, face, young, poisson, plane):
    """Radial displacement of a face, away from the cylinder's material, per unit of pressure on it."""
    pressures = (1.0, 0.0) if face == inner else (0.0, 1.0)
    moved = displacement(face, *cylinder(face, inner, outer, *pressures), young, poisson, plane)
    return float(moved if face == inner else -moved)


def press_fit(inner, face, outer, hub, rim, interference, plane):
    """Pressure between two cylinders that overlap by `interference` on the radius; hub and rim are (E, nu)."""
    compliance = wall_compliance(inner, face, face, *hub, plane) + wall_compliance(face, outer, face, *rim, plane)
    return interference / compliance


def hot_tube(r, inner, outer, inside, outside, young, poisson, expansion, plane):
    """Temperature, its stresses sigma_rr and sigma_tt, and u in a tube with temperatures inside and outside (above
    the natural state), on free faces: T is linear in log r."""
    r = np.asarray(r, float)
    slope = (outside - inside) / np.log(outer / inner)

    def temperature(s):
        return inside + slope * np.log(s / inner)

    def moment(s):   # of T from the bore to s: the integral of T r dr
        return (s**2 * temperature(s) - inner**2 * inside) / 2 - slope * (s**2 - inner**2) / 4

    factor = expansion * young / (1.0 if plane == "stress" else 1.0 - poisson)
    whole, part = moment(outer) / (outer**2 - inner**2), moment(r)
    radial = factor / r**2 * ((r**2 - inner**2) * whole - part)
    hoop = factor / r**2 * ((r**2 + inner**2) * whole + part - temperature(r) * r**2)
    free = expansion * temperature(r)
    return temperature(r), radial, hoop, displacement(r, radial, hoop, young, poisson, plane, free)


def polar_orthotropic(r, inner, outer, inside, along, across, poisson):
    """sigma_rr, sigma_tt and u in plane stress of a ring whose moduli differ along the radius and across it, under a
    pressure inside; poisson is the contraction across under tension along (S. G. Lekhnitskii, Anisotropic Plates,
    section 24): u = A r^k + B r^-k with k^2 = across/along."""
    r = np.asarray(r, float)
    k, back = np.sqrt(across / along), poisson * across / along
    factor = along / (1 - poisson * back)
    radial, hoop = (lambda s, m: factor * (m + back) * s**(m - 1)), (lambda s, m: factor * across / along
                                                                      * (1 + m * poisson) * s**(m - 1))
    a, b = np.linalg.solve([[radial(inner, k), radial(inner, -k)], [radial(outer, k), radial(outer, -k)]],
                           [-inside, 0.0])
    return (a * radial(r, k) + b * radial(r, -k), a * hoop(r, k) + b * hoop(r, -k), a * r**k + b * r**-k)


def main():
    hub, rim = (2.1e5, 0.3), (7.0e4, 0.33)
    pressure = press_fit(20.0, 40.0, 60.0, hub, rim, 0.05, "stress")
    print(f"pressure {pressure:.6f}")
    print("hoop stress at the bore, at the rim's inner and outer face:",
          *(f"{float(v):.6f}" for v in (cylinder(20.0, 20.0, 40.0, 0.0, pressure)[1],
                                        cylinder(40.0, 40.0, 60.0, pressure)[1],
                                        cylinder(60.0, 40.0, 60.0, pressure)[1])))
    print("u at the bore and outside:",
          *(f"{float(v):.9f}" for v in (
              displacement(20.0, *cylinder(20.0, 20.0, 40.0, 0.0, pressure), *hub, "stress"),
              displacement(60.0, *cylinder(60.0, 40.0, 60.0, pressure), *rim, "stress"))))


if __name__ == "__main__":
    main()
