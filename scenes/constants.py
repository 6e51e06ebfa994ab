"""Physical constants: value, unit in the name, source in the comment."""

SPEED_OF_LIGHT_M_S = 299_792_458.0  # SI, exact
PLANCK_J_S = 6.626_070_15e-34  # SI, exact
SOLAR_CONSTANT_W_M2 = 1366.1  # ASTM E490-00a, total irradiance at 1 au
SUN_HALF_ANGLE_DEG = 0.2666  # IAU 2015 B3 nominal solar radius 6.957e8 m seen from 1 au
BOLTZMANN_J_K = 1.380_649e-23  # SI, exact
EARTH_RADIUS_M = 6.371_0e6  # mean radius, IUGG
EARTH_MU_M3_S2 = 3.986_004_418e14  # gravitational constant times mass, WGS 84
EARTH_EQUATOR_M = 6_378_137.0  # radius of the equator, WGS 84
EARTH_J2 = 1.082_626_68e-3  # second zonal harmonic, EGM 96
