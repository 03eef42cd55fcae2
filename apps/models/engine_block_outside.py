"""The outer solids of the engine block: the front and rear plates, and what stands on its two sides."""

from engine_block_bank import CRANK_Z, SKIRT_L_IN, SKIRT_L_OUT, between
from shapes.contours import arc, box, circle, rounded
from shapes.solids import Opening, boss, hole, prism, through


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
