//! Layer 1: the ground. Makes height, water and vegetation at any point of the plan. Reads only the seed; its padding is 0.
//!
//! [`NoiseTerrain`] is the default and endless. [`RasterTerrain`] is a finite piece of ground from files: ESRI ASCII grids and,
//! with the feature `cli`, GeoTIFF and PNG pictures. A game can bring its own ground by implementing the trait [`Terrain`]:
//!
//! ```
//! use bevy_sprawl::{space::Seed, terrain::{Terrain, TerrainSample}, world::{TerrainSource, World, WorldSource}};
//! use glam::DVec2;
//!
//! /// A plain with a sea in the south and a smooth rise to 60 m in the north.
//! struct Coast;
//!
//! impl Terrain for Coast {
//!     fn sample(&self, p: DVec2) -> TerrainSample {
//!         let t = p.y / 5000.0;
//!         let height = 30.0 + 30.0 * t / (1.0 + t * t).sqrt();
//!         TerrainSample { height, water_level: 2.0, vegetation: 0.3 }
//!     }
//! }
//!
//! let world = World::new(WorldSource { terrain: TerrainSource::own(Coast), ..WorldSource::new(Seed(7)) })?;
//! assert!(world.natural_height(DVec2::new(0.0, 20_000.0)) > world.natural_height(DVec2::ZERO));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod contract;
mod drawn;
mod field;
mod ground;
mod lake;
mod noise;
#[cfg(feature = "noise")]
mod noise_fn;
mod raster;
mod river;
mod settings;

pub use self::contract::{Scan, Terrain, TerrainSample};
pub(crate) use self::drawn::height_in_square;
pub use self::drawn::{DrawnGround, GROUND_STEP, GroundTiles};
pub use self::noise::NoiseTerrain;
#[cfg(feature = "noise")]
pub use self::noise_fn::{NoiseFnSettings, NoiseFnTerrain};
pub use self::raster::{Band, Disagreement, Holes, JoinError, MOST_CELLS, Raster, RasterTerrain};
#[cfg(feature = "cli")]
pub use self::raster::{GeoUnits, PngPlace};
pub use self::settings::TerrainSettings;
