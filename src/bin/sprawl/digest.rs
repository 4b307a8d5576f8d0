//! `sprawl digest`: hashes of the exact bits of chunks, layer by layer.

use crate::common::Common;
use crate::fail::Fail;
use crate::values::{ChunkRange, chunk_range};
use crate::work;
use bevy_sprawl::analysis::digest::{ChunkDigest, Digest, LAYERS};
use bevy_sprawl::layer::Cancel;
use bevy_sprawl::space::{ChunkCoord, Seed};
use clap::{Args, ValueEnum};
use serde_json::{Map, json};
use std::fmt::Write;

#[derive(Args)]
pub struct DigestArgs {
    /// Columns and rows of chunks, ends excluded
    #[arg(long, value_name = "X0..X1,Y0..Y1", allow_hyphen_values = true, value_parser = chunk_range)]
    pub chunks: ChunkRange,
    /// Order in which the chunks are made; the hashes do not depend on it
    #[arg(long, value_name = "ORDER", default_value = "forward")]
    pub order: Order,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Order {
    /// Column by column
    Forward,
    /// The other way round
    Reverse,
    /// In an order that follows from the seed
    Shuffled,
}

/// Runs the command.
pub fn run(common: &Common, args: &DigestArgs) -> Result<(), Fail> {
    let world = work::world(common)?;
    let (x, y) = (args.chunks.x.clone(), args.chunks.y.clone());
    let mut coords: Vec<ChunkCoord> = x.flat_map(|x| y.clone().map(move |y| ChunkCoord::new(x, y))).collect();
    order(&mut coords, args.order, world.seed());
    let cancel = Cancel::new();
    let made =
        work::each(common, "making chunks", &coords, |coord| Ok((*coord, ChunkDigest::new(&world, *coord, &cancel)?)))?;
    let digest = Digest::new(made);

    let hex = |hash: u64| format!("{hash:016x}");
    let mut people = String::new();
    for (layer, hash) in LAYERS.iter().zip(digest.layers) {
        // Writing to a string cannot fail.
        let _ = writeln!(people, "{layer:8} {}", hex(hash));
    }
    let total = hex(digest.total);
    let _ = writeln!(people, "{:8} {total}  ({} chunks)", "total", digest.chunks.len());
    let layers: Map<_, _> = LAYERS.iter().zip(digest.layers).map(|(l, h)| ((*l).to_owned(), json!(hex(h)))).collect();
    let chunks: Map<_, _> = digest.chunks.iter().map(|(c, h)| (c.to_string(), json!(hex(*h)))).collect();
    work::print(common, &json!({ "layers": layers, "chunks": chunks, "total": total }), &people)
}

fn order(coords: &mut [ChunkCoord], order: Order, seed: Seed) {
    match order {
        Order::Forward => {}
        Order::Reverse => coords.reverse(),
        Order::Shuffled => {
            let mut random = seed.stream("digest order", &[]);
            for i in (1..coords.len()).rev() {
                coords.swap(i, random.index(i + 1));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_order_visits_every_chunk_once() {
        let all: Vec<_> = (0..20).map(|i| ChunkCoord::new(i / 5 - 2, i % 5)).collect();
        for by in [Order::Forward, Order::Reverse, Order::Shuffled] {
            let mut coords = all.clone();
            order(&mut coords, by, Seed(3));
            assert_eq!(coords == all, by == Order::Forward);
            coords.sort();
            assert_eq!(coords, all);
        }
    }
}
