//! The patch database: patches indexed for the searches of a filler.

use crate::patch::shape::least_reach;
use crate::patch::{MainLine, Patch, PatchSet, PatchShape, PatchView, Pattern, SectorReach};
use crate::space::math::turn;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// A way through a patch, as drawn or mirrored, from one connectable vertex to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Straight distance between the two vertices, in metres.
    pub distance: f64,
    /// Index into [`PatchDatabase::patches`].
    pub patch: usize,
    /// The first vertex, as index into [`Patch::connectables`].
    pub from: usize,
    /// The last vertex, as index into [`Patch::connectables`].
    pub to: usize,
    /// Whether the patch is mirrored.
    pub mirrored: bool,
    /// Angle from the straight line between the vertices to the direction in which the street leaves the first vertex, in
    /// radians, counter-clockwise, -pi..=pi. It is 0 if the street heads for the last vertex.
    pub leaves: f64,
    /// Angle from the straight line to the direction in which the street arrives at the last vertex, in radians,
    /// counter-clockwise, -pi..=pi. It is 0 if the street comes straight from the first vertex.
    pub arrives: f64,
}

impl Passage {
    /// The passages of a patch: four for each pair of connectable vertices.
    fn of(patch: &Patch, index: usize) -> impl Iterator<Item = Self> + '_ {
        let passage = move |from: usize, to: usize, distance: f64, mirrored: bool| {
            let (a, b) = (patch.connectables[from], patch.connectables[to]);
            let chord = patch.vertices[b.vertex] - patch.vertices[a.vertex];
            let sign = if mirrored { -1.0 } else { 1.0 };
            let (leaves, arrives) = (sign * turn(chord, a.inward), sign * turn(chord, -b.inward));
            Self { distance, patch: index, from, to, mirrored, leaves, arrives }
        };
        let both_ways = patch.pairs.iter().flat_map(|p| [(p.a, p.b, p.distance), (p.b, p.a, p.distance)]);
        both_ways.flat_map(move |(from, to, d)| [false, true].map(|mirrored| passage(from, to, d, mirrored)))
    }

    /// Number of the drawer for a heading at one of the ends.
    fn drawer(heading: f64) -> usize {
        (((heading + PI) / TAU * DRAWERS as f64) as usize).min(DRAWERS - 1)
    }
}

/// Number of drawers in which passages are kept by the heading in which they leave, and likewise by the heading in which they
/// arrive.
const DRAWERS: usize = 16;

/// A pattern with its element.
#[derive(Clone, Debug, PartialEq)]
pub struct PatternEntry {
    /// The pattern.
    pub pattern: Pattern,
    /// The patch that it repeats, as index into [`PatchDatabase::patches`].
    pub element: usize,
}

/// What is derived from a patch once, rather than at each try to place it.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchFacts {
    /// Its streets ([`Patch::streets`]).
    pub streets: Vec<Vec<usize>>,
    /// Vertices in which dead-end edges end.
    pub dead_ends: Vec<usize>,
    /// The main street that it can be attached to ([`Patch::main_line`]).
    pub main: Option<MainLine>,
    /// Its geometry, split into arms and core.
    pub shape: PatchShape,
    /// Its geometry as seen from each of its connectable vertices, in their order.
    pub views: Vec<PatchView>,
    /// The least [`PatchView::reach`] in each sector, of all views and of the mirrored views.
    pub least_reach: SectorReach,
}

impl PatchFacts {
    fn of(patch: &Patch) -> Self {
        let ends = |v: &usize| patch.degree(*v) == 1 && !patch.is_connectable(*v);
        let local = |v: &usize| patch.edges_at(*v).all(|e| !patch.edges[e].main);
        let dead_ends = (0..patch.vertices.len()).filter(ends).filter(local).collect();
        let shape = PatchShape::of(patch);
        let views: Vec<PatchView> = patch.connectables.iter().map(|c| PatchView::of(patch, &shape, c)).collect();
        let least_reach = least_reach(&views);
        Self { streets: patch.streets(), dead_ends, main: patch.main_line(), shape, views, least_reach }
    }
}

/// The patches that a style may use, indexed for the searches of Teng 2017, section 3.3.
///
/// With p patches and c pairs of connectable vertices in all: made once in O((p + c) log (p + c)), then each search costs
/// O(log) of what is indexed and the length of its answer.
#[derive(Clone, Debug)]
pub struct PatchDatabase {
    /// The patches, by set and then by place in the file.
    pub patches: Vec<Arc<Patch>>,
    /// For each patch, the name of its set and its own name.
    names: Vec<Arc<str>>,
    /// For each patch, what is derived from it.
    facts: Vec<PatchFacts>,
    patterns: Vec<PatternEntry>,
    /// Passages by the headings in which they leave and arrive, then by distance, then by patch and pair.
    passages: Vec<Vec<Passage>>,
    /// Indices of patches by radius, then index.
    by_radius: Vec<usize>,
    /// Indices of patches in order, by tag.
    by_tag: BTreeMap<String, Vec<usize>>,
}

impl PatchDatabase {
    /// The patches of `sets` that [are allowed](Patch::is_allowed), and the patterns whose element is one of them.
    pub fn new(sets: &[&PatchSet], allow: &[String], exclude: &[String]) -> Self {
        let (mut patches, mut names, mut patterns) = (Vec::new(), Vec::new(), Vec::new());
        for set in sets {
            let first = patches.len();
            patches.extend(set.patches.iter().filter(|p| p.is_allowed(allow, exclude)).cloned().map(Arc::new));
            names.extend(patches[first..].iter().map(|p| Arc::from(format!("{}/{}", set.name, p.name))));
            for pattern in &set.patterns {
                let element = patches[first..].iter().position(|p| p.name == pattern.element);
                patterns.extend(element.map(|e| PatternEntry { pattern: pattern.clone(), element: first + e }));
            }
        }
        Self { names, patterns, ..Self::of(patches) }
    }

    /// The given patches, of no set and without patterns.
    pub fn of(patches: Vec<Arc<Patch>>) -> Self {
        let mut passages = vec![Vec::new(); DRAWERS * DRAWERS];
        for passage in patches.iter().enumerate().flat_map(|(i, p)| Passage::of(p, i)) {
            let drawer = Passage::drawer(passage.leaves) * DRAWERS + Passage::drawer(passage.arrives);
            passages[drawer].push(passage);
        }
        passages.iter_mut().for_each(|drawer| drawer.sort_by(|x, y| x.distance.total_cmp(&y.distance)));
        let mut by_radius: Vec<usize> = (0..patches.len()).collect();
        by_radius.sort_by(|a, b| patches[*a].radius.total_cmp(&patches[*b].radius).then(a.cmp(b)));
        let mut by_tag: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (i, patch) in patches.iter().enumerate() {
            for tag in &patch.tags {
                by_tag.entry(tag.clone()).or_default().push(i);
            }
        }
        let facts = patches.iter().map(|p| PatchFacts::of(p)).collect();
        let names = patches.iter().map(|p| Arc::from(&*p.name)).collect();
        Self { patches, names, facts, patterns: Vec::new(), passages, by_radius, by_tag }
    }

    /// All passages between vertices `distance` metres apart, give or take `tolerance`, that leave and arrive at `headings`
    /// (-pi..=pi), give or take `most` radians. Ranges of headings do not wrap around at pi. Takes O(log c) and the number of
    /// passages with about these headings.
    pub fn passages_near(
        &self,
        distance: f64,
        tolerance: f64,
        headings: [f64; 2],
        most: f64,
    ) -> impl Iterator<Item = &Passage> {
        let drawers = |heading: f64| Passage::drawer(heading - most)..=Passage::drawer(heading + most);
        let (leaves, arrives) = (drawers(headings[0]), drawers(headings[1]));
        let in_drawer = move |drawer: &'_ Vec<Passage>| {
            let from = drawer.partition_point(|e| e.distance < distance - tolerance);
            // Not out of order for a negative tolerance.
            from..drawer.partition_point(|e| e.distance <= distance + tolerance).max(from)
        };
        let drawers = leaves
            .flat_map(move |row| &self.passages[row * DRAWERS + *arrives.start()..=row * DRAWERS + *arrives.end()]);
        let near = drawers.flat_map(move |drawer| &drawer[in_drawer(drawer)]);
        near.filter(move |p| (p.leaves - headings[0]).abs() <= most && (p.arrives - headings[1]).abs() <= most)
    }

    /// Indices of the patches whose bounding circle has a radius of at most `radius` metres, smallest first. O(log p).
    pub fn fitting(&self, radius: f64) -> &[usize] {
        &self.by_radius[..self.by_radius.partition_point(|i| self.patches[*i].radius <= radius)]
    }

    /// Indices of the patches with a tag, in order. O(log of the number of tags).
    pub fn tagged(&self, tag: &str) -> &[usize] {
        self.by_tag.get(tag).map_or(&[], Vec::as_slice)
    }

    /// What is derived from a patch. O(1).
    pub fn facts(&self, patch: usize) -> &PatchFacts {
        &self.facts[patch]
    }

    /// The names of the patches, in order: `set/patch`, or `patch` alone where it is of no set.
    pub fn names(&self) -> &[Arc<str>] {
        &self.names
    }

    /// The weights that the files give the patches, in order.
    pub fn weights(&self) -> Vec<f64> {
        self.patches.iter().map(|p| p.weight).collect()
    }

    /// The patterns, by set and then by place in the file.
    pub fn patterns(&self) -> &[PatternEntry] {
        &self.patterns
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Seed;
    use glam::DVec2;

    /// A set of many random trees with two to five ends.
    fn random_set(seed: u64) -> PatchSet {
        let mut s = Seed(seed).stream("test", &[]);
        let mut patches = Vec::new();
        for i in 0..60 {
            let (n, turned) = (2 + s.index(4), s.unit());
            let mut vertices = vec!["(0, 0)".to_owned()];
            let mut streets = Vec::new();
            for k in 1..=n {
                let angle = (k as f64 / n as f64 + turned) * std::f64::consts::TAU;
                let at = crate::space::math::direction(angle) * s.range(30.0, 120.0);
                vertices.push(format!("({}, {})", at.x, at.y));
                streets.push(format!("(0, {k})"));
            }
            // Two are elements of patterns.
            let dead = if s.chance(0.3) && ![7, 8].contains(&i) { "1" } else { "" };
            let tags = if s.chance(0.5) { "\"odd\"" } else { "" };
            patches.push(format!(
                "(name: \"{i}\", vertices: [{}], streets: [{}], dead_ends: [{dead}], tags: [{tags}], weight: {})",
                vertices.join(", "),
                streets.join(", "),
                i % 3
            ));
        }
        let patterns = "(name: \"a\", element: \"7\", repeat: (1, 2)), (name: \"b\", element: \"8\", repeat: (1, 2))";
        let text = format!("(patches: [{}], patterns: [{patterns}])", patches.join(",\n"));
        PatchSet::from_ron("random.ron", &text).unwrap()
    }

    #[test]
    fn searches_find_what_a_full_scan_finds() {
        for seed in 0..20 {
            let set = random_set(seed);
            let db = PatchDatabase::new(&[&set, &set], &[], &[]);
            assert_eq!((db.patches.len(), db.patterns().len()), (120, 4));
            assert_eq!(db.patterns()[3].element, 68);
            let mut s = Seed(seed).stream("query", &[]);
            let (distance, tolerance) = (s.range(20.0, 240.0), s.range(0.0, 20.0));
            let (headings, most) = ([s.range(-3.0, 3.0), s.range(-3.0, 3.0)], s.range(0.1, 2.0));
            let near = |p: &Passage| {
                (p.distance - distance).abs() <= tolerance
                    && (p.leaves - headings[0]).abs() <= most
                    && (p.arrives - headings[1]).abs() <= most
            };
            let all = db.patches.iter().enumerate().flat_map(|(i, p)| Passage::of(p, i)).filter(near);
            let mut found: Vec<Passage> = db.passages_near(distance, tolerance, headings, most).copied().collect();
            found.sort_by_key(|p| (p.patch, p.from.min(p.to), p.from.max(p.to), p.from > p.to, p.mirrored));
            let mut all: Vec<Passage> = all.collect();
            all.sort_by_key(|p| (p.patch, p.from.min(p.to), p.from.max(p.to), p.from > p.to, p.mirrored));
            assert_eq!(found, all);
            let none =
                |distance: f64, tolerance: f64| db.passages_near(distance, tolerance, [0.0; 2], 9.0).count() == 0;
            assert!(none(distance, -1.0) && none(f64::NAN, 1.0));

            for (i, p) in db.patches.iter().enumerate() {
                assert_eq!(db.facts(i).dead_ends.is_empty(), !p.tags.contains("cul-de-sac"));
            }
            let fitting = db.fitting(distance / 2.0);
            assert_eq!(fitting.len(), db.patches.iter().filter(|p| p.radius <= distance / 2.0).count());
            assert!(fitting.iter().all(|i| db.patches[*i].radius <= distance / 2.0));
            let weights = db.weights();
            assert_eq!([0, 1, 2, 63].map(|i| weights[i]), [0.0, 1.0, 2.0, 0.0]);
        }
    }

    #[test]
    fn headings_place_a_pair_between_two_points() {
        let db = PatchDatabase::new(&[&random_set(5)], &[], &[]);
        let all: Vec<&Passage> = db.passages_near(0.0, 1000.0, [0.0; 2], 9.0).collect();
        assert_eq!(all.len(), 4 * db.patches.iter().map(|p| p.pairs.len()).sum::<usize>());
        for passage in all {
            let patch = &db.patches[passage.patch];
            let side = if passage.mirrored { DVec2::new(1.0, -1.0) } else { DVec2::ONE };
            let (a, b) = (patch.connectables[passage.from], patch.connectables[passage.to]);
            let chord = ((patch.vertices[b.vertex] - patch.vertices[a.vertex]) * side).normalize();
            assert!(crate::space::math::rotate(chord, passage.leaves).distance(a.inward * side) < 1e-9);
            assert!(crate::space::math::rotate(chord, passage.arrives).distance(-b.inward * side) < 1e-9);
        }
    }

    #[test]
    fn tags_allow_and_exclude() {
        let set = random_set(3);
        let names = |tags: &[&str]| tags.iter().map(|t| (*t).to_owned()).collect::<Vec<_>>();
        let with = |allow: &[&str], exclude: &[&str]| PatchDatabase::new(&[&set], &names(allow), &names(exclude));
        let count = |tag: &str| set.patches.iter().filter(|p| p.tags.contains(tag)).count();
        let odd = with(&["odd", "nowhere"], &[]);
        assert_eq!((odd.patches.len(), odd.tagged("odd").len()), (count("odd"), count("odd")));
        assert!(with(&["nowhere"], &[]).patches.is_empty());
        let open = with(&[], &["cul-de-sac"]);
        assert_eq!(open.patches.len(), 60 - count("cul-de-sac"));
        assert!(open.tagged("cul-de-sac").is_empty());
        for entry in with(&["odd"], &["terminal"]).patterns() {
            let element = set.patches.iter().find(|p| p.name == entry.pattern.element).unwrap();
            assert!(element.tags.contains("odd") && !element.tags.contains("terminal"));
        }
    }
}
