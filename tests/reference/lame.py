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


def hot_fit(radii, tubes, temperatures, gap, open_law, closed_law, plane):
    """One tube in another, heat from the bore to the outside: gap, pressure, conductance, flux at the face, and the
    temperatures of both faces.

    radii are those of the bore, the face and the outside; a tube is (E, nu, alpha, k); temperatures are those of the bore
    and of the outside, above the natural state, in which the tubes are `gap` apart (negative: they overlap). Laws are
    functions of the gap and of the pressure; s is a gap where it is positive, else an overlap that pressure takes up.
    """
    inner, face, outer = radii
    hub, rim = tubes
    give = (wall_compliance(inner, face, face, hub[0], hub[1], plane)
            + wall_compliance(face, outer, face, rim[0], rim[1], plane))

    def state(s):
        omega = open_law(s) if s > 0 else closed_law(-s / give)
        resistances = face * np.log(face / inner) / hub[3], 1 / omega, face * np.log(outer / face) / rim[3]
        flux = (temperatures[0] - temperatures[1]) / sum(resistances)
        return omega, flux, (temperatures[0] - flux * resistances[0], temperatures[1] + flux * resistances[2])

    def excess(s):
        _, _, (inside, outside) = state(s)
        hub_grows = hot_tube(face, inner, face, temperatures[0], inside, *hub[:3], plane)[3]
        rim_grows = hot_tube(face, face, outer, outside, temperatures[1], *rim[:3], plane)[3]
        return s - (gap + rim_grows - hub_grows)

    low, high = -face, face
    while low < (middle := (low + high) / 2) < high:
        low, high = (middle, high) if excess(middle) < 0 else (low, middle)
    return max(middle, 0.0), max(-middle, 0.0) / give, *state(middle)


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
