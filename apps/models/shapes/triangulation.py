"""Triangulation of a polygon with holes: bridged ear clipping, then Delaunay edge flips, because
ears alone leave long needles between many round holes."""

import math


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
