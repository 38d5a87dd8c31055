"""Files of foreign formats are read by a process with limits: bombs, files that draw on others, readers that never end."""

import base64
import os
import signal
import subprocess
import sys
import time
import zlib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py
import numpy as np
import pytest

from extrados.model.errors import BadGeometry
from extrados.model.geometry.mesh_files import read_mesh_file
from extrados.schema import contained
from extrados.schema.contained import Unreadable, decode, encode, read_contained
from extrados.schema.files import read

HERE = "test_contained"


@pytest.fixture(autouse=True)
def _found_by_the_reader(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The functions of this file are readers, too: of a server that finds them."""
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parent))
    monkeypatch.setattr(contained, "ROOM", 300_000_000)
    contained.end_server()
    yield
    contained.end_server()


def give(content: bytes, **options: object) -> dict[str, object]:
    return {"content": len(content), "options": (1, [2.5, None, "x"], options), "array": np.arange(6.0).reshape(2, 3)}


def fill(content: bytes) -> int:
    return len(bytearray(2_000_000_000))


def give_much(content: bytes) -> np.ndarray:
    return np.zeros(20_000_000)


def spin(content: bytes) -> None:
    while True:
        pass


def sleep(content: bytes) -> None:
    time.sleep(600.0)


def write(content: bytes, path: str) -> str:
    try:
        with open(path, "wb") as file:
            file.write(b"x" * 100_000)
    except OSError as error:
        return f"refused: {error.strerror}"
    return "written"


def open_many(content: bytes) -> int:
    held = []
    try:
        for _ in range(100):
            held.append(os.open("/etc/passwd", os.O_RDONLY))
    except OSError:
        pass
    return len(held)


def die(content: bytes) -> None:
    os.kill(os.getpid(), signal.SIGSEGV)


def parents(content: bytes) -> tuple[int, int]:
    """The watcher of this reader, and the server."""
    stat = Path(f"/proc/{os.getppid()}/stat").read_text()
    return os.getppid(), int(stat.rpartition(")")[2].split()[1])


def refuse(content: bytes) -> None:
    raise Unreadable("is of yesterday", ("structure", "file"))


def test_what_a_reader_gives_comes_back() -> None:
    found = read_contained(f"{HERE}:give", b"abc", name="ü", many=[1, 2])
    assert found["content"] == 3
    assert found["options"] == (1, [2.5, None, "x"], {"name": "ü", "many": [1, 2]})
    np.testing.assert_array_equal(found["array"], np.arange(6.0).reshape(2, 3))


def test_a_reason_comes_back_with_its_key() -> None:
    with pytest.raises(Unreadable, match="is of yesterday") as refused:
        read_contained(f"{HERE}:refuse", b"")
    assert refused.value.at == ("structure", "file")


@pytest.mark.parametrize(
    ("reader", "words"),
    [
        ("fill", "more than 300 MB of memory to read"),
        ("spin", "takes more than 1 s to read"),
        ("sleep", "in the remaining time"),
        ("die", "its reader ended with code -11"),
        ("missing", "its reader ended with code 1"),
    ],
)
def test_a_reader_that_goes_wrong_ends_within_its_limits(reader: str, words: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contained, "SECONDS", 1)
    monkeypatch.setattr(contained, "PATIENCE", 4 if reader == "sleep" else 60)
    with pytest.raises(Unreadable, match=words):
        read_contained(f"{HERE}:{reader}", b"")


def test_a_result_has_a_largest_size(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contained, "ROOM", 2_000_000_000)
    assert read_contained(f"{HERE}:give_much", b"").size == 20_000_000
    monkeypatch.setattr(contained, "LARGEST", 100_000_000)
    with pytest.raises(Unreadable, match="contains more than 100 MB"):
        read_contained(f"{HERE}:give_much", b"")


def test_a_reader_writes_nothing_and_opens_little(tmp_path: Path) -> None:
    assert read_contained(f"{HERE}:write", b"", path=str(tmp_path / "x")).startswith("refused")
    assert not (tmp_path / "x").exists() or (tmp_path / "x").stat().st_size == 0
    assert read_contained(f"{HERE}:open_many", b"") <= contained.FILES


def test_a_signal_ends_the_reader_too() -> None:
    began = time.monotonic()
    before = signal.signal(signal.SIGALRM, lambda *_: (_ for _ in ()).throw(KeyboardInterrupt()))
    signal.setitimer(signal.ITIMER_REAL, 1.0)
    try:
        with pytest.raises(KeyboardInterrupt):
            read_contained(f"{HERE}:sleep", b"")
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert time.monotonic() - began < 300.0


def test_files_are_read_at_the_same_time() -> None:
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda k: read_contained(f"{HERE}:give", bytes(k))["content"], range(40)))
    assert found == list(range(40))


def test_a_server_that_was_killed_is_replaced() -> None:
    first = read_contained(f"{HERE}:parents", b"")
    os.kill(first[1], signal.SIGKILL)
    second = read_contained(f"{HERE}:parents", b"")
    assert second[1] != first[1]


def test_the_server_loads_libraries_once() -> None:
    (one, server), (other, same) = (read_contained(f"{HERE}:parents", b"") for _ in range(2))
    assert server == same
    assert one != other


def test_a_fork_has_a_server_of_its_own() -> None:
    _, server = read_contained(f"{HERE}:parents", b"")
    child = os.fork()
    if child == 0:
        try:
            os._exit(0 if read_contained(f"{HERE}:parents", b"")[1] != server else 1)
        finally:
            contained.end_server()
            os._exit(2)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    assert read_contained(f"{HERE}:parents", b"")[1] == server


def test_server_and_reader_end_with_a_process_that_is_killed() -> None:
    script = f"from extrados.schema.contained import read_contained\nread_contained('{HERE}:sleep', b'')"
    process = subprocess.Popen([sys.executable, "-c", script])
    until = time.monotonic() + 300.0
    while len(numbers := _descendants(process.pid)) < 3:  # the server, a watcher, a reader
        assert process.poll() is None and time.monotonic() < until
        time.sleep(0.01)
    process.kill()
    process.wait()
    while any(_runs(number) for number in numbers):
        assert time.monotonic() < until, f"{numbers} still run"
        time.sleep(0.01)


def _descendants(number: int) -> list[int]:
    try:
        children = [int(n) for n in Path(f"/proc/{number}/task/{number}/children").read_text().split()]
    except OSError:
        return []
    return [n for child in children for n in (child, *_descendants(child))]


def _runs(number: int) -> bool:
    try:
        return Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.parametrize(
    "data", [b"", b"\x05\0\0\0", encode([1])[:-1], encode(np.arange(3))[:-1], b"\x02\0\0\0{}x", b"\x10\0\0\0" + b'{"\\u0000array":7}']
)
def test_damaged_answers_are_refused(data: bytes) -> None:
    with pytest.raises(Unreadable):
        decode(data)


def test_no_object_comes_back() -> None:
    with pytest.raises(ValueError, match="allow_pickle"):
        encode(np.array([object()]))


def _vtu(path: Path, values: int) -> Path:
    """A mesh of one triangle whose cell data unpack to many values."""
    block = zlib.compress(bytes(8 * values), 9)
    head = np.array([1, 8 * values, 0, len(block)], dtype="<u8").tobytes()
    packed = base64.b64encode(head).decode() + base64.b64encode(block).decode()

    def array(name: str, text: str, kind: str, parts: int = 1) -> str:
        return f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{parts}" format="ascii">{text}</DataArray>'

    path.write_text(
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64" compressor="vtkZLibDataCompressor">'
        '<UnstructuredGrid><Piece NumberOfPoints="3" NumberOfCells="1"><Points>'
        + array("Points", "0 0 0 1 0 0 0 1 0", "Float64", 3)
        + "</Points><Cells>"
        + array("connectivity", "0 1 2", "Int64")
        + array("offsets", "3", "Int64")
        + array("types", "5", "Int64")
        + f'</Cells><CellData><DataArray type="Float64" Name="bomb" format="binary">{packed}</DataArray></CellData></Piece>'
        "</UnstructuredGrid></VTKFile>"
    )
    return path


def test_a_mesh_that_unpacks_to_gigabytes_is_refused(tmp_path: Path) -> None:
    pytest.importorskip("meshio")
    assert len(read_mesh_file(read(_vtu(tmp_path / "small.vtu", 1), 10**9)).points) == 3
    bomb = read(_vtu(tmp_path / "bomb.vtu", 200_000_000), 10**9)
    assert len(bomb.content) < 4_000_000
    with pytest.raises(BadGeometry, match=r"bomb\.vtu: this is not a mesh that meshio can read: this file needs more than \d+ MB"):
        read_mesh_file(bomb)


def _med(path: Path, how: str, secret: Path) -> Path:
    with h5py.File(secret, "w") as file:
        file["numbers"] = np.arange(9.0)
    raw = secret.with_suffix(".raw")
    raw.write_bytes(np.arange(9.0).tobytes())
    with h5py.File(path, "w") as file:
        group = file.create_group("ENS_MAA").create_group("mesh")
        if how == "external link":
            group["COO"] = h5py.ExternalLink(str(secret), "numbers")
        elif how == "virtual":
            layout = h5py.VirtualLayout((9,), "f8")
            layout[:] = h5py.VirtualSource(str(secret), "numbers", (9,))
            group.create_virtual_dataset("COO", layout)
        elif how == "external numbers":
            group.create_dataset("COO", (9,), "f8", external=[(str(raw), 0, 72)])
        else:
            group["COO"] = h5py.SoftLink("/elsewhere")
    return path


@pytest.mark.parametrize("how", ["external link", "virtual", "external numbers", "soft link"])
def test_a_mesh_that_draws_on_another_file_is_refused(how: str, tmp_path: Path) -> None:
    pytest.importorskip("meshio")
    outside, inside = tmp_path / "outside", tmp_path / "inside"
    outside.mkdir()
    inside.mkdir()
    path = _med(inside / "mesh.med", how, outside / "secret.h5")
    with pytest.raises(BadGeometry, match=r"in another file|is a link"):
        read_mesh_file(read(path, 10**9))
