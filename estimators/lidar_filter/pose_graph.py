"""Poses of keyframes from registrations of pairs: all of them at once, so that a loop's misclosure is spread over the loop.

Open3D's multiway registration: Choi, Zhou & Koltun 2015, "Robust reconstruction of indoor scenes", whose line process takes
pairs out that contradict the rest.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from scenes.arrays import Floats


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """A pair of keyframes laid over each other: ``onto_from_of``, of keyframe ``of`` in the axes of keyframe ``onto``.

    ``information`` (6, 6): inverse covariance of the rotation vector and shift by which the true pose differs, axes of ``of``,
    true = measured · exp. ``is_loop``: whether it joins keyframes that were not known to lie beside each other.
    """

    of: int
    onto: int
    onto_from_of: RigidTransform
    information: Floats
    is_loop: bool


def settled(own_from_keys: Sequence[RigidTransform], links: Sequence[Link], believed_m: float) -> list[RigidTransform]:
    """The poses that all links agree on best; the first stays. Loops worse than about ``believed_m`` are left out."""
    import open3d as o3d

    graphs = o3d.pipelines.registration
    graph = graphs.PoseGraph()
    for pose in own_from_keys:
        graph.nodes.append(graphs.PoseGraphNode(pose.as_matrix()))
    for link in links:
        matrix = link.onto_from_of.as_matrix()
        graph.edges.append(graphs.PoseGraphEdge(link.of, link.onto, matrix, link.information, link.is_loop))
    option = graphs.GlobalOptimizationOption(
        max_correspondence_distance=believed_m, edge_prune_threshold=0.25, preference_loop_closure=1.0, reference_node=0
    )
    threads = o3d.utility.get_max_threads()
    o3d.utility.set_max_threads(1)
    try:
        with o3d.utility.VerbosityContextManager(o3d.utility.VerbosityLevel.Error):
            method = graphs.GlobalOptimizationLevenbergMarquardt()
            graphs.global_optimization(graph, method, graphs.GlobalOptimizationConvergenceCriteria(), option)
    finally:
        o3d.utility.set_max_threads(threads)
    moved = [RigidTransform.from_matrix(np.asarray(node.pose)) for node in graph.nodes]
    gauge = own_from_keys[0] * moved[0].inv()
    return [gauge * pose for pose in moved]


def information_of(covariance: Floats, onto_from_of: RigidTransform) -> Floats:
    """Information (6, 6) of a link from its covariance: rotation vector in axes of ``of``, its origin in ``onto``."""
    turn = np.eye(6)
    turn[3:, 3:] = onto_from_of.rotation.as_matrix().T
    return np.asarray(np.linalg.inv(turn @ covariance @ turn.T))
