//! Making the pictures of textures.

use super::kind::Texture;
use super::recipe::Grain;
use glam::Vec2;

/// A pixel of a texture, one byte for each of:
/// - how light the surface is: 0 black, 128 the colour of the vertex, 255 twice as light,
/// - the normal to the right and upwards in the picture: 0 for -1, 128 for 0, 255 for 1,
/// - the roughness: 128 for that of the material, 0 for 0.5 less and 255 for 0.5 more.
pub type Pixel = [u8; 4];

impl Texture {
    /// Makes the square, `pixels` a side, row by row from the top. `pixels` is at least 1.
    pub fn make(self, pixels: usize) -> Vec<Pixel> {
        let metres = self.size() / pixels as f32;
        let grains: Vec<Grain> = (0..pixels * pixels)
            .map(|i| self.grain((Vec2::new((i % pixels) as f32, (i / pixels) as f32) + 0.5) / pixels as f32))
            .collect();
        let height = |x: usize, y: usize| grains[y % pixels * pixels + x % pixels].height;
        let byte = |x: f32| (x * 127.0 + 128.5).clamp(0.0, 255.0) as u8;
        let pixel = |i: usize| {
            let (x, y) = (i % pixels + pixels, i / pixels + pixels);
            let right = (height(x + 1, y) - height(x - 1, y)) / (2.0 * metres);
            // Rows run down the picture.
            let up = (height(x, y - 1) - height(x, y + 1)) / (2.0 * metres);
            let long = (1.0 + right * right + up * up).sqrt();
            let grain = &grains[i];
            [byte(grain.shade - 1.0), byte(-right / long), byte(-up / long), byte(2.0 * grain.rough)]
        };
        (0..pixels * pixels).map(pixel).collect()
    }
}

/// The next smaller picture of a square of `pixels` a side, an even number: each of its pixels is the mean of four.
pub fn halved(square: &[Pixel], pixels: usize) -> Vec<Pixel> {
    let half = pixels / 2;
    let mean = |i: usize| {
        let corner = i / half * 2 * pixels + i % half * 2;
        let four = [corner, corner + 1, corner + pixels, corner + pixels + 1].map(|k| square[k]);
        [0, 1, 2, 3].map(|c| ((four.iter().map(|p| u32::from(p[c])).sum::<u32>() + 2) / 4) as u8)
    };
    (0..half * half).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PIXELS: usize = 128;

    #[test]
    fn textures_repeat_without_a_seam_and_keep_the_colour_of_vertices() {
        for texture in Texture::ALL {
            let square = texture.make(PIXELS);
            let light = |x: usize, y: usize| f64::from(square[y * PIXELS + x][0]);
            let mean = square.iter().map(|p| f64::from(p[0])).sum::<f64>() / (PIXELS * PIXELS) as f64;
            assert!((108.0..148.0).contains(&mean), "{texture:?} is {mean} on average");
            // Across the seam neighbours differ as much as anywhere.
            let step = |x: usize| (0..PIXELS).map(|y| (light(x, y) - light((x + 1) % PIXELS, y)).abs()).sum::<f64>();
            let inside: f64 = (0..PIXELS - 1).map(step).fold(0.0, f64::max);
            assert!(step(PIXELS - 1) <= inside * 1.05 + 1.0, "{texture:?}: {} over {inside}", step(PIXELS - 1));
            assert!(square.iter().any(|p| p[0] != square[0][0]), "{texture:?} is plain");
        }
    }

    #[test]
    fn every_texture_has_its_own_opacity() {
        for (i, texture) in Texture::ALL.into_iter().enumerate() {
            // As it comes back from the two bytes of a vertex.
            let stored = (texture.alpha() * 65535.0 + 0.5) as u16;
            assert_eq!((i, stored % 257), (usize::from(stored / 257), 0), "{texture:?}");
        }
    }

    #[test]
    fn a_smaller_picture_is_the_mean_of_a_larger_one() {
        let square = [[0, 0, 0, 0], [4, 8, 100, 255], [8, 0, 100, 255], [4, 0, 100, 255]];
        assert_eq!(halved(&square, 2), [[4, 2, 75, 191]]);
    }
}
