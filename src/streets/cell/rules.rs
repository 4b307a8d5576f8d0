//! What is asked of the streets of one cell: the style's local rules as distances and angles, once per cell.

use crate::network::STREET_FLOOR;
use crate::space::math;
use crate::style::{FieldKind, LocalRules};

/// Least length that is left of a street when it is cut back from the border, in metres.
pub const LEAST_ARM: f64 = 22.0;

/// What a proposal must keep to. Lengths in metres, angles in radians.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Distance from streets that it does not meet.
    pub gap: f64,
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

/// What is asked of the streets of one cell. Lengths in metres, angles in radians.
#[derive(Clone, Copy, Debug)]
pub struct CellRules<'a> {
    /// The style's rules for local streets.
    pub local: &'a LocalRules,
    /// Least angle between two streets from which a third may leave between them, halved.
    pub min_angle: f64,
    /// What the propagation keeps to.
    pub growth: Limits,
    /// What the repair keeps to: streets may be nearer to each other than those that grow.
    pub repair: Limits,
    /// What streets keep to that stand by the user's wish, or that connect what would float: as near as streets may be
    /// at all.
    pub closest: Limits,
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
}

impl<'a> CellRules<'a> {
    /// The rules of a cell whose streets follow a field of this kind.
    pub fn new(local: &'a LocalRules, field: FieldKind) -> Self {
        let min_angle = local.min_angle_deg.to_radians().max(0.7);
        // Blocks much narrower than the style's streets are long look pinched.
        let share = match field {
            FieldKind::Grid => 0.6,
            FieldKind::Radial => 0.68,
            FieldKind::Organic | FieldKind::Contours => 0.55,
        };
        let gap = local.clearance.max(share * local.length);
        let growth = Limits {
            gap,
            wall_gap: gap,
            junction_cosine: math::cos(min_angle),
            bend_cosine: math::cos(1.75),
            min_piece: local.min_length.clamp(18.0, 40.0),
            max_degree: (local.degree.1 as usize).clamp(3, 5),
            min_round: 3.0 * local.length,
        };
        let repair = Limits {
            gap: 20.0_f64.min(growth.gap),
            wall_gap: 30.0_f64.min(growth.wall_gap),
            junction_cosine: math::cos(min_angle.min(0.75)),
            bend_cosine: math::cos(1.45),
            min_piece: 16.0,
            max_degree: growth.max_degree.max(4),
            min_round: 2.6 * local.length,
        };
        let (junction_cosine, bend_cosine) = (math::cos(0.7), math::cos(1.3));
        let closest = Limits { gap: STREET_FLOOR, wall_gap: 0.0, junction_cosine, bend_cosine, ..repair };
        let (straightness, crossings, field_pull, stump, dogleg) = match field {
            FieldKind::Grid => (0.98, 0.75, 1.0, 1.1, 16.0),
            FieldKind::Radial => (0.88, 0.4, 0.9, 0.9, 16.0),
            FieldKind::Contours => (0.82, 0.25, 0.75, 0.5, 0.0),
            FieldKind::Organic => (0.75, 0.2, 0.5, 0.8, 0.0),
        };
        Self {
            local,
            min_angle,
            growth,
            repair,
            closest,
            straightness,
            most_turn: math::acos(straightness),
            crossings,
            field_pull,
            stump: stump * local.length,
            dogleg,
        }
    }
}
