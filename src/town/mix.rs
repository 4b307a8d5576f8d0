//! Styles between two styles.

use crate::space::Stream;
use crate::space::math::mix;
use crate::town::{LocalRules, MainRules, ParcelRules, SeamRules, Style};

/// How far one is on the way from a first style to a second, and what draws the choices that have no middle.
struct Between<'a> {
    t: f64,
    stream: &'a mut Stream,
}

impl Between<'_> {
    fn number(&self, a: f64, b: f64) -> f64 {
        // Exact at both ends.
        if self.t >= 1.0 { b } else { mix(a, b, self.t) }
    }

    fn pair(&self, a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
        (self.number(a.0, b.0), self.number(a.1, b.1))
    }

    fn counts(&self, a: (u32, u32), b: (u32, u32)) -> (u32, u32) {
        let whole = |a: u32, b: u32| self.number(a.into(), b.into()).round() as u32;
        (whole(a.0, b.0), whole(a.1, b.1))
    }

    fn choice<T: Clone>(&mut self, a: &T, b: &T) -> T {
        if self.stream.chance(self.t) { b.clone() } else { a.clone() }
    }

    fn main(&mut self, a: &MainRules, b: &MainRules) -> MainRules {
        MainRules {
            field: self.choice(&a.field, &b.field),
            length: self.number(a.length, b.length),
            deviation: self.number(a.deviation, b.deviation),
            min_length: self.number(a.min_length, b.min_length),
            degree: self.counts(a.degree, b.degree),
            min_angle_deg: self.number(a.min_angle_deg, b.min_angle_deg),
            angle_deviation_deg: self.number(a.angle_deviation_deg, b.angle_deviation_deg),
            snap_radius: self.number(a.snap_radius, b.snap_radius),
            roundabouts: self.number(a.roundabouts, b.roundabouts),
            squares: self.number(a.squares, b.squares),
            bridges: self.number(a.bridges, b.bridges),
        }
    }

    fn seam(&self, a: &SeamRules, b: &SeamRules) -> SeamRules {
        SeamRules {
            spacing: self.number(a.spacing, b.spacing),
            jitter: self.number(a.jitter, b.jitter),
            min_spacing: self.number(a.min_spacing, b.min_spacing),
            crossing: self.number(a.crossing, b.crossing),
            least: self.counts((a.least, a.least), (b.least, b.least)).0,
        }
    }

    fn local(&self, a: &LocalRules, b: &LocalRules) -> LocalRules {
        LocalRules {
            length: self.number(a.length, b.length),
            deviation: self.number(a.deviation, b.deviation),
            min_length: self.number(a.min_length, b.min_length),
            degree: self.counts(a.degree, b.degree),
            min_angle_deg: self.number(a.min_angle_deg, b.min_angle_deg),
            angle_deviation_deg: self.number(a.angle_deviation_deg, b.angle_deviation_deg),
            snap_radius: self.number(a.snap_radius, b.snap_radius),
            clearance: self.number(a.clearance, b.clearance),
            dead_ends: self.number(a.dead_ends, b.dead_ends),
            rounding: self.number(a.rounding, b.rounding),
        }
    }

    fn parcels(&self, a: &ParcelRules, b: &ParcelRules) -> ParcelRules {
        ParcelRules {
            lot_width: self.pair(a.lot_width, b.lot_width),
            lot_depth: self.number(a.lot_depth, b.lot_depth),
            min_area: self.number(a.min_area, b.min_area),
            setback_front: self.number(a.setback_front, b.setback_front),
            setback_side: self.number(a.setback_side, b.setback_side),
            building_depth: self.number(a.building_depth, b.building_depth),
            wings: self.number(a.wings, b.wings),
            storeys: self.counts(a.storeys, b.storeys),
            vacant: self.number(a.vacant, b.vacant),
            parks: self.number(a.parks, b.parks),
        }
    }
}

impl Style {
    /// The style that is `t` (0 to 1) of the way from `a` to `b`: numbers lie between, counts are rounded, choices without a
    /// middle are drawn from `stream` (`b` with probability `t`), patch sets are those of both. Name and tags are those of the
    /// nearer one; a style between others has no fringe and counts no patches.
    pub fn mix(a: &Self, b: &Self, t: f64, stream: &mut Stream) -> Self {
        let nearer = if t < 0.5 { a } else { b };
        let mut patch_sets: Vec<String> = a.patch_sets.iter().chain(&b.patch_sets).cloned().collect();
        patch_sets.sort();
        patch_sets.dedup();
        let mut between = Between { t, stream };
        Self {
            name: nearer.name.clone(),
            main: between.main(&a.main, &b.main),
            seam: between.seam(&a.seam, &b.seam),
            local: between.local(&a.local, &b.local),
            filler: between.choice(&a.filler, &b.filler),
            patch_sets,
            allow: nearer.allow.clone(),
            exclude: nearer.exclude.clone(),
            patches: Vec::new(),
            fringe: None,
            parcels: between.parcels(&a.parcels, &b.parcels),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::space::Seed;
    use crate::town::Style;

    fn bundled() -> Vec<Style> {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/styles");
        let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
        files.sort();
        let read = |file: &std::path::PathBuf| {
            Style::from_ron(&file.to_string_lossy(), &std::fs::read_to_string(file).unwrap()).unwrap()
        };
        files.iter().map(read).collect()
    }

    #[test]
    fn a_mixed_style_is_sound_and_lies_between_both() {
        let styles = bundled();
        let mut stream = Seed(1).stream("test", &[]);
        for a in &styles {
            for b in &styles {
                for t in [0.0, 0.17, 0.5, 0.83, 1.0] {
                    let mixed = Style::mix(a, b, t, &mut stream);
                    assert_eq!(mixed.check(), Ok(()), "{} and {} at {t}", a.name, b.name);
                    let (x, y) = (a.local.length, b.local.length);
                    assert!((mixed.local.length - (x + (y - x) * t)).abs() < 1e-9);
                    assert!(a.patch_sets.iter().chain(&b.patch_sets).all(|s| mixed.patch_sets.contains(s)));
                    let (end, of) = if t < 0.5 { (0.0, a) } else { (1.0, b) };
                    if t == end {
                        assert_eq!((&mixed.main, &mixed.seam, &mixed.local), (&of.main, &of.seam, &of.local));
                        assert_eq!((&mixed.parcels, &mixed.name), (&of.parcels, &of.name));
                    }
                }
            }
        }
    }
}
