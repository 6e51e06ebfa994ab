"""Where samples lie when all pixels, or dots, are sampled alike: even, and centred."""

from typing import Any


def even_place(index: Any, count: int) -> tuple[Any, Any]:
    """Place (x, y), each in (0, 1), of sample ``index`` of ``count``, a power of two: Hammersley's points, moved to be centred.

    x = (i + ½) / n and y = (reversed bits of i + ½) / n: each column and each row of an n × n grid holds one, and the mean is
    (½, ½) exactly. A single sample lies in the middle. ``index``: a whole number, an array of them, or the device's.
    """
    bits = count.bit_length() - 1
    mirrored = index & 0
    for bit in range(bits):
        mirrored = mirrored | (((index >> bit) & 1) << (bits - 1 - bit))
    return (_real(index) + 0.5) / count, (_real(mirrored) + 0.5) / count


def _real(whole: Any) -> Any:
    """A whole number as one that can be halved: what runs on the device has no such conversion of its own."""
    return whole * 1.0
