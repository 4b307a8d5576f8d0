//! Planning a settlement: field, growth, gates, repair, arterials, places, cells.

mod arterial;
mod border;
#[cfg(test)]
mod cell_tests;
mod cells;
mod fringe;
mod grow;
mod link;
mod places;
mod pole;
mod repair;
mod sketch;
mod small;
#[cfg(test)]
mod tests;
mod water;

use crate::layer::{Cancel, LayerError};
use crate::region::{Gate, Outline, Settlement};
use crate::space::{Bounds, Seed, signed_area};
use crate::style::Style;
use crate::terrain::Terrain;
use crate::town::{DirectionField, Town};
use glam::DVec2;
use std::f64::consts::PI;
use std::sync::Arc;

use sketch::{Rules, Sketch};
use water::River;

/// Streets that keep farther from the centre than this share of the radius leave the place empty.
const HOLLOW: f64 = 0.35;

/// Plans a settlement. A pure function of its arguments; `gates`, those of roads, lie on vertices of `outline`, each on its
/// own, none on a border with a settlement that it touches: gates on borders come with the outline.
///
/// Main streets grow from the centre along the style's field (Teng 2017, section 2), gates are tied to them, and what ends
/// in nothing is connected or taken away: the only dead ends are gates. Places too small or too rugged for growth get a street
/// that runs from gate to gate through the centre, or a ring around it. Borders are streets between their gates.
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
    let mut sketch = Sketch::new(polygon, &gates, rules, origin, terrain);
    sketch.river = outline.river.as_ref().map(River::new);
    // Streets are laid out along the river, where it lies nearest.
    let field = match &outline.river {
        Some(way) => field.facing(way.heading()),
        None => field,
    };

    // Each way of making streets that leaves none (all of them dead ends) gives way to the next; a ring always stands.
    let through = |sketch: &mut Sketch| -> Result<(), LayerError> {
        if sketch.river.is_none() && small::through(sketch, &mut seed.stream("town/through", &key)) {
            link::tie_gates(sketch, cancel)?;
            repair::round_corners(sketch);
        }
        Ok(())
    };
    // Where no main streets may cross, the street that runs through comes first.
    if style.main.degree.1 == 2 {
        through(&mut sketch)?;
    }
    if sketch.graph.edges().next().is_none() && radius >= rules.min_length + 1.3 * rules.margin {
        let quays = if sketch.river.is_some() {
            water::lay(&mut sketch, &style.main, &mut seed.stream("town/river", &key))
        } else {
            water::Quays::default()
        };
        grow::grow(&mut sketch, &field, &mut seed.stream("town/growth", &key), &quays.starts, cancel)?;
        link::tie_gates(&mut sketch, cancel)?;
        link::link_tips(&mut sketch, cancel)?;
        water::keep_far_bank(&mut sketch, &quays);
        sketch.prune();
        repair::divide_wide(&mut sketch, &field, cancel)?;
        repair::drop_pockets(&mut sketch, cancel)?;
        repair::round_corners(&mut sketch);
        // Gates beside each other may be all that holds streets: such a place has no middle yet.
        if sketch.graph.nearest_edge(DVec2::ZERO, HOLLOW * radius, |_| false).is_none() {
            sketch.clear();
        }
    }
    if sketch.graph.edges().next().is_none() {
        sketch.clear();
        through(&mut sketch)?;
    }
    if sketch.graph.edges().next().is_none() {
        sketch.clear();
        small::ring(&mut sketch);
        link::tie_gates(&mut sketch, cancel)?;
    }
    arterial::mark_arterials(&mut sketch);
    repair::drop_slivers(&mut sketch, cancel)?;
    places::make_places(&mut sketch, &style.main, seed, settlement.id.0);
    cancel.check()?;
    let laid = border::lay(&mut sketch, outline, origin);
    let borders = fringe::borders(&sketch, &laid);
    let cells::Parts { junctions, mains, cells } = cells::parts(settlement.id, &sketch, &borders, &laid);
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
