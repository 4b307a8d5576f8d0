//! What a file says of roads. Whatever it leaves out stays as it is in the settings that the file is laid over.

use super::given::Given;
use super::settings::RoadSettings;
use super::tier_settings::TierOverrides;
use serde::{Deserialize, Deserializer};

/// Settings of roads as a file gives them: only what differs. [`RoadSettings`] are read as overrides of the default; those of
/// a finite domain are overrides of [`RoadSettings::finite`].
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields, rename = "RoadSettings")]
pub struct RoadOverrides {
    step: Given<i64>,
    merge: Given<f64>,
    highway: TierOverrides,
    major: TierOverrides,
    minor: TierOverrides,
}

impl RoadOverrides {
    /// Settings with what is given in their place. Ranges are not checked.
    pub fn over(&self, base: RoadSettings) -> RoadSettings {
        RoadSettings {
            step: self.step.or(base.step),
            merge: self.merge.or(base.merge),
            highway: self.highway.over(base.highway),
            major: self.major.over(base.major),
            minor: self.minor.over(base.minor),
        }
    }

    /// The spacing of the lattice in metres, if it is given.
    pub fn step(&self) -> Option<i64> {
        self.step.get()
    }
}

impl<'de> Deserialize<'de> for RoadSettings {
    /// Fields and classes that are left out keep their defaults, each class its own.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        RoadOverrides::deserialize(deserializer).map(|given| given.over(Self::default()))
    }
}

#[cfg(test)]
mod tests {
    use super::super::crossing::Crossing;
    use super::*;
    use crate::layer::from_ron;

    fn read(text: &str) -> RoadSettings {
        from_ron("roads.ron", text).expect("the text is right")
    }

    #[test]
    fn a_class_that_is_named_keeps_what_is_not() {
        let (read, mut expected) =
            (read("(highway: (reach: 26000), major: (), minor: (gamma: 3))"), RoadSettings::default());
        expected.minor.gamma = 3.0;
        assert_eq!(read, expected);
        let given: RoadOverrides = from_ron("roads.ron", "(step: 90, major: (over_highways: Junction))").unwrap();
        let (laid, mut expected) = (given.over(RoadSettings::finite(400)), RoadSettings::finite(400));
        (expected.step, expected.major.highway_crossings) = (90, Crossing::Junction);
        assert_eq!((laid, given.step()), (expected, Some(90)));
    }

    #[test]
    fn all_settings_are_read_back() {
        let mut settings = RoadSettings::finite(77);
        for tier in [&mut settings.highway, &mut settings.major, &mut settings.minor] {
            (tier.reach, tier.earthwork) = (1e4, 9.0);
        }
        settings.major.coarse_step = 7;
        assert_eq!(read(&ron::to_string(&settings).unwrap()), settings);
        let old = "(minor: (wide_step: 3, beside: 2, rough: 0.5, over_highways: Interchange))";
        let minor = read(old).minor;
        let crossings = minor.highway_crossings;
        assert_eq!((minor.coarse_step, minor.beside_roads, minor.roughness), (3, 2.0, 0.5));
        assert_eq!(crossings, Crossing::Interchange);
    }

    #[test]
    fn errors_have_line_and_column() {
        for (text, place, reason) in [
            ("(\n highway: (\n  reach: \"far\"),\n)", "roads.ron:3:", "float"),
            ("(\n highway: (\n  rech: 3),\n)", "roads.ron:3:", "`rech`"),
            ("(minor: (highway_crossings: Ferry))", "roads.ron:1:", "`Ferry`"),
            ("(minor: 3)", "roads.ron:1:", "TierSettings"),
        ] {
            let error = from_ron::<RoadSettings>("roads.ron", text).unwrap_err().to_string();
            assert!(error.starts_with(place) && error.contains(reason), "{text}: {error}");
        }
    }
}
