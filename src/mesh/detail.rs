//! Levels of detail.

/// Level of detail.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Detail {
    /// Everything.
    Full,
    /// For the distance: coarse ground (whole along its border, so that it meets the ground of any other detail without a
    /// crack), streets as flat ribbons, buildings as boxes.
    Reduced,
}
