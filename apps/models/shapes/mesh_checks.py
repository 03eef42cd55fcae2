"""What holds for the mesh of every demo part: closed, wound outward, no faces on each other, no look inside."""

import math

from shapes.mesh_file import decode_ply


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
