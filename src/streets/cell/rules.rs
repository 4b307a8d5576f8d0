//! What is asked of the streets of one cell: the style's local rules as distances and angles, once per cell. Every stage takes
//! what it keeps to from here.

use crate::network::STREET_FLOOR;
use crate::patch::DrawingRules;
use crate::space::{math, signed_area};
use crate::streets::filler::CellBrief;
use crate::style::{FieldKind, LocalRules};
use glam::DVec2;

/// Least ratio of the distance between two streets to their distance along the network, where that distance is short.
pub const WEDGE: f64 = 0.5;

/// How many times their distance the way between two points of streets may be if they are nearer than the clearance.
pub const NEAR_ALONG: f64 = 3.0;

/// Distance at which a street may pass a loose end that can still be connected to it, in metres, where the style asks for no
/// more: room for a short street.
const TIP_GAP: f64 = 19.0;

/// Least distance from the border of streets that repair builds, in metres, where the style does not ask for more.
const REPAIR_WALL_GAP: f64 = 30.0;

/// Angle in radians by which two streets may fall short of the least angle: what positions lose when they are rounded.
const ANGLE_SLACK: f64 = 0.001;

/// Greatest length of a street, as a share of the cell's width.
const LONGEST: f64 = 0.33;

/// Greatest least length of a street, as a share of the cell's width, and in metres the value that is kept in any cell.
const LONGEST_LEAST: (f64, f64) = (0.12, 30.0);

/// Greatest clearance, as a share of the cell's width, and in metres the clearance that is kept in any cell.
const WIDEST_CLEARANCE: (f64, f64) = (0.12, 20.0);

/// Greatest width of a block, as a share of the cell's width.
const WIDEST_BLOCK: f64 = 0.3;

/// Least angle in radians at which streets meet that stand by the user's wish, and at which they bend.
const CLOSEST: [f64; 2] = [0.7, 1.3];

/// What a proposal must keep to. Lengths in metres, angles in radians.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Distance from streets that it does not meet.
    pub gap: f64,
    /// Distance that it keeps in any case, along its whole length, where the way to the other street is longer than
    /// [`NEAR_ALONG`] times that.
    pub clearance: f64,
    /// Distance at which it passes a loose end that may still be connected to it.
    pub tip_gap: f64,
    /// Distance from the border.
    pub wall_gap: f64,
    /// Cosine of the least angle at a junction.
    pub junction_cosine: f64,
    /// Cosine of the least angle at a point of inflexion; -1 is straight on.
    pub bend_cosine: f64,
    /// Least length of a street between junctions.
    pub min_piece: f64,
    /// Greatest number of streets at a junction.
    pub max_degree: usize,
    /// Least way around a block.
    pub min_round: f64,
}

impl Limits {
    /// No street must keep farther away from anything than this.
    pub fn reach(&self) -> f64 {
        self.gap.max(self.wall_gap).max(20.0)
    }

    /// The distance that the coarse grid is asked for: a little less than the gap, since near the vertices that are
    /// joined the distance along the network decides.
    pub fn coarse_gap(&self) -> f32 {
        (self.gap.min(self.wall_gap) - 1.0) as f32
    }
}

/// Width of a cell in metres: that of a square is its side, that of a long strip twice its width.
fn width(border: &[DVec2]) -> f64 {
    let around: f64 = (0..border.len()).map(|i| border[i].distance(border[(i + 1) % border.len()])).sum();
    4.0 * signed_area(border) / around.max(1e-9)
}

/// A style's rules as a cell of this width has room for them: streets that are long for the cell, or far apart, meet nothing.
fn fitted(local: &LocalRules, width: f64) -> LocalRules {
    let share = (LONGEST * width / local.length).min(1.0);
    let at_most = |asked: f64, most: f64, any: f64| asked.min((most * width).max(any));
    LocalRules {
        length: share * local.length,
        deviation: share * local.deviation,
        min_length: at_most(local.min_length, LONGEST_LEAST.0, LONGEST_LEAST.1).min(share * local.length),
        snap_radius: share * local.snap_radius,
        clearance: at_most(local.clearance, WIDEST_CLEARANCE.0, WIDEST_CLEARANCE.1),
        block_width: local.block_width.min(WIDEST_BLOCK * width),
        ..*local
    }
}

/// What a style's rules ask of the drawings of patches, in a cell of any width.
pub fn drawing_rules(local: &LocalRules) -> DrawingRules {
    let least = local.min_angle_deg.to_radians() - ANGLE_SLACK;
    DrawingRules { cosine: math::cos(least), most_streets: local.degree.1 as usize }
}

/// How large the blocks are that streets of one length enclose, against those at junctions of three or four streets.
///
/// In a network whose junctions have `d` streets on average there are `d / 2 - 1` blocks to a junction (Euler), and a block has
/// `d / (d / 2 - 1)` sides.
struct BlockShape {
    /// Ratio of the areas.
    area: f64,
    /// Ratio of the perimeters, at most 1.
    around: f64,
}

impl BlockShape {
    fn new(local: &LocalRules) -> Self {
        let of = |(low, high): (u32, u32)| f64::from(low + high) / 2.0;
        let blocks = |degree: f64| degree / 2.0 - 1.0;
        let (usual, asked) = (of((3, 4)), of(local.degree));
        let area = blocks(usual) / blocks(asked);
        Self { area, around: (area * asked / usual).min(1.0) }
    }
}

/// What is asked of the streets of one cell. Lengths in metres, angles in radians.
#[derive(Clone, Copy, Debug)]
pub struct CellRules {
    /// The style's rules for local streets, fitted to the cell.
    pub local: LocalRules,
    /// Least angle between two streets from which a third may leave between them, halved.
    pub min_angle: f64,
    /// What growth and patches keep to: blocks have some width.
    pub growth: Limits,
    /// What the style asks of every street, and what the repair keeps to.
    pub repair: Limits,
    /// What streets keep to that stand by the user's wish, or that connect what would float: as near as streets may be
    /// at all.
    pub closest: Limits,
    /// What the drawing of a patch keeps to, besides what every drawing does.
    pub drawings: DrawingRules,
    /// Least cosine of the bend where a street goes on as another.
    pub straightness: f64,
    /// Greatest angle by which a street may turn where another goes on from it.
    pub most_turn: f64,
    /// Share of T junctions that growth goes on from, across the street that was met.
    pub crossings: f64,
    /// How much the field draws streets: 0 not at all, 1 wholly.
    pub field_pull: f64,
    /// Dead-end streets shorter than this that do not start at a port are removed.
    pub stump: f64,
    /// Greatest distance of a street that is straightened from straight; 0 where streets may wind.
    pub dogleg: f64,
    /// Area in square metres from which repair divides a block. A style that asks for crossings has the area of one that asks for
    /// three or four streets at a junction: a street across a block ends in T junctions, which the style does not want.
    pub large_block: f64,
}

impl CellRules {
    /// The rules of a cell.
    pub fn new(brief: &CellBrief<'_>) -> Self {
        let local = fitted(brief.rules, width(brief.border));
        let min_angle = local.min_angle_deg.to_radians();
        let (clearance, width) = (local.clearance, local.block_width.max(local.clearance));
        let least = min_angle - ANGLE_SLACK;
        let blocks = BlockShape::new(&local);
        let repair = Limits {
            gap: clearance,
            clearance,
            tip_gap: clearance,
            wall_gap: clearance.max(REPAIR_WALL_GAP.min(width)),
            junction_cosine: math::cos(least),
            bend_cosine: math::cos(least.max(1.45)),
            min_piece: local.min_length,
            max_degree: local.degree.1 as usize,
            min_round: 2.6 * blocks.around * local.length,
        };
        let growth = Limits {
            gap: width,
            tip_gap: clearance.max(TIP_GAP),
            wall_gap: width,
            bend_cosine: math::cos(1.75),
            min_round: 3.0 * blocks.around * local.length,
            ..repair
        };
        let closest = Limits {
            gap: STREET_FLOOR,
            clearance: STREET_FLOOR,
            tip_gap: STREET_FLOOR,
            wall_gap: 0.0,
            junction_cosine: math::cos(CLOSEST[0]),
            bend_cosine: math::cos(CLOSEST[1]),
            min_piece: 16.0,
            max_degree: 8,
            ..repair
        };
        let (straightness, crossings, field_pull, stump, dogleg) = match brief.field_kind {
            FieldKind::Grid => (0.98, 0.75, 1.0, 1.1, 16.0),
            FieldKind::Radial => (0.88, 0.4, 0.9, 0.9, 16.0),
            FieldKind::Contours => (0.82, 0.25, 0.75, 0.5, 0.0),
            FieldKind::Organic => (0.75, 0.2, 0.5, 0.8, 0.0),
        };
        Self {
            local,
            min_angle: least,
            growth,
            repair,
            closest,
            drawings: drawing_rules(&local),
            straightness,
            most_turn: math::acos(straightness),
            crossings,
            field_pull,
            stump: (stump * local.length).max(local.min_length),
            dogleg,
            large_block: 2.6 * blocks.area.max(1.0) * local.length * local.length,
        }
    }
}
