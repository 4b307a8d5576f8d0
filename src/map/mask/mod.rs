//! Road masks: pictures with roads and buildings in a colour each, as Paduraru 2022 (section 3) makes them of aerial images.
//!
//! Roads are thinned to lines of one pixel (`skeletonize`). The paper's circle tells intersections, ends and turning points apart, and
//! lines of pixels between them become streets, whose widths are measured in the picture. Buildings become the polygons around
//! their pixels. The first row of the picture is the northernmost.

mod circle;
mod lines;
mod options;
mod outlines;
mod picture;
mod read;
#[cfg(test)]
mod tests;

pub use options::MaskOptions;
pub(super) use read::read;
