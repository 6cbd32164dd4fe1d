"""A band of heat that moves over the face of a half-space, after Jaeger: long after its start.

J. C. Jaeger, Proc. R. Soc. N. S. W. 76 (1942) 203: with the speed v, the half-width b, the
conductivity k, the diffusivity kappa and the flux q, the temperature of the face at the distance x
ahead of the middle of the band is

    T = q/(pi k) int_-b^b exp(-v (x - s)/(2 kappa)) K0(v |x - s|/(2 kappa)) ds
"""

from math import pi

import numpy as np
from scipy.integrate import quad
from scipy.special import k0


def face_temperature(ahead, half, speed, flux, conductivity, diffusivity):
    """Return the rise of temperature of the face at a distance ahead of the middle of the band."""
    def source(x):
        argument = speed * (ahead - x) / (2 * diffusivity)
        return np.exp(-argument) * k0(abs(argument))

    inside = [ahead] if -half < ahead < half else None
    return flux / (pi * conductivity) * quad(source, -half, half, limit=400, points=inside)[0]
