"""Cuts of CAD faces that close in themselves, as a fillet or a bead around a whole tool: their parts have four edges,
and so a regular mesh."""
import numpy as np

# Parts of the size of the box within which two planes count as one.
SAME_PLANE = 0.02


def is_closed(gmsh, tag):
    """Tell whether a curved face has an edge that ends where it begins."""
    if gmsh.model.getType(2, tag) == "Plane":
        return False
    edges = {abs(edge) for _, edge in gmsh.model.getBoundary([(2, tag)], combined=False, oriented=False)}
    return any(len({point for _, point in gmsh.model.getBoundary([(1, edge)], combined=False)}) < 2
               and gmsh.model.occ.getMass(1, edge) > 1e-9 for edge in edges)


def planes_through(boxes, size):
    """Return planes as (axis of the normal, coordinate): two through the middle of each box along its shortest side."""
    planes = []
    for low, high in boxes:
        along = int(np.argmin(high - low))
        for axis in (axis for axis in range(3) if axis != along):
            place = (low[axis] + high[axis]) / 2
            if not any(axis == other and abs(place - there) < SAME_PLANE * size for other, there in planes):
                planes.append((axis, place))
    return planes


def cut(gmsh, tags, chosen):
    """Cut all faces by planes through the middles of the chosen ones; return the parts of each face. Solids go."""
    occ = gmsh.model.occ
    low, high = np.reshape(gmsh.model.getBoundingBox(-1, -1), (2, 3))
    centre, size = (low + high) / 2, float(np.linalg.norm(high - low))
    boxes = [np.reshape(gmsh.model.getBoundingBox(2, tag), (2, 3)) for tag in chosen]
    tools = []
    for axis, place in planes_through(boxes, size):
        middle = centre.copy()
        middle[axis] = place
        tag = occ.addRectangle(middle[0] - size, middle[1] - size, middle[2], 2 * size, 2 * size)
        if axis != 2:
            occ.rotate([(2, tag)], *middle, *((0, 1, 0) if axis == 0 else (1, 0, 0)), np.pi / 2)
        tools.append((2, tag))
    occ.remove(occ.getEntities(3))
    _, parts = occ.fragment([(2, tag) for tag in tags], tools)
    parts = [[tag for _, tag in part] for part in parts[:len(tags)]]
    kept = {tag for part in parts for tag in part}
    occ.remove([(2, tag) for _, tag in occ.getEntities(2) if tag not in kept], recursive=True)
    occ.synchronize()
    return parts
