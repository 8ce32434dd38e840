"""Make the gallery's pictures: run each scene as far as its picture shows it, and draw that.

``python docs/make_pictures.py NAME…`` makes those of some scenes, without names those of all, which takes hours. Runs
are kept in out/gallery, or the folder ``--runs``; a complete one that is there is drawn as it is.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from page_tools.kept_run import is_complete
from PIL import Image
from site_tools.gallery import DOCS, SCENES, picture
from site_tools.scene_picture import Shown, scene_picture

import rigidfluid

PICTURES = {
    "bounce_in_fluid": Shown("vorticity", (0.008, 0.016, 0.024, 0.032), settings=("output.every=0.004",)),
    "clot_in_blood": Shown("speed", (0.12, 0.2, 0.25)),
    "cold_disk": Shown("scalar", (2.0, 6.0, 10.0, 14.0)),
    "channel_of_disks": Shown("speed", (12.0, 36.0)),
    "dfg_2d2": Shown("vorticity", (3.0, 7.0)),
    "dfg_2d3": Shown("vorticity", (2.0, 4.0, 6.0)),
    "dfg_cylinder": Shown("streamlines", (15.0,), (-0.2, -0.2, 0.6, 0.21)),
    "dominoes": Shown("paths", (0.3,)),
    "drafting_kissing_tumbling": Shown("vorticity", (0.06, 0.12, 0.18, 0.24)),
    "dry_bounce": Shown("paths", (0.2,)),
    "dumbbell_in_shear": Shown("space", (0.6, 4.8)),
    "ellipse_in_channel": Shown("vorticity", (2.0, 4.0, 6.0, 8.0), (-0.1, -0.2, 0.1, 0.2)),
    "ellipse_xia": Shown("vorticity", (0.2, 0.6, 1.0, 1.4), (-0.25, -0.25, 0.25, 0.85)),
    "falling_disk": Shown("speed", (0.24, 0.5, 0.76, 1.0)),
    "falling_disk_window": Shown("vorticity", (0.5, 1.0, 2.0, 3.0)),
    "falling_ellipsoid": Shown("vorticity", (0.2, 0.4, 0.6, 0.8), (-0.5, -0.5, 0.5, 1.8)),
    "falling_sphere": Shown("space", (1.0,)),
    "fast_disk": Shown("vorticity", (0.1, 0.15, 0.2, 0.275)),
    "fed_channel": Shown("speed", (0.75, 1.5, 2.5)),
    "hinged_pair": Shown("vorticity", (0.16, 0.3, 0.44, 0.6)),
    "hot_cavity": Shown("scalar", (0.03, 0.3)),
    "hundred_disks": Shown("speed", (0.5, 1.5, 3.0)),
    "hundred_spheres": Shown("space", (0.4,)),
    "insertion_2d": Shown("streamlines", (0.1,)),
    "insertion_3d": Shown("space", (0.1,)),
    "many_bodies_3d": Shown("space", (0.6,)),
    "periodic_array": Shown("streamlines", (0.01,)),
    "periodic_channel": Shown("streamlines", (0.5, 2.5)),
    "rebound": Shown("vorticity", (0.006, 0.012, 0.018, 0.03), settings=("output.every=0.006",)),
    "sheared_cell": Shown("speed", (0.001,)),
    "settling_cylinder": Shown("vorticity", (3.0, 6.0, 9.0, 12.0), (-2.0, -2.0, 2.0, 8.0)),
    "several_laws": Shown("speed", (0.01, 0.02, 0.03, 0.04)),
    "slider": Shown("speed", (0.03, 0.06, 0.09, 0.15)),
    "slope": Shown("paths", (0.1,)),
    "squeezed_film": Shown("mesh", (0.01,), (-1.5, -1.1, 1.5, 1.3), plane="xz"),
    "stenosis": Shown("speed", (0.002, 0.0054, 0.0068)),
    "swimmer": Shown("streamlines", (1.0, 3.0)),
    "swimmer_3d": Shown("streamlines", (1.0,), (-8.0, -8.0, 20.0, 8.0)),
    "swimmer_near_wall": Shown("streamlines", (400.0, 1200.0)),
    "ten_cate_e3": Shown("space", (1.0,)),
    "three_swimmers": Shown("streamlines", (8.0, 40.0)),
    "two_disks": Shown("vorticity", (1.0, 2.0, 3.0, 4.0)),
    "two_spheres": Shown("mesh", (0.01,), (-1.6, -0.55, 1.6, 2.65)),
    "vortex_induced": Shown("vorticity", (150.0,), (-3.0, -4.0, 13.0, 4.0)),
    "wavy_channel": Shown("speed", (1.0, 3.0)),
}


def draw(name: str, runs: Path) -> Path:
    """Write a scene's picture to docs/pictures; its run is made where it is not in ``runs`` yet."""
    shown, folder = PICTURES[name], runs / name
    if not is_complete(folder):
        settings = (f"time.end={shown.times[-1]}", *shown.settings)
        rigidfluid.run(rigidfluid.load_scene(SCENES / f"{name}.toml", settings), folder)
    path = picture(name)
    scene_picture(folder, shown).savefig(path, dpi=130, metadata={"Software": None})
    with Image.open(path) as image:
        small = image.convert("RGB").quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=3)
    small.save(path, optimize=True)
    return path


def main() -> None:
    """Take scenes and the folder of runs from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("name", nargs="*", metavar="NAME")
    parser.add_argument("--runs", type=Path, default=DOCS.parent / "out" / "gallery")
    options = parser.parse_args()
    for name in options.name or PICTURES:
        print(draw(name, options.runs))


if __name__ == "__main__":
    main()
