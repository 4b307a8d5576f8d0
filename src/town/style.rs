//! Styles: how streets, lots and buildings of a settlement look. Read from RON files.

use crate::layer::{FileError, RangeError, from_ron};
use crate::patch::Patch;
use crate::space::math::smoothstep;
use serde::{Deserialize, Serialize};

/// Directions that the streets of a style prefer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum FieldKind {
    /// One heading for the whole settlement.
    #[default]
    Grid,
    /// Towards and around the centre.
    Radial,
    /// A heading that wanders.
    Organic,
    /// Along and across the slope of the ground.
    Contours,
}

impl FieldKind {
    /// Every kind.
    pub const ALL: [Self; 4] = [Self::Grid, Self::Radial, Self::Organic, Self::Contours];
}

/// What fills the main cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Filler {
    /// Patches chosen by their semantics, with parametric growth where none fits (Teng 2017).
    #[default]
    SemanticPatches,
}

/// Parametric growth of main streets (Teng 2017, Fig. 3). Lengths in metres, angles in degrees.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MainRules {
    /// Directions they follow.
    pub field: FieldKind,
    /// Length of a street between junctions; sets the size of main cells.
    pub length: f64,
    /// Greatest deviation from that length.
    pub deviation: f64,
    /// Least length.
    pub min_length: f64,
    /// Least and greatest number of streets at a junction. With at most 2, a street runs through from gate to gate, and those of
    /// other gates join it.
    pub degree: (u32, u32),
    /// Least angle between two streets at a junction.
    pub min_angle_deg: f64,
    /// Greatest deviation from the field's direction.
    pub angle_deviation_deg: f64,
    /// Distance within which a street's end snaps to a junction or street.
    pub snap_radius: f64,
    /// Share (0 to 1) of the big junctions that become roundabouts: rings of main streets around an island.
    pub roundabouts: f64,
    /// Share (0 to 1) of them that become squares: main streets around an open place. With `roundabouts` at most 1.
    pub squares: f64,
    /// Distance between the bridges over a river that runs through.
    pub bridges: f64,
}

impl Default for MainRules {
    fn default() -> Self {
        Self {
            field: FieldKind::Grid,
            length: 260.0,
            deviation: 40.0,
            min_length: 110.0,
            degree: (3, 4),
            min_angle_deg: 55.0,
            angle_deviation_deg: 6.0,
            snap_radius: 90.0,
            roundabouts: 0.0,
            squares: 0.0,
            bridges: 420.0,
        }
    }
}

/// How local streets attach to main streets. Lengths in metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SeamRules {
    /// Distance between attachment points of one side.
    pub spacing: f64,
    /// Greatest deviation of a point from even spacing, as a share of the spacing.
    pub jitter: f64,
    /// Least distance between two attachment points, and to the ends of the main street.
    pub min_spacing: f64,
    /// Distance along the street, as a share of the spacing (0 to 0.5), up to which points of the two sides become one crossing:
    /// with little of it most are T-junctions.
    pub crossing: f64,
    /// Number of attachment points (0 to 2) that every main cell gets at least, where there is room.
    pub least: u32,
}

impl Default for SeamRules {
    fn default() -> Self {
        Self { spacing: 95.0, jitter: 0.2, min_spacing: 36.0, crossing: 0.4, least: 2 }
    }
}

/// Growth of local streets where no patch fits (Teng 2017, Fig. 3). Lengths in metres, angles in degrees.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LocalRules {
    /// Length of a street segment.
    pub length: f64,
    /// Greatest deviation from that length.
    pub deviation: f64,
    /// Least length.
    pub min_length: f64,
    /// Least and greatest number of streets at a junction.
    pub degree: (u32, u32),
    /// Least angle between two streets at a junction.
    pub min_angle_deg: f64,
    /// Greatest deviation from the straight direction.
    pub angle_deviation_deg: f64,
    /// Distance within which an end snaps to a junction or street.
    pub snap_radius: f64,
    /// Least distance between streets that do not meet.
    pub clearance: f64,
    /// Share (0 to 1) of the dead ends that stay, of those that could be led on to another street.
    pub dead_ends: f64,
    /// Greatest distance from a sharp bend at which the curve begins that takes its place; bends stay sharp at 0.
    pub rounding: f64,
}

impl Default for LocalRules {
    fn default() -> Self {
        Self {
            length: 75.0,
            deviation: 15.0,
            min_length: 30.0,
            degree: (3, 4),
            min_angle_deg: 55.0,
            angle_deviation_deg: 6.0,
            snap_radius: 25.0,
            clearance: 26.0,
            dead_ends: 0.0,
            rounding: 0.0,
        }
    }
}

/// How blocks become lots and buildings. Lengths in metres, areas in square metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ParcelRules {
    /// Least and greatest frontage of a lot.
    pub lot_width: (f64, f64),
    /// Greatest depth of a lot.
    pub lot_depth: f64,
    /// Least area of a lot that is built on.
    pub min_area: f64,
    /// Distance from the frontage to the building.
    pub setback_front: f64,
    /// Distance from the lot's other sides to the building.
    pub setback_side: f64,
    /// Greatest depth of a building.
    pub building_depth: f64,
    /// Share of the houses in closed rows that have a wing along one side of the yard behind them.
    pub wings: f64,
    /// Least and greatest number of storeys; the centre has the most.
    pub storeys: (u32, u32),
    /// Share of lots that stay empty.
    pub vacant: f64,
    /// Share of blocks that become parks.
    pub parks: f64,
}

impl Default for ParcelRules {
    fn default() -> Self {
        Self {
            lot_width: (14.0, 24.0),
            lot_depth: 34.0,
            min_area: 120.0,
            setback_front: 3.0,
            setback_side: 1.5,
            building_depth: 14.0,
            wings: 0.0,
            storeys: (1, 4),
            vacant: 0.05,
            parks: 0.04,
        }
    }
}

/// How another style takes over from the centre of a settlement outwards.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FringeRules {
    /// Name of the style of the fringe.
    pub style: String,
    /// Where it begins, as a share of the settlement's radius: 0 to 1.
    pub begins: f64,
    /// Where nothing is left of the style of the centre, likewise: from `begins` to 2.
    pub complete: f64,
}

/// How often a patch is used in a settlement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PatchCount {
    /// Name of the patch.
    pub patch: String,
    /// Number of main cells in which it stands in any case, as far as there are cells that have room for it.
    #[serde(default)]
    pub at_least: u32,
    /// Greatest number of times that it is used in the settlement, once in a main cell; no limit when not given.
    #[serde(default)]
    pub at_most: Option<u32>,
    /// What its weight is multiplied by: 0 to 1000.
    #[serde(default = "one")]
    pub weight: f64,
}

fn one() -> f64 {
    1.0
}

/// How the streets, lots and buildings of a settlement look.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Style {
    /// Name: the file's, without folders and extension.
    #[serde(skip)]
    pub name: String,
    /// Main streets.
    pub main: MainRules,
    /// Attachment of local streets to main streets.
    pub seam: SeamRules,
    /// Local streets.
    pub local: LocalRules,
    /// What fills the main cells.
    pub filler: Filler,
    /// Names of the patch sets that it uses.
    pub patch_sets: Vec<String>,
    /// Tags of which a patch must have one; empty allows every patch.
    pub allow: Vec<String>,
    /// Tags of which a patch must have none.
    pub exclude: Vec<String>,
    /// How often single patches are used.
    pub patches: Vec<PatchCount>,
    /// The style that takes over towards the outline; none if not given.
    pub fringe: Option<FringeRules>,
    /// Lots and buildings.
    pub parcels: ParcelRules,
}

impl Style {
    /// Reads and checks a style from RON text; `file` names it in errors, and its stem names the style.
    pub fn from_ron(file: &str, text: &str) -> Result<Self, FileError> {
        let mut style: Self = from_ron(file, text)?;
        style.check().map_err(|e| e.in_file(file, text))?;
        style.name =
            std::path::Path::new(file).file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        Ok(style)
    }

    /// Whether the tags of a patch let this style use it.
    pub fn allows(&self, patch: &Patch) -> bool {
        (self.allow.is_empty() || self.allow.iter().any(|t| patch.tags.contains(t)))
            && !self.exclude.iter().any(|t| patch.tags.contains(t))
    }

    /// Weight of a patch of one of its sets: 0 if its tags rule it out.
    pub fn weight_of(&self, patch: &Patch) -> f64 {
        let factor = self.patches.iter().find(|c| c.patch == patch.name).map_or(1.0, |c| c.weight);
        if self.allows(patch) { patch.weight * factor } else { 0.0 }
    }

    /// Share of the fringe's style at a distance from the centre, in radii of the settlement: 0 to 1.
    pub fn fringe_share(&self, radii: f64) -> f64 {
        let share = |f: &FringeRules| smoothstep(f.begins, f.complete.max(f.begins + 1e-6), radii);
        self.fringe.as_ref().map_or(0.0, share)
    }

    /// Checks that every value lies in its allowed range.
    pub fn check(&self) -> Result<(), RangeError> {
        let range = RangeError::check;
        let order = |field: &str, pair: (f64, f64), low: f64, high: f64| {
            range(field, pair.0, low, high).and_then(|()| range(field, pair.1, pair.0, high))
        };
        let m = &self.main;
        let main = || {
            range("length", m.length, 60.0, 2000.0)?;
            range("deviation", m.deviation, 0.0, m.length / 2.0)?;
            range("min_length", m.min_length, 40.0, m.length)?;
            order("degree", (m.degree.0.into(), m.degree.1.into()), 2.0, 8.0)?;
            range("min_angle_deg", m.min_angle_deg, 15.0, 90.0)?;
            range("angle_deviation_deg", m.angle_deviation_deg, 0.0, 45.0)?;
            range("snap_radius", m.snap_radius, 10.0, m.length)?;
            range("roundabouts", m.roundabouts, 0.0, 1.0)?;
            range("squares", m.squares, 0.0, 1.0 - m.roundabouts)?;
            range("bridges", m.bridges, 150.0, 10_000.0)
        };
        main().map_err(|e: RangeError| e.within("main"))?;
        let s = &self.seam;
        let seam = || {
            range("spacing", s.spacing, 30.0, 1000.0)?;
            range("jitter", s.jitter, 0.0, 0.45)?;
            range("min_spacing", s.min_spacing, 30.0, s.spacing.max(30.0))?;
            range("crossing", s.crossing, 0.0, 0.5)?;
            range("least", s.least.into(), 0.0, 2.0)
        };
        seam().map_err(|e: RangeError| e.within("seam"))?;
        let l = &self.local;
        let local = || {
            range("length", l.length, 20.0, 500.0)?;
            range("deviation", l.deviation, 0.0, l.length / 2.0)?;
            range("min_length", l.min_length, 10.0, l.length)?;
            order("degree", (l.degree.0.into(), l.degree.1.into()), 2.0, 8.0)?;
            range("min_angle_deg", l.min_angle_deg, 15.0, 90.0)?;
            range("angle_deviation_deg", l.angle_deviation_deg, 0.0, 45.0)?;
            range("snap_radius", l.snap_radius, 5.0, 200.0)?;
            range("clearance", l.clearance, 15.0, 200.0)?;
            range("dead_ends", l.dead_ends, 0.0, 1.0)?;
            range("rounding", l.rounding, 0.0, 100.0)
        };
        local().map_err(|e: RangeError| e.within("local"))?;
        let p = &self.parcels;
        let parcels = || {
            order("lot_width", p.lot_width, 4.0, 500.0)?;
            range("lot_depth", p.lot_depth, 8.0, 500.0)?;
            range("min_area", p.min_area, 20.0, 100_000.0)?;
            range("setback_front", p.setback_front, 0.0, 100.0)?;
            range("setback_side", p.setback_side, 0.0, 100.0)?;
            range("building_depth", p.building_depth, 4.0, 200.0)?;
            range("wings", p.wings, 0.0, 1.0)?;
            order("storeys", (p.storeys.0.into(), p.storeys.1.into()), 1.0, 100.0)?;
            range("vacant", p.vacant, 0.0, 1.0)?;
            range("parks", p.parks, 0.0, 1.0)
        };
        parcels().map_err(|e: RangeError| e.within("parcels"))?;
        for count in &self.patches {
            range("weight", count.weight, 0.0, 1000.0).map_err(|e| e.within("patches"))?;
            if let Some(most) = count.at_most {
                range("at_most", most.into(), count.at_least.into(), f64::from(u32::MAX))
                    .map_err(|e| e.within("patches"))?;
            }
        }
        let Some(fringe) = &self.fringe else { return Ok(()) };
        range("begins", fringe.begins, 0.0, 1.0)
            .and_then(|()| range("complete", fringe.complete, fringe.begins, 2.0))
            .map_err(|e| e.within("fringe"))
    }
}
