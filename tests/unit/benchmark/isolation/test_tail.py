"""A log keeps the end of what was printed, however it came and however much it was."""

import pytest

from benchmark.isolation.tail import KEPT, Tail


@pytest.mark.parametrize("piece", [1, 7, 1000, KEPT, KEPT + 1, 10 * KEPT])
def test_the_last_bytes_are_kept_in_pieces_of_any_size(piece: int) -> None:
    everything = bytes(i % 251 for i in range(3 * KEPT + 12345))
    tail = Tail()
    for start in range(0, len(everything), piece):
        tail.add(everything[start : start + piece])
    head, _, kept = tail.content().partition(b"\n")
    assert kept == everything[-KEPT:]
    assert head == f"[{len(everything) - KEPT} bytes before these are not kept]".encode()


def test_little_is_kept_whole_and_nothing_is_empty() -> None:
    tail = Tail()
    assert tail.content() == b""
    tail.add(b"one\n")
    tail.add(b"two\n")
    assert tail.content() == b"one\ntwo\n"
    tail.add(b"x" * (KEPT - 8))
    assert tail.content() == b"one\ntwo\n" + b"x" * (KEPT - 8)


def test_a_gigabyte_takes_no_memory() -> None:
    tail = Tail()
    piece = b"y" * (1 << 20)
    for _ in range(1024):
        tail.add(piece)
    assert sum(map(len, tail._pieces)) <= 2 * KEPT
