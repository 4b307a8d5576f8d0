//! The material of chunks: Bevy's standard material with textures that the program makes when the app starts.

use crate::texture::{Pixel, Texture, halved};
use bevy::asset::{RenderAssetUsages, embedded_asset};
use bevy::image::{ImageAddressMode, ImageFilterMode, ImageSampler, ImageSamplerDescriptor};
use bevy::pbr::{ExtendedMaterial, MaterialExtension};
use bevy::prelude::*;
use bevy::render::render_resource::{
    AsBindGroup, Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension,
};
use bevy::render::renderer::RenderAdapterInfo;
use bevy::shader::ShaderRef;
use bevy::tasks::futures_lite::future::yield_now;
use bevy::tasks::{AsyncComputeTaskPool, Task, block_on, poll_once};

/// The material of a part of a chunk. Its `base` is Bevy's, and its `extension` holds the textures. Colours come from the vertices.
pub type SprawlMaterial = ExtendedMaterial<StandardMaterial, SurfaceTextures>;

/// Pixels along the edge of a texture.
const PIXELS: usize = 512;

/// Most samples of a texture where one looks along it. In software they take several times as long as all else.
const ANISOTROPY: u16 = 8;

/// The textures of a [`SprawlMaterial`]: how light, how bent and how rough a surface is from close by. The alpha of a vertex names
/// the texture there.
#[derive(Asset, AsBindGroup, Reflect, Clone, Debug)]
pub struct SurfaceTextures {
    /// One layer for each texture; `None` shows plain colours.
    #[texture(100, dimension = "2d_array")]
    #[sampler(101)]
    pub layers: Option<Handle<Image>>,
    /// How much of the textures shows, 0 to 1.
    #[uniform(102)]
    pub strength: f32,
    /// Edges of the textures in metres.
    #[uniform(102)]
    sizes: [Vec4; 4],
}

impl SurfaceTextures {
    /// Shows the textures of an image, which has the layers of [`SprawlTextures`].
    pub fn new(layers: Handle<Image>) -> Self {
        let mut sizes = [Vec4::ONE; 4];
        for (i, texture) in Texture::ALL.into_iter().enumerate() {
            sizes[i / 4][i % 4] = texture.size();
        }
        Self { layers: Some(layers), strength: 1.0, sizes }
    }

    /// Shows plain colours. Parts whose vertices are transparent need this.
    pub fn none() -> Self {
        Self { layers: None, strength: 0.0, sizes: [Vec4::ONE; 4] }
    }
}

impl MaterialExtension for SurfaceTextures {
    fn fragment_shader() -> ShaderRef {
        shader()
    }

    fn deferred_fragment_shader() -> ShaderRef {
        shader()
    }
}

fn shader() -> ShaderRef {
    "embedded://bevy_sprawl/plugin/material.wgsl".into()
}

/// The image with the textures of all materials: an array with one layer for each texture. It is plain until the textures are made, a
/// moment after the app starts.
#[derive(Resource, Clone, Debug, Reflect)]
#[reflect(Resource, Debug, Clone)]
pub struct SprawlTextures(pub Handle<Image>);

/// The making of the image.
#[derive(Resource)]
struct Making(Task<Image>);

pub(super) struct SprawlMaterialPlugin;

impl Plugin for SprawlMaterialPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(SprawlTextures, SurfaceTextures)>();
        // Without a renderer there is nothing to draw.
        if !app.is_plugin_added::<bevy::pbr::PbrPlugin>() {
            return;
        }
        embedded_asset!(app, "material.wgsl");
        app.add_plugins(MaterialPlugin::<SprawlMaterial>::default())
            .add_systems(Update, give_textures.run_if(resource_exists::<Making>));
        let Some(mut images) = app.world_mut().get_resource_mut::<Assets<Image>>() else { return };
        let plain = images.add(image(1, Texture::ALL.map(|_| vec![[128; 4]]).to_vec()));
        let making = AsyncComputeTaskPool::get().spawn(textures());
        app.insert_resource(SprawlTextures(plain)).insert_resource(Making(making));
    }
}

/// Makes the textures. The first chunks are not kept waiting: after each texture it is their turn.
async fn textures() -> Image {
    let mut squares = Vec::new();
    for texture in Texture::ALL {
        squares.push(texture.make(PIXELS));
        yield_now().await;
    }
    image(PIXELS, squares)
}

/// An image with a layer for each of `squares`, each `pixels` a side, with all smaller pictures of them.
fn image(pixels: usize, squares: Vec<Vec<Pixel>>) -> Image {
    let (size, layers) = (pixels as u32, squares.len() as u32);
    let mut data = Vec::with_capacity(squares.len() * (pixels * pixels * 16 / 3 + 4));
    for mut square in squares {
        let mut edge = pixels;
        loop {
            data.extend_from_slice(square.as_flattened());
            if edge == 1 {
                break;
            }
            (square, edge) = (halved(&square, edge), edge / 2);
        }
    }
    let extent = Extent3d { width: size, height: size, depth_or_array_layers: layers };
    let mut image =
        Image::new_uninit(extent, TextureDimension::D2, TextureFormat::Rgba8Unorm, RenderAssetUsages::RENDER_WORLD);
    image.data = Some(data);
    image.texture_descriptor.mip_level_count = size.ilog2() + 1;
    image.texture_view_descriptor =
        Some(TextureViewDescriptor { dimension: Some(TextureViewDimension::D2Array), ..default() });
    image
}

/// Lets a texture repeat, with up to `anisotropy` samples where one looks along it.
fn sampler(anisotropy: u16) -> ImageSampler {
    ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: ImageAddressMode::Repeat,
        address_mode_v: ImageAddressMode::Repeat,
        mag_filter: ImageFilterMode::Linear,
        min_filter: ImageFilterMode::Linear,
        mipmap_filter: ImageFilterMode::Linear,
        anisotropy_clamp: anisotropy,
        ..default()
    })
}

/// Puts the finished textures in the place of the plain image.
fn give_textures(
    mut commands: Commands,
    mut making: ResMut<Making>,
    textures: Res<SprawlTextures>,
    mut images: ResMut<Assets<Image>>,
    mut materials: ResMut<Assets<SprawlMaterial>>,
    adapter: Option<Res<RenderAdapterInfo>>,
) {
    let Some(mut image) = block_on(poll_once(&mut making.0)) else { return };
    // The type itself belongs to `wgpu`, which is no dependency.
    let in_software = adapter.is_some_and(|adapter| format!("{:?}", adapter.device_type) == "Cpu");
    image.sampler = sampler(if in_software { 1 } else { ANISOTROPY });
    commands.remove_resource::<Making>();
    if images.insert(&textures.0, image).is_ok() {
        // A material takes up an image anew only when it changes itself, and all that this goes through count as changed.
        materials.iter_mut().for_each(drop);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shader_numbers_the_textures_as_the_list_does() {
        let shader = include_str!("material.wgsl");
        let says = |constant: String| assert!(shader.contains(&constant), "{constant}");
        says(format!("const LITTER: f32 = {}.0;", Texture::Litter as u8));
        for (name, texture) in [("ROCK", Texture::Rock), ("TILES", Texture::Tiles), ("MEADOW", Texture::Meadow)] {
            says(format!("const {name}: u32 = {}u;", texture as u8));
        }
        says(format!("array<vec4<f32>, {}>", Texture::ALL.len().div_ceil(4)));
    }
}
