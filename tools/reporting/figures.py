# SPDX-License-Identifier: Apache-2.0
"""The report's figures: each function takes rows of the standard study and returns a matplotlib figure."""
import math

import matplotlib.pyplot as plt
import numpy

from . import record

STYLES = ["-", "--", "-.", ":"]
AXIS_TITLES = {"subtexel_bits": "sub-texel (weight) bits", "level_bits": "level bits", "blend_bits": "bits kept between levels", "coordinate_bits": "coordinate bits",
               "offset_bits": "numerator bits", "reciprocal_bits": "1/w bits", "tolerance_bits": "tolerance bits"}


def panels(count, columns, width=3.4, height=2.7):
    rows = math.ceil(count / columns)
    figure, axes = plt.subplots(rows, columns, figsize=(width * columns, height * rows), squeeze=False)
    flat = list(axes.flat)
    for axis in flat[count:]:
        axis.set_visible(False)
    return figure, flat[:count]


def legend_below(figure, place, columns):
    """For panels whose lines leave no room."""
    figure.legend(*place.get_legend_handles_labels(), loc="upper center", bbox_to_anchor=(0.5, 0), ncol=columns)


def finite(number, ceiling):
    return min(number, ceiling) if not math.isnan(number) else math.nan


def words(rows):
    """Loss against the longest words, one word length at a time."""
    axes = list(AXIS_TITLES)
    figure, places = panels(len(axes), 4, 3.1, 2.6)
    for place, axis in zip(places, axes):
        for scene in record.values(rows, "scene"):
            line = record.base_of(rows, axis, scene)
            place.plot([r[axis] for r in line], [max(line[-1]["psnr_db"] - r["psnr_db"], 1e-4) for r in line], marker="o", label=scene)
        place.set(xlabel=AXIS_TITLES[axis], ylabel="PSNR lost, dB", yscale="log", ylim=(1e-4, 100))
        place.axhline(0.1, linewidth=0.8, linestyle="--", color=plt.rcParams["text.color"])
    places[0].legend()
    return figure


def word_errors(rows):
    """Worst errors of coordinates and colours by word length."""
    panel = [("coordinate_bits", "coordinate_worst_texels", 1 / 256), ("offset_bits", "coordinate_worst_texels", 1 / 256), ("reciprocal_bits", "coordinate_worst_texels", 1 / 256),
             ("tolerance_bits", "coordinate_worst_texels", 1 / 256), ("subtexel_bits", "twin_worst_lsb", 1), ("level_bits", "twin_worst_lsb", 1),
             ("blend_bits", "twin_worst_lsb", 1), ("level_bits", "level_worst", 1 / 256)]
    titles = {"coordinate_worst_texels": "worst coordinate error, texels", "twin_worst_lsb": "worst colour error, LSB", "level_worst": "worst level error"}
    figure, places = panels(len(panel), 4, 3.1, 2.6)
    for place, (axis, measure, limit) in zip(places, panel):
        for scene in record.values(rows, "scene"):
            line = record.base_of(rows, axis, scene)
            place.plot([r[axis] for r in line], [max(r[measure], 1e-6) if measure != "twin_worst_lsb" else max(r[measure], 0.5) for r in line], marker="o", label=scene)
        place.set(xlabel=AXIS_TITLES[axis], ylabel=titles[measure], yscale="log")
        if measure == "twin_worst_lsb":
            place.set_ylim(0.4, 100)
        place.axhline(limit, linewidth=0.8, linestyle="--", color=plt.rcParams["text.color"])
    places[0].legend()
    return figure


def pareto(rows, scenes):
    """Quality over each cost; the front of what no other point beats."""
    costs = [("word_bits", "bits of the words of a pixel"), ("product_bits_per_pixel", "product bits a pixel"), ("cycles_per_pixel", "cycles a pixel"),
             ("words_per_pixel", "64-bit words a pixel"), ("memory_bits", "Kbit of both local memories")]
    unit = {"memory_bits": 1 / 1024}
    figure, places = panels(len(costs) * len(scenes), len(costs), 2.9, 2.6)
    for k, place in enumerate(places):
        scene, (cost, title) = scenes[k // len(costs)], costs[k % len(costs)]
        for mark, filter_name in zip("ox", ("trilinear", "trilinear3")):
            part = record.select(rows, scene=scene, filter=filter_name)
            place.plot([r[cost] * unit.get(cost, 1) for r in part], [r["psnr_db"] for r in part], mark, markersize=2.5, alpha=0.6, label=filter_name)
        line = record.front([(r[cost] * unit.get(cost, 1), r["psnr_db"], r) for r in record.select(rows, scene=scene)])
        place.step([p[0] for p in line], [p[1] for p in line], where="post", linewidth=1.4, label="front")
        place.set(xlabel=title, ylabel=f"PSNR, dB ({scene})")
    places[0].legend()
    return figure


def heat(place, grid, across, down, title, x_title, y_title, form="{:.1f}", log=False):
    shown = numpy.log2(grid) if log else grid
    place.imshow(shown, aspect="auto", cmap="viridis" if not log else "viridis_r", origin="lower")
    low, high = numpy.nanmin(shown), numpy.nanmax(shown)
    for (y, x), value in numpy.ndenumerate(shown):
        if math.isfinite(value):
            light = (value - low) / (high - low + 1e-9)
            bright = light > 0.6 if not log else light < 0.4
            place.text(x, y, form.format(value), ha="center", va="center", fontsize=6.5, color="black" if bright else "white")
    place.set_xticks(range(len(across)), [str(a) for a in across])
    place.set_yticks(range(len(down)), [str(d) for d in down])
    place.grid(False)
    place.set(title=title, xlabel=x_title, ylabel=y_title)


def grid_of(rows, across, down, measure):
    xs, ys = record.values(rows, across), record.values(rows, down)
    return numpy.array([[record.mean([r[measure] for r in record.select(rows, **{across: x, down: y})]) for x in xs] for y in ys]), xs, ys


def reciprocals(rows):
    figure, places = panels(3, 3, 4.2, 3.2)
    for place, steps in zip(places, (0, 1, 2)):
        grid, xs, ys = grid_of(record.select(rows, reciprocal_iterations=steps), "reciprocal_table_log2", "reciprocal_bits", "coordinate_worst_texels")
        heat(place, grid, xs, ys, f"{steps} Newton step{'s' if steps != 1 else ''}", "log2 of the table's entries", "1/w bits", "{:.1f}", True)
    return figure


def angle_maps(rows, filters):
    figure, places = panels(len(filters), 3, 4.2, 3.0)
    for place, name in zip(places, filters):
        grid, xs, ys = grid_of(record.select(rows, filter=name), "minification_16", "pitch_degrees", "psnr_db")
        heat(place, grid, [x / 16 for x in xs], ys, name, "log2 texels a pixel, centre", "pitch, degrees")
    return figure


def against_angle(rows, measure, title):
    """Lines over the pitch, one panel a distance."""
    distances = record.values(rows, "minification_16")
    figure, places = panels(len(distances), 3, 3.8, 2.8)
    for place, distance in zip(places, distances):
        for name in record.values(rows, "filter"):
            line = sorted(record.select(rows, minification_16=distance, filter=name), key=lambda r: r["pitch_degrees"])
            place.plot([r["pitch_degrees"] for r in line], [finite(r[measure], 80) for r in line], marker="o", label=name)
        place.set(title=f"2^{distance / 16:g} texels a pixel", xlabel="pitch, degrees (90 faces the viewer)", ylabel=title, xscale="log")
        place.set_xticks([3, 10, 30, 90], ["3", "10", "30", "90"])
    places[0].legend()
    return figure


def levels(rows, filter_name):
    scenes = record.values(rows, "scene")
    figure, places = panels(len(scenes), 3, 4.0, 2.9)
    for place, scene in zip(places, scenes):
        for k, formula in enumerate(("jacobian", "major", "minor")):
            for n, prefilter in enumerate(record.values(rows, "prefilter")):
                line = sorted(record.select(rows, scene=scene, filter=filter_name, formula=formula, prefilter=prefilter), key=lambda r: r["level_bias"])
                place.plot([r["level_bias"] / 16 for r in line], [r["psnr_db"] for r in line], STYLES[n], color=plt.rcParams["axes.prop_cycle"].by_key()["color"][k],
                           label=f"{formula}, {prefilter}")
        place.set(title=scene, xlabel="LOD bias, levels", ylabel="PSNR, dB")
    legend_below(figure, places[0], 6)
    return figure


def three_points(rows):
    maps = record.values(rows, "map")
    figure, places = panels(2 * len(maps), len(maps), 4.0, 2.7)
    for k, (four, three) in enumerate((("bilinear", "three-point"), ("trilinear", "trilinear3"))):
        for place, name in zip(places[k * len(maps):], maps):
            for label in (four, three):
                line = sorted(record.select(rows, map=name, filter=label), key=lambda r: r["minification_16"])
                place.plot([r["minification_16"] / 16 for r in line], [finite(r["psnr_db"], 80) for r in line], marker="o", label=label)
            place.set(title=f"map {name}", xlabel="log2 texels a pixel at the centre", ylabel="PSNR, dB")
            place.legend()
    return figure


def anisotropy(rows):
    pitches = record.values(rows, "pitch_degrees")
    figure, places = panels(len(pitches), 3, 3.9, 2.8)
    for place, pitch in zip(places, pitches):
        for bias in record.values(rows, "sample_bias"):
            for n, slack in enumerate(record.values(rows, "sample_slack")):
                line = sorted(record.select(rows, pitch_degrees=pitch, sample_bias=bias, sample_slack=slack), key=lambda r: r["max_samples"])
                colour = plt.rcParams["axes.prop_cycle"].by_key()["color"][record.values(rows, "sample_bias").index(bias)]
                place.plot([r["cycles_per_pixel"] for r in line], [r["psnr_db"] for r in line], STYLES[n], marker=".", color=colour, label=f"bias {bias / 16:g}, slack {slack}/16")
        place.set(title=f"pitch {pitch} degrees", xlabel="cycles a pixel", ylabel="PSNR, dB")
    legend_below(figure, places[0], 5)
    return figure


def local_memory(rows, port):
    scenes = record.values(rows, "scene")
    figure, places = panels(len(scenes), 3, 4.0, 3.0)
    for place, scene in zip(places, scenes):
        for k, policy in enumerate(("clamp", "coarser", "split")):
            line = sorted(record.select(rows, scene=scene, overflow=policy, scope="pixel", filter="trilinear", port_words=port), key=lambda r: r["fine_side"])
            place.plot([r["cycles_per_pixel"] for r in line], [r["psnr_db"] for r in line], marker="osd"[k], label=policy)
            for r in line:
                if r["fine_side"] == max(l["fine_side"] for l in line) and policy != "split":
                    continue  # where everything fits all policies are one point
                place.annotate(str(r["fine_side"]), (r["cycles_per_pixel"], r["psnr_db"]), textcoords="offset points", xytext=((-10, 2), (4, -9), (4, 3))[k], fontsize=7)
        place.set(title=scene, xlabel="cycles a pixel", ylabel="PSNR, dB")
    places[0].legend()
    return figure


def motion(rows):
    filters = record.values(rows, "filter")
    figure, places = panels(2, 2, 6.0, 3.2)
    for place, measure, title in zip(places, ("swim_lsb", "twin_swim_lsb"), ("against the reference", "against the twin")):
        for k, name in enumerate(record.values(rows, "profile")):
            heights = [record.mean([r[measure] for r in record.select(rows, profile=name, filter=f)]) for f in filters]
            place.bar([n + 0.2 * k - 0.3 for n in range(len(filters))], heights, 0.2, label=name)
        place.set_xticks(range(len(filters)), filters)
        place.set(title=title, ylabel="swim, LSB a frame")
    places[0].legend()
    return figure


def bias_in_motion(rows):
    """Stills and motion over the bias: PSNR and swim."""
    figure, places = panels(2, 2, 6.0, 3.2)
    for place, measure, title in zip(places, ("psnr_db", "swim_lsb"), ("PSNR, dB", "swim, LSB a frame")):
        for scene in record.values(rows, "scene"):
            for k, motion_name in enumerate(record.values(rows, "motion")):
                for prefilter in record.values(rows, "prefilter"):
                    line = sorted(record.select(rows, scene=scene, motion=motion_name, prefilter=prefilter), key=lambda r: r["level_bias"])
                    if measure == "swim_lsb" or k == 0:
                        label = f"{scene}, {prefilter}" + (f", {motion_name}" if measure == "swim_lsb" else "")
                        place.plot([r["level_bias"] / 16 for r in line], [r[measure] for r in line], marker=".", label=label)
        place.set(xlabel="LOD bias, levels", ylabel=title)
        place.legend(fontsize=7, ncol=2)
    return figure


def pictures(entries):
    """Rows of pictures: reference, drawn, and a signed, enlarged difference of a part. entries: (title, reference, drawn) as arrays."""
    figure, axes = plt.subplots(len(entries), 4, figsize=(12.4, 2.5 * len(entries)), squeeze=False)
    for line, (title, reference, drawn) in zip(axes, entries):
        difference = (drawn.astype(float) - reference.astype(float)).mean(axis=2)
        height, width = difference.shape
        y, x = busiest(numpy.abs(difference), height // 3, width // 3)
        part = (slice(y, y + height // 3), slice(x, x + width // 3))
        for place, shown, name in zip(line[:2], (reference, drawn), ("reference", title)):
            place.imshow(shown)
            place.set_title(name)
        for place, shown, name in zip(line[2:], (difference, difference[part]), ("difference, -16 to 16 LSB", f"the part at ({x}, {y}), three times as large")):
            image = place.imshow(shown, cmap="RdBu_r", vmin=-16, vmax=16, interpolation="nearest")
            place.set_title(name)
        figure.colorbar(image, ax=line[3], label="LSB, drawn less reference", shrink=0.9)
        for place in line:
            place.grid(False)
            place.set_xticks([])
            place.set_yticks([])
    return figure


def busiest(error, height, width):
    """Upper left corner of the window with the largest sum, on a grid of 8."""
    best, place = -1.0, (0, 0)
    for y in range(0, error.shape[0] - height + 1, 8):
        for x in range(0, error.shape[1] - width + 1, 8):
            total = error[y:y + height, x:x + width].sum()
            if total > best:
                best, place = total, (y, x)
    return place
