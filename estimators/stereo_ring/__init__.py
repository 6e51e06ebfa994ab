"""Docking ring and markers in two views: Shu, Pei, Ding, Duan & Zhou 2020 as printed, and our own method."""
