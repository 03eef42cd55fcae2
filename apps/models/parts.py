#!/usr/bin/env python3
"""Generates the two smaller demo parts as triangle meshes.

    python3 parts.py NAME OUT.ply            write the mesh of "flange" or "bracket"
    python3 parts.py --check NAME [IN.ply]   verify the mesh (generated, or read from IN.ply)

Files, units and frame are those of engine_block.py: binary little-endian PLY in millimetres, the
same bytes on every run, origin at the centre of the bounding box, z up.
"""

import math
import sys

from shapes.contours import arc, circle
from shapes.mesh_checks import CELL, check_solids, depth_map
from shapes.mesh_file import encode_ply, mesh_of, write_file
from shapes.solids import Body, Feature, Opening, boss, ccw, through

# ------------------------------------------------------------------------------------------------
# The flange: turned, with six bolt holes of which one is narrower. But for that hole it looks the
# same after every sixth of a turn, so all circles have a number of corners that six divides.
# ------------------------------------------------------------------------------------------------

TURNED_N = 120               # corners of the circles about the axis
BOLT_N = 30                  # of the bolt holes
BOLT_CIRCLE_R = 62.5
BOLT_R, ODD_BOLT_R = 6.5, 4.5  # the odd one is the hole on +x


def flange_bodies():
    turned = lambda r: circle(0, 0, r, TURNED_N)
    bore, seat = turned(24.0), turned(29.0)
    rings = [(0.0, turned(79.0)), (1.0, turned(80.0)), (15.0, turned(80.0)), (16.0, turned(79.0))]
    # The hub tapers to a weld end, whose bore is wider at its mouth; the bore goes on through the
    # raised face below.
    hub = Feature([(16.0, turned(46.0)), (19.0, turned(42.5)), (30.0, turned(37.0)), (41.5, turned(35.5)),
                   (43.0, turned(34.0))],
                  [Feature([(43.0, seat), (37.0, seat), (35.0, bore), (-2.0, bore)], through=True)])
    top, bottom = [hub], [boss(turned(47.5), 0.0, -2.0, 0.4, [Opening(bore)])]
    for k in range(6):
        a = math.radians(60.0 * k)
        r = ODD_BOLT_R if k == 0 else BOLT_R
        top.append(through(circle(BOLT_CIRCLE_R * math.cos(a), BOLT_CIRCLE_R * math.sin(a), r, BOLT_N),
                           16.0, 0.0, 0.8))
    return [Body('flange', 'z', rings, top, bottom)]


# ------------------------------------------------------------------------------------------------
# The bracket: one sheet, cut out flat, then bent into a Z with a lip on one side.
# ------------------------------------------------------------------------------------------------

SHEET = 2.5                  # thickness
BEND_R = 3.5                 # inner radius of the bends
BEND_STEPS = 6               # flat strips to a right angle
BEND_LENGTH = (BEND_R + SHEET / 2) * math.pi / 2  # of the sheet's middle, which keeps its length

FOOT_U, WEB_U, HEAD_U = 86.0, 147.5, 198.0  # ends of foot, web and head along the flat sheet
LIP_V, LIP_END_V = 91.0, 108.0              # where the lip's bend begins, and its edge


def flat_sheet():
    outline = [(0, 6), (6, 0), (FOOT_U + 10, 0), (FOOT_U + 14, 4), (HEAD_U - 18, 4), (HEAD_U, 20), (HEAD_U, 68),
               (HEAD_U - 6, 74), (WEB_U + 4, 74), (FOOT_U + 12, 90)]
    # The lip with a relief cut at each of its ends, so that the sheet does not tear where it is bent.
    lip = [(66, 90), (66, 86), (63, 86), (63, LIP_END_V - 3), (60, LIP_END_V), (24, LIP_END_V),
           (14, LIP_V + 6), (14, 86), (11, 86), (11, 90)]
    outline += lip + [(8, 90), (0, 82)]
    slot = arc(27, 23, 5, 90, 270, 10) + arc(45, 23, 5, -90, 90, 10)
    holes = [circle(24, 62, 5.5, 24), circle(58, 68, 4.0, 20), circle(70, 20, 4.0, 20), slot,
             circle(118, 30, 13.0, 36), circle(122, 66, 3.5, 18),
             circle(176, 26, 4.5, 20), circle(180, 54, 4.5, 20)]
    top = [through(loop, SHEET, 0.0) for loop in holes]
    return Body('bracket', 'z', [(0.0, ccw(outline)), (SHEET, ccw(outline))], top)


def cut(tris, axis, level):
    """Cuts triangles where they cross a plane. Both triangles at an edge get the same new point."""
    out = []
    for tri in tris:
        side = [0 if abs(p[axis] - level) < 1e-9 else math.copysign(1, p[axis] - level) for p in tri]
        if min(side) >= 0 or max(side) <= 0:
            out.append(tri)
            continue
        loops = {-1: [], 1: []}
        for k in range(3):
            p, q = tri[k], tri[(k + 1) % 3]
            for s in loops:
                if side[k] in (0, s):
                    loops[s].append(p)
            if side[k] * side[(k + 1) % 3] < 0:
                a, b = min(p, q), max(p, q)
                t = (level - a[axis]) / (b[axis] - a[axis])
                between = tuple(level if i == axis else a[i] + t * (b[i] - a[i]) for i in range(3))
                loops[-1].append(between)
                loops[1].append(between)
        for loop in loops.values():
            out += [(loop[0], loop[k], loop[k + 1]) for k in range(1, len(loop) - 1)]
    return out


def bend(point, axis, begin, up):
    """Bends the sheet, which lies in 0 <= z <= SHEET where the bend begins, by a right angle about
    a line across `axis`."""
    along, height = point[axis] - begin, point[2] if up else SHEET - point[2]
    if along <= 0:
        return point
    angle = min(along / BEND_LENGTH, 1.0) * math.pi / 2
    beyond = max(along - BEND_LENGTH, 0.0)
    radius = BEND_R + SHEET - height
    new_along = radius * math.sin(angle) + beyond * math.cos(angle)
    new_height = BEND_R + SHEET - radius * math.cos(angle) + beyond * math.sin(angle)
    bent = list(point)
    bent[axis] = begin + new_along
    bent[2] = new_height if up else SHEET - new_height
    return tuple(bent)


def bracket_bodies():
    body = flat_sheet()
    bends = ((0, WEB_U, False), (1, LIP_V, True), (0, FOOT_U, True))  # the outer ones first
    for axis, begin, _ in bends:
        for k in range(BEND_STEPS + 1):
            body.tris = cut(body.tris, axis, begin + BEND_LENGTH * k / BEND_STEPS)
    for axis, begin, up in bends:
        body.tris = [tuple(bend(p, axis, begin, up) for p in tri) for tri in body.tris]
    return [body]


# ------------------------------------------------------------------------------------------------
# Checks and files
# ------------------------------------------------------------------------------------------------

PARTS = {
    # name: (solids, title, least and most triangles, size in mm)
    'flange': (flange_bodies, 'turned flange with one odd bolt hole', (3000, 8000), (160, 160, 45)),
    'bracket': (bracket_bodies, 'bent sheet bracket', (500, 8000), (140, 90, 70)),
}


def check(name, data, reference):
    bodies, _, num_tris, size = PARTS[name]
    failures = []

    def report(ok, text):
        print('%s  %s' % ('ok  ' if ok else 'FAIL', text))
        if not ok:
            failures.append(text)

    verts, tris = check_solids(report, data, reference, len(bodies()), num_tris, size)
    for view, axis, sign in (('+z', 2, 1), ('-z', 2, -1), ('+y', 1, 1), ('-y', 1, -1), ('+x', 0, 1), ('-x', 0, -1)):
        cells, backs = depth_map(verts, tris, axis, sign)
        report(backs == 0, 'view %s: %.0f cm^2 covered, nearest faces look outward'
               % (view, len(cells) * CELL ** 2 / 100))
    print('%d failed' % len(failures) if failures else 'all checks passed')
    return not failures


def main(args):
    if args[:1] == ['--check'] and 2 <= len(args) <= 3 and args[1] in PARTS:
        bodies, title = PARTS[args[1]][:2]
        reference = encode_ply(*mesh_of(bodies()), title)
        data = reference
        if len(args) == 3:
            with open(args[2], 'rb') as f:
                data = f.read()
        return 0 if check(args[1], data, reference) else 1
    if len(args) == 2 and args[0] in PARTS:
        bodies, title = PARTS[args[0]][:2]
        write_file(args[1], encode_ply(*mesh_of(bodies()), title))
        return 0
    print('usage: parts.py NAME OUT.ply | --check NAME [IN.ply]; names: ' + ', '.join(PARTS), file=sys.stderr)
    return 2


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
