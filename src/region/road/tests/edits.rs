//! Roads with the user's wishes.

use super::*;
use crate::edits::{EditList, Influence, RoadEdit, Shape, WayPoint};
use crate::space::{distance_to_line, line_length, point_at, segments};

fn edited(seed: u64, flat: bool, edits: &Edits) -> Roads {
    assert_eq!(edits.check(), Ok(()));
    let inputs = roads(seed, flat, &RoadSettings::default()).searches.inputs;
    let (terrain, settlements) = (inputs.terrain.clone(), inputs.settlements.clone());
    Roads::from_source(&inputs.settings, terrain, settlements, edits, 256 << 20)
}

/// The routes of a tier from the settlements in a square.
fn routes(roads: &Roads, tier: SizeClass, bounds: Bounds) -> Vec<Arc<Route>> {
    let mut out = Vec::new();
    for s in roads.searches.inputs.settlements.centred_in(bounds, tier).unwrap() {
        out.extend(roads.routes.of(tier, &s, &Cancel::new()).unwrap());
    }
    out.sort_by_key(|c| c.id);
    out.dedup_by_key(|c| c.id);
    out
}

fn ends(c: &Route) -> [DVec2; 2] {
    [c.ends[0].centre.plan(), c.ends[1].centre.plan()]
}

#[test]
fn a_road_through_points_passes_them_and_still_meets_others_at_junctions() {
    let (mut passed, mut refused) = (0, 0);
    for seed in 30..34 {
        let bounds = Bounds::square(DVec2::ZERO, 9_000.0);
        let plain = roads(seed, false, &RoadSettings::default());
        for c in routes(&plain, SizeClass::Town, bounds).iter().take(2) {
            let [from, to] = ends(c);
            let off = (to - from).perp() * 0.2;
            let points: Vec<DVec2> = [0.4, 0.6].map(|t| from.lerp(to, t) + off).to_vec();
            let via = RoadEdit::Via { from: to, to: from, points: points.iter().rev().copied().collect(), keep: true };
            let edits = Edits { roads: vec![via], ..Edits::default() };
            let roads = edited(seed, false, &edits);
            if !roads.rejected_edits(&Cancel::new()).unwrap().is_empty() {
                refused += 1;
                continue;
            }
            passed += 1;
            let all_now = routes(&roads, SizeClass::Town, bounds);
            let line = all_now.iter().find(|o| o.id == c.id).unwrap().line(128);
            let near = |p: &DVec2| distance_to_line(*p, &line) <= super::via::TOLERANCE_STEPS * 128.0;
            assert!(points.iter().all(near), "{line:?}");
            assert!(segments(&line).all(|(a, b)| a != b));
            let square = Bounds::square(from.lerp(to, 0.5) + off, 4_000.0);
            let sections = all(&roads, square);
            assert!(
                sections.iter().any(|r| r.street.line.iter().any(|p| r.origin.to_plan(*p).distance(points[0]) < 500.0))
            );
            assert_planar(&sections, Origin::at(square.centre()));
        }
    }
    assert!(passed >= 3, "{passed} {refused}");
}

#[test]
fn roads_are_kept_and_banned_against_the_proximity_rule() {
    let bounds = Bounds::square(DVec2::ZERO, 14_000.0);
    let tier = SizeClass::Town;
    for seed in 40..43 {
        let plain = roads(seed, false, &RoadSettings::default());
        let before = routes(&plain, tier, bounds);
        let banned = before.first().unwrap();
        let all = plain.searches.inputs.settlements.centred_in(bounds, tier).unwrap();
        let reach = plain.searches.inputs.settings.major.reach;
        let linked = |a: &Settlement, b: &Settlement| {
            before.iter().any(|c| {
                let has = |s: &Settlement| c.ends.iter().any(|e| e.settlement == s.id);
                has(a) && has(b)
            })
        };
        let pairs: Vec<_> = all.iter().flat_map(|a| all.iter().map(move |b| (a, b))).collect();
        let apart =
            pairs.iter().find(|(a, b)| a.id < b.id && tier_of(a, b) == tier && beeline(a, b) < reach && !linked(a, b));
        let Some((a, b)) = apart else { continue };
        let [from, to] = ends(banned);
        let edits = Edits {
            roads: vec![
                RoadEdit::Ban { from, to },
                RoadEdit::Keep { from: a.centre.plan(), to: b.centre.plan() },
                RoadEdit::Keep { from: b.centre.plan(), to: a.centre.plan() },
            ],
            ..Edits::default()
        };
        let roads = edited(seed, false, &edits);
        let after = routes(&roads, tier, bounds);
        assert!(!after.iter().any(|c| c.id == banned.id));
        let rejected = roads.rejected_edits(&Cancel::new()).unwrap();
        assert!(rejected.iter().any(|e| e.index == 2 && e.reason.starts_with("roads[1] already names these two")));
        let kept = after.iter().filter(|c| c.ends[0].settlement == a.id && c.ends[1].settlement == b.id).count();
        assert_eq!(kept, usize::from(rejected.len() == 1), "{rejected:?}");
        // Nothing else changes but what ran along these two.
        let others = |list: &[Arc<Route>]| list.iter().map(|c| c.id).collect::<Vec<_>>();
        let mut expected = others(&before);
        expected.retain(|id| *id != banned.id);
        let mut found = others(&after);
        found.retain(|id| expected.contains(id));
        assert_eq!((found, after.len()), (expected.clone(), expected.len() + kept));
    }
}

/// Metres of a line within a distance of a point.
fn metres_near(line: &[DVec2], p: DVec2, distance: f64) -> f64 {
    let length = line_length(line);
    let count = (length / 10.0) as usize;
    let near = (0..count).filter(|i| point_at(line, *i as f64 * 10.0).0.distance(p) < distance).count();
    near as f64 * 10.0
}

#[test]
fn influences_drive_roads_off_and_draw_them_near() {
    let bounds = Bounds::square(DVec2::ZERO, 16_000.0);
    let (mut off, mut near) = ([0.0; 2], [0.0; 2]);
    for seed in 50..53 {
        let plain = roads(seed, true, &RoadSettings::default());
        for c in routes(&plain, SizeClass::Town, bounds).iter().filter(|c| c.nodes.len() > 20).take(2) {
            let (line, [from, to]) = (c.line(128), ends(c));
            let middle = point_at(&line, line_length(&line) / 2.0).0;
            let aside = from.lerp(to, 0.5) + (to - from).perp() * 0.12;
            let square = |r: f64| [(-r, -r), (r, -r), (r, r), (-r, r)].map(|(x, y)| middle + DVec2::new(x, y)).to_vec();
            let influence = |shape: Shape, strength: f64| Influence {
                shape,
                radius: 400.0,
                strength,
                classes: vec![StreetClass::Major],
            };
            let of = |influence: Influence| {
                let edits = Edits { influences: vec![influence], ..Edits::default() };
                let roads = edited(seed, true, &edits);
                let found = routes(&roads, SizeClass::Town, bounds);
                found.iter().find(|o| o.id == c.id).map(|c| c.line(128))
            };
            if let Some(now) = of(influence(Shape::Area(square(300.0)), 12.0)) {
                off[0] += metres_near(&line, middle, 400.0);
                off[1] += metres_near(&now, middle, 400.0);
            }
            let lure = vec![from.lerp(aside, 0.4), aside, to.lerp(aside, 0.4)];
            if let Some(now) = of(influence(Shape::Curve(lure), -1.4)) {
                near[0] += metres_near(&line, aside, 350.0);
                near[1] += metres_near(&now, aside, 350.0);
            }
        }
    }
    assert!(off[0] > 2_000.0 && off[1] < off[0] / 4.0, "{off:?}");
    assert!(near[1] > near[0] + 1_500.0, "{near:?}");
}

#[test]
fn far_roads_know_nothing_of_influences_and_ground_is_read_within_the_padding() {
    let draws = Influence {
        shape: Shape::Point(DVec2::ZERO),
        radius: 1_500.0,
        strength: -5.0,
        classes: vec![StreetClass::Minor],
    };
    let drives = Influence { shape: Shape::Point(DVec2::new(1_000.0, 2_000.0)), strength: 9.0, ..draws.clone() };
    let edits = Edits { influences: vec![draws, drives], ..Edits::default() };
    let t = RoadSettings::default().minor;
    // Pairs that an influence changes, and those that the proximity rule compares with them.
    let reach = 2.0 * 1.03 * t.detour * t.reach + 2_500.0 + 2_500.0;
    for seed in 60..62 {
        let (plain, edited) = (roads(seed, false, &RoadSettings::default()), edited(seed, false, &edits));
        for way in [DVec2::X, DVec2::NEG_Y] {
            let far = Bounds::square(way * (reach + 1_500.0), 3_000.0);
            assert_eq!(all(&plain, far), all(&edited, far));
        }
        let here = Bounds::square(DVec2::ZERO, 3_000.0);
        assert_ne!(all(&plain, here), all(&edited, here));
        // Any order gives the same with edits as well.
        assert_eq!(all(&super::edits::edited(seed, false, &edits), here), all(&edited, here));
    }
}

/// Way points at random places in a square.
fn random_way_points(seed: u64, middle: DVec2, size: f64, count: usize) -> Vec<WayPoint> {
    let mut stream = crate::space::Seed(seed).stream("way points", &[]);
    let classes = [StreetClass::Highway, StreetClass::Major, StreetClass::Minor];
    let mut random = || {
        let at = (middle + DVec2::new(stream.signed(), stream.signed()) * (size / 2.0)).round();
        WayPoint { at, class: classes[stream.index(3)] }
    };
    (0..count).map(|_| random()).collect()
}

#[test]
fn roads_lead_to_way_points_and_through_them() {
    let mut degrees: BTreeMap<(StreetClass, usize), usize> = BTreeMap::new();
    for (seed, middle) in [(70, DVec2::ZERO), (71, DVec2::new(-90_000.0, 41_000.0)), (72, DVec2::new(6e8, -2e8))] {
        let way_points = random_way_points(seed, middle, 9_000.0, 6);
        let edits = Edits { way_points: way_points.clone(), ..Edits::default() };
        let roads = edited(seed, false, &edits);
        let square = Bounds::square(middle, 11_000.0);
        let sections = all(&roads, square);
        assert_planar(&sections, Origin::at(middle));
        let rejected = roads.rejected_edits(&Cancel::new()).unwrap();
        assert!(rejected.iter().all(|e| e.list == EditList::WayPoints), "{rejected:?}");
        assert!(roads.way_points().len() + rejected.len() >= way_points.len());
        for (i, w) in way_points.iter().enumerate().filter(|(i, _)| rejected.iter().all(|e| e.index != *i)) {
            let point = roads.way_points().iter().find(|p| p.centre.plan() == w.at).unwrap();
            let junction = roads.way_point_junction(point.id);
            let mut arriving = Vec::new();
            for r in &sections {
                let line = &r.street.line;
                let ends = [(r.street.from, line[0]), (r.street.to, line[line.len() - 1])];
                for (_, end) in ends.into_iter().filter(|e| e.0 == junction) {
                    assert_eq!(end + r.origin.offset_to(point.centre), DVec2::ZERO, "way point {i}");
                    arriving.push(r.street.class);
                }
            }
            *degrees.entry((w.class, arriving.len())).or_default() += 1;
            // No road is of a higher class than the way point, but one that passes by chance.
            let links = roads.links(Bounds::square(w.at, 2.0), &Cancel::new()).unwrap();
            assert!(!links.is_empty() && links.iter().all(|l| l.class >= w.class), "{links:?}");
        }
    }
    println!("{degrees:?}");
    assert!(degrees.keys().all(|d| d.1 > 0), "{degrees:?}");
}
