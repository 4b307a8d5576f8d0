//! Chunk meshes as one glTF 2.0 binary: a node for each chunk, a primitive for each part.

use crate::export::ExportError;
use crate::mesh::{ChunkMesh, ChunkPart, MeshBuffers, PartMaterial};
use crate::space::Origin;
use glam::{DVec2, Vec3};
use gltf::Index;
use gltf::accessor::{ComponentType, GenericComponentType, Type};
use gltf::buffer::Target;
use gltf::mesh::Semantic;
use gltf::validation::{Checked, USize64};
use gltf_json as gltf;

/// The meshes of a chunk, or of a tile of the horizon, with their position.
pub struct PlacedMesh {
    /// Name in the file.
    pub name: String,
    /// South-west corner of the chunk or tile, which positions of the meshes are local to.
    pub origin: Origin,
    /// The meshes.
    pub mesh: ChunkMesh,
}

/// Writes meshes as a GLB file, with `centre` (plan metres) at (0, height, 0): x east, y up, z south, in metres.
///
/// # Errors
///
/// [`ExportError::Format`] if the buffers of a mesh differ in length, or if the file would be larger than 4 GiB.
pub fn write(chunks: &[PlacedMesh], centre: DVec2) -> Result<Vec<u8>, ExportError> {
    let mut file = File::default();
    // A material is added when it is first used, since readers warn of unused materials.
    let mut materials = [None; ChunkPart::ALL.len()];
    for chunk in chunks {
        let mut primitives = Vec::new();
        // The format and its viewers refuse empty meshes.
        for (part, buffers) in chunk.mesh.parts().filter(|(_, buffers)| !buffers.indices.is_empty()) {
            let material = *materials[part as usize].get_or_insert_with(|| file.material(part));
            primitives.push(file.primitive(buffers, material, part.material().transparent)?);
        }
        if primitives.is_empty() {
            continue;
        }
        let name = Some(chunk.name.clone());
        let mesh =
            gltf::Mesh { extensions: None, extras: Default::default(), name: name.clone(), primitives, weights: None };
        let mesh = file.root.push(mesh);
        let at = chunk.origin.plan() - centre;
        let translation = Some([at.x as f32, 0.0, -at.y as f32]);
        file.nodes.push(file.root.push(gltf::Node { mesh: Some(mesh), name, translation, ..Default::default() }));
    }
    file.finish()
}

#[derive(Default)]
struct File {
    root: gltf::Root,
    binary: Vec<u8>,
    nodes: Vec<Index<gltf::Node>>,
}

impl File {
    fn material(&mut self, part: ChunkPart) -> Index<gltf::Material> {
        let PartMaterial { name, roughness, transparent, .. } = part.material();
        let alpha_mode = if transparent { gltf::material::AlphaMode::Blend } else { Default::default() };
        self.root.push(gltf::Material {
            name: Some(name.into()),
            alpha_mode: Checked::Valid(alpha_mode),
            pbr_metallic_roughness: gltf::material::PbrMetallicRoughness {
                metallic_factor: gltf::material::StrengthFactor(0.0),
                roughness_factor: gltf::material::StrengthFactor(roughness),
                ..Default::default()
            },
            ..Default::default()
        })
    }

    fn primitive(
        &mut self,
        buffers: &MeshBuffers,
        material: Index<gltf::Material>,
        transparent: bool,
    ) -> Result<gltf::mesh::Primitive, ExportError> {
        let count = buffers.positions.len();
        let fits = buffers.normals.len() == count && buffers.colours.len() == count;
        if !fits || buffers.indices.iter().any(|i| *i as usize >= count) {
            return Err(ExportError::Format("a mesh's buffers differ in length".into()));
        }
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for p in &buffers.positions {
            (low, high) = (low.min((*p).into()), high.max((*p).into()));
        }
        let positions = buffers.positions.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        // Readers insist on normals of unit length.
        let unit = |vertex: u32| buffers.normal(vertex).try_normalize().unwrap_or(Vec3::Y).to_array();
        let normals = (0..count as u32).flat_map(unit).flat_map(f32::to_le_bytes).collect();
        // Of opaque parts the alpha names a texture.
        let alpha = |[r, g, b, a]: [u16; 4]| [r, g, b, if transparent { a } else { u16::MAX }];
        let colours = buffers.colours.iter().flat_map(|c| alpha(*c)).flat_map(u16::to_le_bytes).collect();
        let indices = buffers.indices.iter().flat_map(|i| i.to_le_bytes()).collect();

        let vertices = Some(Target::ArrayBuffer);
        let positions = self.accessor(positions, vertices, count, Type::Vec3, ComponentType::F32);
        let accessor = &mut self.root.accessors[positions.value()];
        accessor.min = Some(low.to_array().map(f64::from).to_vec().into());
        accessor.max = Some(high.to_array().map(f64::from).to_vec().into());
        let normals = self.accessor(normals, vertices, count, Type::Vec3, ComponentType::F32);
        let colours = self.accessor(colours, vertices, count, Type::Vec4, ComponentType::U16);
        self.root.accessors[colours.value()].normalized = true;
        let elements = Some(Target::ElementArrayBuffer);
        let indices = self.accessor(indices, elements, buffers.indices.len(), Type::Scalar, ComponentType::U32);
        let attributes =
            [(Semantic::Positions, positions), (Semantic::Normals, normals), (Semantic::Colors(0), colours)];
        Ok(gltf::mesh::Primitive {
            attributes: attributes.into_iter().map(|(k, v)| (Checked::Valid(k), v)).collect(),
            extensions: None,
            extras: Default::default(),
            indices: Some(indices),
            material: Some(material),
            mode: Checked::Valid(gltf::mesh::Mode::Triangles),
            targets: None,
        })
    }

    /// Appends `bytes`, whose number is a multiple of 4, and describes them.
    fn accessor(
        &mut self,
        bytes: Vec<u8>,
        target: Option<Target>,
        count: usize,
        type_: Type,
        component: ComponentType,
    ) -> Index<gltf::Accessor> {
        let view = self.root.push(gltf::buffer::View {
            buffer: Index::new(0),
            byte_length: USize64::from(bytes.len()),
            byte_offset: Some(USize64::from(self.binary.len())),
            byte_stride: None,
            name: None,
            target: target.map(Checked::Valid),
            extensions: None,
            extras: Default::default(),
        });
        self.binary.extend(bytes);
        self.root.push(gltf::Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: USize64::from(count),
            component_type: Checked::Valid(GenericComponentType(component)),
            extensions: None,
            extras: Default::default(),
            type_: Checked::Valid(type_),
            min: None,
            max: None,
            name: None,
            normalized: false,
            sparse: None,
        })
    }

    fn finish(mut self) -> Result<Vec<u8>, ExportError> {
        self.root.asset.generator = Some("bevy_sprawl".into());
        if !self.binary.is_empty() {
            self.root.buffers.push(gltf::Buffer {
                byte_length: USize64::from(self.binary.len()),
                name: None,
                uri: None,
                extensions: None,
                extras: Default::default(),
            });
        }
        let name = Some("sprawl".into());
        let scene = gltf::Scene { extensions: None, extras: Default::default(), name, nodes: self.nodes };
        self.root.scene = Some(self.root.push(scene));
        let mut json = self.root.to_vec().map_err(|e| ExportError::Format(e.to_string()))?;
        json.resize(json.len().next_multiple_of(4), b' ');
        let chunks: [(&[u8; 4], Vec<u8>); 2] = [(b"JSON", json), (b"BIN\0", self.binary)];
        let total = 12 + chunks.iter().filter(|(_, data)| !data.is_empty()).map(|(_, d)| 8 + d.len()).sum::<usize>();
        let length = |n: usize| {
            let too_long = || ExportError::Format("the file would be larger than 4 GiB; take a smaller square".into());
            u32::try_from(n).map(u32::to_le_bytes).map_err(|_| too_long())
        };
        let mut out = Vec::with_capacity(total);
        out.extend(b"glTF");
        out.extend(2u32.to_le_bytes());
        out.extend(length(total)?);
        for (kind, data) in chunks.iter().filter(|(_, data)| !data.is_empty()) {
            out.extend(length(data.len())?);
            out.extend(*kind);
            out.extend(data);
        }
        Ok(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::ChunkCoord;

    /// A square of two triangles, off the origin.
    fn square(height: f32) -> MeshBuffers {
        MeshBuffers {
            positions: vec![[1.0, height, 0.0], [9.1, height, 0.0], [9.1, height, -7.0], [1.0, height, -7.0]],
            normals: vec![[0, 90, 0, 0]; 4],
            colours: vec![[32768, 65535, 16384, 65535]; 4],
            indices: vec![0, 1, 2, 0, 2, 3],
        }
    }

    #[test]
    fn chunks_are_nodes_and_lengths_add_up() {
        let mesh = |roads| {
            let mut mesh = ChunkMesh::default();
            mesh[ChunkPart::Ground] = square(0.0);
            mesh[ChunkPart::Roads] = roads;
            mesh
        };
        let chunk = |x, mesh| {
            let coord = ChunkCoord::new(x, -1);
            PlacedMesh { name: coord.to_string(), origin: coord.origin(512), mesh }
        };
        let chunks =
            [chunk(1, mesh(square(2.0))), chunk(2, mesh(MeshBuffers::default())), chunk(3, ChunkMesh::default())];
        let file = write(&chunks, DVec2::new(512.0, 0.0)).unwrap();
        let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!(word(8), file.len());
        let root = gltf::Root::from_slice(&file[20..20 + word(12)]).unwrap();
        assert_eq!((root.nodes.len(), root.meshes[0].primitives.len(), root.meshes[1].primitives.len()), (2, 2, 1));
        assert_eq!(root.nodes[1].translation, Some([512.0, 0.0, 512.0]));
        assert_eq!(root.buffers[0].byte_length.0 as usize, word(20 + word(12)));
    }

    #[test]
    fn buffers_that_do_not_fit_are_refused() {
        let mut mesh = ChunkMesh::default();
        mesh[ChunkPart::Ground] = square(0.0);
        mesh[ChunkPart::Ground].indices[0] = 4;
        let coord = ChunkCoord::new(0, 0);
        let chunk = PlacedMesh { name: coord.to_string(), origin: coord.origin(512), mesh };
        assert!(write(&[chunk], DVec2::ZERO).is_err());
    }
}
