"""Attitude of a rectangle of unknown size from one picture: Zhai, Qu, Li & Chen 2014 (J. Harbin Inst. Technol. 46(3))."""
