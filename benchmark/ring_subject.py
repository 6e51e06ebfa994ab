"""What a stereo method is judged on where it was told of a ring: the circle, the views that measure it, the names of its markers.

A method is not told which marker lies on the ring's X axis, so an answer that takes another marker for it is as good, as long as
the whole track keeps to one (``benchmark.symmetry``).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

from benchmark import symmetry
from benchmark.predictions import positions, rotations
from benchmark.records import KnowledgeRecord
from scenes.arrays import Floats
from scenes.dataset import Dataset
from scenes.features import CircleFeature, Feature, MarkerFeature

LABELLING = "markers"  # what a summary says of the equivalent attitudes of a ring
_ON_THE_AXIS_M = 1e-6  # a marker nearer to the ring's axis has no azimuth


@dataclass(frozen=True, slots=True, eq=False)
class RingSubject:
    """``views``: the name of a view (left, right) → its camera. ``labels``: the equivalent turns, in the target frame."""

    circle: CircleFeature
    views: Mapping[str, str]
    labels: Rotation

    def centres(self, table: pd.DataFrame) -> Floats:
        """(n, 3) the circle's centre in the sensor frame, metres, at the n poses of ``table``; NaN where it gives no pose."""
        found = np.full((len(table), 3), np.nan)
        posed = table["qw"].notna().to_numpy()
        if posed.any():
            found[posed] = rotations(table[posed]).apply(self.circle.centre_m) + positions(table[posed])
        return found

    @property
    def target_from_ring(self) -> Rotation:
        """The ring's axes (X towards its marker, Z outward normal) in the target frame."""
        return self.circle.target_from_feature.rotation


def subject_of(knowledge: KnowledgeRecord | None, dataset: Dataset) -> RingSubject | None:
    """The ring that a method was told of, None where it was told of a rectangle or of nothing."""
    circle = next((one for one in dataset.features if knowledge is not None and one.name == knowledge.feature), None)
    if not isinstance(circle, CircleFeature):
        return None
    labels = symmetry.ring_labels(circle.target_from_feature.rotation, _azimuths(circle, dataset.features))
    return RingSubject(circle, _views(knowledge, dataset), labels)


def _azimuths(circle: CircleFeature, features: tuple[Feature, ...]) -> Floats:
    """(n,) azimuths in radians of the target's markers in the ring's frame, from X towards Y."""
    centres = [one.centre_m for one in features if isinstance(one, MarkerFeature)]
    in_ring = circle.target_from_feature.inv().apply(np.array(centres).reshape(-1, 3))
    in_ring = in_ring[np.hypot(in_ring[:, 0], in_ring[:, 1]) > _ON_THE_AXIS_M]
    return np.arctan2(in_ring[:, 1], in_ring[:, 0])


def _views(knowledge: KnowledgeRecord | None, dataset: Dataset) -> dict[str, str]:
    """The cameras of the declared pair; of an outside method that declares none, those of the data set's only rig."""
    if knowledge is not None and knowledge.pair is not None:
        return {"left": knowledge.pair.left, "right": knowledge.pair.right}
    pairs = list(dataset.rigs.values())
    return {"left": pairs[0].left, "right": pairs[0].right} if len(pairs) == 1 else {}
