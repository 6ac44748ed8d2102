# SPDX-License-Identifier: GPL-3.0-or-later
"""Structured meshes of hexahedra as .inp files."""

CORNERS = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)]
EDGES = [(0, -1, -1), (1, 0, -1), (0, 1, -1), (-1, 0, -1), (0, -1, 1), (1, 0, 1), (0, 1, 1), (-1, 0, 1),
         (-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
INNER = [(0, 0, 0), (0, 0, -1), (0, 0, 1), (0, -1, 0), (1, 0, 0), (0, 1, 0), (-1, 0, 0)]
NODES = {8: CORNERS, 20: CORNERS + EDGES, 27: CORNERS + EDGES + INNER}
# Weights of a uniform load on a face: corners, middles of edges, centre.
FACE_WEIGHTS = {8: (1 / 4,), 20: (-1 / 12, 1 / 3), 27: (1 / 36, 4 / 36, 16 / 36)}


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

    def fractions(self, axis, side):
        """Return the fractions of a uniform load on the first or last plane of an axis by node; its faces are equal."""
        result, plane = {}, 2 * side * self.divisions[axis]
        for nodes in self.elements:
            for node, key in zip(NODES[self.count], nodes):
                if key[axis] == plane:
                    middle = [n for a, n in enumerate(node) if a != axis].count(0)
                    result[key] = result.get(key, 0.0) + FACE_WEIGHTS[self.count][middle]
        total = sum(result.values())
        return {key: weight / total for key, weight in result.items()}
