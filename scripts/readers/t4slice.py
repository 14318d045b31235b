"""Slow slices of space-time tetrahedra, written from docs/formats/hypermesh.md alone: the tests' oracle.

The rule is stated by sides, not by the table of four triangles that the C++ slicer uses: a vertex is before the slice or
after it, a tetrahedron with 1, 2 or 3 vertices before is cut in a triangle, a quadrangle or a triangle.
"""

from fractions import Fraction

import t4container as t4


def crossing(a, b, t):
    """Where edge ab (a earlier) meets time t, in float32 arithmetic, computed from a; exact at both ends."""
    if t == b[3]:
        return b[:3]
    weight = t4.f32(t4.f32(t - a[3]) / t4.f32(b[3] - a[3]))
    return tuple(t4.f32(p + t4.f32(weight * t4.f32(q - p))) for p, q in zip(a[:3], b[:3]))


def exact_crossing(a, b, t):
    a, b, t = [Fraction(v) for v in a], [Fraction(v) for v in b], Fraction(t)
    weight = (t - a[3]) / (b[3] - a[3])
    return [p + weight * (q - p) for p, q in zip(a[:3], b[:3])]


def cut_of(order, positions, t, last_t):
    """Triangles of one tetrahedron's slice as triples of edges (earlier end, later end); wound as by its parity.

    order: the four vertices by time (stable)."""
    at_end = t == last_t
    before = [v for v in order if positions[v][3] < t or (positions[v][3] == t and not at_end)]
    after = [v for v in order if v not in before]
    if len(before) == 1:
        (a,) = before
        return [[(a, b) for b in after]]
    if len(before) == 3:
        (d,) = after
        first, second, third = before
        return [[(first, d), (second, d), (third, d)]]
    if len(before) == 2:
        (a, b), (c, d) = before, after
        # The quadrangle a-c, a-d, b-d, b-c, cut along the diagonal from a-d to b-c.
        return [[(a, c), (a, d), (b, c)], [(a, d), (b, d), (b, c)]]
    return []


def parity(order, tet):
    """True if order is an odd permutation of tet."""
    numbers = [tet.index(v) for v in order]
    return sum(numbers[i] > numbers[j] for i in range(4) for j in range(i)) % 2 == 1


def determinant(rows):
    if len(rows) == 1:
        return rows[0][0]
    return sum((-1) ** j * rows[0][j] * determinant([row[:j] + row[j + 1:] for row in rows[1:]])
               for j in range(len(rows)) if rows[0][j])


def outward_normal(tet, positions):
    """The 4D normal n with det(n, b-a, c-a, d-a) > 0, exact."""
    a, *others = [[Fraction(c) for c in positions[v]] for v in tet]
    edges = [[p - q for p, q in zip(other, a)] for other in others]
    unit = [[Fraction(int(i == j)) for j in range(4)] for i in range(4)]
    return [determinant([row] + edges) for row in unit]


def winds_outward(corners, positions, t, normal):
    """1, -1, or 0 (no area, or a slice parallel to space): exact sign of triangle normal times spatial normal."""
    p, q, r = [exact_crossing(positions[a], positions[b], t) for a, b in corners]
    u, w = [y - x for x, y in zip(p, q)], [y - x for x, y in zip(p, r)]
    cross = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]]
    dot = sum(c * n for c, n in zip(cross, normal))
    return (dot > 0) - (dot < 0)


def slice_tet(tet, positions, t, last_t, check_winding=False):
    """Yields (keys, points) per triangle. tet: four keys of positions; a key of a slice vertex is an edge (a, b), or
    (a, a) where the slice goes through vertex a."""
    order = sorted(tet, key=lambda v: positions[v][3])  # stable
    odd = parity(order, tet)
    for corners in cut_of(order, positions, t, last_t):
        if check_winding:
            sign = winds_outward(corners, positions, t, outward_normal(tet, positions)[:3])
            t4.require(sign != (1 if odd else -1), f"tetrahedron {tet}", "its slice winds inward")
        keys = [(a, a) if positions[a][3] == t else (b, b) if positions[b][3] == t else (a, b) for a, b in corners]
        if len(set(keys)) < 3:
            continue
        points = [crossing(positions[a], positions[b], t) for a, b in corners]
        if odd:
            keys, points = [keys[0], keys[2], keys[1]], [points[0], points[2], points[1]]
        yield keys, points


def canonical(keys):
    """A triangle's keys, rotated so that the smallest stands first: winding is kept."""
    first = keys.index(min(keys))
    return tuple(keys[first:] + keys[:first])
