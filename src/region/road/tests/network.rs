//! What holds for the roads of a world as a whole.

use super::*;
use crate::region::road::inputs::Way;
use crate::testing::Countryside;

#[test]
fn sections_meet_at_junctions_and_end_in_gates() {
    for (seed, centre) in [(1, DVec2::ZERO), (2, DVec2::new(-40_000.0, 31_000.0)), (3, DVec2::new(5e8, -3e8))] {
        let roads = roads(seed, false, &RoadSettings::default());
        let bounds = Bounds::square(centre, 10_000.0);
        let sections = all(&roads, bounds);
        assert!(sections.len() > 20, "{}", sections.len());
        assert_planar(&sections, Origin::at(centre));
        let mut ends: BTreeMap<JunctionId, usize> = BTreeMap::new();
        for r in &sections {
            for id in [r.street.from, r.street.to] {
                *ends.entry(id).or_default() += 1;
            }
        }
        let inner = bounds.grown(-3_000.0);
        let mut gates = Vec::new();
        let segments = local_segments(&sections, Origin::at(centre));
        for s in roads.searches.inputs.settlements.centred_in(bounds.grown(3_000.0), SizeClass::Village).unwrap() {
            let outline = roads.searches.inputs.settlements.outline(&s).unwrap();
            let shift = Origin::at(centre).offset_to(s.centre);
            let own = roads.gates(&s, &Cancel::new()).unwrap();
            for g in &own {
                assert_eq!(outline.polygon[g.vertex], g.at);
                assert!((g.inward.length() - 1.0).abs() < 1e-9);
                if inner.contains(s.centre.to_plan(g.at)) {
                    let section = sections.iter().find(|r| [r.street.from, r.street.to].contains(&g.junction)).unwrap();
                    assert_eq!(section.street.class, g.class);
                    let line = &section.street.line;
                    let (end, before) = if section.street.to == g.junction {
                        (line[line.len() - 1], line[line.len() - 2])
                    } else {
                        (line[0], line[1])
                    };
                    assert_eq!(end + section.origin.offset_to(s.centre), g.at);
                    assert!((end - before).normalize().dot(g.inward) > 0.99);
                }
            }
            let count = outline.polygon.len();
            for (_, _, a, b) in &segments {
                let (a, b) = (*a + shift, *b + shift);
                if !Bounds::of([a, b]).overlaps(Bounds::of(outline.polygon.iter().copied())) {
                    continue;
                }
                let gate = own.iter().find(|g| g.at == a || g.at == b).map(|g| g.vertex);
                for i in 0..count {
                    let j = (i + 1) % count;
                    if gate == Some(i) || gate == Some(j) {
                        let far = if a == own.iter().find(|g| Some(g.vertex) == gate).unwrap().at { b } else { a };
                        assert!(!point_in_polygon(far, &outline.polygon));
                    } else {
                        assert!(segment_distance(a, b, outline.polygon[i], outline.polygon[j]) > 1.0);
                    }
                }
            }
            gates.extend(own.iter().map(|g| g.junction));
        }
        // No road stops in a field.
        for r in &sections {
            let line = &r.street.line;
            for (id, p) in [(r.street.from, line[0]), (r.street.to, line[line.len() - 1])] {
                if inner.contains(r.origin.to_plan(p)) {
                    assert!(ends[&id] > 1 || gates.contains(&id), "{id:?}");
                }
            }
        }
    }
}

#[test]
fn the_same_sections_whatever_was_asked_before() {
    for centre in [DVec2::new(-3_000.0, -9_000.0), DVec2::new(5e8, 77.0)] {
        assert_same_whatever_was_asked(|| roads(7, false, &RoadSettings::default()), centre, 2_500.0);
    }
}

#[test]
fn on_open_ground_gamma_two_gives_the_gabriel_graph() {
    let mut settings = RoadSettings::default();
    settings.major.gamma = 2.0;
    settings.major.settlement = 0.0;
    settings.major.reach = 14_000.0;
    let roads = roads(5, true, &settings);
    let bounds = Bounds::square(DVec2::ZERO, 40_000.0);
    let all = roads.searches.inputs.settlements.centred_in(bounds, SizeClass::Town).unwrap();
    let around =
        roads.searches.inputs.settlements.centred_in(bounds.grown(settings.major.reach), SizeClass::Town).unwrap();
    let mut kept_pairs = 0;
    for a in &all {
        for b in all.iter().filter(|b| b.id > a.id) {
            let length = beeline(a, b);
            let middle = (a.centre.plan() + b.centre.plan()) / 2.0;
            if tier_of(a, b) != SizeClass::Town || length > settings.major.reach {
                continue;
            }
            let nearest = around
                .iter()
                .filter(|c| c.id != a.id && c.id != b.id)
                .map(|c| c.centre.plan().distance(middle))
                .fold(f64::INFINITY, f64::min);
            // A settlement on the circle itself may fall on either side: centres are rounded to nodes.
            if (nearest / (length / 2.0) - 1.0).abs() < 0.05 {
                continue;
            }
            let kept = roads.searches.proximity.keeps(a, b, &Cancel::new()).unwrap();
            assert_eq!(kept, nearest > length / 2.0, "{} {}", a.name, b.name);
            kept_pairs += usize::from(kept);
        }
    }
    assert!(kept_pairs > 30, "{kept_pairs}");
}

#[test]
fn links_name_settlements_and_cost_at_least_their_beeline() {
    let roads = roads(11, false, &RoadSettings::default());
    let bounds = Bounds::square(DVec2::new(20_000.0, 0.0), 9_000.0);
    let links = roads.links(bounds, &Cancel::new()).unwrap();
    let settlements = roads.searches.inputs.settlements.centred_in(bounds, SizeClass::Village).unwrap();
    assert!(links.len() >= settlements.len() / 2);
    for l in &links {
        assert!(l.from < l.to && l.cost.is_finite() && l.length_m > 0.0, "{l:?}");
        assert!(settlements.iter().any(|s| s.id == l.from || s.id == l.to));
    }
}

#[test]
fn courses_keep_within_their_padding() {
    let roads = roads(4, false, &RoadSettings::default());
    let step = roads.searches.inputs.settings.step;
    let bounds = Bounds::square(DVec2::ZERO, 8_000.0);
    for tier in [SizeClass::City, SizeClass::Town, SizeClass::Village] {
        let padding = roads.searches.inputs.settings.tier(tier).padding(step);
        for course in roads.routes.passing(tier, bounds, &Cancel::new()).unwrap() {
            for node in &course.nodes {
                let p = node_at(*node, step);
                assert!(course.ends.iter().any(|e| e.centre.plan().distance(p) <= padding));
            }
        }
    }
}

#[test]
fn a_cancelled_question_ends_and_can_be_asked_again() {
    let roads = roads(9, false, &RoadSettings::default());
    let cancel = Cancel::new();
    cancel.cancel();
    let bounds = Bounds::square(DVec2::ZERO, 500.0);
    assert_eq!(roads.overlapping(bounds, &cancel), Err(LayerError::Cancelled));
    assert!(roads.overlapping(bounds, &Cancel::new()).is_ok());
}

#[test]
fn bends_are_wide() {
    for seed in 31..34 {
        let roads = roads(seed, false, &RoadSettings::default());
        let (mut points, mut sharp) = (0, 0);
        for r in all(&roads, Bounds::square(DVec2::new(0.0, 9_000.0), 14_000.0)) {
            let t = roads.searches.inputs.settings.class(r.street.class);
            let even = crate::space::resample(&r.street.line, 20.0);
            for w in even.windows(3) {
                let (a, b, c) = (w[0].distance(w[1]), w[1].distance(w[2]), w[0].distance(w[2]));
                let area = (w[1] - w[0]).perp_dot(w[2] - w[0]).abs();
                points += 1;
                sharp += usize::from(a * b * c < 0.9 * 2.0 * area * t.radius);
            }
        }
        assert!(points > 5_000, "{points}");
        // Where roads pass close to another or begin at a gate, some corners are sharper.
        assert!(sharp * 200 < points, "{sharp} of {points}");
    }
}

/// Pieces of roads on the ground, one step of the lattice long, and how many are steeper than their class allows.
fn steep_pieces(roads: &Roads, limits: &RoadSettings, bounds: Bounds) -> (usize, usize) {
    let (mut pieces, mut steep) = (0, 0);
    for r in all(roads, bounds).iter().filter(|r| r.street.level == 0) {
        let limit = limits.class(r.street.class).slope_limit;
        let even = crate::space::resample(&r.street.line, limits.step as f64);
        for (a, b) in segments(&even) {
            let [from, to] = [a, b].map(|p| roads.searches.inputs.terrain.height(r.origin.to_plan(p)));
            pieces += 1;
            steep += usize::from((from - to).abs() > 1.1 * limit * a.distance(b));
        }
    }
    (pieces, steep)
}

#[test]
fn roads_avoid_slopes_above_their_limit() {
    // Slopes of up to 30 %.
    let hills = |p: DVec2| {
        let height = 120.0 * crate::space::math::sin(p.x / 450.0) * crate::space::math::cos(p.y / 400.0);
        crate::terrain::TerrainSample { height, water_level: -500.0, vegetation: 0.0 }
    };
    let settings = RoadSettings::default();
    let mut blind = settings.clone();
    for tier in [&mut blind.highway, &mut blind.major, &mut blind.minor] {
        (tier.slope, tier.slope_limit, tier.earthwork) = (0.0, 1.0, 100.0);
    }
    let bounds = Bounds::square(DVec2::ZERO, 9_000.0);
    let measure =
        |settings_used| steep_pieces(&roads_over(77, crate::testing::Ground(hills), settings_used), &settings, bounds);
    let ((pieces, steep), (all_blind, steep_blind)) = (measure(&settings), measure(&blind));
    // The lattice is coarser than the hills, and roads that leave a gate have little choice.
    assert!(pieces > 1000 && steep * 25 < pieces, "{steep} of {pieces}");
    assert!(steep_blind * 4 > all_blind, "roads that ignore slopes are steep: {steep_blind} of {all_blind}");
}

#[test]
fn wide_rivers_are_crossed_on_straight_bridges_of_their_own_level() {
    let mut bridges = 0;
    for seed in 41..44 {
        let roads = roads_over(seed, Countryside { flat: false, river: 110.0 }, &RoadSettings::default());
        let sections = all(&roads, Bounds::square(DVec2::ZERO, 12_000.0));
        assert_planar(&sections, Origin::at(DVec2::ZERO));
        let overpasses: Vec<StreetId> = overpass::overpasses(&sections).iter().map(|o| o.0.street.id).collect();
        for r in sections.iter().filter(|r| r.street.level != 0 && !overpasses.contains(&r.street.id)) {
            let line = &r.street.line;
            let (from, to) = (line[0], line[line.len() - 1]);
            assert!(line.iter().all(|p| crate::space::distance_to_segment(*p, from, to) < 0.1));
            let t = roads.searches.inputs.settings.class(r.street.class);
            let [low, high] = [from, to].map(|p| roads.searches.inputs.terrain.height(r.origin.to_plan(p)));
            assert!((low - high).abs() <= 1.01 * t.slope_limit * r.street.length());
            bridges += usize::from(r.street.bridge);
        }
    }
    assert!(bridges > 3, "{bridges}");
}

/// Length of the shortest way along sections from one of some junctions to a section of a class.
fn way_to(sections: &[Arc<RoadSection>], from: &[JunctionId], class: StreetClass) -> Option<f64> {
    let mut ways: BTreeMap<JunctionId, Vec<(&RoadSection, JunctionId)>> = BTreeMap::new();
    for r in sections {
        ways.entry(r.street.from).or_default().push((r, r.street.to));
        ways.entry(r.street.to).or_default().push((r, r.street.from));
    }
    let mut open: std::collections::BTreeSet<(u64, JunctionId)> = from.iter().map(|id| (0, *id)).collect();
    let mut done = std::collections::BTreeSet::new();
    while let Some((bits, at)) = open.pop_first() {
        if !done.insert(at) {
            continue;
        }
        for (road, to) in ways.get(&at).into_iter().flatten() {
            if road.street.class == class {
                return Some(f64::from_bits(bits));
            }
            open.insert(((f64::from_bits(bits) + road.street.length()).to_bits(), *to));
        }
    }
    None
}

#[test]
fn highways_pass_towns_at_a_distance_and_towns_join_them() {
    let (mut passed, mut joined) = (0, 0);
    for (seed, centre) in (200..206).map(random_place) {
        let roads = world(seed, 275.0);
        let window = Bounds::square(centre, 14_000.0);
        let sections = all(&roads, window.grown(6_000.0));
        for town in roads.searches.inputs.settlements.centred_in_of(window, SizeClass::Town).unwrap() {
            let outline = roads.searches.inputs.settlements.outline(&town).unwrap();
            let off = |r: &Arc<RoadSection>| {
                let shift = r.origin.offset_to(outline.origin);
                let ends =
                    segments(&r.street.line).map(|(a, b)| polygon_distance(a + shift, b + shift, &outline.polygon));
                ends.fold(f64::INFINITY, f64::min)
            };
            let highways = sections.iter().filter(|r| r.street.class == StreetClass::Highway);
            let nearest = highways.map(off).fold(f64::INFINITY, f64::min);
            if nearest > 2_000.0 {
                continue;
            }
            passed += 1;
            // Closer only where ground leaves no other way.
            assert!(nearest > 0.3 * roads.searches.inputs.settings.step as f64, "{} at {nearest}", town.name);
            let gates: Vec<JunctionId> =
                roads.gates(&town, &Cancel::new()).unwrap().iter().map(|g| g.junction).collect();
            joined += usize::from(way_to(&sections, &gates, StreetClass::Highway).is_some_and(|m| m < 6_000.0));
        }
    }
    assert!(passed > 5 && joined * 10 >= passed * 9, "{joined} of {passed}");
}

#[test]
fn a_town_on_a_plateau_gets_a_costlier_road() {
    let terrain = Arc::new(crate::terrain::NoiseTerrain::new(crate::space::Seed(224), &Default::default()));
    let towns =
        crate::region::Settlements::new(crate::space::Seed(224), &Default::default(), terrain.clone(), 32 << 20);
    let roads = Roads::new(&RoadSettings::default(), terrain, Arc::new(towns), 32 << 20);
    let here = Bounds::square(DVec2::new(13_134.0, 2_626.0), 10.0);
    let town = &roads.searches.inputs.settlements.centred_in(here, SizeClass::Town).unwrap()[0];
    let partners = |tier| roads.searches.partners.of(tier, town).unwrap();
    for (tier, other) in
        [SizeClass::Town, SizeClass::Village].into_iter().flat_map(|t| partners(t).into_iter().map(move |o| (t, o)))
    {
        let path = roads.searches.distances.coarse_path((tier, Way::Usual), town, &other, &Cancel::new()).unwrap();
        assert!(path.cost.is_infinite(), "{} has a usual way", other.name);
    }
    assert_eq!(roads.unreached(here, &Cancel::new()).unwrap(), []);
    let links = roads.links(here, &Cancel::new()).unwrap();
    assert!(links.len() == 1 && links[0].cost > links[0].length_m, "{links:?}");
}
