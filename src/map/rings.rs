//! Rings of outlines, put together from lines that share their end nodes.

/// Joins lines of nodes into closed rings, each without its first node again at the end. `None` if some line is left over.
pub(super) fn rings(lines: Vec<Vec<i64>>) -> Option<Vec<Vec<i64>>> {
    let mut out = Vec::new();
    let mut left: Vec<Vec<i64>> = lines.into_iter().filter(|l| l.len() > 1).collect();
    while let Some(mut ring) = left.pop() {
        while ring.first() != ring.last() {
            let end = ring.last().copied()?;
            let next = left.iter().position(|l| l.first() == Some(&end) || l.last() == Some(&end))?;
            let mut line = left.swap_remove(next);
            if line.first() != Some(&end) {
                line.reverse();
            }
            ring.extend(line.into_iter().skip(1));
        }
        ring.pop();
        out.push(ring);
    }
    out.reverse();
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_from_one_line_and_from_several() {
        let ring = |lines: &[&[i64]]| rings(lines.iter().map(|l| l.to_vec()).collect());
        assert_eq!(ring(&[&[1, 2, 3, 1]]), Some(vec![vec![1, 2, 3]]));
        assert_eq!(ring(&[&[1, 2, 3], &[1, 4, 3]]), Some(vec![vec![1, 4, 3, 2]]));
        assert_eq!(ring(&[&[7, 8, 9, 7], &[1, 2], &[3, 1], &[2, 3]]), Some(vec![vec![7, 8, 9], vec![2, 3, 1]]));
        assert_eq!(ring(&[&[1, 2], &[2, 3]]), None);
        assert_eq!(ring(&[&[1, 2, 3, 1], &[5, 6]]), None);
        assert_eq!(ring(&[&[5]]), Some(vec![]));
    }
}
