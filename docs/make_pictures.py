"""Make the gallery's own pictures, of quick scenes without a page: run each, and keep the last picture of its movie.

``python docs/make_pictures.py NAME…`` makes those of some scenes, without names those of all.
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image
from site_tools.gallery import OWN, SCENES

import rigidfluid
from rigidfluid.post.movies.make_movie import Look, movie

SETTINGS = {
    "dry_bounce": ["time.end=0.03", "output.every=0.01", "time.step=1e-4"],
    "hinged_pair": ["time.end=0.4", "output.every=0.1"],
    "periodic_channel": ["time.end=1", "output.every=0.5"],
    "several_laws": ["time.end=0.02", "output.every=0.01"],
    "slider": ["time.end=0.09"],
    "wavy_channel": ["time.end=0.5", "time.step=0.01"],
}
"""Scenes, and what makes them quicker than they are shipped."""


def draw(name: str) -> Path:
    """Run a scene for a while, and write its picture to docs/pictures."""
    with TemporaryDirectory() as folder:
        out = Path(folder) / name
        rigidfluid.run(rigidfluid.load_scene(SCENES / f"{name}.toml", SETTINGS[name]), out)
        with Image.open(movie(out, out / "movie.gif", Look(longer=400))) as frames:
            frames.seek(frames.n_frames - 1)
            OWN.mkdir(exist_ok=True)
            frames.convert("RGB").quantize(128).save(OWN / f"{name}.png", optimize=True)
    return OWN / f"{name}.png"


if __name__ == "__main__":
    for scene in sys.argv[1:] or SETTINGS:
        print(draw(scene))
