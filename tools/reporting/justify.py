# SPDX-License-Identifier: Apache-2.0
"""The tables by which docs/FINDINGS.md justifies profiles: tools/sweeps/justify.json, one line a change, over its scenes."""
from . import record


class Change:
    """One change of a profile on every scene: mean PSNR, worst errors, mean costs."""

    def __init__(self, name, rows):
        self.name = name
        self.psnr_db = record.mean([r["psnr_db"] for r in rows])
        self.worst_lsb = max(r["twin_worst_lsb"] for r in rows)
        self.coordinate = max(r["coordinate_worst_texels"] for r in rows)
        self.level = max(r["level_worst"] for r in rows)
        self.product_bits = record.mean([r["product_bits_per_pixel"] for r in rows])
        self.long_products = record.mean([r["long_products_per_pixel"] for r in rows])
        self.cycles = record.mean([r["cycles_per_pixel"] for r in rows])
        self.words = record.mean([r["words_per_pixel"] for r in rows])
        self.memory = max(r["memory_bits"] for r in rows)

    def line(self):
        return (f"| {self.name} | {self.psnr_db:.2f} | {self.worst_lsb:.0f} | {self.coordinate:.5f} | {self.level:.4f} | {self.product_bits:.0f} | {self.long_products:.2f} | "
                f"{self.cycles:.3f} | {self.words:.2f} | {self.memory:.0f} |")


HEADING = ("| change | PSNR dB | worst LSB | worst coordinate, texels | worst level | product bits | long products | cycles | words | memory bits |\n"
           "|---|---|---|---|---|---|---|---|---|---|")


def changes(rows, part, spec):
    """By name, the unchanged profile first: its name, then 'axis = value'."""
    rows = record.select(rows, part=part["name"])
    scenes = record.values(rows, "scene")
    by_scene = [record.select(rows, scene=scene) for scene in scenes]
    found = {}
    for group in zip(*by_scene):
        base = by_scene[0][0]
        moved = [axis for axis in part["axes"] if group[0][axis] != base[axis]]
        if "profile" in moved:
            moved = ["profile"]
        name = part["name"] if not moved else f"{moved[0]} = {group[0][moved[0]]}"
        found[name] = Change(name, group)
    assert spec["parts"] and len(found) == len(by_scene[0]), "a change twice"
    return found


def table(found):
    return HEADING + "\n" + "\n".join(change.line() for change in found.values())
