"""Makes sensors see what ``scenes`` describes. The only package that knows Mitsuba."""
