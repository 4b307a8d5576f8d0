//! What every step reads: settings, terrain, settlements, and the user's edits.

use super::budget::Budget;
use super::domain::Domain;
use super::influence::Influences;
use super::lattice::node_near;
use super::nodes::Nodes;
use super::padding::pair_padding;
use super::samples::{SampleTile, Samples, TileKey};
use super::settings::RoadSettings;
use super::source::SettlementSource;
use super::tier::beeline;
use super::tier_settings::TierSettings;
use super::way_points::{self, PlacedWayPoint};
use super::window::Window;
use super::wishes::Wishes;
use crate::edits::{Edits, RejectedEdit};
use crate::layer::{LayerCache, LayerError, Reach};
use crate::network::SizeClass;
use crate::region::settlement::{Settlement, SettlementId};
use crate::space::Bounds;
use crate::terrain::Terrain;
use glam::{DVec2, I64Vec2};
use std::sync::Arc;

/// How much a way may cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// As the settings say.
    Usual,
    /// Whatever it costs, with [costlier settings](TierSettings::costlier).
    Costlier,
}

/// What roads are made from.
pub(super) struct Inputs {
    pub settings: RoadSettings,
    /// The settings of ways that are tried where a settlement would get no road.
    costlier: RoadSettings,
    pub terrain: Arc<dyn Terrain>,
    pub settlements: Arc<dyn SettlementSource>,
    /// The rectangle of a finite domain; `None` in an endless world.
    pub domain: Option<Domain>,
    /// Settlements that are nodes of the lattice.
    pub nodes: Nodes,
    pub influences: Influences,
    pub wishes: Wishes,
    /// The user's way points, sorted by id.
    pub way_points: Vec<PlacedWayPoint>,
    /// Edits that cannot be carried out.
    pub rejected: Vec<RejectedEdit>,
    samples: LayerCache<TileKey, SampleTile>,
}

impl Inputs {
    pub fn new(
        settings: &RoadSettings,
        terrain: Arc<dyn Terrain>,
        settlements: Arc<dyn SettlementSource>,
        budget: Budget,
    ) -> Self {
        Self {
            settings: settings.clone(),
            costlier: settings.costlier(),
            terrain,
            settlements,
            domain: None,
            nodes: Nodes::default(),
            influences: Influences::default(),
            wishes: Wishes::default(),
            way_points: Vec::new(),
            rejected: Vec::new(),
            samples: budget.cache(6),
        }
    }

    /// The same with the user's edits of roads, which must have been checked; in a finite domain (plan metres) if one is given.
    pub fn with_edits(
        settings: &RoadSettings,
        terrain: Arc<dyn Terrain>,
        settlements: Arc<dyn SettlementSource>,
        edits: &Edits,
        domain: Option<Bounds>,
        budget: Budget,
    ) -> Self {
        let step = settings.step;
        let (way_points, unplaced) = way_points::place(&edits.way_points, &*terrain, &*settlements, step, domain);
        let points: Vec<_> = way_points.iter().map(|p| p.settlement.clone()).collect();
        let everywhere = Bounds::new(DVec2::NEG_INFINITY, DVec2::INFINITY);
        let nodes = Nodes::new(&points, domain.unwrap_or(everywhere), &*terrain, step);
        let settlements = way_points::with_way_points(settlements, &points);
        let (influences, out_of_reach) = Influences::new(edits, domain);
        let (wishes, mut rejected) = Wishes::new(&edits.roads, settings, &*terrain, &*settlements, domain);
        rejected.extend(unplaced);
        rejected.extend(out_of_reach);
        let plain = Self::new(settings, terrain, settlements, budget);
        Self { domain: domain.map(Domain), nodes, influences, wishes, way_points, rejected, ..plain }
    }

    /// Spacing of the fine lattice in metres.
    pub fn step(&self) -> i64 {
        self.settings.step
    }

    pub fn tier(&self, tier: SizeClass) -> &TierSettings {
        self.settings.tier(tier)
    }

    /// Settings of a class of roads, or of its costlier ways.
    pub fn tier_for(&self, tier: SizeClass, way: Way) -> &TierSettings {
        match way {
            Way::Usual => self.tier(tier),
            Way::Costlier => self.costlier.tier(tier),
        }
    }

    /// Samples of the terrain at the nodes of a window of the lattice of spacing `step`.
    pub fn samples(&self, window: &Window, step: i64) -> Samples<'_> {
        Samples::new(&self.samples, &*self.terrain, step, window)
    }

    /// The nodes of a box that a search may use. In a finite domain, none lie outside of it.
    pub fn window(&self, bounds: Bounds, step: i64) -> Window {
        let window = Window::around(bounds, step);
        self.domain.map_or(window, |d| d.clip(window, step))
    }

    /// South-west and north-east node that a search on the fine lattice may use; `None` in an endless world.
    pub fn range(&self) -> Option<(I64Vec2, I64Vec2)> {
        self.domain.map(|d| d.range(self.step()))
    }

    /// The node that stands for a settlement's centre on the lattice of spacing `step`.
    pub fn centre_node(&self, s: &Settlement, step: i64) -> I64Vec2 {
        if let Some(node) = self.nodes.node(s, step) {
            return node;
        }
        let near = || node_near(s.centre.plan(), step);
        self.domain.map_or_else(near, |d| d.centre_node(&*self.terrain, s, step))
    }

    /// What the search for the road of a pair may read: the box around both centres, grown by [`pair_padding`] for a
    /// corridor of that width in metres.
    pub fn pair_reach(&self, tier: SizeClass, [a, b]: [&Settlement; 2], corridor: f64) -> Reach {
        let own = Bounds::of([a, b].map(|s| s.centre.plan()));
        Reach::new("roads", own, pair_padding(self.tier(tier), self.step(), beeline(a, b), corridor))
    }

    /// The settlement with an id whose centre is known.
    pub fn settlement(&self, id: SettlementId, centre: DVec2) -> Result<Option<Arc<Settlement>>, LayerError> {
        let all = self.settlements.centred_in(Bounds::square(centre, 2.0), SizeClass::Village)?;
        Ok(all.into_iter().find(|s| s.id == id))
    }
}
