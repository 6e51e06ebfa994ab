"""The scenario of the tests' small studies: the paper's fly-around in a small picture. Each adds its own ``[scenario]`` numbers."""

FLY_AROUND = """
[scenario.cameras.nav]
base = "guppy-f125b"
width_px = 640
height_px = 128

[scenario.lights]
sun = "sun"

[scenario.motion]
type = "axis-sweep"
axis = "y"
start_deg = 20.0
rate_deg_s = 1.0
range_m = 100.0
"""
