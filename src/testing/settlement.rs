//! Settlements with an outline, gates, a style and ground.

use crate::layer::Cancel;
use crate::network::{JunctionId, SizeClass, StreetClass};
use crate::region::{Gate, Outline, Settlement, SettlementId};
use crate::space::math::{angle_of, direction, rotate, sin};
use crate::space::{Origin, Seed, Stream, quantize};
use crate::style::{FieldKind, Style};
use crate::terrain::{Terrain, TerrainSample};
use crate::town::{Town, plan};
use glam::{DVec2, I64Vec2};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Hills of a given height, and sea north of a line.
pub(crate) struct Coast {
    pub height: f64,
    pub shore: f64,
}

impl Terrain for Coast {
    fn sample(&self, p: DVec2) -> TerrainSample {
        let waves = sin(p.x / 310.0 + 1.0) * sin(p.y / 270.0) + 0.4 * sin(p.x / 130.0 - p.y / 170.0);
        let land = 100.0 + self.height * waves;
        TerrainSample { height: if p.y > self.shore { -5.0 } else { land }, water_level: 0.0, vegetation: 0.0 }
    }
}

/// A settlement with everything that its plan reads.
pub(crate) struct SettlementCase {
    pub seed: Seed,
    pub settlement: Arc<Settlement>,
    pub outline: Arc<Outline>,
    pub gates: Vec<Gate>,
    pub style: Style,
    pub terrain: Coast,
}

impl SettlementCase {
    pub fn plan(&self) -> Town {
        let (s, o) = (&self.settlement, &self.outline);
        plan(self.seed, s, o, self.gates.clone(), &self.style, &self.terrain, &Cancel::new()).unwrap()
    }
}

/// The settlement that `number` stands for; kind and size are drawn from it, too.
pub(crate) fn any_settlement(number: u64) -> SettlementCase {
    let mut s = Seed(number).stream("sample", &[1]);
    let field = FieldKind::ALL[s.index(4)];
    let radius = 120.0 + 1580.0 * s.unit() * s.unit();
    let gates = s.index(10);
    settlement(number, field, radius, gates)
}

/// A settlement of a given kind, size in metres and number of gates; all else is drawn from `number`.
pub(crate) fn settlement(number: u64, field: FieldKind, radius: f64, gates: usize) -> SettlementCase {
    let mut s = Seed(number).stream("sample", &[2]);
    let seed = Seed(s.bits());
    let shore = if s.chance(0.3) { radius * s.range(0.25, 0.6) } else { f64::INFINITY };
    let terrain = Coast { height: if s.chance(0.5) { 0.0 } else { s.range(5.0, 30.0) }, shore: shore + 5.0 };
    let origin = Origin(I64Vec2::ZERO);
    let polygon = polygon(&mut s, radius, shore);
    let gates = draw_gates(&mut s, &polygon, gates);
    let settlement = Arc::new(Settlement {
        id: SettlementId(s.bits()),
        centre: origin,
        radius,
        size: SizeClass::Town,
        style: "sample".into(),
        name: "Sample".into(),
    });
    let mut style = Style::default();
    style.main.field = field;
    if field != FieldKind::Grid {
        style.main.min_angle_deg = 50.0;
        style.main.angle_deviation_deg = 10.0;
    }
    if field == FieldKind::Radial {
        style.main.degree = (3, 5);
    }
    if number.is_multiple_of(2) {
        (style.main.roundabouts, style.main.squares) = (0.5, 0.5);
    }
    style.check().unwrap();
    SettlementCase {
        seed,
        settlement,
        outline: Arc::new(Outline { origin, polygon, shared: Vec::new(), river: None }),
        gates,
        style,
        terrain,
    }
}

fn polygon(s: &mut Stream, radius: f64, shore: f64) -> Vec<DVec2> {
    let waves: Vec<(f64, f64, f64)> =
        (2..7).map(|k| (k as f64, s.range(0.0, TAU), 0.16 * s.unit() / (k as f64 / 2.0))).collect();
    let reach = |angle: f64| {
        let wobble: f64 = waves.iter().map(|(k, phase, a)| a * (sin(k * angle + phase) - 1.0)).sum();
        let r = radius * (1.0 + wobble);
        let north = sin(angle);
        if north * r > shore { shore / north } else { r }
    };
    let mut out: Vec<DVec2> = Vec::new();
    let steps = 4000;
    for i in 0..steps {
        let p = direction(TAU * i as f64 / steps as f64);
        let p = quantize(p * reach(angle_of(p)));
        let far = out.last().is_none_or(|q| q.distance(p) >= 55.0);
        if far && (out.len() < 3 || p.distance(out[0]) >= 40.0) {
            out.push(p);
        }
    }
    out
}

fn draw_gates(s: &mut Stream, polygon: &[DVec2], count: usize) -> Vec<Gate> {
    let mut vertices: Vec<usize> = (0..count.min(polygon.len())).map(|_| s.index(polygon.len())).collect();
    vertices.sort_unstable();
    vertices.dedup();
    let classes = [StreetClass::Highway, StreetClass::Major, StreetClass::Minor];
    vertices
        .into_iter()
        .map(|vertex| {
            let at = polygon[vertex];
            let inward = rotate(-at.normalize(), 0.8 * s.signed() * s.unit());
            Gate { junction: JunctionId(s.bits()), vertex, at, inward, class: classes[s.index(3)] }
        })
        .collect()
}
