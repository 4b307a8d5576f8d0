//! The furniture of a map: symbols, names, scale bar, legend and frame.

use super::label::Label;
use super::sheet::{BUILDINGS, Colouring, Layer, ORIGINS, Pen, Sheet, nice, paths, round};
use crate::export::{Plan, glyphs};
use crate::network::{JunctionId, SizeClass, Street, StreetClass};
use crate::region::Settlement;
use crate::space::{Bounds, closest_on_segment, segments};
use glam::DVec2;
use std::collections::BTreeMap;
use std::sync::Arc;
use svg::node::element::{Circle, Group, Path, Rectangle};

/// Maps with more settlements than this leave out the names of small villages.
const MANY: usize = 120;
/// Radius of the dot of a junction, on a map of 1600 pixels.
const JUNCTION: f64 = 1.9;
/// Ink of symbols and frames.
const INK: &str = "#3c372f";

/// Radius of the ring that stands for a settlement, on a map of 1600 pixels.
fn symbol(size: SizeClass) -> f64 {
    match size {
        SizeClass::City => 6.5,
        SizeClass::Town => 4.6,
        SizeClass::Village => 2.9,
    }
}

/// A line of the legend.
enum Entry {
    Road(StreetClass, &'static str),
    Bridge,
    Tunnel,
    Real,
    Junction,
    Place(SizeClass, &'static str),
    Patch(&'static str, &'static str),
}

impl Entry {
    fn words(&self) -> &'static str {
        match self {
            Self::Road(_, words) | Self::Place(_, words) | Self::Patch(_, words) => words,
            Self::Bridge => "BRIDGE",
            Self::Tunnel => "TUNNEL",
            Self::Real => "REAL ROAD",
            Self::Junction => "JUNCTION",
        }
    }
}

impl Sheet {
    /// Pixels of this map for each pixel of a map of 1600.
    fn unit(&self) -> f64 {
        self.longer / 1600.0
    }

    /// A ring for each settlement that would hardly show at its true size. Villages come first, so that cities lie on top.
    pub(super) fn symbols(&self, plan: &Plan<'_>) -> Group {
        let mut group = Group::new().set("id", "symbols").set("fill", "#fffdf6").set("stroke", INK);
        for size in SizeClass::ALL.into_iter().rev() {
            let radius = symbol(size) * self.unit();
            let least = if self.region { 2.2 * radius } else { 1.3 * radius };
            let small = |s: &&Arc<Settlement>| s.size == size && s.radius * self.scale < least;
            for settlement in plan.area.settlements.iter().filter(small) {
                let at = self.place(plan.area.origin.to_local(settlement.centre.plan()));
                group = group.add(circle(at, radius).set("stroke-width", round(0.32 * radius)));
            }
        }
        group
    }

    /// A dot where three roads or more meet outside settlements.
    pub(super) fn junctions(&self, plan: &Plan<'_>) -> Group {
        let mut group = Group::new().set("id", "junctions").set("fill", INK);
        let mut roads: BTreeMap<JunctionId, usize> = BTreeMap::new();
        let ends = plan.area.streets.iter().flat_map(|s| [s.item.street.from, s.item.street.to]);
        ends.for_each(|end| *roads.entry(end).or_default() += 1);
        let places: Vec<(DVec2, f64)> = plan.area.settlements.iter().map(|s| self.disc(plan, s)).collect();
        for junction in plan.area.junctions.iter().filter(|j| roads.get(&j.item.id).is_some_and(|n| *n > 2)) {
            let at = self.place(junction.item.at);
            if !places.iter().any(|(centre, radius)| centre.distance(at) < radius + 2.0 * self.unit()) {
                group = group.add(circle(at, JUNCTION * self.unit()));
            }
        }
        group
    }

    /// The place of a settlement on the map, and the radius that it or its symbol takes up, in pixels.
    fn disc(&self, plan: &Plan<'_>, settlement: &Settlement) -> (DVec2, f64) {
        let centre = self.place(plan.area.origin.to_local(settlement.centre.plan()));
        (centre, (settlement.radius * self.scale).max(symbol(settlement.size) * self.unit()))
    }

    /// Names of settlements, the largest first, clear of symbols and of the boxes `taken`; on a map of a region also clear of
    /// roads, if a side of the settlement is. A name that would lie on another is left out.
    pub(super) fn names(&self, plan: &Plan<'_>, mut taken: Vec<Bounds>) -> Group {
        let mut group = Group::new().set("id", "names");
        let mut settlements: Vec<_> = plan.area.settlements.iter().collect();
        settlements.sort_by(|a, b| b.size.cmp(&a.size).then(b.radius.total_cmp(&a.radius)).then(a.id.cmp(&b.id)));
        let lines: Vec<Vec<DVec2>> = match self.region {
            true => plan.area.streets.iter().map(|s| self.placed(&s.item.street.line)).collect(),
            false => Vec::new(),
        };
        let discs: Vec<Bounds> = match self.region {
            true => settlements.iter().map(|s| self.disc(plan, s)).map(|(c, r)| Bounds::square(c, 1.6 * r)).collect(),
            false => Vec::new(),
        };
        for (i, settlement) in settlements.iter().enumerate() {
            let height = self.unit()
                * match settlement.size {
                    SizeClass::City => 19.0,
                    SizeClass::Town => 14.0,
                    SizeClass::Village => 10.0,
                };
            let label = Label::new(&settlement.name, height, self.has_text);
            let width = label.width;
            if settlement.size == SizeClass::Village && settlement.radius * self.scale < 7.0 && settlements.len() > MANY
            {
                continue;
            }
            let (centre, radius) = self.disc(plan, settlement);
            let sheet = Bounds::new(DVec2::ZERO, self.size);
            let half = DVec2::new(width, height) / 2.0;
            let around = |at: DVec2| Bounds::new(at - half, at + half).grown(height / 2.0);
            let free = |at: &DVec2| {
                let own = around(*at);
                let other = |(k, d): (usize, &Bounds)| k != i && d.overlaps(own);
                sheet.encloses(own) && !taken.iter().any(|t| t.overlaps(own)) && !discs.iter().enumerate().any(other)
            };
            // A name stands in the middle of a settlement that is wide enough, otherwise above it or on another side.
            let (up, side) = (radius + height, radius + half.x + 0.7 * height);
            let mut sides = vec![DVec2::ZERO];
            if width >= radius {
                sides = vec![DVec2::new(0.0, -up)];
                if self.region {
                    sides.extend([(0.0, up), (side, 0.0), (-side, 0.0)].map(|(x, y)| DVec2::new(x, y)));
                    sides.extend(
                        [(1.0, -1.0), (-1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                            .map(|(x, y)| DVec2::new(x * side, y * up) * 0.85),
                    );
                }
            }
            let crossed = |at: DVec2| {
                let own = Bounds::new(at - half, at + half).grown(0.15 * height);
                lines.iter().flat_map(|l| segments(l)).filter(|(a, b)| touches(own, *a, *b)).count()
            };
            let best = sides.into_iter().map(|s| centre + s).filter(free).min_by_key(|at| crossed(*at));
            if let Some(at) = best {
                taken.push(Bounds::new(at - half, at + half).grown(height / 2.0));
                let corner = at + DVec2::new(-half.x, half.y);
                group = group.add(label.at(corner));
            }
        }
        group
    }

    /// A scale bar of a round length at the lower left, above it the meaning of colours that show the origin of streets, and a
    /// frame around the map.
    pub(super) fn scale_bar(&self) -> Group {
        let unit = self.unit();
        let metres = nice((self.size.x / self.scale / 6.0).max(1.0));
        let (from, length) = (DVec2::new(40.0 * unit, self.size.y - 40.0 * unit), metres * self.scale);
        let mut group = Group::new().set("id", "scale");
        for part in 0..4 {
            let piece = box_of(
                from + DVec2::new(length / 4.0 * f64::from(part), -6.0 * unit),
                DVec2::new(length / 4.0, 6.0 * unit),
            );
            let fill = if part % 2 == 0 { INK } else { "#ffffff" };
            group = group.add(piece.set("fill", fill).set("stroke", INK).set("stroke-width", unit));
        }
        let label = if metres >= 1000.0 { format!("{} km", metres / 1000.0) } else { format!("{metres} m") };
        group = group.add(self.write(&label, from + DVec2::new(0.0, -16.0 * unit), 13.0));
        if self.colouring == Colouring::Origin {
            // The last origin occurs only on real maps and needs no entry.
            let entries = ORIGINS[..4].iter().copied().chain([("building", BUILDINGS[1].2)]);
            let entries: Vec<_> = entries.collect();
            let size = DVec2::new(210.0, 26.0 * entries.len() as f64 + 18.0) * unit;
            group = group.add(self.card(from - DVec2::new(14.0, 38.0) * unit - DVec2::Y * size, size));
            for (i, (name, colour)) in entries.into_iter().enumerate() {
                let at = from - DVec2::new(0.0, (60.0 + 26.0 * i as f64) * unit);
                group =
                    group.add(box_of(at - DVec2::Y * 11.0 * unit, DVec2::new(28.0, 9.0) * unit).set("fill", colour));
                group = group.add(self.write(&name.to_uppercase(), at + DVec2::X * 40.0 * unit, 13.0));
            }
        }
        let frame = box_of(DVec2::ZERO, self.size).set("fill", "none");
        group.add(frame.set("stroke", "#5f574c").set("stroke-width", 2.0 * unit))
    }

    /// The box that the scale bar takes up.
    pub(super) fn scale_box(&self) -> Bounds {
        Bounds::new(DVec2::new(0.0, 0.9) * self.size, DVec2::new(0.25, 1.0) * self.size)
    }

    fn write(&self, text: &str, at: DVec2, height: f64) -> Group {
        Label::new(text, height * self.unit(), false).at(at)
    }

    /// The title at the upper left, and the box around it.
    pub(super) fn title(&self, text: &str) -> (Group, Bounds) {
        let unit = self.unit();
        let (_, width) = glyphs::write(text, 22.0 * unit);
        let (low, size) = (DVec2::splat(24.0 * unit), DVec2::new(width + 36.0 * unit, 50.0 * unit));
        let at = low + DVec2::new(18.0, 36.0) * unit;
        let group = Group::new().set("id", "title").add(self.card(low, size));
        (group.add(self.write(&text.to_uppercase(), at, 22.0)), Bounds::new(low, low + size))
    }

    fn card(&self, low: DVec2, size: DVec2) -> Rectangle {
        let card = box_of(low, size).set("fill", "#fffdf6").set("fill-opacity", 0.92);
        card.set("stroke", "#5f574c").set("stroke-width", self.unit())
    }

    /// The legend of the map's signs, in the emptiest corner, and the box around it.
    pub(super) fn legend(&self, plan: &Plan<'_>, water: bool, wood: bool, taken: &[Bounds]) -> (Group, Bounds) {
        let entries = self.entries(plan, water, wood);
        let unit = self.unit();
        let widest = entries.iter().map(|e| glyphs::write(e.words(), 13.0 * unit).1).fold(0.0, f64::max);
        let size = DVec2::new(widest + 106.0 * unit, (26.0 * entries.len() as f64 + 24.0) * unit);
        let margin = DVec2::splat(24.0 * unit);
        let (last, first) = (self.size - margin - size, margin);
        let lines: Vec<Vec<DVec2>> = plan.area.streets.iter().map(|s| self.placed(&s.item.street.line)).collect();
        let busy = |low: &DVec2| {
            let own = Bounds::new(*low, *low + size).grown(10.0 * unit);
            let roads = lines.iter().flat_map(|l| segments(l)).filter(|(a, b)| touches(own, *a, *b)).count();
            let places = plan.area.settlements.iter().map(|s| self.disc(plan, s).0).filter(|c| own.contains(*c));
            roads + 20 * places.count() + 1_000_000 * taken.iter().filter(|t| t.overlaps(own)).count()
        };
        let corners = [(last.x, last.y), (last.x, first.y), (first.x, first.y), (first.x, last.y)];
        let low = corners.map(|(x, y)| DVec2::new(x, y)).into_iter().min_by_key(busy).unwrap_or(last);
        let mut group = Group::new().set("id", "legend").add(self.card(low, size));
        for (i, entry) in entries.iter().enumerate() {
            let middle = low + DVec2::new(18.0, 12.0 + 26.0 * (i as f64 + 0.5)) * unit;
            group = self.sign(group, entry, middle, middle + DVec2::X * 52.0 * unit);
            group = group.add(self.write(entry.words(), middle + DVec2::new(70.0, 6.5) * unit, 13.0));
        }
        (group, Bounds::new(low, low + size))
    }

    fn entries(&self, plan: &Plan<'_>, water: bool, wood: bool) -> Vec<Entry> {
        let streets = || plan.area.streets.iter().map(|s| &s.item.street);
        let classes =
            [(StreetClass::Highway, "HIGHWAY"), (StreetClass::Major, "MAJOR ROAD"), (StreetClass::Minor, "MINOR ROAD")];
        let sizes = [(SizeClass::City, "CITY"), (SizeClass::Town, "TOWN"), (SizeClass::Village, "VILLAGE")];
        let place = |size| plan.area.settlements.iter().any(|s| s.size == size);
        let mut out: Vec<Entry> = Vec::new();
        out.extend(classes.into_iter().filter(|c| streets().any(|s| s.class == c.0)).map(|c| Entry::Road(c.0, c.1)));
        let has: [(bool, Entry); 4] = [
            (streets().any(|s| s.bridge), Entry::Bridge),
            (streets().any(|s| s.tunnel), Entry::Tunnel),
            (!plan.area.junctions.is_empty(), Entry::Junction),
            (plan.real.is_some(), Entry::Real),
        ];
        out.extend(has.into_iter().filter(|h| h.0).map(|h| h.1));
        out.extend(sizes.into_iter().filter(|s| place(s.0)).map(|s| Entry::Place(s.0, s.1)));
        out.extend(water.then_some(Entry::Patch("#a9cfe6", "WATER")));
        out.extend(wood.then_some(Entry::Patch("#bed3a5", "WOOD")));
        out
    }

    /// The sign of an entry between two points.
    fn sign(&self, group: Group, entry: &Entry, from: DVec2, to: DVec2) -> Group {
        let (unit, middle) = (self.unit(), from.lerp(to, 0.5));
        let id = crate::network::StreetId(0);
        let stroke = |group: Group, class: StreetClass, bridge: bool, tunnel: bool, a: DVec2, b: DVec2| {
            let line = vec![self.unplaced(a), self.unplaced(b)];
            let street = Street { bridge, tunnel, ..Street::new(id, class, JunctionId(0), JunctionId(0), line) };
            [Layer::Casing, Layer::Carriageway].into_iter().fold(group, |group, layer| {
                match self.pen(class, layer, tunnel) {
                    Some(pen) if bridge && layer == Layer::Casing => {
                        self.stroke(group, [&street].into_iter(), self.bridge_pen(pen))
                    }
                    Some(pen) => self.stroke(group, [&street].into_iter(), pen),
                    None => group,
                }
            })
        };
        let third = (to - from) / 3.0;
        match entry {
            Entry::Road(class, _) => stroke(group, *class, false, false, from, to),
            Entry::Bridge => {
                let group = stroke(group, StreetClass::Major, true, false, from + third, to - third);
                stroke(group, StreetClass::Major, false, false, from, to)
            }
            Entry::Tunnel => {
                let group = stroke(group, StreetClass::Major, false, false, from, from + third * 0.6);
                let group = stroke(group, StreetClass::Major, false, false, to - third * 0.6, to);
                stroke(group, StreetClass::Major, false, true, from + third * 0.6, to - third * 0.6)
            }
            Entry::Real => {
                let pen = self.real_pen(StreetClass::Major);
                draw(group, &[vec![from, to]], pen, 0.55)
            }
            Entry::Junction => group.add(circle(middle, JUNCTION * unit).set("fill", INK)),
            Entry::Place(size, _) => {
                let radius = symbol(*size) * unit;
                let ring = circle(middle, radius).set("stroke-width", round(0.32 * radius));
                group.add(ring.set("fill", "#fffdf6").set("stroke", INK))
            }
            Entry::Patch(colour, _) => {
                let patch = box_of(from - DVec2::Y * 7.0 * unit, DVec2::new(to.x - from.x, 14.0 * unit));
                group.add(patch.set("fill", *colour).set("stroke", "#5f574c").set("stroke-width", 0.6 * unit))
            }
        }
    }

    /// Real roads, as a pale band under the plan's own roads.
    pub(super) fn real(&self, area: &crate::world::Area, offset: DVec2) -> Group {
        let group = Group::new().set("id", "real").set("fill", "none").set("stroke-linejoin", "round");
        let classes = [StreetClass::Minor, StreetClass::Major, StreetClass::Highway];
        classes.into_iter().fold(group, |group, class| {
            let roads = area.streets.iter().map(|s| &s.item.street).filter(|s| s.class == class);
            let lines: Vec<Vec<DVec2>> =
                roads.map(|s| s.line.iter().map(|p| self.place(*p + offset)).collect()).collect();
            draw(group, &lines, self.real_pen(class), 0.55)
        })
    }

    fn real_pen(&self, class: StreetClass) -> Pen {
        let width = match class {
            StreetClass::Highway => 10.0,
            StreetClass::Major => 8.5,
            _ => 6.5,
        };
        Pen { width: width * self.unit(), colour: "#3f6fd8", cap: "round", dashed: false }
    }
}

fn draw(group: Group, lines: &[Vec<DVec2>], pen: Pen, opacity: f64) -> Group {
    paths(lines.iter().cloned(), false).into_iter().fold(group, |group, data| {
        let path = Path::new().set("d", data).set("fill", "none").set("stroke", pen.colour);
        group.add(
            path.set("stroke-width", round(pen.width)).set("stroke-linecap", pen.cap).set("stroke-opacity", opacity),
        )
    })
}

/// Whether a segment comes into a box, except that a segment may pass near a corner unnoticed.
fn touches(bounds: Bounds, a: DVec2, b: DVec2) -> bool {
    let (centre, half) = (bounds.centre(), bounds.size() / 2.0);
    // Boxes of words are flat, so they are scaled to a square: the point nearest to the middle then decides.
    let [a, b] = [a, b].map(|p| (p - centre) / half);
    let (_, near) = closest_on_segment(DVec2::ZERO, a, b);
    near.abs().max_element() <= 1.0
}

fn circle(at: DVec2, radius: f64) -> Circle {
    Circle::new().set("cx", round(at.x)).set("cy", round(at.y)).set("r", round(radius))
}

fn box_of(at: DVec2, size: DVec2) -> Rectangle {
    Rectangle::new().set("x", at.x).set("y", at.y).set("width", size.x).set("height", size.y)
}
