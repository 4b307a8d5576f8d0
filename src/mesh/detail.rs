//! Levels of detail.

/// Level of detail.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Detail {
    /// Everything.
    Full,
    /// For the distance: coarse ground where no street is near, streets without kerbs and paint, and buildings as boxes. Its border
    /// is that of full detail, so that it meets any other detail without a crack.
    Reduced,
}
