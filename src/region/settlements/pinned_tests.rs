//! Tests of settlements that are pinned, moved and banned, on the default terrain.

use super::*;
use crate::region::settlement::spacing::{conflict, conflict_distance};
use crate::space::signed_area;
use crate::terrain::{NoiseTerrain, TerrainSettings};

fn settlements(seed: u64, edits: &[SettlementEdit]) -> Settlements {
    let terrain = Arc::new(NoiseTerrain::new(Seed(seed), &TerrainSettings::default()));
    let settings = SettlementSettings::default();
    Settlements::with_edits(Seed(seed), &settings, terrain, edits, |s| s != "roman", 16 << 20)
}

fn pin(at: DVec2, size: SizeClass) -> SettlementEdit {
    SettlementEdit::Pin { at, size, name: None, style: None, radius: None }
}

const BOX: f64 = 22_000.0;

fn all(s: &Settlements, middle: DVec2) -> Vec<Arc<Settlement>> {
    s.centred_in(Bounds::square(middle, BOX)).unwrap()
}

#[test]
fn pins_stand_where_they_fit_and_change_only_what_is_too_near() {
    let (mut stood, mut gave_way) = (0, 0);
    for seed in 0..12 {
        let middle = DVec2::new(seed as f64 * 4e6, -7e5);
        let mut stream = Seed(seed).stream("test", &[]);
        let at = (middle + DVec2::new(stream.signed(), stream.signed()) * 3_000.0).round();
        let size = SizeClass::ALL[stream.index(3)];
        let (plain, edited) = (settlements(seed, &[]), settlements(seed, &[pin(at, size)]));
        let (before, after) = (all(&plain, middle), all(&edited, middle));
        if let [rejected] = edited.rejected_edits() {
            assert!(rejected.index == 0 && before == after, "{rejected}");
            continue;
        }
        stood += 1;
        let pinned = after.iter().find(|s| s.centre.plan() == at).unwrap();
        assert_eq!(edited.at(at).unwrap().as_ref(), Some(pinned));
        assert_eq!(edited.centred_in_of(Bounds::square(at, 2.0), size).unwrap(), std::slice::from_ref(pinned));
        assert!(edited.overlapping(Bounds::square(at + pinned.radius * 0.5, 2.0)).unwrap().contains(pinned));
        let outline = edited.outline(pinned).unwrap();
        assert!(outline.polygon.len() >= 6 && signed_area(&outline.polygon) > 0.0);
        assert!(outline.polygon.iter().all(|p| (60.0..=pinned.radius).contains(&p.length())));
        // All others are as they were, or gone because they are too near.
        let reach = conflict_distance(&edited.lattices.settings, pinned.radius, edited.largest_radius());
        for s in &before {
            let apart = s.centre.offset_to(pinned.centre).length();
            let conflict = conflict(&edited.lattices.settings, pinned, s.centre, s.radius);
            assert_eq!(after.contains(s), !conflict, "{}", s.name);
            assert!(!conflict || apart < reach);
            gave_way += usize::from(conflict);
            if apart > 2.0 * reach {
                assert_eq!(plain.outline(s).unwrap(), edited.outline(s).unwrap());
            }
        }
        let gone = before.iter().filter(|s| !after.contains(s)).count();
        assert_eq!(before.len() - gone + 1, after.len());
    }
    assert!(stood >= 5 && gave_way > 0, "{stood} {gave_way}");
}

#[test]
fn a_moved_settlement_stays_itself_and_a_banned_one_is_gone() {
    let (mut moved, mut refused) = (0, 0);
    for seed in 20..32 {
        let middle = DVec2::new(-2e6, seed as f64 * 3e6);
        let before = all(&settlements(seed, &[]), middle);
        let Some(s) = before.iter().find(|s| s.centre.plan().distance(middle) < 6_000.0) else { continue };
        let (from, to) = (s.centre.plan() + s.radius * 0.5, s.centre.plan() + DVec2::new(90.0, -130.0));
        let edited = settlements(seed, &[SettlementEdit::Move { from, to }]);
        let after = all(&edited, middle);
        if edited.rejected_edits().is_empty() {
            let there = after.iter().find(|o| o.id == s.id).unwrap();
            assert_eq!(there.centre.plan(), to);
            assert_eq!((&there.name, &there.style, there.radius), (&s.name, &s.style, s.radius));
            moved += 1;
        } else {
            assert_eq!(before, after);
            refused += 1;
        }
        let (at, radius) = (s.centre.plan() + 40.0, 60.0);
        let ban = SettlementEdit::Ban { at, radius };
        let mut expected = before.clone();
        expected.retain(|o| o.centre.plan().distance(at) > radius);
        assert!(expected.len() < before.len());
        assert_eq!(all(&settlements(seed, std::slice::from_ref(&ban)), middle), expected);
        // A pin may stand where the ban is.
        let pinned = settlements(seed, &[ban, pin(s.centre.plan(), s.size)]);
        let stands = all(&pinned, middle).iter().any(|o| o.centre == s.centre && o.id != s.id);
        assert_eq!(stands, pinned.rejected_edits().is_empty());
        // What is banned cannot be moved.
        let both = settlements(
            seed,
            &[SettlementEdit::Move { from: s.centre.plan(), to }, SettlementEdit::Ban { at, radius }],
        );
        assert_eq!(both.rejected_edits().len(), 1);
    }
    assert!(moved > 4, "{moved} {refused}");
}

#[test]
fn what_cannot_be_says_why() {
    let plain = settlements(5, &[]);
    let s = all(&plain, DVec2::ZERO);
    let place = s[0].centre.plan();
    let terrain = NoiseTerrain::new(Seed(5), &TerrainSettings::default());
    let sea = (0..).map(|i| DVec2::new(f64::from(i) * 500.0, 77.0)).find(|p| terrain.sample(*p).depth() > 0.0).unwrap();
    let roman =
        SettlementEdit::Pin { at: place, size: SizeClass::Town, name: None, style: Some("roman".into()), radius: None };
    let edits = [
        pin(sea, SizeClass::Village),
        roman,
        pin(place, SizeClass::Village),
        pin(place + 300.0, SizeClass::Village),
        SettlementEdit::Move { from: sea, to: place },
    ];
    let edited = settlements(5, &edits);
    let reasons: Vec<String> = edited.rejected_edits().iter().map(ToString::to_string).collect();
    let expected = [
        "settlements[0]: ",
        "settlements[1]: style `roman` is not among the styles",
        "settlements[3]: too near the settlement of settlements[2]",
        "settlements[4]: there is no settlement to move at ",
    ];
    assert_eq!(reasons.len(), expected.len(), "{reasons:?}");
    assert!(reasons.iter().zip(expected).all(|(r, e)| r.starts_with(e)), "{reasons:?}");
    assert!(reasons[0].contains("lies in water"), "{}", reasons[0]);
}
