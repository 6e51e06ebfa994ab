"""How well anybody could estimate the pose from a frame: the Cramér-Rao bound from the rendered picture or scan."""

SAMPLES = 64  # of a pixel in each rendering, where nobody says otherwise
