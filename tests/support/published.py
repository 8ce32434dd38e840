"""Published figures of falling disks, with their sources: one (case 1 of arXiv:2402.19093), and two in a line."""

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


# Two disks of diameter .25 and density 1.5 in a box 2 × 6, viscosity .01, released at the heights 5 and 4.5: Glowinski,
# Pan, Hesla, Joseph, Périaux, J. Comput. Phys. 169 (2001) 363; (time [s], height [cm]) and (time [s], velocity [cm/s]).
PAIR_TRAILING_HEIGHT = np.array(
    [(0.0088, 4.982), (0.0280, 4.924), (0.0406, 4.830), (0.0548, 4.737), (0.0694, 4.608)]
    + [(0.0886, 4.398), (0.1024, 4.234), (0.1166, 4.047), (0.1273, 3.883), (0.1419, 3.637)]
    + [(0.1561, 3.380), (0.1706, 3.135), (0.1856, 2.912), (0.1998, 2.690), (0.2151, 2.433)]
    + [(0.2289, 2.211), (0.2435, 2.023)]
)
PAIR_TRAILING_VELOCITY = np.array(
    [(0.0164, -3.16), (0.0409, -6.82), (0.0627, -9.03), (0.0981, -11.60), (0.1133, -13.53)]
    + [(0.1336, -17.04), (0.1460, -18.03), (0.1581, -18.07), (0.1600, -16.57), (0.1604, -15.94)]
    + [(0.1608, -16.29), (0.1636, -15.54), (0.1998, -16.29), (0.2165, -15.70), (0.2333, -13.49)]
    + [(0.2492, -11.79)]
)
PAIR_LEADING_HEIGHT = np.array(
    [(0.0008, 4.503), (0.0169, 4.456), (0.0303, 4.409), (0.0445, 4.316), (0.0579, 4.199)]
    + [(0.0709, 4.082), (0.0859, 3.918), (0.0993, 3.766), (0.1116, 3.626), (0.1254, 3.474)]
    + [(0.1403, 3.298), (0.1549, 3.111), (0.1614, 3.029), (0.1679, 2.924), (0.1825, 2.702), (0.2002, 2.456)]
    + [(0.2178, 2.211), (0.2366, 2.035), (0.2496, 1.953)]
)
PAIR_LEADING_VELOCITY = np.array(
    [(0.0343, -5.96), (0.0475, -7.73), (0.0639, -9.35), (0.0872, -10.61), (0.1402, -11.95)]
    + [(0.1585, -12.70), (0.1612, -14.91), (0.1647, -15.38), (0.1873, -15.07), (0.1994, -14.48)]
    + [(0.2091, -13.18), (0.2313, -8.76), (0.2410, -7.46), (0.2461, -7.14)]
)
PAIR_KISSES = 0.159  # s, when the velocities of the published disks jump towards each other

# The same pair, each disk half of PAIR_OFFSET beside the line. When the two are at one height: Koblitz, Lovett,
# Nikiforakis, Henshaw, J. Comput. Phys. 343 (2017) 414; Uhlmann, J. Comput. Phys. 209 (2005) 448, figure 6a, digitised;
# Glowinski et al. 2001, digitised, whose offset is not known [s].
PAIR_OFFSET = 0.002
PAIR_OVERTAKES = {"Koblitz et al. 2017": 0.261, "Uhlmann 2005": 0.280, "Glowinski et al. 2001": 0.243}
PAIR_LEADING_ASIDE = np.array(  # Koblitz et al. 2017, figure 10a: (time [s], way of the leading disk aside [cm])
    [(0.1575, 0.0085), (0.1740, 0.0191), (0.1850, 0.0335), (0.1960, 0.0588), (0.2070, 0.1004), (0.2170, 0.1586)]
    + [(0.2278, 0.2455), (0.2366, 0.3330), (0.2466, 0.4485), (0.2541, 0.5404), (0.2615, 0.6291)]
)

# Xia, Connington, Rapaka, Yue, Feng & Chen, J. Fluid Mech. 625 (2009) 249: an ellipse in a channel that is four of its
# long axes a wide. Digitised, heights over a from the bottom of a channel of 28 a; it starts at 24 a.
ELLIPSE_PATH = np.array(  # (y/a, x/a)
    [(0.36, 1.993), (2.22, 2.009), (4.88, 1.985), (6.67, 1.992), (8.46, 1.982), (10.68, 1.934)]
    + [(12.76, 1.974), (14.15, 1.921), (15.82, 1.835), (17.37, 1.870), (18.71, 1.865), (19.65, 1.759)]
    + [(20.33, 1.625), (21.22, 1.501), (22.05, 1.510), (22.66, 1.622), (23.18, 1.751), (23.57, 1.885)]
    + [(23.98, 1.997)]
)
ELLIPSE_ANGLE = np.array(  # (y/a, angle/π)
    [(0.08, -0.0055), (1.83, 0.0021), (3.87, 0.0045), (5.69, -0.0018), (8.45, 0.0116), (11.20, -0.0161)]
    + [(13.23, 0.0193), (14.80, 0.0101), (16.49, -0.0333), (17.99, 0.0056), (19.23, 0.0538), (19.66, 0.0468)]
    + [(20.50, -0.0186), (21.26, -0.0714), (21.71, -0.0957), (22.24, -0.0736), (22.62, 0.0075), (22.99, 0.1218)]
    + [(23.45, 0.2110), (24.01, 0.2499)]
)
ELLIPSE_VELOCITY = np.array(  # (time [s], velocity [cm/s])
    [(0.005, -0.020), (0.035, -0.786), (0.065, -1.084), (0.098, -1.167), (0.129, -1.159), (0.173, -1.173)]
    + [(0.202, -1.227), (0.249, -1.277), (0.311, -1.281), (0.383, -1.281), (0.450, -1.297), (0.505, -1.301)]
    + [(0.575, -1.294), (0.646, -1.296), (0.761, -1.292), (0.879, -1.291), (0.974, -1.297)]
)
ELLIPSE_TERMINAL_SPEED = 1.295  # cm/s, about the level of the published points after .3 s; reading error 1-2 %


# A sphere of diameter 1.5 cm in silicone oil: ten Cate, Nieuwstad, Derksen, Van den Akker, Phys. Fluids 14 (2002) 4012,
# case E3 of Reynolds number 11.6; the highest speed [cm/s], measured, and by their lattice Boltzmann program.
SETTLING_SPEED, SETTLING_SPEED_BY_LATTICE = 8.727, 8.690


def brenner(gap: float, terms: int = 4000) -> float:
    """Force on a sphere that moves slowly onto a wall over 6πμrV, by gap over radius: Brenner, Chem. Eng. Sci. 16
    (1961) 242, doi:10.1016/0009-2509(61)80035-3."""
    a, n, weight = _brenner_terms(gap, terms)
    above = 2.0 * np.sinh((2 * n + 1) * a) + (2 * n + 1) * np.sinh(2.0 * a)
    below = 4.0 * np.sinh((n + 0.5) * a) ** 2 - ((2 * n + 1) * np.sinh(a)) ** 2
    return float(weight @ (above / below - 1.0))


def drag_of_approach(gap: float, terms: int = 4000) -> float:
    """Force on each of two equal spheres that move slowly onto each other over 6πμrV, by gap over radius; half-way
    between them is Brenner's plane without shear (1961, as above)."""
    a, n, weight = _brenner_terms(0.5 * gap, terms)
    above = 4.0 * np.cosh((n + 0.5) * a) ** 2 + ((2 * n + 1) * np.sinh(a)) ** 2
    below = 2.0 * np.sinh((2 * n + 1) * a) - (2 * n + 1) * np.sinh(2.0 * a)
    return float(weight @ (above / below - 1.0))


def _brenner_terms(height: float, terms: int) -> tuple[float, np.ndarray, np.ndarray]:
    """α of a plane at ``height`` over the radius below the sphere, the numbers n, and their weights in the series."""
    a, n = float(np.arccosh(1.0 + height)), np.arange(1, terms)
    n = n[(2 * n + 1) * a < 600.0]
    return a, n, 4.0 / 3.0 * np.sinh(a) * n * (n + 1) / ((2 * n - 1) * (2 * n + 3))


def torque_of_twist(gap: float) -> float:
    """Torque on a sphere that turns about the normal of a wall over 8πμr³ω, by gap over radius: Jeffery, Proc. Lond.
    Math. Soc. 14 (1915) 327, doi:10.1112/plms/s2_14.1.327."""
    a = float(np.arccosh(1.0 + gap))
    return float(np.sum((np.sinh(a) / np.sinh(np.arange(1, int(40.0 / a) + 2) * a)) ** 3))


# Slow flow through a square array of cylinders: force on a unit length of one over viscosity and mean velocity, by
# the share φ of the area. Sangani and Acrivos, Int. J. Multiphase Flow 8 (1982) 193, table 1, as quoted by Basilisk's
# test `cylinders`.
CYLINDER_ARRAY = {0.05: 15.56, 0.1: 24.83, 0.2: 51.53, 0.3: 102.90, 0.4: 217.89, 0.5: 532.55, 0.6: 1763.0, 0.7: 13520.0}
DENSE_CYLINDERS = {0.75: 126300.0}

# A simple cubic array of spheres: force over 6πμ, radius and mean velocity, by the share φ of the volume. Zick and
# Homsy, J. Fluid Mech. 115 (1982) 13, table 2, as quoted by Basilisk's test `spheres`.
SPHERE_ARRAY = {0.027: 2.008, 0.064: 2.810, 0.125: 4.292, 0.216: 7.442, 0.343: 15.4, 0.45: 28.1}

# A cylinder of the fluid's density and of diameter .25 in a square channel of side 1, which is periodic, ρ = 1: Pan and
# Glowinski, J. Comput. Phys. 181 (2002) 260, figure as digitised for `docs/source/examples/case2` of the repository
# EllipsesInFlows (N. Hori), with its viscosity and pressure gradient; (way along the channel, height).
MIGRATION_VISCOSITY, MIGRATION_GRADIENT = 1.0 / 2334.0, 2.337e-4
MIGRATION_PATH = np.array(
    [(0.03, 0.4000), (2.51, 0.3890), (5.00, 0.3628), (7.49, 0.3286), (10.01, 0.2948), (12.49, 0.2740)]
    + [(15.02, 0.2695), (17.50, 0.2702), (20.02, 0.2712), (22.51, 0.2714), (25.00, 0.2717), (27.52, 0.2719)]
    + [(30.00, 0.2721), (32.49, 0.2722), (35.01, 0.2722), (37.50, 0.2723), (40.02, 0.2723), (50.00, 0.2723)]
)

# The same array, settling without a mean flow: speed over that of a sphere alone, by the share φ. Sierou and Brady, J.
# Fluid Mech. 448 (2001) 115, figure 9, digitised; reading error .01.
SETTLING_ARRAY = {0.0267: 0.496, 0.0626: 0.358, 0.1244: 0.243, 0.2145: 0.160, 0.3420: 0.111}

# 72 disks of the fluid's density in a periodic channel, 16.9 % of its area, Re 1000: share of disks over the height.
# Chen, Pan and Chang, Phys. Fluids 24 (2012), as digitised for `docs/source/examples/case4` of EllipsesInFlows
# (N. Hori), thinned out.
DISK_SHARE = np.array(
    [(0.0002, 0.0007), (0.0437, 0.0032), (0.0734, 0.0187), (0.1015, 0.0633), (0.1175, 0.1069), (0.1289, 0.1524)]
    + [(0.1441, 0.1975), (0.1564, 0.2388), (0.1778, 0.2834), (0.2074, 0.2905), (0.2361, 0.2679), (0.2748, 0.2800)]
    + [(0.3104, 0.3217), (0.3619, 0.3583), (0.3958, 0.3590), (0.4249, 0.3198), (0.4463, 0.2739), (0.4748, 0.2292)]
    + [(0.5097, 0.2375), (0.5411, 0.2820), (0.5846, 0.3265), (0.6237, 0.3344), (0.6693, 0.3522), (0.7048, 0.3306)]
    + [(0.7413, 0.2989), (0.7697, 0.2782), (0.7996, 0.2862), (0.8277, 0.2712), (0.8481, 0.2267), (0.8642, 0.1821)]
    + [(0.8793, 0.1375), (0.8909, 0.0939), (0.9061, 0.0490), (0.9317, 0.0089), (0.9732, 0.0006), (0.9997, 0.0002)]
)

# Drag on a sphere in a power-law fluid over 3πK(v/d)ⁿ⁻¹dv, by the exponent n: Gu and Tanner, J. Non-Newtonian
# Fluid Mech. 17 (1985) 1. From memory: the paper was not at hand.
SPHERE_IN_POWER_LAW = {0.9: 1.140, 0.8: 1.240, 0.7: 1.320, 0.6: 1.382, 0.5: 1.420}


def cylinder_in_bingham_fluid(number: float) -> float:
    """Drag over τ_y d at a Bingham ``number``: Tokpavi, Magnin and Jay, J. Non-Newtonian Fluid Mech. 154 (2008) 65, as
    quoted in a test of Basilisk by A. Ghigo, a cylinder at different Bingham numbers."""
    return float(11.98 + 20.43 * number**-0.68)


def sphere_in_carreau_fluid(exponent: float, number: float) -> float:
    """Drag over 3πμ₀dv at a Carreau ``number`` 2λv/d, without inertia, to 14 % of measurements: Chhabra and Uhlherr,
    Rheol. Acta 19 (1980) 187. From memory, and as programs of others have it; the paper was not at hand."""
    return float(1.0 + 0.65 * (exponent - 1.0) * number**0.2)
