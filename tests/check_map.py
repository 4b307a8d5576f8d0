#!/usr/bin/env python3
"""A stranger's check of an exported map: knows nothing but the GeoJSON (or OSM XML) file itself.

    check_map.py MAP.geojson            checks streets, junctions, settlements and buildings
    check_map.py MAP.osm --osm          checks that ways share nodes where they meet, and nowhere else

Needs Python 3 alone. Prints each finding with its place and exits 1 if there is any, 2 if the file cannot be read.
"""

import argparse
import json
import math
import sys
import xml.etree.ElementTree as xml
from collections import Counter, defaultdict

TOLERANCE = 1e-6
NEAR_MISS = 5.0
# Streets this near to a settlement's outline belong to it.
RIM = 1.0
CELL = 40.0
# Full width of the carriageway in metres.
CARRIAGEWAY = {"highway": 15.0, "major": 9.5, "minor": 6.5, "ramp": 5.0, "arterial": 12.0, "main": 9.0, "local": 6.0}


class Street:
    def __init__(self, id, line, start, end, level=0, road=False, width=6.0):
        self.id, self.line, self.start, self.end = id, line, start, end
        self.level, self.road, self.width = level, road, width

    def segments(self):
        return list(zip(self.line, self.line[1:]))

    def middle(self):
        """The point half way along."""
        left = sum(distance(a, b) for a, b in self.segments()) / 2
        for a, b in self.segments():
            length = distance(a, b)
            if length > 0 and left <= length:
                return a[0] + (b[0] - a[0]) * left / length, a[1] + (b[1] - a[1]) * left / length
            left -= length
        return self.line[-1]


class Grid:
    """Segments (or anything with a box) by the cells of a grid that they overlap."""

    def __init__(self):
        self.cells = defaultdict(list)

    @staticmethod
    def over(low, high):
        for x in range(math.floor(low[0] / CELL), math.floor(high[0] / CELL) + 1):
            for y in range(math.floor(low[1] / CELL), math.floor(high[1] / CELL) + 1):
                yield x, y

    def put(self, points, what, margin=TOLERANCE):
        for cell in self.over(*box(points, margin)):
            self.cells[cell].append(what)

    def near(self, points, margin=TOLERANCE):
        found = {}
        for cell in self.over(*box(points, margin)):
            for what in self.cells.get(cell, ()):
                found[what] = None
        return list(found)


def box(points, margin=0.0):
    xs, ys = [p[0] for p in points], [p[1] for p in points]
    return (min(xs) - margin, min(ys) - margin), (max(xs) + margin, max(ys) + margin)


def sub(a, b):
    return a[0] - b[0], a[1] - b[1]


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1]


def distance(a, b):
    return math.hypot(a[0] - b[0], a[1] - b[1])


def nearest(p, a, b):
    """The point of segment a-b nearest to p."""
    ab = sub(b, a)
    length2 = dot(ab, ab)
    t = 0.0 if length2 == 0 else max(0.0, min(1.0, dot(sub(p, a), ab) / length2))
    return a[0] + ab[0] * t, a[1] + ab[1] * t


def proper_crossing(a, b, c, d):
    """The point where two segments cross in the inside of both, or None."""
    ab, cd = sub(b, a), sub(d, c)
    sides = cross(ab, sub(c, a)), cross(ab, sub(d, a)), cross(cd, sub(a, c)), cross(cd, sub(b, c))
    if sides[0] * sides[1] >= 0 or sides[2] * sides[3] >= 0:
        return None
    t = sides[2] / (sides[2] - sides[3])
    return a[0] + ab[0] * t, a[1] + ab[1] * t


def contacts(a, b, c, d):
    """Points where two segments cross, or an end of one lies on the other."""
    at = proper_crossing(a, b, c, d)
    found = [] if at is None else [at]
    for p, (s, e) in ((a, (c, d)), (b, (c, d)), (c, (a, b)), (d, (a, b))):
        if distance(p, nearest(p, s, e)) <= TOLERANCE:
            found.append(p)
    return found


def inside(p, ring):
    odd = False
    for (x1, y1), (x2, y2) in zip(ring, ring[1:] + ring[:1]):
        if (y1 > p[1]) != (y2 > p[1]) and p[0] < (x2 - x1) * (p[1] - y1) / (y2 - y1) + x1:
            odd = not odd
    return odd


def segment_distance(a, b, c, d):
    if proper_crossing(a, b, c, d) is not None:
        return 0.0
    pairs = ((a, (c, d)), (b, (c, d)), (c, (a, b)), (d, (a, b)))
    return min(distance(p, nearest(p, s, e)) for p, (s, e) in pairs)


class Groups:
    """Things that are joined, directly or through others."""

    def __init__(self):
        self.parent = {}

    def root(self, x):
        self.parent.setdefault(x, x)
        while self.parent[x] != x:
            self.parent[x] = self.parent[self.parent[x]]
            x = self.parent[x]
        return x

    def join(self, a, b):
        self.parent[self.root(a)] = self.root(b)


class Check:
    def __init__(self):
        self.findings = []
        self.streets, self.junctions = [], {}
        self.settlements, self.buildings = [], []
        self.square = None

    def report(self, what, at, about=""):
        self.findings.append(f"{what} at {at[0]:.4f},{at[1]:.4f} {about}".rstrip())

    # Reading

    def read_geojson(self, path):
        with open(path, encoding="utf-8") as file:
            collection = json.load(file)
        if collection.get("type") != "FeatureCollection":
            raise ValueError("no FeatureCollection")
        west, south, east, north = collection["bbox"]
        self.square = (west, south), (east, north)
        ids = Counter()
        for feature in collection["features"]:
            of, coordinates = feature["properties"], feature["geometry"]["coordinates"]
            kind = of["kind"]
            ids[kind if kind not in ("street", "road") else "way", of["id"]] += 1
            if kind in ("street", "road"):
                line = [tuple(p) for p in coordinates]
                width = CARRIAGEWAY[of["class"]]
                street = Street(of["id"], line, of["from"], of["to"], of.get("level", 0), kind == "road", width)
                self.streets.append(street)
            elif kind == "junction":
                self.junctions[of["id"]] = tuple(coordinates)
            elif kind == "settlement" and feature["geometry"]["type"] == "Polygon":
                self.settlements.append((of.get("name", of["id"]), [tuple(p) for p in coordinates[0][:-1]]))
            elif kind == "building":
                ring = [tuple(p) for p in coordinates[0]]
                if ring[0] != ring[-1]:
                    self.report("open ring", ring[0], of["id"])
                self.buildings.append((of["id"], ring[:-1]))
        for (kind, id), count in ids.items():
            if count > 1:
                self.report(f"id used {count} times", (math.nan, math.nan), f"{kind} {id}")

    def read_osm(self, path):
        metres = 6378137.0 * math.pi / 180.0
        root = xml.parse(path).getroot()
        at = {}
        for node in root.iter("node"):
            if node.get("id") in at:
                self.report("id used twice", at[node.get("id")], f"node {node.get('id')}")
            at[node.get("id")] = float(node.get("lon")) * metres, float(node.get("lat")) * metres
        bounds = root.find("bounds")
        sides = [float(bounds.get(k)) * metres for k in ("minlon", "minlat", "maxlon", "maxlat")]
        self.square = (sides[0], sides[1]), (sides[2], sides[3])
        for way in root.iter("way"):
            tags = {tag.get("k"): tag.get("v") for tag in way.iter("tag")}
            if "highway" not in tags:
                continue
            refs = [nd.get("ref") for nd in way.iter("nd")]
            missing = [ref for ref in refs if ref not in at]
            if missing or len(refs) < 2:
                self.report("broken way", (math.nan, math.nan), way.get("id"))
                continue
            street = Street(way.get("id"), [at[r] for r in refs], refs[0], refs[-1], int(tags.get("layer", 0)))
            self.streets.append(street)
            self.junctions.update({ref: at[ref] for ref in (refs[0], refs[-1])})
        places = Counter(at[ref] for ref in self.junctions)
        for place, count in places.items():
            if count > 1:
                self.report(f"{count} nodes for one junction", place)

    # Checking

    def check(self):
        self.ends()
        self.grid = Grid()
        for i, street in enumerate(self.streets):
            for k, segment in enumerate(street.segments()):
                self.grid.put(segment, (i, k))
        self.crossings()
        self.near_misses()
        self.whole_settlements()
        self.carriageways()

    def ends(self):
        for street in self.streets:
            for id, at in ((street.start, street.line[0]), (street.end, street.line[-1])):
                if id not in self.junctions:
                    self.report("end without a junction", at, f"street {street.id}")
                elif self.junctions[id] != at:
                    self.report("end away from its junction", at, f"street {street.id}, junction {id}")
            if any(a == b for a, b in street.segments()):
                self.report("repeated point", street.line[0], f"street {street.id}")
        by_place = defaultdict(list)
        for id, at in self.junctions.items():
            by_place[at].append(id)
        for at, ids in by_place.items():
            if len(ids) > 1:
                self.report("two junctions in one place", at, " ".join(ids))

    def shared(self, a, b, at):
        """Whether `at` is a junction of both streets."""
        return any(
            id in (b.start, b.end) and distance(self.junctions.get(id, (math.nan, math.nan)), at) <= TOLERANCE
            for id in (a.start, a.end)
        )

    def crossings(self):
        seen = set()
        for i, street in enumerate(self.streets):
            segments = street.segments()
            for k, (a, b) in enumerate(segments):
                for j, m in self.grid.near((a, b)):
                    other = self.streets[j]
                    if (j, m) <= (i, k) or other.level != street.level:
                        continue
                    c, d = other.segments()[m]
                    for at in contacts(a, b, c, d):
                        chained = i == j and m == k + 1 and distance(at, b) <= TOLERANCE
                        if not chained and not self.shared(street, other, at):
                            key = min(i, j), max(i, j), round(at[0], 4), round(at[1], 4)
                            if key not in seen:
                                seen.add(key)
                                self.report("streets meet without a junction", at, f"{street.id} {other.id}")
                    # From a common end two segments may run on top of each other.
                    for p, u in ((a, b), (b, a)):
                        for q, v in ((c, d), (d, c)):
                            if distance(p, q) > TOLERANCE:
                                continue
                            one, two = sub(u, p), sub(v, q)
                            size = math.hypot(*one) * math.hypot(*two)
                            if size > 0 and abs(cross(one, two)) <= TOLERANCE * math.sqrt(size) and dot(one, two) > 0:
                                self.report("streets lie on each other", p, f"{street.id} {other.id}")
        # A junction in the inside of a street should have divided it.
        for id, at in self.junctions.items():
            for i, k in self.grid.near((at,)):
                street = self.streets[i]
                if id in (street.start, street.end) or self.level_of(id) not in (None, street.level):
                    continue
                a, b = street.segments()[k]
                if distance(at, nearest(at, a, b)) <= TOLERANCE:
                    self.report("junction inside a street", at, f"junction {id}, street {street.id}")

    def level_of(self, id):
        """The level of all streets at a junction; None where levels meet."""
        if not hasattr(self, "levels"):
            self.levels = defaultdict(set)
            for street in self.streets:
                for end in (street.start, street.end):
                    self.levels[end].add(street.level)
        levels = self.levels[id]
        return next(iter(levels)) if len(levels) == 1 else None

    def within(self, at, margin):
        (west, south), (east, north) = self.square
        return west + margin < at[0] < east - margin and south + margin < at[1] < north - margin

    def near_misses(self):
        degree = Counter()
        for street in self.streets:
            degree.update((street.start, street.end))
        for id, at in self.junctions.items():
            if degree[id] == 0:
                self.report("junction without a street", at, id)
            # Streets beyond the square are not in the file.
            if degree[id] != 1 or not self.within(at, NEAR_MISS + TOLERANCE):
                continue
            for i, k in self.grid.near((at,), NEAR_MISS):
                street = self.streets[i]
                if id in (street.start, street.end) or street.level != (self.level_of(id) or 0):
                    continue
                a, b = street.segments()[k]
                if distance(at, nearest(at, a, b)) < NEAR_MISS:
                    self.report("dead end short of a street", at, f"street {street.id}")

    def whole_settlements(self):
        ends = defaultdict(lambda: [0, 0])
        for street in self.streets:
            for id in (street.start, street.end):
                ends[id][0 if street.road else 1] += 1
        corners = {}
        for name, ring in self.settlements:
            for p in ring:
                corners[p] = name
        for id, (roads, streets) in ends.items():
            at = self.junctions.get(id)
            if at is None or not self.within(at, TOLERANCE) or roads == 0 or streets > 0:
                continue
            if at in corners:
                self.report("gate without a street", at, corners[at])
            elif roads == 1:
                self.report("road that ends nowhere", at, id)
        for name, ring in self.settlements:
            low, high = box(ring)
            if not (self.within(low, 0.0) and self.within(high, 0.0)):
                continue
            groups, places, sides = Groups(), {}, list(zip(ring, ring[1:] + ring[:1]))
            for street in self.streets:
                if street.road:
                    continue
                middle = street.middle()
                if low[0] - RIM <= middle[0] <= high[0] + RIM and low[1] - RIM <= middle[1] <= high[1] + RIM:
                    on_rim = lambda: any(distance(middle, nearest(middle, a, b)) <= RIM for a, b in sides)
                    if inside(middle, ring) or on_rim():
                        groups.join(street.start, street.end)
                        places[street.start] = street.line[0]
            roots = {groups.root(id) for id in places}
            if not places:
                self.report("settlement without streets", low, name)
            if len(roots) > 1:
                sizes = Counter(groups.root(id) for id in places)
                smallest = min(sizes, key=lambda r: (sizes[r], r))
                at = next(p for id, p in places.items() if groups.root(id) == smallest)
                self.report(f"settlement in {len(roots)} pieces", at, name)

    def carriageways(self):
        for id, ring in self.buildings:
            for i, k in self.grid.near(ring, max(CARRIAGEWAY.values()) / 2):
                street = self.streets[i]
                if street.level != 0:
                    continue
                a, b = street.segments()[k]
                apart = min(segment_distance(a, b, c, d) for c, d in zip(ring, ring[1:] + ring[:1]))
                if inside(a, ring) or apart < street.width / 2 - 1e-3:
                    self.report("building on a carriageway", ring[0], f"building {id}, street {street.id}")
                    break


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("file")
    parser.add_argument("--osm", action="store_true", help="the file is OSM XML")
    parser.add_argument("--most", type=int, default=50, help="findings to print")
    flags = parser.parse_args()
    check = Check()
    try:
        check.read_osm(flags.file) if flags.osm or flags.file.endswith(".osm") else check.read_geojson(flags.file)
    except (OSError, ValueError, KeyError, AttributeError, xml.ParseError) as error:
        print(f"{flags.file}: {error!r}", file=sys.stderr)
        return 2
    check.check()
    for finding in check.findings[: flags.most]:
        print(finding)
    print(
        f"{len(check.streets)} streets, {len(check.junctions)} junctions, {len(check.settlements)} settlements, "
        f"{len(check.buildings)} buildings: {len(check.findings)} findings"
    )
    return 1 if check.findings else 0


if __name__ == "__main__":
    sys.exit(main())
