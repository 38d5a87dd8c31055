"""HDF5 files of others: what of them lies in other files, and the arrays of a results file.

The contained process calls the functions `parse_...` (`contained`).
"""

from typing import Any

from extrados.schema.contained import Unreadable

SIGNATURE = b"\x89HDF\r\n\x1a\n"
DEEPEST = 50  # groups within groups


def is_hdf5(path: str) -> bool:
    """Whether a file says that it is HDF5."""
    with open(path, "rb") as file:
        return file.read(len(SIGNATURE)) == SIGNATURE


def lies_elsewhere(store: Any, file: Any) -> bool:
    """Whether the numbers of an array do not all lie in the file: they are in files elsewhere, or one stands for
    gigabytes."""
    return bool(store.file != file or store.external or store.is_virtual or store.nbytes > store.id.get_storage_size())


def refuse_elsewhere(path: str) -> None:
    """Unreadable where a link or an array of a file draws on another file."""
    import h5py

    def look(group: Any, depth: int = 0) -> None:
        if depth > DEEPEST:
            raise Unreadable(f"this file has groups nested more than {DEEPEST} levels deep")
        for name in group:
            link = group.get(name, getlink=True)
            if isinstance(link, h5py.ExternalLink):
                raise Unreadable(f"the data of '{group.name}/{name}' are in another file, {link.filename[:100]!r}")
            if isinstance(link, h5py.SoftLink):
                raise Unreadable(f"'{group.name}/{name}' is a link: save the file without links")
            one = group[name]
            if isinstance(one, h5py.Dataset):
                if one.external or one.is_virtual:
                    raise Unreadable(f"the numbers of '{one.name}' are in another file")
            elif isinstance(one, h5py.Group):
                look(one, depth + 1)

    try:
        with h5py.File(path, "r") as file:
            look(file)
    except (OSError, RuntimeError, KeyError, ValueError) as error:
        raise Unreadable(f"this is a damaged HDF5 file: {error}") from None


def parse_arrays(source: bytes | str, marks: list[str], long: int | None) -> dict[str, dict[str, dict[str, Any]]]:
    """The arrays of the groups of a results file by their names: those with the first of the attributes `marks`.

    Each is its numbers as `data`, or its texts with their `shape`; the names of its axes, `dims`; its attributes. Of an array
    of numbers along one axis longer than `long`, `dtype` and `length` stand for the numbers, see `parse_rows`.
    """
    with _opened(source) as file:
        return {
            name: {
                title: _array(store, file, title, marks, long)
                for title, store in group.items()
                if _whole(store, file, title) and marks[0] in store.attrs
            }
            for name, group in file.items()
        }


def parse_rows(path: str, group: str, title: str, first: int, end: int) -> Any:
    """Rows first .. end - 1 of an array of a group."""
    with _opened(path) as file:
        store = file[group][title]
        _whole(store, file, title)
        return store[first:end]


class _opened:
    """An HDF5 file; whatever its library raises within the block is that the file cannot be read."""

    def __init__(self, source: bytes | str):
        self.source = source

    def __enter__(self) -> Any:
        import h5py

        try:
            inside = isinstance(self.source, bytes)
            self.file = h5py.File.in_memory(self.source) if inside else h5py.File(self.source, "r")
        except Exception as error:
            self.__exit__(None, error, None)
        return self.file

    def __exit__(self, kind: Any, error: BaseException | None, trace: Any) -> None:
        if isinstance(error, Exception) and not isinstance(error, Unreadable | MemoryError):
            raise Unreadable(f"{type(error).__name__ if isinstance(error, KeyError) else ''} {error}".strip()) from None


def _whole(store: Any, file: Any, title: str) -> bool:
    """Unreadable where a dataset, or what should be one, does not lie in the file whole."""
    if store is None or lies_elsewhere(store, file):
        raise Unreadable(f"the data of '{title}' are not complete in this file; extrados does not write such files")
    return True


def _array(store: Any, file: Any, title: str, marks: list[str], long: int | None) -> dict[str, Any]:
    import h5py

    dims = [title if not len(d) else d[0].name.rsplit("/", 1)[1] for d in store.dims]
    said = {"dims": dims, "marks": [str(store.attrs.get(mark, "")) for mark in marks]}
    if h5py.check_string_dtype(store.dtype):
        data = store.asstr()[()]
        return {**said, "data": [str(text) for text in data.ravel()], "shape": list(data.shape)}
    if store.dtype.kind not in "iufbc":
        raise Unreadable(f"'{title}' contains {store.dtype}; expected numbers or text")
    if long is not None and store.ndim == 1 and len(store) > long and store.dtype.kind in "iuf":
        return {**said, "length": len(store), "dtype": store.dtype.str}
    return {**said, "data": store[()]}
