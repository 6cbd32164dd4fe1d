"""Two rods between walls: those with known answers, ever steeper laws, and rods at random."""

from random import Random

from rod_runs import Case
from test_known_rods import RODS

import rods

LAWS = {"r1": (0.15, 1e-5), "r1b": (0.15, 1e-5), "r2": (0.001, 1e-6)}   # a, b
OF_R3 = 0.005, 1e-5
STARTS = {"r3-open": 50.0, "r3-middle": 320.0, "r3-closed": 700.0}
SEED, COUNT = 1987, 200   # of the random rods, but where laws jump
JUMPING = 10_000
# Of these, where Newton's method alone comes to no end, and a path does.
HARD = (
    261, 409, 659, 749, 891, 1031, 1295, 1304, 1448, 1469, 1479, 1539, 1838, 2062, 2103,
    2407, 2629, 2844, 2931, 3180, 3385, 3750, 4416, 4473, 4555, 4620, 4674, 4853, 5289,
    5347, 5526, 5841, 5865, 5918, 5978, 6045, 6414, 6654, 7004, 7118, 7436, 7615, 7650,
    7655, 7949, 8035, 8422, 8827, 8846, 9139, 9379, 9443, 9683, 9706)


def known_case(name):
    """Return one of the rods of input/rods."""
    a, b = LAWS.get(name, OF_R3)
    return Case(RODS[name][0], a, b, a / b, 1e-4, 1e-11, STARTS.get(name))


def steep_cases(kept, factor):
    """Return R1, R1b and R2 with B down to 1e-14; the closed law begins at a multiple of A/B."""
    cases = []
    for name, (a, b) in LAWS.items():
        for exponent in (-8, -10, -12, -14):
            steep = 10.0**exponent
            amount = a if kept == "A" else a / b * steep
            # Pairs that rest must not part; where none does, stout rods round less.
            cases.append(Case(RODS[name][0], amount, steep, amount / steep * factor, 1e-4,
                              slender=2 if factor == 1.0 else 16))
    return cases


def random_case(draw, jumps):
    """Return rods at random, or None where the data are not those of a pair of rods."""
    def power(low, high):
        return 10.0 ** draw.uniform(low, high)

    length = power(-1, 1)
    both = rods.Rods((length, length * power(-0.5, 0.5)), (power(-1, 2.5), power(-1, 2.5)),
                     tuple(draw.choice((0, 1, 1, 1)) * power(-7, -4) for _ in range(2)),
                     (power(8, 12), power(8, 12)),
                     (draw.uniform(-1000, 1000), draw.uniform(-1000, 1000)), 0.0)
    reach = max(abs(both.separation(both.flux(omega))) for omega in (0.0, 1e300))
    if reach == 0.0:
        return None
    touch, b = power(-2, 4) / both.resistance, reach * power(-7, 0)
    c = touch * both.compliance / reach * power(-3, 3)
    at = draw.choice((1, 1, -1)) * reach * power(-8, 0)   # a state that is to be a solution
    omega = touch * b / (b + at) if at > 0 else touch - c * at / both.compliance
    gap = at - both.separation(both.flux(omega))
    if draw.random() < 0.3:
        gap = reach * power(-3, 1)
    both = rods.Rods(both.length, both.conductivity, both.expansion, both.young, both.temperature,
                     gap)
    jump = power(-3, 3) if jumps else 1.0
    return Case(both, touch * b, b, touch * jump, c) if gap > 0.0 else None


def random_cases(jumps, count):
    """Return random rods whose data settle their solutions: none within 5 % of a turning point or
    wrong by more than 1e-5 through rounding."""
    draw, cases = Random(SEED), []
    while len(cases) < count:
        case = random_case(draw, jumps)
        if case and all(abs(1 - one.gain) > 0.05 and case.allowed(one) < 1e-5
                        for one in case.solutions()):
            cases.append(case)
    return cases
