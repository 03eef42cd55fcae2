"""From solids to triangles, and from triangles to a binary PLY file and back."""

import os
import struct
import tempfile


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


def encode_ply(verts, tris, title):
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
