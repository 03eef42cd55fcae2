#!/usr/bin/env python3
"""Generates the demo part: an inline-four engine block as a triangle mesh.

    python3 engine_block.py OUT.ply            write the mesh
    python3 engine_block.py --check [IN.ply]   verify the mesh (generated, or read from IN.ply)

The output is a binary little-endian PLY in millimetres, the same bytes on every run. Only the
standard library is used.

Frame: origin at the centre of the bounding box, x along the crankshaft (front of the engine at
-x, gearbox at +x), y across, z up along the deck normal.

The part is a union of overlapping closed solids. Each solid is a stack of contours along one axis
(`Body`) with pockets, bosses and through holes nested to any depth, so it is watertight by
construction. Where solids overlap, the overlap lies in the material of both: a ray from outside
always meets an outward face of the union first. Two solids never share a plane over a common
area, because such faces would flicker in a depth buffer; hence the slightly uneven numbers below.
"""

import sys

from engine_block_bank import PITCH, crankcase, cylinder_bank
from engine_block_outside import bell_housing_flange, exhaust_side, intake_side, timing_case
from shapes.mesh_checks import CELL, best_fit, check_solids, depth_map, difference, turned
from shapes.mesh_file import encode_ply, mesh_of, write_file

TITLE = 'inline-four engine block'


def build_bodies():
    return (cylinder_bank() + crankcase() + timing_case() + bell_housing_flange() + exhaust_side()
            + intake_side())


def check(data, reference):
    failures = []

    def report(ok, text):
        print('%s  %s' % ('ok  ' if ok else 'FAIL', text))
        if not ok:
            failures.append(text)

    verts, tris = check_solids(report, data, reference, len(build_bodies()), (6000, 12000), (360, 170, 240))
    views = (('+z', 2, 1), ('-z', 2, -1), ('+y', 1, 1), ('-y', 1, -1), ('+x', 0, 1), ('-x', 0, -1))
    for name, axis, sign in views:
        base, backs = depth_map(verts, tris, axis, sign)
        report(backs == 0, 'view %s: %.0f cm^2 covered, nearest faces look outward'
               % (name, len(base) * CELL ** 2 / 100))
        for k in range(3):
            other, _ = depth_map(turned(verts, k), tris, axis, sign)
            plain, common = difference(base, other)
            # A pose estimate is free to slide, so the turned part must differ at its best fit too.
            best = best_fit(base, other)
            report(min(plain, common, best) > 0.08,
                   '  turned 180 deg about %s: differs on %.0f %%, where both cover %.0f %%, '
                   'best fit %.0f %%' % ('xyz'[k], 100 * plain, 100 * common, 100 * best))
        if axis == 0:
            continue
        for step in (-PITCH, PITCH):
            other, _ = depth_map(verts, tris, axis, sign, step)
            plain, common = difference(base, other)
            report(min(plain, common) > 0.08,
                   '  shifted %+.0f mm: differs on %.0f %%, where both cover %.0f %%'
                   % (step, 100 * plain, 100 * common))
    print('%d failed' % len(failures) if failures else 'all checks passed')
    return not failures


def main(args):
    if args and args[0] == '--check' and len(args) <= 2:
        reference = encode_ply(*mesh_of(build_bodies()), TITLE)
        data = reference
        if len(args) == 2:
            with open(args[1], 'rb') as f:
                data = f.read()
        return 0 if check(data, reference) else 1
    if len(args) == 1 and not args[0].startswith('-'):
        write_file(args[0], encode_ply(*mesh_of(build_bodies()), TITLE))
        return 0
    print('usage: engine_block.py OUT.ply | --check [IN.ply]', file=sys.stderr)
    return 2


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
