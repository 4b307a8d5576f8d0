//! Levels of detail.

/// Level of detail.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Detail {
    /// Everything.
    Full,
    /// For the distance: coarse ground, streets as flat ribbons and buildings as boxes. The ground is fine along its border, so
    /// that it meets the ground of any other detail without a crack.
    Reduced,
}
