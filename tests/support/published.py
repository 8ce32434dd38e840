"""Published figures of the falling disk (case 1 of arXiv:2402.19093), with their sources."""

import numpy as np

# Digitised from the figures, (time [s], velocity [cm/s]); reading error 1-2 % of the axis.
KOBLITZ_2017 = np.array(  # Koblitz, Lovett, Nikiforakis, Henshaw, J. Comput. Phys. 343 (2017) 414, figure 6b
    [(0.0306, -1.892), (0.0518, -2.727), (0.0800, -3.590), (0.1152, -4.338), (0.1775, -5.040)]
    + [(0.2798, -5.430), (0.3832, -5.540), (0.4866, -5.579), (0.5900, -5.591), (0.6934, -5.515)]
)
GLOWINSKI_2001 = np.array(  # Glowinski, Pan, Hesla, Joseph, Périaux, J. Comput. Phys. 169 (2001) 363
    [(0.0115, -1.017), (0.0220, -1.675), (0.0429, -2.591), (0.0639, -3.393), (0.0767, -3.736), (0.0977, -4.237)]
    + [(0.1223, -4.652), (0.1574, -4.995), (0.1761, -5.138), (0.2347, -5.351), (0.2570, -5.408), (0.3109, -5.493)]
    + [(0.3555, -5.535), (0.4212, -5.520), (0.5233, -5.575), (0.5901, -5.574), (0.6230, -5.559), (0.6546, -5.544)]
    + [(0.6664, -5.501), (0.6863, -5.458)]
)
TERMINAL_SPEED = 5.59
HIGHEST_REYNOLDS = 17.46  # P2-P1 body-fitted, with the solid's density; Wan & Turek 2006: 17.42
WEIGHT = (1.25 - 1.0) * np.pi * 0.125**2 * 981.0
