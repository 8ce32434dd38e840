"""The falling-disk scene, shortened or coarsened by overrides."""

from pathlib import Path

import rigidfluid

SCENES = Path(__file__).parents[2] / "scenes"


def falling_disk(**tables):
    """The scene with ``table={key: value}`` merged in; ``body={…}`` goes to the one body."""
    import tomllib

    data = tomllib.loads((SCENES / "falling_disk.toml").read_text())
    data["body"][0].update(tables.pop("body", {}))
    for name, keys in tables.items():
        data[name].update(keys)
    return rigidfluid.scene_from_dict(data)
