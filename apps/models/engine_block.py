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

import math
import os
import struct
import sys
import tempfile

# ------------------------------------------------------------------------------------------------
# 2-D contours: lists of (u, v), counter-clockwise
# ------------------------------------------------------------------------------------------------


def signed_area(loop):
    return 0.5 * sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(loop, loop[1:] + loop[:1]))


def arc(cu, cv, r, a0, a1, n):
    """n + 1 points on a circle from angle a0 to a1 (degrees)."""
    step = (a1 - a0) / n
    return [(cu + r * math.cos(math.radians(a0 + i * step)),
             cv + r * math.sin(math.radians(a0 + i * step))) for i in range(n + 1)]


def circle(cu, cv, r, n=24):
    # The half-step phase keeps the outermost vertices of different circles off common lines.
    return arc(cu, cv, r, 180.0 / n, 180.0 / n + 360.0, n)[:-1]


def rounded(corners, seg_deg=30.0):
    """Polygon from (u, v, radius) corners, each corner replaced by a tangent arc."""
    out = []
    n = len(corners)
    for i in range(n):
        pu, pv = corners[i - 1][:2]
        u, v, r = corners[i]
        nu, nv = corners[(i + 1) % n][:2]
        if r <= 0:
            out.append((u, v))
            continue
        l0, l1 = math.hypot(pu - u, pv - v), math.hypot(nu - u, nv - v)
        d0 = ((pu - u) / l0, (pv - v) / l0)
        d1 = ((nu - u) / l1, (nv - v) / l1)
        inner = math.acos(max(-1.0, min(1.0, d0[0] * d1[0] + d0[1] * d1[1])))
        tangent = r / math.tan(inner / 2)
        bis = (d0[0] + d1[0], d0[1] + d1[1])
        lb = math.hypot(*bis)
        reach = r / math.sin(inner / 2) / lb
        cu, cv = u + bis[0] * reach, v + bis[1] * reach
        a0 = math.degrees(math.atan2(v + d0[1] * tangent - cv, u + d0[0] * tangent - cu))
        a1 = math.degrees(math.atan2(v + d1[1] * tangent - cv, u + d1[0] * tangent - cu))
        sweep = (a1 - a0 + 180.0) % 360.0 - 180.0
        out += arc(cu, cv, r, a0, a0 + sweep, max(1, int(round(abs(sweep) / seg_deg))))
    return out


def box(u0, v0, u1, v1, r=0.0, seg_deg=45.0):
    return rounded([(u0, v0, r), (u1, v0, r), (u1, v1, r), (u0, v1, r)], seg_deg)


def arc_slot(cu, cv, r0, r1, a0, a1, n):
    """Ring segment between two radii: the shape of a water-jacket slot beside a bore."""
    return arc(cu, cv, r1, a0, a1, n) + arc(cu, cv, r0, a1, a0, n)


def bezier(p0, p1, p2, n):
    """n + 1 points on a quadratic curve: the shoulder of the crankcase skirt."""
    return [tuple((1 - t) ** 2 * a + 2 * t * (1 - t) * b + t * t * c for a, b, c in zip(p0, p1, p2))
            for t in (i / n for i in range(n + 1))]


def offset(loop, d):
    """Moves every edge outward by d (inward if negative); vertices keep their order and number."""
    out = []
    n = len(loop)
    for i in range(n):
        (au, av), (bu, bv), (cu, cv) = loop[i - 1], loop[i], loop[(i + 1) % n]
        l0, l1 = math.hypot(bu - au, bv - av), math.hypot(cu - bu, cv - bv)
        n0 = ((bv - av) / l0, -(bu - au) / l0)
        n1 = ((cv - bv) / l1, -(cu - bu) / l1)
        k = d / (1.0 + n0[0] * n1[0] + n0[1] * n1[1])
        out.append((bu + k * (n0[0] + n1[0]), bv + k * (n0[1] + n1[1])))
    return out


# ------------------------------------------------------------------------------------------------
# Triangulation of a polygon with holes: bridged ear clipping, then Delaunay edge flips, because
# ears alone leave long needles between the many round holes of the deck.
# ------------------------------------------------------------------------------------------------


def orient(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def segments_touch(p, q, a, b):
    if max(p[0], q[0]) < min(a[0], b[0]) or max(a[0], b[0]) < min(p[0], q[0]):
        return False
    if max(p[1], q[1]) < min(a[1], b[1]) or max(a[1], b[1]) < min(p[1], q[1]):
        return False
    return orient(p, q, a) * orient(p, q, b) <= 0 and orient(a, b, p) * orient(a, b, q) <= 0


def in_cone(prev, at, nxt, p):
    """Whether the direction at -> p points into a counter-clockwise polygon at vertex `at`."""
    if orient(prev, at, nxt) > 0:
        return orient(prev, at, p) > 0 and orient(at, nxt, p) > 0
    return orient(prev, at, p) > 0 or orient(at, nxt, p) > 0


def bridge_holes(pts, outer, holes):
    """Joins clockwise holes to the outer ring by two-way cuts; returns one index ring."""
    ring = list(outer)
    pending = sorted(holes, key=lambda h: -max(pts[i][0] for i in h))
    while pending:
        hole = pending.pop(0)
        start = max(range(len(hole)), key=lambda k: pts[hole[k]])
        hole = hole[start:] + hole[:start]
        tip = hole[0]
        p = pts[tip]
        edges = [(r[k - 1], r[k]) for r in [ring, hole] + pending for k in range(len(r))]
        order = sorted(range(len(ring)), key=lambda k: (math.dist(p, pts[ring[k]]), k))
        for k in order:
            at = ring[k]
            q = pts[at]
            if not in_cone(pts[ring[k - 1]], q, pts[ring[(k + 1) % len(ring)]], p):
                continue
            if any(segments_touch(p, q, pts[a], pts[b]) for a, b in edges
                   if tip not in (a, b) and at not in (a, b)):
                continue
            ring = ring[:k + 1] + hole + [tip] + ring[k:]
            break
        else:
            raise ValueError('a hole cannot be joined to its contour: contours cross')
    return ring


def clip_ears(pts, ring):
    ring = list(ring)
    tris = []
    k = stalled = 0
    while len(ring) > 3:
        n = len(ring)
        ia, ib, ic = ring[(k - 1) % n], ring[k % n], ring[(k + 1) % n]
        a, b, c = pts[ia], pts[ib], pts[ic]
        ear = orient(a, b, c) > 1e-9
        if ear:
            lo_u, hi_u = min(a[0], b[0], c[0]) - 1e-6, max(a[0], b[0], c[0]) + 1e-6
            lo_v, hi_v = min(a[1], b[1], c[1]) - 1e-6, max(a[1], b[1], c[1]) + 1e-6
            for i in ring:
                p = pts[i]
                if i in (ia, ib, ic) or not (lo_u <= p[0] <= hi_u and lo_v <= p[1] <= hi_v):
                    continue
                # Points on the border block too (with a margin for the rounding of sin and cos):
                # cutting along them would leave a flat, area-less remainder.
                if min(orient(a, b, p), orient(b, c, p), orient(c, a, p)) > -1e-6:
                    ear = False
                    break
        if ear:
            tris.append((ia, ib, ic))
            del ring[k % n]
            stalled = 0
            k += 1  # move on, so that the ears do not fan around one vertex
        else:
            k += 1
            stalled += 1
            if stalled > n:
                raise ValueError('no ear left: the contour crosses itself')
        k %= len(ring)
    tris.append(tuple(ring))
    return tris


def flip_to_delaunay(pts, tris):
    tris = [list(t) for t in tris]
    owner = {}
    for t, tri in enumerate(tris):
        for k in range(3):
            owner[tri[k], tri[(k + 1) % 3]] = t
    queue = sorted(e for e in owner if e[0] < e[1] and (e[1], e[0]) in owner)
    budget = 200 * len(tris)  # flips terminate in theory; rounding must not make them loop
    while queue and budget:
        budget -= 1
        a, b = queue.pop()
        if (a, b) not in owner or (b, a) not in owner:
            continue
        t0, t1 = owner[a, b], owner[b, a]
        c = next(i for i in tris[t0] if i not in (a, b))
        d = next(i for i in tris[t1] if i not in (a, b))
        pa, pb, pc, pd = pts[a], pts[b], pts[c], pts[d]
        if orient(pc, pd, pb) <= 1e-9 or orient(pd, pc, pa) <= 1e-9:
            continue
        rows = [(p[0] - pd[0], p[1] - pd[1]) for p in (pa, pb, pc)]
        (x0, y0), (x1, y1), (x2, y2) = rows
        s0, s1, s2 = (x * x + y * y for x, y in rows)
        if s0 * (x1 * y2 - x2 * y1) - s1 * (x0 * y2 - x2 * y0) + s2 * (x0 * y1 - x1 * y0) <= 1e-6:
            continue
        del owner[a, b], owner[b, a]
        tris[t0], tris[t1] = [c, d, b], [d, c, a]
        for t in (t0, t1):
            for k in range(3):
                owner[tris[t][k], tris[t][(k + 1) % 3]] = t
        queue += [tuple(sorted(e)) for e in ((c, a), (a, d), (d, b), (b, c))]
    return tris


def triangulate(outer, holes):
    """Counter-clockwise triangles, as points, of a contour with hole contours."""
    pts, rings = [], []
    for loop in [outer] + [h[::-1] for h in holes]:
        rings.append(list(range(len(pts), len(pts) + len(loop))))
        pts += loop
    tris = clip_ears(pts, bridge_holes(pts, rings[0], rings[1:]))
    return [tuple(pts[i] for i in t) for t in flip_to_delaunay(pts, tris)]


# ------------------------------------------------------------------------------------------------
# Solids
# ------------------------------------------------------------------------------------------------


class Feature:
    """A pocket or boss on a face: rings [(level, contour), ...] from the face to the feature's own
    end face, which may carry further features (`kids`). A through feature has no end face: it ends
    in an `Opening` of the opposite side."""

    def __init__(self, rings, kids=(), through=False):
        self.rings = [(w, ccw(loop)) for w, loop in rings]
        self.kids = list(kids)
        self.through = through


class Opening(Feature):
    """The place where a through feature breaks out of a face."""

    def __init__(self, loop):
        super().__init__([(0.0, loop)], through=True)


def ccw(loop):
    return list(loop) if signed_area(loop) > 0 else list(reversed(loop))


class Body:
    """Closed solid along `axis`: outer rings [(level, contour), ...] with rising levels, features
    on the top (high) and bottom (low) face. Contour coordinates are (y, z) for axis x, (x, z) for
    axis y, (x, y) for axis z."""

    def __init__(self, name, axis, rings, top=(), bottom=()):
        self.name = name
        self.axis = axis
        self.tris = []
        top, bottom = list(top), list(bottom)
        for f in top:
            if f.through and not self._opens(bottom, f):
                bottom.append(Opening(f.rings[-1][1]))
        rings = [(w, ccw(loop)) for w, loop in rings]
        self._walls(rings, False)
        self._face(rings[-1], top, False)
        self._face(rings[0], bottom, True)

    def _opens(self, features, through):
        """Whether the through feature already ends in an opening somewhere in this tree."""
        return any((isinstance(f, Opening) and f.rings[0][1] == through.rings[-1][1])
                   or self._opens(f.kids, through) for f in features)

    def _emit(self, tri, flip):
        # (x, y) of axis z and (y, z) of axis x are right-handed with their axis; (x, z) of axis y
        # is left-handed, which turns every triangle round once more.
        if self.axis == 'x':
            tri = [(w, u, v) for u, v, w in tri]
        elif self.axis == 'y':
            tri = [(u, w, v) for u, v, w in tri]
            flip = not flip
        self.tris.append(tuple(reversed(tri)) if flip else tuple(tri))

    def _walls(self, rings, flip):
        for (w0, lo), (w1, hi) in zip(rings, rings[1:]):
            n = len(lo)
            assert n == len(hi), self.name
            for i in range(n):
                j = (i + 1) % n
                a, b = (*lo[i], w0), (*lo[j], w0)
                c, d = (*hi[j], w1), (*hi[i], w1)
                self._emit((a, b, c), flip)
                self._emit((a, c, d), flip)

    def _face(self, ring, features, flip):
        level, loop = ring
        try:
            tris = triangulate(loop, [f.rings[0][1] for f in features])
        except ValueError as e:
            raise ValueError('%s, face at %g: %s' % (self.name, level, e)) from e
        for tri in tris:
            self._emit([(u, v, level) for u, v in tri], flip)
        for f in features:
            assert isinstance(f, Opening) or f.rings[0][0] == level, self.name
            self._walls(f.rings, flip)
            if not f.through:
                self._face(f.rings[-1], f.kids, flip)


def hole(loop, face, floor, chamfer=0.0, kids=()):
    """Pocket from level `face` to `floor`, its mouth widened by a 45 degree chamfer."""
    if not chamfer:
        return Feature([(face, loop), (floor, loop)], kids)
    down = math.copysign(chamfer, floor - face)
    loop = ccw(loop)
    return Feature([(face, offset(loop, chamfer)), (face + down, loop), (floor, loop)], kids)


def through(loop, face, end, chamfer=0.0):
    f = hole(loop, face, end, chamfer)
    f.through = True
    return f


def boss(loop, face, end, chamfer=0.0, kids=()):
    """Raised area on a face, its rim chamfered."""
    if not chamfer:
        return Feature([(face, loop), (end, loop)], kids)
    up = math.copysign(chamfer, end - face)
    loop = ccw(loop)
    return Feature([(face, loop), (end - up, loop), (end, offset(loop, -chamfer))], kids)


def prism(name, axis, loop, lo, hi, top=(), bottom=(), c_lo=0.0, c_hi=0.0):
    """Straight solid with optionally chamfered rims."""
    loop = ccw(loop)
    rings = [(lo + c_lo, loop), (hi - c_hi, loop)]
    if c_lo:
        rings.insert(0, (lo, offset(loop, -c_lo)))
    if c_hi:
        rings.append((hi, offset(loop, -c_hi)))
    return Body(name, axis, rings, top, bottom)


# ------------------------------------------------------------------------------------------------
# The engine block
# ------------------------------------------------------------------------------------------------

DECK = 120.0                 # z of the deck
CEILING = 0.0                # z of the crankcase ceiling, the underside of the cylinder bank
CRANK_Z = -72.0              # crankshaft axis (y = 0)
PITCH = 82.0
BORE_R = 38.0
BORES_X = [-109.0 + PITCH * i for i in range(4)]
BULKHEADS_X = [BORES_X[0] - PITCH / 2 + PITCH * i for i in range(5)]
HEAD_BOLTS_X = [-147.0] + BULKHEADS_X[1:4] + [172.0]  # the outer pairs stay inside the end walls
HEAD_BOLT_Y = 52.5
DECK_Y, WAIST_Y = 66.0, 61.0  # half width of the deck flange and of the bank below it


def cylinder_bank():
    """Bank with bores, water jackets and head bolts. Its front has a notch over the full height:
    the timing-chain chamber, open at the deck and to the crankcase, closed by the timing case."""
    outline = [(-175, -DECK_Y)]
    for a, b in zip(HEAD_BOLTS_X, HEAD_BOLTS_X[1:]):
        # Weight-saving scallops between the bolts, on this side of the deck only.
        outline += [(a + 14, -DECK_Y), (a + 21, -WAIST_Y), (b - 21, -WAIST_Y), (b - 14, -DECK_Y)]
    outline += [(181, -DECK_Y), (181, DECK_Y), (-175, DECK_Y)]
    outline += [(-175, 30), (-158, 30), (-153, 25), (-153, -35), (-158, -40), (-175, -40)]
    waist = [(x, max(-WAIST_Y, min(WAIST_Y, y))) for x, y in outline]
    rings = [(CEILING, waist), (90.0, waist), (97.0, outline), (DECK - 1.0, outline),
             (DECK, offset(outline, -1.0))]

    top, bottom = [], []
    for x in BORES_X:
        wall = circle(x, 0, BORE_R, 36)
        top.append(through(wall, DECK, CEILING - 8.0, 1.2))
        # The liner stands a little into the crankcase.
        bottom.append(boss(circle(x, 0, BORE_R + 2.5, 36), CEILING, CEILING - 8.0,
                           kids=[Opening(wall)]))
    # Jacket slots: deep on the exhaust side (-y), shallower on the other, and the last bore has a
    # short one where the oil return passes.
    for i, x in enumerate(BORES_X):
        top.append(hole(arc_slot(x, 0, 43.5, 50.5, 222, 318, 7), DECK, 50.0))
        if i == 3:
            top.append(hole(arc_slot(x, 0, 43.5, 50.5, 85, 138, 4), DECK, 84.0))
        else:
            top.append(hole(arc_slot(x, 0, 43.5, 50.5, 42, 138, 7), DECK, 68.0))
    for x in HEAD_BOLTS_X:
        for y in (-HEAD_BOLT_Y, HEAD_BOLT_Y):
            top.append(hole(circle(x, y, 4.8, 10), DECK, 84.0))
    # Oil and coolant passages, none of which has a counterpart on the other side.
    top.append(hole(circle(-164.5, 47.5, 8.5, 18), DECK, 70.0, 0.8))        # coolant transfer
    top.append(hole(box(-171, -60, -159, -45, 4), DECK, 60.0))              # front oil drain
    top.append(hole(circle(-45, 55.5, 3.8, 10), DECK, 98.0, 0.6))           # oil feed
    top.append(hole(box(140, 53.5, 153, 60.5, 3), DECK, 60.0))              # rear oil drain
    top.append(hole(circle(120, -56, 3.0, 8), DECK, 92.0))                 # dowel
    return [Body('cylinder bank', 'z', rings, top, bottom)]


# Skirt sections as (y, z), from inside the bank down into the pan rail. The +y skirt bulges.
SKIRT_N = 6
SKIRT_L_OUT = bezier((-57, 14), (-73, -12), (-73, -55), SKIRT_N) + [(-73, -113)]
SKIRT_L_IN = bezier((-48, 8), (-65, -16), (-65, -55), SKIRT_N) + [(-65, -113)]
SKIRT_R_OUT = bezier((57, 20), (79, 0), (79, -48), SKIRT_N) + [(76, -113)]
SKIRT_R_IN = bezier((48, 8), (70, -12), (70, -50), SKIRT_N) + [(68, -113)]


def midline(a, b):
    return [((p[0] + q[0]) / 2, (p[1] + q[1]) / 2) for p, q in zip(a, b)]


def between(path, z_top, z_end):
    """The part of a descending path between two heights, cut exactly there."""
    out = []
    for p, q in zip(path, path[1:]):
        at = lambda z: (p[0] + (z - p[1]) / (q[1] - p[1]) * (q[0] - p[0]), z)
        if p[1] >= z_top > q[1]:
            out.append(at(z_top))
        elif z_top > p[1] > z_end:
            out.append(p)
        if p[1] > z_end >= q[1]:
            out.append(at(z_end))
    return out


def crankcase():
    parts = [
        prism('skirt -y', 'x', SKIRT_L_OUT + SKIRT_L_IN[::-1], -173.5, 179.5),
        prism('skirt +y', 'x', SKIRT_R_OUT + SKIRT_R_IN[::-1], -173.3, 179.3),
    ]
    # Pan rails: straight with a full-width foot on +y, lugs around the bolts on -y.
    bolts = [-160, -122, -81, -41, 2, 43, 85, 124, 164]
    lugs = [(-172.8, -61.5), (-172.8, -76.5)]
    for x in bolts:
        lugs += [(x - 9.5, -76.5), (x - 6, -82), (x + 6, -82), (x + 9.5, -76.5)]
    lugs += [(179, -76.5), (179, -61.5)]
    rail_bolts = lambda y, xs: [hole(circle(x, y, 3.6, 8), -120.0, -114.0) for x in xs]
    parts.append(prism('pan rail -y', 'z', lugs, -120.0, -106.0,
                       bottom=rail_bolts(-74.0, bolts)))
    parts.append(prism('pan rail +y', 'z', box(-172.6, 64.5, 178.8, 84), -120.0, -108.0,
                       bottom=rail_bolts(76.5, [-155, -110, -65, -20, 25, 70, 115, 160]), c_hi=1.0))

    for i, x in enumerate(BULKHEADS_X):
        parts += bulkhead(i, x)
    return parts


def bulkhead(i, x):
    """Bearing web: a thin wall, no thicker than the metal between two bores where it joins the
    bank, and a thick bearing block with the half-round saddle and two cap bolt pads."""
    left = between(midline(SKIRT_L_OUT, SKIRT_L_IN), 9.0, -94.0)
    right = between(midline(SKIRT_R_OUT, SKIRT_R_IN), 9.0, -94.0)
    saddle_recess = arc(0, CRANK_Z, 30, 175, 5, 8)
    wall = left + [(-57, -94), (-49, -69.5)] + saddle_recess + [(49, -69.5), (58, -94)] + right[::-1]
    # Breather windows between the bays, except in the end walls; the middle one is offset.
    windows = {1: (-17, 8.5), 2: (12, 10.0), 3: (-17, 8.5)}
    top = []
    if i in windows:
        y, r = windows[i]
        top = [through(circle(y, -19, r, 14), x + 2.7, x - 2.7)]
    parts = [prism('web wall %d' % (i + 1), 'x', wall, x - 2.7, x + 2.7, top)]

    half = 13.0 if i == 2 else 10.0  # the middle bearing takes the thrust
    lo, hi = x - half, x + half
    if i == 4:
        lo, hi = x - 13.0, x + 5.2   # the rear one ends inside the bell-housing flange
    block = [(-53, CRANK_Z), (-47, CRANK_Z), (-47, -44), (-33, -44), (-33, CRANK_Z)]
    block += arc(0, CRANK_Z, 27, 180, 0, 18)
    block += [(33, CRANK_Z), (33, -44), (47, -44), (47, CRANK_Z), (53, CRANK_Z),
              (53, -46), (41, -29), (-41, -29), (-53, -46)]
    parts.append(prism('bearing block %d' % (i + 1), 'x', block, lo, hi))
    for side, y in (('-y', -40.0), ('+y', 40.0)):
        pad = box(lo - 1.5, y - 9.4, hi + 1.5, y + 9.4, 4, 90)
        bolt = hole(circle(min((lo + hi) / 2, 170.3), y, 4.6, 8), CRANK_Z - 1.5, -50.0)
        parts.append(prism('cap pad %d %s' % (i + 1, side), 'z', pad, CRANK_Z - 1.5, -41.0,
                           bottom=[bolt]))
    return parts


def timing_case():
    """Front plate; closes the chain chamber. Faces -x, so its features sit on the low side."""
    back, face = -172.0, -182.0
    outline = rounded([(-80, -117, 5), (82, -117, 5), (84, -62, 10), (77, -8, 12), (68, 22, 8),
                       (68, 100, 8), (52, 117, 6), (20, 117, 4), (10, 108, 4), (-22, 108, 4),
                       (-32, 117, 4), (-50, 117, 6), (-67, 104, 8), (-67, 24, 8), (-75, -14, 12),
                       (-79, -60, 10)])
    seal_bore = circle(0, CRANK_Z, 31, 32)
    pump_bore = circle(-4, 52, 23, 30)
    pump_flange = rounded([(-47, 27, 9), (-35, 13, 9), (22, 15, 9), (37, 30, 9), (13, 92, 9),
                           (-19, 92, 9)])
    pump_bolts = [(-36, 25), (27, 27), (-3, 83)]
    bolts = [(-72, -110), (-40, -111), (42, -111), (75, -110), (77, -64), (73, -36), (62, 30),
             (-61, 34), (-61, 96), (-69, -24), (-73, -66)]
    bottom = [
        boss(circle(0, CRANK_Z, 38, 32), face, -184.5, 1.0, [Opening(seal_bore)]),
        boss(pump_flange, face, -187.0, 1.0, [Opening(pump_bore)] + [
            hole(circle(y, z, 3.6, 8), -187.0, -177.0) for y, z in pump_bolts]),
        # Thermostat inlet, idler stud boss and a weight-saving recess.
        boss(box(39, 50, 63, 96, 10), face, -185.5, 1.0, [
            hole(box(44, 55, 58, 91, 6.5), -185.5, -176.0)]),
        boss(circle(-52, -6, 12, 18), face, -186.0, 1.0, [hole(circle(-52, -6, 4.5, 10), -186.0, -176.5)]),
        hole(rounded([(10, -28, 4), (58, -30, 4), (54, 4, 4), (20, 6, 4)]), face, -176.5),
    ] + [hole(circle(y, z, 3.2, 8), face, -177.5) for y, z in bolts]
    top = [through(seal_bore, back, -184.5), through(pump_bore, back, -187.0)]
    return [prism('timing case', 'x', outline, face, back, top, bottom, c_lo=1.0)]


def bell_housing_flange():
    """Rear flange: wider than the block, higher on -y, with the starter lobe low on +y."""
    back, face = 178.0, 187.0
    outline = rounded([(-72, -118, 6), (60, -118, 6), (86, -98, 8), (86, -34, 12), (74, 6, 14),
                       (60, 46, 10), (44, 92, 9), (26, 104, 9), (-18, 104, 9), (-36, 90, 12),
                       (-70, 78, 11), (-78, 54, 11), (-70, 36, 8), (-86, 8, 12), (-86, -76, 12),
                       (-80, -104, 8)])
    seal_bore = circle(0, CRANK_Z, 36, 32)
    top = [
        hole(circle(0, CRANK_Z, 42, 32), face, 183.5, kids=[Opening(seal_bore)]),
        hole(circle(66, -60, 12, 18), face, 182.2),
        through(circle(-78.5, -18, 4.8, 10), face, back),
        through(circle(-77.5, -82, 4.2, 10), face, back),
        through(circle(-67.5, 60, 4.5, 10), face, back),
        through(circle(79.0, -92, 4.2, 10), face, back),
        hole(circle(64, 12, 4.8, 10), face, 181.8),
        hole(circle(29, 86, 4.8, 10), face, 181.8),
        hole(circle(-17, 93, 4.8, 10), face, 181.8),
        # Casting recesses lighten the plate behind the last bore.
        hole(rounded([(-52, -18, 5), (-14, -18, 5), (-10, 70, 5), (-52, 62, 5)]), face, 182.4),
        hole(rounded([(4, -18, 5), (44, -18, 5), (36, 60, 5), (8, 70, 5)]), face, 182.6),
    ]
    # The bore ends in the floor of the seal step: its wall hangs on the low face here, and the step
    # carries the opening.
    bottom = [through(seal_bore, back, 183.5)]
    return [prism('bell-housing flange', 'x', outline, back, face, top, bottom, c_hi=1.0)]


def exhaust_side():
    """-y: ribs, oil gallery, core plugs, alternator bracket, mount pad, dipstick boss."""
    parts = []
    # The root line runs inside bank and skirt (off the line on which the web walls end), the crest
    # line stands proud of both. Two ribs are cut short where a bracket or pad stands in the way.
    root = [(-57.5, 89)] + [(0.7 * p[0] + 0.3 * q[0], 0.7 * p[1] + 0.3 * q[1])
                            for p, q in zip(SKIRT_L_OUT, SKIRT_L_IN)]
    crest = [(-58.5, 89), (-68.5, 74), (-72, 10), (-80, -24), (-80, -105)]
    for k, (x, z_top, z_end) in enumerate(((-134, 43, -105), (-75, 89, -105), (-56, 89, -104),
                                           (7, 89, -105), (26, 89, -104), (93, 89, -55),
                                           (156, 89, -105))):
        parts.append(prism('rib %d' % (k + 1), 'x', between(root, z_top, z_end - 0.3)
                           + between(crest, z_top, z_end)[::-1], x - 3.0, x + 3.0))
    parts.append(prism('oil gallery', 'x', circle(-60, 17, 11.5, 18), -174.2, 180.2))
    diagonal = [(-118, -92), (-108, -92), (-79, -40), (-79, -30), (-85, -30)]
    parts.append(prism('diagonal rib', 'y', diagonal, -78.5, -68.2))
    for k, x in enumerate((-26.0, 59.0, 127.0)):
        parts.append(prism('core plug %d' % (k + 2), 'y', circle(x, 52, 18, 24), -68.0, -56.0,
                           bottom=[hole(circle(x, 52, 14, 24), -68.0, -62.3)], c_lo=1.0))
    parts.append(prism('alternator bracket', 'z', rounded([
        (-164, -57, 0), (-164, -84, 6), (-104, -84, 6), (-92, -57, 0)]), 38.0, 86.0,
        top=[hole(circle(-152, -73, 5, 10), 86.0, 60.0), hole(circle(-113, -73, 5, 10), 86.0, 60.0),
             hole(box(-144, -80, -121, -66, 3), 86.0, 52.0)], c_lo=1.5, c_hi=1.0))
    parts.append(prism('mount pad -y', 'y', box(58, -101, 126, -48, 8), -84.5, -69.6, bottom=[
        hole(circle(x, z, 5, 10), -84.5, -74.0) for x, z in ((69, -90), (115, -90), (69, -59), (115, -59))]
        + [hole(circle(92, -75, 15, 20), -84.5, -77.0, 1.0)], c_lo=1.2))
    parts.append(prism('dipstick boss', 'z', circle(-22, -76.5, 8.5, 14), -110.0, -31.0,
                       top=[hole(circle(-22, -76.5, 4.2, 10), -31.0, -70.0, 0.8)], c_hi=0.8))
    return parts


def intake_side():
    """+y: oil filter, engine mount, crankcase breather, water outlet, starter bulge."""
    parts = []
    # Nested features: a sealing groove around an island, and the stud bore in the island.
    stud = boss(circle(-104, -77, 11, 18), 77.0, 84.0, kids=[hole(circle(-104, -77, 6, 12), 84.0, 79.0)])
    parts.append(prism('oil filter boss', 'y', circle(-104, -77, 28.5, 28), 73.0, 85.0, top=[
        hole(circle(-104, -77, 22, 28), 85.0, 77.0, kids=[stud])], c_hi=1.0))
    parts.append(prism('oil cooler pad', 'y', rounded([
        (-158, 8, 6), (-84, 8, 6), (-84, 36, 6), (-112, 46, 6), (-158, 46, 6)]), 55.5, 74.0, top=[
            hole(circle(-145, 27, 9, 18), 74.0, 63.0, 0.8), hole(circle(-100, 22, 7, 14), 74.0, 63.0, 0.8)],
        c_hi=1.2))
    parts.append(prism('water outlet', 'y', circle(-128, 73, 19, 24), 56.0, 83.0, top=[
        hole(circle(-128, 73, 14, 24), 83.0, 62.5)], c_hi=1.0))
    parts.append(prism('mount pad +y', 'y', rounded([
        (-70, 24, 8), (10, 24, 8), (10, 60, 8), (-14, 86, 8), (-70, 86, 8)]), 55.0, 81.0, top=[
            hole(circle(x, z, 5.2, 10), 81.0, 63.0) for x, z in ((-59, 35), (-1, 35), (-59, 75), (-21, 74))]
        + [hole(box(-48, 42, -14, 67, 6), 81.0, 66.0, 1.0)], c_hi=1.2))
    # Open breather chamber beside the deck: two cells of different depth.
    parts.append(prism('breather', 'z', rounded([
        (58, 59.5, 0), (146, 59.5, 0), (146, 84, 6), (70, 84, 8)]), 34.0, 112.0, top=[
            hole(box(72, 68.5, 98, 80, 3), 112.0, 70.0), hole(box(103, 68.5, 141, 80, 3), 112.0, 46.0)],
        c_lo=2.0, c_hi=1.0))
    # Starter bulge: D sections, because a full cylinder would come out inside the crankcase.
    nose = [p for p in arc(67, -60, 16, -70, 70, 14) if p[0] > 74.0]
    body = [p for p in arc(66, -60, 19.5, -90, 90, 20) if p[0] > 73.5]
    parts.append(prism('starter bulge', 'x', body + [(73.2, -45), (73.2, -75)], 96.0, 181.5, c_lo=2.0))
    parts.append(prism('starter nose', 'x', nose + [(73.6, -50), (73.6, -70)], 52.0, 99.0, c_lo=2.0))
    parts.append(prism('knock sensor boss', 'y', circle(32, 46, 11, 18), 57.0, 72.0, top=[
        hole(circle(32, 46, 4, 10), 72.0, 62.0)], c_hi=1.0))
    return parts


def build_bodies():
    return (cylinder_bank() + crankcase() + timing_case() + bell_housing_flange() + exhaust_side()
            + intake_side())


# ------------------------------------------------------------------------------------------------
# Mesh and file
# ------------------------------------------------------------------------------------------------


def mesh_of(bodies):
    """Vertices (mm) and triangles; vertices are welded within a solid, never across solids."""
    points = [p for b in bodies for t in b.tris for p in t]
    centre = [(min(p[k] for p in points) + max(p[k] for p in points)) / 2 for k in range(3)]
    verts, tris = [], []
    for b in bodies:
        index = {}
        for tri in b.tris:
            ids = []
            for p in tri:
                # Rounding to a micrometre makes the bytes independent of the last bits of sin/cos.
                key = tuple(int(round((p[k] - centre[k]) * 1000.0)) for k in range(3))
                if key not in index:
                    index[key] = len(verts)
                    verts.append(tuple(c / 1000.0 for c in key))
                ids.append(index[key])
            tris.append(tuple(ids))
    return verts, tris


def encode_ply(verts, tris, title='inline-four engine block'):
    header = ('ply\nformat binary_little_endian 1.0\n'
              'comment %s, millimetres\n'
              'element vertex %d\nproperty float x\nproperty float y\nproperty float z\n'
              'element face %d\nproperty list uchar int vertex_indices\nend_header\n'
              % (title, len(verts), len(tris)))
    return (header.encode('ascii') + b''.join(struct.pack('<3f', *v) for v in verts)
            + b''.join(struct.pack('<B3i', 3, *t) for t in tris))


def decode_ply(data):
    """Reads back exactly the layout written by encode_ply."""
    head, _, body = data.partition(b'end_header\n')
    count = {w[1]: int(w[2]) for w in (line.split() for line in head.decode('ascii').splitlines())
             if w[0] == 'element'}
    nv, nf = count['vertex'], count['face']
    if len(body) != 12 * nv + 13 * nf:
        raise ValueError('unexpected file size')
    verts = list(struct.iter_unpack('<3f', body[:12 * nv]))
    faces = list(struct.iter_unpack('<B3i', body[12 * nv:]))
    if any(f[0] != 3 or min(f[1:]) < 0 or max(f[1:]) >= nv for f in faces):
        raise ValueError('faces must be triangles with valid indices')
    return verts, [f[1:] for f in faces]


def write_file(path, data):
    """Writes next to the target and renames, so that a reader never sees half a file."""
    fd, tmp = tempfile.mkstemp(dir=os.path.dirname(os.path.abspath(path)), suffix='.tmp')
    try:
        with os.fdopen(fd, 'wb') as f:
            f.write(data)
        os.chmod(tmp, 0o644)
        os.replace(tmp, path)
    except BaseException:
        os.unlink(tmp)
        raise


# ------------------------------------------------------------------------------------------------
# Checks
# ------------------------------------------------------------------------------------------------


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def solids_of(verts, tris):
    """Groups triangles into connected solids; vertices at one place count as one."""
    place = {}
    canon = [place.setdefault(v, i) for i, v in enumerate(verts)]
    parent = list(range(len(verts)))

    def root(i):
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    for t in tris:
        a, b, c = (root(canon[i]) for i in t)
        parent[b] = a
        parent[root(c)] = a
    groups = {}
    for t in tris:
        groups.setdefault(root(canon[t[0]]), []).append(tuple(canon[i] for i in t))
    return list(groups.values())


def triangles_overlap_2d(s, t):
    """Whether two triangles share area (separating axes; touching does not count)."""
    for tri in (s, t):
        for i in range(3):
            n = (tri[i][1] - tri[i - 1][1], tri[i - 1][0] - tri[i][0])
            ps = [n[0] * p[0] + n[1] * p[1] for p in s]
            pt = [n[0] * p[0] + n[1] * p[1] for p in t]
            scale = math.hypot(*n) * 1e-2
            if max(ps) <= min(pt) + scale or max(pt) <= min(ps) + scale:
                return False
    return True


def coplanar_pairs(verts, solids):
    """Number of triangle pairs of different solids that lie on each other."""
    planes = {}
    for s, group in enumerate(solids):
        for t in group:
            a, b, c = (verts[i] for i in t)
            n = cross(sub(b, a), sub(c, a))
            length = math.sqrt(dot(n, n))
            n = tuple(x / length for x in n)
            k = max(range(3), key=lambda j: abs(n[j]))
            if n[k] < 0:
                n = tuple(-x for x in n)
            d = dot(n, a)
            flat = [tuple(p[j] for j in range(3) if j != k) for p in (a, b, c)]
            key = (round(n[0], 3), round(n[1], 3), round(n[2], 3), round(d / 0.05))
            planes.setdefault(key, []).append((s, d, flat))
    found = 0
    for key, group in planes.items():
        # Neighbouring offset bins are compared too, lest a pair straddles a bin border.
        near = group + planes.get(key[:3] + (key[3] + 1,), [])
        for i, (s0, _, f0) in enumerate(group):
            found += sum(1 for s1, _, f1 in near[i + 1:] if s1 != s0 and triangles_overlap_2d(f0, f1))
    return found


CELL = 2.0  # mm, raster of the depth maps


def depth_map(verts, tris, axis, sign, shift=0.0):
    """Orthographic heights seen against direction sign * axis: {(i, j): height}; and the number of
    cells whose nearest face looks away, which a closed outward-wound part never has."""
    ua, va = [k for k in range(3) if k != axis]
    height, backs = {}, {}
    for t in tris:
        a, b, c = (verts[i] for i in t)
        n = cross(sub(b, a), sub(c, a))
        facing = n[axis] * sign
        if abs(n[axis]) < 1e-9:
            continue
        u = [p[ua] + (shift if ua == 0 else 0.0) for p in (a, b, c)]
        v = [p[va] for p in (a, b, c)]
        # Sample points sit off the round numbers that the edges lie on.
        for i in range(math.ceil((min(u) - 0.137) / CELL), math.floor((max(u) - 0.137) / CELL) + 1):
            pu = i * CELL + 0.137
            for j in range(math.ceil((min(v) - 0.173) / CELL), math.floor((max(v) - 0.173) / CELL) + 1):
                pv = j * CELL + 0.173
                w = [(u[(k + 1) % 3] - u[k]) * (pv - v[k]) - (v[(k + 1) % 3] - v[k]) * (pu - u[k])
                     for k in range(3)]
                if min(w) < 0 and max(w) > 0:
                    continue
                total = sum(w)
                if not total:
                    continue
                h = sign * (w[1] * a[axis] + w[2] * b[axis] + w[0] * c[axis]) / total
                if h > height.get((i, j), -1e9):
                    height[i, j] = h
                    backs[i, j] = facing < 0
    return height, sum(backs.values())


def difference(m0, m1, du=0, dv=0):
    """Shares of cells that differ by more than 5 mm: over the area covered by either map, and over
    the area covered by both. The second map is moved by (du, dv) cells."""
    moved = {(i + du, j + dv): h for (i, j), h in m1.items()}
    both = [c for c in m0 if c in moved]
    differ = sum(1 for c in both if abs(m0[c] - moved[c]) > 5.0)
    union = len(m0) + len(moved) - len(both)
    return (differ + union - len(both)) / union, differ / len(both) if both else 1.0


def best_fit(m0, m1):
    """Smallest difference over in-plane moves of up to 40 by 16 mm, on every other cell."""
    a, b = ({(i // 2, j // 2): h for (i, j), h in m.items() if i % 2 == 0 and j % 2 == 0}
            for m in (m0, m1))
    return min(difference(a, b, du, dv)[0] for du in range(-10, 11) for dv in range(-4, 5))


def turned(verts, axis):
    return [tuple(c if k == axis else -c for k, c in enumerate(v)) for v in verts]


def check_solids(report, data, reference, num_bodies, num_tris, expected_size):
    """What holds for every part: `num_tris` is (least, most), `expected_size` in mm."""
    verts, tris = decode_ply(data)
    report(data == reference, 'bytes equal a fresh generation (%d bytes)' % len(data))
    report(len(data) < 300000, 'file below 300 kB')
    report(num_tris[0] <= len(tris) <= num_tris[1], '%d triangles, %d vertices' % (len(tris), len(verts)))
    lo = [min(v[k] for v in verts) for k in range(3)]
    hi = [max(v[k] for v in verts) for k in range(3)]
    size = [h - l for l, h in zip(lo, hi)]
    report(all(abs(h + l) < 2e-3 for l, h in zip(lo, hi)), 'bounding box centred on the origin')
    report(all(abs(s - e) < 16 for s, e in zip(size, expected_size)),
           'size %.1f x %.1f x %.1f mm' % tuple(size))
    areas = []
    for t in tris:
        n = cross(sub(verts[t[1]], verts[t[0]]), sub(verts[t[2]], verts[t[0]]))
        areas.append(0.5 * math.sqrt(dot(n, n)))
    report(min(areas) > 1e-6, 'smallest triangle %.2g mm^2' % min(areas))

    solids = solids_of(verts, tris)
    open_edges = 0
    volumes = []
    for group in solids:
        edges = {}
        for t in group:
            for k in range(3):
                e = (t[k], t[(k + 1) % 3])
                edges[e] = edges.get(e, 0) + 1
        open_edges += sum(1 for (a, b), n in edges.items() if n != 1 or edges.get((b, a)) != 1)
        volumes.append(sum(dot(verts[a], cross(verts[b], verts[c])) for a, b, c in group) / 6)
    report(open_edges == 0, '%d solids, each edge between two opposite triangles' % len(solids))
    report(len(solids) == num_bodies, 'solids do not touch in a vertex')
    report(min(volumes) > 0, 'all solids wound outward (smallest %.0f mm^3)' % min(volumes))
    n = coplanar_pairs(verts, solids)
    report(n == 0, '%d coincident faces between solids' % n)
    return verts, tris


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
        reference = encode_ply(*mesh_of(build_bodies()))
        data = reference
        if len(args) == 2:
            with open(args[1], 'rb') as f:
                data = f.read()
        return 0 if check(data, reference) else 1
    if len(args) == 1 and not args[0].startswith('-'):
        write_file(args[0], encode_ply(*mesh_of(build_bodies())))
        return 0
    print('usage: engine_block.py OUT.ply | --check [IN.ply]', file=sys.stderr)
    return 2


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
