"""Files that begin with the digest of all that follows, so that damage and edits are known before anything is read."""

from __future__ import annotations

import hashlib
import io

BLOCK = 512
"""Bytes before the content, which HDF5 leaves to others (its user block)."""

_NAME = b"rigidfluid sha256 "


def seal(image: io.BytesIO) -> None:
    """Write the digest of what follows into the first block of an ``image``."""
    with image.getbuffer() as data:
        data[:BLOCK] = (_NAME + _digest(data[BLOCK:])).ljust(BLOCK, b"\0")


def is_sealed(data: bytes) -> bool:
    """Tell whether a file begins with a digest, right or wrong."""
    return data.startswith(_NAME)


def is_intact(data: bytes) -> bool:
    """Tell whether a sealed file is to the last bit as it was written."""
    return data[:BLOCK] == (_NAME + _digest(memoryview(data)[BLOCK:])).ljust(BLOCK, b"\0")


def _digest(data: memoryview) -> bytes:
    return hashlib.sha256(data).hexdigest().encode()
