"""Cauchy stress of isochoric laws at one deformation by FElupe 11.3.0, for tests/derivatives/hexahedron_laws.rs.

Isochoric energies of FElupe (mooney_rivlin, yeoh) by automatic differentiation, beside K/2 ln^2 J; moduli in MPa.
"""

import felupe as fem
import numpy as np
import tensortrax.math as tm

MU, LAMBDA = 1.3, 2.9
BULK = LAMBDA + 2 / 3 * MU
F = np.array([[1.3, 0.2, -0.1], [0.1, 0.8, 0.3], [-0.2, 0.1, 1.1]])


def with_volume(law, **constants):
    def energy(C):
        return law(C, **constants) + BULK / 8 * tm.log(tm.linalg.det(C)) ** 2

    return fem.Hyperelastic(energy)


SHARE = 0.3
LAWS = {
    "Mooney and Rivlin": with_volume(
        fem.mooney_rivlin, C10=MU / 2 * (1 - SHARE), C01=MU / 2 * SHARE
    ),
    "Yeoh": with_volume(fem.yeoh, C10=MU / 2, C20=-0.3, C30=0.2),
}
for name, law in LAWS.items():
    P = law.gradient([F.reshape(3, 3, 1, 1), None])[0].reshape(3, 3)
    print(name, np.array2string(P @ F.T / np.linalg.det(F), precision=15, separator=", "))
