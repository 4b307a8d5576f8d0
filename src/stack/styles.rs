//! The styles of a world, and the style of each main cell: a mixture of the styles of the town's centre, of its fringe, and of
//! towns across a border, by where the cell lies.

use crate::layer::LayerError;
use crate::region::{Border, Outline, Settlement};
use crate::space::{Origin, Seed, distance_to_line};
use crate::style::Style;
use crate::town::CellId;
use glam::DVec2;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

/// Distance from a border, in metres, within which the styles on both sides mix.
pub const BORDER_BLEND: f64 = 400.0;
/// Styles with a smaller share of a cell than this are left out.
const LEAST_SHARE: f64 = 0.04;

/// Names of styles, in order, with their shares, which sum to 1.
#[derive(Clone, Debug, PartialEq)]
struct Blend(Vec<(String, f64)>);

impl Blend {
    fn of(mut shares: Vec<(String, f64)>) -> Self {
        shares.sort_by(|a, b| a.0.cmp(&b.0));
        let mut merged: Vec<(String, f64)> = Vec::new();
        for (name, share) in shares {
            match merged.last_mut() {
                Some(last) if last.0 == name => last.1 += share,
                _ => merged.push((name, share)),
            }
        }
        merged.retain(|(_, share)| *share >= LEAST_SHARE);
        let sum: f64 = merged.iter().map(|(_, share)| share).sum();
        merged.iter_mut().for_each(|(_, share)| *share /= sum);
        Self(merged)
    }
}

/// How the styles of a town spread over it.
pub(super) struct StyledTown<'a> {
    style: &'a Style,
    origin: Origin,
    /// Radius of the circle with the outline's area, in metres.
    radius: f64,
}

impl StyledTown<'_> {
    /// Adds to `out` the shares of this town's own styles at a local place, times `share`.
    fn shares(&self, at: DVec2, share: f64, out: &mut Vec<(String, f64)>) {
        let outer = self.style.fringe_share(at.length() / self.radius);
        out.push((self.style.name.clone(), share * (1.0 - outer)));
        if let Some(fringe) = &self.style.fringe {
            out.push((fringe.style.clone(), share * outer));
        }
    }

    /// Shares of all styles at a place local to this town; `across` has the towns that it touches.
    fn blend(&self, at: DVec2, across: &[(StyledTown<'_>, Arc<Border>)]) -> Blend {
        let near = |border: &Border| {
            let distance = distance_to_line(at + self.origin.offset_to(border.origin), &border.line);
            0.5 * (1.0 - distance / BORDER_BLEND).max(0.0)
        };
        let theirs: Vec<f64> = across.iter().map(|(_, border)| near(border)).collect();
        // Where three towns meet, the other two have two thirds at most.
        let scale = 1.0 / (0.5 + theirs.iter().sum::<f64>()).max(1.0);
        let mut out = Vec::new();
        let mut own = 1.0;
        for ((town, _), share) in across.iter().zip(theirs).filter(|(_, share)| *share > 0.0) {
            own -= share * scale;
            town.shares(at + self.origin.offset_to(town.origin), share * scale, &mut out);
        }
        self.shares(at, own, &mut out);
        Blend::of(out)
    }
}

/// The style of a main cell.
#[derive(Clone, Debug)]
pub struct CellStyle {
    /// The mixed styles in the order of their names, with their shares, which sum to 1.
    pub parts: Vec<(Arc<Style>, f64)>,
    /// The mixture.
    pub style: Arc<Style>,
}

/// All styles of a world, by name.
pub(super) struct Styles(pub BTreeMap<String, Arc<Style>>);

impl Styles {
    /// The style of a name.
    pub fn of(&self, name: &str) -> Result<&Arc<Style>, LayerError> {
        self.0.get(name).ok_or_else(|| LayerError::UnknownStyle(name.to_owned()))
    }

    /// How the styles of a settlement spread over it.
    pub fn town(&self, settlement: &Settlement, outline: &Outline) -> Result<StyledTown<'_>, LayerError> {
        let style = self.of(&settlement.style)?;
        Ok(StyledTown { style, origin: outline.origin, radius: (outline.area() / PI).sqrt() })
    }

    /// The style of a main cell whose anchor lies at a place local to a town; `across` has the towns that it touches.
    pub fn mix(
        &self,
        seed: Seed,
        cell: CellId,
        (town, anchor): (&StyledTown<'_>, DVec2),
        across: &[(StyledTown<'_>, Arc<Border>)],
    ) -> Result<CellStyle, LayerError> {
        let mut parts = Vec::new();
        for (name, share) in town.blend(anchor, across).0 {
            parts.push((self.of(&name)?.clone(), share));
        }
        // The choices of a cell are drawn in the order of the styles' names, whatever their shares.
        let mut stream = seed.stream("style", &[cell.0]);
        let (mut sum, mut style): (f64, Option<Arc<Style>>) = (0.0, None);
        for (part, share) in &parts {
            sum += share;
            style = Some(match style {
                Some(before) => Arc::new(Style::mix(&before, part, share / sum, &mut stream)),
                None => part.clone(),
            });
        }
        Ok(CellStyle { parts, style: style.unwrap_or_default() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::StreetClass;
    use crate::region::SettlementId;
    use crate::style::FringeRules;

    #[test]
    fn styles_of_towns_that_touch_meet_in_equal_shares_on_their_border() {
        let style = |name: &str, fringe: &str| Style {
            name: name.into(),
            fringe: Some(FringeRules { style: fringe.into(), begins: 0.6, complete: 1.1 }),
            ..Style::default()
        };
        let (a, b) = (style("a", "c"), style("b", "d"));
        let origins = [Origin::at(DVec2::ZERO), Origin::at(DVec2::new(1300.0, 200.0))];
        let spread = |i: usize| StyledTown { style: [&a, &b][i], origin: origins[i], radius: 700.0 };
        let border = Arc::new(Border {
            origin: Origin::at(DVec2::new(650.0, 100.0)),
            sides: [SettlementId(1), SettlementId(2)],
            line: vec![DVec2::new(60.0, -400.0), DVec2::new(-10.0, 0.0), DVec2::new(-60.0, 400.0)],
            gates: vec![1],
            class: StreetClass::Arterial,
        });
        let blend =
            |i: usize, plan: DVec2| spread(i).blend(origins[i].to_local(plan), &[(spread(1 - i), border.clone())]);
        for p in &border.line {
            let plan = border.origin.to_plan(*p);
            let (here, there) = (blend(0, plan), blend(1, plan));
            assert_eq!(here.0.len(), there.0.len());
            for (x, y) in here.0.iter().zip(&there.0) {
                assert!(x.0 == y.0 && (x.1 - y.1).abs() < 1e-9, "{here:?} {there:?}");
            }
        }
        // The share of the other town's style fades with the distance and ends.
        let share = |x: f64, style: &str| {
            let blend = blend(0, DVec2::new(x, 0.0));
            blend.0.iter().filter(|(name, _)| name == style).map(|(_, s)| *s).sum::<f64>()
        };
        let own: Vec<f64> = (0..8).map(|i| share(600.0 - 100.0 * f64::from(i), "b")).collect();
        assert!(own.windows(2).all(|w| w[1] <= w[0] + 1e-12), "{own:?}");
        assert_eq!((share(0.0, "a"), share(0.0, "b")), (1.0, 0.0));
        let sum: f64 = blend(0, DVec2::new(500.0, 90.0)).0.iter().map(|(_, s)| s).sum();
        assert!((sum - 1.0).abs() < 1e-12);
    }
}
