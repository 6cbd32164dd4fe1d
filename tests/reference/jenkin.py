"""The Jenkin element in closed form: a spring in series with a Coulomb slider, driven by displacements."""


def path(displacements, stiffness, limit):
    """Return the force and the slip at the end of every move, from rest.

    The slider holds until the spring's force would exceed the limit; then it gives way by just so
    much that the force stays on the limit. Within a move the displacement goes one way.
    """
    forces, slips, slip = [], [], 0.0
    for displacement in displacements:
        force = stiffness * (displacement - slip)
        if abs(force) > limit:
            force = limit if force > 0.0 else -limit
            slip = displacement - force / stiffness
        forces.append(force)
        slips.append(slip)
    return forces, slips


def loop_work(amplitude, stiffness, limit):
    """Return what a closed cycle between +amplitude and -amplitude dissipates.

    The loop is a parallelogram of height 2 limit, and the slider goes there and back by
    2 (amplitude - limit/stiffness).
    """
    return 4.0 * limit * max(amplitude - limit / stiffness, 0.0)
