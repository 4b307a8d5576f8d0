//! What things stand on and run into, for physics.

use crate::mesh::CollisionMesh;
use bevy::prelude::*;
use std::sync::Arc;

/// The triangles that things in a chunk stand on and run into, from the chunk's transform. With [`StreamSettings::collision`] an entity
/// of a chunk has it while the chunk is loaded in full detail.
///
/// With the feature `avian` the entity is a static body of the physics engine Avian, too. For any other engine, make a collider from
/// the triangles when this comes:
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_sprawl::prelude::*;
///
/// fn collide(added: On<Add, ChunkCollision>, chunks: Query<&ChunkCollision>) {
///     if let Ok(chunk) = chunks.get(added.entity) {
///         println!("{} triangles", chunk.triangles.len());
///     }
/// }
/// ```
///
/// [`StreamSettings::collision`]: crate::plugin::StreamSettings::collision
#[derive(Component, Clone, Debug, Deref)]
#[component(immutable)]
pub struct ChunkCollision(pub Arc<CollisionMesh>);

/// What a task makes for physics.
pub(super) struct MadeCollision {
    mesh: Arc<CollisionMesh>,
    #[cfg(feature = "avian")]
    collider: avian3d::prelude::Collider,
}

impl MadeCollision {
    pub fn new(mesh: CollisionMesh) -> Self {
        Self {
            #[cfg(feature = "avian")]
            collider: collider(&mesh),
            mesh: Arc::new(mesh),
        }
    }

    /// Gives the entity of a chunk what was made, or takes it away where nothing was.
    pub fn put(made: Option<Self>, entity: &mut EntityWorldMut<'_>) {
        match made {
            Some(made) => {
                #[cfg(feature = "avian")]
                entity.insert((avian3d::prelude::RigidBody::Static, made.collider));
                entity.insert(ChunkCollision(made.mesh));
            }
            None => {
                #[cfg(feature = "avian")]
                entity.remove::<(avian3d::prelude::RigidBody, avian3d::prelude::Collider)>();
                entity.remove::<ChunkCollision>();
            }
        }
    }
}

/// A collider on which balls roll from triangle to triangle without a bump.
#[cfg(feature = "avian")]
fn collider(mesh: &CollisionMesh) -> avian3d::prelude::Collider {
    use avian3d::prelude::{Collider, TrimeshFlags};
    let vertices = mesh.vertices.iter().map(|v| Vec3::from(*v)).collect();
    Collider::trimesh_with_config(vertices, mesh.triangles.clone(), TrimeshFlags::FIX_INTERNAL_EDGES)
}
