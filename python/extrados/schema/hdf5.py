"""HDF5 files of others: what of them lies in other files."""

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
            raise Unreadable(f"has groups within more than {DEEPEST} others")
        for name in group:
            link = group.get(name, getlink=True)
            if isinstance(link, h5py.ExternalLink):
                raise Unreadable(f"'{group.name}/{name}' lies in another file, {link.filename[:100]!r}")
            if isinstance(link, h5py.SoftLink):
                raise Unreadable(f"'{group.name}/{name}' is a link; save the file without links")
            one = group[name]
            if isinstance(one, h5py.Dataset):
                if one.external or one.is_virtual:
                    raise Unreadable(f"the numbers of '{one.name}' lie in another file")
            elif isinstance(one, h5py.Group):
                look(one, depth + 1)

    try:
        with h5py.File(path, "r") as file:
            look(file)
    except (OSError, RuntimeError, KeyError, ValueError) as error:
        raise Unreadable(f"is a damaged HDF5 file: {error}") from None
