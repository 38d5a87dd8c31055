"""Files of a discrete-element run for other programs: VTU and PVD for fields."""

import io

import numpy as np

from extrados.analyses.dem.model import Model
from extrados.analyses.dem.tables import Dem
from extrados.core import dem

#: Frames of a PVD collection, at most.
MOST_FRAMES = 300


def files(model: Model, run: dem.Run, options: Dem) -> dict[str, bytes]:
    """Name -> bytes of what the deck asks for."""
    out: dict[str, bytes] = {}
    if len(run.time) and options.vtk:
        out |= collection(model, run)
    return out


def frames(run: dem.Run) -> np.ndarray:
    """Output times that are kept."""
    step = max(1, int(np.ceil(len(run.time) / MOST_FRAMES)))
    return np.arange(0, len(run.time), step)


def collection(model: Model, run: dem.Run) -> dict[str, bytes]:
    """One VTU of all parts per frame, and the PVD that puts them in order."""
    out, entries = {}, []
    for number, k in enumerate(frames(run)):
        name = f"dem/frame_{number:04d}.vtu"
        out[name] = vtu(model, run, int(k))
        entries.append(f'<DataSet timestep="{run.time[k]:.9g}" file="{name}"/>')
    text = (
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian"><Collection>\n'
        + "\n".join(entries)
        + "\n</Collection></VTKFile>\n"
    )
    out["dem.pvd"] = text.encode()
    return out


def vtu(model: Model, run: dem.Run, k: int) -> bytes:
    """All convex parts as polygons at output k, with body, velocity and spin."""
    r = model.rigid
    points, sizes, owner = [], [], []
    for part, body in zip(r.parts, r.owner, strict=True):
        x, y, turn = run.place[k, body]
        c, s = np.cos(turn), np.sin(turn)
        arm = part - r.centroid[body]
        points.append(np.stack([x + c * arm[:, 0] - s * arm[:, 1], y + s * arm[:, 0] + c * arm[:, 1]], axis=1))
        sizes.append(len(part))
        owner.append(body)
    xyz = np.column_stack([np.concatenate(points), np.zeros(sum(sizes))])
    rate = run.rate[k, owner]
    velocity = np.column_stack([rate[:, :2], np.zeros(len(owner))])
    text = io.StringIO()

    def data(name: str, kind: str, values: np.ndarray, components: int = 1) -> None:
        text.write(f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="ascii">\n')
        text.write(" ".join(f"{v:.9g}" if kind == "Float64" else str(int(v)) for v in np.ravel(values)))
        text.write("\n</DataArray>\n")

    text.write('<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">')
    text.write(f'<UnstructuredGrid><Piece NumberOfPoints="{len(xyz)}" NumberOfCells="{len(sizes)}">\n<Points>\n')
    data("points", "Float64", xyz, 3)
    text.write("</Points>\n<Cells>\n")
    data("connectivity", "Int64", np.arange(len(xyz)))
    data("offsets", "Int64", np.cumsum(sizes))
    data("types", "UInt8", np.full(len(sizes), 7))
    text.write("</Cells>\n<CellData>\n")
    data("body", "Int64", np.array(owner))
    data("velocity", "Float64", velocity, 3)
    data("spin", "Float64", rate[:, 2])
    text.write("</CellData>\n</Piece></UnstructuredGrid></VTKFile>\n")
    return text.getvalue().encode()
