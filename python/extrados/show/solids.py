"""Figures of limit analysis of solids: the stones, their mechanism, the capacity over direction."""

import itertools
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize, to_rgb

from extrados.results.limit import DILATANT
from extrados.results.solid_files import rotations
from extrados.results.solids import SolidThrust, SolidTilt
from extrados.results.store import Stored
from extrados.show import film, scene, style
from extrados.show.limit import tilt
from extrados.show.limit.section import TIE

VIEW = scene.View()
LONGEST, FAINT = 0.16, 0.01  # length of the greatest force, of the picture; the least that is drawn, of the greatest
NARROW = 1e-6  # of the greatest thrust: a range of thrusts that is rounding
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
        bound += f"\nwithout dilatancy: design value {design:.4f} g,\nlowest found {least:.4f} g"
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
                f"{r.moving_blocks} of {r.blocks} stones move."
                + (f" Contacts slide, so the capacity is an {DILATANT}." if r.dilating_contacts else ""),
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
    wide = (frame[1] - frame[0]) / (frame[3] - frame[2])
    with style.figure(7.0, float(np.clip(6.0 / wide + 1.4, 3.8, 7.0))) as (fig, (ax,)):
        pale_stones(ax, stones, frame, r.load_direction_deg)
        pressing(ax, force, centre, frame, float(size.max()), style.THRUST)
        ax.set_title(f"Forces between the stones at {r.collapse_acceleration_g:.4f} g; the greatest is {size.max() / 1e3:.3g} kN")
        saved = style.save(fig, folder, f"{name}-forces")
    return saved, (
        "Forces between the stones, and on the ground, at collapse. Each arrow starts at the centre of compression of its contact; its "
        f"length is proportional to the force. The greatest force is {size.max() / 1000.0:.3g} kN."
    )


def pale_stones(ax: Axes, stones: scene.Faces, frame: tuple[float, float, float, float], direction: float | None) -> None:
    """The blocks pale, for forces drawn upon them, with the direction of the push [deg]."""
    pale = np.tile(1.0 - 0.45 * (1.0 - np.array(to_rgb(style.STONE))), (int(stones.block.max()) + 1, 1))
    image = scene.picture(stones, VIEW, frame, pale)
    image[..., 3] *= 0.75
    scene.show(ax, image, frame)
    scene.ground(ax, stones.vertices, VIEW)
    scene.compass(ax, VIEW, direction)


def pressing(
    ax: Axes, force: np.ndarray, centre: np.ndarray, frame: tuple[float, float, float, float], longest: float, colour: str
) -> None:
    """Forces (n, 3) [N] through their centres (n, 3) [m], as long as they are great; longest: the force [N] of the longest line."""
    size = np.linalg.norm(force, axis=1)
    reach = LONGEST * max(frame[1] - frame[0], frame[3] - frame[2]) / max(longest, 1e-300)
    pressed = np.flatnonzero(size > FAINT * longest)
    half = 0.5 * reach * force[pressed] @ VIEW.axes[:2].T
    middle = centre[pressed] @ VIEW.axes[:2].T
    ax.add_collection(LineCollection(list(np.stack([middle - half, middle + half], axis=1)), colors=colour, linewidths=1.1, zorder=3))
    ax.plot(*middle.T, ".", color=colour, markersize=2.0, zorder=3)


def draw_thrust(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Forces between the blocks in the states of least and greatest thrust of the first section, and in the most central one; the
    range of the thrust of every section."""
    r = run[name]
    assert isinstance(r, SolidThrust)
    stones = faces_of(run, name)
    states = []
    if r.sections:
        first = r.sections[0]
        for which, value, colour in (("least", first.least_N, style.THRUST), ("greatest", first.greatest_N, style.HINGE)):
            if value is not None:
                title = f"{which} thrust at '{first.name}'\n{value / 1e3:.4g} kN"
                states.append((title, run.array(name, f"{which}_force")[0], run.array(name, f"{which}_centre")[0], colour))
    if r.least_part_of_joints is not None:
        title = f"most central state\n(resultants in the middle {100.0 * r.least_part_of_joints:.1f} %)"
        states.insert(1, (title, run.array(name, "central_force"), run.array(name, "central_centre"), "#444444"))
    frame = scene.frame_of(stones.vertices, VIEW)
    tall = (frame[3] - frame[2]) / (frame[1] - frame[0])
    found = []
    if states:
        longest = max(float(np.linalg.norm(force, axis=1).max()) for _, force, _, _ in states)
        with style.figure(4.2 * len(states), float(np.clip(4.2 * tall + 2.0, 3.4, 7.0)), columns=len(states)) as (fig, axes):
            for ax, (title, force, centre, colour) in zip(axes, states, strict=True):
                pale_stones(ax, stones, frame, r.load_direction_deg if r.gamma_g else None)
                pressing(ax, force, centre, frame, longest, colour)
                ax.set_title(title)
            caption = (
                f"Forces between the blocks at {r.gamma_g:g} g, each drawn through the centre of compression of its "
                f"contact; the greatest force is {longest / 1000.0:.3g} kN."
            )
            found.append((style.save(fig, folder, f"{name}-forces"), caption))
    if r.sections:
        found.append(_draw_ranges(folder, name, r))
    return found


def _draw_ranges(folder: Path, name: str, r: SolidThrust) -> tuple[str, str]:
    """Least, central and greatest thrust of the sections; an arrow where there is no greatest."""
    with style.figure(7.0, 1.4 + 0.4 * len(r.sections)) as (fig, (ax,)):
        known = [v for one in r.sections for v in (one.least_N, one.central_N, one.greatest_N) if v is not None]
        reach = 1.15 * max([*map(abs, known), 0.01 * r.weight_N])
        for k, one in enumerate(r.sections):
            low, high = (-reach if one.least_N is None else one.least_N), (reach if one.greatest_N is None else one.greatest_N)
            ax.plot([low / 1e3, high / 1e3], [k, k], color=style.STONE, linewidth=9.0, solid_capstyle="butt")
            for value, end, marker in ((one.least_N, low, "<"), (one.greatest_N, high, ">")):
                ax.plot(end / 1e3, k, "|" if value is not None else marker, color=style.EDGE, markersize=12 if value is not None else 7)
            if one.central_N is not None:
                ax.plot(one.central_N / 1e3, k, "o", color="#444444", markersize=5)
        ax.set_yticks(range(len(r.sections)), [f"{one.name} ({one.direction})" for one in r.sections])
        ax.set_ylim(len(r.sections) - 0.5, -0.5)
        low, high = ax.get_xlim()
        if 1e3 * (high - low) < NARROW * reach:  # thrusts that differ by rounding alone
            ax.set_xlim(0.5 * (low + high) - 0.5 * reach / 1e3, 0.5 * (low + high) + 0.5 * reach / 1e3)
        ax.set_xlabel("thrust [kN]")
        ax.set_title(f"Minimum, most central (dot) and maximum thrust at {r.gamma_g:g} g")
        return style.save(fig, folder, f"{name}-sections"), (
            "Thrust of the sections, from minimum to maximum; dot: in the most central state. An arrow head marks an end without a limit."
        )


def draw_examples(run: Stored, name: str, folder: Path, captions: dict[int, str]) -> list[tuple[str, str]]:
    """The mechanisms of solids that a sweep stored; captions: what each is called, by its number."""
    numbers = run.array(name, "example_mechanism").tolist()
    rest = [faces_of(run, name, which=f"_{k}") for k in numbers]
    poses = [run.array(name, f"solid_pose_{k}") for k in numbers]
    moved = [faces_of(run, name, pose, f"_{k}") for k, pose in zip(numbers, poses, strict=True)]
    if not moved:
        return []
    frame = scene.frame_of(np.concatenate([faces.vertices for faces in moved]), VIEW)
    tall = (frame[3] - frame[2]) / (frame[1] - frame[0])
    with style.figure(3.6 * len(numbers) + 0.4, float(np.clip(3.6 * tall + 1.2, 3.2, 6.5)), columns=len(numbers)) as (fig, axes):
        for ax, k, still, faces, pose in zip(axes, numbers, rest, moved, poses, strict=True):
            scene.show(ax, scene.picture(faces, VIEW, frame, SPEED(speeds(still, faces, len(pose)))[:, :3]), frame)
            scene.ground(ax, still.vertices, VIEW)
            ax.set_title(f"Mechanism {k}")
        saved = style.save(fig, folder, f"{name}-mechanisms")
    return [(saved, "; ".join(f"{k}: {captions[k]}" for k in numbers) + ". Colours show the speed of each block (red: fastest).")]


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
            ax.plot(way, [row.least_g for row in rows], "_", color=style.HINGE, markersize=9, label="lowest value found")
            ax.legend(loc="lower left", bbox_to_anchor=(-0.17, -0.07), fontsize=7)
        ax.set_ylim(0.0, 1.15 * float(np.nanmax(radius)))
        ax.set_rlabel_position(100.0)
        ax.tick_params(axis="y", labelsize=7)
        ax.set_xlabel("capacity [g]; angles in plan: 0 deg is +x, 90 deg is +y")
        ax.set_title(
            f"Capacity, plotted over the direction of the acceleration\nlowest {r.least_acceleration_g:.4f} g "
            f"along {r.least_direction_deg % 360.0:g} deg (red)"
        )
        return style.save(fig, folder, f"{name}-rose"), (
            "Capacity, plotted over the direction of the acceleration in plan."
            + (" The line is an upper bound (dilatant friction)." if rows else "")
        )
