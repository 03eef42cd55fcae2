"""2-D contours: lists of (u, v), counter-clockwise."""

import math


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
