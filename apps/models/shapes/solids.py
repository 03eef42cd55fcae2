"""Closed solids: stacks of contours along one axis with pockets, bosses and through holes."""

import math

from shapes.contours import offset, signed_area
from shapes.triangulation import triangulate


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
