"""The series of a CalculiX .frd file, read by pyvista-frd-reader (ASCII and binary)."""

from functools import partial

import numpy as np

from ..errors import UserError
from .series import Series, Source

# Blocks of the file -> names of *VERIFY and of /contact; None is passed over.
BLOCKS = {
    "DISP": ("U1", "U2", None),
    "NDTEMP": ("NT",),
    "STRESS": ("S11", "S22", "S33", "S12", None, None),
    "FORC": ("RF1", "RF2", None),
    "RFL": ("RFL",),
    "FLUX": ("HFL1", "HFL2", None),
    "CONTACT": ("COPEN", "CSLIP1", None, "pressure", "CSHEAR1", None),
}


def read(path):
    """Return the source of a .frd file."""
    from pyvista_frd import FRDError, NativeFile  # here, for it takes half a second to load

    try:
        file = NativeFile(path)
        if file.n_points == 0 or file.n_steps == 0:
            raise UserError(f"{path}: no nodes, or no results, as a CalculiX .frd file has them")
        blocks = [block_names(file, step) for step in range(file.n_steps)]
    except (OSError, FRDError) as reason:
        raise UserError(f"{path}: cannot be read as a CalculiX .frd file ({reason})") from None
    times = np.array(file.step_times)
    source = Source(str(path), "CalculiX .frd", [])
    for contact in (False, True):
        chosen = [[name for name in each if (name == "CONTACT") == contact] for each in blocks]
        # Blocks that only some times have (FREQUENCY=) make series of their own.
        for have in dict.fromkeys(tuple(each) for each in chosen if each):
            steps = [step for step, each in enumerate(chosen) if tuple(each) == have]
            source.series.append(series(file, have, steps, times))
    return source


def block_names(file, step):
    """Return the names of the blocks of a time that are known here."""
    return [name for name, _, _ in file.array_infos(step) if name in BLOCKS]


def series(file, blocks, steps, times):
    """Return the series of some blocks at the steps that have them."""
    names = [name for block in blocks for name in BLOCKS[block] if name]
    names += ["MISES"] if "STRESS" in blocks else []
    names += ["closed"] if "CONTACT" in blocks else []
    frames = [partial(frame, file, blocks, step) for step in steps]
    return Series(names, frames, {"time": times[steps]})


def frame(file, blocks, step):
    """Return the columns of all nodes at one time."""
    points = file.points
    columns = {"node": file.node_ids, "x": points[:, 0], "y": points[:, 1]}
    for block in blocks:
        values = file.array(step, file.find_array(step, block)).reshape(len(points), -1)
        columns |= {name: values[:, k] for k, name in enumerate(BLOCKS[block]) if name}
        if block == "STRESS":
            columns["MISES"] = file.array(step, file.find_array(step, "STRESS_Mises"))
        if block == "CONTACT":
            # The block has a row for every node: zeros where no slave face is in contact.
            columns["closed"] = (values[:, 3] > 0.0).astype(int)
            columns["padding"] = ~np.any(values != 0.0, axis=1)
    return columns
