//! Tests of roads on whole worlds.

mod costs;
mod edits;
mod fixtures;
mod interchanges;
mod limits;
mod merging;
mod network;
mod overpass;

use super::lattice::node_at;
use super::route::Route;
use super::tier::{beeline, tier_of};
use super::*;
use crate::edits::Edits;
use crate::layer::{Cancel, LayerError};
use crate::network::{JunctionId, SizeClass, StreetClass, StreetId};
use crate::region::{Settlement, SettlementId};
use crate::space::{Bounds, Origin};
use crate::space::{point_in_polygon, polygon_distance, segment_crossing, segment_distance, segments};
use fixtures::*;
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;
use std::sync::Arc;
