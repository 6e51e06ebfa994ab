"""A small exact renderer for tests: convex boxes under a distant sun, exact area coverage, PSF, shot and read noise.

It shares no line with the product. Every visible or lit region is a convex polygon minus convex polygons, and its
coverage of each pixel is integrated exactly (signed areas under the edges), so that an edge in the picture stands where
the projected edge stands, to rounding.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

CAMERA = (2133.3333333333335, 645.5, 481.5, 1292, 964)  # f, cx, cy, width, height
SUN_PAPER = np.array([0.8, 0.35, 0.5]) / np.linalg.norm([0.8, 0.35, 0.5])
CV_FROM_PAPER = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]])
BLACK_DN, ELECTRONS_PER_DN, READ_NOISE_E, PSF_SIGMA_PX = 6.0, 25.0, 10.0, 0.5
WING_INNER_M, WING_OUTER_M, HALF_M, THICKNESS_M = 2.0, 12.0, 1.5, 0.06
RANGE_M = 100.0
FEATURES = {  # centre, length, width, gap, free standing
    "face": ((HALF_M, 0.0, 0.0), 3.0, 3.0, None, False),
    "wing": ((THICKNESS_M / 2, 7.0, 0.0), 10.0, 3.0, None, True),
    "span": ((THICKNESS_M / 2, 0.0, 0.0), 24.0, 3.0, (10 / 24, 14 / 24), True),
}


@dataclass(frozen=True)
class Box:
    low: np.ndarray
    high: np.ndarray
    dn: float  # signal of the surface under normal incidence

    def vertices(self):
        pick = np.array(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij")).reshape(3, -1).T
        return np.where(pick == 1, self.high, self.low)

    def faces(self):
        """(outward normal, four corners in order) of the six faces."""
        for axis in range(3):
            for sign in (-1, 1):
                normal = np.zeros(3)
                normal[axis] = sign
                b, c = [i for i in range(3) if i != axis]
                corners = np.tile(self.high if sign > 0 else self.low, (4, 1)).astype(float)
                corners[:, b] = np.array([self.low[b], self.high[b], self.high[b], self.low[b]])
                corners[:, c] = np.array([self.low[c], self.low[c], self.high[c], self.high[c]])
                yield normal, corners


def boxes():
    """−Y wing, its yokes, cube, +Y yokes, +Y wing: in the order of y, so that y = const planes part them."""

    def box(low, high, dn):
        return Box(np.array(low, float), np.array(high, float), dn)

    t, i, o, h = THICKNESS_M / 2, WING_INNER_M, WING_OUTER_M, HALF_M
    yokes = [[box((-t, side[0], z - t), (t, side[1], z + t), 110.0) for z in (-0.8, 0.8)] for side in ((-i, -h), (h, i))]
    return [
        [box((-t, -o, -h), (t, -i, h), 120.0)],
        yokes[0],
        [box((-h, -h, -h), (h, h, h), 190.0)],
        yokes[1],
        [box((-t, i, -h), (t, o, h), 120.0)],
    ]


def pose(case, theta_rad):
    """Rotation cam_from_target of the paper's case 1 (about Y: θ2) or 2 (about Z: θ1); passive angles, OpenCV axes."""
    axis = [0, 1, 0] if case == 1 else [0, 0, 1]
    return Rotation.from_matrix(CV_FROM_PAPER @ Rotation.from_rotvec(-theta_rad * np.array(axis, float)).as_matrix())


def corners_px(rotation, feature, position_m=(0.0, 0.0, RANGE_M)):
    """Projected corners P1..P4 of a named feature, (4, 2) pixels."""
    centre, length, width, _, _ = FEATURES[feature]
    signs = np.array([(-1, -1), (1, -1), (-1, 1), (1, 1)])
    local = np.column_stack([np.zeros(4), signs[:, 0] * length / 2, signs[:, 1] * width / 2]) + centre
    return _project(rotation.apply(local) + np.asarray(position_m))


def render(rotation, seed=None, distort=None, position_m=(0.0, 0.0, RANGE_M), bits=8):
    """The picture of the target, seeded noise if ``seed`` is given, else the rounded expectation."""
    signal = signal_dn(rotation, position_m=position_m)
    return expose(signal if distort is None else distort(signal), seed, bits)


def signal_dn(rotation, sun_paper=SUN_PAPER, position_m=(0.0, 0.0, RANGE_M)):
    """What falls on the sensor, in 8-bit DN above black."""
    signal = np.zeros((CAMERA[4], CAMERA[3]))
    sun_target = rotation.inv().apply(CV_FROM_PAPER @ sun_paper)
    eye_target = rotation.inv().apply(-np.asarray(position_m))

    def project(points_target):
        return _project(rotation.apply(points_target) + np.asarray(position_m))

    groups = boxes()
    order = np.argsort([_gap(group, eye_target[1]) for group in groups])
    in_front = []
    for index in order:
        for box in groups[index]:
            _paint(signal, box, project, sun_target, eye_target, in_front, groups)
        in_front += [_hull(project(box.vertices())) for box in groups[index]]
    return cv2.GaussianBlur(signal, (9, 9), PSF_SIGMA_PX)


def _gap(group, y):
    low, high = group[0].low[1], group[0].high[1]
    return 0.0 if low <= y <= high else min(abs(y - low), abs(y - high))


def _paint(signal, box, project, sun_target, eye_target, in_front, groups):
    for normal, corners in box.faces():
        cosine = normal @ sun_target
        if normal @ (eye_target - corners[0]) <= 0 or cosine <= 0:
            continue
        polygon = project(corners)
        shadows = [
            project(shadow)
            for group in groups
            for other in group
            if other is not box and (shadow := _shadow(other, normal, corners, sun_target)) is not None
        ]
        _add(signal, _hull(polygon), [_hull(s) for s in shadows] + in_front, box.dn * cosine)


def _shadow(caster, normal, corners, sun):
    """Outline of the caster's part in front of the plane, thrown along −sun onto it; None without such a part."""
    points = caster.vertices()
    height = (points - corners[0]) @ normal
    kept = [p for p, h in zip(points, height, strict=True) if h > 1e-9]
    for i in range(8):
        for j in range(i):
            if height[i] * height[j] < 0:
                kept.append(points[i] + (points[j] - points[i]) * height[i] / (height[i] - height[j]))
    if len(kept) < 3:
        return None
    kept = np.array(kept)
    thrown = kept - ((kept - corners[0]) @ normal / (sun @ normal))[:, None] * sun
    flat = thrown[:, np.abs(normal) < 0.5]
    if np.ptp(flat, axis=0).min() < 1e-6:
        return None
    return thrown[ConvexHull(flat).vertices]


def _project(points_cam):
    f, cx, cy, *_ = CAMERA
    return points_cam[:, :2] / points_cam[:, 2:] * f + [cx, cy]


def _hull(points):
    return points[ConvexHull(points).vertices]


def _add(signal, polygon, removed, value):
    """Adds value × coverage(polygon minus the union of the removed convex polygons), by inclusion and exclusion."""
    if len(polygon) < 3:
        return
    _accumulate(signal, polygon, value)
    for i, other in enumerate(removed):
        part = _clip(polygon, other)
        if len(part) >= 3:
            _add(signal, part, removed[i + 1 :], -value)


def _clip(polygon, window):
    """Sutherland-Hodgman; both convex and counter-clockwise."""
    for a, b in zip(window, np.roll(window, -1, axis=0), strict=True):
        side = (b[0] - a[0]) * (polygon[:, 1] - a[1]) - (b[1] - a[1]) * (polygon[:, 0] - a[0])
        kept = []
        for i in range(len(polygon)):
            j = (i + 1) % len(polygon)
            if side[i] >= 0:
                kept.append(polygon[i])
            if (side[i] >= 0) != (side[j] >= 0):
                kept.append(polygon[i] + (polygon[j] - polygon[i]) * side[i] / (side[i] - side[j]))
        polygon = np.array(kept).reshape(-1, 2)
        if len(polygon) < 3:
            break
    return polygon


def _accumulate(signal, polygon, value):
    corner = polygon + 0.5  # pixel i covers [i − ½, i + ½]
    x0, y0 = np.floor(corner.min(axis=0)).astype(int) - 1
    x1, y1 = np.ceil(corner.max(axis=0)).astype(int) + 2
    area = np.zeros((y1 - y0, x1 - x0))
    for p, q in zip(corner - [x0, y0], np.roll(corner - [x0, y0], -1, axis=0), strict=True):
        cuts = [np.array([0.0, 1.0])]
        for axis in (0, 1):
            if p[axis] != q[axis]:
                low, high = sorted((p[axis], q[axis]))
                cuts.append((np.arange(np.ceil(low), np.floor(high) + 1) - p[axis]) / (q[axis] - p[axis]))
        t = np.unique(np.clip(np.concatenate(cuts), 0, 1))
        points = p + t[:, None] * (q - p)
        middle, rise = (points[1:] + points[:-1]) / 2, np.diff(points[:, 1])
        cell = np.floor(middle).astype(int)
        np.add.at(area, (cell[:, 1], cell[:, 0]), rise * (cell[:, 0] + 1 - middle[:, 0]))
        np.add.at(area, (cell[:, 1], cell[:, 0] + 1), rise * (middle[:, 0] - cell[:, 0]))
    coverage = np.cumsum(area, axis=1)
    coverage *= np.sign(coverage.sum()) or 1.0
    signal[y0:y1, x0:x1] += value * coverage


def expose(signal, seed=None, bits=8):
    """The picture of a signal: shot and read noise about the target if ``seed`` is given, black level, rounding."""
    rows, columns = (slice(max(i.min() - 40, 0), i.max() + 41) for i in np.nonzero(signal > 1e-3))
    finer = (2**bits - 1) / 255  # of the same full scale
    picture = np.full(signal.shape, BLACK_DN * finer).astype(np.uint8 if bits == 8 else np.uint16)
    electrons = np.clip(signal[rows, columns], 0, None) * ELECTRONS_PER_DN
    if seed is not None:
        rng = np.random.default_rng(seed)
        electrons = rng.poisson(electrons) + rng.normal(0, READ_NOISE_E, electrons.shape)
    picture[rows, columns] = np.clip(np.rint((electrons / ELECTRONS_PER_DN + BLACK_DN) * finer), 0, 2**bits - 1)
    return picture
