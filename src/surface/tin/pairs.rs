//! Edges of triangles, brought together with the same edge of other triangles.

/// An edge of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side<T> {
    /// The vertices, the lower number first.
    pub ends: [u32; 2],
    /// Whether the triangle runs from the lower to the higher number.
    pub forward: bool,
    /// What the triangle is.
    pub of: T,
}

/// The edges of triangles that count, sorted by their vertices; the same edges in the order of their triangles.
pub(super) fn sides<T: Copy>(
    vertices: usize,
    triangles: impl Iterator<Item = ([u32; 3], T)> + Clone,
    counts: impl Fn([u32; 2]) -> bool,
) -> Vec<Side<T>> {
    // A counting sort by the lower vertex: there are few edges at each.
    let mut starts = vec![0u32; vertices + 1];
    let edges = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]].into_iter().filter(|ends| counts(*ends));
    for (corners, _) in triangles.clone() {
        edges(corners).for_each(|[a, b]| starts[a.min(b) as usize + 1] += 1);
    }
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let Some((_, first)) = triangles.clone().next() else { return Vec::new() };
    let blank = Side { ends: [0; 2], forward: false, of: first };
    let mut sides = vec![blank; starts[vertices] as usize];
    let mut next = starts.clone();
    for (corners, of) in triangles {
        for [a, b] in edges(corners) {
            let slot = &mut next[a.min(b) as usize];
            sides[*slot as usize] = Side { ends: [a.min(b), a.max(b)], forward: a < b, of };
            *slot += 1;
        }
    }
    for w in starts.windows(2) {
        sides[w[0] as usize..w[1] as usize].sort_by_key(|side| side.ends[1]);
    }
    sides
}
