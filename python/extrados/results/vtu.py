"""Fields on unstructured meshes as VTU, and series of them as PVD; ParaView reads both."""

import base64
from collections.abc import Mapping, Sequence
from xml.sax.saxutils import quoteattr

import numpy as np

POLYGON = 7
CELLS = {"T3": 5, "Q4": 9, "T6": 22, "Q8": 23, "points": 1}
_NAMES = {"f": "Float64", "i": "Int64", "u": "UInt8"}


def _data(name: str, values: np.ndarray) -> str:
    """One DataArray, base64 with an 8-byte length."""
    values = np.asarray(values)
    kind = values.dtype.kind if values.dtype.kind in "fu" else "i"
    values = np.ascontiguousarray(values, dtype={"f": "<f8", "i": "<i8", "u": "u1"}[kind])
    raw = values.tobytes()
    text = base64.b64encode(np.array([len(raw)], dtype="<u8").tobytes() + raw).decode()
    parts = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    return f'<DataArray type="{_NAMES[kind]}" Name={quoteattr(name)}{parts} format="binary">{text}</DataArray>'


def _three(values: np.ndarray) -> np.ndarray:
    """Plane vectors with a third component of zero; those in space as they are."""
    return values if values.shape[1] == 3 else np.column_stack([values, np.zeros(len(values))])


def vtu(
    xy: np.ndarray,
    cells: Sequence[tuple[str, np.ndarray]],
    point_data: Mapping[str, np.ndarray] | None = None,
    cell_data: Mapping[str, np.ndarray] | None = None,
) -> bytes:
    """One unstructured grid: xy (nodes, 2 or 3) [m], cells as (kind, connect (n, nodes)); vectors (n, 2) get a z of 0."""
    connect = np.concatenate([c.ravel() for _, c in cells])
    ends = np.cumsum(np.concatenate([np.full(len(c), c.shape[1]) for _, c in cells]))
    kinds = np.concatenate([np.full(len(c), CELLS[k], dtype=np.uint8) for k, c in cells])

    def fields(data: Mapping[str, np.ndarray] | None) -> str:
        return "".join(
            _data(n, _three(np.asarray(v, dtype=float)) if np.ndim(v) == 2 and np.shape(v)[1] == 2 else v) for n, v in (data or {}).items()
        )

    return (
        '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
        f'header_type="UInt64"><UnstructuredGrid><Piece NumberOfPoints="{len(xy)}" NumberOfCells="{len(kinds)}">'
        f"<PointData>{fields(point_data)}</PointData><CellData>{fields(cell_data)}</CellData>"
        f"<Points>{_data('Points', _three(np.asarray(xy, dtype=float)))}</Points>"
        f"<Cells>{_data('connectivity', connect)}{_data('offsets', ends)}{_data('types', kinds)}</Cells>"
        "</Piece></UnstructuredGrid></VTKFile>\n"
    ).encode()


def vtu_faces(
    xyz: np.ndarray, faces: Sequence[np.ndarray], point_data: Mapping[str, np.ndarray], cell_data: Mapping[str, np.ndarray]
) -> bytes:
    """Faces of solids as polygons: xyz (nodes, 3) [m], each face as numbers of nodes."""
    connect, ends = np.concatenate(faces), np.cumsum([len(face) for face in faces])
    fields = ["".join(_data(n, v) for n, v in data.items()) for data in (point_data, cell_data)]
    return (
        '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
        f'header_type="UInt64"><UnstructuredGrid><Piece NumberOfPoints="{len(xyz)}" NumberOfCells="{len(faces)}">'
        f"<PointData>{fields[0]}</PointData><CellData>{fields[1]}</CellData><Points>{_data('Points', xyz)}</Points>"
        f"<Cells>{_data('connectivity', connect)}{_data('offsets', ends)}"
        f"{_data('types', np.full(len(faces), POLYGON, dtype=np.uint8))}</Cells></Piece></UnstructuredGrid></VTKFile>\n"
    ).encode()


def pvd(files: Sequence[tuple[float, str]]) -> bytes:
    """A series: (time or event number, file name relative to the PVD)."""
    rows = "".join(f'<DataSet timestep="{t:g}" part="0" file={quoteattr(name)}/>' for t, name in files)
    return f'<?xml version="1.0"?>\n<VTKFile type="Collection" version="1.0"><Collection>{rows}</Collection></VTKFile>\n'.encode()
