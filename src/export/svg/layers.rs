//! The layers of a map: contours and water, parcels and buildings, streets.

use super::sheet::{BUILDINGS, Colouring, Layer, ORIGINS, Pen, Sheet, nice, paths, round, trace};
use crate::export::relief::Relief;
use crate::export::{Plan, narrowest_first};
use crate::network::StreetClass;
use crate::parcel::BlockUse;
use crate::stack::PlacedStreet;
use crate::streets::StreetOrigin;
use crate::surface::{JunctionOutline, junction_outlines};
use glam::DVec2;
use svg::node::element::{Group, Path};

/// Pixels per metre from which on a map shows the corners of junctions.
const CORNERS_FROM: f64 = 0.4;

impl Sheet {
    pub(super) fn ground(&self, relief: &Relief) -> Group {
        let mut group = Group::new().set("id", "ground").set("fill", "none");
        if let Some((low, high)) = relief.heights() {
            let step = nice(((high - low) / 14.0).max(2.0));
            let mut level = (low / step).ceil() * step;
            while level < high {
                let index = (level / step).round() as i64 % 5 == 0;
                let mut data = String::new();
                relief.rings(self.longer, level, |s| s.height).iter().for_each(|r| trace(&mut data, r, true));
                let width = if index { 0.9 } else { 0.45 };
                let contour = Path::new().set("d", data).set("stroke", "#8a6f4a").set("stroke-width", width);
                group = group.add(contour.set("stroke-opacity", if index { 0.4 } else { 0.28 }));
                level += step;
            }
        }
        for (depth, fill) in [(0.0, "#a9cfe6"), (3.0, "#9cc5df"), (10.0, "#8eb9d7"), (30.0, "#80accc")] {
            let (rings, shore) = match depth {
                0.0 => (relief.shores(self.longer), "#6c9dbf"),
                _ => (relief.rings(self.longer, depth, |s| s.water_level - s.height), "none"),
            };
            let mut data = String::new();
            rings.iter().for_each(|r| trace(&mut data, r, true));
            let water = Path::new().set("d", data).set("fill", fill).set("fill-rule", "evenodd");
            group = group.add(water.set("stroke", shore).set("stroke-width", 1.2));
        }
        group
    }

    pub(super) fn parcels(&self, plan: &Plan<'_>) -> Vec<Group> {
        let area = plan.area;
        let mut groups = Vec::new();
        if area.blocks.is_empty() {
            let rings = plan.outlines.iter().map(|o| {
                let offset = o.origin.offset_to(area.origin);
                o.polygon.iter().map(|p| self.place(*p + offset)).collect()
            });
            groups.push(fill(rings, "towns", "#dcc3a6", Some("#8d6f4f")).set("fill-opacity", 0.85));
        }
        for (land_use, id, colour) in [(BlockUse::Built, "blocks", "#ece6da"), (BlockUse::Park, "parks", "#bfdca6")] {
            let blocks = area.blocks.iter().filter(|b| b.item.land_use == land_use);
            groups.push(fill(blocks.map(|b| self.placed(&b.item.polygon)), id, colour, None));
        }
        if self.scale > 0.25 {
            let lots = area.lots.iter().map(|l| self.placed(&l.item.polygon));
            let thin = (0.12 * self.scale).clamp(0.15, 1.0);
            groups.push(fill(lots, "lots", "#f1ecdf", Some("#d3c8b4")).set("stroke-width", thin));
        }
        if self.scale > 0.08 {
            let buildings = || area.footprints.iter();
            let shadow = |storeys: u32| DVec2::new(0.45, 0.45) * (f64::from(storeys) + 0.6) * self.scale;
            let shadows = buildings().map(|b| {
                let offset = shadow(b.item.storeys);
                self.placed(&b.item.polygon).into_iter().map(|p| p + offset).collect()
            });
            groups.push(fill(shadows, "shadows", "#5b5348", None).set("fill-opacity", 0.3));
            for (from, to, colour) in BUILDINGS {
                let alike = buildings().filter(|b| (from..to).contains(&b.item.storeys));
                let edge = (self.scale > 0.3).then_some("#8f7a64");
                let thin = (0.15 * self.scale).clamp(0.2, 1.0);
                let outlines = alike.map(|b| self.placed(&b.item.polygon));
                groups.push(fill(outlines, "buildings", colour, edge).set("stroke-width", thin));
            }
        }
        groups
    }

    /// Streets from the lowest level up. Within a level all casings lie under all carriageways, so that carriageways join.
    pub(super) fn streets(&self, plan: &Plan<'_>) -> Group {
        let mut group = Group::new().set("id", "streets").set("fill", "none").set("stroke-linejoin", "round");
        let streets = || plan.area.streets.iter().map(|s| &s.item);
        let levels: std::collections::BTreeSet<i8> = streets().map(|s| s.street.level).collect();
        let bounds = plan.area.bounds.moved(-plan.area.origin.plan());
        let junctions = match self.scale {
            scale if scale < CORNERS_FROM || self.region => Vec::new(),
            _ => junction_outlines(streets().map(|s| &s.street).filter(|s| s.level == 0), bounds),
        };
        for level in levels {
            let here = || streets().filter(move |s| s.street.level == level);
            for layer in [Layer::Pavement, Layer::Casing, Layer::Carriageway] {
                if level == 0 {
                    group = self.corners(group, &junctions, layer);
                }
                for class in narrowest_first() {
                    for tunnel in [true, false] {
                        let alike = here().filter(|s| s.street.class == class && s.street.tunnel == tunnel);
                        let Some(pen) = self.pen(class, layer, tunnel) else { continue };
                        let bridge = self.bridge_pen(pen);
                        let (bridges, plain): (Vec<_>, Vec<_>) =
                            alike.partition(|s| s.street.bridge && layer == Layer::Casing);
                        group = self.stroke(group, bridges.into_iter().map(|s| &s.street), bridge);
                        if layer == Layer::Carriageway && self.colouring == Colouring::Origin {
                            for (made_by, colour) in ORIGINS {
                                let made = plain.iter().filter(|s| origin_name(s) == made_by);
                                group = self.stroke(group, made.map(|s| &s.street), Pen { colour, ..pen });
                            }
                        } else {
                            group = self.stroke(group, plain.into_iter().map(|s| &s.street), pen);
                        }
                    }
                }
            }
        }
        group
    }
}

impl Sheet {
    /// Junctions with their rounded corners, as they are built.
    fn corners(&self, mut group: Group, junctions: &[JunctionOutline], layer: Layer) -> Group {
        for class in narrowest_first() {
            let Some(pen) = self.pen(class, layer, false) else { continue };
            let rings = junctions.iter().filter(|j| j.class == class).map(|junction| {
                self.placed(if layer == Layer::Pavement { &junction.outer } else { &junction.carriageway })
            });
            let carriageway = class.carriageway() * self.scale;
            for data in paths(rings, true) {
                let path = Path::new().set("d", data).set("fill", pen.colour);
                let edged = layer == Layer::Casing;
                let edge = round(pen.width - carriageway);
                group = group.add(if edged { path.set("stroke", pen.colour).set("stroke-width", edge) } else { path });
            }
        }
        group
    }
}

fn origin_name(placed: &PlacedStreet) -> &'static str {
    match placed.made_by.as_ref().map(|made_by| &made_by.origin) {
        None if placed.street.class == StreetClass::Local => "real local",
        None => "main",
        Some(StreetOrigin::Piece(_)) => "patch",
        Some(StreetOrigin::Growth) => "growth",
        Some(StreetOrigin::Repair) => "repair",
    }
}

fn fill(rings: impl Iterator<Item = Vec<DVec2>>, id: &str, colour: &str, edge: Option<&str>) -> Group {
    let group = Group::new().set("class", id).set("fill", colour).set("stroke", edge.unwrap_or("none"));
    paths(rings, true).into_iter().fold(group, |group, data| group.add(Path::new().set("d", data)))
}
