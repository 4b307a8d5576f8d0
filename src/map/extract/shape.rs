//! Shapes of drawings: which are alike, and which are the most varied.

/// What is told of the shape of a patch.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Shape {
    /// Patches with the same key have the same shape.
    pub key: Vec<i32>,
    /// Figures that differ more, the more shapes do; each about 0 to 1.
    pub figures: Vec<f64>,
}

impl Shape {
    fn off(&self, other: &Self) -> f64 {
        self.figures.iter().zip(&other.figures).map(|(a, b)| (a - b) * (a - b)).sum()
    }
}

/// Which of some shapes to keep so that `most` are: each the one that is the least like those before.
pub(super) fn most_varied(shapes: &[&Shape], most: usize) -> Vec<bool> {
    let mut kept = vec![false; shapes.len()];
    let mut off = vec![f64::INFINITY; shapes.len()];
    for _ in 0..most.min(shapes.len()) {
        let left = (0..shapes.len()).filter(|i| !kept[*i]);
        let Some(next) = left.reduce(|a, b| if off[b] > off[a] { b } else { a }) else { break };
        kept[next] = true;
        for (off, shape) in off.iter_mut().zip(shapes) {
            *off = off.min(shape.off(shapes[next]));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_varied_are_far_from_each_other() {
        let shapes: Vec<Shape> =
            [0.0, 0.1, 0.9, 1.0, 0.5].map(|x| Shape { key: Vec::new(), figures: vec![x] }).to_vec();
        let kept = |most| most_varied(&shapes.iter().collect::<Vec<_>>(), most);
        assert_eq!(kept(3), [true, false, false, true, true]);
        assert_eq!(kept(9), [true; 5]);
    }
}
