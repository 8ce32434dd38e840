"""Scenes of a mechanism with a head, a trunk and a tail."""

from rigidfluid.core.case.load import scene_from_dict

BALL = {"type": "sphere", "radius": 0.05, "density": 1.0}
WAG = {"moves": ["tail"], "about": [0.6, 0.0], "smooth": [[0.0, 0.0], [0.1, 0.5], [0.3, -0.5], [0.4, 0.0]]}
OUT = {"moves": ["head"], "along": [-1.0, 0.0], "piecewise": [[0.0, 0.0], [0.03, 0.06], [0.05, 0.06], [0.1, 0.0]]}


def components(**tail):
    square = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]]
    return [
        BALL | {"name": "head", "position": [0.0, 0.0]},
        {"name": "trunk", "type": "ellipsoid", "semi_axes": [0.2, 0.1], "density": 2.0, "position": [0.4, 0.0]},
        {"name": "tail", "type": "polygon", "points": square, "density": 3.0, "position": [0.8, 0.0]} | tail,
    ]


def scene(*strokes, parts=None, end=0.2, step=0.01, position=(2.0, 2.0), fluid=None, **keys):
    table = {"name": "it", "type": "articulated", "component": parts or components(), "stroke": list(strokes)}
    return scene_from_dict(
        {
            "scene": {"name": "articulated", "dimension": 2},
            "fluid": fluid or {"backend": "dry"},
            "domain": {"lower": [0.0, 0.0], "upper": [4.0, 4.0]},
            "mechanism": [table | {"position": list(position)} | keys],
            "mesh": {"size": 0.8, "size_body": 0.08},
            "time": {"end": end, "step": step},
            "output": {"every": end},
        }
    )
