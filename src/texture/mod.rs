//! Textures of ground, streets and walls, made by the program.
//!
//! Belongs to the ground floor: it knows no layer. A texture is a square that repeats without a seam. It holds no colour: vertices
//! give the colour, and the texture says how much lighter or darker, how bent and how rough the surface is from pixel to pixel.

mod kind;
mod make;
mod noise;
mod recipe;

pub use kind::Texture;
pub use make::{Pixel, halved};
