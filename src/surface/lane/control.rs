//! Who goes first at a junction.

use crate::network::StreetClass;
use crate::space::math::angle_between;
use glam::DVec2;
use std::f64::consts::PI;

/// What the traffic of a street must do where it enters a junction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// Go on: others wait, or there are none.
    Priority,
    /// Wait for traffic from the side on which one drives: the streets are alike.
    Equal,
    /// Wait for the traffic of streets with priority.
    GiveWay,
    /// Stop, then wait for the traffic of streets with priority.
    Stop,
    /// Wait for a green light.
    Signals,
}

impl Control {
    /// Lower-case name, as in exported files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Priority => "priority",
            Self::Equal => "equal",
            Self::GiveWay => "give way",
            Self::Stop => "stop",
            Self::Signals => "signals",
        }
    }
}

/// The end of a street at a junction, as far as it matters for who goes first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Approach {
    pub class: StreetClass,
    /// Unit direction away from the junction.
    pub out: DVec2,
    /// Whether the street is part of the ring of a roundabout.
    pub ring: bool,
}

/// Greatest bend in radians of a road that has priority where it goes straight on through a junction.
const STRAIGHT_ON: f64 = 0.6;

/// The control of each approach of a junction:
/// - Where the ring of a roundabout passes, traffic on the ring goes first.
/// - Four or more main streets with an arterial among them have signals.
/// - Streets of the best class go first. If these are more than two, the two of them that go straight on do. If no two do, or
///   if all streets are local, the streets are alike.
/// - Others give way, or stop where they cross a street of their own class.
pub(super) fn controls(approaches: &[Approach]) -> Vec<Control> {
    let n = approaches.len();
    if n < 3 {
        return vec![Control::Priority; n];
    }
    if approaches.iter().any(|a| a.ring) {
        return approaches.iter().map(|a| if a.ring { Control::Priority } else { Control::GiveWay }).collect();
    }
    let mains = approaches.iter().filter(|a| a.class.is_main()).count();
    if mains >= 4 && approaches.iter().any(|a| a.class == StreetClass::Arterial) {
        return vec![Control::Signals; n];
    }
    // Classes are in order, the best first; ramps wait for all roads.
    let rank = |a: &Approach| (a.class == StreetClass::Ramp, a.class);
    let best = approaches.iter().map(rank).min();
    let first: Vec<usize> = (0..n).filter(|i| Some(rank(&approaches[*i])) == best).collect();
    if first.len() <= 2 {
        return (0..n).map(|i| if first.contains(&i) { Control::Priority } else { Control::GiveWay }).collect();
    }
    let pairs = first.iter().flat_map(|i| first.iter().filter(move |k| *k < i).map(move |k| (*k, *i)));
    let bend = |&(i, k): &(usize, usize)| PI - angle_between(approaches[i].out, approaches[k].out);
    let through = pairs.min_by(|a, b| bend(a).total_cmp(&bend(b))).filter(|pair| bend(pair) < STRAIGHT_ON);
    let alike = first.len() == n && approaches[0].class == StreetClass::Local;
    let Some((i, k)) = through.filter(|_| !alike) else {
        return (0..n).map(|i| if first.contains(&i) { Control::Equal } else { Control::GiveWay }).collect();
    };
    let of = |x: usize| match first.contains(&x) {
        _ if x == i || x == k => Control::Priority,
        true if first.len() > 3 => Control::Stop,
        _ => Control::GiveWay,
    };
    (0..n).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::math::direction;

    fn of(arms: &[(StreetClass, f64)]) -> Vec<Control> {
        let approach = |&(class, degrees): &(StreetClass, f64)| Approach {
            class,
            out: direction(degrees.to_radians()),
            ring: false,
        };
        controls(&arms.iter().map(approach).collect::<Vec<_>>())
    }

    #[test]
    fn the_better_street_goes_first() {
        use Control::{Equal, GiveWay, Priority, Signals, Stop};
        use StreetClass::{Arterial, Highway, Local, Main, Ramp};
        assert_eq!(of(&[(Local, 0.0), (Main, 90.0)]), [Priority; 2]);
        assert_eq!(of(&[(Main, 0.0), (Local, 90.0), (Main, 180.0)]), [Priority, GiveWay, Priority]);
        assert_eq!(of(&[(Local, 0.0), (Local, 90.0), (Local, 180.0)]), [Equal; 3]);
        assert_eq!(of(&[(Main, 0.0), (Main, 90.0), (Main, 180.0)]), [Priority, GiveWay, Priority]);
        assert_eq!(of(&[(Main, 0.0), (Main, 90.0), (Main, 181.0), (Main, 260.0)]), [Priority, Stop, Priority, Stop]);
        assert_eq!(of(&[(Main, 0.0), (Main, 120.0), (Main, 240.0)]), [Equal; 3]);
        assert_eq!(of(&[(Main, 0.0), (Arterial, 90.0), (Main, 180.0), (Arterial, 270.0)]), [Signals; 4]);
        assert_eq!(of(&[(Highway, 0.0), (Ramp, 20.0), (Highway, 180.0)]), [Priority, GiveWay, Priority]);
        assert_eq!(of(&[(Local, 0.0), (Ramp, 90.0), (Local, 180.0)]), [Priority, GiveWay, Priority]);
    }
}
