"""Structured meshes of hexahedra as .inp files, and the nodal forces of a pressure on their faces."""
import math

CORNERS = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)]
EDGES = [(0, -1, -1), (1, 0, -1), (0, 1, -1), (-1, 0, -1), (0, -1, 1), (1, 0, 1), (0, 1, 1), (-1, 0, 1),
         (-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
INNER = [(0, 0, 0), (0, 0, -1), (0, 0, 1), (0, -1, 0), (1, 0, 0), (0, 1, 0), (-1, 0, 0)]
NODES = {8: CORNERS, 20: CORNERS + EDGES, 27: CORNERS + EDGES + INNER}
FACES = {8: [(-1, -1), (1, -1), (1, 1), (-1, 1)], 27: [(i, j) for j in (-1, 0, 1) for i in (-1, 0, 1)]}
FACES[20] = FACES[8] + [(0, -1), (1, 0), (0, 1), (-1, 0)]
GAUSS = [(-math.sqrt(0.6), 5 / 9), (0.0, 8 / 9), (math.sqrt(0.6), 5 / 9)]


def node_count(element):
    """Return the nodes of an element by its name."""
    return {"hex20": 20, "hex27": 27}.get(element, 8)


class Mesh:
    """A box of u, v, w from 0 to 1 in elements, mapped to places. Nodes are addressed by half elements (i, j, k)."""

    def __init__(self, element, divisions, place):
        self.count, self.divisions = node_count(element), divisions
        half = [2 * n for n in divisions]
        self.elements = [[tuple(2 * e + 1 + n for e, n in zip((i, j, k), node)) for node in NODES[self.count]]
                         for k in range(divisions[2]) for j in range(divisions[1]) for i in range(divisions[0])]
        used = {key for nodes in self.elements for key in nodes}
        self.label = {key: n + 1 for n, key in enumerate(sorted(used))}
        self.place = {key: place(*(n / h for n, h in zip(key, half))) for key in self.label}

    def plane(self, axis, side):
        """Return the nodes of the first (0) or last (1) plane of an axis."""
        return [key for key in self.label if key[axis] == 2 * side * self.divisions[axis]]

    def write(self, path, sets):
        """Write the mesh with named lists of nodes."""
        lines = ["*NODE"]
        lines += [f"{label}, " + ", ".join(f"{x:.10g}" for x in self.place[key]) for key, label in self.label.items()]
        lines.append(f"*ELEMENT, TYPE=C3D{self.count}, ELSET=body")
        for n, nodes in enumerate(self.elements, 1):
            words = [str(n), *(str(self.label[key]) for key in nodes)]
            lines += [", ".join(words[i:i + 12]) + ("," if i + 12 < len(words) else "")
                      for i in range(0, len(words), 12)]
        for name, keys in sets.items():
            lines.append(f"*NSET, NSET={name}")
            labels = [str(self.label[key]) for key in keys]
            lines += [", ".join(labels[i:i + 14]) for i in range(0, len(labels), 14)]
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")

    def pressure_forces(self, axis):
        """Return the forces of a unit pressure on the first plane of an axis by node, consistent with the element."""
        forces, others = {}, [a for a in range(3) if a != axis]
        for nodes in self.elements:
            if min(key[axis] for key in nodes) > 0:
                continue
            face = {}
            for node, key in zip(NODES[self.count], nodes):
                if key[axis] == 0:
                    face[node[others[0]], node[others[1]]] = key
            for s, weight_s in GAUSS:
                for t, weight_t in GAUSS:
                    shape = {node: face_shape(self.count, node, s, t) for node in face}
                    base = [[sum(shape[node][d] * self.place[key][x] for node, key in face.items()) for x in range(3)]
                            for d in (1, 2)]
                    normal = cross(*base) if axis != 1 else cross(*base[::-1])
                    for node, key in face.items():
                        force = forces.setdefault(key, [0.0, 0.0, 0.0])
                        for x in range(3):
                            force[x] += weight_s * weight_t * shape[node][0] * normal[x]
        return forces


def cross(a, b):
    """Return the vector product."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def face_shape(count, node, s, t):
    """Return the shape function of a node of a face and its derivatives along s and t."""
    (a, da), (b, db) = (line_shape(count, *pair) for pair in zip(node, (s, t)))
    if count == 20 and 0 not in node:  # serendipity corner: (1 + s a)(1 + t b)(s a + t b - 1)/4
        i, j = node
        p, q, r = 1 + s * i, 1 + t * j, s * i + t * j - 1
        return p * q * r / 4, i * q * (r + p) / 4, j * p * (r + q) / 4
    return a * b, da * b, a * db


def line_shape(count, node, s):
    """Return the shape function of a line and its derivative: linear for corners of 8 or 20 nodes."""
    if node == 0:
        return 1 - s * s, -2 * s
    if count == 27:
        return 0.5 * s * (s + node), s + 0.5 * node
    return 0.5 * (1 + s * node), 0.5 * node
