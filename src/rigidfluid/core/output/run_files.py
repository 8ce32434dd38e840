"""The files of a run, of its report and of its movie: the one list of what is replaced in a folder."""

from __future__ import annotations

from dataclasses import dataclass

from rigidfluid.core.output.results_folder import Product

PICTURES = (
    *("speed_field", "streamlines", "vorticity", "pressure", "scalar", "viscosity"),
    *("whole_mesh", "mesh", "smallest_gap"),
    *("space", "position", "mechanisms", "speed", "gap", "rotation", "torque", "force", "coefficients"),
    *("contacts", "joints", "energy", "step", "statistics"),
)
"""Names of the pictures in the report of a run, each a PNG or SVG file."""

TABLES = {
    "bodies": "a row per body, components of mechanisms among them, and a row per mechanism",
    "contacts": "a row per contact within the longest range of the laws",
    "joints": "a row per joint, and per body that is held or on springs",
    "energy": "the energy balance",
    "steps": "size, error with `time.tolerance`, unknowns, new meshes",
    "probes": "the fluid at the points of `output.probes`",
    "driving": "flux and drop of pressure of each pair of periodic surfaces",
    "stresslets": "a row per body with `output.stresslets`",
    "walls": "forces on the surfaces of the domain, with `output.walls`",
    "statistics": "velocities, gaps, contacts and stress of many bodies, with `output.statistics`",
    "mesh_error": "the error that the mesh makes, with `mesh.estimate`",
    "sensitivities": "derivatives by the keys in `output.sensitivities`, a row per key and body",
    "scalar": "content, balance and extremes of the scalar of a table `[scalar]`",
    "scalar_fluxes": "its flux into the fluid and mean value on each body and each surface of the domain",
    "exchanges": "mass, momentum and energy of each body that entered or left",
    "error_estimates": "a row per body with `output.error_bars`",
}
"""Names of a run's tables, and what is in each."""


@dataclass(frozen=True)
class Files:
    """Files of one purpose: ``shown`` as documentation lists them, a ``pattern`` of their paths in the folder, when
    they are ``written`` and their ``content``."""

    shown: str
    pattern: str
    written: str
    content: str


_ADDED = (
    Files(
        "`report.html`, `report/`",
        rf"report\.html|report/({'|'.join(PICTURES)})\.(png|svg)",
        "by `rigidfluid report DIR`",
        "plots and one page that holds them all",
    ),
    Files(
        "`movie.mp4` or `movie.gif`",
        r"movie\.(mp4|gif)|\.movie\.(mp4|gif)\.part\.(mp4|gif)",
        "by `rigidfluid movie DIR`",
        "a picture for each output time",
    ),
)


def _written(table: str) -> str:
    """When rows of a table are written."""
    seldom = {"error_estimates": "each `output.every`", "exchanges": "when bodies enter or leave"}
    return seldom.get(table, "each step")


FILES = (
    *(Files(f"`{name}.csv`", rf"{name}\.csv", _written(name), content) for name, content in TABLES.items()),
    Files("`fields.pvd`", r"fields\.pvd(\.part)?", "each `output.every`", "the list of all in `fields/`, for ParaView"),
    Files(
        "`fields/000000.vtu`, …",
        r"fields/\d{6,}(\.\d+)?\.p?vtu",
        "each `output.every`",
        "velocity, pressure, vorticity, and what else the scene has; not without a fluid",
    ),
    Files(
        "`fields/000000.bodies.vtu`, `fields/000000.contacts.vtu`, `fields/000000.insides.vtu`, …",
        r"fields/\d{6,}\.(bodies|contacts|insides)\.vtu",
        "each `output.every`",
        "bodies with twists and forces; contacts with their forces; what is inside bodies that conduct",
    ),
    Files("`state.h5`", r"state(\.\d+)?\.h5(\.part)?", "each `output.every`", "checkpoint for `--resume`"),
    Files("`summary.json`", r"summary\.json(\.part)?", "at the end", "the figures that matter, and what they cost"),
    *_ADDED,
)

RUN = Product("run", "|".join(files.pattern for files in FILES), subfolders=("fields", "report"))
ADDED = Product("run", "|".join(files.pattern for files in _ADDED), subfolders=("report",))
"""Files that commands add to the folder of a run."""
