"""72 disks in a periodic channel at Re 1000: their share across it, beside Chen, Pan and Chang's, and the cost."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from page_tools import Page, Run, Work, table
from published import DISK_SHARE

from rigidfluid.post.statistics import statistics
from rigidfluid.post.statistics.figures import Statistics

END = 240.0
SINCE = (80.0, 160.0)
"""Times from which means are taken, each to the next one or the end."""


def page(work: Work) -> Page:
    """Shares of the layers in two times, the account of energy, and the cost."""
    run = work.run("shipped", "channel_of_disks.toml", [f"time.end={END}"])
    until = (*SINCE[1:], END)
    found = [statistics(run.folder, since, to)[0] for since, to in zip(SINCE, until, strict=True)]
    text = ABOUT.format(
        whole=f"{_whole():.3f}",
        end=f"{END:g}",
        figures=table(("figure", "value"), _figures(run, found[-1])),
        layers=table(
            (
                "height",
                *(f"share, {a:g} to {b:g}" for a, b in zip(SINCE, until, strict=True)),
                "Chen et al.",
                "velocity",
            ),
            _layers(found),
        ),
        earlier=_off(found[0]),
        off=_off(found[-1]),
        apart=f"{np.sqrt(((found[0].profile.fraction.value - found[-1].profile.fraction.value) ** 2).mean()):.3f}",
        gain=_gain(run),
    )
    return Page("72 disks in a channel", text, {"": profiles(found), "_disks": disks(run)})


def profiles(found: list[Statistics]) -> Figure:
    """Shares and velocities of the disks across the channel."""
    figure = Figure(figsize=(9.0, 3.8), dpi=110, layout="constrained")
    left, right = figure.subplots(1, 2)
    for one in found:
        label = f"{one.samples.time[0]:.0f} to {one.samples.time[-1]:.0f}"
        layers = one.profile
        left.errorbar(layers.place, *layers.fraction, fmt="o-", markersize=3, capsize=2, label=label)
        right.errorbar(
            layers.place, layers.velocity.value[:, 0], layers.velocity.error[:, 0], fmt="o-", markersize=3, capsize=2,
            label=label,
        )  # fmt: skip
    place, share = DISK_SHARE.T
    left.plot(place, share * found[0].presence.fraction.value / _whole(), "k--", label="Chen et al. 2012, for 16.9 %")
    left.set(xlabel="height", ylabel="share of the disks", ylim=(0.0, None))
    right.plot(place, 4.0 * place * (1.0 - place), "k:", label="without disks")
    right.set(xlabel="height", ylabel="velocity of the disks")
    for axes in (left, right):
        axes.legend(frameon=False, fontsize=8)
    return figure


def disks(run: Run) -> Figure:
    """The disks at the start and at the end, by their height at the start."""
    figure = Figure(figsize=(9.0, 4.8), dpi=100, layout="constrained")
    bodies, count = run.history.bodies, len(run.scene.body)
    x, y = (bodies[name].reshape(-1, count) for name in "xy")
    for axes, state, title in zip(figure.subplots(2, 1), (0, -1), ("at the start", f"at {END:g}"), strict=True):
        _draw(axes, run, x[state] % run.scene.domain.upper[0], y[state], y[0])
        axes.set_title(title)
    return figure


def _draw(axes: Axes, run: Run, x: np.ndarray, y: np.ndarray, first: np.ndarray) -> None:
    length, height = run.scene.domain.upper
    for body, at, up, start in zip(run.scene.body, x, y, first, strict=True):
        for image in (at - length, at, at + length):
            colour = f"C{int(5 * start / height)}"
            axes.add_patch(Circle((image, up), body.radius, facecolor=colour, edgecolor="black", linewidth=0.3))
    axes.set(xlim=(0.0, length), ylim=(0.0, height), aspect="equal", xticks=[], yticks=[])


def _whole() -> float:
    """Mean of the published share over the height."""
    return float(np.trapezoid(DISK_SHARE[:, 1], DISK_SHARE[:, 0]))


def _published(found: Statistics) -> np.ndarray:
    """Published share at the middles of the layers, so that its mean is that of the disks."""
    return np.interp(found.profile.place, *DISK_SHARE.T) * found.presence.fraction.value / _whole()


def _off(found: Statistics) -> str:
    """Root of the mean square of the differences of the shares, and the greatest one."""
    off = found.profile.fraction.value - _published(found)
    return f"{np.sqrt((off**2).mean()):.3f}, and at most {np.abs(off).max():.3f}"


def _gain(run: Run) -> str:
    """Relative change of the mean flux from the first of the two times to the second."""
    time, flux = run.history.driving["time"], run.history.driving["flux"]
    first, second = (
        flux[(time >= since) & (time < to)].mean() for since, to in zip(SINCE, (*SINCE[1:], END), strict=True)
    )
    return f"{second / first - 1.0:.1%}"


def _layers(found: list[Statistics]) -> Iterator[tuple[str, ...]]:
    last = found[-1].profile
    for layer, place in enumerate(last.place):
        shares = (one.profile.fraction for one in found)
        velocity = f"{last.velocity.value[layer, 0]:.3f}" if np.isfinite(last.velocity.value[layer, 0]) else ""
        yield (
            f"{place:.3f}",
            *(f"{share.value[layer]:.3f} ± {share.error[layer]:.3f}" for share in shares),
            f"{_published(found[-1])[layer]:.3f}",
            velocity,
        )


def _figures(run: Run, found: Statistics) -> Iterator[tuple[str, str]]:
    summary, energy, stages = run.summary, run.summary["energy"], run.summary["wall_time_per_stage"]
    flux, total, x = run.history.driving["flux"], sum(stages.values()), run.history.bodies["x"]
    count = len(run.scene.body)
    way = (x[-count:] - x[:count]).mean() / run.scene.domain.upper[1]
    yield "disks, share of the area", f"{count}, {found.presence.fraction.value:.4f}"
    yield "time reached, mean way of the disks in heights", f"{END:g}, {way:.1f}"
    yield "mean velocity at the start, at the end", f"{flux[0]:.3f}, {flux[-1]:.3f}"
    yield "unknowns at the end", f"{summary['unknowns']:,}"
    yield "steps, rejected", f"{summary['steps']:,}, {summary['rejected_steps']}"
    yield "new meshes, failed", f"{summary['remeshes']}, {summary['failed_remeshes']}"
    yield "smallest gap over the radius", f"{summary['smallest_gap'] / run.scene.body[0].radius:.3f}"
    yield "CPU time of one thread", f"{run.cpu_seconds:.0f} s, {run.cpu_seconds / summary['steps']:.2f} s a step"
    yield "stages", ", ".join(f"{stage} {seconds / total:.0%}" for stage, seconds in stages.items())
    yield "energy put in", f"{energy['put_in']:.4f}"
    yield (
        "created, lost, unaccounted",
        ", ".join(f"{100.0 * energy[n]:.2f} %" for n in ("created", "lost", "unaccounted")),
    )
    yield "of it by stabilisation", f"{100.0 * energy['grad_div']:.2f} %"


ABOUT = """`scenes/channel_of_disks.toml`: 72 disks of the fluid's density fill 16.9 % of a periodic channel that is
four times as long as high. The drop of pressure is held; without disks it drives a flow with a greatest velocity of 1,
and Re is 1000 with this velocity and the height. The fluid starts with that flow, and the disks, seeded by
`[[swarm]]`, at rest. This is the scene of the repository EllipsesInFlows (N. Hori, its example `case4`),
which followed disks to a time of 1000 and compares their share across the channel with that of Chen, Pan and Chang
(Phys. Fluids 24 (2012)). Here two cores, shared with other work, came to {end}.

{figures}

![Disks at the start and at the end](channel_of_disks_disks.png)

*Share* is that of disks in a layer, *velocity* theirs at the last times; errors are standard errors of blocks.

{layers}

Chen's points are those that EllipsesInFlows took from the paper. Their mean over the height is {whole} and not .169;
so they are scaled here, and their shape is what can be compared: two maxima near the middle, a dip between them, and
walls without disks. The shares in the earlier of the two times differ from it by {earlier}; in the later one by {off};
from each other by {apart} in the mean square. So the suspension is steady, but for the flow, which still gains
{gain} from the one time to the other. Errors are those within one such time. Cells are
.64 of the radius on the disks, which is coarse for Re 1000; at walls and in gaps they are no shorter than half of
that. The contact law has a range of .18 of the radius; the published one is not known here."""
