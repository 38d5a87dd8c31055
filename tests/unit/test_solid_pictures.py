"""Pictures and files of solids: the depth buffer against closed forms, glTF and VTU read back."""

import json
import struct
from pathlib import Path

import meshio
import numpy as np
import pytest
from PIL import Image

import extrados
from extrados.model.geometry.solids.polyhedra import Polyhedron, box
from extrados.results.solid_files import glb, quaternions, rotations, series
from extrados.show import scene

FRONT = scene.View(azimuth=-90.0, elevation=0.0)  # x to the right, z up
COLOURS = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def faces(*bodies: Polyhedron) -> scene.Faces:
    start = np.cumsum([0, *(len(b.vertices) for b in bodies)])
    loops = [np.array(f) + k for b, k in zip(bodies, start[:-1].tolist(), strict=True) for f in b.faces]
    return scene.Faces(np.concatenate([b.vertices for b in bodies]), loops, np.repeat(range(len(bodies)), [len(b.faces) for b in bodies]))


def areas(image: np.ndarray, frame: tuple[float, float, float, float]) -> list[float]:
    """What of the frame [m^2] shows each of the two colours."""
    cell = (frame[1] - frame[0]) * (frame[3] - frame[2]) / image.shape[0] / image.shape[1]
    red, green = image[..., 0] > 2.0 * image[..., 1], image[..., 1] > 2.0 * image[..., 0]
    return [float((c & (image[..., 3] > 0.5)).sum()) * cell for c in (red, green)]


def test_what_stands_before_hides_what_stands_behind() -> None:
    frame = (-0.5, 3.5, -0.5, 2.5)
    near, far = box((0, 0, 0), (2, 1, 2)), box((1, 2, 0), (3, 3, 1))
    for bodies in ((near, far), (far, near)):
        image = scene.picture(faces(*bodies), FRONT, frame, COLOURS if bodies[0] is near else COLOURS[::-1])
        seen = areas(image, frame)
        assert seen == pytest.approx([4.0, 1.0], rel=0.03)


def test_bodies_that_pierce_each_other_are_cut_where_they_meet() -> None:
    """No order of painting draws these right: a slab that runs through another, seen half."""
    frame = (-2.0, 2.0, -2.0, 2.0)
    flat = box((-1, -0.1, -1), (1, 0.1, 1))
    oblique = flat.moved(rotations(np.array([[0.0, 0.0, np.pi / 4]]))[0])
    seen = areas(scene.picture(faces(flat, oblique), FRONT, frame, COLOURS), frame)
    # in the projection the turned slab covers |x| < .78; its half behind the flat one shows beyond x = 1 nowhere
    assert seen[0] + seen[1] == pytest.approx(4.0, rel=0.03) and min(seen) > 1.0


def test_rotations_and_quaternions_agree() -> None:
    vectors = np.random.default_rng(1).normal(size=(50, 3))
    vectors[0] = 0.0
    x, y, z, w = quaternions(vectors).T
    turned = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)], axis=1)
    assert turned == pytest.approx(rotations(vectors)[:, :, 0], abs=1e-14)
    assert rotations(np.array([[0, 0, np.pi / 2]]))[0] @ [1, 0, 0] == pytest.approx([0, 1, 0], abs=1e-15)


BODIES = [box((0, 0, 0), (1, 1, 1)), box((0.2, 0.2, 1), (0.8, 0.8, 2)), box((2, 0, 0), (3, 1, 1))]
OWNER, CENTRES = np.array([0, 0, 1]), np.array([[0.5, 0.5, 0.7], [2.5, 0.5, 0.5]])
POSES = np.array([[[0.0] * 6, [0.0] * 6], [[0.1, 0.2, 0.3, 0.0, 0.4, 0.0], [0.0] * 6]])


def chunks(content: bytes) -> tuple[dict, bytes]:
    magic, version, total = struct.unpack("<4sII", content[:12])
    assert magic == b"glTF" and version == 2 and total == len(content)
    size, kind = struct.unpack("<I4s", content[12:20])
    assert kind == b"JSON" and size % 4 == 0
    body = content[20 + size :]
    assert struct.unpack("<I4s", body[:8]) == (len(body) - 8, b"BIN\0")
    return json.loads(content[20 : 20 + size]), body[8:]


def test_gltf_holds_the_stones_and_their_motion() -> None:
    scene_of, body = chunks(glb(BODIES, OWNER, CENTRES, ["pier", "block"], np.array([0.0, 2.0]), POSES))
    assert [n["name"] for n in scene_of["nodes"]] == ["pier", "block", "z up"]

    def values(k: int) -> np.ndarray:
        accessor = scene_of["accessors"][k]
        view = scene_of["bufferViews"][accessor["bufferView"]]
        raw = np.frombuffer(body, "<f4", view["byteLength"] // 4, view["byteOffset"])
        return raw.reshape(accessor["count"], -1)

    points = values(scene_of["meshes"][0]["primitives"][0]["attributes"]["POSITION"]) + CENTRES[0]
    triangles = points.reshape(-1, 3, 3).astype(float)
    volume = np.einsum("ti,ti->t", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])).sum() / 6.0
    assert volume == pytest.approx(1.0 + 0.36, rel=1e-6)  # closed, and outward
    (motion,) = scene_of["animations"]
    assert {c["target"]["node"] for c in motion["channels"]} == {0}  # what stands still has no channel
    moved = {c["target"]["path"]: values(motion["samplers"][c["sampler"]]["output"]) for c in motion["channels"]}
    assert moved["translation"][-1] == pytest.approx(CENTRES[0] + [0.1, 0.2, 0.3], abs=1e-6)
    assert moved["rotation"][-1] == pytest.approx([0, np.sin(0.2), 0, np.cos(0.2)], abs=1e-6)


def test_vtu_series_is_read_by_others(tmp_path: Path) -> None:
    files = series("mechanism", BODIES, OWNER, CENTRES, np.array([0.0, 1.0]), POSES)
    for name, content in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(content)
    last = meshio.read(tmp_path / "mechanism" / "frame_0001.vtu")
    assert len(last.points) == 24 and sum(len(c.data) for c in last.cells) == 18
    rest = np.concatenate([b.vertices for b in BODIES])
    turn = rotations(np.array([[0.0, 0.4, 0.0]]))[0]
    assert last.points[:16] == pytest.approx(CENTRES[0] + [0.1, 0.2, 0.3] + (rest[:16] - CENTRES[0]) @ turn.T, abs=1e-12)
    assert last.point_data["displacement"][16:] == pytest.approx(np.zeros((8, 3)), abs=1e-15)
    assert (tmp_path / "mechanism.pvd").read_text().count("<DataSet") == 2


def test_a_mechanism_becomes_a_film(tmp_path: Path) -> None:
    deck = tmp_path / "stack.toml"
    deck.write_text(
        '[structure]\nkind = "column"\nsection = "round"\nsides = 6\nwidth = 1\nheight = 3\ndrums = 2\n'
        '[[analysis]]\nkind = "tilt"\nrose = 4\nanimation = "gif"\nanimation_speed = 10\n'
    )
    extrados.run(deck, out=tmp_path / "out", figures=True)
    film = Image.open(tmp_path / "out" / "figures" / "tilt.gif")
    assert film.size == (1280, 720) and film.n_frames == 7
    film.seek(0)
    first = np.asarray(film.convert("RGB")).astype(int)
    film.seek(3)
    assert np.abs(np.asarray(film.convert("RGB")) - first).max() > 50
