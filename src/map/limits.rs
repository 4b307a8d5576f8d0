//! How much of a map is read.

/// The most that is read of a map; beyond it, a reader refuses the file instead of filling the memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapLimits {
    /// Size of the file, in bytes.
    pub file_bytes: u64,
    /// Size of a compressed file once it is unpacked, in bytes.
    pub unpacked_bytes: u64,
    /// Streets and buildings.
    pub elements: u64,
    /// Points of streets and buildings.
    pub points: u64,
}

impl Default for MapLimits {
    /// Enough for a city of some million people: 512 MiB, 8 GiB unpacked, 2 million elements, 20 million points.
    fn default() -> Self {
        Self { file_bytes: 512 << 20, unpacked_bytes: 8 << 30, elements: 2_000_000, points: 20_000_000 }
    }
}
