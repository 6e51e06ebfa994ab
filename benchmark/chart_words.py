"""Numbers and sentences that stand beside charts."""

import numpy as np
import pandas as pd

from benchmark.chart_frames import Quantity, by_method
from benchmark.chart_stats import quantile

NONE = "–"  # no such number: the frames it falls on have no answer


def amount(value: float) -> str:
    """Three significant figures; a dash for what is not finite."""
    return f"{value:.3g}" if np.isfinite(value) else NONE


def percent(share: float) -> str:
    """A share as a percentage; "100 %" and "0 %" only where it is all or nothing."""
    text = f"{100 * share:.1f}".removesuffix(".0")
    if text in ("100", "0") and share not in (0.0, 1.0):
        text = "> 99.9" if text == "100" else "< 0.1"
    return f"{text} %"


def told(frames: pd.DataFrame, quantity: Quantity, places: dict[str, int]) -> str:
    """Each method's answered share and median in words."""
    parts = []
    for title, _, part in by_method(frames, places):
        errors = part[quantity.column].to_numpy(dtype=np.float64)
        middle = quantile(errors, 0.5)
        known = np.isfinite(middle)
        median = f"median {amount(middle)} {quantity.unit}" if known else "no median, since most frames have no answer"
        parts.append(f"{title}: {percent(float(np.isfinite(errors).mean()))} of {errors.size} frames answered, {median}")
    return "; ".join(parts) + "."
