//! A row as an object of JSON, with the keys that its columns have there.

use super::{Columns, Entry, List, Quantity};
use serde::ser::{Serialize, SerializeMap, Serializer};

/// One sample.
#[derive(Clone, Copy)]
pub struct JsonSample<'s> {
    /// What the numbers are.
    pub columns: &'s Columns<'s>,
    /// One for each column.
    pub row: &'s [f64],
}

impl Serialize for JsonSample<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for entry in self.entries(None) {
            entry.write(&mut map)?;
        }
        for list in List::ALL {
            let entries: Vec<_> = self.entries(Some(list)).collect();
            if !entries.is_empty() {
                map.serialize_entry(list.key(), &entries)?;
            }
        }
        map.end()
    }
}

impl<'s> JsonSample<'s> {
    fn entries(&self, list: Option<List>) -> impl Iterator<Item = JsonEntry<'s>> + use<'s> {
        let row = self.row;
        let entries = self.columns.entries.iter();
        entries
            .filter(move |entry| entry.list == list)
            .map(move |entry| JsonEntry { entry, row })
    }
}

/// One of the things that a sample tells of.
struct JsonEntry<'s> {
    entry: &'s Entry<'s>,
    row: &'s [f64],
}

impl JsonEntry<'_> {
    fn write<M: SerializeMap>(&self, map: &mut M) -> Result<(), M::Error> {
        for Quantity { key, columns, .. } in &self.entry.quantities {
            let numbers = self.row.get(columns.clone()).unwrap_or_default();
            match (self.entry.list, numbers) {
                (None, [number]) => map.serialize_entry(key, number)?,
                _ => map.serialize_entry(key, numbers)?,
            }
        }
        Ok(())
    }
}

impl Serialize for JsonEntry<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        if let Some(list) = self.entry.list {
            map.serialize_entry(list.label(), self.entry.name)?;
        }
        self.write(&mut map)?;
        map.end()
    }
}
