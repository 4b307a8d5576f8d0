//! The entities that show meshes.

use crate::plugin::appearance::{PartMesh, SprawlMaterials};
use bevy::camera::visibility::NoAutoAabb;
use bevy::prelude::*;

/// Spawns a child of `parent` for each mesh.
pub(super) fn spawn_parts(world: &mut World, parent: Entity, parts: Vec<PartMesh>) -> Vec<Entity> {
    let materials = world.get_resource::<SprawlMaterials>().cloned();
    let mut handles = Vec::with_capacity(parts.len());
    if let Some(mut meshes) = world.get_resource_mut::<Assets<Mesh>>() {
        handles.extend(parts.into_iter().map(|p| (p.part, meshes.add(p.mesh), p.bounds)));
    }
    let spawned = handles.into_iter().map(|(part, mesh, bounds)| {
        let mut child = world.spawn((part, Mesh3d(mesh), bounds, NoAutoAabb, Visibility::default(), ChildOf(parent)));
        if let Some(materials) = &materials {
            child.insert(MeshMaterial3d(materials[part].clone()));
        }
        child.id()
    });
    spawned.collect()
}
