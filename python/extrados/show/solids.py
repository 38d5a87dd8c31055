"""Figures of limit analysis of solids: the stones, their mechanism, the capacity over direction."""

import itertools
from pathlib import Path

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize, to_rgb

from extrados.results.limit import DILATANT
from extrados.results.solid_files import rotations
from extrados.results.solids import SolidTilt
from extrados.results.store import Stored
from extrados.show import film, scene, style
from extrados.show.limit import tilt
from extrados.show.limit.section import TIE

VIEW = scene.View()
LONGEST, FAINT = 0.16, 0.01  # length of the greatest force, of the picture; the least that is drawn, of the greatest
FILM, FILM_PIXELS = 4.0, 600  # seconds that a mechanism takes at speed 1, pixels of the longer side of its pictures
SPEED = LinearSegmentedColormap.from_list("speed", [style.STONE, "#f2c28b", "#c8553d"])


def draw_tilt(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """The figures of a plane section, or of solids."""
    r = run[name]
    return _draw_solids(run, name, folder, r) if isinstance(r, SolidTilt) else tilt.draw(run, name, folder)


def faces_of(run: Stored, name: str, pose: np.ndarray | None = None, which: str = "") -> scene.Faces:
    """The solids of an analysis, carried to a pose (blocks, 6) of shifts and rotation vectors; which: end of the names of their
    arrays, where an analysis has several buildings."""
    vertices, corners = run.array(name, f"solid_vertex{which}"), run.array(name, f"solid_face{which}")
    start, block = run.array(name, f"solid_face_start{which}"), run.array(name, f"solid_face_block{which}")
    faces = [corners[a:b] for a, b in itertools.pairwise(start)]
    if pose is not None:
        whose = np.empty(len(vertices), dtype=int)
        whose[corners] = np.repeat(block, np.diff(start))
        centroid = run.array(name, f"solid_centroid{which}")
        turn = rotations(pose[:, 3:])
        vertices = centroid[whose] + pose[whose, :3] + np.einsum("nij,nj->ni", turn[whose], vertices - centroid[whose])
    return scene.Faces(vertices, faces, block)


def _title(r: SolidTilt) -> str:
    """The collapse acceleration along the direction, an upper bound where contacts slide."""
    bound = f",\n{DILATANT}" if r.dilating_contacts and not _least_drawn(r) else ""
    design, least = r.collapse_acceleration_load_path_g, r.collapse_acceleration_non_associated_g
    if design is not None and least is not None:
        bound += f"\nwithout dilatancy {design:.4f} g (design value), {least:.4f} g (least found)"
    return f"Mechanism at {r.collapse_acceleration_g:.4f} g along {r.load_direction_deg:g} deg{bound}"


def _least_drawn(r: SolidTilt) -> bool:
    """Whether the mechanism is that of the least state without dilatancy, as friction_rule asks."""
    return r.collapse_acceleration_g == r.collapse_acceleration_non_associated_g


def _draw_solids(run: Stored, name: str, folder: Path, r: SolidTilt) -> list[tuple[str, str]]:
    pose = run.array(name, "mechanism_pose")
    stones, moved = faces_of(run, name), faces_of(run, name, pose)
    speed = speeds(stones, moved, len(pose))
    both = np.concatenate([stones.vertices, moved.vertices])
    frame = scene.frame_of(both, VIEW)
    wide = (frame[1] - frame[0]) / (frame[3] - frame[2])
    height = float(np.clip(4.6 / wide + 1.6, 3.8, 7.0))
    strands = _strands(run, name)
    plain = np.tile(to_rgb(style.STONE), (len(pose), 1))
    with style.figure(10.5, height, columns=2) as (fig, axes):
        for ax, solids, colours in ((axes[0], stones, plain), (axes[1], moved, SPEED(speed)[:, :3])):
            scene.show(ax, scene.picture(solids, VIEW, frame, colours), frame)
            scene.ground(ax, stones.vertices, VIEW)
            scene.compass(ax, VIEW, r.load_direction_deg if ax is axes[1] else None)
            if ax is axes[0] and len(strands):
                ax.add_collection(LineCollection(list(strands), colors=TIE, linewidths=1.6, zorder=3))
        x, y, z = np.ptp(stones.vertices, axis=0)
        axes[0].set_title(f"{r.blocks} stones, {r.contacts} contacts; {x:.3g} x {y:.3g} x {z:.3g} m")
        axes[1].set_title(_title(r))
        bar = fig.colorbar(ScalarMappable(Normalize(0.0, 1.0), SPEED), ax=axes[1], shrink=0.6, pad=0.01)
        bar.set_label("speed of the stone / greatest speed")
        found = [
            (
                style.save(fig, folder, f"{name}-mechanism"),
                f"Left: the stones. Right: the mechanism at {r.collapse_acceleration_g:.4f} g along {r.load_direction_deg:g} degrees in plan, continued to a visible displacement; "
                f"{r.moving_blocks} of {r.blocks} stones move." + (f" Contacts slide: {DILATANT}." if r.dilating_contacts else ""),
            )
        ]
    found.append(_draw_forces(run, name, folder, r, stones))
    angles, capacity = run.array(name, "rose_direction"), run.array(name, "rose_capacity")
    capacity = np.where(np.isfinite(capacity), capacity, np.nan)  # where nothing brings it down
    if len(angles) > 2 and np.isfinite(capacity).any():
        found.append(_draw_rose(folder, name, r, angles, capacity))
    _film(run, name, folder, r, frame, SPEED(speed)[:, :3])
    return found


def _strands(run: Stored, name: str) -> np.ndarray:
    """Segments (n, 2, 2) of ties, chains and hoops in the picture."""
    if "strand_segment" not in run.arrays[name]:
        return np.empty((0, 2, 2))
    return run.array(name, "strand_segment") @ VIEW.axes[:2].T


def _draw_forces(run: Stored, name: str, folder: Path, r: SolidTilt, stones: scene.Faces) -> tuple[str, str]:
    """Where and how the contacts press at collapse: through the stones, as long as the forces are great."""
    force, centre = run.array(name, "contact_force"), run.array(name, "contact_centre")
    size = np.linalg.norm(force, axis=1)
    frame = scene.frame_of(stones.vertices, VIEW)
    span = max(frame[1] - frame[0], frame[3] - frame[2])
    reach = LONGEST * span / float(size.max())
    pressed = np.flatnonzero(size > FAINT * size.max())
    half = 0.5 * reach * force[pressed] @ VIEW.axes[:2].T
    middle = centre[pressed] @ VIEW.axes[:2].T
    pale = np.tile(1.0 - 0.45 * (1.0 - np.array(to_rgb(style.STONE))), (int(stones.block.max()) + 1, 1))
    wide = (frame[1] - frame[0]) / (frame[3] - frame[2])
    with style.figure(7.0, float(np.clip(6.0 / wide + 1.4, 3.8, 7.0))) as (fig, (ax,)):
        image = scene.picture(stones, VIEW, frame, pale)
        image[..., 3] *= 0.75
        scene.show(ax, image, frame)
        scene.ground(ax, stones.vertices, VIEW)
        scene.compass(ax, VIEW, r.load_direction_deg)
        ax.add_collection(
            LineCollection(list(np.stack([middle - half, middle + half], axis=1)), colors=style.THRUST, linewidths=1.1, zorder=3)
        )
        ax.plot(*middle.T, ".", color=style.THRUST, markersize=2.0, zorder=3)
        ax.set_title(f"Forces between the stones at {r.collapse_acceleration_g:.4f} g; the longest is {size.max() / 1e3:.3g} kN")
        saved = style.save(fig, folder, f"{name}-forces")
    return saved, (
        "Forces between the stones, and on the ground, at collapse. Each acts at the centre "
        f"of compression of its contact; its length is in proportion. The longest is {size.max() / 1e3:.3g} kN."
    )


def _film(run: Stored, name: str, folder: Path, r: SolidTilt, frame: tuple[float, float, float, float], colours: np.ndarray) -> None:
    """The mechanism as a film, if the deck requests one: forward and backward, so that it repeats without a jump."""
    kind, speed = film.asked(run, name)
    if kind == "none":
        return
    pose = run.array(name, "mechanism_pose")
    stones = faces_of(run, name)
    times = np.linspace(0.0, FILM, 1 + round(FILM * film.RATES[kind] / max(speed, 1e-3)))
    share = np.sin(np.pi * times / FILM) ** 2
    width, height = (side / film.DPI for side in film.PIXELS)
    with style.figure(width, height) as (fig, (ax,)):
        scene.show(ax, scene.picture(stones, VIEW, frame, colours, FILM_PIXELS), frame)
        (drawn,) = ax.images
        scene.ground(ax, stones.vertices, VIEW)
        scene.compass(ax, VIEW, r.load_direction_deg)
        ax.set_title(_title(r))

        def draw(k: int) -> None:
            drawn.set_data(scene.picture(faces_of(run, name, share[k] * pose), VIEW, frame, colours, FILM_PIXELS))

        path = folder / "figures" / f"{name}.{kind}"
        film.write(fig, path, kind, film.RATES[kind], np.arange(len(times)), draw, [drawn])


def speeds(stones: scene.Faces, moved: scene.Faces, count: int) -> np.ndarray:
    """Displacement of the fastest vertex of each block, relative to the greatest of all."""
    gone = np.linalg.norm(moved.vertices - stones.vertices, axis=1)
    found = np.zeros(count)
    for face, block in zip(stones.faces, stones.block, strict=True):
        found[block] = max(found[block], gone[face].max())
    return found / found.max()


def _draw_rose(folder: Path, name: str, r: SolidTilt, angles: np.ndarray, capacity: np.ndarray) -> tuple[str, str]:
    order = np.argsort(angles)
    turn = np.radians(np.append(angles[order], angles[order][0] + 360.0))
    radius = np.append(capacity[order], capacity[order][0])
    with style.figure(5.2, 5.0, subplot_kw={"projection": "polar"}) as (fig, (ax,)):
        ax.fill(turn, radius, facecolor=style.SAFE, alpha=0.15)
        ax.plot(turn, radius, "o-", color=style.SAFE, markersize=3)
        worst = np.radians(r.least_direction_deg)
        ax.plot([worst], [r.least_acceleration_g], "o", color=style.THRUST, markersize=6, zorder=4)
        rows = [row for row in r.non_dilatant or [] if row.load_path_g is not None]
        if rows:
            way = np.radians([row.direction_deg for row in rows])
            ax.plot(way, [row.load_path_g for row in rows], "s", color=style.HINGE, markersize=5, label="design value by load paths")
            ax.plot(way, [row.least_g for row in rows], "_", color=style.HINGE, markersize=9, label="least state found")
            ax.legend(loc="lower left", bbox_to_anchor=(-0.17, -0.07), fontsize=7)
        ax.set_ylim(0.0, 1.15 * float(np.nanmax(radius)))
        ax.set_rlabel_position(100.0)
        ax.tick_params(axis="y", labelsize=7)
        ax.set_xlabel("capacity [g]; 0 deg is +x, 90 deg is +y")
        ax.set_title(
            "Capacity over the direction of the acceleration\n"
            f"least {r.least_acceleration_g:.4f} g along {r.least_direction_deg % 360.0:g} deg (red)"
        )
        return style.save(fig, folder, f"{name}-rose"), (
            "Capacity over the direction of the acceleration in plan."
            + (" The line is an upper bound (dilatant friction)." if rows else "")
        )
