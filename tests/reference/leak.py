"""A mass on a muscle behind a resistor with a leak, by the implicit Runge-Kutta method Radau IIA of order 5 of scipy.

    pip install scipy && python leak.py

Prints displacement in mm, velocity in mm/ms and charge in mC after 30 ms, and what the source supplied and resistor and leak took in mJ.
Units are g, mm, ms, N, V, mC. The muscle is that of `tests/motion/maxwell.rs` with the circuit of `tests/motion/leakage.rs`.
"""

import numpy as np
from scipy.integrate import solve_ivp

LENGTH, SECTION, MODULUS, LAYER, MASS = 40.0, 100.0, 0.1, 0.05, 20.0
PERMITTIVITY = 3.0 * 8.8541878128e-12
C0 = PERMITTIVITY * SECTION * LENGTH / LAYER**2
SERIES, LEAK = 6.0 / C0, 18.0 / C0
VOLTAGE = 0.7 * LAYER * np.sqrt(MODULUS / PERMITTIVITY)


def rate(t, y):
    x, v, q, *_ = y
    stretch = 1.0 + x / LENGTH
    across = q * stretch**2 / C0
    electric = q * q / C0 * stretch / LENGTH
    force = -SECTION * MODULUS * (stretch - stretch**-2) - electric
    source = (VOLTAGE - across) / SERIES
    leak = across / LEAK
    return [v, force / MASS, source - leak, VOLTAGE * source, SERIES * source**2, LEAK * leak**2]


end = solve_ivp(rate, (0.0, 30.0), np.zeros(6), method="Radau", rtol=1e-12, atol=1e-14).y[:, -1]
print(" ".join(f"{value:.12g}" for value in end))
