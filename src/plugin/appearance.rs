//! Meshes and materials of chunks.

use super::streaming::Streaming;
use crate::mesh::{ChunkMesh, MeshBuffers};
use bevy::asset::RenderAssetUsages;
use bevy::camera::primitives::Aabb;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;

/// What a child of a chunk's entity shows.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Reflect)]
#[reflect(Component, Debug, PartialEq, Hash, Clone)]
pub enum ChunkPart {
    /// The ground.
    Ground,
    /// Surface of sea, lakes and rivers.
    Water,
    /// Streets and junctions.
    Roads,
    /// Buildings.
    Buildings,
    /// Windows and doors.
    Windows,
}

/// The materials that all chunks share. Colours come from the vertices. Replace a handle before the first chunk is
/// there, or change the material behind it at any time.
#[derive(Resource, Clone, Debug, Reflect)]
#[reflect(Resource, Debug, Clone)]
pub struct SprawlMaterials {
    /// Of the ground.
    pub ground: Handle<StandardMaterial>,
    /// Of water; transparent.
    pub water: Handle<StandardMaterial>,
    /// Of streets and junctions.
    pub roads: Handle<StandardMaterial>,
    /// Of buildings.
    pub buildings: Handle<StandardMaterial>,
    /// Of windows and doors; glossy.
    pub windows: Handle<StandardMaterial>,
}

impl SprawlMaterials {
    /// The material of a part.
    pub fn of(&self, part: ChunkPart) -> &Handle<StandardMaterial> {
        match part {
            ChunkPart::Ground => &self.ground,
            ChunkPart::Water => &self.water,
            ChunkPart::Roads => &self.roads,
            ChunkPart::Buildings => &self.buildings,
            ChunkPart::Windows => &self.windows,
        }
    }
}

/// A mesh of a chunk, made in a task. Never empty.
pub(super) struct PartMesh {
    pub part: ChunkPart,
    pub mesh: Mesh,
    pub bounds: Aabb,
}

/// The meshes of a chunk that are not empty. `keep` leaves their data in the main world when they go to the GPU.
pub(super) fn part_meshes(chunk: ChunkMesh, keep: bool) -> Vec<PartMesh> {
    let ChunkMesh { ground, water, roads, buildings, windows } = chunk;
    [
        (ChunkPart::Ground, ground),
        (ChunkPart::Water, water),
        (ChunkPart::Roads, roads),
        (ChunkPart::Buildings, buildings),
        (ChunkPart::Windows, windows),
    ]
    .into_iter()
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

/// Measured here, in the task, so that Bevy need not do it on the main thread.
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
    mut streaming: ResMut<Streaming>,
    meshes: Option<Res<Assets<Mesh>>>,
) {
    streaming.with_meshes = meshes.is_some();
    let (None, Some(mut materials)) = (given, materials) else { return };
    let mut rough = |perceptual_roughness, reflectance| {
        materials.add(StandardMaterial { perceptual_roughness, reflectance, ..default() })
    };
    let (ground, roads, buildings) = (rough(1.0, 0.1), rough(0.9, 0.2), rough(0.85, 0.3));
    let windows = rough(0.15, 0.6);
    let water = materials.add(StandardMaterial {
        alpha_mode: AlphaMode::Blend,
        perceptual_roughness: 0.12,
        reflectance: 0.5,
        ..default()
    });
    commands.insert_resource(SprawlMaterials { ground, water, roads, buildings, windows });
}
