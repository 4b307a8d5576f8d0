//! The circle heuristic of Paduraru 2022 (section 3.1, listing 1): what lies at a pixel of a thinned road is told by how many roads
//! leave a circle around it.

use glam::IVec2;

/// Roads thinned to lines of one pixel.
pub(super) struct Skeleton {
    pub width: i32,
    pub height: i32,
    /// Row by row from the north.
    pub pixels: Vec<bool>,
}

/// The eight neighbours of a pixel, those at its edges first: ways along them are the shorter ones.
pub(super) const AROUND: [IVec2; 8] = [
    IVec2::new(1, 0),
    IVec2::new(-1, 0),
    IVec2::new(0, 1),
    IVec2::new(0, -1),
    IVec2::new(1, 1),
    IVec2::new(1, -1),
    IVec2::new(-1, 1),
    IVec2::new(-1, -1),
];

impl Skeleton {
    /// Index of a pixel, `None` outside the picture.
    pub fn index(&self, p: IVec2) -> Option<usize> {
        let inside = p.x >= 0 && p.y >= 0 && p.x < self.width && p.y < self.height;
        inside.then(|| (p.y * self.width + p.x) as usize)
    }

    /// The place of the pixel with an index.
    pub fn place(&self, index: usize) -> IVec2 {
        IVec2::new(index as i32 % self.width, index as i32 / self.width)
    }

    /// Whether a pixel is of a road.
    pub fn is_road(&self, p: IVec2) -> bool {
        self.index(p).is_some_and(|i| self.pixels[i])
    }

    /// The pixels of roads next to a pixel.
    pub fn neighbours(&self, p: IVec2) -> impl Iterator<Item = IVec2> + '_ {
        AROUND.into_iter().map(move |step| p + step).filter(|q| self.is_road(*q))
    }

    /// How many roads leave the circle of a radius around a pixel of a road: those that hang together with the pixel inside it.
    pub fn branches(&self, at: IVec2, radius: f64) -> usize {
        let inside = |p: &IVec2| f64::from((*p - at).length_squared()) <= radius * radius;
        let on_ring = |p: &IVec2| {
            let inner = radius - 1.0;
            f64::from((*p - at).length_squared()) > inner * inner
        };
        let mut reached = vec![at];
        let mut next = 0;
        while let Some(&p) = reached.get(next) {
            next += 1;
            for q in self.neighbours(p).filter(inside) {
                if !reached.contains(&q) {
                    reached.push(q);
                }
            }
        }
        let mut ring: Vec<IVec2> = reached.into_iter().filter(on_ring).collect();
        let mut count = 0;
        while let Some(first) = ring.pop() {
            count += 1;
            let mut run = vec![first];
            while let Some(p) = run.pop() {
                let (near, far) = ring.into_iter().partition(|q: &IVec2| (*q - p).abs().max_element() <= 1);
                ring = far;
                run.extend::<Vec<IVec2>>(near);
            }
        }
        count
    }
}
