//! Meshes and materials of chunks.

use super::material::{SprawlMaterial, SprawlTextures, SurfaceTextures};
use crate::mesh::{ChunkMesh, MeshBuffers, PartMaterial};
use bevy::asset::RenderAssetUsages;
use bevy::camera::primitives::Aabb;
use bevy::ecs::component::{Mutable, StorageType};
use bevy::mesh::{Indices, MeshVertexAttribute, PrimitiveTopology, VertexAttributeValues, VertexFormat};
use bevy::prelude::*;
use std::ops::{Index, IndexMut};

pub use crate::mesh::ChunkPart;

/// Each child of the entity of a chunk, or of a tile of the horizon, that shows a mesh has this component.
impl Component for ChunkPart {
    const STORAGE_TYPE: StorageType = StorageType::Table;
    type Mutability = Mutable;
}

/// The material of a part, unless a game gives another one. Colours come from the vertices.
fn default_material(part: ChunkPart, textures: Option<&SprawlTextures>) -> SprawlMaterial {
    let PartMaterial { roughness, reflectance, transparent, textured, .. } = part.material();
    let alpha_mode = if transparent { AlphaMode::Blend } else { AlphaMode::Opaque };
    let extension = match textures.filter(|_| textured) {
        Some(textures) => SurfaceTextures::new(textures.0.clone()),
        None => SurfaceTextures::none(),
    };
    let base = StandardMaterial { perceptual_roughness: roughness, reflectance, alpha_mode, ..default() };
    SprawlMaterial { base, extension }
}

/// The materials that all chunks and tiles share, one for each [`ChunkPart`]. Colours come from the vertices, and textures from the
/// program.
///
/// A game may change a material at any time, or replace a handle before the first chunk is loaded. Images of a game's own need
/// [`StreamSettings::texture_coordinates`](crate::plugin::StreamSettings::texture_coordinates).
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_sprawl::prelude::*;
///
/// fn evening(parts: Res<SprawlMaterials>, mut materials: ResMut<Assets<SprawlMaterial>>) {
///     if let Some(mut windows) = materials.get_mut(&parts[ChunkPart::Windows]) {
///         windows.base.emissive = LinearRgba::rgb(0.9, 0.7, 0.3);
///     }
/// }
///
/// fn plain(parts: Res<SprawlMaterials>, mut materials: ResMut<Assets<SprawlMaterial>>) {
///     for part in ChunkPart::ALL {
///         if let Some(mut material) = materials.get_mut(&parts[part]) {
///             material.extension = SurfaceTextures::none();
///         }
///     }
/// }
/// ```
#[derive(Resource, Clone, Debug, Reflect)]
#[reflect(Resource, Debug, Clone)]
pub struct SprawlMaterials([Handle<SprawlMaterial>; ChunkPart::ALL.len()]);

impl SprawlMaterials {
    /// The materials that `material` gives for the parts.
    pub fn new(material: impl FnMut(ChunkPart) -> Handle<SprawlMaterial>) -> Self {
        Self(ChunkPart::ALL.map(material))
    }
}

impl Index<ChunkPart> for SprawlMaterials {
    type Output = Handle<SprawlMaterial>;

    fn index(&self, part: ChunkPart) -> &Self::Output {
        &self.0[part as usize]
    }
}

impl IndexMut<ChunkPart> for SprawlMaterials {
    fn index_mut(&mut self, part: ChunkPart) -> &mut Self::Output {
        &mut self.0[part as usize]
    }
}

/// A mesh of a chunk, made in a task. It is never empty.
pub(super) struct PartMesh {
    pub part: ChunkPart,
    pub mesh: Mesh,
    pub bounds: Aabb,
}

/// The meshes of a chunk that are not empty. With `keep`, their vertices stay in main memory when they go to the GPU; with
/// `textured`, they have texture coordinates.
pub(super) fn part_meshes(chunk: ChunkMesh, keep: bool, textured: bool) -> Vec<PartMesh> {
    chunk
        .into_parts()
        .filter(|(_, buffers)| !buffers.indices.is_empty())
        .map(|(part, buffers)| {
            let bounds = bounds(&buffers);
            PartMesh { part, mesh: to_mesh(buffers, keep, textured), bounds }
        })
        .collect()
}

/// Normals of four bytes. Bevy matches attributes by their ids and takes their formats as they are.
const NORMAL: MeshVertexAttribute = MeshVertexAttribute { format: VertexFormat::Snorm8x4, ..Mesh::ATTRIBUTE_NORMAL };

/// Colours of eight bytes. Their alpha names textures.
const COLOUR: MeshVertexAttribute = MeshVertexAttribute { format: VertexFormat::Unorm16x4, ..Mesh::ATTRIBUTE_COLOR };

fn to_mesh(buffers: MeshBuffers, keep: bool, textured: bool) -> Mesh {
    let usage = if keep { RenderAssetUsages::default() } else { RenderAssetUsages::RENDER_WORLD };
    let mut mesh = Mesh::new(PrimitiveTopology::TriangleList, usage);
    if textured {
        mesh.insert_attribute(Mesh::ATTRIBUTE_UV_0, buffers.texture_coordinates());
    }
    mesh.with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, buffers.positions)
        .with_inserted_attribute(NORMAL, VertexAttributeValues::Snorm8x4(buffers.normals))
        .with_inserted_attribute(COLOUR, VertexAttributeValues::Unorm16x4(buffers.colours))
        .with_inserted_indices(Indices::U32(buffers.indices))
}

/// The box around a mesh. It is computed in the task, so that Bevy need not compute it on the main thread.
fn bounds(buffers: &MeshBuffers) -> Aabb {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for p in &buffers.positions {
        low = low.min(Vec3::from(*p));
        high = high.max(Vec3::from(*p));
    }
    Aabb::from_min_max(low, high)
}

pub(super) struct AppearancePlugin;

impl Plugin for AppearancePlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(ChunkPart, SprawlMaterials)>()
            .register_type_data::<ChunkPart, ReflectComponent>()
            .add_systems(PreStartup, make_materials);
    }
}

/// Makes the default materials, unless a game has given others. Without a renderer there are none.
fn make_materials(
    mut commands: Commands,
    given: Option<Res<SprawlMaterials>>,
    materials: Option<ResMut<Assets<SprawlMaterial>>>,
    textures: Option<Res<SprawlTextures>>,
) {
    let (None, Some(mut materials)) = (given, materials) else { return };
    let material = |part| materials.add(default_material(part, textures.as_deref()));
    commands.insert_resource(SprawlMaterials::new(material));
}
