//! The contents of files as the loaders have read them.

use bevy::prelude::Resource;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// The content of each file as a loader last read it, good or bad. Clones share it.
#[derive(Resource, Clone, Debug, Default)]
pub(in crate::plugin) struct FileContents(Arc<Mutex<BTreeMap<String, Arc<[u8]>>>>);

impl FileContents {
    pub fn get(&self, file: &str) -> Option<Arc<[u8]>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get(file).cloned()
    }

    pub fn set(&self, file: &str, content: &[u8]) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).insert(file.to_owned(), content.into());
    }
}
