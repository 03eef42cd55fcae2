"""The inner solids of the engine block: the cylinder bank and the crankcase with its bearings."""

from shapes.contours import arc, arc_slot, bezier, box, circle, offset
from shapes.solids import Body, Opening, boss, hole, prism, through

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
