"""How well anybody could estimate the pose from a frame: the Cramér-Rao bound from the rendered picture or scan."""
