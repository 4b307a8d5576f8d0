//! Meshes and materials of chunks.
//!
//! Everything that differs between the parts of a chunk stands here, in the methods of [`ChunkPart`].

use crate::mesh::{ChunkMesh, MeshBuffers};
use bevy::asset::RenderAssetUsages;
use bevy::camera::primitives::Aabb;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use std::ops::{Index, IndexMut};

/// What a child of a chunk's entity shows.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Reflect)]
#[reflect(Component, Debug, PartialEq, Hash, Clone)]
pub enum ChunkPart {
    /// The ground.
    Ground,
    /// The surface of the sea, lakes and rivers.
    Water,
    /// Streets and junctions.
    Roads,
    /// Buildings.
    Buildings,
    /// Windows and doors.
    Windows,
}

impl ChunkPart {
    /// All parts, in the order of their values.
    pub const ALL: [Self; 5] = [Self::Ground, Self::Water, Self::Roads, Self::Buildings, Self::Windows];

    /// Takes the buffers of this part out of a mesh.
    fn take_buffers(self, mesh: &mut ChunkMesh) -> MeshBuffers {
        std::mem::take(match self {
            Self::Ground => &mut mesh.ground,
            Self::Water => &mut mesh.water,
            Self::Roads => &mut mesh.roads,
            Self::Buildings => &mut mesh.buildings,
            Self::Windows => &mut mesh.windows,
        })
    }

    /// The material of this part unless a game gives another. Colours come from the vertices.
    fn default_material(self) -> StandardMaterial {
        let (perceptual_roughness, reflectance) = match self {
            Self::Ground => (1.0, 0.1),
            Self::Water => (0.12, 0.5),
            Self::Roads => (0.9, 0.2),
            Self::Buildings => (0.85, 0.3),
            Self::Windows => (0.15, 0.6),
        };
        let alpha_mode = if self == Self::Water { AlphaMode::Blend } else { AlphaMode::Opaque };
        StandardMaterial { perceptual_roughness, reflectance, alpha_mode, ..default() }
    }
}

/// The materials that all chunks share, one for each [`ChunkPart`]. Colours come from the vertices.
///
/// A game may change a material at any time, or replace a handle before the first chunk is loaded:
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_sprawl::prelude::*;
///
/// fn brick(mut of_parts: ResMut<SprawlMaterials>, mut materials: ResMut<Assets<StandardMaterial>>) {
///     of_parts[ChunkPart::Buildings] = materials.add(Color::srgb(0.6, 0.3, 0.2));
/// }
/// ```
#[derive(Resource, Clone, Debug, Reflect)]
#[reflect(Resource, Debug, Clone)]
pub struct SprawlMaterials([Handle<StandardMaterial>; ChunkPart::ALL.len()]);

impl SprawlMaterials {
    /// Materials that `of` gives for each part.
    pub fn new(of: impl FnMut(ChunkPart) -> Handle<StandardMaterial>) -> Self {
        Self(ChunkPart::ALL.map(of))
    }
}

impl Index<ChunkPart> for SprawlMaterials {
    type Output = Handle<StandardMaterial>;

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

/// The meshes of a chunk that are not empty. With `keep`, their vertices stay in main memory when they go to the GPU.
pub(super) fn part_meshes(mut chunk: ChunkMesh, keep: bool) -> Vec<PartMesh> {
    let parts = ChunkPart::ALL.into_iter().map(|part| (part, part.take_buffers(&mut chunk)));
    parts
        .filter(|(_, buffers)| !buffers.indices.is_empty())
        .map(|(part, buffers)| {
            let bounds = bounds(&buffers);
            PartMesh { part, mesh: to_mesh(buffers, keep), bounds }
        })
        .collect()
}

fn to_mesh(buffers: MeshBuffers, keep: bool) -> Mesh {
    let usage = if keep { RenderAssetUsages::default() } else { RenderAssetUsages::RENDER_WORLD };
    Mesh::new(PrimitiveTopology::TriangleList, usage)
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, buffers.positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, buffers.normals)
        .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, buffers.colours)
        .with_inserted_indices(Indices::U32(buffers.indices))
}

/// The box around a mesh. It is measured here, in the task, so that Bevy need not do it on the main thread.
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
        app.register_type::<(ChunkPart, SprawlMaterials)>().add_systems(PreStartup, make_materials);
    }
}

/// Without a renderer there are no materials.
fn make_materials(
    mut commands: Commands,
    given: Option<Res<SprawlMaterials>>,
    materials: Option<ResMut<Assets<StandardMaterial>>>,
) {
    let (None, Some(mut materials)) = (given, materials) else { return };
    commands.insert_resource(SprawlMaterials::new(|part| materials.add(part.default_material())));
}
