"""Lighting studies: one thing is changed at a time, all else equal, and what methods make of it."""
