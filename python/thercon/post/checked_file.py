"""Opens a result file and makes sure that reading it stays inside it and needs no more memory than
it has content."""

import os

import h5py
import numpy as np

from .errors import UserError

DEFLATION = 1032  # the most that a filter makes data smaller
UNWRITTEN = 2**20  # bytes of a dataset that may have no storage because nobody wrote them


def open_checked(path):
    """Return an HDF5 file, open for reading, that asks for no other file."""
    try:
        file = h5py.File(path, "r")
    except Exception as reason:  # noqa: BLE001  HDF5 tells a damaged file in many ways
        raise UserError(f"{path}: is not an HDF5 file that can be read ({reason})") from None
    try:
        names = []
        file.id.links.visit(names.append)  # follows hard links alone
        for name in map(os.fsdecode, names):
            check(file, name, file.get(name, getlink=True))
    except UserError as reason:
        file.close()
        raise UserError(f"{path}: {reason}") from None
    except Exception as reason:  # noqa: BLE001
        file.close()
        raise UserError(f"{path}: is damaged ({reason})") from None
    return file


def check(file, name, link):
    """Raise the error for one object of a file: a link, or data of another size than it has."""
    if not isinstance(link, h5py.HardLink):
        raise UserError(f"/{name} is a link to another place, which is not followed: a result has none")
    found = file[name]
    if not isinstance(found, h5py.Dataset):
        return
    if found.external or found.is_virtual:
        raise UserError(f"/{name} is kept in another file, which is not read: a result is one file")
    if found.dtype.kind not in "biufSO" or (found.dtype.kind == "O"
                                            and not h5py.check_string_dtype(found.dtype)):
        raise UserError(f"/{name} holds neither numbers nor texts: the file is damaged")
    stored = found.id.get_storage_size()
    stored *= DEFLATION if found.id.get_create_plist().get_nfilters() else 1
    chunk = int(np.prod(found.chunks or (0,), dtype=float)) * found.dtype.itemsize
    if found.size and max(found.nbytes, chunk) > max(stored, UNWRITTEN):
        raise UserError(f"/{name} claims to be larger than what is stored of it: the file is damaged")


def need(group, holds, words):
    """Raise the error that says what is wrong with a group, unless the condition `holds`."""
    if not holds:
        raise UserError(f"{group.file.filename}: {group.name}: {words}: the file is damaged, or of "
                        "another program")


def numbers(group, name, like=None, finite=False):
    """Return a dataset of numbers; `like` gives its shape, None in it any number.

    `finite` demands that none of the numbers is NaN or infinite.
    """
    found = group.get(name)
    there = isinstance(found, h5py.Dataset) and found.shape is not None
    need(group, there, f"there is no dataset {name}")
    need(group, found.dtype.kind in "biuf", f"{name} holds no numbers")
    if like is not None:
        fits = len(like) == len(found.shape) and all(
            size in (None, have) for size, have in zip(like, found.shape))
        shape = " by ".join("any" if size is None else str(size) for size in like)
        need(group, fits, f"{name} has the shape {found.shape} instead of ({shape})")
    try:
        values = found[()]
    except OSError as reason:
        need(group, False, f"{name} cannot be read ({reason})")
    need(group, not finite or np.isfinite(values).all(), f"{name} has values that are no numbers")
    return values
