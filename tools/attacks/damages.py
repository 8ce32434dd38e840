"""Damage to the bytes of a file: bits, cuts, wrong numbers, and what is no such file at all."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

from numpy.random import Generator

Damage = Callable[[bytes, Generator], bytes]

_WRONG = (
    b"999999999",
    b"-1",
    b"0",
    b"nan",
    b"inf",
    b"1e400",
    b"many",
    b"2147483648",
    b"18446744073709551615",
    b"1e-300",
)
_NUMBER = re.compile(rb"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
_WHOLE = re.compile(rb"(?<![\d.eE+-])\d+(?![\d.eE])")


def one_bit(data: bytes, random: Generator) -> bytes:
    """One bit is another."""
    return some_bits(data, random, 1)


def some_bits(data: bytes, random: Generator, count: int = 12) -> bytes:
    """Some bits are others."""
    damaged = bytearray(data)
    for place in random.integers(0, 8 * len(data), count):
        damaged[place // 8] ^= 1 << (place % 8)
    return bytes(damaged)


def some_bytes(data: bytes, random: Generator) -> bytes:
    """Some bytes are any."""
    damaged = bytearray(data)
    for place in random.integers(0, len(data), 12):
        damaged[place] = int(random.integers(0, 256))
    return bytes(damaged)


def a_letter(data: bytes, random: Generator) -> bytes:
    """One letter too many."""
    place = int(random.integers(0, len(data)))
    return data[:place] + bytes([int(random.integers(97, 123))]) + data[place:]


def cut_off(data: bytes, random: Generator) -> bytes:
    """The end is missing."""
    return data[: int(random.uniform(0.02, 0.99) * len(data))]


def a_hole(data: bytes, random: Generator) -> bytes:
    """A piece in the middle is missing."""
    begin, end = sorted(random.integers(0, len(data), 2))
    return data[:begin] + data[end:]


def zeros(data: bytes, random: Generator) -> bytes:
    """A piece is zero, as of a disk that was full."""
    begin = int(random.integers(0, len(data)))
    return data[:begin] + bytes(min(512, len(data) - begin)) + data[begin + 512 :]


def a_wrong_number(data: bytes, random: Generator) -> bytes:
    """A number is another, or four bytes of a binary one are."""
    return _replaced(data, random, list(_NUMBER.finditer(data)), _WRONG)


def a_huge_count(data: bytes, random: Generator) -> bytes:
    """A whole number among the first is huge."""
    return _replaced(data, random, list(_WHOLE.finditer(data))[:12], (b"999999999", b"99999999999999999999"))


def no_bytes(data: bytes, random: Generator) -> bytes:
    """An empty file."""
    return b""


def words(data: bytes, random: Generator) -> bytes:
    """Text of no kind."""
    return b"# Notes\n\nA file that somebody has called so by mistake.\n" * int(random.integers(1, 50))


def another_encoding(data: bytes, random: Generator) -> bytes:
    """The same text in UTF-16."""
    return data.decode("latin-1").encode("utf-16")


def noise(data: bytes, random: Generator) -> bytes:
    """Random bytes."""
    return bytes(random.bytes(max(len(data), 1000)))


DAMAGES: Mapping[str, tuple[Damage, ...]] = {
    "bits and bytes": (one_bit, some_bits, some_bytes, a_letter),
    "cut off, holes, zeros": (cut_off, a_hole, zeros),
    "wrong numbers and counts": (a_wrong_number, a_huge_count),
    "empty, text, noise, UTF-16": (no_bytes, words, noise, another_encoding),
}
"""Kinds of damage, by the words of a table."""


def _replaced(data: bytes, random: Generator, places: list[re.Match[bytes]], values: tuple[bytes, ...]) -> bytes:
    """One of the places holds one of the values."""
    binary = not places or (b"\0" in data and bool(random.integers(0, 2)))
    if binary:
        place = int(random.integers(0, max(len(data) - 4, 1)))
        return data[:place] + (b"\xff\xff\xff\x7f", b"\xff\xff\xff\xff")[int(random.integers(0, 2))] + data[place + 4 :]
    place = places[int(random.integers(0, len(places)))]
    return data[: place.start()] + values[int(random.integers(0, len(values)))] + data[place.end() :]
