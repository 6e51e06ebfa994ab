"""Guess the pose from what was seen. Never sees Truth."""
