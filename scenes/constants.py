"""Physical constants: value, unit in the name, source in the comment."""

SPEED_OF_LIGHT_M_S = 299_792_458.0  # SI, exact
PLANCK_J_S = 6.626_070_15e-34  # SI, exact
SOLAR_CONSTANT_W_M2 = 1366.1  # ASTM E490-00a, total irradiance at 1 au
SUN_HALF_ANGLE_DEG = 0.2666  # IAU 2015 B3 nominal solar radius 6.957e8 m seen from 1 au
BOLTZMANN_J_K = 1.380_649e-23  # SI, exact
EARTH_RADIUS_M = 6.371_0e6  # mean radius, IUGG
