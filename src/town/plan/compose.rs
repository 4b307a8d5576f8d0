//! The steps that plan a settlement, in their order.

use super::rules::Rules;
use super::site::Site;
use super::sketch::Sketch;
use super::{arterial, border, cell_graph, cells, connect, grow, open_spaces, quays, repair, simple};
use crate::layer::{Cancel, LayerError};
use crate::region::{Gate, Outline, Settlement};
use crate::space::{Bounds, Seed, signed_area};
use crate::style::Style;
use crate::terrain::Terrain;
use crate::town::{DirectionField, Town};
use glam::DVec2;
use std::f64::consts::PI;
use std::sync::Arc;

/// A network that stays farther from the centre than this share of the radius is discarded.
const HOLLOW: f64 = 0.35;

/// Plans a settlement. A pure function of its arguments. The `gates` are the gates of roads: each lies on its own vertex of
/// `outline`, and none on a border with another settlement, since the gates on borders come with the outline.
///
/// Main streets grow from the centre along the style's field (Teng 2017, section 2), gates are connected to them, and streets
/// that end in nothing are connected or removed: the only dead ends are gates. Settlements too small or too rugged for growth get
/// a street that runs from gate to gate through the centre, or a ring around it. Borders are streets between their gates.
///
/// # Errors
///
/// [`LayerError::Cancelled`] when `cancel` is set.
pub fn plan(
    seed: Seed,
    settlement: &Arc<Settlement>,
    outline: &Arc<Outline>,
    mut gates: Vec<Gate>,
    style: &Style,
    terrain: &dyn Terrain,
    cancel: &Cancel,
) -> Result<Town, LayerError> {
    let key = [settlement.id.0];
    gates.extend(outline.border_gates());
    gates.sort_by_key(|g| g.vertex);
    let polygon = &outline.polygon;
    let bounds = Bounds::of(polygon.iter().copied());
    let origin = outline.origin;
    let field = DirectionField::draw(style.main.field, &mut seed.stream("town/field", &key), bounds, origin, terrain);
    let radius = (signed_area(polygon) / PI).sqrt();
    let rules = Rules::new(&style.main, radius);
    let mut sketch = Sketch::new(Site::new(outline, &gates, terrain), rules);
    // Streets take the direction that the river has where it is nearest to the centre.
    let field = match &outline.river {
        Some(way) => field.facing(way.heading()),
        None => field,
    };

    // Three methods are tried in turn until one leaves streets: all streets of a method may be dead ends. A ring always stands.
    let lay_through = |sketch: &mut Sketch| -> Result<(), LayerError> {
        if sketch.site.river.is_none() && simple::lay_through_street(sketch, &mut seed.stream("town/through", &key)) {
            connect::connect_gates(sketch, cancel)?;
            repair::round_corners(sketch);
        }
        Ok(())
    };
    // Where main streets may not cross, the street that runs through is tried first.
    if style.main.degree.1 == 2 {
        lay_through(&mut sketch)?;
    }
    if sketch.is_empty() && radius >= rules.min_length + 1.3 * rules.margin {
        let quays = if sketch.site.river.is_some() {
            quays::lay(&mut sketch, &style.main, &mut seed.stream("town/river", &key))
        } else {
            quays::Quays::default()
        };
        grow::grow(&mut sketch, &field, &mut seed.stream("town/growth", &key), &quays.starts, cancel)?;
        connect::connect_gates(&mut sketch, cancel)?;
        connect::connect_dead_ends(&mut sketch, cancel)?;
        quays::keep_far_bank(&mut sketch, &quays);
        sketch.prune();
        repair::divide_large_faces(&mut sketch, &field, cancel)?;
        repair::drop_pockets(&mut sketch, cancel)?;
        repair::round_corners(&mut sketch);
        // Only streets between neighbouring gates may be left.
        if sketch.graph.nearest_edge(DVec2::ZERO, HOLLOW * radius, |_| false).is_none() {
            sketch.clear();
        }
    }
    if sketch.is_empty() {
        sketch.clear();
        lay_through(&mut sketch)?;
    }
    if sketch.is_empty() {
        sketch.clear();
        simple::lay_ring(&mut sketch);
        connect::connect_gates(&mut sketch, cancel)?;
    }
    arterial::mark_arterials(&mut sketch);
    repair::drop_slivers(&mut sketch, cancel)?;
    open_spaces::replace_junctions(&mut sketch, &style.main, seed, settlement.id.0);
    cancel.check()?;
    let borders = border::lay_borders(&mut sketch, outline, origin);
    let cell_graph = cell_graph::cell_graph(&sketch, &borders);
    let cells::Parts { junctions, mains, cells } = cells::parts(settlement.id, &sketch, &cell_graph, &borders);
    Ok(Town {
        settlement: Arc::clone(settlement),
        origin,
        outline: Arc::clone(outline),
        gates,
        field,
        junctions,
        mains,
        cells,
    })
}
