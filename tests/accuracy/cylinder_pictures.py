"""Pictures of the published cylinder: convergence with bands, and the readings of the paper."""

import numpy as np
from convergence import rms
from cylinder_courses import INCREMENTS, QUANTITIES
from pictures import save, style, subplots


def convergence(off, best, steps, where, loads, path):
    """Draw the errors against the mesh, a panel a quantity, and the changes by the increments."""
    figure, panels = subplots(2, 3, 4.6, sharex=False)
    shades = style.shades(len(where))
    for k, (quantity, axes) in enumerate(zip(QUANTITIES, panels.flat, strict=False)):
        elements = 10 * 2.0 ** np.arange(len(off[quantity]))
        edge = quantity.startswith("edge")
        unit, factor = ("cm", 1.0) if edge else ("%", 100.0)
        order = min(best[quantity].mesh.order, 2.0)
        band, of_mesh = (factor * rms(each.band) for each in (best[quantity], best[quantity].mesh))
        rising = band + of_mesh * (2.0 ** (order * np.arange(len(elements))[::-1]) - 1)
        floor = band / 30
        axes.fill_between(elements, rising, floor, color="#E6E6E6", linewidth=0)
        for load, at, shade, sign in zip(loads, where, shades, style.MARKERS, strict=False):
            errors = factor * np.abs([values[at] for values in off[quantity]])
            axes.plot(elements[:-1], np.maximum(errors, floor)[:-1], color=shade, marker=sign,
                      linestyle=":", linewidth=0.6, label=f"{load} °C")
        axes.plot(elements[:-1], [factor * rms(values) for values in off[quantity]][:-1],
                  color=style.BLACK, linewidth=1.4, label="rms")
        axes.errorbar(elements[-1:], [band], yerr=[[band - floor], [0]], color=style.BLACK,
                      capsize=2.5, linewidth=1.0)
        axes.set(xscale="log", yscale="log", xlim=(8, 200), ylim=(floor, None),
                 ylabel=f"error, {unit}")
        axes.set_xticks(elements, [f"{n:.0f}" for n in elements])
        axes.set_xticks([], minor=True)
        axes.set_xlabel("elements along the contact")
        axes.axvline(elements[0], color=style.VERMILION, linewidth=0.8, linestyle="--")
        axes.annotate("the paper's mesh", (elements[0], 0.03), (4, 0), fontsize=6.5, rotation=90,
                      xycoords=("data", "axes fraction"), textcoords="offset points",
                      color=style.VERMILION)
        style.panel_title(axes, f"{quantity}, order {best[quantity].mesh.order:.1f}", "abcde"[k])
    increments_panel(panels.flat[-1], steps)
    panels.flat[0].legend(loc="upper right", fontsize=6.5, handlelength=1.6, labelspacing=0.2)
    save(figure, path)


def increments_panel(axes, steps):
    """Draw what halving the increments changes on two meshes, all quantities in one panel."""
    for k, quantity in enumerate(QUANTITIES):
        factor, unit = (1.0, "cm") if quantity.startswith("edge") else (100.0, "%")
        for sizes, line in zip(steps[quantity], (":", "-"), strict=True):
            axes.plot(INCREMENTS[:-1], factor * np.array(sizes), line, color=style.SERIES[k],
                      marker=style.marker(k), label=f"{quantity}, {unit}" if line == "-" else None)
    axes.set(xscale="log", yscale="log", ylim=(1e-6, 60.0), xlabel="increments",
             ylabel="change by halving them")
    axes.set_xticks(INCREMENTS[:-1], map(str, INCREMENTS[:-1]))
    axes.set_xticks([], minor=True)
    axes.legend(loc="upper center", fontsize=6, ncols=2, handlelength=1.4, columnspacing=0.8)
    style.panel_title(axes, "increments, 10 and 80 elements", "f")


def readings(results, where, loads, path):
    """Draw each reading's change against ours, a panel a quantity, a dot a temperature."""
    names = [name for name in results if name != "ours"][::-1]
    figure, panels = subplots(1, len(QUANTITIES), 2.6, sharey=True)
    shades = style.shades(len(where))
    for quantity, axes in zip(QUANTITIES, panels, strict=True):
        ours = results["ours"][quantity]
        axes.axvline(0.0, color=style.GREY, linewidth=0.6)
        for row, name in enumerate(names):
            other = results[name][quantity]
            for load, at, shade, sign in zip(loads, where, shades, style.MARKERS, strict=False):
                mine = ours.value[at] * ours.scale[at]
                change = 100 * (other.value[at] * other.scale[at] / mine - 1)
                band = other.band[at] * other.scale[at] + ours.band[at] * ours.scale[at]
                height = row + 0.5 - (list(loads).index(load) + 1) / 6
                axes.errorbar(change, height, xerr=100 * band / mine, color=shade, marker=sign,
                              markersize=3, linewidth=0.6, label=f"{load} °C" if row == 0 else None)
        axes.set_xlabel("change, %")
        axes.locator_params(axis="x", nbins=5)
        axes.grid(axis="x", linewidth=0.3, color="#D0D0D0")
        for line in range(1, len(names)):
            axes.axhline(line - 0.5, color="#D0D0D0", linewidth=0.3)
        style.panel_title(axes, quantity)
    panels[0].set_yticks(range(len(names)), names)
    panels[0].set_ylim(-0.5, len(names) - 0.5)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=5)
    save(figure, path)
