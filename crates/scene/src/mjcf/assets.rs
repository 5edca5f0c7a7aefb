//! What geoms refer to by name: meshes and materials.

use super::defaults::{Defaults, MAIN};
use super::mesh::{self, Bulks};
use crate::read::Sink;
use crate::shape::Mesh;
use roxmltree::Node;
use std::collections::HashMap;

/// The assets of a model, by their names.
pub(super) struct Assets {
    /// What meshes weigh with the density 1.
    pub(super) bulks: Bulks,
    /// The files of meshes.
    pub(super) files: HashMap<String, Mesh>,
    /// The colours of materials.
    pub(super) colors: HashMap<String, [f64; 4]>,
}

impl Assets {
    /// Those of a model that has been completed.
    pub(super) fn read<'a>(root: Node<'a, 'a>, defaults: &Defaults<'a>, sink: &mut Sink) -> Self {
        let colors = assets(root, "material").filter_map(|node| {
            let element = defaults.element(node, MAIN, sink);
            Some((node.attribute("name")?.to_owned(), element.vector("rgba")?))
        });
        Self {
            colors: colors.collect(),
            bulks: mesh::bulks(root, defaults, sink),
            files: mesh::files(root, defaults, sink),
        }
    }
}

/// The assets of a kind.
pub(super) fn assets<'a>(
    root: Node<'a, 'a>,
    kind: &'static str,
) -> impl Iterator<Item = Node<'a, 'a>> {
    let assets = root.children().filter(|node| node.has_tag_name("asset"));
    assets
        .flat_map(|asset| asset.children())
        .filter(move |node| node.has_tag_name(kind))
}
