"""The end of what a method printed: a method may print gigabytes, and a log keeps the last 64 kB of them."""

from collections import deque

KEPT = 64 * 1024


class Tail:
    """Takes pieces of bytes and keeps the last ``KEPT`` bytes."""

    def __init__(self) -> None:
        """Empty."""
        self._pieces: deque[bytes] = deque()
        self._held = 0
        self._dropped = 0

    def add(self, piece: bytes) -> None:
        """Appends ``piece`` and forgets what is older than the last ``KEPT`` bytes, whole pieces at a time."""
        piece, cut = piece[-KEPT:], max(0, len(piece) - KEPT)
        self._pieces.append(piece)
        self._held += len(piece)
        self._dropped += cut
        while self._held - len(self._pieces[0]) >= KEPT:
            gone = len(self._pieces.popleft())
            self._held -= gone
            self._dropped += gone

    def content(self) -> bytes:
        """What is kept, with a line in front where something is not; empty where nothing was printed."""
        text = b"".join(self._pieces)
        dropped = self._dropped + max(0, len(text) - KEPT)
        head = f"[{dropped} bytes before these are not kept]\n".encode() if dropped else b""
        return head + text[-KEPT:]
