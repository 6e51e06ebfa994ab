"""Small JSON messages over a socket, each after its length: what is asked, and the answer."""

import json
import socket
import struct
from typing import Any

LONGEST = 1 << 22  # bytes; a thousand extras with long names are far from it
_HEAD = struct.Struct(">I")


class BadMessage(Exception):  # noqa: N818 - not ours to mend
    """What came is no message: a method wrote into the channel."""


def framed(message: dict[str, Any]) -> bytes:
    """The bytes of a message."""
    body = json.dumps(message).encode()
    return _HEAD.pack(len(body)) + body


class Inbox:
    """Puts messages together from the pieces in which they come."""

    def __init__(self) -> None:
        """Nothing came yet."""
        self._held = bytearray()

    def add(self, piece: bytes) -> dict[str, Any] | None:
        """The message that ``piece`` completes, None where it is not whole yet. Raises ``BadMessage``."""
        self._held += piece
        if len(self._held) < _HEAD.size:
            return None
        (length,) = _HEAD.unpack(self._held[: _HEAD.size])
        if length > LONGEST or len(self._held) > _HEAD.size + length:
            raise BadMessage
        if len(self._held) < _HEAD.size + length:
            return None
        body = bytes(self._held[_HEAD.size :])
        self._held.clear()
        try:
            message = json.loads(body)
        except ValueError:
            raise BadMessage from None
        if not isinstance(message, dict):
            raise BadMessage
        return message


def receive(channel: socket.socket) -> dict[str, Any] | None:
    """Waits for the next message; None where the other side has gone."""
    inbox = Inbox()
    while piece := channel.recv(1 << 16):
        message = inbox.add(piece)
        if message is not None:
            return message
    return None
