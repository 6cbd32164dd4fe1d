"""Command line of post/compare."""

from contextlib import ExitStack
from pathlib import Path

from .. import style
from ..errors import UserError, program
from ..result import completed
from ..tables import write_table
from . import from_csv, from_frd, from_result, mapping, picture, print_file, report
from .blocks import listed
from .compare import compare
from .judge import Tolerance, floors, read_tolerances
from .options import check, parser
from .template import read_template

RESULT_ENDINGS = (".vtkhdf", ".hdf", ".h5", ".hdf5")


def open_source(path, template, stack):
    """Return the source of a file, by its ending."""
    path = completed(path)
    if not path.is_file():
        raise UserError(f"{path}: no such file")
    ending = path.suffix.lower()
    if ending in RESULT_ENDINGS:
        return from_result.read(path, stack)
    if ending == ".frd":
        return from_frd.read(path)
    if ending == ".csv":
        return from_csv.read(path)
    if template:
        return print_file.read(path, template)
    if ending == ".dat":
        return print_file.read_calculix_dat(path)
    raise UserError(f"{path}: is no result, .frd, .dat or .csv; a print file needs --template")


def read_templates(paths):
    """Return all templates as one; None without any."""
    joined = None
    for path in paths:
        template = read_template(path)
        joined = joined.joined(template) if joined else template
    return joined


def run(arguments):
    """Compare what the arguments name; return whether all is within tolerance."""
    options = parser().parse_args(arguments)
    check(options)
    tolerances, mappings = read_tolerances(options.tol), mapping.read_mappings(options.map)
    template = read_templates(options.template)
    usual = Tolerance(options.abs, options.rel, options.block)
    compared, used = [], []
    with ExitStack() as stack:
        a = open_source(options.a, template, stack)
        announce("A", a)
        for path in options.b:
            b = open_source(path, template, stack)
            used += mapping.apply(b, mappings)
            announce("B", b)
            if not b.series:
                continue
            blocks = compare(a, b, options)
            below = floors(blocks)
            for block in blocks:
                tolerance = tolerances.get(block.quantity, usual)
                block.judge(tolerance, options.mismatches, below[block.quantity])
            lines = report.table(blocks, options.all_keys)
            lines += report.remarks(blocks, a, b, options.only)
            print("\n".join(lines))
            compared.append((path, blocks))
        if not compared:
            raise UserError("none of the files B has a value to compare")
        check_used(options, mappings, used, tolerances, compared)
        write(a, compared, options)
    passed = all(report.passed(blocks, options.all_keys) for _, blocks in compared)
    print("all within tolerance" if passed else "NOT within tolerance")
    return passed


def announce(side, source):
    """Print what a file is and what its reader had to say."""
    print(f"{side}: {source.label} ({source.kind})")
    print("".join(f"  {note}\n" for note in source.notes), end="")


def check_used(options, mappings, used, tolerances, compared):
    """Raise the error for options that named something that is nowhere."""
    met = {block.quantity for _, blocks in compared for block in blocks}
    for each in mappings:
        if each not in used:
            raise UserError(f"--map: no B has a quantity or key '{each.other}'")
    for option, names in (("tol", tolerances), ("draw", options.draw), ("only", options.only)):
        for name in names or ():
            if name not in met:
                raise UserError(
                    f"--{option} {name}: is not compared; compared are {listed(sorted(met))}"
                )


def write(a, compared, options):
    """Write picture and tables; print their names."""
    name = f"{Path(a.label).stem}.compare"
    folder, written = Path(options.out), []
    tables = {"blocks": report.block_table}
    tables |= {"rows": report.row_table} if options.rows else {}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for kind, make in tables.items():
            path = folder / f"{name}-{kind}.csv"
            write_table(path, stack([make(label, blocks) for label, blocks in compared]))
            written.append(path)
    except OSError as reason:
        raise UserError(f"{folder}: cannot be written ({reason})") from None
    if not options.no_picture:
        style.apply()
        figure, drawn = picture.draw(a, compared, options)
        written += style.write(figure, drawn, options, name)
    print("\n".join(map(str, written)))


def stack(tables):
    """Return tables of the same columns, of lists, as one."""
    return {name: [value for table in tables for value in table[name]] for name in tables[0]}


@program("compare")
def main(arguments):
    """Run the command line; return the exit status."""
    return 0 if run(arguments) else 1
