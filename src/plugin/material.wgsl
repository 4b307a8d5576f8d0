// Bevy's standard material with the textures of `texture::Texture`: the alpha of a vertex names its texture.

#import bevy_pbr::{
    decal::clustered::apply_decals,
    pbr_fragment::pbr_input_from_standard_material,
    pbr_functions::alpha_discard,
}

#ifdef PREPASS_PIPELINE
#import bevy_pbr::{
    pbr_deferred_functions::deferred_output,
    prepass_io::{FragmentOutput, VertexOutput},
}
#else
#import bevy_pbr::{
    forward_io::{FragmentOutput, VertexOutput},
    pbr_functions::{apply_pbr_lighting, main_pass_post_lighting_processing},
    pbr_types::STANDARD_MATERIAL_FLAGS_UNLIT_BIT,
}
#endif

struct Settings {
    // How much of the textures shows, 0 to 1.
    strength: f32,
    // Edges of the textures in metres.
    sizes: array<vec4<f32>, 4>,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(100) var layers: texture_2d_array<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(101) var layers_sampler: sampler;
@group(#{MATERIAL_BIND_GROUP}) @binding(102) var<uniform> settings: Settings;

// The last texture of the ground, the texture of rock, and that of roof tiles.
const LITTER: f32 = 3.0;
const ROCK: u32 = 4u;
const TILES: u32 = 12u;
const MEADOW: u32 = 1u;

// A place on a plane with its derivatives in the picture.
struct Place {
    at: vec2<f32>,
    dx: vec2<f32>,
    dy: vec2<f32>,
}

// A pixel of a texture with its signs: how much lighter, the normal to the right and upwards, how much rougher.
fn pixel(layer: u32, place: Place) -> vec4<f32> {
    let scale = 1.0 / settings.sizes[layer / 4u][layer % 4u];
    let p = textureSampleGrad(
        layers,
        layers_sampler,
        place.at * scale,
        layer,
        place.dx * scale,
        place.dy * scale,
    );
    return (p * 255.0 - 128.0) / 127.0;
}

// The same between two textures of the list.
fn blended(axis: f32, place: Place) -> vec4<f32> {
    let low = floor(axis + 0.02);
    let share = saturate(axis - low);
    var out = pixel(u32(low), place);
    if share > 0.02 {
        out = mix(out, pixel(u32(low) + 1u, place), share);
    }
    return out;
}

// The place of a point on the plane with the unit axes `right` and `up`.
fn on_plane(p: vec3<f32>, dx: vec3<f32>, dy: vec3<f32>, right: vec3<f32>, up: vec3<f32>) -> Place {
    return Place(
        vec2(dot(p, right), -dot(p, up)),
        vec2(dot(dx, right), -dot(dx, up)),
        vec2(dot(dy, right), -dot(dy, up)),
    );
}

@fragment
fn fragment(in: VertexOutput, @builtin(front_facing) is_front: bool) -> FragmentOutput {
    var pbr_input = pbr_input_from_standard_material(in, is_front);

#ifdef VERTEX_COLORS
    let p = in.world_position.xyz;
    let dx = dpdx(p);
    let dy = dpdy(p);
    if settings.strength > 0.0 && textureNumLayers(layers) > 1u {
        let normal = pbr_input.N;
        let axis = in.color.a * 255.0;
        // On level ground, to the east and to the north.
        var right = vec3(1.0, 0.0, 0.0);
        var up = vec3(0.0, 0.0, -1.0);
        let is_ground = axis < LITTER + 0.5;
        if !is_ground && (abs(normal.y) < 0.7 || (u32(axis + 0.5) == TILES && abs(normal.y) < 0.999)) {
            right = normalize(cross(vec3(0.0, 1.0, 0.0), normal));
            up = cross(normal, right);
        }
        let place = on_plane(p, dx, dy, right, up);
        var detail = blended(axis, place);
        var tint = vec3(1.0);
        if is_ground {
            let slope = length(normal.xz) / max(abs(normal.y), 0.01);
            let bare = smoothstep(0.45, 0.8, slope);
            if bare > 0.01 {
                let weights = pow(abs(normal), vec3(4.0)) / dot(pow(abs(normal), vec3(4.0)), vec3(1.0));
                let sky = vec3(0.0, 1.0, 0.0);
                let rock = weights.x * pixel(ROCK, on_plane(p, dx, dy, vec3(0.0, 0.0, 1.0), sky))
                    + weights.y * pixel(ROCK, place)
                    + weights.z * pixel(ROCK, on_plane(p, dx, dy, vec3(1.0, 0.0, 0.0), sky));
                detail = mix(detail, rock, bare);
            }
            // Patches of a few dozen metres, on axes of their own, so that repeats do not show.
            let turned = on_plane(p, dx, dy, vec3(0.0743, 0.0, 0.0371), vec3(0.0371, 0.0, -0.0743));
            let patches = pixel(MEADOW, turned).x;
            tint = vec3(1.0 + 0.45 * patches, 1.0 + 0.30 * patches, 1.0 + 0.20 * patches);
        }
        let shade = 1.0 + detail.x * settings.strength;
        let colour = pbr_input.material.base_color;
        pbr_input.material.base_color = vec4(colour.rgb * max(shade, 0.0) * mix(vec3(1.0), tint, settings.strength), colour.a);
        pbr_input.material.perceptual_roughness =
            clamp(pbr_input.material.perceptual_roughness + 0.5 * detail.w * settings.strength, 0.08, 1.0);
        pbr_input.N = normalize(normal + (right * detail.y + up * detail.z) * settings.strength);
    }
#endif

    pbr_input.material.base_color = alpha_discard(pbr_input.material, pbr_input.material.base_color);
    apply_decals(&pbr_input);

#ifdef PREPASS_PIPELINE
    return deferred_output(in, pbr_input);
#else
    var out: FragmentOutput;
    if (pbr_input.material.flags & STANDARD_MATERIAL_FLAGS_UNLIT_BIT) == 0u {
        out.color = apply_pbr_lighting(pbr_input);
    } else {
        out.color = pbr_input.material.base_color;
    }
    out.color = main_pass_post_lighting_processing(pbr_input, out.color);
    return out;
#endif
}
