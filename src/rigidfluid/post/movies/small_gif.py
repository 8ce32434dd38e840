"""Writer of GIFs of one palette, without dithering: flat colours then stay flat, and a file takes a fraction."""

from __future__ import annotations

from matplotlib.animation import PillowWriter
from PIL import Image

COLOURS = 64
"""Number of colours of the palette."""

_SAMPLES = 8
"""Number of pictures, spread over the movie, from which the palette is chosen."""


class SmallGifWriter(PillowWriter):
    """Matplotlib's writer of GIFs, with one palette for all pictures."""

    _frames: list[Image.Image]

    def finish(self) -> None:
        """Write the file."""
        palette = _palette(self._frames)
        dither = Image.Dither.NONE
        self._frames = [frame.convert("RGB").quantize(palette=palette, dither=dither) for frame in self._frames]
        super().finish()


def _palette(frames: list[Image.Image]) -> Image.Image:
    """Picture whose palette suits all ``frames``."""
    samples = frames[:: max(1, len(frames) // _SAMPLES)] + frames[-1:]
    width, height = samples[0].size
    together = Image.new("RGB", (width, height * len(samples)))
    for number, frame in enumerate(samples):
        together.paste(frame, (0, height * number))
    return together.quantize(colors=COLOURS, method=Image.Quantize.MAXCOVERAGE)
