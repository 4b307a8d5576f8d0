//! Coordinates, seeds and random streams, deterministic math, boxes, polylines, polygons and disjoint sets.
//!
//! Belongs to the ground floor: it knows no layer. Plan axes are x east and y north, in metres; angles are in radians,
//! counter-clockwise from east.

mod bounds;
mod clip;
mod coord;
mod disjoint_sets;
mod ears;
mod geographic;
mod geometry;
pub mod math;
mod overlay;
mod pole;
mod polyline;
mod seed;

pub use bounds::Bounds;
pub use clip::{ClippedPoint, clip_line};
pub use coord::{CHUNK_SIZE, ChunkCoord, Origin, QUANTUM, quantize, quantum_key};
pub use disjoint_sets::DisjointSets;
pub use ears::ears;
pub use geographic::Geographic;
pub use geometry::{
    SegmentCrossing, closest_on_segment, cross, distance_to_segment, left_normal, orient, segment_crossing,
    segment_distance,
};
pub use overlay::common_parts;
pub use pole::pole;
pub use polyline::{
    Measured, centroid, closest_on_line, cut_line, distance_to_line, is_simple, line_length, point_at,
    point_in_polygon, polygon_distance, resample, segments, signed_area, simplify_line,
};
pub use seed::{Seed, Stream, stable_hash};
