"""Compares the guess with the truth."""
