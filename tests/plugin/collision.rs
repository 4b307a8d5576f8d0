//! What things stand on, with the real generator and without a renderer.

use super::*;
use bevy_sprawl::mesh::Detail;

/// Heights of the triangles that hold a point, in metres; points and triangles in Bevy's axes.
fn heights(collision: &ChunkCollision, x: f32, z: f32) -> Vec<f32> {
    let mut out = Vec::new();
    for triangle in &collision.triangles {
        let [a, b, c] = triangle.map(|v| Vec3::from(collision.vertices[v as usize]));
        let (ab, ac, ap) = ((b - a).xz(), (c - a).xz(), Vec2::new(x, z) - a.xz());
        let area = ab.perp_dot(ac);
        let (s, t) = (ap.perp_dot(ac) / area, ab.perp_dot(ap) / area);
        if area != 0.0 && s >= -1e-4 && t >= -1e-4 && s + t <= 1.0 + 1e-4 {
            out.push(a.y + (b.y - a.y) * s + (c.y - a.y) * t);
        }
    }
    out
}

#[test]
fn chunks_in_full_detail_are_solid_where_one_walks() {
    let streaming = StreamSettings { collision: true, ..default() };
    let mut app = app(SprawlPlugin { streaming, ..SprawlPlugin::new(42) }, AssetPlugin::default());
    app.world_mut().spawn(anchor());
    settle(&mut app);
    let mut query = app.world_mut().query::<(&ChunkData, &ChunkDetail, Option<&ChunkCollision>)>();
    let (mut solid, mut coarse) = (0, 0);
    for (chunk, detail, collision) in query.iter(app.world()) {
        assert_eq!(detail.0 == Detail::Full, collision.is_some(), "{}", chunk.coord);
        let Some(collision) = collision else {
            coarse += 1;
            continue;
        };
        solid += 1;
        for i in 0..60 {
            let at = DVec2::new(f64::from(i * 83 % 509) + 1.3, f64::from(i * 47 % 503) + 2.1);
            let walked = chunk.surface(at, f64::INFINITY).expect("the point lies in the chunk") as f32;
            let under = heights(collision, at.x as f32, -at.y as f32);
            let nearest = under.iter().map(|h| (h - walked).abs()).fold(f32::INFINITY, f32::min);
            assert!(nearest < 0.011, "{} at {at}: {walked} m, triangles at {under:?}", chunk.coord);
        }
    }
    assert!(solid > 0 && coarse > 0, "{solid} chunks in full detail, {coarse} others");
}
