"""Damages files, by a seed: results, and the texts that post/compare reads."""

import h5py
import numpy as np


def damage(path, seed):
    """Damage a file in one of the ways that fit it; return in words what was done."""
    random = np.random.default_rng(seed)
    ways = [truncate, flip]
    ways += [*IN_HDF5] if path.suffix == ".vtkhdf" else [*IN_TEXT]
    chosen = ways[random.integers(len(ways))]
    return f"{chosen.__name__} {chosen(path, random)}"


def truncate(path, random):
    """End the file early, or with the first byte."""
    content = path.read_bytes()
    kept = int(random.integers(len(content)))
    path.write_bytes(content[:kept])
    return kept


def flip(path, random):
    """Change bytes: anywhere, or where HDF5 keeps most of its structure, in the first 8 kB."""
    content = bytearray(path.read_bytes())
    last = len(content) if random.integers(2) else min(len(content), 8192)
    for place in random.integers(last, size=int(random.integers(1, 60))):
        content[place] = int(random.integers(256))
    path.write_bytes(content)
    return last


def one_of(random, things):
    """Return one of several things."""
    things = list(things)
    return things[int(random.integers(len(things)))]


def change_dataset(path, random, change):
    """Replace a dataset by what `change` makes of its values, its attributes kept."""
    with h5py.File(path, "r+") as file:
        names = []
        file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
        name = one_of(random, names)
        values, attributes = file[name][()], dict(file[name].attrs)
        del file[name]
        change(file, name, values)
        if name in file and isinstance(file[name], h5py.Dataset):
            file[name].attrs.update(attributes)
    return name


def removed(path, random):
    """Remove a dataset or group."""
    with h5py.File(path, "r+") as file:
        names = []
        file.visit(names.append)
        name = one_of(random, names)
        del file[name]
    return name


def shape(path, random):
    """Give a dataset another shape."""
    def change(file, name, values):
        values = np.asarray(values)
        file[name] = one_of(random, [
            lambda: values[:-1] if values.ndim else values[None],
            lambda: np.concatenate([values, values]) if values.ndim else [[values]],
            lambda: values.reshape(-1, 1, 1),
            lambda: values.ravel()[:1].reshape(()) if values.size else values.reshape(0, 0),
            lambda: values[..., None],
            lambda: values.T,
        ])()
    return change_dataset(path, random, change)


def empty(path, random):
    """Empty a dataset: no rows, or no data at all."""
    def change(file, name, values):
        values = np.asarray(values)
        if random.integers(2):
            file[name] = np.zeros((0, *values.shape[1:]), dtype="f8")
        else:
            file[name] = h5py.Empty("f8")
    return change_dataset(path, random, change)


def kind(path, random):
    """Give a dataset values of another kind."""
    def change(file, name, values):
        values = np.asarray(values)
        made = one_of(random, ["S4", "i1", "c16", [("a", "f8")], "text", "f4", "u8", "group"])
        if made == "group":
            file.create_group(name)
        elif made == "text":
            file[name] = ["text"] * (values.shape[0] if values.ndim else 1)
        else:
            file[name] = np.zeros(values.shape, dtype=made)
    return change_dataset(path, random, change)


def values(path, random):
    """Put values in a dataset that no run writes."""
    def change(file, name, values):
        values = np.array(values)
        bad = one_of(random, [np.nan, np.inf, -np.inf, 1e300, -1e300, 0.0, -7.0, 2.0**31 - 1])
        if values.dtype.kind in "iuf" and values.size:
            if values.dtype.kind != "f":
                bad = int(np.nan_to_num(np.clip(bad, 0 if values.dtype.kind == "u" else -1e9,
                                                np.iinfo(values.dtype).max // 2)))
            count = int(random.integers(1, values.size + 1)) if random.integers(2) else 1
            values.flat[random.integers(values.size, size=count)] = bad
        file[name] = values
    return change_dataset(path, random, change)


def huge(path, random):
    """Let a dataset claim more rows than it has."""
    def change(file, name, values):
        values = np.asarray(values)
        rows = 10 ** int(random.integers(7, 13))
        whole = (rows, *values.shape[1:])
        kind = values.dtype if values.dtype.kind in "iuf" else "f8"
        file.create_dataset(name, whole, dtype=kind, chunks=(1024, *(max(n, 1) for n in whole[1:])),
                            maxshape=(None, *whole[1:]))
    return change_dataset(path, random, change)


def attribute(path, random):
    """Remove an attribute, or give it another value."""
    with h5py.File(path, "r+") as file:
        found = []
        file.visititems(lambda name, item: found.extend((name, key) for key in item.attrs))
        name, key = one_of(random, found)
        attributes = file[name].attrs
        del attributes[key]
        other = [None, 7, np.nan, "", "$\\frac{$", b"\xff\xfe", np.zeros(3), np.zeros(0), "a" * 5000]
        bad = one_of(random, other)
        if bad is not None:
            attributes[key] = bad
    return f"{name}@{key}"


def link(path, random):
    """Replace something by a link, to another file or to nowhere."""
    with h5py.File(path, "r+") as file:
        names = []
        file.visit(names.append)
        name = one_of(random, names)
        del file[name]
        file[name] = one_of(random, [h5py.ExternalLink("other.vtkhdf", "/history"),
                                     h5py.SoftLink("/nowhere"), h5py.SoftLink("/history"),
                                     h5py.ExternalLink("/dev/zero", "/")])
    return name


def lines(path, random):
    """Remove, repeat or exchange lines."""
    content = path.read_bytes().split(b"\n")
    k, m = (int(random.integers(len(content))) for _ in "ab")
    if random.integers(3) == 0:
        del content[min(k, m) : max(k, m)]
    elif random.integers(2):
        content[k:k] = content[k : k + 3]
    else:
        content[k], content[m] = content[m], content[k]
    path.write_bytes(b"\n".join(content))
    return k, m


def word(path, random):
    """Put another word in the place of one of a line."""
    content = path.read_bytes().split(b"\n")
    for _ in range(int(random.integers(1, 6))):
        k = int(random.integers(len(content)))
        words = content[k].replace(b",", b" , ").split(b" ")
        other = [b"nan", b"-inf", b"1e999", b"", b"\xff\x00", b"9" * 400, b"****", b",", b"1e-400",
                 b"-1", b"x", b"'\"", b"NaN(1)"]
        words[int(random.integers(len(words)))] = one_of(random, other)
        content[k] = b" ".join(words)
    path.write_bytes(b"\n".join(content))
    return k


def bare(path, random):
    """Leave nothing, blanks, or bytes without any form."""
    path.write_bytes(one_of(random, [b"", b"\n\n", bytes(random.integers(256, size=3000, dtype="u1"))]))
    return ""


IN_HDF5 = (removed, removed, shape, shape, empty, kind, values, values, huge, attribute, link)
IN_TEXT = (lines, word, word, bare)
