"""Methods in a process of their own: whatever one does, its answers are rows and the others go on.

It guards against accidents and honest mistakes, not against an adversary, who shares the user's account and can read what the
user can read.
"""
