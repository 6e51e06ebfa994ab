"""Where a pixel's samples fall: spread evenly, not thrown, so that their mean converges faster than at random.

Place in the pixel, point of the light and direction in a surface's lobe each follow a two-dimensional net of their own, shifted
and shuffled at random for every pixel (padded nets, Kollig & Keller 2002): the shift takes the bias away, and the shuffle keeps
the nets from pairing up with each other.
"""

from typing import Any

_BITS = 10  # of the index: a pixel has at most 1024 samples
MOST_SAMPLES = 1 << _BITS
_TO_UNIT = 2.0**-24
_WORD = 0xFFFFFFFF  # where numbers are Python's own (scalar variants) they do not run over by themselves


def net_start(mi: Any, rng: Any) -> Any:
    """What makes one pixel's net its own (mi.Vector3u): two shifts and the seed of its shuffle."""
    return mi.Vector3u(rng.next_uint32(), rng.next_uint32(), rng.next_uint32())


def net(mi: Any, dr: Any, start: Any, index: Any) -> Any:
    """Point ``index`` (0..1)² of a pixel's net: any aligned 2^m of them fill every elementary interval once.

    The (0, 2)-sequence of Sobol (1967), by bit reversal and the sum of its generator's columns, with a digital shift.
    """
    x, y = mi.UInt32(start.x), mi.UInt32(start.y)
    shuffled = _shuffled(mi, index, start.z)
    for bit, column in enumerate(_COLUMNS):
        is_set = ((shuffled >> bit) & 1) == 1
        x ^= dr.select(is_set, mi.UInt32(1 << (31 - bit)), mi.UInt32(0))
        y ^= dr.select(is_set, mi.UInt32(column), mi.UInt32(0))
    return mi.Point2f(_unit(mi, x), _unit(mi, y))


def _shuffled(mi: Any, index: Any, seed: Any) -> Any:
    """``index`` with each bit turned over or not as the bits above it say (Owen's nested scrambling of the order).

    So aligned blocks of 2^m numbers stay aligned blocks of 2^m numbers.
    """
    result = mi.UInt32(0)
    for bit in range(_BITS):
        above = ((mi.UInt32(index) >> (bit + 1)) + mi.UInt32(seed) + mi.UInt32(bit * 0x9E3779B9 & _WORD)) & _WORD
        above = ((above ^ (above >> 16)) * mi.UInt32(0x7FEB352D)) & _WORD
        above = ((above ^ (above >> 15)) * mi.UInt32(0x846CA68B)) & _WORD
        flip = (above >> 31) & 1
        result |= (((mi.UInt32(index) >> bit) & 1) ^ flip) << bit
    return result


def _columns(count: int) -> tuple[int, ...]:
    """Columns of the second generator matrix (Pascal's triangle modulo two) as 32-bit fractions."""
    columns = [1 << 31]
    for _ in range(count - 1):
        columns.append(columns[-1] ^ (columns[-1] >> 1))
    return tuple(columns)


_COLUMNS = _columns(_BITS)


def _unit(mi: Any, whole: Any) -> Any:
    """A 32-bit whole number as a number in [0, 1) that float32 can hold."""
    return mi.Float(whole >> 8) * _TO_UNIT
