//! Loops and couplings.

use super::body::name_of;
use super::value::{number, table, text};
use super::{entry, pose};
use crate::description::{LoopEnd, SceneDescription};
use crate::source::Located;

/// Appends both lists.
pub(super) fn ties(out: &mut String, scene: &SceneDescription) {
    let name = |body: Option<usize>| text(name_of(body, &scene.bodies));
    for tie in &scene.loops {
        out.push_str("\n[[loop]]\n");
        entry(out, "name", &text(&tie.name.value));
        entry(out, "type", &text(tie.closing.name()));
        let end = |end: &LoopEnd| {
            let mut entries = vec![("body", name(end.body))];
            entries.extend(pose::pose(&end.at).map(|at| ("at", at)));
            table(&entries)
        };
        let [first, second] = tie.ends.each_ref().map(end);
        entry(out, "predecessor", &first);
        entry(out, "successor", &second);
        independent(out, &tie.independent);
    }
    for tie in &scene.couplings {
        out.push_str("\n[[coupling]]\n");
        entry(out, "name", &text(&tie.name.value));
        let [first, second] = tie.ends.map(name);
        entry(out, "predecessor", &first);
        entry(out, "successor", &second);
        entry(out, "ratio", &number(tie.ratio));
        if tie.offset != 0.0 {
            entry(out, "offset", &number(tie.offset));
        }
        independent(out, &tie.independent);
    }
}

fn independent(out: &mut String, names: &[Located<String>]) {
    if !names.is_empty() {
        let names: Vec<String> = names.iter().map(|own| text(&own.value)).collect();
        entry(out, "independent", &format!("[{}]", names.join(", ")));
    }
}
