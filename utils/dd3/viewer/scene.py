# SPDX-License-Identifier: GPL-3.0-or-later
"""What the 3D view of a page shows: the sheet at its steps with all fields, its tools, the forming limit curve, places.

The scripts of the page read the description of a scene. Its steps are those of fields.vtkhdf; after a release follows
the free shape once more, moved to the best fit with the drawn one.
"""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import matplotlib
import numpy as np
from scipy.spatial import cKDTree

from dd3 import forming_limit, springback, verdict
from dd3 import forming_limit_curve as curves
from dd3.fields import components_of, odd_axes, text_of
from dd3.plot import scale, skins
from dd3.plot import sheet as pictures
from dd3.plot.beads import draped
from dd3.sheet import AXES, Sheet
from dd3.viewer.arrays import Arrays
from dd3.viewer.skin import Skin, skin_of

TOOL_POINTS = 20000  # of a tool, about
MOST = 40_000_000  # values of all fields at all steps; of more, steps between the ends of phases are left out
MAPS = {"viridis": scale.SEQUENTIAL, "cividis": "cividis", "diverging": scale.DIVERGING}
COLOURS = 64  # of a map
WHOLE_COLOURS = ("#d0d4d8", "#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#f0e442")
STATUS = ("no contact", "stick", "slip")
ZONES = ("no warning", "thickens, may wrinkle", "thinning of 80 to 100 % of the limit", "thinning above the limit")
ZONE_COLOURS = ("#e3e7eb", "#0072b2", "#f0e442", "#d55e00")
NEAR = 0.8  # of the limit of thinning
NEAREST = 1.2  # distance of corners over the least one up to which they count for the normal between them
PLACES = (("punches", "off_tools", "farthest from the tools at the end of the path of {}"),
          ("punches", "off_walls", "farthest from the tools in walls"),
          ("punches", "path_left", "path left of {} is shortest"), ("holders", "wave", "highest wave under {}"),
          ("holders", "beyond", "rim farthest beyond {}"))
DISTANCE = "distance from the drawn shape (mm)"


class Picture(NamedTuple):
    """A step of the view: its step in the fields, its name, the places of its nodes; `free`: it is the free shape in
    the mesh of the drawn one, whose nodes are `nodes` of the last mesh."""

    step: int
    mesh: int  # step whose mesh it has
    name: str
    points: np.ndarray
    free: bool = False
    nodes: np.ndarray | None = None


class Scene:
    """A run with what is added to its view."""

    def __init__(self, sheet: Sheet, run: pictures.Run, mirror: Sequence[str], limits: forming_limit.Limits,
                 margin: float) -> None:
        self.sheet, self.run, self.mirror, self.limits, self.margin = sheet, run, mirror, limits, margin
        self.arrays = Arrays()
        self.skins: dict[int, Skin] = {}  # by the number of the mesh
        self.sprung = springback.find(sheet, run.job["phases"], mirror)
        self.pictures = list(self.pictures_of())

    def skin(self, step: int) -> Skin:
        """Return the skin of the mesh of a step."""
        number = self.sheet.mesh_number(step)
        if number not in self.skins:
            self.skins[number] = skin_of(self.sheet, step)
        return self.skins[number]

    def pictures_of(self) -> Iterator[Picture]:
        """Return the steps of the view."""
        sheet = self.sheet
        for step in kept_steps(sheet):
            yield Picture(step, step, sheet.state(step), sheet.points(step))
        if self.sprung:
            yield Picture(sheet.last, self.sprung.step, "free shape, moved to the best fit with the drawn one",
                          self.sprung.free, True, sheet.nodes_in(self.sprung.step, sheet.last))

    def description(self) -> dict[str, Any]:
        """Return the description; the arrays are then those of the page."""
        fields = [*self.fields(False), *self.fields(True), *self.limit_fields(), *self.distances()]
        return {
            "mirror": list(self.mirror), "fields": fields, "steps": [self.step(picture) for picture in self.pictures],
            "meshes": {number: self.mesh(skin) for number, skin in self.skins.items()},
            "left_out": self.sheet.count - len({picture.step for picture in self.pictures}),
            "tools": list(self.tools()), "beads": self.beads(), "places": list(places_of(self.run.job, self.pictures)),
            "limit": limit_of(self.limits, self.margin), "drawn": self.drawn(),
            "maps": {name: matplotlib.colormaps[known](np.linspace(0, 1, COLOURS))[:, :3].round(4).tolist()
                     for name, known in MAPS.items()}}

    def mesh(self, skin: Skin) -> dict[str, Any]:
        """Return the description of a skin; numbers of nodes and elements are from 1."""
        elements, owner = np.unique(skin.owners, return_inverse=True)
        add = self.arrays.add_whole
        return {"nodes": add(skin.nodes + 1), "places": add(skin.places), "triangles": add(skin.triangles),
                "elements": add(elements + 1), "owners": add(owner), "sides": add(skin.sides), "edges": add(skin.edges)}

    def step(self, picture: Picture) -> dict[str, Any]:
        """Return the description of a step: mesh, places of the nodes, tools that act."""
        sheet, skin, number = self.sheet, self.skin(picture.mesh), 0
        job = sheet.file["job"]
        if "phase" in job:
            number = int(job["phase"][picture.step])
        known = 0 < number <= len(sheet.phases)
        phase: dict[str, Any] = sheet.phases[number - 1] if known else {"name": "", "tools": []}
        placed = {name: np.block([[place.axes, np.zeros((3, 1))], [place.displacement, 1.0]]).ravel().tolist()
                  for name, place in self.run.tool_placements(picture.step).items()}
        return {"name": picture.name, "mesh": sheet.mesh_number(picture.mesh), "phase": phase["name"],
                "free": picture.free, "placed": placed,
                "active": [tool["name"] for tool in phase["tools"] if tool["active"]],
                "points": [self.arrays.add(picture.points[skin.nodes, i]) for i in range(3)]}

    def drawn(self) -> list[dict[str, Any]] | None:
        """Return the places of the nodes of the drawn shape, which lies over the free one."""
        if not self.sprung:
            return None
        nodes = self.skin(self.sprung.step).nodes
        return [self.arrays.add(self.sprung.drawn[nodes, i]) for i in range(3)]

    def fields(self, at_cells: bool) -> Iterator[dict[str, Any]]:
        """Return the fields of the run at the nodes or at the elements, vectors by component."""
        where = self.sheet.grid.get("CellData" if at_cells else "PointData", {})
        for name, data in where.items():
            parts = [""] if data.ndim == 1 else list(components_of(data.shape[1]))
            if data.ndim > 1 and len(parts) == len(AXES):
                parts.append("magnitude")
            for part in parts:
                field = f"{name}:{part}" if part else name
                values = [self.values(picture, field, at_cells) for picture in self.pictures]
                kind = self.kind(name, data)
                odd = [axis for axis in odd_axes(field) if axis in self.mirror]
                yield {"name": field, "label": self.sheet.component(0, field, at_cells)[1], "odd": odd,
                       "help": text_of(data.attrs.get("description", "")), "elements": at_cells, **kind,
                       **self.written(values, np.issubdtype(data.dtype, np.integer), kind["percent"], name, bool(odd))}

    def values(self, picture: Picture, field: str, at_cells: bool) -> np.ndarray | None:
        """Return a field at the nodes or elements of a skin; None for elements of another mesh."""
        sheet, skin = self.sheet, self.skin(picture.mesh)
        if at_cells and sheet.mesh_number(picture.mesh) != sheet.mesh_number(picture.step):
            return None
        values = sheet.component(picture.step, field, at_cells)[0]
        if at_cells:
            return values[np.unique(skin.owners)]
        return values[skin.nodes if picture.nodes is None else picture.nodes[skin.nodes]]

    def kind(self, name: str, data: Any) -> dict[str, Any]:
        """Return how the values of a field are shown: as numbers, in per cent, or by names."""
        if name == "contact_status":
            return named(STATUS)
        if name == "contact_tool":
            return named(["none", *(tool["name"] for tool in self.run.job["tools"])])
        if np.issubdtype(data.dtype, np.integer):
            return named(list(map(str, range(int(data[:].max()) + 1))))
        return {"percent": scale.in_per_cent(name)}

    def written(self, values: Sequence[np.ndarray | None], whole: bool, percent: bool = False, name: str = "",
                odd: bool = False) -> dict[str, Any]:
        """Return arrays of a field, one for each step of the view, its scale at each of them, and that of all. odd: its
        sign is another one in mirror images."""
        factor = 100.0 if percent else 1.0
        ends = [None if part is None else tuple(factor * float(end(part)) for end in (np.nanmin, np.nanmax))
                for part in values]
        if odd:
            ends = [pair and (min(pair[0], -pair[1]), max(pair[1], -pair[0])) for pair in ends]
        lows, highs = zip(*(pair for pair in ends if pair))
        add = self.arrays.add_whole if whole else self.arrays.add
        return {"values": [None if part is None else add(part) for part in values],
                "scale": scale.scale_of(name, min(lows), max(highs)),
                "scales": [pair and scale.scale_of(name, *pair) for pair in ends]}

    def limit_fields(self) -> Iterator[dict[str, Any]]:
        """Return the strains and zones of the forming limit diagram, and the zones of thinning and thickening, at nodes
        and elements."""
        strains = [forming_limit.strains_of(self.sheet, picture.step, "middle") for picture in self.pictures]
        for at_cells in (False, True):
            parts = [self.on_skin(picture, every, at_cells) for picture, every in zip(self.pictures, strains)]
            for role in ("minor", "major"):
                yield {"name": f"limit_{role}", "label": f"{role} strain, middle, as in the forming limit diagram",
                       "help": "", "elements": at_cells, "percent": True, "role": role,
                       **self.written([None if part is None else getattr(part, role) for part in parts], False, True)}
            if self.limits.curve:
                curve, margin = self.limits.curve, self.margin
                zones = [None if part is None else curve.zones(part.major, part.minor, margin) for part in parts]
                yield {"name": "limit_zone", "label": "zone of the forming limit diagram", "help": "", "role": "zone",
                       "elements": at_cells, **named(curves.ZONES, curves.COLOURS),
                       **self.written(zones, True)}
            yield {"name": "thinning_zone", "label": "zones of thinning and wrinkling", "elements": at_cells,
                   "help": f"limit of thinning {100 * self.limits.thinning:g} %; it thickens where the major strain is "
                           "smaller than minus the minor one",
                   **named(ZONES, ZONE_COLOURS),
                   **self.written([None if part is None else self.zones(part) for part in parts], True)}

    def on_skin(self, picture: Picture, strains: forming_limit.Strains, at_cells: bool) -> forming_limit.Strains | None:
        """Return strains at the nodes or elements of a skin; None for elements of another mesh."""
        skin = self.skin(picture.mesh)
        if not at_cells:
            nodes = skin.nodes if picture.nodes is None else picture.nodes[skin.nodes]
            return forming_limit.Strains(strains.major[nodes], strains.minor[nodes], strains.thinning[nodes])
        if self.sheet.mesh_number(picture.mesh) != self.sheet.mesh_number(picture.step) or strains.at_cells is None:
            return None
        cells, owners = strains.at_cells, np.unique(skin.owners)
        return forming_limit.Strains(cells.major[owners], cells.minor[owners], cells.thinning[owners])

    def zones(self, strains: forming_limit.Strains) -> np.ndarray:
        """Return the zones of thinning and thickening, numbers of ZONES."""
        zone = np.zeros(len(strains.major), int)
        large = np.maximum(np.abs(strains.major), np.abs(strains.minor)) >= curves.LEAST_STRAIN
        zone[large & (strains.major < -strains.minor)] = 1
        zone[strains.thinning > NEAR * self.limits.thinning] = 2
        zone[strains.thinning > self.limits.thinning] = 3
        return zone

    def distances(self) -> Iterator[dict[str, Any]]:
        """Return the distance of the free shape from the drawn one along its normal, and its size."""
        if not self.sprung:
            return
        skin, apart = self.skin(self.sprung.step), self.sprung.free - self.sprung.drawn
        normals = upward_normals(self.sheet, self.sprung.step)
        for name, label, values in (
                ("distance_normal", "deviation along the normal of the drawn shape (mm)",
                 (apart * normals).sum(axis=1)), ("distance", DISTANCE, self.sprung.distance())):
            shown = [values[skin.nodes] if picture.free else None for picture in self.pictures]
            yield {"name": name, "label": label, "elements": False, "percent": False,
                   "help": "after the best fit; along the normal: positive towards the upper face",
                   **self.written(shown, False)}

    def tools(self) -> Iterator[dict[str, Any]]:
        """Return the surfaces of the tools whose files are there."""
        numbers = {tool["name"]: i + 1 for i, tool in enumerate(self.run.job["tools"])}
        for name, patches in pictures.find_tools(self.run).items():
            skin = skins.tool_surface(patches, skins.Placement(np.eye(3), np.zeros(3)), TOOL_POINTS)
            edges = skins.sharp_edges(skin)
            quads = skin.faces.reshape(-1, 5)[:, 1:]
            add = self.arrays.add_whole
            yield {"name": name, "number": numbers.get(name, 0),
                   "points": [self.arrays.add(skin.points[:, i]) for i in range(3)],
                   "triangles": add(np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])),
                   "edge_points": [self.arrays.add(edges.points[:, i]) for i in range(3)],
                   "edges": add(edges.lines.reshape(-1, 3)[:, 1:])}

    def beads(self) -> list[list[list[float]]]:
        """Return the lines of the draw-beads on the sheet of the last step."""
        nodes = self.sheet.points(self.sheet.last)
        return [draped(line, nodes).points.round(3).tolist() for line in self.run.beads.values()]


def kept_steps(sheet: Sheet) -> list[int]:
    """Return the steps of the view: all of them, or as many as MOST values allow, the ends of phases among them."""
    components = sum(int(np.prod(data.shape[1:])) for data in sheet.grid.get("PointData", {}).values())
    allowed = max(1, MOST // (max(sheet.size_of("Points", step) for step in range(sheet.count)) * max(components, 1)))
    if sheet.count <= allowed:
        return list(range(sheet.count))
    job = sheet.file["job"]
    ends = np.flatnonzero(np.diff(job["phase"][: sheet.count])).tolist() if "phase" in job else []
    even = np.linspace(0, sheet.last, max(2, allowed - len(ends))).round().astype(int).tolist()
    return sorted({*ends, *even, sheet.last})


def named(names: Sequence[str], colours: Sequence[str] = ()) -> dict[str, Any]:
    """Return the names and colours of the whole numbers from 0 that a field has."""
    return {"names": list(names), "percent": False,
            "colours": list(colours) or [WHOLE_COLOURS[i % len(WHOLE_COLOURS)] for i in range(len(names))]}


def limit_of(limits: forming_limit.Limits, margin: float) -> dict[str, Any]:
    """Return points of the forming limit curve, none without one, with why."""
    curve = limits.curve
    if curve is None:
        return {"label": limits.why, "margin": margin, "minor": [], "major": []}
    minor = np.linspace(min(-1.5, curve.minor.min()), max(1.0, curve.minor.max()), 501)
    return {"label": curve.label, "margin": margin, "minor": minor.round(5).tolist(),
            "major": curve.limit(minor).round(5).tolist()}


def places_of(job: dict[str, Any], shown: Sequence[Picture]) -> Iterator[dict[str, Any]]:
    """Return the places that the verdict names, at the ends of their phases."""
    for phase in verdict.ended_phases(job):
        steps = [i for i, picture in enumerate(shown) if picture.name.partition(",")[0] == phase.phase]
        found = [(text.format(tool["tool"]), tool[member]) for kind, member, text in PLACES
                 for tool in phase.closing[kind]]
        for text, place in found:
            if place and steps:
                yield {"text": f"{phase.phase}: {text}, {place['distance']:.2g} mm", "step": steps[-1],
                       "position": place["position"]}


def upward_normals(sheet: Sheet, step: int) -> np.ndarray:
    """Return the unit normals of the sheet at the nodes of a step, from its lower to its upper face. Nodes that are no
    corners of its faces have the mean of the corners that are nearest."""
    points = sheet.points(step)
    normals = np.zeros_like(points)
    for upper, sign in ((True, 1.0), (False, -1.0)):
        faces = sheet.faces(upper, step)
        across = np.cross(points[faces[:, 2]] - points[faces[:, 0]], points[faces[:, 3]] - points[faces[:, 1]])
        np.add.at(normals, faces, sign * across[:, None, :])
    known = normals.any(axis=1)
    if not known.all():
        distance, near = cKDTree(points[known]).query(points[~known], 4)
        close = distance <= NEAREST * distance[:, :1]
        normals[~known] = (normals[known] / np.linalg.norm(normals[known], axis=1)[:, None])[near].sum(
            axis=1, where=close[..., None])
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
